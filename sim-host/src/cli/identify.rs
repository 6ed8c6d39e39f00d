//! Arguments for a log.

use super::SeedArgs;
use clap::Args;
use firmware_demo::excitation::{DURATIONS, SIDES};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// What to identify from.
#[derive(Clone, Debug, Args)]
pub struct IdentifyArgs {
    /// The log: CSV, or a bag of ROS 2 (.mcap)
    #[arg(value_name = "LOG", required_unless_present_any = ["coverage", "port"])]
    pub log: Option<PathBuf>,
    #[command(flatten)]
    pub live: LiveArgs,
    /// Encoder counts of one whole turn of the wheel (columns counts_...); else [encoder] of the file of --profile
    #[arg(long, value_name = "N", value_parser = positive)]
    pub counts_per_turn: Option<f64>,
    /// State values as exactly known, by the names of the table; `radius=0.08` is for both sides.
    /// `gear` gives the motors' own constants; `wheel_inertia` takes the wheels out of mass and inertia;
    /// `current_limit` leaves out where drivers limit; `efficiency` and `dead_band` may have half of their 95 %
    /// interval, `efficiency=0.8+-0.05`
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub known: Vec<String>,
    /// Age of an external pose in the row where it stands [s]
    #[arg(long, value_name = "S", default_value = "0", value_parser = not_negative)]
    pub latency: f64,
    /// Leave out wheels slower than this, where friction is not Coulomb's [rad/s]
    #[arg(long, value_name = "RAD/S", default_value = "0.5", value_parser = positive)]
    pub slow: f64,
    /// Update [robot], [motor], [battery] and [friction] of this base's file, or begin it, and print it
    #[arg(long, value_name = "FILE")]
    pub profile: Option<PathBuf>,
    /// Of a bag (.mcap): the topic of angle, counts, torque, duty, voltage, supply, current or pose; else angles and
    /// torques of /joint_states
    #[arg(long, value_name = "NAME=/TOPIC")]
    pub topic: Vec<String>,
    /// Of a bag: the wheels' joints
    #[arg(long, value_name = "RIGHT,LEFT", value_parser = two)]
    pub joints: Option<[String; 2]>,
    /// Instead of a log: how often the intervals hold the true values of this base, a file or one of paper-30kg,
    /// lab-10kg, hobby-1kg, on simulated drives of it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["log", "port", "profile", "known", "counts_per_turn", "latency", "slow"])]
    pub coverage: Option<PathBuf>,
    /// Drives of the coverage
    #[arg(long, value_name = "N", default_value = "200", requires = "coverage")]
    pub runs: NonZeroUsize,
    #[command(flatten)]
    pub seed: SeedArgs,
}

/// A live base in place of a log.
#[derive(Clone, Debug, Args)]
pub struct LiveArgs {
    /// Instead of a log: drive this base and record it. Its serial port, or the Unix socket of an emulator
    #[arg(long, value_name = "PORT", conflicts_with = "log", requires = "space")]
    pub port: Option<PathBuf>,
    /// Free floor for the middle of the axle [m]: a tenth of the length behind it, the rest ahead, half of the width to each
    /// side. The body needs its room around it
    #[arg(long, value_name = "LENGTHxWIDTH", value_parser = space, requires = "port", conflicts_with = "log")]
    pub space: Option<[f64; 2]>,
    /// Largest speed [m/s]; else 0.6 of the base's limit. The base takes less where the space is too short
    #[arg(long, value_name = "M/S", value_parser = positive, requires = "port")]
    pub speed: Option<f64>,
    /// Largest turn rate [rad/s]; else 0.6 of the base's limit
    #[arg(long, value_name = "RAD/S", value_parser = positive, requires = "port")]
    pub turn_rate: Option<f64>,
    #[arg(
        long, value_name = "S", default_value = "30", value_parser = |text: &str| within(text, DURATIONS), requires = "port",
        help = format!("Length of the drive, {} to {} [s]", DURATIONS.0, DURATIONS.1)
    )]
    pub duration: f64,
    /// Bits per second of a serial port
    #[arg(long, value_name = "N", default_value = "115200", requires = "port")]
    pub baud: u32,
    /// Keep the recording: a log for `identify`
    #[arg(long, value_name = "FILE", requires = "port", conflicts_with = "log")]
    pub record: Option<PathBuf>,
}

fn space(text: &str) -> Result<[f64; 2], String> {
    let (length, width) = text.split_once('x').ok_or("must be LENGTHxWIDTH, as 2x1")?;
    Ok([within(length, SIDES)?, within(width, SIDES)?])
}

/// What a base would refuse, and only when somebody has cleared the floor.
fn within(text: &str, (least, most): (f32, f32)) -> Result<f64, String> {
    match positive(text)? {
        value if (least..=most).contains(&(value as f32)) => Ok(value),
        _ => Err(format!("must be {least} to {most}")),
    }
}

fn two(text: &str) -> Result<[String; 2], String> {
    let (right, left) = text.split_once(',').ok_or("must be two names")?;
    Ok([right, left].map(str::to_owned))
}

fn positive(text: &str) -> Result<f64, String> {
    not_negative(text).and_then(|value| match value > 0.0 {
        true => Ok(value),
        false => Err("must be positive".to_owned()),
    })
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("must be a number, not negative".to_owned()),
    }
}
