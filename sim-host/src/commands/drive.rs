//! Missions: `run`, and `check` and `compile` for trajectory files.

use super::error::CommandError;
use super::log::{finish, started};
use super::write::Writer;
use super::{advise, advise_of, robot, say};
use crate::cli::Output;
use crate::drive_args::{DriveArgs, TrajectoryArgs};
use crate::log_args::LogArgs;
use sim_host::advice::of_job;
use sim_host::csv_out::Columns;
use sim_host::drive::{ChipTable, DriveMetrics, summary, trajectory};
use sim_host::figure::Labelled;
use sim_host::import::FileVerdict;
use sim_host::job::{Content, Job, Trajectory};
use sim_host::mission::{BaseSpec, Mission};
use sim_host::pil::BaseCost;
use sim_host::plain_text::written_out;
use sim_host::record::{ChipRecord, DriveRecord};
use sim_host::run;
use sim_host::trace::Trace;
use std::path::Path;

/// A base's file, a built-in base, or the default one.
pub fn base(file: Option<&Path>) -> Result<BaseSpec, CommandError> {
    match file {
        Some(file) => Ok(robot::load(file)?.base),
        None => Ok(BaseSpec::default()),
    }
}

/// Runs a mission and writes its results.
pub fn run(
    mission: &Mission,
    file: Option<&Trajectory>,
    (csv, log): (bool, &LogArgs),
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    announce(mission, file)?;
    let (trace, pending) = started(log, Columns::Motion, &mission.base.name, |watch| {
        run::drive_watched(mission, watch)
    })?;
    let done = Done {
        trace,
        label: "robot",
        chip: None,
    };
    let written = results(mission, file, &done, csv, writer);
    finish(pending)?;
    written
}

/// A mission that has been run.
pub struct Done {
    pub trace: Trace,
    /// Who drove, in the figure's legend.
    pub label: &'static str,
    /// With the control task on a chip.
    pub chip: Option<ChipRecord<BaseCost>>,
}

/// What is about to be run.
pub fn announce(mission: &Mission, file: Option<&Trajectory>) -> Result<(), CommandError> {
    say(&written_out(&format!(
        "{}: {}\n",
        mission.name, mission.description
    )))?;
    advise_of(mission, file);
    if let Some(Trajectory { scaling, read }) = file {
        say(&format!(
            "{}\nbase       {}: {scaling}\n",
            FileVerdict(Ok(read)),
            mission.base.name
        ))?;
    }
    if mission.setup.is_none() {
        say(
            "plant      ideal: exact poses, wheels that do what is asked of them and never slip\n",
        )?;
    }
    Ok(())
}

/// Prints and writes what came of a mission.
pub fn results(
    mission: &Mission,
    file: Option<&Trajectory>,
    done: &Done,
    csv: bool,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let Done { trace, label, chip } = done;
    let name = &match chip {
        None => mission.name.clone(),
        Some(_) => format!("{}-pil", mission.name),
    };
    let metrics = DriveMetrics::of(mission, trace).ok_or(CommandError::NoRows)?;
    say(&format!("{}\n", summary(&metrics)))?;
    // In figures an underscore begins a subscript.
    let title = format!("{}: {}", name.replace('_', " "), mission.description);
    let main = Labelled { label, trace };
    writer.figure(name, &title, main, None)?;
    let record = DriveRecord::of(mission, file, trace, &metrics, chip.as_ref());
    writer.json(name, &[record])?;
    if csv {
        writer.csv(name, trace, Columns::Motion)?;
    }
    let why = match (&metrics.stopped, metrics.parked_s) {
        (Some(stop), _) => format!("the base stopped at {:.2} s: {}", stop.time_s, stop.cause),
        (None, None) if mission.ends_parked() => "the robot did not park".to_owned(),
        _ => return Ok(()),
    };
    Err(CommandError::NotDone {
        mission: mission.name.clone(),
        why,
    })
}

/// Verdicts, without running anything. A file that is refused keeps no other from being judged.
pub fn check(arguments: &TrajectoryArgs) -> Result<(), CommandError> {
    let base = base(arguments.base.as_deref())?;
    let mut refused = 0;
    for file in &arguments.files {
        let (verdict, is_in_order) = judged(file, arguments, &base);
        refused += usize::from(!is_in_order);
        say(&written_out(&format!("{}\n{verdict}\n\n", file.display())))?;
    }
    match refused {
        0 => Ok(()),
        count => Err(CommandError::Refused {
            count,
            of: arguments.files.len(),
        }),
    }
}

