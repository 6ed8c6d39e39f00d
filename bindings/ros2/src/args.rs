//! The command line.

use clap::Parser;
use std::path::PathBuf;

/// Between a base at the end of a serial line and ROS 2
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub struct Args {
    /// The base: its serial port, or the Unix socket of an emulator
    #[arg(value_name = "PORT")]
    pub port: PathBuf,
    /// The base's file, or one of paper-30kg, lab-10kg, hobby-1kg: its wheels, and the parameters that it gets
    #[arg(long, value_name = "FILE")]
    pub base: PathBuf,
    /// Bits per second of a serial port
    #[arg(long, value_name = "N", default_value = "115200")]
    pub baud: u32,
    /// Name of the node
    #[arg(long, value_name = "NAME", default_value = "base")]
    pub name: String,
    /// Namespace of the node and of its topics
    #[arg(long, value_name = "NAME", default_value = "/")]
    pub namespace: String,
    /// DDS domain
    #[arg(long, value_name = "N", env = "ROS_DOMAIN_ID", default_value = "0", value_parser = domain)]
    pub domain: u16,
    /// At most so many odometries a second; the base sends 50
    #[arg(long, value_name = "HZ", default_value = "50", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rate: u32,
    /// The frame that poses count from: of what is published, and of goals and paths
    #[arg(long, value_name = "FRAME", default_value = sim_host::datalog::messages::ODOM_FRAME)]
    pub odom_frame: String,
    /// The frame of the base
    #[arg(long, value_name = "FRAME", default_value = sim_host::datalog::messages::BASE_FRAME)]
    pub base_frame: String,
    /// Repeat a velocity for so many seconds after it came; then it is stale after the base's own timeout
    #[arg(long, value_name = "S", default_value = "0", value_parser = seconds)]
    pub hold: f64,
    /// Velocities come with a stamp, as TwistStamped
    #[arg(long)]
    pub stamped: bool,
    /// Begin unconfigured and let others manage the node; else it configures and activates itself
    #[arg(long)]
    pub managed: bool,
    /// Leave the parameters of the base as they are
    #[arg(long)]
    pub keep_parameters: bool,
}

/// Ports of higher ones are past 65535.
const LAST_DOMAIN: u16 = 232;

fn domain(text: &str) -> Result<u16, String> {
    // As rcl has it for the variable.
    if text.is_empty() {
        return Ok(0);
    }
    match text.parse() {
        Ok(domain @ 0..=LAST_DOMAIN) => Ok(domain),
        _ => Err(format!("not in 0 to {LAST_DOMAIN}")),
    }
}

/// More than that is no repetition but a motion that nobody orders.
const LONGEST_HOLD_S: f64 = 1.0;

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().map_err(|error| error.to_string())?;
    if (0.0..=LONGEST_HOLD_S).contains(&seconds) {
        Ok(seconds)
    } else {
        Err(format!("not in 0 to {LONGEST_HOLD_S} s"))
    }
}

#[cfg(test)]
mod tests {
    use super::domain;

    #[test]
    fn a_domain_has_ports() {
        for (text, number) in [("", 0), ("0", 0), ("232", 232)] {
            assert_eq!(domain(text), Ok(number), "{text:?}");
        }
        for text in ["233", "65536", "-1", "x"] {
            assert!(domain(text).is_err(), "{text}");
        }
    }
}
