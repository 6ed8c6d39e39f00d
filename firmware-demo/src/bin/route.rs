//! The law for a real base on an emulated board: drives a trajectory from flash to parked, counts what a
//! tick costs, and prints a checksum over every bit for comparison with the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
#[path = "on_route/frame.rs"]
mod frame;

#[cfg(target_os = "none")]
fn run() {
    use controller_core::motion::Task;
    use firmware_demo::board::{Meter, Spread};
    use firmware_demo::route::{CURVE, base, drive};
    use frame::{TICKS, complain, report};

    let Ok(base) = base() else {
        return complain("!parameters");
    };
    let mut meter = Meter::start();
    let (mut follow, mut park) = (Spread::new(), Spread::new());
    let driven = drive(&CURVE, &base, TICKS, |controller, dt, task, measured| {
        let (result, count) = meter.measure(|| controller.step(dt, task, measured).map(|_| ()));
        match task {
            Task::Follow(_) => follow.add(count),
            Task::Park(_) => park.add(count),
            // On no route.
            Task::Drive { .. } => {}
        }
        result
    });
    let Ok(driven) = driven else {
        return complain("!fault");
    };
    let costs = [("motion/follow", &follow), ("motion/park", &park)];
    report(costs, &driven);
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; `tests/tests/parity/images.rs` starts it.");
}
