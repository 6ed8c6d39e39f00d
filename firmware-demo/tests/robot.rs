//! A whole robot in the emulator, driven over its serial port: control in the timer's interrupt at 1 kHz.

use std::time::{Duration, Instant};

use crate::support::{LIMIT, MACHINES, image, options};
use controller_core::maths::Single;
use controller_core::queue::TimedReference;
use controller_core::reference::ConstantTwist;
use controller_core::safety::Fault;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::types::{Pose, Twist};
use firmware_demo::control_server::UNASKED;
use firmware_demo::host::{AnyLink, Emulator, LinkKind, Machine, Session};
use firmware_demo::storage::NotLoaded;
use protocol::{
    BaseTick, Command, Excite, Origin, RecordedRows, Recording, RecordingEnd, RejectReason,
    Telemetry, WirePose,
};

/// The host's side: sends, and sorts what comes back.
struct Remote {
    session: Session<AnyLink, Telemetry>,
    // Dropped last: it kills the emulator.
    _emulator: Emulator,
    states: Vec<(u32, State, Cause)>,
    reports: Vec<BaseTick>,
    origins: Vec<Origin>,
    rows: Vec<RecordedRows>,
    recordings: Vec<Recording>,
}

impl Remote {
    fn start(machine: Machine) -> Self {
        let options = options(machine, LinkKind::Uart, false);
        // 16 ns an instruction, whatever else the host has to do: no tick is late because the host is busy. Never ahead of
        // the host's clock: 100 ms without a word from this side are no less here.
        let pace = ["-icount", "shift=4,align=on"];
        let image = image(machine, "robot");
        let (emulator, link) = Emulator::start_with(&image, &options, &pace).unwrap();
        Self {
            session: Session::new(link.unwrap()),
            _emulator: emulator,
            states: Vec::new(),
            reports: Vec::new(),
            origins: Vec::new(),
            rows: Vec::new(),
            recordings: Vec::new(),
        }
    }

    fn ask(&mut self, command: &Command) -> Telemetry {
        let sequence = self.session.send(command).unwrap();
        loop {
            let frame = self.session.receive().unwrap();
            if frame.sequence == sequence {
                return frame.message;
            }
            self.keep(frame.sequence, frame.message);
        }
    }

    fn send(&mut self, command: &Command) {
        assert_eq!(self.ask(command), Telemetry::Ack, "{command:?}");
    }

    fn keep(&mut self, sequence: u16, message: Telemetry) {
        assert_eq!(sequence, UNASKED);
        match message {
            Telemetry::State { tick, state, cause } => self.states.push((tick, state, cause)),
            Telemetry::Tick(report) => self.reports.push(report),
            Telemetry::Origin(origin) => self.origins.push(origin),
            Telemetry::Rows(rows) => self.rows.push(rows),
            Telemetry::Recording(recording) => self.recordings.push(recording),
            other => panic!("nobody asked for {other:?}"),
        }
    }

    /// Talks until the robot is in `state`, or only listens.
    fn wait_for(&mut self, state: State, talk: bool) -> (u32, Cause) {
        let until = Instant::now() + LIMIT;
        loop {
            if let Some((tick, now, cause)) = self.states.last()
                && *now == state
            {
                return (*tick, *cause);
            }
            assert!(Instant::now() < until, "no {state:?}: {:?}", self.states);
            if talk {
                std::thread::sleep(Duration::from_millis(10));
                let hello = self.ask(&Command::Heartbeat);
                assert!(matches!(hello, Telemetry::Hello(_)));
            } else {
                let frame = self.session.receive().unwrap();
                self.keep(frame.sequence, frame.message);
            }
        }
    }

    fn line(&mut self, from: Pose<f32>, samples: u16) {
        let line = ConstantTwist {
            start: from,
            twist: Twist::new(0.4, 0.0),
        };
        for number in 0..samples {
            let t = f32::from(number) * 0.1;
            let reference = line.at::<Single>(t);
            self.send(&Command::Sample((&TimedReference { t, reference }).into()));
        }
    }
}

