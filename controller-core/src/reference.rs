//! The moving reference of Eq. (6), and the virtual target point.

use crate::maths::{Maths, Usual};
use crate::scalar::{Scalar, residue};
use crate::types::{Accel, Pose, Twist};

/// A direction in the plane as a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading<T> {
    /// Component along x.
    pub cos: T,
    /// Component along y.
    pub sin: T,
}

/// One sample of a reference trajectory: what the law needs to know of it at a tick.
///
/// It carries the unit vector of its heading, so that whoever makes samples ahead of time (a
/// planner, a table in flash) pays for sine and cosine, and not the control tick. Hence fields are
/// read through functions: the vector always belongs to the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<T = f32> {
    pose: Pose<T>,
    heading: Heading<T>,
    twist: Twist<T>,
    accel: Accel<T>,
    left_m: T,
}

impl<T: Usual> Reference<T> {
    /// [`new_with`](Self::new_with) the usual mathematics of the number type.
    #[inline]
    pub fn new(pose: Pose<T>, twist: Twist<T>, accel: Accel<T>) -> Self {
        Self::new_with::<T::Maths>(pose, twist, accel)
    }

    /// [`at_rest_with`](Self::at_rest_with) the usual mathematics of the number type.
    pub fn at_rest(pose: Pose<T>) -> Self {
        Self::at_rest_with::<T::Maths>(pose)
    }
}

impl<T: Scalar> Reference<T> {
    /// A sample: q_r = (x_r, y_r, θ_r), (v_r, w_r) and (v̇_r, ẇ_r). Values are checked where they are
    /// used, at the tick.
    #[inline]
    pub fn new_with<M: Maths<T>>(pose: Pose<T>, twist: Twist<T>, accel: Accel<T>) -> Self {
        let (sin, cos) = M::sin_cos(pose.theta);
        Self {
            pose,
            heading: Heading { cos, sin },
            twist,
            accel,
            left_m: T::ZERO,
        }
    }

    /// The same with `left_m` to go until its path comes to rest \[m\]: see [`left_m`](Self::left_m).
    #[inline]
    #[must_use]
    pub fn with_left(self, left_m: T) -> Self {
        Self { left_m, ..self }
    }

    /// A reference that stands still at `pose`.
    pub fn at_rest_with<M: Maths<T>>(pose: Pose<T>) -> Self {
        Self::new_with::<M>(pose, Twist::default(), Accel::default())
    }

    /// The same in another precision, in which the unit vector is worked out anew.
    pub fn cast_with<S: Scalar, M: Maths<S>>(&self) -> Reference<S> {
        Reference::new_with::<M>(self.pose.cast(), self.twist.cast(), self.accel.cast())
            .with_left(self.left_m.cast())
    }

    /// q_r = (x_r, y_r, θ_r).
    #[inline]
    pub fn pose(&self) -> &Pose<T> {
        &self.pose
    }

    /// (cos θ_r, sin θ_r).
    #[inline]
    pub fn heading(&self) -> &Heading<T> {
        &self.heading
    }

    /// (v_r, w_r).
    #[inline]
    pub fn twist(&self) -> &Twist<T> {
        &self.twist
    }

    /// It stands: a reference that is made of numbers ends with their rounding, so slower than 1e-6 m/s and 1e-6 rad/s is rest.
    pub fn stands(&self) -> bool {
        let least = T::from_f64(1.0e-6);
        self.twist.linear.abs() < least && self.twist.angular.abs() < least
    }

    /// (v̇_r, ẇ_r).
    #[inline]
    pub fn accel(&self) -> &Accel<T> {
        &self.accel
    }

    /// What its path has to go until it comes to rest \[m\], all of it forward or all of it backward; 0, or less, where that is not so
    /// or nobody knows. A base that is beside its path is led to its end by it ([`PathEnd`](crate::motion::PathEnd)).
    #[inline]
    pub fn left_m(&self) -> T {
        self.left_m
    }

