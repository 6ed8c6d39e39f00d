//! References: modulated ones against closed forms and an independent integrator. Eq. (6).

use controller_core::reference::ConstantTwist;
use controller_core::types::{Pose, Twist};
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use sim_host::motion::{Profile, ReferenceMotion};

fn constant(mean: f64) -> Profile {
    Profile {
        mean,
        ..Profile::default()
    }
}

const START: Pose<f64> = Pose::new(0.5, -1.0, 0.7);

#[test]
fn without_amplitude_a_modulated_motion_is_the_closed_form() {
    let closed = ReferenceMotion::Constant(ConstantTwist {
        start: START,
        twist: Twist::new(0.4, 0.15),
    });
    let modulated = ReferenceMotion::Modulated {
        start: START,
        speed: constant(0.4),
        turn_rate: constant(0.15),
    };
    for t in [0.0, 0.001, 1.0, 10.0, 77.7] {
        let (a, b) = (closed.at(t), modulated.at(t));
        // Rounding of a few hundred panels.
        assert!((a.pose().x - b.pose().x).abs() < 1e-13, "{t}: {a:?} {b:?}");
        assert!((a.pose().y - b.pose().y).abs() < 1e-13, "{t}: {a:?} {b:?}");
        assert!((a.pose().theta - b.pose().theta).abs() < 1e-13);
        assert_eq!((a.twist(), a.accel()), (b.twist(), b.accel()));
    }
}

#[test]
fn a_slow_sine_is_integrated_without_cancellation() {
    for frequency in [0.0, 1e-12, 1e-6, 1e-3] {
        let profile = Profile {
            mean: 0.0,
            amplitude: 2.0,
            frequency,
            phase: 0.4,
        };
        // ∫ 2 sin(Ot + 0.4) over 3 s, by its series to O².
        let t = 3.0_f64;
        let (s, c) = 0.4_f64.sin_cos();
        let expected =
            2.0 * (s * t + c * frequency * t * t / 2.0 - s * frequency.powi(2) * t.powi(3) / 6.0);
        // The next term of the series is 2 c O³ t⁴/24.
        assert!((profile.integral(t) - expected).abs() < 1e-8, "{frequency}");
    }
}

#[test]
fn rates_are_the_derivatives_of_values() {
    let profile = Profile {
        mean: 0.3,
        amplitude: 0.2,
        frequency: 1.7,
        phase: -0.5,
    };
    let h = 1e-5;
    let slope = (profile.value(2.0 + h) - profile.value(2.0 - h)) / (2.0 * h);
    // A central difference is off by h²/6 of the third derivative, 1e-11 here, and by rounding.
    assert!((profile.rate(2.0) - slope).abs() < 1e-9);
    let slope = (profile.integral(2.0 + h) - profile.integral(2.0 - h)) / (2.0 * h);
    assert!((profile.value(2.0) - slope).abs() < 1e-9);
}

struct Oracle;

impl ODE<f64, [f64; 3]> for Oracle {
    fn diff(&self, t: f64, y: &[f64; 3], rate: &mut [f64; 3]) {
        let v = 0.3 + 0.5 * (1.3 * t + 0.2).sin();
        let w = -0.1 + 0.8 * (2.1 * t - 0.4).sin();
        *rate = [v * y[2].cos(), v * y[2].sin(), w];
    }
}

#[test]
fn an_adaptive_order_eight_solver_finds_the_same_reference() {
    let motion = ReferenceMotion::Modulated {
        start: START,
        speed: Profile {
            mean: 0.3,
            amplitude: 0.5,
            frequency: 1.3,
            phase: 0.2,
        },
        turn_rate: Profile {
            mean: -0.1,
            amplitude: 0.8,
            frequency: 2.1,
            phase: -0.4,
        },
    };
    let solution = IVP::ode(&Oracle, 0.0, 15.0, [START.x, START.y, START.theta])
        .method(ExplicitRungeKutta::dop853().rtol(1e-13).atol(1e-13))
        .solve()
        .expect("a smooth problem");
    let theirs = solution.y.last().expect("at least the end");
    let by_ticks = {
        let mut walker = motion.walk();
        (0..=15_000)
            .map(|tick| walker.advance_to(f64::from(tick) * 0.001))
            .last()
    };
    for ours in [motion.at(15.0), by_ticks.expect("ticks")] {
        // Their tolerance, times some hundred steps.
        assert!(
            (ours.pose().x - theirs[0]).abs() < 1e-11,
            "{ours:?} {theirs:?}"
        );
        assert!(
            (ours.pose().y - theirs[1]).abs() < 1e-11,
            "{ours:?} {theirs:?}"
        );
        assert!(
            (ours.pose().theta - theirs[2]).abs() < 1e-11,
            "{ours:?} {theirs:?}"
        );
    }
}
