//! The laws that are compared, behind one call per tick.

use super::condition::Disturbance;
use super::{Case, StudyError};
use crate::controller_port::{self, ControllerPort};
use crate::mission::{BaseSpec, Course, Mission, When};
use crate::precision::Precision;
use crate::run::Sequencer;
use crate::scenario::{self, BuiltIn, MathsBackEnd, PAPER, Scenario};
use controller_core::paper::demand::Demand;
use controller_core::reference::Reference;
use controller_core::types::{Measured, WheelTorques};

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

/// What a law makes of a tick.
pub(super) struct LawOutput {
    pub(super) torques: WheelTorques<f64>,
    /// Where the robot is to be: the moving reference, then the goal.
    pub(super) target: Reference<f64>,
    /// The goal is the target.
    pub(super) parking: bool,
}

/// A law at work, once a tick, beginning at tick 0. `None`: the controller refuses to go on.
pub(super) trait LawUnderTest {
    fn tick(&mut self, tick: usize, measured: &Measured<f64>) -> Option<LawOutput>;
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

/// The same case for the default law, which hands over by its own rule.
pub(super) fn mission(scenario: &Scenario, disturbance: &Disturbance) -> Mission {
    let mut mission = scenario.mission(base_with_limits(disturbance));
    if let Course::Follow {
        hand_over: Some(rule),
        ..
    } = &mut mission.course
    {
        rule.end_s = TARGET_AT_S;
        rule.when = When::Distance;
    }
    mission
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

/// A law of the paper.
pub(super) struct PaperLaw {
    period_s: f64,
    sequencer: Sequencer,
    controller: Box<dyn ControllerPort>,
    parking: bool,
}

impl PaperLaw {
    pub(super) fn new(scenario: &Scenario, law: scenario::ControlLaw) -> Result<Self, StudyError> {
        Ok(Self {
            period_s: scenario.period_s,
            sequencer: Sequencer::new(scenario),
            controller: controller_port::for_scenario(&scenario.with_law(law))?,
            parking: false,
        })
    }
}

impl LawUnderTest for PaperLaw {
    fn tick(&mut self, tick: usize, measured: &Measured<f64>) -> Option<LawOutput> {
        let dt = self.period_s;
        let (demand, target) = self.sequencer.at(tick, tick as f64 * dt);
        let answer = match (tick, &demand) {
            (0, Demand::Track(reference)) => self.controller.start(reference, measured),
            _ => self.controller.step(dt, &demand, measured),
        };
        self.parking |= matches!(demand, Demand::HandOver { .. });
        Some(LawOutput {
            torques: answer.ok()?.report.torques,
            target,
            parking: self.parking,
        })
    }
}
