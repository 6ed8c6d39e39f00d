//! The supervisor in time: ends of stops, latches, active faults.

use super::*;
use crate::error::{Field, Problem};
use crate::hal::ErrorKind;
use crate::safety::{
    ActiveFaults, Fault, FaultKind, PolicyParams, Side, Timeout, ValidPolicyParams,
};

#[test]
fn a_stop_ends_when_the_base_rests_for_the_dwell() {
    let mut supervisor = supervisor_in(State::Tracking, SupervisorParams::DEFAULT);
    assert_eq!(supervisor.on(Event::LinkLost), Action::BeginStop);
    assert_eq!(supervisor.output(), OutputMode::ControlledStop);
    for k in 0..9 {
        assert_eq!(supervisor.tick(10_000, true), Action::Continue, "{k}");
    }
    // Moving again: the dwell starts anew.
    assert_eq!(supervisor.tick(10_000, false), Action::Continue);
    for _ in 0..9 {
        assert_eq!(supervisor.tick(10_000, true), Action::Continue);
    }
    assert_eq!(supervisor.tick(10_000, true), Action::Release);
    assert_eq!(supervisor.state(), State::Stopped);
    assert_eq!(supervisor.cause(), Cause::LinkLost);
}

/// What does not come to rest is braked after the limit, and ends after the second: 10 s at most.
#[test]
fn stops_are_bounded_in_time() {
    let mut supervisor = supervisor_in(State::Tracking, SupervisorParams::DEFAULT);
    supervisor.on(Event::Stop);
    let mut braked = 0;
    for k in 1..=1000 {
        if supervisor.tick(10_000, false) == Action::Brake {
            // The second time as it ends: shorted motors stay so.
            assert!(k == 500 || k == 1000, "{k}");
            braked += 1;
        }
    }
    assert_eq!((supervisor.state(), braked), (State::Stopped, 2));
    // A single endless tick is no way around it.
    let mut supervisor = supervisor_in(State::Tracking, SupervisorParams::DEFAULT);
    supervisor.on(Event::Stop);
    assert_eq!(supervisor.tick(u32::MAX, false), Action::Brake);
    assert_eq!(supervisor.tick(u32::MAX, false), Action::Brake);
    assert_eq!(supervisor.state(), State::Stopped);
}

/// A milder fault during a stop latches it without giving it more time.
#[test]
fn a_fault_during_a_stop_latches_and_does_not_prolong_it() {
    let policy = ValidPolicyParams::default();
    let mut supervisor = supervisor_in(State::Tracking, SupervisorParams::DEFAULT);
    supervisor.on(Event::Stop);
    for _ in 0..400 {
        supervisor.tick(10_000, false);
    }
    let mut active_faults = ActiveFaults::NONE;
    active_faults.add(Fault::UnderVoltage);
    assert_eq!(
        supervisor.on_active_faults(&active_faults, &policy),
        Action::Continue
    );
    assert_eq!(supervisor.state(), State::Stopping(Then::Fault));
    assert_eq!(supervisor.latched(), Some(Fault::UnderVoltage));
    for _ in 0..100 {
        supervisor.tick(10_000, false);
    }
    assert_eq!(supervisor.state(), State::Braking(Then::Fault));
    // The first one stays the latched one.
    let stuck = Fault::EncoderStuck(Side::Left);
    active_faults.add(stuck);
    supervisor.on_active_faults(&active_faults, &policy);
    assert_eq!(supervisor.latched(), Some(Fault::UnderVoltage));
    // The whole time of the brake, since encoders cannot show any more that the base rests.
    for _ in 0..500 {
        supervisor.tick(10_000, true);
    }
    assert_eq!(supervisor.state(), State::Fault);
    assert_eq!(supervisor.on(Event::Arm), Action::Refuse);
    supervisor.on(Event::Reset);
    assert_eq!(
        (supervisor.state(), supervisor.latched()),
        (State::Idle, None)
    );
}

/// What is released after a fault is braked again, as an idle base is, once it is reset; and once it was armed.
#[test]
fn a_reset_and_arming_forget_what_was_released() {
    let params = SupervisorParams {
        idle_output: IdleOutput::Brake,
        ..SupervisorParams::DEFAULT
    };
    let mut supervisor = supervisor_in(State::Tracking, params);
    supervisor.on(Event::EmergencyStop { brake: false });
    assert_eq!(supervisor.output(), OutputMode::Release);
    supervisor.on(Event::Reset);
    assert_eq!(supervisor.state(), State::Idle);
    assert_eq!(supervisor.output(), OutputMode::Brake);
    supervisor.on(Event::Arm);
    supervisor.on(Event::Stop);
    assert_eq!(supervisor.state(), State::Stopped);
    assert_eq!(supervisor.output(), OutputMode::Brake);
}

#[test]
fn ignored_faults_are_counted_and_reported() {
    let policy = ValidPolicyParams::default();
    let mut supervisor = supervisor_in(State::Parking, SupervisorParams::DEFAULT);
    let changes = supervisor.changes();
    let mut active_faults = ActiveFaults::NONE;
    active_faults.add(Fault::PoseJump);
    for _ in 0..3 {
        supervisor.on_active_faults(&active_faults, &policy);
    }
    assert_eq!(supervisor.ignored(), (3, Some(Fault::PoseJump)));
    assert_eq!(
        (supervisor.state(), supervisor.changes()),
        (State::Parking, changes)
    );
}

