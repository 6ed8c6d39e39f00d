//! A localiser on a robot that is led along a known way, without a controller.

use controller_core::localiser::{Estimate, Localiser, ValidLocaliserParams};
use controller_core::maths::Maths;
use controller_core::scalar::Scalar;
use controller_core::types::{Accel, Pose, Twist, WheelTorques};

use crate::encoded::Encoded;
use crate::fixes::{Source, fix};
use crate::ideal::Robot;
use crate::motion_base::{Base, pose};

/// Robot and localiser.
#[derive(Clone, Debug)]
pub struct Led<T, const N: usize> {
    /// The robot.
    pub robot: Encoded,
    /// The localiser.
    pub localiser: Localiser<T, N>,
    /// Time \[s\].
    pub t: f64,
}

impl<T: Scalar, const N: usize> Led<T, N> {
    /// The localiser believes the robot where it is.
    pub fn start(localisation: &ValidLocaliserParams<T>, robot: Encoded) -> Self {
        let localiser = Localiser::start(localisation, pose(&robot.body.pose), robot.counts());
        Self {
            robot,
            localiser: localiser.expect("a finite pose"),
            t: 0.0,
        }
    }

    /// A tick at a twist, which needs no torque whatever the robot is made of.
    pub fn advance<M: Maths<T>>(
        &mut self,
        twist: Twist<f64>,
        dt: f64,
        source: &mut Source,
    ) -> Estimate<T> {
        self.advance_told::<M>(twist, &Accel::default(), dt, source)
    }

    /// The same where the localiser is given an acceleration.
    pub fn advance_told<M: Maths<T>>(
        &mut self,
        twist: Twist<f64>,
        accel: &Accel<f64>,
        dt: f64,
        source: &mut Source,
    ) -> Estimate<T> {
        self.robot.body.twist = twist;
        self.robot = self
            .robot
            .after(&Base::STANDARD, &WheelTorques::default(), dt);
        self.t += dt;
        let fixed = source.poll(self.t, &self.robot.body.pose);
        let fixed = fixed.as_ref().map(fix);
        self.localiser
            .update_with_accel::<M>(
                self.robot.counts(),
                T::from_f64(dt),
                &accel.cast(),
                fixed.as_ref(),
            )
            .expect("the tick is accepted")
    }

    /// Reported minus true pose, in the true robot's frame, of an estimate.
    pub fn off(&self, estimate: &Estimate<T>) -> Pose<f64> {
        let (found, truth) = (&estimate.measured.pose, &self.robot.body.pose);
        let (sine, cosine) = truth.theta.sin_cos();
        let (dx, dy) = (found.x.to_f64() - truth.x, found.y.to_f64() - truth.y);
        Pose::new(
            dx * cosine + dy * sine,
            dy * cosine - dx * sine,
            controller_core::angle::wrap(found.theta.to_f64() - truth.theta),
        )
    }
}
