//! Everything that is to be known of a base: plain data, validated once and together.

use core::fmt;

use super::over_speed::OverSpeedLimits;
use crate::error::{Field, ParamError, Problem};
use crate::localiser::{LocaliserParams, ValidLocaliserParams};
use crate::maths::{Maths, Usual};
use crate::motion::{Limits, MotionGains, MotionParams, NOISE_HEADING_RAD, ValidMotionParams};
use crate::motor::{Driver, DriverParams, Motor, MotorParams, SpeedParams};
use crate::range::larger;
use crate::robot::Robot;
use crate::safety::supervisor::{SupervisorParams, ValidSupervisorParams};
use crate::safety::{
    DetectorParams, LEAST_STUCK_TORQUE_NM, PolicyError, PolicyParams, SLOW, StuckDetectorParams,
    SupplyDetectorParams, Timeout, ValidDetectorParams, ValidPolicyParams,
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
    /// What drives the wheels.
    pub driver: DriverParams<T>,
    /// Thresholds and timeouts.
    pub detectors: DetectorParams<T>,
    /// What is done about each kind of fault.
    pub policy: PolicyParams,
    /// How stops end.
    pub supervisor: SupervisorParams,
}

/// Wheel torque limit of a base whose drivers close their own speed loop \[N m\]: none. What they exert is not known, and a limit would set the command back for a
/// reason that does not exist: a wheel that is blocked or counts backward would be commanded what it does, and nobody would find it.
const ANY_TORQUE_NM: f64 = 1.0e5;

/// Share of the weight that friction in bearings and gear may be wherever no more is stated, in [`own_loop_breaks_loose`]: of small geared motors without load.
const FRICTION_SHARE: f64 = 0.2;

impl<T: Usual> BaseParams<T> {
    /// [`new_with`](Self::new_with) the usual mathematics of the number type.
    ///
    /// # Errors
    /// The localiser's parameters, on whose noise the others depend.
    pub fn new(
        robot: Robot<T>,
        limits: Limits<T>,
        localiser: LocaliserParams<T>,
        driver: DriverParams<T>,
        period_us: u32,
    ) -> Result<Self, ParamError> {
        Self::new_with::<T::Maths>(robot, limits, localiser, driver, period_us)
    }

    /// [`validate_with`](Self::validate_with) the usual mathematics of the number type.
    ///
    /// # Errors
    /// As [`validate_with`](Self::validate_with).
    pub fn validate(self) -> Result<ValidBaseParams<T>, BaseError> {
        self.validate_with::<T::Maths>()
    }
}

