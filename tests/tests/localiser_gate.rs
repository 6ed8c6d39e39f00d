//! Fixes that are wrong, and poses that are: outliers, relocalisation, refusals, steps.

use controller_core::error::{Input, StepFault};
use controller_core::hal::WheelCounts;
use controller_core::localiser::{Fix, FixOutcome, Localiser, LocaliserParams, Refusal};
use controller_core::maths::Libm;
use controller_core::types::{Accel, Pose, Twist};
use tests::encoded::{Encoded, bases, odometry};
use tests::fixes::Source;
use tests::led::Led;
use tests::localised::{Localised, SPEED, localisation};
use tests::motion_loop::steady;
use tests::random::Random;

type Small = Localiser<f64, 8>;

fn fix(x: f64, y: f64, theta: f64, age_s: f64) -> Fix<f64> {
    let pose = Pose::new(x, y, theta);
    Fix { pose, age_s }
}

/// One fix in five is nonsense, anywhere within 3 m: the pose does not care.
#[test]
fn outliers_are_rejected() {
    let (_, file) = bases()[1].clone();
    let localisation = localisation(&file, 5e-3, 5e-3);
    let mut localiser =
        Localiser::<f64, 64>::start(&localisation, Pose::default(), WheelCounts::default())
            .expect("finite");
    let mut random = Random(31);
    let (mut rejected, mut nonsense, mut worst) = (0, 0, 0.0_f64);
    for k in 0..20_000 {
        let mut given = None;
        if k % 5 == 0 {
            let mut near = || 5e-3 * random.normal();
            given = Some(fix(near(), near(), near(), 0.02));
            if random.within(1.0) < -0.6 {
                nonsense += 1;
                given = Some(fix(
                    random.within(3.0),
                    random.within(3.0),
                    random.within(3.0),
                    0.02,
                ));
            }
        }
        // No older than the start.
        let given = given.filter(|_| k > 2);
        let estimate = localiser
            .update::<Libm>(WheelCounts::default(), 0.01, given.as_ref())
            .expect("accepted");
        assert!(
            !estimate.jumped,
            "three of them agree by chance once in a million"
        );
        rejected += u32::from(estimate.fix == FixOutcome::Rejected);
        let pose = &estimate.measured.pose;
        worst = worst.max(pose.x.hypot(pose.y));
    }
    println!(
        "{rejected} of {nonsense} rejected, at most {:.2} mm off",
        1e3 * worst
    );
    // 5 sigma of good fixes: none of 3,200. Nonsense inside 25 mm, 25 mrad: none of 800.
    assert!(rejected >= nonsense - 2 && rejected <= nonsense + 1);
    assert!(worst < 5.0 * 0.7e-3);
}

/// Lifted and put down elsewhere while it drives: the third agreeing fix sets the pose and says so; the
/// controller takes it without a jump of torque.
#[test]
fn agreeing_outliers_relocalise_without_a_jump_of_torque() {
    for (name, file) in bases() {
        let localisation = localisation(&file, 5e-3, 5e-3);
        let motion = file.motion().validate().expect("valid");
        let path = steady(0.4, 0.15);
        for dt in [0.01, 0.005] {
            let robot = Encoded::new(&file, Pose::default());
            let mut run = Localised::start(&motion, &localisation, (&file, robot), &path(0.0), dt);
            let mut source = Source::camera(41);
            let (force, moment) = (
                motion.force_rate_limit() * dt,
                motion.moment_rate_limit() * dt,
            );
            let (mut jumps, mut outliers, mut most) = (0, 0, 0.0_f64);
            let mut last = motion
                .wheels()
                .wrench(&run.drive.controller.report().torques);
            while run.drive.t < 12.0 {
                run.coast();
                if (run.drive.t - 5.0).abs() < 0.5 * dt {
                    let pose = &mut run.drive.body.body.pose;
                    *pose = Pose::new(pose.x + 0.3, pose.y - 0.4, pose.theta + 0.5);
                }
                run.take(&path(run.drive.t), &mut source);
                outliers += u32::from(run.estimate.fix == FixOutcome::Rejected);
                if run.estimate.jumped {
                    jumps += 1;
                    let (found, truth) = (run.estimate.measured.pose, run.drive.body.body.pose);
                    // The mean of three: 5 mm/√3, five of them.
                    let off = (found.x - truth.x).hypot(found.y - truth.y);
                    assert!(off < 5.0 * 2.9e-3, "{name}: {off}");
                }
                let wrench = motion
                    .wheels()
                    .wrench(&run.drive.controller.report().torques);
                most = most
                    .max((wrench.force - last.force).abs() / force)
                    .max((wrench.moment - last.moment).abs() / moment);
                last = wrench;
            }
            let left = run.error(&path(run.drive.t));
            println!(
                "{name}: {outliers} rejected, {jumps} jump, torque {most:.3} L dt, left {left:?}"
            );
            assert_eq!((jumps, outliers), (1, 2), "{name}");
            assert!(most <= 1.0, "{name}: {most} of L dt");
            assert!(left.x.hypot(left.y) < 0.01, "{name}: {left:?}");
        }
    }
}

