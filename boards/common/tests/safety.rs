//! A board made of memory: nothing is driven before the host has armed it, and nothing once the host is gone.

#[path = "../../../firmware-demo/tests/support/wire.rs"]
mod wire;

use std::cell::Cell;
use std::convert::Infallible;
use std::f32::consts::TAU;
use std::rc::Rc;

use board_common::{
    Bytes, Clock, ErrorType, Halves, MotorSide, NoGyro, Parts, Queues, Slots, Supply, WheelCounts,
    WheelEncoders, robot, start,
};
use controller_core::maths::Single;
use controller_core::queue::TimedReference;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{Cause, State, Then};
use controller_core::safety::{Fault, Side, StopPlan, controlled_stop};
use controller_core::types::{Accel, Pose, Twist};
use firmware_demo::control::ControlTask;
use firmware_demo::drive::MotorPair;
use firmware_demo::storage::{Memory, RamFlash};
use protocol::{Command, FieldParams, MAX_FRAME, encode};
use wire::Wire;

/// Gear times torque constant of the configuration \[V s\].
const GEARED: f32 = 30.0 * 0.0085;

/// A clock, and counts that follow the duty.
#[derive(Clone, Default)]
struct World {
    now_us: Rc<Cell<u32>>,
    /// Of both wheels.
    counts: Rc<Cell<f32>>,
    speed_rad_s: Rc<Cell<f32>>,
    /// What the left encoder still says once it is unplugged.
    unplugged: Rc<Cell<Option<i32>>>,
    /// Measured, while something does.
    supply_v: Rc<Cell<Option<f32>>>,
}

impl Supply for World {
    fn volts(&mut self) -> Option<f32> {
        self.supply_v.get()
    }
}

impl Clock for World {
    fn now_us(&self) -> u32 {
        self.now_us.get()
    }
}

impl ErrorType for World {
    type Error = Infallible;
}

impl WheelEncoders for World {
    fn counts(&mut self) -> Result<WheelCounts, Infallible> {
        let turned = self.counts.get() as i32;
        Ok(WheelCounts {
            right: turned,
            left: self.unplugged.get().unwrap_or(turned),
        })
    }
}

struct Board {
    halves: Halves<'static, Wire, Wire, Wire, World, World, Slots<RamFlash>, NoGyro, World>,
    wires: [Wire; 3],
    backward: Wire,
    world: World,
    received: Bytes,
    sequence: u16,
}

impl Board {
    fn new() -> Self {
        Self::with_memory(Slots::new(RamFlash::default()))
    }

    /// All outputs begin high, as if something had gone wrong before.
    fn with_memory(memory: Slots<RamFlash>) -> Self {
        let wires = [(); 3].map(|()| Wire(Rc::new(Cell::new(1))));
        let [enable, right, left] = wires.clone();
        let world = World::default();
        let backward = Wire::default();
        let side = |pwm, direction| MotorSide { pwm, direction };
        let parts = Parts {
            right: side(right, backward.clone()),
            left: side(left, Wire::default()),
            enable,
            encoders: world.clone(),
            gyro: NoGyro,
            supply: world.clone(),
            clock: world.clone(),
            memory,
        };
        let queues = Box::leak(Box::new(Queues::default()));
        Self {
            halves: start(parts, queues).expect("the configuration is valid"),
            wires,
            backward,
            world,
            received: Bytes::new(),
            sequence: 0,
        }
    }

    /// Armed, and for 0.2 s on its trajectory.
    fn driving() -> Self {
        let mut board = Self::new();
        board.tick();
        board.send(&Command::Arm);
        board.tick();
        board.send_trajectory();
        for _ in 0..200 {
            board.send(&Command::Heartbeat);
            board.tick();
        }
        board
    }

