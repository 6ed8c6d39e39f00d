//! DC motors on two half bridges: any board with a PWM output and a direction pin for each wheel.
//!
//! A torque becomes a current, and the current the voltage that drives it through the winding against the
//! motor's own back-EMF:
//!
//! ```text
//! i = τ/(g k_t)        u = R i + k_e g φ̇        duty = |u|/U        direction = sign u
//! ```
//!
//! | symbol | name | unit |
//! | --- | --- | --- |
//! | τ, φ̇ | torque and speed of the wheel | N m, rad/s |
//! | g | gear ratio, motor turns per wheel turn | |
//! | k_t, k_e | torque constant; in SI units the same number as the back-EMF constant | N m/A, V s/rad |
//! | R, U | winding and bridge, supply | Ω, V |
//!
//! The winding's inductance and the gear's friction are left out.

use core::error::Error as CoreError;
use core::fmt::{self, Display, Formatter};

use controller_core::hal::{Error, ErrorKind, ErrorType, WheelDrive, accepts};
use controller_core::types::{WheelSpeeds, WheelTorques};
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

/// One motor with its gear; both wheels have the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorParams {
    /// Motor turns per wheel turn, 0.1 to 10,000.
    pub gear_ratio: f32,
    /// Torque constant \[N m/A\], 1e-6 to 100.
    pub torque_constant: f32,
    /// Winding and bridge \[Ω\], 1e-4 to 1e4.
    pub resistance_ohm: f32,
    /// Supply \[V\], 1 to 1000.
    pub supply_v: f32,
    /// Largest current of either motor \[A\], 1e-3 to 1000.
    pub max_current_a: f32,
}

/// A motor parameter that is not finite or out of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorParamError(
    /// Its name.
    pub &'static str,
);

impl Display for MotorParamError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} is out of its range", self.0)
    }
}

impl CoreError for MotorParamError {}

impl MotorParams {
    /// Checks every parameter.
    ///
    /// # Errors
    ///
    /// The first one out of its range.
    pub fn validate(self) -> Result<ValidMotor, MotorParamError> {
        for (name, value, low, high) in [
            ("gear_ratio", self.gear_ratio, 0.1, 1e4),
            ("torque_constant", self.torque_constant, 1e-6, 100.0),
            ("resistance_ohm", self.resistance_ohm, 1e-4, 1e4),
            ("supply_v", self.supply_v, 1.0, 1000.0),
            ("max_current_a", self.max_current_a, 1e-3, 1000.0),
        ] {
            if !(value >= low && value <= high) {
                return Err(MotorParamError(name));
            }
        }
        let wheel_torque_per_ampere = self.gear_ratio * self.torque_constant;
        Ok(ValidMotor {
            params: self,
            volt_per_torque: self.resistance_ohm / wheel_torque_per_ampere,
            volt_per_speed: wheel_torque_per_ampere,
            max_torque_nm: wheel_torque_per_ampere * self.max_current_a,
        })
    }
}

/// [`MotorParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidMotor {
    params: MotorParams,
    volt_per_torque: f32,
    volt_per_speed: f32,
    max_torque_nm: f32,
}

impl ValidMotor {
    /// The parameters as they were given.
    pub const fn params(&self) -> &MotorParams {
        &self.params
    }

    /// Voltage for a torque at a speed, as a share of the supply in [−1, 1].
    pub fn share(&self, torque_nm: f32, speed_rad_s: f32) -> f32 {
        let volt = self.volt_per_torque * torque_nm + self.volt_per_speed * speed_rad_s;
        // A motor that runs too fast for its supply gets all there is.
        (volt / self.params.supply_v).clamp(-1.0, 1.0)
    }
}

/// The two outputs of one wheel.
#[derive(Clone, Copy, Debug)]
pub struct MotorSide<P, D> {
    /// Duty cycle of the bridge.
    pub pwm: P,
    /// Low drives forward.
    pub direction: D,
}

impl<P: SetDutyCycle, D: OutputPin> MotorSide<P, D> {
    fn coast(&mut self) -> Result<(), MotorError> {
        self.pwm.set_duty_cycle(0).map_err(|_| MotorError::Pwm)
    }

