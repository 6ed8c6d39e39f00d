//! From force and moment to wheel torques and back: the matrix B̄ of Eq. (3).

use crate::cast::cast;
use crate::error::{Field, ParamError, Problem};
use crate::range::{check_ranges, smaller};
use crate::scalar::Scalar;
use crate::types::{Twist, WheelSpeeds, WheelTorques, Wrench};

/// Two wheels on one axle. Radii may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelGeometry<T = f32> {
    /// Radius of the right wheel \[m\], 1e-3 to 10.
    pub radius_right_m: T,
    /// Radius of the left wheel \[m\], 1e-3 to 10.
    pub radius_left_m: T,
    /// l: the full distance between the wheels' contact points \[m\], 1e-2 to 100.
    pub track_m: T,
}

cast!(WheelGeometry {
    radius_right_m,
    radius_left_m,
    track_m
});

impl<T: Scalar> WheelGeometry<T> {
    #[inline(never)]
    pub(crate) fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::RadiusRight, self.radius_right_m, 1.0e-3, 10.0),
            (Field::RadiusLeft, self.radius_left_m, 1.0e-3, 10.0),
            (Field::Track, self.track_m, 1.0e-2, 100.0),
        ]
    }

    /// A rim's speed is at least this much times its wheel's.
    pub(crate) fn smaller_radius_m(&self) -> T {
        smaller(self.radius_right_m, self.radius_left_m)
    }

    pub(crate) fn mean_radius_m(&self) -> T {
        T::HALF * (self.radius_right_m + self.radius_left_m)
    }

    /// What both wheels push straight on with \[N\] that exert `torque_nm` each \[N m\]: τ/r_R + τ/r_L, Eq. (3).
    pub fn force_n(&self, torque_nm: T) -> T {
        torque_nm / self.radius_right_m + torque_nm / self.radius_left_m
    }
}

/// An invertible linear map between a [`Wrench`] and [`WheelTorques`].
///
/// Holds B̄ (wheel torques to wrench) and its inverse; both are made once, so a tick costs four
/// multiplications.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelMap<T> {
    to_wrench: [[T; 2]; 2],
    to_wheels: [[T; 2]; 2],
}

impl<T: Scalar> WheelMap<T> {
    /// B̄ by virtual work. Eq. (3), corrected.
    ///
    /// With v = (r_R φ̇_R + r_L φ̇_L)/2 and w = (r_R φ̇_R − r_L φ̇_L)/l, the power
    /// τ_R φ̇_R + τ_L φ̇_L equals τ₁ v + τ₂ w for every motion exactly if
    ///
    /// ```text
    /// B̄ = [ 1/r_R        1/r_L     ]      τ_R = r_R (τ₁/2 + τ₂/l)
    ///     [ l/(2 r_R)   −l/(2 r_L) ]      τ_L = r_L (τ₁/2 − τ₂/l)
    /// ```
    ///
    /// The paper prints (1/r) \[\[1, 0\], \[l, −l\]\]: a 1 is missing, and l would have to be half the
    /// distance of the wheels. See `docs/errata.md`.
    ///
    /// # Errors
    /// A length that is not finite or out of its range.
    pub fn from_geometry(geometry: &WheelGeometry<T>) -> Result<Self, ParamError> {
        geometry.check()?;
        let WheelGeometry {
            radius_right_m: right,
            radius_left_m: left,
            track_m: track,
        } = *geometry;
        let half_track = T::HALF * track;
        Ok(Self {
            to_wrench: [
                [T::ONE / right, T::ONE / left],
                [half_track / right, -(half_track / left)],
            ],
            to_wheels: [
                [T::HALF * right, right / track],
                [T::HALF * left, -(left / track)],
            ],
        })
    }

