//! What can be wrong: parameters, starts, ticks. Small `Copy` values that name the culprit.

use core::fmt;

/// A parameter, by the name it has in scenario files and in the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs)] // The names are the documentation: see `Field::name`.
pub enum Field {
    Mass,
    Inertia,
    RadiusRight,
    RadiusLeft,
    Track,
    WheelMatrix,
    K1,
    K2,
    K3,
    K4,
    K5,
    Kd1,
    Kd2,
    Kc1,
    Kc2,
    DecayA,
    UpperB,
    LowerD,
    MaxWheelTorque,
    MaxTick,
    CountsPerTurn,
    Bandwidth,
    MaxSpeed,
    MaxTurnRate,
    MaxAccel,
    MaxBrake,
    MaxTurnAccel,
    MaxJerk,
    MaxTurnJerk,
    AlongBound,
    SlowSpeed,
    ApproachBrake,
    SpeedLoop,
    TurnLoop,
    PoseNoise,
    ArrivalDistance,
    ArrivalHeading,
    ArrivalDwell,
    StallSpeed,
    StallTime,
    JumpDistance,
    JumpHeading,
    CalibrationRight,
    CalibrationLeft,
    CalibrationTrack,
    FixNoise,
    FixHeadingNoise,
    FixRate,
    FixBandwidth,
    FixHeadingBandwidth,
    FixGate,
    RelocaliseAfter,
    OdometryDrift,
    SlideSpeed,
    FixStale,
    GearRatio,
    GearEfficiency,
    TorqueConstant,
    Resistance,
    Supply,
    MaxCurrent,
    CoulombFriction,
    Stiction,
    ViscousFriction,
    FrictionBlend,
    DeadBand,
    MaxWheelSpeed,
    MinWheelSpeed,
    DriverLag,
    BrakeDamping,
    DisturbanceBandwidth,
    DisturbanceShare,
    TickPeriod,
    LateTick,
    LateRow,
    LateShare,
    LongTick,
    MeasurementTimeout,
    PoseTimeout,
    CommandTimeout,
    WheelLoad,
    StuckTorque,
    StuckSpeed,
    StuckTime,
    ReversedTime,
    SlipAccel,
    SlipSpeed,
    SlipTime,
    CurrentLimit,
    CurrentTime,
    SupplyLow,
    SupplyRecovered,
    SupplyTime,
    StopLimit,
    BrakeLimit,
    RestTime,
    RestSpeed,
    RestTurnRate,
}

impl Field {
    /// The parameter's name with its unit where the unit is not plain from the name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mass => "m",
            Self::Inertia => "I",
            Self::RadiusRight => "r_right",
            Self::RadiusLeft => "r_left",
            Self::Track => "l",
            Self::WheelMatrix => "B-bar",
            Self::K1 => "k1",
            Self::K2 => "k2",
            Self::K3 => "k3",
            Self::K4 => "k4",
            Self::K5 => "k5",
            Self::Kd1 => "kd1",
            Self::Kd2 => "kd2",
            Self::Kc1 => "kc1",
            Self::Kc2 => "kc2",
            Self::DecayA => "A",
            Self::UpperB => "B",
            Self::LowerD => "D",
            Self::MaxWheelTorque => "max_wheel_torque",
            Self::MaxTick => "max_tick",
            Self::CountsPerTurn => "counts_per_turn",
            Self::Bandwidth => "bandwidth",
            Self::MaxSpeed => "max_speed",
            Self::MaxTurnRate => "max_turn_rate",
            Self::MaxAccel => "max_accel",
            Self::MaxBrake => "max_brake",
            Self::MaxTurnAccel => "max_turn_accel",
            Self::MaxJerk => "max_jerk",
            Self::MaxTurnJerk => "max_turn_jerk",
            Self::AlongBound => "along_bound",
            Self::SlowSpeed => "slow",
            Self::ApproachBrake => "approach_brake",
            Self::SpeedLoop => "speed_loop",
            Self::TurnLoop => "turn_loop",
            Self::PoseNoise => "pose_noise",
            Self::ArrivalDistance => "arrival_distance",
            Self::ArrivalHeading => "arrival_heading",
            Self::ArrivalDwell => "arrival_dwell",
            Self::StallSpeed => "stall_speed",
            Self::StallTime => "stall_time",
            Self::JumpDistance => "jump_distance",
            Self::JumpHeading => "jump_heading",
            Self::CalibrationRight => "calibration_right",
            Self::CalibrationLeft => "calibration_left",
            Self::CalibrationTrack => "calibration_track",
            Self::FixNoise => "fix_noise",
            Self::FixHeadingNoise => "fix_heading_noise",
            Self::FixRate => "fix_rate",
            Self::FixBandwidth => "fix_bandwidth",
            Self::FixHeadingBandwidth => "fix_heading_bandwidth",
            Self::FixGate => "fix_gate",
            Self::RelocaliseAfter => "relocalise_after",
            Self::OdometryDrift => "odometry_drift",
            Self::SlideSpeed => "slide_m_s",
            Self::FixStale => "fix_stale",
            Self::GearRatio => "gear_ratio",
            Self::GearEfficiency => "gear_efficiency",
            Self::TorqueConstant => "torque_constant",
            Self::Resistance => "resistance",
            Self::Supply => "supply",
            Self::MaxCurrent => "max_current",
            Self::Stiction => "stiction",
            Self::CoulombFriction => "friction.coulomb",
            Self::ViscousFriction => "friction.viscous",
            Self::FrictionBlend => "friction.blend",
            Self::DeadBand => "dead_band",
            Self::MaxWheelSpeed => "max_wheel_speed",
            Self::MinWheelSpeed => "min_wheel_speed",
            Self::DriverLag => "driver_lag",
            Self::BrakeDamping => "brake_damping",
            Self::DisturbanceBandwidth => "disturbance",
            Self::DisturbanceShare => "disturbance_share",
            Self::TickPeriod => "tick_period",
            Self::LateTick => "late_tick",
            Self::LateRow => "late_row",
            Self::LateShare => "late_share",
            Self::LongTick => "long_tick",
            Self::MeasurementTimeout => "measurement_timeout",
            Self::PoseTimeout => "pose_timeout",
            Self::CommandTimeout => "command_timeout",
            Self::WheelLoad => "wheel_load",
            Self::StuckTorque => "stuck_torque",
            Self::StuckSpeed => "stuck_speed",
            Self::StuckTime => "stuck_time",
            Self::ReversedTime => "reversed_time",
            Self::SlipAccel => "slip_accel",
            Self::SlipSpeed => "slip_speed",
            Self::SlipTime => "slip_time",
            Self::CurrentLimit => "current_limit",
            Self::CurrentTime => "current_time",
            Self::SupplyLow => "supply_low",
            Self::SupplyRecovered => "supply_recovered",
            Self::SupplyTime => "supply_time",
            Self::StopLimit => "stop_limit",
            Self::BrakeLimit => "brake_limit",
            Self::RestTime => "rest_time",
            Self::RestSpeed => "rest_speed",
            Self::RestTurnRate => "rest_turn_rate",
        }
    }
}

