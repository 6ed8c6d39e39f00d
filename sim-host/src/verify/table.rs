//! A verification for people.

use super::study::{Case, Verification};
use super::{DISTANCE_M, HEADING_RAD, RIPPLE, StabilityMap, likely_causes, shortcoming};
use crate::mission::BaseSpec;
use crate::trials::Course;
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Random starts beside the path: none lost says with 95 % confidence that less than 1 % are.
const STARTS: usize = 300;

const HEADER: [&str; 9] = [
    "course",
    "world",
    "parked",
    "worst error\n[mm]",
    "\n[mrad]",
    "time [s]\nmean / worst",
    "ripple at rest\n[% of limit]",
    "peak [% of\nits limit]",
    "stopped for; found",
];

/// All that a verification of this base with worlds from `seed` on says: table, verdict, likely causes of failures, and how stable it follows.
pub fn report(base: &BaseSpec, verification: &Verification, seed: u64) -> String {
    let mut text = format!(
        "{}\nerrors and times of the runs that parked, of all if none did; worst over the seeds. !: beyond what \
         is asked.\nstopped for; found: faults with the number of runs, found ones may have been ignored.\n\n{}\n",
        case_table(verification),
        verdict(verification)
    );
    if !verification.holds() {
        text += &likely(base);
    }
    let _ = write!(text, "{}", StabilityMap::of(base, STARTS, seed));
    text
}

/// A line for each likely cause of failures.
pub fn likely(base: &BaseSpec) -> String {
    let causes = likely_causes(base).into_iter();
    causes
        .map(|cause| format!("likely     {cause}\n"))
        .collect()
}

/// A row for each case. Errors, times: of the runs that parked, or of all if none did.
fn case_table(verification: &Verification) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let bold = |name: &&str| Cell::new(name).add_attribute(Attribute::Bold);
    table.set_header(HEADER.iter().map(bold));
    for case in &verification.cases {
        let right = |text: String| Cell::new(text).set_alignment(CellAlignment::Right);
        let mark = |value: f64, most: f64| if value > most { " !" } else { "" };
        let (mm, mrad) = (case.error_m, case.error_rad);
        table.add_row(vec![
            Cell::new(case.course),
            Cell::new(case.condition),
            right(format!("{} of {}", case.parked, case.runs)),
            right(format!("{:.1}{}", 1e3 * mm, mark(mm, DISTANCE_M))),
            right(format!("{:.1}{}", 1e3 * mrad, mark(mrad, HEADING_RAD))),
            right(format!("{:.1} / {:.1}", case.mean_s, case.longest_s)),
            right(case.ripple.map_or_else(
                || "never parked".to_owned(),
                |share| format!("{:.2}{}", 1e2 * share, mark(share, RIPPLE)),
            )),
            right(case.peak.map_or_else(String::new, |peak| {
                let what = peak.name.split(" [").next().unwrap_or_default();
                format!("{:.0} {what}", 1e2 * peak.share)
            })),
            Cell::new(faults(case)),
        ]);
    }
    table
}

fn faults(case: &Case) -> String {
    let count = |name: &str, runs: usize| format!("{name} {runs}");
    let stops: Vec<_> = case.stopped.iter().map(|(n, r)| count(n, *r)).collect();
    let found: Vec<_> = case.found.iter().map(|(n, r)| count(n, *r)).collect();
    match (stops.is_empty(), found.is_empty()) {
        (true, true) => String::new(),
        _ => format!("{}; {}", stops.join(", "), found.join(", ")),
    }
}

/// PASS or FAIL, the criteria, and what failed how often.
pub fn verdict(verification: &Verification) -> String {
    let mut reasons = BTreeMap::new();
    for reason in verification
        .runs
        .iter()
        .filter_map(|run| shortcoming(&run.figures))
    {
        *reasons.entry(reason).or_insert(0_usize) += 1;
    }
    let failures = verification.failures();
    let mut text = if failures.failed == 0 {
        format!(
            "PASS: all of {} runs (failing: {failures}; 95 % confidence)",
            failures.runs
        )
    } else {
        let list = reasons
            .iter()
            .map(|(reason, count)| format!("{reason} {count}"));
        let list: Vec<_> = list.collect();
        format!("FAIL: {failures} ({}; 95 % confidence)", list.join(", "))
    };
    for course in Course::ALL {
        let parked = |share, word: &str| match verification.parked_within_s(course, share) {
            time_s if time_s.is_finite() => format!("{word} {time_s:.1} s"),
            _ => "never".to_owned(),
        };
        let [half, most, all] = [(0.5, "within"), (0.99, "within"), (1.0, "after")]
            .map(|(share, word)| parked(share, word));
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "\n{:10} half parked {half}, 99 % {most}, the last {all}",
            course.name()
        );
    }
    let _ = write!(
        text,
        "\nasked: parked, true error at most {:.0} mm and {:.0} mrad, torque ripple at rest below {:.0} %",
        1e3 * DISTANCE_M,
        1e3 * HEADING_RAD,
        1e2 * RIPPLE
    );
    text
}
