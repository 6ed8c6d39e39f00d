//! What can go wrong: typed, small, each with a kind that has a number and a name.

use core::fmt;

use crate::error::{Input, StepFault};
use crate::hal::ErrorKind;

/// Which wheel a fault is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// Right.
    Right,
    /// Left.
    Left,
    /// Both in the same tick.
    Both,
}

impl Side {
    /// The side for what holds of each wheel; `None` if of neither.
    pub const fn of(right: bool, left: bool) -> Option<Self> {
        match (right, left) {
            (true, true) => Some(Self::Both),
            (true, false) => Some(Self::Right),
            (false, true) => Some(Self::Left),
            (false, false) => None,
        }
    }
}

/// Something that went wrong, with what is known of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Fault {
    /// The encoders gave no reading for too long.
    MeasurementStale,
    /// No external pose for too long; odometry goes on alone.
    PoseStale,
    /// Host or reference were silent for too long.
    CommandStale,
    /// An input is NaN or infinite.
    NotFinite(Input),
    /// Too many ticks came late, in a row or among the last 64.
    TickJitter,
    /// One tick was so long that the loop was blind in between.
    TickTooLong,
    /// The pose jumped further than the robot can have moved.
    PoseJump,
    /// A wheel is commanded to turn and its counts stand still: its encoder is lost, or the wheel is blocked.
    /// From wheels alone the two look alike; where an external twist shows that the robot stands, the
    /// fault is [`Fault::Stalled`] instead.
    EncoderStuck(Side),
    /// Counts move against what torque and mass say: encoder or motor wired the wrong way round. The
    /// velocity loop then has positive feedback.
    EncoderReversed(Side),
    /// A wheel moves as only one without grip can. A light wheel that loses its grip is held at its commanded
    /// speed by the velocity loop with hardly any torque: that shows against an external twist only.
    WheelSlip(Side),
    /// The wheel driver failed.
    Driver(ErrorKind),
    /// A motor's measured current was above its limit for too long.
    OverCurrent(Side),
    /// The supply was too low for too long.
    UnderVoltage,
    /// The controller refused a tick.
    StepRefused(StepFault),
    /// The robot is commanded to move and stands.
    Stalled,
    /// The motion law has no retry left and is still outside the tolerance of its goal.
    GoalUnreachable,
}

/// A [`Fault`] without its details: what a policy is written for, and what a counter counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[allow(missing_docs)] // Each is the variant of `Fault` with the same name.
pub enum FaultKind {
    MeasurementStale,
    PoseStale,
    CommandStale,
    NotFinite,
    TickJitter,
    TickTooLong,
    PoseJump,
    EncoderStuck,
    EncoderReversed,
    WheelSlip,
    Driver,
    OverCurrent,
    UnderVoltage,
    StepRefused,
    Stalled,
    GoalUnreachable,
}

impl FaultKind {
    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// All of them, by their code.
    pub const ALL: [Self; 16] = [
        Self::MeasurementStale,
        Self::PoseStale,
        Self::CommandStale,
        Self::NotFinite,
        Self::TickJitter,
        Self::TickTooLong,
        Self::PoseJump,
        Self::EncoderStuck,
        Self::EncoderReversed,
        Self::WheelSlip,
        Self::Driver,
        Self::OverCurrent,
        Self::UnderVoltage,
        Self::StepRefused,
        Self::Stalled,
        Self::GoalUnreachable,
    ];

    /// A number that never changes its meaning: for logs, wires and blink codes. From 1; 0 is free for
    /// "none".
    pub const fn code(self) -> u8 {
        match self {
            Self::MeasurementStale => 1,
            Self::PoseStale => 2,
            Self::CommandStale => 3,
            Self::NotFinite => 4,
            Self::TickJitter => 5,
            Self::TickTooLong => 6,
            Self::PoseJump => 7,
            Self::EncoderStuck => 8,
            Self::EncoderReversed => 9,
            Self::WheelSlip => 10,
            Self::Driver => 11,
            Self::OverCurrent => 12,
            Self::UnderVoltage => 13,
            Self::StepRefused => 14,
            Self::Stalled => 15,
            Self::GoalUnreachable => 16,
        }
    }

