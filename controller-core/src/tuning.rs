//! Gains from a design specification that a person understands, and how far any gains are from trouble.
//!
//! | | the law for a real base | the paper's law |
//! | --- | --- | --- |
//! | gains from a design specification | [`motion::gains`] of [`motion::MotionDesignSpec`] | [`paper::tuning::gains`](crate::paper::tuning::gains) of [`paper::tuning::DesignSpec`](crate::paper::tuning::DesignSpec) |
//! | specifications from a tolerance | | [`paper::tuning::DesignSpec::for_tolerance`](crate::paper::tuning::DesignSpec::for_tolerance) |
//! | margins of any gains | [`motion::margins`] | [`paper::tuning::margins`](crate::paper::tuning::margins) |
//!
//! A specification that the base cannot meet is refused by a [`DesignError`] that names the parameter, the nearest
//! value that can be had and what stands against it; nothing is repaired silently.
//!
//! Everything here is linear: small errors, a straight reference, constant speed, the robot that the
//! parameters state. What large errors, limits and ticks do to it was measured: `docs/tuning.md`.
//! All computations have a fixed cost; they are meant for the start of a program, not for a tick.

pub(crate) mod error;
pub mod motion;
pub(crate) mod response;

pub use crate::stability::LoopMargins;
pub use error::{DesignError, DesignParameter, Why};

use crate::maths::Maths;
use crate::scalar::Scalar;
use core::fmt;

/// A loop of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Channel {
    /// Error along the path while following.
    Longitudinal,
    /// Error across the path, and heading, while following.
    Lateral,
    /// Distance to the goal while parking.
    Approach,
    /// Bearing of the goal while parking.
    Bearing,
    /// Heading at the goal.
    Heading,
}

/// What is not healthy about a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Concern {
    /// It grows without a cause.
    Unstable,
    /// Damping ratio below 0.4: it rings, overshoot beyond 25 %.
    Rings,
    /// Survives poses less than 0.1 s old: an ordinary localisation is too slow for it.
    ShortOfPoseDelay,
    /// Survives torque less than 0.05 s late: a tick of 20 ms and its drives use half of it.
    ShortOfTorqueDelay,
    /// A factor of less than 2 on mass or inertia makes it grow.
    ShortOfMass,
}

/// A channel and what is not healthy about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warning {
    /// Which loop.
    pub channel: Channel,
    /// What.
    pub concern: Concern,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let channel = match self.channel {
            Channel::Longitudinal => "along the path",
            Channel::Lateral => "across the path",
            Channel::Approach => "towards the goal",
            Channel::Bearing => "turning to the goal",
            Channel::Heading => "heading at the goal",
        };
        let concern = match self.concern {
            Concern::Unstable => "the loop is unstable",
            Concern::Rings => "the loop rings: damping below 0.4",
            Concern::ShortOfPoseDelay => "poses 0.1 s late make the loop unstable",
            Concern::ShortOfTorqueDelay => "torques 0.05 s late make the loop unstable",
            Concern::ShortOfMass => "twice the mass or inertia makes the loop unstable",
        };
        write!(f, "{channel}: {concern}")
    }
}

/// What is not healthy about a channel, the worst first.
pub(crate) fn concern<T: Scalar>(channel: Channel, margins: &LoopMargins<T>) -> Option<Warning> {
    let f = T::from_f64;
    let concern = if !margins.is_stable() {
        Concern::Unstable
    } else if margins.pose_delay_s < f(0.1) {
        Concern::ShortOfPoseDelay
    } else if margins.torque_delay_s < f(0.05) {
        Concern::ShortOfTorqueDelay
    } else if margins.heavier < f(2.0) {
        Concern::ShortOfMass
    } else if margins.damping < f(0.4) {
        Concern::Rings
    } else {
        return None;
    };
    Some(Warning { channel, concern })
}

/// The bandwidth w_d \[1/s\] of a disturbance estimate d̂' = −w_d κ (v − v_c) that meets a velocity loop
/// of bandwidth `loop_bandwidth` with the damping ratio `damping`: λ² + κ λ + κ w_d, w_d = κ/(4 ζ²).
///
/// 1 for no overshoot after a push; below 0.7 the estimate hunts. An estimate that is driven by a
/// model of the robot instead of the velocity error decays with w_d alone, whatever κ is.
pub fn disturbance_bandwidth<T: Scalar>(loop_bandwidth: T, damping: T) -> T {
    loop_bandwidth / (T::from_f64(4.0) * damping * damping)
}

/// The damping ratio ½ √(κ/w_d) of that pair.
pub fn disturbance_damping<T: Scalar, M: Maths<T>>(loop_bandwidth: T, estimate: T) -> T {
    T::HALF * M::sqrt(loop_bandwidth / estimate)
}
