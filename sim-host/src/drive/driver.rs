//! The controller, in the precision of a mission.

use crate::mission::BaseSpec;
use crate::precision::Precision;
use controller_core::angle::wrap;
use controller_core::error::{ParamError, StepFault};
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{
    Arrival, MotionController, MotionParams, MotionReport, Task, ValidMotionParams,
};
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::RationalMean;
use controller_core::types::{Measured, Pose};

/// A [`MotionController`] with `f64` on its outside.
///
/// Single precision runs with [`Single`], as on a chip; double with [`Libm`]. Positions reach the
/// controller relative to an origin, so that a map far from (0, 0) costs no digits, and headings
/// within (−π, π].
#[derive(Clone, Copy, Debug)]
pub struct Driver {
    origin: (f64, f64),
    inner: Inner,
}

// One per run: the size of the larger one is of no concern.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
enum Inner {
    Single(MotionController<f32, Single, RationalMean>),
    Double(MotionController<f64, Libm, RationalMean>),
}

impl Driver {
    /// Starts a controller; the first report is the start's.
    ///
    /// # Errors
    /// Parameters that are out of range in the precision asked for, or inputs that are not finite.
    pub fn start(
        base: &BaseSpec,
        precision: Precision,
        task: &Task<f64>,
        measured: &Measured<f64>,
    ) -> Result<Self, StartError> {
        let pose = match task {
            Task::Follow(reference) => *reference.pose(),
            Task::Park(goal) => *goal,
        };
        let origin = (pose.x, pose.y);
        let inner = match precision {
            Precision::F32 => Inner::Single(start(base, origin, task, measured)?),
            Precision::F64 => Inner::Double(start(base, origin, task, measured)?),
        };
        Ok(Self { origin, inner })
    }

    /// One tick.
    ///
    /// # Errors
    /// The controller's.
    pub fn step(
        &mut self,
        dt: f64,
        task: &Task<f64>,
        measured: &Measured<f64>,
    ) -> Result<MotionReport<f64>, StepFault> {
        let origin = self.origin;
        match &mut self.inner {
            Inner::Single(controller) => step(controller, origin, dt, task, measured),
            Inner::Double(controller) => step(controller, origin, dt, task, measured),
        }
    }

    /// Tells the controller of a jump of the next pose.
    pub fn declare_jump(&mut self) {
        match &mut self.inner {
            Inner::Single(controller) => controller.declare_jump(),
            Inner::Double(controller) => controller.declare_jump(),
        }
    }

    /// The report of the last tick.
    pub fn report(&self) -> MotionReport<f64> {
        match &self.inner {
            Inner::Single(controller) => controller.report().cast(),
            Inner::Double(controller) => controller.report().cast(),
        }
    }

    /// See [`ValidMotionParams::hand_over_distance`].
    pub fn hand_over_distance(&self, speed: f64) -> f64 {
        match &self.inner {
            Inner::Single(c) => f64::from(c.motion().hand_over_distance(speed as f32)),
            Inner::Double(c) => c.motion().hand_over_distance(speed),
        }
    }
}

/// Why a controller does not start.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StartError {
    /// A parameter.
    #[error("{0}")]
    Params(ParamError),
    /// An input.
    #[error("{0}")]
    Fault(StepFault),
}

type Controller<T, M> = MotionController<T, M, RationalMean>;

fn start<T: Scalar, M: Maths<T>>(
    base: &BaseSpec,
    origin: (f64, f64),
    task: &Task<f64>,
    measured: &Measured<f64>,
) -> Result<Controller<T, M>, StartError> {
    let motion = parameters::<T, M>(&base.motion()).map_err(StartError::Params)?;
    let task = near_task::<T, M>(task, origin);
    let measured = near_measured(measured, origin);
    MotionController::start(&motion, &task, &measured).map_err(StartError::Fault)
}

fn step<T: Scalar, M: Maths<T>>(
    controller: &mut Controller<T, M>,
    origin: (f64, f64),
    dt: f64,
    task: &Task<f64>,
    measured: &Measured<f64>,
) -> Result<MotionReport<f64>, StepFault> {
    let task = near_task::<T, M>(task, origin);
    let measured = near_measured(measured, origin);
    controller
        .step(T::from_f64(dt), &task, &measured)
        .map(MotionReport::cast)
}

fn parameters<T: Scalar, M: Maths<T>>(
    from: &MotionParams<f64>,
) -> Result<ValidMotionParams<T>, ParamError> {
    let params = MotionParams {
        gains: from.gains.cast(),
        arrival: Arrival::exact(),
        ..MotionParams::new_with::<M>(from.robot.cast(), from.limits.cast())
    };
    params.validate()
}

/// With the origin near the robot, where singles are finest.
fn near(pose: &Pose<f64>, origin: (f64, f64)) -> Pose<f64> {
    Pose::new(pose.x - origin.0, pose.y - origin.1, wrap(pose.theta))
}

fn near_measured<T: Scalar>(measured: &Measured<f64>, origin: (f64, f64)) -> Measured<T> {
    Measured {
        pose: near(&measured.pose, origin).cast(),
        twist: measured.twist.cast(),
    }
}

fn near_task<T: Scalar, M: Maths<T>>(task: &Task<f64>, origin: (f64, f64)) -> Task<T> {
    match task {
        Task::Follow(reference) => Task::Follow(Reference::new_with::<M>(
            near(reference.pose(), origin).cast(),
            reference.twist().cast(),
            reference.accel().cast(),
        )),
        Task::Park(goal) => Task::Park(near(goal, origin).cast()),
    }
}
