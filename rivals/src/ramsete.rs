//! Ramsete.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, error, gain, sin_cos, sinc, sqrt};
use crate::plan::Plan;
use controller_core::reference::Reference;

/// The nonlinear tracking law that WPILib ships; it parks along a plan of turns and a drive.
#[derive(Clone, Copy, Debug)]
pub struct Ramsete {
    b: f32,
    zeta: f32,
    plan: Plan,
}

impl Ramsete {
    /// b \[rad²/m²\] and ζ: the defaults of WPILib's `RamseteController`.
    pub const GAINS: [Gain; 2] = [
        Gain {
            name: "b",
            usual: 2.0,
        },
        Gain {
            name: "zeta",
            usual: 0.7,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        Self {
            b: gain(gains, 0),
            zeta: gain(gains, 1),
            plan: Plan::new(body),
        }
    }

    /// v = v_r cos e_θ + k e_x, w = w_r + k e_θ + b v_r sinc(e_θ) e_y, k = 2 ζ √(w_r² + b v_r²).
    pub fn track(&self, now: &Now, reference: &Reference<f32>) -> Wanted {
        let e = error(reference.pose(), &now.pose);
        let (v, w) = (reference.twist().linear, reference.twist().angular);
        let k = 2.0 * self.zeta * sqrt(w * w + self.b * v * v);
        let cosine = sin_cos(e.theta).1;
        Wanted::of(
            v * cosine + k * e.x,
            w + k * e.theta + self.b * v * sinc(e.theta) * e.y,
        )
        .with(*reference.accel())
    }
}

impl Rival for Ramsete {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        let reference = self.plan.reference(now, job)?;
        Some(self.track(now, &reference))
    }
}
