//! What a base is told beside its orders, what does not fit it, and a dead encoder beside a gyro.

use controller_core::base::{BaseError, BaseReport, Order, WheelAction};
use controller_core::error::{Field, ParamError, Problem};
use controller_core::gyro::GyroParams;
use controller_core::maths::Single;
use controller_core::reference::Reference;
use controller_core::safety::supervisor::{Action, Cause, Event, State};
use controller_core::safety::{Fault, FaultKind, Side, Timeout};
use controller_core::types::{Accel, Pose, Twist};
use tests::rolling::{AS_STATED, Rig, Truth, shipped, with_period};
use tests::stated::{At, Stated};

fn drive(v: f32, w: f32) -> Order {
    Order::Drive {
        twist: Twist::new(v, w),
        hold_heading: true,
    }
}

/// Whatever is said that is no order and no stop: a base that drives by velocity stops as if nothing had been said, with a link and without one.
#[test]
fn events_are_no_orders() {
    let stops = |event: &Event| {
        matches!(
            event,
            Event::Stop | Event::LinkLost | Event::EmergencyStop { .. } | Event::Fault(_)
        )
    };
    let mut said = 0;
    for (name, params) in shipped() {
        let Timeout::AfterUs(patience_us) = params.detectors.command else {
            panic!("{name} waits for ever");
        };
        for link in [false, true] {
            for event in Event::ALL.into_iter().filter(|event| !stops(event)) {
                let mut rig = Rig::new(params, AS_STATED);
                let period_us = params.detectors.period_us;
                let tick = |rig: &mut Rig, order: &Order| -> BaseReport {
                    if link {
                        rig.base.frame_seen();
                        rig.base.watch_link(period_us);
                    }
                    rig.tick(order)
                };
                let order = drive(0.5 * params.motion.limits.speed, 0.0);
                for _ in 0..rig.ticks(2.0) {
                    assert_eq!(tick(&mut rig, &order).state, State::Tracking);
                }
                let mut ticks = 0;
                let state = loop {
                    assert_eq!(rig.base.on(event), Action::Refuse, "{name}: {event:?}");
                    ticks += 1;
                    match tick(&mut rig, &Order::None).state {
                        State::Tracking => assert!(ticks * period_us <= patience_us, "{event:?}"),
                        state => break state,
                    }
                };
                assert!(matches!(state, State::Stopping(_)), "{name}: {event:?}");
                // A stop ends when the base stands, not when somebody says so.
                while let State::Stopping(_) = rig.base.report().state {
                    rig.base.on(Event::Halted);
                    tick(&mut rig, &Order::None);
                }
                assert!(rig.twist.linear.abs() < 0.02, "{name}: {:?}", rig.twist);
                said += 1;
            }
        }
    }
    assert_eq!(said, 3 * 2 * 10);
}

/// A tick of which the law takes no step is too long whatever the period: the base stops from that tick on, and is not let go in between.
#[test]
fn a_tick_beyond_the_laws_longest_begins_a_stop() {
    let mut stops = 0;
    for period_us in [10_000, 49_000, 60_000, 100_000] {
        for (name, params) in with_period(|_| period_us) {
            for late_us in [501_000, 700_000, 999_000, 1_000_000, 3_000_000] {
                let mut rig = Rig::new(params, AS_STATED);
                let order = drive(0.3 * params.motion.limits.speed, 0.0);
                for _ in 0..rig.ticks(3.0) {
                    assert_eq!(rig.tick(&order).state, State::Tracking);
                }
                let mut report = rig.tick_after(late_us, &order);
                let said = format!("{name}, {late_us} us late of {period_us}: {report:?}");
                assert_eq!(report.cause, Cause::Fault(Fault::TickTooLong), "{said}");
                for _ in 0..3 {
                    assert!(matches!(report.state, State::Stopping(_)), "{said}");
                    assert!(matches!(report.action, WheelAction::Drive(_)), "{said}");
                    report = rig.tick(&order);
                }
                stops += 1;
            }
        }
    }
    assert_eq!(stops, 4 * 3 * 5);
}

#[test]
fn a_trajectory_that_ended_is_parked_at_its_last_reference() {
    for (name, params) in shipped() {
        let mut rig = Rig::new(params, AS_STATED);
        let period_us = params.detectors.period_us;
        let tick = |rig: &mut Rig, order: &Order| {
            rig.base.frame_seen();
            rig.base.watch_link(period_us);
            rig.tick(order).state
        };
        for i in 0..rig.ticks(2.0) {
            let t = i as f32 * rig.dt();
            let (pose, twist) = (Pose::new(0.05 * t * t, 0.0, 0.0), Twist::new(0.1 * t, 0.0));
            let reference = Reference::new_with::<Single>(pose, twist, Accel::new(0.1, 0.0));
            tick(&mut rig, &Order::Follow(reference));
        }
        assert_eq!(
            rig.base.on(Event::TrajectoryEnded),
            Action::ParkAtLastReference,
            "{name}"
        );
        let parked = (0..rig.ticks(10.0)).any(|_| tick(&mut rig, &Order::None) == State::Parked);
        assert!(parked, "{name}");
        let x = rig.base.report().measured.expect("counts").pose.x;
        assert!((x - 0.2).abs() < 5e-3, "{name}: parked at {x} of 0.2 m");
    }
}

