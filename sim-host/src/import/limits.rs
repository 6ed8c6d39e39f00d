//! What a base can do.

use super::Sample;
use std::fmt;
use thiserror::Error;

/// The wheels' torque limit, and what the wheels move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Largest torque of a wheel \[N m\].
    pub wheel_torque: f64,
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
    /// Torque limit of the wheels.
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
    /// Acceleration across the path.
    Lateral,
    /// Acceleration or deceleration.
    Acceleration,
    /// Angular acceleration.
    AngularAcceleration,
    /// Torque of a wheel.
    WheelTorque,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "speed",
            Self::TurnRate => "turn rate",
            Self::Lateral => "lateral acceleration",
            Self::Acceleration => "acceleration",
            Self::AngularAcceleration => "angular acceleration",
            Self::WheelTorque => "wheel torque",
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

/// Slower than this, speeding up and braking are the same \[m/s\].
const STANDING: f64 = 1e-6;
/// Smallest limit taken: smaller ones would take the path longer than anyone waits.
const SMALLEST: f64 = 1e-6;

impl ReferenceLimits {
    /// Checks that all are positive.
    pub(super) fn validate(&self) -> Result<(), LimitError> {
        let drive = self.drive.unwrap_or(DriveLimits {
            wheel_torque: 1.0,
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
            ("drive.wheel_torque", drive.wheel_torque),
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

    /// Bounds on rates at a state of the path: linear in q and q′.
    pub(super) fn rows(&self, s: &Sample) -> [BoundRow; 4] {
        let (up, down) = (self.max_accel, self.max_decel);
        let (low, high) = if s.v > STANDING {
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
            torque = drive.wheel_torque;
        }
        [
            row(Bound::Acceleration, s.a, s.v, low, high),
            row(Bound::AngularAcceleration, s.alpha, s.w, -turn, turn),
            row(Bound::WheelTorque, right.0, right.1, -torque, torque),
            row(Bound::WheelTorque, left.0, left.1, -torque, torque),
        ]
    }

    /// Largest q at a state of the path, and what bounds it; 1 is the file's own time.
    pub(super) fn ceiling(&self, s: &Sample) -> (f64, Option<Bound>) {
        let mut ceiling = (1.0, None);
        for (bound, q) in [
            (Bound::Speed, (self.max_speed / s.v).powi(2)),
            (Bound::TurnRate, (self.max_turn_rate / s.w).powi(2)),
            (Bound::Lateral, (self.max_lateral / (s.v * s.w)).abs()),
        ] {
            if q < ceiling.0 {
                ceiling = (q, Some(bound));
            }
        }
        ceiling
    }

    /// By how much a sample exceeds each kind of bound: 1 is on the limit.
    pub(super) fn load(&self, s: &Sample) -> [(Bound, f64); 6] {
        let mut load = [
            (Bound::Speed, s.v.abs() / self.max_speed),
            (Bound::TurnRate, s.w.abs() / self.max_turn_rate),
            (Bound::Lateral, (s.v * s.w).abs() / self.max_lateral),
            (Bound::Acceleration, 0.0),
            (Bound::AngularAcceleration, 0.0),
            (Bound::WheelTorque, 0.0),
        ];
        for row in self.rows(s) {
            let part = (row.c / row.high).max(row.c / row.low);
            for (bound, worst) in &mut load {
                if *bound == row.bound {
                    *worst = worst.max(part);
                }
            }
        }
        load
    }

    /// The limits with those of each kind multiplied by a factor.
    pub(super) fn scaled(&self, factors: &[(Bound, f64); 6]) -> Self {
        let of = |bound| {
            let found = factors.iter().find(|(b, _)| *b == bound);
            found.map_or(1.0, |(_, f)| *f)
        };
        Self {
            max_speed: self.max_speed * of(Bound::Speed),
            max_accel: self.max_accel * of(Bound::Acceleration),
            max_decel: self.max_decel * of(Bound::Acceleration),
            max_turn_rate: self.max_turn_rate * of(Bound::TurnRate),
            max_angular_accel: self.max_angular_accel * of(Bound::AngularAcceleration),
            max_lateral: self.max_lateral * of(Bound::Lateral),
            drive: self.drive.map(|d| DriveLimits {
                wheel_torque: d.wheel_torque * of(Bound::WheelTorque),
                ..d
            }),
        }
    }
}