impl<T: Scalar> BaseParams<T> {
    /// What suits a base that ticks every `period_us`: gains and tolerances follow from limits and
    /// localisation, thresholds from the body, responses are the defaults.
    ///
    /// `robot` is what a scale and a ruler tell. The law and the detectors reckon with the robot as its wheels feel it, with the
    /// rotors of its motors ([`Robot::with_wheel_inertia`]); what slopes and pushes may be follows from the weight alone. The torque limit is not that of drivers that
    /// close their own speed loop: theirs is unknown.
    ///
    /// # Errors
    /// The localiser's parameters, on whose noise the others depend.
    pub fn new_with<M: Maths<T>>(
        robot: Robot<T>,
        limits: Limits<T>,
        localiser: LocaliserParams<T>,
        driver: DriverParams<T>,
        period_us: u32,
    ) -> Result<Self, ParamError> {
        let localisation = localiser.validate_with::<M>()?;
        let rotor = driver.motor().map(MotorParams::rotor_at_wheel_kg_m2);
        let with_rotors = robot.with_wheel_inertia(rotor.unwrap_or(T::ZERO));
        let limits = match &driver {
            DriverParams::Torques | DriverParams::Motors(_) => limits,
            DriverParams::Speeds(_) => Limits {
                wheel_torque_nm: T::from_f64(ANY_TORQUE_NM),
                ..limits
            },
        };
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
        if let Some(motor) = driver.motor() {
            detectors.supply = SupplyDetectorParams::for_nominal(motor.supply_v);
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
        if let DriverParams::Speeds(speeds) = &driver {
            let stuck = &mut detectors.wheels.stuck;
            stuck.torque_nm = T::ZERO;
            // What the driver does not execute turns no wheel.
            stuck.speed_rad_s = larger(stuck.speed_rad_s, speeds.min_speed_rad_s);
            stuck.after = own_loop_breaks_loose(speeds, stuck, &robot);
        }
        if let Some(fusion) = &localiser.fusion {
            // Ten fixes; odometry alone is worth a second.
            let us = fusion.stale_s * T::from_f64(1.0e6);
            detectors.pose = Timeout::AfterUs(larger_us(us, 1_000_000));
        }
        let base = Self {
            motion,
            localiser,
            driver,
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
    /// The first field out of range. [`Field::MaxWheelTorque`] also if the motors cannot exert it, [`Field::MaxRimSpeed`] if motors without load or
    /// drivers do not turn wheels so fast, [`Field::StuckTorque`] if it is not that of such drivers, [`Field::WheelMatrix`] if odometry has other
    /// wheels than the robot.
    pub fn validate_with<M: Maths<T>>(self) -> Result<ValidBaseParams<T>, BaseError> {
        let driver = self.driver.validate()?;
        // Torques that nobody knows push no wheel, and where they are known none of 0 does.
        let by_torque = self.detectors.wheels.stuck.torque_nm != T::ZERO;
        let problem = match (driver.speeds().is_some(), by_torque) {
            (true, true) => Some(Problem::Above(0.0)),
            (false, false) => Some(Problem::Below(LEAST_STUCK_TORQUE_NM)),
            _ => None,
        };
        if let Some(problem) = problem {
            let field = Field::StuckTorque;
            return Err(BaseError::Param(ParamError { field, problem }));
        }
        let motion = self.motion.validate()?;
        fits(&driver, &self.motion)?;
        let detectors = self.detectors.validate()?;
        Ok(ValidBaseParams {
            over_speed: OverSpeedLimits::of_base(&motion, &detectors),
            motion,
            localisation: self.localiser.validate_with::<M>()?.with_robot(
                &self.motion.robot,
                larger(self.motion.gains.turn_loop, self.motion.gains.speed_loop),
            )?,
            driver,
            detectors,
            policy: self.policy.validate()?,
            supervisor: self.supervisor.validate()?,
        })
    }
}

/// After what time a wheel stands that a driver with its own speed loop is to turn at [`SLOW`] times the slowest speed that is watched.
///
/// After twice the [way](SpeedParams::way_to_push_m) to what may hold it, for the driver may just have pushed the other way.
fn own_loop_breaks_loose<T: Scalar>(
    speeds: &SpeedParams<T>,
    stuck: &StuckDetectorParams<T>,
    robot: &Robot<T>,
) -> Timeout {
    let least = match stuck.after {
        Timeout::AfterUs(us) => us,
        Timeout::Off => return Timeout::Off,
    };
    let wheels = &robot.wheels;
    let radius = wheels.mean_radius_m();
    // On each wheel is half of the weight.
    let usual = T::from_f64(FRICTION_SHARE * 9.81) * T::HALF * robot.mass_kg * radius;
    let way = T::from_f64(2.0) * speeds.way_to_push_m(larger(speeds.breakaway_nm, usual), robot);
    let speed = T::from_f64(SLOW) * stuck.speed_rad_s * radius;
    Timeout::AfterUs(larger_us(T::from_f64(1.0e6) * (way / speed), least))
}

/// That drivers give what the limits ask of them.
// Apart: within its caller it takes a kilobyte more of flash.
#[inline(never)]
fn fits<T: Scalar>(driver: &Driver<T>, motion: &MotionParams<T>) -> Result<(), ParamError> {
    let limits = &motion.limits;
    let (torque_nm, wheel_rad_s) = match driver {
        Driver::Torques => return Ok(()),
        Driver::Motors(motor) => (motor.max_torque_nm(), motor.no_load_speed_rad_s()),
        Driver::Speeds(speeds) => (limits.wheel_torque_nm, speeds.params().max_speed_rad_s),
    };
    let rim_speed = wheel_rad_s * motion.robot.wheels.smaller_radius_m();
    let (field, most) = if limits.wheel_torque_nm > torque_nm {
        (Field::MaxWheelTorque, torque_nm)
    } else if limits.rim_speed > rim_speed {
        (Field::MaxRimSpeed, rim_speed)
    } else {
        return Ok(());
    };
    let problem = Problem::Above(most.to_f64());
    Err(ParamError { field, problem })
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
    pub(super) over_speed: OverSpeedLimits<T>,
    pub(super) localisation: ValidLocaliserParams<T>,
    pub(super) driver: Driver<T>,
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

    /// What drives the wheels.
    pub const fn driver(&self) -> &Driver<T> {
        &self.driver
    }

    /// The motors, if they are on bridges.
    pub const fn motor(&self) -> Option<&Motor<T>> {
        self.driver.motor()
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
