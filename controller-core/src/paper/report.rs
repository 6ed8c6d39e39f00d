//! Everything that a tick computed, in one value.

use crate::cast::cast;
use crate::pose_error::PoseError;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist, WheelTorques, Wrench};

/// Which law is in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Following a moving reference: Eqs. (15)-(17), or (10) and (12).
    #[default]
    Tracking,
    /// Going to a pose at rest: Eqs. (20)-(22), or (13) and (14).
    Parking,
}

/// States of the five neurons; those without a part in the phase, or in the controller, are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NeuronStates<T> {
    /// s₁, of e_x.
    pub s1: T,
    /// s₂, of e_y; tracking only.
    pub s2: T,
    /// s₃, of e_θ; parking only.
    pub s3: T,
    /// (v̇_s, ẇ_s), of the command's rate.
    pub accel: Accel<T>,
}

cast!(NeuronStates { s1, s2, s3, accel });

/// The report of one tick. Every term of the law is here; nothing is logged anywhere else.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport<T> {
    /// The law that made the torques of this report.
    pub phase: Phase,
    /// e_p, Eq. (8); while parking with respect to the goal.
    pub error: PoseError<T>,
    /// Neuron states after this tick's update.
    pub neurons: NeuronStates<T>,
    /// (v_c, w_c), transition offset included.
    pub command: Twist<T>,
    /// (v̇_c, ẇ_c), transition offset included.
    pub command_rate: Accel<T>,
    /// δ = (v − v_c, w − w_c).
    pub velocity_error: Twist<T>,
    /// Transition offsets (b_v, b_w) within the command; see [`StepReport::has_transition_offset`].
    pub transition_offset: Twist<T>,
    /// (τ₁, τ₂) that the law demands.
    pub wrench: Wrench<T>,
    /// Torques for the wheels \[N m\]: the wrench through B̄⁻¹, limited.
    pub torques: WheelTorques<T>,
    /// Both wheel torques were scaled down to the limit; `wrench` is what was demanded.
    pub saturated: bool,
}

cast!(
    StepReport {
        error,
        neurons,
        command,
        command_rate,
        velocity_error,
        transition_offset,
        wrench,
        torques,
    } keeps phase, saturated
);

impl<T: Scalar> StepReport<T> {
    /// A transition offset above `threshold` \[m/s, rad/s\] is at work: the start or the hand-over asked
    /// for more than the neurons hold.
    ///
    /// Transition offsets fade as exp(−A t) and become exactly 0 only when they underflow; with a threshold of
    /// 0 the answer says whether one was needed at all.
    pub fn has_transition_offset(&self, threshold: T) -> bool {
        self.transition_offset.linear.abs() > threshold
            || self.transition_offset.angular.abs() > threshold
    }
}
