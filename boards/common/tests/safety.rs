//! A board made of memory: nothing is driven before the host has armed it, and nothing once the host is gone.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use board_common::{
    Bytes, Clock, ErrorType, Halves, MotorSide, Parts, Queues, WheelCounts, WheelEncoders, start,
};
use controller_core::maths::Single;
use controller_core::queue::TimedReference;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use firmware_demo::protocol::{Command, MAX_FRAME, encode};

/// Gear times torque constant of the configuration \[V s\].
const GEARED: f32 = 30.0 * 0.0085;

/// One wire, seen from both of its ends.
#[derive(Clone, Default)]
struct Wire(Rc<Cell<u16>>);

impl digital::ErrorType for Wire {
    type Error = Infallible;
}

impl OutputPin for Wire {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(0);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(1);
        Ok(())
    }
}

impl pwm::ErrorType for Wire {
    type Error = Infallible;
}

impl SetDutyCycle for Wire {
    fn max_duty_cycle(&self) -> u16 {
        1000
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.set(duty);
        Ok(())
    }
}

/// A clock, and counts that follow the duty.
#[derive(Clone, Default)]
struct World {
    now_us: Rc<Cell<u32>>,
    /// Of both wheels.
    counts: Rc<Cell<f32>>,
    speed_rad_s: Rc<Cell<f32>>,
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
            left: turned,
        })
    }
}

struct Board {
    halves: Halves<'static, Wire, Wire, Wire, World, World>,
    wires: [Wire; 3],
    backward: Wire,
    world: World,
    received: Bytes,
    sequence: u16,
}

impl Board {
    /// All outputs begin high, as if something had gone wrong before.
    fn new() -> Self {
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
            clock: world.clone(),
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
        counts.set(counts.get() + 1.0e-3 * speed * 1920.0 / core::f32::consts::TAU);
        self.halves.0.tick();
        self.halves.1.poll(&self.received, |_| true);
    }

    fn outputs(&self) -> [u16; 3] {
        self.wires.clone().map(|wire| wire.0.get())
    }

    /// A trajectory of a second, straight on at 0.2 m/s.
    fn send_trajectory(&mut self) {
        for at in 0..20 {
            let t = at as f32 * 0.05;
            let reference = Reference::new::<Single>(
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
    assert_eq!(board.outputs(), [1, 0, 0], "armed, and told no torque");
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
    // 100 ms of silence, 0.2 s of braking by the plan, and a tail of the speed loop's 3/s until 1 cm/s are rest.
    for _ in 0..1000 {
        board.tick();
    }
    assert!(speed > 1.5 && board.world.speed_rad_s.get().abs() < 0.1 * speed);
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
    let mut board = Board::new();
    board.tick();
    board.send(&Command::Arm);
    board.tick();
    board.send_trajectory();
    for _ in 0..200 {
        board.send(&Command::Heartbeat);
        board.tick();
    }
    board.send(&Command::EmergencyStop { brake: true });
    board.tick();
    assert_eq!(
        board.outputs(),
        [1, 0, 0],
        "shorted by the bridges' low phase"
    );
}
