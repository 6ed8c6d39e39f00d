//! The laws that are compared, and their course.

use super::condition::Disturbance;
use super::{Case, StudyError};
use crate::mission::{BaseSpec, Course, Mission, When};
use crate::precision::Precision;
use crate::run::{Law, MotionLaw};
use crate::scenario::{BuiltIn, MathsBackEnd, PAPER, Scenario};
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::MotionParams;
use controller_core::scalar::Scalar;

/// Who drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ComparedLaw {
    /// The paper's, Eqs. (15)-(23).
    Neural,
    /// Backstepping without neurons, Eqs. (10)-(14).
    Plain,
    /// The default for a base, [`controller_core::motion`].
    Default,
}

impl ComparedLaw {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 3] = [Self::Neural, Self::Plain, Self::Default];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Neural => "neural",
            Self::Plain => "plain",
            Self::Default => "default",
        }
    }
}

/// A case as a scenario for the paper's laws.
pub(super) fn scenario(case: Case, disturbance: &Disturbance) -> Result<Scenario, StudyError> {
    let missing = || StudyError::Missing(case.name());
    let name = match case {
        Case::Line => PAPER[0],
        Case::Curve => PAPER[1],
    };
    let built_in = BuiltIn::find(name).ok_or_else(missing)?;
    let mut scenario = built_in.scenario()?;
    scenario.period_s = disturbance.period_s;
    scenario.duration_s = disturbance.duration_s;
    scenario.controller.precision = disturbance.precision;
    if disturbance.precision == Precision::F32 {
        scenario.controller.maths = MathsBackEnd::Single;
    }
    Ok(scenario)
}

/// The default law hands over by its own rule.
pub(super) fn hand_over_by_distance(mission: &mut Mission) {
    if let Course::Follow {
        hand_over: Some(rule),
        ..
    } = &mut mission.course
    {
        rule.end_s = TARGET_AT_S;
        rule.when = When::Distance;
    }
}

/// N of both cases \[s\].
const TARGET_AT_S: f64 = 10.0;

/// The base as the default law knows it: [`BaseSpec::default`], within the saturation if there is
/// one.
///
/// Wheels that can exert force and moment at the same time need r (F/2 + N/l) each, which is the
/// limit given. 85 % of force and moment go into the accelerations, as for every base here; the rest
/// is for feedback. A jerk of 20 times the acceleration is below what the base has without limit.
pub fn base_with_limits(disturbance: &Disturbance) -> BaseSpec {
    let mut base = BaseSpec::default();
    let Some(saturation) = disturbance.saturation else {
        return base;
    };
    let (robot, limits) = (&base.robot, &mut base.limits);
    let wheels = &robot.wheels;
    let both = 0.5 * saturation.force + saturation.moment / wheels.track_m;
    let along = COMMANDED * saturation.force / robot.mass_kg;
    let about = COMMANDED * saturation.moment / robot.inertia_kg_m2;
    limits.wheel_torque_nm = limits.wheel_torque_nm.min(wheels.radius_right_m * both);
    limits.accel = limits.accel.min(along);
    limits.brake = limits.brake.min(along);
    limits.turn_accel = limits.turn_accel.min(about);
    limits.jerk = limits.jerk.min(20.0 * along);
    limits.turn_jerk = limits.turn_jerk.min(20.0 * about);
    base
}

/// The share of force and moment that commands may ask for.
const COMMANDED: f64 = 0.85;

/// The default law, in the precision asked for.
pub(super) fn default_law(
    mission: &Mission,
    disturbance: &Disturbance,
) -> Result<Box<dyn Law>, StudyError> {
    match disturbance.precision {
        Precision::F64 => with_pose_noise::<f64, Libm>(mission, disturbance),
        Precision::F32 => with_pose_noise::<f32, Single>(mission, disturbance),
    }
}

/// It knows what an owner knows, the period and the noise of poses; nothing of latency, friction or wrong masses.
fn with_pose_noise<T: Scalar, M: Maths<T> + 'static>(
    mission: &Mission,
    disturbance: &Disturbance,
) -> Result<Box<dyn Law>, StudyError> {
    let robot = mission.base.robot.cast();
    let limits = mission.base.limits.cast();
    let sigma = T::from_f64(disturbance.position_noise_m);
    let period_s = T::from_f64(disturbance.period_s);
    let params = MotionParams::for_period::<M>(robot, limits, period_s).with_pose_noise(sigma);
    Ok(Box::new(MotionLaw::<T, M>::new(params.validate()?)))
}
