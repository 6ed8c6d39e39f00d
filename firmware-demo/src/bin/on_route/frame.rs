//! What the programs that drive the route on a board have in common: how long, and what they print.

use firmware_demo::board::print::Line;
use firmware_demo::board::{Spread, high_water_mark};
use firmware_demo::route::Driven;

/// 14 s: the route, and time to park.
pub const TICKS: u32 = 14_000;

/// The drive did not take place, or not to its end.
pub fn complain(about: &str) {
    Line::new().text(about).print();
}

/// What a tick cost, by the task, and what came of the drive.
pub fn report(costs: [(&str, &Spread); 2], driven: &Driven) {
    for (name, spread) in costs {
        spread.print(name);
    }
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
