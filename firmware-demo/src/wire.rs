//! Between what travels and what the core computes with. Conversions change no bit.

use controller_core::error::{Input, StepFault};
use controller_core::paper::demand::Demand;
use controller_core::queue::TimedReference;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Measured, Pose, Twist};

use crate::protocol::{
    Refusal, TimedSample, WireDemand, WireMeasured, WirePose, WireReference, WireTwist,
};

mod field;
mod parameters;
mod report;
mod tick;

pub use report::Ticked;

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

impl From<&Measured<f32>> for WireMeasured {
    fn from(measured: &Measured<f32>) -> Self {
        Self {
            pose: (&measured.pose).into(),
            twist: (&measured.twist).into(),
        }
    }
}

impl From<&WireMeasured> for Measured<f32> {
    fn from(wire: &WireMeasured) -> Self {
        Self {
            pose: (&wire.pose).into(),
            twist: (&wire.twist).into(),
        }
    }
}

impl From<&Demand<f32>> for WireDemand {
    fn from(demand: &Demand<f32>) -> Self {
        match demand {
            Demand::Track(reference) => Self::Track(reference.into()),
            Demand::HandOver { reference, goal } => Self::HandOver {
                reference: reference.into(),
                goal: goal.into(),
            },
            Demand::Park => Self::Park,
        }
    }
}

impl From<&WireDemand> for Demand<f32> {
    fn from(wire: &WireDemand) -> Self {
        match wire {
            WireDemand::Track(reference) => Self::Track(reference.into()),
            WireDemand::HandOver { reference, goal } => Self::HandOver {
                reference: reference.into(),
                goal: goal.into(),
            },
            WireDemand::Park => Self::Park,
        }
    }
}

impl From<StepFault> for Refusal {
    fn from(fault: StepFault) -> Self {
        match fault {
            StepFault::NotFinite(Input::Pose) => Self::Pose,
            StepFault::NotFinite(Input::Twist) => Self::Twist,
            StepFault::NotFinite(Input::Reference) => Self::Reference,
            StepFault::NotFinite(Input::Goal) => Self::Goal,
            StepFault::NotFinite(Input::Tick) => Self::Tick,
            StepFault::TickNotPositive => Self::TickNotPositive,
            StepFault::TickTooLong { .. } => Self::TickTooLong,
            StepFault::WrongPhase => Self::WrongPhase,
            StepFault::Overflow => Self::Overflow,
            _ => Self::Other,
        }
    }
}
