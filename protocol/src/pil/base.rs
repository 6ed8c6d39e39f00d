//! The whole base, one tick at a time: what a host sends in place of wheels and sensors, and what it gets back.

use controller_core::base::{BaseParams, Order, Sensed};
use controller_core::localiser::LocaliserParams;
use controller_core::motion::MotionParams;
use controller_core::motor::DriverParams;
use controller_core::safety::supervisor::SupervisorParams;
use controller_core::safety::{DetectorParams, PolicyParams};
use controller_core::types::Pose;
use serde::{Deserialize, Serialize};

use crate::{BaseTick, Command, Counters, Hello, RejectReason, WirePose, WireReference, WireTwist};

/// A question to a chip that has the whole base. Each has one answer.
// See `Question`: moved once, never boxed.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BaseQuestion {
    /// Who is there? [`BaseAnswer::Hello`].
    Hello,
    /// Parameters of the next base.
    Configure(BasePart),
    /// Start a base, disarmed, with the parameters that were sent.
    Begin {
        /// Where it is.
        start: Pose<f32>,
    },
    /// A command of the field protocol.
    Command(Command),
    /// The timer's interrupt; answered with [`BaseAnswer::Ticked`].
    Tick(BaseInput),
    /// Send the counters.
    GetCounters,
    /// No more questions.
    Stop,
}

/// The answer to a question.
// See `Question`: moved once, never boxed.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BaseAnswer {
    /// Who is there.
    Hello(Hello),
    /// What a tick did.
    Ticked(BaseTicked),
    /// What the link has seen, and the stack.
    Counters(Counters),
    /// Done.
    Ack,
    /// Not done.
    Nack(RejectReason),
}

/// Parameters of one part of a base: all together are too long for a frame.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum BasePart {
    /// The motion law.
    Motion(MotionParams<f32>),
    /// Odometry and external poses.
    Localiser(LocaliserParams<f32>),
    /// What drives the wheels.
    Driver(DriverParams<f32>),
    /// Thresholds and timeouts.
    Detectors(DetectorParams<f32>),
    /// Reactions to faults.
    Policy(PolicyParams),
    /// How stops end.
    Supervisor(SupervisorParams),
}

impl BasePart {
    /// All parts of a base's parameters.
    pub const fn all(params: &BaseParams<f32>) -> [Self; 6] {
        [
            Self::Motion(params.motion),
            Self::Localiser(params.localiser),
            Self::Driver(params.driver),
            Self::Detectors(params.detectors),
            Self::Policy(params.policy),
            Self::Supervisor(params.supervisor),
        ]
    }

    /// Puts the part into place.
    pub const fn put(&self, params: &mut BaseParams<f32>) {
        match self {
            Self::Motion(motion) => params.motion = *motion,
            Self::Localiser(localiser) => params.localiser = *localiser,
            Self::Driver(driver) => params.driver = *driver,
            Self::Detectors(detectors) => params.detectors = *detectors,
            Self::Policy(policy) => params.policy = *policy,
            Self::Supervisor(supervisor) => params.supervisor = *supervisor,
        }
    }
}

/// What a tick of the base has to go by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseInput {
    /// The clock \[µs\]; wraps around.
    pub now_us: u32,
    /// What is to be done.
    pub order: WireOrder,
    /// What the base senses, the drivers' answers included.
    pub sensed: Sensed<f32>,
}

/// [`Order`]; the receiver works out sine and cosine of a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum WireOrder {
    /// Nothing new.
    #[default]
    None,
    /// Follow this sample.
    Follow(WireReference),
    /// Go to this pose and stay.
    Park(WirePose),
    /// Drive with this speed and turn rate.
    Drive {
        /// Ordered.
        twist: WireTwist,
        /// Keep the heading.
        hold_heading: bool,
    },
}

impl From<&Order<f32>> for WireOrder {
    fn from(order: &Order<f32>) -> Self {
        match order {
            Order::None => Self::None,
            Order::Follow(reference) => Self::Follow(reference.into()),
            Order::Park(goal) => Self::Park(goal.into()),
            Order::Drive {
                twist,
                hold_heading,
            } => Self::Drive {
                twist: twist.into(),
                hold_heading: *hold_heading,
            },
        }
    }
}

impl From<&WireOrder> for Order<f32> {
    fn from(order: &WireOrder) -> Self {
        match order {
            WireOrder::None => Self::None,
            WireOrder::Follow(reference) => Self::Follow(reference.into()),
            WireOrder::Park(goal) => Self::Park(goal.into()),
            WireOrder::Drive {
                twist,
                hold_heading,
            } => Self::Drive {
                twist: twist.into(),
                hold_heading: *hold_heading,
            },
        }
    }
}

/// What a tick of the base did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BaseTicked {
    /// What the base would tell a host on its line.
    pub tick: BaseTick,
    /// What acts on the wheels until the next tick.
    pub output: WheelOutput,
    /// Executed instructions, 0 where they are not counted.
    pub instructions: u32,
}

/// What the wheels' drivers put out until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum WheelOutput {
    /// Open windings.
    #[default]
    Release,
    /// Shorted windings.
    Brake,
    /// Torque at each wheel \[N m\].
    Torque {
        /// Right wheel.
        #[serde(deserialize_with = "crate::values::real")]
        right: f32,
        /// Left wheel.
        #[serde(deserialize_with = "crate::values::real")]
        left: f32,
    },
    /// Share of the supply at each motor, −1 to 1.
    Duty {
        /// Right wheel.
        #[serde(deserialize_with = "crate::values::real")]
        right: f32,
        /// Left wheel.
        #[serde(deserialize_with = "crate::values::real")]
        left: f32,
    },
    /// Speed of each wheel, which its driver holds \[rad/s\].
    Speed {
        /// Right wheel.
        #[serde(deserialize_with = "crate::values::real")]
        right: f32,
        /// Left wheel.
        #[serde(deserialize_with = "crate::values::real")]
        left: f32,
    },
}
