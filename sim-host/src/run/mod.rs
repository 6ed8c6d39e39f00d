//! The closed loop: measure, decide what is to be done, compute, hold the torque to the next tick.
//!
//! [`run`] is a scenario under a law of the paper, [`drive`] a mission under the default law, both on the plant of
//! [`crate::plant`]; a mission with a world runs there, with the whole base. A [`Live`] one takes its orders while it runs.

mod law;
mod live;
mod motion;
mod paper_rival;
mod recorder;
mod rival;
mod watch;
mod world;

use law::Computed;
pub(crate) use law::{Law, PaperLaw};
pub use live::{Live, LiveLaw};
pub(crate) use motion::motion_law;
pub(crate) use rival::{Driver, body};
// What only studies take.
pub use watch::{Seen, Watch, WheelStates};
pub use world::{drive_and_observe, drive_and_observe_watched, fly};
#[cfg(not(target_family = "wasm"))]
pub(crate) use {motion::MotionLaw, paper_rival::PaperRival, rival::RivalLaw, world::ride};

use crate::closed_loop::ClosedLoopError;
use crate::controller_port::{self, ControllerPort, ControllerPortError};
use crate::mission::{AccelerationAt, End, Mission, Sequencer};
use crate::numbers::{digits, param};
use crate::plant::Plant;
use crate::scenario::Scenario;
use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::error::ParamError;
use controller_core::maths::Libm;
use controller_core::motion::Outcome;
use controller_core::pose_error::pose_error;
use recorder::{Keep, Recorder};

/// Why a run did not reach its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The controller refused a tick, or cannot be reached.
    #[error("{name}: stopped at t = {} s: {cause}", digits(*time_s))]
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
    #[error("{name}: {}", param(cause))]
    Params {
        /// The scenario.
        name: String,
        /// Which parameter and why.
        cause: ParamError,
    },
    /// The base or the world cannot be.
    #[error("{name}: {cause}")]
    ClosedLoop {
        /// The mission.
        name: String,
        /// Why.
        cause: ClosedLoopError,
    },
}

/// For how long a robot is observed after it parked \[s\].
const OBSERVE_S: f64 = 1.0;

/// Runs a scenario with the controller that it names.
///
/// # Errors
/// The first fault of the controller, with its time.
pub fn run(scenario: &Scenario) -> Result<Trace, RunError> {
    run_watched(scenario, None)
}

/// As [`run`], and `watch` sees every tick.
///
/// # Errors
/// As [`run`].
pub fn run_watched(scenario: &Scenario, watch: Watch<'_>) -> Result<Trace, RunError> {
    let controller = controller_port::for_scenario(scenario);
    let mut controller = controller.map_err(|cause| refused(&scenario.name, cause))?;
    run_with_watched(scenario, controller.as_mut(), watch)
}

/// Runs a scenario with any controller.
///
/// # Errors
/// The first fault of the controller, with its time.
pub fn run_with(
    scenario: &Scenario,
    controller: &mut dyn ControllerPort,
) -> Result<Trace, RunError> {
    run_with_watched(scenario, controller, None)
}

/// As [`run_with`], and `watch` sees every tick.
///
/// # Errors
/// As [`run_with`].
pub fn run_with_watched(
    scenario: &Scenario,
    controller: &mut dyn ControllerPort,
    watch: Watch<'_>,
) -> Result<Trace, RunError> {
    let mission = scenario.mission(scenario.believed_base());
    let sequencer = Sequencer::new(&mission, AccelerationAt::Tick);
    let mut law = PaperLaw::new(controller);
    Ok(recorded(&mission, sequencer, &mut law, Keep::All(watch))?.trace)
}

/// Runs a mission with the default law: in its world if it has one, else on the ideal plant.
///
/// # Errors
/// The first fault of the controller, with its time; parameters out of their range.
pub fn drive(mission: &Mission) -> Result<Trace, RunError> {
    drive_watched(mission, None)
}

/// As [`drive`], and `watch` sees every tick.
///
/// # Errors
/// As [`drive`].
pub fn drive_watched(mission: &Mission, watch: Watch<'_>) -> Result<Trace, RunError> {
    Ok(driven(mission, Keep::All(watch))?.trace)
}

