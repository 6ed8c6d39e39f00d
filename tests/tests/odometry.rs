//! Encoder counts to pose and twist, and the traits of a base.

use controller_core::error::{Field, Problem};
use controller_core::hal::{Error, ErrorKind, WheelCounts, Widened, accepts};
use controller_core::maths::Libm;
use controller_core::odometry::{Calibration, Odometry, OdometryParams};
use controller_core::types::{Pose, WheelTorques};
use controller_core::wheels::WheelGeometry;
use std::f64::consts::PI;
use tests::check::assert_within;

/// Wheels of different radii, 2,048 counts a turn.
fn params() -> OdometryParams<f64> {
    OdometryParams {
        wheels: WheelGeometry {
            radius_right_m: 0.1,
            radius_left_m: 0.098,
            track_m: 0.5,
        },
        calibration: Calibration::NOMINAL,
        counts_per_turn: 2048.0,
        bandwidth: 50.0,
    }
}

/// Counts of a wheel of radius `r` that has rolled `s`.
fn counts(s: f64, r: f64) -> f64 {
    s / (2.0 * PI * r) * 2048.0
}

/// Eq. (6): constant wheel rates give the arc, however long the ticks, through a rollover of the counters.
#[test]
fn constant_rates_give_the_exact_arc() {
    let start = Pose::new(0.3, -0.2, 1.0);
    let base = WheelCounts {
        right: i32::MAX - 500,
        left: i32::MIN + 10,
    };
    let (v, w): (f64, f64) = (0.4, 0.7);
    let mut odometry = Odometry::new(&params(), start, base).expect("in range");
    let dt = 0.5;
    let mut truth = start;
    for k in 1..=20 {
        let t = f64::from(k) * dt;
        let count = |side: f64, r: f64| counts((v + side * w * 0.25) * t, r).round() as i32;
        let now = WheelCounts {
            right: base.right.wrapping_add(count(1.0, 0.1)),
            left: base.left.wrapping_add(count(-1.0, 0.098)),
        };
        let measured = odometry.update::<Libm>(now, dt);
        let theta = start.theta + w * t;
        truth = Pose::new(
            start.x + v / w * (theta.sin() - start.theta.sin()),
            start.y - v / w * (theta.cos() - start.theta.cos()),
            theta,
        );
        assert_eq!(measured.pose, *odometry.pose());
    }
    // A count is 0.3 mm of travel; its rounding turns the heading by 0.6 mrad, and 4 m follow.
    let pose = odometry.pose();
    assert_within(pose.theta, truth.theta, 0.7e-3, "heading");
    assert_within(pose.x, truth.x, 3e-3, "x");
    assert_within(pose.y, truth.y, 3e-3, "y");
}

/// The speed estimate has no error at constant speed; it lags a ramp by less than 2/bandwidth at first, and in time not at all.
#[test]
fn speed_estimate_is_unbiased_and_learns_what_accelerates_it() {
    let (dt, accel) = (1e-3, 0.5);
    // Fine counts, so that the loop and not the quantisation is seen.
    let fine = OdometryParams {
        counts_per_turn: 1.0e7,
        ..params()
    };
    let run = |end: u32, speed: &dyn Fn(f64) -> f64, place: &dyn Fn(f64) -> f64| {
        let mut odometry =
            Odometry::new(&fine, Pose::default(), WheelCounts::default()).expect("in range");
        let mut last = 0.0;
        for k in 1..=end {
            let t = f64::from(k) * dt;
            let count = |r: f64| (place(t) / (2.0 * PI * r) * 1.0e7).round() as i32;
            let now = WheelCounts {
                right: count(0.1),
                left: count(0.098),
            };
            last = odometry.update::<Libm>(now, dt).twist.linear - speed(t);
        }
        last
    };
    let constant = run(5000, &|_| 0.3, &|t| 0.3 * t);
    // Quantisation: one count of 6e-8 m, through bandwidth² dt. The slowest pole, 3.6/s, leaves 1e-8 of the start.
    assert_within(constant, 0.0, 1e-6, "constant speed");
    let ramp = |end| run(end, &|t| accel * t, &|t| 0.5 * accel * t * t);
    let late = -accel * 2.0 / 50.0;
    // Nothing is learnt in the two time constants in which the lag builds up, and it is at most that of a loop that learns nothing.
    let first = ramp(100);
    assert!(first < 0.75 * late && first > late, "{first} {late}");
    assert_within(ramp(5000), 0.0, 1e-6, "ramp");
}

