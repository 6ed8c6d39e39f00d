//! A stop is obeyed in the next tick, whatever else is on the line, in the queues or under way.

use crate::commands::command;
use controller_core::base::Sensed;
use controller_core::hal::WheelCounts;
use controller_core::safety::supervisor::{State, Then};
use controller_core::types::Pose;
use firmware_demo::control::ControlTask;
use firmware_demo::control_server::{CommandReceiver, ControlServer, Queues, REPORTS, UNASKED};
use firmware_demo::drive::MockDrive;
use firmware_demo::mission;
use firmware_demo::storage::{RamFlash, Slots};
use proptest::collection::vec;
use proptest::prelude::*;
use protocol::{
    Command, Frame, MAX_FRAME, RejectReason, Telemetry, TimedSample, WirePose, WireReference,
    WireTwist, encode,
};

const TORQUE: f32 = 3.0;
const STOPS: [Command; 3] = [
    Command::Stop,
    Command::EmergencyStop { brake: true },
    Command::EmergencyStop { brake: false },
];
const AHEAD: Command = Command::Park {
    goal: WirePose {
        x: 1.0,
        y: 0.0,
        theta: 0.0,
    },
};
/// Every state but `Braking(Then::Stopped)`, which takes a stop that does not end.
const FROM: [State; 10] = [
    State::Idle,
    State::Armed,
    State::Tracking,
    State::Parking,
    State::Parked,
    State::Stopping(Then::Stopped),
    State::Stopping(Then::Fault),
    State::Braking(Then::Fault),
    State::Stopped,
    State::Fault,
];

/// A control server whose wheels stand still; nobody reads its telemetry unless a test does.
struct Rig {
    server: ControlServer<'static, MockDrive<0>, Slots<RamFlash>>,
    receiver: CommandReceiver<'static>,
    now_us: u32,
    sequence: u16,
}

impl Rig {
    fn new() -> Self {
        let queues = Box::leak(Box::new(Queues::default()));
        let (references, ends, receiver) = queues.split(1);
        let defaults = mission::params(TORQUE, false).unwrap();
        let wheels = MockDrive::new(TORQUE);
        let task = ControlTask::new(wheels, references, defaults, Pose::default()).unwrap();
        Self {
            server: ControlServer::with_memory(task, ends, Slots::new(RamFlash::default())),
            receiver,
            now_us: 0,
            sequence: 0,
        }
    }

    /// In one of [`FROM`].
    fn reached(state: State) -> Self {
        let mut rig = Self::new();
        let script: &[Command] = match state {
            State::Idle => &[],
            State::Armed => &[Command::Arm],
            State::Tracking => &[Command::Arm, sample(0), sample(100), sample(200)],
            State::Parking => &[Command::Arm, AHEAD],
            State::Parked => &[
                Command::Arm,
                Command::Park {
                    goal: WirePose {
                        x: 0.0,
                        y: 0.0,
                        theta: 0.0,
                    },
                },
            ],
            State::Stopping(Then::Stopped) => &[Command::Arm, AHEAD, Command::Stop],
            State::Stopping(Then::Fault) => &[Command::Arm, AHEAD],
            State::Braking(_) => &[Command::Arm, AHEAD, STOPS[1]],
            State::Stopped => &[Command::Stop],
            State::Fault => &[STOPS[2]],
        };
        for command in script {
            assert_ne!(refusal(rig.say(command)), Some(RejectReason::Full));
            rig.tick();
        }
        if state == State::Stopping(Then::Fault) {
            // A tick that is too long, but shorter than the dwell at rest that ends a stop.
            rig.now_us += 60_000;
        }
        rig.run_until(state);
        rig
    }

    fn bytes(&mut self, bytes: &[u8]) -> Option<Frame<Telemetry>> {
        let receiver = &mut self.receiver;
        bytes.iter().find_map(|&byte| receiver.push(byte, || 0))
    }

    fn say(&mut self, command: &Command) -> Option<Frame<Telemetry>> {
        let mut frame = [0; MAX_FRAME];
        // Counts through all numbers but that of what nobody asked for.
        self.sequence = (self.sequence + 1) % UNASKED;
        let frame = encode(self.sequence, command, &mut frame).expect("every command fits");
        self.bytes(frame)
    }

    /// A stop, which is answered at once.
    fn stop(&mut self, stop: &Command) {
        let answer = self.say(stop);
        let ack = Frame {
            sequence: self.sequence,
            message: Telemetry::Ack,
        };
        assert_eq!(answer, Some(ack));
    }

    fn tick(&mut self) {
        self.now_us = self.now_us.wrapping_add(1000);
        let standing = Sensed::of_counts(WheelCounts::default());
        self.server.tick(self.now_us, &standing);
    }

    fn run_until(&mut self, state: State) {
        for _ in 0..5000 {
            if self.state() == state {
                return;
            }
            self.tick();
        }
        panic!("{:?} is not {state:?}", self.state());
    }

