//! Range checks shared by all parameters, and the symmetric limit shared by the laws.

use crate::error::{Field, ParamError, Problem};
use crate::scalar::Scalar;

/// `value` if it is finite and in [`low`, `high`], else an error that names field and limit.
pub(crate) fn within<T: Scalar>(
    field: Field,
    value: T,
    low: f64,
    high: f64,
) -> Result<T, ParamError> {
    let problem = if !value.is_finite() {
        Problem::NotFinite
    } else if value < T::from_f64(low) {
        Problem::Below(low)
    } else if value > T::from_f64(high) {
        Problem::Above(high)
    } else {
        return Ok(value);
    };
    Err(ParamError { field, problem })
}

/// Checks rows of `(field, value, low, high)` in turn, as [`within`] does. Limits that are constants are a table in flash, and all
/// tables share one loop.
macro_rules! check_ranges {
    [$(($field:expr, $value:expr, $low:expr, $high:expr $(,)?)),* $(,)?] => {
        $crate::range::all_within(&[$($field),*], &[$($value),*], &[$(($low, $high)),*])
    };
}
pub(crate) use check_ranges;

/// What [`check_ranges`] is made of: columns of its rows, which without gaps between them take two thirds of the flash.
#[inline(never)]
pub(crate) fn all_within<T: Scalar>(
    fields: &[Field],
    values: &[T],
    ranges: &[(f64, f64)],
) -> Result<(), ParamError> {
    for ((&field, &value), &(low, high)) in fields.iter().zip(values).zip(ranges) {
        within(field, value, low, high)?;
    }
    Ok(())
}

/// The smaller one, the second where one is no number.
#[inline]
pub(crate) fn smaller<T: Scalar>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The larger one, the second where one is no number.
#[inline]
pub(crate) fn larger<T: Scalar>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// `value`, with its sign changed where `of` is negative.
#[inline(always)]
pub(crate) fn signed<T: Scalar>(value: T, of: T) -> T {
    if of < T::ZERO { -value } else { value }
}

/// `value`, but not beyond ±`largest`. By comparison: host and chip agree on every bit.
#[inline]
pub(crate) fn clamp<T: Scalar>(value: T, largest: T) -> T {
    if value.abs() <= largest {
        // What happens in nearly every tick.
        return value;
    }
    if value > largest {
        largest
    } else if value < -largest {
        -largest
    } else {
        value
    }
}
