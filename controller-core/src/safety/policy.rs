//! One response for each kind of fault: plain data, checked once.

use core::fmt;

use super::fault::{Fault, FaultKind};
use super::reaction::{Reaction, Response};

/// What is done about each kind of fault. `default()` has a reason for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
#[allow(missing_docs)] // Each is the response to the kind of fault with the same name.
pub struct PolicyParams {
    pub measurement_stale: Response,
    pub pose_stale: Response,
    pub command_stale: Response,
    pub not_finite: Response,
    pub tick_jitter: Response,
    pub tick_too_long: Response,
    pub pose_jump: Response,
    pub encoder_stuck: Response,
    pub encoder_reversed: Response,
    pub wheel_slip: Response,
    pub driver: Response,
    pub over_current: Response,
    pub under_voltage: Response,
    pub step_refused: Response,
    pub stalled: Response,
    #[cfg_attr(feature = "serde", serde(alias = "gave_up"))]
    pub goal_unreachable: Response,
}

impl PolicyParams {
    /// The default of [`ValidPolicyParams`].
    pub const DEFAULT: Self = Self {
        // Blind: what is left needs no speed to work.
        measurement_stale: Response::latched(Reaction::Brake),
        // Odometry drifts by a few per cent of the way: good enough for the way of a stop.
        pose_stale: Response::passing(Reaction::ControlledStop),
        // There is no target; the base itself is sound, and may go on when the host is back.
        command_stale: Response::passing(Reaction::ControlledStop),
        // What is not a number says nothing of the next one.
        not_finite: Response::latched(Reaction::Brake),
        // Ticks come, only late: enough to stop with, not to drive on. Somebody has to look why.
        tick_jitter: Response::latched(Reaction::ControlledStop),
        // The loop was blind once, and is not any more.
        tick_too_long: Response::latched(Reaction::ControlledStop),
        // The motion law takes jumps without a step of torque.
        pose_jump: Response::IGNORE,
        // Half of the twist is wrong, so a velocity loop would push on.
        encoder_stuck: Response::latched(Reaction::Brake),
        // The velocity loop drives the error up; an electrical brake has no sign to get wrong.
        encoder_reversed: Response::latched(Reaction::Brake),
        // Grip comes back with less torque; odometry is off by then, so the way is not driven on.
        wheel_slip: Response::passing(Reaction::ControlledStop),
        // After an error the wheels' state is unknown, and the driver has to release.
        driver: Response::latched(Reaction::Release),
        // A brake would add the current of the motor's own voltage.
        over_current: Response::latched(Reaction::Release),
        // Decelerating gives energy back; an empty battery stays one until somebody changes it.
        under_voltage: Response::latched(Reaction::ControlledStop),
        // No torque is known that could stop the base.
        step_refused: Response::latched(Reaction::Brake),
        // Nothing moves anyhow; free of the obstacle it may be armed again.
        stalled: Response::passing(Reaction::ControlledStop),
        // The goal is not reached, everything else works.
        goal_unreachable: Response::passing(Reaction::ControlledStop),
    };

    /// The response to a kind.
    pub const fn get(&self, kind: FaultKind) -> Response {
        match kind {
            FaultKind::MeasurementStale => self.measurement_stale,
            FaultKind::PoseStale => self.pose_stale,
            FaultKind::CommandStale => self.command_stale,
            FaultKind::NotFinite => self.not_finite,
            FaultKind::TickJitter => self.tick_jitter,
            FaultKind::TickTooLong => self.tick_too_long,
            FaultKind::PoseJump => self.pose_jump,
            FaultKind::EncoderStuck => self.encoder_stuck,
            FaultKind::EncoderReversed => self.encoder_reversed,
            FaultKind::WheelSlip => self.wheel_slip,
            FaultKind::Driver => self.driver,
            FaultKind::OverCurrent => self.over_current,
            FaultKind::UnderVoltage => self.under_voltage,
            FaultKind::StepRefused => self.step_refused,
            FaultKind::Stalled => self.stalled,
            FaultKind::GoalUnreachable => self.goal_unreachable,
        }
    }

