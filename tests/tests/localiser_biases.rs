//! Wheels that are not as large, or not as far apart, as stated: odometry learns a curvature bias and a turn bias from fixes.

use controller_core::localiser::{Estimate, ValidLocaliserParams};
use controller_core::maths::Libm;
use controller_core::types::{Pose, Twist};
use tests::check::assert_within;
use tests::encoded::{Encoded, bases};
use tests::fixes::Source;
use tests::led::Led;
use tests::localised::localisation;

const DT: f64 = 0.01;
/// Of the lab base \[m\].
const TRACK_M: f64 = 0.35;

/// The lab base, led by fixes, with a right wheel that is larger than believed by the share `wrong`.
fn led(localisation: &ValidLocaliserParams<f64>, wrong: f64) -> Led<f64, 64> {
    let mut led = Led::start(localisation, Encoded::new(&bases()[1].1, Pose::default()));
    led.robot.wheels.radius_right_m *= 1.0 + wrong;
    led
}

/// The same with sound wheels that stand further apart than believed by the share `wrong`.
fn wide(localisation: &ValidLocaliserParams<f64>, wrong: f64) -> Led<f64, 64> {
    let mut led = led(localisation, 0.0);
    led.robot.wheels.track_m *= 1.0 + wrong;
    led
}

/// With fixes of 5 mm and 5 mrad, and odometry that may be wrong by the share `drift`.
fn fused(drift: f64) -> ValidLocaliserParams<f64> {
    let mut params = *localisation(&bases()[1].1, 5e-3, 5e-3).params();
    if let Some(fusion) = &mut params.fusion {
        fusion.drift = drift;
    }
    params.validate_with::<Libm>().expect("valid")
}

/// Leads for `seconds`; `see` sees every estimate with its error.
fn lead(
    led: &mut Led<f64, 64>,
    twist: Twist<f64>,
    seconds: f64,
    source: &mut Source,
    mut see: impl FnMut(&Estimate<f64>, &Pose<f64>),
) {
    for _ in 0..(seconds / DT).round() as usize {
        let estimate = led.advance::<Libm>(twist, DT, source);
        assert!(!estimate.jumped);
        let off = led.off(&estimate);
        see(&estimate, &off);
    }
}

/// What is learnt in each tick of `seconds` past the camera of a seed.
fn learnt(
    mut led: Led<f64, 64>,
    twist: Twist<f64>,
    seconds: f64,
    seed: u64,
    bias: fn(&Estimate<f64>) -> f64,
) -> Vec<f64> {
    let mut biases = Vec::new();
    let mut source = Source::camera(seed);
    lead(&mut led, twist, seconds, &mut source, |estimate, _| {
        biases.push(bias(estimate));
    });
    biases
}

/// Largest error across and last curvature bias of 15 s at 0.4 m/s; of the former those of the last 3 s.
fn straight(localisation: &ValidLocaliserParams<f64>, wrong: f64, seed: u64) -> (f64, f64) {
    let mut led = led(localisation, wrong);
    let mut source = Source::camera(seed);
    let (mut worst, mut curvature_bias) = (0.0_f64, 0.0);
    let ahead = Twist::new(0.4, 0.0);
    lead(&mut led, ahead, 12.0, &mut source, |_, _| {});
    lead(&mut led, ahead, 3.0, &mut source, |estimate, off| {
        worst = worst.max(off.y.abs());
        curvature_bias = estimate.curvature_bias;
    });
    (worst, curvature_bias)
}

/// A radius that is 2 % larger turns the way by 0.02/(1.01 l). Learnt within 6 m, the pose no longer stays behind.
#[test]
fn a_wrong_radius_is_learnt_on_the_way() {
    let true_bias = 0.02 / (1.01 * TRACK_M);
    for seed in 1..=8 {
        let (off, curvature_bias) = straight(&fused(0.02), 0.02, seed);
        println!("{seed}: {curvature_bias:.4} of {true_bias:.4} rad/m, {off:.4} m aside");
        // 15 s are 300 fixes, and the time constant of each pole, 2/α, is 51: (1 + 5.9) e^-5.9 = 1.9 % are still to
        // come. Noise is 0.18 σ α^1.5/s, at 20 mm a fix 0.6 % of it; five times that.
        assert_within(
            curvature_bias,
            true_bias,
            0.05 * true_bias,
            "curvature bias",
        );
        // Noise: five of 0.7 mm, by the filter. Without a curvature bias 14 mm would be left: heading times way over bandwidth.
        assert!(off < 3.5e-3, "{off}");
    }
}

