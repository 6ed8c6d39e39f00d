//! A HAL of your own: wheels, encoders and a clock behind the traits of `controller_core::hal`, and the
//! loop that any board runs. Here the hardware is a robot in memory; on a board it is timers and a bridge.

mod plant;

use controller_core::hal::{
    Clock, Error as _, ErrorKind, ErrorType, WheelCounts, WheelDrive, WheelEncoders, accepts,
};
use controller_core::localiser::LocaliserParams;
use controller_core::motor::DriverParams;
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::safety::supervisor::{Event, State};
use controller_core::{BaseController, BaseParams, Order, Pose, Robot, Sensed, WheelTorques};
use plant::{LIMITS, Plant};

const TICK_US: u32 = 10_000;
const COUNTS_PER_TURN: f32 = 4096.0;

/// The hardware.
struct Board {
    plant: Plant,
    torques: WheelTorques,
    /// Angles of the wheels \[rad\].
    angles: (f32, f32),
    now_us: u32,
}

impl Board {
    /// Until the next tick; a board sleeps here.
    fn wait(&mut self) {
        let dt = TICK_US as f32 * 1.0e-6;
        self.plant.advance(&self.torques, dt);
        let speeds = self.plant.wheel_speeds();
        self.angles.0 += dt * speeds.right;
        self.angles.1 += dt * speeds.left;
        self.now_us = self.now_us.wrapping_add(TICK_US);
    }
}

impl ErrorType for Board {
    type Error = ErrorKind;
}

impl WheelDrive for Board {
    fn max_torque_nm(&self) -> f32 {
        LIMITS.wheel_torque_nm
    }

    fn set_torques(&mut self, torques: WheelTorques) -> Result<(), ErrorKind> {
        if !accepts(&torques, self.max_torque_nm()) {
            return Err(ErrorKind::OutOfRange);
        }
        self.torques = torques;
        Ok(())
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        self.torques = WheelTorques::default();
        Ok(())
    }

    /// This bridge cannot short its motors: it releases.
    fn brake(&mut self) -> Result<(), ErrorKind> {
        self.release()
    }
}

impl WheelEncoders for Board {
    fn counts(&mut self) -> Result<WheelCounts, ErrorKind> {
        let counts = |angle: f32| (angle * COUNTS_PER_TURN / core::f32::consts::TAU).round() as i32;
        Ok(WheelCounts {
            right: counts(self.angles.0),
            left: counts(self.angles.1),
        })
    }
}

impl Clock for Board {
    fn now_us(&self) -> u32 {
        self.now_us
    }
}

/// One tick on any hardware: read, decide, carry out. What the driver answers is input of the next tick.
fn tick<H: WheelDrive + WheelEncoders + Clock>(
    board: &mut H,
    controller: &mut BaseController,
    order: &Order,
    last: &mut (u32, Result<(), ErrorKind>),
) -> State {
    let now = board.now_us();
    let sensed = Sensed {
        driver: last.1,
        counts: board.counts().map_err(|error| error.kind()),
        ..Sensed::of_counts(WheelCounts::default())
    };
    let state = controller
        .tick(now.wrapping_sub(last.0), order, &sensed)
        .state;
    *last = (now, controller.apply(board, sensed.supply_v));
    state
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let robot = Robot::paper();
    let localiser = LocaliserParams {
        odometry: OdometryParams {
            wheels: robot.wheels,
            calibration: Calibration::NOMINAL,
            counts_per_turn: COUNTS_PER_TURN,
            bandwidth: 50.0,
        },
        fusion: None,
        gyro: None,
    };
    let base =
        BaseParams::new(robot, LIMITS, localiser, DriverParams::Torques, TICK_US)?.validate()?;
    let mut controller: BaseController = BaseController::new(&base, Pose::default());
    let mut board = Board {
        plant: Plant::new(robot)?,
        torques: WheelTorques::default(),
        angles: (0.0, 0.0),
        now_us: 0,
    };
    let mut last = (board.now_us(), Ok(()));
    board.wait();
    tick(&mut board, &mut controller, &Order::None, &mut last);
    controller.on(Event::Arm);
    // Repeated at every tick, for a silent host is a fault.
    let order = Order::Park(Pose::new(1.0, 0.3, 0.0));
    while board.now_us() < 30_000_000 {
        board.wait();
        if tick(&mut board, &mut controller, &order, &mut last) == State::Parked {
            let Pose { x, y, theta } = board.plant.measured.pose;
            let t = f64::from(board.now_us()) * 1.0e-6;
            println!("parked after {t:.2} s at x {x:.4} m, y {y:.4} m, heading {theta:.4} rad");
            return Ok(());
        }
    }
    Err("not parked within 30 s".into())
}

#[test]
fn it_parks() {
    main().expect("parked");
}
