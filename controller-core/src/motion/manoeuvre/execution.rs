//! Driving a manoeuvre: a reference that ends at the goal.

use super::candidate::{Pace, PlanLimits};
use super::lateral_offset::{Aside, LateralOffset, OffsetLimits, SETTING_S};
use super::path::{Courses, Path, Vector};
use super::profile::AxisSample;
use super::search::{Progress, Search, ready_s};
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::types::{Accel, Twist};

/// The goal as the robot sees it.
#[derive(Clone, Copy)]
pub(crate) struct GoalSeen<'a, T> {
    pub(crate) error: &'a PoseError<T>,
    /// (sin θ, cos θ) of the robot.
    pub(crate) heading: (T, T),
}

/// A manoeuvre under way, or being searched for while the robot comes to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Execution<T> {
    stage: Stage<T>,
    path: Path<T>,
    /// Of the path \[s\].
    duration: T,
    /// Travel at the end of the path's drives \[m\], once they are known.
    end: T,
    /// Heading of the goal, from that of the robot at the begin \[rad\].
    goal: T,
    reference: Reference<T>,
    /// The position is good as it is.
    turn_only: bool,
    /// What the poses seen while searching say of the goal, beside the first one.
    seen: Seen<T>,
}

/// What is known of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage<T> {
    /// The motion at its begin.
    Searching(Search<T>),
    /// All of it.
    Driving {
        /// Where on it the reference is.
        courses: Courses<T>,
        /// (sin β, cos β) of the world's heading β of the robot at the begin.
        begin: (T, T),
    },
}

/// Where the reference is: what a tick changes of a manoeuvre under way, beside what follows from its time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Reference<T> {
    /// Since the begin \[s\].
    t: T,
    /// From the reference to the goal, in the frame of the robot at the begin \[m\].
    remaining: Vector<T>,
    /// v (cos θ, sin θ) of the reference, and its rate.
    velocity: Vector<T>,
    change: Vector<T>,
    /// The last speed that was not zero \[m/s\]; its sign is the direction of travel.
    speed: T,
    /// During the last drive.
    offset: LateralOffset<T>,
    /// Time since it was set \[s\].
    set_s: T,
}

/// Sums of corrections of the goal, and their number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Seen<T> {
    moved: Vector<T>,
    turned: T,
    count: T,
}

/// The reference of a manoeuvre at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<T> {
    pub(crate) twist: Twist<T>,
    /// Half a tick ahead.
    pub(crate) accel: Accel<T>,
    /// Reference minus robot.
    pub(crate) error: PoseError<T>,
    /// (sin e_θ, cos e_θ).
    pub(crate) heading: (T, T),
}

/// The motion that a manoeuvre begins with.
struct Begin<T> {
    /// Of a tick \[s\].
    half: T,
    /// What is commanded now.
    now: Twist<T>,
    /// What will be, half a tick from now. An acceleration is held for a tick, and meant for its middle: the clock of a manoeuvre
    /// starts there, and so does its frame.
    twist: Twist<T>,
}

impl<T: Scalar> Begin<T> {
    /// With `last` commanded a tick of `dt` ago, and `rate`.
    fn of(last: &Twist<T>, rate: &Accel<T>, dt: T) -> Self {
        let half = T::HALF * dt;
        let now = Twist {
            linear: last.linear + dt * rate.linear,
            angular: last.angular + dt * rate.angular,
        };
        let twist = Twist {
            linear: now.linear + half * rate.linear,
            angular: now.angular + half * rate.angular,
        };
        Self { half, now, twist }
    }
}

impl<T: Scalar> Execution<T> {
    /// Keeps its speed and brakes at the goal: for a robot that drives towards it already. Nothing has to be searched for. Its frame is
    /// that of the goal, whose axis is the planned path; what the robot is aside of it is a [`LateralOffset`]'s from the begin.
    ///
    /// `None`, and nothing is changed, where that is no quicker than what a search finds, or is not to be had within `limits`: too near, too
    /// far aside, or heading elsewhere. For a manoeuvre that stands at its goal.
    ///
    /// By a call: what it takes of the stack is not added to that of a search.
    #[inline(never)]
    pub(crate) fn roll_on<M: Maths<T>>(
        &mut self,
        limits: &PlanLimits<T>,
        view: GoalSeen<'_, T>,
        last: &Twist<T>,
        rate: &Accel<T>,
        dt: T,
    ) -> Option<()> {
        let Begin { half, now, twist } = Begin::of(last, rate, dt);
        let error = view.error;
        let (sine, cosine) = M::sin_cos(error.theta);
        if cosine <= T::HALF {
            return None;
        }
        let ahead = error.x * cosine + error.y * sine;
        let stop = limits.drive.stop(twist.linear, rate.linear);
        let stop_drive = stop.standing_at(ahead - half * twist.linear)?;
        let left = ahead.abs();
        if stop_drive.duration() > ready_s(dt) + limits.drive.profile::<M>(left).duration() {
            return None;
        }
        let robot = Aside {
            offset: error.x * sine - error.y * cosine,
            slope: -sine / cosine,
            turn_rate: now.angular,
            turn_accel: rate.angular,
            speed: now.linear,
            accel: rate.linear,
        };
        let curve = LateralOffset::of_robot(limits, left, &robot)?;
        self.path.stop_drive = stop_drive;
        self.stage = Stage::Driving {
            courses: Courses::of(&self.path, -half),
            begin: turned_back(view.heading, (-sine, cosine)),
        };
        self.duration = stop_drive.duration();
        self.end = ahead - half * twist.linear;
        self.reference = Reference {
            t: -half,
            remaining: Vector {
                x: ahead,
                y: T::ZERO,
            },
            velocity: Vector {
                x: now.linear,
                y: T::ZERO,
            },
            change: Vector {
                x: rate.linear,
                y: T::ZERO,
            },
            speed: now.linear,
            offset: curve,
            ..Reference::default()
        };
        Some(())
    }

