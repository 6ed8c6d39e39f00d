//! The control task with a host at the other end of a line: what runs in the timer's interrupt, and what runs
//! in the background.
//!
//! ```text
//! bytes -> CommandReceiver --requests--> ControlServer::tick -> wheels
//!             |   --orders, poses----> |
//!             |      ----stops---> |
//!             |      --samples---> (control task)
//!             v                        |
//! bytes <- answers <----telemetry------+
//! ```
//!
//! All queues are bounded and lock-free, so neither side ever waits for the other. A full queue of requests refuses
//! them with [`RejectReason::Full`].
//!
//! # Stops
//!
//! A stop and an emergency stop are never refused. They have places of their own beside the queue, and the tick after their
//! frame has arrived obeys them, however many frames came with it:
//!
//! * The command receiver answers with an Ack as soon as the stop has its place; it does not go through the queue of telemetry.
//! * A stop stands where the host sent it. Commands before it come before it, so that Arm, Park, Stop in one tick ends
//!   stopped. Commands after it come after it, as if they had come in a later tick: Stop, Arm ends armed if the base
//!   stood, and refuses to arm while it comes to rest; after an emergency stop Arm is refused until a reset.
//! * Of several stops of one kind in a tick the last one counts; the severer of two kinds prevails: release, brake, stop.
//!
//! Storing parameters makes a tick as long as the flash takes, and a stop wait for it; it is refused unless the base is idle
//! or stopped, where there is no torque that a stop could end.
//!
//! What the line loses has no Ack. A host sends a stop again until it has one, best with a delimiter (a zero byte) before
//! it, which ends whatever damage stands on the line; a host that says nothing at all is gone after `command_stale`.

use core::sync::atomic::{AtomicU32, Ordering};

use controller_core::base::Sensed;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use heapless::spsc::Queue;

use crate::control::ControlTask;
use crate::drive::DriveOutput;
use crate::queue::{self, Receiver};
use crate::recorder::{Recorder, Tick};
use crate::storage::{Memory, NoMemory, NotLoaded, SaveError};
use crate::telemetry::TelemetryQueue;
use protocol::{Command, Frame, Origin, RejectReason, Telemetry, WirePose, WireTwist};

mod command_receiver;
mod stops;

use stops::{Seen, Stops};

pub use command_receiver::CommandReceiver;

/// Slots for samples; a host is ahead of the robot by one less.
pub const SAMPLES: usize = 64;
/// Slots for commands under way to the tick.
pub const REQUESTS: usize = 8;
/// Slots for velocity orders and external poses under way to the tick: a queue of their own, so that other commands, however many, make
/// none stale.
pub const PERIODIC: usize = 4;
/// Slots for telemetry under way to the line.
pub const REPORTS: usize = 16;

/// A base that stands, and so does not report, says its state again after so long \[µs\].
const STATE_US: u32 = 1_000_000;

/// A command, and its place among all that is on its way to the tick.
struct Request<M = Command> {
    number: u32,
    frame: Frame<M>,
}

/// What a host sends again and again: smaller than what a command may be.
enum Periodic {
    Drive {
        twist: WireTwist,
        hold_heading: bool,
    },
    Fix {
        pose: WirePose,
        age_s: f32,
    },
}

impl Periodic {
    /// `None` for a command that is none.
    const fn of(command: &Command) -> Option<Self> {
        match *command {
            Command::Drive {
                twist,
                hold_heading,
            } => Some(Self::Drive {
                twist,
                hold_heading,
            }),
            Command::Fix { pose, age_s } => Some(Self::Fix { pose, age_s }),
            _ => None,
        }
    }
}

impl From<Request<Periodic>> for Request {
    fn from(Request { number, frame }: Request<Periodic>) -> Self {
        let Frame { sequence, message } = frame;
        let message = match message {
            Periodic::Drive {
                twist,
                hold_heading,
            } => Command::Drive {
                twist,
                hold_heading,
            },
            Periodic::Fix { pose, age_s } => Command::Fix { pose, age_s },
        };
        Self {
            number,
            frame: Frame { sequence, message },
        }
    }
}

type Answer = Frame<Telemetry>;

/// Sequence number of unsolicited telemetry.
pub const UNASKED: u16 = u16::MAX;

/// What both sides look at; each field has one writer.
#[derive(Debug, Default)]
struct Shared {
    /// Sound frames, written by the command receiver.
    frames: AtomicU32,
    /// Whether samples are taken, in the lowest bit, and changes of state above; written by the tick.
    state: AtomicU32,
    /// Written by the command receiver.
    stops: Stops,
    /// Heartbeats, written by the command receiver.
    heartbeats: AtomicU32,
    /// Time between ticks \[µs\], written once.
    period_us: AtomicU32,
    overruns: AtomicU32,
    dropped: AtomicU32,
}

