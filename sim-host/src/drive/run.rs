//! The closed loop.

use super::driver::{Driver, StartError};
use super::in_world::drive_in_world;
use super::trace::{DriveHandOver, DriveRow, DriveTrace};
use crate::closed_loop::ClosedLoopError;
use crate::mission::{End, Mission, Orders, Sequencer};
use crate::plant::Plant;
use controller_core::error::StepFault;
use controller_core::maths::Libm;
use controller_core::motion::{Outcome, Task};
use controller_core::pose_error::pose_error;
use controller_core::types::{Twist, Wrench};

/// Why a run did not reach its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The controller does not start.
    #[error("{name}: {cause}")]
    Start {
        /// The mission.
        name: String,
        /// Why.
        cause: StartError,
    },
    /// The controller gave up.
    #[error("{name}: stopped at t = {time_s} s: {cause}")]
    Step {
        /// The mission.
        name: String,
        /// When \[s\].
        time_s: f64,
        /// Why.
        cause: StepFault,
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

/// Runs a mission.
///
/// # Errors
/// The first fault of the controller, with its time.
pub fn drive(mission: &Mission) -> Result<DriveTrace, DriveError> {
    if let Some(setup) = &mission.setup {
        return drive_in_world(mission, setup).map_err(|cause| DriveError::ClosedLoop {
            name: mission.name.clone(),
            cause,
        });
    }
    let dt = mission.period_s;
    let mut sequencer = Sequencer::new(mission);
    let mut plant = Plant::new(mission.robot, &mission.start);
    let mut driver: Option<Driver> = None;
    let mut trace = DriveTrace {
        period_s: dt,
        ..DriveTrace::default()
    };
    let last_event = mission.events.last().map_or(0.0, |event| event.at_s);
    let ticks = (mission.longest_s() / dt).round() as usize;
    let mut parked_since = None;
    for tick in 0..=ticks {
        // The product, not a running sum: times do not drift.
        let t = tick as f64 * dt;
        let truth = plant.truth();
        let command = driver
            .as_ref()
            .map_or(Twist::default(), |d| d.report().command);
        let distance = |speed| driver.as_ref().map_or(0.0, |d| d.hand_over_distance(speed));
        let orders = sequencer.at(tick, t, &truth, &command, distance);
        let step = |cause| DriveError::Step {
            name: mission.name.clone(),
            time_s: t,
            cause,
        };
        let report = match &mut driver {
            None => {
                let started = Driver::start(
                    &mission.base,
                    mission.precision,
                    &orders.task,
                    &orders.measured,
                );
                let started = started.map_err(|cause| DriveError::Start {
                    name: mission.name.clone(),
                    cause,
                })?;
                driver.insert(started).report()
            }
            Some(driver) => {
                if orders.jumped {
                    driver.declare_jump();
                }
                let before = *driver;
                let report = driver
                    .step(dt, &orders.task, &orders.measured)
                    .map_err(step)?;
                if let Some(hand_over) = hand_over(tick, &orders, before, dt, &report.wrench) {
                    trace.hand_over = Some(hand_over.map_err(step)?);
                }
                report
            }
        };
        let error = pose_error::<f64, Libm>(orders.target.pose(), &truth.pose);
        trace.rows.push(DriveRow {
            t,
            truth,
            measured: orders.measured.pose,
            reference: orders.target,
            error,
            report,
            base: None,
        });
        parked_since = match report.outcome {
            Outcome::Parked => parked_since.or(Some(t)),
            _ => None,
        };
        let watched = parked_since.is_some_and(|since| t >= since.max(last_event) + OBSERVE_S);
        if watched && matches!(mission.end, End::Parked(_)) {
            break;
        }
        plant.advance(&report.torques, dt);
    }
    Ok(trace)
}

/// What a hand-over did, if the orders were one: `before` is the controller of the last tick, to
/// ask what it would have done.
fn hand_over(
    row: usize,
    orders: &Orders,
    mut before: Driver,
    dt: f64,
    wrench: &Wrench<f64>,
) -> Option<Result<DriveHandOver, StepFault>> {
    let (left, distance_m) = orders.left?;
    let followed = match before.step(dt, &Task::Follow(left), &orders.measured) {
        Ok(report) => report.wrench,
        Err(fault) => return Some(Err(fault)),
    };
    Some(Ok(DriveHandOver {
        row,
        left,
        distance_m,
        error_before: pose_error::<f64, Libm>(left.pose(), &orders.measured.pose),
        torque_step: Wrench {
            force: wrench.force - followed.force,
            moment: wrench.moment - followed.moment,
        },
    }))
}
