//! Verification in simulation: does a base do its courses on bad floors?
//!
//! Every [`Course`] under every [`Condition`], many seeds each: all of them have to park within 5 mm and
//! 10 mrad of the true goal and then be quiet. A simulation says nothing about a robot that is not as
//! its file says; it shows what the numbers in the file are good for.

mod csv;
mod margins;
mod part;
mod study;
mod table;

pub use csv::{run_sheet, write as write_csv};
pub use margins::{Place, StabilityMap};
pub use part::VerifyStudy;
pub use study::{Case, Run, Verification, VerifyError, runs, verify};
pub use table::{case_table, verdict};

use crate::job::RobotFile;
use crate::mission::BaseSpec;
use crate::scenario::ScenarioError;
use crate::trials::{self, Condition, Course, Figures};
use std::f64::consts::TAU;

/// Largest true distance to the goal \[m\].
pub const DISTANCE_M: f64 = 5.0e-3;
/// Largest true heading error \[rad\].
pub const HEADING_RAD: f64 = 10.0e-3;
/// What largest and least torque of a wheel at rest may differ by, over its limit.
pub const RIPPLE: f64 = 0.01;

/// Whether a robot can be asked for this at all.
///
/// # Errors
/// One that learns from nothing outside where it is: of its runs all would fail, whatever its gains are.
pub fn check(robot: &RobotFile) -> Result<(), ScenarioError> {
    let asked = format!(
        "a run has to end within {:.0} mm and {:.0} mrad of the true goal",
        1e3 * DISTANCE_M,
        1e3 * HEADING_RAD
    );
    trials::check_poses(robot, &asked)
}

/// The likely cause of failures, where a number of the base says it: encoders so coarse that one count more on one wheel turns
/// the base out of tolerance. Bases of 1 and 10 kg with 90 counts a turn, 17 and 15 mrad each, fail in 10 of 72 runs, none with 180.
pub fn likely_cause(base: &BaseSpec) -> Option<String> {
    let wheels = &base.robot.wheels;
    let counts = base.hardware.as_ref()?.counts_per_turn;
    let way_m = TAU * wheels.radius_right_m.max(wheels.radius_left_m) / counts;
    let turn_rad = way_m / wheels.track_m;
    (turn_rad > HEADING_RAD || way_m > DISTANCE_M).then(|| {
        format!(
            "[encoder] counts_per_turn = {counts}: one count is {:.1} mm of a wheel's way and turns the base by {:.1} mrad",
            1e3 * way_m,
            1e3 * turn_rad
        )
    })
}

/// What a run did not fulfil, if anything; the first of them.
pub fn shortcoming(figures: &Figures) -> Option<&'static str> {
    [
        ("not parked", !figures.parked),
        ("distance", figures.error_m > DISTANCE_M),
        ("heading", figures.error_rad > HEADING_RAD),
        // No ripple was measured if it did not park.
        ("ripple", figures.ripple.is_none_or(|share| share >= RIPPLE)),
    ]
    .into_iter()
    .find_map(|(name, failed)| failed.then_some(name))
}

/// How bad a run is, to find the worst one: parked before not parked, then by error over tolerance.
fn badness(figures: &Figures) -> f64 {
    let error = (figures.error_m / DISTANCE_M).max(figures.error_rad / HEADING_RAD);
    let quiet = figures.ripple.unwrap_or_default() / RIPPLE;
    // No error reaches a thousand tolerances on these courses.
    let lost = if figures.parked { 0.0 } else { 1.0e3 };
    lost + error.max(quiet)
}

/// Runs of all cases, in order.
const fn grid() -> [(Course, Condition); 18] {
    let mut all = [(Course::Line, Condition::Drawn); 18];
    let mut at = 0;
    while at < all.len() {
        let conditions = Condition::ALL.len();
        all[at] = (
            Course::ALL[at / conditions],
            Condition::ALL[at % conditions],
        );
        at += 1;
    }
    all
}