/// The queues between the two sides. It outlives both, in a `static` or on the stack of `main`.
#[derive(Default)]
pub struct Queues {
    samples: ReferenceQueue<f32, SAMPLES>,
    requests: Queue<Request, REQUESTS>,
    periodic: Queue<Request<Periodic>, PERIODIC>,
    answers: Queue<Answer, REPORTS>,
    shared: Shared,
}

/// Ends of the queues for the tick.
pub struct TickEnds<'queue> {
    requests: Receiver<'queue, Request, REQUESTS>,
    periodic: Receiver<'queue, Request<Periodic>, PERIODIC>,
    /// The first of each queue, which waits for the other's.
    next: (Option<Request>, Option<Request<Periodic>>),
    telemetry: TelemetryQueue<'queue, Answer, REPORTS>,
    shared: &'queue Shared,
}

impl Queues {
    /// The control task's references, the tick's ends, and the background's side. Of `decimate` reports one is
    /// sent.
    pub fn split(
        &mut self,
        decimate: u16,
    ) -> (
        controller_core::queue::ReferenceConsumer<'_, f32>,
        TickEnds<'_>,
        CommandReceiver<'_>,
    ) {
        let (producer, consumer) = self.samples.split();
        let (sender, requests) = queue::split(&mut self.requests);
        let (periodic_sender, periodic) = queue::split(&mut self.periodic);
        let (telemetry, answers) = TelemetryQueue::split(&mut self.answers, decimate);
        let shared = &self.shared;
        let receiver = CommandReceiver::new(producer, sender, periodic_sender, answers, shared);
        let ends = TickEnds {
            requests,
            periodic,
            next: (None, None),
            telemetry,
            shared,
        };
        (consumer, ends, receiver)
    }
}

impl TickEnds<'_> {
    /// The next command of both queues, in the sequence in which they came.
    fn receive(&mut self) -> Option<Request> {
        let (request, periodic) = &mut self.next;
        if request.is_none() {
            *request = self.requests.receive();
        }
        if periodic.is_none() {
            *periodic = self.periodic.receive();
        }
        let periodic_first = match (&*request, &*periodic) {
            (Some(request), Some(periodic)) => stops::is_before(periodic.number, request.number),
            (request, _) => request.is_none(),
        };
        if periodic_first {
            periodic.take().map(Request::from)
        } else {
            request.take()
        }
    }
}

/// The tick's side: stops and commands first, then the control task, then telemetry.
pub struct ControlServer<'queue, D, M = NoMemory> {
    task: ControlTask<'queue, D>,
    ends: TickEnds<'queue>,
    memory: M,
    origin: Origin,
    /// The origin that the host knows.
    reported: Option<Origin>,
    frames: u32,
    heartbeats: u32,
    stops: Seen,
    changes: u32,
    /// When the state was told last.
    told_us: u32,
    /// The state word of the trajectory under way.
    word: u32,
    recorder: Recorder,
}

impl<'queue, D: DriveOutput> ControlServer<'queue, D> {
    /// Puts a task on the line; it begins with what it was compiled with.
    pub fn new(task: ControlTask<'queue, D>, ends: TickEnds<'queue>) -> Self {
        Self::with_memory(task, ends, NoMemory)
    }
}

impl<'queue, D: DriveOutput, M: Memory> ControlServer<'queue, D, M> {
    /// Puts a task on the line; it begins with what is stored, if that is whole and in range.
    pub fn with_memory(
        mut task: ControlTask<'queue, D>,
        ends: TickEnds<'queue>,
        mut memory: M,
    ) -> Self {
        let origin = match memory.load().record {
            Ok(record) => match task.set_field(&record.params) {
                Ok(()) => Origin::Stored {
                    sequence: record.sequence,
                },
                Err(_) => Origin::Defaults(NotLoaded::Refused),
            },
            Err(why) => Origin::Defaults(why),
        };
        let period_us = task.params().detectors.period_us;
        ends.shared.period_us.store(period_us, Ordering::Relaxed);
        Self {
            task,
            ends,
            memory,
            origin,
            reported: None,
            frames: 0,
            heartbeats: 0,
            stops: Seen::default(),
            changes: 0,
            told_us: 0,
            word: 0,
            recorder: Recorder::default(),
        }
    }

    /// Where the parameters in use come from.
    pub const fn origin(&self) -> Origin {
        self.origin
    }

