//! Two PIDs.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, atan2, clamp, error, gain, norm, sin_cos};
use controller_core::angle::wrap;
use controller_core::types::Pose;

/// A PID on the distance and one on the heading.
#[derive(Clone, Copy, Debug)]
pub struct TwoPids {
    distance: Pid,
    heading: Pid,
    near: f32,
    /// It was at its goal, and turns there until it is this far off again.
    arrived: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct Pid {
    p: f32,
    i: f32,
    d: f32,
    most: f32,
    sum: f32,
    last: Option<f32>,
}

impl Pid {
    /// The integral stays within what the limit is worth.
    fn advance(&mut self, error: f32, dt: f32) -> f32 {
        let rate = match self.last {
            Some(last) if dt > 0.0 => wrap(error - last) / dt,
            _ => 0.0,
        };
        self.last = Some(error);
        self.sum = clamp(self.sum + self.i * error * dt, 0.1 * self.most);
        self.p * error + self.sum + self.d * rate
    }

    fn reset(&mut self) {
        (self.sum, self.last) = (0.0, None);
    }
}

impl TwoPids {
    /// Proportional gains 1.5 and 6 \[1/s\] of "Go to goal", a turtlesim tutorial of ROS; it has neither integral \[1/s²\]
    /// nor derivative \[1\].
    pub const GAINS: [Gain; 6] = [
        Gain {
            name: "distance p",
            usual: 1.5,
        },
        Gain {
            name: "heading p",
            usual: 6.0,
        },
        Gain {
            name: "distance i",
            usual: 0.0,
        },
        Gain {
            name: "heading i",
            usual: 0.0,
        },
        Gain {
            name: "distance d",
            usual: 0.0,
        },
        Gain {
            name: "heading d",
            usual: 0.0,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        let pid = |at: usize, most: f32| Pid {
            p: gain(gains, at),
            i: gain(gains, at + 2),
            d: gain(gains, at + 4),
            most,
            ..Pid::default()
        };
        Self {
            distance: pid(0, body.limits.speed),
            heading: pid(1, body.limits.turn_rate),
            near: body.distance_m,
            arrived: false,
        }
    }

    /// v = PID(e_x), w = PID(bearing), forward or backward, whichever is nearer; at the goal w = PID(e_θ).
    fn to(&mut self, now: &Now, goal: &Pose<f32>) -> Wanted {
        let e = error(goal, &now.pose);
        let far = norm(e.x, e.y);
        let at_goal = far
            < if self.arrived {
                self.near
            } else {
                0.5 * self.near
            };
        if at_goal != self.arrived {
            self.heading.reset();
        }
        self.arrived = at_goal;
        if at_goal {
            return Wanted::of(0.0, self.heading.advance(e.theta, now.dt));
        }
        let bearing = if e.x < 0.0 {
            atan2(-e.y, -e.x)
        } else {
            atan2(e.y, e.x)
        };
        // Not off to the side of where it should go.
        let ahead = sin_cos(bearing).1;
        Wanted::of(
            self.distance.advance(e.x, now.dt) * ahead,
            self.heading.advance(bearing, now.dt),
        )
    }
}

impl Rival for TwoPids {
    /// A moving goal is chased.
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        match job {
            Job::Follow(path) => Some(self.to(now, path.at(0)?.pose())),
            Job::Park(goal) => Some(self.to(now, goal)),
        }
    }
}
