//! A whole base on an emulated board: drives a trajectory from flash to parked by its encoders, counts what a tick costs, and
//! prints a checksum over every bit for comparison with the host.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

/// 14 s: the route, and time to park.
#[cfg(target_os = "none")]
const TICKS: u32 = 14_000;

#[cfg(target_os = "none")]
fn run() {
    use controller_core::base::Order;
    use firmware_demo::board::print::Line;
    use firmware_demo::board::{Meter, Spread, high_water_mark};
    use firmware_demo::mission::{base, drive};
    use firmware_demo::route::BEND;

    let Ok(base) = base(false) else {
        Line::new().text("!parameters").print();
        return;
    };
    let mut meter = Meter::start();
    let (mut follow, mut park) = (Spread::new(), Spread::new());
    let driven = drive(&BEND, &base, TICKS, |controller, tick| {
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
        Line::new().text("!fault").print();
        return;
    };
    follow.print("base/follow");
    park.print("base/park");
    for (name, number) in [
        ("ticks", driven.ticks),
        ("handed-over", driven.handed_over),
        ("parked", driven.parked),
        ("checksum", driven.checksum),
        ("stack", high_water_mark()),
    ] {
        Line::new().text(name).number(number).print();
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; `tests/tests/motion_on_chip.rs` starts it.");
}
