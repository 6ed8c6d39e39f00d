//! How a base slows down on its own: with shorted motors, and with released ones.
//!
//! # Shorted
//!
//! A shorted motor has U = 0, so its back-EMF drives i = −g k_t ω/R, and the wheel feels at least
//!
//! ```text
//! τ = g k_t i = −κ ω        κ = (g k_t)²/R
//! ```
//!
//! (a lossy gear brakes more, see η). On wheels of radii r_R, r_L, a distance l apart, with ω_R = (v + l w/2)/r_R
//! and ω_L = (v − l w/2)/r_L, Eq. (3) becomes
//!
//! ```text
//! m v̇ = −κ s v        I ẇ = −κ s (l/2)² w        s = 1/r_R² + 1/r_L²
//! ```
//!
//! up to a coupling of κ (l/2)(1/r_R² − 1/r_L²), which is zero for equal wheels. With r_R = r_L = r:
//!
//! ```text
//! T_v = m r² R/(2 (g k_t)²)        T_w = 2 I r² R/(l² (g k_t)²)
//! ```
//!
//! so v(t) = v₀ exp(−t/T_v), and the way is ∫ v dt = v₀ T_v; likewise the angle w₀ T_w. The floor is level; friction
//! shortens both. What lengthens them: wheels that slide (the brake needs κ v₀/r² per wheel at first;
//! beyond µ m g/2 the rubber is what stops), and a slope. Shorting does not hold a base on a slope: it creeps at
//! m g sin(slope)/(κ s).
//!
//! # Released
//!
//! No current flows while the back-EMF is below the supply (above, the bridge's diodes conduct), so only the friction
//! of [`MotorParams`](crate::motor::MotorParams) is left, per wheel τ_c sgn ω + b ω:
//!
//! ```text
//! m v̇ = −b s v − τ_c (1/r_R + 1/r_L) sgn v        I ẇ = −b s (l/2)² w − τ_c (1/r_R + 1/r_L)(l/2) sgn w
//! ```

use crate::error::ParamError;
use crate::motor::Motor;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::wheels::WheelMap;

/// ẋ = −damping x − drag sgn x, of a speed \[m/s\] or a turn rate \[rad/s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay<T> {
    /// \[1/s\].
    pub damping: T,
    /// \[m/s²\] or \[rad/s²\].
    pub drag: T,
}

/// Both motions of a base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slowing<T> {
    /// Straight on \[m/s\].
    pub linear: Decay<T>,
    /// Turning \[rad/s\]; in an arc both go on side by side, and the curvature changes.
    pub angular: Decay<T>,
}

impl<T: Scalar> Decay<T> {
    /// Time in which the speed falls to 1/e without drag \[s\]; `None` if nothing damps.
    pub fn time_constant_s(&self) -> Option<T> {
        (self.damping > T::ZERO).then(|| T::ONE / self.damping)
    }

    /// Way until rest \[m\] or \[rad\] from a speed, in magnitude and from above: the smaller of |x|/damping and x²/(2 drag), each of
    /// which leaves out the other's cause. `None` if nothing slows the base down.
    pub fn distance(&self, speed: T) -> Option<T> {
        let speed = speed.abs();
        let damped = self.time_constant_s().map(|constant| speed * constant);
        let dragged = (self.drag > T::ZERO).then(|| T::HALF * speed * speed / self.drag);
        match (damped, dragged) {
            (Some(damped), Some(dragged)) if dragged < damped => Some(dragged),
            (None, dragged) => dragged,
            (damped, _) => damped,
        }
    }
}

/// Motors shorted, friction left out: an upper bound of the way on level floor.
///
/// # Errors
/// A mass, inertia or wheel out of its range.
pub fn electrical_brake<T: Scalar>(
    motor: &Motor<T>,
    robot: &Robot<T>,
) -> Result<Slowing<T>, ParamError> {
    let constant = motor.gear.constant;
    let damping = constant * constant * motor.per_resistance;
    slowing(robot, damping, T::ZERO)
}

/// Motors released: the motor's friction parameters are all that brakes.
///
/// # Errors
/// A mass, inertia or wheel out of its range.
pub fn coast<T: Scalar>(motor: &Motor<T>, robot: &Robot<T>) -> Result<Slowing<T>, ParamError> {
    let friction = &motor.params.friction;
    slowing(robot, friction.viscous_nm_s, friction.coulomb_nm)
}

/// Both wheels with τ = −`viscous` ω − `coulomb` sgn ω.
fn slowing<T: Scalar>(robot: &Robot<T>, viscous: T, coulomb: T) -> Result<Slowing<T>, ParamError> {
    robot.check()?;
    let (mass, inertia) = (robot.mass_kg, robot.inertia_kg_m2);
    let wheels = &robot.wheels;
    WheelMap::from_geometry(wheels)?;
    let (right, left) = (
        T::ONE / wheels.radius_right_m,
        T::ONE / wheels.radius_left_m,
    );
    let arm = T::HALF * wheels.track_m;
    let damping = viscous * (right * right + left * left);
    let drag = coulomb * (right + left);
    Ok(Slowing {
        linear: Decay {
            damping: damping / mass,
            drag: drag / mass,
        },
        angular: Decay {
            damping: damping * arm * arm / inertia,
            drag: drag * arm / inertia,
        },
    })
}
