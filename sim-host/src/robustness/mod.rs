//! How much the laws stand: the paper's two cases under everything that is wrong with a real robot.
//!
//! The plant is the realistic one, [`crate::world`], perfect but for the disturbance: ideal torques, a pose with each tick.
//! A [`Condition`] changes one thing (control period, mass, saturation, noise, latency, friction,
//! precision) or several; [`study`] runs it with both cases and all laws, those with noise many
//! times. Beside the figures of the paper's law stand those of an independent double-precision
//! calculation, where there are some.
//!
//! ```
//! use sim_host::robustness::{Case, ComparedLaw, Disturbance, run};
//!
//! let late = Disturbance { pose_latency_s: 0.1, ..Disturbance::NOMINAL };
//! let figures = run(&late, Case::Line, ComparedLaw::Neural, 0)?;
//! assert!((figures.settling_s.ok_or("never settled")? - 5.28).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod body;
mod catalogue;
mod closed_loop;
mod condition;
mod csv;
mod law;
mod part;
mod study;
mod table;

pub use catalogue::catalogue;
pub use closed_loop::{LOST, Run, RunVerdict, run};
pub use condition::{Condition, Disturbance, Expected, Group, Range};
pub use csv::{column_names, write as write_csv};
pub use law::{ComparedLaw, base_with_limits};
pub use part::Robustness;
pub use study::{Spread, StudyOutcome, StudyRow, rows, runs, study};
pub use table::{tables, three_digits};

use crate::scenario::ScenarioError;
use crate::world::{ActuationError, WorldError};
use controller_core::error::ParamError;

/// A case of the paper: from rest 1 m beside the reference to 4 m along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Case {
    /// Fig. 3. The paper's laws hand over at 9.0 s.
    Line,
    /// Fig. 4. The paper's laws hand over at 9.5 s.
    Curve,
}

impl Case {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Line, Self::Curve];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Curve => "curve",
        }
    }

    /// What an independent calculation expects of the paper's law in this case.
    pub fn expected(self, condition: &Condition) -> &Expected {
        let [line, curve] = &condition.expected;
        match self {
            Self::Line => line,
            Self::Curve => curve,
        }
    }
}

/// Why there is no run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A word that no condition has in its name.
    #[error("no condition has {word} in its name; there are: {}", names.join("; "))]
    NoCondition {
        /// The word.
        word: String,
        /// All conditions.
        names: Vec<String>,
    },
    /// A case that should be built in.
    #[error("the case {0} is not built in")]
    Missing(&'static str),
    /// A case that cannot be read.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Parameters that the core refuses.
    #[error("{0}")]
    Params(ParamError),
    /// A plant that cannot be.
    #[error("world.{0}")]
    World(#[from] WorldError),
    /// Torques that are no numbers.
    #[error(transparent)]
    Actuation(#[from] ActuationError),
}

impl From<ParamError> for StudyError {
    fn from(error: ParamError) -> Self {
        Self::Params(error)
    }
}
