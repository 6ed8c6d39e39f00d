//! What came of a run.

use super::fault_injection::FaultInjectionKind;
use super::plan::{Bases, Plan, Target};
use crate::scenario::BASES;
use controller_core::safety::FaultKind;
use controller_core::safety::supervisor::Cause;
use serde::{Deserialize, Serialize};

/// How a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum End {
    /// Stayed as it was: nothing was asked of the base.
    Held,
    /// Went on, and parked.
    Parked,
    /// Stopped in time.
    Stopped(Why),
    /// As is stated to happen: neither good nor against the rules.
    Known(Failing),
}

/// What is known to go wrong, at a rate that is stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Failing {
    /// Neither parks for good nor gives up.
    Adrift,
}

impl Failing {
    /// For tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Adrift => "adrift",
        }
    }
}

/// What a base was stopped by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Why {
    /// The host, before the trouble had any effect.
    Host,
    /// The button.
    Button,
    /// No frame came from the host.
    Link,
    /// What was asked for was refused.
    Refused,
    /// A fault.
    Fault(FaultKind),
    /// Anything else.
    Other,
}

impl Why {
    pub(super) fn of(cause: Cause) -> Self {
        match cause {
            Cause::Host => Self::Host,
            Cause::EmergencyStop => Self::Button,
            Cause::LinkLost => Self::Link,
            Cause::Fault(fault) => Self::Fault(fault.kind()),
            _ => Self::Other,
        }
    }

    /// For tables and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Button => "button",
            Self::Link => "link_lost",
            Self::Refused => "refused",
            Self::Fault(kind) => kind.name(),
            Self::Other => "other",
        }
    }
}

/// What a run must not do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// Since the start of the run \[s\].
    pub at_s: f64,
    /// What.
    pub what: String,
}

/// Way of a stop beside its bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// Way from the tick in which the stop began \[m\].
    pub way_m: f64,
    /// At most \[m\].
    pub bound_m: f64,
}

impl Stop {
    /// Share of the bound that was used.
    pub fn share(&self) -> f64 {
        if self.bound_m > 0.0 {
            self.way_m / self.bound_m
        } else {
            0.0
        }
    }

    pub(super) fn worse(self, other: Self) -> Self {
        if other.share() > self.share() {
            other
        } else {
            self
        }
    }
}

/// The first finding of a trouble.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Detection {
    /// As what.
    pub why: Why,
    /// After it began \[s\].
    pub after_s: f64,
    /// Way of the base meanwhile \[m\].
    pub way_m: f64,
}

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunOutcome {
    /// Number.
    pub run: u64,
    /// Which base.
    pub base: usize,
    /// Name of the robot of a file, if that is the base; else it is one of [`BASES`].
    pub robot: Option<String>,
    /// In what state.
    pub target: Target,
    /// What.
    pub injection: FaultInjectionKind,
    /// And what came on top, if anything did.
    pub second: Option<FaultInjectionKind>,
    /// When \[s\].
    pub at_s: f64,
    /// First finding.
    pub found: Option<Detection>,
    /// The stop that came nearest to its bound.
    pub stop: Stop,
    /// Largest true speed after the trouble began \[m/s\].
    pub fastest: f64,
    /// Largest distance from the goal, and largest heading error, of a base that said it was parked \[m, rad\].
    pub parked: Option<(f64, f64)>,
    /// Most of the time that counts towards a deadline in which the trouble was not found \[s\].
    pub counted_s: f64,
    /// After the end the base was mended, reset and given a goal, and parked there.
    pub again: bool,
    /// How it ended.
    pub end: Result<End, Violation>,
}

impl RunOutcome {
    /// Name of the base.
    pub fn base_name(&self) -> &str {
        let built_in = || BASES.get(self.base).map_or("", |base| base.name);
        self.robot.as_deref().unwrap_or_else(built_in)
    }

    pub(super) fn begin(bases: &Bases, plan: &Plan) -> Self {
        Self {
            run: plan.run,
            base: plan.base,
            robot: bases.robot().map(str::to_owned),
            target: plan.target,
            injection: plan.injection.kind,
            second: None,
            at_s: 0.0,
            found: None,
            stop: Stop::default(),
            fastest: 0.0,
            parked: None,
            counted_s: 0.0,
            again: false,
            end: Ok(End::Held),
        }
    }
}
