//! The parking law: a manoeuvre, feedback, or rest at the goal.

use super::arrival::{HEADING_DEVIATIONS, Parking};
use super::error_view::ErrorView;
use super::follow::{Follower, Instant};
use super::goal_checker::{Ending, GoalChecker, GoalView};
use super::governor::Command;
use super::manoeuvre::{Execution, Pace};
use super::params::ValidMotionParams;
use super::polar::PoseRegulator;
use super::pose_law::{Moving, Step, Transition, Wanted};
use super::retry::{Attempt, Rest, Retry, distance_of};
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::smaller;
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;

/// What parking remembers. It means something while the robot parks, and begins anew with every goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParkingLaw<T> {
    memory: Memory<T>,
    approach: Approach<T>,
}

/// Beside the approach.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Memory<T> {
    regulator: PoseRegulator<T>,
    checker: GoalChecker<T>,
    retry: Retry<T>,
    /// The robot left the reference of a manoeuvre to this goal once already.
    departed: bool,
    grip: Grip,
    /// How often the way to this goal was begun anew because the pose had jumped.
    jumps: u8,
}

/// What the floor holds of the manoeuvres to a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grip {
    /// All that they asked for.
    Holds,
    /// Less: wheels slide, and the manoeuvre under way is to be planned anew.
    Lost,
    /// Half the accelerations are asked for.
    Spared,
}

impl<T: Scalar> Memory<T> {
    /// Where full accelerations have led beside this goal twice, or wheels slid, half of them are planned with.
    fn is_slower(&self) -> bool {
        self.retry.has_failed_twice() || self.has_slid()
    }

    /// Wheels slid on the way to this goal.
    fn has_slid(&self) -> bool {
        self.grip != Grip::Holds
    }

    /// With a manoeuvre under way nothing has arrived, and nothing is stuck.
    fn drives(&mut self) {
        self.checker = GoalChecker::NEW;
        self.retry.drives();
    }
}

/// How the goal is approached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Approach<T> {
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

/// How often the way to a goal is begun anew because the pose has jumped. A pose that goes on jumping is no reason to go on planning.
const JUMPS: u8 = 3;

/// How a tick goes on along an approach.
struct Way<T> {
    /// Since the last tick, 0 where the approach begins \[s\].
    since: T,
    /// As in [`Step`].
    two_per_dt: Option<T>,
    transition: Transition,
}

impl<T: Scalar> Way<T> {
    /// Along the same approach as in the last tick.
    #[inline(always)]
    fn on(Step { dt, two_per_dt }: Step<T>) -> Self {
        Self {
            since: dt,
            two_per_dt,
            transition: Transition::after(two_per_dt),
        }
    }
}

/// What is to be done in a tick without a manoeuvre under way.
enum Next<T> {
    /// Nothing is asked for: the robot is parked, or has given up.
    Rest(Transition),
    /// To keep the command until there is a tick.
    Wait,
    /// To go on as before.
    GoOn(Way<T>),
    /// To begin an approach.
    Begin(Attempt),
}

impl<T: Scalar> ParkingLaw<T> {
    /// No goal yet.
    pub(crate) const NEW: Self = Self {
        memory: Memory {
            regulator: PoseRegulator::NEW,
            checker: GoalChecker::NEW,
            retry: Retry::NEW,
            departed: false,
            grip: Grip::Holds,
            jumps: 0,
        },
        approach: Approach::Idle,
    };

    /// Becomes [`NEW`](Self::NEW).
    pub(crate) fn forget(&mut self) {
        self.memory = Self::NEW.memory;
        self.approach = Approach::Idle;
    }

    /// Another goal: all approaches are to be had again. `goes_on` if the robot was on its way to one.
    #[cold]
    #[inline(never)]
    pub(crate) fn renew(&mut self, goes_on: bool) {
        self.memory.retry = Retry::NEW;
        self.memory.departed = false;
        self.memory.grip = Grip::Holds;
        self.memory.jumps = 0;
        // A goal that moves again before the manoeuvre to it was found is chased.
        let chased = goes_on
            && match &self.approach {
                Approach::Manoeuvre(execution) => execution.is_searching(),
                Approach::Chase => true,
                Approach::Idle | Approach::Regulate => false,
            };
        self.approach = if chased {
            Approach::Chase
        } else {
            Approach::Idle
        };
        if !goes_on {
            self.memory.checker = GoalChecker::NEW;
        }
    }

