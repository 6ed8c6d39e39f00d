//! What fixes do to the pose: drift, noise, latency, gaps, uneven ticks, precision.

use controller_core::localiser::{FusionParams, LocaliserParams, ValidLocaliserParams};
use controller_core::maths::{Libm, Single};
use controller_core::types::{Pose, Twist};
use sim_host::mission::BaseSpec as File;
use tests::check::assert_within;
use tests::encoded::{Encoded, bases, odometry};
use tests::fixes::Source;
use tests::led::Led;
use tests::localised::{SPEED, localisation};
use tests::random::Random;

fn lab() -> File {
    bases()[1].1.clone()
}

/// The base with a right wheel that is 2 % larger than believed.
fn worn(file: &File) -> Encoded {
    let mut robot = Encoded::new(file, Pose::default());
    robot.wheels.radius_right_m *= 1.02;
    robot
}

/// Calibration of a wheel cures what it causes; fixes bound it.
#[test]
fn drift_of_a_wrong_radius_is_bounded_by_fixes() {
    let file = lab();
    let run = |localisation: &ValidLocaliserParams<f64>, source: &mut Source| {
        let mut led = Led::<f64, 64>::start(localisation, worn(&file));
        let (mut last, mut worst) = (Pose::default(), 0.0_f64);
        for k in 0..1000 {
            let estimate = led.advance::<Libm>(Twist::new(0.4, 0.0), 0.01, source);
            assert!(!estimate.jumped);
            last = led.off(&estimate);
            if k > 500 {
                worst = worst.max(last.x.hypot(last.y));
            }
        }
        println!("drift: {last:?}, worst {worst:.4} m");
        (last, worst)
    };
    let fused = localisation(&file, 5e-3, 5e-3);
    let (alone, _) = run(&fused, &mut Source::silent());
    // 2 % of a radius turn by 0.02 · 4 m / 0.35 m, less than the larger wheel's own share, and that
    // turn over half the way takes the robot aside by 0.45 m.
    assert_within(alone.theta.abs(), 0.02 * 4.0 / 0.35, 5e-3, "turn");
    assert_within(alone.y.abs(), 0.5 * 4.0 * 0.224, 0.02, "aside");
    let (_, with_fixes) = run(&fused, &mut Source::camera(1));
    // The heading stays behind by 0.02 · 0.4/0.35/0.8 = 29 mrad, the position by 0.4 m/s · 29 mrad /
    // 0.8 = 14 mm across and 5 mm along; noise adds 3 of its 0.7 mm.
    assert!(with_fixes < 0.02, "{with_fixes}");
    let mut params = *fused.params();
    params.odometry.calibration.right = 1.02;
    let calibrated = params.validate_with::<Libm>().expect("valid");
    let (alone, _) = run(&calibrated, &mut Source::silent());
    // Counts: a wheel's of 0.23 mm.
    assert!(
        alone.x.hypot(alone.y) < 2e-3 && alone.theta.abs() < 1e-3,
        "{alone:?}"
    );
}

/// What odometry lost on a metre without fixes, a precise source gives back within a few fixes, not at the rate of its noise, 15 mrad/s.
#[test]
fn precise_fixes_end_a_drift_soon() {
    let file = lab();
    let precise = 0.5e-3;
    let localisation = localisation(&file, precise, precise);
    let mut led = Led::<f64, 64>::start(&localisation, worn(&file));
    let mut off = Pose::default();
    for _ in 0..250 {
        let estimate = led.advance::<Libm>(Twist::new(0.4, 0.0), 0.01, &mut Source::silent());
        off = led.off(&estimate);
    }
    // As above, over a metre.
    assert_within(off.theta.abs(), 0.02 / 0.35, 5e-3, "turn");
    assert_within(off.y.abs(), 0.5 * 0.02 / 0.35, 5e-3, "aside");
    let mut source = Source {
        noise_m: precise,
        noise_rad: precise,
        ..Source::camera(3)
    };
    for _ in 0..30 {
        let estimate = led.advance::<Libm>(Twist::default(), 0.01, &mut source);
        assert!(!estimate.jumped);
        off = led.off(&estimate);
    }
    // Five fixes, each spread over the time to the next: what is left is within the 5 standard deviations that may be noise.
    let left = off.x.abs().max(off.y.abs()).max(off.theta.abs());
    assert!(left < 5.0 * precise, "{off:?}");
}