    /// The kind with this code.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }

    /// The name that it has in configuration files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MeasurementStale => "measurement_stale",
            Self::PoseStale => "pose_stale",
            Self::CommandStale => "command_stale",
            Self::NotFinite => "not_finite",
            Self::TickJitter => "tick_jitter",
            Self::TickTooLong => "tick_too_long",
            Self::PoseJump => "pose_jump",
            Self::EncoderStuck => "encoder_stuck",
            Self::EncoderReversed => "encoder_reversed",
            Self::WheelSlip => "wheel_slip",
            Self::Driver => "driver",
            Self::OverCurrent => "over_current",
            Self::UnderVoltage => "under_voltage",
            Self::StepRefused => "step_refused",
            Self::Stalled => "stalled",
            Self::GoalUnreachable => "goal_unreachable",
        }
    }
}

impl Fault {
    /// The kind.
    pub const fn kind(self) -> FaultKind {
        match self {
            Self::MeasurementStale => FaultKind::MeasurementStale,
            Self::PoseStale => FaultKind::PoseStale,
            Self::CommandStale => FaultKind::CommandStale,
            Self::NotFinite(_) => FaultKind::NotFinite,
            Self::TickJitter => FaultKind::TickJitter,
            Self::TickTooLong => FaultKind::TickTooLong,
            Self::PoseJump => FaultKind::PoseJump,
            Self::EncoderStuck(_) => FaultKind::EncoderStuck,
            Self::EncoderReversed(_) => FaultKind::EncoderReversed,
            Self::WheelSlip(_) => FaultKind::WheelSlip,
            Self::Driver(_) => FaultKind::Driver,
            Self::OverCurrent(_) => FaultKind::OverCurrent,
            Self::UnderVoltage => FaultKind::UnderVoltage,
            Self::StepRefused(_) => FaultKind::StepRefused,
            Self::Stalled => FaultKind::Stalled,
            Self::GoalUnreachable => FaultKind::GoalUnreachable,
        }
    }
}

impl From<StepFault> for Fault {
    /// Inputs and time are faults of their own; what is left is a refused step.
    fn from(fault: StepFault) -> Self {
        match fault {
            StepFault::NotFinite(input) => Self::NotFinite(input),
            StepFault::TickTooLong { .. } => Self::TickTooLong,
            other => Self::StepRefused(other),
        }
    }
}

impl From<ErrorKind> for Fault {
    fn from(kind: ErrorKind) -> Self {
        Self::Driver(kind)
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.kind().name();
        match self {
            Self::NotFinite(input) => write!(f, "{name} ({input:?})"),
            Self::EncoderStuck(side)
            | Self::EncoderReversed(side)
            | Self::WheelSlip(side)
            | Self::OverCurrent(side) => write!(f, "{name} ({side:?})"),
            Self::Driver(kind) => write!(f, "{name}: {kind}"),
            Self::StepRefused(fault) => write!(f, "{name}: {fault}"),
            _ => f.write_str(name),
        }
    }
}

impl core::error::Error for Fault {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_their_place_in_the_list_and_lead_back() {
        for (place, kind) in FaultKind::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(kind.code()), place + 1, "{kind}");
            assert_eq!(FaultKind::from_code(kind.code()), Some(kind));
        }
        assert_eq!(FaultKind::from_code(0), None);
        assert_eq!(FaultKind::from_code(17), None);
    }

    #[test]
    fn names_differ() {
        for (place, kind) in FaultKind::ALL.into_iter().enumerate() {
            let others = FaultKind::ALL.into_iter().skip(place + 1);
            assert!(others.into_iter().all(|other| other.name() != kind.name()));
        }
    }

    #[test]
    fn refused_steps_keep_what_they_know() {
        let fault = Fault::from(StepFault::NotFinite(Input::Twist));
        assert_eq!(fault, Fault::NotFinite(Input::Twist));
        let fault = Fault::from(StepFault::TickTooLong { max_tick_us: 1 });
        assert_eq!(fault.kind(), FaultKind::TickTooLong);
        assert_eq!(
            Fault::from(StepFault::Overflow).kind(),
            FaultKind::StepRefused
        );
    }
}
