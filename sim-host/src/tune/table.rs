//! A search for people.

use super::knobs::KNOBS;
use super::score::Score;
use super::search::Tuned;
use crate::mission::BaseSpec;
use crate::numbers::refused;
use crate::verify::{StabilityMap, WEAVES};
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{Attribute, Cell, CellAlignment, ContentArrangement, Table};

/// All that a search for this base says, and a warning if gains after it let the robot weave.
pub fn report(base: &BaseSpec, tuned: &Tuned) -> (String, Option<String>) {
    let damping = least_damping(base, tuned);
    let [before, after] = &tuned.unseen;
    let text = format!(
        "{}\n{}\n{}\nleast damping of following: {:.2} before, {:.2} after",
        gain_table(tuned),
        score_table(tuned),
        verdict(before.total(), after.total()),
        damping[0],
        damping[1]
    );
    (text, damping_warning(damping[1]))
}

/// Gains before and after.
fn gain_table(tuned: &Tuned) -> Table {
    let mut table = begin(&["gain", "unit", "before", "after"]);
    for knob in KNOBS {
        let mut row = vec![Cell::new(knob.key), Cell::new(knob.unit)];
        row.extend(tuned.gains.iter().map(|gains| right(knob.of(gains))));
        table.add_row(row);
    }
    table
}

/// Scores before and after, where the search looked and where it did not.
fn score_table(tuned: &Tuned) -> Table {
    let mut table = begin(&[
        "points",
        "training\nbefore",
        "\nafter",
        "unseen\nbefore",
        "\nafter",
    ]);
    let scores = [tuned.training, tuned.unseen];
    let all: Vec<&Score> = scores.iter().flatten().collect();
    for (part, name) in Score::NAMES.iter().enumerate() {
        let mut row = vec![Cell::new(name)];
        let value = |score: &&Score| score.parts().get(part).copied().unwrap_or_default();
        row.extend(all.iter().map(|score| right(value(score))));
        table.add_row(row);
    }
    let mut row = vec![Cell::new("sum")];
    row.extend(all.iter().map(|score| right(score.total())));
    table.add_row(row);
    table
}

/// Least damping of following with the gains before and after, as [`StabilityMap`] has it.
fn least_damping(base: &BaseSpec, tuned: &Tuned) -> [f64; 2] {
    tuned.gains.map(|gains| {
        let base = BaseSpec {
            gains: Some(gains),
            ..base.clone()
        };
        StabilityMap::of(&base, 0, 0).least_damping()
    })
}

/// A warning if gains with this damping let a robot weave.
fn damping_warning(after: f64) -> Option<String> {
    (after < WEAVES).then(|| {
        format!(
            "with the gains after, the least damping of following, {}, is below {WEAVES}: the robot weaves for long; less `lateral` or `heading` \
             helps",
            refused(after, WEAVES)
        )
    })
}

/// How much better the gains are by their points in worlds that the search did not see.
fn verdict(before: f64, after: f64) -> String {
    let share = 100.0 * (before - after) / before;
    if after < before {
        // Never 0 %, which would be no better.
        let share = if share < 0.5 {
            "less than 1".to_owned()
        } else {
            format!("{share:.0}")
        };
        format!(
            "better by {share} % in worlds that the search did not see; fewer points are better"
        )
    } else {
        "no better in worlds that the search did not see: keep the gains, or search longer"
            .to_owned()
    }
}

fn begin(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_preset(UTF8_FULL_CONDENSED)
        .set_content_arrangement(ContentArrangement::Disabled);
    let bold = |name: &&str| Cell::new(name).add_attribute(Attribute::Bold);
    table.set_header(header.iter().map(bold));
    table
}

fn right(value: f64) -> Cell {
    Cell::new(format!("{value:.3}")).set_alignment(CellAlignment::Right)
}

#[cfg(test)]
mod tests {
    use super::{damping_warning, verdict};

    #[test]
    fn what_weaves_is_warned_of() {
        assert_eq!(damping_warning(0.1), None);
        let warning = damping_warning(0.099_999_99).expect("below the bound");
        assert!(warning.contains("0.09999999, is below 0.1:"), "{warning}");
    }

    #[test]
    fn better_is_never_by_nothing() {
        for (after, said) in [
            (0.89, "better by 11 % in"),
            (0.996, "better by less than 1 % in"),
            (1.0, "no better in"),
            (1.1, "no better in"),
        ] {
            let text = verdict(1.0, after);
            assert!(text.starts_with(said), "{text}");
        }
    }
}