/// At a count every 30 ticks the estimate stays smooth: no spike of a count per tick.
#[test]
fn slow_wheels_do_not_make_the_speed_rattle() {
    let dt = 1e-3;
    let speed = 0.01;
    let mut odometry =
        Odometry::new(&params(), Pose::default(), WheelCounts::default()).expect("in range");
    let (mut largest_step, mut before) = (0.0_f64, 0.0);
    for k in 1..=3000 {
        let s = speed * f64::from(k) * dt;
        let now = WheelCounts {
            right: counts(s, 0.1).floor() as i32,
            left: counts(s, 0.098).floor() as i32,
        };
        let v = odometry.update::<Libm>(now, dt).twist.linear;
        if k > 1000 {
            largest_step = largest_step.max((v - before).abs());
        }
        before = v;
    }
    // bandwidth² dt per count of 0.3 mm, where a difference quotient would jump by 0.3 m/s.
    let bound = 50.0 * 50.0 * dt * 2.0 * PI * 0.1 / 2048.0;
    assert!(largest_step <= bound, "{largest_step} above {bound}");
    assert_within(before, speed, 0.4 * speed, "speed");
}

/// A corrected pose is taken over; speeds carry on.
#[test]
fn set_pose_keeps_the_speed() {
    let mut odometry =
        Odometry::new(&params(), Pose::default(), WheelCounts::default()).expect("in range");
    let mut measured = odometry.update::<Libm>(WheelCounts::default(), 0.01);
    for k in 1..=100 {
        let now = WheelCounts {
            right: 10 * k,
            left: 10 * k,
        };
        measured = odometry.update::<Libm>(now, 0.01);
    }
    odometry.set_pose(Pose::new(5.0, 6.0, 0.5));
    let now = WheelCounts {
        right: 1010,
        left: 1010,
    };
    let after = odometry.update::<Libm>(now, 0.01);
    assert_within(after.pose.x, 5.0, 4e-3, "moved on from the new pose");
    let change = (after.twist.linear - measured.twist.linear).abs();
    assert!(change < 0.02 * measured.twist.linear, "{change}");
}

/// Calibration scales radii and track: as if they had been measured so.
#[test]
fn calibration_scales_the_lengths() {
    let calibrated = OdometryParams {
        calibration: Calibration {
            right: 1.02,
            left: 0.97,
            track: 1.05,
        },
        ..params()
    };
    let wheels = params().wheels;
    let measured = OdometryParams {
        wheels: WheelGeometry {
            radius_right_m: 1.02 * wheels.radius_right_m,
            radius_left_m: 0.97 * wheels.radius_left_m,
            track_m: 1.05 * wheels.track_m,
        },
        ..params()
    };
    let drive = |params: &OdometryParams<f64>| {
        let mut odometry =
            Odometry::new(params, Pose::default(), WheelCounts::default()).expect("in range");
        let now = WheelCounts {
            right: 700,
            left: 300,
        };
        odometry.update::<Libm>(now, 0.1)
    };
    assert_eq!(drive(&calibrated), drive(&measured));
    assert_eq!(calibrated.track_m(), 1.05 * 0.5);
    assert_eq!(calibrated.delay_s(), 2.0 / 50.0);
}

/// A count's travel is that of the wheel, right or left, which turned out to be the larger.
#[test]
fn travel_per_count_is_that_of_the_larger_wheel() {
    for (right, left) in [(1.05, 0.95), (0.95, 1.05)] {
        let params = OdometryParams {
            calibration: Calibration {
                right,
                left,
                track: 1.0,
            },
            ..params()
        };
        let larger = (0.1 * right).max(0.098 * left);
        // Roundings.
        assert_within(
            params.travel_per_count_m(),
            2.0 * PI * larger / 2048.0,
            1e-18,
            "travel",
        );
    }
}

/// Back-EMF is made up for the speed at which each wheel turns, by its own radius; and on a ramp that no torque explains for what the
/// wheel would turn without what it won in 4/bandwidth.
#[test]
fn back_emf_is_of_the_wheels_without_unmodelled_forces() {
    let dt = 1e-3;
    // Fine counts, so that the loop and not the quantisation is seen.
    let fine = OdometryParams {
        counts_per_turn: 1.0e7,
        calibration: Calibration {
            right: 1.02,
            left: 0.97,
            track: 1.0,
        },
        ..params()
    };
    let (right_m, left_m) = (1.02 * 0.1, 0.97 * 0.098);
    for (speed, accel) in [(0.5, 0.0), (0.1, 0.3), (-0.1, -0.3)] {
        let mut odometry =
            Odometry::new(&fine, Pose::default(), WheelCounts::default()).expect("in range");
        for k in 1..=5000 {
            let t = f64::from(k) * dt;
            let count =
                |r: f64| ((speed + 0.5 * accel * t) * t / (2.0 * PI * r) * 1.0e7).round() as i32;
            let now = WheelCounts {
                right: count(right_m),
                left: count(left_m),
            };
            odometry.update::<Libm>(now, dt);
        }
        let made_up = speed + accel * 5.0 - accel * 4.0 / 50.0;
        let speeds = odometry.back_emf_speeds();
        // Quantisation: a count of 6e-8 m, through bandwidth² dt, on a tenth of a metre; what is learnt of it 4/16 more.
        assert_within(speeds.right, made_up / right_m, 3e-5, "right");
        assert_within(speeds.left, made_up / left_m, 3e-5, "left");
    }
}