#[test]
fn short_mission_over_the_serial_port() {
    for machine in MACHINES {
        let mut remote = Remote::start(machine);
        let hello = remote.ask(&Command::Heartbeat);
        assert!(matches!(hello, Telemetry::Hello(hello) if hello.period_us == 1000));
        let goal = WirePose::default();
        let refused = remote.ask(&Command::Park { goal });
        assert_eq!(refused, Telemetry::Nack(RejectReason::State));

        // What is changed while disarmed is stored, and reported; the memory of an emulated robot begins empty.
        let Telemetry::Parameters(mut field) = remote.ask(&Command::GetParameters) else {
            panic!("no parameters")
        };
        field.limits.speed = 2.0;
        remote.send(&Command::SetParameters(field));
        remote.send(&Command::SaveParameters);
        let field_now = remote.ask(&Command::GetParameters);
        assert_eq!(field_now, Telemetry::Parameters(field));

        // A trajectory that is cut off ends in a controlled stop.
        remote.send(&Command::Arm);
        remote.line(Pose::default(), 12);
        assert_eq!(
            remote.ask(&Command::SetParameters(field)),
            Telemetry::Nack(RejectReason::State)
        );
        let (stopped, cause) = remote.wait_for(Stopped, true);
        assert_eq!(cause, Cause::Fault(Fault::CommandStale));
        assert_eq!(
            remote.origins,
            [
                Origin::Defaults(NotLoaded::Empty),
                Origin::Host,
                Origin::Stored { sequence: 0 }
            ]
        );
        use State::{Armed, Idle, Stopped, Stopping, Tracking};
        // While it stands it says so once a second.
        remote
            .states
            .dedup_by(|(_, one, _), (_, before, _)| *one == Idle && *before == Idle);
        let states: Vec<State> = remote.states.iter().map(|&(_, state, _)| state).collect();
        // Idle, and Tracking once more, beside what was refused for them.
        assert_eq!(
            states,
            [
                Idle,
                Armed,
                Tracking,
                Tracking,
                Stopping(Then::Stopped),
                Stopped
            ]
        );
        let (started, ..) = remote.states[2];
        let (underrun, ..) = remote.states[4];
        assert!(
            (1150..1300).contains(&(underrun - started)),
            "1.1 s of samples, and 100 ms of none, took {} ticks",
            underrun - started
        );
        assert!(stopped - underrun < 5000);
        assert!(!remote.reports.is_empty());
        for report in &remote.reports {
            assert!(report.tau_right.abs() <= 15.0 && report.tau_left.abs() <= 15.0);
        }

        // The next trajectory, and a host that falls silent in it.
        remote.send(&Command::Arm);
        remote.line(Pose::new(0.7, 0.0, 0.0), 30);
        remote.states.clear();
        let hello = remote.ask(&Command::Heartbeat);
        assert!(matches!(hello, Telemetry::Hello(_)));
        let last_report = remote.reports.last().map(|report| report.tick);
        let (_, cause) = remote.wait_for(Stopped, false);
        assert_eq!(cause, Cause::LinkLost);
        // Reports come every 20 ticks; those after the last word of the host tell how long it moved on: 100 ms, and its stop.
        let moved_on = remote
            .reports
            .last()
            .map(|report| report.tick)
            .zip(last_report)
            .map(|(last, before)| last - before);
        assert!(moved_on.is_some_and(|ticks| ticks <= 1200), "{moved_on:?}");

        // From standstill to a pose.
        remote.send(&Command::Arm);
        let goal = WirePose {
            x: 1.2,
            y: 0.0,
            theta: 0.0,
        };
        remote.send(&Command::Park { goal });
        remote.states.clear();
        let (_, cause) = remote.wait_for(State::Parked, true);
        assert_eq!(cause, Cause::Reached);
        remote.send(&Command::Stop);
        let Telemetry::Counters(counters) = remote.ask(&Command::GetCounters) else {
            panic!("no counters")
        };
        println!("{machine:?}: {counters:?}");
        assert_eq!((counters.frames_rejected, counters.overruns), (0, 0));
        // Queues of 6 kB and the task of 4.5 kB live on it, and are moved there while the robot is put together:
        // 25.2 kB on the Cortex-M4F.
        assert!(counters.stack_bytes < 28 * 1024);
    }
}

/// Every tick of 6 s at 1 kHz, from the timer's interrupt over the emulated serial port, while the host's heartbeats come in.
#[test]
fn a_recording_at_the_full_rate_loses_no_row_on_the_serial_port() {
    let mut remote = Remote::start(Machine::CortexM4F);
    let order = Excite {
        length_m: 3.0,
        width_m: 2.0,
        speed: 0.6,
        turn_rate: 0.8,
        duration_s: 6.0,
        seed: 1,
    };
    let refused = remote.ask(&Command::Excite(order));
    assert_eq!(refused, Telemetry::Nack(RejectReason::State));
    remote.send(&Command::Arm);
    remote.send(&Command::Excite(order));
    let (_, cause) = remote.wait_for(State::Stopped, true);
    assert_eq!(cause, Cause::Host);
    let hello = remote.ask(&Command::Heartbeat);
    assert!(matches!(hello, Telemetry::Hello(_)));
    // Wheels that take torques, up to 15 N m.
    let began = Recording::Began {
        full_torque_nm: Some(15.0),
    };
    let [first, Recording::Ended { rows, end }] = remote.recordings[..] else {
        panic!("{:?}", remote.recordings)
    };
    assert_eq!((first, end), (began, RecordingEnd::Complete));
    let mut next = 0;
    for frame in &remote.rows {
        assert_eq!(frame.first, next);
        for row in &frame.rows[..usize::from(frame.count)] {
            assert!(next == 0 || row.dt_us == 1000, "row {next}: {row:?}");
            next += 1;
        }
    }
    assert_eq!(next, rows);
    // And until it has come to rest, 2 s at most.
    assert!((6000..8000).contains(&rows), "{rows}");
    let turned: i32 = remote
        .rows
        .iter()
        .flat_map(|frame| &frame.rows[..usize::from(frame.count)])
        .map(|row| i32::from(row.counts[0].abs()))
        .sum();
    assert!(turned > 1000, "{turned} counts");
}
