//! Jumps of task, goal, reference and localisation: per tick the wrench changes by at most L dt.

use std::f64::consts::PI;

use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{JumpThreshold, SaturationPolicy, Task, ValidMotionParams};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Pose, Twist, Wrench};
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body, pose};
use tests::motion_loop::{Drive, Order, steady};
use tests::motion_tracking::Exact;
use tests::random::Random;
use tests::stated::{At, Stated};
use tests::tolerance::MOTION_RATE;

/// What a fuzzed run came to, in shares of L.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    force: f64,
    moment: f64,
    /// Of twice L, in the norm of the harder worked wheel, while wheels are at their limit.
    saturated: f64,
    events: u32,
}

/// A random order near the robot.
fn order(random: &mut Random, body: &Body, t: f64) -> (ConstantTwist<f64>, f64, bool) {
    let parks = random.within(1.0) < 0.0;
    let reach = if parks { 2.0 } else { 0.5 };
    let start = Pose::new(
        body.pose.x + random.within(reach),
        body.pose.y + random.within(reach),
        body.pose.theta + random.within(if parks { PI } else { 1.0 }),
    );
    let twist = Twist::new(random.within(1.5), random.within(1.0));
    (ConstantTwist { start, twist }, t, parks)
}

/// Ticks of a run.
const TICKS: u32 = 200_000;

/// Largest push, as a share of the largest force and of the largest moment.
const MOST: f64 = 0.25;

/// Changes of task, goal, reference and localisation at random ticks; where they are declared, wheels that slide as well.
fn fuzz<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    base: Base,
    (declared, pushed): (bool, bool),
    dt: f64,
    ticks: u32,
) -> Shares {
    let motion: ValidMotionParams<T> = base.params::<T, M>().validate().expect("valid");
    let largest = (
        motion.largest_force().to_f64(),
        motion.largest_moment().to_f64(),
    );
    let mut limits = (
        motion.force_rate_limit().to_f64() * dt,
        motion.moment_rate_limit().to_f64() * dt,
    );
    let mut push = Wrench::default();
    if pushed {
        // L is for a robot that nobody pushes: a push changes v by d/m dt more, and the speed loop answers.
        let gains = motion.gains();
        limits.0 += gains.speed_loop.to_f64() * MOST * largest.0 * dt;
        limits.1 += gains.turn_loop.to_f64() * MOST * largest.1 * dt;
    }
    let both = 2.0 * Base::wheel_norm(limits.0, limits.1);
    let mut random = Random(0x5EED_0005);
    let start = Body::default();
    let mut plan = order(&mut random, &start, 0.0);
    let mut offset = Pose::default();
    let now = |plan: &(ConstantTwist<f64>, f64, bool), t: f64| -> Order {
        if plan.2 {
            Task::Park(plan.0.start)
        } else {
            Task::Follow(plan.0.at::<Libm>(t - plan.1))
        }
    };
    let mut drive = Drive::<T, M, U>::start(&motion, base, start, &now(&plan, 0.0), dt);
    let mut seen = Shares::default();
    let (mut last, mut was_saturated) = (drive.applied(), false);
    for tick in 0..ticks {
        drive.coast(&push);
        if declared && tick % 50 == 0 {
            drive.controller.declare_slide();
        }
        if pushed && random.within(1.0) < -0.99 {
            let mut share = |largest: f64| {
                let share = 0.175 + random.within(MOST - 0.175);
                share * largest * random.within(1.0).signum()
            };
            push = Wrench {
                force: share(largest.0),
                moment: share(largest.1),
            };
        }
        if random.within(1.0) < -0.98 {
            seen.events += 1;
            match (random.within(1.0) + 1.0) * 1.5 {
                0.0..1.0 => plan = order(&mut random, &drive.body, drive.t),
                1.0..2.0 => {
                    offset =
                        Pose::new(random.within(0.25), random.within(0.25), random.within(0.5));
                }
                _ => plan.0.start.x += random.within(0.3),
            }
            if declared {
                drive.controller.declare_jump();
            }
        }
        let mut measured = drive.body.measured::<T>();
        let (at, off) = (&drive.body.pose, &offset);
        measured.pose = pose(&Pose::new(at.x + off.x, at.y + off.y, at.theta + off.theta));
        let saturated = drive.take(&now(&plan, drive.t), &measured).limited.torque;
        let applied = drive.applied();
        let (f, n) = (applied.force - last.force, applied.moment - last.moment);
        if saturated || was_saturated {
            seen.saturated = seen.saturated.max(Base::wheel_norm(f, n) / both);
        } else {
            seen.force = seen.force.max(f.abs() / limits.0);
            seen.moment = seen.moment.max(n.abs() / limits.1);
        }
        (last, was_saturated) = (applied, saturated);
    }
    seen
}

