//! From bytes to what the board says.

use super::RecordedDrive;
use controller_core::safety::FaultKind;
use controller_core::safety::supervisor::{Cause, State};
use protocol::{
    BaseTick, Counters, Decoder, FieldParams, Frame, FrameCounters, Hello, MAX_CONTENT, Origin,
    RejectReason, Telemetry, tick_flags,
};
use std::fmt::Write as _;

/// What the board said last, and how many of its frames were damaged.
#[derive(Clone, Debug, Default)]
pub struct Monitor {
    decoder: Decoder<Telemetry, MAX_CONTENT>,
    bytes: u64,
    reports: u64,
    latest: LatestTelemetry,
    /// A command whose answer counts, and the answer.
    asked: Option<(u16, Option<Result<(), RejectReason>>)>,
    recording: RecordedDrive,
}

/// The last of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LatestTelemetry {
    /// Who it is.
    pub hello: Option<Hello>,
    /// The last tick.
    pub report: Option<BaseTick>,
    /// The supervisor's state, and why.
    pub state: Option<(State, Cause)>,
    /// What the board has counted.
    pub counters: Option<Counters>,
    /// Where its parameters come from.
    pub origin: Option<Origin>,
    /// Its parameters.
    pub parameters: Option<FieldParams>,
}

impl Monitor {
    /// Takes bytes from the line; every report in them goes to `each`, with the latest of each other message.
    pub fn take(&mut self, bytes: &[u8], mut each: impl FnMut(&BaseTick, &LatestTelemetry)) {
        self.take_frames(bytes, |frame, latest| {
            if let Telemetry::Tick(report) = &frame.message {
                each(report, latest);
            }
        });
    }

    /// The same with every sound frame, for those who ask questions.
    pub fn take_frames(
        &mut self,
        bytes: &[u8],
        mut each: impl FnMut(&Frame<Telemetry>, &LatestTelemetry),
    ) {
        self.bytes += bytes.len() as u64;
        for &byte in bytes {
            let Some(Ok(frame)) = self.decoder.push(byte) else {
                continue;
            };
            match frame.message {
                Telemetry::Tick(report) => {
                    self.reports += 1;
                    self.latest.report = Some(report);
                }
                Telemetry::Hello(hello) => self.latest.hello = Some(hello),
                Telemetry::State { state, cause, .. } => self.latest.state = Some((state, cause)),
                Telemetry::Counters(counters) => self.latest.counters = Some(counters),
                Telemetry::Origin(origin) => self.latest.origin = Some(origin),
                Telemetry::Parameters(parameters) => self.latest.parameters = Some(parameters),
                Telemetry::Ack => self.answered(frame.sequence, Ok(())),
                Telemetry::Nack(reason) => self.answered(frame.sequence, Err(reason)),
                Telemetry::Recording(_) | Telemetry::Rows(_) | Telemetry::RecordedPose(_) => {
                    self.recording.take(&frame.message);
                }
            }
            each(&frame, &self.latest);
        }
    }

    /// The latest of each message.
    pub fn latest(&self) -> &LatestTelemetry {
        &self.latest
    }

    /// Looks for the answer to the command with this number from now on; all others are answers to somebody else.
    pub const fn ask_about(&mut self, sequence: u16) {
        self.asked = Some((sequence, None));
    }

    /// The answer to the command that was asked about, once it is there.
    pub fn answer(&self) -> Option<Result<(), RejectReason>> {
        self.asked?.1
    }

    fn answered(&mut self, sequence: u16, answer: Result<(), RejectReason>) {
        if let Some((asked, known @ None)) = &mut self.asked
            && *asked == sequence
        {
            *known = Some(answer);
        }
    }

    /// What came of a bench recording.
    pub const fn recording(&self) -> &RecordedDrive {
        &self.recording
    }

    /// The bench recording, to keep.
    pub fn into_recording(self) -> RecordedDrive {
        self.recording
    }

    /// Frames by outcome.
    pub fn frames(&self) -> FrameCounters {
        self.decoder.counters()
    }

    /// Reports so far.
    pub fn reports(&self) -> u64 {
        self.reports
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let mut line = String::new();
        // Writing to a string does not fail. A board says why its state changed when it does: before, reports have the state alone.
        match (&self.latest.state, &self.latest.report) {
            (Some((state, cause)), _) => {
                let _ = write!(line, "{state:?} ({cause:?}) ");
            }
            (None, Some(report)) => {
                let _ = write!(line, "{:?} ", report.state);
            }
            (None, None) => {}
        }
        match &self.latest.report {
            Some(report) => tick(&mut line, report),
            // A line with bytes and no frame is of another baud rate, or of another program.
            None if self.frames() == FrameCounters::default() && self.bytes > 0 => {
                let _ = write!(line, "no report yet, {} bytes without a frame", self.bytes);
            }
            None => line.push_str("no report yet"),
        }
        if let Some(origin) = &self.latest.origin {
            let _ = match origin {
                Origin::Stored { sequence } => write!(line, " | parameters: stored, {sequence}"),
                Origin::Host => write!(line, " | parameters: from the host"),
                Origin::Defaults(why) => write!(line, " | parameters: defaults ({why:?})"),
            };
        }
        let frames = self.frames();
        let _ = write!(line, " | frames {} good", frames.good);
        for (count, name) in [
            (frames.crc, "check"),
            (frames.framing, "framing"),
            (frames.length, "length"),
            (frames.version, "version"),
            (frames.payload, "payload"),
        ] {
            if count > 0 {
                let _ = write!(line, ", {count} bad {name}");
            }
        }
        if let Some(counters) = &self.latest.counters {
            let _ = write!(
                line,
                " | board: {} bad, {} dropped, {} overruns, stack {}",
                counters.frames_rejected,
                counters.reports_dropped,
                counters.overruns,
                counters.stack_bytes
            );
        }
        line
    }
}

fn tick(line: &mut String, report: &BaseTick) {
    let law = match report.flags & (tick_flags::LAW | tick_flags::PARKING) {
        0 | tick_flags::PARKING => "no law",
        tick_flags::LAW => "following",
        _ => "parking",
    };
    let _ = write!(
        line,
        "{law} tick {} | at {:+.3} {:+.3} m {:+.3} rad | e {:+.3} {:+.3} m {:+.3} rad | \
         v_c {:+.3} m/s w_c {:+.3} rad/s | tau {:+.3} {:+.3} N m",
        report.tick,
        report.x,
        report.y,
        report.theta,
        report.e_x,
        report.e_y,
        report.e_theta,
        report.v_c,
        report.w_c,
        report.tau_right,
        report.tau_left,
    );
    if report.flags & tick_flags::TORQUE_LIMITED != 0 {
        line.push_str(" saturated");
    }
    for kind in report.codes().filter_map(FaultKind::from_code) {
        let _ = write!(line, " {kind}");
    }
    if report.ignored > 0 {
        let _ = write!(line, " | {} faults ignored", report.ignored);
    }
}
