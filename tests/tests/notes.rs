//! What a report says is unusual is so, and only then: transition offsets that fade, neurons that come back, torques at their limit.

use controller_core::paper::demand::Demand;
use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::cell::Cell;
use tests::core_draw::cases;
use tests::core_draw_loop::scenario;
use tests::core_flow::Flow;
use tests::core_loop::{Exact, hand_over, run};
use tests::core_params::{core_params, measured, sample};
use tests::ideal::Loop;
use tests::oracle::{Params, Phase, Reference, Reset, Scenario, continuous, robot};
use tests::plant::{Body, MovingReference};
use tests::tolerance::{
    FIRST_ORDER_HIGH, FIRST_ORDER_LOW, LIMITED, SETTLED, TRANSITION_OFFSET, TRANSITION_OFFSET_FLOOR,
};

/// Control period \[s\].
const DT: f64 = 10e-3;

/// A start that Eq. (18) cannot serve: the reference stands still but turns, then moves off.
fn infeasible_start() -> Scenario {
    Scenario {
        reference: Reference {
            v1: 0.5,
            omega_v: 1.0,
            ..Reference::steady([0.0, 0.0, 0.0], 0.0, 0.3)
        },
        q0: Vector3::new(-0.2, 0.5, 1.0),
        twist0: Vector2::new(0.3, -0.4),
        duration: 8.0,
        switch: None,
        ..Scenario::paper_line()
    }
}

/// Beyond Eq. (18) and Eq. (23): each transition offset fades as exp(-A t), and is gone when it is too small to matter.
#[test]
fn bridges_fade_with_the_rate_of_the_neurons() {
    TestRunner::new(cases(300))
        .run(&scenario(), |scenario| {
            let ticks = run::<f64, Exact>(&scenario, DT);
            let (start, switch) = (&ticks[..hand_over(&ticks)], &ticks[hand_over(&ticks)..]);
            for part in [start, switch] {
                let first = part[0].report.transition_offset;
                for tick in part {
                    let left = (-scenario.params.a * (tick.t - part[0].t)).exp();
                    let transition_offset = tick.report.transition_offset;
                    for (found, first) in [
                        (transition_offset.linear, first.linear),
                        (transition_offset.angular, first.angular),
                    ] {
                        let off = (found - first * left).abs();
                        prop_assert!(
                            off <= TRANSITION_OFFSET * first.abs() + TRANSITION_OFFSET_FLOOR,
                            "{off:e}"
                        );
                    }
                    let offset =
                        transition_offset.linear != 0.0 || transition_offset.angular != 0.0;
                    prop_assert_eq!(tick.report.has_transition_offset(0.0), offset);
                }
            }
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));

    let ticks = run::<f64, Exact>(&infeasible_start(), DT);
    assert!(ticks[0].report.has_transition_offset(0.0));
    /// A transition offset too small to matter [m/s, rad/s]: 1e-10 N with the gains of a 30 kg base.
    const GONE: f64 = 1e-12;
    let gone = ticks
        .iter()
        .position(|tick| !tick.report.has_transition_offset(GONE));
    let gone = ticks[gone.expect("the transition offset ends")].t;
    println!("transition offset gone at {gone:.2} s");
    assert!(
        ticks
            .iter()
            .filter(|tick| tick.t > gone)
            .all(|tick| !tick.report.has_transition_offset(GONE))
    );
}

/// A start with a transition offset is the sampled form of the continuous law: the distance halves with the tick.
#[test]
fn start_with_offset_converges_to_the_continuous_law() {
    let scenario = infeasible_start();
    let flow = Flow::new(&scenario);
    let mut state = flow.start();
    let coarse = 20e-3;
    let states: Vec<_> = (0..100)
        .map(|k| {
            let t = f64::from(k) * coarse;
            let now = state;
            state = flow.advance(Phase::Tracking, t, t + coarse, &state, continuous::STEP);
            now
        })
        .collect();
    let distances = [10e-3, 5e-3, 2.5e-3].map(|dt| {
        let ticks = run::<f64, Exact>(&scenario, dt);
        let stride = (coarse / dt).round() as usize;
        let pairs = ticks.iter().step_by(stride).zip(&states);
        pairs
            .map(|(tick, state)| (tick.body.q - state.fixed_rows::<3>(0)).norm())
            .fold(0.0, f64::max)
    });
    println!("start with a transition offset: {distances:.5?} m and rad");
    for pair in distances.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(
            (FIRST_ORDER_LOW..=FIRST_ORDER_HIGH).contains(&order),
            "{order}"
        );
    }
}

