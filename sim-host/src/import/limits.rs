//! What a base can do.

use super::Sample;
use std::fmt;
use thiserror::Error;

/// The wheels' limits, and what the wheels move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Largest torque of a wheel \[N m\].
    pub wheel_torque: f64,
    /// Largest speed of a wheel's rim \[m/s\].
    pub rim_speed: f64,
    /// Radius of the wheels \[m\].
    pub wheel_radius: f64,
    /// Distance between the wheels \[m\].
    pub track: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Moment of inertia about the vertical axis \[kg m²\].
    pub inertia: f64,
}

/// Limits of a base. All positive; `f64::INFINITY` for one that does not bind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceLimits {
    /// Largest |v| \[m/s\].
    pub max_speed: f64,
    /// Largest rate of |v| upwards \[m/s²\].
    pub max_accel: f64,
    /// Largest rate of |v| downwards \[m/s²\].
    pub max_decel: f64,
    /// Largest |w| \[rad/s\].
    pub max_turn_rate: f64,
    /// Largest |α| \[rad/s²\].
    pub max_angular_accel: f64,
    /// Largest |v w| \[m/s²\].
    pub max_lateral: f64,
    /// Largest rate of the acceleration \[m/s³\].
    pub max_jerk: f64,
    /// Largest rate of α \[rad/s³\].
    pub max_angular_jerk: f64,
    /// Limits of the wheels.
    pub drive: Option<DriveLimits>,
}

impl Default for ReferenceLimits {
    /// Nothing binds.
    fn default() -> Self {
        Self {
            max_speed: f64::INFINITY,
            max_accel: f64::INFINITY,
            max_decel: f64::INFINITY,
            max_turn_rate: f64::INFINITY,
            max_angular_accel: f64::INFINITY,
            max_lateral: f64::INFINITY,
            max_jerk: f64::INFINITY,
            max_angular_jerk: f64::INFINITY,
            drive: None,
        }
    }
}

/// A limit that no base has.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("limit `{field}` is not positive")]
pub struct LimitError {
    /// Name of the field.
    pub field: &'static str,
}

/// What limits the pace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Bound {
    /// Speed.
    Speed,
    /// Turn rate.
    TurnRate,
    /// Speed of a wheel's rim.
    RimSpeed,
    /// Acceleration across the path.
    Lateral,
    /// Acceleration or deceleration.
    Acceleration,
    /// Angular acceleration.
    AngularAcceleration,
    /// Torque of a wheel.
    WheelTorque,
    /// Rate of the acceleration.
    Jerk,
    /// Rate of the angular acceleration.
    AngularJerk,
}

/// Limits share a piece whose loads differ by this part at most: a search leaves some thousandths of each that it is on.
const SHARED: f64 = 0.02;

/// What a motion uses of every limit, by [`Bound`]: 1 is on the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Loads([f64; 9]);

impl Loads {
    const BOUNDS: [Bound; 9] = [
        Bound::Speed,
        Bound::TurnRate,
        Bound::RimSpeed,
        Bound::Lateral,
        Bound::Acceleration,
        Bound::AngularAcceleration,
        Bound::WheelTorque,
        Bound::Jerk,
        Bound::AngularJerk,
    ];

    pub(super) fn of(&self, bound: Bound) -> f64 {
        self.0.get(bound as usize).copied().unwrap_or_default()
    }

    /// Takes a load into account.
    pub(super) fn include(&mut self, bound: Bound, load: f64) {
        if let Some(most) = self.0.get_mut(bound as usize) {
            *most = most.max(load);
        }
    }

    /// Takes another motion's loads into account.
    pub(super) fn merge(&mut self, other: &Self) {
        for (most, load) in self.0.iter_mut().zip(other.0) {
            *most = most.max(load);
        }
    }

    /// Multiplies by the loads beyond 1, and by `more`.
    pub(super) fn tighten(&mut self, passed: &Self, more: f64) {
        for (tight, load) in self.0.iter_mut().zip(passed.0) {
            if load > 1.0 {
                *tight = tight.max(1.0) * load * more;
            }
        }
    }

    /// The largest, and those that are as large but for [`SHARED`].
    pub(super) fn nearest(&self) -> Vec<Bound> {
        let (_, most) = self.largest();
        let all = Self::BOUNDS.into_iter().zip(self.0);
        all.filter(|(_, load)| *load > 0.0 && *load >= (1.0 - SHARED) * most)
            .map(|(bound, _)| bound)
            .collect()
    }

    /// The largest, and what it is a load of.
    pub(super) fn largest(&self) -> (Bound, f64) {
        let all = Self::BOUNDS.into_iter().zip(self.0);
        all.fold((Bound::Speed, 0.0), |most, here| {
            if here.1 > most.1 { here } else { most }
        })
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "speed",
            Self::TurnRate => "turn rate",
            Self::RimSpeed => "wheel speed",
            Self::Lateral => "lateral acceleration",
            Self::Acceleration => "acceleration",
            Self::AngularAcceleration => "angular acceleration",
            Self::WheelTorque => "wheel torque",
            Self::Jerk => "jerk",
            Self::AngularJerk => "angular jerk",
        })
    }
}

/// One bound on c q + d q′, where q is the squared rate of time: value, coefficients, bounds.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundRow {
    pub(super) bound: Bound,
    pub(super) c: f64,
    pub(super) d: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Slower than this, the limits of speeding up and of braking both hold \[m/s\].
