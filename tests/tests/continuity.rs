//! No start and no hand-over jumps, whatever the gains, the posture, the twist and the reference: drawn closed loops in
//! single and double precision, and every tick within a bound derived from Eq. (1) to Eq. (23).

use controller_core::maths::{Libm, Maths, Single};
use controller_core::paper::neural::NeuralController;
use controller_core::paper::plain::PlainController;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactHeld, ExactMean, NeuronUpdate, RationalMean};
use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, PI};
use tests::core_draw::cases;
use tests::core_draw_loop::scenario;
use tests::core_loop::{Tick, hand_over, run};
use tests::oracle::{Params, Phase, Scenario, posture};
use tests::tolerance::{NEAR_BOUND, ROUNDINGS};

/// Drawn loops per scalar, update and back end.
const CASES: u32 = 1000;

/// Whether a neuron at `s` can be inside \[-D, B\]; `None` where rounding decides.
fn fits(p: &Params, s: f64) -> Option<bool> {
    let margin = (p.b - s).min(s + p.d);
    (margin.abs() > NEAR_BOUND * (p.b + p.d)).then_some(margin > 0.0)
}

/// Largest rounding of a torque, given the largest terms of command and acceleration.
fn rounding<T: Scalar>(p: &Params, scenario: &Scenario, extra: f64) -> f64 {
    let bound = p.b.max(p.d);
    let v_r = scenario.reference.v0.abs() + scenario.reference.v1.abs();
    let speed = 2.0 + v_r + (p.k1 + p.k4) * bound;
    let turn = 3.0 + p.k2 * v_r * bound + p.k3 + p.k5;
    let gain = p.kd1.max(p.kc1).max(p.kd2).max(p.kc2);
    let accel = p.m.max(p.inertia) * (bound + extra);
    ROUNDINGS * T::EPSILON.to_f64() * (gain * (speed + turn + extra) + accel)
}

/// Eq. (18) and Eq. (19): no torque, the command is the measured twist, and a transition offset is reported where (18) fails.
fn check_start<T: Scalar>(scenario: &Scenario, first: &Tick<T>) -> Result<(), TestCaseError> {
    let p = &scenario.params;
    let small = rounding::<T>(p, scenario, 0.0);
    prop_assert!(
        first.tau().amax() <= small,
        "start torque {:e}",
        first.tau().amax()
    );
    let command = (first.command() - scenario.twist0).amax();
    prop_assert!(command <= small, "command off by {command:e}");

    let twist_r = scenario.target(Phase::Tracking, 0.0).twist;
    let e = posture::error(&scenario.reference.q0.into(), &scenario.q0);
    let turn = scenario.twist0.y - twist_r.y - p.k3 * e.z.sin();
    let ahead = fits(p, (scenario.twist0.x - twist_r.x * e.z.cos()) / p.k1);
    let across = if twist_r.x == 0.0 {
        Some(turn == 0.0)
    } else {
        fits(p, turn / (p.k2 * twist_r.x))
    };
    if let (Some(ahead), Some(across)) = (ahead, across) {
        prop_assert_eq!(
            first.report.has_transition_offset(T::ZERO),
            !(ahead && across),
            "{} {}",
            ahead,
            across
        );
    }
    Ok(())
}

/// Eq. (23): command and torque of the new law are those of the old one, with a transition offset exactly where (23) fails.
fn check_hand_over<T: Scalar>(scenario: &Scenario, tick: &Tick<T>) -> Result<(), TestCaseError> {
    let p = &scenario.params;
    let old = tick.unswitched.expect("a copy went on tracking");
    let old_tick = Tick {
        report: old,
        ..*tick
    };
    let small = rounding::<T>(
        p,
        scenario,
        old_tick.command().amax() + tick.tau().amax() / p.inertia,
    );
    let step = &tick.wrench_step.expect("this tick hands over");
    let reported = Vector2::new(step.force.to_f64(), step.moment.to_f64());
    let found = tick.tau() - old_tick.tau();
    prop_assert!(reported.amax() <= small, "{reported} above {small:e}");
    prop_assert!(found.amax() <= small, "{found} above {small:e}");
    prop_assert!((tick.command() - old_tick.command()).amax() <= small);

    let desired = old_tick.command();
    let ahead = fits(p, desired.x / p.k4);
    let largest = if desired.y > 0.0 { p.b } else { p.d }.min(FRAC_PI_2).sin();
    let margin = p.k5 * largest - desired.y.abs();
    let turn = (margin.abs() > NEAR_BOUND * p.k5).then_some(margin > 0.0);
    if let (Some(ahead), Some(turn)) = (ahead, turn) {
        prop_assert_eq!(
            tick.report.has_transition_offset(T::ZERO),
            !(ahead && turn),
            "{} {}",
            ahead,
            turn
        );
    }
    Ok(())
}

