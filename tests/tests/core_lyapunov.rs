//! The core's monitor of Eq. (24) to Eq. (27) against the oracle, and what it says along the paper's runs.

use controller_core::maths::Libm;
use controller_core::paper::lyapunov::{
    dissipates, forgetting_rate, ideal_pose_energy_rate, neuron_energy, neuron_energy_rate,
    passive_storage, pose_energy, velocity_energy,
};
use controller_core::paper::neural_law::NeuralState;
use controller_core::paper::params::Params as CoreParams;
use controller_core::pose_error::PoseError;
use controller_core::shunting::NeuronParams;
use controller_core::shunting::Shunting;
use controller_core::types::{Accel, Twist};
use nalgebra::{Vector2, Vector3};
use tests::check::{assert_close, assert_within};
use tests::core_loop::{Exact, hand_over, run};
use tests::core_params::core_params;
use tests::oracle::laws;
use tests::oracle::{Params, Reset, Scenario, lyapunov, neuron, posture};
use tests::random::Random;
use tests::tolerance::{ALGEBRA, SAMPLED_PEAK};

/// Seed of every random state below.
const SEED: u64 = 0x5EED_0003;
/// Random states per statement.
const STATES: usize = 20_000;

fn core() -> (Params, CoreParams<f64>) {
    let p = Params::recommended();
    (p, core_params(&p, Reset::Corrected))
}

fn core_error(e: &Vector3<f64>) -> PoseError<f64> {
    PoseError {
        x: e.x,
        y: e.y,
        theta: e.z,
    }
}

/// V₁, V₂ and V_s under Eq. (24), corrected, are the oracle's.
#[test]
fn energies_are_the_oracles() {
    let (p, core) = core();
    let mut random = Random(SEED);
    for _ in 0..STATES {
        let e = random.error();
        let delta = Vector2::new(random.within(2.0), random.within(2.0));
        let s = Vector3::new(random.within(4.0), random.within(4.0), 0.0);
        let accel = Vector2::new(random.within(4.0), random.within(4.0));
        let state = NeuralState {
            s1: s.x,
            s_turn: s.y,
            accel: Accel::new(accel.x, accel.y),
            transition_offset: Twist::new(1.0, 1.0),
        };
        let pose = pose_energy::<f64, Libm>(&core.tracking, &core_error(&e));
        let velocity = velocity_energy(&core.robot, &Twist::new(delta.x, delta.y));
        assert_close(pose, lyapunov::v1(&p, &e), ALGEBRA, "V1");
        assert_close(velocity, lyapunov::v2(&p, &delta), ALGEBRA, "V2");
        assert_close(
            neuron_energy(&state),
            lyapunov::v_s(&s, &accel),
            ALGEBRA,
            "Vs",
        );
    }
    // The printed V₁ vanishes there.
    let apart = PoseError {
        x: 1.0,
        y: -1.0,
        theta: 0.0,
    };
    assert_eq!(pose_energy::<f64, Libm>(&core.tracking, &apart), 1.0);
}

/// V̇₁ under Eq. (24) is what Eq. (9) and Eq. (10) make it when the robot obeys.
#[test]
fn ideal_rate_is_that_of_an_obeying_robot() {
    let (p, core) = core();
    let mut random = Random(SEED);
    for _ in 0..STATES {
        let (e, target) = (random.error(), random.target());
        let ideal = laws::plain_tracking(&p, &target, &e, &Vector3::zeros()).velocity;
        let e_rate = posture::error_rate(&e, &ideal, &target.twist);
        let found = ideal_pose_energy_rate::<f64, Libm>(&core.tracking, &core_error(&e));
        assert!(found <= 0.0, "seed {SEED:#x}");
        assert_close(found, lyapunov::v1_rate(&p, &e, &e_rate), ALGEBRA, "V1'");
    }
}

/// Eq. (25) with the terms it drops; Eq. (26) and Eq. (27): A + |u| > 0; and what is true instead: passivity.
#[test]
fn neuron_powers_are_the_oracles_and_the_neuron_is_passive() {
    let (p, _) = core();
    let params = NeuronParams {
        a: p.a,
        b: p.b,
        d: p.d,
    };
    let core = Shunting::new(&params).expect("in range");
    let mut random = Random(SEED);
    let mut growing = 0;
    for _ in 0..STATES {
        let (s, u) = (random.within(p.b), random.within(20.0));
        let power = neuron_energy_rate(&core, s, u);
        let expected =
            lyapunov::neuron_power_printed(&p, s, u) + lyapunov::neuron_power_dropped(&p, s, u);
        assert_close(power, expected, ALGEBRA, "s ds/dt");
        growing += usize::from(power > 0.0);
        let forgetting = p.a + neuron::s_plus(u) + neuron::s_minus(u);
        assert_eq!(forgetting_rate(&core, u), forgetting);
        assert!(forgetting > 0.0);
        let passive = s * u - forgetting * s * s / p.b;
        assert_close(power / p.b, passive, ALGEBRA, "W' of W = s²/(2B)");
        assert_close(passive_storage(&core, s), s * s / (2.0 * p.b), ALGEBRA, "W");
    }
    assert!(growing > STATES / 4, "V_s alone proves nothing: {growing}");
}

/// V of Eq. (24) rises along the paper's runs, as the core's own documentation says.
#[test]
fn corrected_function_rises_along_both_cases() {
    let (_, core) = core();
    for (name, scenario, peak, without_neurons) in [
        ("line", Scenario::paper_line(), 1.19, 0.69),
        ("curve", Scenario::paper_curve(), 3.69, 2.02),
    ] {
        let ticks = run::<f64, Exact>(&scenario, 1e-3);
        let values = ticks[..hand_over(&ticks)].iter().map(|tick| {
            let report = &tick.report;
            let state = NeuralState {
                s1: report.neurons.s1,
                s_turn: report.neurons.s2,
                accel: report.neurons.accel,
                transition_offset: report.transition_offset,
            };
            let body = pose_energy::<f64, Libm>(&core.tracking, &report.error)
                + velocity_energy(&core.robot, &report.velocity_error);
            (body + neuron_energy(&state), body)
        });
        let (all, body) = values.fold((0.0, 0.0), |(all, body), (v, b)| {
            (f64::max(all, v), f64::max(body, b))
        });
        println!("{name}: V peaks at {all:.3}, without neurons at {body:.3}");
        assert_within(all, peak, SAMPLED_PEAK, name);
        assert_within(body, without_neurons, SAMPLED_PEAK, name);
    }
}

/// The condition that makes V₁ + V₂ of Eq. (24) fall under Eq. (10) to Eq. (12), on both sides of a quarter.
#[test]
fn dissipation_needs_gain_products_of_a_quarter() {
    let (_, core) = core();
    let mut gains = core.tracking;
    assert!(dissipates(&gains));
    (gains.k1, gains.k_d1) = (0.5, 0.5);
    (gains.k2, gains.k3, gains.k_d2) = (0.5, 0.5, 1.0);
    assert!(dissipates(&gains), "a quarter will do");
    for spoil in [
        |g: &mut controller_core::paper::params::TrackingGains<f64>| g.k_d1 = 0.499,
        |g: &mut controller_core::paper::params::TrackingGains<f64>| g.k_d2 = 0.999,
    ] {
        let mut spoiled = gains;
        spoil(&mut spoiled);
        assert!(!dissipates(&spoiled));
    }
}
