//! A trajectory in flash, followed and parked at by the law for a real base.

use controller_core::error::{ParamError, StepFault};
use controller_core::maths::Single;
use controller_core::motion::{
    Limits, MotionController, MotionParams, Outcome, Remaining, Task, ValidMotionParams,
};
use controller_core::paper::params::{Params, ValidParams};
use controller_core::queue::{TimedReference, interpolate};
use controller_core::reference::Reference;
use controller_core::types::{Accel, Measured, Pose, Twist};

use crate::model::Model;

#[path = "routes/curve.rs"]
mod curve;

/// Samples made by `sim-host compile`: t, x, y, θ, v, w, v̇, ẇ, what is left of the last drive.
#[derive(Clone, Copy, Debug)]
pub struct Route {
    samples: &'static [[f32; 9]],
}

/// Ten seconds, four metres, half a turn; for a 30 kg base.
pub const CURVE: Route = Route {
    samples: &curve::CURVE,
};

impl Route {
    /// The reference at `t` \[s\]: between samples by the core's interpolation, outside at rest at the
    /// ends. The work is bounded by the number of samples.
    pub fn at(&self, t: f32) -> Option<Reference<f32>> {
        let mut before: Option<&[f32; 9]> = None;
        for sample in self.samples {
            if sample[0] > t {
                return Some(match before {
                    Some(from) => interpolate::<f32, Single>(&timed(from), &timed(sample), t),
                    None => Reference::at_rest(pose(sample)),
                });
            }
            before = Some(sample);
        }
        before.map(|last| Reference::at_rest(pose(last)))
    }

    /// Where it ends; `None` for a route without samples.
    pub fn goal(&self) -> Option<Pose<f32>> {
        self.samples.last().map(pose)
    }
}

fn pose(&[_, x, y, theta, ..]: &[f32; 9]) -> Pose<f32> {
    Pose { x, y, theta }
}

fn timed(sample: &[f32; 9]) -> TimedReference<f32> {
    let &[t, _, _, _, v, w, v_rate, w_rate, left] = sample;
    TimedReference {
        t,
        reference: Reference::new(pose(sample), Twist::new(v, w), Accel::new(v_rate, w_rate))
            .with_left(left),
    }
}

/// The 30 kg base that [`CURVE`] was made for.
pub fn base() -> Result<(ValidMotionParams<f32>, ValidParams<f32>), ParamError> {
    let params = Params::<f32>::paper();
    let motion = MotionParams::new(params.robot, limits()).validate()?;
    Ok((motion, params.validate()?))
}

/// What that base can do.
pub(crate) fn limits() -> Limits<f32> {
    Limits::PAPER.cast()
}

/// What came of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// Control ticks.
    pub ticks: u32,
    /// The tick that handed over to parking; 0 if none did.
    pub handed_over: u32,
    /// The first tick of the last stay at the goal; 0 if it is not parked.
    pub parked: u32,
    /// A checksum over the bits of every torque, command and desired twist of every tick (FNV-1a).
    pub checksum: u32,
    /// How far from the goal the robot is in the end \[m\].
    pub off_m: f32,
}

impl Driven {
    /// Nothing yet.
    pub(crate) const NONE: Self = Self {
        ticks: 0,
        handed_over: 0,
        parked: 0,
        checksum: 0x811c_9dc5,
        off_m: 0.0,
    };

    /// Takes the bits of a value into the checksum.
    pub(crate) const fn sum(&mut self, value: f32) {
        self.checksum = (self.checksum ^ value.to_bits()).wrapping_mul(0x0100_0193);
    }

    /// Notes the end of a tick, and whether the robot is parked.
    pub(crate) const fn stay(&mut self, tick: u32, parked: bool) {
        if !parked {
            self.parked = 0;
        } else if self.parked == 0 {
            self.parked = tick;
        }
        self.ticks = tick;
    }
}

/// Drives a route at 1 kHz with the model robot, 0.15 m to the left of its start and at rest, for
/// `ticks`. `step` makes each control tick; it may count what that costs.
///
/// # Errors
/// The first fault of the controller.
pub fn drive(
    route: &Route,
    (motion, params): &(ValidMotionParams<f32>, ValidParams<f32>),
    ticks: u32,
    mut step: impl FnMut(
        &mut MotionController,
        f32,
        &Task<f32>,
        &Measured<f32>,
    ) -> Result<(), StepFault>,
) -> Result<Driven, StepFault> {
    const DT: f32 = 1.0e-3;
    let mut driven = Driven::NONE;
    let (Some(first), Some(goal)) = (route.at(0.0), route.goal()) else {
        return Ok(driven);
    };
    let start = Measured {
        pose: Pose {
            y: first.pose().y + 0.15,
            ..*first.pose()
        },
        twist: Twist::default(),
    };
    let mut robot = Model::new(*params, start);
    let mut task = Task::Follow(first);
    let mut controller: MotionController = MotionController::start(motion, &task, &start)?;
    for tick in 1..=ticks {
        robot.advance(DT, Some(controller.report().torques));
        let measured = *robot.measured();
        let t = tick as f32 * DT;
        if let (Task::Follow(_), Some(reference)) = (&task, route.at(t)) {
            let remaining = Remaining {
                path_m: distance(&measured.pose, &goal),
                turn_rad: 0.0,
            };
            task = if motion.parking_is_due::<Single>(&remaining, &controller.report().command) {
                driven.handed_over = tick;
                Task::Park(goal)
            } else {
                Task::Follow(reference)
            };
        }
        step(&mut controller, DT, &task, &measured)?;
        let report = controller.report();
        for value in [
            report.torques.right,
            report.torques.left,
            report.command.linear,
            report.command.angular,
            report.desired.linear,
            report.desired.angular,
        ] {
            driven.sum(value);
        }
        driven.stay(tick, report.outcome == Outcome::Parked);
    }
    driven.off_m = distance(&robot.measured().pose, &goal);
    Ok(driven)
}

fn distance(a: &Pose<f32>, b: &Pose<f32>) -> f32 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    controller_core::single::sqrt(dx * dx + dy * dy)
}
