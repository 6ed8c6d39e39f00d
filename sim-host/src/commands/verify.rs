//! `verify`.

use super::error::CommandError;
use super::log::watched;
use super::robot::load;
use super::write::Writer;
use super::{part, say};
use crate::cli::Output;
use crate::log_args::LogArgs;
use crate::robot_args::VerifyArgs;
use serde::Serialize;
use sim_host::csv_out::Columns;
use sim_host::figure::Labelled;
use sim_host::job::RobotFile;
use sim_host::part::Study as _;
use sim_host::verify::{
    Case, Run, Verification, VerifyStudy, check, report as report_text, shortcoming, write_csv,
};

/// A verification as it stands in a JSON file.
#[derive(Serialize)]
struct Record<'a> {
    robot: &'a str,
    description: &'a str,
    first_seed: u64,
    seeds: u32,
    passed: bool,
    cases: &'a [Case],
}

pub fn robot(arguments: &VerifyArgs, output: &Output) -> Result<(), CommandError> {
    let robot = load(&arguments.robot)?;
    check(&robot)?;
    let study = VerifyStudy {
        robot,
        path: arguments.robot.clone(),
        seeds: arguments.seeds,
        seed: part::seed(&arguments.seed, &arguments.part)?,
    };
    part::without_log(&arguments.part, &arguments.log)?;
    part::run(&study, &arguments.part, output, |runs| {
        report(&study, runs, &arguments.log, output)
    })
}

/// Prints and writes what a verification says.
pub fn report(
    study: &VerifyStudy,
    runs: Vec<Run>,
    log: &LogArgs,
    output: &Output,
) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let verification = Verification::of(runs);
    let (robot, seed) = (&study.robot, study.seed);
    let base = &robot.base;
    say(&format!(
        "{}: {}, worlds of seeds {seed} to {}\n{}\n",
        robot.name,
        base.name,
        seed.wrapping_add(u64::from(study.seeds.get() - 1)),
        report_text(base, &verification, seed)
    ))?;
    let name = study.name();
    draw_worst(&verification, robot, (&name, log), &writer)?;
    let record = Record {
        robot: &robot.file,
        description: &base.name,
        first_seed: seed,
        seeds: study.seeds.get(),
        passed: verification.holds(),
        cases: &verification.cases,
    };
    writer.json(&name, &[record])?;
    writer.rows(&name, |out| write_csv(&verification.runs, out))?;
    say(&format!("results are in {}\n", output.out.display()))?;
    match verification.holds() {
        true => Ok(()),
        false => Err(CommandError::NotProven(robot.name.clone())),
    }
}

/// The worst run, with all its signals.
fn draw_worst(
    verification: &Verification,
    robot: &RobotFile,
    (name, log): (&str, &LogArgs),
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let worst = verification.worst().ok_or(CommandError::NoRows)?;
    let trace = watched(log, Columns::Motion, &robot.base.name, |watch| {
        worst.again_watched(&robot.base, watch)
    })?;
    let reason = shortcoming(&worst.figures).map_or_else(String::new, |r| format!(", fails: {r}"));
    let what = format!(
        "{}, {}, seed {}{reason}",
        worst.course.name(),
        worst.condition.name(),
        worst.seed
    );
    say(&format!("worst      {what}\n"))?;
    let main = Labelled {
        label: "robot",
        trace: &trace,
    };
    let title = format!("{}: {what}", robot.name.replace('_', " "));
    writer.figure(name, &title, main, None)?;
    writer.csv(&format!("{name}-worst"), &trace, Columns::Motion)
}
