//! What `MotorPair` does to its outputs, call by call, and what it does when one of them fails.

use crate::outputs::{motor, side};
use crate::wire::Wire;
use controller_core::hal::{Error, ErrorKind, WheelDrive};
use controller_core::types::{WheelSpeeds, WheelTorques};
use embedded_hal_mock::eh1::digital::{Mock as Pin, State as Level, Transaction as PinStep};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as PwmStep};
use firmware_demo::drive::{Bridges, DriveOutput, MotorError, MotorPair, Observed, OffPhase};
use protocol::pil::WheelOutput;

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
    assert_eq!(pair.output(), WheelOutput::Release);
    pair.observe(&Observed {
        speeds: speeds(5.0, 0.0),
        ..Observed::default()
    });
    pair.set_torques(torques(1.0, -2.0)).unwrap();
    // The duties that the outputs get in their steps of a thousandth.
    let WheelOutput::Duty { right, left } = pair.output() else {
        panic!("{:?}", pair.output())
    };
    assert!((right - 0.35).abs() < 5.0e-4 && (left + 0.2).abs() < 5.0e-4);
    assert!(pair.applied().right.limited.supply_unknown, "not measured");
    pair.observe(&Observed {
        speeds: speeds(1.0, 0.0),
        supply_v: 16.0,
        ..Observed::default()
    });
    pair.set_torques(torques(1.0, 0.5)).unwrap();
    assert_eq!(pair.applied().right.limited, Default::default());
    assert_eq!(pair.applied().left.current_a, 0.5);
    // Not a number: refused, and nothing is touched.
    pair.observe(&Observed {
        speeds: speeds(1.0, f32::NAN),
        ..Observed::default()
    });
    let refused = pair.set_torques(torques(1.0, 0.5));
    assert_eq!(refused, Err(MotorError::Observation));
    pair.brake().unwrap();
    assert_eq!(pair.output(), WheelOutput::Brake);
    assert_eq!(*pair.applied(), Default::default());
    pair.release().unwrap();
    done(pair);
}

/// Asked for more than the supply gives at this speed, the pair says what is left; else nothing.
#[test]
fn motor_pair_tells_what_it_could_not_exert() {
    let levels: [Wire; 4] = Default::default();
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
