//! A trajectory in flash, followed and parked at by a whole base: from encoder counts to wheel torques.

use controller_core::base::{
    BaseController, BaseError, BaseParams, Order, Sensed, ValidBaseParams,
};
use controller_core::error::StepFault;
use controller_core::hal::WheelCounts;
use controller_core::localiser::{Fix, FusionParams, LocaliserParams};
use controller_core::maths::{Maths, Single};
use controller_core::motion::{Limits, Remaining};
use controller_core::motor::DriverParams;
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::paper::params::{Params, ValidParams};
use controller_core::robot::Robot;
use controller_core::safety::supervisor::{Action, Event, State};
use controller_core::types::{Measured, Pose};

use crate::model::Model;
use crate::route::{Driven, Route, limits};

/// Counts a turn of the model's encoders: 0.3 mm of the way of a wheel of 0.1 m.
pub const COUNTS_PER_TURN: f32 = 2048.0;
/// Control period \[us\].
pub const PERIOD_US: u32 = 1000;

/// Encoders of a model: whole counts of what its wheels have turned.
#[derive(Clone, Copy, Debug)]
pub struct Encoders {
    per_rad: f32,
    right_rad: f32,
    left_rad: f32,
}

impl Default for Encoders {
    fn default() -> Self {
        Self::new(COUNTS_PER_TURN)
    }
}

impl Encoders {
    /// Of so many counts a turn of the wheel.
    pub const fn new(counts_per_turn: f32) -> Self {
        Self {
            per_rad: counts_per_turn / core::f32::consts::TAU,
            right_rad: 0.0,
            left_rad: 0.0,
        }
    }

    /// Counts after `dt` \[s\] at the model's present speed.
    pub fn advance(&mut self, dt: f32, model: &Model) -> WheelCounts {
        let speeds = model.wheel_speeds();
        self.right_rad += dt * speeds.right;
        self.left_rad += dt * speeds.left;
        WheelCounts {
            right: whole(self.per_rad * self.right_rad),
            left: whole(self.per_rad * self.left_rad),
        }
    }
}

fn whole(counts: f32) -> i32 {
    let towards_zero = counts as i32;
    // Rounded down, as a counter of edges does.
    towards_zero.wrapping_sub(i32::from(counts < towards_zero as f32))
}

/// The 30 kg base of [`crate::route::base`] with encoders, wheels of this torque, and external poses if `fixes` says so.
///
/// # Errors
/// None of its own: what the core says of the parameters.
pub fn params(wheel_torque_nm: f32, fixes: bool) -> Result<BaseParams<f32>, BaseError> {
    let robot = Robot::<f32>::paper();
    let localiser = LocaliserParams {
        odometry: OdometryParams {
            wheels: robot.wheels,
            calibration: Calibration::NOMINAL,
            counts_per_turn: COUNTS_PER_TURN,
            bandwidth: 50.0,
        },
        // A camera or a beacon: 5 mm, 5 mrad, 20 times a second.
        fusion: fixes.then(|| FusionParams::for_source(5.0e-3, 5.0e-3, 20.0)),
        gyro: None,
    };
    Ok(BaseParams::new(
        robot,
        Limits {
            wheel_torque_nm,
            ..limits()
        },
        localiser,
        DriverParams::Torques,
        PERIOD_US,
    )?)
}

/// A base and the model of its body.
///
/// # Errors
/// Those of [`params`].
pub fn base(fixes: bool) -> Result<(ValidBaseParams<f32>, ValidParams<f32>), BaseError> {
    let base = params(limits().wheel_torque_nm, fixes)?.validate()?;
    Ok((base, Params::<f32>::paper().validate()?))
}

/// What a base does in one tick of [`drive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Since the last tick \[us\].
    pub dt_us: u32,
    /// Follow or park.
    pub order: Order<f32>,
    /// Counts, and a fix in every fiftieth tick if the base takes fixes.
    pub sensed: Sensed<f32>,
}

/// Drives a route at 1 kHz for `ticks`, starting 0.15 m to the left of it: whole counts in, torques out. `step` makes each
/// control tick; it may count what that costs.
///
/// # Errors
/// [`StepFault::WrongPhase`] if the base refuses to be armed or an order: its state does not fit.
pub fn drive(
    route: &Route,
    (base, body): &(ValidBaseParams<f32>, ValidParams<f32>),
    ticks: u32,
    mut step: impl FnMut(&mut BaseController, &Tick),
) -> Result<Driven, StepFault> {
    const DT: f32 = PERIOD_US as f32 * 1.0e-6;
    let mut driven = Driven::NONE;
    let (Some(first), Some(goal)) = (route.at(0.0), route.goal()) else {
        return Ok(driven);
    };
    let start = Pose {
        y: first.pose().y + 0.15,
        ..*first.pose()
    };
    let mut robot = Model::new(
        *body,
        Measured {
            pose: start,
            ..Measured::default()
        },
    );
    let fused = base.localisation().params().fusion.is_some();
    let mut encoders = Encoders::default();
    let mut controller: BaseController = BaseController::new(base, start);
    if controller.on(Event::Arm) == Action::Refuse {
        return Err(StepFault::WrongPhase);
    }
    let mut parking = false;
    for tick in 1..=ticks {
        robot.act(DT, &controller.report().action);
        let counts = encoders.advance(DT, &robot);
        let t = tick as f32 * DT;
        let order = match route.at(t) {
            Some(reference) if !parking => {
                let report = controller.report();
                let command = report.motion.map(|motion| motion.command);
                let remaining = Remaining {
                    path_m: distance(&report.measured.unwrap_or_default().pose, &goal),
                    turn_rad: 0.0,
                };
                let law = base.motion();
                parking = tick > 1
                    && law.parking_is_due::<Single>(&remaining, &command.unwrap_or_default());
                if parking {
                    driven.handed_over = tick;
                    Order::Park(goal)
                } else {
                    Order::Follow(reference)
                }
            }
            _ => Order::Park(goal),
        };
        let fix = (fused && tick.is_multiple_of(50)).then(|| Fix {
            pose: robot.measured().pose,
            age_s: 0.0,
        });
        let sensed = Sensed {
            fix,
            ..Sensed::of_counts(counts)
        };
        step(
            &mut controller,
            &Tick {
                dt_us: PERIOD_US,
                order,
                sensed,
            },
        );
        let report = controller.report();
        if report.refused {
            return Err(StepFault::WrongPhase);
        }
        let torques = report.action.torques().unwrap_or_default();
        let measured = report.measured.unwrap_or_default();
        for value in [
            torques.right,
            torques.left,
            measured.pose.x,
            measured.pose.y,
            measured.pose.theta,
            measured.twist.linear,
            measured.twist.angular,
        ] {
            driven.sum(value);
        }
        driven.sum(f32::from_bits(counts.right as u32));
        driven.stay(tick, report.state == State::Parked);
    }
    driven.off_m = distance(&robot.measured().pose, &goal);
    Ok(driven)
}

fn distance(a: &Pose<f32>, b: &Pose<f32>) -> f32 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    Single::sqrt(dx * dx + dy * dy)
}
