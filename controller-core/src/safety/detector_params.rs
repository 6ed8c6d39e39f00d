//! Thresholds and times of the detectors: plain data, checked once.

use crate::error::{Field, ParamError, Problem};
use crate::range::{check_ranges, within};
use crate::robot::{Robot, acceleration};
use crate::scalar::Scalar;
use crate::types::{Twist, WheelTorques, Wrench};
use crate::wheels::WheelMap;

mod suited;

/// a: rate of the window in which torque and motion are compared \[1/s\]. At 0.1 s there are four
/// [looks](super::LOOK_US) in it; a longer one would find a reversed encoder later, a shorter one has fewer counts to go by.
pub(super) const WINDOW: f64 = 10.0;
/// Below this many counts of expected travel nothing is said: each of the two high-passes may double the one
/// count by which a reading is rounded, and that has to stay below half of it.
pub(super) const LEAST_COUNTS: i32 = 8;
/// So many times [`WheelDetectorParams::load_nm`] is not taken for a fault by any detector.
pub(crate) const LOADS: f64 = 3.0;
/// What nobody notices a base to go on for: so many ticks, and at least this time \[µs\].
pub(crate) const UNNOTICED: (u32, u32) = (5, 100_000);
/// How long something may last, or that it is not watched at all. Being off is never a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Timeout {
    /// A fault from this many microseconds on.
    AfterUs(u32),
    /// Not watched.
    Off,
}

impl Timeout {
    pub(super) const fn passed(self, us: u32) -> bool {
        match self {
            Self::AfterUs(limit) => us >= limit,
            Self::Off => false,
        }
    }
}

/// When ticks are too uneven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TickDetectorParams {
    /// A tick of this length came late, and every longer one; above the period. `Off` watches no jitter.
    pub late: Timeout,
    /// So many late ticks in a row are a fault; 1 to 255.
    pub row: u8,
    /// So many late ones among the last 64 are a fault; 1 to 64.
    pub of_64: u8,
    /// A single tick from this length on is a fault; below the controller's longest tick.
    pub long: Timeout,
}

/// A driver that closes its own speed loop exerts on a wheel that stands what grows with the way that was commanded, so the wheel is stuck after a way rather
/// than after a time: that of [`StuckDetectorParams::after`] at this many times [`StuckDetectorParams::speed_rad_s`], and at any higher speed the time.
pub(crate) const SLOW: f64 = 4.0;

/// Of [`StuckDetectorParams::torque_nm`], where it is not 0 \[N m\].
pub(crate) const LEAST_STUCK_TORQUE_NM: f64 = 1.0e-6;

/// When a wheel that is commanded to turn counts as stuck.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StuckDetectorParams<T> {
    /// Torque that turns a free wheel in any case \[N m\]: above friction, and above what a slope that the
    /// base drives on needs. 1e-6 to 1e6; or 0 of drivers that close their own speed loop, which exert what it takes.
    pub torque_nm: T,
    /// A wheel commanded slower than this need not turn \[rad/s\]; at least 3 counts in the time, up to 1e3.
    pub speed_rad_s: T,
    /// For how long; of drivers that close their own speed loop, at four times `speed_rad_s` and faster: more slowly, after the same way.
    pub after: Timeout,
}

/// When a wheel counts as slipping.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SlipDetectorParams<T> {
    /// Acceleration of a wheel beyond twice that of the model that nothing but slip explains \[rad/s²\],
    /// 1e-2 to 1e6.
    pub accel_rad_s2: T,
    /// Speed at a wheel by encoders minus that by an outside twist \[m/s\], 1e-3 to 100; above the noise of
    /// the latter.
    pub speed_m_s: T,
    /// For how long either has to hold.
    pub after: Timeout,
}

/// Detectors of wheels and encoders.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelDetectorParams<T> {
    /// Encoder counts per turn of a wheel, 1 to 1e7.
    pub counts_per_turn: T,
    /// Load from outside as torque at each wheel \[N m\], 1e-6 to 1e6: slope, rolling resistance, pushes. A
    /// reversed wheel is found under loads up to this; no load below three times it is taken for one.
    pub load_nm: T,
    /// Stuck.
    pub stuck: StuckDetectorParams<T>,
    /// Reversed: for how long the evidence has to hold, on top of the 0.1 s that it is averaged over.
    pub reversed: Timeout,
    /// Slipping.
    pub slip: SlipDetectorParams<T>,
}