    /// Begins to search, from a robot that sees its goal at `error` and was commanded `last` a tick ago, with `rate`. The
    /// reference goes on from there: it jumps neither in rate nor in acceleration.
    pub(crate) fn start<M: Maths<T>>(
        &mut self,
        plan: &PlanLimits<T>,
        slower: bool,
        error: &PoseError<T>,
        last: &Twist<T>,
        rate: &Accel<T>,
        dt: T,
    ) {
        let Begin { half, now, twist } = Begin::of(last, rate, dt);
        // The goal as seen from there; the robot looks aside by what it turns until then.
        let turned = half * twist.angular;
        let (sine, cosine) = M::sin_cos_near(turned);
        let remaining = Vector {
            x: error.x * cosine + error.y * sine,
            y: error.y * cosine - error.x * sine,
        };
        let error = PoseError {
            x: remaining.x - half * twist.linear,
            y: remaining.y,
            theta: error.theta - turned,
        };
        let still = *last == Twist::default() && *rate == Accel::default();
        let pace = Pace {
            slower,
            smoother: !still,
        };
        let limits = &plan.at(pace);
        // Field by field: a manoeuvre is not copied.
        self.path.stop_drive = limits.drive.stop(twist.linear, rate.linear);
        self.path.stop_turn = limits.turn.stop(twist.angular, rate.angular);
        self.path.forget_manoeuvre();
        self.duration = self.path.duration();
        self.goal = error.theta;
        self.reference = Reference {
            t: -half,
            remaining,
            velocity: Vector {
                x: now.linear,
                y: T::ZERO,
            },
            change: Vector {
                x: rate.linear,
                y: now.linear * now.angular,
            },
            speed: now.linear,
            ..Reference::default()
        };
        self.turn_only = false;
        self.seen = Seen::default();
        self.stage = Stage::Searching(Search::start::<M>((limits, pace), &error, &self.path, dt));
    }

    /// The robot turns on the spot: its position is good as it is, whatever is seen of it while it waits.
    pub(crate) const fn turn_only(&mut self) {
        self.turn_only = true;
    }

    /// The reference stands at the goal.
    #[inline(always)]
    pub(crate) fn at_goal() -> Self {
        Self {
            stage: Stage::Driving {
                courses: Courses::STANDING,
                begin: (T::ZERO, T::ONE),
            },
            path: Path::default(),
            duration: T::ZERO,
            end: T::ZERO,
            goal: T::ZERO,
            reference: Reference::default(),
            turn_only: false,
            seen: Seen::default(),
        }
    }

    /// A tick of the search, before the reference [goes on](Self::advance) by `step`; `None` if no manoeuvre was found. `view` is the
    /// goal as the robot sees it now; `plan` is what the manoeuvre may use.
    ///
    /// Apart from the tick along a manoeuvre, for the sake of the stack.
    #[cold]
    #[inline(never)]
    pub(crate) fn search<M: Maths<T>>(
        &mut self,
        plan: &PlanLimits<T>,
        view: GoalSeen<'_, T>,
        step: T,
        dt: T,
    ) -> Option<()> {
        self.look::<M>(view.error);
        let Stage::Searching(search) = &mut self.stage else {
            return Some(());
        };
        let moving = self.duration > T::ZERO;
        // Ticks that became shorter may find it when it should have started.
        let late = moving && self.reference.t > search.ready();
        match search.advance::<M>(plan, &mut self.path, dt, step == T::ZERO) {
            Progress::Searching => {}
            Progress::Found if late => return None,
            Progress::Found => self.take_found::<M>(view, step),
            Progress::Failed => return None,
        }
        Some(())
    }

