//! Processor in the loop on an emulated board: the controller answers measurements with reports.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
fn run() {
    use controller_core::paper::params::Params;
    use firmware_demo::board::{EXIT_LINK, Meter, open_link, semihosting};
    use firmware_demo::pil::{End, Pil, serve};

    let (Some(mut link), Ok(params)) = (open_link(), Params::paper().validate()) else {
        semihosting::exit(EXIT_LINK)
    };
    if serve(&mut link, &mut Meter::start(), &mut Pil::new(params)) != End::Stopped {
        semihosting::exit(EXIT_LINK);
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; build it with");
    println!("  cargo build -p firmware-demo --release --target thumbv7em-none-eabihf --bin pil");
    println!("and let firmware_demo::host::Chip start it (examples/exchange.rs shows how).");
}
