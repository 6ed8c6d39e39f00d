//! The two number types the core is written for.
//!
//! `f64` exists to prove the formulas against an oracle without rounding in the way, `f32` is what
//! a Cortex-M4F computes in hardware. The trait is sealed: every bound stated in this crate was
//! checked for these two.

mod wrap;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

mod sealed {
    pub trait Sealed {
        /// Of seconds from 1e-6 to 1e3, exactly, without the fraction.
        fn whole_microseconds(self) -> u32;
    }

    impl Sealed for f32 {
        /// In integers: 24 bits of the number and 20 of the factor, which a double holds as well, but in a kilobyte of software.
        fn whole_microseconds(self) -> u32 {
            let bits = self.to_bits();
            let (exponent, fraction) = (bits >> 23, bits & 0x007f_ffff);
            let product = u64::from(fraction | 0x0080_0000) * 1_000_000;
            product.wrapping_shr(150_u32.wrapping_sub(exponent)) as u32
        }
    }

    impl Sealed for f64 {
        fn whole_microseconds(self) -> u32 {
            (self * 1.0e6) as u32
        }
    }
}

/// `f32` or `f64`, with the few operations that the control law needs beside arithmetic.
///
/// Ordering is done by comparison, never by floating-point `max`, `min` or `clamp`: those leave
/// the sign of zero open, and host and chip have to agree bit for bit.
pub trait Scalar:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// π, rounded to nearest.
    const PI: Self;
    /// π/2, rounded to nearest.
    const FRAC_PI_2: Self;
    /// The distance from 1 to the next larger value.
    const EPSILON: Self;
    /// The largest finite value.
    const MAX: Self;

    /// Rounds a double to this type; meant for constants and for parameters, not for the tick.
    fn from_f64(value: f64) -> Self;
    /// The nearest value of this type.
    fn from_i32(value: i32) -> Self;
    /// The nearest value of this type.
    fn from_u32(value: u32) -> Self;
    /// Widens to a double; exact.
    fn to_f64(self) -> f64;
    /// Without its fraction; saturates, and is 0 for NaN.
    fn to_u32(self) -> u32;
    /// The same number in another precision: rounded to nearest, exact where it widens.
    #[inline]
    fn cast<S: Scalar>(self) -> S {
        S::from_f64(self.to_f64())
    }
    /// Magnitude; clears the sign bit.
    fn abs(self) -> Self;
    /// 1 for a negative sign bit, else 0: chooses between two values without a comparison.
    fn sign_index(self) -> usize;
    /// 0 < `self` ≤ `limit`, for a positive finite `limit`; false for NaN.
    ///
    /// Positive floats are ordered like their bits, so one unsigned comparison does it all.
    fn is_positive_up_to(self, limit: Self) -> bool;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// The angle congruent to `self` in (−π, π]; see [`crate::angle::wrap`].
    fn wrap_angle(self) -> Self;
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const HALF: Self = 0.5;
    const PI: Self = core::f32::consts::PI;
    const FRAC_PI_2: Self = core::f32::consts::FRAC_PI_2;
    const EPSILON: Self = f32::EPSILON;
    const MAX: Self = f32::MAX;

    #[inline]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn from_i32(value: i32) -> Self {
        value as f32
    }
    #[inline]
    fn from_u32(value: u32) -> Self {
        value as f32
    }
    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn to_u32(self) -> u32 {
        self as u32
    }
    #[inline]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn sign_index(self) -> usize {
        (self.to_bits() >> 31) as usize
    }
    #[inline(always)]
    fn is_positive_up_to(self, limit: Self) -> bool {
        self.to_bits().wrapping_sub(1) < limit.to_bits()
    }
    #[inline]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
    #[inline]
    fn wrap_angle(self) -> Self {
        crate::single::wrap(self)
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const HALF: Self = 0.5;
    const PI: Self = core::f64::consts::PI;
    const FRAC_PI_2: Self = core::f64::consts::FRAC_PI_2;
    const EPSILON: Self = f64::EPSILON;
    const MAX: Self = f64::MAX;

    #[inline]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline]
    fn from_i32(value: i32) -> Self {
        f64::from(value)
    }
    #[inline]
    fn from_u32(value: u32) -> Self {
        f64::from(value)
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline]
    fn to_u32(self) -> u32 {
        self as u32
    }
    #[inline]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sign_index(self) -> usize {
        (self.to_bits() >> 63) as usize
    }
    #[inline(always)]
    fn is_positive_up_to(self, limit: Self) -> bool {
        self.to_bits().wrapping_sub(1) < limit.to_bits()
    }
    #[inline]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
    #[inline]
    fn wrap_angle(self) -> Self {
        wrap::wrap_f64(self)
    }
}

/// 0 if all `values` are finite, otherwise NaN: Σ 0 x, one instruction each. Residues may be added up, so that many numbers cost one
/// comparison.
#[inline(always)]
pub(crate) fn residue<T: Scalar, const N: usize>(values: [T; N]) -> T {
    // From -0, which added to anything is that.
    let start = -T::ZERO;
    values
        .into_iter()
        .fold(start, |sum, value| sum + value * T::ZERO)
}

/// Of seconds from 1e-6 to 1e3, without the fraction of the exact product.
pub(crate) fn whole_microseconds<T: Scalar>(seconds: T) -> u32 {
    sealed::Sealed::whole_microseconds(seconds)
}

/// Microseconds in seconds. In single precision exact to a rounding up to 16.7 s.
#[inline]
pub(crate) fn seconds<T: Scalar>(us: u32) -> T {
    T::from_u32(us) * T::from_f64(1.0e-6)
}

/// Seconds in microseconds. Saturates; what is no number is as long as can be.
#[inline]
pub(crate) fn microseconds<T: Scalar>(seconds: T) -> u32 {
    let us = seconds * T::from_f64(1.0e6);
    if us >= T::ZERO { us.to_u32() } else { u32::MAX }
}

#[cfg(test)]
mod tests {
    use super::whole_microseconds;

    #[test]
    fn whole_microseconds_are_those_of_the_exact_product() {
        let ends = [1.0e-6_f32, 1.0e3].map(f32::to_bits);
        for bits in (ends[0]..=ends[1]).step_by(97).chain(ends) {
            let seconds = f32::from_bits(bits);
            let exact = (f64::from(seconds) * 1.0e6) as u32;
            assert_eq!(whole_microseconds(seconds), exact, "{seconds}");
            assert_eq!(whole_microseconds(f64::from(seconds)), exact);
        }
    }
}
