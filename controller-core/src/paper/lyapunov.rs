//! The paper's Lyapunov terms, corrected, as a monitor. Eqs. (24)-(27).
//!
//! Not a proof: V of (24) rises along both of the paper's own cases (0.77 → 1.15 and 0.60 → 3.61).
//! What does hold is stated at each function and derived in `docs/derivation.md`.

use crate::maths::Maths;
use crate::paper::neural_law::NeuralState;
use crate::paper::params::TrackingGains;
use crate::pose_error::PoseError;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::shunting::Shunting;
use crate::types::Twist;

/// V₁ = (e_x² + e_y²)/2 + (1 − cos e_θ)/k₂. Eq. (24), corrected.
///
/// Printed as (e_x + e_y)²/2, which is zero along e_x = −e_y and so not definite.
pub fn pose_energy<T: Scalar, M: Maths<T>>(gains: &TrackingGains<T>, error: &PoseError<T>) -> T {
    let (_, cosine) = M::sin_cos(error.theta);
    T::HALF * (error.x * error.x + error.y * error.y) + (T::ONE - cosine) / gains.k2
}

/// dV₁/dt if the robot moved exactly as Eq. (10) commands: −k₁ e_x² − (k₃/k₂) sin² e_θ ≤ 0.
///
/// With velocity errors δ it also has −e_x δ_v − sin(e_θ) δ_w/k₂; see [`dissipates`].
pub fn ideal_pose_energy_rate<T: Scalar, M: Maths<T>>(
    gains: &TrackingGains<T>,
    error: &PoseError<T>,
) -> T {
    let (sine, _) = M::sin_cos(error.theta);
    -(gains.k1 * error.x * error.x) - gains.k3 / gains.k2 * sine * sine
}

/// V₂ = δᵀ M̄ δ/2. Eq. (24).
pub fn velocity_energy<T: Scalar>(robot: &Robot<T>, error: &Twist<T>) -> T {
    let linear = robot.mass_kg * error.linear * error.linear;
    let angular = robot.inertia_kg_m2 * error.angular * error.angular;
    T::HALF * (linear + angular)
}

/// V₁ + V₂ cannot rise under plain backstepping, Eqs. (10)-(12): k₁ k_d1 ≥ 1/4 and k₂ k₃ k_d2 ≥ 1/4.
///
/// The paper leaves out the cross terms and claims it for all gains. With k₁ = 0.5, k_d1 = 0.1,
/// e_x = 1, δ_v = −1 the sum rises at 0.4 per second.
pub fn dissipates<T: Scalar>(gains: &TrackingGains<T>) -> bool {
    let quarter = T::from_f64(0.25);
    gains.k1 * gains.k_d1 >= quarter && gains.k2 * gains.k3 * gains.k_d2 >= quarter
}

/// V_s = (s₁² + s₂² + s₃²)/2 + (v̇_s² + ẇ_s²)/2. Eq. (24).
pub fn neuron_energy<T: Scalar>(state: &NeuralState<T>) -> T {
    let NeuralState {
        s1, s_turn, accel, ..
    } = state;
    let pose = *s1 * *s1 + *s_turn * *s_turn;
    T::HALF * (pose + accel.linear * accel.linear + accel.angular * accel.angular)
}

/// d(s²/2)/dt of one neuron. Eq. (25), with the terms that the paper drops.
///
/// s ṡ = −(A + |u|) s² + s (B S⁺ − D S⁻): positive for 0 < s < B u/(A + u), so V_s alone proves
/// nothing. See [`passive_storage`] for what is true.
pub fn neuron_energy_rate<T: Scalar>(neuron: &Shunting<T>, state: T, input: T) -> T {
    state * neuron.rate(state, input)
}

/// The rate at which a neuron forgets: A + S⁺ + S⁻ = A + |u| > 0. Eq. (26) for u ≥ 0 (A + u),
/// Eq. (27) for u < 0 (A − u).
pub fn forgetting_rate<T: Scalar>(neuron: &Shunting<T>, input: T) -> T {
    neuron.decay() + input.abs()
}

/// W = s²/(2B), the storage with which a neuron with B = D is strictly passive from input to state.
///
/// Ẇ = s u − (A + |u|) s²/B. This is what replaces the argument of (25): what a neuron gives back
/// it was given before.
pub fn passive_storage<T: Scalar>(neuron: &Shunting<T>, state: T) -> T {
    T::HALF * state * state / neuron.upper()
}
