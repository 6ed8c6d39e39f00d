//! A whole base: encoder counts go in, a wheel action comes out, and the supervisor says what it is at.

mod plant;

use controller_core::hal::WheelCounts;
use controller_core::localiser::LocaliserParams;
use controller_core::motor::DriverParams;
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::safety::supervisor::{Event, State};
use controller_core::{BaseController, BaseParams, Order, Pose, Robot, Sensed};
use plant::{LIMITS, Plant};

const TICK_US: u32 = 10_000;
const COUNTS_PER_TURN: f32 = 4096.0;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let robot = Robot::paper();
    // Odometry alone; with poses from outside, `fusion` says how good those are.
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
    let mut plant = Plant::new(robot)?;
    // Angles of the wheels [rad].
    let (mut right, mut left) = (0.0, 0.0);
    let mut state = None;
    for tick in 0..3000_u32 {
        let counts = |angle: f32| (angle * COUNTS_PER_TURN / core::f32::consts::TAU).round() as i32;
        let sensed = Sensed::of_counts(WheelCounts {
            right: counts(right),
            left: counts(left),
        });
        // The host: arm after 0.1 s, then park. It repeats its order, for its silence is a fault.
        if tick == 10 {
            controller.on(Event::Arm);
        }
        let order = match tick {
            0..10 => Order::None,
            _ => Order::Park(Pose::new(2.0, -0.5, 0.5)),
        };
        let report = *controller.tick(TICK_US, &order, &sensed);
        if state != Some(report.state) {
            println!("{:6.2} s  {:?}", 0.01 * tick as f32, report.state);
            state = Some(report.state);
        }
        if report.state == State::Parked {
            let Pose { x, y, theta } = plant.measured.pose;
            println!(
                "{:6.2} s  really at x {x:.4} m, y {y:.4} m, heading {theta:.4} rad",
                0.01 * tick as f32
            );
            return Ok(());
        }
        plant.advance(&report.action.torques().unwrap_or_default(), 0.01);
        let speeds = plant.wheel_speeds();
        right += 0.01 * speeds.right;
        left += 0.01 * speeds.left;
    }
    Err("not parked within 30 s".into())
}

#[test]
fn it_parks() {
    main().expect("parked");
}
