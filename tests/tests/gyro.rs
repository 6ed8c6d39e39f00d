//! The gyro's estimator: what it refuses, what it learns, what it finds, in both precisions.

use controller_core::error::Field;
use controller_core::gyro::{
    GyroFault, GyroHeading, GyroOutcome, GyroParams, GyroReading, GyroRefusal, Rolled,
    ValidGyroParams,
};
use controller_core::hal::WheelCounts;
use controller_core::localiser::{
    Estimate, Fix, FixOutcome, FusionParams, Localiser, LocaliserParams,
};
use controller_core::maths::{Libm, Single};
use controller_core::odometry::OdometryParams;
use controller_core::scalar::Scalar;
use controller_core::types::{Accel, Pose};
use proptest::prelude::*;
use std::f64::consts::PI;
use tests::encoded::{bases, odometry};
use tests::random::Random;

const DT: f64 = 0.005;

fn wheels<T: Scalar>() -> OdometryParams<T> {
    let (_, file) = bases()[0].clone();
    odometry(&file, 50.0)
}

fn sensor<T: Scalar>() -> ValidGyroParams<T> {
    let params = GyroParams::icm_42688_p();
    let wheels = wheels::<T>();
    params.validate(&wheels, T::from_f64(0.02)).expect("valid")
}

fn reading<T: Scalar>(rate: f64, age_s: f64) -> GyroReading<T> {
    GyroReading {
        rate: T::from_f64(rate),
        heading: None,
        age_s: T::from_f64(age_s),
    }
}

/// A tick of wheels that roll without an error.
fn rolled<T: Scalar>(v: f64, w: f64) -> Rolled<T> {
    Rolled {
        travel: T::from_f64(v * DT),
        turn: T::from_f64(w * DT),
        counted: (v != 0.0 || w != 0.0, v != 0.0 || w != 0.0),
        dt: T::from_f64(DT),
    }
}

/// Ticks of a base with a true speed, turn rate and turn rate of the wheels; the reading is the true rate and `error`. By how much
/// the heading turned.
fn drive<T: Scalar>(
    heading: &mut GyroHeading<T>,
    gyro: &ValidGyroParams<T>,
    (v, w, by_wheels): (f64, f64, f64),
    seconds: f64,
    mut error: impl FnMut() -> f64,
) -> f64 {
    let mut turned = 0.0;
    for _ in 0..(seconds / DT).round() as usize {
        let reading = reading(w + error(), 0.0);
        turned += heading
            .advance(gyro, &rolled(v, by_wheels), Some(&reading))
            .to_f64();
    }
    turned
}

/// Noise of a reading at 200 Hz of the sensor's density.
fn noise(random: &mut Random) -> f64 {
    4.9e-5 * f64::sqrt(1.0 / DT) * random.normal()
}

/// A clock that steps back by a microsecond makes a tick of 4,294 s, and no rate turned the base for so long.
#[test]
fn a_reading_says_nothing_of_a_tick_that_is_too_long() {
    let gyro = sensor::<f32>();
    let mut heading = GyroHeading::new(&gyro);
    drive(&mut heading, &gyro, (0.2, 0.3, 0.3), 1.0, || 0.0);
    let long = Rolled {
        dt: 4294.0,
        ..rolled::<f32>(0.2, 0.3)
    };
    let turned = heading.advance(&gyro, &long, Some(&reading(0.3, 0.0)));
    assert_eq!(turned, long.turn);
    let next = drive(&mut heading, &gyro, (0.2, 0.3, 0.3), 1.0, || 0.0);
    assert!((next - 0.3).abs() < 1e-3, "{next}");
}