    fn send(&mut self, command: &Command) {
        self.sequence += 1;
        let mut frame = [0; MAX_FRAME];
        let frame = encode(self.sequence, command, &mut frame).expect("a frame");
        frame.iter().for_each(|&byte| self.received.push(byte));
        // Answers and telemetry are sent and forgotten.
        for _ in 0..4 {
            self.halves.1.poll(&self.received, |_| true);
        }
    }

    /// A millisecond; both wheels turn as the right motor's voltage and half of the mass have it.
    fn tick(&mut self) {
        self.world
            .now_us
            .set(self.world.now_us.get().wrapping_add(1000));
        let [_, right, _] = &self.wires;
        let duty = f32::from(right.0.get()) * 1.0e-3;
        let volts = if self.backward.0.get() > 0 {
            -12.0
        } else {
            12.0
        } * duty;
        let World {
            counts,
            speed_rad_s,
            ..
        } = &self.world;
        let speed = speed_rad_s.get();
        // Gear times torque constant, resistance, half of the mass at the wheel's radius.
        let torque = GEARED * (volts - GEARED * speed) / 2.2;
        let speed = speed + 1.0e-3 * torque / (0.75 * 0.0325 * 0.0325);
        speed_rad_s.set(speed);
        counts.set(counts.get() + 1.0e-3 * speed * 1920.0 / TAU);
        self.halves.0.tick();
        self.halves.1.poll(&self.received, |_| true);
    }

    fn task(&self) -> &ControlTask<'static, MotorPair<Wire, Wire, Wire>> {
        self.halves.0.server().task()
    }

    /// Commanded speed \[m/s\].
    fn command(&self) -> f32 {
        let motion = self.task().report().motion;
        motion.map_or(0.0, |motion| motion.command.linear)
    }

    fn outputs(&self) -> [u16; 3] {
        self.wires.clone().map(|wire| wire.0.get())
    }

    /// A trajectory of a second, straight on at 0.2 m/s.
    fn send_trajectory(&mut self) {
        for at in 0..20 {
            let t = at as f32 * 0.05;
            let reference = Reference::new(
                Pose::new(0.2 * t, 0.0, 0.0),
                Twist::new(0.2, 0.0),
                Accel::default(),
            );
            self.send(&Command::Sample((&TimedReference { t, reference }).into()));
        }
    }
}

#[test]
fn outputs_are_off_from_the_start_until_armed() {
    let mut board = Board::new();
    assert_eq!(board.outputs(), [0; 3]);
    board.send_trajectory();
    for _ in 0..500 {
        board.send(&Command::Heartbeat);
        board.tick();
        assert_eq!(board.outputs(), [0; 3]);
    }
}

