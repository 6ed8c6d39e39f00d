//! What single precision and the mathematical back ends cost, over both of the paper's cases at 1 ms.

use controller_core::maths::{Libm, Maths, Micromath, Single};
use controller_core::paper::neural::NeuralController;
use controller_core::paper::plain::PlainController;
use controller_core::shunting::{ExactHeld, ExactMean, NeuronUpdate, RationalMean};
use tests::core_loop::{Controller, Tick, hand_over, run};
use tests::oracle::{OracleLaw, Scenario};
use tests::tolerance::{
    MICROMATH_HAND_OVER, MICROMATH_POSE, PARKED, SINGLE_HAND_OVER, SINGLE_POSE,
};

/// Control period \[s\].
const DT: f64 = 1e-3;

/// Largest differences of two runs: posture (m, rad), torque (N, N m).
fn differences(single: &[Tick<f32>], double: &[Tick<f64>]) -> (f64, f64) {
    assert_eq!(single.len(), double.len());
    single
        .iter()
        .zip(double)
        .fold((0.0, 0.0), |(q, tau), (a, b)| {
            (
                f64::max(q, (a.body.q - b.body.q).amax()),
                f64::max(tau, (a.tau() - b.tau()).amax()),
            )
        })
}

/// Both cases in single and in double precision; returns the largest posture difference.
fn compare<S: Controller<f32>, D: Controller<f64>>(name: &str) -> f64 {
    [Scenario::paper_line(), Scenario::paper_curve()]
        .into_iter()
        .map(|scenario| {
            let (single, double) = (run::<f32, S>(&scenario, DT), run::<f64, D>(&scenario, DT));
            let (posture, torque) = differences(&single, &double);
            println!("{name}: posture {posture:.2e} m or rad, torque {torque:.2e} N or N m");
            posture
        })
        .fold(0.0, f64::max)
}

fn compare_neural<M: Maths<f32> + PartialEq, U>(name: &str) -> f64
where
    U: NeuronUpdate<f32> + NeuronUpdate<f64> + PartialEq,
{
    compare::<NeuralController<f32, M, U>, NeuralController<f64, Libm, U>>(name)
}

/// Eq. (15) to Eq. (23) in single precision stay within 10 µm and 10 µrad of double precision.
#[test]
fn single_precision_follows_double_precision() {
    for difference in [
        compare_neural::<Libm, ExactMean>("libm, exact mean"),
        compare_neural::<Libm, ExactHeld>("libm, exact held"),
        compare_neural::<Libm, RationalMean>("libm, rational mean"),
        compare_neural::<Single, ExactMean>("single, exact mean"),
        compare_neural::<Single, ExactHeld>("single, exact held"),
        compare_neural::<Single, RationalMean>("single, rational mean"),
    ] {
        assert!(difference <= SINGLE_POSE, "{difference:e}");
    }
}

/// Eq. (10) to Eq. (14) in single precision likewise.
#[test]
fn single_precision_follows_double_precision_without_neurons() {
    for difference in [
        compare::<PlainController<f32, Libm>, PlainController<f64, Libm>>("plain, libm"),
        compare::<PlainController<f32, Single>, PlainController<f64, Libm>>("plain, single"),
    ] {
        assert!(difference <= SINGLE_POSE, "{difference:e}");
    }
}

/// micromath is rough, but rough within a stated bound, and it still parks.
#[test]
fn micromath_stays_within_half_a_centimetre() {
    let difference = compare_neural::<Micromath, ExactMean>("micromath, exact mean");
    assert!(difference <= MICROMATH_POSE, "{difference:e}");
    for scenario in [Scenario::paper_line(), Scenario::paper_curve()] {
        assert_eq!(scenario.law, OracleLaw::Neural);
        let ticks = run::<f32, NeuralController<f32, Micromath>>(&scenario, DT);
        let goal = scenario.switch.expect("a paper run parks").target;
        let last = ticks.last().expect("a run has ticks");
        let distance = (last.body.q - goal).xy().norm();
        println!(
            "micromath: {:.3} mm from the target at the end",
            1e3 * distance
        );
        assert!(distance <= PARKED + MICROMATH_POSE, "{distance}");
    }
}

/// Largest torque step at the hand-over of both cases, reported and against a copy that went on tracking.
fn hand_over_step<C: Controller<f32>>(name: &str) -> f64 {
    [Scenario::paper_line(), Scenario::paper_curve()]
        .into_iter()
        .flat_map(|scenario| {
            let ticks = run::<f32, C>(&scenario, DT);
            let tick = &ticks[hand_over(&ticks)];
            let old = tick.unswitched.expect("a copy went on tracking").wrench;
            let (new, step) = (
                tick.report.wrench,
                tick.wrench_step.expect("this tick hands over"),
            );
            println!(
                "{name}: hand-over step {:.1e} N, {:.1e} N m",
                step.force, step.moment
            );
            [
                step.force,
                step.moment,
                new.force - old.force,
                new.moment - old.moment,
            ]
        })
        .map(|step| f64::from(step.abs()))
        .fold(0.0, f64::max)
}

/// Eq. (23) in single precision: the torque step is rounding, and with micromath its sine's error.
#[test]
fn hand_over_step_is_rounding_in_single_precision() {
    let libm = hand_over_step::<NeuralController<f32, Libm>>("libm");
    let single = hand_over_step::<NeuralController<f32, Single>>("single");
    let micromath = hand_over_step::<NeuralController<f32, Micromath>>("micromath");
    assert!(libm <= SINGLE_HAND_OVER, "libm: {libm:e}");
    assert!(single <= SINGLE_HAND_OVER, "single: {single:e}");
    assert!(micromath <= MICROMATH_HAND_OVER, "micromath: {micromath:e}");
}
