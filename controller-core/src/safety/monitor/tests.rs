//! Each detector at its threshold: a tick before, and the tick in which it finds.

use super::*;
use crate::error::Field;
use crate::hal::ErrorKind;
use crate::hal::WheelCounts;
use crate::maths::Libm;
use crate::motion::{Limits, MotionParams};
use crate::paper::params::Params;
use crate::safety::{Currents, DetectorParams, FaultKind, Timeout};
use crate::types::WheelTorques;

mod named;
mod turns;

/// Ticks of 10 ms on the paper's robot with wheels of 15 N m and 4096 counts.
fn params() -> DetectorParams<f64> {
    let motion = MotionParams::new_with::<Libm>(Params::paper().robot, Limits::PAPER);
    DetectorParams::for_base(&motion, 4096.0, 10_000)
}

fn monitor(params: DetectorParams<f64>) -> Monitor<f64> {
    Monitor::new(&params.validate().expect("valid"))
}

/// Standing, with everything in order.
fn quiet() -> DetectorInputs<f64> {
    DetectorInputs {
        dt_us: 10_000,
        counts: Some(WheelCounts::default()),
        torques: Some(WheelTorques::default()),
        ..DetectorInputs::default()
    }
}

/// The tick, counted from 1, in which `kind` is found first.
fn found_in(
    monitor: &mut Monitor<f64>,
    ticks: i32,
    kind: FaultKind,
    inputs: impl Fn(i32) -> DetectorInputs<f64>,
) -> Option<i32> {
    (1..=ticks).find(|tick| monitor.check(&inputs(*tick)).get(kind).is_some())
}

#[test]
fn nothing_is_found_on_a_base_that_stands() {
    let mut monitor = monitor(params());
    for _ in 0..10_000 {
        assert!(monitor.check(&quiet()).is_empty());
    }
}

#[test]
fn silence_is_found_at_its_timeout_and_ends_with_a_reading() {
    let mut monitor = monitor(params());
    let silent = |_| DetectorInputs {
        counts: None,
        ..quiet()
    };
    let found = found_in(&mut monitor, 100, FaultKind::MeasurementStale, silent);
    assert_eq!(found, Some(5), "50 ms");
    assert!(monitor.check(&quiet()).is_empty());
}

#[test]
fn ages_are_compared_with_their_timeouts_and_off_is_off() {
    let mut with_pose = params();
    with_pose.pose = Timeout::AfterUs(500_000);
    with_pose.command = Timeout::Off;
    let mut monitor = monitor(with_pose);
    let mut aged = quiet();
    aged.command_age_us = u32::MAX;
    aged.pose_age_us = 499_999;
    assert!(monitor.check(&aged).is_empty());
    aged.pose_age_us = 500_000;
    let found = monitor.check(&aged);
    assert_eq!(found.get(FaultKind::PoseStale), Some(Fault::PoseStale));
    assert_eq!(found.iter().count(), 1);
}

#[test]
fn late_ticks_in_a_row_and_among_many() {
    let late = |late: bool| DetectorInputs {
        dt_us: if late { 15_001 } else { 10_000 },
        ..quiet()
    };
    let row = found_in(&mut monitor(params()), 10, FaultKind::TickJitter, |_| {
        late(true)
    });
    assert_eq!(row, Some(5));
    // Every third one: the 16th late one among 64 is the 48th tick.
    let many = found_in(&mut monitor(params()), 100, FaultKind::TickJitter, |k| {
        late(k % 3 == 0)
    });
    assert_eq!(many, Some(48));
    // Every fifth one: 13 of 64.
    let few = found_in(&mut monitor(params()), 1000, FaultKind::TickJitter, |k| {
        late(k % 5 == 0)
    });
    assert_eq!(few, None);
    let mut long = quiet();
    long.dt_us = 100_000;
    let found = monitor(params()).check(&long);
    assert_eq!(found.get(FaultKind::TickTooLong), Some(Fault::TickTooLong));
}

#[test]
fn what_others_tell_is_passed_on() {
    let mut reported = quiet();
    reported.pose_jumped = true;
    reported.driver = Some(ErrorKind::OverCurrent);
    reported.measured.pose.x = f64::NAN;
    let found = monitor(params()).check(&reported);
    for fault in [
        Fault::PoseJump,
        Fault::Driver(ErrorKind::OverCurrent),
        Fault::NotFinite(Input::Pose),
    ] {
        assert_eq!(found.get(fault.kind()), Some(fault));
    }
    assert_eq!(found.iter().count(), 3);
}