/// How far off the pose is a second after a robot that moves with `twist` was pushed aside by 12 mm: root mean square of 100 drives \[m\].
fn left_of_a_push(twist: Twist<f64>) -> f64 {
    let file = lab();
    let localisation = localisation(&file, 5e-3, 5e-3);
    let mut squares = 0.0;
    for seed in 1..=100 {
        let mut source = Source::camera(seed);
        let mut led = Led::<f64, 64>::start(&localisation, Encoded::new(&file, Pose::default()));
        let mut off = Pose::default();
        for tick in 0..200 {
            if tick == 100 {
                let pose = &mut led.robot.body.pose;
                let (sine, cosine) = pose.theta.sin_cos();
                pose.x -= 0.012 * sine;
                pose.y += 0.012 * cosine;
            }
            let estimate = led.advance::<Libm>(twist, 0.01, &mut source);
            off = led.off(&estimate);
        }
        squares += off.x.powi(2) + off.y.powi(2);
    }
    (squares / 100.0).sqrt()
}

/// A base that slides on its way takes more of the fixes that stay to one side; one that rests does not.
#[test]
fn a_slide_on_the_way_is_made_up_for() {
    let (turning, driving, resting) = (
        left_of_a_push(Twist::new(0.0, 0.8)),
        left_of_a_push(Twist::new(0.4, 0.3)),
        left_of_a_push(Twist::default()),
    );
    println!("turning {turning:.2e}, driving {driving:.2e}, resting {resting:.2e} m");
    // exp(-0.8 0.95) of it, with the noise of two coordinates.
    let noise = 2.0_f64.sqrt() * 0.7e-3;
    assert_within(resting, 5.6e-3_f64.hypot(noise), 0.3e-3, "at rest");
    // Without it 5.6 mm while turning on the spot, 4.9 mm driving.
    assert!(turning < 3.6e-3 && driving < 2.6e-3);
}

/// At constant speed the age of fixes does not put the pose behind by 1 % of the way in that time.
#[test]
fn latency_leaves_no_lag() {
    let file = lab();
    let localisation = localisation(&file, 5e-3, 5e-3);
    for latency_s in [0.02, 0.1, 0.3] {
        for (v, w) in [(0.4, 0.0), (0.4, 0.5), (1.0, 0.3)] {
            let mut led =
                Led::<f64, 64>::start(&localisation, Encoded::new(&file, Pose::default()));
            let mut source = Source {
                latency_s,
                ..Source::exact()
            };
            let (mut along, mut n) = (0.0, 0.0);
            for k in 0..2000 {
                let estimate = led.advance::<Libm>(Twist::new(v, w), 0.01, &mut source);
                if k > 1000 {
                    along += led.off(&estimate).x;
                    n += 1.0;
                }
            }
            let lag = along / n;
            println!(
                "{latency_s} s, {v} m/s, {w} rad/s: {:.4} mm along",
                1e3 * lag
            );
            assert!(lag.abs() < 0.01 * v * latency_s, "{lag}");
        }
    }
}

/// The standard deviation that parameters promise, at rest, for slow and fast filters and sources.
#[test]
fn filtered_noise_is_what_is_promised() {
    let file = lab();
    for (bandwidth, rate_hz) in [
        (0.8, 20.0),
        (0.2, 20.0),
        (3.0, 20.0),
        (0.5, 2.0),
        (10.0, 20.0),
    ] {
        let mut fusion = FusionParams::for_source(5e-3, 3e-3, rate_hz);
        (fusion.bandwidth, fusion.heading_bandwidth) = (bandwidth, 0.5 * bandwidth);
        let params = LocaliserParams {
            odometry: odometry(&file, SPEED),
            fusion: Some(fusion),
            gyro: None,
        };
        let localisation = params.validate_with::<Libm>().expect("valid");
        let mut led = Led::<f64, 64>::start(&localisation, Encoded::new(&file, Pose::default()));
        let mut source = Source {
            period_s: 1.0 / rate_hz,
            noise_rad: 3e-3,
            ..Source::camera(7)
        };
        let (mut x2, mut theta2, mut n) = (0.0, 0.0, 0.0);
        // 40,000 s at the slowest: 8,000 time constants and two coordinates leave 1 % of chance.
        let ticks = (8000.0 / bandwidth / 0.01) as u32;
        for _ in 0..ticks {
            let estimate = led.advance::<Libm>(Twist::default(), 0.01, &mut source);
            let off = led.off(&estimate);
            x2 += 0.5 * (off.x * off.x + off.y * off.y);
            theta2 += off.theta * off.theta;
            n += 1.0;
        }
        let (m, rad) = (f64::sqrt(x2 / n), f64::sqrt(theta2 / n));
        let (want_m, want_rad) = (
            localisation.filtered_noise_m(),
            localisation.filtered_noise_rad(),
        );
        println!(
            "{bandwidth} rad/s, {rate_hz} Hz: {:.4} mm for {:.4}, {:.4} mrad for {:.4}",
            1e3 * m,
            1e3 * want_m,
            1e3 * rad,
            1e3 * want_rad
        );
        assert_within(m / want_m, 1.0, 0.1, "position");
        assert_within(rad / want_rad, 1.0, 0.1, "heading");
    }
}

