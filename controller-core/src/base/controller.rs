//! The tick of a base.

use super::io::{Drive, Order, Sensed, WheelAction};
use super::locate::{Located, Locator, coast};
use super::params::Base;
use super::report::BaseReport;
use crate::error::StepFault;
use crate::localiser::FixOutcome;
use crate::maths::{Maths, Single};
use crate::motion::{MotionController, Outcome, Task};
use crate::reference::Reference;
use crate::safety::supervisor::{Action, Event, State, Supervisor};
use crate::safety::{Evidence, Fault, Findings, Monitor, OutputMode, StopPlan};
use crate::scalar::Scalar;
use crate::shunting::{NeuronUpdate, RationalMean};
use crate::types::{Accel, Measured, Pose, Twist, WheelTorques};

mod drive;
mod host;

/// Poses remembered for late fixes, unless stated otherwise: 0.3 s at 10 ms.
pub const REMEMBERED: usize = 32;

/// A base: localiser, monitor, supervisor and motion law behind one tick. See [`crate::base`].
///
/// ```
/// use controller_core::base::{BaseController, BaseParams, Order, Sensed};
/// use controller_core::hal::WheelCounts;
/// use controller_core::localiser::LocaliserParams;
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, Policy};
/// use controller_core::odometry::{Calibration, OdometryParams};
/// use controller_core::robot::Robot;
/// use controller_core::safety::supervisor::{Event, State};
/// use controller_core::types::Pose;
///
/// let robot = Robot::<f32>::paper();
/// let limits = Limits {
///     speed: 1.0, turn_rate: 2.0, accel: 0.8, brake: 1.0, turn_accel: 3.0,
///     jerk: 20.0, turn_jerk: 40.0, wheel_torque_nm: 8.0, policy: Policy::KeepCurvature,
/// };
/// let localiser = LocaliserParams {
///     odometry: OdometryParams {
///         wheels: robot.wheels, calibration: Calibration::NOMINAL, counts_per_turn: 2048.0, bandwidth: 50.0,
///     },
///     fusion: None,
/// };
/// let base = BaseParams::new(robot, limits, localiser, None, 10_000)?.validate()?;
/// let mut controller: BaseController = BaseController::new(&base, Pose::default());
/// let sensed = Sensed::of_counts(WheelCounts::default());
/// controller.tick(10_000, &Order::None, &sensed);
/// controller.on(Event::Arm);
/// let report = controller.tick(10_000, &Order::Park(Pose::new(1.0, 0.0, 0.0)), &sensed);
/// assert_eq!(report.state, State::Parking);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseController<T = f32, M = Single, U = RationalMean, const N: usize = REMEMBERED> {
    base: Base<T>,
    locator: Locator<T, N>,
    monitor: Monitor<T>,
    supervisor: Supervisor,
    /// While its torque flows.
    motion: Option<MotionController<T, M, U>>,
    /// Of a controlled stop, and the time since its begin \[s\].
    stop: Option<(StopPlan<T>, T)>,
    task: Option<Task<T>>,
    /// Exerted since the last tick.
    exerted: WheelTorques<T>,
    silent_us: u32,
    report: BaseReport<T>,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>, const N: usize> BaseController<T, M, U, N> {
    /// Disarmed, at `start` with the first reading of the encoders.
    pub fn new(base: &Base<T>, start: Pose<T>) -> Self {
        let supervisor = Supervisor::new(&base.supervisor);
        Self {
            base: *base,
            locator: Locator::new(&base.localisation, start),
            monitor: Monitor::new(&base.watch),
            motion: None,
            stop: None,
            task: None,
            exerted: WheelTorques::default(),
            silent_us: 0,
            report: BaseReport {
                action: WheelAction::Release,
                state: supervisor.state(),
                cause: supervisor.cause(),
                measured: None,
                blind: false,
                bend: T::ZERO,
                fix: FixOutcome::Absent,
                findings: Findings::NONE,
                refused: false,
                motion: None,
            },
            supervisor,
        }
    }

    /// One tick, `dt_us` after the last.
    pub fn tick(&mut self, dt_us: u32, order: &Order<T>, sensed: &Sensed<T>) -> &BaseReport<T> {
        let dt = seconds(dt_us);
        let mut findings = Findings::NONE;
        let accel = self.exerted_accel();
        let located = match self.locator.advance::<M>(dt, &accel, sensed) {
            Ok(located) => located,
            Err(fault) => {
                findings.add(fault.into());
                Located {
                    measured: self.report.measured,
                    fix: FixOutcome::Absent,
                    fix_age_s: None,
                    jumped: false,
                    blind: true,
                    bend: self.report.bend,
                }
            }
        };
        self.silent_us = match order {
            Order::None => self.silent_us.saturating_add(dt_us),
            Order::Follow(_) | Order::Park(_) => 0,
        };
        let evidence = self.evidence(dt_us, &located, sensed);
        for fault in self.monitor.check(&evidence).iter() {
            findings.add(fault);
        }
        findings.add_some(self.given_up());
        self.supervisor.on_findings(&findings, &self.base.policy);
        let refused = self.take(dt, order);
        let rests = located.measured.is_some_and(|measured| {
            let Twist { linear, angular } = measured.twist;
            let single = |value: T| value.to_f64() as f32;
            self.supervisor.rests(single(linear), single(angular))
        });
        // Whether that can be believed, the supervisor knows from the findings.
        self.supervisor.tick(dt_us, rests);
        let action = self.act(dt, &located, &mut findings);
        self.exerted = action.torques().unwrap_or_default();
        let driven = self.motion.as_ref();
        self.report = BaseReport {
            action,
            state: self.supervisor.state(),
            cause: self.supervisor.cause(),
            measured: located.measured,
            blind: located.blind,
            bend: located.bend,
            fix: located.fix,
            findings,
            refused,
            motion: driven.map(|motion| *motion.report()),
        };
        &self.report
    }

    /// The report of the last tick.
    pub const fn report(&self) -> &BaseReport<T> {
        &self.report
    }

    /// The parameters in use.
    pub const fn base(&self) -> &Base<T> {
        &self.base
    }

    /// The supervisor, to look at.
    pub const fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    fn exerted_accel(&self) -> Accel<T> {
        let wrench = self.base.motion.wheels().wrench(&self.exerted);
        let robot = &self.base.motion.params().robot;
        Accel {
            linear: wrench.force / robot.mass_kg,
            angular: wrench.moment / robot.inertia_kg_m2,
        }
    }

    fn evidence(&self, dt_us: u32, located: &Located<T>, sensed: &Sensed<T>) -> Evidence<T> {
        let driven = self.motion.as_ref();
        Evidence {
            dt_us,
            counts: sensed.counts.ok(),
            // Before the first reading: at rest, which the counts that are missing say more about.
            measured: located.measured.unwrap_or_default(),
            outside: None,
            command: driven.map_or(Twist::default(), |motion| motion.report().command),
            torques: match self.report.action {
                WheelAction::Brake => None,
                WheelAction::Drive(_) | WheelAction::Release => Some(self.exerted),
            },
            pose_age_us: located.fix_age_s.map_or(0, microseconds),
            command_age_us: self.silent_us,
            pose_jumped: located.jumped,
            driver: sensed.driver.err(),
            supply_v: sensed.supply_v,
            currents: sensed.currents,
        }
    }

    /// What the motion law said in the last tick about getting there.
    fn given_up(&self) -> Option<Fault> {
        if !self.supervisor.state().drives() {
            return None;
        }
        match self.motion.as_ref()?.report().outcome {
            Outcome::Stalled => Some(Fault::Stalled),
            Outcome::OutOfTolerance => Some(Fault::GaveUp),
            _ => None,
        }
    }

    /// Takes an order into the task, as far as the state allows; whether it was refused.
    fn take(&mut self, dt: T, order: &Order<T>) -> bool {
        let (task, event) = match order {
            Order::None => {
                if let Some(Task::Follow(reference)) = &self.task {
                    self.task = Some(Task::Follow(onward::<T, M>(reference, dt)));
                }
                return false;
            }
            Order::Follow(reference) => (Task::Follow(*reference), Event::Track),
            Order::Park(goal) => (Task::Park(*goal), Event::Park),
        };
        let goes_on = match (&self.task, &task) {
            (Some(Task::Park(old)), Task::Park(new)) => {
                let there = self.supervisor.state();
                old == new && (there.drives() || there == State::Parked)
            }
            _ => false,
        };
        if goes_on {
            return false;
        }
        match self.supervisor.on(event) {
            Action::Refuse => true,
            _ => {
                self.task = Some(task);
                false
            }
        }
    }
}

/// A reference a tick on, as far as its twist tells.
fn onward<T: Scalar, M: Maths<T>>(reference: &Reference<T>, dt: T) -> Reference<T> {
    let from = Measured {
        pose: *reference.pose(),
        twist: *reference.twist(),
    };
    let Measured { pose, twist } = coast::<T, M>(&from, dt);
    Reference::new_with::<M>(pose, twist, Accel::default())
}

fn seconds<T: Scalar>(us: u32) -> T {
    T::from_i32(i32::try_from(us).unwrap_or(i32::MAX)) * T::from_f64(1.0e-6)
}

/// Saturates; what is no number is as old as can be.
fn microseconds<T: Scalar>(seconds: T) -> u32 {
    let us = seconds.to_f64() * 1.0e6;
    if us >= 0.0 { us as u32 } else { u32::MAX }
}

type Stepped<T> = Result<WheelAction<T>, StepFault>;
