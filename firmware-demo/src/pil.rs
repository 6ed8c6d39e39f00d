//! Processor in the loop: the host owns the plant, this side computes the ticks.
//!
//! One question, one answer, in lock step, over any byte link. The loop is the same on every board and, with
//! links in memory, in the host's tests.

use embedded_io::{Read, Write};

use crate::protocol::{
    Command, Counters, Decoder, Hello, MAX_CONTENT, MAX_FRAME, Measure, RejectReason, Report,
    Telemetry, VERSION, encode,
};

/// Ticks per second that a greeting announces.
pub const TICK_HZ: u16 = 1000;
/// Bytes asked of the link at once; a whole question fits.
const CHUNK: usize = 128;

/// What a board can tell about a tick; the defaults are those of a board that cannot.
pub trait Probe {
    /// Runs `work` and counts its executed instructions.
    fn count<R>(&mut self, work: impl FnOnce() -> R) -> (R, u32) {
        (work(), 0)
    }

    /// High-water mark of the stack in bytes.
    fn stack_bytes(&self) -> u32 {
        0
    }
}

/// The probe of a board that can tell nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoProbe;

impl Probe for NoProbe {}

/// Why the loop ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The host said stop.
    Stopped,
    /// The host closed the link.
    Closed,
    /// The link failed.
    Broken,
}

/// Answers the host until it stops, closes or breaks the link.
///
/// Each [`Command::Measure`] is given to `tick`, and its report goes back with the same sequence number and
/// with the instructions that `probe` counted. Damaged frames are counted and not answered.
pub fn serve<L: Read + Write, P: Probe>(
    link: &mut L,
    probe: &mut P,
    mut tick: impl FnMut(&Measure, &mut Report),
) -> End {
    let mut decoder = Decoder::<Command, MAX_CONTENT>::new();
    let mut chunk = [0; CHUNK];
    loop {
        let received = match link.read(&mut chunk) {
            Ok(0) => return End::Closed,
            Ok(len) => chunk.get(..len).unwrap_or_default(),
            Err(_) => return End::Broken,
        };
        for &byte in received {
            let Some(Ok(frame)) = decoder.push(byte) else {
                continue;
            };
            let stop = frame.message == Command::Stop;
            let answer = match frame.message {
                Command::Measure(measure) => {
                    let mut report = Report::default();
                    let ((), instructions) = probe.count(|| tick(&measure, &mut report));
                    report.instructions = instructions;
                    Telemetry::Report(report)
                }
                Command::GetCounters => {
                    let frames = decoder.counters();
                    Telemetry::Counters(Counters {
                        frames_good: frames.good,
                        frames_rejected: frames.rejected(),
                        stack_bytes: probe.stack_bytes(),
                        ..Counters::default()
                    })
                }
                Command::Heartbeat => Telemetry::Hello(HELLO),
                Command::Stop => Telemetry::Ack,
                _ => Telemetry::Nack(RejectReason::Unsupported),
            };
            if !send(link, frame.sequence, &answer) {
                return End::Broken;
            }
            if stop {
                return End::Stopped;
            }
        }
    }
}

const HELLO: Hello = Hello {
    protocol: VERSION,
    firmware: [0, 1, 0],
    tick_hz: TICK_HZ,
};

fn send<L: Write>(link: &mut L, sequence: u16, answer: &Telemetry) -> bool {
    let mut frame = [0; MAX_FRAME];
    let Ok(mut rest) = encode(sequence, answer, &mut frame) else {
        return false;
    };
    // Not `write_all`, which panics when a link takes nothing. Each turn takes at least one byte.
    while !rest.is_empty() {
        match link.write(rest) {
            Ok(taken @ 1..) => rest = rest.get(taken..).unwrap_or_default(),
            _ => return false,
        }
    }
    link.flush().is_ok()
}

/// Stands in for the controller until it is wired up: cheap, and every bit of the answer depends on the
/// question, so that a test sees a damaged transport.
pub fn stand_in(measure: &Measure, report: &mut Report) {
    report.tick = measure.tick;
    report.e_x = -measure.pose.x;
    report.e_y = -measure.pose.y;
    report.e_theta = -measure.pose.theta;
    report.e_v = -measure.twist.v;
    report.e_w = -measure.twist.w;
    report.tau_right = measure.dt * (measure.pose.x + measure.twist.w);
    report.tau_left = measure.dt * (measure.pose.x - measure.twist.w);
}

#[cfg(test)]
mod tests;
