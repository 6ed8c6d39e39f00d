//! A mission in a world.

use super::note::BaseNote;
use super::trace::{DriveHandOver, DriveRow, DriveTrace};
use crate::closed_loop::{ClosedLoop, ClosedLoopError, Mirror, order};
use crate::mission::{Mission, Sequencer};
use crate::world::WorldSetup;
use controller_core::base::BaseReport;
use controller_core::maths::Libm;
use controller_core::motion::{MotionReport, Outcome, Task};
use controller_core::pose_error::pose_error;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::{Twist, Wrench};
use protocol::Command;

/// For how long a base is observed after it parked \[s\].
const OBSERVE_S: f64 = 1.0;

/// Runs a mission in a world: arms, follows, hands over, parks.
///
/// The trace ends early when the base stopped or failed for good, or has been parked for a second.
///
/// # Errors
/// Parameters out of their range.
pub fn drive_in_world(
    mission: &Mission,
    setup: &WorldSetup,
) -> Result<DriveTrace, ClosedLoopError> {
    drive_and_observe(mission, setup, OBSERVE_S)
}

/// The same, but a base that parked is observed for `observe_s` \[s\].
///
/// # Errors
/// Parameters out of their range.
pub fn drive_and_observe(
    mission: &Mission,
    setup: &WorldSetup,
    observe_s: f64,
) -> Result<DriveTrace, ClosedLoopError> {
    run(mission, setup, None, observe_s)
}

/// As [`drive_in_world`], with the same base somewhere else whose motors move the plant.
///
/// # Errors
/// Parameters out of their range, or no answer from there.
pub fn fly(
    mission: &Mission,
    setup: &WorldSetup,
    mirror: &mut dyn Mirror,
) -> Result<DriveTrace, ClosedLoopError> {
    run(mission, setup, Some(mirror), OBSERVE_S)
}

fn run(
    mission: &Mission,
    setup: &WorldSetup,
    mirror: Option<&mut dyn Mirror>,
    observe_s: f64,
) -> Result<DriveTrace, ClosedLoopError> {
    let mut queue = ReferenceQueue::<f32, 2>::new();
    let mirror = mirror.map(|mirror| mirror as _);
    let mut closed_loop = ClosedLoop::new(queue.split().1, mission, setup, mirror)?;
    let mut sequencer = Sequencer::new(mission);
    let mut trace = DriveTrace {
        period_s: mission.period_s,
        ..DriveTrace::default()
    };
    let mut parked_since = None;
    let last_event = mission.events.last().map_or(0.0, |event| event.at_s);
    loop {
        closed_loop.advance()?;
        let t = 1.0e-6 * closed_loop.world().now_us() as f64 - mission.period_s;
        if t > mission.longest_s() {
            break;
        }
        let mut row = tick(mission, &mut closed_loop, &mut sequencer, t)?;
        let state = closed_loop.report().state;
        if closed_loop.report().motion.is_none() {
            // The motion law is off: what it said last stands.
            let before = trace.rows.last().map(|row: &DriveRow| row.report);
            row.0.report.mode = before.map_or_else(Default::default, |report| report.mode);
            row.0.report.outcome = match (state, before) {
                (State::Parked, _) => Outcome::Parked,
                (_, Some(report)) => report.outcome,
                (_, None) => Outcome::default(),
            };
        }
        if let Some(hand_over) = row.1 {
            trace.hand_over = Some(DriveHandOver {
                row: trace.rows.len(),
                ..hand_over
            });
        }
        trace.rows.push(row.0);
        parked_since = match state {
            State::Parked => parked_since.or(Some(t)),
            _ => None,
        };
        let done = matches!(state, State::Stopped | State::Fault)
            || parked_since.is_some_and(|since| t >= since.max(last_event) + observe_s);
        if done {
            break;
        }
    }
    Ok(trace)
}

/// One tick of a mission.
fn tick(
    mission: &Mission,
    closed_loop: &mut ClosedLoop<'_>,
    sequencer: &mut Sequencer<'_>,
    t: f64,
) -> Result<(DriveRow, Option<DriveHandOver>), ClosedLoopError> {
    let truth = closed_loop.world().truth();
    let report = closed_loop.report();
    let believed = report
        .measured
        .map_or(mission.start, |measured| measured.cast());
    let command = report
        .motion
        .map_or(Twist::default(), |motion| motion.command.cast());
    let motion = *closed_loop.task().controller().base().motion();
    let distance = |speed: f64| f64::from(motion.hand_over_distance(speed as f32));
    // Ticks come unevenly; the route goes by the clock.
    let tick = (t.max(0.0) / mission.period_s).round() as usize;
    let orders = sequencer.at(tick, t, &believed, &command, distance);
    if closed_loop.report().state == State::Idle && closed_loop.report().measured.is_some() {
        // An idle base that knows where it is refuses no arming.
        let _ = closed_loop.command(&Command::Arm)?;
    }
    let followed = orders.left.map(|(left, way)| {
        let order = order(&Task::Follow(left));
        (left, way, wrench(&closed_loop.would_say(&order)))
    });
    let report = *closed_loop.tick(&order(&orders.task))?;
    let hand_over = followed.map(|(left, distance_m, followed)| {
        let parks = wrench(&report);
        DriveHandOver {
            row: 0,
            left,
            distance_m,
            error_before: pose_error::<f64, Libm>(left.pose(), &truth.pose),
            torque_step: Wrench {
                force: parks.force - followed.force,
                moment: parks.moment - followed.moment,
            },
        }
    });
    let measured = report
        .measured
        .map_or(mission.start.pose, |measured| measured.pose.cast());
    let asked = report.action.torques().unwrap_or_default();
    let row = DriveRow {
        t,
        truth,
        measured,
        reference: orders.target,
        error: pose_error::<f64, Libm>(orders.target.pose(), &truth.pose),
        report: report
            .motion
            .map_or_else(MotionReport::default, |motion| motion.cast()),
        base: Some(BaseNote {
            state: report.state,
            cause: report.cause,
            active_faults: report.active_faults,
            fix: report.fix,
            asked: asked.cast(),
        }),
    };
    Ok((row, hand_over))
}

fn wrench(report: &BaseReport<f32>) -> Wrench<f64> {
    report
        .motion
        .map_or(Wrench::default(), |motion| motion.wrench.cast())
}
