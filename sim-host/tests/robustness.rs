//! The study of robustness: against an independent calculation, and as a program.

use sim_host::robustness::{
    COLUMNS, Case, Condition, Group, Law, Row, Verdict, catalogue, study, write_csv,
};
use std::num::NonZeroU32;
use std::process::Command;

const SEEDS: NonZeroU32 = NonZeroU32::new(20).expect("not 0");

fn some(keep: impl Fn(&Condition) -> bool) -> Vec<Condition> {
    let mut conditions = catalogue();
    conditions.retain(|condition| keep(condition));
    assert!(!conditions.is_empty());
    conditions
}

fn all<'a>(conditions: &'a [Condition]) -> Vec<Row<'a>> {
    study(conditions, SEEDS, || {}).expect("the built-in cases are in order")
}

#[test]
fn the_papers_law_stands_what_an_independent_calculation_says() {
    let conditions = catalogue();
    let (mut times, mut ends, mut moments) = (0, 0, 0);
    for row in all(&conditions).iter().filter(|row| row.law == Law::Neural) {
        let (outcome, disturbance) = (&row.outcome, &row.condition.disturbance);
        let expected = row.case.expected(row.condition);
        let what = format!("{}, {}: {outcome:?}", row.condition.name, row.case.name());
        if expected.fails {
            assert_eq!(outcome.settling_s, None, "{what}");
        }
        if let Some((low, high)) = expected.settling_s {
            let time = outcome.settling_s.expect(&what).mean;
            // Settled in between ticks is seen at the next one, and figures have two decimals.
            let late = disturbance.period_s + 0.02;
            assert!(low - 0.02 <= time && time <= high + late, "{what}");
            times += 1;
        }
        if let Some((low, high)) = expected.final_mm {
            let end = 1.0e3 * outcome.final_m.mean;
            // Without noise the digits of the figure, and what else a push does than along the goal.
            // With noise the figure is of one run, which scatters about the mean by half of it.
            let random = 0.4 * high;
            let exact = 0.15 + 0.02 * high;
            let tolerance = if disturbance.is_random() {
                random
            } else {
                exact
            };
            assert!(low - tolerance <= end && end <= high + tolerance, "{what}");
            ends += 1;
        }
        if let Some(moment) = expected.moment_std_nm {
            // 2,000 samples give 1.6 %, and the figure has two digits.
            let ratio = outcome.following_std.moment / moment;
            assert!((0.93..1.07).contains(&ratio), "{what}");
            moments += 1;
        }
    }
    // So that an emptied catalogue does not pass.
    assert!(
        times >= 40 && ends >= 40 && moments == 6,
        "{times} {ends} {moments}"
    );
}

#[test]
fn ten_newtons_lose_the_papers_law_and_not_the_default() {
    let conditions = some(|c| c.name == "limit 10 N, 5 N m");
    for row in all(&conditions)
        .iter()
        .filter(|row| row.case == Case::Curve)
    {
        let lost = row.outcome.verdict == Verdict::LostFollowing;
        assert_eq!(lost, row.law != Law::Default, "{row:?}");
    }
}

#[test]
fn the_default_law_parks_exactly_without_noise_and_unknown_forces() {
    let known = |c: &Condition| !c.disturbance.is_random() && c.group != Group::Force;
    // Four times the mass is braked too late, and it still works its way back at the end.
    let conditions = some(|c| known(c) && !c.name.starts_with("m × 4"));
    for row in all(&conditions)
        .iter()
        .filter(|row| row.law == Law::Default)
    {
        // The latch's tolerance of 0.5 mm, and what the robot rolls on after it.
        assert!(row.outcome.final_m.worst < 1.0e-3, "{row:?}");
        assert!(row.outcome.parked_s.is_some(), "{row:?}");
    }
}

#[test]
fn single_precision_changes_nothing_that_matters() {
    let conditions = some(|c| matches!(c.group, Group::Nominal | Group::Precision));
    let rows = all(&conditions);
    let (double, single) = rows.split_at(rows.len() / 2);
    for (double, single) in double.iter().zip(single) {
        let (a, b) = (&double.outcome, &single.outcome);
        let apart = (a.final_m.mean - b.final_m.mean).abs();
        // The paper's laws differ by the rounding of 5 m, some 1e-6. The default law stops where its
        // latch catches, which may be a tick, and so some 10 µm, apart.
        let limit = if single.law == Law::Default {
            1.0e-4
        } else {
            1.0e-5
        };
        assert!(apart < limit, "{double:?}\n{single:?}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let conditions = some(|c| c.name == "all together");
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let rows = pool.build().expect("a pool").install(|| all(&conditions));
        let mut csv = Vec::new();
        write_csv(&rows, &mut csv).expect("memory");
        csv
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn the_program_writes_table_figure_and_numbers() {
    let here = tempfile::tempdir().expect("a directory");
    let run = |arguments: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_sim-host"));
        let program = program.arg("robustness").args(arguments);
        program.current_dir(here.path()).output().expect("it runs")
    };
    let done = run(&[
        "--only", "5 mm", "--only", "single", "--seeds", "2", "--out", "here",
    ]);
    let (shown, errors) = (
        String::from_utf8(done.stdout).expect("UTF-8"),
        String::from_utf8(done.stderr).expect("UTF-8"),
    );
    assert!(done.status.success(), "{errors}");
    // No progress where nobody watches.
    assert_eq!(errors, "");
    for part in [
        "pose noise 5 mm, 5 mrad",
        "single precision",
        "expected",
        "4.98",
    ] {
        assert!(shown.contains(part), "{part} is not in\n{shown}");
    }
    let file = |name: &str| std::fs::read(here.path().join("here").join(name)).expect(name);
    assert!(file("robustness.png").starts_with(b"\x89PNG"));
    assert!(file("robustness.svg").starts_with(b"<svg"));
    let numbers = file("robustness.csv");
    let mut csv = csv::Reader::from_reader(numbers.as_slice());
    let rows: Vec<_> = csv.records().map(|row| row.expect("a row")).collect();
    // Two conditions, two cases, three laws.
    assert_eq!(rows.len(), 12);
    assert!(rows.iter().all(|row| row.len() == COLUMNS.len()));
    assert_eq!(&rows[0][4], "2");

    let refused = run(&["--only", "earthquake"]);
    let errors = String::from_utf8(refused.stderr).expect("UTF-8");
    assert!(!refused.status.success() && errors.contains("earthquake") && errors.contains("5 N"));
}
