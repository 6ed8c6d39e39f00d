//! The bridge without ROS and without a line.

use super::*;
use controller_core::safety::supervisor::Then;
use controller_core::safety::{DetectorParams, PolicyParams};
use protocol::{
    BaseTick, Hello, NotLoaded, WireCalibration, WireGains, WireLimits, WireTimeouts, WireYield,
};

type Which = fn(&Command) -> bool;

/// The bridge, and a base that answers as it is ordered.
struct Rig {
    bridge: Bridge,
    now_us: u64,
    sent: Vec<Command>,
    /// What it answers to each kind of command; Ack where nothing is said.
    refuses: Option<(Which, RejectReason)>,
    /// It says nothing.
    is_dead: bool,
    /// As it has said last; a live one sends ticks.
    state: State,
    /// Ticks that it has counted.
    ticks: u32,
}

/// Values do not matter here.
fn field() -> FieldParams {
    let command = Timeout::AfterUs(100_000);
    FieldParams {
        gains: WireGains {
            decay: 1.0,
            longitudinal: 1.0,
            longitudinal_bound: 1.0,
            heading: 1.0,
            lateral: 1.0,
            slow: 1.0,
            approach: 1.0,
            approach_brake: 1.0,
            speed_loop: 1.0,
            turn_loop: 1.0,
            disturbance: 1.0,
            disturbance_share: 1.0,
        },
        limits: WireLimits {
            speed: 1.0,
            turn_rate: 1.0,
            rim_speed: 1.0,
            accel: 1.0,
            brake: 1.0,
            turn_accel: 1.0,
            jerk: 1.0,
            turn_jerk: 1.0,
            wheel_torque_nm: 1.0,
            policy: WireYield::KeepCurvature,
        },
        calibration: WireCalibration {
            right: 1.0,
            left: 1.0,
            track: 1.0,
        },
        timeouts: WireTimeouts {
            measurement: command,
            pose: command,
            command,
        },
        policy: PolicyParams::DEFAULT,
    }
}

impl Rig {
    fn new(hold_us: u64) -> Self {
        Self {
            bridge: Bridge::new(Settings {
                field: Some(field()),
                patience: Timeout::AfterUs(100_000),
                hold_us,
            }),
            now_us: 0,
            sent: Vec::new(),
            refuses: None,
            is_dead: false,
            state: State::Idle,
            ticks: 0,
        }
    }

    /// Armed, and nothing sent yet.
    fn active(hold_us: u64) -> Self {
        let mut rig = Self::new(hold_us);
        rig.bridge.change(Transition::Configure, 0);
        rig.run(0.1);
        rig.bridge.change(Transition::Activate, rig.now_us);
        rig.run(0.1);
        assert_eq!(rig.bridge.stage(), Stage::Active);
        while rig.bridge.event().is_some() {}
        rig.says(State::Armed, Cause::Host);
        rig.sent.clear();
        rig
    }

    /// One whose base has taken a goal.
    fn parking() -> Self {
        let mut rig = Self::active(0);
        rig.bridge.park(WirePose::default(), rig.now_us);
        rig.run(0.02);
        rig.says(State::Parking, Cause::Host);
        assert_eq!(rig.bridge.event(), Some(Event::Taken));
        rig
    }

    fn says(&mut self, state: State, cause: Cause) {
        self.state = state;
        self.tells(Telemetry::State {
            tick: self.ticks,
            state,
            cause,
        });
    }

    fn tells(&mut self, message: Telemetry) {
        let frame = Frame {
            sequence: u16::MAX,
            message,
        };
        self.bridge.hear(&frame, self.now_us);
    }

    /// The base starts again, and says so.
    fn starts_again(&mut self) {
        self.state = State::Idle;
        self.ticks = 0;
        self.tells(Telemetry::Origin(Origin::Defaults(NotLoaded::NoMemory)));
    }

