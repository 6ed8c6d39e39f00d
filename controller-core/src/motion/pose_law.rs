//! The pose law of a tick: following, a parking manoeuvre, or rest at the goal.

use super::arrival::Parking;
use super::drive::{self, DriveLaw};
use super::error_view::ErrorView;
use super::follow::{Follower, Instant};
use super::goal_checker::{GoalChecker, GoalView};
use super::governor::Command;
use super::manoeuvre::{Execution, PlanLimits};
use super::params::ValidMotionParams;
use super::polar::PoseRegulator;
use super::retry::{Attempt, Rest, Retry, distance_of};
use super::setpoint::Setpoint;
use super::task::{Aim, Task};
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Accel, Twist};

/// What the pose laws remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseLaw<T> {
    follower: Follower<T>,
    regulator: PoseRegulator<T>,
    checker: GoalChecker<T>,
    retry: Retry<T>,
    /// The robot left the reference of a manoeuvre to this goal once already.
    departed: bool,
    pub(crate) drive: DriveLaw<T>,
}

/// A [`PoseLaw`] as it was before a tick, by pieces: each is small enough to be copied in a few instructions.
pub(crate) struct Before<T> {
    follower: Follower<T>,
    regulator: PoseRegulator<T>,
    checker: GoalChecker<T>,
    retry: Retry<T>,
    departed: bool,
    drive: DriveLaw<T>,
}

/// How the goal is approached. Lent, not part of what every tick copies: a manoeuvre is long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Approach<T> {
    /// Not at all yet.
    #[default]
    Idle,
    /// By a manoeuvre, whose end is the goal.
    Manoeuvre(Execution<T>),
    /// By feedback, since the goal moves on before a manoeuvre is found.
    Chase,
    /// By feedback, since no manoeuvre was found.
    Regulate,
}

/// How far the robot may be from the reference of a manoeuvre before another one is planned \[m\], \[rad\]. The
/// follower takes back what is less: at these errors its demands are at their bounds.
const DEPARTURE: (f64, f64) = (0.1, 0.5);

/// How the robot moves, measured and commanded.
#[derive(Clone, Copy)]
pub(crate) struct Moving<'a, T> {
    /// Measured.
    pub(crate) heading: T,
    /// Measured.
    pub(crate) twist: &'a Twist<T>,
    /// Of the last tick.
    pub(crate) command: &'a Command<T>,
}

/// Time since the last tick.
#[derive(Clone, Copy)]
pub(crate) struct Step<T> {
    /// \[s\].
    pub(crate) dt: T,
    /// 2/dt \[1/s\]; `None` where the laws start afresh from the command: at the start, and after a jump.
    pub(crate) two_per_dt: Option<T>,
}

/// What a pose law made of a tick.
pub(crate) struct Wanted<T> {
    pub(crate) setpoint: Setpoint<T>,
    pub(crate) transition: Transition,
}

/// How a setpoint goes on from the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Transition {
    /// From the last setpoint: the transition offset goes on fading.
    Continue,
    /// It may jump: a new transition offset starts from the command.
    Offset,
    /// From the command itself, rate and acceleration: there is no offset.
    Seamless,
}

