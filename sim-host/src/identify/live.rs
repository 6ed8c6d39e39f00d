//! A drive of a live base for its identification: the host arms it, keeps it company and takes what it records.

use crate::monitor::{Lost, Monitor, MonitorError, RecordedDrive};
use crate::teleop::{Line, ORDER_PERIOD};
use crate::trace::{cause, state_name};
use controller_core::safety::supervisor::{Cause, State};
use protocol::{Command, Excite, RecordingEnd, RejectReason, WireLimits, least_baud};
use std::time::Duration;

/// What is to be driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bench {
    /// Length and width of the space \[m\]; see [`Excite`].
    pub space_m: [f64; 2],
    /// Largest speed \[m/s\], if stated.
    pub speed: Option<f64>,
    /// Largest turn rate \[rad/s\], if stated.
    pub turn_rate: Option<f64>,
    /// Length of the drive \[s\].
    pub duration_s: f64,
    /// Another drive for each.
    pub seed: u32,
    /// Bits per second of the line, where it is a serial port of this speed.
    pub baud: Option<u32>,
}

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The line failed.
    #[error(transparent)]
    Line(#[from] MonitorError),
    /// The other end is gone.
    #[error("the base is gone: the line has ended")]
    Gone,
    /// Nothing sound came.
    #[error("the base does not answer{}: is the port right, and its speed?", damaged(*.0))]
    Silent(u32),
    /// Rows came, and then nothing.
    #[error(
        "after {rows} rows nothing came from the base for {} s, and the recording is not whole: the line stalled, or the base lost its power",
        SILENCE.as_secs()
    )]
    FellSilent {
        /// How many.
        rows: usize,
    },
    /// A line that cannot carry every tick.
    #[error(
        "a line of {baud} baud is too slow for a row of every tick, {period_us} us apart: it needs {least} baud"
    )]
    TooSlow {
        /// Its speed.
        baud: u32,
        /// From tick to tick \[µs\].
        period_us: u32,
        /// What would do.
        least: u32,
    },
    /// Refused by the base.
    #[error("the base refused to {what}: {why}{}", hint(*.why, .what))]
    Refused {
        /// What.
        what: &'static str,
        /// Why.
        why: RejectReason,
    },
    /// Stops were sent for as long as any base needs, and its state is still one that drives.
    #[error("the base does not say that it has stopped: look at it, and cut its power if it moves")]
    NotStopped,
    /// Rows were lost; the base has been stopped.
    #[error("the recording is not whole, and the base was stopped: {0}")]
    Lost(#[from] Lost),
    /// The recording ended before its time.
    #[error("the recording ended early: {}", ended(*.end, .state))]
    Ended {
        /// Why.
        end: RecordingEnd,
        /// The supervisor's state then, and its cause.
        state: Option<(State, Cause)>,
    },
}

fn damaged(frames: u32) -> String {
    match frames {
        0 => String::new(),
        _ => format!(" ({frames} damaged frames came)"),
    }
}

fn hint(why: RejectReason, what: &str) -> &'static str {
    match (why, what) {
        (RejectReason::State, _) => "; reset a fault first, and let it come to rest",
        (RejectReason::Value, DRIVE) => {
            "; the space is too small, or the speed or the turn rate above the base's limits"
        }
        (RejectReason::Unsupported, DRIVE) => {
            "; its drivers close their own speed loop ([speed_driver]), and what they exert is not recorded. State mass, inertia and lengths \
             (scales, ruler) in [robot] and the drivers' lag in [speed_driver]; if the drivers report torques, voltages or duties, log these \
             beside the encoders: `identify LOG`"
        }
        _ => "",
    }
}

fn ended(end: RecordingEnd, state: &Option<(State, Cause)>) -> String {
    match (end, state) {
        (RecordingEnd::Complete, _) => "its time was over".to_owned(),
        (RecordingEnd::LeftSpace, _) => "the base was about to leave its space".to_owned(),
        (RecordingEnd::HostSilent, _) | (RecordingEnd::Stopped, Some((_, Cause::LinkLost))) => {
            "the base did not hear this host, and stopped".to_owned()
        }
        (RecordingEnd::Unread, _) => "an encoder was not read".to_owned(),
        (RecordingEnd::Overflow, _) => "the line is too slow for every tick".to_owned(),
        (RecordingEnd::Stopped, Some((state, why))) => {
            format!("state {}, cause {}", state_name(*state), cause(why))
        }
        (RecordingEnd::Stopped, None) => "the base stopped".to_owned(),
    }
}

/// How long an answer may take.
const ANSWER: Duration = Duration::from_secs(2);
/// How long a base may be silent that drives: a stop of its own, and its last rows.
const SILENCE: Duration = Duration::from_secs(1);
/// How long it may take to come to rest at the end.
const REST: Duration = Duration::from_secs(5);
/// Shares of the base's limits, unless stated.
const SHARE: f64 = 0.6;
const DRIVE: &str = "drive";