#[test]
fn parameters_that_do_not_fit_each_other_are_refused() {
    for (name, params) in shipped() {
        let motor = params.driver.motor().expect("motors");
        let no_load = motor.supply_v / (motor.gear_ratio * motor.torque_constant_nm_per_a);
        let radius = params.motion.robot.wheels.radius_left_m;
        let mut fast = params;
        fast.motion.limits.rim_speed = 1.01 * no_load * radius;
        let Err(BaseError::Param(ParamError { field, problem })) = fast.validate() else {
            panic!("{name} is to be faster than its motors");
        };
        assert_eq!(field, Field::MaxRimSpeed);
        assert!(
            matches!(problem, Problem::Above(most) if (most - f64::from(no_load * radius)).abs() < 1e-6 * most)
        );
        let mut other = params;
        other.localiser.odometry.wheels.track_m *= 2.0;
        let (field, problem) = (Field::WheelMatrix, Problem::Differs);
        assert_eq!(
            other.validate(),
            Err(BaseError::Param(ParamError { field, problem })),
            "{name}"
        );
    }
}

/// The gyro holds the heading, so that nothing else shows that one encoder is dead: the base would drive on, faster than it is told.
#[test]
fn a_dead_encoder_beside_a_gyro_is_found() {
    let (mut longest_s, mut runs) = (0.0_f32, 0_u32);
    for (name, mut params) in shipped() {
        params.localiser.gyro = Some(GyroParams::icm_42688_p());
        for (i, side) in [Side::Right, Side::Left].into_iter().enumerate() {
            for (v, w) in [
                (0.015, 0.0),
                (0.0, 0.1),
                (0.03, 0.0),
                (0.05, 0.0),
                (-0.05, 0.0),
                (0.1, 0.0),
                (0.0, 0.2),
                (0.0, -0.4),
                (0.3, 0.0),
            ] {
                let mut rig = Rig::new(params, AS_STATED);
                rig.gyro = true;
                for _ in 0..rig.ticks(3.0) {
                    rig.tick(&drive(v, w));
                }
                rig.counts_per_mark[i] = 0;
                let ticks = (0..rig.ticks(20.0)).find(|_| {
                    let found = rig.tick(&drive(v, w)).active_faults;
                    found.get(FaultKind::EncoderStuck) == Some(Fault::EncoderStuck(side))
                });
                let ticks =
                    ticks.unwrap_or_else(|| panic!("{name}: {side:?} at {v} m/s, {w} rad/s"));
                longest_s = longest_s.max(ticks as f32 * rig.dt());
                runs += 1;
            }
        }
    }
    let mut page = Stated::of("docs/faults.md");
    page.about(
        At::Phrase("a gyro shows a dead encoder within # s in all of # such drives"),
        &[longest_s.into(), runs.into()],
    );
}

/// An encoder that counts the wrong way from when a slow base is told to stop, beside a gyro that holds the heading: one wheel's way takes the other's
/// away, so that the base believes that it stands, and what keeps it rolling is taken for a load. Told to go on, it pushes the wheel, which its own
/// detector sees.
#[test]
fn a_reversed_encoder_beside_a_gyro_is_found() {
    let (mut longest_s, mut farthest_m, mut runs) = (0.0_f32, 0.0_f32, 0_u32);
    for (name, mut params) in shipped() {
        params.localiser.gyro = Some(GyroParams::icm_42688_p());
        for i in 0..2 {
            for v in [0.005_f32, 0.01, 0.015, -0.015, 0.02, 0.03, 0.1, 0.3] {
                for then in [0.0, v] {
                    let truth = Truth {
                        loads: -0.5 * v.signum(),
                        ..AS_STATED
                    };
                    let mut rig = Rig::new(params, truth);
                    rig.gyro = true;
                    for _ in 0..rig.ticks(3.0) {
                        rig.tick(&drive(v, 0.0));
                    }
                    rig.counts_per_mark[i] = -1;
                    let mut way = 0.0;
                    let mut found = None;
                    let ticks = (0..rig.ticks(20.0)).find(|_| {
                        way += rig.dt() * rig.twist.linear;
                        let report = rig.tick(&drive(then, 0.0));
                        found = (!report.state.drives()).then_some(report.cause);
                        found.is_some()
                    });
                    let side = [Side::Right, Side::Left][i];
                    let reversed = Cause::Fault(Fault::EncoderReversed(side));
                    assert_eq!(found, Some(reversed), "{name}: {v} m/s, then {then}");
                    longest_s = longest_s.max(ticks.unwrap_or(0) as f32 * rig.dt());
                    farthest_m = farthest_m.max(way.abs());
                    runs += 1;
                }
            }
        }
    }
    let mut page = Stated::of("docs/faults.md");
    page.about(
        At::Phrase(
            "told to stop or to go on, it is found within # s and # m in all of # such drives",
        ),
        &[longest_s.into(), farthest_m.into(), runs.into()],
    );
}

/// A tick longer than the law takes a step for, within a controlled stop: the base goes on stopping and does not let its wheels go.
#[test]
fn a_late_tick_does_not_interrupt_a_stop() {
    for (name, params) in shipped() {
        let mut rig = Rig::new(params, AS_STATED);
        let order = drive(0.5 * params.motion.limits.speed, 0.0);
        for _ in 0..rig.ticks(2.0) {
            rig.tick(&order);
        }
        rig.base.on(Event::Stop);
        for _ in 0..3 {
            let report = rig.tick(&Order::None);
            assert!(matches!(report.state, State::Stopping(_)), "{name}");
        }
        rig.params.detectors.period_us = (1.1e6 * params.motion.max_tick_s) as u32;
        let report = rig.tick(&Order::None);
        assert!(matches!(report.state, State::Stopping(_)), "{name}");
        assert!(
            report.action.torques().is_some(),
            "{name}: {:?}",
            report.action
        );
        // What it asks for is still within the limits.
        let torques = report.action.torques().unwrap_or_default();
        let most = params.motion.limits.wheel_torque_nm;
        assert!(
            torques.right.abs().max(torques.left.abs()) <= most,
            "{name}: {torques:?}"
        );
    }
}