    /// A tick.
    ///
    /// What looks at the goal, what begins a manoeuvre and what searches for one are called one after the other: their stack does not
    /// add up.
    #[inline(always)]
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        follower: &mut Follower<T>,
        motion: &ValidMotionParams<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        step: Step<T>,
    ) -> Wanted<T> {
        let way = if self.is_driving() && step.two_per_dt.is_some() {
            self.memory.drives();
            Way::on(step)
        } else if self.stays(motion, &view.error, step) {
            self.memory.checker.stay(step.dt);
            self.memory.retry.rests(step.dt);
            self.memory.regulator.rest();
            return Wanted::rest(Transition::Continue);
        } else {
            match self.look::<M>(motion, view, moving, step) {
                Next::Rest(transition) => return Wanted::rest(transition),
                Next::Wait => return Wanted::as_commanded(moving.command),
                Next::GoOn(way) => way,
                Next::Begin(attempt) => self.begin::<M>(motion, view, moving, attempt, step.dt),
            }
        };
        match self.along::<U, M>(follower, motion, view, &moving, step, &way) {
            Some(along) => along,
            None => self.by_feedback::<U, M>(motion, &view.error, &moving, way.two_per_dt),
        }
    }

    /// A parked robot is so near its goal that nothing else is to be asked about.
    fn stays(&self, motion: &ValidMotionParams<T>, error: &PoseError<T>, step: Step<T>) -> bool {
        let Memory { retry, checker, .. } = &self.memory;
        step.two_per_dt.is_some() && retry.may_park() && checker.stays(motion, error)
    }

    /// Whether the robot has arrived, and what is to be done if not: without a manoeuvre under way, or where the pose jumped on the way, from where another one
    /// leads to the goal.
    #[inline(never)]
    fn look<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        step: Step<T>,
    ) -> Next<T> {
        let dt = step.dt;
        let jumped = step.two_per_dt.is_none();
        let anew = jumped && self.forgets_attempts();
        if self.is_driving() {
            self.memory.drives();
            return if anew {
                Next::Begin(Attempt::Manoeuvre)
            } else {
                Next::GoOn(Way::on(step))
            };
        }
        let (was_parked, was_resting) = (self.memory.checker.parked, self.is_resting());
        let at = GoalView::of(motion, view, moving, (self.is_backing(), self.ending()));
        self.memory.checker = if !self.memory.retry.may_park() {
            GoalChecker::NEW
        } else if jumped {
            GoalChecker::NEW.advance(motion, &at, dt)
        } else {
            self.memory.checker.advance(motion, &at, dt)
        };
        if self.memory.checker.parked {
            self.memory.jumps = 0;
        }
        let rest = match (was_parked && !jumped, self.memory.checker.parked) {
            (_, true) => Rest::Parked,
            (true, false) => Rest::Lost,
            (false, false) if self.memory.checker.is_settling(motion) => Rest::Settling,
            (false, false) if matches!(self.approach, Approach::Manoeuvre(_)) => Rest::Beside,
            (false, false) => Rest::Moving,
        };
        let attempt = self.memory.retry.advance::<M>(motion, &at, rest, dt);
        if self.is_resting() {
            self.memory.regulator.rest();
            return Next::Rest(if jumped {
                Transition::Offset
            } else if was_resting {
                Transition::Continue
            } else {
                match at.ending {
                    Ending::Fading => Transition::Offset,
                    Ending::AtOnce => Transition::Seamless,
                }
            });
        }
        if attempt == Attempt::Aim {
            self.approach = Approach::Regulate;
        }
        if dt == T::ZERO {
            // At the start: the length of ticks is known with the first one.
            self.approach = Approach::Idle;
            return Next::Wait;
        }
        // Pushed off its goal, or beside it, the robot starts afresh.
        let attempt = match attempt {
            Attempt::GoOn if was_resting || anew => Attempt::Manoeuvre,
            _ => attempt,
        };
        let begins = match self.approach {
            Approach::Chase => !jumped,
            Approach::Idle => true,
            // A pose that jumped moves the robot against its reference. If that is far, it has departed.
            Approach::Manoeuvre(_) | Approach::Regulate => {
                matches!(attempt, Attempt::Manoeuvre | Attempt::Hold)
            }
        };
        if begins {
            return Next::Begin(attempt);
        }
        let way = Way::on(step);
        Next::GoOn(if attempt == Attempt::Aim {
            Way {
                two_per_dt: None,
                ..way
            }
        } else {
            way
        })
    }

    /// After a jump on the way to the goal, or at it: what was tried from a pose that was wrong says nothing of the goal. `false` where nothing
    /// has been tried, and where the pose has jumped too often without the robot having parked between.
    fn forgets_attempts(&mut self) -> bool {
        let tried = matches!(self.approach, Approach::Manoeuvre(_) | Approach::Regulate);
        if !tried || self.memory.retry.given_up || self.memory.jumps >= JUMPS {
            return false;
        }
        self.memory.jumps = self.memory.jumps.saturating_add(1);
        self.memory.departed = false;
        self.memory.retry = Retry::NEW;
        true
    }

    /// Begins an approach.
    #[cold]
    #[inline(never)]
    fn begin<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        attempt: Attempt,
        dt: T,
    ) -> Way<T> {
        if self.memory.grip == Grip::Lost {
            self.memory.grip = Grip::Spared;
        }
        let slower = self.memory.is_slower();
        let at = &GoalView::of(motion, view, moving, (self.is_backing(), Ending::Fading));
        let hold = attempt == Attempt::Hold || is_inside(motion, at);
        Way {
            since: T::ZERO,
            two_per_dt: None,
            transition: self.approach.begin::<M>(motion, slower, at, hold, dt),
        }
    }

    /// With a manoeuvre under way, that nothing else is to be asked about: it ends at the goal by itself, sooner than a stop that
    /// is begun before.
    fn is_driving(&self) -> bool {
        self.approach.is_under_way() && !self.is_resting() && self.memory.retry.may_park()
    }

    /// By feedback: also from where a manoeuvre failed, which is given up.
    #[inline(never)]
    fn by_feedback<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
        moving: &Moving<'_, T>,
        two_per_dt: Option<T>,
    ) -> Wanted<T> {
        let fails = matches!(self.approach, Approach::Manoeuvre(_));
        if fails {
            self.approach = Approach::Regulate;
        }
        let two_per_dt = if fails { None } else { two_per_dt };
        self.regulate::<U, M>(motion, error, moving, two_per_dt)
    }

    /// The setpoint along a manoeuvre, and how it goes on from the command; `None` without one, or where none is to be had.
    ///
    /// A search, and what is done of a departure, are no part of [`follow`](Self::follow): their stack is not added to its.
    #[inline(always)]
    fn along<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        follower: &mut Follower<T>,
        motion: &ValidMotionParams<T>,
        view: &ErrorView<T>,
        moving: &Moving<'_, T>,
        step: Step<T>,
        way: &Way<T>,
    ) -> Option<Wanted<T>> {
        let Approach::Manoeuvre(execution) = &mut self.approach else {
            return None;
        };
        if execution.is_searching() {
            execution.search::<M>(&motion.plan, view.goal(), way.since, step.dt)?;
        }
        self.follow::<U, M>(follower, motion, view, moving, step.dt, way)
            .or_else(|| self.return_from::<U, M>(follower, motion, view, moving, step.dt))
    }

    /// Another manoeuvre, slower, from where the robot is: where its wheels slid, and once where it departed.
    #[cold]
    #[inline(never)]
    fn return_from<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        follower: &mut Follower<T>,
        motion: &ValidMotionParams<T>,
        view: &ErrorView<T>,
        moving: &Moving<'_, T>,
        dt: T,
    ) -> Option<Wanted<T>> {
        let Approach::Manoeuvre(execution) = &mut self.approach else {
            return None;
        };
        if self.memory.grip == Grip::Lost {
            self.memory.grip = Grip::Spared;
        } else if self.memory.departed {
            // Whatever keeps it off would do so again: feedback needs no plan.
            return None;
        } else {
            self.memory.departed = true;
        }
        let Command { twist, rate } = moving.command;
        execution.start::<M>(&motion.plan, true, &view.error, twist, rate, dt);
        execution.search::<M>(&motion.plan, view.goal(), T::ZERO, dt)?;
        let way = Way {
            since: T::ZERO,
            two_per_dt: None,
            transition: Transition::Seamless,
        };
        self.follow::<U, M>(follower, motion, view, moving, dt, &way)
    }

    /// The same with a manoeuvre under way; `None` too far from its reference, see [`DEPARTURE`], and where wheels slide.
    #[inline(never)]
    fn follow<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        follower: &mut Follower<T>,
        motion: &ValidMotionParams<T>,
        view: &ErrorView<T>,
        moving: &Moving<'_, T>,
        dt: T,
        way: &Way<T>,
    ) -> Option<Wanted<T>> {
        let Approach::Manoeuvre(execution) = &mut self.approach else {
            return None;
        };
        let limits = || motion.offset_limits();
        let dead_band = |since_s| dead_band(motion, since_s);
        let moment = execution.advance::<M>(limits, dead_band, view.goal(), way.since, dt);
        // A robot that does not move is stalled, and has departed from nothing.
        let moves = || {
            T::from_f64(10.0) * motion.rim_speed(moving.twist)
                >= motion.rim_speed(&moving.command.twist)
        };
        let departed = has_departed(motion, &moment.error) && moves();
        if departed && !execution.is_searching() || self.memory.grip == Grip::Lost {
            return None;
        }
        let now = Instant {
            twist: &moment.twist,
            accel: &moment.accel,
            error: moment.error,
            heading: moment.heading,
            turn_rate: moving.twist.angular,
            ending: Some(moment.twist.angular),
        };
        let command = &moving.command.twist;
        Some(Wanted {
            setpoint: follower.advance::<U, M>(motion, &now, command, way.two_per_dt),
            transition: way.transition,
        })
    }

    /// The setpoint by feedback, and how it goes on from the command.
    fn regulate<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
        moving: &Moving<'_, T>,
        two_per_dt: Option<T>,
    ) -> Wanted<T> {
        let command = &moving.command.twist;
        let aim = self.aim::<M>(motion, error);
        let distance = distance_of::<T, M>(&aim);
        let setpoint = self
            .memory
            .regulator
            .advance::<U, M>(motion, &aim, distance, command, two_per_dt);
        Wanted {
            setpoint,
            transition: Transition::after(two_per_dt),
        }
    }

    /// What to drive at by feedback: the goal, or the place that a retry drives out to.
    fn aim<M: Maths<T>>(
        &self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
    ) -> PoseError<T> {
        if self.memory.retry.is_out() {
            self.memory.retry.aim::<M>(motion, error)
        } else {
            *error
        }
    }

    /// Wheels slide. A manoeuvre under way asks for less, once; where one is still being searched for, the robot comes to rest.
    #[cold]
    pub(crate) fn declare_slide(&mut self) {
        let drives = matches!(&self.approach, Approach::Manoeuvre(execution) if !execution.is_over() && !execution.is_searching());
        if drives && !self.memory.has_slid() {
            self.memory.grip = Grip::Lost;
        }
    }

    /// Not at rest, and no manoeuvre under way: feedback brings the robot to its goal, or holds it there.
    pub(crate) fn is_beside(&self) -> bool {
        !self.is_driving() && !self.is_resting()
    }

    /// Wheels slid on the way to this goal.
    pub(crate) fn has_slid(&self) -> bool {
        self.memory.has_slid()
    }

    /// Nothing is asked for any more: parked, or given up.
    pub(crate) fn is_resting(&self) -> bool {
        self.memory.checker.parked || self.memory.retry.given_up
    }

    /// At the goal within tolerance.
    pub(crate) fn is_parked(&self) -> bool {
        self.memory.checker.parked
    }

    /// At rest outside of the tolerance, after all retries.
    pub(crate) fn has_given_up(&self) -> bool {
        self.memory.retry.given_up
    }

    /// New approaches so far.
    pub(crate) fn retries(&self) -> u8 {
        self.memory.retry.count
    }

    /// How the robot stops at its goal.
    fn ending(&self) -> Ending {
        match &self.approach {
            Approach::Manoeuvre(_) => Ending::AtOnce,
            Approach::Idle | Approach::Chase | Approach::Regulate => Ending::Fading,
        }
    }

    /// The robot backs up.
    pub(crate) fn is_backing(&self) -> bool {
        match &self.approach {
            Approach::Manoeuvre(execution) => execution.is_backing(),
            Approach::Idle | Approach::Chase | Approach::Regulate => {
                self.memory.regulator.is_backing()
            }
        }
    }

    /// Of what may have changed since the last tick: a manoeuvre leaves the feedback alone, but that it lets its neurons rest.
    pub(crate) fn residue(&self) -> T {
        match &self.approach {
            Approach::Manoeuvre(execution) => execution.residue(),
            Approach::Idle | Approach::Chase | Approach::Regulate => {
                self.memory.regulator.residue()
            }
        }
    }
}

