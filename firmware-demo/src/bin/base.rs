//! A whole base on an emulated board: drives a trajectory from flash to parked by its encoders, counts what a tick costs, and
//! prints a checksum over every bit for comparison with the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
#[path = "on_route/frame.rs"]
mod frame;

#[cfg(target_os = "none")]
fn run() {
    use controller_core::base::Order;
    use firmware_demo::board::{Meter, Spread};
    use firmware_demo::mission::{base, drive};
    use firmware_demo::route::CURVE;
    use frame::{TICKS, complain, report};

    let Ok(base) = base(false) else {
        return complain("!parameters");
    };
    let mut meter = Meter::start();
    let (mut follow, mut park) = (Spread::new(), Spread::new());
    let driven = drive(&CURVE, &base, TICKS, |controller, tick| {
        let count = meter
            .measure(|| {
                controller.tick(tick.dt_us, &tick.order, &tick.sensed);
            })
            .1;
        match tick.order {
            Order::Park(_) => park.add(count),
            _ => follow.add(count),
        }
    });
    let Ok(driven) = driven else {
        return complain("!fault");
    };
    let costs = [("base/follow", &follow), ("base/park", &park)];
    report(costs, &driven);
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; `tests/tests/parity/images.rs` starts it.");
}