/// Parameters out of range are named.
#[test]
fn odometry_names_bad_parameters() {
    let refuse = |change: &dyn Fn(&mut OdometryParams<f64>)| {
        let mut bad = params();
        change(&mut bad);
        let error = Odometry::new(&bad, Pose::default(), WheelCounts::default());
        error.expect_err("out of range")
    };
    let error = refuse(&|p| p.counts_per_turn = 0.5);
    assert_eq!(
        (error.field, error.problem),
        (Field::CountsPerTurn, Problem::Below(1.0))
    );
    let error = refuse(&|p| p.bandwidth = f64::NAN);
    assert_eq!(
        (error.field, error.problem),
        (Field::Bandwidth, Problem::NotFinite)
    );
    assert_eq!(refuse(&|p| p.wheels.track_m = 0.0).field, Field::Track);
    assert_eq!(
        refuse(&|p| p.calibration.right = 0.4).field,
        Field::CalibrationRight
    );
    assert_eq!(
        refuse(&|p| p.calibration.left = 2.1).field,
        Field::CalibrationLeft
    );
    assert_eq!(
        refuse(&|p| p.calibration.track = f64::NAN).field,
        Field::CalibrationTrack
    );
}

/// What drivers refuse, what kinds say, and counters of 16 bits in either direction.
#[test]
fn hal_helpers_do_what_drivers_need() {
    let torques = |right, left| WheelTorques { right, left };
    assert!(accepts(&torques(2.0, -2.0), 2.0));
    for bad in [2.1, -2.1, f32::NAN, f32::INFINITY] {
        assert!(!accepts(&torques(bad, 0.0), 2.0) && !accepts(&torques(0.0, bad), 2.0));
    }
    assert_eq!(ErrorKind::OverCurrent.kind(), ErrorKind::OverCurrent);
    assert!(ErrorKind::UnderVoltage.to_string().contains("supply"));
    let mut wheel = Widened::new(0);
    assert_eq!(wheel.update(u16::MAX), -1);
    let mut total = -1;
    for _ in 0..10 {
        total += 30_000;
        assert_eq!(wheel.update(total as u16), total);
    }
}

/// Two kilometres from the origin the next number in single precision is 0.12 mm away, after two thousand turns 1 mrad: a slow base moves and turns by
/// a few hundredths of that in a tick of a millisecond, and yet nothing of it is lost.
#[test]
fn far_away_and_after_many_turns_no_way_is_lost() {
    let exact = params();
    let single = OdometryParams::<f32> {
        wheels: exact.wheels.cast(),
        calibration: Calibration::NOMINAL,
        counts_per_turn: 2048.0,
        bandwidth: 50.0,
    };
    let mut off = [0.0_f64; 2];
    for (case, (start, right, left, ticks)) in [
        (Pose::new(1900.0, -1900.0, 0.6), 2.0, 1.7, 400_000),
        (Pose::new(0.0, 0.0, 12_000.0), 1.0, -1.0, 400_000),
    ]
    .into_iter()
    .enumerate()
    {
        let counts = WheelCounts::default();
        let mut reference = Odometry::new(&exact, start, counts).expect("in range");
        let mut odometry = Odometry::new(&single, start.cast(), counts).expect("in range");
        for tick in 1..=ticks {
            let turned = 0.1 * f64::from(tick);
            let counts = WheelCounts {
                right: (right * turned) as i32,
                left: (left * turned) as i32,
            };
            reference.update::<Libm>(counts, 1e-3);
            odometry.update::<Libm>(counts, 1e-3);
        }
        let (is, due) = (odometry.pose().cast::<f64>(), *reference.pose());
        println!("{start:?}: {is:?} for {due:?}");
        off[case] = if case == 0 {
            (is.x - due.x).hypot(is.y - due.y)
        } else {
            (is.theta - due.theta).abs()
        };
    }
    println!("{off:?}");
    // Half of the last digit, 0.06 mm on each axis and 0.5 mrad, and what single precision makes of the wheels' sizes: 1e-7 of the way.
    assert!(off[0] < 1e-4 && off[1] < 6e-4);
}