/// What is wrong with a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// NaN or infinite.
    NotFinite,
    /// Below the smallest accepted value.
    Below(f64),
    /// Above the largest accepted value.
    Above(f64),
    /// The matrix of wheels and wrench cannot be inverted.
    Singular,
}

/// A parameter that `validate` refuses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamError {
    /// Which parameter.
    pub field: Field,
    /// Why, with the limit that was passed.
    pub problem: Problem,
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.field.name();
        match self.problem {
            Problem::NotFinite => write!(f, "{name} is not a finite number"),
            Problem::Below(limit) => write!(f, "{name} is below its smallest value {limit:e}"),
            Problem::Above(limit) => write!(f, "{name} is above its largest value {limit:e}"),
            Problem::Singular => write!(f, "{name} cannot be inverted"),
        }
    }
}

impl core::error::Error for ParamError {}

/// An input of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Input {
    /// The measured pose.
    Pose,
    /// The measured twist.
    Twist,
    /// The pose, twist or acceleration of the reference.
    Reference,
    /// The pose to park at.
    Goal,
    /// The measured time since the last tick.
    Tick,
    /// The acceleration that odometry is told of.
    Accel,
    /// The wheel torques that were really exerted.
    Applied,
}

/// A tick, or a start, that was refused. The controller's state is what it was before the call;
/// the caller makes the wheels safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StepFault {
    /// An input is NaN or infinite.
    NotFinite(Input),
    /// No time, or less than none, has passed since the last tick.
    TickNotPositive,
    /// More time than `max_tick` has passed since the last tick.
    TickTooLong {
        /// The limit that was passed \[µs\].
        max_tick_us: u32,
    },
    /// Tracking was asked of a controller that parks, or parking of one that tracks.
    WrongPhase,
    /// Finite inputs so large that a torque came out infinite or NaN.
    Overflow,
}

impl fmt::Display for StepFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(input) => write!(f, "{input:?} is not finite"),
            Self::TickNotPositive => f.write_str("elapsed time is not positive"),
            Self::TickTooLong { max_tick_us } => {
                write!(f, "elapsed time is above its limit of {max_tick_us} us")
            }
            Self::WrongPhase => f.write_str("the demand does not fit the phase"),
            Self::Overflow => f.write_str("the inputs are too large for a finite torque"),
        }
    }
}

impl core::error::Error for StepFault {}

/// What a stand-alone neuron refuses; its state is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum NeuronError {
    /// The state to start from is outside [−D, B] or not a number.
    OutOfBounds,
    /// The input is NaN or infinite.
    InputNotFinite,
    /// The elapsed time is NaN or below zero.
    TickNegative,
}

impl fmt::Display for NeuronError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OutOfBounds => "the neuron's state is outside [-D, B]",
            Self::InputNotFinite => "the neuron's input is not finite",
            Self::TickNegative => "the elapsed time is negative",
        })
    }
}

impl core::error::Error for NeuronError {}
