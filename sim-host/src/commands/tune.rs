//! `tune`.

use super::error::CommandError;
use super::robot::load;
use super::write::Writer;
use super::{part, say, tell};
use crate::cli::Output;
use crate::robot_args::TuneArgs;
use serde::Serialize;
use sim_host::figure::Labelled;
use sim_host::part::Study as _;
use sim_host::scenario::BuiltInBase;
use sim_host::tune::{
    Find, KNOBS, Score, Search, Seeds, TrajectoryText, TuneStudy, Tuned, TuningProblem, check,
    conclude, report as report_text, update,
};
use std::collections::BTreeMap;
use std::path::Path;

/// A search as it stands in a JSON file.
#[derive(Serialize)]
struct Record<'a> {
    robot: &'a str,
    evaluations: u64,
    starts: usize,
    seed: u64,
    gains_before: BTreeMap<&'static str, f64>,
    gains_after: BTreeMap<&'static str, f64>,
    /// Before and after.
    training: [Score; 2],
    unseen: [Score; 2],
}

pub fn robot(arguments: &TuneArgs, output: &Output) -> Result<(), CommandError> {
    let robot = load(&arguments.robot)?;
    if arguments.write && BuiltInBase::at(&arguments.robot).is_some() {
        return Err(CommandError::BuiltInRobot(robot.name));
    }
    if arguments.write && arguments.part.shard.is_some() {
        return Err(CommandError::NotInParts("--write"));
    }
    check(&robot)?;
    let trajectory = arguments.trajectory.as_deref().map(read).transpose()?;
    let study = TuneStudy {
        robot,
        path: arguments.robot.clone(),
        trajectory,
        evaluations: arguments.evaluations.get(),
        starts: arguments.starts.get(),
        seed: arguments.seed,
    };
    let write = arguments.write.then_some(arguments.robot.as_path());
    part::run(&study, &arguments.part, output, |finds| {
        report(&study, &finds, write, output)
    })
}

fn read(path: &Path) -> Result<TrajectoryText, CommandError> {
    let bytes = std::fs::read(path).map_err(|cause| CommandError::Read {
        path: path.to_owned(),
        cause,
    })?;
    let stem = path.file_stem().unwrap_or_default();
    Ok(TrajectoryText {
        name: stem.to_string_lossy().into_owned(),
        path: path.to_owned(),
        bytes,
    })
}

/// Prints and writes what a search says; with `write` the gains into that file of the robot as well.
pub fn report(
    study: &TuneStudy,
    finds: &[Find],
    write: Option<&Path>,
    output: &Output,
) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let (problem, scaling) = study.problem()?;
    let (robot, how) = (&study.robot, study.search());
    if let Some((scaling, trajectory)) = scaling.zip(study.trajectory.as_ref()) {
        let name = &trajectory.name;
        say(&format!("{name} on a {}: {scaling}\n", robot.base.name))?;
    }
    let tuned = conclude(&problem, &how, finds)?;
    let (before, after) = (tuned.unseen[0].total(), tuned.unseen[1].total());
    let (text, warning) = report_text(&robot.base, &tuned);
    say(&format!("{}: {}\n{text}\n", robot.name, robot.base.name))?;
    if let Some(warning) = warning {
        tell(&format!("warning: {}: {warning}\n", robot.name));
    }
    let name = study.name();
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
        starts: how.starts,
        seed: how.seed,
        gains_before: values(&tuned.gains[0]),
        gains_after: values(&tuned.gains[1]),
        training: tuned.training,
        unseen: tuned.unseen,
    };
    writer.json(&name, &[record])?;
    match write {
        Some(path) if after < before => {
            let written = |cause: String| CommandError::Write {
                path: path.to_owned(),
                cause,
            };
            let text = update(&robot.text, &tuned.gains[1]).map_err(|e| written(e.to_string()))?;
            std::fs::write(path, text).map_err(|error| written(error.to_string()))?;
            say(&format!("[gains] of {} are the new ones\n", path.display()))?;
        }
        Some(path) => say(&format!("[gains] of {} stay as they are\n", path.display()))?,
        None => {}
    }
    say(&format!("results are in {}\n", output.out.display()))
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
