//! What can be wrong: parameters, starts, ticks. Small `Copy` values that name the culprit.

mod field;

use core::fmt;

pub use field::Field;

/// What is wrong with a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// NaN or infinite.
    NotFinite,
    /// Below the smallest accepted value.
    Below(f64),
    /// Above the largest accepted value.
    Above(f64),
    /// The matrix of wheels and wrench cannot be inverted.
    Singular,
    /// Other parameters say something else of the same thing.
    Differs,
}

/// A parameter that `validate` refuses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamError {
    /// Which parameter.
    pub field: Field,
    /// Why, with the limit that was passed.
    pub problem: Problem,
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.field.name();
        match self.problem {
            Problem::NotFinite => write!(f, "{name} is not a finite number"),
            Problem::Below(limit) => write!(f, "{name} is below its smallest value {limit:e}"),
            Problem::Above(limit) => write!(f, "{name} is above its largest value {limit:e}"),
            Problem::Singular => write!(f, "{name} cannot be inverted"),
            Problem::Differs => write!(f, "{name} is not what other parameters say"),
        }
    }
}

impl core::error::Error for ParamError {}

/// An input of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Input {
    /// The measured pose.
    Pose,
    /// The measured twist.
    Twist,
    /// The pose, twist or acceleration of the reference.
    Reference,
    /// The pose to park at.
    Goal,
    /// The measured time since the last tick.
    Tick,
    /// The acceleration given to odometry.
    Accel,
    /// The wheel torques that were really exerted.
    Applied,
    /// The speed and turn rate that are ordered.
    Order,
}

/// A tick, or a start, that was refused. The controller's state is what it was before the call;
/// the caller makes the wheels safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StepFault {
    /// An input is NaN or infinite.
    NotFinite(Input),
    /// No time, or less than none, has passed since the last tick.
    TickNotPositive,
    /// More time than `max_tick` has passed since the last tick.
    TickTooLong {
        /// The limit that was passed \[µs\].
        max_tick_us: u32,
    },
    /// Tracking was asked of a controller that parks, or parking of one that tracks.
    WrongPhase,
    /// Finite inputs so large that a torque came out infinite or NaN.
    Overflow,
    /// An input is finite and beyond what any base can do.
    OutOfRange(Input),
}

impl fmt::Display for StepFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(input) => write!(f, "{input:?} is not finite"),
            Self::TickNotPositive => f.write_str("elapsed time is not positive"),
            Self::TickTooLong { max_tick_us } => {
                write!(f, "elapsed time is above its limit of {max_tick_us} us")
            }
            Self::WrongPhase => f.write_str("the demand does not fit the phase"),
            Self::Overflow => f.write_str("the inputs are too large for a finite torque"),
            Self::OutOfRange(input) => write!(f, "{input:?} is out of its range"),
        }
    }
}

impl core::error::Error for StepFault {}

/// What a stand-alone neuron refuses; its state is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum NeuronError {
    /// The state to start from is outside [−D, B] or not a number.
    OutOfBounds,
    /// The input is NaN or infinite.
    InputNotFinite,
    /// The elapsed time is NaN or below zero.
    TickNegative,
}

impl fmt::Display for NeuronError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OutOfBounds => "the neuron's state is outside [-D, B]",
            Self::InputNotFinite => "the neuron's input is not finite",
            Self::TickNegative => "the elapsed time is negative",
        })
    }
}

impl core::error::Error for NeuronError {}