#[test]
fn gyro_parameters_out_of_range_are_named() {
    let refused = |change: &dyn Fn(&mut GyroParams<f64>)| {
        let mut params = GyroParams::icm_42688_p();
        change(&mut params);
        params.check().expect_err("out of range").field
    };
    assert_eq!(refused(&|p| p.noise_density = 0.0), Field::GyroNoise);
    assert_eq!(refused(&|p| p.bias_limit = f64::NAN), Field::GyroBias);
    assert_eq!(refused(&|p| p.bias_walk = -1e-9), Field::GyroBiasWalk);
    assert_eq!(refused(&|p| p.scale_error = 0.3), Field::GyroScale);
    assert_eq!(refused(&|p| p.range = f64::INFINITY), Field::GyroRange);
    assert_eq!(refused(&|p| p.resolution = 0.2), Field::GyroResolution);
    assert_eq!(refused(&|p| p.rate_hz = 1.0), Field::GyroRate);
    assert_eq!(refused(&|p| p.latency_s = 0.2), Field::GyroLatency);
    assert_eq!(refused(&|p| p.rest_s = 0.0), Field::GyroRest);
    assert_eq!(refused(&|p| p.carry_s = 61.0), Field::GyroCarry);
    assert_eq!(GyroParams::<f32>::icm_42688_p().check(), Ok(()));
}

/// A second of rest after twice the stated time leaves n/√1 s of the bias; five of it, and the rounding of single precision.
fn learns_at_rest<T: Scalar>(bias: f64, seed: u64) {
    let gyro = sensor::<T>();
    let mut heading = GyroHeading::new(&gyro);
    let mut random = Random(seed);
    let rest = 2.0 * gyro.params().rest_s.to_f64() + 1.0;
    let turned = drive(&mut heading, &gyro, (0.0, 0.0, 0.0), rest, || {
        bias + noise(&mut random)
    });
    let off = heading.report().bias.to_f64() - bias;
    assert!(off.abs() < 5.0 * 4.9e-5, "{off:e}");
    // Of what the bias turned meanwhile, up to 18 mrad, is left what the noise of a reading (0.7 mrad/s) says of the 0.3 s before the rest
    // was seen, five times.
    assert!(turned.abs() < 5.0 * 7.0e-4 * 0.3, "{turned:e}");
    let variance = heading.bias_variance().to_f64();
    assert!(variance < f64::powi(1.5 * 4.9e-5, 2), "{variance:e}");
}

/// A body that rocks on its tyres after a stop gives no steady readings, so that nothing is learnt of its bias yet; but its wheels stand, and the heading
/// is held to what they may have turned unseen. Who turns such a base by hand turns it.
#[test]
fn a_base_that_rocks_does_not_turn_by_its_bias() {
    let gyro = sensor::<f32>();
    let wheels = wheels::<f64>();
    let unseen = 2.0 * wheels.travel_per_count_m() / wheels.track_m();
    for bias in [-0.011, 0.004, 0.011] {
        let mut heading = GyroHeading::new(&gyro);
        let mut random = Random(3);
        drive(&mut heading, &gyro, (0.1, 0.2, 0.2), 0.1, || bias);
        let (amplitude, rad_s) = (0.06, 40.0);
        let mut t = 0.0;
        let stood = drive(&mut heading, &gyro, (0.0, 0.0, 0.0), 1.5, || {
            t += DT;
            let rocking = amplitude * f64::sin(rad_s * t) * f64::exp(-t);
            bias + rocking + noise(&mut random)
        });
        assert!(
            stood.abs() < unseen + 2.0 * amplitude / rad_s,
            "{bias}: {stood:e}"
        );
        let mut t = 0.0;
        let by_hand = drive(&mut heading, &gyro, (0.0, 0.0, 0.0), 0.4, || {
            t += DT;
            bias + 1.0 * f64::sin(PI * t / 0.4)
        });
        let turned = 1.0 * 0.8 / PI;
        assert!((by_hand - turned).abs() < 0.03, "{bias}: {by_hand}");
    }
}

/// One of the readings of this rest is more than five standard deviations off, as one of 1.7 million is.
#[test]
fn a_reading_that_is_far_off_by_chance_is_no_jump() {
    learns_at_rest::<f64>(0.0, 11_036_286_374_072_588_099);
}