/// What was learnt stays when fixes do not come, and of the turn of 4 m of dead reckoning 5 % are left at most.
#[test]
fn what_was_learnt_outlasts_the_fixes() {
    let mut led = led(&fused(0.02), 0.02);
    let ahead = Twist::new(0.4, 0.0);
    lead(&mut led, ahead, 15.0, &mut Source::camera(1), |_, _| {});
    let mut last = Pose::default();
    lead(&mut led, ahead, 10.0, &mut Source::silent(), |_, off| {
        last = *off
    });
    // 0.23 rad without; noise of the heading at the last fix comes to it, five times 0.7 mrad.
    assert!(last.theta.abs() < 0.05 * 0.23 + 3.5e-3, "{last:?}");
}

/// Backward too, and then forward again, nothing has to be learnt anew: it is the same wheel.
#[test]
fn backward_is_the_same_curve() {
    let true_bias = 0.02 / (1.01 * TRACK_M);
    let mut led = led(&fused(0.02), 0.02);
    let mut source = Source::camera(2);
    for speed in [-0.4, 0.4] {
        let mut curvature_bias = 0.0;
        lead(
            &mut led,
            Twist::new(speed, 0.0),
            15.0,
            &mut source,
            |estimate, _| {
                curvature_bias = estimate.curvature_bias;
            },
        );
        assert_within(
            curvature_bias,
            true_bias,
            0.05 * true_bias,
            "curvature bias",
        );
    }
}

/// Odometry that is said to be exact is left alone, and where it is wrong all the same, fixes set the pose.
#[test]
fn exact_odometry_learns_nothing() {
    let mut led = led(&fused(0.0), 0.02);
    let mut source = Source::camera(1);
    for _ in 0..1000 {
        let estimate = led.advance::<Libm>(Twist::new(0.4, 0.0), DT, &mut source);
        assert_eq!((estimate.curvature_bias, estimate.turn_bias), (0.0, 0.0));
    }
}

/// Odometry that is worse than stated is learnt up to what was stated, and no further.
#[test]
fn the_curvature_is_bounded() {
    let most = 2.0 * 0.01 / TRACK_M;
    let ahead = Twist::new(0.4, 0.0);
    let biases = learnt(led(&fused(0.01), 0.04), ahead, 10.0, 3, |e| {
        e.curvature_bias
    });
    assert!(biases.iter().all(|bias| bias.abs() <= most));
    assert_eq!(biases.last(), Some(&most));
}

/// Noise on sound wheels shakes the curvature bias by less than a fifth of its bound at any speed, and not at all at rest.
#[test]
fn noise_teaches_little_and_nothing_at_rest() {
    let most = 2.0 * 0.02 / TRACK_M;
    for speed in [0.0, 0.002, 0.01, 0.05, 0.4, 1.2] {
        let mut led = led(&fused(0.02), 0.0);
        let (mut squares, mut count, mut moved) = (0.0, 0.0, 0.0_f64);
        lead(
            &mut led,
            Twist::new(speed, 0.0),
            60.0,
            &mut Source::camera(4),
            |estimate, _| {
                squares += estimate.curvature_bias * estimate.curvature_bias;
                count += 1.0;
                moved = moved.max(estimate.curvature_bias.abs());
            },
        );
        let rms = f64::sqrt(squares / count);
        println!("{speed} m/s: {:.4} of the bound", rms / most);
        assert!(rms < 0.2 * most, "{speed} m/s: {rms}");
        assert!(speed > 0.0 || moved == 0.0);
    }
}

