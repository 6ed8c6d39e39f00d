//! `tune`.

use super::error::CommandError;
use super::robot::load;
use super::write::Writer;
use super::{robustness, say};
use crate::cli::Output;
use crate::robot_args::TuneArgs;
use indicatif::ProgressBar;
use serde::Serialize;
use sim_host::figure::Labelled;
use sim_host::job::RobotFile;
use sim_host::tune::{
    KNOBS, Score, Search, Seeds, Tuned, TuningProblem, gain_table, score_table, search, update,
};
use std::collections::BTreeMap;

/// A search as it stands in a JSON file.
#[derive(Serialize)]
struct Record<'a> {
    robot: &'a str,
    evaluations: u64,
    seed: u64,
    gains_before: BTreeMap<&'static str, f64>,
    gains_after: BTreeMap<&'static str, f64>,
    /// Before and after.
    training: [Score; 2],
    unseen: [Score; 2],
}

pub fn robot(arguments: &TuneArgs, output: &Output) -> Result<(), CommandError> {
    let robot = load(&arguments.robot)?;
    if arguments.write && !arguments.robot.exists() {
        return Err(CommandError::BuiltInRobot(robot.name));
    }
    let writer = Writer::new(output)?;
    let problem = problem(arguments, &robot)?;
    let how = Search {
        evaluations: arguments.evaluations.get(),
        seed: arguments.seed,
        ..Search::default()
    };
    // Hidden by itself where standard error is no terminal.
    let bar = ProgressBar::new(how.evaluations).with_style(robustness::style());
    let tuned = search(&problem, &how, || bar.inc(1));
    bar.finish_and_clear();
    let tuned = tuned?;
    let (before, after) = (tuned.unseen[0].total(), tuned.unseen[1].total());
    say(&format!(
        "{}: {}\n{}\n{}\n{}\n",
        robot.name,
        robot.base.name,
        gain_table(&tuned),
        score_table(&tuned),
        verdict(before, after)
    ))?;
    let name = format!("{}-tune", robot.name);
    draw(&problem, &how, &tuned, &robot.name, &name, &writer)?;
    let values = |gains| {
        KNOBS
            .iter()
            .map(|knob| (knob.key, knob.of(gains)))
            .collect()
    };
    let record = Record {
        robot: &robot.file,
        evaluations: how.evaluations,
        seed: how.seed,
        gains_before: values(&tuned.gains[0]),
        gains_after: values(&tuned.gains[1]),
        training: tuned.training,
        unseen: tuned.unseen,
    };
    writer.json(&name, &[record])?;
    if arguments.write {
        let written = |cause: String| CommandError::Write {
            path: arguments.robot.clone(),
            cause,
        };
        let text = update(&robot.text, &tuned.gains[1]).map_err(|e| written(e.to_string()))?;
        std::fs::write(&arguments.robot, text).map_err(|error| written(error.to_string()))?;
        say(&format!(
            "[gains] of {} are the new ones\n",
            arguments.robot.display()
        ))?;
    }
    say(&format!("results are in {}\n", output.out.display()))
}

fn verdict(before: f64, after: f64) -> String {
    let share = 100.0 * (before - after) / before;
    if after < before {
        format!(
            "better by {share:.0} % in worlds that the search did not see; fewer points are better"
        )
    } else {
        "no better in worlds that the search did not see: keep the gains, or search longer"
            .to_owned()
    }
}

fn problem(arguments: &TuneArgs, robot: &RobotFile) -> Result<TuningProblem, CommandError> {
    let Some(path) = &arguments.trajectory else {
        return Ok(TuningProblem::courses(&robot.base));
    };
    let bytes = std::fs::read(path).map_err(|cause| CommandError::Read {
        path: path.clone(),
        cause,
    })?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let problem = TuningProblem::trajectory(&robot.base, &stem, &bytes);
    let (problem, scaling) = problem.map_err(|cause| CommandError::Trajectory {
        path: path.clone(),
        cause,
    })?;
    say(&format!("{stem} on a {}: {scaling}\n", robot.base.name))?;
    Ok(problem)
}

/// Before and after, in the first world that was not seen. The curve, if that is what was tuned for.
fn draw(
    problem: &TuningProblem,
    how: &Search,
    tuned: &Tuned,
    robot: &str,
    name: &str,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let mission = problem.missions().saturating_sub(2);
    let seeds = Seeds::Unseen.draw(how.seed, 1);
    let seed = seeds.first().copied().unwrap_or_default();
    let (before, _) = problem.run(mission, &tuned.gains[0], seed)?;
    let (after, _) = problem.run(mission, &tuned.gains[1], seed)?;
    let main = Labelled {
        label: "after",
        trace: &after,
    };
    let other = Labelled {
        label: "before",
        trace: &before,
    };
    let robot = robot.replace('_', " ");
    let title = format!(
        "{robot}: {} on a floor that the search did not see",
        problem.name(mission)
    );
    writer.figure(name, &title, main, Some(other))
}
