//! Design specifications and margins for the law of [`crate::motion`].

mod loops;
mod spec;

pub use spec::{MotionDesignSpec, gains};

use super::{Channel, LoopMargins, Warning, concern};
use crate::maths::Maths;
use crate::motion::MotionGains;
use crate::scalar::Scalar;
use crate::tuning::response::response;
use loops::{bearing, estimating, lateral, longitudinal};

/// Margins of all loops, and the times that the gains amount to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionMargins<T> {
    /// Following, e_x: k₁, A, κ₁.
    pub longitudinal: LoopMargins<T>,
    /// Following, e_y and e_θ: k₃, c, A, κ₂. Does not depend on the speed.
    pub lateral: LoopMargins<T>,
    /// Parking by feedback, distance: k₄, A₄, κ₁; A₄ is the decay of its neurons.
    pub approach: LoopMargins<T>,
    /// Parking by feedback, bearing, while the distance decays with k₄: k₄, A₄, κ₂. Its delay margins take that
    /// decay as undisturbed.
    pub bearing: LoopMargins<T>,
    /// Parking by feedback, heading inside the noise radius: k₄, A₄, κ₂.
    pub heading: LoopMargins<T>,
    /// A small offset across the path has a tenth left \[s\].
    pub settling_s: T,
    /// A small distance to the goal has a tenth left \[s\].
    pub arrival_s: T,
}

impl<T: Scalar> MotionMargins<T> {
    /// The worst of all loops, field by field.
    pub fn worst(&self) -> LoopMargins<T> {
        let following = self.longitudinal.worse(&self.lateral);
        let parking = self.approach.worse(&self.bearing).worse(&self.heading);
        following.worse(&parking)
    }

    /// What is not healthy, if anything: unstable before fragile before ringing.
    pub fn warnings(&self) -> impl Iterator<Item = Warning> {
        [
            (Channel::Longitudinal, self.longitudinal),
            (Channel::Lateral, self.lateral),
            (Channel::Approach, self.approach),
            (Channel::Bearing, self.bearing),
            (Channel::Heading, self.heading),
        ]
        .into_iter()
        .filter_map(|(channel, margins)| concern(channel, &margins))
    }
}

/// Margins of any gains, good or hopeless.
///
/// ```
/// use controller_core::maths::Libm;
/// use controller_core::motion::{Limits, MotionGains, SaturationPolicy};
/// use controller_core::tuning::motion::margins;
///
/// let limits = Limits {
///     speed: 1.0, turn_rate: 2.0, rim_speed: 1.2, accel: 0.8, brake: 1.0, turn_accel: 3.0,
///     jerk: 20.0, turn_jerk: 40.0, wheel_torque_nm: 8.0, policy: SaturationPolicy::KeepCurvature,
/// };
/// let good = MotionGains::<f64>::for_limits::<Libm>(&limits, 0.01);
/// assert_eq!(margins::<f64, Libm>(&good).warnings().count(), 0);
///
/// // Forty times the stiffness across the path, for a robot that weaved once too slowly.
/// let hopeless = MotionGains { lateral: 40.0 * good.lateral, ..good };
/// let warning = margins::<f64, Libm>(&hopeless).warnings().next().expect("one");
/// assert_eq!(warning.to_string(), "across the path: the loop is unstable");
/// ```
pub fn margins<T: Scalar, M: Maths<T>>(gains: &MotionGains<T>) -> MotionMargins<T> {
    let MotionGains {
        decay: a,
        speed_loop,
        turn_loop,
        approach,
        disturbance,
        ..
    } = *gains;
    let of = |feedback| estimating(feedback, disturbance).margins::<M>();
    let horizon = T::from_f64(200.0);
    let settle = |p, push, decay: T| {
        // Ten decay times are four more than a factor of ten takes.
        let ten = T::from_f64(10.0);
        if decay > ten / horizon {
            response(&p, push, ten / decay).tenth_s
        } else {
            horizon
        }
    };
    let lateral_margins = of(lateral(gains.heading, gains.lateral, a, turn_loop));
    let parking = gains.approach_decay();
    let approach_margins = of(longitudinal(approach, parking, speed_loop));
    let (side, push) = loops::lateral_start(gains.heading, gains.lateral, a);
    let (ahead, pull) = loops::longitudinal_start(approach, parking, a);
    MotionMargins {
        longitudinal: of(longitudinal(gains.longitudinal, a, speed_loop)),
        lateral: lateral_margins,
        approach: approach_margins,
        bearing: of(bearing(approach, parking, turn_loop)),
        heading: of(longitudinal(approach, parking, turn_loop)),
        settling_s: settle(side, push, lateral_margins.decay),
        arrival_s: settle(ahead, pull, approach_margins.decay),
    }
}