/// What is to be said of a file, and whether it is in order.
fn judged(file: &Path, arguments: &TrajectoryArgs, base: &BaseSpec) -> (String, bool) {
    let retiming = arguments.retiming();
    let bytes = match Content::read(file) {
        Err(error) => return (format!("verdict    refused\n  {error}"), false),
        Ok(Content::Trajectory { bytes, .. }) => bytes,
        Ok(Content::Scenario { file, text }) => {
            return match Job::parse(&file, &text) {
                Ok(job) => {
                    advise(&of_job(&job));
                    ("format     scenario\nverdict    in order".to_owned(), true)
                }
                Err(error) => (
                    format!("format     scenario\nverdict    refused\n{error}"),
                    false,
                ),
            };
        }
    };
    let trajectory = trajectory(&bytes, &retiming);
    let verdict = FileVerdict(trajectory.as_ref());
    let Ok(trajectory) = &trajectory else {
        return (format!("{verdict}\n"), false);
    };
    match retiming.of(trajectory, base) {
        Ok((_, scaling)) => (
            format!("{verdict}\nbase       {}: {scaling}", base.name),
            true,
        ),
        Err(error) => (
            format!("{verdict}\nbase       {}: {error}", base.name),
            false,
        ),
    }
}

/// Results are named after their file: those of a second one of that name would overwrite the first one's.
#[derive(Default)]
struct Names<'a>(Vec<(String, &'a Path)>);

impl<'a> Names<'a> {
    fn add(&mut self, name: &str, file: &'a Path) -> Result<(), CommandError> {
        match self.0.iter().find(|(other, _)| other == name) {
            Some((_, first)) => Err(CommandError::SameName {
                first: first.to_path_buf(),
                second: file.to_owned(),
                name: name.to_owned(),
            }),
            None => {
                self.0.push((name.to_owned(), file));
                Ok(())
            }
        }
    }
}

/// Tables for a chip. If one of the files cannot be used nothing is written, and of those every one is told.
pub fn compile(arguments: &TrajectoryArgs, output: &Output) -> Result<(), CommandError> {
    let base = base(arguments.base.as_deref())?;
    let mut tables = Vec::new();
    let mut failed = Vec::new();
    let mut names = Names::default();
    for file in &arguments.files {
        let table = compiled(file, arguments, &base, &mut names);
        table.map_or_else(|error| failed.push(error), |table| tables.push(table));
    }
    CommandError::all(failed)?;
    let writer = Writer::new(output)?;
    for (name, table) in tables {
        writer.bytes(&format!("{name}.rs"), table.rust().as_bytes())?;
        let binary = table.binary();
        writer.bytes(&format!("{name}.bin"), &binary)?;
        say(&format!(
            "{name}: {} samples, {} bytes, {}\n",
            table.compact.samples.len(),
            binary.len(),
            table.accuracy()
        ))?;
    }
    say(&format!("results are in {}\n", output.out.display()))
}

/// The table of a file, with its name.
fn compiled<'a>(
    file: &'a Path,
    arguments: &TrajectoryArgs,
    base: &BaseSpec,
    names: &mut Names<'a>,
) -> Result<(String, ChipTable), CommandError> {
    let Content::Trajectory { name, bytes } = Content::read(file)? else {
        return Err(CommandError::NoTrajectory(file.to_owned()));
    };
    names.add(&name, file)?;
    let table = ChipTable::of(&name, &bytes, base, &arguments.retiming());
    let table = table.map_err(|cause| CommandError::Trajectory {
        path: file.to_owned(),
        cause,
    })?;
    Ok((name, table))
}

/// All files of a `run`; whether scenarios are driven by the base as well. Of those that cannot be used every one is told.
pub fn load_all(
    files: &[std::path::PathBuf],
    arguments: &DriveArgs,
    base: &BaseSpec,
    by_base: bool,
) -> Result<Vec<Job>, CommandError> {
    let run = arguments.file_run(base);
    let mut jobs: Vec<Job> = Vec::new();
    let mut failed = Vec::new();
    let mut names = Names::default();
    for file in files {
        match Job::load(file, &run, base) {
            Ok(job) => match names.add(job.name(), file) {
                Ok(()) => jobs.push(job),
                Err(error) => failed.push(error),
            },
            Err(error) => failed.push(error.into()),
        }
    }
    CommandError::all(failed)?;
    let follows = |job: &Job| matches!(job, Job::Mission { file: Some(_), .. });
    match arguments.given(by_base) {
        Some(option) if !jobs.iter().any(follows) => Err(CommandError::ForTrajectories(option)),
        _ => Ok(jobs),
    }
}