    /// The search has laid out the path, on which the reference goes on by `step` next.
    #[cold]
    #[inline(never)]
    fn take_found<M: Maths<T>>(&mut self, view: GoalSeen<'_, T>, step: T) {
        let path = &self.path;
        self.duration = path.duration();
        self.end = travel_at_end(path, self.duration);
        if path.stop_drive.duration() == T::ZERO && path.stop_turn.duration() == T::ZERO {
            // Nothing has moved: the clock starts now.
            self.reference.t = -step;
        }
        let angle = self.goal - view.error.theta;
        self.stage = Stage::Driving {
            courses: Courses::of(path, self.reference.t),
            begin: turned_back(view.heading, M::sin_cos_near(angle)),
        };
    }

    /// A `step` on, 0 at the begin and then `dt`. `view` is the goal as the robot sees it now; `limits` are what the last drive may use.
    ///
    /// `dead_band` is that of a robot that has been to stand at its goal for so long \[s\], along it \[m\] and of the heading \[rad\]: without one it follows what
    /// noise says, and where friction holds its wheels that is stick and slip, by more than what was to be mended.
    ///
    /// The position is integrated by the trapezoidal rule with its end correction, dt/2 (f₀ + f₁) +
    /// dt²/12 (f₀′ − f₁′): wrong by dt⁵. At the end of the manoeuvre the reference is the goal.
    #[inline(always)]
    pub(crate) fn advance<M: Maths<T>>(
        &mut self,
        limits: impl FnOnce() -> OffsetLimits<T>,
        dead_band: impl FnOnce(T) -> (T, T),
        view: GoalSeen<'_, T>,
        step: T,
        dt: T,
    ) -> Moment<T> {
        let error = view.error;
        self.reference.t += step;
        if self.is_over() {
            let (along, around) = dead_band(self.reference.t - self.duration);
            let (sine, cosine) = M::sin_cos_near(error.theta);
            return Moment {
                twist: Twist::default(),
                accel: Accel::default(),
                error: PoseError {
                    x: error.x - clamp(error.x, along),
                    ..*error
                },
                heading: (sine - clamp(sine, around), cosine),
            };
        }
        let (path, t) = (&self.path, self.reference.t);
        let ahead = t + T::HALF * dt;
        // The robot's heading in the frame of the begin, and (sin, cos) of it.
        let angle = self.goal - error.theta;
        let (turn, drive, accel, robot) = match &mut self.stage {
            Stage::Driving { courses, begin } => {
                let (turn, drive) = courses.go_on_to(path, t);
                let accel = courses.accel_at(path, ahead);
                (turn, drive, accel, turned_back(view.heading, *begin))
            }
            Stage::Searching(_) => {
                let (turn, drive) = (&path.stop_turn, &path.stop_drive);
                let accel = Accel {
                    linear: drive.at(ahead).accel,
                    angular: turn.at(ahead).accel,
                };
                (turn.at(t), drive.at(t), accel, M::sin_cos_near(angle))
            }
        };
        let looks = M::sin_cos_near(turn.position);
        let (turn_sine, turn_cosine) = looks;
        let velocity = Vector {
            x: drive.rate * turn_cosine,
            y: drive.rate * turn_sine,
        };
        let across = drive.rate * turn.rate;
        let change = Vector {
            x: drive.accel * turn_cosine - across * turn_sine,
            y: drive.accel * turn_sine + across * turn_cosine,
        };
        let half = T::HALF * step;
        let correction = step * step * T::from_f64(1.0 / 12.0);
        let moved = self
            .reference
            .velocity
            .plus(velocity)
            .scaled(half)
            .plus(self.reference.change.minus(change).scaled(correction));
        self.reference.remaining = self.reference.remaining.minus(moved);
        self.reference.velocity = velocity;
        self.reference.change = change;
        if drive.rate != T::ZERO {
            self.reference.speed = drive.rate;
        }
        let (sine, cosine) = robot;
        let Vector { x, y } = self.reference.remaining;
        let error = PoseError {
            x: error.x - (x * cosine + y * sine),
            y: error.y - (y * cosine - x * sine),
            theta: (turn.position - angle).wrap_angle(),
        };
        let mut moment = Moment {
            twist: Twist {
                linear: drive.rate,
                angular: turn.rate,
            },
            accel,
            error,
            heading: turned_back(looks, robot),
        };
        if self.is_last_drive() && drive.rate != T::ZERO {
            self.join(limits, &drive, step, &mut moment);
        }
        moment
    }

    /// What is driven now is driven to the end.
    fn is_last_drive(&self) -> bool {
        matches!(&self.stage, Stage::Driving { courses, .. } if courses.is_last_drive(&self.path))
    }

