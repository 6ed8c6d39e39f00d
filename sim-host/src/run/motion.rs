//! The default law in the loop, in the precision of a mission.

use super::law::{Acted, Computed, Law};
use crate::controller_port::ControllerPortError;
use crate::mission::{BaseSpec, Orders};
use crate::precision::Precision;
use controller_core::angle::wrap;
use controller_core::error::ParamError;
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{Arrival, MotionController, MotionParams, Task, ValidMotionParams};
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::RationalMean;
use controller_core::types::{Measured, Pose, Twist, Wrench};

/// A [`MotionController`] with `f64` on its outside.
///
/// Positions reach the controller relative to an origin, so that a map far from (0, 0) costs no digits, and headings
/// within (−π, π].
pub(crate) struct MotionLaw<T, M> {
    motion: ValidMotionParams<T>,
    /// The first task's place, once there is one.
    origin: Option<(f64, f64)>,
    controller: Option<MotionController<T, M, RationalMean>>,
}

/// The default law on a base: single precision runs with [`Single`], as on a chip; double with [`Libm`].
pub(crate) fn motion_law(
    base: &BaseSpec,
    precision: Precision,
) -> Result<Box<dyn Law>, ParamError> {
    Ok(match precision {
        Precision::F32 => Box::new(MotionLaw::<f32, Single>::new(parameters::<_, Single>(
            base,
        )?)),
        Precision::F64 => Box::new(MotionLaw::<f64, Libm>::new(parameters::<_, Libm>(base)?)),
    })
}

impl<T: Scalar, M: Maths<T>> MotionLaw<T, M> {
    pub(crate) fn new(motion: ValidMotionParams<T>) -> Self {
        Self {
            motion,
            origin: None,
            controller: None,
        }
    }
}

impl<T: Scalar, M: Maths<T>> Law for MotionLaw<T, M> {
    fn tick(&mut self, dt: f64, orders: &Orders) -> Result<Acted, ControllerPortError> {
        let origin = *self.origin.get_or_insert_with(|| {
            let pose = match &orders.task {
                Task::Follow(reference) => *reference.pose(),
                Task::Park(goal) => *goal,
                Task::Drive { .. } => orders.measured.pose,
            };
            (pose.x, pose.y)
        });
        let task = near_task::<T, M>(&orders.task, origin);
        let measured = Measured {
            pose: near(&orders.measured.pose, origin).cast(),
            twist: orders.measured.twist.cast(),
        };
        let mut hand_over_step = None;
        let report = match &mut self.controller {
            None => {
                let started = MotionController::start(&self.motion, &task, &measured)?;
                self.controller.insert(started).report()
            }
            Some(controller) => {
                if orders.jumped {
                    controller.declare_jump();
                }
                let dt = T::from_f64(dt);
                // The controller of the last tick, to ask what it would have done.
                let before = orders.left.map(|(left, _)| (left, *controller));
                let report = controller.step(dt, &task, &measured)?;
                if let Some((left, mut before)) = before {
                    let left = near_task::<T, M>(&Task::Follow(left), origin);
                    let followed: Wrench<f64> = before.step(dt, &left, &measured)?.wrench.cast();
                    let parks: Wrench<f64> = report.wrench.cast();
                    hand_over_step = Some(Wrench {
                        force: parks.force - followed.force,
                        moment: parks.moment - followed.moment,
                    });
                }
                report
            }
        };
        Ok(Acted {
            torques: report.torques.cast(),
            outcome: report.outcome,
            hand_over_step,
        })
    }

    fn computed(&self) -> Computed {
        let controller = self.controller.as_ref();
        controller.map_or_else(Computed::default, |controller| Computed {
            report: controller.report().cast(),
            paper: None,
        })
    }

    fn command(&self) -> Twist<f64> {
        let controller = self.controller.as_ref();
        controller.map_or(Twist::default(), |c| c.report().command.cast())
    }

    /// See [`ValidMotionParams::hand_over_distance`].
    fn hand_over_distance(&self, speed: f64) -> f64 {
        self.motion.hand_over_distance(T::from_f64(speed)).to_f64()
    }
}

fn parameters<T: Scalar, M: Maths<T>>(base: &BaseSpec) -> Result<ValidMotionParams<T>, ParamError> {
    let from = base.motion();
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

fn near_task<T: Scalar, M: Maths<T>>(task: &Task<f64>, origin: (f64, f64)) -> Task<T> {
    match task {
        Task::Follow(reference) => Task::Follow(Reference::new_with::<M>(
            near(reference.pose(), origin).cast(),
            reference.twist().cast(),
            reference.accel().cast(),
        )),
        Task::Park(goal) => Task::Park(near(goal, origin).cast()),
        Task::Drive { .. } => task.cast_with::<T, M>(),
    }
}
