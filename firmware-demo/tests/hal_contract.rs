//! What every `WheelDrive` and `WheelSpeedDrive` promises, tried on every implementation of this package.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use controller_core::hal::{Error, ErrorKind, WheelDrive, WheelSpeedDrive};
use controller_core::motor::{Motor, MotorParams, WheelFriction};
use controller_core::types::{WheelSpeeds, WheelTorques};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State as Level, Transaction as PinStep};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as PwmStep};
use firmware_demo::drive::{
    Bridges, Call, MockDrive, MockSpeedDrive, MotorError, MotorPair, MotorSide, Observed, OffPhase,
};

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

/// Pins and PWM that work and remember their level.
#[derive(Clone, Default)]
struct Level16(Rc<Cell<u16>>);

impl digital::ErrorType for Level16 {
    type Error = Infallible;
}

impl OutputPin for Level16 {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(0);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(1);
        Ok(())
    }
}

impl pwm::ErrorType for Level16 {
    type Error = Infallible;
}

impl SetDutyCycle for Level16 {
    fn max_duty_cycle(&self) -> u16 {
        1000
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.set(duty);
        Ok(())
    }
}

/// Gear 20, 0.05 N m/A: 1 N m at the wheel is 1 A, with 2 Ω 2 V of 20 V; 1 rad/s is 1 V.
fn motor() -> Motor<f32> {
    let params = MotorParams {
        gear_ratio: 20.0,
        gear_efficiency: 1.0,
        torque_constant_nm_per_a: 0.05,
        resistance_ohm: 2.0,
        supply_v: 20.0,
        max_current_a: 4.0,
        friction: WheelFriction::NONE,
        dead_band: 0.0,
    };
    params.validate().unwrap()
}

fn side<P, D>(pwm: P, direction: D) -> MotorSide<P, D> {
    MotorSide { pwm, direction }
}

#[test]
fn mocks_keep_the_contract() {
    contract(MockDrive::<4>::new(2.5), BOTH, |drive| {
        match drive.doing() {
            Call::Set(told) => Does::Drives([told.right > 0.0, told.left > 0.0]),
            Call::Release => Does::Coasts,
            Call::Brake => Does::Brakes,
        }
    });
    speed_contract(MockSpeedDrive::<4>::new(9.0), |drive| match drive.doing() {
        Call::Set(told) => Does::Drives([told.right > 0.0, told.left > 0.0]),
        Call::Release => Does::Coasts,
        Call::Brake => Does::Brakes,
    });
}