/// Outliers that do not agree with each other never set the pose, and a good fix in between starts anew.
#[test]
fn only_outliers_in_a_row_and_agreeing_count() {
    let (_, file) = bases()[1].clone();
    let localisation = localisation(&file, 5e-3, 5e-3);
    let start = || {
        let mut localiser =
            Small::start(&localisation, Pose::default(), WheelCounts::default()).expect("finite");
        move |x: f64| {
            let given = fix(x, 0.0, 0.0, 0.0);
            let estimate = localiser.update::<Libm>(WheelCounts::default(), 0.01, Some(&given));
            estimate.expect("accepted").fix
        }
    };
    let mut give = start();
    for k in 0..20 {
        assert_eq!(give(1.0 + 0.1 * f64::from(k)), FixOutcome::Rejected);
    }
    let mut give = start();
    for _ in 0..10 {
        assert_eq!(give(1.0), FixOutcome::Rejected);
        assert_eq!(give(1.01), FixOutcome::Rejected);
        assert_eq!(give(0.0), FixOutcome::Fused);
    }
    assert_eq!(give(1.0), FixOutcome::Rejected);
    assert_eq!(give(1.01), FixOutcome::Rejected);
    assert_eq!(give(0.99), FixOutcome::Relocalised);
    assert_eq!(give(1.0), FixOutcome::Fused);
}

/// What cannot be used is named and changes nothing; a bad tick neither.
#[test]
fn refusals_change_nothing() {
    let (_, file) = bases()[1].clone();
    let localisation = localisation(&file, 5e-3, 5e-3);
    let counts = WheelCounts::default();
    let mut localiser = Small::start(&localisation, Pose::default(), counts).expect("finite");
    for _ in 0..20 {
        localiser
            .update::<Libm>(counts, 0.01, None)
            .expect("accepted");
    }
    let mut plain = localiser;
    plain.update::<Libm>(counts, 0.01, None).expect("accepted");
    for (bad, refusal) in [
        (fix(f64::NAN, 0.0, 0.0, 0.0), Refusal::NotFinite),
        (fix(0.0, 0.0, f64::INFINITY, 0.0), Refusal::NotFinite),
        (fix(0.0, 0.0, 0.0, f64::NAN), Refusal::NotFinite),
        (fix(0.0, 0.0, 0.0, -1e-3), Refusal::NegativeAge),
    ] {
        let mut tried = localiser;
        let outcome = tried
            .update::<Libm>(counts, 0.01, Some(&bad))
            .expect("accepted")
            .fix;
        assert_eq!(outcome, FixOutcome::Refused(refusal));
        assert_eq!(tried, plain);
    }
    // Eight poses are seven ticks.
    let mut tried = localiser;
    let outcome = tried.update::<Libm>(counts, 0.01, Some(&fix(0.0, 0.0, 0.0, 0.0701)));
    let FixOutcome::Refused(Refusal::TooOld { oldest_s }) = outcome.expect("accepted").fix else {
        panic!("too old");
    };
    assert!((oldest_s - 0.07).abs() < 1e-12 && tried == plain);
    let outcome = localiser.update::<Libm>(counts, 0.01, Some(&fix(0.0, 0.0, 0.0, 0.0699)));
    assert_eq!(outcome.expect("accepted").fix, FixOutcome::Fused);
    let before = localiser;
    for (dt, fault) in [
        (0.0, StepFault::TickNotPositive),
        (-0.01, StepFault::TickNotPositive),
        (f64::NAN, StepFault::NotFinite(Input::Tick)),
    ] {
        assert_eq!(localiser.update::<Libm>(counts, dt, None), Err(fault));
    }
    let accel = Accel::new(f64::NAN, 0.0);
    let fault = localiser.update_with_accel::<Libm>(counts, 0.01, &accel, None);
    assert_eq!(fault, Err(StepFault::NotFinite(Input::Accel)));
    assert_eq!(localiser, before);
    let nowhere = Pose::new(0.0, f64::NAN, 0.0);
    assert!(Small::start(&localisation, nowhere, counts).is_err());
}