#[test]
fn an_armed_board_drives_and_a_silent_host_stops_it() {
    let mut board = Board::new();
    board.tick();
    board.send(&Command::Arm);
    board.tick();
    assert_eq!(board.outputs(), [1, 0, 0], "armed, and no torque applied");
    board.send_trajectory();
    for _ in 0..200 {
        board.send(&Command::Heartbeat);
        board.tick();
    }
    let [enable, right, left] = board.outputs();
    assert!(
        enable == 1 && right > 0 && left > 0,
        "{:?}",
        board.outputs()
    );
    let speed = board.world.speed_rad_s.get();
    assert!(speed > 1.5, "{speed} rad/s");
    // 100 ms after the last frame of the host, and one tick, the stop has begun.
    let mut last = *board.task().report();
    let mut begin = None;
    for tick in 1..=102 {
        let before = *board.task().report();
        board.tick();
        match board.task().state() {
            State::Tracking => assert_eq!(begin, None),
            State::Stopping(Then::Stopped) if begin.is_none() => {
                (begin, last) = (Some(tick), before)
            }
            State::Stopping(Then::Stopped) => {}
            other => panic!("{other:?} after {tick} ticks"),
        }
    }
    let begin = begin.expect("stopping after 102 silent ticks");
    assert_eq!(board.task().cause(), Cause::LinkLost);
    let task = board.task();
    let law = task.controller().base().motion();
    let gains = law.gains();
    let motion = last.motion.expect("it was driving");
    let (rate, error) = (motion.command_rate.linear, motion.velocity_error.linear);
    // It follows the trajectory no more: the acceleration a under way fades as a (1 - A t) e^(-A t), which makes it faster
    // by a t e^(-A t), at most by a/(e A). A tick of 1 ms at a is what ticks may differ by from that.
    let fading = |t: f32| rate.abs() * t * (-gains.decay * t).exp();
    let fastest = motion.command.linear + fading(1.0 / gains.decay) + 1.0e-3 * rate.abs();
    // With the plan at its end, what is left is that and the velocity error, which fades as e^(-kappa t). Rest is believed
    // below a speed, less the half count that encoders are off times the bandwidth of the estimate.
    let plan = StopPlan::new::<Single>(law, &motion.command, &motion.command_rate);
    let bound = controlled_stop::<f32, Single>(
        law,
        &motion.command,
        &motion.command_rate,
        &motion.velocity_error,
    );
    let rest = task.params().supervisor.rest;
    let odometry = robot::BASE.localiser.odometry;
    let count_m = TAU * odometry.wheels.radius_right_m / odometry.counts_per_turn;
    let slow = rest.speed_m_s - 0.5 * count_m * odometry.bandwidth;
    let from_ms = (plan.duration_s() * 1.0e3) as u32;
    let rests_ms = (from_ms..(bound.time_s * 1.0e3) as u32)
        .find(|&ms| {
            let t = ms as f32 * 1.0e-3;
            fading(t) + error.abs() * (-gains.speed_loop * t).exp() < slow
        })
        .expect("it rests within the bound of the core");
    // The dwell, the tick after which the plan begins, and the one in which rest is seen.
    let within = rests_ms + rest.dwell_us / 1000 + 2;
    let mut took = 102 - begin;
    while board.task().state() != State::Stopped {
        board.tick();
        took += 1;
        assert!(took <= within, "{took} ticks, {within} allowed");
        assert!(board.command() <= fastest);
    }
    println!("begins in tick {begin} of 102, rests {took} ticks later of {within}");
    assert!(board.world.speed_rad_s.get().abs() < 0.1 * speed);
    assert_eq!(board.outputs(), [0; 3], "the host is gone");
    for _ in 0..100 {
        board.send(&Command::Heartbeat);
        board.tick();
        assert_eq!(
            board.outputs(),
            [0; 3],
            "a host that comes back does not drive on"
        );
    }
}

#[test]
fn the_button_shorts_the_motors_in_the_next_tick() {
    let mut board = Board::driving();
    board.send(&Command::EmergencyStop { brake: true });
    board.tick();
    assert_eq!(
        board.outputs(),
        [1, 0, 0],
        "shorted by the bridges' low phase"
    );
}

/// What step 7 of the boards' bring-up says.
#[test]
fn an_unplugged_encoder_shorts_the_motors_until_a_reset() {
    for (speed, within_ms) in [(0.3, 600), (0.05, 1300)] {
        let mut board = Board::new();
        board.tick();
        board.send(&Command::Arm);
        board.tick();
        let drive = Command::Drive {
            twist: (&Twist::new(speed, 0.0)).into(),
            hold_heading: false,
        };
        let drive_on = |board: &mut Board| {
            board.send(&drive);
            board.tick();
        };
        for _ in 0..2000 {
            drive_on(&mut board);
        }
        assert_eq!(board.task().state(), State::Tracking);
        let world = &board.world;
        world.unplugged.set(Some(world.counts.get() as i32));
        let mut took_ms = 0;
        while board.task().state() == State::Tracking {
            drive_on(&mut board);
            took_ms += 1;
            assert!(took_ms <= within_ms, "{speed} m/s");
        }
        println!("{speed} m/s: after {took_ms} ms");
        let cause = Cause::Fault(Fault::EncoderStuck(Side::Left));
        assert_eq!(board.task().cause(), cause);
        for _ in 0..8000 {
            assert_eq!(board.outputs(), [1, 0, 0], "shorted");
            board.send(&Command::Heartbeat);
            board.tick();
        }
        assert_eq!(board.task().state(), State::Fault);
        board.send(&Command::Arm);
        board.tick();
        assert_eq!(board.outputs(), [1, 0, 0], "latched");
        board.send(&Command::ResetFault);
        board.tick();
        assert_eq!(board.outputs(), [0; 3]);
    }
}

