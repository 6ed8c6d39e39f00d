//! A law in the loop, and the paper's as one.

use crate::controller_port::{Answer, ControllerPort, ControllerPortError};
use crate::mission::Orders;
use crate::trace::PaperTerms;
use controller_core::motion::{Limited, Mode, MotionReport, Outcome, Task};
use controller_core::paper::demand::Demand;
use controller_core::paper::report::{Phase, StepReport};
use controller_core::types::{Twist, WheelTorques, Wrench};

/// A control law, tick by tick. The first tick starts it.
pub(crate) trait Law {
    /// One tick, `dt` \[s\] after the last.
    fn tick(&mut self, dt: f64, orders: &Orders) -> Result<Acted, ControllerPortError>;

    /// All that it computed in the last tick. Most ticks of runs by the thousand do without.
    fn computed(&self) -> Computed;

    /// What it commanded last.
    fn command(&self) -> Twist<f64>;

    /// The distance \[m\] at which parking takes over from `speed` \[m/s\].
    fn hand_over_distance(&self, speed: f64) -> f64;
}

/// What the loop needs of a tick.
pub(crate) struct Acted {
    pub(crate) torques: WheelTorques<f64>,
    pub(crate) outcome: Outcome,
    /// What parking demands minus what following would have, if this tick handed over.
    pub(crate) hand_over_step: Option<Wrench<f64>>,
}

/// What a law computed in a tick.
#[derive(Default)]
pub(crate) struct Computed {
    pub(crate) report: MotionReport<f64>,
    pub(crate) paper: Option<PaperTerms>,
}

/// A law of the paper.
pub(crate) struct PaperLaw<'a> {
    controller: &'a mut dyn ControllerPort,
    /// What it answered last.
    answer: Option<Answer>,
}

impl<'a> PaperLaw<'a> {
    pub(crate) fn new(controller: &'a mut dyn ControllerPort) -> Self {
        Self {
            controller,
            answer: None,
        }
    }
}

impl Law for PaperLaw<'_> {
    fn tick(&mut self, dt: f64, orders: &Orders) -> Result<Acted, ControllerPortError> {
        let demand = match (orders.task, orders.left) {
            (Task::Park(goal), Some((reference, _))) => Demand::HandOver { reference, goal },
            (Task::Park(_), None) => Demand::Park,
            (Task::Follow(reference), _) => Demand::Track(reference),
            // They know references only.
            (Task::Drive { .. }, _) => Demand::Track(orders.target),
        };
        let measured = &orders.measured;
        let answer = match &demand {
            Demand::Track(reference) if self.answer.is_none() => {
                self.controller.start(reference, measured)
            }
            _ => self.controller.step(dt, &demand, measured),
        }?;
        self.answer = Some(answer);
        Ok(Acted {
            torques: answer.report.torques,
            outcome: Outcome::default(),
            hand_over_step: answer.hand_over_step,
        })
    }

    fn computed(&self) -> Computed {
        self.answer
            .map_or_else(Computed::default, |answer| Computed {
                report: common(&answer.report),
                paper: Some(PaperTerms {
                    neurons: answer.report.neurons,
                    relaxing: answer.relaxing,
                }),
            })
    }

    fn command(&self) -> Twist<f64> {
        self.answer
            .map_or_else(Twist::default, |answer| answer.report.command)
    }

    /// It parks at a time, not at a distance.
    fn hand_over_distance(&self, _: f64) -> f64 {
        0.0
    }
}

/// What the paper's report has in common with the default law's.
fn common(report: &StepReport<f64>) -> MotionReport<f64> {
    MotionReport {
        mode: match report.phase {
            Phase::Tracking => Mode::Following,
            Phase::Parking => Mode::Parking,
        },
        error: report.error,
        command: report.command,
        command_rate: report.command_rate,
        velocity_error: report.velocity_error,
        transition_offset: report.transition_offset,
        wrench: report.wrench,
        torques: report.torques,
        limited: Limited {
            torque: report.saturated,
            ..Limited::default()
        },
        ..MotionReport::default()
    }
}
