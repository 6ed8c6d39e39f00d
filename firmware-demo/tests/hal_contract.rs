//! What every `WheelDrive`, `WheelSpeedDrive` and `YawGyro` promises, tried on every implementation of this package.

use crate::outputs::{motor, side};
use crate::wire::Wire;
use controller_core::base::{BaseController, Order, Sensed};
use controller_core::gyro::{GyroFault, GyroOutcome, GyroParams};
use controller_core::hal::{Error, ErrorKind, GyroReading, WheelDrive, WheelSpeedDrive, YawGyro};
use controller_core::types::{Pose, WheelSpeeds, WheelTorques};
use firmware_demo::drive::{
    Bridges, Call, MockDrive, MockGyro, MockSpeedDrive, MotorPair, OffPhase, Script,
};
use firmware_demo::mission;

/// What the hardware does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Does {
    /// Which wheels are driven forward.
    Drives([bool; 2]),
    Coasts,
    Brakes,
}

/// What the hardware is able to do.
#[derive(Clone, Copy)]
struct Able {
    release: Does,
    brake: Does,
}

const BOTH: Able = Able {
    release: Does::Coasts,
    brake: Does::Brakes,
};

/// The contract. `does` looks at what the hardware does.
fn contract<D: WheelDrive>(mut drive: D, able: Able, does: impl Fn(&D) -> Does) {
    let limit = drive.max_torque_nm();
    assert!(limit > 0.0 && limit.is_finite());
    let set = |drive: &mut D, right: f32, left: f32| {
        drive
            .set_torques(WheelTorques { right, left })
            .map_err(|error| error.kind())
    };
    drive.release().unwrap();
    assert_eq!(does(&drive), able.release, "released");
    drive.release().unwrap();
    assert_eq!(does(&drive), able.release, "twice in a row");
    drive.brake().unwrap();
    assert_eq!(does(&drive), able.brake, "braked");
    drive.brake().unwrap();
    assert_eq!(does(&drive), able.brake, "twice in a row");
    assert_eq!(
        set(&mut drive, limit, -limit),
        Ok(()),
        "the limit is allowed"
    );
    let driving = Does::Drives([true, false]);
    assert_eq!(does(&drive), driving);
    for wrong in [f32::NAN, f32::INFINITY, limit * 1.001, -limit * 1.001] {
        let refused = Err(ErrorKind::OutOfRange);
        assert_eq!(set(&mut drive, wrong, 0.0), refused, "{wrong}");
        assert_eq!(set(&mut drive, 0.0, wrong), refused, "{wrong}");
        assert_eq!(does(&drive), driving, "refused: as it was");
    }
    // Through a reference it is the same drive.
    fn borrowed(mut drive: impl WheelDrive, right: f32, left: f32) {
        drive.set_torques(WheelTorques { right, left }).unwrap();
    }
    borrowed(&mut drive, -0.5 * limit, 0.5 * limit);
    let turning = Does::Drives([false, true]);
    assert_eq!(does(&drive), turning, "both wheels by one call");
    drive.brake().unwrap();
    assert_eq!(does(&drive), able.brake, "braked while driving");
    drive.release().unwrap();
    assert_eq!(does(&drive), able.release, "released while braked");
    borrowed(&mut drive, -0.5 * limit, 0.5 * limit);
    assert_eq!(does(&drive), turning, "on again");
    drive.release().unwrap();
    assert_eq!(does(&drive), able.release);
}

/// The contract for speeds.
fn speed_contract<D: WheelSpeedDrive>(mut drive: D, does: impl Fn(&D) -> Does) {
    let limit = drive.max_speed_rad_s();
    assert!(limit > 0.0 && limit.is_finite());
    for _ in 0..2 {
        drive.release().unwrap();
        assert_eq!(does(&drive), Does::Coasts);
    }
    for _ in 0..2 {
        drive.brake().unwrap();
        assert_eq!(does(&drive), Does::Brakes);
    }
    let set = |drive: &mut D, right: f32, left: f32| {
        drive
            .set_speeds(WheelSpeeds { right, left })
            .map_err(|error| error.kind())
    };
    assert_eq!(set(&mut drive, limit, -limit), Ok(()));
    for wrong in [f32::NAN, f32::NEG_INFINITY, limit * 1.001] {
        assert_eq!(set(&mut drive, wrong, 0.0), Err(ErrorKind::OutOfRange));
        assert_eq!(set(&mut drive, 0.0, wrong), Err(ErrorKind::OutOfRange));
        assert_eq!(does(&drive), Does::Drives([true, false]), "as it was");
    }
    fn borrowed(mut drive: impl WheelSpeedDrive, limit: f32) {
        assert_eq!(drive.max_speed_rad_s(), limit);
        drive.release().unwrap();
        drive.brake().unwrap();
        drive.set_speeds(WheelSpeeds::default()).unwrap();
    }
    borrowed(&mut drive, limit);
    assert_eq!(does(&drive), Does::Drives([false, false]));
}

