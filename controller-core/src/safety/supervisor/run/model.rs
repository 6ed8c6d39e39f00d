//! Every state that the supervisor can get into by any sequence of events, faults and ticks, and every step out of each: its rules
//! hold in all of them. No sequence is longer than what is tried, since what it leads to has been tried already.

extern crate std;

use super::{Cause, Supervisor};
use crate::hal::ErrorKind;
use crate::motion::AtRest;
use crate::safety::supervisor::{
    Action, Emergency, Event, IdleOutput, OutputMode, RestLimits, State, SupervisorParams, Then,
};
use crate::safety::{
    ActiveFaults, Fault, PolicyParams, Reaction, Response, Side, Timeout, ValidPolicyParams,
};
use std::vec::Vec;

/// Times in units of a tick: a dwell of two, stops of five and four. Only their order matters.
const DWELL: u32 = 2;
const LIMITS: (u32, u32) = (5, 4);

/// What can come.
#[derive(Clone, Copy, Debug)]
enum Step {
    On(Event),
    Button,
    Found(ActiveFaults),
    /// Of so many units; whether the base seems to rest.
    Tick(u32, bool),
}

/// A fault for each answer that the policy below gives, with and without a broken measurement.
const FAULTS: [Fault; 10] = [
    Fault::PoseJump,
    Fault::PoseStale,
    Fault::TickTooLong,
    Fault::WheelSlip(Side::Left),
    Fault::UnderVoltage,
    Fault::Stalled,
    Fault::OverCurrent(Side::Both),
    Fault::EncoderStuck(Side::Right),
    Fault::EncoderReversed(Side::Left),
    Fault::Driver(ErrorKind::Bus),
];

/// Every answer that there is to a fault.
fn policy() -> ValidPolicyParams {
    let params = PolicyParams {
        pose_jump: Response::IGNORE,
        pose_stale: Response::passing(Reaction::ControlledStop),
        tick_too_long: Response::latched(Reaction::ControlledStop),
        wheel_slip: Response::passing(Reaction::Brake),
        under_voltage: Response::latched(Reaction::Brake),
        stalled: Response::passing(Reaction::Release),
        over_current: Response::latched(Reaction::Release),
        encoder_stuck: Response::passing(Reaction::Brake),
        encoder_reversed: Response::latched(Reaction::Release),
        driver: Response::latched(Reaction::Release),
        ..PolicyParams::DEFAULT
    };
    params.validate().expect("each leaves what it needs")
}

/// All steps: all events, the button, no fault, each alone and any two of them, ticks short and long.
fn steps() -> Vec<Step> {
    let mut steps: Vec<Step> = Event::ALL.map(Step::On).into();
    steps.push(Step::Button);
    for first in 0..=FAULTS.len() {
        for second in first..=FAULTS.len() {
            let mut found = ActiveFaults::NONE;
            found.add_some(FAULTS.get(first).copied());
            found.add_some(FAULTS.get(second).copied());
            steps.push(Step::Found(found));
        }
    }
    for units in [0, 1, 3, u32::MAX] {
        steps.extend([Step::Tick(units, false), Step::Tick(units, true)]);
    }
    steps
}

/// Without what counts and what is only reported: two that are the same by this go on alike.
fn essence(supervisor: &Supervisor) -> Supervisor {
    let mut same = *supervisor;
    (same.changes, same.ignored, same.last_ignored) = (0, 0, None);
    same.cause = Cause::PowerOn;
    same.latched = same.latched.map(|_| Fault::UnderVoltage);
    let unlimited = match same.state {
        State::Stopping(_) => same.params.stop_limit == Timeout::Off,
        State::Braking(_) => same.params.brake_limit == Timeout::Off,
        _ => false,
    };
    if unlimited {
        same.stop_us = 0;
    }
    same
}

fn take(supervisor: &mut Supervisor, step: &Step, policy: &ValidPolicyParams) -> Action {
    match step {
        Step::On(event) => supervisor.on(*event),
        Step::Button => supervisor.emergency_stop(),
        Step::Found(faults) => supervisor.on_active_faults(faults, policy),
        Step::Tick(units, rests) => supervisor.tick(*units, *rests),
    }
}

