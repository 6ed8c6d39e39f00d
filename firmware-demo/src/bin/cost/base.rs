//! The tick of a whole base, and of the motion law in it, on a mission: the route in flash, followed and parked at.

use core::hint::black_box;

use controller_core::base::{BaseController, Order};
use controller_core::maths::{Maths, Single};
use controller_core::motion::{MotionController, MotionReport, Outcome, PathEnd, Task};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Measured, Pose, Twist};
use firmware_demo::board::Meter;
use firmware_demo::mission;
use firmware_demo::model::Model;
use firmware_demo::route::{self, CURVE};

use crate::print::{Row, complain, line};
use crate::stack::mark;

/// The route, and time to park.
const TICKS: u32 = 14_000;

/// A search for a manoeuvre takes no longer \[s\].
pub const SEARCH_S: f32 = 0.35;

/// The same in ticks of a mission.
const SEARCH_TICKS: u32 = (1.0e6 * SEARCH_S) as u32 / mission::PERIOD_US;

/// Where a mission is.
enum Phase {
    First,
    Follow,
    /// A manoeuvre may be searched for.
    Search,
    Park,
}

/// A base that is not at its goal and commands nothing: it may search for a manoeuvre.
pub fn stands(motion: &MotionReport) -> bool {
    let Twist { linear, angular } = motion.command;
    motion.outcome == Outcome::Driving && linear.abs() < 0.005 && angular.abs() < 0.02
}

/// Ticks so far, and those of them that parked.
#[derive(Default)]
struct Phases {
    ticks: u32,
    parking: u32,
}

impl Phases {
    /// Of a tick that parks or not, and what the law reported of it. A search begins with parking, or from rest beside the goal.
    fn next(&mut self, parks: bool, motion: Option<&MotionReport>) -> Phase {
        let stands = motion.is_some_and(stands);
        self.ticks += 1;
        self.parking += u32::from(parks);
        match self.parking {
            _ if self.ticks == 1 => Phase::First,
            1..=SEARCH_TICKS if parks => Phase::Search,
            _ if parks && stands => Phase::Search,
            _ if parks => Phase::Park,
            _ => Phase::Follow,
        }
    }
}

/// From counts to torques, without and with external poses; apart, the first tick and those in which a manoeuvre may be searched for.
#[inline(never)]
pub fn ticks(meter: &mut Meter) {
    for fixes in [false, true] {
        let Ok(base) = mission::base(fixes) else {
            return complain(&["base"], "params", 1);
        };
        let (mut first, mut follow, mut with_fix) = (Row::new(), Row::new(), Row::new());
        let (mut plan, mut park, mut phases) = (Row::new(), Row::new(), Phases::default());
        let driven = mission::drive(&CURVE, &base, TICKS, |controller, tick| {
            let cost = meter
                .measure(|| {
                    controller.tick(tick.dt_us, &tick.order, &tick.sensed);
                })
                .1;
            let parks = matches!(tick.order, Order::Park(_));
            let phase = phases.next(parks, controller.report().motion.as_ref());
            match (phase, &tick.sensed.fix) {
                (Phase::First, _) => first.add(cost),
                (Phase::Search, _) => plan.add(cost),
                (_, Some(_)) => with_fix.add(cost),
                (Phase::Park, None) => park.add(cost),
                (Phase::Follow, None) => follow.add(cost),
            }
        });
        complain(&["base"], "faults", u32::from(driven.is_err()));
        if fixes {
            follow.print(&["base", "follow-fused"]);
            plan.print(&["base", "plan-fused"]);
            park.print(&["base", "park-fused"]);
            with_fix.print(&["base", "with-fix"]);
        } else {
            first.print(&["base", "first"]);
            follow.print(&["base", "follow"]);
            plan.print(&["base", "plan"]);
            park.print(&["base", "park"]);
        }
    }
}

/// Bytes: the controller itself, and the stack of its ticks, of which those that begin something are looked at.
#[inline(never)]
pub fn bytes() {
    line(&["ram", "base"])
        .number(size_of::<BaseController>() as u32)
        .print();
    let Ok(base) = mission::base(true) else {
        return complain(&["stack", "base"], "params", 1);
    };
    let empty = mark(|| ());
    let (mut most, mut ticks) = (0, 0_u32);
    let driven = mission::drive(&CURVE, &base, TICKS, |controller, tick| {
        ticks += 1;
        let parks = matches!(tick.order, Order::Park(_));
        let mut step = || {
            controller.tick(tick.dt_us, &tick.order, &tick.sensed);
        };
        // Looking takes as long as some ticks.
        if parks || ticks <= 100 || ticks % 500 == 0 {
            most = most.max(mark(step));
        } else {
            step();
        }
    });
    complain(&["stack", "base"], "faults", u32::from(driven.is_err()));
    line(&["stack", "base"])
        .number(most.saturating_sub(empty))
        .print();
}

