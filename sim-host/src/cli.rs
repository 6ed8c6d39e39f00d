//! Arguments.

mod board;
mod identify;

use crate::bench_args::BenchArgs;
use crate::count_args::seeds;
use crate::drive_args::{DriveArgs, TrajectoryArgs};
use crate::log_args::LogArgs;
use crate::part_args::{MergeArgs, PartArgs};
use crate::robot_args::{ConstantsArgs, TuneArgs, VerifyArgs};
use crate::seed_args::SeedArgs;
use clap::{Args, Parser, Subcommand};
use sim_host::teleop::KEYS;
use std::num::{NonZeroU32, NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

pub use board::{Chip, LawArg, Link, MonitorArgs, TeleopArgs};
pub use identify::{IdentifyArgs, LiveArgs};

const EXAMPLES: &str = "\
Examples:
  sim-host                                  both cases of the paper, results in out/
  sim-host list                             what can be run by name
  sim-host show paper-curve > mine.toml     a commented file to start from
  sim-host run mine.toml --csv              figure, metrics and trace of your own scenario
  sim-host run slalom.json                  the same for a trajectory file, as people have them
  sim-host check slalom.json                whether it can be driven, and what was repaired
  sim-host compare mine.toml                your scenario, neural beside plain
  sim-host compare weaving mine.toml        two scenarios beside each other
  sim-host pil paper-curve                  the same, with the controller on an emulated chip
  sim-host robustness                       what the laws stand: noise, latency, friction, ...
  sim-host faults                           everything that can fail, in every state
  sim-host tune robot.toml                  gains for your own robot, searched on bad floors
  sim-host verify robot.toml                whether it does its courses there
  sim-host verify robot.toml --shard 3/8    a part of it, for `sim-host merge`
  sim-host bench --quick                    the default law beside published ones
  sim-host constants robot.toml             the same robot as constants for a firmware
  sim-host teleop --base robot.toml         drive it by the keyboard, simulated or with --port
  sim-host monitor /dev/ttyACM0             live numbers of a real board
  sim-host identify drive.csv               mass, lengths, friction, motors of a real robot";

/// Closed-loop simulation of a two-wheeled robot that follows a reference and parks.
///
/// Without a command: `paper`.
#[derive(Debug, Parser)]
#[command(version, about, after_help = EXAMPLES, arg_required_else_help = false)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    output: Output,
}

/// Where and how results are written.
#[derive(Clone, Debug, Args)]
pub struct Output {
    /// Directory for results; made if it does not exist
    #[arg(long, global = true, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Write every N-th control tick to CSV files (the hand-over and the last one always)
    #[arg(long, global = true, value_name = "N", default_value = "1")]
    pub every: NonZeroUsize,
}

/// What to do.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Run both cases of the paper, neural and plain (the default)
    ///
    /// Prints a table and writes for each case a figure (.svg, .png) in the layout of the paper's
    /// Figs. 3 and 4, a CSV of every signal for both controllers, and the metrics as JSON.
    Paper,
    /// Run scenarios, each with the controller that it names, or trajectory files
    ///
    /// Writes NAME.svg, NAME.png and NAME.json; NAME.csv with --csv.
    ///
    /// Trajectory files are WPILib trajectory JSON, Choreo .traj of a differential drive, TUM poses,
    /// or CSV with the header t,x,y,theta[,v,w[,a,alpha]]; the content tells. BAG.mcap:/topic takes the
    /// poses of a bag of ROS 2. The robot starts at
    /// rest beside the path, follows, hands over by itself and parks at the last pose.
    ///
    /// The exit code is 1 if a base stops for a fault, or does not park where it is to: at the end
    /// of a trajectory file, or at the goal that a scenario for the default law ends with.
    #[command(after_help = "\
