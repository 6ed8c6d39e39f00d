//! The back end of record: `libm`, correct to about one unit in the last place.

use super::Maths;

/// `libm`. On a chip whose floating-point unit has only single precision its `f32` sine and
/// cosine are computed in software doubles: right, and some 1,200 instructions a call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Libm;

impl Maths<f64> for Libm {
    #[inline]
    fn sin_cos(angle: f64) -> (f64, f64) {
        libm::sincos(angle)
    }
    #[inline]
    fn asin(sine: f64) -> f64 {
        libm::asin(sine)
    }
    #[inline]
    fn atan2(y: f64, x: f64) -> f64 {
        libm::atan2(y, x)
    }
    #[inline]
    fn sqrt(value: f64) -> f64 {
        libm::sqrt(value)
    }
    #[inline]
    fn exp_m1(x: f64) -> f64 {
        libm::expm1(x)
    }
}

impl Maths<f32> for Libm {
    #[inline]
    fn sin_cos(angle: f32) -> (f32, f32) {
        libm::sincosf(angle)
    }
    #[inline]
    fn asin(sine: f32) -> f32 {
        libm::asinf(sine)
    }
    #[inline]
    fn atan2(y: f32, x: f32) -> f32 {
        libm::atan2f(y, x)
    }
    #[inline]
    fn sqrt(value: f32) -> f32 {
        libm::sqrtf(value)
    }
    #[inline]
    fn exp_m1(x: f32) -> f32 {
        libm::expm1f(x)
    }
}
