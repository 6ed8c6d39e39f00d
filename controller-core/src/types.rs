//! Poses, twists, wrenches: the quantities that cross the border of the core.
//!
//! SI units and radians throughout. World frame: x, y in the plane, headings counter-clockwise
//! from x. Body frame: x forward, y left. Where wheels come in pairs, right comes before left.

use crate::cast::cast;
use crate::error::{Input, StepFault};
use crate::scalar::Scalar;
use crate::scalar::residue;

/// Farthest from the origin of its frame that a pose may be stated in x and in y \[m\]: the next number in single precision is 0.12 mm away there,
/// a quarter of the tolerance of [`Arrival::exact`](crate::motion::Arrival). Maps in metres from a far datum (UTM, say) need an origin of their own.
pub const FARTHEST_M: f64 = 2000.0;

/// Largest heading that may be stated \[rad\], all turns counted: the next number in single precision is 8 mrad away there.
const MOST_TURNED: f64 = 1.0e5;

/// Position and heading in the world frame: the q = (x, y, θ)ᵀ of Eq. (1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose<T = f32> {
    /// Position \[m\].
    pub x: T,
    /// Position \[m\].
    pub y: T,
    /// Heading \[rad\], counter-clockwise; not wrapped.
    pub theta: T,
}

cast!(Pose { x, y, theta });

/// Forward speed and turn rate: the v̄ = (v, w)ᵀ of Eq. (1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Twist<T = f32> {
    /// Speed along the heading \[m/s\]; negative backs up.
    pub linear: T,
    /// Turn rate \[rad/s\], counter-clockwise.
    pub angular: T,
}

cast!(Twist { linear, angular });

/// Rate of change of a [`Twist`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Accel<T = f32> {
    /// \[m/s²\].
    pub linear: T,
    /// \[rad/s²\].
    pub angular: T,
}

cast!(Accel { linear, angular });

/// Force along the heading and moment about the vertical: the τ̄ = (τ₁, τ₂)ᵀ of Eq. (3).
///
/// The paper calls both "torques"; with M̄ = diag(m, I) the first one is a force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench<T = f32> {
    /// τ₁ \[N\].
    pub force: T,
    /// τ₂ \[N m\], counter-clockwise.
    pub moment: T,
}

cast!(Wrench { force, moment });

/// Torques at the two wheels \[N m\]; positive drives the robot forward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelTorques<T = f32> {
    /// Right wheel.
    pub right: T,
    /// Left wheel.
    pub left: T,
}

cast!(WheelTorques { right, left });

/// Angular speeds of the two wheels \[rad/s\]; positive drives the robot forward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelSpeeds<T = f32> {
    /// Right wheel.
    pub right: T,
    /// Left wheel.
    pub left: T,
}

cast!(WheelSpeeds { right, left });

/// What the base knows of itself at a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measured<T = f32> {
    /// Pose in the world frame.
    pub pose: Pose<T>,
    /// Speed and turn rate in the body frame.
    pub twist: Twist<T>,
}

cast!(Measured { pose, twist });

impl<T: Scalar> Pose<T> {
    /// A pose from its three coordinates \[m, m, rad\].
    pub const fn new(x: T, y: T, theta: T) -> Self {
        Self { x, y, theta }
    }

    /// All coordinates finite.
    pub fn is_finite(&self) -> bool {
        self.residue() == T::ZERO
    }

    /// Finite, and no farther than single precision can tell places apart: ±[`FARTHEST_M`], ±10⁵ rad.
    pub fn is_near(&self) -> bool {
        let most = T::from_f64(FARTHEST_M);
        let turned = T::from_f64(MOST_TURNED);
        self.x.abs() <= most && self.y.abs() <= most && self.theta.abs() <= turned
    }

    /// Looks whether it [is near](Self::is_near), by the name of an input.
    ///
    /// # Errors
    /// [`StepFault::NotFinite`] or [`StepFault::OutOfRange`].
    pub fn check(&self, input: Input) -> Result<(), StepFault> {
        if self.is_near() {
            Ok(())
        } else if self.is_finite() {
            Err(StepFault::OutOfRange(input))
        } else {
            Err(StepFault::NotFinite(input))
        }
    }

    pub(crate) fn residue(&self) -> T {
        residue([self.x, self.y, self.theta])
    }

    /// Moves by `step` and by what rounding `lost` of the steps before it (Kahan's sum): a kilometre from the origin, or after a hundred turns, a
    /// slow base's way in a tick is less than the last digit.
    #[inline(always)]
    pub(crate) fn advance(&mut self, step: &Self, lost: &mut Self) {
        let add = |sum: &mut T, step: T, lost: &mut T| {
            let before = *sum;
            let step = step + *lost;
            *sum = before + step;
            *lost = step - (*sum - before);
        };
        add(&mut self.x, step.x, &mut lost.x);
        add(&mut self.y, step.y, &mut lost.y);
        add(&mut self.theta, step.theta, &mut lost.theta);
    }
}

impl<T: Scalar> Twist<T> {
    /// Component by component: measured minus commanded is the velocity error δ.
    #[inline(always)]
    pub fn minus(&self, other: &Self) -> Self {
        Self {
            linear: self.linear - other.linear,
            angular: self.angular - other.angular,
        }
    }

    /// A twist from speed \[m/s\] and turn rate \[rad/s\].
    pub const fn new(linear: T, angular: T) -> Self {
        Self { linear, angular }
    }

    /// Both components finite.
    pub fn is_finite(&self) -> bool {
        self.residue() == T::ZERO
    }

    pub(crate) fn residue(&self) -> T {
        residue([self.linear, self.angular])
    }
}

impl<T: Scalar> Accel<T> {
    /// An acceleration from its components \[m/s², rad/s²\].
    pub const fn new(linear: T, angular: T) -> Self {
        Self { linear, angular }
    }

    /// Both components finite.
    pub fn is_finite(&self) -> bool {
        self.residue() == T::ZERO
    }

    pub(crate) fn residue(&self) -> T {
        residue([self.linear, self.angular])
    }
}

impl<T: Scalar> Measured<T> {
    /// Everything finite.
    pub fn is_finite(&self) -> bool {
        self.pose.residue() + self.twist.residue() == T::ZERO
    }
}
