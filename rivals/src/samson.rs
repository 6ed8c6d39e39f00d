//! Samson's laws in chained form.

use crate::law::{Body, Gain, Job, Now, Path, Rival, Wanted, clamp, error, gain, norm, sin_cos};
use controller_core::angle::wrap;
use controller_core::types::Pose;

/// Tracking in chained form, and smooth time-varying stabilisation of a pose.
#[derive(Clone, Copy, Debug)]
pub struct Samson {
    along: f32,
    across: f32,
    around: f32,
    turn: f32,
    sway: f32,
    pace: f32,
    phase: f32,
}

/// The chained form ends at a quarter turn; the error that is fed back stays inside \[rad\].
const INSIDE: f32 = 1.2;

impl Samson {
    /// Tracking: k₁ \[1/m\], k₂ \[1/m²\], k₃ \[1/m\], poles at one per metre; parking: k \[1/s\], the amplitude of the sway
    /// \[rad/(s m)\] and its frequency \[rad/s\]. The papers leave the numbers open; theirs are of this size.
    pub const GAINS: [Gain; 6] = [
        Gain {
            name: "along",
            usual: 1.0,
        },
        Gain {
            name: "across",
            usual: 1.0,
        },
        Gain {
            name: "around",
            usual: 2.0,
        },
        Gain {
            name: "turn",
            usual: 1.0,
        },
        Gain {
            name: "sway",
            usual: 5.0,
        },
        Gain {
            name: "pace",
            usual: 1.0,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(_: &Body, gains: &[f32]) -> Self {
        Self {
            along: gain(gains, 0),
            across: gain(gains, 1),
            around: gain(gains, 2),
            turn: gain(gains, 3),
            sway: gain(gains, 4),
            pace: gain(gains, 5),
            phase: 0.0,
        }
    }

    /// With z = (x_e, y_e, tan θ_e), robot minus reference in the reference's frame:
    /// w₁ = −k₁ |v_r| (z₁ + z₂ z₃), w₂ = −k₂ v_r z₂ − k₃ |v_r| z₃, v = (v_r + w₁)/cos θ_e, w = w_r + w₂ cos² θ_e.
    fn track(&self, now: &Now, path: &Path<'_>) -> Option<Wanted> {
        let reference = path.at(0)?;
        // The robot as seen from the reference.
        let e = error(&now.pose, reference.pose());
        let (v, w) = (reference.twist().linear, reference.twist().angular);
        let (sine, cosine) = sin_cos(clamp(e.theta, INSIDE));
        let z3 = sine / cosine;
        let w1 = -self.along * v.abs() * (e.x + e.y * z3);
        let w2 = -self.across * v * e.y - self.around * v.abs() * z3;
        let wanted = Wanted::of((v + w1) / cosine, w + w2 * cosine * cosine);
        Some(wanted.with(*reference.accel()))
    }

    /// With x₁ = θ, x₂ = x sin θ − y cos θ, x₃ = x cos θ + y sin θ about the goal, a chain for u₁ = w, u₂ = v − w x₂:
    /// u₁ = −k x₁ + g |(x₂, x₃)| sin(Ω t), u₂ = −k₂ u₁ x₂ − k₃ |u₁| x₃.
    fn park(&mut self, now: &Now, goal: &Pose<f32>) -> Wanted {
        self.phase = wrap(self.phase + self.pace * now.dt);
        let e = error(goal, &now.pose);
        // The robot in the goal's frame, seen along its own heading: x₃ ahead, x₂ to the right of the goal.
        let (x1, x2, x3) = (-e.theta, e.y, -e.x);
        let u1 = -self.turn * x1 + self.sway * norm(x2, x3) * sin_cos(self.phase).0;
        let u2 = -self.across * u1 * x2 - self.around * u1.abs() * x3;
        Wanted::of(u2 + u1 * x2, u1)
    }
}

impl Rival for Samson {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        match job {
            Job::Follow(path) => self.track(now, path),
            Job::Park(goal) => Some(self.park(now, goal)),
        }
    }
}
