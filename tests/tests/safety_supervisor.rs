//! The supervisor under any sequence of events, active faults and ticks.

use controller_core::safety::supervisor::{Event, State, SupervisorParams};
use controller_core::safety::{
    ActiveFaults, Fault, FaultKind, OutputMode, Reaction, Side, Supervisor, ValidPolicyParams,
};
use proptest::prelude::*;

/// A fault of each kind that carries little.
fn fault(kind: FaultKind) -> Fault {
    match kind {
        FaultKind::EncoderReversed => Fault::EncoderReversed(Side::Both),
        FaultKind::Driver => Fault::Driver(controller_core::hal::ErrorKind::Bus),
        FaultKind::UnderVoltage => Fault::UnderVoltage,
        FaultKind::PoseJump => Fault::PoseJump,
        FaultKind::MeasurementStale => Fault::MeasurementStale,
        _ => Fault::CommandStale,
    }
}

#[derive(Clone, Copy, Debug)]
enum Step {
    On(Event),
    Found(Fault),
    Tick(u32, bool),
    Button,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        (0..Event::ALL.len()).prop_map(|k| Step::On(Event::ALL[k])),
        (0..FaultKind::COUNT).prop_map(|k| Step::Found(fault(FaultKind::ALL[k]))),
        (0_u32..2_000_000, any::<bool>()).prop_map(|(us, rests)| Step::Tick(us, rests)),
        Just(Step::On(Event::Arm)),
        Just(Step::On(Event::Track)),
        Just(Step::On(Event::Drive)),
        Just(Step::Button),
    ]
}

proptest! {
    /// Torque begins only by a command from an armed state; faults never make the output milder, nor does the button but by braking
    /// what stands; Fault is left by a reset only; a stop ends within its two limits.
    #[test]
    fn walks_keep_the_rules(steps in prop::collection::vec(step(), 1..200)) {
        let policy = ValidPolicyParams::default();
        let mut supervisor = Supervisor::new(&SupervisorParams::DEFAULT.validate().expect("valid"));
        let mut stopping_us = 0_u64;
        for step in steps {
            let (state, before) = (supervisor.state(), supervisor.output());
            match step {
                Step::On(event) => { supervisor.on(event); }
                Step::Found(fault) => {
                    let mut active_faults = ActiveFaults::NONE;
                    active_faults.add(fault);
                    supervisor.on_active_faults(&active_faults, &policy);
                }
                Step::Tick(us, rests) => { supervisor.tick(us, rests); }
                Step::Button => { supervisor.emergency_stop(); }
            }
            let (now, after) = (supervisor.state(), supervisor.output());
            let asked = matches!(step, Step::On(Event::Track | Event::Park | Event::Drive | Event::TrajectoryEnded));
            let armed = matches!(state, State::Armed | State::Parked) || state.drives();
            prop_assert!(!now.drives() || state.drives() || (asked && armed), "{step:?} in {state:?}");
            let fails = matches!(step, Step::Found(_) | Step::Button | Step::On(Event::Fault(_)));
            let braked = matches!(step, Step::Button) && after == OutputMode::Brake && !state.is_live();
            prop_assert!(!fails || braked || after.severity() >= before.severity(), "{step:?} in {state:?}");
            if matches!(step, Step::Button) {
                prop_assert!(after.severity() >= Reaction::Brake);
            }
            if state == State::Fault && now != State::Fault {
                prop_assert!(matches!(step, Step::On(Event::Reset)));
                prop_assert_eq!(after, OutputMode::Release);
            }
            let stops = |state| matches!(state, State::Stopping(_) | State::Braking(_));
            match step {
                Step::Tick(us, _) if stops(state) => stopping_us += u64::from(us),
                _ if !stops(state) => stopping_us = 0,
                _ => {}
            }
            // 5 s each, and a tick of at most 2 s over each.
            prop_assert!(!stops(now) || stopping_us < 14_000_000, "{stopping_us} us in {now:?}");
        }
    }
}
