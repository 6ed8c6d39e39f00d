//! Mathematical back ends, chosen by type.
//!
//! A back end is a type and not a feature switch: two of them run side by side in one test, and
//! a library cannot change another library's choice.

mod libm_backend;
mod micromath_backend;
mod single_backend;

pub use libm_backend::Libm;
pub use micromath_backend::Micromath;
pub use single_backend::Single;

use crate::scalar::Scalar;

/// A number type with a usual back end, for constructors that name none.
pub trait Usual: Scalar {
    /// [`Single`] for `f32`, [`Libm`] for `f64`.
    type Maths: Maths<Self>;
}

impl Usual for f32 {
    type Maths = Single;
}

impl Usual for f64 {
    type Maths = Libm;
}

/// The transcendental functions of the control law, for one number type.
///
/// Arguments are finite; results for others are unspecified but never a panic. Every function
/// runs in bounded time.
pub trait Maths<T: Scalar>: Copy + core::fmt::Debug + Default + Send + Sync + 'static {
    /// Sine and cosine of one angle \[rad\].
    fn sin_cos(angle: T) -> (T, T);
    /// [`sin_cos`](Maths::sin_cos) for |`angle`| ≤ 1e4 rad, where no range check is needed: wrapped
    /// headings, and neurons, whose bounds are at most 1e4.
    #[inline(always)]
    fn sin_cos_near(angle: T) -> (T, T) {
        Self::sin_cos(angle)
    }
    /// Angle \[rad\] in [−π/2, π/2] whose sine is `sine`, which lies in [−1, 1].
    fn asin(sine: T) -> T;
    /// Angle \[rad\] in (−π, π] of the vector (x, y).
    fn atan2(y: T, x: T) -> T;
    /// Square root of a value ≥ 0.
    fn sqrt(value: T) -> T;
    /// One over the [square root](Maths::sqrt) of a value > 0.
    #[inline(always)]
    fn inverse_sqrt(value: T) -> T {
        T::ONE / Self::sqrt(value)
    }
    /// exp(x) − 1 for x ≤ 0, without the cancellation near 0.
    fn exp_m1(x: T) -> T;
}