/// The motion law alone, from a measured pose and twist.
#[inline(never)]
pub fn motion(meter: &mut Meter) {
    let Ok(base) = route::base() else {
        return complain(&["motion"], "params", 1);
    };
    let (mut follow, mut plan, mut park) = (Row::new(), Row::new(), Row::new());
    let mut phases = Phases::default();
    let driven = route::drive(&CURVE, &base, TICKS, |controller, dt, task, measured| {
        let (result, cost) = meter.measure(|| controller.step(dt, task, measured).map(|_| ()));
        let parks = matches!(task, Task::Park(_));
        match phases.next(parks, Some(controller.report())) {
            Phase::First | Phase::Follow => follow.add(cost),
            Phase::Search => plan.add(cost),
            Phase::Park => park.add(cost),
        }
        result
    });
    complain(&["motion"], "faults", u32::from(driven.is_err()));
    follow.print(&["motion", "follow"]);
    plan.print(&["motion", "plan"]);
    park.print(&["motion", "park"]);
}

/// Ticks of the motion law in which a manoeuvre may be searched for: to goals of 5 mm to 2 m all around, from rest and from motion, every
/// 1 and 10 ms. The longer a tick, the more of a search belongs to it.
#[inline(never)]
pub fn searches(meter: &mut Meter) {
    let Ok((base, robot)) = route::base() else {
        return complain(&["motion"], "params", 1);
    };
    let mut faults = 0;
    for (dt, name) in [(1.0e-3_f32, "search-1ms"), (1.0e-2, "search-10ms")] {
        let mut row = Row::new();
        let mut distance = 0.005_f32;
        for goal in 0..24_u8 {
            let angle = f32::from(goal);
            let moving = f32::from(goal % 3) - 1.0;
            let (sine, cosine) = Single::sin_cos(2.4 * angle);
            let goal = Pose::new(distance * cosine, distance * sine, 1.6 * angle);
            distance *= 1.3;
            let start = Measured {
                pose: Pose::default(),
                twist: Twist::new(0.5 * moving, 0.3 * moving),
            };
            let task = Task::Park(goal);
            let mut model = Model::new(robot, start);
            let Ok(mut controller) = MotionController::<f32>::start(&base, &task, &start) else {
                faults += 1;
                continue;
            };
            let mut t = 0.0;
            while t < SEARCH_S {
                t += dt;
                model.advance(dt, Some(controller.report().torques));
                let measured = *model.measured();
                let (result, cost) =
                    meter.measure(|| controller.step(dt, &task, &measured).map(|_| ()));
                faults += u32::from(result.is_err());
                row.add(cost);
            }
        }
        row.print(&["motion", name]);
    }
    complain(&["motion", "search"], "faults", faults);
}

/// A robot beside its path, braked from 0.6 m/s at 0.5 m/s² to its end: what leading it there adds to ticks.
#[inline(never)]
pub fn lead(meter: &mut Meter) {
    const SPEED: f32 = 0.6;
    const BRAKE: f32 = 0.5;
    const DT: f32 = 0.01;
    let Ok((base, _)) = route::base() else {
        return complain(&["motion", "lead"], "params", 1);
    };
    let beside = Pose::new(0.0, black_box(0.009), 0.0);
    let mut end = PathEnd::NEW;
    let mut row = Row::new();
    let mut led = 0_u32;
    for tick in 0..120 {
        let speed = SPEED - BRAKE * DT * tick as f32;
        let left = 0.5 * speed * speed / BRAKE;
        let at = Pose::new(-left, 0.0, 0.0);
        let reference = Reference::new(at, Twist::new(speed, 0.0), Accel::new(-BRAKE, 0.0));
        let mut reference = black_box(reference.with_left(left));
        let cost = meter
            .measure(|| end.lead::<Single>(&base, &mut reference, &beside, DT))
            .1;
        if reference.pose().y != 0.0 {
            led += 1;
            row.add(cost);
        }
    }
    complain(&["motion", "lead"], "led", u32::from(led == 0));
    row.print(&["motion", "lead"]);
}
