//! Follow a circle of 1 m at 0.5 m/s, from a start 0.3 m outside of it and at rest.

mod plant;

use controller_core::types::Accel;
use controller_core::{MotionController, MotionParams, Pose, Reference, Robot, Task, Twist};
use core::f32::consts::FRAC_PI_2;
use plant::{LIMITS, Plant};

const TICK_S: f32 = 0.01;

/// The reference at time `t` \[s\]: pose, twist and its rate, which is 0.
fn circle(t: f32) -> Reference {
    let turn_rate = 0.5;
    let angle = turn_rate * t;
    let pose = Pose::new(angle.cos(), angle.sin(), angle + FRAC_PI_2);
    Reference::new(pose, Twist::new(0.5, turn_rate), Accel::default())
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let motion = MotionParams::new(Robot::paper(), LIMITS).validate()?;
    let mut robot = Plant::new(Robot::paper())?;
    robot.measured.pose = Pose::new(1.3, 0.0, FRAC_PI_2);
    let task = Task::Follow(circle(0.0));
    let mut controller: MotionController =
        MotionController::start(&motion, &task, &robot.measured)?;
    println!("   t s    e_x m    e_y m  e_θ rad  right N m  left N m");
    let mut last_error = f32::INFINITY;
    for tick in 1..=1500_u16 {
        let t = f32::from(tick) * TICK_S;
        robot.advance(&controller.report().torques, TICK_S);
        let report = controller.step(TICK_S, &Task::Follow(circle(t)), &robot.measured)?;
        let (error, torques) = (&report.error, &report.torques);
        last_error = error.x.hypot(error.y);
        if tick % 100 == 0 {
            println!(
                "{t:6.1} {:8.4} {:8.4} {:8.4} {:10.3} {:9.3}",
                error.x, error.y, error.theta, torques.right, torques.left
            );
        }
    }
    if last_error < 1.0e-3 {
        Ok(())
    } else {
        Err("still more than 1 mm off after 15 s".into())
    }
}

#[test]
fn it_is_on_the_circle_in_the_end() {
    main().expect("on the circle");
}
