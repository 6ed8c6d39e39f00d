//! The drive of `identify --port`.

use super::error::CommandError;
use super::say;
use crate::cli::LiveArgs;
use firmware_demo::excitation::BEHIND;
use sim_host::identify::live::{Bench, Progress, record_live};
use sim_host::monitor::Port;
use sim_host::teleop::PortLine;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::Duration;

/// From the last word of the program to the first motion.
const PAUSE: Duration = Duration::from_secs(3);
/// A line for people each so many calls: once a second.
const LINES: u32 = 25;

/// Drives the base at a port; its recording as a log.
pub fn drive(path: &Path, arguments: &LiveArgs, seed: u32) -> Result<Vec<u8>, CommandError> {
    let port = Port::open(path, arguments.baud)?;
    // Without a space the arguments are refused.
    let space_m = arguments.space.unwrap_or_default();
    let bench = Bench {
        space_m,
        speed: arguments.speed,
        turn_rate: arguments.turn_rate,
        duration_s: arguments.duration,
        seed,
        baud: port.is_serial().then_some(arguments.baud),
    };
    let [length, width] = space_m;
    let behind = f64::from(BEHIND);
    say(&format!(
        "THE BASE MOVES in {} s. Free floor from the middle of its axle, and its body's room around that: {:.2} m ahead, {:.2} m \
         behind, {:.2} m to each side. Ctrl-C stops it.\n",
        PAUSE.as_secs(),
        (1.0 - behind) * length,
        behind * length,
        0.5 * width
    ))?;
    thread::sleep(PAUSE);
    let mut calls = 0_u32;
    let mut said = Ok(());
    let drive = record_live(&mut PortLine::new(port), &bench, |progress| {
        if calls.is_multiple_of(LINES) {
            said = std::mem::replace(&mut said, Ok(())).and(line(progress, calls == 0));
        }
        calls += 1;
    });
    said?;
    let drive = drive?;
    say(&format!(
        "{} rows, {} external poses, none lost\n",
        drive.rows().len(),
        drive.poses().len()
    ))?;
    for (what, rows) in ["the supply", "currents"].into_iter().zip(drive.lacking()) {
        match rows {
            0 => {}
            _ if rows == drive.rows().len() => {
                say(&format!("note: this base does not measure {what}\n"))?
            }
            _ => say(&format!(
                "note: {rows} rows have not measured {what}: that is left out of all\n"
            ))?,
        }
    }
    let written = |path: &Path, cause: String| CommandError::Write {
        path: path.to_owned(),
        cause,
    };
    let mut log = Vec::new();
    drive
        .write(&mut log)
        .map_err(|cause| written(path, cause.to_string()))?;
    if let Some(path) = &arguments.record {
        fs::write(path, &log).map_err(|cause| written(path, cause.to_string()))?;
    }
    Ok(log)
}

fn line(Progress { order, drive }: &Progress<'_>, first: bool) -> Result<(), CommandError> {
    if first {
        say(&format!(
            "at most {:.2} m/s and {:.2} rad/s for {} s; the seed is {}\n",
            order.speed, order.turn_rate, order.duration_s, order.seed
        ))?;
    }
    say(&format!("{} rows\n", drive.rows().len()))
}
