//! What counts as arrived, and as stuck.

use crate::error::{Field, ParamError};
use crate::range::check_ranges;
use crate::scalar::Scalar;

/// Standard deviations of a noisy heading that its tolerance has: a parked robot is pushed off only
/// at 1.3 times the tolerance, and noise must not do it.
pub(crate) const HEADING_DEVIATIONS: f64 = 8.0;

/// What counts as arrived, and as stuck.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Arrival<T = f32> {
    /// Distance to the goal \[m\], 1e-5 to 10. With noisy poses at least the noise radius plus three
    /// standard deviations.
    pub distance_m: T,
    /// Heading error \[rad\], 1e-5 to 3.
    pub heading_rad: T,
    /// How long the predicted stop has to be inside \[s\], 0 to 10.
    pub dwell_s: T,
    /// How the robot gets to its goal.
    pub parking: Parking,
    /// What the wheels do once parked.
    pub at_rest: AtRest,
    /// A command above this \[m/s, or at the wheels' distance of the track\] with less than a tenth
    /// of it measured counts towards a stall, and so do wheels at their torque limit with less than a
    /// tenth of this measured. 1e-4 to 10.
    pub stall_speed: T,
    /// For how long it has to, to be one \[s\]. 1e-2 to 1e3.
    pub stall_s: T,
    /// How often a robot that stands outside of the tolerance drives out and tries again before
    /// [`super::Outcome::OutOfTolerance`].
    pub retries: u8,
}

/// How a robot gets to its goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Parking {
    /// By a manoeuvre near the least time, planned in the ticks before it.
    #[default]
    Planned,
    /// By feedback alone: two to four times as late, with ticks of the same small cost, for a chip that has no time to plan.
    Feedback,
}

/// What the wheels do once parked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum AtRest {
    /// Hold zero speed: a push is resisted by the velocity loop.
    #[default]
    Hold,
    /// No torque at all once the robot stands, until it is pushed off the goal.
    Release,
}

impl<T: Scalar> Arrival<T> {
    /// Half a millimetre, 0.7 mrad, 50 ms: for poses without noise.
    ///
    /// 0.7 mrad leaves 0.9 at the end (the stop is predicted); 50 ms is ten samples of a slow pose
    /// source. Stalled: 5 cm/s commanded and not reached for 2 s. Two
    /// retries: what two new approaches did not mend a third will not.
    pub fn exact() -> Self {
        let f = T::from_f64;
        Self {
            distance_m: f(5.0e-4),
            heading_rad: f(7.0e-4),
            dwell_s: f(0.05),
            parking: Parking::Planned,
            at_rest: AtRest::Hold,
            stall_speed: f(0.05),
            stall_s: f(2.0),
            retries: 2,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::ArrivalDistance, self.distance_m, 1.0e-5, 10.0),
            (Field::ArrivalHeading, self.heading_rad, 1.0e-5, 3.0),
            (Field::ArrivalDwell, self.dwell_s, 0.0, 10.0),
            (Field::StallSpeed, self.stall_speed, 1.0e-4, 10.0),
            (Field::StallTime, self.stall_s, 1.0e-2, 1.0e3),
        ]
    }
}
