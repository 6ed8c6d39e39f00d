//! The tick of a whole base, and of the motion law in it, on a mission: the route in flash, followed and parked at.

use controller_core::base::Order;
use controller_core::motion::Task;
use firmware_demo::board::Meter;
use firmware_demo::mission;
use firmware_demo::route::{self, BEND};

use crate::print::{Row, complain};

/// The route, and time to park.
const TICKS: u32 = 14_000;

/// From counts to torques, without and with external poses.
#[inline(never)]
pub fn ticks(meter: &mut Meter) {
    for fixes in [false, true] {
        let Ok(base) = mission::base(fixes) else {
            return complain(&["base"], "params", 1);
        };
        let (mut follow, mut park, mut with_fix) = (Row::new(), Row::new(), Row::new());
        let driven = mission::drive(&BEND, &base, TICKS, |controller, tick| {
            let cost = meter
                .measure(|| {
                    controller.tick(tick.dt_us, &tick.order, &tick.sensed);
                })
                .1;
            match (&tick.order, &tick.sensed.fix) {
                (_, Some(_)) => with_fix.add(cost),
                (Order::Park(_), None) => park.add(cost),
                _ => follow.add(cost),
            }
        });
        complain(&["base"], "faults", u32::from(driven.is_err()));
        if fixes {
            follow.print(&["base", "follow-fused"]);
            park.print(&["base", "park-fused"]);
            with_fix.print(&["base", "with-fix"]);
        } else {
            follow.print(&["base", "follow"]);
            park.print(&["base", "park"]);
        }
    }
}

/// The motion law alone, from a measured pose and twist.
#[inline(never)]
pub fn motion(meter: &mut Meter) {
    let Ok(base) = route::base() else {
        return complain(&["motion"], "params", 1);
    };
    let (mut follow, mut park) = (Row::new(), Row::new());
    let driven = route::drive(&BEND, &base, TICKS, |controller, dt, task, measured| {
        let (result, cost) = meter.measure(|| controller.step(dt, task, measured).map(|_| ()));
        match task {
            Task::Follow(_) => follow.add(cost),
            Task::Park(_) => park.add(cost),
            // On no route.
            Task::Drive { .. } => {}
        }
        result
    });
    complain(&["motion"], "faults", u32::from(driven.is_err()));
    follow.print(&["motion", "follow"]);
    park.print(&["motion", "park"]);
}