    /// A map from any B̄ (rows: force, moment; columns: right, left): a base with gears,
    /// off-centre axle, or one that was identified rather than measured.
    ///
    /// # Errors
    /// Not finite, or so close to singular that the inverse is not finite.
    pub fn from_matrix(to_wrench: [[T; 2]; 2]) -> Result<Self, ParamError> {
        let field = Field::WheelMatrix;
        let [[a, b], [c, d]] = to_wrench;
        if ![a, b, c, d].iter().all(|entry| entry.is_finite()) {
            let problem = Problem::NotFinite;
            return Err(ParamError { field, problem });
        }
        let determinant = a * d - b * c;
        // Below a few rounding errors of its two products the determinant is noise.
        let noise = T::from_f64(8.0) * T::EPSILON * ((a * d).abs() + (b * c).abs());
        let to_wheels = [
            [d / determinant, -(b / determinant)],
            [-(c / determinant), a / determinant],
        ];
        let inverse_is_finite = to_wheels.iter().flatten().all(|entry| entry.is_finite());
        if determinant.abs() > noise && inverse_is_finite {
            Ok(Self {
                to_wrench,
                to_wheels,
            })
        } else {
            let problem = Problem::Singular;
            Err(ParamError { field, problem })
        }
    }

    /// Wheel torques that exert a wrench: B̄⁻¹ τ̄.
    #[inline(always)]
    pub fn torques(&self, wrench: &Wrench<T>) -> WheelTorques<T> {
        let [[rf, rm], [lf, lm]] = self.to_wheels;
        WheelTorques {
            right: rf * wrench.force + rm * wrench.moment,
            left: lf * wrench.force + lm * wrench.moment,
        }
    }

    /// The wrench that wheel torques exert: B̄ (τ_R, τ_L)ᵀ.
    #[inline(always)]
    pub fn wrench(&self, torques: &WheelTorques<T>) -> Wrench<T> {
        let [[fr, fl], [mr, ml]] = self.to_wrench;
        Wrench {
            force: fr * torques.right + fl * torques.left,
            moment: mr * torques.right + ml * torques.left,
        }
    }

    /// Wheel speeds that go with a twist: B̄ᵀ (v, w)ᵀ, by virtual work.
    #[inline(always)]
    pub fn wheel_speeds(&self, twist: &Twist<T>) -> WheelSpeeds<T> {
        WheelSpeeds {
            right: self.right_speed(twist),
            left: self.left_speed(twist),
        }
    }

    /// [`wheel_speeds`](Self::wheel_speeds) where a call costs less than its code: away from what every tick does.
    #[inline(never)]
    pub(crate) fn wheel_speeds_apart(&self, twist: &Twist<T>) -> WheelSpeeds<T> {
        self.wheel_speeds(twist)
    }

    /// The right one of [`wheel_speeds`](Self::wheel_speeds).
    #[inline(always)]
    pub(crate) fn right_speed(&self, twist: &Twist<T>) -> T {
        let [[force, _], [moment, _]] = self.to_wrench;
        force * twist.linear + moment * twist.angular
    }

    /// The left one.
    #[inline(always)]
    pub(crate) fn left_speed(&self, twist: &Twist<T>) -> T {
        let [[_, force], [_, moment]] = self.to_wrench;
        force * twist.linear + moment * twist.angular
    }

    /// The twist that goes with wheel speeds: B̄⁻ᵀ (φ̇_R, φ̇_L)ᵀ.
    #[inline(always)]
    pub fn twist(&self, speeds: &WheelSpeeds<T>) -> Twist<T> {
        let [[rf, rm], [lf, lm]] = self.to_wheels;
        Twist {
            linear: rf * speeds.right + lf * speeds.left,
            angular: rm * speeds.right + lm * speeds.left,
        }
    }
}

/// Scales both torques by one factor so that neither exceeds `limit`; returns whether it had to.
///
/// One factor keeps the ratio of force to moment, and with it the curvature that the law demanded
/// for. `limit` > 0.
#[inline(always)]
pub fn limit_torques<T: Scalar>(torques: WheelTorques<T>, limit: T) -> (WheelTorques<T>, bool) {
    let (right, left) = (torques.right.abs(), torques.left.abs());
    let largest = if right > left { right } else { left };
    if largest > limit {
        let scale = limit / largest;
        let bounded = |torque: T| {
            // The product may round above the limit by one unit in the last place.
            let scaled = torque * scale;
            if scaled > limit {
                limit
            } else if scaled < -limit {
                -limit
            } else {
                scaled
            }
        };
        let right = bounded(torques.right);
        let left = bounded(torques.left);
        (WheelTorques { right, left }, true)
    } else {
        (torques, false)
    }
}
