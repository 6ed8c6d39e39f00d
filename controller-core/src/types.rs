//! Poses, twists, wrenches: the quantities that cross the border of the core.
//!
//! SI units and radians throughout. World frame: x, y in the plane, headings counter-clockwise
//! from x. Body frame: x forward, y left. Where wheels come in pairs, right comes before left.

use crate::cast::cast;
use crate::scalar::Scalar;
use crate::scalar::residue;

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

    pub(crate) fn residue(&self) -> T {
        residue([self.x, self.y, self.theta])
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
