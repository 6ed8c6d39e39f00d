//! The loops of the paper's laws, linearised about a straight reference at constant speed.

use crate::scalar::Scalar;
use crate::stability::{Feedback, Polynomial};

/// λ + r.
fn lag<T: Scalar>(r: T) -> Polynomial<T> {
    Polynomial::new([r, T::ONE])
}

/// The loop e_x → s₁ → v_c → v of Eqs. (15)-(17), with pose gain `gain`, bandwidth κ of its velocity
/// loop, and μ the true over the believed mass:
///
/// ```text
/// λ (λ + A)² (μλ + κ)  +  k B ((κ + B) λ + κ A)
/// ```
///
/// With k = k₁, κ = k_d1/m for tracking; k₄, k_c1/m and k₅, k_c2/I for parking, Eqs. (20)-(22).
pub(crate) fn longitudinal<T: Scalar>(gain: T, bandwidth: T, a: T, b: T) -> Feedback<T> {
    let neurons = lag(a).times(&lag(a)).times(&lag(T::ZERO));
    Feedback {
        mass: neurons.times(&lag(T::ZERO)),
        rest: neurons.scaled(bandwidth),
        pose: Polynomial::new([bandwidth * a, bandwidth + b]).scaled(gain * b),
    }
}

/// What the loop across the path depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PathLoop<T> {
    /// k₂ v_r² \[1/s²\].
    pub(crate) lateral: T,
    /// k₃ \[1/s\].
    pub(crate) heading: T,
    /// κ = k_d2/I \[1/s\].
    pub(crate) bandwidth: T,
    pub(crate) a: T,
    pub(crate) b: T,
}

/// The loop (e_y, e_θ, s₂, w, ẇ_s) of Eqs. (15)-(17), with μ the true over the believed inertia:
///
/// ```text
/// λ² (λ + A) ((μλ + κ)(λ + A) + B k₃)  +  k₂ v_r² B ((κ + B) λ + κ A)  +  κ k₃ λ (λ + A)²
/// ```
///
/// The last two terms see the measured pose; B k₃ comes from ẇ_c, which uses the measured turn rate.
pub(crate) fn lateral<T: Scalar>(path: &PathLoop<T>) -> Feedback<T> {
    let PathLoop { a, b, .. } = *path;
    let k = path.bandwidth;
    let turn = lag(T::ZERO).times(&lag(T::ZERO)).times(&lag(a));
    let rest = lag(a).scaled(k).plus(&Polynomial::new([b * path.heading]));
    let aside = Polynomial::new([k * a, k + b]).scaled(path.lateral * b);
    let heading = lag(T::ZERO).times(&lag(a)).times(&lag(a));
    Feedback {
        mass: turn.times(&lag(a)).times(&lag(T::ZERO)),
        rest: turn.times(&rest),
        pose: aside.plus(&heading.scaled(k * path.heading)),
    }
}
