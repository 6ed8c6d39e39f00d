//! Parameters of the law for a real base: plain data, validated once.

use super::arrival::Arrival;
use super::gains::{MotionGains, NOISE_HEADING_RAD};
use super::lag::Lag;
use super::limits::Limits;
use super::load;
use super::manoeuvre::{AxisLimits, OffsetLimits, PLAN_SHARE, PlanLimits};
use super::observer_limits::ObserverLimits;
use super::turn_demand::TurnDemand;
use crate::error::{Field, ParamError};
use crate::maths::{Maths, Usual};
use crate::range::{check_ranges, larger, smaller};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::types::{Twist, Wrench};
use crate::wheels::WheelMap;

/// A change of the pose error in one tick beyond what the robot can have moved: a jump of the
/// localisation, or of the reference, that nobody declared.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JumpThreshold<T = f32> {
    /// \[m\], 1e-4 to 100; above the noise of the pose.
    pub distance_m: T,
    /// \[rad\], 1e-4 to 4; above the noise of the heading.
    pub heading_rad: T,
}

/// Everything that the controller needs to know of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionParams<T = f32> {
    /// Mass, inertia, wheels.
    pub robot: Robot<T>,
    /// What it can do.
    pub limits: Limits<T>,
    /// Gains; [`MotionGains::for_limits`] unless you know better.
    pub gains: MotionGains<T>,
    /// Standard deviation of the measured position \[m\], 0 to 1, per tick. Gains and tolerances that
    /// suit it: [`MotionParams::with_pose_noise`].
    pub pose_noise_m: T,
    /// When the robot has arrived, and when it is stuck.
    pub arrival: Arrival<T>,
    /// Jumps to be detected; `None` leaves it to the caller to declare them.
    pub jump: Option<JumpThreshold<T>>,
    /// Longest accepted time between ticks \[s\], 1e-6 to 1e3.
    pub max_tick_s: T,
}

impl<T: Usual> MotionParams<T> {
    /// [`new_with`](Self::new_with) the usual mathematics of the number type.
    pub fn new(robot: Robot<T>, limits: Limits<T>) -> Self {
        Self::new_with::<T::Maths>(robot, limits)
    }
}

impl<T: Scalar> MotionParams<T> {
    /// Parameters for a base, with gains that suit its limits, exact poses and ticks of 10 ms;
    /// [`for_period`](Self::for_period) has those for others.
    ///
    /// Where the wheels are too weak for the accelerations that the limits name, gains suit the wheels.
    pub fn new_with<M: Maths<T>>(robot: Robot<T>, limits: Limits<T>) -> Self {
        Self::for_period::<M>(robot, limits, T::from_f64(0.01))
    }

    /// The same for ticks of `period_s` \[s\].
    pub fn for_period<M: Maths<T>>(robot: Robot<T>, limits: Limits<T>, period_s: T) -> Self {
        Self {
            robot,
            limits,
            gains: MotionGains::for_limits::<M>(&within_reach(&robot, &limits), period_s),
            pose_noise_m: T::ZERO,
            arrival: Arrival::exact(),
            jump: None,
            max_tick_s: T::HALF,
        }
    }

    /// The same base with poses of this noise \[m, standard deviation per tick\], 0 to 1: sets
    /// `pose_noise_m` and what follows from it.
    ///
    /// * `gains.slow` so that following makes at most 0.03 rad of heading out of it.
    /// * The tolerance of arrival: 8 σ, which is the radius of 5 σ within which e_y is not corrected
    ///   and 3 σ for the pose that says so; and 0.02 rad, what the bearing's noise leaves of the heading.
    ///
    /// Larger values stay. 0 changes nothing.
    pub fn with_pose_noise(self, sigma_m: T) -> Self {
        let f = T::from_f64;
        let (mut gains, mut arrival) = (self.gains, self.arrival);
        if sigma_m > T::ZERO {
            gains.slow = larger(gains.slow_for(sigma_m, f(NOISE_HEADING_RAD)), gains.slow);
            arrival.distance_m = larger(f(8.0) * sigma_m, arrival.distance_m);
            arrival.heading_rad = larger(f(0.02), arrival.heading_rad);
        }
        Self {
            gains,
            arrival,
            pose_noise_m: sigma_m,
            ..self
        }
    }