/// Half of the fixes lost: the noise stays, the pose too; none for a while is reported.
#[test]
fn lost_fixes_do_no_harm_and_long_gaps_are_told() {
    let file = lab();
    let localisation = localisation(&file, 5e-3, 5e-3);
    let mut led = Led::<f64, 64>::start(&localisation, Encoded::new(&file, Pose::default()));
    let (mut camera, mut nobody) = (Source::camera(11), Source::silent());
    let mut random = Random(12);
    let (mut sum, mut n) = (0.0, 0.0);
    for k in 0..20_000 {
        let source = if random.within(1.0) < 0.0 {
            &mut camera
        } else {
            &mut nobody
        };
        let estimate = led.advance::<Libm>(Twist::new(0.4, 0.2), 0.01, source);
        if k > 1000 {
            let off = led.off(&estimate);
            sum += 0.5 * (off.x * off.x + off.y * off.y);
            n += 1.0;
            assert!(!estimate.stale);
        }
    }
    let rms = f64::sqrt(sum / n);
    println!("half the fixes: {:.3} mm", 1e3 * rms);
    assert!(rms < 1.3 * localisation.filtered_noise_m());
    let mut told_s = 0.0;
    let begin = led.t;
    for _ in 0..200 {
        let estimate = led.advance::<Libm>(Twist::default(), 0.01, &mut nobody);
        assert_eq!(estimate.fix_age_s, led.localiser.fix_age_s());
        if estimate.stale && told_s == 0.0 {
            told_s = led.t - begin;
        }
    }
    // Ten periods of 50 ms, less the age of the last fix.
    assert!(told_s > 0.3 && told_s <= 0.51, "{told_s}");
}

/// Ticks from 2 to 30 ms, and single precision: the same pose.
#[test]
fn uneven_ticks_and_single_precision_agree() {
    let file = lab();
    let double = localisation(&file, 5e-3, 5e-3);
    let params = LocaliserParams {
        odometry: odometry::<f32>(&file, SPEED),
        fusion: Some(FusionParams::for_source(5.0e-3_f32, 5.0e-3, 20.0)),
        gyro: None,
    };
    let single = params.validate().expect("valid");
    let mut exact = Led::<f64, 64>::start(&double, Encoded::new(&file, Pose::default()));
    let mut rough = Led::<f32, 64>::start(&single, Encoded::new(&file, Pose::default()));
    let (mut one, mut other) = (Source::camera(21), Source::camera(21));
    let mut random = Random(22);
    let (mut apart, mut turned, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..6000 {
        let dt = 0.016 + random.within(0.014);
        let twist = Twist::new(0.4, 0.3);
        let a = exact.advance::<Libm>(twist, dt, &mut one);
        let b = rough.advance::<Single>(twist, dt, &mut other);
        assert_eq!(a.jumped, b.jumped);
        let (p, q) = (exact.off(&a), rough.off(&b));
        apart = apart.max((p.x - q.x).hypot(p.y - q.y));
        turned = turned.max((p.theta - q.theta).abs());
        worst = worst.max(p.x.hypot(p.y));
    }
    println!("single apart by {apart:.1e} m, {turned:.1e} rad; off by {worst:.4} m");
    // 6,000 roundings of 1e-7 m and, at a heading of 29 rad, of 1e-6 rad, added up as by chance to 80
    // of them; fixes pull them back.
    assert!(apart < 2e-5 && turned < 1e-4);
    // Five of the 0.7 mm, and a millimetre of the counts.
    assert!(worst < 4.5e-3, "{worst}");
}
