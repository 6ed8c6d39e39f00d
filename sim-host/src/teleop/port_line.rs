//! A real base at the other end of a serial port.

use super::Line;
use crate::monitor::{Monitor, MonitorError, Port, Received};
use protocol::Command;
use std::time::{Duration, Instant};

/// A serial port, or the socket of an emulator.
#[derive(Debug)]
pub struct PortLine(Port);

impl PortLine {
    /// Over an open port.
    pub const fn new(port: Port) -> Self {
        Self(port)
    }
}

impl Line for PortLine {
    fn send(&mut self, command: &Command) -> Result<u16, MonitorError> {
        self.0.ask(command)
    }

    fn pass(&mut self, time: Duration, monitor: &mut Monitor) -> Result<bool, MonitorError> {
        let until = Instant::now() + time;
        let mut buffer = [0; 4096];
        loop {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(true);
            }
            match self.0.receive(&mut buffer, left)? {
                Received::Silence => {}
                Received::End => return Ok(false),
                Received::Bytes(count) => {
                    monitor.take(buffer.get(..count).unwrap_or_default(), |_, _| {});
                }
            }
        }
    }
}