/// Base by base, declared or not, at 10 ms and 1 ms, in both precisions.
#[test]
fn wrench_changes_by_at_most_l_dt() {
    // Wheels that saturate often.
    let limits = controller_core::motion::Limits {
        wheel_torque_nm: 4.0,
        ..Base::STANDARD.limits
    };
    let tight = Base {
        limits,
        ..Base::STANDARD
    };
    let mut cases = Vec::new();
    for declared in [true, false] {
        for dt in [0.01, 0.001] {
            for (name, base) in [
                ("standard", Base::STANDARD),
                ("small", Base::SMALL),
                ("weak", Base::WEAK),
                ("keep curvature", tight),
                ("turn first", tight.with_policy(SaturationPolicy::TurnFirst)),
                (
                    "drive first",
                    tight.with_policy(SaturationPolicy::DriveFirst),
                ),
            ] {
                cases.push((name, base, declared, dt));
            }
        }
    }
    let runs = on_all_cores(&cases, |(_, base, declared, dt)| {
        let double = fuzz::<f64, Libm, ExactMean>(*base, (*declared, false), *dt, TICKS);
        let single = fuzz::<f32, Single, RationalMean>(*base, (*declared, false), *dt, TICKS);
        (double, single)
    });
    let (mut most, mut saturated) = (0.0_f64, 0.0_f64);
    for ((name, _, declared, dt), (double, single)) in cases.iter().zip(runs) {
        println!("{name}, declared {declared}, {dt} s: {double:.3?} {single:.3?}");
        for (run, slack) in [(double, MOTION_RATE.0), (single, MOTION_RATE.1)] {
            assert!(run.events > 1500);
            assert!(run.force <= 1.0 + slack, "{name}: {run:?}");
            assert!(run.moment <= 1.0 + slack, "{name}: {run:?}");
            assert!(run.saturated <= 1.0 + slack, "{name}: {run:?}");
            most = most.max(run.force).max(run.moment);
            saturated = saturated.max(run.saturated);
        }
    }
    let mut page = Stated::of("docs/motion.md");
    page.exactly(
        At::Phrase("# million ticks of 10 and 1 ms in each precision: at most # of L dt, and # of twice that"),
        &[cases.len() as f64 * f64::from(TICKS) / 1e6, most, saturated],
    );
    let motion: ValidMotionParams<f64> = Base::STANDARD.exact().validate().expect("valid");
    page.exactly(
        At::Phrase("L_F = # N/s, L_N = # N m/s"),
        &[motion.force_rate_limit(), motion.moment_rate_limit()],
    );
}

/// The same while pushes of 10 to 25 % of the largest force and moment come, change sign and go on: beyond L by what a
/// push does to the speed loop, and no more, although the estimate works at its bound.
#[test]
fn wrench_changes_by_at_most_l_dt_under_pushes() {
    let cases = [
        ("standard", Base::STANDARD, true, 0.01),
        ("standard", Base::STANDARD, false, 0.001),
        ("small", Base::SMALL, false, 0.01),
        ("weak", Base::WEAK, true, 0.01),
    ];
    let runs = on_all_cores(&cases, |(_, base, declared, dt)| {
        let how = (*declared, true);
        let double = fuzz::<f64, Libm, ExactMean>(*base, how, *dt, TICKS);
        let single = fuzz::<f32, Single, RationalMean>(*base, how, *dt, TICKS);
        (double, single)
    });
    let mut most = 0.0_f64;
    for ((name, _, declared, dt), (double, single)) in cases.iter().zip(runs) {
        println!("pushed, {name}, declared {declared}, {dt} s: {double:.3?} {single:.3?}");
        for (run, slack) in [(double, MOTION_RATE.0), (single, MOTION_RATE.1)] {
            assert!(run.events > 1500);
            assert!(run.force <= 1.0 + slack, "{name}: {run:?}");
            assert!(run.moment <= 1.0 + slack, "{name}: {run:?}");
            assert!(run.saturated <= 1.0 + slack, "{name}: {run:?}");
            most = most.max(run.force).max(run.moment);
        }
    }
    Stated::of("docs/motion.md").exactly(
        At::Phrase("# million ticks in each precision: at most # of (L + κ D′) dt"),
        &[cases.len() as f64 * f64::from(TICKS) / 1e6, most],
    );
}

