//! Pose and twist from wheel encoders.

use crate::error::{Field, ParamError};
use crate::hal::WheelCounts;
use crate::maths::Maths;
use crate::range::{check_ranges, smaller};
use crate::reference::sinc;
use crate::scalar::Scalar;
use crate::types::{Accel, Measured, Pose, Twist, WheelSpeeds};
use crate::wheels::WheelGeometry;

mod slip;
mod speed;
pub(crate) use slip::{Tyres, drift_angle};
use speed::{Turned, Wheel};

/// What a calibration run found, as factors on the nominal lengths; 1 where it found nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Calibration<T = f32> {
    /// On the right wheel's radius, 0.5 to 2.
    pub right: T,
    /// On the left wheel's radius, 0.5 to 2.
    pub left: T,
    /// On the distance of the wheels, 0.5 to 2: wide tyres roll about a point that no ruler finds.
    pub track: T,
}

impl<T: Scalar> Calibration<T> {
    /// The lengths as they were measured with a ruler.
    pub const NOMINAL: Self = Self {
        right: T::ONE,
        left: T::ONE,
        track: T::ONE,
    };
}

impl<T: Scalar> Default for Calibration<T> {
    fn default() -> Self {
        Self::NOMINAL
    }
}

/// What odometry needs to know of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OdometryParams<T = f32> {
    /// Nominal radii and distance of the wheels.
    pub wheels: WheelGeometry<T>,
    /// What they turned out to be.
    pub calibration: Calibration<T>,
    /// Encoder counts per turn of a wheel, after gears and quadrature: 1 to 1e7.
    pub counts_per_turn: T,
    /// Bandwidth of the speed estimate \[rad/s\], 1 to 1e4. Its delay is [`OdometryParams::delay_s`].
    pub bandwidth: T,
}

impl<T: Scalar> OdometryParams<T> {
    /// Delay of the speed estimate for accelerations that it does not know of \[s\]: 2/bandwidth.
    pub fn delay_s(&self) -> T {
        (T::ONE + T::ONE) / self.bandwidth
    }

    /// Largest travel of a wheel per count \[m\].
    pub fn travel_per_count_m(&self) -> T {
        let right = self.wheels.radius_right_m * self.calibration.right;
        let left = self.wheels.radius_left_m * self.calibration.left;
        (T::PI + T::PI) / self.counts_per_turn * if right > left { right } else { left }
    }

    /// Distance of the wheels, calibrated \[m\].
    pub fn track_m(&self) -> T {
        self.wheels.track_m * self.calibration.track
    }

    pub(crate) fn check(&self) -> Result<(), ParamError> {
        let calibration = &self.calibration;
        self.wheels.check()?;
        check_ranges![
            (Field::CalibrationRight, calibration.right, 0.5, 2.0),
            (Field::CalibrationLeft, calibration.left, 0.5, 2.0),
            (Field::CalibrationTrack, calibration.track, 0.5, 2.0),
            (Field::CountsPerTurn, self.counts_per_turn, 1.0, 1.0e7),
            (Field::Bandwidth, self.bandwidth, 1.0, 1.0e4),
        ]
    }
}

/// What odometry has to add to what wheels count, as a localiser has learnt it: they are not as large, or not as far apart, as
/// stated, or their tyres slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Biases<T> {
    /// Turn per way \[rad/m\].
    pub(crate) per_way: T,
    /// Turn per turn \[rad/rad\].
    pub(crate) per_turn: T,
    /// κ, the tyres' slip per acceleration \[s²/m\], at least 0; see [`slip`].
    pub(crate) slip: T,
}

impl<T: Scalar> Biases<T> {
    /// Nothing learnt.
    pub(crate) const NONE: Self = Self {
        per_way: T::ZERO,
        per_turn: T::ZERO,
        slip: T::ZERO,
    };
}

