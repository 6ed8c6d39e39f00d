//! The default back end for a chip whose floating-point unit has only single precision.

use super::Maths;
use crate::single;

/// Our own single-precision functions, [`single`]: accurate to a few 1e-7 and free of doubles.
///
/// Built from additions, multiplications, comparisons and integer operations only, so every target
/// computes the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Single;

impl Maths<f32> for Single {
    #[inline(always)]
    fn sin_cos(angle: f32) -> (f32, f32) {
        single::sin_cos(angle)
    }
    #[inline(always)]
    fn sin_cos_near(angle: f32) -> (f32, f32) {
        single::sin_cos_near(angle)
    }
    #[inline]
    fn asin(sine: f32) -> f32 {
        single::asin(sine)
    }
    #[inline]
    fn atan2(y: f32, x: f32) -> f32 {
        single::atan2(y, x)
    }
    #[inline]
    fn sqrt(value: f32) -> f32 {
        single::sqrt(value)
    }
    #[inline]
    fn inverse_sqrt(value: f32) -> f32 {
        single::inverse_sqrt(value)
    }
    #[inline]
    fn exp_m1(x: f32) -> f32 {
        single::exp_m1(x)
    }
}
