//! What can go wrong, and what is done about it: one table, from which faults, kinds and policies are made.

use core::fmt;

use super::reaction::{Reaction, Response};
use crate::error::{Input, StepFault};
use crate::gyro::GyroFault;
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

/// What a fault takes away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Broken {
    /// The measured twist cannot be relied upon.
    Measurement,
    /// The controller gives no torque.
    Controller,
    /// The wheel driver's state is unknown.
    Driver,
}

/// Makes of the table below the faults, their kinds with codes and names, a policy with a response for each, and room for
/// the details of each.
macro_rules! faults {
    (@of $details:ident $kind:ident $name:ident) => { Some(Fault::$kind) };
    (@of $details:ident $kind:ident $name:ident $detail:ty) => { $details.$name.map(Fault::$kind) };
    ($(
        $(#[$doc:meta])*
        $kind:ident $(($detail:ty))? = $code:literal, $name:ident $(or $alias:literal)?,
        $broken:expr, $response:expr;
    )*) => {
        /// Something that went wrong, with what is known of it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        pub enum Fault {
            $($(#[$doc])* $kind $(($detail))?,)*
        }

        impl Fault {
            /// The kind.
            pub const fn kind(self) -> FaultKind {
                match self {
                    $(Self::$kind { .. } => FaultKind::$kind,)*
                }
            }
        }

        /// A [`Fault`] without its details: what a policy is written for, and what a counter counts.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        #[allow(missing_docs)] // Each is the variant of `Fault` with the same name.
        pub enum FaultKind {
            $($kind,)*
        }

        /// What is known of faults beside their kinds: one value for each kind that has details.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub(super) struct Details {
            $($($name: Option<$detail>,)?)*
        }

        impl Details {
            /// Of no fault.
            pub(super) const NONE: Self = Self {
                $($($name: None::<$detail>,)?)*
            };

            /// Keeps what is known of `fault`.
            pub(super) fn keep(&mut self, fault: Fault) {
                match fault {
                    $($(Fault::$kind(detail) => {
                        let detail: $detail = detail;
                        self.$name = Some(detail);
                    })?)*
                    _ => {}
                }
            }

            /// The fault of a kind that was kept.
            pub(super) fn fault(&self, kind: FaultKind) -> Option<Fault> {
                let details = *self;
                match kind {
                    $(FaultKind::$kind => faults!(@of details $kind $name $($detail)?),)*
                }
            }
        }

        impl FaultKind {
            /// How many there are.
            pub const COUNT: usize = [$(Self::$kind),*].len();

            /// All of them, by their code.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$kind),*];

            /// A number that never changes its meaning: for logs, wires and blink codes. From 1; 0 is free for
            /// "none".
            pub const fn code(self) -> u8 {
                match self {
                    $(Self::$kind => $code,)*
                }
            }

            /// The name that it has in configuration files.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => stringify!($name),)*
                }
            }

            pub(super) const fn broken(self) -> Option<Broken> {
                match self {
                    $(Self::$kind => $broken,)*
                }
            }
        }

        /// What is done about each kind of fault. `default()` has a reason for each.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
        #[allow(missing_docs)] // Each is the response to the kind of fault with the same name.
        pub struct PolicyParams {
            $($(#[cfg_attr(feature = "serde", serde(alias = $alias))])? pub $name: Response,)*
        }

        impl PolicyParams {
            /// The default of [`ValidPolicyParams`](super::ValidPolicyParams).
            pub const DEFAULT: Self = Self {
                $($name: $response,)*
            };

            /// The response to a kind. By a call: it is asked for only where there is a fault, and takes much flash.
            #[inline(never)]
            pub const fn get(&self, kind: FaultKind) -> Response {
                match kind {
                    $(FaultKind::$kind => self.$name,)*
                }
            }

            /// The same with another response to one kind.
            #[must_use]
            pub const fn with(mut self, kind: FaultKind, response: Response) -> Self {
                let place = match kind {
                    $(FaultKind::$kind => &mut self.$name,)*
                };
                *place = response;
                self
            }
        }
    };
}

const BLIND: Option<Broken> = Some(Broken::Measurement);
const STOP: Reaction = Reaction::ControlledStop;

// Fault = code, name in files, what it takes away, response by default. The order is that of the codes.
faults! {
    /// The encoders gave no reading for too long.
    MeasurementStale = 1, measurement_stale,
        BLIND,
        // Blind: what is left needs no speed to work.
        Response::latched(Reaction::Brake);
    /// No external pose for too long; odometry goes on alone.
    PoseStale = 2, pose_stale,
        None,
        // Odometry drifts by a few per cent of the way: good enough for the way of a stop.
        Response::passing(STOP);
    /// The host is there, but gave no order where one is due for too long.
    CommandStale = 3, command_stale,
        None,
        // There is no target; the base itself is sound, and may go on when the host is back.
        Response::passing(STOP);
    /// An input is NaN or infinite.
    NotFinite (Input) = 4, not_finite,
        BLIND,
        // What is not a number says nothing of the next one.
        Response::latched(Reaction::Brake);
    /// Too many ticks came late, in a row or among the last 64.
    TickJitter = 5, tick_jitter,
        None,
        // Ticks come, only late: enough to stop with, not to drive on. Somebody has to look why.
        Response::latched(STOP);
    /// One tick was so long that the loop was blind in between.
    TickTooLong = 6, tick_too_long,
        None,
        // The loop was blind once, and is not any more.
        Response::latched(STOP);
    /// The pose jumped further than the robot can have moved.
    PoseJump = 7, pose_jump,
        None,
        // The motion law takes jumps without a step of torque.
        Response::IGNORE;
    /// A wheel is commanded to turn and its counts stand still: its encoder is lost, or the wheel is blocked.
    /// From wheels alone the two look alike; where an external twist shows that the robot stands, the
    /// fault is [`Fault::Stalled`] instead.
    EncoderStuck (Side) = 8, encoder_stuck,
        BLIND,
        // Half of the twist is wrong, so a velocity loop would push on.
        Response::latched(Reaction::Brake);
    /// Counts move against what torque and mass say: encoder or motor wired the wrong way round. The
    /// velocity loop then has positive feedback.
    EncoderReversed (Side) = 9, encoder_reversed,
        BLIND,
        // The velocity loop drives the error up; an electrical brake has no sign to get wrong.
        Response::latched(Reaction::Brake);
    /// A wheel moves as only one without grip can. A light wheel that loses its grip is held at its commanded
    /// speed by the velocity loop with hardly any torque: that shows against an external twist only.
    WheelSlip (Side) = 10, wheel_slip,
        None,
        // Grip comes back with less torque; odometry is off by then, so the way is not driven on.
        Response::passing(STOP);
    /// The wheel driver failed.
    Driver (ErrorKind) = 11, driver,
        Some(Broken::Driver),
        // After an error the wheels' state is unknown, and the driver has to release.
        Response::latched(Reaction::Release);
    /// A motor's measured current was above its limit for too long.
    OverCurrent (Side) = 12, over_current,
        None,
        // A brake would add the current of the motor's own voltage.
        Response::latched(Reaction::Release);
    /// The supply was too low for too long.
    UnderVoltage = 13, under_voltage,
        None,
        // Decelerating gives energy back; an empty battery stays one until somebody changes it.
        Response::latched(STOP);
    /// The controller refused a tick.
    StepRefused (StepFault) = 14, step_refused,
        Some(Broken::Controller),
        // No torque is known that could stop the base.
        Response::latched(Reaction::Brake);
    /// The robot is commanded to move and stands.
    Stalled = 15, stalled,
        None,
        // Nothing moves anyhow; free of the obstacle it may be armed again.
        Response::passing(STOP);
    /// The motion law has no retry left and is still outside the tolerance of its goal.
    GoalUnreachable = 16, goal_unreachable or "gave_up",
        None,
        // The goal is not reached, everything else works.
        Response::passing(STOP);
    /// The gyro is faulty. The heading goes by the wheels until it agrees with them again.
    Gyro (GyroFault) = 17, gyro,
        None,
        // What is left is a base without a gyro.
        Response::IGNORE;
    /// A wheel turns faster than any command and any load explain: what drives it does not do what it is told.
    OverSpeed (Side) = 18, over_speed,
        None,
        // The velocity loop is what does not hold the speed; an electrical brake needs none.
        Response::latched(Reaction::Brake);
}

impl FaultKind {
    /// The kind with this code.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }

    /// The measured twist cannot be relied upon, not even to see that the base rests.
    pub const fn breaks_measurement(self) -> bool {
        matches!(self.broken(), Some(Broken::Measurement))
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
            | Self::OverCurrent(side)
            | Self::OverSpeed(side) => write!(f, "{name} ({side:?})"),
            Self::Driver(kind) => write!(f, "{name}: {kind}"),
            Self::StepRefused(fault) => write!(f, "{name}: {fault}"),
            Self::Gyro(fault) => write!(f, "{name}: {fault}"),
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
        assert_eq!(FaultKind::from_code(19), None);
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
