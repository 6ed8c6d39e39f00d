//! Every term of one control tick, as it travels.

use serde::{Deserialize, Serialize};

/// Bits of [`Report::flags`].
pub mod report_flags {
    /// The wheel torques were scaled down to their limit.
    pub const SATURATED: u8 = 1;
    /// This tick handed over from tracking to parking.
    pub const HANDED_OVER: u8 = 1 << 1;
    /// An acceleration neuron is outside its bounds, on its way back.
    pub const RELAXING: u8 = 1 << 2;
}

/// The terms of the law in the paper's symbols, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Ticks since the controller was started.
    pub tick: u32,
    /// Executed instructions of the step where the board can count them, else 0.
    pub instructions: u32,
    /// 0 tracking, 1 parking.
    pub phase: u8,
    /// See [`report_flags`].
    pub flags: u8,
    /// Pose error in the body frame, m.
    pub e_x: f32,
    /// m.
    pub e_y: f32,
    /// rad.
    pub e_theta: f32,
    /// Neuron of the forward error.
    pub s1: f32,
    /// Neuron of the lateral error, tracking only.
    pub s2: f32,
    /// Neuron of the heading error, parking only.
    pub s3: f32,
    /// Filtered rate of the forward command, m/s^2.
    pub vdot_s: f32,
    /// Filtered rate of the turn command, rad/s^2.
    pub wdot_s: f32,
    /// Forward velocity command, m/s.
    pub v_c: f32,
    /// Turn rate command, rad/s.
    pub w_c: f32,
    /// Its analytic rate, m/s^2.
    pub vdot_c: f32,
    /// Its analytic rate, rad/s^2.
    pub wdot_c: f32,
    /// Velocity error, m/s.
    pub e_v: f32,
    /// Turn rate error, rad/s.
    pub e_w: f32,
    /// What the forward command carries beside the neuron, m/s.
    pub offset_v: f32,
    /// What the turn command carries beside the neuron, rad/s.
    pub offset_w: f32,
    /// Demanded force, N.
    pub force: f32,
    /// Demanded moment, N m.
    pub moment: f32,
    /// Torque of the right wheel, limited, N m.
    pub tau_right: f32,
    /// Torque of the left wheel, limited, N m.
    pub tau_left: f32,
    /// Step of the force at the hand-over, N; 0 in every other tick.
    pub step_force: f32,
    /// Step of the moment at the hand-over, N m; 0 in every other tick.
    pub step_moment: f32,
}
