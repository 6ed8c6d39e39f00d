//! What has to hold in every tick.

use super::expected;
use super::outcome::Why;
use crate::world::Actuation;
use controller_core::base::{BaseReport, WheelAction};
use controller_core::safety::Reaction;
use controller_core::safety::supervisor::{State, Then};

/// The output to the wheels, by severity.
pub(super) fn severity(report: &BaseReport<f32>) -> Reaction {
    match (report.state, &report.action) {
        (_, WheelAction::Release) => Reaction::Release,
        (_, WheelAction::Brake) => Reaction::Brake,
        (State::Stopping(_), WheelAction::Drive(_)) => Reaction::ControlledStop,
        (_, WheelAction::Drive(_)) => Reaction::Ignore,
    }
}

/// Torques within limits, none where nothing drives, all numbers finite.
pub(super) fn outputs(
    report: &BaseReport<f32>,
    actuation: &Actuation,
    limit_nm: f32,
) -> Result<(), String> {
    if let Some(torques) = report.action.torques() {
        let (right, left) = (torques.right, torques.left);
        // Rounding of the scaling to the limit.
        let most = 1.000_001 * limit_nm;
        if !(right.abs() <= most && left.abs() <= most) {
            return Err(format!("torques {right}, {left} N m beyond {limit_nm}"));
        }
        let drives = match report.state {
            State::Tracking | State::Parking | State::Parked | State::Stopping(_) => true,
            State::Idle | State::Armed | State::Braking(_) | State::Stopped | State::Fault => false,
        };
        if !drives && (right != 0.0 || left != 0.0) {
            return Err(format!(
                "torques {right}, {left} N m in state {:?}",
                report.state
            ));
        }
    }
    let applied = match (&report.action, actuation) {
        (WheelAction::Release, Actuation::Release) | (WheelAction::Brake, Actuation::Brake) => true,
        (WheelAction::Drive(_), Actuation::Duty { right, left }) => {
            right.abs() <= 1.0 && left.abs() <= 1.0
        }
        (
            WheelAction::Drive(_),
            Actuation::Torque { right, left } | Actuation::Speed { right, left },
        ) => right.is_finite() && left.is_finite(),
        _ => false,
    };
    if !applied {
        return Err(format!("{:?} became {actuation:?}", report.action));
    }
    let measured = report
        .measured
        .is_none_or(|m| m.pose.is_finite() && m.twist.is_finite());
    if !measured {
        return Err("the report holds a pose that is not finite".to_owned());
    }
    let motion = report.motion.is_none_or(|m| {
        m.command.is_finite() && m.wrench.force.is_finite() && m.wrench.moment.is_finite()
    });
    if !motion {
        return Err("the motion report holds what is not finite".to_owned());
    }
    Ok(())
}

/// Comes to rest, or rests, until the host says otherwise.
pub(super) const fn stops(state: State) -> bool {
    matches!(
        state,
        State::Stopping(_) | State::Braking(_) | State::Stopped | State::Fault
    )
}

/// Frames that reached the base between two ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Received {
    /// Any, with every byte as it was sent.
    pub(super) any: bool,
    /// Any that the protocol reads.
    pub(super) read: bool,
    /// One that may lead out of a stop.
    pub(super) frees: bool,
    /// A reset.
    pub(super) reset: bool,
    /// An emergency stop, be it of a frame that arrived with other bytes around it.
    pub(super) button: bool,
    /// A stop that arrived with every byte as it was sent, and no such frame after it; an emergency stop if so.
    pub(super) stop: Option<bool>,
}

/// A base that stops does not go back to a milder output until it is freed, nor leaves a latched state before a reset. The button brakes one that stands
/// released.
pub(super) fn milder(
    before: (State, Reaction),
    report: &BaseReport<f32>,
    received: &Received,
) -> Result<(), String> {
    let (state, was) = before;
    let now = severity(report);
    let stands = matches!(state, State::Stopped | State::Fault);
    let braked = stands && now == Reaction::Brake && received.button;
    if stops(state) && !received.frees && !braked && now < was {
        return Err(format!(
            "{was:?} in {state:?} became {now:?} in {:?}",
            report.state
        ));
    }
    let latched = |state| {
        matches!(
            state,
            State::Fault | State::Stopping(Then::Fault) | State::Braking(Then::Fault)
        )
    };
    if latched(state) && !received.reset && !latched(report.state) {
        return Err(format!("latched {state:?} became {:?}", report.state));
    }
    Ok(())
}

/// What was found in a live base had its reaction in the same tick.
pub(super) fn reacted(before: State, report: &BaseReport<f32>) -> Result<(), String> {
    if !before.is_live() {
        return Ok(());
    }
    for fault in report.active_faults.iter() {
        let least = expected::least(fault.kind());
        if least.reaction == Reaction::Ignore {
            continue;
        }
        if severity(report) < least.reaction {
            return Err(format!(
                "{fault} was found, {:?} is applied in {:?}",
                severity(report),
                report.state
            ));
        }
        let latched = matches!(
            report.state,
            State::Fault | State::Stopping(Then::Fault) | State::Braking(Then::Fault)
        );
        if least.latch && !latched {
            return Err(format!(
                "{fault} was found, {:?} is not latched",
                report.state
            ));
        }
    }
    Ok(())
}

/// What the base was stopped for in this tick, if that does not fit the trouble there is.
///
/// What is found besides, such as poses that grow old while a base brakes blindly, is not what it was stopped for.
pub(super) fn wrong(
    before: &BaseReport<f32>,
    report: &BaseReport<f32>,
    right: impl Fn(Why) -> bool,
) -> Option<&'static str> {
    let news = report.cause != before.cause || report.state != before.state;
    let why = Why::of(report.cause);
    match why {
        Why::Fault(_) | Why::Link if news && !right(why) => Some(why.name()),
        _ => None,
    }
}
