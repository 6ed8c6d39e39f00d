//! The robot: its body and wheels, kinematics, rolling constraint, dynamics. Eqs. (1)-(3).

use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::maths::Maths;
use crate::range::check_ranges;
use crate::scalar::Scalar;
use crate::types::{Accel, Pose, Twist, Wrench};
use crate::wheels::WheelGeometry;

/// The body: M̄ = diag(m, I) of Eq. (3), and its wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Robot<T = f32> {
    /// m \[kg\], 1e-3 to 1e5.
    pub mass_kg: T,
    /// I \[kg m²\] about the vertical through the middle of the axle, 1e-6 to 1e6.
    pub inertia_kg_m2: T,
    /// Wheels, for the map from wrench to wheel torques.
    pub wheels: WheelGeometry<T>,
}

cast!(Robot {
    mass_kg,
    inertia_kg_m2,
    wheels
});

impl<T: Scalar> Robot<T> {
    /// The robot of the paper: m = 30 kg and I = 15 kg m².
    ///
    /// The paper gives neither wheel radius nor wheel distance: 0.1 m and 0.5 m are those of a usual
    /// 30 kg base.
    pub fn paper() -> Self {
        let f = T::from_f64;
        Self {
            mass_kg: f(30.0),
            inertia_kg_m2: f(15.0),
            wheels: WheelGeometry {
                radius_right_m: f(0.1),
                radius_left_m: f(0.1),
                track_m: f(0.5),
            },
        }
    }

    /// The robot as its wheels feel it, with the inertia J of what turns with each of them beyond what m and I hold: rotors,
    /// whose turning a gear multiplies by its ratio squared. A law whose robot lacks them is late in every acceleration.
    ///
    /// ```text
    /// m′ = m + J (1/r_r² + 1/r_l²)        I′ = I + (l/2)² J (1/r_r² + 1/r_l²)
    /// ```
    ///
    /// | symbol | argument | unit |
    /// | --- | --- | --- |
    /// | J | `inertia`: n² J_m of a rotor behind a gear of ratio n | kg m² |
    /// | r_r, r_l, l | `wheels` | m |
    ///
    /// With unlike radii speed and turn rate are coupled by what the two wheels differ in; that part is left out.
    pub fn with_wheel_inertia(self, inertia: T) -> Self {
        let WheelGeometry {
            radius_right_m: right,
            radius_left_m: left,
            track_m,
        } = self.wheels;
        let mass = inertia / (right * right) + inertia / (left * left);
        let lever = T::HALF * track_m;
        Self {
            mass_kg: self.mass_kg + mass,
            inertia_kg_m2: self.inertia_kg_m2 + lever * lever * mass,
            wheels: self.wheels,
        }
    }

    /// How hard the tyres push to turn the base, beside how hard they push to move it, rim for rim and acceleration for acceleration: 4I/(m l²).
    ///
    /// The rims' forces are m a/2 ± I α/l; those of a rim's own acceleration a ± α l/2 are as large where this is 1. The base of the paper
    /// has 8.
    pub(crate) fn turning_load(&self) -> T {
        let lever = T::HALF * self.wheels.track_m;
        self.inertia_kg_m2 / (self.mass_kg * lever * lever)
    }

    /// Mass and inertia; the wheels are checked where their map is made.
    pub(crate) fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::Mass, self.mass_kg, 1.0e-3, 1.0e5),
            (Field::Inertia, self.inertia_kg_m2, 1.0e-6, 1.0e6),
        ]
    }
}

/// Rate of change of a pose: how a base that neither slips nor skids moves. Eq. (1).
///
/// ẋ = v cos θ,  ẏ = v sin θ,  θ̇ = w
///
/// | symbol | argument | unit | frame |
/// | --- | --- | --- | --- |
/// | θ | `pose.theta` | rad | world |
/// | v, w | `twist` | m/s, rad/s | body |
/// | ẋ, ẏ, θ̇ | result | m/s, m/s, rad/s | world |
pub fn pose_rate<T: Scalar, M: Maths<T>>(pose: &Pose<T>, twist: &Twist<T>) -> Pose<T> {
    let (sine, cosine) = M::sin_cos(pose.theta);
    Pose {
        x: twist.linear * cosine,
        y: twist.linear * sine,
        theta: twist.angular,
    }
}

/// Sideways speed \[m/s\]: zero exactly when the rolling constraint holds. Eq. (2).
///
/// A(q) q̇ = −ẋ sin θ + ẏ cos θ
///
/// A residual to check with, not a law: feed it a differentiated external pose, and what it
/// returns is skid.
pub fn constraint_residual<T: Scalar, M: Maths<T>>(pose: &Pose<T>, rate: &Pose<T>) -> T {
    let (sine, cosine) = M::sin_cos(pose.theta);
    rate.y * cosine - rate.x * sine
}

/// Acceleration of the body under a wrench. Eq. (3).
///
/// m v̇ = τ₁,  I ẇ = τ₂
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | m, I | `robot` | kg, kg m² |
/// | τ₁, τ₂ | `wrench` | N, N m |
pub fn acceleration<T: Scalar>(robot: &Robot<T>, wrench: &Wrench<T>) -> Accel<T> {
    Accel {
        linear: wrench.force / robot.mass_kg,
        angular: wrench.moment / robot.inertia_kg_m2,
    }
}

/// The wrench that gives the body an acceleration: Eq. (3) solved for τ̄.
pub fn wrench_for<T: Scalar>(robot: &Robot<T>, accel: &Accel<T>) -> Wrench<T> {
    Wrench {
        force: robot.mass_kg * accel.linear,
        moment: robot.inertia_kg_m2 * accel.angular,
    }
}
