//! Plans for laws that follow a reference and cannot park by themselves.

use crate::law::{Body, Job, Now, atan2, error, norm, sin_cos};
use crate::trapezoid::Trapezoid;
use controller_core::angle::wrap;
use controller_core::motion::Limits;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

/// Share of the limits that a plan uses; the rest is for feedback.
pub(crate) const SHARE: f32 = 0.9;
/// A robot faster than this brakes along its path before anything else \[m/s\].
const MOVES: f32 = 0.05;
/// A robot that is beside its goal so long after the end of its plan plans again \[s\].
const PATIENCE: f32 = 0.5;
/// A turn below this is not worth planning \[rad\].
const LEAST_TURN: f32 = 1.0e-3;
/// Part of the tolerance within which a robot only turns at its goal.
const PLACED: f32 = 0.8;

/// A reference to a goal: turn, drive, turn, with trapezoids; from motion a stop along the path that it is on.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    limits: Limits<f32>,
    tolerance: (f32, f32),
    share: f32,
    course: Option<Course>,
    t: f32,
}

#[derive(Clone, Copy, Debug)]
struct Course {
    goal: Pose<f32>,
    legs: Legs,
}

#[derive(Clone, Copy, Debug)]
enum Legs {
    /// From a pose.
    Turns {
        from: Pose<f32>,
        first: Trapezoid,
        drive: Trapezoid,
        last: Trapezoid,
    },
    /// To the goal along an arc: way, speed, deceleration, curvature.
    Stop {
        way: f32,
        speed: f32,
        brake: f32,
        curvature: f32,
    },
}

impl Plan {
    pub(crate) fn new(body: &Body) -> Self {
        Self {
            limits: body.limits,
            tolerance: (body.distance_m, body.heading_rad),
            share: SHARE,
            course: None,
            t: 0.0,
        }
    }

    /// With another share of the limits.
    pub(crate) fn with_share(self, share: f32) -> Self {
        Self { share, ..self }
    }

    /// What to follow now: the path itself, or the plan to a goal.
    pub(crate) fn reference(&mut self, now: &Now, job: &Job<'_>) -> Option<Reference<f32>> {
        match job {
            Job::Follow(path) => {
                self.course = None;
                path.at(0)
            }
            Job::Park(goal) => Some(self.to(now, goal)),
        }
    }

    /// The reference `later` seconds from now on, of the same job.
    #[cfg(feature = "mpc")]
    pub(crate) fn ahead(&self, job: &Job<'_>, period_s: f32, later: f32) -> Option<Reference<f32>> {
        match job {
            Job::Follow(path) => path.at((later / period_s + 0.5) as usize),
            Job::Park(goal) => Some(self.course.map_or_else(
                || Reference::at_rest(*goal),
                |course| course.at(self.t + later),
            )),
        }
    }

    /// The plan's reference at its present time.
    fn to(&mut self, now: &Now, goal: &Pose<f32>) -> Reference<f32> {
        self.t += now.dt;
        let course = match self.course {
            Some(course) if course.goal == *goal && !self.has_missed(&course, now) => course,
            _ => {
                self.t = 0.0;
                let placed = PLACED * self.tolerance.0;
                let course = Course::new((&self.limits, self.share, placed), now, goal);
                *self.course.insert(course)
            }
        };
        course.at(self.t)
    }

    /// It stands beside its goal, long after the end.
    fn has_missed(&self, course: &Course, now: &Now) -> bool {
        let e = error(&course.goal, &now.pose);
        let beside = norm(e.x, e.y) > self.tolerance.0 || e.theta.abs() > self.tolerance.1;
        beside && self.t > course.duration() + PATIENCE
    }
}

