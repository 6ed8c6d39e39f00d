//! The default law, which knows the noise of its poses.

use super::StudyError;
use super::condition::Disturbance;
use super::law::{LawOutput, LawUnderTest};
use crate::mission::{Mission, Sequencer};
use crate::precision::Precision;
use controller_core::error::ParamError;
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{MotionController, MotionParams, Task, ValidMotionParams};
use controller_core::scalar::Scalar;
use controller_core::shunting::RationalMean;
use controller_core::types::{Measured, Twist};

/// A [`MotionController`] on a mission.
pub(super) struct DefaultLaw<'a, T, M> {
    period_s: f64,
    sequencer: Sequencer<'a>,
    motion: ValidMotionParams<T>,
    controller: Option<MotionController<T, M, RationalMean>>,
}

impl<'a, T: Scalar, M: Maths<T>> DefaultLaw<'a, T, M> {
    pub(super) fn new(mission: &'a Mission, disturbance: &Disturbance) -> Result<Self, ParamError> {
        let robot = mission.base.robot.cast();
        let limits = mission.base.limits.cast();
        // It knows what an owner knows, the noise of poses; nothing of latency, friction or wrong masses.
        let sigma = T::from_f64(disturbance.position_noise_m);
        let params = MotionParams::new_with::<M>(robot, limits).with_pose_noise(sigma);
        Ok(Self {
            period_s: mission.period_s,
            sequencer: Sequencer::new(mission),
            motion: params.validate()?,
            controller: None,
        })
    }
}

impl<T: Scalar, M: Maths<T>> LawUnderTest for DefaultLaw<'_, T, M> {
    fn tick(&mut self, tick: usize, measured: &Measured<f64>) -> Option<LawOutput> {
        let dt = self.period_s;
        let command = self
            .controller
            .as_ref()
            .map_or(Twist::default(), |c| c.report().command.cast());
        let motion = &self.motion;
        let distance = |speed| motion.hand_over_distance(T::from_f64(speed)).to_f64();
        let orders = self
            .sequencer
            .at(tick, tick as f64 * dt, measured, &command, distance);
        let task = orders.task.cast_with::<T, M>();
        let measured = orders.measured.cast();
        let report = match &mut self.controller {
            None => {
                let started = MotionController::start(motion, &task, &measured).ok()?;
                *self.controller.insert(started).report()
            }
            Some(controller) => *controller.step(T::from_f64(dt), &task, &measured).ok()?,
        };
        Some(LawOutput {
            torques: report.torques.cast(),
            target: orders.target,
            parking: matches!(task, Task::Park(_)),
        })
    }
}

/// The default law, in the precision asked for.
pub(super) fn default_law<'a>(
    mission: &'a Mission,
    disturbance: &Disturbance,
) -> Result<Box<dyn LawUnderTest + 'a>, StudyError> {
    Ok(match disturbance.precision {
        Precision::F64 => Box::new(DefaultLaw::<f64, Libm>::new(mission, disturbance)?),
        Precision::F32 => Box::new(DefaultLaw::<f32, Single>::new(mission, disturbance)?),
    })
}