    fn turn(&mut self, backward: bool) -> Result<(), MotorError> {
        self.direction
            .set_state(backward.into())
            .map_err(|_| MotorError::Direction)
    }

    fn push(&mut self, share: f32) -> Result<(), MotorError> {
        let max = f32::from(self.pwm.max_duty_cycle());
        // At most `max`; rounded to nearest.
        let duty = (share.abs() * max + 0.5) as u16;
        self.pwm.set_duty_cycle(duty).map_err(|_| MotorError::Pwm)
    }
}

/// What a pair of motors fails with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotorError {
    /// A PWM output.
    Pwm,
    /// A direction pin.
    Direction,
    /// A torque beyond the current limit, or not a number.
    OutOfRange,
}

impl Error for MotorError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Pwm | Self::Direction => ErrorKind::Bus,
            Self::OutOfRange => ErrorKind::OutOfRange,
        }
    }
}

/// Both wheels of a base. Mirrored motors are mirrored by their wiring.
#[derive(Clone, Copy, Debug)]
pub struct MotorPair<P, D> {
    right: MotorSide<P, D>,
    left: MotorSide<P, D>,
    motor: ValidMotor,
    speeds: WheelSpeeds<f32>,
    backward: Option<[bool; 2]>,
}

impl<P: SetDutyCycle, D: OutputPin> MotorPair<P, D> {
    /// Takes the outputs; the caller calls [`release`](WheelDrive::release) before anything else.
    pub fn new(right: MotorSide<P, D>, left: MotorSide<P, D>, motor: ValidMotor) -> Self {
        Self {
            right,
            left,
            motor,
            speeds: WheelSpeeds::default(),
            backward: None,
        }
    }

    /// Tells how fast the wheels turn now, for the back-EMF. To be called before every set of torques; a
    /// speed that is not finite counts as 0.
    pub fn observe(&mut self, speeds: &WheelSpeeds<f32>) {
        let known = |speed: f32| if speed.is_finite() { speed } else { 0.0 };
        self.speeds = WheelSpeeds {
            right: known(speeds.right),
            left: known(speeds.left),
        };
    }

    /// The outputs, for a board that needs them back.
    pub fn into_sides(self) -> (MotorSide<P, D>, MotorSide<P, D>) {
        (self.right, self.left)
    }
}

impl<P, D> ErrorType for MotorPair<P, D> {
    type Error = MotorError;
}

impl<P: SetDutyCycle, D: OutputPin> WheelDrive for MotorPair<P, D> {
    fn max_torque_nm(&self) -> f32 {
        self.motor.max_torque_nm
    }

    /// Directions first, each with its bridge off while it changes, then both duty cycles.
    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), MotorError> {
        if !accepts(&torques, self.motor.max_torque_nm) {
            return Err(MotorError::OutOfRange);
        }
        let right = self.motor.share(torques.right, self.speeds.right);
        let left = self.motor.share(torques.left, self.speeds.left);
        let wanted = [right < 0.0, left < 0.0];
        let now = self.backward.take();
        if now != Some(wanted) {
            let [to_right, to_left] = wanted;
            let (from_right, from_left) = match now {
                Some([right, left]) => (Some(right), Some(left)),
                None => (None, None),
            };
            if from_right != Some(to_right) {
                self.right.coast()?;
                self.right.turn(to_right)?;
            }
            if from_left != Some(to_left) {
                self.left.coast()?;
                self.left.turn(to_left)?;
            }
        }
        self.right.push(right)?;
        self.left.push(left)?;
        // Known only now: after an error the directions are set anew.
        self.backward = Some(wanted);
        Ok(())
    }

    /// No duty on either wheel, then both directions forward; each is tried whatever became of the others.
    fn release(&mut self) -> Result<(), MotorError> {
        self.backward = None;
        let duties = (self.right.coast(), self.left.coast());
        let directions = (self.right.turn(false), self.left.turn(false));
        self.backward = match directions {
            (Ok(()), Ok(())) => Some([false, false]),
            _ => None,
        };
        duties.0.and(duties.1).and(directions.0).and(directions.1)
    }
}
