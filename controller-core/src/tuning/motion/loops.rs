//! The loops of the law for a real base, linearised about a straight reference, with μ the true over
//! the believed mass or inertia. A neuron whose rate is fed forward exactly is a lag of 1/A, and a
//! velocity loop with the right mass then adds none: v = (λ + κ)/(μλ + κ) v_c.

use crate::motion::{BEARING, COUPLING};
use crate::scalar::Scalar;
use crate::stability::{Feedback, Polynomial};

/// λ + r.
fn lag<T: Scalar>(r: T) -> Polynomial<T> {
    Polynomial::new([r, T::ONE])
}

fn integrator<T: Scalar>() -> Polynomial<T> {
    lag(T::ZERO)
}

/// A loop with the disturbance estimate of bandwidth ω, which knows the torque demanded and not when
/// it comes: ḋ = ω (λv − u − d) and u = x − d give u = (λ + ω)/λ x − ω v, and so
///
/// ```text
/// μ λ M + (λ + ω) R + ω M  +  (λ + ω) P          for μ M + R + P without it
/// ```
///
/// For μ = 1 the root −ω is added, and nothing else changes.
pub(super) fn estimating<T: Scalar>(of: Feedback<T>, omega: T) -> Feedback<T> {
    if omega <= T::ZERO {
        return of;
    }
    let forget = lag(omega);
    Feedback {
        rest: of.rest.times(&forget).plus(&of.mass.scaled(omega)),
        mass: of.mass.times(&integrator()),
        pose: of.pose.times(&forget),
    }
}

/// e_x through s₁, distance and heading of the goal through theirs: k = k₁ or k₄.
///
/// ```text
/// λ (λ + A) (μλ + κ)  +  k A (λ + κ)            for μ = 1: (λ + κ)(λ² + Aλ + kA)
/// ```
pub(super) fn longitudinal<T: Scalar>(gain: T, a: T, bandwidth: T) -> Feedback<T> {
    let neuron = integrator().times(&lag(a));
    Feedback {
        mass: neuron.times(&integrator()),
        rest: neuron.scaled(bandwidth),
        pose: lag(bandwidth).scaled(gain * a),
    }
}

/// e_y and e_θ: ė_y = v_r e_θ, ė_θ = −w, s₂ of g e_y with k₃ g v_r = c, and
/// μ ẇ = α_d − κ (w − w_d), w_d = k₃ (s₂ + e_θ), α_d = k₃ (ṡ₂ − w) with w as measured.
///
/// ```text
/// λ² (λ + A) (μλ + k₃ + κ)  +  A c (λ + κ) + κ k₃ λ (λ + A)
///                           for μ = 1: (λ + κ)(λ³ + (A + k₃) λ² + A k₃ λ + A c)
/// ```
///
/// The last two terms see the measured pose. c is exact well above the speed v_f, less below.
pub(super) fn lateral<T: Scalar>(heading: T, stiffness: T, a: T, bandwidth: T) -> Feedback<T> {
    let turn = integrator().times(&integrator()).times(&lag(a));
    let aside = lag(bandwidth).scaled(a * stiffness);
    let straight = integrator().times(&lag(a)).scaled(bandwidth * heading);
    Feedback {
        mass: turn.times(&integrator()),
        rest: turn.scaled(heading + bandwidth),
        pose: aside.plus(&straight),
    }
}

/// Bearing α and β = α − e_θ of the goal while the distance decays with K = k₄:
/// α̇ = −w + Kα, β̇ = Kα, w through its neuron of K ((k_a + 1 + h) α + k_a h β).
///
/// ```text
/// λ (λ − K) (λ + A) (μλ + κ)  +  A K (λ + κ) ((k_a + 1 + h) λ + k_a h K)
/// ```
///
/// Stable for K < 0.75 A.
pub(super) fn bearing<T: Scalar>(approach: T, a: T, bandwidth: T) -> Feedback<T> {
    let (ka, h) = (T::from_f64(BEARING), T::from_f64(COUPLING));
    let view = integrator().times(&lag(-approach)).times(&lag(a));
    let law = Polynomial::new([ka * h * approach, ka + T::ONE + h]);
    Feedback {
        mass: view.times(&integrator()),
        rest: view.scaled(bandwidth),
        pose: lag(bandwidth).times(&law).scaled(a * approach),
    }
}

/// [`lateral`] for the right inertia from an offset at rest, with the transition offset that starts it smoothly,
/// (λ + A)², and the push that its highest derivative starts with.
pub(super) fn lateral_start<T: Scalar>(heading: T, stiffness: T, a: T) -> (Polynomial<T>, T) {
    let transition_offset = lag(a).times(&lag(a));
    let pair = Polynomial::new([a * stiffness, a * heading, a + heading, T::ONE]);
    (transition_offset.times(&pair), stiffness * a * a)
}

/// The same for [`longitudinal`], whose neuron may be slower than the offset: ë = −(ṡ + ḃ) starts at 0 and its rate with −k₁ A (2 A_b − A), A_b
/// the `offset`'s decay.
pub(super) fn longitudinal_start<T: Scalar>(gain: T, a: T, offset: T) -> (Polynomial<T>, T) {
    let transition_offset = lag(offset).times(&lag(offset));
    let pair = Polynomial::new([gain * a, a, T::ONE]);
    (
        transition_offset.times(&pair),
        gain * a * (offset + offset - a),
    )
}