impl<T: Scalar> PoseLaw<T> {
    /// Nothing seen yet.
    pub(crate) const NEW: Self = Self {
        follower: Follower::NEW,
        regulator: PoseRegulator::NEW,
        checker: GoalChecker::NEW,
        retry: Retry::NEW,
        departed: false,
        drive: DriveLaw::NEW,
    };

    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        approach: &mut Approach<T>,
        motion: &ValidMotionParams<T>,
        task: &Task<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        step: Step<T>,
    ) -> Wanted<T> {
        match task {
            Task::Follow(reference) => {
                *approach = Approach::Idle;
                self.follow::<U, M>(motion, reference, view, moving, step.two_per_dt)
            }
            Task::Park(_) => self.park::<U, M>(approach, motion, &view.error, moving, step),
            Task::Drive {
                twist,
                hold_heading,
            } => {
                self.checker = GoalChecker::default();
                *approach = Approach::Idle;
                let now = drive::Now {
                    order: twist,
                    hold_heading: *hold_heading,
                    heading: moving.heading,
                    turn_rate: moving.twist.angular,
                    error: view.error.theta,
                    command: moving.command,
                    jumped: step.two_per_dt.is_none(),
                    dt: step.dt,
                };
                Wanted {
                    setpoint: self.drive.advance::<M>(motion, &now),
                    transition: Transition::Seamless,
                }
            }
        }
    }

    fn follow<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        reference: &Reference<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        two_per_dt: Option<T>,
    ) -> Wanted<T> {
        let now = Instant {
            twist: reference.twist(),
            accel: reference.accel(),
            error: view.error,
            heading: view.heading,
            turn_rate: moving.twist.angular,
        };
        self.checker = GoalChecker::default();
        let command = &moving.command.twist;
        Wanted {
            setpoint: self
                .follower
                .advance::<U, M>(motion, &now, command, two_per_dt),
            transition: if two_per_dt.is_some() {
                Transition::Continue
            } else {
                Transition::Offset
            },
        }
    }

    fn park<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        approach: &mut Approach<T>,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
        moving: Moving<'_, T>,
        step: Step<T>,
    ) -> Wanted<T> {
        let Step { dt, two_per_dt } = step;
        let distance = distance_of::<T, M>(error);
        let (was_parked, was_resting) = (self.checker.parked, self.is_resting());
        let at = GoalView {
            error: *error,
            distance,
            twist: *moving.twist,
            command: moving.command.twist,
            command_rate: moving.command.rate,
            backing: self.is_backing(approach),
        };
        // A manoeuvre ends at the goal by itself, sooner than a stop that is begun before.
        let driving = approach.is_under_way() && !was_resting;
        self.checker = if driving || !self.retry.may_park() {
            GoalChecker::default()
        } else if two_per_dt.is_some() {
            self.checker.advance(motion, &at, dt)
        } else {
            GoalChecker::default().advance(motion, &at, dt)
        };
        let rest = match (was_parked && two_per_dt.is_some(), self.checker.parked) {
            (_, true) => Rest::Parked,
            (true, false) => Rest::Lost,
            (false, false) if driving => Rest::Driving,
            (false, false) if matches!(approach, Approach::Manoeuvre(_)) => Rest::Beside,
            (false, false) => Rest::Moving,
        };
        let (retry, attempt) = self.retry.advance::<M>(motion, &at, rest, dt);
        self.retry = retry;
        let resting = self.is_resting();
        let (setpoint, transition) = if resting {
            self.regulator.rest();
            let transition = if was_resting && two_per_dt.is_some() {
                Transition::Continue
            } else {
                Transition::Offset
            };
            (Setpoint::default(), transition)
        } else {
            // Pushed off its goal, or beside it, the robot starts afresh.
            match attempt {
                Attempt::Aim => *approach = Approach::Regulate,
                Attempt::GoOn | Attempt::Hold | Attempt::Manoeuvre => {}
            }
            let attempt = match attempt {
                Attempt::GoOn if was_resting => Attempt::Manoeuvre,
                _ => attempt,
            };
            self.approach::<U, M>(approach, motion, &at, &moving, step, attempt)
        };
        Wanted {
            setpoint,
            transition,
        }
    }

    /// The setpoint of an approach, and how it goes on from the command.
    fn approach<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        approach: &mut Approach<T>,
        motion: &ValidMotionParams<T>,
        at: &GoalView<T>,
        moving: &Moving<'_, T>,
        step: Step<T>,
        attempt: Attempt,
    ) -> (Setpoint<T>, Transition) {
        if step.dt == T::ZERO {
            // At the start: the first tick tells how long ticks are.
            *approach = Approach::Idle;
            let setpoint = Setpoint {
                twist: moving.command.twist,
                rate: Accel::default(),
            };
            return (setpoint, Transition::Offset);
        }
        let jumped = step.two_per_dt.is_none();
        let begun = match approach {
            Approach::Chase => !jumped,
            Approach::Idle => true,
            // A pose that jumped moves the robot against its reference. If that is far, it has departed.
            Approach::Manoeuvre(_) | Approach::Regulate => {
                matches!(attempt, Attempt::Manoeuvre | Attempt::Hold)
            }
        };
        if begun {
            let plan = if self.retry.is_another() {
                motion.plan.slower()
            } else {
                motion.plan
            };
            let hold = attempt == Attempt::Hold || is_inside(motion, at);
            *approach = Approach::begin::<M>(motion, &plan, at, moving.command, hold, step.dt);
        }
        let mut begun = begun;
        let mut two_per_dt = if begun || attempt == Attempt::Aim {
            None
        } else {
            step.two_per_dt
        };
        if let Approach::Manoeuvre(execution) = approach {
            let since = if begun { T::ZERO } else { step.dt };
            let mut moment = execution.advance::<M>(&at.error, since, step.dt);
            let departed = |error: &PoseError<T>| {
                let (far, turned) = DEPARTURE;
                distance_of::<T, M>(error) > T::from_f64(far) + motion.near
                    || error.theta.abs() > T::from_f64(turned)
            };
            // A robot that does not move is stalled, and has departed from nothing.
            let moves = T::from_f64(10.0) * motion.rim_speed(moving.twist)
                >= motion.rim_speed(&moving.command.twist);
            let gone = moment
                .as_ref()
                .is_some_and(|moment| departed(&moment.error));
            if gone && moves && !execution.is_searching() {
                begun = true;
                two_per_dt = None;
                if self.departed {
                    // Whatever keeps it off would do so again: feedback needs no plan.
                    moment = None;
                } else {
                    self.departed = true;
                    let Command { twist, rate } = moving.command;
                    let plan = motion.plan.slower();
                    *execution = Execution::start::<M>(&plan, &at.error, twist, rate, step.dt);
                    moment = execution.advance::<M>(&at.error, T::ZERO, step.dt);
                }
            }
            if let Some(moment) = moment {
                let now = Instant {
                    twist: &moment.twist,
                    accel: &moment.accel,
                    error: moment.error,
                    heading: M::sin_cos_near(moment.error.theta),
                    turn_rate: moving.twist.angular,
                };
                let command = &moving.command.twist;
                let setpoint = self
                    .follower
                    .advance::<U, M>(motion, &now, command, two_per_dt);
                let transition = match (begun, execution.is_over()) {
                    // Held where it is: nothing leads there from how it moves.
                    (true, true) => Transition::Offset,
                    (true, false) => Transition::Seamless,
                    (false, _) if jumped => Transition::Offset,
                    (false, _) => Transition::Continue,
                };
                return (setpoint, transition);
            }
            *approach = Approach::Regulate;
            two_per_dt = None;
        }
        let command = &moving.command.twist;
        let (aim, distance) = self.aim::<M>(motion, at);
        let setpoint = self
            .regulator
            .advance::<U, M>(motion, &aim, distance, command, two_per_dt);
        let transition = if two_per_dt.is_some() {
            Transition::Continue
        } else {
            Transition::Offset
        };
        (setpoint, transition)
    }

    /// What to drive at by feedback, and how far it is: the goal, or the place that a retry drives out to.
    fn aim<M: Maths<T>>(
        &self,
        motion: &ValidMotionParams<T>,
        at: &GoalView<T>,
    ) -> (PoseError<T>, T) {
        if self.retry.is_out() {
            let aim = self.retry.aim::<M>(motion, &at.error);
            let far = distance_of::<T, M>(&aim);
            (aim, far)
        } else {
            (at.error, at.distance)
        }
    }

    /// Another goal: all approaches are to be had again.
    pub(crate) fn renew_retries(&mut self, approach: &mut Approach<T>) {
        self.retry = Retry::default();
        self.departed = false;
        // A goal that moves again before the manoeuvre to it was found is chased.
        let chased = match approach {
            Approach::Manoeuvre(execution) => execution.is_searching(),
            Approach::Chase => true,
            Approach::Idle | Approach::Regulate => false,
        };
        *approach = if chased {
            Approach::Chase
        } else {
            Approach::Idle
        };
    }

    /// Nothing is asked for any more: parked, or given up.
    pub(crate) fn is_resting(&self) -> bool {
        self.checker.parked || self.retry.given_up
    }

    /// At the goal within tolerance.
    pub(crate) fn is_parked(&self) -> bool {
        self.checker.parked
    }

    /// At rest outside of the tolerance, after all retries.
    pub(crate) fn has_given_up(&self) -> bool {
        self.retry.given_up
    }

    /// New approaches so far.
    pub(crate) fn retries(&self) -> u8 {
        self.retry.count
    }

    /// While parking: the robot backs up.
    pub(crate) fn is_backing(&self, approach: &Approach<T>) -> bool {
        match approach {
            Approach::Manoeuvre(execution) => execution.is_backing(),
            Approach::Idle | Approach::Chase | Approach::Regulate => self.regulator.is_backing(),
        }
    }

    /// Of what a tick of a task with this aim may have changed.
    pub(crate) fn residue(&self, aim: &Aim<T>) -> T {
        match aim {
            Aim::Follow => self.follower.residue(),
            Aim::Park(_) => self.follower.residue() + self.regulator.residue(),
            Aim::Drive => self.drive.residue(),
        }
    }

    pub(crate) const fn before(&self) -> Before<T> {
        Before {
            follower: self.follower,
            regulator: self.regulator,
            checker: self.checker,
            retry: self.retry,
            departed: self.departed,
            drive: self.drive,
        }
    }

    pub(crate) const fn restore(&mut self, before: Before<T>) {
        self.follower = before.follower;
        self.regulator = before.regulator;
        self.checker = before.checker;
        self.retry = before.retry;
        self.departed = before.departed;
        self.drive = before.drive;
    }
}

