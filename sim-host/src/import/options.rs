//! What a caller may choose.

use super::Format;

/// How close the reference passes the poses of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Metres.
    pub position_m: f64,
    /// Radians.
    pub heading_rad: f64,
}

/// Choices for [`super::import`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Instead of the format's own: 0.5 mm and 2 mrad for planned trajectories, 5 mm and 20 mrad
    /// for recorded (TUM) poses. Values that are not positive and finite are not used.
    pub tolerance: Option<Tolerance>,
    /// Poses with more noise than the tolerance, as recorded ones, may be passed as far off as the noise needs, within a tube of this
    /// radius \[m\]; that is listed as a repair.
    pub tube_m: Option<f64>,
    /// A file that states no speeds begins and ends at rest, however it moves there, if that passes its poses; else as it moves.
    pub rests: bool,
}

impl Options {
    /// Position and heading tolerance for a format.
    pub(super) fn tolerance(&self, format: Format) -> [f64; 2] {
        let own = match format {
            Format::TumPoses => [5e-3, 2e-2],
            _ => [5e-4, 2e-3],
        };
        let usable = |v: &f64| v.is_finite() && *v > 1e-9;
        self.tolerance
            .map(|t| [t.position_m, t.heading_rad])
            .filter(|t| t.iter().all(usable))
            .unwrap_or(own)
    }
}
