//! Ticks of the robots of `bases/` as they are shipped: each in its own period, with its poses and its supply, from encoder counts to the
//! duties of both motors.

use core::hint::black_box;

use controller_core::base::{BaseController, Order, Sensed, WheelAction};
use controller_core::localiser::Fix;
use controller_core::maths::{Maths, Single};
use controller_core::motor::Motor;
use controller_core::paper::params::Params;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{Event, State};
use controller_core::types::{Accel, Measured, Pose, Twist};
use firmware_demo::board::Meter;
use firmware_demo::mission::Encoders;
use firmware_demo::model::Model;
use firmware_demo::robots::{HOBBY_1KG, LAB_10KG, PAPER_30KG, RobotConstants};

use crate::base::{SEARCH_S, stands};
use crate::print::{Row, complain};

/// How long each order is given \[s\]: a curve and its end, a goal aside, a twist.
const CURVE_S: f32 = 5.0;
const GOAL_S: f32 = 8.0;
const TWIST_S: f32 = 2.0;
/// Curvature of the curve \[1/m\].
const CURVATURE: f32 = 0.8;

/// What is counted, over all robots.
struct Rows {
    follow: Row,
    plan: Row,
    park: Row,
    velocity: Row,
    with_fix: Row,
}

/// A curve from rest to rest with half of the base's speed and acceleration.
struct Curve {
    twist: Twist<f32>,
    pose: Pose<f32>,
    left_m: f32,
    most: f32,
    accel: f32,
}

impl Curve {
    fn new(speed: f32, accel: f32) -> Self {
        let (most, accel) = (0.5 * speed, 0.5 * accel);
        Self {
            twist: Twist::default(),
            pose: Pose::default(),
            // Up, 1.5 s of it, and down.
            left_m: most * (most / accel + 1.5),
            most,
            accel,
        }
    }

    /// After another `dt` \[s\].
    fn advance(&mut self, dt: f32) -> Reference<f32> {
        let v = self.twist.linear;
        let brakes = v * v >= 2.0 * self.accel * self.left_m;
        let target = if brakes {
            (v - self.accel * dt).max(0.0)
        } else {
            (v + self.accel * dt).min(self.most)
        };
        let accel = (target - v) / dt;
        let way = 0.5 * dt * (v + target);
        let heading = self.pose.theta + 0.5 * CURVATURE * way;
        let (sine, cosine) = Single::sin_cos(heading);
        self.pose.x += way * cosine;
        self.pose.y += way * sine;
        self.pose.theta += CURVATURE * way;
        self.left_m = (self.left_m - way).max(0.0);
        self.twist = Twist::new(target, CURVATURE * target);
        Reference::new(self.pose, self.twist, Accel::new(accel, CURVATURE * accel))
            .with_left(self.left_m)
    }
}

/// Most and mean of all shipped robots, by what they do.
#[inline(never)]
pub fn ticks(meter: &mut Meter) {
    let mut rows = Rows {
        follow: Row::new(),
        plan: Row::new(),
        park: Row::new(),
        velocity: Row::new(),
        with_fix: Row::new(),
    };
    let mut amiss = 0;
    for robot in [&PAPER_30KG, &LAB_10KG, &HOBBY_1KG] {
        amiss += u32::from(mission(robot, meter, &mut rows).is_none());
    }
    complain(&["shipped"], "robots", amiss);
    rows.follow.print(&["shipped", "follow"]);
    rows.plan.print(&["shipped", "plan"]);
    rows.park.print(&["shipped", "park"]);
    rows.velocity.print(&["shipped", "velocity"]);
    rows.with_fix.print(&["shipped", "with-fix"]);
}

/// One robot follows, parks and drives by velocity; `None` if it does not do as it is ordered.
fn mission(robot: &RobotConstants, meter: &mut Meter, rows: &mut Rows) -> Option<()> {
    let params = robot.base.validate().ok()?;
    let motor = params.motor()?;
    let limits = &robot.base.motion.limits;
    let pose_us = (1.0e6 / robot.base.localiser.fusion?.rate_hz) as u32;
    let dt_us = robot.period_us;
    let dt = 1.0e-6 * dt_us as f32;
    let body = Params::<f32> {
        robot: robot.base.motion.robot,
        ..Params::paper()
    };
    let mut model = Model::new(body.validate().ok()?, Measured::default());
    let mut controller: BaseController = BaseController::new(&params, Pose::default());
    let mut encoders = Encoders::new(robot.base.localiser.odometry.counts_per_turn);
    let mut curve = Curve::new(limits.speed, limits.accel);
    let ticks = |s: f32| (s / dt) as u32;
    let [curve_ends, goal_ends, twist_ends] = [
        ticks(CURVE_S),
        ticks(CURVE_S + GOAL_S),
        ticks(CURVE_S + GOAL_S + TWIST_S),
    ];
    let _ = controller.on(Event::Arm);
    for tick in 0..twist_ends {
        model.act(dt, &controller.report().action);
        let counts = encoders.advance(dt, &model);
        let fix = (tick * dt_us).is_multiple_of(pose_us).then(|| Fix {
            pose: model.measured().pose,
            age_s: 0.0,
        });
        let sensed = black_box(Sensed {
            fix,
            supply_v: Some(robot.base.driver.motor()?.supply_v),
            ..Sensed::of_counts(counts)
        });
        let order = black_box(if tick < curve_ends {
            Order::Follow(curve.advance(dt))
        } else if tick < goal_ends {
            Order::Park(Pose::new(
                curve.pose.x - 0.4,
                curve.pose.y + 0.3,
                curve.pose.theta + 1.0,
            ))
        } else {
            Order::Drive {
                twist: Twist::new(0.4 * limits.speed, 0.2 * limits.turn_rate),
                hold_heading: false,
            }
        });
        let cost = meter
            .measure(|| black_box(duties(&mut controller, dt_us, &order, &sensed, motor)))
            .1;
        let report = controller.report();
        let begins = tick < curve_ends + ticks(SEARCH_S);
        let searches = matches!(order, Order::Park(_))
            && (begins || report.motion.as_ref().is_some_and(stands));
        let row = match order {
            _ if searches => &mut rows.plan,
            _ if fix.is_some() => &mut rows.with_fix,
            Order::Follow(_) => &mut rows.follow,
            Order::Park(_) => &mut rows.park,
            _ => &mut rows.velocity,
        };
        row.add(cost);
        if report.refused || (tick + 1 == goal_ends && report.state != State::Parked) {
            return None;
        }
    }
    Some(())
}

/// A tick as a driver of motors on bridges makes it.
#[inline(never)]
fn duties(
    controller: &mut BaseController,
    dt_us: u32,
    order: &Order<f32>,
    sensed: &Sensed<f32>,
    motor: &Motor<f32>,
) -> [f32; 2] {
    controller.tick(dt_us, order, sensed);
    let WheelAction::Drive(drive) = &controller.report().action else {
        return [0.0; 2];
    };
    let commands = motor.commands(&drive.torques, &drive.observed(sensed.supply_v));
    if let Some(exerted) = commands.exerted() {
        let _ = controller.note_exerted(&exerted);
    }
    [commands.right.duty, commands.left.duty]
}
