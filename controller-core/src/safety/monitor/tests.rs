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
pub(super) fn params() -> DetectorParams<f64> {
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

/// All there were, in a row or not.
#[test]
fn late_ticks_are_counted() {
    let mut monitor = monitor(params());
    assert_eq!(monitor.late_ticks(), 0);
    for late in [true, false, true, true, false] {
        let mut inputs = quiet();
        inputs.dt_us = if late { 15_000 } else { 14_999 };
        monitor.check(&inputs);
    }
    assert_eq!(monitor.late_ticks(), 3);
}

/// Looks come in parts: one in a tick of up to 3.1 ms, two in one of up to 6.2 ms, a whole one in one of up to 12.5 ms, and both in a longer one. Each
/// takes all that was exerted.
#[test]
fn longer_ticks_take_more_of_a_look() {
    for (dt_us, part, is_left) in [
        (3_125, Part::Push, false),
        (3_126, Part::Filter, false),
        (6_250, Part::Filter, false),
        (6_251, Part::Take, true),
        (12_500, Part::Take, true),
        (12_501, Part::Take, false),
    ] {
        let mut monitor = monitor(params());
        let mut inputs = pushing(1, 0, 0);
        inputs.dt_us = dt_us;
        monitor.check(&inputs);
        let Detectors {
            part: next,
            is_left: left,
            gathered,
            ..
        } = monitor.detectors;
        assert_eq!(
            (next, left, gathered),
            (part, is_left, Span::default()),
            "{dt_us}"
        );
    }
}

/// Times and impulses add up; torques that were not known for a while are not known.
#[test]
fn spans_add_up() {
    let torques = WheelTorques {
        right: 2.0,
        left: -3.0,
    };
    let known = Span::<f64>::of(1_000, Some(torques));
    let unknown = Span::of(2_000, None);
    for (one, other, us, share, is_unknown) in [
        (known, known, 2_000, 2.0, false),
        (known, unknown, 3_000, 1.0, true),
        (unknown, known, 3_000, 1.0, true),
        (unknown, unknown, 4_000, 0.0, true),
    ] {
        let WheelTorques { right, left } = one.and(&other).impulses;
        assert_eq!(
            (one.and(&other).us, one.and(&other).unknown),
            (us, is_unknown)
        );
        assert_eq!((right, left), (share * 2e-3, share * -3e-3));
    }
}

/// A wheel half a track beside the middle moves by that much of a turn, the right one forward: where both together would slip by less than is
/// allowed, one of them slips by more.
#[test]
fn a_turn_that_wheels_do_not_make_is_slip() {
    let slip = params().wheels.slip.speed_m_s;
    for (linear, angular, side) in [
        (0.0, 0.98 * slip / 0.25, None),
        (0.0, 1.02 * slip / 0.25, Some(Side::Both)),
        (0.98 * slip, 0.04 * slip / 0.25, Some(Side::Right)),
        (0.98 * slip, -0.04 * slip / 0.25, Some(Side::Left)),
    ] {
        let mut monitor = monitor(params());
        let off = |_| DetectorInputs {
            outside: Some(Twist::new(linear, angular)),
            ..quiet()
        };
        let kind = FaultKind::WheelSlip;
        let found = found_in(&mut monitor, 1000, kind, off);
        assert_eq!(found.is_some(), side.is_some(), "{linear} {angular}");
        let found = monitor.check(&off(0)).get(kind);
        assert_eq!(found, side.map(Fault::WheelSlip));
    }
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

/// A hundredth of the torque that turns a free wheel is no push, but the wheel is commanded to turn: four times 250 ms without a count. One count a second,
/// or a torque that brakes, and nothing is said.
#[test]
fn a_wheel_that_stands_while_commanded_is_stuck_however_little_it_is_pushed() {
    let found = |torque: f64, count_every: i32| {
        let mut monitor = monitor(params());
        found_in(&mut monitor, 1000, FaultKind::EncoderStuck, |k| {
            let mut now = pushing(k, 0, 100);
            now.torques = Some(WheelTorques {
                right: torque,
                left: torque,
            });
            if let Some(counts) = &mut now.counts {
                counts.right = k / count_every;
            }
            now
        })
    };
    let little = 0.01 * params().wheels.stuck.torque_nm;
    // From the first reading, in the first tick, in looks every 20 ms.
    assert_eq!(found(little, 2000), Some(101));
    assert_eq!(found(little, 100), None);
    assert_eq!(found(-little, 2000), None);
}

/// As little pushed, and it counts against its command all the while: 8 counts or more in a second are an encoder that is the wrong way round, fewer a
/// wheel that stands. A count the way that it is commanded, and all begins anew.
#[test]
fn a_wheel_that_turns_against_its_command_is_reversed_however_little_it_is_pushed() {
    let found = |kind: FaultKind, torque: f64, count_every: i32, ahead_at: i32| {
        let mut monitor = monitor(params());
        found_in(&mut monitor, 300, kind, |k| {
            let mut now = pushing(k, 0, 100);
            now.torques = Some(WheelTorques {
                right: torque,
                left: torque,
            });
            if let Some(counts) = &mut now.counts {
                counts.right = i32::from(k >= ahead_at) * 40 - k / count_every;
            }
            now
        })
    };
    let little = 0.01 * params().wheels.stuck.torque_nm;
    let (reversed, stuck) = (FaultKind::EncoderReversed, FaultKind::EncoderStuck);
    assert_eq!(found(reversed, little, 4, 300), Some(101));
    assert_eq!(found(stuck, little, 4, 300), None);
    assert_eq!(found(stuck, little, 15, 300), Some(101));
    assert_eq!(found(reversed, little, 4, 50), Some(151));
    assert_eq!(found(reversed, -little, 4, 300), None);
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
    // The first reading only tells where the counts are, in the second tick for the left one; 250 ms from then, in looks every 20 ms.
    let (tick, found) = stuck(100, 0).expect("left stands");
    assert_eq!(tick, 28);
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
    // 250 ms from the first tick, which looks at the right wheel, in looks every 20 ms.
    assert_eq!(
        found_in(&mut walled, 100, FaultKind::Stalled, blocked),
        Some(27)
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
