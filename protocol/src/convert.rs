//! Between what travels and what the core computes with. Conversions change no bit.

use controller_core::queue::TimedReference;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

use crate::{TimedSample, WirePose, WireReference, WireTwist};

mod field;
mod tick;

impl From<&Pose<f32>> for WirePose {
    fn from(&Pose { x, y, theta }: &Pose<f32>) -> Self {
        Self { x, y, theta }
    }
}

impl From<&WirePose> for Pose<f32> {
    fn from(&WirePose { x, y, theta }: &WirePose) -> Self {
        Self { x, y, theta }
    }
}

impl From<&Twist<f32>> for WireTwist {
    fn from(twist: &Twist<f32>) -> Self {
        Self {
            v: twist.linear,
            w: twist.angular,
        }
    }
}

impl From<&WireTwist> for Twist<f32> {
    fn from(&WireTwist { v, w }: &WireTwist) -> Self {
        Self::new(v, w)
    }
}

impl From<&Accel<f32>> for WireTwist {
    fn from(accel: &Accel<f32>) -> Self {
        Self {
            v: accel.linear,
            w: accel.angular,
        }
    }
}

impl From<&WireTwist> for Accel<f32> {
    fn from(&WireTwist { v, w }: &WireTwist) -> Self {
        Self::new(v, w)
    }
}

impl From<&Reference<f32>> for WireReference {
    fn from(reference: &Reference<f32>) -> Self {
        Self {
            pose: reference.pose().into(),
            twist: reference.twist().into(),
            accel: reference.accel().into(),
            left: reference.left_m(),
        }
    }
}

/// Works out sine and cosine of the heading: host and chip get the same bits.
impl From<&WireReference> for Reference<f32> {
    fn from(wire: &WireReference) -> Self {
        Self::new(
            (&wire.pose).into(),
            (&wire.twist).into(),
            (&wire.accel).into(),
        )
        .with_left(wire.left)
    }
}

impl From<&TimedSample> for TimedReference<f32> {
    fn from(sample: &TimedSample) -> Self {
        Self {
            t: sample.t,
            reference: (&sample.reference).into(),
        }
    }
}

impl From<&TimedReference<f32>> for TimedSample {
    fn from(sample: &TimedReference<f32>) -> Self {
        Self {
            t: sample.t,
            reference: (&sample.reference).into(),
        }
    }
}