Examples:
  sim-host run paper-line
  sim-host run scenarios/*.toml --out results --csv --every 10
  sim-host run slalom.json --base bases/lab-10kg.toml --offset 0.3")]
    Run {
        /// Scenario or trajectory files, or names from `sim-host list` of which there is no file here
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// Write the trace of each run as CSV
        #[arg(long)]
        csv: bool,
        #[command(flatten)]
        log: LogArgs,
        #[command(flatten)]
        drive: DriveArgs,
    },
    /// Run one scenario with several laws, or several files, and put them side by side
    ///
    /// One scenario of the paper runs with both of its laws, or with those of --law; the default law hands over to
    /// parking when the paper's do. Several files run each with its own controller, or each with each of --law. The
    /// first run is compared with each of the others.
    #[command(after_help = "\
Examples:
  sim-host compare scenarios/paper-curve.toml
  sim-host compare paper-line --law neural --law motion
  sim-host compare standing-reference weaving slalom.json --out results")]
    Compare {
        /// Scenario or trajectory files, or names from `sim-host list` of which there is no file here
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// A law to compare; may be given several times
        #[arg(long = "law", value_enum, value_name = "LAW")]
        laws: Vec<LawArg>,
        /// Write the trace of each run as CSV
        #[arg(long)]
        csv: bool,
        #[command(flatten)]
        drive: DriveArgs,
    },
    /// Processor in the loop: the controller on an emulated chip, the plant here
    ///
    /// Builds the firmware, starts the emulator, and closes the loop. Scenarios of the paper's law run with a
    /// firmware of that law; those of the default law and trajectory files with the whole base: the control task
    /// with localiser, supervisor and motors, on the realistic plant. Writes NAME-pil.svg, .png,
    /// .json and .csv, and says whether every number of every tick was bit-equal to the same
    /// controller run here in lock step; if not, the exit code is 1. Also
    /// instructions per tick, stack, flash and RAM.
    #[command(after_help = "\
Examples:
  sim-host pil                              both cases of the paper
  sim-host pil mine.toml --machine riscv32 --every 10
  sim-host pil mine.toml --link uart        over the emulated serial port: slow and real
  sim-host pil slalom.json --base bases/lab-10kg.toml      the whole base along a trajectory")]
    Pil {
        /// Scenario or trajectory files, or names from `sim-host list` of which there is no file here; without any: both
        /// cases of the paper
        #[arg(value_name = "FILE")]
        files: Vec<PathBuf>,
        /// The emulated chip
        #[arg(long, value_enum, default_value_t = Chip::CortexM4f)]
        machine: Chip,
        /// The way to it
        #[arg(long, value_enum, default_value_t = Link::Fifo)]
        link: Link,
        #[command(flatten)]
        log: LogArgs,
        #[command(flatten)]
        drive: DriveArgs,
    },
    /// Both cases of the paper under everything that is wrong with a real robot
    ///
    /// Control period, mass and inertia, torque saturation, noise, latency, friction, single
    /// precision: each with the neural, the plain and the default law. Prints a table and writes
    /// robustness.csv, .svg and .png. Runs on all processors; the results do not depend on how many.
    #[command(after_help = "\
Examples:
  sim-host robustness
  sim-host robustness --only noise --only together --seeds 100
  sim-host robustness --only period --out results")]
    Robustness {
        /// Runs of each condition with noise
        #[arg(long, value_name = "N", default_value = "20", value_parser = seeds)]
        seeds: NonZeroU32,
        /// Only conditions whose name contains this; may be given several times
        #[arg(long, value_name = "TEXT")]
        only: Vec<String>,
        #[command(flatten)]
        part: PartArgs,
    },
    /// The fault campaign: random trouble in every state, on the realistic plant
    ///
    /// Drives the three built-in bases in turn, or the robot of a file, into each state of the supervisor, puts something out
    /// of order (encoders, wheels, motor drivers, battery, poses, ticks, host, the button), and checks
    /// every tick and the end: torques, type and time of what is found, the way of the stop, and that
    /// nothing moves that must not. Prints a table, writes faults.csv (a row for each run) and
    /// faults.json, of a robot NAME-faults.csv and .json. Exit code 1 if a run breaks a rule. Runs on all processors; the
    /// results do not depend on how many. --log is of the run of --run, or else of the first that breaks a rule.
    #[command(after_help = "\
Examples:
  sim-host faults --runs 10000 --seed 1
  sim-host faults mine.toml --runs 600             a robot of your own; its gyro fails as well if it has one
  sim-host faults --runs 10000 --fresh             runs that nobody has seen
  sim-host faults --runs 1000 --only ice --fresh
  sim-host faults --runs 1 --seed 1 --run 4711     one of them again, every tick in faults-4711.csv")]
    Faults {
        /// The robot's file, as in bases/, or one of paper-30kg, lab-10kg, hobby-1kg; else these three in turn
        #[arg(value_name = "ROBOT.toml")]
        robot: Option<PathBuf>,
        /// Number of runs
        #[arg(long, value_name = "N", default_value = "1000")]
        runs: NonZeroU64,
        #[command(flatten)]
        seed: SeedArgs,
        /// Only troubles whose name contains this; may be given several times, each with a word or a whole name
        #[arg(long, value_name = "TEXT")]
        only: Vec<String>,
        /// Begin with this run, and write its trace
        #[arg(long, value_name = "K")]
        run: Option<u64>,
        /// The built-in bases with the gyro of parts/, which can fail as well; a robot's file has its own, or none
        #[arg(long, conflicts_with = "robot")]
        gyro: bool,
        #[command(flatten)]
        log: LogArgs,
        #[command(flatten)]
        part: PartArgs,
    },
    /// Put the parts of a study together: what the study would have printed and written in one piece
    ///
    /// `faults`, `verify`, `robustness` and `tune` take --shard I/N, on any machine and in any order. A part that is missing is
    /// named with the command that makes it; parts of another study, another version or another file of the robot
    /// are refused. The same bytes, the same exit code, for any number of parts. docs/cluster.md has job files.
    #[command(after_help = "\
Examples:
  for i in 1 2 3 4; do sim-host faults --runs 10000 --shard $i/4 & done; wait
  sim-host merge out/faults-part-*-of-4.parquet
  sim-host merge parts/*.parquet --out results --parquet results/runs.parquet")]
    Merge(MergeArgs),
    /// Find gains for a robot of your own
    ///
    /// Searches in worlds that are drawn around the robot of the file: bad floor, mass and inertia 30 % off,
    /// battery at 80 to 100 %, late and noisy poses. Prints scores before and after, also in worlds that the
    /// search did not see; writes NAME-tune.svg, .png and .json, and with --write [gains] into the file.
    /// A robot without [pose_source] is refused, as by `verify`. The same arguments give the same gains, on any number of processors.
    #[command(after_help = "\
Examples:
  sim-host tune mine.toml
  sim-host tune mine.toml --trajectory slalom.json --evaluations 600 --write")]
    Tune(TuneArgs),
    /// Verify in simulation that a robot does its courses on bad floors
    ///
    /// The paper's line and curve and a park, in worlds drawn around the robot of the file and at their
    /// corners. Every run has to park within 5 mm and 10 mrad of the true goal and be quiet there: if not,
    /// the exit code is 1. A robot without [pose_source] cannot, and is refused. Writes NAME-verify.csv, .json,
    /// and the worst run as .svg, .png and -worst.csv; --log is of that run.
    #[command(after_help = "\
Examples:
  sim-host verify mine.toml
  sim-host verify lab-10kg --seeds 50 --out results
  sim-host verify lab-10kg --seeds 556 --fresh      10,008 runs that nobody has seen")]
    Verify(VerifyArgs),
    /// The default law beside published ones: one benchmark
    ///
    /// Ramsete, LTV unicycle, Nav2's graceful controller and regulated pure pursuit, Aicardi's and Samson's laws,
    /// turn-drive-turn, two PIDs, linear MPC and the paper's laws, with their usual constants and with those that a search
    /// finds, on the same wheels, limits, velocity loop, estimator and plant. Parking from starts whose least time is known,
    /// trajectory files, the paper's cases, steps of velocity; ideal, realistic and on a bad floor. Prints tables in
    /// which what beats the default law is marked; writes bench.csv (a row for each run), bench.md, a figure for each
    /// class and bench.html, a page that needs no network. Runs on all processors; the results do not depend on how
    /// many.
    #[command(after_help = "\
Examples:
  sim-host bench --quick
  sim-host bench lab-10kg --only parking --runs 100 --fresh
  sim-host bench --file slalom.json --only files")]
    Bench(BenchArgs),
    /// The old name of `verify`, for one release more
    #[command(hide = true)]
    Prove(VerifyArgs),
    /// Write a robot's constants for a firmware
    ///
    /// NAME.rs has every parameter of the base, gains included, as the simulator uses them, bit for bit; NAME.h the same for C.
    #[command(after_help = "\
Examples:
  sim-host constants mine.toml --out firmware/src
  sim-host constants mine.toml --c --out include")]
    Constants(ConstantsArgs),
    /// Drive a base by the keyboard, in a simulated world or over a serial port
    ///
    /// Speed and turn rate in steps of a tenth; orders go out 25 times a second, and a base that gets none any more
    /// stops by itself. Ends with q. Without --port the firmware drives in a world drawn for the base, a bad floor
    /// as of `verify`, in real time. If standard input is no terminal it is a script of keys, in which a dot lets
    /// 0.2 s pass; a simulated base then runs as fast as it can.
    #[command(after_help = format!("\
Keys: {KEYS}
Examples:
  sim-host teleop --base lab-10kg
  sim-host teleop --port /dev/ttyACM0 --base robot.toml --speed 0.3
  printf 'wwww.......... q' | sim-host teleop --hold-heading"))]
    Teleop(TeleopArgs),
    /// Show and log what a board sends over its serial port
    ///
    /// Only listens, unless it is to poll. Ends with the line, after --seconds, or with Ctrl-C.
    #[command(after_help = "\
Examples:
  sim-host monitor /dev/ttyACM0
  sim-host monitor /dev/ttyUSB0 --baud 921600 --csv bench.csv")]
    Monitor(MonitorArgs),
    /// Say whether files can be driven, without running anything
    ///
    /// Prints format, figures, repairs with their places, and how time is scaled for the base; or why a file
    /// is refused. Exit code 0 if all can be driven, 1 if not.
    Check(TrajectoryArgs),
    /// Compile trajectory files for a chip
    ///
    /// Writes NAME.rs, a table for flash, and NAME.bin, the same as little-endian f32 for streaming:
    /// as few samples as the core's interpolation needs, time-scaled to the base's limits.
    Compile(TrajectoryArgs),
    /// Identify a robot from a log: lengths, mass, inertia, friction, motor constants
    ///
    /// Each with its 95 % interval, or with the reason why this log cannot tell it and what would.
    /// Prints a table, writes LOG-identify.json. Exit code 0 also where something is not
    /// identifiable, 1 if the log cannot be read or contradicts itself, or if --coverage finds an
    /// interval that holds the true value in less than 90 % of the drives, by more than chance.
    ///
    /// The log is CSV with a header, SI units; a row holds what is measured at t and the command
    /// that acts from t on:
    ///   t
    ///   duty_right, duty_left [and supply] | voltage_right, voltage_left | torque_right, torque_left
    ///   counts_right, counts_left | angle_right, angle_left      (at the wheel)
    ///   current_right, current_left      optional, before the row's command acts
    ///   x, y, theta      optional external pose, cells empty where none came
    ///
    /// A bag of ROS 2 (.mcap) has the same in topics; docs/logs.md says how they are read.
    ///
    /// --port drives a live base by itself in a stated space, records every control tick on it, and
    /// identifies from that. THE BASE MOVES three seconds later; Ctrl-C stops it.
    ///
    /// Commands and encoders alone fix neither lengths nor masses. docs/identify.md says what does,
    /// and what to drive.
    #[command(
        verbatim_doc_comment,
        after_help = "\
Examples:
  sim-host identify drive.csv --counts-per-turn 2048
  sim-host identify drive.csv --counts-per-turn 2048 --latency 0.03 --known mass=9.8,gear=20
  sim-host identify drive.csv --known radius=0.08 --known track=0.35 --profile robot.toml
  sim-host identify bag.mcap --topic torque=/commands --topic pose=/mocap --joints right,left
  sim-host identify --port /dev/ttyACM0 --baud 921600 --space 2x1 --profile robot.toml
  sim-host identify --coverage bases/lab-10kg.toml --fresh     drives that nobody has seen"
    )]
    Identify(Box<IdentifyArgs>),
    /// List scenarios with their descriptions
    List {
        /// A directory of scenario files instead of the built-in ones
        #[arg(value_name = "DIR")]
        directory: Option<PathBuf>,
    },
    /// Print a built-in scenario file, to start your own from
    Show {
        /// A name from `sim-host list`
        name: String,
    },
}

impl Cli {
    /// The command, `paper` if none was given.
    pub fn command(&self) -> &Command {
        self.command.as_ref().unwrap_or(&Command::Paper)
    }

    /// Where the command's log goes.
    pub fn log(&self) -> Option<&Path> {
        let log = match self.command() {
            Command::Run { log, .. } | Command::Pil { log, .. } | Command::Faults { log, .. } => {
                log
            }
            Command::Verify(arguments) | Command::Prove(arguments) => &arguments.log,
            Command::Merge(arguments) => &arguments.log,
            Command::Monitor(arguments) => &arguments.log,
            _ => return None,
        };
        log.log.as_deref()
    }

    /// Where results go.
    pub fn output(&self) -> &Output {
        &self.output
    }
}
