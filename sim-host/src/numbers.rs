//! Numbers in messages: of six digits at most, without those that only rounding left.

use controller_core::error::{ParamError, Problem};
use controller_core::types::FARTHEST_M;

/// Behind the point of the scientific notation.
const DECIMALS: usize = 5;

/// A number.
pub(crate) fn digits(value: f64) -> String {
    written(rounded(value))
}

/// The smallest number that is taken. Rounded upwards: who writes what is said is not refused again.
pub(crate) fn least(limit: f64) -> String {
    written(up(limit))
}

/// The largest number that is taken, likewise.
pub(crate) fn most(limit: f64) -> String {
    written(-up(-limit))
}

/// A number that is refused; it never looks like the limit that it is beyond.
pub(crate) fn refused(value: f64, limit: f64) -> String {
    match rounded(value) == rounded(limit) {
        true => value.to_string(),
        false => digits(value),
    }
}

/// What is wrong with a number that is in no range.
pub(crate) fn outside(value: f64, low: f64, high: f64) -> String {
    let limit = if value < low { low } else { high };
    let (value, low, high) = (refused(value, limit), least(low), most(high));
    format!("{value} is not in {low} to {high}")
}

fn rounded(value: f64) -> f64 {
    format!("{value:.DECIMALS$e}").parse().unwrap_or(value)
}

/// The next number of so few digits that is not below this one.
fn up(value: f64) -> f64 {
    let near = rounded(value);
    if near < value {
        let exponent = value.abs().log10().floor() as i32 - DECIMALS as i32;
        return rounded(near + 10.0_f64.powi(exponent));
    }
    near
}

fn written(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1.0e-4..1.0e6).contains(&size) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// What is wrong with a place that is too far off for a base.
pub(crate) fn far() -> String {
    format!(
        "is more than {FARTHEST_M} m from the origin; the whole base computes in single precision: take an origin of your own"
    )
}

/// What the core says of a parameter, in numbers as above.
pub(crate) fn param(error: &ParamError) -> String {
    format!("{} {}", error.field.name(), problem(error))
}

/// The same without its name.
pub(crate) fn problem(error: &ParamError) -> String {
    match error.problem {
        Problem::Below(limit) => format!("is below its smallest value {}", least(limit)),
        Problem::Above(limit) => format!("is above its largest value {}", most(limit)),
        // What has no number is in the core's own words.
        _ => {
            let text = error.to_string();
            let rest = text.strip_prefix(error.field.name()).unwrap_or(&text);
            rest.trim_start().to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{digits, least, most, outside, param, refused};
    use controller_core::error::{Field, ParamError, Problem};

    #[test]
    fn rounding_shows_nowhere() {
        for (value, text) in [
            (1.0 - 0.8 - 1.0e-17, "0.2"),
            (-0.1 - 0.2, "-0.3"),
            (1.0e-6, "1e-6"),
            (1.0e300, "1e300"),
            (123_456_789.0, "1.23457e8"),
            (0.0, "0"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(digits(value), text);
        }
    }

    /// What is said to be the limit is taken.
    #[test]
    fn limits_are_rounded_to_what_is_taken() {
        for limit in [0.2, 0.1 + 0.2, 1.0 / 3.0, 9.999_999, 1.0e-7 / 3.0, 0.0] {
            for limit in [limit, -limit] {
                let [low, high] = [least(limit), most(limit)].map(|text| text.parse::<f64>());
                assert!(
                    low.is_ok_and(|low| low >= limit && low - limit <= 1.1e-5 * limit.abs()),
                    "{limit}"
                );
                assert!(
                    high.is_ok_and(|high| high <= limit && limit - high <= 1.1e-5 * limit.abs()),
                    "{limit}"
                );
            }
        }
        assert_eq!(
            [least(-f64::INFINITY), most(f64::INFINITY)],
            ["-inf", "inf"]
        );
        assert_eq!(least(0.1 + 0.2), "0.300001");
        assert_eq!(most(0.1 + 0.2), "0.3");
    }

    #[test]
    fn the_core_says_what_is_wrong() {
        for (problem, text) in [
            (Problem::Above(100.0), "is above its largest value 100"),
            (Problem::NotFinite, "is not a finite number"),
            (Problem::Differs, "is not what other parameters say"),
        ] {
            let field = Field::Track;
            let said = param(&ParamError { field, problem });
            assert_eq!(said, format!("{} {text}", field.name()));
        }
    }

    #[test]
    fn a_value_never_looks_like_its_limit() {
        assert_eq!(refused(1.000_000_4, 1.0), "1.0000004");
        assert_eq!(refused(0.1 + 0.2, 0.2), "0.3");
        assert_eq!(outside(1.000_000_4, 0.0, 1.0), "1.0000004 is not in 0 to 1");
        assert_eq!(outside(f64::NAN, 0.0, 1.0), "NaN is not in 0 to 1");
    }
}
