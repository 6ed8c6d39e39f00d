//! What is known of a gyro: plain data of its data sheet, validated once.

use crate::error::{Field, ParamError};
use crate::odometry::OdometryParams;
use crate::range::check_ranges;
use crate::scalar::Scalar;

/// A gyro, as its data sheet has it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GyroParams<T = f32> {
    /// Noise density \[rad/s/√Hz\], 1e-7 to 1e-1: the heading walks by it times the root of the time.
    pub noise_density: T,
    /// Largest bias \[rad/s\], 1e-6 to 1: offset at switching on, and what temperature and soldering add.
    pub bias_limit: T,
    /// How fast the bias wanders \[rad/s/√s\], 0 to 1e-1.
    pub bias_walk: T,
    /// Share by which its scale may be wrong, 0 to 0.2.
    pub scale_error: T,
    /// Largest rate that it measures \[rad/s\], 1e-1 to 1e3.
    pub range: T,
    /// Least step of its output \[rad/s\], 0 to 1e-1.
    pub resolution: T,
    /// Readings per second, nominal; 10 to 1e5.
    pub rate_hz: T,
    /// Age of a reading when it arrives, nominal \[s\], 0 to 0.1: for a driver that knows no better.
    pub latency_s: T,
    /// The wheels have to stand for so long before the bias is learnt \[s\], 0.05 to 10.
    pub rest_s: T,
    /// How long a base with external poses may drive by wheels and gyro alone \[s\], 0 to 60; 0 is no longer than without one.
    pub carry_s: T,
}

/// A base on soft tyres rings for some tenths of a second after its wheels have stopped.
const REST_S: f64 = 0.3;
/// Half a minute: a camera behind a pillar, a robot through a door. What is left is the way, to a share that radii are known to.
const CARRY_S: f64 = 30.0;

impl<T: Scalar> GyroParams<T> {
    /// TDK InvenSense ICM-42688-P at ± 500 °/s, 200 Hz.
    ///
    /// Data sheet DS-000347, table 1 (typical values): noise density 2.8 m°/s/√Hz; offset ± 0.5 °/s, and 0.005 °/s/K over
    /// ± 30 K; scale ± 0.5 % and 0.005 %/K over ± 30 K; 65.5 LSB per °/s. The filter's delay is of the order of half a sample at
    /// a quarter of the output rate. The walk of the bias is not in the sheet: 1 m°/s in a minute.
    pub fn icm_42688_p() -> Self {
        let f = T::from_f64;
        Self {
            noise_density: f(4.9e-5),
            bias_limit: f(0.0115),
            bias_walk: f(2.3e-6),
            scale_error: f(0.0065),
            range: f(8.72),
            resolution: f(2.66e-4),
            rate_hz: f(200.0),
            latency_s: f(0.003),
            rest_s: f(REST_S),
            carry_s: f(CARRY_S),
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed.
    pub fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::GyroNoise, self.noise_density, 1.0e-7, 1.0e-1),
            (Field::GyroBias, self.bias_limit, 1.0e-6, 1.0),
            (Field::GyroBiasWalk, self.bias_walk, 0.0, 1.0e-1),
            (Field::GyroScale, self.scale_error, 0.0, 0.2),
            (Field::GyroRange, self.range, 1.0e-1, 1.0e3),
            (Field::GyroResolution, self.resolution, 0.0, 1.0e-1),
            (Field::GyroRate, self.rate_hz, 10.0, 1.0e5),
            (Field::GyroLatency, self.latency_s, 0.0, 0.1),
            (Field::GyroRest, self.rest_s, 0.05, 10.0),
            (Field::GyroCarry, self.carry_s, 0.0, 60.0),
        ]
    }

    /// Checks every field and works out what follows from them on these wheels, whose radii may be wrong by the share `drift`.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed.
    pub fn validate(
        self,
        wheels: &OdometryParams<T>,
        drift: T,
    ) -> Result<ValidGyroParams<T>, ParamError> {
        let f = T::from_f64;
        self.check()?;
        let per_track = T::ONE / wheels.track_m();
        let per_way = (drift + drift) * per_track;
        let noise = self.noise_density * self.noise_density;
        let step = self.resolution * self.resolution;
        let (silent, least) = (f(5.0) / self.rate_hz, f(0.1));
        Ok(ValidGyroParams {
            per_way,
            per_turn: drift + self.scale_error,
            rounding: f(ROUNDING) * per_track * wheels.travel_per_count_m(),
            honest: f(0.5 * WINDOW_S * GATE * GATE) * noise + f(WINDOW_S * WINDOW_S) * step,
            noise,
            rounded: f(1.0 / 12.0) * step,
            scale: f(1.0 / 3.0) * self.scale_error * self.scale_error,
            walk: self.bias_walk * self.bias_walk,
            prior: f(1.0 / 3.0) * self.bias_limit * self.bias_limit,
            silent_s: if silent > least { silent } else { least },
            wheels_half_track: T::HALF * wheels.track_m(),
            two_per_track: per_track + per_track,
            params: self,
        })
    }
}

/// W: window in which turns are compared \[s\].
pub(super) const WINDOW_S: f64 = 0.1;
/// Standard deviations of noise that are honest.
pub(super) const GATE: f64 = 5.0;
/// Counts by which the wheels' difference may be wrong: one at either end of the window for each wheel.
const ROUNDING: f64 = 4.0;

/// [`GyroParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidGyroParams<T = f32> {
    pub(super) params: GyroParams<T>,
    /// 2 d/l \[rad/m\]: turn per way of radii that are wrong by d, each its way.
    pub(super) per_way: T,
    /// d + scale error: share of a turn by which the two may disagree.
    pub(super) per_turn: T,
    /// Rounding of the counts \[rad\].
    pub(super) rounding: T,
    /// (5 σ)² of the gyro's noise in the window, and a step of its output for all of it \[rad²\].
    pub(super) honest: T,
    /// n² \[rad²/s\].
    pub(super) noise: T,
    /// Variance of a scale that is anywhere within its error.
    pub(super) scale: T,
    /// Variance of the output's rounding \[rad²/s²\].
    pub(super) rounded: T,
    /// Of the bias, per time \[rad²/s³\].
    pub(super) walk: T,
    /// Variance of a bias that is anywhere within its limit.
    pub(super) prior: T,
    /// Without a reading for longer it is silent \[s\].
    pub(super) silent_s: T,
    pub(super) wheels_half_track: T,
    pub(super) two_per_track: T,
}

impl<T: Copy> ValidGyroParams<T> {
    /// The parameters as they were given.
    pub const fn params(&self) -> &GyroParams<T> {
        &self.params
    }

    /// Largest curvature bias of the wheels that is believed \[rad/m\].
    pub(crate) const fn most_per_way(&self) -> T {
        self.per_way
    }
}