    /// One tick; see [`ControlTask::tick`]. Storing parameters, at the host's request and while disarmed only, takes as long as the
    /// flash does.
    pub fn tick(&mut self, now_us: u32, sensed: &Sensed<f32>) {
        let frames = self.ends.shared.frames.load(Ordering::Relaxed);
        if frames != self.frames {
            self.frames = frames;
            self.task.host_seen();
        }
        let heartbeats = self.ends.shared.heartbeats.load(Ordering::Relaxed);
        if heartbeats != self.heartbeats {
            self.heartbeats = heartbeats;
            self.task.heartbeat_seen();
        }
        let mut stops = self.stops.news(&self.ends.shared.stops);
        let mut told = false;
        // As many as there can be, and no more, however fast they come. The commands before a stop seen above were in the
        // queues by then, which hold less than there are rounds: the stop is obeyed within them.
        for _ in 0..REQUESTS + PERIODIC {
            let request = self.ends.receive();
            let number = request.as_ref().map(|request| request.number);
            while let Some(stop) = stops.next_before(number) {
                // Nothing refuses a stop.
                let _ = self.task.command(stop);
            }
            let Some(Request { frame, .. }) = request else {
                break;
            };
            let Frame { sequence, message } = frame;
            let message = self.answer(&message);
            if message == Telemetry::Nack(RejectReason::State) && !told {
                // Before the refusal, so that whoever reads that knows of which state. Once a tick: the queue is short.
                told = true;
                self.tell_state();
            }
            self.ends.telemetry.push(Frame { sequence, message });
        }
        self.task.tick(now_us, sensed);
        self.record(now_us, sensed);
        self.publish(now_us);
    }

    /// A row of this tick, if the base drives for a recording. One that cannot be sent ends the drive.
    fn record(&mut self, now_us: u32, sensed: &Sensed<f32>) {
        let Self {
            task,
            ends,
            recorder,
            ..
        } = self;
        let tick = Tick {
            excites: if task.excites() {
                Ok(())
            } else {
                Err(task.excitation_end())
            },
            now_us,
            sensed,
            fix: task.fix_taken(),
            output: task.drive().output(),
            max_torque_nm: task.drive().max_torque_nm(),
        };
        let recorded = recorder.tick(&tick, |message| ends.telemetry.push(unasked(message)));
        if let Err(end) = recorded {
            task.end_excitation(end);
        }
    }

    fn answer(&mut self, command: &Command) -> Telemetry {
        let origin = match command {
            Command::GetParameters => {
                self.task.host_seen();
                return Telemetry::Parameters(self.task.params().into());
            }
            Command::SaveParameters => {
                self.task.host_seen();
                if !self.task.is_disarmed() {
                    return Telemetry::Nack(RejectReason::State);
                }
                match self.memory.save(&self.task.params().into()) {
                    Ok(sequence) => Origin::Stored { sequence },
                    Err(SaveError::NoMemory) => {
                        return Telemetry::Nack(RejectReason::Unsupported);
                    }
                    Err(_) => return Telemetry::Nack(RejectReason::Storage),
                }
            }
            _ => {
                let result = self.task.command(command);
                if result.is_err() {
                    return outcome(result);
                }
                match command {
                    Command::SetParameters(_) => Origin::Host,
                    Command::LoadDefaults => Origin::Defaults(NotLoaded::Asked),
                    _ => self.origin,
                }
            }
        };
        self.origin = origin;
        Telemetry::Ack
    }

    /// The control task, to look at.
    pub const fn task(&self) -> &ControlTask<'queue, D> {
        &self.task
    }

    /// The wheels; see [`ControlTask::drive_mut`].
    pub const fn drive_mut(&mut self) -> &mut D {
        self.task.drive_mut()
    }

    fn tell_state(&mut self) {
        let task = &self.task;
        let told = self.ends.telemetry.push(unasked(Telemetry::State {
            tick: task.ticks(),
            state: task.state(),
            cause: task.cause(),
        }));
        if told {
            self.changes = task.changes();
        }
    }

    fn publish(&mut self, now_us: u32) {
        // One that does not report is silent to a host that has come since its last change.
        let again = now_us.wrapping_sub(self.told_us) >= STATE_US && !self.task.state().is_live();
        // Where there is no room the next tick tries again: what the base does now is the last thing to keep from a host.
        if self.task.changes() != self.changes || again {
            self.tell_state();
            self.told_us = now_us;
        }
        let Self { task, ends, .. } = self;
        if self.reported != Some(self.origin)
            && ends.telemetry.push(unasked(Telemetry::Origin(self.origin)))
        {
            self.reported = Some(self.origin);
        }
        if task.state().is_live() && !self.recorder.is_on() {
            ends.telemetry
                .offer(|| unasked(Telemetry::Tick(task.telemetry())));
        }
        let takes = match task.state() {
            State::Armed | State::Parked => true,
            // While it drives by velocity a trajectory would wait for nothing.
            State::Tracking => task.follows(),
            _ => false,
        };
        // Tracking goes on with the trajectory that it was started with.
        if task.state() != State::Tracking || !takes {
            self.word = task.changes() << 1 | u32::from(takes);
        }
        let shared = ends.shared;
        shared.state.store(self.word, Ordering::Release);
        shared.overruns.store(task.overruns(), Ordering::Relaxed);
        shared
            .dropped
            .store(ends.telemetry.dropped(), Ordering::Relaxed);
    }
}

const fn unasked(message: Telemetry) -> Answer {
    Frame {
        sequence: UNASKED,
        message,
    }
}

fn outcome(result: Result<(), RejectReason>) -> Telemetry {
    match result {
        Ok(()) => Telemetry::Ack,
        Err(reason) => Telemetry::Nack(reason),
    }
}