/// Of a robot that stands at its goal: a standard deviation of the pose along the goal \[m\] and of its heading \[rad\], of which
/// the tolerance has [`HEADING_DEVIATIONS`]; none where no noise is stated.
///
/// One that has not come to rest `since_s` \[s\], two dwells after its manoeuvre, hunts: bearings that are freer than its friction compensation
/// reckons with turn it to and fro. In the next two its dead band widens to half of the tolerance.
fn dead_band<T: Scalar>(motion: &ValidMotionParams<T>, since_s: T) -> (T, T) {
    if !motion.noisy {
        return (T::ZERO, T::ZERO);
    }
    let params = motion.params();
    let share = T::from_f64(1.0 / HEADING_DEVIATIONS);
    let (along, around) = (params.pose_noise_m, share * params.arrival.heading_rad);
    let two_dwells = params.arrival.dwell_s + params.arrival.dwell_s;
    if since_s <= two_dwells {
        return (along, around);
    }
    let hunting = smaller((since_s - two_dwells) / two_dwells, T::ONE);
    let half = |band, tolerance| band + hunting * (T::HALF * tolerance - band);
    (
        half(along, params.arrival.distance_m),
        half(around, params.arrival.heading_rad),
    )
}

impl<T: Scalar> Approach<T> {
    /// A manoeuvre has still to be found or driven.
    fn is_under_way(&self) -> bool {
        matches!(self, Self::Manoeuvre(execution) if !execution.is_over())
    }

