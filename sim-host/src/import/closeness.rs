//! Distances and angles that belong together.

use std::fmt;

/// A heading may depart by what brings a point so far ahead to the tube's edge \[m\].
pub(super) const AHEAD: f64 = 0.04;

/// A tube's room across \[m\] and in heading \[rad\].
pub(super) fn room(tube: f64) -> [f64; 2] {
    [tube, tube / AHEAD]
}

/// How close a reference passes the poses of its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closeness {
    /// Largest distance \[m\].
    pub position_m: f64,
    /// Largest angle \[rad\].
    pub heading_rad: f64,
}

impl fmt::Display for Closeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (position, heading) = (1e3 * self.position_m, 1e3 * self.heading_rad);
        write!(f, "{position:.1} mm and {heading:.1} mrad")
    }
}

impl From<[f64; 2]> for Closeness {
    fn from([position_m, heading_rad]: [f64; 2]) -> Self {
        Self {
            position_m,
            heading_rad,
        }
    }
}
