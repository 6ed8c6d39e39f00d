//! Every pair of the table against a second, independent writing of it, and the rules it must obey.

use super::*;
use crate::motion::AtRest;
use crate::safety::{Reaction, Response};

mod run;

/// Rows are states, columns events, in the order of `ALL`: the next state (Idle, Armed, Tracking, Parking,
/// D parked, c and C controlled stop that ends in Stopped and in Fault, b and B the same braked, Stopped,
/// X fault), then the action (`.` continue, `!` refuse, `e` enable, `t` track, `p` park, `l` park at last,
/// `c` controlled stop, `b` brake, `r` release).
///
/// Arm Track Park Drive | trajectory ended, reached, goal unreachable | halted, timed out | stop, link lost |
/// emergency brake, release | ignored | controlled | brake | release, each passing and latched | reset
const TABLE: [&str; 11] = [
    "Ae I! I! I! I. I. I. I. I. Sr I. Xb Xr I. I. Sr Xr Sb Xb Sr Xr I!",
    "A. Tt Pp Tt A. A. A. A. A. Sr Sr Bb Xr A. A. Sr Xr bb Bb Sr Xr A!",
    "T! T. Pp T. Pl T. cc T. T. cc cc Bb Xr T. T. cc Cc bb Bb Sr Xr T!",
    "P! P! Pp Tt P. Dr cc P. P. cc cc Bb Xr P. P. cc Cc bb Bb Sr Xr P!",
    "Ae Tt Pp Tt D. D. D. D. D. Sr Sr Bb Xr D. D. Sr Xr bb Bb Sr Xr D!",
    "c! c! c! c! c. c. c. Sr bb c. c. Bb Xr c. c. c. C. bb Bb Sr Xr c!",
    "C! C! C! C! C. C. C. Xr Bb C. C. Bb Xr C. C. C. C. Bb Bb Xr Xr C!",
    "b! b! b! b! b. b. b. Sb Sb b. b. B. Xr b. b. b. B. b. B. Sr Xr b!",
    "B! B! B! B! B. B. B. Xb Xb B. B. B. Xr B. B. B. B. B. B. Xr Xr B!",
    "Ae S! S! S! S. S. S. S. S. S. S. Xb Xr S. S. Sr Xr Sb Xb Sr Xr S!",
    "X! X! X! X! X. X. X. X. X. X. X. Xb Xr X. X. Xr Xr Xb Xb Xr Xr Ir",
];

fn letters(state: State, action: Action) -> [u8; 2] {
    let state = match state {
        State::Idle => b'I',
        State::Armed => b'A',
        State::Tracking => b'T',
        State::Parking => b'P',
        State::Parked => b'D',
        State::Stopping(Then::Stopped) => b'c',
        State::Stopping(Then::Fault) => b'C',
        State::Braking(Then::Stopped) => b'b',
        State::Braking(Then::Fault) => b'B',
        State::Stopped => b'S',
        State::Fault => b'X',
    };
    let action = match action {
        Action::Continue => b'.',
        Action::Refuse => b'!',
        Action::Enable => b'e',
        Action::StartTracking => b't',
        Action::StartParking => b'p',
        Action::ParkAtLastReference => b'l',
        Action::BeginStop => b'c',
        Action::Brake => b'b',
        Action::Release => b'r',
    };
    [state, action]
}

fn pairs() -> impl Iterator<Item = (State, Event)> {
    State::ALL
        .into_iter()
        .flat_map(|state| Event::ALL.into_iter().map(move |event| (state, event)))
}