/// What a track that is 2 % larger than believed takes from every turn.
const WIDE: f64 = 1.0 / 1.02 - 1.0;
/// What is still to come of that after 12 rad, where the chance of a radian weighs as much as what is known beforehand, a thirteenth; and noise,
/// five times that of two headings, 5 mrad each, of which the filter averages as many as are taken in half a radian, some 16: 0.15 mrad a rad.
const LEARNT: f64 = 0.02 / 13.0 + 5.0 * 1.5e-4;

/// A track that is 2 % larger is learnt in two turns, either way round and whatever the way, and stays learnt without fixes. On an arc a wheel of
/// another size does the same, so what the two biases add up to there is what counts.
#[test]
fn a_wrong_track_is_learnt_in_turns() {
    for (seed, twist) in [
        (1, Twist::new(0.0, 0.6)),
        (2, Twist::new(0.0, -0.6)),
        (3, Twist::new(0.4, 0.6)),
        (4, Twist::new(-0.4, 0.6)),
    ] {
        let mut led = wide(&fused(0.02), 0.02);
        let mut last = Estimate::default();
        let mut source = Source::camera(seed);
        lead(&mut led, twist, 20.0, &mut source, |estimate, _| {
            last = *estimate;
        });
        let radius = twist.linear / twist.angular;
        let learnt = last.turn_bias + radius * last.curvature_bias;
        println!("{seed}: {learnt:.4} of {WIDE:.4}");
        assert_within(learnt, WIDE, LEARNT, "turn per turn");
        // 6 rad without fixes: 0.12 rad without what was learnt.
        let before = led.off(&last).theta;
        let mut off = 0.0;
        lead(&mut led, twist, 10.0, &mut Source::silent(), |_, now| {
            off = now.theta
        });
        assert!((off - before).abs() < 6.0 * LEARNT, "{off} {before}");
    }
}

/// A wheel that is larger and a track that is wider are distinguished by turns to both sides.
#[test]
fn a_wrong_radius_and_a_wrong_track_are_told_apart() {
    let mut led = wide(&fused(0.02), 0.02);
    led.robot.wheels.radius_right_m *= 1.005;
    let true_bias = 0.005 / (1.0025 * 1.02 * TRACK_M);
    let mut last = Estimate::default();
    let mut source = Source::camera(6);
    for turn in [0.6, -0.6].repeat(4) {
        let twist = Twist::new(0.4, turn);
        lead(&mut led, twist, 10.0, &mut source, |estimate, _| {
            last = *estimate;
        });
    }
    // Each arc says what both do together, and of what arcs say a filter that expects chance in every radian remembers 10 rad, less than two arcs:
    // a sixth of the turn bias is left at most, and a fifth of the curvature bias.
    for (is, expected, share) in [
        (last.turn_bias, WIDE, 1.0 / 6.0),
        (last.curvature_bias, true_bias, 0.2),
    ] {
        println!("{is:.5} of {expected:.5}");
        assert_within(is, expected, share * expected.abs(), "bias");
    }
}

/// A track that is further off than odometry is said to be is learnt up to that.
#[test]
fn the_turn_bias_is_bounded() {
    let turning = Twist::new(0.0, 0.6);
    let biases = learnt(wide(&fused(0.01), 0.04), turning, 20.0, 7, |e| e.turn_bias);
    assert!(biases.iter().all(|bias| bias.abs() <= 0.01));
    assert_eq!(biases.last(), Some(&-0.01));
}

/// A straight way says nothing about the track.
#[test]
fn a_straight_way_teaches_nothing_of_turns() {
    let ahead = Twist::new(0.4, 0.0);
    let biases = learnt(led(&fused(0.02), 0.0), ahead, 30.0, 8, |e| e.turn_bias);
    assert!(
        biases.iter().all(|bias| bias.abs() < 0.1 * 0.02),
        "{biases:?}"
    );
}

/// A turn on the spot says nothing about the way.
#[test]
fn turning_on_the_spot_teaches_no_curvature() {
    let most = 2.0 * 0.02 / TRACK_M;
    let turning = Twist::new(0.0, 0.5);
    let biases = learnt(led(&fused(0.02), 0.0), turning, 30.0, 5, |e| {
        e.curvature_bias
    });
    assert!(
        biases.iter().all(|bias| bias.abs() < 0.1 * most),
        "{biases:?}"
    );
}