proptest! {
    #[test]
    fn the_bias_is_learnt_at_rest(bias in -0.0115_f64..0.0115, seed in any::<u64>()) {
        learns_at_rest::<f64>(bias, seed);
        learns_at_rest::<f32>(bias, seed);
    }

    /// What is refused is as what never came: all that follows is the same, bit for bit.
    #[test]
    fn readings_that_are_no_use_change_nothing(
        v in -1.0_f64..1.0, w in -2.0_f64..2.0, age in 0.0_f64..0.02, which in 0..6_usize,
    ) {
        let gyro = sensor::<f32>();
        let mut heading = GyroHeading::new(&gyro);
        let sound = reading(w, age);
        for _ in 0..20 {
            heading.advance(&gyro, &rolled(v, w), Some(&sound));
        }
        let (bad, refusal) = [
            (GyroReading { rate: f32::NAN, ..sound }, GyroRefusal::NotFinite),
            (GyroReading { heading: Some(f32::INFINITY), ..sound }, GyroRefusal::NotFinite),
            (GyroReading { age_s: f32::NAN, ..sound }, GyroRefusal::NotFinite),
            (GyroReading { age_s: -1e-3, ..sound }, GyroRefusal::NegativeAge),
            (GyroReading { age_s: 0.11, ..sound }, GyroRefusal::TooOld),
            (GyroReading { rate: -8.72, ..sound }, GyroRefusal::BeyondRange),
        ][which];
        let mut other = heading;
        let turned = heading.advance(&gyro, &rolled(v, w), Some(&bad));
        prop_assert_eq!(heading.report().outcome, GyroOutcome::Refused(refusal));
        prop_assert_eq!(turned, other.advance(&gyro, &rolled(v, w), None));
        prop_assert_eq!(
            heading.advance(&gyro, &rolled(v, w), Some(&sound)),
            other.advance(&gyro, &rolled(v, w), Some(&sound))
        );
        prop_assert_eq!(heading, other);
    }

    /// A reading of any age is compared with the wheels of its own time: at changing rates, what is left of the age is the lag's form,
    /// and nothing adds up.
    #[test]
    fn the_age_of_readings_does_not_add_up(age_ticks in 0..6_usize, rate in 0.2_f64..3.0) {
        let gyro = sensor::<f64>();
        let mut heading = GyroHeading::new(&gyro);
        let rate_at = |tick: usize| rate * f64::sin(tick as f64 * DT);
        let age = age_ticks as f64 * DT;
        let (mut turned, mut truth) = (0.0, 0.0);
        for tick in 0..4000 {
            let w = rate_at(tick);
            let then = reading(rate_at(tick.saturating_sub(age_ticks)), age);
            truth += w * DT;
            turned += heading.advance(&gyro, &rolled(0.2, w), Some(&then));
            // A lag of τ differs from a delay of τ by τ²/2 of the angular acceleration at most.
            let most = 1e-6 + age * age * rate;
            prop_assert!((turned - truth).abs() < most + rate * DT * DT * 4.0, "{}", turned - truth);
        }
        prop_assert_eq!(heading.report().slid, 0.0);
    }
}

/// Without rest, and without knowing anything, external headings of 5 mrad show the bias within half a minute, in motion.
#[test]
fn the_bias_is_learnt_in_motion_from_external_headings() {
    for (number, bias) in [0.01, -0.01, 0.004, -0.002].into_iter().enumerate() {
        let params = LocaliserParams {
            odometry: wheels::<f32>(),
            fusion: Some(FusionParams::for_source(5e-3, 5e-3, 20.0)),
            gyro: Some(GyroParams::icm_42688_p()),
        };
        let localisation = params.validate_with::<Single>().expect("valid");
        let mut localiser =
            Localiser::<f32, 64>::start(&localisation, Pose::default(), WheelCounts::default())
                .expect("starts");
        let mut random = Random(71 + number as u64);
        let per_count = f64::from(params.odometry.travel_per_count_m());
        let mut last = 0.0;
        for tick in 1..=6000 {
            // Straight on at 0.3 m/s.
            let x = 0.3 * DT * f64::from(tick);
            let counts = (x / per_count) as i32;
            let counts = WheelCounts {
                right: counts,
                left: counts,
            };
            let normal = random.normal();
            let fix = (tick % 10 == 0).then(|| Fix {
                pose: Pose::new(x as f32, 0.0, (5e-3 * normal) as f32),
                age_s: 0.0,
            });
            let reading = reading(bias + noise(&mut random), 0.0);
            let estimate = localiser
                .update_with::<Single>(
                    counts,
                    DT as f32,
                    &Accel::default(),
                    fix.as_ref(),
                    Some(&reading),
                )
                .expect("a tick");
            last = f64::from(estimate.gyro.bias);
            assert_eq!(estimate.gyro.fault, None, "{tick}");
            if tick > 4000 {
                let theta = estimate.measured.pose.theta.abs();
                assert!(theta < 2.5e-3, "{tick}: {theta}");
            }
        }
        // A line through headings of σ for 30 s at 20 Hz: √(12/600) σ/30 s is 2.4e-5 rad/s; five of them.
        assert!((last - bias).abs() < 1.2e-4, "{bias}: {last}");
    }
}