    /// Checks every field and works out what follows from them.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed.
    pub fn validate(self) -> Result<ValidMotionParams<T>, ParamError> {
        let f = T::from_f64;
        self.robot.check()?;
        let wheels = WheelMap::from_geometry(&self.robot.wheels)?;
        self.limits.check()?;
        self.gains.check()?;
        self.arrival.check()?;
        check_ranges![(Field::PoseNoise, self.pose_noise_m, 0.0, 1.0)]?;
        if let Some(jump) = &self.jump {
            check_ranges![
                (Field::JumpDistance, jump.distance_m, 1.0e-4, 100.0),
                (Field::JumpHeading, jump.heading_rad, 1.0e-4, 4.0),
            ]?;
        }
        check_ranges![(Field::MaxTick, self.max_tick_s, 1.0e-6, 1.0e3)]?;
        let gains = &self.gains;
        // At 5 standard deviations the direction to the goal is known to 0.2 rad; without noise
        // 0.3 mm keeps the direction out of the last rounding of single precision.
        let noise_radius = f(5.0) * self.pose_noise_m;
        let least = f(3.0e-4);
        let noisy = noise_radius > least;
        let bound = gains.disturbance_share * largest_force(&self);
        let approach_decay = gains.approach_decay();
        Ok(ValidMotionParams {
            params: self,
            wheels,
            disturbance: Wrench {
                force: bound,
                moment: T::HALF * self.robot.wheels.track_m * bound,
            },
            loops: (
                self.robot.mass_kg * gains.speed_loop,
                self.robot.inertia_kg_m2 * gains.turn_loop,
            ),
            command_torque_nm: self.limits.command_torque_nm(),
            lateral: gains.lateral / gains.heading,
            gentle: smaller(self.limits.accel, self.limits.brake),
            observer: ObserverLimits::of(&self.limits),
            near: if noisy { noise_radius } else { least },
            noisy,
            along: Lag::new(gains.decay, gains.longitudinal_bound)?,
            across: Lag::new(gains.decay, f(STEEPEST_APPROACH))?,
            around: Lag::new(gains.decay, f(1.5))?,
            approach_decay,
            approach: Lag::new(approach_decay, f(4.0) * gains.approach)?,
            turn: Lag::new(approach_decay, f(4.0))?,
            plan: plan_limits(&self),
            turning: TurnDemand::new(
                gains.heading,
                within_reach(&self.robot, &self.limits).turn_accel,
            ),
        })
    }
}

/// The largest force that the wheels exert \[N\].
fn largest_force<T: Scalar>(params: &MotionParams<T>) -> T {
    params.robot.wheels.force_n(params.limits.wheel_torque_nm)
}

/// Acceleration \[m/s²\] and angular acceleration \[rad/s²\] that the wheels have to give to a command.
pub(crate) fn reach<T: Scalar>(robot: &Robot<T>, limits: &Limits<T>) -> (T, T) {
    let wheels = &robot.wheels;
    let force = wheels.force_n(limits.command_torque_nm());
    let moment = T::HALF * wheels.track_m * force;
    (force / robot.mass_kg, moment / robot.inertia_kg_m2)
}

/// The limits with no more acceleration than the wheels have to give to a command.
fn within_reach<T: Scalar>(robot: &Robot<T>, limits: &Limits<T>) -> Limits<T> {
    let (linear, angular) = reach(robot, limits);
    // Parameters that are not checked yet: a reach that is not a number limits nothing.
    Limits {
        accel: smaller(linear, limits.accel),
        brake: smaller(linear, limits.brake),
        turn_accel: smaller(angular, limits.turn_accel),
        ..*limits
    }
}

/// B, the bound of the following law's s₂ and of its input \[rad\]: a lateral error asks for sin e_θ = −B/2 at most, 45°. There
/// cos e_θ leaves the heading loop 0.7 of k₃; from 2 on the heading would be a quarter turn, and it had none left.
const STEEPEST_APPROACH: f64 = core::f64::consts::SQRT_2;

/// What of a limit a plan leaves, as a share of what it uses.
const PLAN_LEAVES: f64 = 1.0 / PLAN_SHARE - 1.0;

/// What a parking manoeuvre may use: its share of the limits, and no more than the wheels give to a command
/// that drives and turns at once.
fn plan_limits<T: Scalar>(params: &MotionParams<T>) -> PlanLimits<T> {
    let (robot, limits) = (&params.robot, &params.limits);
    let wheels = &robot.wheels;
    let radius = larger(wheels.radius_right_m, wheels.radius_left_m);
    let driving = T::HALF * robot.mass_kg * larger(limits.accel, limits.brake);
    let turning = robot.inertia_kg_m2 * limits.turn_accel / wheels.track_m;
    let needed = radius * (driving + turning);
    let torque = limits.command_torque_nm();
    let share = T::from_f64(PLAN_SHARE);
    let accel = if needed > torque {
        share * torque / needed
    } else {
        share
    };
    let axis = |rate: T, up: T, down: T, jerk: T| AxisLimits {
        rate: share * rate,
        up: accel * up,
        down: accel * down,
        jerk_s: accel * larger(up, down) / (share * jerk),
    };
    PlanLimits {
        drive: axis(limits.speed, limits.accel, limits.brake, limits.jerk),
        turn: axis(
            limits.turn_rate,
            limits.turn_accel,
            limits.turn_accel,
            limits.turn_jerk,
        ),
        rim: share * limits.rim_speed,
        half_track: T::HALF * wheels.track_m,
    }
}

