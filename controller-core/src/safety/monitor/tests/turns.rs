//! Brief ticks, which take parts of looks at the wheels in turns.

use super::*;

/// Of 1 ms.
fn brief(inputs: DetectorInputs<f64>) -> DetectorInputs<f64> {
    DetectorInputs {
        dt_us: 1000,
        ..inputs
    }
}

fn every_ms() -> Monitor<f64> {
    let period_us = 1000;
    monitor(DetectorParams {
        period_us,
        ..params()
    })
}

/// Looks are every 8 ms, that at the right wheel from the first tick on, that at the left one from the fifth, and each shows a tick
/// later what it has taken. 250 ms last from the first look until the 32nd after it.
#[test]
fn what_stands_is_found_at_the_next_look_and_stays_found() {
    for (right, left, side, tick) in [
        (0, 10, Side::Right, 258),
        (10, 0, Side::Left, 262),
        (0, 0, Side::Right, 258),
    ] {
        let mut monitor = every_ms();
        let kind = FaultKind::EncoderStuck;
        let at = |k| brief(pushing(k, right, left));
        assert_eq!(found_in(&mut monitor, 300, kind, at), Some(tick));
        // Also in the ticks that do something else. The left one is found half a cycle after the right one.
        for k in tick + 1..tick + 20 {
            let found = monitor.check(&at(k));
            let both = right == left && k >= tick + 4;
            let side = if both { Side::Both } else { side };
            assert_eq!(found.get(kind), Some(Fault::EncoderStuck(side)));
        }
        // It ends with its sign: 8 ms until the next look, and a tick.
        let moves = |k| brief(pushing(100 * k, 1, 1));
        let found = (1..=9).map(|k| monitor.check(&moves(k)));
        assert!(found.last().is_some_and(|last| last.get(kind).is_none()));
    }
}

/// Ticks of 10 ms look at the right wheel and at the left one in turn, ticks of 5 ms take half a look each: 250 ms last from the first look until the
/// 13th after it, 20 ms each.
#[test]
fn longer_ticks_look_at_one_wheel_after_the_other() {
    let kind = FaultKind::EncoderStuck;
    for (period_us, right, left, tick) in [
        (10_000, 0, 10, 27),
        (10_000, 10, 0, 28),
        (5_000, 0, 10, 53),
        (5_000, 10, 0, 55),
    ] {
        let mut monitor = monitor(DetectorParams {
            period_us,
            ..params()
        });
        let at = |k| DetectorInputs {
            dt_us: period_us,
            ..pushing(k, right, left)
        };
        assert_eq!(found_in(&mut monitor, 100, kind, at), Some(tick));
    }
}

/// A torque to and fro at every tick pushes nothing, though a look meets it the same way each time.
#[test]
fn a_look_takes_all_that_was_exerted_since_the_last() {
    let shaken = |k: i32, mean: f64| {
        let torque = mean + if k % 2 == 0 { 8.0 } else { -8.0 };
        DetectorInputs {
            torques: Some(WheelTorques {
                right: torque,
                left: -torque,
            }),
            command: Twist::new(0.0, 2.0),
            ..brief(pushing(k, 0, 0))
        }
    };
    let kind = FaultKind::EncoderStuck;
    let quiet = found_in(&mut every_ms(), 2000, kind, |k| shaken(k, 0.0));
    assert_eq!(quiet, None);
    let pushed = found_in(&mut every_ms(), 2000, kind, |k| shaken(k, 4.0));
    // In the look of the right wheel that shows 250 ms, as above.
    assert!(pushed.is_some_and(|tick| tick <= 258), "{pushed:?}");
}

/// Ticks of any length one after the other: neither counts nor torques nor time are lost or taken twice.
#[test]
fn nothing_is_lost_where_ticks_change_their_length() {
    let mut monitor = every_ms();
    let (mut us, mut angle, mut speed) = (0_u32, 0.0_f64, 0.0);
    // 4 N m each: 80 N on 30 kg with wheels of 0.1 m.
    let accel = 8.0 / (30.0 * 0.1 * 0.1);
    let lengths = [1000, 10_000, 1000, 2000, 5000, 2500, 2600, 4000, 700];
    for dt_us in lengths.into_iter().cycle().take(700) {
        let dt = 1e-6 * f64::from(dt_us);
        us += dt_us;
        angle += dt * (speed + 0.5 * dt * accel);
        speed += dt * accel;
        let count = (angle * 4096.0 / core::f64::consts::TAU) as i32;
        let found = monitor.check(&DetectorInputs {
            dt_us,
            counts: Some(WheelCounts {
                right: count,
                left: count,
            }),
            ..pushing(0, 0, 0)
        });
        assert!(
            found
                .iter()
                .all(|fault| fault.kind() == FaultKind::TickJitter)
        );
    }
    assert!(us > 1_000_000);
    // After 20 windows both have settled at â/a², what is seen within the two counts by which it may be rounded; a tick lost, or taken twice, is a tenth.
    let settled = accel / 100.0;
    for wheel in [&monitor.detectors.right, &monitor.detectors.left] {
        let (seen, expected) = wheel.seen_and_expected();
        assert!(
            (expected - settled).abs() < 1e-6 * settled,
            "{expected} {settled}"
        );
        let rounding = 2.0 * core::f64::consts::TAU / 4096.0;
        assert!(
            (seen - settled).abs() < 0.03 * settled + rounding,
            "{seen} {settled}"
        );
    }
}

/// Torques that are not known in one of the ticks of a look are not known in it.
#[test]
fn a_tick_without_torques_blinds_the_looks_it_is_in() {
    let dark = |k: i32| {
        let mut inputs = brief(pushing(k, 0, 0));
        if k % 2 == 0 {
            inputs.torques = None;
        }
        inputs
    };
    let kind = FaultKind::EncoderStuck;
    assert_eq!(found_in(&mut every_ms(), 2000, kind, dark), None);
}
