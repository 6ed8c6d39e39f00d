//! A host as a real one is: it speaks in frames, waits for answers, and asks again where none comes.

use super::line::{Line, LineFault};
use super::path::{Path, VelocityOrders, narrow};
use super::random::Random;
use crate::monitor::{AHEAD_S, Questions, SAMPLE_S, stops};
use crate::world::World;
use controller_core::types::Pose;
use protocol::{
    Command, Decoder, Frame, MAX_CONTENT, MAX_FRAME, RejectReason, Telemetry, TimedSample, encode,
};

/// A sign of life at least so often \[µs\]: a fifth of the base's patience.
const BEAT_US: u64 = 20_000;

/// What a host is kept from or does wrong in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Manner {
    /// It says nothing.
    pub silent: bool,
    /// Ages of poses are not numbers.
    pub bad_age: bool,
    /// So many frames that nobody needs come with its own.
    pub flood: usize,
    pub line: LineFault,
}

/// What a host has driven.
#[derive(Clone, Copy, Debug)]
pub(super) enum Course<'a> {
    /// A trajectory, sample by sample.
    Path(&'a Path),
    /// Velocity orders.
    Orders(&'a VelocityOrders),
}

/// What came of a command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answered {
    pub command: Command,
    pub result: Result<(), RejectReason>,
    pub has_to_fail: bool,
}

/// The host's half of the line.
pub(super) struct Host {
    decoder: Decoder<Telemetry, MAX_CONTENT>,
    /// Each with whether anything but a refusal is an error.
    asked: Questions<bool>,
    beat_us: u64,
    /// A trajectory since then, and its next sample.
    stream: Option<(Option<u64>, u32)>,
    up: Line<Command>,
    down: Line<()>,
    random: Random,
}

impl Host {
    pub fn new(seed: u64) -> Self {
        let random = |stream| Random::new(seed, stream);
        Self {
            decoder: Decoder::new(),
            asked: Questions::default(),
            beat_us: 0,
            stream: None,
            up: Line::new(random(1)),
            down: Line::new(random(2)),
            random: random(3),
        }
    }

    /// Asks for something, after what was asked before.
    pub fn ask(&mut self, command: Command) {
        self.asked.ask(command, false);
    }

    /// Asks for what has to be refused.
    pub fn ask_in_vain(&mut self, command: Command) {
        self.asked.ask(command, true);
    }

    /// Stops the base: nothing else counts any more.
    pub fn stop(&mut self, command: Command) {
        self.asked.clear();
        self.stream = None;
        self.ask(command);
    }

    /// Sends a trajectory as soon as all that was asked for is answered.
    pub fn follow(&mut self) {
        self.stream = Some((None, 0));
    }

    /// No more of a trajectory.
    pub fn follow_no_more(&mut self) {
        self.stream = None;
    }

    /// When the trajectory began \[µs\].
    pub fn followed_since(&self) -> Option<u64> {
        self.stream.and_then(|(since, _)| since)
    }

    /// Everything is answered.
    pub fn is_content(&self) -> bool {
        self.asked.is_empty()
    }

    /// Puts a tick's frames on the line.
    pub fn speak(&mut self, manner: &Manner, now_us: u64, course: Course<'_>, world: &World) {
        if manner.silent {
            return;
        }
        let flood_first = manner.flood > 0 && self.random.chance(0.5);
        let stop_now = self
            .asked
            .due(now_us)
            .is_some_and(|(_, command)| stops(&command));
        if flood_first {
            self.flood(manner, now_us, stop_now);
        }
        if let Some((sequence, command)) = self.asked.due(now_us) {
            self.asked.sent(now_us);
            self.send(manner, now_us, sequence, &command);
        }
        if now_us >= self.beat_us + BEAT_US {
            self.beat_us = now_us;
            self.say(manner, now_us, &Command::Heartbeat);
        }
        if let Some((pose, age_s)) = world.fix() {
            let age_s = if manner.bad_age {
                f32::NAN
            } else {
                age_s as f32
            };
            let pose = (&narrow(&pose)).into();
            self.say(manner, now_us, &Command::Fix { pose, age_s });
        }
        match course {
            Course::Path(path) => self.samples(manner, now_us, path),
            Course::Orders(orders) => self.orders(manner, now_us, orders),
        }
        if manner.flood > 0 && !flood_first {
            self.flood(manner, now_us, stop_now);
        }
    }