impl Bench {
    /// What is asked of a base of these limits.
    fn order(&self, limits: &WireLimits) -> Excite {
        let [length, width] = self.space_m;
        let speed = SHARE * f64::from(limits.speed);
        let turn_rate = SHARE * f64::from(limits.turn_rate);
        Excite {
            length_m: length as f32,
            width_m: width as f32,
            speed: self.speed.unwrap_or(speed) as f32,
            turn_rate: self.turn_rate.unwrap_or(turn_rate) as f32,
            duration_s: self.duration_s as f32,
            seed: self.seed,
        }
    }
}

/// What a base has been asked for, and what it does.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// The order.
    pub order: &'a Excite,
    /// What came.
    pub drive: &'a RecordedDrive,
}

/// Arms a base, has it drive for a recording and stops it; the whole recording. `show` is called about 25 times a second.
///
/// Whatever goes wrong on the way, the base is stopped; and it stops by itself when this host falls silent.
///
/// # Errors
/// [`BenchError`].
pub fn record_live(
    line: &mut impl Line,
    bench: &Bench,
    mut show: impl FnMut(&Progress<'_>),
) -> Result<RecordedDrive, BenchError> {
    let mut monitor = Monitor::default();
    let order = greet(line, &mut monitor, bench)?;
    command(line, &mut monitor, &Command::Arm, "arm")?;
    let outcome = drive(line, &mut monitor, &order, &mut show);
    // After a recording that is complete the base has stopped by itself. What becomes of a stop of a line that failed nobody knows.
    let stopped = stop(line, &mut monitor);
    // A base that may still drive is more urgent than a recording that is not whole.
    if let Err(BenchError::NotStopped) = stopped {
        return Err(BenchError::NotStopped);
    }
    outcome?;
    stopped?;
    Ok(monitor.into_recording())
}

/// Asks what the base is, and whether its line will do.
fn greet(line: &mut impl Line, monitor: &mut Monitor, bench: &Bench) -> Result<Excite, BenchError> {
    let mut waited = Duration::ZERO;
    loop {
        line.send(&Command::Heartbeat)?;
        line.send(&Command::GetParameters)?;
        pass(line, monitor, 5 * ORDER_PERIOD)?;
        let latest = monitor.latest();
        if let (Some(hello), Some(parameters)) = (latest.hello, &latest.parameters) {
            let least = least_baud(hello.period_us);
            return match bench.baud {
                Some(baud) if baud < least => Err(BenchError::TooSlow {
                    baud,
                    period_us: hello.period_us,
                    least,
                }),
                _ => Ok(bench.order(&parameters.limits)),
            };
        }
        waited += 5 * ORDER_PERIOD;
        if waited >= ANSWER {
            return Err(BenchError::Silent(monitor.frames().rejected()));
        }
    }
}

/// Sends a command and waits for its answer.
fn command(
    line: &mut impl Line,
    monitor: &mut Monitor,
    command: &Command,
    what: &'static str,
) -> Result<(), BenchError> {
    monitor.ask_about(line.send(command)?);
    let mut waited = Duration::ZERO;
    while waited < ANSWER {
        pass(line, monitor, ORDER_PERIOD)?;
        match monitor.answer() {
            Some(answer) => return answer.map_err(|why| BenchError::Refused { what, why }),
            None => waited += ORDER_PERIOD,
        }
        line.send(&Command::Heartbeat)?;
    }
    Err(BenchError::Silent(monitor.frames().rejected()))
}

fn drive(
    line: &mut impl Line,
    monitor: &mut Monitor,
    order: &Excite,
    show: &mut impl FnMut(&Progress<'_>),
) -> Result<(), BenchError> {
    command(line, monitor, &Command::Excite(*order), DRIVE)?;
    let (mut rows, mut silent) = (0, Duration::ZERO);
    loop {
        line.send(&Command::Heartbeat)?;
        pass(line, monitor, ORDER_PERIOD)?;
        let drive = monitor.recording();
        show(&Progress { order, drive });
        if let Some(lost) = drive.lost() {
            return Err(lost.into());
        }
        match drive.ended() {
            Some(RecordingEnd::Complete) => return Ok(()),
            Some(end) => {
                let state = monitor.latest().state;
                return Err(BenchError::Ended { end, state });
            }
            None => {}
        }
        silent = match drive.rows().len() {
            now if now > rows => {
                rows = now;
                Duration::ZERO
            }
            _ => silent + ORDER_PERIOD,
        };
        if silent >= SILENCE {
            return Err(BenchError::FellSilent { rows });
        }
    }
}

/// Stops the base, and waits until it says so, for [`REST`] at most.
fn stop(line: &mut impl Line, monitor: &mut Monitor) -> Result<(), BenchError> {
    let mut waited = Duration::ZERO;
    while waited < REST {
        // First of all, for what it said last may be older than what it does.
        line.send(&Command::Stop)?;
        pass(line, monitor, ORDER_PERIOD)?;
        let over = |(state, _): (State, Cause)| !state.is_live();
        if monitor.latest().state.is_some_and(over) {
            return Ok(());
        }
        waited += ORDER_PERIOD;
    }
    Err(BenchError::NotStopped)
}

fn pass(line: &mut impl Line, monitor: &mut Monitor, time: Duration) -> Result<(), BenchError> {
    match line.pass(time, monitor)? {
        true => Ok(()),
        false => Err(BenchError::Gone),
    }
}
