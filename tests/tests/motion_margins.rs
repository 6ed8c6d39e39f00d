//! Margins of the velocity loop with its disturbance estimate, as a PI loop with what a real base adds.

use controller_core::motion::{MotionGains, ValidMotionParams};
use nalgebra::Complex;
use tests::motion_base::Base;

/// Delay of pose and speed, and half a tick of held torque \[s\].
const DELAY_S: f64 = 0.020 + 0.005;
/// Bandwidth \[rad/s\] and damping of the speed estimate.
const ESTIMATE: (f64, f64) = (50.0, 0.7);

/// L(jω) = r ((κ + ω_d) s + κ ω_d)/s² · H(s) e^(−τ s), r = m believed over m true.
fn open_loop(loop_rate: f64, disturbance: f64, ratio: f64, omega: f64) -> Complex<f64> {
    let s = Complex::new(0.0, omega);
    let (bandwidth, damping) = ESTIMATE;
    let estimate =
        bandwidth.powi(2) / (s * s + s * (2.0 * damping * bandwidth) + bandwidth.powi(2));
    let controller = (s * (loop_rate + disturbance) + loop_rate * disturbance) / (s * s);
    controller * ratio * estimate * (-s * DELAY_S).exp()
}

/// Gain margin, phase margin \[°\] and crossover \[rad/s\], from a fine sweep.
fn margins(loop_rate: f64, disturbance: f64, ratio: f64) -> (f64, f64, f64) {
    let (mut gain, mut phase, mut crossover) = (f64::INFINITY, f64::INFINITY, 0.0);
    let mut last: Option<Complex<f64>> = None;
    for k in 0..60_000 {
        // 0.1 to 400 rad/s by factors: neighbours differ by 0.014 %.
        let omega = 0.1 * (f64::from(k) * 1.382_8e-4).exp();
        let now = open_loop(loop_rate, disturbance, ratio, omega);
        if let Some(last) = last {
            if last.norm() >= 1.0 && now.norm() < 1.0 {
                let lag = now.arg().to_degrees();
                let margin = if lag > 0.0 { lag - 180.0 } else { lag + 180.0 };
                if margin.abs() < phase {
                    (phase, crossover) = (margin, omega);
                }
            }
            // Crosses the negative real axis from below on its way to −540°, which counts from 1 on.
            if last.im <= 0.0 && now.im > 0.0 && now.re < 0.0 {
                gain = gain.min(1.0 / now.norm());
            }
        }
        last = Some(now);
    }
    (gain, phase, crossover)
}

/// Half to twice the mass and inertia: at least 30°, and a factor 2 of gain within ±30 %, 1.5 beyond.
#[test]
fn default_bandwidth_leaves_margins() {
    let motion: ValidMotionParams<f64> = Base::STANDARD.exact().validate().expect("valid");
    let gains: &MotionGains<f64> = motion.gains();
    for (name, loop_rate) in [("speed", gains.speed_loop), ("turn rate", gains.turn_loop)] {
        for ratio in [0.5, 1.0 / 1.3, 1.0, 1.0 / 0.7, 2.0] {
            let (gain, phase, crossover) = margins(loop_rate, gains.disturbance, ratio);
            println!(
                "{name}, r {ratio:.2}: crossover {crossover:.1} rad/s, {phase:.0}°, gain margin {gain:.2}"
            );
            // Usual demands for a servo loop.
            assert!(phase > 30.0, "{name} {ratio}: {phase}");
            let least = if (0.7..1.5).contains(&ratio) {
                2.0
            } else {
                1.5
            };
            assert!(gain > least, "{name} {ratio}: {gain}");
        }
    }
}

/// Without delay the loop is stable for any ratio: s² + r (κ + ω) s + r κ ω, damped by at least √r.
#[test]
fn ideal_loop_is_damped_by_the_root_of_the_ratio() {
    for loop_rate in [0.1, 3.0, 5.0, 100.0] {
        for disturbance in [0.1, 2.5, 50.0] {
            for ratio in [0.25_f64, 0.5, 1.0, 2.0] {
                let natural = (ratio * loop_rate * disturbance).sqrt();
                let damping = ratio * (loop_rate + disturbance) / (2.0 * natural);
                assert!(damping >= ratio.sqrt() - 1e-12);
            }
        }
    }
}