/// An idle base needs no host; its driver has to work all the same.
#[test]
fn only_the_driver_fails_what_stands() {
    let policy = ValidPolicyParams::default();
    for state in [State::Idle, State::Stopped, State::Fault] {
        for kind in FaultKind::ALL {
            let fault = match kind {
                FaultKind::CommandStale => Fault::CommandStale,
                FaultKind::MeasurementStale => Fault::MeasurementStale,
                FaultKind::Driver => Fault::Driver(ErrorKind::Bus),
                _ => continue,
            };
            let mut supervisor = supervisor_in(state, SupervisorParams::DEFAULT);
            let mut active_faults = ActiveFaults::NONE;
            active_faults.add(fault);
            supervisor.on_active_faults(&active_faults, &policy);
            let expected = if kind == FaultKind::Driver {
                State::Fault
            } else {
                state
            };
            assert_eq!(supervisor.state(), expected, "{kind} in {state:?}");
        }
    }
}

/// Each response of a policy gets its output in the very call.
#[test]
fn every_reaction_is_the_output_of_the_same_call() {
    for (reaction, output) in [
        (Reaction::Ignore, OutputMode::Drive),
        (Reaction::ControlledStop, OutputMode::ControlledStop),
        (Reaction::Brake, OutputMode::Brake),
        (Reaction::Release, OutputMode::Release),
    ] {
        let response = Response::passing(reaction);
        let policy = PolicyParams::DEFAULT.with(FaultKind::WheelSlip, response);
        let policy = policy.validate().expect("valid");
        let mut supervisor = supervisor_in(State::Tracking, SupervisorParams::DEFAULT);
        let mut active_faults = ActiveFaults::NONE;
        active_faults.add(Fault::WheelSlip(Side::Right));
        supervisor.on_active_faults(&active_faults, &policy);
        assert_eq!(supervisor.output(), output);
    }
}

#[test]
fn the_button_does_what_is_set_up_and_latches() {
    for (emergency, output) in [
        (Emergency::Brake, OutputMode::Brake),
        (Emergency::Release, OutputMode::Release),
    ] {
        let params = SupervisorParams {
            emergency,
            ..SupervisorParams::DEFAULT
        };
        let mut supervisor = supervisor_in(State::Tracking, params);
        supervisor.emergency_stop();
        assert_eq!(supervisor.output(), output);
        for _ in 0..20 {
            supervisor.tick(10_000, true);
        }
        assert_eq!(supervisor.state(), State::Fault);
        assert_eq!(supervisor.cause(), Cause::EmergencyStop);
    }
}

#[test]
fn parameters_out_of_range_are_named() {
    let default = SupervisorParams::DEFAULT;
    assert_eq!(default.validate(), Ok(ValidSupervisorParams::default()));
    let short = SupervisorParams {
        stop_limit: Timeout::AfterUs(100_000),
        ..default
    };
    let error = short.validate().expect_err("not longer than the dwell");
    assert_eq!(error.field, Field::StopLimit);
    assert_eq!(error.problem, Problem::Below(100_001.0));
    let mut wild = default;
    wild.rest.speed_m_s = f32::NAN;
    assert_eq!(wild.validate().expect_err("NaN").field, Field::RestSpeed);
    let endless = SupervisorParams {
        brake_limit: Timeout::Off,
        ..default
    };
    assert!(endless.validate().is_ok(), "off because it says so");
}

/// A dead encoder says that the base stands; that does not end the braking, its limit does.
#[test]
fn rest_is_not_believed_from_a_broken_measurement() {
    let mut supervisor = supervisor_in(State::Tracking, SupervisorParams::DEFAULT);
    let mut active_faults = ActiveFaults::NONE;
    active_faults.add(Fault::EncoderStuck(Side::Both));
    supervisor.on_active_faults(&active_faults, &ValidPolicyParams::default());
    for _ in 0..499 {
        assert_eq!(supervisor.tick(10_000, true), Action::Continue);
        assert_eq!(supervisor.output(), OutputMode::Brake);
    }
    assert_eq!(supervisor.tick(10_000, true), Action::Brake);
    assert_eq!(supervisor.state(), State::Fault);
    assert_eq!(supervisor.output(), OutputMode::Brake);
}

/// Rest is slower than both limits, whichever way; parameters for what is to come change it, and neither state nor cause; changes of
/// state are counted.
#[test]
fn rest_is_within_both_limits() {
    let mut supervisor = supervisor_in(State::Idle, SupervisorParams::DEFAULT);
    assert!(supervisor.rests(0.009, -0.019) && supervisor.rests(-0.009, 0.019));
    for (speed, turn) in [(0.01, 0.0), (-0.011, 0.0), (0.0, 0.02), (0.0, -0.021)] {
        assert!(!supervisor.rests(speed, turn), "{speed} {turn}");
    }
    let mut params = SupervisorParams::DEFAULT;
    params.rest.speed_m_s = 0.1;
    supervisor.reconfigure(&params.validate().expect("valid"));
    assert!(supervisor.rests(0.09, 0.0) && !supervisor.rests(0.09, 0.021));
    let before = supervisor.changes();
    supervisor.on(Event::Arm);
    supervisor.on(Event::Arm);
    assert_eq!(supervisor.changes(), before + 1);
    assert_eq!(supervisor.state(), State::Armed);
    for state in State::ALL {
        let stops = matches!(state, State::Stopping(_) | State::Braking(_));
        assert_eq!(state.ends_at_rest(), stops, "{state:?}");
    }
}