/// How a run ended, without the way there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// The last row.
    pub last: TraceRow,
    /// Number of rows.
    pub ticks: usize,
    /// From when on the robot was parked \[s\], if it was at the end.
    pub parked_since_s: Option<f64>,
}

/// As [`drive`], for runs by the thousand: the same ticks, of which only the last is kept; none of a run without ticks. `each` is
/// called at every tick.
///
/// # Errors
/// As [`drive`].
pub fn finish(mission: &Mission, each: &mut dyn FnMut()) -> Result<Option<Finish>, RunError> {
    let recorder = driven(mission, Keep::Last(each))?;
    Ok(recorder.trace.rows.last().map(|last| Finish {
        last: *last,
        ticks: recorder.ticks,
        parked_since_s: recorder.parked_since,
    }))
}

fn driven<'w>(mission: &Mission, keep: Keep<'w>) -> Result<Recorder<'w>, RunError> {
    if let Some(setup) = &mission.setup {
        return world::run(mission, setup, (None, None), (OBSERVE_S, keep)).map_err(|cause| {
            RunError::ClosedLoop {
                name: mission.name.clone(),
                cause,
            }
        });
    }
    let law = motion_law(&mission.base, mission.precision);
    let mut law = law.map_err(|cause| refused(&mission.name, cause))?;
    let sequencer = Sequencer::new(mission, AccelerationAt::MiddleOfHold);
    recorded(mission, sequencer, law.as_mut(), keep)
}

fn refused(name: &str, cause: ParamError) -> RunError {
    let name = name.to_owned();
    RunError::Params { name, cause }
}

/// Runs a mission with any law, on the ideal plant.
///
/// # Errors
/// The first tick that the law refuses.
pub(crate) fn on_ideal_plant(
    mission: &Mission,
    sequencer: Sequencer<'_>,
    law: &mut dyn Law,
) -> Result<Trace, RunError> {
    Ok(recorded(mission, sequencer, law, Keep::All(None))?.trace)
}

fn recorded<'w>(
    mission: &Mission,
    mut sequencer: Sequencer<'_>,
    law: &mut dyn Law,
    keep: Keep<'w>,
) -> Result<Recorder<'w>, RunError> {
    let dt = mission.period_s;
    let ticks = (mission.longest_s() / dt).round() as usize;
    let mut plant = Plant::new(mission.robot, &mission.start);
    let observe_s = match mission.end {
        End::Parked(_) => OBSERVE_S,
        End::At(_) => f64::INFINITY,
    };
    let mut recorder = Recorder::new(mission, observe_s, keep);
    for tick in 0..=ticks {
        // The product, not a running sum: times do not drift.
        let t = tick as f64 * dt;
        let truth = plant.truth();
        let command = law.command();
        let distance = |speed| law.hand_over_distance(speed);
        let orders = sequencer.at(tick, t, &truth, &command, distance);
        let acted = law.tick(dt, &orders);
        let acted = acted.map_err(|cause| RunError::ControllerPort {
            name: mission.name.clone(),
            time_s: t,
            cause,
        })?;
        let parked = acted.outcome == Outcome::Parked;
        let is_last = recorder.ends_at(t, parked) || tick == ticks;
        if recorder.wants(is_last) {
            let hand_over = orders.left.map(|(left, distance_m)| HandOver {
                row: tick,
                left,
                goal: *orders.target.pose(),
                distance_m,
                error_before: pose_error::<f64, Libm>(left.pose(), &orders.measured.pose),
                torque_step: acted.hand_over_step.unwrap_or_default(),
            });
            let Computed { report, paper } = law.computed();
            let row = TraceRow {
                t,
                truth,
                measured: orders.measured.pose,
                reference: orders.target,
                error: pose_error::<f64, Libm>(orders.target.pose(), &truth.pose),
                report,
                paper,
                base: None,
            };
            recorder.take(row, hand_over, orders.measured, || None);
        }
        if is_last {
            break;
        }
        plant.advance(&acted.torques, dt);
    }
    Ok(recorder)
}
