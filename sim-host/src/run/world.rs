//! A mission in a world, with the whole base.

use super::Driver;
use super::OBSERVE_S;
use super::recorder::{Keep, Recorder};
use super::watch::{Watch, WheelStates};
use crate::closed_loop::{ClosedLoop, ClosedLoopError, Mirror, order};
use crate::mission::{AccelerationAt, Mission, Sequencer};
use crate::trace::{BaseNote, HandOver, Trace, TraceRow};
use crate::world::WorldSetup;
use controller_core::base::{BaseReport, Order};
use controller_core::maths::Libm;
use controller_core::motion::{MotionReport, Outcome, Task};
use controller_core::pose_error::pose_error;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::{Twist, Wrench};
use protocol::Command;

/// Runs a mission in a world: arms, follows, hands over, parks.
///
/// The trace ends early when the base stopped or failed for good, or has been parked for `observe_s` \[s\].
///
/// # Errors
/// Parameters out of their range.
pub fn drive_and_observe(
    mission: &Mission,
    setup: &WorldSetup,
    observe_s: f64,
) -> Result<Trace, ClosedLoopError> {
    drive_and_observe_watched(mission, setup, observe_s, None)
}

/// As [`drive_and_observe`], and `watch` sees every tick.
///
/// # Errors
/// As [`drive_and_observe`].
pub fn drive_and_observe_watched(
    mission: &Mission,
    setup: &WorldSetup,
    observe_s: f64,
    watch: Watch<'_>,
) -> Result<Trace, ClosedLoopError> {
    let keep = Keep::All(watch);
    Ok(run(mission, setup, (None, None), (observe_s, keep))?.trace)
}

/// As [`super::drive_watched`], with the same base somewhere else whose motors move the plant.
///
/// # Errors
/// Parameters out of their range, or no answer from there.
pub fn fly(
    mission: &Mission,
    setup: &WorldSetup,
    mirror: &mut dyn Mirror,
    watch: Watch<'_>,
) -> Result<Trace, ClosedLoopError> {
    let keep = Keep::All(watch);
    Ok(run(mission, setup, (Some(mirror), None), (OBSERVE_S, keep))?.trace)
}

/// As [`drive_and_observe`], with a rival's demands in place of the default law's.
///
/// # Errors
/// Parameters out of their range.
pub(crate) fn ride(
    mission: &Mission,
    setup: &WorldSetup,
    driver: &mut Driver,
    observe_s: f64,
) -> Result<Trace, ClosedLoopError> {
    let keep = Keep::All(None);
    Ok(run(mission, setup, (None, Some(driver)), (observe_s, keep))?.trace)
}

pub(super) fn run<'w>(
    mission: &Mission,
    setup: &WorldSetup,
    (mirror, mut driver): (Option<&mut dyn Mirror>, Option<&mut Driver>),
    (observe_s, keep): (f64, Keep<'w>),
) -> Result<Recorder<'w>, ClosedLoopError> {
    let mut queue = ReferenceQueue::<f32, 2>::new();
    let mirror = mirror.map(|mirror| mirror as _);
    let mut closed_loop = ClosedLoop::new(queue.split().1, mission, setup, mirror)?;
    let mut sequencer = Sequencer::new(mission, AccelerationAt::MiddleOfHold);
    let mut recorder = Recorder::new(mission, observe_s, keep);
    loop {
        closed_loop.advance()?;
        let t = 1.0e-6 * closed_loop.world().now_us() as f64 - mission.period_s;
        if t > mission.longest_s() {
            break;
        }
        let laws = (&mut sequencer, driver.as_deref_mut());
        let (mut row, hand_over) = tick(mission, &mut closed_loop, laws, (t, t))?;
        if closed_loop.report().motion.is_none() {
            // The motion law is off: what it said last stands.
            let before = recorder.trace.rows.last().map(|row| row.report);
            row.report.mode = before.map_or_else(Default::default, |report| report.mode);
            row.report.outcome = match (closed_loop.report().state, before) {
                (State::Parked, _) => Outcome::Parked,
                (_, Some(report)) => report.outcome,
                (_, None) => Outcome::default(),
            };
        }
        let state = row.base.map(|base| base.state);
        let hand_over = hand_over.map(|hand_over| HandOver {
            row: recorder.ticks,
            ..hand_over
        });
        let measured = closed_loop.report().measured;
        let measured = measured.map_or(mission.start, |measured| measured.cast());
        let wheels = || WheelStates::of(closed_loop.world());
        let observed = recorder.ends_at(t, state == Some(State::Parked));
        recorder.take(row, hand_over, measured, wheels);
        if observed || matches!(state, Some(State::Stopped | State::Fault)) {
            break;
        }
    }
    Ok(recorder)
}

/// One tick of a mission at `t`, which is `on_course` after its course began \[s\].
pub(super) fn tick(
    mission: &Mission,
    closed_loop: &mut ClosedLoop<'_>,
    (sequencer, mut driver): (&mut Sequencer<'_>, Option<&mut Driver>),
    (t, on_course): (f64, f64),
) -> Result<(TraceRow, Option<HandOver>), ClosedLoopError> {
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
    let tick = (on_course.max(0.0) / mission.period_s).round() as usize;
    let orders = sequencer.at(tick, on_course, &believed, &command, distance);
    if closed_loop.report().state == State::Idle && closed_loop.report().measured.is_some() {
        // An idle base that knows where it is refuses no arming.
        let _ = closed_loop.command(&Command::Arm)?;
    }
    let followed = orders.left.map(|(left, way)| {
        let order = order(&Task::Follow(left));
        (left, way, wrench(&closed_loop.would_say(&order)))
    });
    let given = match &mut driver {
        None => order(&orders.task),
        // What it sees is the pose of this very tick, as the default law does.
        Some(driver) => match closed_loop.would_say(&Order::None).measured {
            Some(seen) => driver.order(on_course, &seen, &orders.task),
            None => Order::None,
        },
    };
    let report = *closed_loop.tick(&given)?;
    let hand_over = followed.map(|(left, distance_m, followed)| {
        let parks = wrench(&report);
        HandOver {
            row: 0,
            left,
            goal: *orders.target.pose(),
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
    let row = TraceRow {
        t,
        truth,
        measured,
        reference: orders.target,
        error: pose_error::<f64, Libm>(orders.target.pose(), &truth.pose),
        report: report
            .motion
            .map_or_else(MotionReport::default, |motion| motion.cast()),
        paper: None,
        base: Some(BaseNote {
            state: match driver {
                // No supervisor knows that a rival has arrived.
                Some(driver) if driver.has_arrived() => State::Parked,
                _ => report.state,
            },
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
