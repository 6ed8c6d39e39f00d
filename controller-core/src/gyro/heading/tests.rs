//! What the gyro's estimate keeps of the way: sums over the window, doubt while it was not believed, stretches.

use super::*;
use crate::gyro::GyroParams;
use crate::odometry::{Calibration, OdometryParams};
use crate::wheels::WheelGeometry;

const DT: f64 = 0.005;
/// Backward, and turning right, so that a lost sign shows.
const SPEED: f64 = -0.4;
const TURN_RATE: f64 = -0.3;

fn sensor() -> ValidGyroParams<f64> {
    let wheels = OdometryParams {
        wheels: WheelGeometry {
            radius_right_m: 0.035,
            radius_left_m: 0.035,
            track_m: 0.14,
        },
        calibration: Calibration::NOMINAL,
        counts_per_turn: 2048.0,
        bandwidth: 50.0,
    };
    let valid = GyroParams::icm_42688_p().validate(&wheels, 0.02);
    valid.expect("in range")
}

fn rolled(speed: f64, turn_rate: f64) -> Rolled<f64> {
    Rolled {
        travel: speed * DT,
        turn: turn_rate * DT,
        counted: (true, true),
        dt: DT,
    }
}

/// A gyro that fuses a heading: no bias is learnt on the way.
fn fused(heading: f64) -> GyroReading<f64> {
    GyroReading {
        rate: TURN_RATE,
        heading: Some(heading),
        age_s: 0.0,
    }
}

/// Of a steady speed the leaky sums hold what passes in the window, whichever way it is.
#[test]
fn sums_hold_the_way_of_a_window() {
    let gyro = sensor();
    let mut heading = GyroHeading::new(&gyro);
    for _ in 0..1000 {
        heading.advance(&gyro, &rolled(SPEED, TURN_RATE), None);
    }
    let way = gyro.per_way * SPEED.abs() * WINDOW_S;
    let turn = gyro.per_turn * TURN_RATE.abs() * WINDOW_S;
    let expected = way + turn + gyro.rounding;
    assert!((heading.geometry(&gyro) - expected).abs() < 1e-12);
}

/// While the gyro is silent wheels carry the heading, and what radii and track may be wrong by on that way is in doubt once it speaks.
#[test]
fn the_way_without_a_gyro_adds_to_the_doubt() {
    let gyro = sensor();
    let mut heading = GyroHeading::new(&gyro);
    let reading = fused(0.0);
    heading.advance(&gyro, &rolled(0.0, 0.0), Some(&reading));
    while heading.report().fault.is_none() {
        heading.advance(&gyro, &rolled(SPEED, TURN_RATE), None);
    }
    assert_eq!(heading.report().fault, Some(GyroFault::Silent));
    let before = heading.heading_variance();
    let ticks = 400;
    for _ in 1..ticks {
        heading.advance(&gyro, &rolled(SPEED, TURN_RATE), None);
    }
    // The tick of the reading is one of them.
    heading.advance(&gyro, &rolled(SPEED, TURN_RATE), Some(&reading));
    assert!(heading.carries());
    let time = f64::from(ticks) * DT;
    let alone = gyro.per_way * SPEED.abs() * time + gyro.per_turn * TURN_RATE.abs() * time;
    let added = heading.heading_variance() - before;
    assert!((added / (alone * alone) - 1.0).abs() < 1e-9, "{added}");
}

/// Wheels that say straight on while the gyro turns: after some decimetres three tenths of the curvature between them is taken, and then
/// the next stretch begins. In a curve nothing is learnt.
#[test]
fn curvature_is_learnt_on_straight_stretches() {
    let gyro = sensor();
    let per_way = 0.02;
    for (speed, turn_rate) in [(0.4, 0.0), (-0.4, 0.0), (0.4, 0.8)] {
        let mut heading = GyroHeading::new(&gyro);
        let mut now = 0.0;
        heading.advance(&gyro, &rolled(0.0, 0.0), Some(&fused(now)));
        let mut learnt = None;
        let mut ticks = 0;
        while ticks < 300 && learnt.is_none() {
            now += (turn_rate + per_way * speed) * DT;
            heading.advance(&gyro, &rolled(speed, turn_rate), Some(&fused(now)));
            learnt = heading.curvature(&gyro);
            ticks += 1;
        }
        if turn_rate != 0.0 {
            assert_eq!(learnt, None);
            continue;
        }
        let learnt = learnt.expect("after a stretch");
        assert!((learnt - TAKEN * per_way).abs() < 1e-9, "{learnt}");
        assert_eq!(f64::from(ticks), STRETCH_M / (0.4 * DT));
        assert_eq!(heading.curvature(&gyro), None);
    }
}

