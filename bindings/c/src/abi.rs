//! The structs of the header. Every number is 32 bits wide, so that no compiler pads.

/// Version of these structs and of the calls: the caller's header has the same one.
pub const API: u32 = 6;

/// What a call answers that did nothing. None is 0, which the call answers that did what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// A pointer is NULL.
    Null = -1,
    /// A pointer is not aligned for its type.
    Misaligned = -2,
    /// The base was not initialised.
    NotInitialised = -3,
    /// Called from within another call on the same base.
    Busy = -4,
    /// Header and archive are of different versions, or the memory is too small.
    Api = -5,
    /// The bytes are no robot.
    RobotMagic = -6,
    /// There are more or fewer bytes than the robot states.
    RobotLength = -7,
    /// A bit of the robot is wrong.
    RobotCheck = -8,
    /// The robot is of another version.
    RobotVersion = -9,
    /// The robot is sound, and has no parameters or such that are out of range.
    RobotContent = -10,
    /// A number is NaN or infinite where that is no fault of the tick.
    NotFinite = -11,
    /// A kind, a status or a flag that the header does not have.
    BadValue = -12,
    /// The base's state does not allow it.
    Refused = -13,
}

/// `twb_pose`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Pose {
    /// m.
    pub x: f32,
    /// m.
    pub y: f32,
    /// rad.
    pub theta: f32,
}

/// `twb_twist`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Twist {
    /// m/s.
    pub v: f32,
    /// rad/s.
    pub w: f32,
}

/// A number for each wheel: `twb_wheels`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Wheels {
    /// Right.
    pub right: f32,
    /// Left.
    pub left: f32,
}

/// `twb_order`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Order {
    /// See [`order`].
    pub kind: u32,
    /// 0 or 1; velocity orders.
    pub hold_heading: u32,
    /// Of the reference, or the goal.
    pub pose: Pose,
    /// Of the reference, or ordered.
    pub twist: Twist,
    /// Of the reference.
    pub accel: Twist,
    /// What the reference's path has to go until it rests \[m\].
    pub left: f32,
}

/// Kinds of orders.
pub mod order {
    /// Nothing new.
    pub const NONE: u32 = 0;
    /// Follow this sample.
    pub const FOLLOW: u32 = 1;
    /// Go to this pose and stay.
    pub const PARK: u32 = 2;
    /// Drive with this twist.
    pub const VELOCITY: u32 = 3;
}

/// `twb_sensed`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Sensed {
    /// See [`sensed`].
    pub flags: u32,
    /// Counts, wrapping around.
    pub right: i32,
    /// Counts, wrapping around.
    pub left: i32,
    /// How the encoders are: see [`device`].
    pub encoders: u32,
    /// What the wheel driver answered.
    pub driver: u32,
    /// External pose.
    pub fix: Pose,
    /// How long ago it was valid \[s\].
    pub fix_age_s: f32,
    /// Turn rate of a gyro \[rad/s\].
    pub gyro_rate: f32,
    /// Heading that it fuses by itself \[rad\].
    pub gyro_heading: f32,
    /// How long ago that was valid \[s\].
    pub gyro_age_s: f32,
    /// Supply of the motors \[V\].
    pub supply_v: f32,
    /// Currents of the motors \[A\].
    pub currents: Wheels,
}

/// What of [`Sensed`] is there.
pub mod sensed {
    /// An external pose arrived.
    pub const FIX: u32 = 1;
    /// A reading of the gyro arrived.
    pub const GYRO: u32 = 1 << 1;
    /// With a heading; never without [`GYRO`].
    pub const GYRO_HEADING: u32 = 1 << 2;
    /// The supply is measured.
    pub const SUPPLY: u32 = 1 << 3;
    /// The currents are measured.
    pub const CURRENTS: u32 = 1 << 4;
    /// All of them.
    pub const KNOWN: u32 = FIX | GYRO | GYRO_HEADING | SUPPLY | CURRENTS;
}