/// When a motor's current is too large. Without measured currents there is nothing to find.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CurrentDetectorParams<T> {
    /// Largest lasting current of a motor \[A\], 1e-3 to 1e4.
    pub limit_a: T,
    /// For how long above it.
    pub after: Timeout,
}

/// When the supply is too low. Without a measured supply there is nothing to find.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SupplyDetectorParams<T> {
    /// Below this is too low \[V\], 1e-1 to 1e3.
    pub low_v: T,
    /// Good again only from this on \[V\], at least `low_v`: a battery recovers when its load is gone.
    pub recovered_v: T,
    /// For how long below.
    pub after: Timeout,
}

/// Everything that the monitor watches by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DetectorParams<T> {
    /// Time between ticks as planned \[µs\], 100 to 100,000. No timeout is shorter than two of them.
    pub period_us: u32,
    /// Mass, inertia and wheels that torques work on.
    pub robot: Robot<T>,
    /// Encoders without a reading.
    pub measurement: Timeout,
    /// External poses missing.
    pub pose: Timeout,
    /// Host silent: no frame where there is a link, or no order where one is due.
    pub command: Timeout,
    /// Ticks.
    pub ticks: TickDetectorParams,
    /// Wheels and encoders.
    pub wheels: WheelDetectorParams<T>,
    /// Motor currents.
    pub current: CurrentDetectorParams<T>,
    /// Supply.
    pub supply: SupplyDetectorParams<T>,
}

impl<T: Scalar> DetectorParams<T> {
    /// Checks every field and works out what follows from them.
    ///
    /// # Errors
    /// The first field out of range, with the limit it passed. Times are in µs.
    pub fn validate(self) -> Result<ValidDetectorParams<T>, ParamError> {
        let period = self.period_us;
        whole(Field::TickPeriod, period, 100, 100_000)?;
        let robot = &self.robot;
        robot.check()?;
        let map = WheelMap::from_geometry(&robot.wheels)?;
        let Self { ticks, wheels, .. } = &self;
        let (stuck, slip) = (&wheels.stuck, &wheels.slip);
        for (field, timeout) in [
            (Field::MeasurementTimeout, self.measurement),
            (Field::PoseTimeout, self.pose),
            (Field::CommandTimeout, self.command),
            (Field::LongTick, ticks.long),
            (Field::StuckTime, stuck.after),
            (Field::ReversedTime, wheels.reversed),
            (Field::SlipTime, slip.after),
            (Field::CurrentTime, self.current.after),
            (Field::SupplyTime, self.supply.after),
        ] {
            time(field, timeout, 2 * period)?;
        }
        time(Field::LateTick, ticks.late, period + 1)?;
        whole(Field::LateRow, ticks.row.into(), 1, 255)?;
        whole(Field::LateShare, ticks.of_64.into(), 1, 64)?;
        check_ranges![
            (Field::CountsPerTurn, wheels.counts_per_turn, 1.0, 1.0e7),
            (Field::WheelLoad, wheels.load_nm, 1.0e-6, 1.0e6),
        ]?;
        if stuck.torque_nm != T::ZERO {
            within(
                Field::StuckTorque,
                stuck.torque_nm,
                LEAST_STUCK_TORQUE_NM,
                1.0e6,
            )?;
        }
        let per_count = (T::PI + T::PI) / wheels.counts_per_turn;
        let least = match stuck.after {
            Timeout::AfterUs(us) => T::from_f64(3.0e6) * per_count / T::from_u32(us),
            Timeout::Off => T::ZERO,
        };
        within(Field::StuckSpeed, stuck.speed_rad_s, least.to_f64(), 1.0e3)?;
        let supply = &self.supply;
        let low_v = supply.low_v;
        check_ranges![
            (Field::SlipAccel, slip.accel_rad_s2, 1.0e-2, 1.0e6),
            (Field::SlipSpeed, slip.speed_m_s, 1.0e-3, 100.0),
            (Field::CurrentLimit, self.current.limit_a, 1.0e-3, 1.0e4),
            (Field::SupplyLow, low_v, 1.0e-1, 1.0e3),
        ]?;
        let recovered = Field::SupplyRecovered;
        within(recovered, supply.recovered_v, low_v.to_f64(), 1.0e3)?;
        let accels = |right: T, left: T| {
            wheel_accels(robot, &map, &map.wrench(&WheelTorques { right, left }))
        };
        let (by_right, by_left) = (accels(T::ONE, T::ZERO), accels(T::ZERO, T::ONE));
        let window = T::from_f64(WINDOW);
        let area = window * window;
        Ok(ValidDetectorParams {
            load_travel: load_accel(robot, &map, wheels.load_nm) / area,
            slip_travel: slip.accel_rad_s2 / area,
            least_travel: T::from_i32(LEAST_COUNTS) * per_count,
            pushed_nm: if stuck.torque_nm == T::ZERO {
                T::from_f64(f64::INFINITY)
            } else {
                stuck.torque_nm
            },
            own_accel: WheelAccels {
                right: by_right.0,
                left: by_left.1,
            },
            other_accel: by_left.0,
            map,
            per_count,
            params: self,
        })
    }
}

