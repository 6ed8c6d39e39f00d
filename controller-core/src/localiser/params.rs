//! Parameters of the localiser: plain data, validated once.

use super::covariance::Growth;
use super::noise::{bandwidth_for, least_noise, pose_noise};
use crate::error::{Field, ParamError, Problem};
use crate::gyro::{GyroParams, ValidGyroParams};
use crate::maths::{Maths, Usual};
#[cfg(test)]
use crate::odometry::Calibration;
use crate::odometry::{OdometryParams, Tyres};
use crate::range::{check_ranges, clamp, larger, signed, smaller};
use crate::robot::Robot;
use crate::scalar::Scalar;

/// What is known of the external pose, and how far it is trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FusionParams<T = f32> {
    /// Standard deviation of a fix in each coordinate \[m\], 1e-5 to 10.
    pub noise_m: T,
    /// Standard deviation of its heading \[rad\], 1e-5 to 1.
    pub noise_rad: T,
    /// Fixes per second, nominal; 1e-2 to 1e3. They may come more rarely.
    pub rate_hz: T,
    /// Bandwidth of the position's correction at rest, at the nominal rate \[rad/s\], 1e-3 to 100. A base that drives
    /// corrects faster, by what `drift` makes of its way.
    pub bandwidth: T,
    /// The same of the heading's.
    pub heading_bandwidth: T,
    /// A fix this many standard deviations off is an outlier, 2 to 20.
    pub gate: T,
    /// Outliers in a row that agree with each other and so are right, 2 to 100.
    pub relocalise_after: u8,
    /// What odometry may be wrong by, as a share of the travel of a wheel; 0 to 0.5. Widens the gate, bounds
    /// the curvature bias that is learnt, [`Estimate::curvature_bias`](super::Estimate::curvature_bias), and says how fast a
    /// base that drives is to doubt odometry: the larger, the more of each fix is taken on the way. At 0 as much as at rest.
    pub drift: T,
    /// How fast a wheel may slide over the floor \[m/s\], 0 (never) to 100: outliers may move by that
    /// beside odometry and still agree.
    pub slide_m_s: T,
    /// Without a fix for longer, the pose is stale \[s\], 1e-2 to 1e4.
    pub stale_s: T,
}

impl<T: Scalar> FusionParams<T> {
    /// A pose source of this noise and rate, and odometry that is good to 2 % or better.
    ///
    /// The bandwidths leave a seventh of the noise, 1/50 of its variance, but are at most 1 rad/s:
    /// faster noise keeps a parking robot busy. A source that is better than a robot parks, of 0.8 mm and less at 20 Hz, is filtered less: until its noise
    /// shows in the tolerance of arrival, or up to 4 rad/s, which velocity loops of 6 rad/s still follow. 5 standard deviations reject one good fix in half a million; 3
    /// outliers that agree are no chance. A base that is commanded more than the floor holds has been
    /// seen to turn at 1 to 2 rad/s while its wheels say otherwise: a slide of half a metre per second
    /// at half a metre of track. Stale after ten fixes.
    pub fn for_source(noise_m: T, noise_rad: T, rate_hz: T) -> Self {
        let f = T::from_f64;
        let drift = f(DRIFT);
        let quiet = smaller(f(2.0 / 50.0) * rate_hz, T::ONE);
        let bandwidth = |noise, least| {
            let fine = bandwidth_for(noise, least, rate_hz);
            larger(smaller(fine, f(FASTEST)), quiet)
        };
        let (least_m, least_rad) = least_noise(drift);
        Self {
            noise_m,
            noise_rad,
            rate_hz,
            bandwidth: bandwidth(noise_m, least_m),
            heading_bandwidth: bandwidth(noise_rad, least_rad),
            gate: f(5.0),
            relocalise_after: 3,
            drift,
            slide_m_s: f(0.5),
            stale_s: f(10.0) / rate_hz,
        }
    }

    fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::FixNoise, self.noise_m, 1.0e-5, 10.0),
            (Field::FixHeadingNoise, self.noise_rad, 1.0e-5, 1.0),
            (Field::FixRate, self.rate_hz, 1.0e-2, 1.0e3),
            (Field::FixBandwidth, self.bandwidth, 1.0e-3, 100.0),
            (
                Field::FixHeadingBandwidth,
                self.heading_bandwidth,
                1.0e-3,
                100.0,
            ),
            (Field::FixGate, self.gate, 2.0, 20.0),
            (
                Field::RelocaliseAfter,
                T::from_i32(i32::from(self.relocalise_after)),
                2.0,
                100.0,
            ),
            (Field::OdometryDrift, self.drift, 0.0, 0.5),
            (Field::SlideSpeed, self.slide_m_s, 0.0, 100.0),
            (Field::FixStale, self.stale_s, 1.0e-2, 1.0e4),
        ]
    }
}

