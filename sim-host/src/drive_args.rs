//! Arguments for trajectory files.

use clap::{Args, ValueEnum};
use sim_host::drive::{FileRun, Retiming};
use sim_host::import::Pace;
use sim_host::mission::BaseSpec;
use sim_host::precision::Precision;
use std::path::PathBuf;

/// How trajectory files are run. Scenario files say it themselves.
#[derive(Clone, Debug, Args)]
pub struct DriveArgs {
    /// Trajectory files: the base that drives, a file with [robot] and [limits] or one of
    /// paper-30kg, lab-10kg, hobby-1kg; else a 30 kg base
    #[arg(long, value_name = "FILE")]
    pub base: Option<PathBuf>,
    /// Trajectory files: start this far to the left of the path [m]; else 0.15, or 0 on a
    /// route shorter than 1 m or 8 s, which leaves no time to settle
    #[arg(long, value_name = "M")]
    offset: Option<f64>,
    #[command(flatten)]
    route: RouteArgs,
    /// Trajectory files: number type of the controller; else f32
    #[arg(long, value_enum)]
    precision: Option<Number>,
    /// Trajectory files: time between control ticks [s]; else that of the base's file
    #[arg(long, value_name = "S")]
    period: Option<f64>,
}

impl DriveArgs {
    /// The same for the library, on this base.
    pub fn file_run(&self, base: &BaseSpec) -> FileRun {
        FileRun {
            offset_m: self.offset,
            retiming: self.route.retiming(),
            precision: match self.precision {
                None | Some(Number::F32) => Precision::F32,
                Some(Number::F64) => Precision::F64,
            },
            period_s: self.period.unwrap_or(base.period_s()),
        }
    }

    /// The first that was given of those that a scenario has in its file; its base is not one of them where `by_base`.
    pub fn given(&self, by_base: bool) -> Option<&'static str> {
        let options = [
            ("--base", self.base.is_some() && !by_base),
            ("--offset", self.offset.is_some()),
            ("--fastest", self.route.fastest),
            ("--tolerance", self.route.tolerance.is_some()),
            ("--precision", self.precision.is_some()),
            ("--period", self.period.is_some()),
        ];
        let mut given = options.into_iter().filter(|(_, given)| *given);
        given.next().map(|(option, _)| option)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Number {
    /// Single precision, as on a chip
    F32,
    /// Double precision
    F64,
}

/// What is checked or compiled.
#[derive(Clone, Debug, Args)]
pub struct TrajectoryArgs {
    /// Trajectory files; `check` takes scenario files as well
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// The base that is to drive, a file with [robot] and [limits] or one of paper-30kg, lab-10kg,
    /// hobby-1kg; else a 30 kg base
    #[arg(long, value_name = "FILE")]
    pub base: Option<PathBuf>,
    #[command(flatten)]
    route: RouteArgs,
}

impl TrajectoryArgs {
    /// How references are made.
    pub fn retiming(&self) -> Retiming {
        self.route.retiming()
    }
}

/// How the reference of a trajectory file is made.
#[derive(Clone, Copy, Debug, Args)]
struct RouteArgs {
    /// Trajectory files: as fast as the base's limits allow; else nowhere faster than the file
    #[arg(long)]
    fastest: bool,
    /// Trajectory files: smooth the path by up to this, where that saves time or where noisy poses
    /// leave no other [m]; 0 follows every pose, else 0.01
    #[arg(long, value_name = "M")]
    tolerance: Option<f64>,
}

impl RouteArgs {
    fn retiming(self) -> Retiming {
        Retiming {
            pace: if self.fastest {
                Pace::Fastest
            } else {
                Pace::Own
            },
            tolerance_m: self.tolerance.unwrap_or(Retiming::default().tolerance_m),
        }
    }
}