    /// In steps of 4 ms, as the loop has them.
    fn run(&mut self, seconds: f64) {
        for _ in 0..(250.0 * seconds).round() as u32 {
            self.now_us += 4_000;
            self.ticks += 4;
            if self.state.is_live() && !self.is_dead && self.ticks.is_multiple_of(20) {
                self.tells(Telemetry::Tick(BaseTick {
                    tick: self.ticks,
                    state: self.state,
                    ..BaseTick::default()
                }));
            }
            self.bridge.step(self.now_us);
            while let Some((sequence, command)) = self.bridge.due(self.now_us) {
                self.sent.push(command);
                if self.is_dead {
                    continue;
                }
                let refused = self.refuses.filter(|(which, _)| which(&command));
                let message = match (&command, refused) {
                    (Command::Heartbeat, _) => Telemetry::Hello(Hello::OURS),
                    (_, Some((_, why))) => Telemetry::Nack(why),
                    _ => Telemetry::Ack,
                };
                self.bridge.hear(&Frame { sequence, message }, self.now_us);
            }
        }
    }

    fn count(&self, which: Which) -> usize {
        self.sent.iter().filter(|command| which(command)).count()
    }

    fn ended(&mut self) -> Result<Stage, String> {
        loop {
            match self.bridge.event() {
                Some(Event::Transition { result, .. }) => return result,
                Some(_) => {}
                None => panic!("no transition has ended"),
            }
        }
    }
}

const TWIST: WireTwist = WireTwist { v: 0.3, w: 0.1 };

fn is_drive(command: &Command) -> bool {
    matches!(command, Command::Drive { .. })
}

fn is_park(command: &Command) -> bool {
    matches!(command, Command::Park { .. })
}

fn is_arm(command: &Command) -> bool {
    *command == Command::Arm
}

#[test]
fn a_base_is_greeted_stopped_and_given_its_parameters_before_it_is_armed() {
    let mut rig = Rig::new(0);
    rig.run(0.2);
    assert_eq!(
        rig.sent,
        [],
        "nothing is said to a base that nobody asked for"
    );
    rig.bridge.change(Transition::Configure, rig.now_us);
    rig.run(0.2);
    assert_eq!(rig.ended(), Ok(Stage::Inactive));
    let set = Command::SetParameters(field());
    assert_eq!(rig.sent[..3], [Command::Heartbeat, Command::Stop, set]);
    assert_eq!(rig.count(is_arm), 0);
    rig.bridge.change(Transition::Activate, rig.now_us);
    rig.run(0.1);
    assert_eq!(rig.ended(), Ok(Stage::Active));
    assert_eq!(rig.count(is_arm), 1);
}

#[test]
fn a_transition_that_the_base_does_not_take_is_none() {
    let mut rig = Rig::new(0);
    rig.refuses = Some((
        |c| matches!(c, Command::SetParameters(_)),
        RejectReason::Value,
    ));
    rig.bridge.change(Transition::Configure, 0);
    rig.run(0.2);
    let why = rig.ended().expect_err("refused");
    assert!(why.contains("parameters") && why.contains("range"), "{why}");
    assert_eq!(rig.bridge.stage(), Stage::Unconfigured);

    rig.is_dead = true;
    rig.bridge.change(Transition::Configure, rig.now_us);
    rig.run(7.9);
    assert!(rig.bridge.event().is_none());
    rig.run(0.2);
    assert!(
        rig.ended()
            .expect_err("no base")
            .contains("does not answer")
    );
    rig.bridge.change(Transition::Activate, rig.now_us);
    assert!(rig.ended().is_err());
}

/// While it still moves it refuses parameters; they are offered until it stands.
#[test]
fn a_base_that_comes_to_rest_is_waited_for() {
    let mut rig = Rig::new(0);
    rig.refuses = Some((
        |c| matches!(c, Command::SetParameters(_)),
        RejectReason::State,
    ));
    rig.bridge.change(Transition::Configure, 0);
    rig.run(1.0);
    assert!(rig.bridge.event().is_none());
    rig.refuses = None;
    rig.run(0.1);
    assert_eq!(rig.ended(), Ok(Stage::Inactive));
}

