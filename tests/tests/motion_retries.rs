//! Stuck beside the goal: a bounded number of new approaches, then a typed outcome and rest.

use controller_core::maths::Libm;
use controller_core::motion::{MotionParams, Outcome, Task, ValidMotionParams};
use controller_core::shunting::ExactMean;
use controller_core::types::Pose;
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, Order, hand_over_states, ring};
use tests::motion_tracking::Exact;
use tests::random::Random;
use tests::stated::{At, Stated};

const BASE: Base = Base::STANDARD;
const HOME: Order = Task::Park(Pose::new(0.0, 0.0, 0.0));
/// Standard deviation of noisy poses \[m\].
const SIGMA: f64 = 2e-3;

fn noisy_base(tolerance_m: f64, retries: u8) -> ValidMotionParams<f64> {
    let mut params = BASE.exact().with_pose_noise(SIGMA);
    params.arrival.distance_m = tolerance_m;
    params.arrival.retries = retries;
    params.validate().expect("valid")
}

/// A row of the table of `docs/motion.md`.
fn state(label: &str, measured: &[f64]) {
    Stated::of("docs/motion.md").exactly(At::Row("9. Retries", label), measured);
}

/// A tick with a noisy pose.
fn noisy_tick(drive: &mut Exact, random: &mut Random, order: &Order) {
    let last = drive.applied();
    drive.coast(&Default::default());
    let mut measured = drive.body.measured::<f64>();
    // Uniform within ±√3 σ has standard deviation σ.
    measured.pose.x += random.within(3.0_f64.sqrt() * SIGMA);
    measured.pose.y += random.within(3.0_f64.sqrt() * SIGMA);
    let limits = drive.controller.motion();
    let limits = (
        limits.force_rate_limit() * drive.dt,
        limits.moment_rate_limit() * drive.dt,
    );
    drive.take(order, &measured);
    let now = drive.applied();
    // Driving out and coming back are new goals: no step of the torque.
    assert!(
        (now.force - last.force).abs() <= limits.0 && (now.moment - last.moment).abs() <= limits.1
    );
}

/// From every hand-over state with noise: outcomes are final, retries bounded, and at the end the robot stands.
#[test]
fn noise_ends_parked_or_told() {
    for tolerance in [5e-3, 1e-4] {
        for retries in [0, 2] {
            let motion = noisy_base(tolerance, retries);
            let starts: Vec<(u64, Body)> = (0..).zip(hand_over_states()).collect();
            let runs = on_all_cores(&starts, |(k, body)| {
                let mut random = Random(0x5EED_0100 + k);
                let mut drive = Exact::start(&motion, BASE, *body, &HOME, 0.01);
                let (mut final_s, mut last, mut still) = (0.0, Outcome::Driving, 0.0_f64);
                while drive.t < 90.0 {
                    noisy_tick(&mut drive, &mut random, &HOME);
                    let report = drive.report();
                    assert!(report.retries <= retries);
                    if report.outcome != last {
                        (final_s, last) = (drive.t, report.outcome);
                    }
                    if drive.t > 70.0 {
                        still = still
                            .max(drive.body.twist.linear.abs() + drive.body.twist.angular.abs());
                    }
                }
                let left = drive.error(&HOME);
                (
                    last,
                    final_s,
                    drive.report().retries,
                    left.x.hypot(left.y),
                    still,
                )
            });
            let count = |desired| runs.iter().filter(|run| run.0 == desired).count();
            let (parked, gave_up) = (count(Outcome::Parked), count(Outcome::OutOfTolerance));
            let latest = runs.iter().fold(0.0_f64, |most, run| most.max(run.1));
            let left = runs.iter().fold(0.0_f64, |most, run| most.max(run.3));
            let still = runs.iter().fold(0.0_f64, |most, run| most.max(run.4));
            println!(
                "tolerance {} mm, {retries} retries: {parked} parked, {gave_up} out of tolerance, by {latest:.1} s, left {:.1} mm, \
                 speed {still:.1e}",
                1e3 * tolerance,
                1e3 * left
            );
            assert_eq!(parked + gave_up, runs.len());
            // Rest: the desired twist is zero, and no pose enters the command any more.
            assert!(still < 1e-9, "{still}");
            // Within the noise radius of 5 σ, even if not within the tolerance.
            assert!(left < 5.0 * SIGMA);
            assert!(latest < 60.0);
            let label = match (tolerance < 1e-3, retries) {
                (false, _) => "90 states, σ = 2 mm, tolerance 5 mm, 0 or 2 retries",
                (true, 0) => "the same, tolerance 0.1 mm, 0 retries",
                (true, _) => "the same, 2 retries",
            };
            state(label, &[parked as f64, gave_up as f64, latest, 1e3 * left]);
        }
    }
}