    /// The same with another response to one kind.
    #[must_use]
    pub const fn with(mut self, kind: FaultKind, response: Response) -> Self {
        let place = match kind {
            FaultKind::MeasurementStale => &mut self.measurement_stale,
            FaultKind::PoseStale => &mut self.pose_stale,
            FaultKind::CommandStale => &mut self.command_stale,
            FaultKind::NotFinite => &mut self.not_finite,
            FaultKind::TickJitter => &mut self.tick_jitter,
            FaultKind::TickTooLong => &mut self.tick_too_long,
            FaultKind::PoseJump => &mut self.pose_jump,
            FaultKind::EncoderStuck => &mut self.encoder_stuck,
            FaultKind::EncoderReversed => &mut self.encoder_reversed,
            FaultKind::WheelSlip => &mut self.wheel_slip,
            FaultKind::Driver => &mut self.driver,
            FaultKind::OverCurrent => &mut self.over_current,
            FaultKind::UnderVoltage => &mut self.under_voltage,
            FaultKind::StepRefused => &mut self.step_refused,
            FaultKind::Stalled => &mut self.stalled,
            FaultKind::GoalUnreachable => &mut self.goal_unreachable,
        };
        *place = response;
        self
    }

    /// Checks every response against what its fault leaves in working order.
    ///
    /// # Errors
    /// The first kind, by its code, whose response cannot work.
    pub fn validate(self) -> Result<ValidPolicyParams, PolicyError> {
        for kind in FaultKind::ALL {
            let Response { reaction, latch } = self.get(kind);
            let problem = match (kind.broken(), reaction) {
                (Some(Broken::Driver), reaction) if reaction < Reaction::Release => {
                    PolicyProblem::NeedsDriver
                }
                (Some(_), Reaction::Ignore) => PolicyProblem::MayNotBeIgnored,
                (Some(Broken::Measurement), Reaction::ControlledStop) => {
                    PolicyProblem::NeedsMeasurement
                }
                (Some(Broken::Controller), Reaction::ControlledStop) => {
                    PolicyProblem::NeedsController
                }
                (_, Reaction::Ignore) if latch => PolicyProblem::IgnoredLatched,
                _ => continue,
            };
            return Err(PolicyError { kind, problem });
        }
        Ok(ValidPolicyParams(self))
    }
}

impl Default for PolicyParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What a fault takes away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Broken {
    Measurement,
    Controller,
    Driver,
}

impl FaultKind {
    /// The measured twist cannot be relied upon, not even to see that the base rests.
    pub const fn breaks_measurement(self) -> bool {
        matches!(self.broken(), Some(Broken::Measurement))
    }

    const fn broken(self) -> Option<Broken> {
        match self {
            Self::MeasurementStale
            | Self::NotFinite
            | Self::EncoderStuck
            | Self::EncoderReversed => Some(Broken::Measurement),
            Self::StepRefused => Some(Broken::Controller),
            Self::Driver => Some(Broken::Driver),
            Self::PoseStale
            | Self::CommandStale
            | Self::TickJitter
            | Self::TickTooLong
            | Self::PoseJump
            | Self::WheelSlip
            | Self::OverCurrent
            | Self::UnderVoltage
            | Self::Stalled
            | Self::GoalUnreachable => None,
        }
    }
}

/// [`PolicyParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValidPolicyParams(PolicyParams);

impl ValidPolicyParams {
    /// The response to a fault.
    pub const fn response(&self, fault: Fault) -> Response {
        self.0.get(fault.kind())
    }

    /// The responses as they were given.
    pub const fn params(&self) -> &PolicyParams {
        &self.0
    }
}

impl Default for ValidPolicyParams {
    /// [`PolicyParams::DEFAULT`], which a test holds to be valid.
    fn default() -> Self {
        Self(PolicyParams::DEFAULT)
    }
}

/// Why a response cannot work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PolicyProblem {
    /// Driving on would be blind.
    MayNotBeIgnored,
    /// A controlled stop goes by the measurement that is broken.
    NeedsMeasurement,
    /// A controlled stop goes by the controller that refuses to work.
    NeedsController,
    /// The driver that failed cannot be relied upon: only releasing is left.
    NeedsDriver,
    /// A fault that is ignored has no end to be latched.
    IgnoredLatched,
}

/// A response that `validate` refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PolicyError {
    /// To which kind.
    pub kind: FaultKind,
    /// Why.
    pub problem: PolicyProblem,
}

impl fmt::Display for PolicyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let why = match self.problem {
            PolicyProblem::MayNotBeIgnored => "may not be ignored",
            PolicyProblem::NeedsMeasurement => "leaves no measurement for a controlled stop",
            PolicyProblem::NeedsController => "leaves no controller for a controlled stop",
            PolicyProblem::NeedsDriver => "leaves nothing but to release the wheels",
            PolicyProblem::IgnoredLatched => "is ignored and cannot be latched",
        };
        write!(f, "{} {why}", self.kind)
    }
}

impl core::error::Error for PolicyError {}

#[cfg(test)]
mod tests;
