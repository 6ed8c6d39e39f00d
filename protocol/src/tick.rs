//! A tick of the base, as it travels.

use controller_core::safety::supervisor::State;
use serde::{Deserialize, Serialize};

use super::values::real;

/// Bits of [`BaseTick::flags`].
pub mod tick_flags {
    /// The command was held at the largest speed or turn rate.
    pub const SPEED_LIMITED: u16 = 1;
    /// The command was slewed.
    pub const ACCEL_LIMITED: u16 = 1 << 1;
    /// The fed-forward acceleration was slewed.
    pub const JERK_LIMITED: u16 = 1 << 2;
    /// A wheel torque was at its limit.
    pub const TORQUE_LIMITED: u16 = 1 << 3;
    /// The disturbance estimate was at its bound.
    pub const DISTURBANCE_LIMITED: u16 = 1 << 4;
    /// The pose or the goal jumped.
    pub const JUMPED: u16 = 1 << 5;
    /// While parking: the robot backs up.
    pub const BACKING: u16 = 1 << 6;
    /// The encoders gave nothing; the pose is extrapolated.
    pub const BLIND: u16 = 1 << 7;
    /// The law is parking; without this and `DRIVING` it is following.
    pub const PARKING: u16 = 1 << 8;
    /// A law is at work: its terms mean something.
    pub const LAW: u16 = 1 << 9;
    /// An external pose was used.
    pub const FIX_USED: u16 = 1 << 10;
    /// An external pose was an outlier, or no use.
    pub const FIX_REFUSED: u16 = 1 << 11;
    /// The law drives by velocity.
    pub const DRIVING: u16 = 1 << 12;
    /// A gyro carries the heading.
    pub const GYRO_USED: u16 = 1 << 13;
    /// Gyro and wheels disagree: a wheel slides, or the gyro lies.
    pub const SLIDING: u16 = 1 << 14;
    /// Wheels slid on the way to this goal: manoeuvres to it have half the accelerations.
    pub const GRIP_LIMITED: u16 = 1 << 15;
}

/// The output to the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum WireAction {
    /// Released.
    #[default]
    Release,
    /// Shorted.
    Brake,
    /// Torques.
    Drive,
}

/// What came of the law's task so far; [`controller_core::motion::Outcome`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum WireOutcome {
    /// On the way.
    #[default]
    Driving,
    /// At the goal.
    Parked,
    /// Ordered to move, and stands.
    Stalled,
    /// Given up beside the goal.
    OutOfTolerance,
}

/// The important terms of a tick, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BaseTick {
    /// Ticks since power-on; wraps around.
    pub tick: u32,
    /// The supervisor's state.
    pub state: State,
    /// The output to the wheels.
    pub action: WireAction,
    /// What came of it.
    pub outcome: WireOutcome,
    /// See [`tick_flags`].
    pub flags: u16,
    /// Faults found in this tick: bit n − 1 for the kind with the code n.
    pub active_faults: u32,
    /// Faults ignored since power-on.
    pub ignored: u32,
    /// New approaches to the goal so far.
    pub retries: u8,
    /// Pose, m.
    #[serde(deserialize_with = "real")]
    pub x: f32,
    /// m.
    #[serde(deserialize_with = "real")]
    pub y: f32,
    /// rad.
    #[serde(deserialize_with = "real")]
    pub theta: f32,
    /// Measured speed, m/s.
    #[serde(deserialize_with = "real")]
    pub v: f32,
    /// Measured turn rate, rad/s.
    #[serde(deserialize_with = "real")]
    pub w: f32,
    /// Pose error in the body frame, m; this and what follows 0 where no law is at work.
    #[serde(deserialize_with = "real")]
    pub e_x: f32,
    /// m.
    #[serde(deserialize_with = "real")]
    pub e_y: f32,
    /// rad.
    #[serde(deserialize_with = "real")]
    pub e_theta: f32,
    /// Commanded speed, m/s.
    #[serde(deserialize_with = "real")]
    pub v_c: f32,
    /// Commanded turn rate, rad/s.
    #[serde(deserialize_with = "real")]
    pub w_c: f32,
    /// Measured minus commanded speed, m/s.
    #[serde(deserialize_with = "real")]
    pub e_v: f32,
    /// rad/s.
    #[serde(deserialize_with = "real")]
    pub e_w: f32,
    /// Estimated force that acts on the robot beside its wheels, N.
    #[serde(deserialize_with = "real")]
    pub load_force: f32,
    /// Estimated moment, N m.
    #[serde(deserialize_with = "real")]
    pub load_moment: f32,
    /// Torque of the right wheel, limited, N m.
    #[serde(deserialize_with = "real")]
    pub tau_right: f32,
    /// Torque of the left wheel, limited, N m.
    #[serde(deserialize_with = "real")]
    pub tau_left: f32,
}