    fn state(&self) -> State {
        self.server.task().state()
    }

    fn assert_stopped_by(&self, stop: &Command) {
        let state = self.state();
        if *stop == Command::Stop {
            assert!(
                matches!(
                    state,
                    State::Stopping(_) | State::Braking(_) | State::Stopped | State::Fault
                ),
                "{state:?}"
            );
        } else {
            assert!(
                matches!(state, State::Braking(Then::Fault) | State::Fault),
                "{state:?}"
            );
            assert_eq!(self.server.task().applied(), None);
        }
    }
}

fn refusal(answer: Option<Frame<Telemetry>>) -> Option<RejectReason> {
    match answer?.message {
        Telemetry::Nack(reason) => Some(reason),
        _ => None,
    }
}

fn sample(ms: u16) -> Command {
    let t = f32::from(ms) * 1.0e-3;
    let mut reference = WireReference::default();
    (reference.pose.x, reference.twist.v) = (0.2 * t, 0.2);
    Command::Sample(TimedSample { t, reference })
}

/// A sample that no base can follow is refused on the line, and the trajectory goes on without it; in the tick it would be a fault.
#[test]
fn a_sample_that_no_base_follows_is_refused_by_name() {
    let mut rig = Rig::reached(State::Armed);
    let wrong: [fn(&mut WireReference); 5] = [
        |reference| reference.pose.y = 1.0e30,
        |reference| reference.twist.v = -1.0e30,
        |reference| reference.twist.w = 1.0e30,
        |reference| reference.accel.v = 1.0e30,
        |reference| reference.accel.w = -1.0e30,
    ];
    for set in wrong {
        let mut reference = WireReference::default();
        set(&mut reference);
        // Later than those that are taken below.
        let wrong = Command::Sample(TimedSample { t: 9.0, reference });
        assert_eq!(refusal(rig.say(&wrong)), Some(RejectReason::Value));
    }
    for ms in [0, 20] {
        assert_eq!(refusal(rig.say(&sample(ms))), None);
    }
}

/// The finding: the queue holds seven commands, and the stop was the ninth.
#[test]
fn a_full_queue_refuses_no_stop() {
    for stop in &STOPS {
        let mut rig = Rig::reached(State::Parking);
        for _ in 0..7 {
            assert_eq!(rig.say(&Command::GetParameters), None);
        }
        assert_eq!(refusal(rig.say(&AHEAD)), Some(RejectReason::Full));
        rig.stop(stop);
        rig.tick();
        rig.assert_stopped_by(stop);
    }
}

/// External poses and velocity orders have places of their own: what fills the queue makes none of them late.
#[test]
fn a_full_queue_refuses_no_pose_and_no_order() {
    let mut rig = Rig::reached(State::Armed);
    for _ in 0..7 {
        assert_eq!(rig.say(&Command::GetParameters), None);
    }
    assert_eq!(refusal(rig.say(&AHEAD)), Some(RejectReason::Full));
    let pose = WirePose::default();
    let (twist, hold_heading) = (WireTwist::default(), false);
    let order = Command::Drive {
        twist,
        hold_heading,
    };
    assert_eq!(rig.say(&Command::Fix { pose, age_s: 0.0 }), None);
    assert_eq!(rig.say(&order), None);
    rig.tick();
    assert_eq!(rig.state(), State::Tracking);
}

/// In one tick: what came before the stop does not survive it.
#[test]
fn a_stop_wins_over_the_commands_before_it() {
    for stop in &STOPS {
        let mut rig = Rig::reached(State::Idle);
        assert_eq!(rig.say(&Command::Arm), None);
        assert_eq!(rig.say(&AHEAD), None);
        rig.stop(stop);
        rig.tick();
        rig.assert_stopped_by(stop);
        // And nothing of them comes back with the next arming.
        rig.run_until(if *stop == Command::Stop {
            State::Stopped
        } else {
            State::Fault
        });
        rig.say(&Command::ResetFault);
        rig.say(&Command::Arm);
        rig.tick();
        assert_eq!(rig.state(), State::Armed);
        rig.tick();
        assert_eq!(rig.state(), State::Armed);
    }
    // References that wait are gone as well.
    let mut rig = Rig::reached(State::Armed);
    let ack = Some(Telemetry::Ack);
    for ms in [0, 100, 200] {
        assert_eq!(rig.say(&sample(ms)).map(|answer| answer.message), ack);
    }
    rig.stop(&Command::Stop);
    rig.say(&Command::Arm);
    for _ in 0..10 {
        rig.tick();
        assert_eq!(rig.state(), State::Armed);
    }
}