/// Measured or not, a supply acts on duties and is watched; the wheels of this board are on 12 V whatever is said.
#[test]
fn a_low_supply_stops_the_base_where_it_is_measured() {
    let duty = |supply_v| {
        let mut board = Board::driving();
        board.world.supply_v.set(supply_v);
        board.send(&Command::Heartbeat);
        board.tick();
        let [_, right, _] = board.outputs();
        f32::from(right)
    };
    let nominal = duty(None);
    assert_eq!(duty(Some(12.0)), nominal);
    assert!((duty(Some(10.0)) - nominal * 1.2).abs() <= 1.0);

    for (supply_v, state) in [
        (None, State::Tracking),
        (Some(8.0), State::Stopping(Then::Fault)),
    ] {
        let mut board = Board::driving();
        board.world.supply_v.set(supply_v);
        for _ in 0..510 {
            board.send(&Command::Heartbeat);
            board.tick();
        }
        assert_eq!(board.task().state(), state);
        if supply_v.is_some() {
            assert_eq!(board.task().cause(), Cause::Fault(Fault::UnderVoltage));
        }
    }
}

/// 921,600 baud: bytes that the line carries each way in a tick, rounded down.
const BYTES_A_TICK: usize = 92;

/// The line is full with questions whose answers are longer, and the host reads them, or does not.
#[test]
fn a_flood_of_questions_delays_no_stop() {
    for reads in [true, false] {
        let mut board = Board::driving();
        assert_eq!(board.task().state(), State::Tracking);
        let questions: Vec<u8> = [Command::GetCounters, Command::GetParameters]
            .iter()
            .flat_map(frame)
            .collect();
        let stop = frame(&Command::Stop);
        for tick in 0..100 {
            let flood = questions.iter().cycle();
            let last = tick == 99;
            // The stop comes with the last bytes of its tick, behind a delimiter.
            let ending: &[u8] = if last { &stop } else { &[] };
            let bytes = flood.take(BYTES_A_TICK - ending.len() - 1);
            for &byte in bytes.chain(&[0]).chain(ending) {
                board.received.push(byte);
                let mut room = reads;
                board
                    .halves
                    .1
                    .poll(&board.received, |_| std::mem::take(&mut room));
            }
            board.world.now_us.set(board.world.now_us.get() + 1000);
            board.halves.0.tick();
        }
        assert_eq!(board.received.lost(), 0);
        assert_eq!(board.task().state(), State::Stopping(Then::Stopped));
        assert_eq!(board.task().cause(), Cause::Host);
    }
}

/// A board begins with what its memory holds, and disarmed as ever.
#[test]
fn stored_parameters_are_in_force_from_power_on() {
    let mut stored = FieldParams::from(&robot::BASE);
    stored.limits.speed *= 0.5;
    let mut memory = Slots::new(RamFlash::default());
    memory.save(&stored).expect("room");
    let mut board = Board::with_memory(memory);
    board.tick();
    assert_eq!(board.outputs(), [0; 3]);
    let speed = board.task().params().motion.limits.speed;
    assert_eq!(speed, 0.5 * robot::BASE.motion.limits.speed);
}

fn frame(command: &Command) -> Vec<u8> {
    let mut frame = [0; MAX_FRAME];
    encode(1, command, &mut frame).expect("a frame").to_vec()
}
