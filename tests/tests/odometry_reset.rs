//! A pose that is set while the robot drives.

use controller_core::maths::Libm;
use controller_core::motion::MotionController;
use controller_core::odometry::Odometry;
use controller_core::shunting::ExactMean;
use controller_core::types::Pose;
use tests::encoded::{Encoded, bases, odometry};
use tests::ideal::Loop;
use tests::motion_loop::{Order, steady};

type Controller = MotionController<f64, Libm, ExactMean>;

/// A new pose in the middle of a curve and of parking: the twist carries on, and with the jump declared
/// force and moment change by no more than L dt.
#[test]
fn a_reset_pose_does_not_jump_the_torque() {
    for (name, file) in bases() {
        let motion = file.motion().validate().expect("valid");
        for order in [
            steady(0.4, 0.15)(0.0),
            Order::Park(Pose::new(1.5, 0.4, 0.3)),
        ] {
            let dt = 0.01;
            let robot = Encoded::new(&file, Pose::default());
            let start = robot.body.pose;
            let mut odometry =
                Odometry::new(&odometry::<f64>(&file, 50.0), start, robot.counts()).expect("valid");
            let path = steady(0.4, 0.15);
            let now = |t: f64| {
                if let Order::Park(_) = order {
                    order
                } else {
                    path(t)
                }
            };
            let controller =
                Controller::start(&motion, &now(0.0), &robot.body.measured()).expect("starts");
            let mut drive = Loop::new(controller, robot, Encoded::plant(&file), dt);
            let mut last = motion.wheels().wrench(&controller.report().torques);
            let (mut most, mut twist, mut stepped) = (0.0_f64, Default::default(), 0.0_f64);
            for k in 1..=400 {
                let torques = drive.controller.report().torques;
                drive.hold(&torques);
                if k == 100 {
                    odometry.set_pose(Pose::new(0.1, 0.3, -0.4));
                    drive.controller.declare_jump();
                }
                let accel = drive.controller.report().command_rate;
                let measured = odometry.update_with_accel::<Libm>(drive.body.counts(), dt, &accel);
                if k == 100 {
                    let before: controller_core::types::Twist<f64> = twist;
                    stepped = (measured.twist.linear - before.linear).abs();
                }
                twist = measured.twist;
                drive
                    .controller
                    .step(dt, &now(drive.t), &measured)
                    .expect("accepted");
                let wrench = motion.wheels().wrench(&drive.controller.report().torques);
                if !drive.controller.report().limited.torque {
                    most = most
                        .max((wrench.force - last.force).abs() / (motion.force_rate_limit() * dt))
                        .max(
                            (wrench.moment - last.moment).abs() / (motion.moment_rate_limit() * dt),
                        );
                }
                last = wrench;
            }
            println!("{name}: {most:.3} of L dt, twist {stepped:.4} m/s");
            assert!(most <= 1.0, "{name}: {most}");
            // A tick of the largest acceleration.
            assert!(stepped <= file.limits.accel.max(file.limits.brake) * dt * 1.2);
        }
    }
}
