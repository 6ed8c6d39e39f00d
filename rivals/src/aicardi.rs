//! The polar law of Aicardi and others.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, atan2, error, gain, norm, sin_cos, sinc};
use controller_core::angle::wrap;
use controller_core::types::Pose;

/// Closed-loop steering in polar coordinates by a Lyapunov function.
#[derive(Clone, Copy, Debug)]
pub struct Aicardi {
    gamma: f32,
    k: f32,
    h: f32,
    near: f32,
}

impl Aicardi {
    /// γ \[1/s\], k \[1/s\], h: those of the paper's examples.
    pub const GAINS: [Gain; 3] = [
        Gain {
            name: "gamma",
            usual: 3.0,
        },
        Gain {
            name: "k",
            usual: 6.0,
        },
        Gain {
            name: "h",
            usual: 1.0,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        Self {
            gamma: gain(gains, 0),
            k: gain(gains, 1),
            h: gain(gains, 2),
            near: 0.2 * body.distance_m,
        }
    }

    /// u = γ e cos α, ω = k α + γ cos α sinc α (α + h θ), with α from the heading to the goal and θ from the goal's heading
    /// to the same line. Within a fifth of the tolerance, where the bearing is noise, only the heading is regulated.
    fn to(&self, now: &Now, goal: &Pose<f32>) -> Wanted {
        let e = error(goal, &now.pose);
        let far = norm(e.x, e.y);
        if far < self.near {
            return Wanted::of(0.0, self.k * e.theta);
        }
        let alpha = atan2(e.y, e.x);
        let theta = wrap(alpha - e.theta);
        let cosine = sin_cos(alpha).1;
        Wanted::of(
            self.gamma * far * cosine,
            self.k * alpha + self.gamma * cosine * sinc(alpha) * (alpha + self.h * theta),
        )
    }
}

impl Rival for Aicardi {
    /// A moving goal is chased.
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        match job {
            Job::Follow(path) => Some(self.to(now, path.at(0)?.pose())),
            Job::Park(goal) => Some(self.to(now, goal)),
        }
    }
}