/// Five times in the base's patience, whatever else is sent, and not when nobody is to be armed.
#[test]
fn signs_of_life_are_even() {
    let mut rig = Rig::active(0);
    rig.run(1.0);
    assert_eq!(rig.sent.len(), 50, "{:?}", rig.sent);
    rig.sent.clear();
    rig.bridge.change(Transition::Deactivate, rig.now_us);
    rig.says(State::Stopped, Cause::Host);
    rig.run(0.1);
    rig.sent.clear();
    rig.run(1.0);
    assert_eq!(rig.sent, []);
}

#[test]
fn a_velocity_is_sent_once_or_as_long_as_it_is_held() {
    for (hold_us, times) in [(0, 1), (200_000, 6)] {
        let mut rig = Rig::active(hold_us);
        assert!(rig.bridge.drive(TWIST, rig.now_us));
        rig.run(1.0);
        assert_eq!(rig.count(is_drive), times, "held for {hold_us} us");
    }
}

/// A velocity that no base has is not said to it, and ends nothing that goes on.
#[test]
fn a_velocity_that_is_none_is_refused_and_changes_nothing() {
    let mut rig = Rig::parking();
    for (v, told) in [(f32::NAN, "not a number"), (1.0e4, "beyond 100 m/s")] {
        for twist in [WireTwist { v, w: 0.0 }, WireTwist { v: 0.0, w: v }] {
            let drives = rig.bridge.drive(twist, rig.now_us);
            assert!(!drives, "a path that is being fitted would be given up");
            rig.run(0.02);
            let event = rig.bridge.event();
            assert!(
                matches!(&event, Some(Event::Refused(why)) if why.contains(told)),
                "{event:?}"
            );
        }
    }
    assert_eq!((rig.count(is_drive), rig.count(is_park)), (0, 1));
    rig.says(State::Stopped, Cause::LinkLost);
    let event = rig.bridge.event();
    assert!(
        matches!(event, Some(Event::Refused(_))),
        "the goal was given up before: {event:?}"
    );
}

/// The base stops by itself when orders are stale. It is armed again, which moves nothing; not after any other fault.
#[test]
fn only_harmless_stops_are_left_again() {
    for (cause, again) in [
        (Cause::Fault(Fault::CommandStale), 1),
        (Cause::LinkLost, 1),
        (Cause::GoalUnreachable, 1),
        (Cause::Fault(Fault::PoseStale), 0),
        (Cause::EmergencyStop, 0),
    ] {
        let mut rig = Rig::active(0);
        rig.says(State::Stopping(Then::Stopped), cause);
        rig.run(0.1);
        assert_eq!(rig.count(is_arm), 0, "{cause:?}: it still moves");
        rig.says(State::Stopped, cause);
        rig.run(0.006);
        if again > 0 {
            rig.says(State::Armed, Cause::Host);
        }
        rig.run(0.1);
        assert_eq!(rig.count(is_arm), again, "{cause:?}");
    }
    let mut rig = Rig::active(0);
    rig.says(State::Fault, Cause::Fault(Fault::CommandStale));
    rig.run(0.2);
    assert_eq!(rig.count(is_arm), 0, "latched");
}

#[test]
fn a_refused_arming_is_not_asked_for_again() {
    let mut rig = Rig::active(0);
    rig.refuses = Some((is_arm, RejectReason::State));
    rig.says(State::Stopped, Cause::LinkLost);
    rig.run(1.0);
    assert_eq!(rig.count(is_arm), 1);
}

