//! Fast and rough: `micromath`, single precision only.

use super::Maths;
use micromath::F32Ext;

/// `micromath`: sine and cosine in some 30 instructions each, to about 1.1e-3.
///
/// Its arcsine (1.8e-2) and square root (6 %) would make the hand-over of Eq. (23) jump, so those
/// two come from `libm`; its exponential (2.4e-3 relative) has lost all digits of exp(x) − 1 by
/// the time x is a tick times a decay rate, so that comes from `libm` as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Micromath;

impl Maths<f32> for Micromath {
    #[inline]
    fn sin_cos(angle: f32) -> (f32, f32) {
        (F32Ext::sin(angle), F32Ext::cos(angle))
    }
    #[inline]
    fn asin(sine: f32) -> f32 {
        libm::asinf(sine)
    }
    #[inline]
    fn atan2(y: f32, x: f32) -> f32 {
        F32Ext::atan2(y, x)
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
