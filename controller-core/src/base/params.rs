//! Everything that is to be known of a base: plain data, validated once and together.

use core::fmt;

use crate::error::{Field, ParamError, Problem};
use crate::localiser::{LocaliserParams, ValidLocaliserParams};
use crate::maths::{Maths, Usual};
use crate::motion::{Limits, MotionGains, MotionParams, NOISE_HEADING_RAD, ValidMotionParams};
use crate::motor::{Motor, MotorParams};
use crate::range::larger;
use crate::robot::Robot;
use crate::safety::supervisor::{SupervisorParams, ValidSupervisorParams};
use crate::safety::{
    DetectorParams, PolicyError, PolicyParams, SupplyDetectorParams, Timeout, ValidDetectorParams,
    ValidPolicyParams,
};
use crate::scalar::{Scalar, seconds};

/// Parameters of all parts of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BaseParams<T = f32> {
    /// The motion law.
    pub motion: MotionParams<T>,
    /// Odometry and external poses.
    pub localiser: LocaliserParams<T>,
    /// Motors on bridges; `None` where the driver takes torques itself.
    pub motor: Option<MotorParams<T>>,
    /// Thresholds and timeouts.
    pub detectors: DetectorParams<T>,
    /// What is done about each kind of fault.
    pub policy: PolicyParams,
    /// How stops end.
    pub supervisor: SupervisorParams,
}

/// A motor's supply is too low below this share of its nominal voltage, and good again above the other.
/// Lead and lithium batteries are empty at 0.8 to 0.85 and sag by a tenth under load.
const LOW_SUPPLY: (f64, f64) = (0.7, 0.75);

impl<T: Usual> BaseParams<T> {
    /// [`new_with`](Self::new_with) the usual mathematics of the number type.
    ///
    /// # Errors
    /// The localiser's parameters, on whose noise the others depend.
    pub fn new(
        robot: Robot<T>,
        limits: Limits<T>,
        localiser: LocaliserParams<T>,
        motor: Option<MotorParams<T>>,
        period_us: u32,
    ) -> Result<Self, ParamError> {
        Self::new_with::<T::Maths>(robot, limits, localiser, motor, period_us)
    }

    /// [`validate_with`](Self::validate_with) the usual mathematics of the number type.
    ///
    /// # Errors
    /// The first field out of range. [`Field::MaxWheelTorque`] also if the motors cannot exert it.
    pub fn validate(self) -> Result<ValidBaseParams<T>, BaseError> {
        self.validate_with::<T::Maths>()
    }
}

impl<T: Scalar> BaseParams<T> {
    /// What suits a base that ticks every `period_us`: gains and tolerances follow from limits and
    /// localisation, thresholds from the body, responses are the defaults.
    ///
    /// `robot` is what a scale and a ruler tell. The law and the detectors reckon with the robot as its wheels feel it, with the
    /// rotors of its motors ([`Robot::with_wheel_inertia`]); what slopes and pushes may be follows from the weight alone.
    ///
    /// # Errors
    /// The localiser's parameters, on whose noise the others depend.
    pub fn new_with<M: Maths<T>>(
        robot: Robot<T>,
        limits: Limits<T>,
        localiser: LocaliserParams<T>,
        motor: Option<MotorParams<T>>,
        period_us: u32,
    ) -> Result<Self, ParamError> {
        let localisation = localiser.validate_with::<M>()?;
        let rotor = motor.as_ref().map(MotorParams::rotor_at_wheel_kg_m2);
        let with_rotors = robot.with_wheel_inertia(rotor.unwrap_or(T::ZERO));
        let motion = MotionParams {
            pose_noise_m: localisation.pose_noise_m(),
            arrival: localisation.arrival(),
            ..MotionParams::for_period::<M>(with_rotors, limits, seconds(period_us))
        };
        let counts_per_turn = localiser.odometry.counts_per_turn;
        let body = MotionParams { robot, ..motion };
        let mut detectors = DetectorParams {
            robot: with_rotors,
            ..DetectorParams::for_base(&body, counts_per_turn, period_us)
        };
        if let Some(motor) = &motor {
            detectors.supply = SupplyDetectorParams {
                low_v: T::from_f64(LOW_SUPPLY.0) * motor.supply_v,
                recovered_v: T::from_f64(LOW_SUPPLY.1) * motor.supply_v,
                // Longer than the current of a start from rest.
                after: Timeout::AfterUs(500_000),
            };
            // A controller limits the current by itself; a tenth more is a driver that does not.
            detectors.current.limit_a = T::from_f64(1.1) * motor.max_current_a;
            detectors.current.after = Timeout::AfterUs(200_000);
            // What breaks a wheel loose is up to twice its friction while it turns, and only that is fed
            // forward: the rest is no sign of a wheel that is stuck. Nor may feeble motors be commanded more
            // than they have.
            let most = T::from_f64(0.9) * limits.wheel_torque_nm;
            let loose = detectors.wheels.stuck.torque_nm + motor.friction.coulomb_nm;
            detectors.wheels.stuck.torque_nm = if loose < most { loose } else { most };
        }
        if let Some(fusion) = &localiser.fusion {
            // Ten fixes; odometry alone is worth a second.
            let us = fusion.stale_s * T::from_f64(1.0e6);
            detectors.pose = Timeout::AfterUs(larger_us(us, 1_000_000));
        }
        let base = Self {
            motion,
            localiser,
            motor,
            detectors,
            policy: PolicyParams::DEFAULT,
            supervisor: SupervisorParams {
                parked: motion.arrival.at_rest,
                ..SupervisorParams::DEFAULT
            },
        };
        Ok(base.with_gains(motion.gains))
    }

