//! The whole base with the processor in the loop: the control task answers what a simulated base senses with what its
//! motors get.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
fn run() {
    use controller_core::queue::ReferenceQueue;
    use firmware_demo::board::{EXIT_LINK, Meter, open_link, semihosting};
    use firmware_demo::mission;
    use firmware_demo::pil::{BasePil, End, serve};

    let (Some(mut link), Ok(params)) = (open_link(), mission::params(15.0, false)) else {
        semihosting::exit(EXIT_LINK)
    };
    let mut queue = ReferenceQueue::<f32, 2>::new();
    let mut base = BasePil::new(params, queue.split().1);
    if serve(&mut link, &mut Meter::start(), &mut base) != End::Stopped {
        semihosting::exit(EXIT_LINK);
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; `sim-host pil` builds and starts it.");
}