    fn samples(&mut self, manner: &Manner, now_us: u64, path: &Path) {
        let Some((since, next)) = self.stream else {
            return;
        };
        if !self.asked.is_empty() {
            return;
        }
        let since = since.unwrap_or(now_us);
        let until = 1.0e-6 * (now_us - since) as f64 + AHEAD_S;
        let mut next = next;
        while f64::from(next) * SAMPLE_S <= until {
            let t = f64::from(next) * SAMPLE_S;
            let sample = TimedSample {
                t: t as f32,
                reference: (&path.at(t)).into(),
            };
            self.say(manner, now_us, &Command::Sample(sample));
            next += 1;
        }
        self.stream = Some((Some(since), next));
    }

    /// An order with every sign of life, from when all that was asked for before is answered.
    fn orders(&mut self, manner: &Manner, now_us: u64, orders: &VelocityOrders) {
        let Some((since, next)) = self.stream else {
            return;
        };
        if since.is_none() && !self.asked.is_empty() {
            return;
        }
        let since = since.unwrap_or(now_us);
        let run_us = now_us - since;
        self.stream = Some((Some(since), next));
        if run_us >= u64::from(next) * BEAT_US {
            let order = orders.at(1.0e-6 * run_us as f64);
            self.say(manner, now_us, &order);
            let next = (run_us / BEAT_US + 1) as u32;
            self.stream = Some((Some(since), next));
        }
    }

    /// What nobody needs. Before a stop there may be an order to arm: the stop has the last word.
    fn flood(&mut self, manner: &Manner, now_us: u64, before_stop: bool) {
        if before_stop && self.random.chance(0.5) {
            self.say(manner, now_us, &Command::Arm);
        }
        for _ in 0..manner.flood {
            let command = match self.random.below(4) {
                0 => Command::GetCounters,
                1 => Command::Heartbeat,
                _ => Command::GetParameters,
            };
            self.say(manner, now_us, &command);
        }
    }

    fn say(&mut self, manner: &Manner, now_us: u64, command: &Command) {
        let sequence = self.asked.number();
        self.send(manner, now_us, sequence, command);
    }

    fn send(&mut self, manner: &Manner, now_us: u64, sequence: u16, command: &Command) {
        let mut bytes = [0; MAX_FRAME];
        if let Ok(frame) = encode(sequence, command, &mut bytes) {
            self.up.send(&manner.line, now_us, *command, frame);
        }
    }

    /// The next frame that reaches the base.
    pub fn arrived(&mut self, now_us: u64) -> Option<super::line::Sent<Command>> {
        self.up.arrived(now_us)
    }

    /// The base answers.
    pub fn answer(&mut self, manner: &Manner, now_us: u64, answer: &Frame<Telemetry>) {
        let mut bytes = [0; MAX_FRAME];
        if let Ok(frame) = encode(answer.sequence, &answer.message, &mut bytes) {
            self.down.send(&manner.line, now_us, (), frame);
        }
    }

    /// Takes what has come back, and says what came of the command under way.
    pub fn hear(&mut self, now_us: u64) -> Option<Answered> {
        while let Some(sent) = self.down.arrived(now_us) {
            for byte in sent.bytes {
                if let Some(Ok(frame)) = self.decoder.push(byte)
                    && let Some(answered) = self.take(&frame)
                {
                    // A chunk holds one frame: nothing is left of it.
                    return Some(answered);
                }
            }
        }
        None
    }

    fn take(&mut self, frame: &Frame<Telemetry>) -> Option<Answered> {
        let (command, has_to_fail, result) = self.asked.answered(frame)?;
        Some(Answered {
            command,
            result,
            has_to_fail,
        })
    }
}

/// Drive to a pose.
pub(super) fn park(goal: &Pose<f64>) -> Command {
    Command::Park {
        goal: (&narrow(goal)).into(),
    }
}
