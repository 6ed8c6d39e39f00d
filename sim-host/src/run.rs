//! The closed loop: measure, demand, step, hold the torque to the next tick.

use crate::controller_port::{self, ControllerPort, ControllerPortError};
use crate::motion::Walker;
use crate::plant::Plant;
use crate::scenario::Scenario;
use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::error::ParamError;
use controller_core::maths::Libm;
use controller_core::paper::demand::Demand;
use controller_core::pose_error::pose_error;
use controller_core::reference::{ParkingPlan, Reference};

/// Why a run did not reach its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The controller refused a tick, or cannot be reached.
    #[error("{name}: stopped at t = {time_s} s: {cause}")]
    ControllerPort {
        /// The scenario.
        name: String,
        /// When \[s\].
        time_s: f64,
        /// Why.
        #[source]
        cause: ControllerPortError,
    },
    /// Parameters that the core refuses.
    #[error("{name}: {cause}")]
    Params {
        /// The scenario.
        name: String,
        /// Which parameter and why.
        cause: ParamError,
    },
}

/// Runs a scenario with the controller that it names.
///
/// # Errors
/// The first fault of the controller, with its time.
pub fn run(scenario: &Scenario) -> Result<Trace, RunError> {
    let mut controller =
        controller_port::for_scenario(scenario).map_err(|cause| RunError::Params {
            name: scenario.name.clone(),
            cause,
        })?;
    run_with(scenario, controller.as_mut())
}

/// Runs a scenario with any controller.
///
/// # Errors
/// The first fault of the controller, with its time.
pub fn run_with(
    scenario: &Scenario,
    controller: &mut dyn ControllerPort,
) -> Result<Trace, RunError> {
    let dt = scenario.period_s;
    let ticks = scenario.ticks();
    let mut plant = Plant::new(scenario.robot, &scenario.start);
    let mut sequencer = Sequencer::new(scenario);
    let mut trace = Trace {
        period_s: dt,
        rows: Vec::with_capacity(ticks + 1),
        hand_over: None,
    };
    for tick in 0..=ticks {
        // The product, not a running sum: times do not drift.
        let t = tick as f64 * dt;
        let truth = plant.truth();
        let (demand, target) = sequencer.at(tick, t);
        let answer = match (tick, &demand) {
            (0, Demand::Track(reference)) => controller.start(reference, &truth),
            _ => controller.step(dt, &demand, &truth),
        };
        let answer = answer.map_err(|cause| RunError::ControllerPort {
            name: scenario.name.clone(),
            time_s: t,
            cause,
        })?;
        if let Demand::HandOver { reference, goal } = demand {
            trace.hand_over = Some(HandOver {
                row: tick,
                virtual_target: reference,
                goal,
                error_before: pose_error::<f64, Libm>(reference.pose(), &truth.pose),
                torque_step: answer.hand_over_step.unwrap_or_default(),
            });
        }
        let torques = answer.report.torques;
        trace.rows.push(TraceRow {
            t,
            truth,
            reference: target,
            error: pose_error::<f64, Libm>(target.pose(), &truth.pose),
            report: answer.report,
            relaxing: answer.relaxing,
            torques,
        });
        plant.advance(&torques, dt);
    }
    Ok(trace)
}

/// Decides what each tick is to do.
pub(crate) struct Sequencer {
    walker: Walker,
    plan: Option<ParkingPlan<f64>>,
    parking: bool,
}

impl Sequencer {
    pub(crate) fn new(scenario: &Scenario) -> Self {
        Self {
            walker: scenario.motion.walk(),
            plan: scenario.hand_over,
            parking: false,
        }
    }

    /// The demand of a tick, and where the robot is to be from this tick on.
    pub(crate) fn at(&mut self, tick: usize, t: f64) -> (Demand<f64>, Reference<f64>) {
        match self.plan {
            Some(ParkingPlan { goal, .. }) if self.parking => {
                (Demand::Park, Reference::at_rest_with::<Libm>(goal))
            }
            // Tick 0 starts tracking, so it cannot hand over.
            Some(plan) if tick > 0 && plan.is_due(t) => {
                self.parking = true;
                let reference = self.walker.advance_to(t);
                let goal = plan.goal;
                (
                    Demand::HandOver { reference, goal },
                    Reference::at_rest_with::<Libm>(goal),
                )
            }
            _ => {
                let reference = self.walker.advance_to(t);
                (Demand::Track(reference), reference)
            }
        }
    }
}
