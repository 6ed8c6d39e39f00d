//! Motor drivers that close their own speed loop: the default law's command goes out as wheel speeds, led by the
//! drivers' lag. Here the drivers are a first-order lag in memory; on a board they are on a bus.

#[allow(dead_code)] // Only its limits are used here.
mod plant;

use controller_core::hal::{Error as _, ErrorKind, ErrorType, WheelSpeedDrive};
use controller_core::maths::Single;
use controller_core::motor::{SpeedParams, SpeedState};
use controller_core::robot::pose_rate;
use controller_core::types::{Twist, WheelSpeeds};
use controller_core::{
    Limits, Measured, MotionController, MotionParams, Outcome, Pose, Robot, Task,
};
use plant::LIMITS;

const TICK_S: f32 = 0.01;
/// Of the drivers' speed loop \[s\].
const LAG_S: f32 = 0.03;
const MAX_SPEED_RAD_S: f32 = 15.0;

/// Both drivers.
#[derive(Default)]
struct Drivers {
    commanded: WheelSpeeds,
    speeds: WheelSpeeds,
}

impl Drivers {
    /// `dt` \[s\] with the commanded speeds.
    fn advance(&mut self, dt: f32) {
        let share = dt / (LAG_S + dt);
        self.speeds.right += share * (self.commanded.right - self.speeds.right);
        self.speeds.left += share * (self.commanded.left - self.speeds.left);
    }
}

impl ErrorType for Drivers {
    type Error = ErrorKind;
}

impl WheelSpeedDrive for Drivers {
    fn max_speed_rad_s(&self) -> f32 {
        MAX_SPEED_RAD_S
    }

    fn set_speeds(&mut self, speeds: WheelSpeeds) -> Result<(), ErrorKind> {
        let within = |speed: f32| speed.abs() <= MAX_SPEED_RAD_S;
        if !(within(speeds.right) && within(speeds.left)) {
            return Err(ErrorKind::OutOfRange);
        }
        self.commanded = speeds;
        Ok(())
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        self.set_speeds(WheelSpeeds::default())
    }

    fn brake(&mut self) -> Result<(), ErrorKind> {
        self.release()
    }
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // Torques stay inside the drivers: a torque limit far above what the base needs, so that it sets no command back.
    let limits = Limits {
        wheel_torque_nm: 100.0,
        ..LIMITS
    };
    let motion = MotionParams::new(Robot::paper(), limits).validate()?;
    let output = SpeedParams {
        max_speed_rad_s: MAX_SPEED_RAD_S,
        min_speed_rad_s: 0.0,
        lag_s: LAG_S,
        breakaway_nm: 0.0,
    }
    .validate()?;
    let (mut drivers, mut state) = (Drivers::default(), SpeedState::default());
    let mut measured = Measured::default();
    let goal = Task::Park(Pose::new(1.5, 0.5, 0.0));
    let mut controller: MotionController = MotionController::start(&motion, &goal, &measured)?;
    for tick in 0..3000 {
        let report = *controller.step(TICK_S, &goal, &measured)?;
        // Nobody knows what the drivers exert: the disturbance is theirs to reject.
        controller.note_not_driven();
        if report.outcome == Outcome::Parked {
            let Pose { x, y, theta } = measured.pose;
            let t = tick as f32 * TICK_S;
            println!("parked after {t:.2} s at x {x:.4} m, y {y:.4} m, heading {theta:.4} rad");
            drivers
                .release()
                .map_err(|error| error.kind().to_string())?;
            return Ok(());
        }
        let wheels = motion.wheels();
        let command = output.command(&mut state, wheels, &report.command, &report.command_rate)?;
        drivers
            .set_speeds(command.speeds)
            .map_err(|error| error.kind().to_string())?;
        drivers.advance(TICK_S);
        let (v, w) = (robot_speed(&drivers.speeds), robot_turn(&drivers.speeds));
        let twist = Twist::new(v, w);
        let rate = pose_rate::<f32, Single>(&measured.pose, &twist);
        measured.pose.x += TICK_S * rate.x;
        measured.pose.y += TICK_S * rate.y;
        measured.pose.theta += TICK_S * rate.theta;
        measured.twist = twist;
    }
    Err("not parked within 30 s".into())
}

/// Wheels of 0.1 m.
fn robot_speed(speeds: &WheelSpeeds) -> f32 {
    0.05 * (speeds.right + speeds.left)
}

/// 0.5 m apart.
fn robot_turn(speeds: &WheelSpeeds) -> f32 {
    0.2 * (speeds.right - speeds.left)
}

#[test]
fn it_parks() {
    main().expect("parked");
}
