//! The firmware in a simulated world, behind the same frames as a real base.

use super::Line;
use crate::closed_loop::{Board, ClosedLoopError, LineMirror, MirrorError};
use crate::mission::BaseSpec;
use crate::monitor::{Monitor, MonitorError};
use crate::world::{World, WorldSetup};
use controller_core::types::Pose;
use firmware_demo::control_server::Queues;
use protocol::{Command, Frame, MAX_FRAME, Telemetry, WirePose, encode};
use std::io;
use std::time::{Duration, Instant};

/// A base on the realistic plant that knows nothing but frames.
pub struct Simulated<'queue> {
    board: Board<'queue>,
    mirror: Option<Twin<'queue>>,
    /// Whether a message arrives.
    arrives: Option<Box<Arrives<'queue>>>,
    sequence: u16,
    /// Answers of the background that the host has not read.
    unread: Vec<u8>,
    /// Passed, of the world's clock \[µs\].
    due_us: u64,
    /// When the world began, where it keeps to real time.
    began: Option<Instant>,
}

type Arrives<'a> = dyn FnMut(&Telemetry) -> bool + 'a;

/// The same firmware somewhere else, and what passed the line since the last tick.
struct Twin<'a> {
    there: &'a mut dyn LineMirror,
    to_base: Vec<u8>,
    from_here: Vec<u8>,
}

impl<'queue> Simulated<'queue> {
    /// A base at the origin; in real time, or as fast as it can.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn new(
        queues: &'queue mut Queues,
        base: &BaseSpec,
        setup: &WorldSetup,
        real_time: bool,
    ) -> Result<Self, ClosedLoopError> {
        Ok(Self {
            board: Board::new(queues, base, setup, |_| {})?,
            mirror: None,
            arrives: None,
            sequence: 0,
            unread: Vec::new(),
            due_us: 0,
            began: real_time.then(Instant::now),
        })
    }

    /// The firmware moves to `mirror`: its outputs move the plant, and every byte that it sends has to be one that the same
    /// firmware sends here; the line fails where it is not.
    ///
    /// # Errors
    /// It cannot be reached, or refuses the parameters.
    pub fn mirrored(mut self, mirror: &'queue mut dyn LineMirror) -> Result<Self, MirrorError> {
        self.board.begin_mirror(mirror)?;
        self.mirror = Some(Twin {
            there: mirror,
            to_base: Vec::new(),
            from_here: Vec::new(),
        });
        Ok(self)
    }

    /// The firmware and its world.
    pub const fn board_mut(&mut self) -> &mut Board<'queue> {
        &mut self.board
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        self.board.world()
    }

    /// A line on which only those messages of the base arrive of which `arrives` says so.
    pub fn losing(mut self, arrives: impl FnMut(&Telemetry) -> bool + 'queue) -> Self {
        self.arrives = Some(Box::new(arrives));
        self
    }

    fn read(&mut self, answer: Frame<Telemetry>) -> Result<(), MonitorError> {
        let mut bytes = [0; MAX_FRAME];
        let frame = encode(answer.sequence, &answer.message, &mut bytes).map_err(failed)?;
        let arrives = self.arrives.as_mut();
        if arrives.is_none_or(|arrives| arrives(&answer.message)) {
            self.unread.extend_from_slice(frame);
        }
        if let Some(mirror) = &mut self.mirror {
            mirror.from_here.extend_from_slice(frame);
        }
        Ok(())
    }

    fn tick(&mut self) -> Result<(), MonitorError> {
        self.board.advance().map_err(failed)?;
        if let Some((pose, age_s)) = self.board.world().fix() {
            let pose: Pose<f32> = pose.cast();
            let pose = WirePose::from(&pose);
            let age_s = age_s as f32;
            self.send(&Command::Fix { pose, age_s })?;
        }
        self.board.tick();
        while let Some(report) = self.board.pending() {
            self.read(report)?;
        }
        let Some(mirror) = &mut self.mirror else {
            return Ok(());
        };
        let line = std::mem::take(&mut mirror.to_base);
        let there = self.board.tick_mirror(mirror.there, &line);
        let there = there.map_err(|cause| MonitorError::Line(io::Error::other(cause)))?;
        let here = std::mem::take(&mut mirror.from_here);
        if here == there {
            Ok(())
        } else {
            let tick = self.board.task().ticks();
            Err(MonitorError::Line(io::Error::other(format!(
                "tick {tick}: {there:?} was sent there, {here:?} here"
            ))))
        }
    }
}

impl Line for Simulated<'_> {
    fn send(&mut self, command: &Command) -> Result<u16, MonitorError> {
        let mut bytes = [0; MAX_FRAME];
        let sequence = self.sequence;
        let frame = encode(sequence, command, &mut bytes).map_err(failed)?;
        self.sequence = sequence.wrapping_add(1);
        if let Some(mirror) = &mut self.mirror {
            mirror.to_base.extend_from_slice(frame);
        }
        for byte in frame {
            if let Some(answer) = self.board.receive(*byte) {
                self.read(answer)?;
            }
        }
        Ok(sequence)
    }

    fn pass(&mut self, time: Duration, monitor: &mut Monitor) -> Result<bool, MonitorError> {
        self.due_us += u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        while self.board.world().now_us() < self.due_us {
            self.tick()?;
        }
        monitor.take(&self.unread, |_, _| {});
        self.unread.clear();
        if let Some(began) = self.began {
            let ahead = Duration::from_micros(self.due_us).saturating_sub(began.elapsed());
            std::thread::sleep(ahead);
        }
        Ok(true)
    }
}

fn failed(cause: impl std::error::Error + Send + Sync + 'static) -> MonitorError {
    MonitorError::Line(io::Error::other(cause))
}
