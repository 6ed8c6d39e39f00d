//! The localiser against an oracle that shares nothing with it, tick by tick.

use controller_core::hal::WheelCounts;
use controller_core::localiser::{
    Estimate, Fix, FixOutcome, FusionParams, Localiser, LocaliserParams, Refusal,
};
use controller_core::maths::Libm;
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::robot::Robot;
use controller_core::types::{Accel, Pose};
use controller_core::wheels::WheelGeometry;
use nalgebra::{Vector2, Vector3};
use tests::oracle::localiser::fusion::Taken;
use tests::oracle::localiser::{self as oracle, Body, Constants};
use tests::random::Random;
use tests::tolerance::LOCALISER_ORACLE;

/// Drives, each on its own base with its own source.
const DRIVES: u64 = 300;
/// Ticks of each.
const TICKS: usize = 6_000;
/// Poses remembered.
const REMEMBERED: usize = 32;

fn posture(pose: &Pose<f64>) -> Vector3<f64> {
    Vector3::new(pose.x, pose.y, pose.theta)
}

fn factor(random: &mut Random, most: f64) -> f64 {
    most.powf(random.within(1.0))
}

/// One in `n`, by the generator's state.
fn one_in(n: u64, random: &Random) -> bool {
    (random.0 / 64).is_multiple_of(n)
}

/// A base with encoders of few or many counts, and a source of rare or frequent poses.
fn draw(random: &mut Random) -> LocaliserParams<f64> {
    let radius = 0.05 * factor(random, 3.0);
    let mut fusion = FusionParams::for_source(
        3e-3 * factor(random, 5.0),
        3e-3 * factor(random, 5.0),
        10.0 * factor(random, 5.0),
    );
    fusion.bandwidth *= factor(random, 2.0);
    fusion.heading_bandwidth *= factor(random, 2.0);
    fusion.drift = [0.0, 0.02, 0.1][(random.0 % 3) as usize];
    fusion.slide_m_s = [0.0, 0.5][(random.0 / 3 % 2) as usize];
    LocaliserParams {
        odometry: OdometryParams {
            wheels: WheelGeometry {
                radius_right_m: radius,
                radius_left_m: radius,
                track_m: 0.3 * factor(random, 2.0),
            },
            calibration: Calibration {
                right: factor(random, 1.05),
                left: factor(random, 1.05),
                track: factor(random, 1.05),
            },
            counts_per_turn: 600.0 * factor(random, 10.0),
            bandwidth: 50.0 * factor(random, 2.0),
        },
        fusion: Some(fusion),
        gyro: None,
    }
}

fn constants(params: &LocaliserParams<f64>) -> Constants {
    let odometry = &params.odometry;
    let (wheels, calibration) = (&odometry.wheels, &odometry.calibration);
    let fusion = params.fusion.as_ref().expect("with fixes");
    Constants {
        radius: Vector2::new(
            wheels.radius_right_m * calibration.right,
            wheels.radius_left_m * calibration.left,
        ),
        track: wheels.track_m * calibration.track,
        counts_per_turn: odometry.counts_per_turn,
        omega: odometry.bandwidth,
        remembered: REMEMBERED,
        sigma: (fusion.noise_m, fusion.noise_rad),
        rate: fusion.rate_hz,
        bandwidth: (fusion.bandwidth, fusion.heading_bandwidth),
        gate: fusion.gate,
        relocalise_after: u32::from(fusion.relocalise_after),
        drift: fusion.drift,
        slide: fusion.slide_m_s,
        stale: fusion.stale_s,
        robot: None,
    }
}

/// Two of three robots have tyres, and bodies from light to hard to turn.
fn draw_robot(params: &LocaliserParams<f64>, random: &mut Random) -> Option<Robot<f64>> {
    let (mass_kg, spread) = (10.0 * factor(random, 10.0), factor(random, 8.0));
    let wheels = params.odometry.wheels;
    (!one_in(3, random)).then_some(Robot {
        mass_kg,
        inertia_kg_m2: spread * mass_kg * (wheels.track_m / 2.0).powi(2),
        wheels,
    })
}