    /// Moves the reference aside, to where the robot is, and back to the planned one by the end of the drive ([`LateralOffset`]).
    fn join(
        &mut self,
        limits: impl FnOnce() -> OffsetLimits<T>,
        drive: &AxisSample<T>,
        step: T,
        moment: &mut Moment<T>,
    ) {
        let reference = &mut self.reference;
        reference.set_s += step;
        let due = reference.set_s >= T::from_f64(SETTING_S);
        if !due && !reference.offset.is_set() {
            return;
        }
        let PoseError { x, y, .. } = moment.error;
        let (sine, cosine) = moment.heading;
        let left = (self.end - drive.position).abs();
        if due {
            reference.set_s = T::ZERO;
            // To the left of the reference, where the robot is.
            let robot = sine * x - cosine * y;
            reference.offset = reference.offset.set(&limits(), left, drive.rate, robot);
        }
        if reference.offset.is_set() {
            let twist = Twist {
                linear: drive.rate,
                angular: moment.twist.angular,
            };
            let beside = reference.offset.beside(left, &twist, drive.accel);
            moment.error.x -= sine * beside.offset;
            moment.error.y += cosine * beside.offset;
            moment.error.theta -= beside.turned;
            moment.heading = turned_back(moment.heading, sin_cos_of_little(beside.turned));
            moment.twist.linear += beside.twist.linear;
            moment.twist.angular += beside.twist.angular;
            moment.accel.linear += beside.accel.linear;
            moment.accel.angular += beside.accel.angular;
        }
    }

    /// Takes the mean of what is seen of the goal while the shape is searched for: a single pose may be off, and a
    /// heading that is off by 5 mrad moves a goal 3 m away by 15 mm.
    fn look<M: Maths<T>>(&mut self, error: &PoseError<T>) {
        let Stage::Searching(search) = &mut self.stage else {
            return;
        };
        if self.duration > T::ZERO {
            // What a moving robot lacks of its reference is not the pose's noise alone.
            return;
        }
        if !search.is_polishing() {
            // In the frame of the begin, by the heading of the reference.
            let heading = self.path.stop_turn.at(self.reference.t).position;
            let (sine, cosine) = M::sin_cos_near(heading);
            if !self.turn_only {
                self.seen.moved = self.seen.moved.plus(Vector {
                    x: error.x * cosine - error.y * sine - self.reference.remaining.x,
                    y: error.x * sine + error.y * cosine - self.reference.remaining.y,
                });
            }
            self.seen.turned += (heading + error.theta - self.goal).wrap_angle();
            self.seen.count += T::ONE;
        } else if self.seen.count > T::ZERO {
            let share = T::ONE / self.seen.count;
            let (moved, turned) = (self.seen.moved.scaled(share), share * self.seen.turned);
            self.reference.remaining = self.reference.remaining.plus(moved);
            self.goal += turned;
            search.correct(moved, turned);
            self.seen = Seen::default();
        }
    }

    /// The reference stands at the goal.
    pub(crate) fn is_over(&self) -> bool {
        !self.is_searching() && self.reference.t >= self.duration
    }

    /// The manoeuvre is not known yet.
    pub(crate) fn is_searching(&self) -> bool {
        matches!(self.stage, Stage::Searching(_))
    }

    /// The reference backs up, or did last.
    pub(crate) fn is_backing(&self) -> bool {
        self.reference.speed < T::ZERO
    }

    /// Of a search. Under way, what a tick changes is the place of the reference and its offset, and all of that goes into the error
    /// that the follower is given.
    pub(crate) fn residue(&self) -> T {
        let Stage::Searching(search) = &self.stage else {
            return T::ZERO;
        };
        let Vector { x, y } = self.reference.remaining;
        search.residue() + residue([x, y, self.reference.t, self.goal])
    }
}

/// (sin, cos) of the difference of two angles whose own ones are known.
fn turned_back<T: Scalar>(of: (T, T), by: (T, T)) -> (T, T) {
    let ((sine, cosine), (by_sine, by_cosine)) = (of, by);
    (
        sine * by_cosine - cosine * by_sine,
        cosine * by_cosine + sine * by_sine,
    )
}

/// Sine and cosine of an angle as small as that of a curve aside, by the first terms of their series: up to 0.3 rad the next ones are
/// below a rounding of single precision.
fn sin_cos_of_little<T: Scalar>(angle: T) -> (T, T) {
    let f = T::from_f64;
    let square = angle * angle;
    let third = f(1.0 / 6.0) - square * f(1.0 / 120.0);
    let fourth = f(1.0 / 24.0) - square * f(1.0 / 720.0);
    (
        angle - angle * square * third,
        T::ONE - square * (T::HALF - square * fourth),
    )
}

/// Once a manoeuvre; apart from its ticks, which are quicker for it.
#[cold]
#[inline(never)]
fn travel_at_end<T: Scalar>(path: &Path<T>, duration: T) -> T {
    path.drive_at(duration).position
}