#[test]
fn currents_and_supply_have_time_and_hysteresis() {
    let mut watched = params();
    watched.current.after = Timeout::AfterUs(200_000);
    watched.supply.after = Timeout::AfterUs(100_000);
    let mut monitor = monitor(watched);
    let inputs = |amps: f64, volts: f64| DetectorInputs {
        currents: Some(Currents {
            right: 1.0,
            left: amps,
        }),
        supply_v: Some(volts),
        ..quiet()
    };
    // A braking current is a current.
    let over = found_in(&mut monitor, 100, FaultKind::OverCurrent, |_| {
        inputs(-10.5, 12.0)
    });
    assert_eq!(over, Some(20));
    let low = found_in(&mut monitor, 100, FaultKind::UnderVoltage, |_| {
        inputs(0.0, 9.9)
    });
    assert_eq!(low, Some(10));
    // Between the two limits it is still too low, and without a measurement too.
    assert!(!monitor.check(&inputs(0.0, 10.9)).is_empty());
    assert!(!monitor.check(&quiet()).is_empty());
    assert!(monitor.check(&inputs(0.0, 11.0)).is_empty());
    assert!(monitor.check(&inputs(0.0, 10.9)).is_empty());
    let broken = found_in(&mut monitor, 100, FaultKind::UnderVoltage, |_| {
        inputs(0.0, f64::NAN)
    });
    assert_eq!(broken, Some(10), "not a number is not good");
}

/// Both wheels commanded to turn with 4 N m, counts by `moves` \[1/tick\].
fn pushing(tick: i32, right: i32, left: i32) -> DetectorInputs<f64> {
    DetectorInputs {
        counts: Some(WheelCounts {
            right: right * tick,
            left: left * tick,
        }),
        command: Twist::new(0.5, 0.0),
        torques: Some(WheelTorques {
            right: 4.0,
            left: 4.0,
        }),
        ..quiet()
    }
}

#[test]
fn a_wheel_that_stands_under_torque_is_stuck_and_one_that_creeps_is_not() {
    let stuck = |right, left| {
        let mut monitor = monitor(params());
        let found = found_in(&mut monitor, 200, FaultKind::EncoderStuck, |k| {
            pushing(k, right, left)
        });
        found.map(|tick| (tick, monitor.check(&pushing(tick, right, left))))
    };
    // The first reading only tells where the counts are; 250 ms from then.
    let (tick, found) = stuck(100, 0).expect("left stands");
    assert_eq!(tick, 26);
    assert_eq!(
        found.get(FaultKind::EncoderStuck),
        Some(Fault::EncoderStuck(Side::Left))
    );
    let (_, found) = stuck(0, 0).expect("both stand");
    assert_eq!(
        found.get(FaultKind::EncoderStuck),
        Some(Fault::EncoderStuck(Side::Both))
    );
    assert!(stuck(100, 1).is_none(), "a count in each tick");
}

#[test]
fn holding_a_place_is_not_being_stuck_and_a_wall_is_not_an_encoder() {
    let mut held = monitor(params());
    let holding = |k| DetectorInputs {
        command: Twist::default(),
        ..pushing(k, 0, 0)
    };
    let kind = FaultKind::EncoderStuck;
    assert_eq!(found_in(&mut held, 1000, kind, holding), None);
    let mut walled = monitor(params());
    let blocked = |k| DetectorInputs {
        outside: Some(Twist::default()),
        ..pushing(k, 0, 0)
    };
    assert_eq!(
        found_in(&mut walled, 100, FaultKind::Stalled, blocked),
        Some(26)
    );
    assert_eq!(walled.check(&blocked(1)).get(kind), None);
}

/// Wild torques and counts leave nothing behind.
#[test]
fn wild_inputs_do_not_stay() {
    let mut monitor = monitor(params());
    for torque in [f64::MAX, f64::NAN, f64::NEG_INFINITY] {
        let mut wild = quiet();
        wild.torques = Some(WheelTorques {
            right: torque,
            left: -torque,
        });
        wild.counts = Some(WheelCounts {
            right: i32::MIN,
            left: i32::MAX,
        });
        monitor.check(&wild);
    }
    // Ten seconds are a hundred time constants of the window.
    for _ in 0..1000 {
        monitor.check(&quiet());
    }
    assert!(monitor.check(&quiet()).is_empty());
    assert!(monitor.detectors.right.seen_is_finite() && monitor.detectors.left.seen_is_finite());
}

#[test]
fn parameters_out_of_range_are_named() {
    let refused = |change: fn(&mut DetectorParams<f64>)| {
        let mut changed = params();
        change(&mut changed);
        changed.validate().expect_err("out of range").field
    };
    for (field, found) in [
        (
            Field::TickPeriod,
            refused(|settings| settings.period_us = 0),
        ),
        (
            Field::MeasurementTimeout,
            refused(|settings| settings.measurement = Timeout::AfterUs(19_999)),
        ),
        (
            Field::CommandTimeout,
            refused(|settings| settings.command = Timeout::AfterUs(u32::MAX)),
        ),
        (Field::LateRow, refused(|settings| settings.ticks.row = 0)),
        (
            Field::LateShare,
            refused(|settings| settings.ticks.of_64 = 65),
        ),
        (
            Field::WheelLoad,
            refused(|settings| settings.wheels.load_nm = f64::NAN),
        ),
        (
            // 64 counts at 0.2 rad/s take half a second each.
            Field::StuckSpeed,
            refused(|settings| settings.wheels.counts_per_turn = 64.0),
        ),
        (
            Field::SupplyRecovered,
            refused(|settings| settings.supply.recovered_v = 9.0),
        ),
        (
            Field::Mass,
            refused(|settings| settings.robot.mass_kg = 0.0),
        ),
    ] {
        assert_eq!(field, found);
    }
}
