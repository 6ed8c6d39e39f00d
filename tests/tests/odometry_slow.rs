//! Speed from rare counts, and what it does to the torques.

use controller_core::hal::WheelCounts;
use controller_core::maths::Libm;
use controller_core::motion::{MotionController, MotionParams};
use controller_core::odometry::Odometry;
use controller_core::shunting::ExactMean;
use controller_core::types::{Accel, Pose};
use sim_host::mission::BaseSpec as File;
use std::f64::consts::PI;
use tests::check::assert_within;
use tests::encoded::{COUNTS, Encoded, bases, odometry};
use tests::ideal::Loop;
use tests::localised;
use tests::motion_loop::{Order, steady};

type Controller = MotionController<f64, Libm, ExactMean>;

/// Follows `order` for `end_s` from rest on odometry alone, given its accelerations or not; calls
/// `see` with the time and the torques.
fn drive(
    file: &File,
    (bandwidth, informed): (f64, bool),
    dt: f64,
    end_s: f64,
    order: impl Fn(f64) -> Order,
    mut see: impl FnMut(f64, (f64, f64)),
) {
    // Nobody ships a base whose odometry is not given them; its loops are those that follow from the limits.
    let params = if informed {
        file.motion()
    } else {
        MotionParams::new_with::<Libm>(file.robot, file.limits)
    };
    let motion = params.validate().expect("valid");
    let robot = Encoded::new(file, Pose::default());
    let params = odometry::<f64>(file, bandwidth);
    let mut odometry = Odometry::new(&params, robot.body.pose, robot.counts()).expect("in range");
    let controller =
        Controller::start(&motion, &order(0.0), &robot.body.measured()).expect("starts");
    let mut drive = Loop::new(controller, robot, Encoded::plant(file), dt);
    for _ in 1..=(end_s / dt) as u32 {
        let torques = drive.controller.report().torques;
        drive.hold(&torques);
        let accel = if informed {
            localised::expected_accel(&motion, &torques)
        } else {
            Accel::default()
        };
        let counts = drive.body.counts();
        let measured = odometry.update_with_accel::<Libm>(counts, dt, &accel);
        let report = drive.controller.step(dt, &order(drive.t), &measured);
        let torques = report.expect("accepted").torques;
        see(drive.t, (torques.right, torques.left));
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

/// A count in 20 ticks, straight and turning in place, half the range of either wheel's torque over
/// its limit.
fn ripple(file: &File, speed_loop: (f64, bool), dt: f64) -> [f64; 2] {
    let q = 2.0 * PI * file.robot.wheels.radius_right_m / COUNTS;
    let speed = q / (20.0 * dt);
    let rate = 2.0 * speed / file.robot.wheels.track_m;
    [steady(speed, 0.0), steady(0.0, rate)].map(|order| {
        let (mut right, mut left) = (Range::NONE, Range::NONE);
        drive(file, speed_loop, dt, 12.0, order, |t, torques| {
            if t > 6.0 {
                right.add(torques.0);
                left.add(torques.1);
            }
        });
        right.half().max(left.half()) / file.limits.wheel_torque_nm
    })
}

/// Given its accelerations, every base creeps with less than 1 % of its torque, at any bandwidth;
/// without, the lightest does.
#[test]
fn creeping_does_not_make_the_torque_rattle() {
    for (name, file) in bases() {
        for dt in [0.01, 0.005] {
            for (bandwidth, informed) in [(50.0, false), (20.0, true), (50.0, true), (200.0, true)]
            {
                let [straight, turning] = ripple(&file, (bandwidth, informed), dt);
                println!(
                    "{name} {} ms, {bandwidth} rad/s, informed {informed}: ripple {:.3} % straight, {:.3} % turning",
                    1e3 * dt,
                    100.0 * straight,
                    100.0 * turning
                );
                // 30 kg turn with 15 kg m² on wheels 0.5 m apart: a loop of 5 rad/s with integral action
                // that learns of its own torque at the next count, 0.2 s later, rings. A whole base tells
                // its odometry (`base::BaseController`), and has none of this.
                // Of 10 kg the heading's gain of 4/s answers what an odometry that is given nothing makes of the torque.
                let most = match name {
                    "paper-30kg" if !informed => 0.06,
                    "lab-10kg" if !informed => 0.012,
                    _ => 0.01,
                };
                assert!(
                    straight < 0.01 && turning < most,
                    "{name}: {straight} {turning}"
                );
            }
        }
    }
}

/// The speed of one linear loop with the same bandwidth: every count is a blow.
fn linear(lag: &mut f64, speed: &mut f64, moved: f64, dt: f64) -> f64 {
    let a = 50.0 * dt;
    let error = *lag + moved - *speed * dt;
    *lag = error / ((1.0 + a) * (1.0 + a));
    *speed += 50.0 * a * *lag;
    *speed
}

/// Open loop: at a steady speed the ripple of the estimate dies out, at many ticks to a count and few.
#[test]
fn steady_creep_is_read_without_ripple() {
    let (_, file) = bases()[2].clone();
    let params = odometry::<f64>(&file, 50.0);
    let q = params.travel_per_count_m();
    for ticks in [0.3, 1.3, 3.7, 20.0, 20.6] {
        for dt in [0.01, 0.005, 0.001] {
            let mut odometry =
                Odometry::new(&params, Pose::default(), WheelCounts::default()).expect("in range");
            let (mut range, mut blows) = (Range::NONE, Range::NONE);
            let (mut lag, mut rate, mut last) = (0.0, 0.0, 0);
            for k in 1..=4000 {
                let count = (f64::from(k) / ticks).floor() as i32;
                let now = WheelCounts {
                    right: count,
                    left: count,
                };
                let v = odometry.update::<Libm>(now, dt).twist.linear;
                let old = linear(&mut lag, &mut rate, f64::from(count - last) * q, dt);
                last = count;
                if k > 2000 {
                    range.add(v);
                    blows.add(old);
                }
            }
            let speed = q / (ticks * dt);
            println!(
                "{ticks} ticks of {dt} s: {:.3} mm/s, ripple {:.4} mm/s, of a linear loop {:.4}",
                1e3 * speed,
                1e3 * range.half(),
                1e3 * blows.half()
            );
            // 2.5 % of the speed: a count that now and then comes a tick earlier.
            assert!(range.half() < 0.025 * speed, "{}", range.half());
            assert!((range.0 - speed).abs().max((range.1 - speed).abs()) < 0.05 * speed);
            assert!(ticks < 2.0 || range.half() < 0.1 * blows.half());
        }
    }
}

/// A stop reads as at most one count per time since the next was due, and soon exactly 0; wheels that
/// are stuck against their torque read near 0 as well.
#[test]
fn standstill_reads_zero() {
    let (_, file) = bases()[2].clone();
    let params = odometry::<f64>(&file, 50.0);
    let q = params.travel_per_count_m();
    for (v, dt) in [
        (1.0, 0.01),
        (0.1, 0.01),
        (0.01, 0.01),
        (0.002, 0.01),
        (1.0, 0.005),
        (0.002, 0.005),
    ] {
        let mut odometry =
            Odometry::new(&params, Pose::default(), WheelCounts::default()).expect("in range");
        let mut now = WheelCounts::default();
        for k in 1..=400 {
            let count = (f64::from(k) * v * dt / q) as i32;
            now = WheelCounts {
                right: count,
                left: count,
            };
            odometry.update::<Libm>(now, dt);
        }
        let (mut slow_s, mut zero_s, mut t) = (f64::NAN, f64::NAN, 0.0);
        while t < 4.0 {
            t += dt;
            let speed = odometry.update::<Libm>(now, dt).twist.linear;
            if speed.abs() < 1e-3 && slow_s.is_nan() {
                slow_s = t;
            }
            if speed == 0.0 && zero_s.is_nan() {
                zero_s = t;
            }
            // The next count is due within the travel of one, or at once.
            let due = t - q / v - 2.0 * dt;
            assert!(
                due <= 0.0 || speed.abs() <= 1.01 * q / due,
                "{speed} at {t}"
            );
        }
        println!("{v} m/s, {dt} s: below 1 mm/s after {slow_s:.3} s, 0 after {zero_s:.3} s");
        // Above a count per time constant, within ten time constants; below, a count later.
        assert!(
            slow_s < 0.2 + q / v && zero_s < 1.5,
            "{v}: {slow_s} {zero_s}"
        );
    }
    let mut odometry =
        Odometry::new(&params, Pose::default(), WheelCounts::default()).expect("in range");
    let (push, mut speeds) = (Accel::new(1.0, 0.0), Vec::new());
    for _ in 0..50 {
        let now = odometry.update_with_accel::<Libm>(WheelCounts::default(), 0.01, &push);
        speeds.push(now.twist.linear);
    }
    // 1 m/s² is predicted and none of it happens. A count is due after 25 ms, by which 25 mm/s are believed;
    // then the acceleration is refuted, and half a second later the wheel reads exactly 0.
    let most = speeds.iter().copied().fold(0.0, f64::max);
    assert!(most < (2.0_f64 * q * 1.0).sqrt() + 0.01, "{most}");
    assert_eq!(speeds.last(), Some(&0.0), "{speeds:?}");
}

/// A torque that friction holds is no acceleration, from either side and after false edges; the speed of a wheel that
/// then rolls is believed from its second count on.
#[test]
fn a_held_wheel_reads_zero_until_it_rolls() {
    for (_, file) in bases() {
        let params = odometry::<f64>(&file, 50.0);
        let mut odometry =
            Odometry::new(&params, Pose::default(), WheelCounts::default()).expect("in range");
        let dt = 0.01;
        let mut read = |count: i32, accel: f64| {
            let now = WheelCounts {
                right: count,
                left: count,
            };
            let accel = Accel::new(accel, 0.0);
            let now = odometry.update_with_accel::<Libm>(now, dt, &accel);
            now.twist.linear
        };
        // Held for a second, then pushed the other way: friction is taken to hold alike.
        (0..100).for_each(|_| _ = read(0, 0.2));
        for _ in 0..200 {
            assert_eq!(read(0, -0.2), 0.0);
        }
        // A false edge after a rest tells no speed.
        assert_eq!(read(1, 0.2), 0.0);
        for _ in 0..200 {
            assert_eq!(read(1, 0.2), 0.0);
        }
        // Nor does a second one, whichever way, let the held torque count again: a share of one count's blow stays,
        // and is gone with the next.
        let q = params.travel_per_count_m();
        for count in [2, 1] {
            (0..10).for_each(|_| _ = read(count, 0.2));
            assert!((0..190).all(|_| read(count, 0.2).abs() < q / 0.1));
        }
        assert_eq!(read(1, 0.2), 0.0);
        // It rolls, at a count a tick: the first says where it is, the second that it moves. From standing to rolling in a tick
        // is more acceleration than there is: for a while the loop takes some of it for a push that lasts, a sixteenth times
        // ω of the step, which reads as 2/16 more of it, and the blow of the step comes on top.
        let speed = params.travel_per_count_m() / dt;
        let mut last = 0.0;
        for count in 2..200 {
            last = read(count, 0.0);
            assert!(count > 2 || last == 0.0);
            assert!(last < 1.25 * speed, "{count}: {last} of {speed}");
            assert!(
                count < 10 || last > 0.9 * speed,
                "{count}: {last} of {speed}"
            );
        }
        // Inside a count nothing is corrected any more.
        assert_within(last, speed, 0.01 * speed, "speed");
    }
}

/// Given its accelerations the estimate does not lag them; what it was not given is at most 2/bandwidth late, and in time not at all.
#[test]
fn told_accelerations_are_not_delayed() {
    let (_, file) = bases()[2].clone();
    let params = odometry::<f64>(&file, 50.0);
    let dt = 0.005;
    for (known, late_s) in [
        (1.0, 0.0),
        (0.7, 0.3 * params.delay_s()),
        (0.0, params.delay_s()),
    ] {
        let mut odometry =
            Odometry::new(&params, Pose::default(), WheelCounts::default()).expect("in range");
        let (mut v, mut latest) = (0.0, 0.0_f64);
        for k in 1..=300 {
            let t = f64::from(k) * dt;
            let count = (0.5 * t * t / params.travel_per_count_m()) as i32;
            let now = WheelCounts {
                right: count,
                left: count,
            };
            v = odometry
                .update_with_accel::<Libm>(now, dt, &Accel::new(known, 0.0))
                .twist
                .linear;
            latest = latest.max(t - v);
        }
        println!(
            "known {known}: at most {latest:.4} s late, at last {:.4} s",
            1.5 - v
        );
        // At 1 m/s² a second is a metre per second. Half a tick, since the loop sees travel, and
        // half a count of 0.3 mm through the loop.
        assert!(latest < late_s + 0.006, "{known}: {latest}");
        assert!(latest > 0.7 * late_s, "{known}: {latest}");
        assert_within(1.5 - v, 0.0, 0.006, "delay");
    }
}