/// Largest change of torque that a tick of `dt` can make, by the laws and by what the two ticks measured.
///
/// A neuron moves at most share · (B + D) with share ≤ dt (A + |u|), a transition offset at most dt A |b|, e_θ at most
/// dt (|w_r| + |w|), v and w by dt M̄⁻¹ τ. Eq. (15), Eq. (20) turn that into a change of the command, Eq. (16) and
/// Eq. (21) into one of the torque.
fn allowed<T: Scalar>(
    scenario: &Scenario,
    before: &Tick<T>,
    now: &Tick<T>,
    dt: f64,
) -> Vector2<f64> {
    let p = &scenario.params;
    // The torque of a hand-over is that of tracking.
    let now = Tick {
        report: now.unswitched.unwrap_or(now.report),
        ..*now
    };
    let range = p.b + p.d;
    let larger = |a: f64, b: f64| a.abs().max(b.abs());
    let (e, e_before) = (now.error(), before.error());
    let neuron = |u: f64| dt * (p.a + u) * range;
    let s1 = neuron(larger(e.x, e_before.x));
    let transition_offset = Vector2::new(
        before.report.transition_offset.linear,
        before.report.transition_offset.angular,
    )
    .map(|b| dt * p.a * b.to_f64().abs());
    let reference = &scenario.reference;
    let (v_r, w_r) = (
        reference.v0.abs() + reference.v1.abs(),
        reference.w0.abs() + reference.w1.abs(),
    );
    let (v_r_change, w_r_change) = (
        dt * (reference.v1 * reference.omega_v).abs(),
        dt * (reference.w1 * reference.omega_w).abs(),
    );
    let turned = dt * (w_r + larger(now.body.twist.y, before.body.twist.y));
    let tracking = now.report.phase == controller_core::paper::report::Phase::Tracking;
    let (command, gain) = if tracking {
        let s2 = neuron(larger(e.y, e_before.y));
        (
            Vector2::new(
                p.k1 * s1 + v_r_change + v_r * turned,
                w_r_change + p.k2 * (v_r_change * p.b.max(p.d) + v_r * s2) + p.k3 * turned,
            ),
            p.tracking_gain(),
        )
    } else {
        (Vector2::new(p.k4 * s1, p.k5 * neuron(PI)), p.parking_gain())
    };
    let body = (now.body.twist - before.body.twist).abs();
    let drive = now.command_rate().abs().sup(&before.command_rate().abs());
    let accel = Vector2::new(
        before.report.neurons.accel.linear,
        before.report.neurons.accel.angular,
    )
    .map(|a| a.to_f64().abs() + p.b.max(p.d));
    let accel_change = dt * drive.map(|u| p.a + u).component_mul(&accel);
    gain * (body + command + transition_offset) + p.mass_matrix() * accel_change
}

/// The first tick whose torque changes by more than the laws allow, if any.
fn jump<T: Scalar>(scenario: &Scenario, ticks: &[Tick<T>], dt: f64) -> Option<String> {
    let p = &scenario.params;
    ticks.windows(2).find_map(|pair| {
        let [before, now] = pair else { return None };
        let change = (now.tau() - before.tau()).abs();
        let extra = before.command().amax() + before.tau().amax() / p.inertia.min(p.m);
        let allowed =
            allowed(scenario, before, now, dt).add_scalar(rounding::<T>(p, scenario, extra));
        let fits = change.x <= allowed.x && change.y <= allowed.y;
        (!fits).then(|| format!("{change} above {allowed} at {} s", now.t))
    })
}

/// Drawn runs: start, hand-over and every tick between and after. Both kinds of either must have been met.
fn check<T: Scalar, M: Maths<T> + PartialEq, U: NeuronUpdate<T> + PartialEq>()
where
    Libm: Maths<T>,
{
    let (starts, hand_overs) = (Cell::new(0), Cell::new(0));
    TestRunner::new(cases(CASES))
        .run(&(scenario(), 1e-3..20e-3_f64), |(scenario, dt)| {
            let ticks = run::<T, NeuralController<T, M, U>>(&scenario, dt);
            let switched = &ticks[hand_over(&ticks)];
            check_start(&scenario, &ticks[0])?;
            check_hand_over(&scenario, switched)?;
            starts.set(starts.get() + u32::from(ticks[0].report.has_transition_offset(T::ZERO)));
            hand_overs
                .set(hand_overs.get() + u32::from(switched.report.has_transition_offset(T::ZERO)));
            let jump = jump(&scenario, &ticks, dt);
            prop_assert!(jump.is_none(), "{jump:?}");
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    for (what, with_offset) in [("starts", starts.get()), ("hand-overs", hand_overs.get())] {
        println!("{with_offset} of {CASES} {what} with a transition offset");
        assert!(
            (CASES / 10..CASES * 9 / 10).contains(&with_offset),
            "{what}: {with_offset}"
        );
    }
}

/// Starts, hand-overs and ticks are continuous in double precision, by every neuron update.
#[test]
fn torque_and_command_never_jump_in_double_precision() {
    check::<f64, Libm, ExactMean>();
    check::<f64, Libm, ExactHeld>();
    check::<f64, Libm, RationalMean>();
}

/// Starts, hand-overs and ticks are continuous in single precision, by both accurate back ends.
#[test]
fn torque_and_command_never_jump_in_single_precision() {
    check::<f32, Libm, ExactMean>();
    check::<f32, Single, RationalMean>();
}

/// The bound on a tick tells: the hand-over of Eq. (13) and Eq. (14) breaks it nearly always.
#[test]
fn plain_backstepping_breaks_the_bound_of_a_tick() {
    let jumps = Cell::new(0);
    TestRunner::new(cases(CASES))
        .run(&scenario(), |scenario| {
            let ticks = run::<f64, PlainController<f64, Libm>>(&scenario, 1e-3);
            jumps.set(jumps.get() + u32::from(jump(&scenario, &ticks, 1e-3).is_some()));
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    println!("{} of {CASES} plain runs jump", jumps.get());
    assert!(jumps.get() > CASES * 9 / 10, "{}", jumps.get());
}