    /// By a manoeuvre, and how it goes on from the command; a robot that is where it should be has none to make. With ticks
    /// longer than the time constant of the follower's neurons by feedback: the follower holds no robot at rest then, and
    /// the regulator is slower.
    ///
    /// A robot that comes to rest at once starts from there: what is left of its motion fades beside the manoeuvre, which
    /// costs the search nothing. At its goal but for the heading it turns on the spot.
    fn begin<M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        slower: bool,
        at: &GoalView<'_, T>,
        hold: bool,
        dt: T,
    ) -> Transition {
        let planned = motion.params().arrival.parking == Parking::Planned;
        if !planned || motion.gains().decay * dt > T::ONE {
            *self = Self::Regulate;
            return Transition::Offset;
        }
        *self = Self::Manoeuvre(Execution::at_goal());
        let Self::Manoeuvre(execution) = self else {
            return Transition::Offset;
        };
        if hold {
            // Nothing leads there from how it moves.
            return Transition::Offset;
        }
        let rest = at.error_at_rest(motion, dt);
        let there = stops_there(motion, at, &rest);
        let rests = there || is_nearly_still(motion, at, &rest);
        let still = Command::default();
        let (Command { twist, rate }, transition) = if rests {
            (&still, Transition::Offset)
        } else {
            (at.command, Transition::Seamless)
        };
        let PoseError { x, y, theta } = at.view.error;
        if !rests {
            let pace = Pace {
                slower,
                ..Pace::default()
            };
            let plan = motion.plan.at(pace);
            let rolls_on = execution.roll_on::<M>(&plan, at.view.goal(), twist, rate, dt);
            if rolls_on.is_some() {
                return Transition::Offset;
            }
        }
        let (x, y) = if there { (T::ZERO, T::ZERO) } else { (x, y) };
        let error = PoseError { x, y, theta };
        execution.start::<M>(&motion.plan, slower, &error, twist, rate, dt);
        if there {
            execution.turn_only();
        }
        transition
    }
}

