//! Why a command failed.

use sim_host::campaign::{CampaignError, GyroOfRobot};
use sim_host::constants::ConstantsError;
use sim_host::drive::FileError;
use sim_host::figure::FigureError;
use sim_host::identify::{IdentifyError, KnownError, LogError};
use sim_host::job::JobError;
use sim_host::monitor::MonitorError;
use sim_host::part::MergeError;
use sim_host::pil::PilError;
use sim_host::robustness::StudyError;
use sim_host::run::RunError;
use sim_host::scenario::ScenarioError;
use sim_host::tune::{TuneError, TuneStudyError};
use sim_host::verify::VerifyError;
use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// Of several files or runs, in their order.
    #[error("{} failed", .0.len())]
    Several(Vec<Self>),
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    Run(#[from] RunError),
    #[error("{}: cannot be read: {cause}", path.display())]
    Read {
        path: PathBuf,
        cause: std::io::Error,
    },
    #[error("{}: {cause}", path.display())]
    Trajectory { path: PathBuf, cause: FileError },
    #[error(transparent)]
    TuneStudy(#[from] TuneStudyError),
    #[error("{count} of {of} files refused: see above")]
    Refused { count: usize, of: usize },
    #[error("{}: a scenario, not a trajectory", .0.display())]
    NoTrajectory(PathBuf),
    #[error("{0} is for trajectory files: a scenario says it itself, in its file")]
    ForTrajectories(&'static str),
    #[error("{mission}: {why}")]
    NotDone { mission: String, why: String },
    #[error("no fresh seed: {0}")]
    Seed(#[from] getrandom::Error),
    #[error(transparent)]
    Figure(#[from] FigureError),
    #[error("{}: cannot be written: {cause}", path.display())]
    Write { path: PathBuf, cause: String },
    #[error("{}: is read by this command, and would be overwritten: choose another place for results", .0.display())]
    OverInput(PathBuf),
    #[error("{}: is a file: --out takes a directory for results", .0.display())]
    OutIsFile(PathBuf),
    #[error("{}: cannot be listed: {cause}", path.display())]
    List {
        path: PathBuf,
        cause: std::io::Error,
    },
    #[error(
        "{} and {}: both are named {name}, so their results would overwrite each other",
        first.display(),
        second.display()
    )]
    SameName {
        first: PathBuf,
        second: PathBuf,
        name: String,
    },
    #[error("{0}: is for the default law: no other can run it")]
    OnlyMotion(String),
    #[error("no built-in scenario is named {0}: see `sim-host list`")]
    NoSuchName(String),
    #[error(transparent)]
    Pil(#[from] PilError),
    #[error(transparent)]
    Monitor(#[from] MonitorError),
    #[error("chip and host computed different bits: see the report above")]
    Apart,
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    #[error("--gyro {0}")]
    Gyro(#[from] GyroOfRobot),
    #[error(transparent)]
    Merge(#[from] MergeError),
    #[error("{0} is not for a part: give it to the whole, or draw a seed once and give it to all")]
    NotInParts(&'static str),
    #[error("these are parts of `{0}`, which has none that this version knows")]
    NoParts(String),
    #[error("--log is for parts of `faults` and `verify`, and these are of `{0}`")]
    LogWhat(String),
    #[error("--write is for parts of `tune`, and these are of `{0}`")]
    WriteWhat(String),
    #[error("{}: not the robot that was tuned: its gains stay as they are", .0.display())]
    OtherRobot(PathBuf),
    #[error(transparent)]
    Bench(#[from] sim_host::bench::BenchError),
    #[error("no threads: {0}")]
    Threads(String),
    #[error(
        "{0}: no least times are known of this base; there are those of paper-30kg, lab-10kg, hobby-1kg"
    )]
    NoLeastTimes(String),
    #[error("no law has {word} in its name; there are: {}", names.join("; "))]
    NoLaw {
        word: String,
        names: Vec<&'static str>,
    },
    #[error("no class has {word} in its name; there are: {}", names.join("; "))]
    NoClass { word: String, names: Vec<String> },
    #[error("{}: none of the classes that `--only` leaves drives files", .0.display())]
    FileOfNoClass(PathBuf),
    #[error(transparent)]
    Verify(#[from] VerifyError),
    #[error(transparent)]
    Tune(#[from] TuneError),
    #[error("{0} is built in: `--write` needs a file of your own")]
    BuiltInRobot(String),
    #[error("{file}: {cause}")]
    Constants { file: String, cause: ConstantsError },
    #[error("{0}: not every run did what is asked: see above")]
    NotProven(String),
    #[error(transparent)]
    Study(#[from] StudyError),
    #[error(transparent)]
    ClosedLoop(#[from] sim_host::closed_loop::ClosedLoopError),
    #[error("{0} runs against the rules: see above")]
    Violations(usize),
    #[error(transparent)]
    Coverage(#[from] sim_host::identify::coverage::CoverageError),
    #[error(
        "intervals hold the true value in less than 90 % of the drives, by more than chance: {}",
        .0.join(", ")
    )]
    NotCovered(Vec<String>),
    #[error(transparent)]
    Live(#[from] sim_host::identify::live::BenchError),
    #[error(transparent)]
    DataLog(#[from] sim_host::datalog::DataLogError),
    #[error("{}: {cause}", path.display())]
    Bag {
        path: PathBuf,
        cause: sim_host::ros::read::ReadError,
    },
    #[error("--topic: {0}")]
    Topic(String),
    #[error("Ctrl-C cannot be caught: {0}")]
    Signals(std::io::Error),
    #[error("cannot print: {0}")]
    Print(std::io::Error),
    #[error("the run has no ticks")]
    NoRows,
    #[error("--known: {0}")]
    Known(#[from] KnownError),
    #[error("{}: {cause}", path.display())]
    Log { path: PathBuf, cause: LogError },
    #[error("{}: {cause}", path.display())]
    Contradiction { path: PathBuf, cause: IdentifyError },
}

impl CommandError {
    /// Success if there is none.
    pub fn all(mut errors: Vec<Self>) -> Result<(), Self> {
        match errors.len() {
            0 => Ok(()),
            1 => Err(errors.remove(0)),
            _ => Err(Self::Several(errors)),
        }
    }

    /// What to tell, one after the other.
    pub fn each(&self) -> &[Self] {
        match self {
            Self::Several(errors) => errors,
            one => std::slice::from_ref(one),
        }
    }
}
