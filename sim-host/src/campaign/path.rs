//! What a host has driven: references along a line or an arc, or velocity orders.

use super::random::Random;
use controller_core::motion::Limits;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};
use protocol::{Command, WireTwist};

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

/// Velocity orders: one twist after the other, for as long each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VelocityOrders {
    /// What is drawn.
    pub seed: u64,
    /// How long a twist is ordered \[s\].
    pub lasts_s: f64,
    /// Largest speed and turn rate \[m/s, rad/s\].
    pub most: (f64, f64),
    pub hold_heading: bool,
}

impl VelocityOrders {
    /// Drawn for a base: steps in 0.1 to 1.5 s, up to its limits, and for some beyond them. What is to be stopped on its way has to
    /// come to some speed: `fast`.
    pub(super) fn draw(limits: &Limits<f64>, fast: bool, random: &mut Random) -> Self {
        let share = if random.chance(0.2) {
            2.0
        } else {
            random.between(if fast { 0.5 } else { 0.1 }, 0.8)
        };
        Self {
            seed: random.word(),
            lasts_s: random.between(if fast { 1.0 } else { 0.1 }, 1.5),
            most: (share * limits.speed, share * limits.turn_rate),
            hold_heading: random.chance(0.5),
        }
    }

    /// The order at `t` \[s\]; the first one drives forward.
    pub(super) fn at(&self, t: f64) -> Command {
        let piece = (t / self.lasts_s) as u64;
        let mut random = Random::new(self.seed, piece);
        let (v, w) = match (piece, random.below(6)) {
            (0, _) => (random.between(0.3, 1.0), 0.0),
            (_, 0) => (0.0, 0.0),
            (_, 1) => (0.0, random.between(-1.0, 1.0)),
            (_, 2) => (random.between(-1.0, 1.0), 0.0),
            _ => (random.between(-1.0, 1.0), random.between(-1.0, 1.0)),
        };
        Command::Drive {
            twist: WireTwist {
                v: (v * self.most.0) as f32,
                w: (w * self.most.1) as f32,
            },
            hold_heading: self.hold_heading,
        }
    }
}

/// To the controller's numbers.
pub(super) fn narrow(pose: &Pose<f64>) -> Pose<f32> {
    Pose::new(pose.x as f32, pose.y as f32, pose.theta as f32)
}
