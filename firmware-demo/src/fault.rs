//! What can break, and why the supervisor changed its state.

use controller_core::error::StepFault;
use controller_core::hal::ErrorKind;
use serde::{Deserialize, Serialize};

use crate::protocol::Refusal;

/// What the wheel driver complains of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DriverFault {
    /// No answer, or nonsense.
    Bus,
    /// Too much current.
    OverCurrent,
    /// Supply too low.
    UnderVoltage,
    /// A torque was refused.
    OutOfRange,
    /// Anything else.
    Other,
}

impl From<ErrorKind> for DriverFault {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::Bus => Self::Bus,
            ErrorKind::OverCurrent => Self::OverCurrent,
            ErrorKind::UnderVoltage => Self::UnderVoltage,
            ErrorKind::OutOfRange => Self::OutOfRange,
            _ => Self::Other,
        }
    }
}

/// What broke. Latched until the host resets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// The wheel driver.
    Driver(DriverFault),
    /// The encoders gave no reading.
    Sensor,
    /// A wheel was told to turn for some time, and its encoder stood still.
    EncoderStuck,
    /// Too many ticks in a row came late.
    Overrun,
    /// The controller refused a tick, such as one with a pose that is not a number.
    Refused(Refusal),
}

impl From<StepFault> for Fault {
    fn from(fault: StepFault) -> Self {
        Self::Refused(fault.into())
    }
}

/// Why the state is what it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cause {
    /// Power came on.
    #[default]
    PowerOn,
    /// The host asked for it.
    Host,
    /// References were there to be followed.
    References,
    /// The trajectory was complete: its last sample is at rest.
    TrajectoryEnded,
    /// The next reference did not arrive in time.
    Underrun,
    /// The robot stands where it should.
    Reached,
    /// Nothing was heard of the host for too long.
    LinkLost,
    /// Something broke.
    Fault(Fault),
}