/// Further from the reference than [`DEPARTURE`].
fn has_departed<T: Scalar>(motion: &ValidMotionParams<T>, error: &PoseError<T>) -> bool {
    let (far, turned) = (T::from_f64(DEPARTURE.0), T::from_f64(DEPARTURE.1));
    let most = far + motion.near;
    let PoseError { x, y, theta } = *error;
    x * x + y * y > most * most || theta.abs() > turned
}

/// Slow, and within tolerance: what holds the robot there brings it to rest.
fn is_inside<T: Scalar>(motion: &ValidMotionParams<T>, at: &GoalView<'_, T>) -> bool {
    let arrival = &motion.params().arrival;
    at.asked <= arrival.stall_speed
        && at.is_within(arrival.distance_m)
        && at.view.error.theta.abs() < arrival.heading_rad
}

/// What is left of its motion moves the robot by less than half of what is tolerated at the goal.
fn is_nearly_still<T: Scalar>(
    motion: &ValidMotionParams<T>,
    at: &GoalView<'_, T>,
    rest: &PoseError<T>,
) -> bool {
    let arrival = &motion.params().arrival;
    let error = &at.view.error;
    (rest.x - error.x).abs() < T::HALF * arrival.distance_m
        && (rest.theta - error.theta).abs() < arrival.heading_rad
}