/// A supervisor in a state, by the shortest way there.
fn supervisor_in(state: State, params: SupervisorParams) -> Supervisor {
    use {Event as E, Reaction as R};
    let stop = |reaction, then| {
        Event::Fault(match then {
            Then::Stopped => Response::passing(reaction),
            Then::Fault => Response::latched(reaction),
        })
    };
    let way: &[Event] = match state {
        State::Idle => &[],
        State::Armed => &[E::Arm],
        State::Tracking => &[E::Arm, E::Track],
        State::Parking => &[E::Arm, E::Park],
        State::Parked => &[E::Arm, E::Park, E::Reached],
        State::Stopping(then) => &[E::Arm, E::Track, stop(R::ControlledStop, then)],
        State::Braking(then) => &[E::Arm, E::Track, stop(R::Brake, then)],
        State::Stopped => &[E::Arm, E::Stop],
        State::Fault => &[E::Fault(Response::latched(R::Release))],
    };
    let mut supervisor = Supervisor::new(&params.validate().expect("valid"));
    for event in way {
        supervisor.on(*event);
    }
    assert_eq!(supervisor.state(), state);
    supervisor
}

/// Every way that parked and standing outputs can be set up.
fn setups() -> impl Iterator<Item = SupervisorParams> {
    [AtRest::Hold, AtRest::Release]
        .into_iter()
        .flat_map(|parked| {
            [IdleOutput::Release, IdleOutput::Brake].map(|idle_output| SupervisorParams {
                parked,
                idle_output,
                ..SupervisorParams::DEFAULT
            })
        })
}

#[test]
fn every_pair_is_as_tabled() {
    for (state, row) in State::ALL.into_iter().zip(TABLE) {
        let mut cells = row.split(' ');
        for (event, cell) in Event::ALL.into_iter().zip(&mut cells) {
            let (after, action) = next(state, event);
            let found = letters(after, action);
            assert_eq!(found, cell.as_bytes(), "{event:?} in {state:?}");
        }
        assert_eq!(cells.next(), None, "{state:?} has a cell too many");
    }
}

/// An emergency stop, and faults that brake or release, end torque in one step and one call, from anywhere.
#[test]
fn emergency_stop_brake_and_release_end_torque_at_once() {
    for setup in setups() {
        for (state, event) in pairs() {
            let least = match event {
                Event::EmergencyStop { brake: true } => Reaction::Brake,
                Event::EmergencyStop { brake: false } => Reaction::Release,
                Event::Fault(Response { reaction, .. }) if reaction >= Reaction::Brake => reaction,
                _ => continue,
            };
            let mut supervisor = supervisor_in(state, setup);
            supervisor.on(event);
            let output = supervisor.output();
            assert!(
                !output.has_torque() && output != OutputMode::ZeroTorque,
                "{event:?} in {state:?}: {output:?}"
            );
            assert!(output.severity() >= least, "{event:?} in {state:?}");
        }
    }
}

/// No fault ever makes the output milder, whatever is set up.
#[test]
fn faults_never_make_the_output_milder() {
    for setup in setups() {
        for (state, event) in pairs() {
            if !matches!(event, Event::Fault(_)) {
                continue;
            }
            let mut supervisor = supervisor_in(state, setup);
            let before = supervisor.output().severity();
            supervisor.on(event);
            let after = supervisor.output().severity();
            assert!(after >= before, "{event:?} in {state:?} with {setup:?}");
        }
    }
}