/// What the wheels did between two calls.
pub(crate) struct Moved<T> {
    /// Counts, right and left.
    counts: (i32, i32),
    /// Ways of the rims, right and left \[m\].
    rims: (T, T),
    /// Way of the middle \[m\].
    pub(crate) travel: T,
    /// \[rad\].
    pub(crate) turn: T,
    /// What tyres that slip by 1 s²/m lose of that turn \[rad m/s²\].
    pub(crate) turn_lost: T,
}

/// Accelerations of the robot since the last call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Accelerations<T> {
    /// By the torques.
    pub(crate) exerted: Accel<T>,
    /// By what acts beside them, as a disturbance estimate has it: for a robot that creeps. Odometry learns by itself what it can.
    pub(crate) disturbance: Option<Accel<T>>,
}

impl<T: Scalar> Accelerations<T> {
    /// Of a robot whose disturbance nobody estimates.
    pub(crate) const fn exerted(exerted: Accel<T>) -> Self {
        Self {
            exerted,
            disturbance: None,
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        let disturbance = self.disturbance.as_ref().map_or(T::ZERO, Accel::residue);
        self.exerted.residue() + disturbance == T::ZERO
    }
}

impl<T: Scalar> Moved<T> {
    /// Neither wheel came further than `most_m` \[m\].
    pub(crate) fn is_within(&self, most_m: T) -> bool {
        self.rims.0.abs() <= most_m && self.rims.1.abs() <= most_m
    }

    /// Whether the right and the left wheel moved by a count.
    pub(crate) const fn counted(&self) -> (bool, bool) {
        (self.counts.0 != 0, self.counts.1 != 0)
    }
}

/// Integrates encoder counts to a pose along exact arcs and estimates the twist.
///
/// The pose error of one step is zero for wheels that turn at constant rates in between. The speed
/// estimate has no steady error at constant speed and no ripple either, at a count in many ticks as
/// well as at many in one. Changes of speed that no known acceleration explains arrive 2/bandwidth late at first, or
/// 1.3 times the time between counts, where that is longer, and those that last in time: what causes them is learnt; a wheel that has stopped reads at
/// most one count per time since the next was due, and soon exactly 0. A torque that friction holds moves nothing:
/// an acceleration that a missing count refutes is not believed until the wheel rolls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry<T> {
    right_per_count: T,
    left_per_count: T,
    track: T,
    bandwidth: T,
    counts: WheelCounts,
    right: Wheel<T>,
    left: Wheel<T>,
    pose: Pose<T>,
    /// What rounding has taken off that.
    lost: Pose<T>,
    /// Turn per way that the right wheel is ahead of the left one \[rad/m\], learnt bias included.
    turn_per_lead: T,
    /// Turn to add per way \[rad/m\].
    curvature_bias: T,
    /// κ of [`slip`] \[s²/m\].
    slip: T,
    /// Angle that a wheel turns per travel of its rim \[rad/m\]: right, left.
    per_metre: (T, T),
}

impl<T: Scalar> Odometry<T> {
    /// Starts at rest at `pose`, with the encoders at `counts`.
    ///
    /// # Errors
    /// The first parameter out of its range.
    pub fn new(
        params: &OdometryParams<T>,
        pose: Pose<T>,
        counts: WheelCounts,
    ) -> Result<Self, ParamError> {
        params.check()?;
        Ok(Self::of_checked(params, pose, counts))
    }

    /// [`Odometry::new`] of parameters that were checked before.
    pub(crate) fn of_checked(
        params: &OdometryParams<T>,
        pose: Pose<T>,
        counts: WheelCounts,
    ) -> Self {
        let (wheels, calibration) = (&params.wheels, &params.calibration);
        let radians_per_count = (T::PI + T::PI) / params.counts_per_turn;
        let right_m = wheels.radius_right_m * calibration.right;
        let left_m = wheels.radius_left_m * calibration.left;
        let track = params.track_m();
        Self {
            right_per_count: right_m * radians_per_count,
            left_per_count: left_m * radians_per_count,
            per_metre: (T::ONE / right_m, T::ONE / left_m),
            track,
            turn_per_lead: T::ONE / track,
            bandwidth: params.bandwidth,
            counts,
            right: Wheel::default(),
            left: Wheel::default(),
            pose,
            lost: Pose::default(),
            curvature_bias: T::ZERO,
            slip: T::ZERO,
        }
    }