/// A base that was set up without one says so, and everything else is as if nothing had come.
#[test]
fn a_base_without_a_gyro_does_not_look_at_readings() {
    let params = LocaliserParams {
        odometry: wheels::<f32>(),
        fusion: Some(FusionParams::for_source(5e-3, 5e-3, 20.0)),
        gyro: None,
    };
    let localisation = params.validate_with::<Single>().expect("valid");
    let start = || {
        Localiser::<f32, 8>::start(&localisation, Pose::default(), WheelCounts::default())
            .expect("starts")
    };
    let (mut with, mut without) = (start(), start());
    for tick in 1..500 {
        let counts = WheelCounts {
            right: 3 * tick,
            left: 2 * tick,
        };
        let reading = reading(1.0, 0.0);
        let accel = Accel::default();
        let other = with
            .update_with::<Single>(counts, 0.005, &accel, None, Some(&reading))
            .expect("a tick");
        let estimate = without
            .update::<Single>(counts, 0.005, None)
            .expect("a tick");
        assert_eq!(
            other.gyro.outcome,
            GyroOutcome::Refused(GyroRefusal::NoGyro)
        );
        assert_eq!(other.measured, estimate.measured);
    }
}

/// A heading that the sensor fuses is followed by its steps, through the wrap and from any zero, whatever its rate says.
#[test]
fn a_fused_heading_is_followed() {
    let gyro = sensor::<f64>();
    let mut heading = GyroHeading::new(&gyro);
    let mut turned = 0.0;
    for tick in 0..2000 {
        let fused = controller_core::angle::wrap(2.0 + 0.8 * DT * f64::from(tick));
        let reading = GyroReading {
            rate: 0.1,
            heading: Some(fused),
            age_s: 0.0,
        };
        // Wheels that turn a per cent too far.
        turned += heading.advance(&gyro, &rolled(0.1, 0.808), Some(&reading));
    }
    // The first reading only begins.
    assert!(
        (turned - 0.8 * DT * 1999.0 - 0.808 * DT).abs() < 1e-9,
        "{turned}"
    );
}

/// A slide that lasts for so long stops a base \[s\].
const SLIPS_S: f32 = 0.15;

