//! Independent double precision transcription of the paper's control laws, and, in [`motion`] and [`localiser`], of what drives a real base.
//!
//! Nothing here is shared with the controller: matrices and vectors are written as a textbook writes them,
//! so that a slip in the controller's scalar formulas is not repeated. Units are SI, angles are radians.
//! Numbers such as Eq. (15) are those of the paper; where the paper's print is wrong the printed form is kept
//! beside the corrected one.

pub mod closed_loop;
pub mod continuous;
pub mod hand_over;
pub mod laws;
pub mod localiser;
pub mod lyapunov;
pub mod motion;
pub mod neuron;
pub mod params;
pub mod posture;
pub mod reference;
pub mod robot;
pub mod sampled;
pub mod trace;

pub use closed_loop::{OracleLaw, Phase, Scenario, Switch};
pub use hand_over::Reset;
pub use laws::Command;
pub use params::Params;
pub use reference::Reference;
pub use trace::{OracleRow, State, Trace};