/// Everything that the localiser needs to know.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LocaliserParams<T = f32> {
    /// Wheels and encoders.
    pub odometry: OdometryParams<T>,
    /// The source of fixes; `None` is odometry alone.
    pub fusion: Option<FusionParams<T>>,
    /// The gyro, if there is one.
    pub gyro: Option<GyroParams<T>>,
}

#[cfg(test)]
impl LocaliserParams<f64> {
    /// Wheels of 0.1 m, half a metre apart, with 2048 counts a turn; poses that are good to 5 mm and 5 mrad at 20 Hz.
    pub(crate) fn for_test() -> Self {
        Self {
            odometry: OdometryParams {
                wheels: Robot::paper().wheels,
                calibration: Calibration::NOMINAL,
                counts_per_turn: 2048.0,
                bandwidth: 50.0,
            },
            fusion: Some(FusionParams::for_source(5e-3, 5e-3, 20.0)),
            gyro: None,
        }
    }
}

/// What odometry may be wrong by, as a share of the travel of a wheel, unless a fusion states it: a calibrated base is within 2 %.
const DRIFT: f64 = 0.02;

/// The largest bandwidth that is chosen for a source \[rad/s\]; see [`FusionParams::for_source`].
const FASTEST: f64 = 4.0;

impl<T: Usual> LocaliserParams<T> {
    /// [`validate_with`](Self::validate_with) the usual mathematics of the number type.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(self) -> Result<ValidLocaliserParams<T>, ParamError> {
        self.validate_with::<T::Maths>()
    }
}

impl<T: Scalar> LocaliserParams<T> {
    /// Checks every field and works out what follows from them.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed.
    // Apart: within its caller it takes a kilobyte more of flash.
    #[inline(never)]
    pub fn validate_with<M: Maths<T>>(self) -> Result<ValidLocaliserParams<T>, ParamError> {
        self.odometry.check()?;
        let fusion = match &self.fusion {
            Some(params) => {
                params.check()?;
                Some(Fusion::new::<M>(params, self.odometry.track_m()))
            }
            None => None,
        };
        let drift = self
            .fusion
            .map_or(T::from_f64(DRIFT), |fusion| fusion.drift);
        let gyro = match self.gyro {
            Some(gyro) => Some(gyro.validate(&self.odometry, drift)?),
            None => None,
        };
        let settled = fusion.as_ref().map_or((T::ZERO, T::ZERO), |fusion| {
            let least = least_noise(fusion.drift);
            (
                larger(fusion.position.filtered, least.0),
                larger(fusion.heading.filtered, least.1),
            )
        });
        Ok(ValidLocaliserParams {
            pose_noise: pose_noise::<T, M>(&self.odometry, settled.0),
            settled,
            tyres: Tyres::RIGID,
            params: self,
            fusion,
            gyro,
        })
    }
}

/// [`LocaliserParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidLocaliserParams<T = f32> {
    params: LocaliserParams<T>,
    pub(super) fusion: Option<Fusion<T>>,
    pub(super) gyro: Option<ValidGyroParams<T>>,
    pub(super) pose_noise: T,
    /// Noise of the pose that a robot parks by: what is left of that of fixes, at least [`least_noise`] \[m\], \[rad\].
    pub(super) settled: (T, T),
    pub(super) tyres: Tyres<T>,
}

impl<T: Scalar> ValidLocaliserParams<T> {
    /// For a robot of this mass and inertia: what its tyres slip is learnt, [`Estimate::tyre_slip`](super::Estimate::tyre_slip).
    ///
    /// The localiser has to be given what accelerates it, as [`BaseController`](crate::base::BaseController) does. `bandwidth` is that of the
    /// loop which makes torques of the twist \[rad/s\], 0.1 to 1e3: of a twist no more is taken off than would delay that loop by a fifth of
    /// its time constant on tyres that are rigid after all.
    ///
    /// # Errors
    /// The first field of the robot out of range; [`Field::WheelMatrix`] if odometry has other wheels than the robot, for what real ones
    /// deviate by is [calibration](crate::odometry::Calibration); [`Field::TurnLoop`] for the bandwidth.
    pub fn with_robot(mut self, robot: &Robot<T>, bandwidth: T) -> Result<Self, ParamError> {
        robot.check()?;
        robot.wheels.check()?;
        if self.params.odometry.wheels != robot.wheels {
            let (field, problem) = (Field::WheelMatrix, Problem::Differs);
            return Err(ParamError { field, problem });
        }
        check_ranges![(Field::TurnLoop, bandwidth, 0.1, 1.0e3)]?;
        self.tyres = Tyres::new(robot, bandwidth);
        if let (Some(fusion), Some(params)) = (&mut self.fusion, &self.params.fusion) {
            fusion.growth.learn_slip(params.drift);
        }
        Ok(self)
    }