/// Fixes at the gate, one side and the other, never move the pose by more than is stated; a heading is
/// corrected where the robot stands, 100 m from the origin as at it.
#[test]
fn corrections_never_step_and_turn_the_robot_where_it_stands() {
    let (_, file) = bases()[1].clone();
    let localisation = localisation(&file, 5e-3, 5e-3);
    let far = Pose::new(100.0, -50.0, 0.3);
    let mut led = Led::<f64, 64>::start(&localisation, Encoded::new(&file, far));
    let dt = 0.01;
    let (step_m, step_rad) = localisation.largest_step(dt);
    let (mut before, mut most) = (far, (0.0_f64, 0.0_f64));
    let mut fused = 0;
    for k in 0..3000_i32 {
        let side = if (k / 500) % 2 == 0 { 1.0 } else { -1.0 };
        let at = led.localiser.pose();
        let given = fix(at.x + side * 24e-3, at.y, at.theta + side * 24e-3, 0.0);
        let given = (k % 5 == 0).then_some(given);
        let counts = led.robot.counts();
        let estimate = led
            .localiser
            .update::<Libm>(counts, dt, given.as_ref())
            .expect("accepted");
        fused += u32::from(estimate.fix == FixOutcome::Fused);
        let pose = estimate.measured.pose;
        most.0 = most.0.max((pose.x - before.x).abs());
        most.1 = most.1.max((pose.theta - before.theta).abs());
        // Turned by as much as the position moved along x, but across not at all.
        assert!((pose.y - far.y).abs() < 1e-9, "{pose:?}");
        before = pose;
    }
    println!(
        "{fused} fused; steps of {:.3} mm of {:.3}, {:.3} mrad of {:.3}",
        1e3 * most.0,
        1e3 * step_m,
        1e3 * most.1,
        1e3 * step_rad
    );
    assert!(fused > 500);
    assert!(most.0 <= step_m * (1.0 + 1e-6) && most.1 <= step_rad * (1.0 + 1e-6));
    // The statement is not idle: half of it happens. 0.5 mm a tick in all.
    assert!(most.0 > 0.5 * step_m && step_m < 5e-4);
    assert!(most.1 > 0.5 * step_rad && step_rad < 5e-4);
}

/// Odometry alone is odometry, bit for bit, and says that it takes no fixes.
#[test]
fn without_fusion_it_is_odometry() {
    let (_, file) = bases()[1].clone();
    let odometry = odometry(&file, SPEED);
    let params = LocaliserParams {
        odometry,
        fusion: None,
        gyro: None,
    };
    let localisation = params.validate_with::<Libm>().expect("valid");
    let mut led = Led::<f64, 2>::start(&localisation, Encoded::new(&file, Pose::default()));
    let mut plain =
        controller_core::odometry::Odometry::new(&odometry, Pose::default(), led.robot.counts())
            .expect("in range");
    let mut source = Source::exact();
    let mut refused = 0;
    for k in 0..500 {
        if k == 250 {
            led.localiser.set_pose(Pose::new(1.0, 2.0, 3.0));
            plain.set_pose(Pose::new(1.0, 2.0, 3.0));
        }
        let estimate = led.advance::<Libm>(Twist::new(0.5, 0.3), 0.01, &mut source);
        assert_eq!(
            estimate.measured,
            plain.update::<Libm>(led.robot.counts(), 0.01)
        );
        assert_eq!(led.localiser.back_emf_speeds(), plain.back_emf_speeds());
        assert!(!estimate.stale && !estimate.jumped);
        if estimate.fix != FixOutcome::Absent {
            assert_eq!(estimate.fix, FixOutcome::Refused(Refusal::NoFusion));
            refused += 1;
        }
    }
    // 20 a second, for 5 s; the last may be under way.
    assert!((99..=100).contains(&refused), "{refused}");
    assert_eq!(localisation.filtered_noise_m(), 0.0);
}
