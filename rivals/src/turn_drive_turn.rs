//! Turns, a drive, a turn.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, error, gain, sin_cos};
use crate::plan::Plan;

/// Turning, driving, turning with trapezoids, with proportional feedback on the way and on the heading.
#[derive(Clone, Copy, Debug)]
pub struct TurnDriveTurn {
    along: f32,
    around: f32,
    across: f32,
    plan: Plan,
}

impl TurnDriveTurn {
    /// No paper has them: a time constant of 0.5 s for the way \[1/s\] and of 0.25 s for the heading \[1/s\], the lateral
    /// error by a heading of a radian a metre \[rad/m\], and nine tenths of the limits for the trapezoids.
    pub const GAINS: [Gain; 4] = [
        Gain {
            name: "along",
            usual: 2.0,
        },
        Gain {
            name: "around",
            usual: 4.0,
        },
        Gain {
            name: "across",
            usual: 1.0,
        },
        Gain {
            name: "share",
            usual: 0.9,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        let share = gain(gains, 3);
        Self {
            along: gain(gains, 0),
            around: gain(gains, 1),
            across: gain(gains, 2),
            plan: Plan::new(body).with_share(if share < 1.0 { share } else { 1.0 }),
        }
    }
}

impl Rival for TurnDriveTurn {
    /// v = v_r cos e_θ + k₁ e_x, w = w_r + k₂ (sin e_θ + k₃ sgn(v_r) e_y).
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        let reference = self.plan.reference(now, job)?;
        let e = error(reference.pose(), &now.pose);
        let (v, w) = (reference.twist().linear, reference.twist().angular);
        let (sine, cosine) = sin_cos(e.theta);
        let side = if v > 0.0 {
            1.0
        } else if v < 0.0 {
            -1.0
        } else {
            0.0
        };
        let turn = w + self.around * (sine + self.across * side * e.y);
        Some(Wanted::of(v * cosine + self.along * e.x, turn).with(*reference.accel()))
    }
}
