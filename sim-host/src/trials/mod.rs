//! Trials of a base on bad floors: what [`crate::tune`] searches with and [`crate::verify`] judges by.
//!
//! A trial is a [`Course`] in a world of a [`Condition`], drawn by a seed, with the chip's whole base
//! in it ([`crate::closed_loop`]); [`Figures`] say what came of it.

mod course;
mod figures;
mod floor;

pub use course::Course;
pub use figures::{Figures, Peak, REST_S};
pub use floor::{Condition, setup};

use crate::closed_loop::ClosedLoopError;
use crate::mission::Mission;
use crate::run::drive_and_observe;
use crate::trace::Trace;
use crate::world::WorldSetup;

/// Runs a mission in a world and observes the base at rest for [`REST_S`].
///
/// # Errors
/// Parameters out of their range.
pub fn run(mission: &Mission, setup: &WorldSetup) -> Result<(Trace, Figures), ClosedLoopError> {
    let trace = drive_and_observe(mission, setup, REST_S)?;
    let figures = Figures::of(mission, &trace);
    Ok((trace, figures))
}
