//! Park forward, then backward, then at a goal that changes on the way: three goals, one controller.

mod plant;

use controller_core::{MotionController, MotionParams, Outcome, Pose, Robot, Task};
use plant::{LIMITS, Plant};

const TICK_S: f32 = 0.01;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let motion = MotionParams::new(Robot::paper(), LIMITS).validate()?;
    let mut robot = Plant::new(Robot::paper())?;
    // A goal, and after how many ticks another one takes its place, if it has not been reached.
    let goals = [
        (Pose::new(2.0, 0.5, 0.0), u32::MAX),
        (Pose::new(0.5, 0.0, 0.0), u32::MAX),
        (Pose::new(3.0, 1.0, 1.0), 150),
        (Pose::new(1.0, 1.5, 3.0), u32::MAX),
    ];
    let first = Task::Park(goals[0].0);
    let mut controller: MotionController =
        MotionController::start(&motion, &first, &robot.measured)?;
    for (goal, leave_after) in goals {
        let mut ticks = 0;
        let mut backed = false;
        let outcome = loop {
            let report = controller.step(TICK_S, &Task::Park(goal), &robot.measured)?;
            backed |= report.backing;
            if report.outcome != Outcome::Driving || ticks == leave_after {
                break report.outcome;
            }
            if ticks == 3000 {
                return Err("no outcome within 30 s".into());
            }
            robot.advance(&report.torques, TICK_S);
            ticks += 1;
        };
        let error = &controller.report().error;
        println!(
            "({:.1}, {:.1}, {:.1}): {outcome:?} after {:5.2} s, {:.4} m and {:.4} rad off{}",
            goal.x,
            goal.y,
            goal.theta,
            ticks as f32 * TICK_S,
            error.x.hypot(error.y),
            error.theta.abs(),
            if backed { ", backed up" } else { "" },
        );
        if leave_after == u32::MAX && outcome != Outcome::Parked {
            return Err("a goal was not reached".into());
        }
    }
    Ok(())
}

#[test]
fn it_parks_at_every_goal_that_is_kept() {
    main().expect("parked");
}