/// A wheel that slides at 0.1 m/s: seen within 0.05 s, named after 0.2 s, and the heading is the gyro's all the time.
#[test]
fn a_wheel_that_slides_is_seen_at_once() {
    let gyro = sensor::<f32>();
    let track = f64::from(wheels::<f32>().track_m());
    for v in [0.1, 0.3, 0.6] {
        let mut heading = GyroHeading::new(&gyro);
        let mut random = Random(3);
        let mut noise = || noise(&mut random);
        drive(&mut heading, &gyro, (0.0, 0.0, 0.0), 1.0, &mut noise);
        drive(&mut heading, &gyro, (v, 0.0, 0.0), 1.0, &mut noise);
        assert!(!heading.slides_now(), "{v}");
        let turned = drive(&mut heading, &gyro, (v, 0.0, 0.1 / track), 0.05, &mut noise);
        assert!(
            heading.slides_now() && heading.report().slides_s < SLIPS_S,
            "{v}"
        );
        let more = drive(&mut heading, &gyro, (v, 0.0, 0.1 / track), 0.15, &mut noise);
        assert!(
            heading.report().slides_s > SLIPS_S && heading.report().slid > 0.0,
            "{v}"
        );
        // Noise and what is left of the bias: five of 4.9e-5 √0.2 s.
        assert!((turned + more).abs() < 1.1e-4, "{v}: {turned}");
        // Over, and forgotten.
        drive(&mut heading, &gyro, (v, 0.0, 0.0), 0.5, &mut noise);
        assert!(
            !heading.slides_now() && heading.report().slides_s < SLIPS_S,
            "{v}"
        );
        assert_eq!(heading.report().fault, None);
    }
}

/// What only a faulty gyro does is named, and its turn taken back.
#[test]
fn lies_are_named() {
    let gyro = sensor::<f64>();
    let begin = || {
        let mut heading = GyroHeading::new(&gyro);
        let mut random = Random(5);
        drive(&mut heading, &gyro, (0.0, 0.0, 0.0), 1.0, || {
            noise(&mut random)
        });
        drive(&mut heading, &gyro, (0.2, 1.0, 1.0), 1.0, || {
            noise(&mut random)
        });
        assert_eq!(heading.report().fault, None);
        heading
    };
    // Silent: found after 0.1 s.
    let mut heading = begin();
    for tick in 0..25 {
        heading.advance(&gyro, &rolled(0.2, 1.0), None);
        let silent = (tick >= 20).then_some(GyroFault::Silent);
        // The twentieth is 0.1 s, to a rounding.
        assert!(heading.report().fault == silent || tick == 19, "{tick}");
    }
    drive(&mut heading, &gyro, (0.2, 1.0, 1.0), 0.02, || 0.0);
    assert_eq!(heading.report().fault, None, "it speaks again");
    // Stuck at 1 rad/s, while the base turns the other way.
    let mut heading = begin();
    let turned = drive(&mut heading, &gyro, (0.2, -1.0, -1.0), 0.4, || 2.0);
    assert_eq!(heading.report().fault, Some(GyroFault::Stuck));
    assert!((turned + 0.4).abs() < 0.03, "{turned}");
    // Reversed.
    let mut heading = begin();
    let mut random = Random(6);
    let turned = drive(&mut heading, &gyro, (0.2, 1.0, 1.0), 0.4, || {
        -2.0 + noise(&mut random)
    });
    assert_eq!(heading.report().fault, Some(GyroFault::Reversed));
    assert!((turned - 0.4).abs() < 0.03, "{turned}");
    // Believed again after a radian of agreement, beginning with the next radian.
    drive(&mut heading, &gyro, (0.2, 1.0, 1.0), 2.1, || {
        noise(&mut random)
    });
    assert_eq!(heading.report().fault, None);
    // A bias beyond its limit, at rest; what it turned is taken back.
    let mut heading = begin();
    let turned = drive(&mut heading, &gyro, (0.0, 0.0, 0.0), 1.5, || {
        0.3 + noise(&mut random)
    });
    assert_eq!(heading.report().fault, Some(GyroFault::Bias));
    assert!(turned.abs() < 0.03, "{turned}");
}

/// Single precision turns as double precision does: a minute of driving with readings of noise.
#[test]
fn single_precision_is_enough() {
    let (single, double) = (sensor::<f32>(), sensor::<f64>());
    let (mut a, mut b) = (GyroHeading::new(&single), GyroHeading::new(&double));
    let mut random = Random(9);
    let (mut turned, mut w, mut v) = ((0.0, 0.0), 0.0, 0.0);
    for tick in 0..12_000 {
        if tick % 300 == 0 {
            (v, w) = (random.within(0.5), random.within(2.0));
            if tick % 900 == 0 {
                (v, w) = (0.0, 0.0);
            }
        }
        let rate = f64::from((w + 0.004 + noise(&mut random)) as f32);
        turned.0 +=
            f64::from(a.advance(&single, &rolled(v, 1.01 * w), Some(&reading(rate, 0.003))));
        turned.1 += b.advance(&double, &rolled(v, 1.01 * w), Some(&reading(rate, 0.003)));
    }
    assert!((turned.0 - turned.1).abs() < 1e-3, "{turned:?}");
    let (bias, expected) = (f64::from(a.report().bias), b.report().bias);
    // A tenth of what a second of rest leaves.
    assert!((bias - expected).abs() < 5e-6, "{bias} {expected}");
}