const STANDING: f64 = 1e-3;
/// Smallest limit taken: smaller ones would take the path longer than anyone waits.
const SMALLEST: f64 = 1e-6;

impl ReferenceLimits {
    /// Checks that all are positive.
    pub(super) fn validate(&self) -> Result<(), LimitError> {
        let drive = self.drive.unwrap_or(DriveLimits {
            wheel_torque: 1.0,
            rim_speed: 1.0,
            wheel_radius: 1.0,
            track: 1.0,
            mass: 1.0,
            inertia: 1.0,
        });
        for (field, value) in [
            ("max_speed", self.max_speed),
            ("max_accel", self.max_accel),
            ("max_decel", self.max_decel),
            ("max_turn_rate", self.max_turn_rate),
            ("max_angular_accel", self.max_angular_accel),
            ("max_lateral", self.max_lateral),
            ("max_jerk", self.max_jerk),
            ("max_angular_jerk", self.max_angular_jerk),
            ("drive.wheel_torque", drive.wheel_torque),
            ("drive.rim_speed", drive.rim_speed),
            ("drive.wheel_radius", drive.wheel_radius),
            ("drive.track", drive.track),
            ("drive.mass", drive.mass),
            ("drive.inertia", drive.inertia),
        ] {
            if value.is_nan() || value < SMALLEST {
                return Err(LimitError { field });
            }
        }
        Ok(())
    }

    /// Bounds on rates at a state of the path: linear in q and q′. Where the direction changes, those
    /// of both.
    pub(super) fn rows(&self, s: &Sample, reverses: bool) -> [BoundRow; 4] {
        let (up, down) = (self.max_accel, self.max_decel);
        let (low, high) = if reverses {
            (-up.min(down), up.min(down))
        } else if s.v > STANDING {
            (-down, up)
        } else if s.v < -STANDING {
            (-up, down)
        } else {
            (-up.min(down), up.min(down))
        };
        let row = |bound, c, d: f64, low, high| BoundRow {
            bound,
            c,
            d: 0.5 * d,
            low,
            high,
        };
        let turn = self.max_angular_accel;
        let (mut right, mut left, mut torque) = ((0.0, 0.0), (0.0, 0.0), f64::INFINITY);
        if let Some(drive) = self.drive {
            // Half the force each, and the moment as a pair of forces at the wheels.
            let push = 0.5 * drive.mass * drive.wheel_radius;
            let turn = drive.inertia * drive.wheel_radius / drive.track;
            right = (push * s.a + turn * s.alpha, push * s.v + turn * s.w);
            left = (push * s.a - turn * s.alpha, push * s.v - turn * s.w);
            // Where accelerations within their limits need no more, nobody has to look at it.
            let most = push * up.max(down) + turn * self.max_angular_accel;
            if most > drive.wheel_torque {
                torque = drive.wheel_torque;
            }
        }
        [
            row(Bound::Acceleration, s.a, s.v, low, high),
            row(Bound::AngularAcceleration, s.alpha, s.w, -turn, turn),
            row(Bound::WheelTorque, right.0, right.1, -torque, torque),
            row(Bound::WheelTorque, left.0, left.1, -torque, torque),
        ]
    }

    /// Largest q by each limit of speed at a state of the path; 1 is the path's own time.
    pub(super) fn ceilings(&self, s: &Sample) -> [(Bound, f64); 4] {
        let rim = self.rim_load(s);
        [
            (Bound::Speed, (self.max_speed / s.v).powi(2)),
            (Bound::TurnRate, (self.max_turn_rate / s.w).powi(2)),
            (Bound::RimSpeed, (1.0 / rim).powi(2)),
            (Bound::Lateral, (self.max_lateral / (s.v * s.w)).abs()),
        ]
    }

    /// Speed of the faster wheel's rim over what it may be.
    fn rim_load(&self, s: &Sample) -> f64 {
        self.drive.map_or(0.0, |drive| {
            (s.v.abs() + 0.5 * drive.track * s.w.abs()) / drive.rim_speed
        })
    }

    /// What a sample uses of the limits; jerk is between samples.
    pub(super) fn loads(&self, s: &Sample) -> Loads {
        let mut loads = Loads::default();
        loads.include(Bound::Speed, s.v.abs() / self.max_speed);
        loads.include(Bound::TurnRate, s.w.abs() / self.max_turn_rate);
        loads.include(Bound::RimSpeed, self.rim_load(s));
        loads.include(Bound::Lateral, (s.v * s.w).abs() / self.max_lateral);
        for row in self.rows(s, false) {
            loads.include(row.bound, (row.c / row.high).max(row.c / row.low));
        }
        loads
    }

    /// What the mean jerk from one sample to a later one uses.
    pub(super) fn jerk_loads(&self, from: &Sample, to: &Sample) -> Loads {
        let mut loads = Loads::default();
        let dt = to.t - from.t;
        if dt > 0.0 {
            loads.include(Bound::Jerk, ((to.a - from.a) / dt).abs() / self.max_jerk);
            let angular = ((to.alpha - from.alpha) / dt).abs();
            loads.include(Bound::AngularJerk, angular / self.max_angular_jerk);
        }
        loads
    }
}