impl<T: Scalar> Approach<T> {
    /// A manoeuvre has still to be found or driven.
    fn is_under_way(&self) -> bool {
        matches!(self, Self::Manoeuvre(execution) if !execution.is_over())
    }

    /// A copy to go back to; only a manoeuvre costs one.
    pub(crate) fn kept(&self) -> Self {
        match self {
            Self::Manoeuvre(execution) => Self::Manoeuvre(*execution),
            Self::Idle => Self::Idle,
            Self::Chase => Self::Chase,
            Self::Regulate => Self::Regulate,
        }
    }

    pub(crate) fn residue(&self) -> T {
        match self {
            Self::Manoeuvre(execution) => execution.residue(),
            Self::Idle | Self::Chase | Self::Regulate => T::ZERO,
        }
    }

    /// By a manoeuvre; a robot that is where it should be has none to make. With ticks longer than the time constant of the
    /// follower's neurons by feedback: the follower holds no robot at rest then, and the regulator is slower.
    fn begin<M: Maths<T>>(
        motion: &ValidMotionParams<T>,
        plan: &PlanLimits<T>,
        at: &GoalView<T>,
        from: &Command<T>,
        hold: bool,
        dt: T,
    ) -> Self {
        let Command { twist, rate } = from;
        let planned = motion.params().arrival.parking == Parking::Planned;
        if !planned || motion.gains().decay * dt > T::ONE {
            Self::Regulate
        } else if hold {
            Self::Manoeuvre(Execution::at_goal())
        } else if is_there(motion, at, from) {
            Self::Manoeuvre(Execution::turning::<M>(plan, &at.error, twist, rate, dt))
        } else {
            Self::Manoeuvre(Execution::start::<M>(plan, &at.error, twist, rate, dt))
        }
    }
}

/// Slow, and within tolerance: what holds the robot there brings it to rest.
fn is_inside<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<T>) -> bool {
    let arrival = &motion.params().arrival;
    motion.rim_speed(&at.command) <= arrival.stall_speed
        && at.distance < arrival.distance_m
        && at.error.theta.abs() < arrival.heading_rad
}

/// At the goal but for the heading, with a fifth of the tolerance to spare: what a turn moves it aside.
fn is_there<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<T>, from: &Command<T>) -> bool {
    let tolerance = T::from_f64(0.8) * motion.params().arrival.distance_m;
    at.distance < tolerance && *from == Command::default()
}