/// Without noise no start of the ring ever needs a retry.
#[test]
fn exact_poses_need_no_retry() {
    for (base, end_s) in [
        (Base::STANDARD, 20.0),
        (Base::SMALL, 20.0),
        (Base::WEAK, 90.0),
    ] {
        let motion = base.exact().validate().expect("valid");
        let starts = ring();
        assert_eq!(starts.len(), 1152);
        let runs = on_all_cores(&starts, |body| {
            let mut drive = Drive::<f64, Libm, ExactMean>::start(&motion, base, *body, &HOME, 0.01);
            // How far beyond its tolerance the heading was when a rest ended by itself.
            let (mut beyond, mut was_parked) = (None, false);
            while drive.t < end_s {
                let parked = drive.advance(|_| HOME).outcome == Outcome::Parked;
                if was_parked && !parked {
                    let off = drive.error(&HOME).theta.abs();
                    beyond = Some(off - motion.params().arrival.heading_rad);
                }
                was_parked = parked;
            }
            (drive.report().retries, drive.report().outcome, beyond)
        });
        let ended: Vec<f64> = runs.iter().filter_map(|run| run.2).collect();
        let beyond = ended.iter().fold(0.0_f64, |most, off| most.max(*off));
        println!(
            "{} kg, {} N m: {} rests ended by themselves, {:.2} mrad beyond the tolerance",
            base.mass,
            base.limits.wheel_torque_nm,
            ended.len(),
            1e3 * beyond
        );
        // The stop is predicted: it may err now and then, by less than the tolerance itself.
        assert!(ended.len() < 40 && beyond < motion.params().arrival.heading_rad);
        if base.mass == BASE.mass && base.limits == BASE.limits {
            Stated::of("docs/motion.md").exactly(
                At::Phrase("errs in # of the # starts, the heading then is up to # mrad beyond"),
                &[ended.len() as f64, starts.len() as f64, 1e3 * beyond],
            );
        }
        let tried: Vec<_> = starts
            .iter()
            .zip(&runs)
            .filter(|(_, run)| (run.0, run.1) != (0, Outcome::Parked))
            .collect();
        assert!(
            tried.is_empty(),
            "{base:?}: {} {:?}",
            tried.len(),
            tried.first()
        );
    }
}

/// Also not one that starts at the goal and looks elsewhere.
#[test]
fn turning_in_place_is_no_retry() {
    let motion = BASE.exact().validate().expect("valid");
    for k in 0..24 {
        let body = Body::at(0.0, 0.0, std::f64::consts::PI * f64::from(k) / 12.0);
        let mut drive = Exact::start(&motion, BASE, body, &HOME, 0.01);
        while drive.t < 30.0 {
            drive.advance(|_| HOME);
        }
        assert_eq!(drive.report().outcome, Outcome::Parked, "{k}");
        assert_eq!(drive.report().retries, 0, "{k}");
    }
}

fn given_up() -> (Exact, Random) {
    let motion = noisy_base(1e-4, 1);
    let mut random = Random(0x5EED_0101);
    let mut drive = Exact::start(&motion, BASE, Body::at(-0.4, 0.1, 0.0), &HOME, 0.01);
    while drive.t < 60.0 && drive.report().outcome != Outcome::OutOfTolerance {
        noisy_tick(&mut drive, &mut random, &HOME);
    }
    assert_eq!(drive.report().outcome, Outcome::OutOfTolerance);
    (drive, random)
}

/// The outcome stays: the robot may be pushed as it likes. A new goal is a new beginning.
#[test]
fn giving_up_is_final_until_a_new_task() {
    let (mut drive, mut random) = given_up();
    assert_eq!(drive.report().retries, 1);
    drive.body.pose.x += 0.3;
    let until = drive.t + 5.0;
    while drive.t < until {
        noisy_tick(&mut drive, &mut random, &HOME);
        assert_eq!(drive.report().outcome, Outcome::OutOfTolerance);
    }
    let other = Task::Park(Pose::new(1.0, 0.0, 0.0));
    noisy_tick(&mut drive, &mut random, &other);
    assert_eq!(drive.report().outcome, Outcome::Driving);
    assert_eq!(drive.report().retries, 0);
}

/// With the tolerance that the noise asks for everything parks at once, at any noise.
#[test]
fn stated_noise_sets_what_follows_from_it() {
    let plain: MotionParams<f64> = BASE.exact();
    assert_eq!(plain.with_pose_noise(0.0), plain);
    for sigma in [1e-3, 5e-3, 0.02] {
        let params = plain.with_pose_noise(sigma);
        let gains = &params.gains;
        // The heading that following makes of the noise: at most 0.03 rad, the same as 2 mm with plain gains.
        let heading = gains.lateral * sigma / (2.0 * gains.heading * gains.slow);
        assert!(heading <= 0.03 + 1e-12, "{heading}");
        assert!(gains.slow >= plain.gains.slow);
        assert!(params.arrival.distance_m >= 8.0 * sigma);
        assert!(params.validate().is_ok());
    }
    assert!(plain.with_pose_noise(f64::NAN).validate().is_err());
    assert!(plain.with_pose_noise(-1.0).validate().is_err());
}

/// A heading that is noisier than its tolerance ends every rest. That too comes to an end.
#[test]
fn noisy_heading_comes_to_an_end() {
    let motion = BASE.exact().validate().expect("valid");
    let (mut parked, mut gave_up) = (0, 0);
    for seed in 0..20 {
        let mut random = Random(0x5EED_0200 + seed);
        let mut drive = Exact::start(&motion, BASE, Body::at(-0.4, 0.1, 0.0), &HOME, 0.01);
        let (mut outcomes, mut last) = (0, Outcome::Driving);
        while drive.t < 200.0 {
            drive.coast(&Default::default());
            let mut measured = drive.body.measured::<f64>();
            // A standard deviation of 0.87 mrad, where 0.91 end a rest.
            measured.pose.theta += random.within(1.5e-3);
            let outcome = drive.take(&HOME, &measured).outcome;
            if drive.t > 150.0 {
                outcomes += u32::from(outcome != last);
            }
            last = outcome;
        }
        println!("{last:?}, {} retries", drive.report().retries);
        assert_eq!(outcomes, 0);
        parked += u32::from(last == Outcome::Parked);
        gave_up += u32::from(last == Outcome::OutOfTolerance);
    }
    let label = "heading noise of 0.87 mrad against a tolerance of 0.7: 20 runs";
    state(label, &[f64::from(parked), f64::from(gave_up)]);
}
