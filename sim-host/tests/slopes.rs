//! Bases that stand, or are stopped, where they would roll away.

use controller_core::base::WheelAction;
use controller_core::motor::electrical_brake;
use controller_core::safety::supervisor::State;
use firmware_demo::control_server::Queues;
use protocol::{Command, MAX_FRAME, encode};
use sim_host::closed_loop::Board;
use sim_host::mission::BaseSpec;
use sim_host::scenario::BASES;
use sim_host::world::{WorldKeys, WorldSetup};

/// 55 %: more than what the gears of any of these bases hold.
const SLOPE_RAD: f64 = 0.5;

/// A base by itself, downhill ahead.
struct Slope<'queue> {
    board: Board<'queue>,
    /// Of what it sends.
    sequence: u16,
}

impl<'queue> Slope<'queue> {
    fn new(queues: &'queue mut Queues, base: &BaseSpec) -> Self {
        let mut setup = WorldSetup {
            world: WorldKeys::default(),
            seed: 1,
        };
        setup.world.floor.slope_rad = SLOPE_RAD;
        let board = Board::new(queues, base, &setup, |_| {}).expect("a base in a world");
        Self { board, sequence: 0 }
    }

    fn send(&mut self, command: &Command) {
        let mut frame = [0; MAX_FRAME];
        let bytes = encode(self.sequence, command, &mut frame).expect("fits");
        for byte in bytes {
            self.board.receive(*byte);
        }
        self.sequence += 1;
    }

    /// The largest speed after the first second \[m/s\]; `held` holds of every action.
    fn run(&mut self, seconds: f64, held: impl Fn(&WheelAction<f32>) -> bool) -> f64 {
        let begin = self.board.world().now_us() as f64;
        let mut fastest = 0.0_f64;
        loop {
            self.board
                .advance()
                .expect("a world takes what a base commands");
            let action = self.board.tick().action;
            assert!(held(&action), "{action:?}");
            while self.board.pending().is_some() {}
            let since = 1e-6 * (self.board.world().now_us() as f64 - begin);
            if since > 1.0 {
                fastest = fastest.max(self.board.world().truth().twist.linear.abs());
            }
            if since > seconds {
                return fastest;
            }
        }
    }

    /// What a base with shorted motors creeps at, if nothing but they hold it \[m/s\]: g sin α T_v.
    fn creep(&self) -> f64 {
        let base = self.board.task().controller().base();
        let motor = base.motor().expect("motors");
        let slowing = electrical_brake(motor, &base.motion().params().robot).expect("slows");
        let time_s = slowing.linear.time_constant_s().expect("of motors");
        9.81 * SLOPE_RAD.sin() * f64::from(time_s)
    }
}

/// An emergency stop brakes a base that rolls though nothing drives it, and keeps it braked, far beyond the limit of a brake, until it is reset.
#[test]
fn an_emergency_stop_holds_on_a_slope_until_a_reset() {
    for built_in in BASES {
        let base = built_in.base().expect("valid");
        let mut queues = Queues::default();
        let mut slope = Slope::new(&mut queues, &base);
        let creep = slope.creep();
        let rolls = slope.run(1.5, |action| *action == WheelAction::Release);
        assert!(rolls > 5.0 * creep, "{}: {rolls} m/s", base.name);
        slope.send(&Command::EmergencyStop { brake: true });
        let creeps = slope.run(15.0, |action| *action == WheelAction::Brake);
        assert!(creeps < creep, "{}: {creeps} of {creep} m/s", base.name);
        assert_eq!(slope.board.report().state, State::Fault);
        slope.send(&Command::ResetFault);
        let rolls = slope.run(2.0, |action| *action == WheelAction::Release);
        assert!(rolls > 5.0 * creep, "{}: {rolls} m/s", base.name);
    }
}

/// A robot's file says that its motors are shorted while nothing is ordered.
#[test]
fn a_base_whose_idle_output_is_the_brake_creeps() {
    for built_in in BASES {
        let text = format!("{}\n[stops]\nidle_output = \"brake\"\n", built_in.text);
        let base = BaseSpec::parse("mine.toml", &text).expect("valid");
        let mut queues = Queues::default();
        let mut slope = Slope::new(&mut queues, &base);
        let creep = slope.creep();
        let creeps = slope.run(5.0, |action| *action == WheelAction::Brake);
        assert!(creeps < creep, "{}: {creeps} of {creep} m/s", base.name);
    }
}