impl Course {
    fn new((limits, share, placed): (&Limits<f32>, f32, f32), now: &Now, goal: &Pose<f32>) -> Self {
        let (dx, dy) = (goal.x - now.pose.x, goal.y - now.pose.y);
        let way = norm(dx, dy);
        let Twist { linear, angular } = now.twist;
        if linear.abs() > MOVES && way > placed {
            let needed = 0.5 * linear * linear / way;
            let brake = if needed < limits.brake {
                needed
            } else {
                limits.brake
            };
            let legs = Legs::Stop {
                way: if linear < 0.0 { -way } else { way },
                speed: linear,
                brake,
                curvature: angular / linear,
            };
            return Self { goal: *goal, legs };
        }
        let way = if way > placed { way } else { 0.0 };
        let forward = Legs::turns(limits, share, now, goal, (dx, dy), way);
        let backward = Legs::turns(limits, share, now, goal, (-dx, -dy), -way);
        let legs = if backward.duration() < forward.duration() {
            backward
        } else {
            forward
        };
        Self { goal: *goal, legs }
    }

    fn duration(&self) -> f32 {
        self.legs.duration()
    }

    fn at(&self, t: f32) -> Reference<f32> {
        match &self.legs {
            Legs::Turns {
                from,
                first,
                drive,
                last,
            } => {
                let (turned, rate, turn_accel) = first.at(t);
                let begun = t - first.duration();
                let (way, speed, accel) = drive.at(begun);
                let (back, back_rate, back_accel) = last.at(begun - drive.duration());
                let heading = from.theta + turned;
                let (sine, cosine) = sin_cos(heading);
                let pose = Pose::new(
                    from.x + way * cosine,
                    from.y + way * sine,
                    wrap(heading + back),
                );
                let accel = Accel::new(accel, turn_accel + back_accel);
                Reference::new(pose, Twist::new(speed, rate + back_rate), accel)
            }
            &Legs::Stop {
                way,
                speed,
                brake,
                curvature,
            } => {
                let sign = if speed < 0.0 { -1.0 } else { 1.0 };
                let end = speed.abs() / brake;
                let left = if t < end { end - t } else { 0.0 };
                // To go, by time: the same brake for all of it.
                let done = way.abs() - 0.5 * brake * end * end;
                let to_go = sign * (0.5 * brake * left * left + if t < end { done } else { 0.0 });
                let turn = -curvature * to_go;
                let (sine, cosine) = sin_cos(self.goal.theta + 0.5 * turn);
                let pose = Pose::new(
                    self.goal.x - to_go * cosine,
                    self.goal.y - to_go * sine,
                    wrap(self.goal.theta + turn),
                );
                let (v, a) = (
                    sign * brake * left,
                    if t < end { -sign * brake } else { 0.0 },
                );
                let twist = Twist::new(v, curvature * v);
                Reference::new(pose, twist, Accel::new(a, curvature * a))
            }
        }
    }
}

impl Legs {
    /// Turns to look along (dx, dy), drives, and turns to the goal's heading.
    fn turns(
        limits: &Limits<f32>,
        share: f32,
        now: &Now,
        goal: &Pose<f32>,
        (dx, dy): (f32, f32),
        way: f32,
    ) -> Self {
        let bearing = if way.abs() > 0.0 {
            atan2(dy, dx)
        } else {
            goal.theta
        };
        let turn = |angle: f32| {
            let angle = if angle.abs() > LEAST_TURN { angle } else { 0.0 };
            let accel = share * limits.turn_accel;
            Trapezoid::new(angle, share * limits.turn_rate, accel, accel)
        };
        Self::Turns {
            from: now.pose,
            first: turn(wrap(bearing - now.pose.theta)),
            drive: Trapezoid::new(
                way,
                share * limits.speed,
                share * limits.accel,
                share * limits.brake,
            ),
            last: turn(wrap(goal.theta - bearing)),
        }
    }

    fn duration(&self) -> f32 {
        match self {
            Self::Turns {
                first, drive, last, ..
            } => first.duration() + drive.duration() + last.duration(),
            Self::Stop { speed, brake, .. } => speed.abs() / brake,
        }
    }
}
