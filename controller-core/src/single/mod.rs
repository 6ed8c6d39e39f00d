//! Single-precision elementary functions for the control loop.
//!
//! Pure functions on `f32`: no tables indexed by data the compiler cannot bound, no state, no
//! allocation, no panic. Only `+ - * /`, comparisons and integer operations on the bits are used,
//! in a fixed order, so every target with IEEE arithmetic and no contraction to fused
//! multiply-add returns the same bits. A function that has no value at its argument returns NaN.
//!
//! | function | range | largest error |
//! |---|---|---|
//! | [`sin_cos`] | any finite angle | 8.8e-8 absolute |
//! | [`wrap`] | any finite angle | half an ulp of the result + 4e-9 |
//! | [`atan2`] | everything | 2.7e-7 absolute |
//! | [`asin`] | [−1, 1] | 1.4e-7 absolute |
//! | [`exp_m1`] | everything | 1.2e-7 relative |
//! | [`sqrt`] | everything | correctly rounded |
//! | [`inverse_sqrt`] | everything | 1.4e-7 relative |
//!
//! The polynomials were fitted offline: weighted minimax (Remez exchange, 40 digits) on the
//! interval written next to the coefficients, then rounded to `f32` from the lowest power up, the
//! remaining powers being fitted again after each rounding.
#![forbid(unsafe_code)]

mod asin;
mod atan2;
mod exp_m1;
mod reduce;
mod sin_cos;
mod sqrt;
mod wrap;

pub use asin::asin;
pub use atan2::atan2;
pub use exp_m1::exp_m1;
pub use sin_cos::{sin_cos, sin_cos_near};
pub use sqrt::{inverse_sqrt, sqrt};
pub use wrap::wrap;

/// The sign bit.
const SIGN: u32 = 0x8000_0000;

/// Bits of +∞: a magnitude at or above is not finite.
const INFINITY_BITS: u32 = 0x7f80_0000;