/// Largest acceleration that the load can give a wheel \[rad/s²\], whichever way it pushes the two: that of
/// equal loads, which drive, or of opposite ones, which turn.
fn load_accel<T: Scalar>(robot: &Robot<T>, map: &WheelMap<T>, load_nm: T) -> T {
    let size = |right: T, left: T| {
        let torques = WheelTorques { right, left };
        let accel = wheel_accels(robot, map, &map.wrench(&torques));
        let (right, left) = (accel.0.abs(), accel.1.abs());
        if right > left { right } else { left }
    };
    let (driving, turning) = (size(load_nm, load_nm), size(load_nm, -load_nm));
    if driving > turning { driving } else { turning }
}

/// Accelerations of both wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WheelAccels<T> {
    pub(super) right: T,
    pub(super) left: T,
}

/// Angular accelerations of right and left wheel \[rad/s²\] under a wrench: B̄ᵀ M̄⁻¹ τ̄.
fn wheel_accels<T: Scalar>(robot: &Robot<T>, map: &WheelMap<T>, wrench: &Wrench<T>) -> (T, T) {
    let accel = acceleration(robot, wrench);
    let rates = map.wheel_speeds(&Twist::new(accel.linear, accel.angular));
    (rates.right, rates.left)
}

/// As [`within`].
pub(super) fn whole(field: Field, value: u32, low: u32, high: u32) -> Result<(), ParamError> {
    let problem = if value < low {
        Problem::Below(low.into())
    } else if value > high {
        Problem::Above(high.into())
    } else {
        return Ok(());
    };
    Err(ParamError { field, problem })
}

/// At most a minute: longer is off, and has to say so.
pub(super) fn time(field: Field, timeout: Timeout, least_us: u32) -> Result<(), ParamError> {
    match timeout {
        Timeout::AfterUs(us) => whole(field, us, least_us, 60_000_000),
        Timeout::Off => Ok(()),
    }
}

/// [`DetectorParams`] that passed `validate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidDetectorParams<T> {
    pub(super) params: DetectorParams<T>,
    pub(super) map: WheelMap<T>,
    /// By a wheel's own torque \[rad/s² per N m\],
    pub(super) own_accel: WheelAccels<T>,
    /// and by that of the other one, which is the same for both: B̄ᵀ M̄⁻¹ B̄ is symmetric.
    pub(super) other_accel: T,
    /// Turn of a wheel per count \[rad\].
    pub(super) per_count: T,
    /// D: what the load adds at most to the filtered turn of a wheel \[rad\]; see [`Monitor`](super::Monitor).
    pub(super) load_travel: T,
    /// What `slip.accel_rad_s2` adds to it \[rad\].
    pub(super) slip_travel: T,
    /// Turn in the filters below which nothing is said of a wheel \[rad\].
    pub(super) least_travel: T,
    /// Torque from which on a wheel is pushed \[N m\]; none where `stuck.torque_nm` is 0.
    pub(super) pushed_nm: T,
}

impl<T: Scalar> ValidDetectorParams<T> {
    /// The parameters as they were given.
    pub fn params(&self) -> &DetectorParams<T> {
        &self.params
    }

    /// Largest acceleration of a wheel by the load \[rad/s²\].
    pub(crate) fn load_accel(&self) -> T {
        let window = T::from_f64(WINDOW);
        window * window * self.load_travel
    }
}
