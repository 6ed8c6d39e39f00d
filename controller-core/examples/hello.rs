//! A first program: park one metre ahead and half a metre to the left.

mod plant;

use controller_core::{MotionController, MotionParams, Outcome, Pose, Robot, Task};
use plant::{LIMITS, Plant};

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let motion = MotionParams::new(Robot::paper(), LIMITS).validate()?;
    let mut robot = Plant::new(Robot::paper())?;
    let task = Task::Park(Pose::new(1.0, 0.5, 0.0));
    let mut controller: MotionController =
        MotionController::start(&motion, &task, &robot.measured)?;
    for tick in 0..2000 {
        let report = controller.step(0.01, &task, &robot.measured)?;
        if report.outcome == Outcome::Parked {
            let Pose { x, y, theta } = robot.measured.pose;
            println!(
                "parked after {:.2} s at x {x:.4} m, y {y:.4} m, heading {theta:.4} rad",
                0.01 * tick as f32
            );
            return Ok(());
        }
        robot.advance(&report.torques, 0.01);
    }
    Err("not parked within 20 s".into())
}

#[test]
fn it_parks() {
    main().expect("parked");
}
