//! Regulated pure pursuit.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, atan2, between, error, gain, norm, sqrt};
use crate::pursuit::Progress;
use controller_core::motion::Limits;
use controller_core::types::Pose;

/// Pure pursuit that slows down in curves and near its goal, and turns in place to begin and to end.
///
/// It parks along the line from where it is; a path's speeds are limits to it, as Nav2's speed limit is.
#[derive(Clone, Copy, Debug)]
pub struct PurePursuit {
    lookahead: f32,
    approach: f32,
    radius: f32,
    turn_angle: f32,
    turn_rate: f32,
    least: f32,
    limits: Limits<f32>,
    near: f32,
    turn_accel: f32,
    arrived: bool,
    line: Option<(Pose<f32>, Pose<f32>)>,
    progress: Progress,
}

/// Largest angular acceleration of Nav2's `max_angular_accel` \[rad/s²\], unless the base has less.
const TURN_ACCEL: f32 = 3.2;
/// Slowest speed in curves, `regulated_linear_scaling_min_speed` \[m/s\].
const SLOWEST: f32 = 0.25;

impl PurePursuit {
    /// `lookahead_dist` \[m\], `approach_velocity_scaling_dist` \[m\], `regulated_linear_scaling_min_radius` \[m\],
    /// `rotate_to_heading_min_angle` \[rad\], `rotate_to_heading_angular_vel` \[rad/s\] and
    /// `min_approach_linear_velocity` \[m/s\]: Nav2's defaults. The desired speed is the base's.
    pub const GAINS: [Gain; 6] = [
        Gain {
            name: "lookahead",
            usual: 0.6,
        },
        Gain {
            name: "approach",
            usual: 0.6,
        },
        Gain {
            name: "radius",
            usual: 0.9,
        },
        Gain {
            name: "turn angle",
            usual: 0.785,
        },
        Gain {
            name: "turn rate",
            usual: 1.8,
        },
        Gain {
            name: "least speed",
            usual: 0.05,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        let limits = body.limits;
        let at_most = |value: f32, most: f32| if value < most { value } else { most };
        Self {
            lookahead: gain(gains, 0),
            approach: gain(gains, 1),
            radius: gain(gains, 2),
            turn_angle: gain(gains, 3),
            turn_rate: at_most(gain(gains, 4), limits.turn_rate),
            least: gain(gains, 5),
            limits,
            near: body.distance_m,
            turn_accel: at_most(TURN_ACCEL, limits.turn_accel),
            arrived: false,
            line: None,
            progress: Progress::default(),
        }
    }

    /// Turns in place, so that it can still stop.
    fn rotate(&self, angle: f32) -> Wanted {
        let stop = sqrt(2.0 * self.turn_accel * angle.abs());
        let rate = if stop < self.turn_rate {
            stop
        } else {
            self.turn_rate
        };
        Wanted::of(0.0, if angle < 0.0 { -rate } else { rate })
    }

    /// κ = 2 y/L² to the carrot at (x, y); the speed is regulated by κ and by the way to the goal.
    fn pursue(&mut self, now: &Now, goal: &Pose<f32>, carrot: (f32, f32), speed: f32) -> Wanted {
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
        let (x, y) = if speed < 0.0 {
            (-carrot.0, -carrot.1)
        } else {
            carrot
        };
        let bearing = atan2(y, x);
        if bearing.abs() > self.turn_angle {
            return self.rotate(bearing);
        }
        let length = norm(x, y);
        let curvature = 2.0 * carrot.1 / (length * length);
        let sharpness = curvature.abs() * self.radius;
        let top = speed.abs();
        let slow = if top < SLOWEST { top } else { SLOWEST };
        let regulated = if sharpness > 1.0 {
            between(top / sharpness, slow, top)
        } else {
            top
        };
        let scaled = if far < self.approach {
            between(top * far / self.approach, self.least, top)
        } else {
            top
        };
        let v = if scaled < regulated {
            scaled
        } else {
            regulated
        };
        let v = if speed < 0.0 { -v } else { v };
        Wanted::of(v, v * curvature)
    }
}

impl Rival for PurePursuit {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        match job {
            Job::Follow(path) => {
                let view = self.progress.view(now, path, self.lookahead)?;
                let carrot = error(view.ahead.pose(), &now.pose);
                // The goal counts once the end of the path is in sight.
                let goal = if view.ends {
                    view.goal
                } else {
                    *view.ahead.pose()
                };
                let speed = if view.speed.abs() > self.least {
                    view.speed
                } else if view.speed < 0.0 {
                    -self.least
                } else {
                    self.least
                };
                Some(self.pursue(now, &goal, (carrot.x, carrot.y), speed))
            }
            Job::Park(goal) => {
                let (from, _) = *self.line.get_or_insert((now.pose, *goal));
                let (dx, dy) = (goal.x - from.x, goal.y - from.y);
                let length = norm(dx, dy);
                let e = error(goal, &now.pose);
                let far = norm(e.x, e.y);
                // A point of the line, so far ahead of the robot.
                let left = far - self.lookahead;
                let carrot = if left > 0.0 && length > 0.0 {
                    let (bx, by) = (goal.x - now.pose.x, goal.y - now.pose.y);
                    let to_go = (bx * dx + by * dy) / length;
                    let aside = norm(bx - to_go * dx / length, by - to_go * dy / length);
                    let reach = sqrt(self.lookahead * self.lookahead - aside * aside);
                    let short = to_go - reach;
                    let share = if short > 0.0 { short / length } else { 0.0 };
                    let point = Pose::new(goal.x - share * dx, goal.y - share * dy, goal.theta);
                    error(&point, &now.pose)
                } else {
                    e
                };
                Some(self.pursue(now, goal, (carrot.x, carrot.y), self.limits.speed))
            }
        }
    }
}
