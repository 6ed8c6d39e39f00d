//! What is done about a fault, from nothing to letting go.

/// What is done about a fault, ordered by severity: a later one beats an earlier one.
///
/// Each needs less to work than the one before: ignoring needs everything, a controlled stop needs a
/// measurement and a controller, an electrical brake only the driver, and a release nothing. So when
/// several faults come in one tick the most severe reaction is taken, a worse one that comes during a
/// stop takes over, and a milder one during a stop changes nothing but whether the end is latched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Reaction {
    /// Count it, report it, go on.
    #[cfg_attr(feature = "serde", serde(alias = "ride-out"))]
    Ignore,
    /// Decelerate within the limits by the velocity loop: [`crate::safety::StopPlan`].
    ControlledStop,
    /// Short the motors: the wheels brake themselves in proportion to their speed, whatever is measured.
    Brake,
    /// No torque, wheels free to coast.
    Release,
}

/// Reaction to a fault, and whether it has to be reset before anything moves again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Response {
    /// What is done.
    pub reaction: Reaction,
    /// Ends in the state Fault, which only a reset leaves, instead of Stopped, from which arming is
    /// enough. Never true for a fault that is ignored.
    pub latch: bool,
}

impl Response {
    /// Count and go on.
    pub const IGNORE: Self = Self::passing(Reaction::Ignore);

    /// A reaction that needs no reset.
    pub const fn passing(reaction: Reaction) -> Self {
        let latch = false;
        Self { reaction, latch }
    }

    /// A reaction that needs a reset.
    pub const fn latched(reaction: Reaction) -> Self {
        let latch = true;
        Self { reaction, latch }
    }

    /// Both together: the more severe reaction, latched if either of them is.
    pub fn and(self, other: Self) -> Self {
        let reaction = if other.reaction > self.reaction {
            other.reaction
        } else {
            self.reaction
        };
        let latch = self.latch || other.latch;
        Self { reaction, latch }
    }
}