    /// Everything finite.
    pub fn is_finite(&self) -> bool {
        let motion = self.pose.residue() + self.twist.residue() + self.accel.residue();
        motion + residue([self.left_m]) == T::ZERO
    }
}

/// A reference with constant v_r and w_r: a line, an arc, or a turn in place. Eq. (6) in closed form.
///
/// ```
/// use controller_core::maths::Libm;
/// use controller_core::reference::ConstantTwist;
/// use controller_core::types::{Pose, Twist};
///
/// let curve = ConstantTwist {
///     start: Pose::new(0.0, 0.0, 0.0),
///     twist: Twist::new(0.4, 0.15),
/// };
/// let target = *curve.at::<Libm>(10.0).pose();
/// assert!((target.x - 2.659_99_f64).abs() < 1e-5 && (target.y - 2.478_03).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantTwist<T = f32> {
    /// Pose at time 0.
    pub start: Pose<T>,
    /// Constant (v_r, w_r).
    pub twist: Twist<T>,
}

impl<T: Scalar> ConstantTwist<T> {
    /// The reference at time `t` \[s\]. Eq. (6).
    ///
    /// Over the turn φ = w_r t the chord has length v_r t · sin(φ/2)/(φ/2) and direction
    /// θ_r(0) + φ/2; both are smooth through w_r = 0, so line and arc are one formula.
    pub fn at<M: Maths<T>>(&self, t: T) -> Reference<T> {
        let half_turn = T::HALF * self.twist.angular * t;
        let (sine, cosine) = M::sin_cos(self.start.theta + half_turn);
        let chord = self.twist.linear * t * sinc::<T, M>(half_turn);
        let pose = Pose {
            x: self.start.x + chord * cosine,
            y: self.start.y + chord * sine,
            theta: self.start.theta + self.twist.angular * t,
        };
        Reference::new_with::<M>(pose, self.twist, Accel::default())
    }
}

/// sin(x)/x, by its series where the quotient would lose digits.
pub(crate) fn sinc<T: Scalar, M: Maths<T>>(x: T) -> T {
    // Below 1e-2 the series to x⁴ is exact to 2e-16 (next term x⁶/5040).
    if x.abs() < T::from_f64(1.0e-2) {
        let x2 = x * x;
        T::ONE - x2 * (T::from_f64(1.0 / 6.0) - x2 * T::from_f64(1.0 / 120.0))
    } else {
        M::sin_cos(x).0 / x
    }
}

/// When to leave the trajectory and where to park: the paper's P and N.
///
/// The virtual target point is the reference pose at P; the real target is another pose, usually
/// that of the reference at N > P. Their difference is the pulse that the pose error shows at the
/// hand-over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParkingPlan<T> {
    /// P \[s\]: the first tick at or after this time hands over.
    pub hand_over_s: T,
    /// q_r(N): where to park.
    pub goal: Pose<T>,
}

impl<T: Scalar> ParkingPlan<T> {
    /// Parks where the reference will be at N = `target_s`, leaving it at P = `hand_over_s`.
    pub fn along<M: Maths<T>>(path: &ConstantTwist<T>, hand_over_s: T, target_s: T) -> Self {
        Self {
            hand_over_s,
            goal: path.at::<M>(target_s).pose,
        }
    }

