//! A fault of each kind, and what has to come of it.

use controller_core::base::BaseParams;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::safety::{FaultKind, Reaction};
use controller_core::types::Pose;
use firmware_demo::drive::{Call, Script};
use protocol::{Command, RejectReason};

use crate::rig::{Rig, params};

/// Runs `tick` until `kind` is found, within so many ticks, then looks at that very tick, and at the end of it all.
pub fn reaches(kind: FaultKind, within: u32, mut rig: Rig, mut tick: impl FnMut(&mut Rig, u32)) {
    let mut ticks = 0;
    let fault = loop {
        assert!(ticks < within, "{kind}: {:?} after {ticks} ticks", rig.is());
        tick(&mut rig, ticks);
        ticks += 1;
        if let Some(fault) = rig.task.report().active_faults.get(kind) {
            break fault;
        }
    };
    let response = rig.task.params().policy.get(kind);
    let state = rig.task.state();
    println!(
        "{kind}: {ticks} ticks, {:?} in {state:?}",
        response.reaction
    );
    let output = rig.task.drive_mut().output();
    let then = Then::Stopped.or(response.latch);
    match response.reaction {
        Reaction::Ignore => {
            assert!(state.drives() && matches!(output, Call::Set(_)));
            assert!(rig.task.controller().supervisor().ignored().0 > 0);
            return;
        }
        Reaction::ControlledStop => {
            assert_eq!(state, State::Stopping(then), "{kind}");
            assert!(matches!(output, Call::Set(_)), "{kind}");
        }
        Reaction::Brake => {
            assert_eq!(state, State::Braking(then), "{kind}");
            assert_eq!(output, Call::Brake, "{kind}");
        }
        Reaction::Release => {
            assert_eq!(state, then.state(), "{kind}");
            assert_eq!(output, Call::Release, "{kind}");
        }
    }
    assert_eq!(rig.task.cause(), Cause::Fault(fault), "{kind}");
    rig.task.drive_mut().fail(Script::default());
    // 5 s to come to rest, 5 s of braking, and nothing afterwards.
    rig.run_until(10_500, |rig| rig.task.state() == then.state());
    rig.run(200);
    assert_eq!(rig.task.state(), then.state(), "{kind}");
    // What was braked stays braked.
    let output = match response.reaction {
        Reaction::Brake => Call::Brake,
        _ => Call::Release,
    };
    assert_eq!(rig.task.drive_mut().output(), output, "{kind}");
    assert_eq!(rig.park(1.0, 0.0, 0.0), Err(RejectReason::State));
    if response.latch {
        assert_eq!(rig.command(Command::Arm), Err(RejectReason::State));
        assert_eq!(rig.command(Command::ResetFault), Ok(()));
        assert_eq!(rig.task.state(), State::Idle, "{kind}");
    }
    assert_eq!(rig.command(Command::Arm), Ok(()), "{kind}");
}

pub fn with(change: impl FnOnce(&mut BaseParams<f32>)) -> Rig {
    let mut params = params();
    change(&mut params);
    moving(Rig::with(params, Pose::default()))
}

/// Armed, on the way to a goal far ahead.
pub fn moving(mut rig: Rig) -> Rig {
    rig.command(Command::Arm).unwrap();
    rig.park(4.0, 0.0, 0.0).unwrap();
    rig.run(500);
    assert_eq!(rig.task.state(), State::Parking);
    rig
}
