//! Every pair of the table against a second, independent writing of it, and the rules it must obey.

use super::{Event, Reaction, State, next};

const STATES: [State; 7] = [
    State::Idle,
    State::Armed,
    State::Tracking,
    State::Parking,
    State::Parked,
    State::Stopped,
    State::Fault,
];

const EVENTS: [Event; 11] = [
    Event::Arm,
    Event::Track,
    Event::Park,
    Event::TrajectoryEnded,
    Event::Underrun,
    Event::Reached,
    Event::Halted,
    Event::Stop,
    Event::LinkLost,
    Event::Fault,
    Event::ResetFault,
];

/// Rows are states, columns events, in the order above: initial of the next state (`d` Parked, `X` Fault),
/// then of the reaction (`.` continue, `!` refuse, `e` enable, `t` track, `p` park, `l` park at last, `b` brake, `r` release).
const TABLE: [&str; 7] = [
    "Ae I! I! I. I. I. I. Sr I. Xr I!",
    "A. Tt Pp A. A. A. A. Sr Sr Xr A!",
    "T! T. Pp Pl Pb T. T. Sr Sr Xr T!",
    "P! P! Pp P. P. dr Sr Sr Sr Xr P!",
    "Ae Tt Pp d. d. d. d. Sr Sr Xr d!",
    "Ae S! S! S. S. S. S. Sr Sr Xr S!",
    "X! X! X! X. X. X. X. Xr Xr Xr Ir",
];

fn letters(state: State, reaction: Reaction) -> [u8; 2] {
    let state = match state {
        State::Idle => b'I',
        State::Armed => b'A',
        State::Tracking => b'T',
        State::Parking => b'P',
        State::Parked => b'd',
        State::Stopped => b'S',
        State::Fault => b'X',
    };
    let reaction = match reaction {
        Reaction::Continue => b'.',
        Reaction::Refuse => b'!',
        Reaction::Enable => b'e',
        Reaction::StartTracking => b't',
        Reaction::StartParking => b'p',
        Reaction::ParkAtLastReference => b'l',
        Reaction::Brake => b'b',
        Reaction::Release => b'r',
    };
    [state, reaction]
}

fn pairs() -> impl Iterator<Item = (State, Event)> {
    STATES
        .into_iter()
        .flat_map(|state| EVENTS.into_iter().map(move |event| (state, event)))
}

#[test]
fn every_pair_is_as_tabled() {
    for (state, row) in STATES.into_iter().zip(TABLE) {
        let mut cells = row.split(' ');
        for (event, cell) in EVENTS.into_iter().zip(&mut cells) {
            let (after, reaction) = next(state, event);
            assert_eq!(
                letters(after, reaction),
                cell.as_bytes(),
                "{event:?} in {state:?}"
            );
        }
        assert_eq!(cells.next(), None, "{state:?} has a cell too many");
    }
}

#[test]
fn stop_and_fault_end_torque_from_every_state() {
    for state in STATES {
        for event in [Event::Stop, Event::Fault] {
            let (after, reaction) = next(state, event);
            assert!(
                !after.drives() && reaction == Reaction::Release,
                "{event:?} in {state:?}"
            );
        }
        assert!(
            !next(state, Event::LinkLost).0.drives(),
            "lost link in {state:?}"
        );
    }
}

#[test]
fn whoever_ceases_to_drive_releases_the_wheels() {
    for (state, event) in pairs() {
        let (after, reaction) = next(state, event);
        if state.drives() && !after.drives() {
            assert_eq!(reaction, Reaction::Release, "{event:?} in {state:?}");
        }
    }
}

#[test]
fn only_a_reset_leaves_the_fault() {
    for event in EVENTS {
        let (after, _) = next(State::Fault, event);
        assert_eq!(
            after != State::Fault,
            event == Event::ResetFault,
            "{event:?}"
        );
    }
}

#[test]
fn idle_and_stopped_move_only_after_arming() {
    for event in EVENTS {
        for state in [State::Idle, State::Stopped, State::Fault] {
            assert!(!next(state, event).0.drives(), "{event:?} in {state:?}");
        }
    }
}

#[test]
fn refusal_never_changes_the_state() {
    for (state, event) in pairs() {
        let (after, reaction) = next(state, event);
        if reaction == Reaction::Refuse {
            assert_eq!(after, state, "{event:?} in {state:?}");
        }
    }
}
