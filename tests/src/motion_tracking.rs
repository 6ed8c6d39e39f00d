//! Figures of following a reference.

use controller_core::maths::Libm;
use controller_core::motion::ValidMotionParams;
use controller_core::pose_error::PoseError;
use controller_core::shunting::ExactMean;
use controller_core::types::Wrench;

use crate::motion_base::{Base, Body};
use crate::motion_loop::{Drive, Order};

/// The controller in double precision.
pub type Exact = Drive<f64, Libm, ExactMean>;

/// What a run came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tracking {
    /// From when on within 5 mm of the reference \[s\].
    pub settled_s: f64,
    /// Largest distance in the last fifth of the run \[m\].
    pub late: f64,
    /// Root mean square distance in the second half \[m\].
    pub rms: f64,
    /// Largest distance in the second half \[m\].
    pub peak: f64,
    /// Wrench at the start.
    pub start: Wrench<f64>,
    /// Largest moment \[N m\].
    pub moment: f64,
    /// Largest turn rate \[rad/s\].
    pub turn_rate: f64,
    /// Error at the end.
    pub left: PoseError<f64>,
}

/// Follows `order` for `end_s`.
pub fn follow(
    motion: &ValidMotionParams<f64>,
    plant: Base,
    body: Body,
    dt: f64,
    end_s: f64,
    order: impl Fn(f64) -> Order,
) -> Tracking {
    let mut drive = Exact::start(motion, plant, body, &order(0.0), dt);
    let mut seen = Tracking {
        start: drive.applied(),
        ..Tracking::default()
    };
    let (mut squares, mut count) = (0.0, 0.0_f64);
    while drive.t < end_s {
        drive.advance(&order);
        let error = drive.error(&order(drive.t));
        let distance = error.x.hypot(error.y);
        if distance > 5e-3 {
            seen.settled_s = drive.t;
        }
        if drive.t > 0.8 * end_s {
            seen.late = seen.late.max(distance);
        }
        if drive.t > 0.5 * end_s {
            squares += distance * distance;
            count += 1.0;
            seen.peak = seen.peak.max(distance);
        }
        seen.moment = seen.moment.max(drive.applied().moment.abs());
        seen.turn_rate = seen.turn_rate.max(drive.body.twist.angular.abs());
        seen.left = error;
    }
    seen.rms = (squares / count.max(1.0)).sqrt();
    seen
}
