//! The whole firmware of a base with the processor in the loop: control task, protocol and line, with its sensors, its motors and
//! the bytes of its line on the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
fn run() {
    use firmware_demo::board::{EXIT_LINK, Meter, open_link, semihosting};
    use firmware_demo::control_server::Queues;
    use firmware_demo::mission;
    use firmware_demo::pil::{BoardPil, End, serve};

    let (Some(mut link), Ok(params)) = (open_link(), mission::params(15.0, false)) else {
        semihosting::exit(EXIT_LINK)
    };
    let mut queues = Queues::default();
    let mut board = BoardPil::new(params, &mut queues);
    if serve(&mut link, &mut Meter::start(), &mut board) != End::Stopped {
        semihosting::exit(EXIT_LINK);
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "This program runs on an emulated board; tests of `sim-host identify` build and start it."
    );
}