#[test]
fn a_mock_counts_brakes_and_fails_them_on_demand() {
    let mut drive = MockDrive::<4>::new(1.0);
    drive.brake().unwrap();
    drive.fail(firmware_demo::drive::Script {
        from: 0,
        count: 1,
        kind: Some(ErrorKind::OverCurrent),
    });
    assert_eq!(drive.brake(), Err(ErrorKind::OverCurrent));
    assert_eq!((drive.brakes(), drive.calls()), (2, 2));
    assert_eq!(drive.told(), None);
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
        let levels: [Level16; 5] = Default::default();
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

/// The very calls on each output; the mocks fail on any other, and on one that is missing.
#[test]
fn motor_pair_makes_these_calls_and_no_others() {
    let duty = PwmStep::set_duty_cycle;
    let max = || PwmStep::max_duty_cycle(1000);
    let (low, high) = (|| PinStep::set(Level::Low), || PinStep::set(Level::High));
    let right = side(
        // release | forward 1 N m at 5 rad/s | the same, slower, at 80 % of the supply | brake | release
        Pwm::new(&[
            duty(0),
            max(),
            duty(350),
            max(),
            duty(188),
            duty(0),
            duty(0),
        ]),
        Pin::new(&[low(), low()]),
    );
    let left = side(
        // release | backward 2 N m at rest: off while the direction changes | forward again | brake | release
        Pwm::new(&[
            duty(0),
            duty(0),
            max(),
            duty(200),
            duty(0),
            max(),
            duty(63),
            duty(0),
            duty(0),
        ]),
        Pin::new(&[low(), high(), low(), low()]),
    );
    let bridges = Bridges {
        off_phase: OffPhase::Shorted,
        enable: Some(Pin::new(&[low(), high(), high(), high(), low()])),
    };
    let torques = |right, left| WheelTorques { right, left };
    let speeds = |right, left| WheelSpeeds { right, left };
    let mut pair = MotorPair::new(right, left, bridges, motor());
    pair.release().unwrap();
    pair.observe(&Observed {
        speeds: speeds(5.0, 0.0),
        ..Observed::default()
    });
    pair.set_torques(torques(1.0, -2.0)).unwrap();
    assert!(pair.told().right.limited.supply_unknown, "not measured");
    pair.observe(&Observed {
        speeds: speeds(1.0, 0.0),
        supply_v: 16.0,
        ..Observed::default()
    });
    pair.set_torques(torques(1.0, 0.5)).unwrap();
    assert_eq!(pair.told().right.limited, Default::default());
    assert_eq!(pair.told().left.current_a, 0.5);
    // Not a number: refused, and nothing is touched.
    pair.observe(&Observed {
        speeds: speeds(1.0, f32::NAN),
        ..Observed::default()
    });
    let refused = pair.set_torques(torques(1.0, 0.5));
    assert_eq!(refused, Err(MotorError::Observation));
    pair.brake().unwrap();
    assert_eq!(*pair.told(), Default::default());
    pair.release().unwrap();
    done(pair);
}

/// Asked for more than the supply gives at this speed, the pair says what is left; else nothing.
#[test]
fn motor_pair_tells_what_it_could_not_exert() {
    let levels: [Level16; 4] = Default::default();
    let [right, right_back, left, left_back] = levels;
    let bridges = Bridges::without_enable(OffPhase::Shorted);
    let mut pair = MotorPair::new(
        side(right, right_back),
        side(left, left_back),
        bridges,
        motor(),
    );
    let torques = WheelTorques {
        right: 2.0,
        left: 2.0,
    };
    pair.set_torques(torques).unwrap();
    assert_eq!(pair.exerted(), None);
    let no_load = motor().no_load_speed_rad_s();
    pair.observe(&Observed {
        speeds: WheelSpeeds {
            right: 0.9 * no_load,
            left: 0.0,
        },
        ..Observed::default()
    });
    pair.set_torques(torques).unwrap();
    let exerted = pair.exerted().expect("the supply does not suffice");
    assert!(exerted.right > 0.0 && exerted.right < 1.9, "{exerted:?}");
    assert!((exerted.left - 2.0).abs() < 1.0e-5, "{exerted:?}");
    pair.release().unwrap();
    assert_eq!(pair.exerted(), None);
}

fn broken() -> embedded_hal_mock::eh1::MockError {
    embedded_hal_mock::eh1::MockError::Io(std::io::ErrorKind::Other)
}

#[test]
fn release_tries_everything_whatever_fails() {
    let low = || PinStep::set(Level::Low);
    let right = side(
        Pwm::new(&[PwmStep::set_duty_cycle(0).with_error(broken())]),
        Pin::new(&[low().with_error(broken())]),
    );
    let left = side(Pwm::new(&[PwmStep::set_duty_cycle(0)]), Pin::new(&[low()]));
    let bridges = Bridges {
        off_phase: OffPhase::Shorted,
        enable: Some(Pin::new(&[low().with_error(broken())])),
    };
    let mut pair = MotorPair::new(right, left, bridges, motor());
    assert_eq!(
        pair.release().map_err(|error| error.kind()),
        Err(ErrorKind::Bus)
    );
    done(pair);
}

/// High enable would drive the wheel whose duty could not be taken away.
#[test]
fn a_brake_that_fails_switches_the_bridges_off() {
    let right = side(
        Pwm::new(&[PwmStep::set_duty_cycle(0).with_error(broken())]),
        Pin::new(&[]),
    );
    let left = side(Pwm::new(&[PwmStep::set_duty_cycle(0)]), Pin::new(&[]));
    let bridges = Bridges {
        off_phase: OffPhase::Shorted,
        enable: Some(Pin::new(&[PinStep::set(Level::Low)])),
    };
    let mut pair = MotorPair::new(right, left, bridges, motor());
    assert_eq!(pair.brake(), Err(MotorError::Pwm));
    done(pair);
}

fn done(pair: MotorPair<Pwm, Pin, Pin>) {
    let (right, left, bridges) = pair.into_parts();
    for mut side in [right, left] {
        side.pwm.done();
        side.direction.done();
    }
    bridges.enable.into_iter().for_each(|mut pin| pin.done());
}