/// The rules, for a step from `before` to `after`.
fn obeys(
    before: &Supervisor,
    step: &Step,
    action: Action,
    after: &Supervisor,
    policy: &ValidPolicyParams,
) {
    let context = || std::format!("{step:?} from {before:?} to {after:?} by {action:?}");
    let (from, to) = (before.state, after.state);
    let (output, next) = (before.output(), after.output());
    // Torque flows where it may, and nowhere else.
    let torque = matches!(to, State::Tracking | State::Parking | State::Stopping(_))
        || (to == State::Parked && after.params.parked == AtRest::Hold);
    assert_eq!(next.has_torque(), torque, "{}", context());
    // Motion begins by an order, from a state that was armed.
    let ordered = matches!(
        step,
        Step::On(Event::Track | Event::Park | Event::Drive | Event::TrajectoryEnded)
    );
    let armed = matches!(from, State::Armed | State::Parked) || from.drives();
    assert!(
        !to.drives() || from.drives() || (ordered && armed),
        "{}",
        context()
    );
    // The button takes torque away in one step, from anywhere, and what a reaction released stays so; what only stands is braked.
    if let Step::Button | Step::On(Event::EmergencyStop { .. }) = step {
        let brake = match step {
            Step::On(Event::EmergencyStop { brake }) => *brake,
            _ => before.params.emergency == Emergency::Brake,
        };
        let expected = if brake && before.worst < Reaction::Release {
            OutputMode::Brake
        } else {
            OutputMode::Release
        };
        assert_eq!(next, expected, "{}", context());
        assert!(
            matches!(to, State::Fault | State::Braking(Then::Fault)),
            "{}",
            context()
        );
    }
    // A fault demands at least its reaction, where anything moves, and never makes an output milder.
    let demanded = match step {
        Step::On(Event::Fault(response)) => Some(*response),
        Step::Found(faults) => faults.worst(policy).map(|(_, response)| response),
        _ => None,
    };
    if let (Some(response), true) = (demanded, from.is_live()) {
        assert!(
            next.severity() >= response.reaction || !next.has_torque(),
            "{}",
            context()
        );
        let latches = response.latch && response.reaction > Reaction::Ignore;
        let ends_in_fault = matches!(
            to,
            State::Fault | State::Stopping(Then::Fault) | State::Braking(Then::Fault)
        );
        assert!(!latches || ends_in_fault, "{}", context());
    }
    if matches!(step, Step::Found(_) | Step::On(Event::Fault(_))) {
        assert!(next.severity() >= output.severity(), "{}", context());
    }
    // What was braked or released stays so until it is armed or reset.
    let lets_go = matches!(step, Step::On(Event::Arm | Event::Reset)) && action != Action::Refuse;
    if before.worst >= Reaction::Brake && !lets_go {
        assert!(after.worst >= before.worst, "{}", context());
        assert!(next.severity() >= before.worst, "{}", context());
    }
    // What latched stays until a reset, and a base that is to end in Fault ends there.
    let bound_for_fault = |state| {
        matches!(
            state,
            State::Fault | State::Stopping(Then::Fault) | State::Braking(Then::Fault)
        )
    };
    if bound_for_fault(from) && !bound_for_fault(to) {
        assert_eq!((from, to), (State::Fault, State::Idle), "{}", context());
        assert!(
            matches!(step, Step::On(Event::Reset)) && after.latched.is_none(),
            "{}",
            context()
        );
        assert!(!next.has_torque(), "{}", context());
    }
    assert!(
        after.latched.is_none() || bound_for_fault(to),
        "{}",
        context()
    );
    // A stop is left by its end, by something more severe, and by nothing else; its time only grows, and is within its limit.
    if let State::Stopping(_) | State::Braking(_) = from {
        let ends = matches!(
            step,
            Step::Tick(..) | Step::On(Event::Halted | Event::StopTimedOut)
        );
        let stops = matches!(to, State::Stopping(_) | State::Braking(_));
        assert!(
            stops || ends || next.severity() > output.severity(),
            "{}",
            context()
        );
    }
    let limit = match to {
        State::Stopping(_) => Some(after.params.stop_limit),
        State::Braking(_) => Some(after.params.brake_limit),
        _ => None,
    };
    if let Some(Timeout::AfterUs(limit)) = limit {
        assert!(after.stop_us < limit, "{}", context());
    }
    let same_stop = core::mem::discriminant(&from) == core::mem::discriminant(&to);
    if let (Step::Tick(units, _), true, true) = (step, same_stop, limit.is_some()) {
        assert_eq!(
            after.stop_us,
            before.stop_us.saturating_add(*units),
            "{}",
            context()
        );
    }
    // A measurement that is broken shows no rest: such a stop ends by its limit alone.
    if let (Step::Tick(units, true), true) = (step, before.blind) {
        let rest = !matches!(to, State::Stopping(_) | State::Braking(_));
        let stops = matches!(from, State::Stopping(_) | State::Braking(_));
        let timed_out = before.stop_us.saturating_add(*units) >= LIMITS.1;
        assert!(!(stops && rest) || timed_out, "{}", context());
    }
    // What is refused changes nothing.
    if action == Action::Refuse {
        assert_eq!(before, after, "{}", context());
    }
    if !from.is_live() && to.is_live() {
        assert!(
            matches!(step, Step::On(Event::Arm)) && to == State::Armed,
            "{}",
            context()
        );
    }
    assert_eq!(before.changes != after.changes, from != to, "{}", context());
}

/// Breadth first to closure, for every choice of parameters.
#[test]
fn every_sequence_of_events_keeps_the_rules() {
    let (policy, steps) = (policy(), steps());
    let (mut states, mut taken) = (0, 0);
    for choice in 0..32_u8 {
        let bit = |n: u8| choice & (1 << n) != 0;
        let limit = |on: bool, units: u32| {
            if on {
                Timeout::AfterUs(units)
            } else {
                Timeout::Off
            }
        };
        let params = SupervisorParams {
            stop_limit: limit(bit(0), LIMITS.0),
            brake_limit: limit(bit(1), LIMITS.1),
            rest: RestLimits {
                dwell_us: DWELL,
                ..SupervisorParams::DEFAULT.rest
            },
            emergency: if bit(2) {
                Emergency::Brake
            } else {
                Emergency::Release
            },
            parked: if bit(3) {
                AtRest::Hold
            } else {
                AtRest::Release
            },
            idle_output: if bit(4) {
                IdleOutput::Brake
            } else {
                IdleOutput::Release
            },
        };
        let mut reached: Vec<Supervisor> = Vec::new();
        reached.push(essence(&Supervisor::new(
            &params.validate().expect("in range"),
        )));
        let mut at = 0;
        while let Some(before) = reached.get(at).copied() {
            at += 1;
            for step in &steps {
                let mut after = before;
                let action = take(&mut after, step, &policy);
                obeys(&before, step, action, &after, &policy);
                taken += 1;
                let after = essence(&after);
                if !reached.contains(&after) {
                    reached.push(after);
                }
            }
        }
        for state in State::ALL {
            assert!(
                reached.iter().any(|found| found.state == state),
                "{state:?} is never reached"
            );
        }
        states += reached.len();
    }
    std::println!("{states} states, {taken} steps");
    assert!(states > 32 * State::ALL.len());
}