/// A base, and what its localiser makes of counts, readings and fixes.
struct Carried {
    localiser: Localiser<f64, 64>,
    /// Travel of the right and the left wheel \[counts\].
    travelled: (f64, f64),
    random: Random,
}

impl Carried {
    fn start(fusion: Option<FusionParams<f64>>, gyro: Option<GyroParams<f64>>) -> Self {
        let params = LocaliserParams {
            odometry: wheels(),
            fusion,
            gyro,
        };
        let localisation = params.validate_with::<Libm>().expect("valid");
        let counts = WheelCounts::default();
        Self {
            localiser: Localiser::start(&localisation, Pose::default(), counts).expect("starts"),
            travelled: (0.5, 0.5),
            random: Random(17),
        }
    }

    /// A tick in which the wheels have this speed and turn rate, and a gyro, if it speaks, this one.
    fn advance(
        &mut self,
        (v, w): (f64, f64),
        rate: Option<f64>,
        fix: Option<&Pose<f64>>,
    ) -> Estimate<f64> {
        let wheels = wheels::<f64>();
        let per_count = wheels.travel_per_count_m();
        let rim = 0.5 * wheels.track_m() * w;
        self.travelled.0 += (v + rim) * DT / per_count;
        self.travelled.1 += (v - rim) * DT / per_count;
        let counts = WheelCounts {
            right: self.travelled.0.floor() as i32,
            left: self.travelled.1.floor() as i32,
        };
        let reading = rate.map(|rate| reading(rate + noise(&mut self.random), 0.0));
        let fix = fix.map(|&pose| Fix { pose, age_s: 0.0 });
        let accel = Accel::default();
        self.localiser
            .update_with::<Libm>(counts, DT, &accel, fix.as_ref(), reading.as_ref())
            .expect("a tick")
    }

    /// The last of some seconds of ticks without a fix.
    fn drive(&mut self, twist: (f64, f64), rate: Option<f64>, seconds: f64) -> Estimate<f64> {
        let mut last = Estimate::default();
        for _ in 0..(seconds / DT).round() as usize {
            last = self.advance(twist, rate, None);
        }
        last
    }
}

fn camera() -> Option<FusionParams<f64>> {
    Some(FusionParams::for_source(5e-3, 5e-3, 20.0))
}

fn sheet() -> Option<GyroParams<f64>> {
    Some(GyroParams::icm_42688_p())
}

/// A base that turns evenly is not at rest, and what its gyro reads is no bias: on both wheels, and on either alone.
#[test]
fn a_base_that_turns_on_one_wheel_does_not_rest() {
    let lever = 0.5 * wheels::<f64>().track_m();
    for (v, w) in [(0.0, 0.5), (0.5 * lever, 0.5), (0.5 * lever, -0.5)] {
        let mut base = Carried::start(camera(), sheet());
        let estimate = base.drive((v, w), Some(w), 3.0);
        assert_eq!(estimate.gyro.fault, None, "{v} {w}");
        // A scale of 0.65 % of 1.5 rad would be 10 mrad; this one has none. The first reading only begins.
        let off = estimate.measured.pose.theta - 3.0 * w;
        assert!(off.abs() < 5e-3, "{v} {w}: {off}");
    }
}

