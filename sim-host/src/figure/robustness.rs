//! The study of robustness: a row per condition, a mark per law and case.

use super::FigureError;
use super::axis::Axis;
use super::chart::{Chart, Item, Upright, sheet};
use super::drawing::Drawing;
use super::legend::{Entry, Marker, entry};
use super::style::{BLACK, BLUE, GREEN, ORANGE};
use crate::robustness::{Case, ComparedLaw, RunVerdict, StudyOutcome, StudyRow};

/// Height of a condition's row, and of what is above and below all rows \[px\].
const ROW: f64 = 27.0;
const FRAME: f64 = 150.0;
/// Widths of the panel with the names and of the one without \[px\].
const WIDTHS: (f64, f64) = (700.0, 560.0);
/// Range of distances \[mm\]: below a hundredth nothing differs, above a metre all is lost.
const DISTANCES: (f64, f64) = (0.01, 1000.0);
/// Where a robot that is lost is drawn, and a distance below the range \[mm\].
const LOST_AT: f64 = 700.0;
const LEAST_AT: f64 = 0.0115;
/// Range of settling times \[s\], and where a robot that never settles is drawn.
const TIMES: (f64, f64) = (4.0, 9.6);
const NEVER_AT: f64 = 9.3;

/// Distance to the goal at the end and settling time, side by side.
///
/// # Errors
/// [`FigureError::Empty`] if there are no rows.
pub fn robustness(rows: &[StudyRow<'_>]) -> Result<Drawing, FigureError> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.condition.name.as_str()).collect();
    names.dedup();
    if names.is_empty() {
        return Err(FigureError::Empty);
    }
    let (ends, times) = (ends(rows, &names), times(rows, &names));
    let height = FRAME + ROW * names.len() as f64;
    let cells = vec![(WIDTHS.0, None, ends), (WIDTHS.1, None, times)];
    let title = "The paper's cases under what is wrong with a real robot";
    Ok(sheet(title, vec![(height, cells)]))
}

fn ends(rows: &[StudyRow<'_>], names: &[&str]) -> Chart {
    let place = |outcome: &StudyOutcome| {
        let lost = outcome.verdict > RunVerdict::Missed;
        let mm = |metres: f64| (1.0e3 * metres).clamp(LEAST_AT, LOST_AT);
        let (mean, worst) = (mm(outcome.final_m.mean), mm(outcome.final_m.worst));
        if lost {
            (LOST_AT, LOST_AT, true)
        } else {
            (mean, worst, false)
        }
    };
    let categories = names.iter().rev().map(|name| (*name).to_owned()).collect();
    Chart {
        // The band that counts as settled.
        uprights: vec![Upright {
            at: 50.0,
            dashes: &[6.0, 4.0],
            label: "5 cm",
        }],
        ..chart(
            Axis::log(
                DISTANCES,
                "distance to the goal at the end [mm]; bars: worst seed; × lost",
            ),
            categories,
            marks(rows, names, place),
        )
    }
}

fn times(rows: &[StudyRow<'_>], names: &[&str]) -> Chart {
    let place = |outcome: &StudyOutcome| match outcome.settling_s {
        Some(time) => (time.mean, time.worst.min(NEVER_AT), false),
        None => (NEVER_AT, NEVER_AT, true),
    };
    Chart {
        legend: legend(),
        ..chart(
            Axis::new(
                TIMES,
                "settled within 5 cm, 0.05 rad [s]; × not before the hand-over",
            ),
            vec![String::new(); names.len()],
            marks(rows, names, place),
        )
    }
}

fn chart(x: Axis, names: Vec<String>, items: Vec<Item>) -> Chart {
    let y = (0.3, names.len() as f64 + 0.7);
    Chart::new(x, Axis::named(y, names), items)
}

/// A mark per law and case; `place` gives mean and worst, and whether the run failed.
fn marks(
    rows: &[StudyRow<'_>],
    names: &[&str],
    place: impl Fn(&StudyOutcome) -> (f64, f64, bool),
) -> Vec<Item> {
    let mut items = Vec::new();
    for (law, color) in COLORS {
        for (case, marker) in MARKERS {
            for failed in [false, true] {
                let marker = if failed { Marker::Cross } else { marker };
                for row in rows.iter().filter(|row| row.law == law && row.case == case) {
                    let (mean, worst, fails) = place(&row.outcome);
                    if fails != failed {
                        continue;
                    }
                    let name = row.condition.name.as_str();
                    let at = names.iter().position(|other| *other == name).unwrap_or(0);
                    let point = (mean, (names.len() - at) as f64 + lane(law, case));
                    // A bar without length would leave its end on the mark.
                    if worst > mean {
                        items.push(Item::Bar(point, worst, color));
                    }
                    items.push(Item::Mark(point, marker, 4.0, color));
                }
            }
        }
    }
    items
}

const COLORS: [(ComparedLaw, &str); 3] = [
    (ComparedLaw::Neural, BLUE.strong),
    (ComparedLaw::Plain, ORANGE.strong),
    (ComparedLaw::Default, GREEN.strong),
];

const MARKERS: [(Case, Marker); 2] = [
    (Case::Line, Marker::Circle),
    (Case::Curve, Marker::Triangle),
];

/// Laws side by side within a row, and the cases of a law close to each other.
fn lane(law: ComparedLaw, case: Case) -> f64 {
    let lane = match law {
        ComparedLaw::Neural => 0.28,
        ComparedLaw::Plain => 0.0,
        ComparedLaw::Default => -0.28,
    };
    match case {
        Case::Line => lane + 0.05,
        Case::Curve => lane - 0.05,
    }
}

fn legend() -> Vec<Entry> {
    let laws = COLORS.map(|(law, color)| entry(law.name(), color, Some(Marker::Square), &[]));
    let cases = MARKERS.map(|(case, marker)| entry(case.name(), BLACK, Some(marker), &[]));
    laws.into_iter().chain(cases).collect()
}