/// At the goal but for the heading, once it is at `rest`.
fn stops_there<T: Scalar>(
    motion: &ValidMotionParams<T>,
    at: &GoalView<'_, T>,
    rest: &PoseError<T>,
) -> bool {
    let arrival = &motion.params().arrival;
    let PoseError { x, y, .. } = *rest;
    at.asked <= arrival.stall_speed && x * x + y * y < arrival.distance_m * arrival.distance_m
}

#[cfg(test)]
mod tests {
    use crate::error::{Input, StepFault};
    use crate::maths::{Libm, Maths};
    use crate::motion::{Limits, MotionController, MotionParams, Outcome, Task, ValidMotionParams};
    use crate::robot::Robot;
    use crate::types::{Measured, Pose, Twist};

    /// A standard deviation each for two dwells, and half of the tolerance after four; nothing where poses are exact.
    #[test]
    fn a_robot_that_hunts_contents_itself() {
        let mut motion = MotionParams::<f64>::new(Robot::paper(), Limits::PAPER);
        let exact = motion.validate().expect("valid");
        assert_eq!(super::dead_band(&exact, 100.0), (0.0, 0.0));
        motion.pose_noise_m = 1.0e-3;
        motion.arrival.distance_m = 6.0e-3;
        motion.arrival.heading_rad = 8.0e-3;
        motion.arrival.dwell_s = 0.5;
        let noisy = motion.validate().expect("valid");
        for (since_s, along, around) in [
            (0.0, 1.0e-3, 1.0e-3),
            (1.0, 1.0e-3, 1.0e-3),
            (1.5, 2.0e-3, 2.5e-3),
            (2.0, 3.0e-3, 4.0e-3),
            (9.0, 3.0e-3, 4.0e-3),
        ] {
            let band = super::dead_band(&noisy, since_s);
            assert!((band.0 - along).abs() < 1e-15 && (band.1 - around).abs() < 1e-15);
        }
    }

    /// Whatever the gains are, what is within reach is not refused, though it be far off or the robot fast; what is beyond is refused
    /// before anything has changed.
    #[test]
    fn within_reach_no_tick_is_refused() {
        let mut motion = MotionParams::<f32>::new(Robot::paper(), Limits::PAPER.cast());
        for (heading, lateral, slow) in [
            (2.0, 2.0, 0.1),
            (1.0e-3, 100.0, 1.0e-4),
            (100.0, 1.0e-3, 10.0),
        ] {
            motion.gains.heading = heading;
            motion.gains.lateral = lateral;
            motion.gains.slow = slow;
            let motion = motion.validate().expect("valid");
            for away in [0.0, 1.0, 100.0, 3.0e3] {
                for speed in [0.0, 1.0, 1.0e3] {
                    let task = Task::Park(Pose::new(away, -away, 2.0));
                    let mut now = Measured::default();
                    let mut controller: MotionController =
                        MotionController::start(&motion, &task, &now).expect("within reach");
                    for tick in 0..400 {
                        // Fast now and then, as by a measurement that is wrong.
                        let fast = if tick % 90 == 70 { speed } else { 0.0 };
                        now.twist = controller.report().command;
                        now.twist.linear += fast;
                        let result = controller.step(0.01, &task, &now).copied();
                        assert!(
                            result.is_ok(),
                            "{heading} {away} {speed} {tick}: {result:?}"
                        );
                    }
                    let before = controller;
                    now.twist.angular = 2.0e4;
                    let result = controller.step(0.01, &task, &now).copied();
                    assert_eq!(result, Err(StepFault::Overflow));
                    assert_eq!(controller, before);
                }
            }
        }
    }