/// How long a base drives on without fixes counts from when its gyro ceased to carry the heading; and in full, once that was for longer
/// than it may.
#[test]
fn time_alone_is_that_without_a_gyro() {
    let gyro = GyroParams {
        carry_s: 2.0,
        ..GyroParams::icm_42688_p()
    };
    let mut base = Carried::start(camera(), Some(gyro));
    let alone = |base: &Carried| (base.localiser.uncarried_s(), base.localiser.fix_age_s());
    // Ticks are counted to a rounding.
    let is = |(uncarried, age): (f64, f64), expected: (f64, f64)| {
        let off = (uncarried - expected.0, age - expected.1);
        let near = off.0.abs().max(off.1.abs()) < 1e-9;
        assert!(near, "{uncarried} {age} for {expected:?}");
    };
    base.drive((0.1, 0.0), None, 0.05);
    is(alone(&base), (0.05, 0.05));
    base.drive((0.1, 0.0), Some(0.0), 0.95);
    is(alone(&base), (0.0, 1.0));
    // Silent after 0.1 s, to a tick.
    base.drive((0.1, 0.0), None, 0.5);
    let (uncarried, age) = alone(&base);
    assert!((uncarried - 0.4).abs() < 1.1 * DT, "{uncarried}");
    is((uncarried, age), (uncarried, 1.5));
    // A fix is nearer than that.
    let at = *base.localiser.pose();
    base.advance((0.1, 0.0), None, Some(&at));
    is(alone(&base), (0.0, 0.0));
    base.drive((0.1, 0.0), Some(0.0), 1.9);
    is(alone(&base), (0.0, 1.9));
    base.drive((0.1, 0.0), Some(0.0), 0.2);
    is(alone(&base), (2.1, 2.1));
    // Without a gyro it is all of the time.
    let mut base = Carried::start(camera(), None);
    base.drive((0.1, 0.0), None, 0.5);
    is(alone(&base), (0.5, 0.5));
}

/// A gyro carries a base for as long as its heading is in doubt by less than 20 mrad: one whose bias may be 20°/s and was never learnt for a tenth of a
/// second, after a second of rest for all of `carry_s`.
#[test]
fn a_gyro_whose_bias_is_unknown_carries_no_base() {
    let gyro = GyroParams {
        bias_limit: 0.35,
        ..GyroParams::icm_42688_p()
    };
    for rests in [false, true] {
        let mut base = Carried::start(camera(), Some(gyro));
        if rests {
            base.drive((0.0, 0.0), Some(0.0), 1.0);
        }
        let at = *base.localiser.pose();
        base.advance((0.1, 0.0), Some(0.0), Some(&at));
        base.drive((0.1, 0.0), Some(0.0), 20.0);
        let (uncarried, age) = (base.localiser.uncarried_s(), base.localiser.fix_age_s());
        assert!((age - 20.0).abs() < 1e-9);
        // A deviation of 0.35/√3 rad/s is 20 mrad after 99 ms, to a tick.
        let expected = if rests { 0.0 } else { 20.0 - 0.099 };
        assert!(
            (uncarried - expected).abs() < 1.1 * DT,
            "{uncarried} {rests}"
        );
    }
}

/// Without fixes too the heading is the gyro's, wheels of unlike radii are learnt, and the estimate says so.
#[test]
fn a_gyro_is_reported_without_fixes() {
    let mut base = Carried::start(None, sheet());
    base.drive((0.0, 0.0), Some(0.0), 1.0);
    // The wheels' radii are apart by 1 %: of what is seen in 0.3 m three tenths are taken, and of ten times 3 % are left.
    let curvature = 0.01 / wheels::<f64>().track_m();
    let mut last = Estimate::default();
    for _ in 0..(12.0 / DT) as usize {
        // Odometry adds what it has learnt to what the wheels say.
        last = base.advance((0.3, 0.3 * curvature), Some(0.0), None);
    }
    assert_eq!(last.gyro.outcome, GyroOutcome::Used);
    assert_eq!(last.curvature_bias, base.localiser.curvature_bias());
    let left = last.curvature_bias / -curvature - 1.0;
    assert!(left.abs() < 0.05, "{left}");
    // Three of the bias that a second of rest leaves, for 12 s, and a count of 0.1 mm at either wheel.
    assert!(last.measured.pose.theta.abs() < 4e-3, "{last:?}");
}

