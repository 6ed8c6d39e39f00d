//! Comparison with a message.

/// Panics unless `found` is within `tolerance` of `expected`, relative where that exceeds 1.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert_within(found, expected, tolerance * expected.abs().max(1.0), what);
}

/// Panics unless `found` is within `tolerance` of `expected`.
#[track_caller]
pub fn assert_within(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{what}: {found} instead of {expected} +- {tolerance:e}"
    );
}