/// A parameter set with a threshold for jumps.
fn watchful() -> ValidMotionParams<f64> {
    let mut params = Base::STANDARD.exact();
    params.pose_noise_m = 2e-3;
    params.jump = Some(JumpThreshold {
        distance_m: 0.05,
        heading_rad: 0.1,
    });
    params.validate().expect("valid")
}

/// Follows an arc, then parks, with poses up to `noise` off; at `jump_s` they are 0.25 m off for good.
fn noisy(motion: &ValidMotionParams<f64>, noise: f64, jump_s: f64) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random(0x5EED_0006);
    let path = steady(0.4, 0.15);
    let orders = |t: f64| -> Order {
        if t < 10.0 {
            path(t)
        } else {
            Task::Park(Pose::new(2.66, 2.48, 1.5))
        }
    };
    let mut drive = Exact::start(
        motion,
        Base::STANDARD,
        Body::at(0.0, 0.2, 0.0),
        &path(0.0),
        0.01,
    );
    let (mut jumps, mut moments) = (Vec::new(), Vec::new());
    while drive.t < 20.0 {
        drive.coast(&Default::default());
        let mut measured = drive.body.measured::<f64>();
        measured.pose.x += random.within(noise);
        measured.pose.y += random.within(noise);
        measured.pose.theta += random.within(noise);
        if drive.t >= jump_s {
            measured.pose.y += 0.25;
        }
        if drive.take(&orders(drive.t), &measured).jumped {
            jumps.push(drive.t);
        }
        moments.push(drive.report().torques.right);
    }
    (jumps, moments)
}

/// Noise of 6 mm and 6 mrad below a threshold of 5 cm: only the change of task counts, and every torque is the same as
/// without a threshold.
#[test]
fn noise_below_the_threshold_passes_untouched() {
    let motion = watchful();
    let mut params = *motion.params();
    params.jump = None;
    let blind = params.validate().expect("valid");
    let (jumps, moments) = noisy(&motion, 6e-3, f64::INFINITY);
    assert_eq!(jumps.len(), 1, "{jumps:?}");
    assert!((jumps[0] - 10.0).abs() < 0.02);
    assert_eq!(moments, noisy(&blind, 6e-3, f64::INFINITY).1);
}

/// A jump of 25 cm is seen, once, while following and while parking.
#[test]
fn jump_beyond_the_threshold_is_seen_once() {
    for at in [5.0, 14.0] {
        let (jumps, _) = noisy(&watchful(), 6e-3, at);
        assert_eq!(jumps.len(), 2, "{jumps:?}");
        assert!(jumps.iter().any(|t| (t - at).abs() < 0.02), "{jumps:?}");
    }
}

/// A new trajectory while parking, a new goal while following, and back: torque goes on, and the robot arrives.
#[test]
fn back_from_parking_to_tracking() {
    let base = Base::STANDARD;
    let motion = base.exact().validate().expect("valid");
    let line = |t: f64, from: f64| -> Order {
        Task::Follow(Reference::new_with::<Libm>(
            Pose::new(0.4 * (t - from), 1.0, 0.0),
            Twist::new(0.4, 0.0),
            Default::default(),
        ))
    };
    let orders = |t: f64| match t {
        0.0..3.0 => Task::Park(Pose::new(1.0, 1.0, 0.5)),
        3.0..5.0 => Task::Park(Pose::new(-1.0, 0.5, 0.0)),
        _ => line(t, 5.0),
    };
    let mut drive = Exact::start(&motion, base, Body::default(), &orders(0.0), 0.01);
    let mut last = drive.applied();
    while drive.t < 30.0 {
        drive.advance(orders);
        let applied = drive.applied();
        if drive.report().jumped {
            // One tick of ordinary change: far less than L dt.
            assert!(
                (applied.moment - last.moment).abs() < 0.5 * motion.moment_rate_limit() * drive.dt
            );
        }
        last = applied;
    }
    assert!(drive.error(&orders(drive.t)).y.abs() < 1e-3);
}
