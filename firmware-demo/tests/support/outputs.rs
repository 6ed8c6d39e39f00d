//! Outputs of a board that work, and a motor on them.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use controller_core::motor::{Motor, MotorParams, WheelFriction};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use firmware_demo::drive::MotorSide;

/// Pins and PWM that work and remember their level.
#[derive(Clone, Default)]
pub struct Level16(pub Rc<Cell<u16>>);

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
pub fn motor() -> Motor<f32> {
    let params = MotorParams {
        gear_ratio: 20.0,
        gear_efficiency: 1.0,
        torque_constant_nm_per_a: 0.05,
        resistance_ohm: 2.0,
        supply_v: 20.0,
        max_current_a: 4.0,
        friction: WheelFriction::NONE,
        dead_band: 0.0,
        rotor_inertia_kg_m2: 0.0,
    };
    params.validate().unwrap()
}

pub fn side<P, D>(pwm: P, direction: D) -> MotorSide<P, D> {
    MotorSide { pwm, direction }
}