    /// Starts what was not updated yet elsewhere.
    pub(crate) fn begin(&mut self, pose: Pose<T>, counts: WheelCounts) {
        self.set_pose(pose);
        self.counts = counts;
    }

    /// From now on the encoders count from elsewhere: these counts are what wheels of the present speeds come to `dt` \[s\] after the last call.
    #[cold]
    #[inline(never)]
    pub(crate) fn count_from(&mut self, counts: WheelCounts, dt: T) {
        let before = |counts: i32, wheel: &Wheel<T>, per_count: T| {
            let way = (dt * wheel.speed().abs() / per_count).to_u32();
            if wheel.speed() < T::ZERO {
                counts.wrapping_add_unsigned(way)
            } else {
                counts.wrapping_sub_unsigned(way)
            }
        };
        self.counts = WheelCounts {
            right: before(counts.right, &self.right, self.right_per_count),
            left: before(counts.left, &self.left, self.left_per_count),
        };
    }

    /// Moves the pose by what the wheels turned since the last call, `dt` > 0 \[s\] ago.
    ///
    /// Along an arc with turn φ the chord is d · sin(φ/2)/(φ/2) in direction θ + φ/2: Eq. (6) again.
    /// Counts wrap; a wheel turns less than 2³¹ counts between calls.
    pub fn update<M: Maths<T>>(&mut self, counts: WheelCounts, dt: T) -> Measured<T> {
        self.update_with_accel::<M>(counts, dt, &Accel::default())
    }

    /// [`update`](Self::update) for a robot that was accelerated by `accel` (finite) since the last call.
    ///
    /// That is what the torques of that time do to it: force over mass, moment over inertia. The speed
    /// estimate then lags only what this leaves out, friction, slopes and wrong masses, until it has learnt them; a velocity
    /// loop sees its own torques without delay (the observer's poles and the loop's do not mix), and
    /// `bandwidth` may be as low as disturbances allow.
    pub fn update_with_accel<M: Maths<T>>(
        &mut self,
        counts: WheelCounts,
        dt: T,
        accel: &Accel<T>,
    ) -> Measured<T> {
        // Of its tyres nobody has learnt anything.
        let (strain, most_s) = (Accel::default(), Tyres::RIGID.most_s);
        let rolled = self.roll(counts, &strain);
        let turn = rolled.turn;
        let accelerations = Accelerations::exerted(*accel);
        self.integrate::<M>(&rolled, turn, dt, &accelerations, (&strain, most_s))
            .0
    }

    /// What the wheels did since the last call, what is learnt of them included; `strain` is that of their tyres.
    pub(crate) fn roll(&mut self, counts: WheelCounts, strain: &Accel<T>) -> Moved<T> {
        let moved = (
            counts.right.wrapping_sub(self.counts.right),
            counts.left.wrapping_sub(self.counts.left),
        );
        self.counts = counts;
        let right = T::from_i32(moved.0) * self.right_per_count;
        let left = T::from_i32(moved.1) * self.left_per_count;
        let travel = T::HALF * (right + left);
        let turn = self.turn_per_lead * (right - left) + self.curvature_bias * travel;
        let way = travel.abs();
        let turn_lost = way * strain.angular;
        Moved {
            counts: moved,
            rims: (right, left),
            travel: travel - self.slip * (way * strain.linear),
            turn: turn - self.slip * turn_lost,
            turn_lost,
        }
    }