#[test]
fn mocks_keep_the_contract() {
    contract(MockDrive::<4>::new(2.5), BOTH, |drive| {
        match drive.output() {
            Call::Set(applied) => Does::Drives([applied.right > 0.0, applied.left > 0.0]),
            Call::Release => Does::Coasts,
            Call::Brake => Does::Brakes,
        }
    });
    speed_contract(MockSpeedDrive::<4>::new(9.0), |drive| {
        match drive.output() {
            Call::Set(applied) => Does::Drives([applied.right > 0.0, applied.left > 0.0]),
            Call::Release => Does::Coasts,
            Call::Brake => Does::Brakes,
        }
    });
}

#[test]
fn a_mock_counts_brakes_and_fails_them_on_demand() {
    let mut drive = MockDrive::<4>::new(1.0);
    drive.brake().unwrap();
    drive.fail(Script {
        from: 0,
        count: 1,
        kind: Some(ErrorKind::OverCurrent),
    });
    assert_eq!(drive.brake(), Err(ErrorKind::OverCurrent));
    assert_eq!((drive.brakes(), drive.calls()), (2, 2));
    assert_eq!(drive.applied(), None);
    assert!(drive.last_calls().all(|call| *call == Call::Brake));
}

/// Every kind of bridge, as its truth table has it.
#[test]
fn motor_pair_keeps_the_contract_on_every_bridge() {
    let brakes_only = Able {
        release: Does::Brakes,
        brake: Does::Brakes,
    };
    let coasts_only = Able {
        release: Does::Coasts,
        brake: Does::Coasts,
    };
    for (off_phase, has_enable, able) in [
        (OffPhase::Shorted, true, BOTH),
        (OffPhase::Shorted, false, brakes_only),
        (OffPhase::Free, true, coasts_only),
        (OffPhase::Free, false, coasts_only),
    ] {
        let levels: [Wire; 5] = Default::default();
        let [right, right_back, left, left_back, enable] = levels.clone();
        let bridges = Bridges {
            off_phase,
            enable: has_enable.then_some(enable),
        };
        assert_eq!(bridges.can_release(), able.release == Does::Coasts);
        assert_eq!(bridges.can_brake(), able.brake == Does::Brakes);
        let pair = MotorPair::new(
            side(right, right_back),
            side(left, left_back),
            bridges,
            motor(),
        );
        contract(pair, able, |_| {
            let [right, right_back, left, left_back, enable] =
                levels.each_ref().map(|level| level.0.get());
            match (enable == 1 || !has_enable, right > 0 && left > 0) {
                (false, _) => Does::Coasts,
                (true, true) => Does::Drives([right_back == 0, left_back == 0]),
                (true, false) if off_phase == OffPhase::Shorted => Does::Brakes,
                (true, false) => Does::Coasts,
            }
        });
    }
}

/// Each reading comes once; a gyro that fails says with what, and to a base that is silence, found by name within 0.15 s.
#[test]
fn a_gyro_gives_each_reading_once_and_is_missed_when_it_fails() {
    let mut gyro = MockGyro::new();
    assert_eq!(gyro.reading(), Ok(None), "nothing measured yet");
    let measured = GyroReading {
        rate: 0.01,
        heading: None,
        age_s: 0.002,
    };
    gyro.measure(measured);
    // Through a reference it is the same gyro.
    fn borrowed(mut gyro: impl YawGyro) -> Option<GyroReading<f32>> {
        gyro.reading().unwrap_or(None)
    }
    assert_eq!(borrowed(&mut gyro), Some(measured));
    assert_eq!(gyro.reading(), Ok(None), "once");
    gyro.fail(Script {
        from: 1,
        count: 2,
        kind: Some(ErrorKind::Other),
    });
    let answers: Vec<_> = (0..4).map(|_| gyro.reading()).collect();
    let fails = Err(ErrorKind::Other);
    assert_eq!(answers, [Ok(None), fails, fails, Ok(None)]);

    let mut params = mission::params(15.0, false).unwrap();
    params.localiser.gyro = Some(GyroParams::icm_42688_p());
    let params = params.validate().unwrap();
    let mut base = BaseController::<f32>::new(&params, Pose::default());
    let mut tick = |gyro: &mut MockGyro| {
        // As a board does it.
        let sensed = Sensed {
            gyro: gyro.reading().unwrap_or(None),
            ..Sensed::of_counts(Default::default())
        };
        base.tick(10_000, &Order::None, &sensed).gyro
    };
    for _ in 0..100 {
        gyro.measure(measured);
        tick(&mut gyro);
    }
    gyro.measure(measured);
    let report = tick(&mut gyro);
    assert_eq!((report.outcome, report.fault), (GyroOutcome::Used, None));
    gyro.fail(Script {
        from: 0,
        count: u32::MAX,
        kind: None,
    });
    let silent = (1..=15).find(|_| {
        gyro.measure(measured);
        tick(&mut gyro).fault == Some(GyroFault::Silent)
    });
    assert!(
        silent.is_some_and(|ticks| ticks > 1),
        "{silent:?} ticks of 10 ms"
    );
}
