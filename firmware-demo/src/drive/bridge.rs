//! Two half bridges behind a PWM output and a direction pin, and the pin that switches both sides off.

use controller_core::hal::{Error, ErrorKind};
use embedded_hal::digital::{ErrorType, OutputPin};
use embedded_hal::pwm::SetDutyCycle;

/// What a pair of motors fails with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotorError {
    /// A PWM output.
    Pwm,
    /// A direction pin.
    Direction,
    /// The enable pin.
    Enable,
    /// A torque beyond what the current limit allows, or not a number.
    OutOfRange,
    /// A speed that was observed is not a number.
    Observation,
}

impl Error for MotorError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Pwm | Self::Direction | Self::Enable => ErrorKind::Bus,
            Self::OutOfRange => ErrorKind::OutOfRange,
            Self::Observation => ErrorKind::Other,
        }
    }
}

/// What a bridge does with its motor while the PWM is low: the rest of every period, and all the time at a duty
/// of 0. Its data sheet has it in the truth table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OffPhase {
    /// Both terminals at the same rail (slow decay): duty 0 brakes. DRV8838 and DRV8833 in phase-enable mode, TB6612 with its
    /// PWM input, MD10C, MDD3A.
    Shorted,
    /// Terminals open (fast decay): duty 0 coasts, and nothing brakes. L298 with PWM at its enable input, VNH2SP30.
    Free,
}

/// What both bridges have in common. It decides what can be done:
///
/// | PWM low | enable pin | release | brake |
/// | --- | --- | --- | --- |
/// | shorted | yes | enable low: coasts | duty 0, enable high: brakes |
/// | shorted | no | duty 0: **brakes** | duty 0: brakes |
/// | free | yes | enable low, duty 0: coasts | as release: **coasts** |
/// | free | no | duty 0: coasts | as release: **coasts** |
///
/// In bold what hardware cannot do better; [`can_release`](Self::can_release) and [`can_brake`](Self::can_brake) say which.
#[derive(Clone, Copy, Debug)]
pub struct Bridges<E = NoPin> {
    /// While the PWM is low. Back-EMF and torque are right with [`OffPhase::Shorted`] only; see [`controller_core::motor`].
    pub off_phase: OffPhase,
    /// High switches both bridges on, low opens their outputs: standby, sleep, enable. A resistor holds it low from
    /// reset on.
    pub enable: Option<E>,
}

impl Bridges {
    /// Without an enable pin.
    pub const fn without_enable(off_phase: OffPhase) -> Self {
        Self {
            off_phase,
            enable: None,
        }
    }
}

impl<E> Bridges<E> {
    /// Released wheels are free to coast.
    pub const fn can_release(&self) -> bool {
        matches!(self.off_phase, OffPhase::Free) || self.enable.is_some()
    }

    /// Braked wheels have their motors shorted.
    pub const fn can_brake(&self) -> bool {
        matches!(self.off_phase, OffPhase::Shorted)
    }
}

impl<E: OutputPin> Bridges<E> {
    pub(super) fn switch(&mut self, on: bool) -> Result<(), MotorError> {
        match &mut self.enable {
            Some(pin) => pin.set_state(on.into()).map_err(|_| MotorError::Enable),
            None => Ok(()),
        }
    }
}

/// The pin that is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoPin {}

impl ErrorType for NoPin {
    type Error = core::convert::Infallible;
}

impl OutputPin for NoPin {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        match *self {}
    }
    fn set_high(&mut self) -> Result<(), Self::Error> {
        match *self {}
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
    pub(super) fn off(&mut self) -> Result<(), MotorError> {
        self.pwm.set_duty_cycle(0).map_err(|_| MotorError::Pwm)
    }

    pub(super) fn turn(&mut self, backward: bool) -> Result<(), MotorError> {
        self.direction
            .set_state(backward.into())
            .map_err(|_| MotorError::Direction)
    }

    pub(super) fn push(&mut self, share: f32) -> Result<(), MotorError> {
        let max = f32::from(self.pwm.max_duty_cycle());
        // At most `max`; rounded to nearest.
        let duty = (share.abs() * max + 0.5) as u16;
        self.pwm.set_duty_cycle(duty).map_err(|_| MotorError::Pwm)
    }
}
