//! Faults of drivers, motors and battery on the task.

use crate::reaches::{reaches, with};
use crate::rig::{PERIOD_US, Rig};
use controller_core::base::WheelAction;
use controller_core::hal::ErrorKind;
use controller_core::safety::supervisor::{Cause, State};
use controller_core::safety::{
    CurrentDetectorParams, Currents, Fault, FaultKind, SupplyDetectorParams, Timeout,
};
use firmware_demo::drive::{Call, Script};

#[test]
fn driver_error_releases_in_the_same_tick() {
    for kind in [
        ErrorKind::Bus,
        ErrorKind::OverCurrent,
        ErrorKind::UnderVoltage,
    ] {
        let mut rig = Rig::tracking();
        let script = Script {
            from: 0,
            count: 1,
            kind: Some(kind),
        };
        rig.task.drive_mut().fail(script);
        rig.tick();
        assert_eq!(rig.task.drive_mut().output(), Call::Release, "at once");
        assert_eq!(*rig.task.output(), WheelAction::Release);
        reaches(FaultKind::Driver, 1, rig, |rig, _| rig.tick());
    }
}

#[test]
fn release_is_tried_again_until_the_driver_obeys() {
    let mut rig = Rig::tracking();
    let script = Script {
        from: 0,
        count: 4,
        kind: None,
    };
    rig.task.drive_mut().fail(script);
    rig.tick();
    assert!(
        rig.task.drive_mut().applied().is_some(),
        "the driver did not obey"
    );
    rig.tick();
    assert_eq!(
        rig.is(),
        (State::Fault, Cause::Fault(Fault::Driver(ErrorKind::Bus)))
    );
    rig.run(3);
    assert_eq!(rig.task.drive_mut().output(), Call::Release);
}

#[test]
fn current_above_its_limit_releases() {
    let rig = with(|params| {
        params.detectors.current = CurrentDetectorParams {
            limit_a: 10.0,
            after: Timeout::AfterUs(10_000),
        };
    });
    reaches(FaultKind::OverCurrent, 10, rig, |rig, _| {
        let currents = Currents {
            right: -11.0,
            left: 0.0,
        };
        rig.tick_with(PERIOD_US, |sensed| sensed.currents = Some(currents));
    });
}

#[test]
fn empty_battery_stops() {
    let rig = with(|params| {
        params.detectors.supply = SupplyDetectorParams {
            low_v: 10.0,
            recovered_v: 11.0,
            after: Timeout::AfterUs(10_000),
        };
    });
    reaches(FaultKind::UnderVoltage, 10, rig, |rig, _| {
        rig.tick_with(PERIOD_US, |sensed| sensed.supply_v = Some(9.0));
    });
}
