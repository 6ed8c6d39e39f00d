//! Every tolerance of the oracle's tests, with its reason.

/// Continuous golden traces, any column (m, rad, m/s, rad/s, N, N m).
///
/// The files themselves are converged to 3.4e-8 at worst (a torque of the plain curve) and the oracle's fixed step to
/// 2e-8 (the kinks of S⁺ and S⁻ at the curve's steepest moment): twice their sum.
pub const GOLDEN_CONTINUOUS: f64 = 1e-7;

/// Sampled golden traces, any column.
///
/// The samples are exact but for the posture's quadrature; the file's ten digits leave 5e-9 on a torque above 10.
pub const GOLDEN_SAMPLED: f64 = 1e-8;

/// Two formulas that are equal on paper, for values of order 100 in double precision.
pub const ALGEBRA: f64 = 1e-12;

/// Quadrature of the reference against another integration of it: Simpson's rule at 1 ms has 1e-14, and the targets
/// in the golden files carry 15 digits.
pub const REFERENCE_POSTURE: f64 = 1e-12;

/// Torque step at a switch that ought to have none: rounding of two torques below 100 N.
pub const TORQUE_STEP: f64 = 1e-12;

/// Central difference along the flow with a step of 1e-5 s or 1e-6 s: at most 1e-9 of truncation or rounding, for
/// functions of order 10 with third derivatives up to 1e3.
pub const FLOW_DERIVATIVE: f64 = 1e-8;

/// A figure quoted with one decimal: half a unit of it, and the next digit.
pub const ONE_DECIMAL: f64 = 0.055;

/// A figure quoted with two decimals: half a unit of it, and the next digit.
pub const TWO_DECIMALS: f64 = 0.0055;

/// Rise of a function that never rises, evaluated by the formula for its rate: rounding of terms of order 100.
pub const ROUNDING_RISE: f64 = 1e-12;

/// Torque step too small for the paper's figures, whose axes span tens of N and N m: a line's width.
pub const INVISIBLE_TORQUE_STEP: f64 = 0.02;

/// Share of 20,000 random states: three standard errors.
pub const STATE_SHARE: f64 = 0.01;
