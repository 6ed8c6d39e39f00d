//! Everything that a tick computed, in one value.

use crate::pose_error::PoseError;
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

/// The report of one tick. Every term of the law is here; nothing is logged anywhere else.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport<T> {
    /// The law that made the torques of this report.
    pub phase: Phase,
    /// e_p, Eq. (8); while parking with respect to the goal.
    pub error: PoseError<T>,
    /// Neuron states after this tick's update.
    pub neurons: NeuronStates<T>,
    /// (v_c, w_c), bridge included.
    pub command: Twist<T>,
    /// (v̇_c, ẇ_c), bridge included.
    pub command_rate: Accel<T>,
    /// δ = (v − v_c, w − w_c).
    pub velocity_error: Twist<T>,
    /// Bridge terms (b_v, b_w) within the command.
    pub bridge: Twist<T>,
    /// (τ₁, τ₂) that the law asks for.
    pub wrench: Wrench<T>,
    /// At the tick of a hand-over: what the new law asks for minus what the old one would have,
    /// at the same instant. Zero at all other ticks.
    pub wrench_step: Wrench<T>,
    /// What the wheels are to be told \[N m\]: the wrench through B̄⁻¹, limited.
    pub torques: WheelTorques<T>,
    /// What is unusual about this tick.
    pub notes: Notes,
}

/// Conditions that a user wants to know of; none of them is an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Notes {
    /// This tick handed over from tracking to parking.
    pub handed_over: bool,
    /// A bridge term is at work: the start or the hand-over asked for more than the neurons hold.
    pub bridging: bool,
    /// An acceleration neuron was put outside [−D, B] by the hand-over and is on its way back.
    pub relaxing: bool,
    /// Both wheel torques were scaled down to the limit; `wrench` is what was asked for.
    pub saturated: bool,
}