/// Pose neurons never leave \[-D, B\]; acceleration neurons may by Eq. (23) corrected, and then it is reported.
#[test]
fn relaxing_is_told_while_a_neuron_is_outside() {
    let relaxed = Cell::new(0);
    TestRunner::new(cases(500))
        .run(&scenario(), |scenario| {
            let p = &scenario.params;
            let ticks = run::<f64, Exact>(&scenario, DT);
            let inside = |s: f64| s >= -p.d && s <= p.b;
            for tick in &ticks {
                let n = &tick.report.neurons;
                prop_assert!(inside(n.s1) && inside(n.s2) && inside(n.s3));
                let outside = !(inside(n.accel.linear) && inside(n.accel.angular));
                prop_assert_eq!(tick.relaxing, outside);
                relaxed.set(relaxed.get() + u32::from(tick.wrench_step.is_some() && outside));
                prop_assert!(!outside || tick.t >= ticks[hand_over(&ticks)].t);
            }
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    println!("{} of 500 hand-overs put a neuron outside", relaxed.get());
    assert!(relaxed.get() > 10);
}

/// Torques of Eq. (16) beyond the wheels' limit: both scaled by one factor through B̄ of Eq. (3), reported, and survived.
#[test]
fn saturation_is_told_and_keeps_the_ratio() {
    let limit = 1.5;
    let scenario = Scenario::paper_curve();
    let p: Params = scenario.params;
    let mut params = core_params::<f64>(&p, Reset::Corrected);
    params.max_wheel_torque_nm = Some(limit);
    let params = params.validate().expect("in range");
    let to_wheels = robot::inverse(&robot::wheel_map(&p));
    let body = Body {
        q: scenario.q0,
        twist: scenario.twist0,
    };
    let mut reference = MovingReference::start(&scenario.reference);
    let mut demanded = |t: f64| {
        reference.move_to(&scenario.reference, t);
        sample::<f64>(&reference.q, &scenario.target(Phase::Tracking, t))
    };
    let now = measured(&body.q, &body.twist);
    let controller = Exact::start(&params, &demanded(0.0), &now).expect("finite");
    let mut report = *controller.report();
    let mut drive = Loop::new(controller, body, p, DT);
    let mut saturated = 0;
    for k in 1..=1000 {
        let given = Vector2::new(report.torques.right, report.torques.left);
        drive.hold(&(robot::wheel_map(&p) * given));
        let demand = Demand::Track(demanded(drive.t));
        let now = measured(&drive.body.q, &drive.body.twist);
        let step = drive.controller.step(DT, &demand, &now);
        report = *step.expect("a good tick");
        let asked = to_wheels * Vector2::new(report.wrench.force, report.wrench.moment);
        let given = Vector2::new(report.torques.right, report.torques.left);
        assert!(given.amax() <= limit);
        assert_eq!(report.saturated, asked.amax() > limit, "at tick {k}");
        let scale = (limit / asked.amax()).min(1.0);
        assert!((given - scale * asked).amax() <= LIMITED);
        saturated += u32::from(report.saturated);
    }
    let e = report.error;
    println!(
        "{saturated} of 1000 ticks saturated, e = ({:.1e}, {:.1e}, {:.1e})",
        e.x, e.y, e.theta
    );
    assert!(saturated > 10 && saturated < 900);
    assert!(e.x.hypot(e.y) < SETTLED, "the robot still follows: {e:?}");
}
