//! Which fault it is that a wheel moves against its torque.

use super::*;
use core::f64::consts::TAU;

/// Adds what was found to all there was: of two wheels one is looked at after the other, and then both are named.
fn gather(all: &mut ActiveFaults, mut found: ActiveFaults) {
    let both = |fault| {
        matches!(
            fault,
            Fault::EncoderStuck(Side::Both) | Fault::EncoderReversed(Side::Both)
        )
    };
    if found.iter().any(both) {
        found.add_all(all);
        *all = found;
    } else {
        all.add_all(&found);
    }
}

/// Driven up with 4 N m for half a second, then held back by twice what those give, though these are still
/// commanded, down to the speed `until` \[rad/s\] and no further. `change` edits the inputs, given the counts at which
/// this began and ticks since: all that is found.
fn slowed_to(until: f64, change: impl Fn(&mut DetectorInputs<f64>, i32, i32)) -> ActiveFaults {
    let mut watched = params();
    watched.supply.after = Timeout::AfterUs(500_000);
    let mut monitor = monitor(watched);
    let (mut speed, mut turned) = (0.0, 0.0);
    // 8 N m on 30 kg with wheels of 0.1 m: 26.7 rad/s².
    let accel = 8.0 / (30.0 * 0.1 * 0.1);
    let (mut all, mut from) = (ActiveFaults::NONE, 0);
    for tick in 1..=150 {
        let held = tick > 50;
        speed += 0.01 * if held { -2.0 * accel } else { accel };
        speed = f64::max(speed, until);
        turned += 0.01 * speed;
        let count = (turned * 4096.0 / TAU) as i32;
        let mut inputs = DetectorInputs {
            counts: Some(WheelCounts {
                right: count,
                left: count,
            }),
            ..pushing(0, 0, 0)
        };
        if held {
            change(&mut inputs, from, tick - 50);
        } else {
            from = count;
        }
        gather(&mut all, monitor.check(&inputs));
    }
    all
}

/// Held back until it turns the other way, as friction never does.
fn held_back_from(change: impl Fn(&mut DetectorInputs<f64>, i32, i32)) -> ActiveFaults {
    slowed_to(f64::NEG_INFINITY, change)
}

fn held_back(change: impl Fn(&mut DetectorInputs<f64>)) -> ActiveFaults {
    held_back_from(|inputs, _, _| change(inputs))
}

/// A reversed encoder would show it turning the other way, ever faster.
#[test]
fn a_wheel_that_friction_brakes_against_its_torque_is_not_reversed() {
    for until in [0.0, 1.0, 5.0] {
        let found = slowed_to(until, |_, _, _| {});
        assert_eq!(found.get(FaultKind::EncoderReversed), None, "{until} rad/s");
    }
}

#[test]
fn a_wheel_held_back_is_not_reversed_where_its_torque_is_not_known() {
    let reversed = |found: ActiveFaults| found.get(FaultKind::EncoderReversed).is_some();
    // It is, as far as anyone can tell, where 4 N m are said to be exerted.
    assert!(reversed(held_back(|_| {})));
    assert!(held_back(|now| now.torques = None).is_empty());
    let sags = |volts| held_back(move |now| now.supply_v = Some(volts));
    let low = params().supply.low_v;
    for volts in [0.99 * low, f64::NAN] {
        let found = sags(volts);
        assert_eq!(found.iter().count(), 1, "{volts} V: {found:?}");
        assert!(found.get(FaultKind::UnderVoltage).is_some());
    }
    assert!(reversed(sags(low)));
}

/// A supply that nobody watches blinds nobody.
#[test]
fn a_low_supply_is_no_excuse_where_it_is_not_watched() {
    let mut unwatched = params();
    unwatched.supply.after = Timeout::Off;
    let mut monitor = monitor(unwatched);
    let stuck = |k| DetectorInputs {
        supply_v: Some(0.0),
        ..pushing(k, 0, 0)
    };
    // 250 ms from the first tick, in looks every 20 ms.
    assert_eq!(
        found_in(&mut monitor, 100, FaultKind::EncoderStuck, stuck),
        Some(27)
    );
}

/// Too little torque for a wheel that only stands to be called stuck, but it turned just before.
#[test]
fn an_encoder_that_dies_on_the_way_is_stuck() {
    for (right, left, side) in [
        (true, false, Side::Right),
        (false, true, Side::Left),
        (true, true, Side::Both),
    ] {
        let found = held_back_from(|now, from, ticks| {
            now.torques = Some(WheelTorques {
                right: 2.0,
                left: 2.0,
            });
            if let Some(counts) = &mut now.counts {
                // 13.3 rad/s go on.
                let on = from + 87 * ticks;
                counts.right = if right { from } else { on };
                counts.left = if left { from } else { on };
            }
        });
        let stuck = Some(Fault::EncoderStuck(side));
        assert_eq!(found.get(FaultKind::EncoderStuck), stuck);
        assert_eq!(found.get(FaultKind::EncoderReversed), None);
    }
}

