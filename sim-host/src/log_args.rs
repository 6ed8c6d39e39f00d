//! Arguments for logs.

use clap::Args;
use sim_host::datalog::{About, DataLog, DataLogError, RATE_HZ, Source};
use std::path::PathBuf;

/// Where every tick goes.
#[derive(Clone, Debug, Args)]
pub struct LogArgs {
    /// Write every tick, while the run goes on: .mcap for the tools of ROS 2, .wpilog for AdvantageScope
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Of .mcap: how often it has odometry, frames and joints, at each tick at most [Hz]
    #[arg(long, value_name = "HZ", default_value_t = RATE_HZ, value_parser = positive, requires = "log")]
    pub log_rate: f64,
}

impl LogArgs {
    /// The log of one of `count` runs: of several, each has its name before the ending.
    pub fn of_run(&self, name: &str, count: usize) -> Self {
        let path = |log: &PathBuf| {
            let stem = log.file_stem().unwrap_or_default().to_string_lossy();
            let ending = log.extension().unwrap_or_default().to_string_lossy();
            log.with_file_name(format!("{stem}-{name}.{ending}"))
        };
        Self {
            log: match count {
                0 | 1 => self.log.clone(),
                _ => self.log.as_ref().map(path),
            },
            ..*self
        }
    }

    /// Begins it, if there is to be one.
    pub fn begin(
        &self,
        source: Source,
        robot: &str,
        epoch_s: f64,
    ) -> Result<Option<DataLog>, DataLogError> {
        let Some(path) = &self.log else {
            return Ok(None);
        };
        let about = About {
            source,
            robot,
            epoch_s,
            rate_hz: self.log_rate,
        };
        DataLog::create(path, &about).map(Some)
    }
}

/// A number of an argument, above 0 and finite.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a positive number".to_owned()),
    }
}
