//! Speed from rare counts, and what it does to the torques.

use controller_core::hal::WheelCounts;
use controller_core::maths::Libm;
use controller_core::motion::{MotionController, Task};
use controller_core::odometry::Odometry;
use controller_core::shunting::ExactMean;
use controller_core::types::{Accel, Pose};
use sim_host::drive::Base as File;
use std::f64::consts::PI;
use tests::check::assert_within;
use tests::encoded::{COUNTS, Encoded, bases, motion, odometry};
use tests::motion_loop::{Order, steady};

type Controller = MotionController<f64, Libm, ExactMean>;

/// Follows `order` for `end_s` from rest on odometry alone, told of its accelerations or not; calls
/// `see` with the time, the torques and the estimated speed.
fn drive(
    file: &File,
    (bandwidth, told): (f64, bool),
    dt: f64,
    end_s: f64,
    order: impl Fn(f64) -> Order,
    mut see: impl FnMut(f64, (f64, f64), &Encoded, f64),
) {
    let motion = motion(file).validate().expect("valid");
    let mut robot = Encoded::new(file, Pose::default());
    let params = odometry::<f64>(file, bandwidth);
    let mut odometry = Odometry::new(&params, robot.body.pose, robot.counts()).expect("in range");
    let mut controller =
        Controller::start(&motion, &order(0.0), &robot.body.measured()).expect("starts");
    for k in 1..=(end_s / dt) as u32 {
        let t = f64::from(k) * dt;
        let torques = controller.report().torques;
        robot.advance(&torques, dt);
        let wrench = motion.wheels().wrench(&torques);
        let accel = if told {
            Accel::new(
                wrench.force / file.robot.mass_kg,
                wrench.moment / file.robot.inertia_kg_m2,
            )
        } else {
            Accel::default()
        };
        let measured = odometry.update_with_accel::<Libm>(robot.counts(), dt, &accel);
        let report = controller.step(dt, &order(t), &measured).expect("accepted");
        let torques = report.torques;
        see(
            t,
            (torques.right, torques.left),
            &robot,
            measured.twist.linear,
        );
    }
}

/// Half the range of a wheel's torque over its limit.
#[derive(Clone, Copy)]
struct Range(f64, f64);

impl Range {
    const NONE: Self = Self(f64::INFINITY, f64::NEG_INFINITY);
    fn add(&mut self, value: f64) {
        *self = Self(self.0.min(value), self.1.max(value));
    }
    fn half(&self) -> f64 {
        0.5 * (self.1 - self.0)
    }
}

/// A count in 20 ticks, straight and turning in place: the torque ripple is below 1 % of the limit.
#[test]
fn creeping_does_not_make_the_torque_rattle() {
    for (name, file) in bases() {
        for dt in [0.01, 0.005] {
            for (bandwidth, told) in [(50.0, false), (100.0, false), (50.0, true), (20.0, true)] {
                let q = 2.0 * PI * file.robot.wheels.radius_right_m / COUNTS;
                let speed = q / (20.0 * dt);
                let rate = 2.0 * speed / file.robot.wheels.track_m;
                let mut worst = [0.0, 0.0];
                for (ripple, order) in worst
                    .iter_mut()
                    .zip([steady(speed, 0.0), steady(0.0, rate)])
                {
                    let (mut right, mut left) = (Range::NONE, Range::NONE);
                    drive(
                        &file,
                        (bandwidth, told),
                        dt,
                        12.0,
                        order,
                        |t, torques, _, _| {
                            if t > 6.0 {
                                right.add(torques.0);
                                left.add(torques.1);
                            }
                        },
                    );
                    *ripple = right.half().max(left.half()) / file.limits.wheel_torque_nm;
                }
                println!(
                    "{name} {} ms, {bandwidth} rad/s, told {told}: ripple {:.3} % straight, {:.3} % turning",
                    1e3 * dt,
                    100.0 * worst[0],
                    100.0 * worst[1]
                );
            }
        }
    }
}

/// Open loop: at a steady creep the ripple of the estimate dies out; a difference quotient has 20 times the speed.
#[test]
fn steady_creep_is_read_without_ripple() {
    let (_, file) = bases()[2].clone();
    for ticks in [1.3, 3.7, 20.0, 20.6] {
        for dt in [0.01, 0.005, 0.001] {
            let params = odometry::<f64>(&file, 50.0);
            let q = params.travel_per_count_m();
            let mut odometry =
                Odometry::new(&params, Pose::default(), WheelCounts::default()).expect("in range");
            let mut range = Range::NONE;
            let (mut sum, mut n) = (0.0, 0.0);
            for k in 1..=4000 {
                let count = (f64::from(k) / ticks).floor() as i32;
                let now = WheelCounts {
                    right: count,
                    left: count,
                };
                let v = odometry.update::<Libm>(now, dt).twist.linear;
                if k > 2000 {
                    range.add(v);
                    sum += v;
                    n += 1.0;
                }
            }
            let speed = q / (ticks * dt);
            println!(
                "{ticks} ticks of {dt} s: {:.4} mm/s +- {:.4}, mean {:.4}",
                1e3 * speed,
                1e3 * range.half(),
                1e3 * sum / n
            );
            assert_within(sum / n, speed, 0.02 * speed, "mean");
        }
    }
}