/// Driven up with 4 N m for a second, left alone for half of one, then braked with 2 N m while still commanded to go on: what is found
/// if from 0.15 s later on, for 0.3 s, both encoders show this share of the way.
fn braked(share: f64) -> ActiveFaults {
    let mut monitor = monitor(params());
    let (mut speed, mut turned) = (0.0, 0.0);
    let mut all = ActiveFaults::NONE;
    for tick in 1..=195 {
        let torque = match tick {
            ..=100 => 4.0,
            101..=150 => 0.0,
            _ => -2.0,
        };
        // Both wheels on 30 kg, with a radius of 0.1 m.
        speed += 0.01 * 2.0 * torque / (30.0 * 0.1 * 0.1);
        turned += 0.01 * speed * if tick > 165 { share } else { 1.0 };
        let count = (turned * 4096.0 / TAU) as i32;
        let inputs = DetectorInputs {
            counts: Some(WheelCounts {
                right: count,
                left: count,
            }),
            torques: Some(WheelTorques {
                right: torque,
                left: torque,
            }),
            ..pushing(0, 0, 0)
        };
        gather(&mut all, monitor.check(&inputs));
    }
    all
}

/// A wheel that slips as it brakes is slowed by more than the base, and goes on counting the way that it is driven.
#[test]
fn an_encoder_that_fails_while_its_wheel_brakes_does_not_slip() {
    let slips = |share: f64| braked(share).get(FaultKind::WheelSlip).is_some();
    assert!(!slips(1.0), "in order");
    assert!(slips(0.2), "slowed to a fifth");
    assert!(!slips(0.0), "dead");
    assert!(!slips(-1.0), "reversed");
}

/// The motor of a dead encoder pulls the other wheel back: its back-EMF is not made up for.
#[test]
fn a_wheel_that_a_dead_one_pulls_back_is_not_reversed() {
    let pulled = |speed: f64| {
        held_back_from(|now, from, _| {
            now.command = Twist::new(speed, 0.0);
            if let Some(counts) = &mut now.counts {
                counts.right = from;
            }
        })
    };
    let found = pulled(0.5);
    let stuck = Some(Fault::EncoderStuck(Side::Right));
    assert_eq!(found.get(FaultKind::EncoderStuck), stuck);
    assert_eq!(found.get(FaultKind::EncoderReversed), None);
    // Where it is not commanded to turn it may well stand, and the other one is what it seems.
    let reversed = Some(Fault::EncoderReversed(Side::Left));
    assert_eq!(pulled(0.0).get(FaultKind::EncoderReversed), reversed);
}

/// One wheel is against its torque, ever faster; the other one counted last so long ago.
#[test]
fn a_wheel_that_rests_for_a_moment_is_not_dead() {
    let against = WheelDetections {
        against: true,
        reversed: true,
        ..WheelDetections::default()
    };
    let silent_for = |us: u32| {
        let mut wheel = Wheel::<f64>::default();
        let settings = params().validate().expect("valid");
        let still = Look {
            us,
            moved: Some(0),
            ..Look::default()
        };
        wheel.push(&settings, &still);
        wheel.detections(&settings, 5.0, None)
    };
    for (us, stuck, backwards) in [
        (49_999, None, Some(Side::Left)),
        // It may be about to turn the other way: nothing is said.
        (50_000, None, None),
        (149_999, None, None),
        (150_000, Some(Side::Right), None),
    ] {
        let right = silent_for(us);
        assert_eq!(dead(&right, &against), stuck, "{us} us");
        assert_eq!(reversed(&right, &against), backwards, "{us} us");
    }
}

/// At a steady speed no acceleration shows it; that it turns the other way than it is commanded and pushed, all the while, does.
#[test]
fn a_wheel_that_turns_back_under_its_torque_is_reversed() {
    let back = |k: i32| pushing(k, -1, 1);
    let kind = FaultKind::EncoderReversed;
    // 0.25 s of looks every 20 ms, from the first reading.
    assert_eq!(found_in(&mut monitor(params()), 100, kind, back), Some(27));
    // One that counts forward in a look now and then is none that turns back. A single count, that the tick before or after takes back, is lost in a
    // look of two ticks.
    for (forward, found) in [(2, None), (1, Some(27))] {
        let to_and_fro = |k: i32| DetectorInputs {
            counts: Some(WheelCounts {
                right: -k + (1 + forward) * (k / 10),
                left: k,
            }),
            ..pushing(k, 0, 0)
        };
        assert_eq!(
            found_in(&mut monitor(params()), 1000, kind, to_and_fro),
            found
        );
    }
    // Nor is one that is not pushed: it rolls.
    let rolls = |k: i32| DetectorInputs {
        torques: Some(WheelTorques::default()),
        ..pushing(k, -1, 1)
    };
    assert_eq!(found_in(&mut monitor(params()), 1000, kind, rolls), None);
}