    /// The same base with gains of its own. `slow` becomes no less than what noise asks for
    /// ([`MotionParams::with_pose_noise`]) and, where poses are corrected on the way, what the arrival does: a
    /// lateral error of half of what is tolerated at the goal, the mean of those that are, may turn the robot by
    /// no more than is tolerated there. In the last centimetres nothing turns it back in time.
    pub fn with_gains(self, gains: MotionGains<T>) -> Self {
        let MotionParams {
            arrival,
            pose_noise_m,
            ..
        } = self.motion;
        let quiet = gains.slow_for(pose_noise_m, T::from_f64(NOISE_HEADING_RAD));
        let tolerated = match &self.localiser.fusion {
            Some(_) => gains.slow_for(T::HALF * arrival.distance_m, arrival.heading_rad),
            None => T::ZERO,
        };
        let mut base = self;
        base.motion.gains = MotionGains {
            slow: larger(tolerated, larger(quiet, gains.slow)),
            ..gains
        };
        base
    }

    /// Checks every part, and that they fit each other.
    ///
    /// # Errors
    /// The first field out of range. [`Field::MaxWheelTorque`] also if the motors cannot exert it.
    pub fn validate_with<M: Maths<T>>(self) -> Result<ValidBaseParams<T>, BaseError> {
        let motor = match self.motor {
            Some(params) => Some(params.validate()?),
            None => None,
        };
        if let Some(motor) = &motor {
            let most = motor.max_torque_nm();
            if self.motion.limits.wheel_torque_nm > most {
                return Err(BaseError::Param(ParamError {
                    field: Field::MaxWheelTorque,
                    problem: Problem::Above(most.to_f64()),
                }));
            }
        }
        Ok(ValidBaseParams {
            motion: self.motion.validate()?,
            localisation: self.localiser.validate_with::<M>()?.with_robot(
                &self.motion.robot,
                larger(self.motion.gains.turn_loop, self.motion.gains.speed_loop),
            )?,
            motor,
            detectors: self.detectors.validate()?,
            policy: self.policy.validate()?,
            supervisor: self.supervisor.validate()?,
        })
    }
}

/// The larger of a time \[µs\] and a least one; a time that is no number is the least one.
fn larger_us<T: Scalar>(us: T, least: u32) -> u32 {
    let us = us.to_f64();
    if us > f64::from(least) && us < 4.0e9 {
        us as u32
    } else {
        least
    }
}

/// [`BaseParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidBaseParams<T = f32> {
    pub(super) motion: ValidMotionParams<T>,
    pub(super) localisation: ValidLocaliserParams<T>,
    pub(super) motor: Option<Motor<T>>,
    pub(super) detectors: ValidDetectorParams<T>,
    pub(super) policy: ValidPolicyParams,
    pub(super) supervisor: ValidSupervisorParams,
}

impl<T: Scalar> ValidBaseParams<T> {
    /// The motion law's parameters.
    pub const fn motion(&self) -> &ValidMotionParams<T> {
        &self.motion
    }

    /// The localiser's.
    pub const fn localisation(&self) -> &ValidLocaliserParams<T> {
        &self.localisation
    }

    /// The motors', if they are on bridges.
    pub const fn motor(&self) -> Option<&Motor<T>> {
        self.motor.as_ref()
    }

    /// The responses to faults.
    pub const fn policy(&self) -> &ValidPolicyParams {
        &self.policy
    }

    /// The monitor's thresholds.
    pub const fn detectors(&self) -> &ValidDetectorParams<T> {
        &self.detectors
    }
}

/// Why parameters of a base are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BaseError {
    /// A field.
    Param(ParamError),
    /// A response to a fault.
    Policy(PolicyError),
}

impl From<ParamError> for BaseError {
    fn from(error: ParamError) -> Self {
        Self::Param(error)
    }
}

impl From<PolicyError> for BaseError {
    fn from(error: PolicyError) -> Self {
        Self::Policy(error)
    }
}

impl fmt::Display for BaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Param(error) => error.fmt(f),
            Self::Policy(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for BaseError {}