#[test]
fn a_goal_waits_for_a_base_that_is_about_to_be_ready() {
    let goal = WirePose {
        x: 1.0,
        y: 0.0,
        theta: 0.0,
    };
    let mut rig = Rig::active(0);
    rig.says(State::Stopping(Then::Stopped), Cause::Host);
    rig.bridge.park(goal, rig.now_us);
    rig.run(0.5);
    assert_eq!(rig.count(is_park), 0);
    rig.says(State::Stopped, Cause::Host);
    rig.run(0.006);
    rig.says(State::Armed, Cause::Host);
    rig.run(0.02);
    assert_eq!(rig.count(is_park), 1);

    rig.says(State::Stopping(Then::Stopped), Cause::Host);
    rig.bridge.park(goal, rig.now_us);
    rig.run(6.0);
    assert_eq!(rig.bridge.event(), Some(Event::Taken));
    let event = rig.bridge.event();
    assert!(matches!(event, Some(Event::Refused(_))), "{event:?}");
    assert_eq!(rig.count(is_park), 1);
    // A velocity in the meantime takes its place.
    rig.bridge.park(goal, rig.now_us);
    rig.bridge.drive(TWIST, rig.now_us);
    rig.says(State::Armed, Cause::Host);
    rig.run(0.1);
    assert_eq!(rig.count(is_park), 1);
}

#[test]
fn whoever_gave_a_goal_is_told_that_it_is_given_up() {
    let mut rig = Rig::parking();
    assert_eq!(rig.bridge.event(), None);
    rig.says(State::Stopping(Then::Stopped), Cause::LinkLost);
    rig.says(State::Stopped, Cause::LinkLost);
    let event = rig.bridge.event();
    let said = matches!(&event, Some(Event::Refused(why)) if why.contains("LinkLost"));
    assert!(said, "{event:?}");
    assert_eq!(rig.bridge.event(), None, "once");
    // One that is reached, or that a velocity has ended, is not.
    rig.says(State::Armed, Cause::Host);
    for ended in [false, true] {
        rig.bridge.park(WirePose::default(), rig.now_us);
        rig.run(0.02);
        if ended {
            rig.bridge.drive(TWIST, rig.now_us);
            rig.run(0.02);
        } else {
            rig.says(State::Parked, Cause::Reached);
        }
        rig.says(State::Stopped, Cause::LinkLost);
        for _ in 0..=usize::from(ended) {
            assert_eq!(rig.bridge.event(), Some(Event::Taken));
        }
        assert_eq!(rig.bridge.event(), None);
        rig.says(State::Armed, Cause::Host);
    }
}

#[test]
fn nobody_drives_a_node_that_is_not_active() {
    let mut rig = Rig::new(0);
    rig.bridge.drive(TWIST, 0);
    rig.bridge.park(WirePose::default(), 0);
    rig.run(0.1);
    assert_eq!(rig.sent, []);
    let mut rig = Rig::active(0);
    rig.bridge.drive(
        WireTwist {
            v: f32::NAN,
            w: 0.0,
        },
        rig.now_us,
    );
    rig.run(0.1);
    assert_eq!(rig.count(is_drive), 0);
}

/// It has its own parameters then, and nothing is armed with those.
#[test]
fn a_base_that_starts_again_gets_its_parameters_before_it_is_armed() {
    let set = Command::SetParameters(field());
    let is_set: Which = |c| matches!(c, Command::SetParameters(_));
    let mut rig = Rig::parking();
    rig.sent.clear();
    rig.starts_again();
    let event = rig.bridge.event();
    assert!(matches!(event, Some(Event::Refused(_))), "{event:?}");
    rig.run(0.02);
    rig.says(State::Armed, Cause::Host);
    rig.run(0.1);
    let orders: Vec<_> = rig
        .sent
        .iter()
        .filter(|c| **c != Command::Heartbeat)
        .collect();
    assert_eq!(orders, [&set, &Command::Arm]);

    // Inactive, and activated afterwards.
    rig.bridge.change(Transition::Deactivate, rig.now_us);
    rig.says(State::Stopped, Cause::Host);
    rig.run(0.1);
    rig.starts_again();
    rig.sent.clear();
    rig.bridge.change(Transition::Activate, rig.now_us);
    rig.run(0.02);
    assert_eq!(rig.bridge.stage(), Stage::Active);
    assert_eq!(rig.sent[..2], [set, Command::Arm]);

    // Its own word of it is lost: it counts from 0.
    rig.says(State::Armed, Cause::Host);
    rig.run(0.1);
    rig.ticks = 0;
    rig.says(State::Armed, Cause::Host);
    rig.sent.clear();
    rig.run(0.02);
    assert_eq!(
        (rig.count(|c| *c == Command::Stop), rig.count(is_arm)),
        (1, 0)
    );
    rig.says(State::Stopped, Cause::Host);
    rig.run(0.02);
    assert_eq!((rig.count(is_set), rig.count(is_arm)), (1, 1));
    // One that does not take them is not armed.
    rig.refuses = Some((is_set, RejectReason::Value));
    rig.starts_again();
    rig.sent.clear();
    rig.run(1.0);
    assert_eq!((rig.count(is_set), rig.count(is_arm)), (1, 0));
}