/// How often a drive met what.
#[derive(Debug, Default)]
struct Met {
    fused: u32,
    rejected: u32,
    relocalised: u32,
    too_old: u32,
    stale: u32,
    rests: u32,
    slipping: u32,
    worst: (f64, &'static str, f64),
}

fn drive(seed: u64, met: &mut Met) {
    let mut random = Random(seed);
    let params = draw(&mut random);
    let mut k = constants(&params);
    let mut valid = params.validate_with::<Libm>().expect("within the ranges");
    if let Some(robot) = draw_robot(&params, &mut random) {
        let bandwidth = 6.0 * factor(&mut random, 3.0);
        valid = valid
            .with_robot(&robot, bandwidth)
            .expect("within the ranges");
        k.robot = Some(Body {
            mass: robot.mass_kg,
            inertia: robot.inertia_kg_m2,
            track: robot.wheels.track_m,
            bandwidth,
        });
    }
    let start = Pose::new(random.within(3.0), random.within(3.0), random.within(6.0));
    // Near the wrap-around, which is met.
    let mut counts = WheelCounts {
        right: i32::MAX - 300,
        left: i32::MIN + 300,
    };
    let mut core = Localiser::<f64, REMEMBERED>::start(&valid, start, counts).expect("finite");
    let mut other = oracle::Localiser::start(k, posture(&start), [counts.right, counts.left]);
    let per_count = k.radius * (std::f64::consts::TAU / k.counts_per_turn);
    let (mut travelled, mut speed, mut aim) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    let (mut lie, mut silent) = (Vector3::zeros(), false);
    for tick in 0..TICKS {
        let dt = 0.01 * factor(&mut random, 1.5);
        if tick % 300 == 0 {
            // Fast, at a count in many ticks, at rest; at times both wheels alike.
            let scale = [1.0, 0.01, 0.1, 0.0][(random.0 / 5 % 4) as usize];
            aim = [random.within(scale), random.within(scale)];
            silent = one_in(7, &random);
            if one_in(3, &random) {
                lie = Vector3::new(random.within(0.5), random.within(0.5), random.within(2.0));
            }
        }
        let mut accel = [0.0; 2];
        for i in 0..2 {
            let last = speed[i];
            speed[i] += (aim[i] - last) * 0.1;
            accel[i] = (speed[i] - last) / dt;
            travelled[i] += speed[i] * dt / per_count[i];
            // A false edge now and then.
            let edge = if one_in(997, &random) { 1.0 } else { 0.0 };
            let whole = (travelled[i] + edge).floor();
            travelled[i] -= whole;
            let count = if i == 0 {
                &mut counts.right
            } else {
                &mut counts.left
            };
            *count = count.wrapping_add(whole as i32);
            random.within(1.0);
        }
        let given = Vector2::new(
            (accel[0] + accel[1]) / 2.0 + random.within(0.05),
            (accel[0] - accel[1]) / k.track,
        );
        let fix = (!silent && random.within(1.0).abs() < k.rate * dt).then(|| {
            let near = posture(core.pose());
            let wild = one_in(11, &random);
            let noise = if wild { 40.0 } else { 0.5 };
            let (m, rad) = (noise * k.sigma.0, noise * k.sigma.1);
            oracle::Fix {
                q: near
                    + 0.02 * lie
                    + Vector3::new(random.within(m), random.within(m), random.within(rad)),
                age: 0.2 * random.within(1.0).abs().powi(2),
            }
        });
        let same = fix.map(|fix| Fix {
            pose: Pose::new(fix.q.x, fix.q.y, fix.q.z),
            age_s: fix.age,
        });
        if tick % 1_777 == 1_776 {
            let pose = Pose::new(random.within(3.0), random.within(3.0), random.within(6.0));
            core.set_pose(pose);
            other.set(posture(&pose));
        }
        let found = core
            .update_with_accel::<Libm>(counts, dt, &Accel::new(given.x, given.y), same.as_ref())
            .expect("finite");
        let expected = other.tick([counts.right, counts.left], dt, &given, fix.as_ref());
        compare((seed, tick), &found, &expected, met);
        if one_in(50, &random) {
            // Outliers that agree with each other, for a while.
            lie = -lie * 30.0;
            lie = lie.map(|x| x.clamp(-60.0, 60.0));
        }
    }
}

fn compare(at: (u64, usize), found: &Estimate<f64>, expected: &oracle::Estimate, met: &mut Met) {
    let outcome = match found.fix {
        FixOutcome::Absent => oracle::Outcome::Absent,
        FixOutcome::Fused => oracle::Outcome::Taken(Taken::Fused),
        FixOutcome::Rejected => oracle::Outcome::Taken(Taken::Rejected),
        FixOutcome::Relocalised => oracle::Outcome::Taken(Taken::Relocalised),
        FixOutcome::Refused(Refusal::TooOld { oldest_s }) => oracle::Outcome::TooOld(oldest_s),
        FixOutcome::Refused(refusal) => panic!("{at:?}: {refusal:?}"),
    };
    match (outcome, expected.outcome) {
        (oracle::Outcome::TooOld(a), oracle::Outcome::TooOld(b)) => {
            assert!((a - b).abs() < LOCALISER_ORACLE, "{at:?}: {a} {b}");
        }
        (a, b) => assert_eq!(a, b, "{at:?}: {found:?} {expected:?}"),
    }
    let relocalised = found.fix == FixOutcome::Relocalised;
    assert_eq!(
        (found.jumped, found.stale),
        (relocalised, expected.stale),
        "{at:?}"
    );
    let (pose, twist) = (&found.measured.pose, &found.measured.twist);
    for (name, a, b) in [
        ("x", pose.x, expected.q.x),
        ("y", pose.y, expected.q.y),
        ("theta", pose.theta, expected.q.z),
        ("v", twist.linear, expected.twist.x),
        ("w", twist.angular, expected.twist.y),
        ("curvature bias", found.curvature_bias, expected.bias.x),
        ("turn bias", found.turn_bias, expected.bias.y),
        ("tyre slip", found.tyre_slip, expected.bias.z),
        ("age", found.fix_age_s, expected.age),
    ] {
        let off = (a - b).abs();
        assert!(
            off <= LOCALISER_ORACLE,
            "{at:?}: {name} {a:e} {b:e}; {found:?} {expected:?}"
        );
        if off > met.worst.0 {
            met.worst = (off, name, b);
        }
    }
    match found.fix {
        FixOutcome::Fused => met.fused += 1,
        FixOutcome::Rejected => met.rejected += 1,
        FixOutcome::Relocalised => met.relocalised += 1,
        FixOutcome::Refused(_) => met.too_old += 1,
        FixOutcome::Absent => {}
    }
    met.stale += u32::from(found.stale);
    met.slipping += u32::from(found.tyre_slip > 0.0);
    met.rests += u32::from(twist.linear == 0.0 && twist.angular == 0.0);
}

/// Pose, twist, biases, age and judgement of every fix, in every tick of random drives.
#[test]
fn the_localiser_is_the_oracle_in_every_tick() {
    let mut met = Met::default();
    for seed in 0..DRIVES {
        drive(seed, &mut met);
    }
    println!("{met:?}");
    for count in [
        met.fused,
        met.rejected,
        met.relocalised,
        met.too_old,
        met.stale,
        met.rests,
        met.slipping,
    ] {
        assert!(count > 100, "{met:?}");
    }
}