/// [`MotionParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidMotionParams<T = f32> {
    params: MotionParams<T>,
    pub(crate) wheels: WheelMap<T>,
    /// Distance to the goal below which its direction is noise \[m\].
    pub(crate) near: T,
    /// It is the poses' noise that says so.
    pub(crate) noisy: bool,
    /// Largest disturbance that is compensated.
    pub(crate) disturbance: Wrench<T>,
    /// m κ₁ and I κ₂ of the velocity loops \[N s/m, N m s/rad\].
    pub(crate) loops: (T, T),
    /// Torque of a wheel that a command may use \[N m\].
    pub(crate) command_torque_nm: T,
    /// c/k₃ of the neuron of e_y; see [`Follower`](super::follow::Follower).
    pub(crate) lateral: T,
    /// The smaller one of acceleration and braking \[m/s²\].
    pub(crate) gentle: T,
    /// Of the estimates of disturbance and load.
    pub(crate) observer: ObserverLimits<T>,
    /// Neuron of e_x while following \[m/s\].
    pub(crate) along: Lag<T>,
    /// Neuron of e_y while following \[rad\].
    pub(crate) across: Lag<T>,
    /// Neuron that turns a robot which looks back \[1\].
    pub(crate) around: Lag<T>,
    /// Decay of the two neurons of parking by feedback \[1/s\].
    pub(crate) approach_decay: T,
    /// Neuron of the distance while parking by feedback \[m/s\].
    pub(crate) approach: Lag<T>,
    /// Neuron of the bearing while parking by feedback \[rad/s\].
    pub(crate) turn: Lag<T>,
    /// What a parking manoeuvre may use.
    pub(crate) plan: PlanLimits<T>,
    /// Of the follower's heading.
    pub(crate) turning: TurnDemand<T>,
}

impl<T: Scalar> ValidMotionParams<T> {
    /// The parameters as they were given.
    pub fn params(&self) -> &MotionParams<T> {
        &self.params
    }

    /// The gains in use.
    pub fn gains(&self) -> &MotionGains<T> {
        &self.params.gains
    }

    /// What setting an offset of a manoeuvre may ask for.
    pub(super) fn offset_limits(&self) -> OffsetLimits<T> {
        OffsetLimits {
            turn_accel: T::from_f64(PLAN_LEAVES) * self.plan.turn.up,
            drive_accel: self.plan.drive.up,
            heading: self.params.gains.heading,
            // What noise leaves is four times as large and more; as squares add up, this is nothing beside it.
            least: T::from_f64(0.1) * self.params.arrival.distance_m,
        }
    }

    /// Of what nobody has stated, how much may be made up for at each wheel \[N m\]: what [`Self::disturbance`] is made of.
    pub(crate) fn unknown_torque_nm(&self) -> T {
        self.params.gains.disturbance_share * self.params.limits.wheel_torque_nm
    }

    /// The map between wrench and wheel torques.
    pub fn wheels(&self) -> &WheelMap<T> {
        &self.wheels
    }

    /// A twist within the limits: each axis by itself, then both by one factor, for the wheels' rims.
    pub(crate) fn reachable(&self, twist: &Twist<T>) -> Twist<T> {
        let params = &self.params;
        params.limits.reachable(twist, params.robot.wheels.track_m)
    }

    /// L of the force \[N/s\], before the wheels' limit: whatever happens, jumps included, it changes
    /// by at most L dt in a tick. m ((1 + 2 σ) jerk + κ₁ (a_max + F/m)) + ω D, with F/m the largest acceleration
    /// that the wheels can make, D the largest disturbance that is compensated, and σ = 0.4 the largest [`Load`](super::Load):
    /// what is fed forward for it changes with the acceleration, and as fast again while it is learnt.
    pub fn force_rate_limit(&self) -> T {
        let limits = &self.params.limits;
        let accel = larger(limits.accel, limits.brake);
        let mass = self.params.robot.mass_kg;
        let loop_rate = self.gains().speed_loop;
        mass * (fed_forward(limits.jerk) + loop_rate * (accel + self.largest_force() / mass))
            + self.gains().disturbance * self.disturbance.force
    }

    /// L of the moment \[N m/s\]; see [`ValidMotionParams::force_rate_limit`].
    pub fn moment_rate_limit(&self) -> T {
        let limits = &self.params.limits;
        let inertia = self.params.robot.inertia_kg_m2;
        let loop_rate = self.gains().turn_loop;
        inertia
            * (fed_forward(limits.turn_jerk)
                + loop_rate * (limits.turn_accel + self.largest_moment() / inertia))
            + self.gains().disturbance * self.disturbance.moment
    }

    /// The largest force that the wheels exert \[N\].
    pub fn largest_force(&self) -> T {
        largest_force(&self.params)
    }

    /// The largest disturbance that is compensated.
    pub fn disturbance_bound(&self) -> &Wrench<T> {
        &self.disturbance
    }

    /// The largest moment that the wheels exert \[N m\].
    pub fn largest_moment(&self) -> T {
        T::HALF * self.params.robot.wheels.track_m * self.largest_force()
    }
}

/// Largest rate of what is fed forward for a `jerk` of the command.
fn fed_forward<T: Scalar>(jerk: T) -> T {
    T::from_f64(1.0 + 2.0 * load::LARGEST) * jerk
}
