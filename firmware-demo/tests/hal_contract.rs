//! What every `WheelDrive` promises, tried on every implementation of this package.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use controller_core::hal::{Error, ErrorKind, WheelDrive};
use controller_core::types::{WheelSpeeds, WheelTorques};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State as Level, Transaction as PinStep};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as PwmStep};
use firmware_demo::drive::{MockDrive, MotorPair, MotorParams, MotorSide, ValidMotor};

/// The contract. `told` looks at what the hardware does: torques' signs, or `None` for free wheels.
fn contract<D: WheelDrive>(mut drive: D, told: impl Fn(&D) -> Option<[bool; 2]>) {
    let limit = drive.max_torque_nm();
    assert!(limit > 0.0 && limit.is_finite());
    let set = |drive: &mut D, right: f32, left: f32| {
        drive
            .set_torques(WheelTorques { right, left })
            .map_err(|error| error.kind())
    };
    drive.release().unwrap();
    assert_eq!(told(&drive), None, "released");
    drive.release().unwrap();
    assert_eq!(told(&drive), None, "twice in a row");
    assert_eq!(
        set(&mut drive, limit, -limit),
        Ok(()),
        "the limit is allowed"
    );
    assert_eq!(told(&drive), Some([true, false]));
    for wrong in [f32::NAN, f32::INFINITY, limit * 1.001, -limit * 1.001] {
        let refused = Err(ErrorKind::OutOfRange);
        assert_eq!(set(&mut drive, wrong, 0.0), refused, "{wrong}");
        assert_eq!(set(&mut drive, 0.0, wrong), refused, "{wrong}");
        assert_eq!(told(&drive), Some([true, false]), "refused: as it was");
    }
    // Through a reference it is the same drive.
    fn borrowed(mut drive: impl WheelDrive, right: f32, left: f32) {
        drive.set_torques(WheelTorques { right, left }).unwrap();
    }
    borrowed(&mut drive, -0.5 * limit, 0.5 * limit);
    assert_eq!(told(&drive), Some([false, true]), "both wheels by one call");
    drive.release().unwrap();
    assert_eq!(told(&drive), None);
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
fn motor() -> ValidMotor {
    let params = MotorParams {
        gear_ratio: 20.0,
        torque_constant: 0.05,
        resistance_ohm: 2.0,
        supply_v: 20.0,
        max_current_a: 4.0,
    };
    params.validate().unwrap()
}

#[test]
fn mock_keeps_the_contract() {
    contract(MockDrive::<4>::new(2.5), |drive| {
        drive.told().map(|told| [told.right > 0.0, told.left > 0.0])
    });
}

#[test]
fn motor_pair_keeps_the_contract() {
    let levels: [Level16; 4] = Default::default();
    let [right_pwm, right_direction, left_pwm, left_direction] = levels.clone();
    let right = MotorSide {
        pwm: right_pwm,
        direction: right_direction,
    };
    let left = MotorSide {
        pwm: left_pwm,
        direction: left_direction,
    };
    contract(MotorPair::new(right, left, motor()), |_| {
        let [right, right_back, left, left_back] = levels.each_ref().map(|level| level.0.get());
        (right > 0 && left > 0).then_some([right_back == 0, left_back == 0])
    });
}

/// The very calls on each of the four outputs; the mocks fail on any other, and on one that is missing.
#[test]
fn motor_pair_makes_these_calls_and_no_others() {
    let duty = PwmStep::set_duty_cycle;
    let max = || PwmStep::max_duty_cycle(1000);
    let (low, high) = (|| PinStep::set(Level::Low), || PinStep::set(Level::High));
    let right = MotorSide {
        // release | forward 1 N m at 5 rad/s | the same, slower | release
        pwm: Pwm::new(&[duty(0), max(), duty(350), max(), duty(150), duty(0)]),
        direction: Pin::new(&[low(), low()]),
    };
    let left = MotorSide {
        // release | backward 2 N m at rest: off while the direction changes | forward again | release
        pwm: Pwm::new(&[
            duty(0),
            duty(0),
            max(),
            duty(200),
            duty(0),
            max(),
            duty(50),
            duty(0),
        ]),
        direction: Pin::new(&[low(), high(), low(), low()]),
    };
    let torques = |right, left| WheelTorques { right, left };
    let mut pair = MotorPair::new(right, left, motor());
    pair.release().unwrap();
    pair.observe(&WheelSpeeds {
        right: 5.0,
        left: 0.0,
    });
    pair.set_torques(torques(1.0, -2.0)).unwrap();
    pair.observe(&WheelSpeeds {
        right: 1.0,
        left: f32::NAN,
    });
    pair.set_torques(torques(1.0, 0.5)).unwrap();
    pair.release().unwrap();
    done(pair);
}

#[test]
fn release_tries_everything_whatever_fails() {
    let broken = || embedded_hal_mock::eh1::MockError::Io(std::io::ErrorKind::Other);
    let right = MotorSide {
        pwm: Pwm::new(&[PwmStep::set_duty_cycle(0).with_error(broken())]),
        direction: Pin::new(&[PinStep::set(Level::Low).with_error(broken())]),
    };
    let left = MotorSide {
        pwm: Pwm::new(&[PwmStep::set_duty_cycle(0)]),
        direction: Pin::new(&[PinStep::set(Level::Low)]),
    };
    let mut pair = MotorPair::new(right, left, motor());
    assert_eq!(
        pair.release().map_err(|error| error.kind()),
        Err(ErrorKind::Bus)
    );
    done(pair);
}

fn done(pair: MotorPair<Pwm, Pin>) {
    let (right, left) = pair.into_sides();
    for mut side in [right, left] {
        side.pwm.done();
        side.direction.done();
    }
}

#[test]
fn torque_becomes_duty_through_current_and_back_emf() {
    let motor = motor();
    // 1 N m = 1 A = 2 V of 20 V, at rest.
    assert_eq!(motor.share(1.0, 0.0), 0.1);
    // At 5 rad/s 5 V more.
    assert_eq!(motor.share(1.0, 5.0), 0.35);
    // Braking: the motor's own voltage does the work.
    assert_eq!(motor.share(-1.0, 2.0), 0.0);
    // Beyond the supply: all there is.
    assert_eq!(motor.share(4.0, 40.0), 1.0);
    assert_eq!(motor.share(-4.0, -40.0), -1.0);
}

#[test]
fn motor_parameters_are_checked_one_by_one() {
    let good = *motor().params();
    let wrong = [
        MotorParams {
            gear_ratio: 0.0,
            ..good
        },
        MotorParams {
            torque_constant: -0.05,
            ..good
        },
        MotorParams {
            resistance_ohm: f32::NAN,
            ..good
        },
        MotorParams {
            supply_v: f32::INFINITY,
            ..good
        },
        MotorParams {
            max_current_a: 0.0,
            ..good
        },
    ];
    let names = [
        "gear_ratio",
        "torque_constant",
        "resistance_ohm",
        "supply_v",
        "max_current_a",
    ];
    for (params, name) in wrong.into_iter().zip(names) {
        assert_eq!(params.validate().unwrap_err().0, name);
    }
}