/// Turning steadily, and then `after` a second gyro and wheels turn against each other, by these factors of the turn so far: the first that is
/// said of it, and when \[s\].
fn against(gyro_factor: f64, wheels_factor: f64) -> (Option<GyroFault>, f64) {
    let gyro = sensor();
    let mut heading = GyroHeading::new(&gyro);
    let turn_rate = 0.4;
    for tick in 0..1000 {
        let t = DT * f64::from(tick) - 1.0;
        let of = |factor| {
            if t < 0.0 {
                turn_rate
            } else {
                factor * turn_rate
            }
        };
        let reading = GyroReading {
            // No two are equal, as of a gyro that is not stuck.
            rate: of(gyro_factor) + 1e-6 * f64::from(tick),
            heading: None,
            age_s: 0.0,
        };
        heading.advance(&gyro, &rolled(0.3, of(wheels_factor)), Some(&reading));
        let report = heading.report();
        if report.slides_s > 0.15 || report.fault.is_some() {
            return (report.fault, t);
        }
    }
    panic!("nothing is said of it");
}

/// Turns of the same size against each other: the gyro is reversed if the wheels turn on as before, and a wheel slides if the gyro does.
#[test]
fn who_turns_on_as_before_is_believed() {
    let (fault, t) = against(-1.0, 1.0);
    assert_eq!(fault, Some(GyroFault::Reversed), "{t}");
    let (fault, t) = against(1.0, -1.0);
    assert!(
        fault.is_none() && (0.15..0.25).contains(&t),
        "{fault:?} {t}"
    );
    // A little more or less.
    for factor in [-0.8, -1.2] {
        let (fault, t) = against(1.1, factor);
        assert!(fault.is_none() && t < 0.25, "{fault:?} {t}");
        let (fault, t) = against(factor, 1.0);
        assert_eq!(fault, Some(GyroFault::Reversed), "{t}");
    }
}

/// One that never agreed is reversed, whatever else turns.
#[test]
fn a_gyro_that_is_reversed_from_the_start_is_named() {
    let gyro = sensor();
    let mut heading = GyroHeading::new(&gyro);
    let mut turned = 0.0;
    while heading.report().fault.is_none() {
        let rate = 0.3 + 0.2 * f64::sin(turned);
        let reading = GyroReading {
            rate: -rate,
            heading: None,
            age_s: 0.0,
        };
        heading.advance(&gyro, &rolled(0.3, rate), Some(&reading));
        turned += rate * DT;
        assert!(turned < 0.3 && heading.report().slides_s == 0.0, "{turned}");
    }
    assert_eq!(heading.report().fault, Some(GyroFault::Reversed));
}

/// Straight on with the right encoder reversed: the wheels seem to turn the base on the spot, and the gyro says that it does not. For a second that is
/// left to the detector of encoders.
#[test]
fn a_reversed_encoder_is_named_after_a_second() {
    let gyro = sensor();
    let mut heading = GyroHeading::new(&gyro);
    let speed = 0.015;
    let mut drive = |(travel, turn): (f64, f64), ticks: u32| {
        for tick in 0..ticks {
            let reading = GyroReading {
                rate: 1e-4 * f64::from(tick % 3),
                heading: None,
                age_s: 0.0,
            };
            heading.advance(&gyro, &rolled(travel, turn), Some(&reading));
        }
        (heading.report().slides_s, heading.encoder())
    };
    assert_eq!(drive((speed, 0.0), 200), (0.0, None));
    let reversed = (0.0, -2.0 * speed / 0.14);
    assert_eq!(drive(reversed, 180).0, 0.0);
    let (slides_s, encoder) = drive(reversed, 40);
    assert!(slides_s > 1.0, "{slides_s}");
    assert_eq!(encoder, Some(Encoder::Reversed));
}
