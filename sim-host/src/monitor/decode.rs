//! From bytes to what the board says.

use firmware_demo::fault::Cause;
use firmware_demo::protocol::{
    Counters, Decoder, FrameCounters, Hello, MAX_CONTENT, Report, Telemetry, report_flags,
};
use firmware_demo::supervisor::State;
use std::fmt::Write as _;

/// What the board said last, and how many of its frames were damaged.
#[derive(Clone, Debug, Default)]
pub struct Monitor {
    decoder: Decoder<Telemetry, MAX_CONTENT>,
    reports: u64,
    heard: Heard,
}

/// The last of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heard {
    /// Who it is.
    pub hello: Option<Hello>,
    /// The last tick.
    pub report: Option<Report>,
    /// The supervisor's state, and why.
    pub state: Option<(State, Cause)>,
    /// What the board has counted.
    pub counters: Option<Counters>,
}

impl Monitor {
    /// Takes bytes from the line; every report in them goes to `each`, with what was heard before.
    pub fn take(&mut self, bytes: &[u8], mut each: impl FnMut(&Report, &Heard)) {
        for &byte in bytes {
            let Some(Ok(frame)) = self.decoder.push(byte) else {
                continue;
            };
            match frame.message {
                Telemetry::Report(report) => {
                    self.reports += 1;
                    self.heard.report = Some(report);
                    each(&report, &self.heard);
                }
                Telemetry::Hello(hello) => self.heard.hello = Some(hello),
                Telemetry::State { state, cause, .. } => self.heard.state = Some((state, cause)),
                Telemetry::Counters(counters) => self.heard.counters = Some(counters),
                // Answers to somebody else's questions.
                Telemetry::Refused(_) | Telemetry::Ack | Telemetry::Nack(_) => {}
            }
        }
    }

    /// What was heard last.
    pub fn heard(&self) -> &Heard {
        &self.heard
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
        if let Some((state, cause)) = &self.heard.state {
            // Writing to a string does not fail.
            let _ = write!(line, "{state:?} ({cause:?}) ");
        }
        match &self.heard.report {
            Some(report) => tick(&mut line, report),
            None => line.push_str("no report yet"),
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
        if let Some(counters) = &self.heard.counters {
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

fn tick(line: &mut String, report: &Report) {
    let phase = if report.phase == 0 {
        "tracking"
    } else {
        "parking"
    };
    let _ = write!(
        line,
        "{phase} tick {} | e {:+.3} {:+.3} m {:+.3} rad | v_c {:+.3} m/s w_c {:+.3} rad/s | \
         tau {:+.3} {:+.3} N m",
        report.tick,
        report.e_x,
        report.e_y,
        report.e_theta,
        report.v_c,
        report.w_c,
        report.tau_right,
        report.tau_left,
    );
    if report.flags & report_flags::SATURATED != 0 {
        line.push_str(" saturated");
    }
}
