//! Scenarios: one closed loop each, written as a TOML file.
//!
//! Everything is settable and nothing is guessed: an unknown key or a value out of range is a
//! [`ScenarioError`] that names file, line and key. Omitted gains are those of
//! [`Params::paper`]. A file whose `controller.kind` is `motion` is a [`crate::mission::Mission`], for the
//! law for a real base. The files in `scenarios/` are commented and built into the program.

mod base;
mod belief;
mod built_in;
mod built_in_base;
mod check;
mod file;
mod hardware;
mod mission;
mod ranges;
mod renamed;
mod source;

pub use built_in::{BUILT_IN, BuiltIn, MISSIONS, PAPER};
pub use built_in_base::{BASES, BuiltInBase, GYRO, SPEED_DRIVER};
pub use ranges::FAR;
pub use renamed::RENAMED_KEYS;
pub use source::ScenarioError;
pub(crate) use source::{if_named, text};

use crate::motion::ReferenceMotion;
use crate::precision::Precision;
use controller_core::paper::params::Params;
use controller_core::paper::params::Reset;
use controller_core::reference::ParkingPlan;
use controller_core::robot::Robot;
use controller_core::types::Measured;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The control law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ControlLaw {
    /// Backstepping through shunting neurons, Eqs. (15)-(23).
    #[default]
    Neural,
    /// Backstepping alone, Eqs. (10)-(14): the baseline.
    Plain,
}

/// The controller's mathematical functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MathsBackEnd {
    /// `libm`.
    #[default]
    Libm,
    /// `micromath`, single precision only.
    Micromath,
    /// The core's own functions, single precision only.
    Single,
}

/// How neurons are advanced over a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Update {
    /// Exact exponential, last input held.
    ExactHeld,
    /// Exact exponential, mean of last and present input.
    #[default]
    ExactMean,
    /// Rational approximation, mean of last and present input.
    RationalMean,
}

/// The law that drives the last metres to the target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ParkingLaw {
    /// Eq. (20) as published: no feedback of e_y.
    #[default]
    Paper,
}

/// What happens to the acceleration neurons at the hand-over, Eq. (23).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ResetRule {
    /// The torque does not jump.
    #[default]
    TorqueContinuous,
    /// As the paper prints it.
    Printed,
    /// They start from zero.
    Zero,
}

impl From<ResetRule> for Reset {
    fn from(rule: ResetRule) -> Self {
        match rule {
            ResetRule::TorqueContinuous => Self::TorqueContinuous,
            ResetRule::Printed => Self::Printed,
            ResetRule::Zero => Self::Zero,
        }
    }
}

/// Which controller flies the scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub struct Controller {
    /// The law.
    pub kind: ControlLaw,
    /// Its number type.
    pub precision: Precision,
    /// Its mathematical functions.
    pub maths: MathsBackEnd,
    /// Its neurons' update; without meaning for [`ControlLaw::Plain`].
    pub neurons: Update,
    /// Its parking law.
    pub parking: ParkingLaw,
}

/// A closed loop, checked: every field is within its range and fits the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// File name without its extension.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Which controller.
    pub controller: Controller,
    /// What the controller believes and how it is tuned.
    pub params: Params<f64>,
    /// What the robot really is.
    pub robot: Robot<f64>,
    /// Where the robot is at t = 0 and how it moves.
    pub start: Measured<f64>,
    /// The reference, Eq. (6).
    pub motion: ReferenceMotion,
    /// When to stop tracking and where to park; `None` tracks to the end.
    pub hand_over: Option<ParkingPlan<f64>>,
    /// Length of the run \[s\].
    pub duration_s: f64,
    /// Control period \[s\].
    pub period_s: f64,
}

/// Keys of files of the law for a real base that the paper's have not.
const MOTION_ONLY: [&str; 3] = ["base", "event", "world"];

impl Scenario {
    /// Reads a scenario file.
    ///
    /// # Errors
    /// A file that cannot be read, or [`Scenario::parse`]'s.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        source::load(path, Self::parse)
    }

    /// A scenario from its text; `file` is the name that errors show.
    ///
    /// # Errors
    /// Not TOML, an unknown or missing key, a value of the wrong type or out of range, or values
    /// that contradict each other.
    pub fn parse(file: &str, text: &str) -> Result<Self, ScenarioError> {
        let place = source::Source::new(file, text);
        let wrong = match crate::mission::Mission::kind(text).as_deref() {
            None if MOTION_ONLY.iter().any(|key| place.has(key)) => {
                Some("is missing: a file with a base is of the law for a real base, \"motion\"")
            }
            None | Some("neural" | "plain") => None,
            Some("motion") => {
                Some("is the law for a real base, which `run` takes and this does not")
            }
            Some(_) => Some("is not one of neural, plain and motion"),
        };
        if let Some(wrong) = wrong {
            return Err(place.error("controller.kind", wrong));
        }
        let keys = toml::from_str(text);
        let keys = keys.map_err(|error| place.misread(source::Kind::Scenario, &error))?;
        let stem = Path::new(file).file_stem();
        let name = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        check::scenario(name, &keys, &place)
    }

    /// The same scenario flown by another law.
    pub fn with_law(&self, kind: ControlLaw) -> Self {
        let mut other = self.clone();
        other.controller.kind = kind;
        other
    }

    /// Number of control periods.
    pub fn ticks(&self) -> usize {
        // `check` keeps the quotient between 1 and a few millions.
        (self.duration_s / self.period_s).round() as usize
    }
}