/// What was braked stays braked, at rest, after the brake's limit, and whatever is found or ordered, until a reset or, where nothing latched, until it is
/// armed; what was released stays so too, and the button does not brake it.
#[test]
fn what_was_braked_or_released_stays_so() {
    let outputs = [
        (Reaction::Brake, OutputMode::Brake),
        (Reaction::Release, OutputMode::Release),
    ];
    for setup in setups() {
        for ((state, (reaction, output)), latch) in State::ALL
            .into_iter()
            .flat_map(|state| outputs.map(|what| (state, what)))
            .flat_map(|case| [(case, false), (case, true)])
        {
            for rests in [false, true] {
                let mut supervisor = supervisor_in(state, setup);
                let releases = supervisor.output() == OutputMode::Release;
                if reaction == Reaction::Brake && latch {
                    supervisor.on(Event::EmergencyStop { brake: true });
                } else {
                    supervisor.on(Event::Fault(Response { reaction, latch }));
                }
                // A fault does not brake what stands released, the button does; the way to Fault was a release.
                let released = state == State::Fault || (releases && !latch);
                let output = if released {
                    OutputMode::Release
                } else {
                    output
                };
                for _ in 0..2_000 {
                    supervisor.tick(10_000, rests);
                    assert_eq!(supervisor.output(), output, "{state:?} {reaction:?}");
                }
                for event in [Event::Stop, Event::LinkLost, Event::Halted, Event::Track] {
                    supervisor.on(event);
                }
                supervisor.on(Event::Fault(Response::passing(Reaction::ControlledStop)));
                assert_eq!(supervisor.output(), output, "{state:?} {reaction:?}");
                if output == OutputMode::Release {
                    supervisor.on(Event::EmergencyStop { brake: true });
                    assert_eq!(supervisor.output(), output, "{state:?} {reaction:?}");
                }
                let again = match supervisor.state() {
                    State::Fault => Event::Reset,
                    _ => Event::Arm,
                };
                supervisor.on(again);
                supervisor.on(Event::Stop);
                let idle = supervisor_in(State::Idle, setup).output();
                assert_eq!(supervisor.output(), idle, "{state:?} {reaction:?}");
            }
        }
    }
}

#[test]
fn torque_flows_in_driving_stopping_and_held_parking_only() {
    for setup in setups() {
        for state in State::ALL {
            let debounce = state == State::Parked && setup.parked == AtRest::Hold;
            let expected = state.drives() || matches!(state, State::Stopping(_)) || debounce;
            let output = supervisor_in(state, setup).output();
            assert_eq!(output.has_torque(), expected, "{state:?}");
        }
    }
}

#[test]
fn only_a_reset_leaves_the_fault_and_moves_nothing() {
    for event in Event::ALL {
        let (after, _) = next(State::Fault, event);
        assert_eq!(after != State::Fault, event == Event::Reset, "{event:?}");
    }
    for state in State::ALL {
        for event in [Event::Reset, Event::Arm] {
            let (after, _) = next(state, event);
            let moves = after.drives() && after != state;
            assert!(!moves, "{event:?} in {state:?}");
        }
        if state != State::Fault {
            assert_eq!(next(state, Event::Reset), (state, Action::Refuse));
        }
    }
}

#[test]
fn what_is_not_armed_does_not_begin_to_drive() {
    for (state, event) in pairs() {
        let (after, _) = next(state, event);
        let armed = matches!(state, State::Armed | State::Parked) || state.drives();
        assert!(!after.drives() || armed, "{event:?} in {state:?}");
        if !armed && matches!(event, Event::Track | Event::Park | Event::Drive) {
            assert_eq!(next(state, event), (state, Action::Refuse));
        }
    }
}

#[test]
fn refusals_and_ignored_faults_change_nothing() {
    for (state, event) in pairs() {
        let (after, action) = next(state, event);
        let ignored =
            matches!(event, Event::Fault(response) if response.reaction == Reaction::Ignore);
        if action == Action::Refuse || ignored {
            assert_eq!(after, state, "{event:?} in {state:?}");
        }
    }
}

/// A stop once under way ends in rest, whatever comes; latched once, it ends in Fault.
#[test]
fn stops_end_in_stopped_or_fault_and_keep_their_latch() {
    for (state, event) in pairs() {
        let (State::Stopping(then) | State::Braking(then)) = state else {
            continue;
        };
        let (after, _) = next(state, event);
        match after {
            State::Stopping(to) | State::Braking(to) => {
                assert!(then == Then::Stopped || to == Then::Fault, "{event:?}");
            }
            State::Stopped => assert_eq!(then, Then::Stopped, "{event:?} in {state:?}"),
            after => assert_eq!(after, State::Fault, "{event:?} in {state:?}"),
        }
    }
}