    /// At every instant of a manoeuvre a wild pose, goal or twist is refused, and nothing has changed.
    #[test]
    fn along_a_manoeuvre_what_is_not_finite_changes_nothing() {
        let motion = MotionParams::new(Robot::paper(), Limits::PAPER);
        let motion = motion.validate().expect("valid");
        let goal = Pose::new(0.6, 0.3, 0.2);
        let (task, dt) = (Task::Park(goal), 0.01);
        let mut now = Measured::default();
        let mut controller: MotionController<f64, Libm> =
            MotionController::start(&motion, &task, &now).expect("finite");
        let mut driven = 0;
        for _ in 0..600 {
            controller.step(dt, &task, &now).expect("finite");
            driven += u32::from(controller.report().command != Twist::default());
            // A robot that does what is commanded.
            now.twist = controller.report().command;
            let (sine, cosine) = Libm::sin_cos(now.pose.theta);
            now.pose.x += dt * now.twist.linear * cosine;
            now.pose.y += dt * now.twist.linear * sine;
            now.pose.theta += dt * now.twist.angular;
            let before = controller;
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                for place in 0..8 {
                    let (mut measured, mut other) = (now, goal);
                    let (wild, input) = match place {
                        0 => (&mut measured.pose.x, Input::Pose),
                        1 => (&mut measured.pose.y, Input::Pose),
                        2 => (&mut measured.pose.theta, Input::Pose),
                        3 => (&mut measured.twist.linear, Input::Twist),
                        4 => (&mut measured.twist.angular, Input::Twist),
                        5 => (&mut other.x, Input::Goal),
                        6 => (&mut other.y, Input::Goal),
                        _ => (&mut other.theta, Input::Goal),
                    };
                    *wild = wrong;
                    let result = controller.step(dt, &Task::Park(other), &measured).copied();
                    assert_eq!(result, Err(StepFault::NotFinite(input)), "{place}");
                    assert_eq!(controller, before, "{place}");
                }
            }
            // So large that something overflows, if not here, then in the torque.
            for wild in [1.0e20, 1.0e150, 1.0e308] {
                let mut measured = now;
                measured.pose.x = wild;
                if controller.step(dt, &task, &measured).is_err() {
                    assert_eq!(controller, before, "{wild}");
                }
                controller = before;
            }
        }
        assert!(driven > 100, "{driven}");
    }

    /// Arrival within 4 mm and 8 mrad, an eighth of which is noise where poses are noisy.
    fn noisy(pose_noise_m: f64) -> ValidMotionParams<f64> {
        let mut motion = MotionParams::new(Robot::paper(), Limits::PAPER);
        motion.pose_noise_m = pose_noise_m;
        motion.arrival.distance_m = 4.0e-3;
        motion.arrival.heading_rad = 8.0e-3;
        motion.arrival.dwell_s = 1.0;
        motion.validate().expect("valid")
    }

    /// A robot that stands at the origin sees itself at `pose` for `ticks` of 10 ms; the largest torque that it demands.
    fn stands(
        controller: &mut MotionController<f64, Libm>,
        ticks: usize,
        pose: impl Fn(usize) -> Pose<f64>,
    ) -> f64 {
        let task = Task::Park(Pose::default());
        let torques = (0..ticks).map(|tick| {
            let now = Measured {
                pose: pose(tick),
                twist: Twist::default(),
            };
            let report = controller.step(0.01, &task, &now).expect("finite");
            report.torques.right.abs() + report.torques.left.abs()
        });
        torques.fold(0.0, f64::max)
    }

    fn at_home(motion: &ValidMotionParams<f64>) -> MotionController<f64, Libm> {
        let task = Task::Park(Pose::default());
        MotionController::start(motion, &task, &Measured::default()).expect("finite")
    }

    /// What is within a standard deviation moves no wheel, on either side; what is beyond does, and so does the same error where no
    /// noise is stated.
    #[test]
    fn a_robot_that_stands_at_its_goal_does_not_follow_noise() {
        let (along, around) = (0.5e-3, 1.0e-3);
        for (share, moves) in [(0.99, false), (-0.99, false), (1.2, true), (-1.2, true)] {
            for off in [
                Pose::new(share * along, 0.0, 0.0),
                Pose::new(0.0, 0.0, share * around),
            ] {
                let (mut noisy, mut exact) = (at_home(&noisy(along)), at_home(&noisy(0.0)));
                let most = stands(&mut noisy, 50, |_| off);
                assert_eq!(most > 0.0, moves, "{off:?}: {most}");
                assert!(stands(&mut exact, 50, |_| off) > 0.0, "{off:?}");
            }
        }
    }

    /// A robot that is held 20 mm aside of its goal, until it has spent an attempt.
    fn spends_an_attempt(controller: &mut MotionController<f64, Libm>) {
        for _ in 0..100 {
            stands(controller, 100, |_| Pose::new(0.0, 20.0e-3, 0.0));
            if controller.report().retries > 0 {
                return;
            }
        }
        panic!("no attempt within 100 s");
    }

    /// What was tried from a wrong pose is forgotten when the pose jumps, three times, and as often again once the robot has parked there.
    #[test]
    fn a_pose_that_jumped_forgets_attempts() {
        let motion = noisy(0.0);
        let aside = |_| Pose::new(0.0, 20.0e-3, 0.0);
        let mut controller = at_home(&motion);
        for round in 0..2 {
            for jump in 0..4 {
                spends_an_attempt(&mut controller);
                controller.declare_jump();
                stands(&mut controller, 1, aside);
                let left = u8::from(jump == 3);
                assert_eq!(controller.report().retries, left, "{round} {jump}");
            }
            // It may be driving out, and gives that up first.
            stands(&mut controller, 4000, |_| Pose::default());
            assert_eq!(controller.report().outcome, Outcome::Parked, "{round}");
        }
    }

    /// Once inside of 4 mm, it is parked after the dwell if it was not beyond 1.3 times that since; where it is then does not matter.
    #[test]
    fn parked_within_the_hysteresis() {
        for (aside, outcome) in [(5.1e-3, Outcome::Parked), (5.3e-3, Outcome::Driving)] {
            let mut controller = at_home(&noisy(0.5e-3));
            let place = |tick| Pose::new(0.0, if tick < 20 { 3.9e-3 } else { aside }, 0.0);
            stands(&mut controller, 98, place);
            assert_eq!(controller.report().outcome, Outcome::Driving);
            stands(&mut controller, 4, |_| place(20));
            assert_eq!(controller.report().outcome, outcome, "{aside}");
        }
        // Not inside yet, the wider tolerance does not count.
        let mut controller = at_home(&noisy(0.5e-3));
        stands(&mut controller, 30, |_| Pose::new(0.0, 4.1e-3, 0.0));
        stands(&mut controller, 80, |_| Pose::new(0.0, 3.9e-3, 0.0));
        assert_eq!(controller.report().outcome, Outcome::Driving);
    }

    /// The follower commands a speed for the millimetre that is left; a few ticks after the dwell there is none.
    #[test]
    fn a_robot_that_a_manoeuvre_led_there_stops_at_once() {
        let mut controller = at_home(&noisy(0.0));
        let off = |_| Pose::new(1.0e-3, 0.0, 1.0e-3);
        stands(&mut controller, 98, off);
        let report = *controller.report();
        assert_eq!(report.outcome, Outcome::Driving);
        assert!(report.command.linear < -1.0e-4 && report.command.angular < -1.0e-4);
        stands(&mut controller, 5, off);
        assert_eq!(controller.report().outcome, Outcome::Parked);
        assert_eq!(controller.report().command, Twist::default());
    }
}
