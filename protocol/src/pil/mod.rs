//! What a processor in the loop is asked, and answers, one tick at a time: the paper's law ([`Question`]), the whole
//! base ([`BaseQuestion`]), or all of its firmware with the line ([`BoardQuestion`]).

mod base;
mod board;
mod convert;
mod parameters;
mod report;
mod ticked;

pub use base::{BaseAnswer, BaseInput, BasePart, BaseQuestion, BaseTicked, WheelOutput, WireOrder};
pub use board::{BoardAnswer, BoardQuestion, LineBytes};
pub use parameters::{ParameterSet, WireReset};
pub use report::{Report, report_flags};
pub use ticked::Ticked;

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use crate::values::real;
use crate::{Counters, Hello, RejectReason, WirePose, WireReference, WireTwist};

/// A question to the chip. Each has one answer.
// The receiver keeps one of these by value and moves it once; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Question {
    /// Who is there? [`Answer::Hello`].
    Hello,
    /// Replace the paper's parameters, within validation. A running controller keeps those that it was started with.
    Configure(ParameterSet),
    /// Start a controller; answered with its report.
    Begin {
        /// Where the reference is.
        reference: WireReference,
        /// Where the robot is.
        measured: WireMeasured,
    },
    /// One tick of the controller; answered with its report.
    Tick {
        /// s since the tick before.
        #[serde(deserialize_with = "real")]
        dt: f32,
        /// What to do.
        demand: WireDemand,
        /// Where the robot is.
        measured: WireMeasured,
    },
    /// Send the counters.
    GetCounters,
    /// No more questions.
    Stop,
}

/// The answer to a question.
// See `Question`: moved once, never boxed.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Who is there.
    Hello(Hello),
    /// A start or a tick, with every term of the law.
    Report(Report),
    /// A start or a tick that the controller refused.
    Refused(Refusal),
    /// What the link has seen, and the stack.
    Counters(Counters),
    /// Done.
    Ack,
    /// Not done.
    Nack(RejectReason),
}

/// What the base knows of itself at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireMeasured {
    /// Measured pose.
    pub pose: WirePose,
    /// Measured velocity.
    pub twist: WireTwist,
}

/// The demand of a tick of the processor in the loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum WireDemand {
    /// Follow the reference of this instant.
    Track(WireReference),
    /// Change from tracking to parking.
    HandOver {
        /// Where the reference is now.
        reference: WireReference,
        /// Where to park.
        goal: WirePose,
    },
    /// Go on parking.
    Park,
}

/// Why the controller refused a start or a tick; its state is what it was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Refusal {
    /// The measured pose is not finite.
    Pose,
    /// The measured velocity is not finite.
    Twist,
    /// The reference is not finite.
    Reference,
    /// The goal is not finite.
    Goal,
    /// The elapsed time is not a number.
    Tick,
    /// No time has passed.
    TickNotPositive,
    /// Too much time has passed.
    TickTooLong,
    /// Tracking was asked of a controller that parks, or the other way round.
    WrongPhase,
    /// Finite inputs gave a torque that is not.
    Overflow,
    /// A reason that this protocol version has no name for.
    Other,
}

impl Display for Refusal {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pose => "the measured pose is not finite",
            Self::Twist => "the measured velocity is not finite",
            Self::Reference => "the reference is not finite",
            Self::Goal => "the goal is not finite",
            Self::Tick => "the elapsed time is not a number",
            Self::TickNotPositive => "the elapsed time is not positive",
            Self::TickTooLong => "the elapsed time is above its limit",
            Self::WrongPhase => "the demand does not fit the phase",
            Self::Overflow => "the inputs are too large for a finite torque",
            Self::Other => "for a reason without a name",
        })
    }
}

impl Error for Refusal {}