/// In one tick: as if they had come one by one.
#[test]
fn commands_after_a_stop_come_after_it() {
    use Command::{Arm, ResetFault, Stop};
    let [_, brake, release] = STOPS;
    let stopping = State::Stopping(Then::Stopped);
    let braking = State::Braking(Then::Fault);
    for (from, commands, to) in [
        // A standing base may be armed again, one that comes to rest may not.
        (State::Armed, vec![Stop, Arm], State::Armed),
        (State::Armed, vec![Stop, Arm, AHEAD], State::Parking),
        (State::Parking, vec![Stop, Arm], stopping),
        (State::Parking, vec![Stop, Arm, AHEAD], stopping),
        (State::Parking, vec![Stop, ResetFault, Arm, AHEAD], stopping),
        // An emergency stop asks for a reset, which the host sends after it or not at all.
        (State::Parking, vec![release, Arm, AHEAD], State::Fault),
        (State::Parking, vec![release, ResetFault], State::Idle),
        (State::Parking, vec![release, ResetFault, Arm], State::Armed),
        (State::Fault, vec![ResetFault, release], State::Fault),
        (State::Parking, vec![brake, ResetFault, Arm, AHEAD], braking),
        // The severer one prevails, in any order.
        (State::Parking, vec![Stop, release], State::Fault),
        (State::Parking, vec![release, Stop], State::Fault),
        (State::Parking, vec![release, brake], State::Fault),
        (State::Parking, vec![brake, release], State::Fault),
        (State::Parking, vec![Stop, brake], braking),
        // The last of a kind counts.
        (State::Armed, vec![Stop, Arm, AHEAD, Stop], State::Stopped),
        (State::Armed, vec![Stop, Arm, Stop, Arm], State::Armed),
    ] {
        let mut rig = Rig::reached(from);
        for command in &commands {
            rig.say(command);
        }
        rig.tick();
        assert_eq!(rig.state(), to, "{from:?}: {commands:?}");
    }
}

/// The host does not read: answers are dropped and counted, stops obeyed, and the state is reported once there is room.
#[test]
fn a_full_line_to_the_host_stops_no_stop() {
    for stop in &STOPS {
        let mut rig = Rig::reached(State::Parking);
        for _ in 0..REPORTS {
            assert_eq!(rig.say(&Command::GetParameters), None);
            rig.tick();
        }
        rig.stop(stop);
        rig.tick();
        rig.assert_stopped_by(stop);
        let state = rig.state();
        while rig.receiver.pending().is_some() {}
        rig.tick();
        let mut reported = None;
        while let Some(Frame { message, .. }) = rig.receiver.pending() {
            if let Telemetry::State { state, .. } = message {
                reported = Some(state);
            }
        }
        assert_eq!(reported, Some(state));
        let counters = rig.say(&Command::GetCounters).unwrap().message;
        assert!(matches!(counters, Telemetry::Counters(counters) if counters.reports_dropped > 0));
    }
}

/// Whoever begins to listen then has no other word of it.
#[test]
fn a_base_that_stands_says_its_state_once_a_second() {
    for state in [State::Idle, State::Stopped, State::Fault] {
        let mut rig = Rig::reached(state);
        rig.tick();
        while rig.receiver.pending().is_some() {}
        let mut told = Vec::new();
        for _ in 0..3000 {
            rig.tick();
            told.extend(core::iter::from_fn(|| rig.receiver.pending()));
        }
        assert_eq!(told.len(), 3, "{state:?}: {told:?}");
        for Frame { sequence, message } in told {
            let says = matches!(message, Telemetry::State { state: said, .. } if said == state);
            assert!(sequence == UNASKED && says, "{state:?}: {message:?}");
        }
    }
}

/// A delimiter before the stop ends what damage has left, of any kind.
#[test]
fn a_damaged_line_takes_a_stop_behind_a_delimiter() {
    for stop in &STOPS {
        for damage in [&[7][..], &[0xff; 300], &[1, 1, 1], &[0, 5, 1]] {
            let mut rig = Rig::reached(State::Parking);
            assert_eq!(rig.bytes(damage), None);
            assert_eq!(rig.bytes(&[0]), None);
            rig.stop(stop);
            rig.tick();
            rig.assert_stopped_by(stop);
        }
    }
}

proptest! {
    /// Any load before and after, in any state; only what lifts a stop is left out behind it.
    #[test]
    fn a_stop_is_obeyed_in_the_next_tick(
        from in prop::sample::select(&FROM[..]),
        ticks_unread in 0..40_usize,
        before in vec(command(), 0..60),
        stop in prop::sample::select(&STOPS[..]),
        after in vec(command(), 0..60),
    ) {
        let mut rig = Rig::reached(from);
        for _ in 0..ticks_unread {
            rig.tick();
        }
        for command in &before {
            rig.say(command);
        }
        rig.stop(&stop);
        for command in &after {
            if !matches!(command, Command::Arm | Command::ResetFault) {
                rig.say(command);
            }
        }
        rig.tick();
        rig.assert_stopped_by(&stop);
    }
}
