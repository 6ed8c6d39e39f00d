//! A base driven by keys: velocity orders over the wire, to a real base or to the firmware in a simulated world.
//!
//! [`Stick`] makes orders of keys, [`teleoperate`] sends them 25 times a second over a [`Line`]: [`PortLine`] is a serial port,
//! [`Simulated`] the firmware on the realistic plant. Keys come from anywhere: a terminal, or a pipe with a script of them.

mod keys;
#[cfg(not(target_family = "wasm"))]
mod port_line;
mod simulated;
mod stick;

pub use keys::{Input, KeySource, Script};
#[cfg(not(target_family = "wasm"))]
pub use port_line::PortLine;
pub use simulated::Simulated;
pub use stick::{KEYS, Key, KeyReader, Stick};

use crate::monitor::{Monitor, MonitorError};
use controller_core::safety::supervisor::State;
use protocol::Command;
use std::time::Duration;

/// Time between two orders: a base takes one of 0.1 s for stale, and may miss one.
pub const ORDER_PERIOD: Duration = Duration::from_millis(40);
/// Longest time for coming to rest at the end, in orders: 4 s.
const LAST_ORDERS: u32 = 100;
/// A base slower than this rests \[m/s, rad/s\].
const RESTS: (f32, f32) = (2.0e-3, 5.0e-3);

/// The way to a base.
pub trait Line {
    /// Sends a command and does not wait for its answer, which has the number that is given back.
    ///
    /// # Errors
    /// The line failed.
    fn send(&mut self, command: &Command) -> Result<u16, MonitorError>;

    /// Lets time pass; what the base says meanwhile goes to the monitor. Whether the other end is still there.
    ///
    /// # Errors
    /// The line failed.
    fn pass(&mut self, time: Duration, monitor: &mut Monitor) -> Result<bool, MonitorError>;
}

/// Arms the base and drives it by keys until they end or one of them quits; then lets it come to rest and stops it.
///
/// `show` is called after every order with what the base said last.
///
/// # Errors
/// The line failed, or keys cannot be read.
pub fn teleoperate(
    line: &mut impl Line,
    keys: &mut impl KeySource,
    stick: &mut Stick,
    mut show: impl FnMut(&Monitor, &Stick),
) -> Result<Monitor, MonitorError> {
    let mut monitor = Monitor::default();
    line.send(&Command::Arm)?;
    let mut reader = KeyReader::default();
    let mut wanted = true;
    while wanted {
        loop {
            match keys.next().map_err(MonitorError::Line)? {
                Input::Nothing => break,
                Input::End => {
                    wanted = false;
                    break;
                }
                Input::Byte(byte) => match reader.push(byte) {
                    Some(Key::Quit) => {
                        wanted = false;
                        break;
                    }
                    Some(Key::EmergencyStop) => {
                        stick.halt();
                        line.send(&Command::EmergencyStop { brake: true })?;
                    }
                    Some(Key::Reset) => {
                        stick.halt();
                        line.send(&Command::ResetFault)?;
                        line.send(&Command::Arm)?;
                    }
                    Some(key) => stick.take(key),
                    None => {}
                },
            }
        }
        if wanted && !order(line, stick, &mut monitor)? {
            return Ok(monitor);
        }
        show(&monitor, stick);
    }
    stick.halt();
    for _ in 0..LAST_ORDERS {
        if !order(line, stick, &mut monitor)? {
            return Ok(monitor);
        }
        show(&monitor, stick);
        if rests(&monitor) {
            break;
        }
    }
    line.send(&Command::Stop)?;
    for _ in 0..LAST_ORDERS {
        if !line.pass(ORDER_PERIOD, &mut monitor)? || is_over(&monitor) {
            break;
        }
    }
    show(&monitor, stick);
    Ok(monitor)
}

fn order(line: &mut impl Line, stick: &Stick, monitor: &mut Monitor) -> Result<bool, MonitorError> {
    line.send(&stick.order())?;
    line.pass(ORDER_PERIOD, monitor)
}

/// The base stands, or is not driving any more.
fn rests(monitor: &Monitor) -> bool {
    let slow = monitor
        .latest()
        .report
        .is_some_and(|report| report.v.abs() < RESTS.0 && report.w.abs() < RESTS.1);
    slow || is_over(monitor)
}

/// The base has said that it is stopped, or something like it.
fn is_over(monitor: &Monitor) -> bool {
    let over = |(state, _)| matches!(state, State::Idle | State::Stopped | State::Fault);
    monitor.latest().state.is_some_and(over)
}
