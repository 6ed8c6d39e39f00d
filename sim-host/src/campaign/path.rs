//! References along a line or an arc.

use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

/// What is followed: a line or an arc from the start, from rest to a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Path {
    /// \[m/s\].
    pub speed: f64,
    /// \[m/s²\].
    pub accel: f64,
    /// \[1/m\].
    pub curvature: f64,
}

impl Path {
    /// The sample at `t` \[s\]: from rest with constant acceleration, then at constant speed.
    pub(super) fn at(&self, t: f64) -> Reference<f32> {
        let ramp = self.speed / self.accel;
        let (speed, accel) = if t < ramp {
            (self.accel * t, self.accel)
        } else {
            (self.speed, 0.0)
        };
        let of = |linear: f64| (linear as f32, (self.curvature * linear) as f32);
        let (twist, rate) = (of(speed), of(accel));
        Reference::new(
            narrow(&self.pose(self.way(t))),
            Twist::new(twist.0, twist.1),
            Accel::new(rate.0, rate.1),
        )
    }

    /// Way at `t` \[m\].
    pub(super) fn way(&self, t: f64) -> f64 {
        let ramp = self.speed / self.accel;
        if t < ramp {
            0.5 * self.accel * t * t
        } else {
            self.speed * (t - 0.5 * ramp)
        }
    }

    /// The pose at a way \[m\].
    pub(super) fn pose(&self, way: f64) -> Pose<f64> {
        let turn = self.curvature * way;
        let half = 0.5 * turn;
        let chord = if half.abs() < 1.0e-9 {
            way
        } else {
            way * half.sin() / half
        };
        Pose::new(chord * half.cos(), chord * half.sin(), turn)
    }
}

/// To the controller's numbers.
pub(super) fn narrow(pose: &Pose<f64>) -> Pose<f32> {
    Pose::new(pose.x as f32, pose.y as f32, pose.theta as f32)
}