    /// The parameters as they were given.
    pub fn params(&self) -> &LocaliserParams<T> {
        &self.params
    }

    /// Standard deviation of the reported position in each coordinate, of the fixes' noise \[m\].
    /// 0 without fixes. See [`filtered_share`](super::filtered_share).
    pub fn filtered_noise_m(&self) -> T {
        self.fusion
            .as_ref()
            .map_or(T::ZERO, |fusion| fusion.position.filtered)
    }

    /// The same of the heading \[rad\].
    pub fn filtered_noise_rad(&self) -> T {
        self.fusion
            .as_ref()
            .map_or(T::ZERO, |fusion| fusion.heading.filtered)
    }

    /// Variance of a fix's heading \[rad²\], 0 without fixes.
    pub(super) fn fix_heading_variance(&self) -> T {
        self.fusion
            .as_ref()
            .map_or(T::ZERO, |fusion| fusion.growth.fix_heading())
    }

    /// The farthest that a coordinate of the pose is corrected in a tick of `dt` \[s\] by what may be noise: \[m\] and \[rad\].
    /// A pose that is further off than the gate allows for noise is corrected faster, and a relocalisation, which says so, at once.
    pub fn largest_step(&self, dt: T) -> (T, T) {
        self.fusion.as_ref().map_or((T::ZERO, T::ZERO), |fusion| {
            (dt * fusion.position.rate, dt * fusion.heading.rate)
        })
    }
}

/// What follows from the parameters of the fusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fusion<T> {
    pub(super) position: Channel<T>,
    pub(super) heading: Channel<T>,
    /// ω_s of [`filtered_share`](super::filtered_share): how fast corrections are spread \[1/s\].
    pub(super) spread: T,
    pub(super) relocalise_after: u8,
    pub(super) drift: T,
    pub(super) slide: T,
    pub(super) two_per_track: T,
    pub(super) growth: Growth<T>,
    pub(super) stale_s: T,
}

/// Position or heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Channel<T> {
    /// g: the share of an innovation that is taken.
    pub(super) gain: T,
    /// Largest believable innovation without drift.
    pub(super) gate: T,
    /// Largest difference of two fixes that agree, without drift.
    pub(super) agree: T,
    /// Largest rate of correction by what may be noise \[1/s\].
    rate: T,
    /// Standard deviation of what is reported.
    pub(super) filtered: T,
}

impl<T: Scalar> Fusion<T> {
    fn new<M: Maths<T>>(params: &FusionParams<T>, track: T) -> Self {
        let channel = |noise, bandwidth| Channel::new::<M>(params, noise, bandwidth);
        let position = channel(params.noise_m, params.bandwidth);
        let heading = channel(params.noise_rad, params.heading_bandwidth);
        let two_per_track = (T::ONE + T::ONE) / track;
        let (noise, gain) = (
            (params.noise_m, params.noise_rad),
            (position.gain, heading.gain),
        );
        Self {
            growth: Growth::new(noise, gain, params.drift, two_per_track),
            position,
            heading,
            spread: params.rate_hz,
            relocalise_after: params.relocalise_after,
            drift: params.drift,
            slide: params.slide_m_s,
            two_per_track,
            stale_s: params.stale_s,
        }
    }
}

impl<T: Scalar> Channel<T> {
    fn new<M: Maths<T>>(params: &FusionParams<T>, noise: T, bandwidth: T) -> Self {
        let two = T::ONE + T::ONE;
        let gain = -M::exp_m1(-(bandwidth / params.rate_hz));
        // What the filter holds is itself noisy, by g/(2 − g) of the fixes' variance.
        let gate = params.gate * noise * M::sqrt(two / (two - gain));
        // Corrections of fixes at the gate, one after the other, while each is spread over 1/rate:
        // 1 + e⁻¹ + e⁻² + … = 1.6 of them are under way, and leave at the nominal rate.
        let under_way = T::from_f64(1.0 / (1.0 - 0.367_879_441_171_442_3));
        Self {
            gain,
            gate,
            agree: params.gate * noise * M::sqrt(two),
            rate: params.rate_hz * under_way * gain * gate,
            filtered: noise * M::sqrt(super::noise::filtered_share(gain)),
        }
    }

    /// What a tick of `dt` corrects of what is `pending`, of which the `share` is due. An error within the gate may be noise, and is corrected no faster
    /// than noise asks for at rest; beyond it the pose is off, as after a slide, and all that is due is corrected.
    #[inline(always)]
    pub(super) fn step(&self, pending: T, share: T, dt: T) -> T {
        let most = dt * self.rate;
        if pending.abs() <= self.gate {
            return clamp(share * pending, most);
        }
        let gate = signed(self.gate, pending);
        share * (pending - gate) + clamp(share * gate, most)
    }
}