/// External headings that side with the wheels show a faulty gyro, and what it turned too much is taken back at once.
#[test]
fn fixes_tell_a_gyro_that_lies() {
    for wrong in [0.3, -0.3] {
        let mut base = Carried::start(camera(), sheet());
        base.drive((0.0, 0.0), Some(0.0), 1.0);
        base.drive((0.2, 0.0), Some(0.0), 1.0);
        let mut found = None;
        for tick in 1..60 {
            let x = 0.2 + 0.2 * DT * f64::from(tick);
            let fix = Pose::new(x, 0.0, 0.0);
            let fix = (tick % 10 == 0).then_some(&fix);
            let before = base.localiser.pose().theta;
            let estimate = base.advance((0.2, 0.0), Some(wrong), fix);
            if estimate.gyro.fault.is_some() {
                found = Some((tick, before, estimate));
                break;
            }
        }
        let (tick, before, estimate) = found.expect("the fault is found");
        assert_eq!(estimate.gyro.fault, Some(GyroFault::Disagrees));
        assert_eq!(estimate.fix, FixOutcome::Fused);
        // The stated heading and the fix are of 5 mrad each: four of both are 28, of which 0.3 rad/s has 15 more at each fix, and
        // those before have taken up to half. By the third; until then the heading went with the gyro.
        assert!(tick <= 30 && before / wrong > 0.06, "{tick}: {before}");
        // Noise, and rounding of the counts.
        let theta = estimate.measured.pose.theta;
        assert!(theta.abs() < 3e-3, "{wrong}: {theta}");
    }
}

/// While a gyro carries the heading the gate widens by what the gyro may be off, not by what the wheels may: a fix that the wheels
/// would excuse is an outlier.
#[test]
fn a_carried_heading_is_not_excused_by_the_way() {
    let mut outcomes = [None, sheet()].map(|gyro| {
        let mut base = Carried::start(camera(), gyro);
        base.drive((0.0, 0.0), Some(0.0), 2.0);
        base.drive((0.3, 0.0), Some(0.0), 5.0);
        let at = *base.localiser.pose();
        let off = |theta: f64| Pose::new(at.x + 0.3 * DT, at.y, at.theta + theta);
        // The gate is 25 mrad, and noise and bias of 4.9e-5 rad/√s and rad/s leave less than a milliradian after 5 s.
        [0.02, 0.15].map(|theta| {
            let mut base = Carried {
                localiser: base.localiser,
                travelled: base.travelled,
                random: Random(18),
            };
            base.advance((0.3, 0.0), Some(0.0), Some(&off(theta))).fix
        })
    });
    let [by_wheels, by_gyro] = &mut outcomes;
    assert_eq!(by_wheels, &[FixOutcome::Fused, FixOutcome::Fused]);
    assert_eq!(by_gyro, &[FixOutcome::Fused, FixOutcome::Rejected]);
}

/// A pose that is stated, at the start or later, has the heading of a fix: it may be off by three standard deviations of one.
#[test]
fn a_stated_heading_is_as_sure_as_a_fix() {
    for set in [false, true] {
        let mut base = Carried::start(camera(), sheet());
        if set {
            // Meanwhile fixes have made it surer.
            for _ in 0..400 {
                let at = Pose::default();
                base.advance((0.0, 0.0), Some(0.0), Some(&at));
            }
            base.localiser.set_pose(Pose::new(1.0, 2.0, 0.5));
        }
        base.advance((0.0, 0.0), Some(0.0), None);
        let at = *base.localiser.pose();
        // 25 mrad of the gate, and 15.
        for (theta, outcome) in [(0.043, FixOutcome::Rejected), (0.037, FixOutcome::Fused)] {
            let fix = Pose::new(at.x, at.y, at.theta + theta);
            let estimate = base.advance((0.0, 0.0), Some(0.0), Some(&fix));
            assert_eq!(estimate.fix, outcome, "{set} {theta}");
        }
    }
}