    /// It is time to park at `t` \[s\]. The slack of 1 ns keeps k·dt, summed in floating point,
    /// from being one tick late.
    pub fn is_due(&self, t: T) -> bool {
        t >= self.hand_over_s - T::from_f64(1.0e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::{ConstantTwist, ParkingPlan, Reference, sinc};
    use crate::maths::{Libm, Maths};
    use crate::types::{Accel, Pose, Twist};

    /// x' = v cos θ, y' = v sin θ, θ' = w, from the start on: central differences err by h²/6 of a third derivative below 0.1.
    #[test]
    fn a_constant_twist_drives_as_eq_6_says() {
        for (v, w) in [
            (0.4, 0.15),
            (-0.3, 0.8),
            (0.5, 0.0),
            (0.2, 1e-5),
            (0.0, -0.7),
        ] {
            let motion = ConstantTwist {
                start: Pose::new(1.2, -0.7, 0.3),
                twist: Twist::new(v, w),
            };
            assert_eq!(*motion.at::<Libm>(0.0).pose(), motion.start);
            let h = 1e-4;
            for t in [0.5, 4.0, 11.0] {
                let pose = |t| *motion.at::<Libm>(t).pose();
                let (before, now, after) = (pose(t - h), pose(t), pose(t + h));
                let rate = |a: f64, b: f64| (b - a) / (2.0 * h);
                let (sine, cosine) = Libm::sin_cos(now.theta);
                assert!(
                    (rate(before.x, after.x) - v * cosine).abs() < 1e-8,
                    "{v} {w} {t}"
                );
                assert!(
                    (rate(before.y, after.y) - v * sine).abs() < 1e-8,
                    "{v} {w} {t}"
                );
                assert!((rate(before.theta, after.theta) - w).abs() < 1e-10);
                assert_eq!(*motion.at::<Libm>(t).twist(), motion.twist);
            }
        }
    }

    /// Both branches, and where they meet.
    #[test]
    fn sinc_is_the_quotient() {
        assert_eq!(sinc::<f64, Libm>(0.0), 1.0);
        for x in [1e-6_f64, 5e-3, 0.009_999_9, 0.010_000_1, 0.7, 3.0] {
            for x in [x, -x] {
                let quotient = Libm::sin_cos(x).0 / x;
                assert!((sinc::<f64, Libm>(x) - quotient).abs() < 3e-16, "{x}");
            }
        }
    }

    #[test]
    fn a_plan_is_due_from_its_time_on() {
        let path = ConstantTwist {
            start: Pose::new(0.0, 0.0, 0.0),
            twist: Twist::new(0.4, 0.0),
        };
        let plan = ParkingPlan::along::<Libm>(&path, 3.0_f64, 5.0);
        assert!((plan.goal.x - 2.0).abs() < 1e-12);
        assert!(plan.is_due(3.0) && plan.is_due(9.0) && plan.is_due(3.0 - 0.9e-9));
        assert!(!plan.is_due(3.0 - 2e-9) && !plan.is_due(0.0));
    }

    /// Whatever of it is not a number, one number or two of opposite sign.
    #[test]
    fn a_reference_is_finite_if_all_of_it_is() {
        let with = |pose, v, a, left| {
            let twist = Twist::new(v, 0.0);
            Reference::new(pose, twist, Accel::new(a, 0.0)).with_left(left)
        };
        let (here, wild) = (Pose::new(1.0, 2.0, 3.0), Pose::new(f32::NAN, 0.0, 0.0));
        assert!(with(here, 1.0, -1.0, 0.5).is_finite());
        assert_eq!(with(here, 1.0, -1.0, 0.5).left_m(), 0.5);
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!with(here, wrong, 0.0, 0.0).is_finite());
            assert!(!with(here, 0.0, wrong, 0.0).is_finite());
            assert!(!with(here, 0.0, 0.0, wrong).is_finite());
            assert!(!with(wild, wrong, wrong, wrong).is_finite());
        }
        assert!(!with(wild, 0.0, 0.0, 0.0).is_finite());
    }

    /// What a retimed file ends with in single precision is rest; the slowest order that a base holds is not.
    #[test]
    fn what_rounds_to_rest_stands() {
        let with = |v, w| {
            let motion = ConstantTwist {
                start: Pose::<f64>::default(),
                twist: Twist::new(v, w),
            };
            motion.at::<Libm>(0.0)
        };
        assert!(Reference::at_rest(Pose::<f64>::default()).stands());
        assert!(with(1.3e-9, -5.1e-11).stands());
        assert!(!with(1e-3, 0.0).stands());
        assert!(!with(0.0, -1e-3).stands());
    }
}