/// A change of state is said once, and a base that is not armed sends no ticks.
#[test]
fn a_base_whose_state_was_lost_is_armed_again() {
    let mut rig = Rig::active(0);
    rig.state = State::Stopped;
    rig.run(0.4);
    assert_eq!(rig.count(is_arm), 0);
    rig.run(0.2);
    assert_eq!(rig.count(is_arm), 1);
    rig.says(State::Armed, Cause::Host);
    // An order shows it sooner, and is not called taken.
    rig.state = State::Stopped;
    rig.refuses = Some((is_drive, RejectReason::State));
    rig.bridge.drive(TWIST, rig.now_us);
    assert_eq!(rig.bridge.event(), None);
    rig.run(0.02);
    let event = rig.bridge.event();
    let said = matches!(&event, Some(Event::Refused(why)) if why.contains("velocity"));
    assert!(said, "{event:?}");
    assert_eq!(rig.count(is_arm), 2);
    rig.refuses = None;
    rig.says(State::Armed, Cause::Host);
    rig.bridge.drive(TWIST, rig.now_us);
    rig.run(0.02);
    assert_eq!(rig.bridge.event(), Some(Event::Taken));
    assert_eq!(rig.count(is_arm), 2, "one that obeys is not asked");
    // The answers are lost as well: it is asked until it says something.
    rig.is_dead = true;
    rig.run(3.0);
    rig.is_dead = false;
    rig.refuses = Some((is_arm, RejectReason::State));
    rig.run(1.2);
    rig.refuses = None;
    rig.run(0.6);
    assert_eq!(rig.bridge.state(), Some((State::Armed, Cause::Host)));
}

/// It says which fault before it refuses what it was asked, and a reset leads on.
#[test]
fn a_base_in_a_fault_at_the_beginning_is_one_to_reset() {
    for keeps in [false, true] {
        let mut rig = Rig::new(0);
        if keeps {
            rig.bridge.settings.field = None;
        }
        rig.says(State::Fault, Cause::Fault(Fault::PoseStale));
        rig.refuses = Some((
            |c| matches!(c, Command::SetParameters(_) | Command::Arm),
            RejectReason::State,
        ));
        rig.bridge.change(Transition::Configure, 0);
        rig.run(0.2);
        if keeps {
            assert_eq!(rig.ended(), Ok(Stage::Inactive));
            rig.bridge.change(Transition::Activate, rig.now_us);
            rig.run(0.2);
        }
        let why = rig.ended().expect_err("in a fault");
        assert!(
            why.contains("pose_stale") && why.contains("reset_fault"),
            "{why}"
        );
        assert_eq!(rig.bridge.onward(), None);
        rig.bridge.reset();
        rig.run(0.02);
        assert_eq!(rig.bridge.event(), Some(Event::Reset(Ok(()))));
        rig.refuses = None;
        while let Some(onward) = rig.bridge.onward() {
            rig.bridge.change(onward, rig.now_us);
            rig.run(0.2);
            assert!(rig.ended().is_ok());
        }
        assert_eq!(rig.bridge.stage(), Stage::Active);
    }
}

/// The default of the core, which the base's files do not change.
#[test]
fn the_patience_of_these_tests_is_a_bases() {
    let base = sim_host::mission::BaseSpec::default();
    let params = sim_host::closed_loop::params(&base, 10_000).expect("in order");
    let DetectorParams { command, .. } = params.detectors;
    assert_eq!(command, Timeout::AfterUs(100_000));
}
