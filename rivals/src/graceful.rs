//! The graceful motion law.

use crate::law::{
    Body, Gain, Job, Now, Rival, Wanted, atan2, between, clamp, error, gain, norm, sin_cos,
};
use crate::pursuit::Progress;
use controller_core::angle::wrap;
use controller_core::motion::Limits;
use controller_core::types::Pose;

/// Park and Kuipers' law in polar coordinates about the goal, as Nav2 runs it.
#[derive(Clone, Copy, Debug)]
pub struct Graceful {
    k_phi: f32,
    k_delta: f32,
    beta: f32,
    slowdown: f32,
    least: f32,
    rotation: f32,
    limits: Limits<f32>,
    near: f32,
    /// The heading at the goal is turned to there, not on the way.
    last_turn: bool,
    arrived: bool,
    begun: bool,
    progress: Progress,
}

/// `max_lookahead` on a path \[m\].
const LOOKAHEAD: f32 = 1.0;
/// `initial_rotation_tolerance` \[rad\].
const BEGIN: f32 = 0.75;
/// `v_angular_min_in_place` \[rad/s\].
const IN_PLACE: f32 = 0.25;

impl Graceful {
    /// `k_phi`, `k_delta`, `beta`, `slowdown_radius` \[m\], `v_linear_min` \[m/s\] and `rotation_scaling_factor`: Nav2's
    /// defaults. `lambda` is 2, as there. The largest speeds are the base's.
    pub const GAINS: [Gain; 6] = [
        Gain {
            name: "k_phi",
            usual: 2.0,
        },
        Gain {
            name: "k_delta",
            usual: 1.0,
        },
        Gain {
            name: "beta",
            usual: 0.4,
        },
        Gain {
            name: "slowdown",
            usual: 1.5,
        },
        Gain {
            name: "least speed",
            usual: 0.1,
        },
        Gain {
            name: "rotation",
            usual: 0.5,
        },
    ];

    /// With gains in the order of the list; `last_turn` is Nav2's `prefer_final_rotation`.
    pub fn new(body: &Body, gains: &[f32], last_turn: bool) -> Self {
        Self {
            k_phi: gain(gains, 0),
            k_delta: gain(gains, 1),
            beta: gain(gains, 2),
            slowdown: gain(gains, 3),
            least: gain(gains, 4),
            rotation: gain(gains, 5),
            limits: body.limits,
            near: body.distance_m,
            last_turn,
            arrived: false,
            begun: false,
            progress: Progress::default(),
        }
    }

    fn rotate(&self, angle: f32) -> Wanted {
        let rate = self.rotation * angle * self.limits.turn_rate;
        let least = if angle < 0.0 { -IN_PLACE } else { IN_PLACE };
        let rate = if rate.abs() < IN_PLACE { least } else { rate };
        Wanted::of(0.0, clamp(rate, self.limits.turn_rate))
    }

    /// κ = −1/r (k_δ (δ − atan(−k_φ φ)) + (1 + k_φ/(1 + (k_φ φ)²)) sin δ), v = v_max/(1 + β κ²), less near the goal.
    fn to(&self, now: &Now, target: &Pose<f32>, top: f32, headed: bool) -> Wanted {
        let e = error(target, &now.pose);
        let r = norm(e.x, e.y);
        let delta = -atan2(e.y, e.x);
        let phi = if headed { wrap(e.theta + delta) } else { 0.0 };
        let slope = self.k_phi * phi;
        let curvature = -(self.k_delta * (delta - atan2(-slope, 1.0))
            + (1.0 + self.k_phi / (1.0 + slope * slope)) * sin_cos(delta).0)
            / if r > 1.0e-4 { r } else { 1.0e-4 };
        let v = top / (1.0 + self.beta * curvature * curvature);
        let slow = top * r / self.slowdown;
        let least = if self.least < top { self.least } else { top };
        let v = between(if slow < v { slow } else { v }, least, top);
        let w = clamp(curvature * v, self.limits.turn_rate);
        let v = if curvature.abs() > 1.0e-6 {
            w / curvature
        } else {
            v
        };
        Wanted::of(v, w)
    }

    fn advance_to(
        &mut self,
        now: &Now,
        (target, top, headed): (&Pose<f32>, f32, bool),
        goal: Option<&Pose<f32>>,
    ) -> Wanted {
        if let Some(goal) = goal {
            let e = error(goal, &now.pose);
            let far = norm(e.x, e.y);
            self.arrived = far
                < if self.arrived {
                    self.near
                } else {
                    0.5 * self.near
                };
            if self.arrived {
                return self.rotate(e.theta);
            }
        }
        let e = error(target, &now.pose);
        let bearing = atan2(e.y, e.x);
        self.begun |= bearing.abs() < BEGIN;
        if !self.begun {
            return self.rotate(bearing);
        }
        self.to(now, target, top, headed)
    }
}

impl Rival for Graceful {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        match job {
            Job::Follow(path) => {
                let view = self.progress.view(now, path, LOOKAHEAD)?;
                let speed = view.speed.abs();
                let top = if speed > self.least {
                    speed
                } else {
                    self.least
                };
                let headed = !(view.ends && self.last_turn);
                let goal = view.ends.then_some(view.goal);
                Some(self.advance_to(now, (view.ahead.pose(), top, headed), goal.as_ref()))
            }
            Job::Park(goal) => {
                let target = (goal, self.limits.speed, !self.last_turn);
                Some(self.advance_to(now, target, Some(goal)))
            }
        }
    }
}
