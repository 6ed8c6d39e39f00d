//! Are these gains hopeless? Local stability of the closed loop, before the robot finds out.
//!
//! Linearised about the reference, for constant v_r on a straight line, the loop splits in two
//! (derivation in `docs/derivation.md`). κ is the bandwidth of the velocity loop, k_d1/m or k_d2/I.
//! Near zero a neuron has gain B/A for positive inputs and D/A for negative ones; where they differ
//! both are checked, which is necessary but for the switching between them not sufficient.

mod loops;

pub(crate) use loops::{PathLoop, lateral, longitudinal};

use crate::maths::Maths;
use crate::paper::params::Params;
use crate::scalar::Scalar;
use crate::shunting::NeuronParams;

fn for_both_bounds<T: Scalar>(neurons: &NeuronParams<T>, check: impl Fn(T) -> bool) -> bool {
    check(neurons.b) && check(neurons.d)
}

/// Tracking is stable along the path (k₁, k_d1).
pub fn longitudinal_tracking_is_stable<T: Scalar>(params: &Params<T>) -> bool {
    let bandwidth = params.tracking.k_d1 / params.robot.mass_kg;
    for_both_bounds(&params.neurons, |b| {
        longitudinal(params.tracking.k1, bandwidth, params.neurons.a, b).is_stable()
    })
}

/// The paper's parking is stable, in distance (k₄, k_c1) and in heading (k₅, k_c2).
pub fn parking_is_stable<T: Scalar>(params: &Params<T>) -> bool {
    let gains = &params.parking;
    let distance = gains.k_c1 / params.robot.mass_kg;
    let heading = gains.k_c2 / params.robot.inertia_kg_m2;
    let a = params.neurons.a;
    for_both_bounds(&params.neurons, |b| {
        longitudinal(gains.k4, distance, a, b).is_stable()
            && longitudinal(gains.k5, heading, a, b).is_stable()
    })
}

/// Reference speed \[m/s\] above which the robot weaves about a straight line with growing
/// amplitude. `None` only if gains are so extreme that a product overflows or drowns in rounding:
/// for positive gains the loop is always stable at low speed.
///
/// The lateral loop (e_y, e_θ, s₂, w, ẇ_s), with x = v_r²,
///
/// ```text
/// λ⁵ + (2A+κ) λ⁴ + (A²+2Aκ+k₃(κ+B)) λ³ + (A²κ + k₃A(B+2κ)) λ²
///    + (A²k₃κ + k₂ x B (B+κ)) λ + k₂ x A B κ
/// ```
///
/// loses stability where its fourth Hurwitz determinant, a quadratic in x, crosses zero: one pair
/// of roots, so the limit comes in closed form. The default gains give 1.215 m/s.
pub fn max_stable_speed<T: Scalar, M: Maths<T>>(params: &Params<T>) -> Option<T> {
    let upper = lateral_limit::<T, M>(params, params.neurons.b)?;
    let lower = lateral_limit::<T, M>(params, params.neurons.d)?;
    Some(if lower < upper { lower } else { upper })
}

fn lateral_limit<T: Scalar, M: Maths<T>>(params: &Params<T>, b: T) -> Option<T> {
    let gains = &params.tracking;
    let a = params.neurons.a;
    let k = gains.k_d2 / params.robot.inertia_kg_m2;
    let two = T::ONE + T::ONE;
    let c4 = two * a + k;
    let c3 = a * a + two * a * k + gains.k3 * (k + b);
    let c2 = a * a * k + gains.k3 * a * (b + two * k);
    // c1 = p + q x and c0 = r x.
    let p = a * a * gains.k3 * k;
    let q = gains.k2 * b * (b + k);
    let r = gains.k2 * a * b * k;
    let second = c4 * c3 - c2;
    // Fourth determinant: second (c2 c1 − c3 c0) − (c4 c1 − c0)², as d0 + d1 x − d2 x².
    let s = c4 * q - r;
    let d0 = second * c2 * p - (c4 * p) * (c4 * p);
    let d1 = second * (c2 * q - c3 * r) - two * c4 * p * s;
    let d2 = s * s;
    if second > T::ZERO && d0 > T::ZERO {
        let root = M::sqrt(d1 * d1 + two * two * d2 * d0);
        Some(M::sqrt((d1 + root) / (two * d2)))
    } else {
        None
    }
}

/// Reference speed \[m/s\] up to which lateral convergence is proven for every start but a heading
/// error of exactly π, given an ideal velocity loop and B = D: k₂ B v_r² ≤ A² k₃.
pub fn max_proven_speed<T: Scalar, M: Maths<T>>(params: &Params<T>) -> T {
    let NeuronParams { a, b, d } = params.neurons;
    let bound = if b > d { b } else { d };
    a * M::sqrt(params.tracking.k3 / (params.tracking.k2 * bound))
}