/// How a device is.
pub mod device {
    /// Well.
    pub const OK: u32 = 0;
    /// It did not answer, or answered nonsense.
    pub const BUS: u32 = 1;
    /// It switched off for too much current.
    pub const OVER_CURRENT: u32 = 2;
    /// The supply is too low.
    pub const UNDER_VOLTAGE: u32 = 3;
    /// It refused a command out of its range.
    pub const OUT_OF_RANGE: u32 = 4;
    /// Anything else.
    pub const OTHER: u32 = 5;
}

/// `twb_action`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Action {
    /// See [`action`].
    pub kind: u32,
    /// See [`action`].
    pub flags: u32,
    /// N m.
    pub torque: Wheels,
    /// Share of the supply at the motors, −1 to 1.
    pub duty: Wheels,
    /// Commanded \[rad/s\].
    pub desired: Wheels,
    /// Measured \[rad/s\].
    pub speed: Wheels,
    /// Friction beyond the Coulomb part \[N m\].
    pub beyond_coulomb: Wheels,
}

/// Kinds of actions, and what of [`Action`] is there.
pub mod action {
    /// No torque, free to coast.
    pub const RELEASE: u32 = 0;
    /// Windings shorted.
    pub const BRAKE: u32 = 1;
    /// Torques, and duties where the robot has motors on bridges.
    pub const DRIVE: u32 = 2;
    /// `duty` is there.
    pub const DUTY: u32 = 1;
    /// Current or supply limited a torque.
    pub const LIMITED: u32 = 1 << 1;
    /// `beyond_coulomb` is there.
    pub const BEYOND_COULOMB: u32 = 1 << 2;
    /// `desired` is for drivers that close their own speed loop.
    pub const SPEEDS: u32 = 1 << 3;
}

/// `twb_report`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Report {
    /// Ticks so far; wraps around.
    pub tick: u32,
    /// The supervisor's state: the place in `State::ALL`.
    pub state: u32,
    /// Why it is that.
    pub cause: u32,
    /// Code of the fault that is the cause, or 0.
    pub cause_fault: u32,
    /// Code of the fault that a reset is to acknowledge, or 0.
    pub latched_fault: u32,
    /// Bit n − 1 for each fault with the code n that was found in the last tick.
    pub active_faults: u32,
    /// Faults ignored so far.
    pub ignored: u32,
    /// Changes of state so far.
    pub changes: u32,
    /// Ticks that came late.
    pub late_ticks: u32,
    /// Bits of `protocol::tick_flags`, and [`ORDER_REFUSED`](Self::ORDER_REFUSED).
    pub flags: u32,
    /// What came of the task.
    pub outcome: u32,
    /// New approaches to the goal.
    pub retries: u32,
    /// Kind of the last action.
    pub action: u32,
    /// Where the base is.
    pub pose: Pose,
    /// How it moves.
    pub twist: Twist,
    /// Pose error in the body frame.
    pub error: Pose,
    /// Commanded twist.
    pub command: Twist,
    /// Measured minus commanded twist.
    pub velocity_error: Twist,
    /// Force that acts on the base beside its wheels \[N\].
    pub load_force: f32,
    /// Moment \[N m\].
    pub load_moment: f32,
    /// Torques \[N m\].
    pub torque: Wheels,
    /// Turn that odometry adds per way \[rad/m\].
    pub curvature_bias: f32,
    /// Turn that odometry adds per turn.
    pub turn_bias: f32,
    /// What the tyres slip per acceleration \[s²/m\].
    pub tyre_slip: f32,
    /// Share by which the right motor's constant is above what is stated, and the left one's below it.
    pub motor_bias: f32,
    /// Bias of the gyro \[rad/s\], 0 without one.
    pub gyro_bias: f32,
    /// Turn by which gyro and wheels disagree \[rad\], 0 without one.
    pub gyro_slid: f32,
}

impl Report {
    /// The order did not fit the state; nothing came of it.
    pub const ORDER_REFUSED: u32 = 1 << 16;
}

// The header asserts the same numbers.
const _: () = {
    assert!(size_of::<Pose>() == 12);
    assert!(size_of::<Twist>() == 8);
    assert!(size_of::<Wheels>() == 8);
    assert!(size_of::<Order>() == 40);
    assert!(size_of::<Sensed>() == 60);
    assert!(size_of::<Action>() == 48);
    assert!(size_of::<Report>() == 140);
};