    /// Moves the pose by what the wheels did, with the turn `turn` \[rad\]: theirs, or one that is known better. Of the twist tyres under
    /// this strain lose no more than the other says. The chord of that
    /// \[m\], backward negative, comes with it.
    #[inline(always)]
    pub(crate) fn integrate<M: Maths<T>>(
        &mut self,
        rolled: &Moved<T>,
        turn: T,
        dt: T,
        accelerations: &Accelerations<T>,
        (strain, most_s): (&Accel<T>, T),
    ) -> (Measured<T>, T) {
        let (moved, travel) = (rolled.counts, rolled.travel);
        let lever = T::HALF * self.track;
        let rims = |accel: &Accel<T>| {
            let rim = lever * accel.angular;
            (accel.linear + rim, accel.linear - rim)
        };
        let exerted = rims(&accelerations.exerted);
        let disturbance = accelerations.disturbance.as_ref().map(rims);
        let right = Turned {
            counts: moved.0,
            per_count: self.right_per_count,
            accel: exerted.0,
            disturbance: disturbance.map(|rim| rim.0),
            dt,
        };
        let left = Turned {
            counts: moved.1,
            per_count: self.left_per_count,
            accel: exerted.1,
            disturbance: disturbance.map(|rim| rim.1),
            dt,
        };
        let right = self.right.track(&right, self.bandwidth);
        let left = self.left.track(&left, self.bandwidth);
        let linear = T::HALF * (right + left);
        let slips = smaller(self.slip * linear.abs(), most_s);
        let twist = Twist {
            linear: linear - slips * strain.linear,
            angular: self.turn_per_lead * (right - left) + self.curvature_bias * linear
                - slips * strain.angular,
        };
        let half_turn = T::HALF * turn;
        let course = self.pose.theta + half_turn + drift_angle(self.slip, &twist);
        let (sine, cosine) = M::sin_cos(course);
        let chord = travel * sinc::<T, M>(half_turn);
        let step = Pose {
            x: chord * cosine,
            y: chord * sine,
            theta: turn,
        };
        self.pose.advance(&step, &mut self.lost);
        let measured = Measured {
            pose: self.pose,
            twist,
        };
        (measured, chord)
    }

    /// From now on adds this.
    pub(crate) fn set_biases(&mut self, biases: &Biases<T>) {
        self.curvature_bias = biases.per_way;
        self.turn_per_lead = (T::ONE + biases.per_turn) / self.track;
        self.slip = biases.slip;
    }

    /// Speeds of the wheels for which a motor layer is to make up the back-EMF \[rad/s\]: as the encoders have them (what a learnt
    /// bias adds to the turn rate is no turning of a motor), without what the wheels have just lost to unmodelled
    /// forces. A wheel that friction slows gets more voltage by it.
    pub fn back_emf_speeds(&self) -> WheelSpeeds<T> {
        self.back_emf_speeds_of(T::ZERO)
    }

    /// The same where the motor constant of the right wheel is above what is stated by the share `unlike`, that of the left one below it.
    pub(crate) fn back_emf_speeds_of(&self, unlike: T) -> WheelSpeeds<T> {
        let (right, left) = (T::ONE + unlike, T::ONE - unlike);
        WheelSpeeds {
            right: self.right.back_emf_speed(right, self.bandwidth) * self.per_metre.0,
            left: self.left.back_emf_speed(left, self.bandwidth) * self.per_metre.1,
        }
    }

    /// By how much more than the mean of both the right wheel is made up in that \[m/s\].
    pub(crate) fn made_up_right(&self) -> T {
        T::HALF * (self.right.made_up(self.bandwidth) - self.left.made_up(self.bandwidth))
    }

    /// Puts the robot elsewhere on the map. Speeds, and with them the torques' damping, carry on.
    ///
    /// A motion controller to which the caller declares it
    /// ([`declare_jump`](crate::motion::MotionController::declare_jump)) takes it without a jump of torque.
    pub fn set_pose(&mut self, pose: Pose<T>) {
        self.pose = pose;
        self.lost = Pose::default();
    }

    /// The pose of the last update.
    pub fn pose(&self) -> &Pose<T> {
        &self.pose
    }
}
