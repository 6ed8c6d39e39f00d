//! One response for each kind of fault: plain data, checked once.

use core::fmt;

use super::fault::{Broken, Fault, FaultKind, PolicyParams};
use super::reaction::{Reaction, Response};

impl PolicyParams {
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
