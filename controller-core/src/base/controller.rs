//! The tick of a base.

use super::driving::{Driving, Tick};
use super::host_watch::HostWatch;
use super::io::{Order, Sensed, WheelAction};
use super::locate::{Located, Locator};
use super::motor_bias::MotorBias;
use super::orders::{self, Leading};
use super::over_speed::OverSpeed;
use super::params::ValidBaseParams;
use super::report::BaseReport;
use super::speed_drive::{SpeedDrive, SpeedTick};
use super::wheel_friction::{Creeps, Turning};
use crate::error::{Input, StepFault};
use crate::gyro::Encoder;
use crate::maths::{Maths, Single};
use crate::motion::{Mode, Outcome};
use crate::motor::{Motor, SpeedLimited};
use crate::odometry::Accelerations;
use crate::range::larger;
use crate::robot::{acceleration, wrench_for};
use crate::safety::supervisor::{Action, Event, State, Supervisor};
use crate::safety::{ActiveFaults, DetectorInputs, Detectors, Fault, OutputMode, Side};
use crate::scalar::{Scalar, seconds};
use crate::shunting::{NeuronUpdate, RationalMean};
use crate::types::{Accel, Pose, Twist, WheelSpeeds, WheelTorques, Wrench};

/// Poses remembered for late fixes, unless stated otherwise: 0.3 s at 10 ms.
pub const REMEMBERED: usize = 32;

/// A wheel that slides for longer stops the base, as the policy says \[s\]: three times as long as a faulty gyro takes to show.
const SLIDES_S: f64 = 0.15;

/// A base: localiser, monitor, supervisor and motion law behind one tick. See [`crate::base`].
///
/// ```
/// use controller_core::base::{BaseController, BaseParams, Order, Sensed};
/// use controller_core::hal::WheelCounts;
/// use controller_core::localiser::LocaliserParams;
/// use controller_core::maths::Single;
/// use controller_core::motion::{Limits, SaturationPolicy};
/// use controller_core::motor::DriverParams;
/// use controller_core::odometry::{Calibration, OdometryParams};
/// use controller_core::robot::Robot;
/// use controller_core::safety::supervisor::{Event, State};
/// use controller_core::types::Pose;
///
/// let robot = Robot::<f32>::paper();
/// let limits = Limits {
///     speed: 1.0, turn_rate: 2.0, rim_speed: 1.2, accel: 0.8, brake: 1.0, turn_accel: 3.0,
///     jerk: 20.0, turn_jerk: 40.0, wheel_torque_nm: 8.0, policy: SaturationPolicy::KeepCurvature,
/// };
/// let localiser = LocaliserParams {
///     odometry: OdometryParams {
///         wheels: robot.wheels, calibration: Calibration::NOMINAL, counts_per_turn: 2048.0, bandwidth: 50.0,
///     },
///     fusion: None,
///     gyro: None,
/// };
/// let base = BaseParams::new(robot, limits, localiser, DriverParams::Torques, 10_000)?.validate()?;
/// let mut controller: BaseController = BaseController::new(&base, Pose::default());
/// let sensed = Sensed::of_counts(WheelCounts::default());
/// controller.tick(10_000, &Order::None, &sensed);
/// controller.on(Event::Arm);
/// let report = controller.tick(10_000, &Order::Park(Pose::new(1.0, 0.0, 0.0)), &sensed);
/// assert_eq!(report.state, State::Parking);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
// In this order: an instruction of a Cortex-M4 reaches numbers no further than 1,020 bytes from a pointer, and what a tick reads and
// writes most lies within that. In the order of the compiler's choice a tick takes 20 instructions more.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseController<T = f32, M = Single, U = RationalMean, const N: usize = REMEMBERED> {
    /// Exerted since the last tick.
    exerted: WheelTorques<T>,
    detectors: Detectors<T>,
    report: BaseReport<T>,
    host: HostWatch,
    over_speed: OverSpeed,
    supervisor: Supervisor,
    base: ValidBaseParams<T>,
    locator: Locator<T, N>,
    motors: MotorBias<T>,
    driving: Driving<T, M, U>,
    /// Of drivers that close their own speed loop.
    speeds: SpeedDrive<T>,
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>, const N: usize> BaseController<T, M, U, N> {
    /// Disarmed, at `start` with the first reading of the encoders.
    pub fn new(base: &ValidBaseParams<T>, start: Pose<T>) -> Self {
        let supervisor = Supervisor::new(&base.supervisor);
        Self {
            base: *base,
            locator: Locator::new(start),
            detectors: Detectors::default(),
            driving: Driving::IDLE,
            motors: MotorBias::default(),
            speeds: SpeedDrive::default(),
            exerted: WheelTorques::default(),
            host: HostWatch::NEW,
            over_speed: OverSpeed::default(),
            report: BaseReport::new(supervisor.state(), supervisor.cause()),
            supervisor,
        }
    }

    /// One tick, `dt_us` after the last.
    pub fn tick(&mut self, dt_us: u32, order: &Order<T>, sensed: &Sensed<T>) -> &BaseReport<T> {
        let dt = seconds(dt_us);
        self.report.active_faults.clear();
        let accelerations = self.accelerations();
        let Self {
            locator,
            base,
            report,
            ..
        } = self;
        let (localisation, motion) = (&base.localisation, base.motion.params());
        let bounds = (&accelerations, motion.limits.rim_speed);
        let located = locator.advance::<M>(localisation, dt, bounds, sensed, report);
        let period_us = self.base.detectors.params().period_us;
        let given = !matches!(order, Order::None);
        self.host.order(dt_us, period_us, given);
        let inputs = self.inputs(dt_us, &located, sensed);
        self.detectors.check(
            &self.base.detectors,
            &inputs,
            !self.report.blind,
            &mut self.report.active_faults,
        );
        let over_speed = self.over_speed(dt_us);
        let given_up = self.given_up();
        if self.report.gyro.slides_s > T::ZERO {
            self.yield_to_slide();
        }
        let gyro = self.report.gyro.fault;
        let active_faults = &mut self.report.active_faults;
        active_faults.add_some(over_speed);
        active_faults.add_some(given_up);
        active_faults.add_some(gyro.map(Fault::Gyro));
        self.supervisor
            .on_active_faults(active_faults, &self.base.policy);
        let leading = Leading {
            end: &mut self.driving.end,
            motion: &self.base.motion,
            measured: self.report.measured.as_ref(),
        };
        let task = &mut self.driving.task;
        let taken = orders::take::<T, M>(order, task, &mut self.supervisor, leading, dt);
        // Whether that can be believed, the supervisor knows from the active faults.
        let rests = self.supervisor.state().ends_at_rest() && self.rests();
        self.supervisor.tick(dt_us, rests);
        let mut action = self.act(dt, &located, taken.other_goal, sensed);
        if self.base.driver.speeds().is_some() {
            action = self.by_speeds(action, dt, sensed);
        }
        self.exerted = action.torques().unwrap_or_default();
        let report = &mut self.report;
        report.action = action;
        report.state = self.supervisor.state();
        report.cause = self.supervisor.cause();
        report.refused = taken.refused;
        report
    }

    /// The report of the last tick.
    pub const fn report(&self) -> &BaseReport<T> {
        &self.report
    }

    /// The parameters in use.
    pub const fn base(&self) -> &ValidBaseParams<T> {
        &self.base
    }

    /// The supervisor, to look at.
    pub const fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    fn accelerations(&self) -> Accelerations<T> {
        let exerted = self.base.motion.wheels().wrench(&self.exerted);
        let Some(report) = &self.report.motion else {
            return Accelerations::exerted(self.unloaded(&exerted));
        };
        // What friction and slopes take of the torques accelerates nothing, and odometry finds that by itself, but not of a wheel that
        // creeps: driving by velocity may. Parking knows it otherwise: a wheel that stands has to be pushed.
        let creeps = report.mode == Mode::Driving;
        let by = |wrench| report.load.slowed(&self.unloaded(wrench));
        Accelerations {
            exerted: by(&exerted),
            disturbance: creeps.then(|| by(&report.disturbance)),
        }
    }

    /// Acceleration of the base without a load.
    fn unloaded(&self, wrench: &Wrench<T>) -> Accel<T> {
        acceleration(&self.base.motion.params().robot, wrench)
    }

    fn inputs(&self, dt_us: u32, located: &Located, sensed: &Sensed<T>) -> DetectorInputs<T> {
        DetectorInputs {
            dt_us,
            counts: sensed.counts.ok(),
            // Before the first reading: at rest, which the counts that are missing say more about.
            measured: self.report.measured.unwrap_or_default(),
            outside: None,
            command: self.commanded(),
            torques: match self.report.action {
                WheelAction::Brake => None,
                WheelAction::Drive(_) | WheelAction::Release => Some(self.exerted),
            },
            pose_age_us: located.fix_age_us,
            command_age_us: self.host.order_age_us(),
            pose_jumped: located.poses_jumped,
            driver: sensed.driver.err(),
            supply_v: sensed.supply_v,
            currents: sensed.currents,
        }
    }

    /// The base is known to be at rest.
    fn rests(&self) -> bool {
        self.report.measured.is_some_and(|measured| {
            let Twist { linear, angular } = measured.twist;
            let single = |value: T| value.to_f64() as f32;
            self.supervisor.rests(single(linear), single(angular))
        })
    }

    /// The command in force; none is rest.
    fn commanded(&self) -> Twist<T> {
        let report = self.report.motion.as_ref();
        report.map_or_else(Twist::default, |report| report.command)
    }

    /// A wheel slides, or its encoder is wrong. Of a slide the law is told. Either is a fault for longer than [`SLIDES_S`], and a slide where the law
    /// yields, for longer than that takes as well: 2 a/j, at half the jerk of a manoeuvre that begins in motion.
    #[cold]
    #[inline(never)]
    fn yield_to_slide(&mut self) {
        let slid = self.report.gyro.slid;
        let (fault, yields_s) = match self.locator.encoder() {
            // Lifted or turned by hand a base has such wheels as well.
            Some(_) if !self.supervisor.state().drives() => return,
            Some(Encoder::Dead { right: true }) => (Fault::EncoderStuck(Side::Right), T::ZERO),
            Some(Encoder::Dead { right: false }) => (Fault::EncoderStuck(Side::Left), T::ZERO),
            // Turned on the spot to make up for a gyro's bias, wheels do the same.
            Some(Encoder::Reversed) if self.exerted.right * self.exerted.left <= T::ZERO => return,
            // What it counts is against its wheel's torque.
            Some(Encoder::Reversed) => (Fault::EncoderReversed(self.sliding(-slid)), T::ZERO),
            None => {
                self.driving.declare_slide();
                (Fault::WheelSlip(self.sliding(slid)), self.yields_s())
            }
        };
        if self.report.gyro.slides_s > T::from_f64(SLIDES_S) + yields_s {
            self.report.active_faults.add(fault);
        }
    }

    /// How long the law takes to yield to a slide; 0 where it does not.
    fn yields_s(&self) -> T {
        let limits = &self.base.motion.params().limits;
        let ramp_s = larger(
            limits.accel / limits.jerk,
            limits.turn_accel / limits.turn_jerk,
        );
        match &self.report.motion {
            Some(report) if report.limited.grip => ramp_s + ramp_s,
            _ => T::ZERO,
        }
    }

    /// Which wheel slides, where the wheels have turned the base by `slid` more than a gyro: a wheel slides the way that its own
    /// torque pushes it, so forward on the right or backward on the left if `slid` is above 0.
    fn sliding(&self, slid: T) -> Side {
        let WheelTorques { right, left } = self.exerted;
        let (right, left) = if slid > T::ZERO {
            (right, -left)
        } else {
            (-right, left)
        };
        if right > left {
            Side::Right
        } else {
            Side::Left
        }
    }

    /// Wheels that turn too fast.
    #[inline(always)]
    fn over_speed(&mut self, dt_us: u32) -> Option<Fault> {
        let twist = &self.report.measured.as_ref()?.twist;
        let limits = &self.base.over_speed;
        self.over_speed
            .check(limits, &self.base.motion, twist, dt_us)
    }

    /// What the motion law said in the last tick about getting there.
    fn given_up(&self) -> Option<Fault> {
        if !self.supervisor.state().drives() {
            return None;
        }
        match self.report.motion.as_ref()?.outcome {
            Outcome::Stalled => Some(Fault::Stalled),
            Outcome::OutOfTolerance => Some(Fault::GoalUnreachable),
            _ => None,
        }
    }

    /// What the wheels are to do. A step that the motion law refuses is a fault, whose reaction takes
    /// its place in this very tick.
    fn act(
        &mut self,
        dt: T,
        located: &Located,
        other_goal: bool,
        sensed: &Sensed<T>,
    ) -> WheelAction<T> {
        let speeds = self.back_emf_speeds(dt);
        let turning = match (self.driving.creeps(), self.base.motor()) {
            (Some(creeps), Some(motor)) => Some(self.turning(motor, creeps, dt, sensed)),
            _ => None,
        };
        let course = self.report.course();
        let tick = Tick {
            motion: &self.base.motion,
            mode: self.supervisor.output(),
            measured: course.as_ref(),
            jumped: located.jumped,
            other_goal,
            speeds,
            turning,
            dt,
        };
        let driven = match self.driving.act(&tick, &mut self.report.motion) {
            Ok(driven) => driven,
            Err(fault) => return self.act_after(fault),
        };
        match driven.at_goal {
            Some(true) => {
                self.supervisor.on(Event::Reached);
            }
            // Pushed off its goal, it drives back, and is watched like any base that drives.
            Some(false) if self.supervisor.state() == State::Parked => {
                self.supervisor.on(Event::Park);
            }
            _ => {}
        }
        driven.action
    }

    /// An action for drivers that close their own speed loop: the law's command as wheel speeds. What such drivers exert is not known,
    /// and the law is told so; odometry and detectors go by what accelerates the base as it is commanded.
    #[cold]
    #[inline(never)]
    fn by_speeds(&mut self, action: WheelAction<T>, dt: T, sensed: &Sensed<T>) -> WheelAction<T> {
        self.report.speed_limited = SpeedLimited::default();
        let (Some(output), WheelAction::Drive(mut drive), Some(report)) =
            (self.base.driver.speeds(), action, &self.report.motion)
        else {
            self.speeds = SpeedDrive::default();
            return match action {
                // No law is at work. A speed of 0 would stop a base that rolls with all that its drivers have.
                WheelAction::Drive(_) => WheelAction::Release,
                WheelAction::Release | WheelAction::Brake => action,
            };
        };
        self.driving.note_not_driven();
        let motion = &self.base.motion;
        let tick = SpeedTick {
            output,
            wheels: motion.wheels(),
            command: (&report.command, &report.command_rate),
            creeps: self.driving.creeps().is_some(),
            counts: sensed.counts.ok(),
            per_count: self.per_count(),
            most: larger(
                self.base.detectors.params().wheels.stuck.speed_rad_s,
                output.params().min_speed_rad_s,
            ),
            dt,
        };
        match self.speeds.command(&tick) {
            Ok(command) => {
                let wrench = wrench_for(&motion.params().robot, &report.command_rate);
                drive.torques = motion.wheels().torques(&wrench);
                drive.desired = command.speeds;
                self.report.speed_limited = command.limited;
                WheelAction::Drive(drive)
            }
            Err(fault) => self.act_after(fault),
        }
    }

    /// Speeds of the wheels for which their back-EMF is to be made up, by motors that are not quite alike. How much they are not is learnt while
    /// torque flows.
    fn back_emf_speeds(&mut self, dt: T) -> WheelSpeeds<T> {
        let Some(odometry) = self.locator.odometry() else {
            return WheelSpeeds::default();
        };
        if let (Some(_), Some(_), Some(measured)) = (
            self.base.motor(),
            &self.report.motion,
            &self.report.measured,
        ) {
            self.motors
                .advance(measured.twist.linear, odometry.made_up_right(), dt);
            self.report.motor_bias = self.motors.share;
        }
        odometry.back_emf_speeds_of(self.motors.share)
    }

    /// The reaction to a step that the motion law refused. Nothing that a policy allows for it steps the law again.
    #[cold]
    #[inline(never)]
    fn act_after(&mut self, fault: StepFault) -> WheelAction<T> {
        let mut found = ActiveFaults::NONE;
        found.add(fault.into());
        self.report.active_faults.add(fault.into());
        self.supervisor.on_active_faults(&found, &self.base.policy);
        self.cut()
    }

    /// What the friction of wheels with motors is found by.
    #[inline(never)]
    fn turning<'a>(
        &self,
        motor: &'a Motor<T>,
        creeps: Creeps,
        dt: T,
        sensed: &Sensed<T>,
    ) -> Turning<'a, T> {
        Turning {
            creeps,
            motor,
            per_count: self.per_count(),
            counts: sensed.counts.ok(),
            commanded: self.base.motion.wheels().wheel_speeds(&self.commanded()),
            torques: self.exerted,
            dt,
        }
    }

    /// Turn of a wheel for a count of its encoder \[rad\].
    fn per_count(&self) -> T {
        (T::PI + T::PI) / self.base.localisation.params().odometry.counts_per_turn
    }

    /// What the host or the firmware says: `Event::Arm`, `Stop`, `Reset`, `LinkLost`, `EmergencyStop`, a `Fault` of its own, or
    /// `TrajectoryEnded` while the base follows references, which parks it at the last one. What it asks of the wheels happens in
    /// the next tick.
    ///
    /// Anything else is refused and changes nothing: goals, references and velocities are orders of [`tick`](Self::tick), and that the base
    /// arrived or came to rest it finds itself. No event takes the place of an order that is due.
    pub fn on(&mut self, event: Event) -> Action {
        match event {
            Event::Arm | Event::Stop | Event::Reset | Event::LinkLost => {}
            Event::EmergencyStop { .. } | Event::Fault(_) => {}
            Event::TrajectoryEnded if self.driving.park_at_last_reference() => {}
            _ => return Action::Refuse,
        }
        let action = self.supervisor.on(event);
        // A base that drives owes its orders to what is said in ticks.
        if !self.supervisor.state().drives() {
            self.host.order_seen();
        }
        action
    }

    /// The button. What it returns is to reach the wheels at once; the ticks that follow say the same until a reset.
    pub fn emergency_stop(&mut self) -> WheelAction<T> {
        self.supervisor.emergency_stop();
        self.cut()
    }

    /// As [`emergency_stop`](Self::emergency_stop), but whether to brake or to release is said here.
    pub fn emergency_stop_by(&mut self, brake: bool) -> WheelAction<T> {
        self.supervisor.on(Event::EmergencyStop { brake });
        self.cut()
    }

    fn cut(&mut self) -> WheelAction<T> {
        let action = match self.supervisor.output() {
            OutputMode::Brake => WheelAction::Brake,
            _ => WheelAction::Release,
        };
        self.idle();
        self.exerted = WheelTorques::default();
        self.report.action = action;
        action
    }

    /// A sound frame came from the host.
    pub const fn frame_seen(&mut self) {
        self.host.frame_seen();
    }

    /// The time of a tick for a link with the host, before its [`tick`](Self::tick): [`Event::LinkLost`] when no frame has come
    /// for `DetectorParams::command`, looked at a tick ahead.
    ///
    /// Where a link says whether the host is there, a base needs orders only while it follows references or drives by velocity. Without a link this is
    /// not called: then orders are the host's only sign, and [`Fault::CommandStale`] says in every state that they ceased.
    pub fn watch_link(&mut self, dt_us: u32) {
        let detectors = self.base.detectors.params();
        if self
            .host
            .is_lost(dt_us, detectors.period_us, detectors.command)
        {
            self.on(Event::LinkLost);
        }
        if self.supervisor.state() != State::Tracking {
            self.host.order_seen();
        }
    }

    /// Puts the base elsewhere on the map. Command and torque go on without a step, and no [`Fault::PoseJump`] comes of it.
    ///
    /// # Errors
    /// Of [`Pose::check`]; nothing has changed then.
    pub fn set_pose(&mut self, pose: Pose<T>) -> Result<(), StepFault> {
        pose.check(Input::Pose)?;
        self.locator.set_pose(&self.base.localisation, pose);
        Ok(())
    }

    /// Takes other parameters: where the base is and what latched stays, what the localiser, the monitor and the wheels have learnt begins
    /// anew.
    ///
    /// # Errors
    /// [`StepFault::WrongPhase`] while the base is live: only Idle, Stopped and Fault are left alone by new gains.
    // What it needs of the stack is not needed while parameters are checked as well.
    #[inline(never)]
    pub fn reconfigure(&mut self, base: &ValidBaseParams<T>) -> Result<(), StepFault> {
        if self.supervisor.state().is_live() {
            return Err(StepFault::WrongPhase);
        }
        self.base = *base;
        self.locator.begin_anew(self.report.measured.as_ref());
        self.motors = MotorBias::default();
        self.speeds = SpeedDrive::default();
        self.detectors = Detectors::default();
        self.over_speed = OverSpeed::default();
        self.supervisor.reconfigure(&base.supervisor);
        self.idle();
        Ok(())
    }

    /// Nothing is driven any more.
    fn idle(&mut self) {
        self.driving = Driving::IDLE;
        self.report.motion = None;
    }

    /// Ticks that came late, by the watch over them, since the start or the last new parameters.
    pub fn late_ticks(&self) -> u32 {
        self.detectors.late_ticks()
    }

    /// What the wheels really exert until the next tick, where the driver could not do what it was
    /// commanded: for the estimates of speed and disturbance.
    ///
    /// # Errors
    /// A torque that is not finite, or above ten times [`Limits::wheel_torque_nm`](crate::motion::Limits); nothing is noted then.
    pub fn note_exerted(&mut self, torques: &WheelTorques<T>) -> Result<(), StepFault> {
        if let Some(report) = &mut self.report.motion {
            self.driving
                .note_exerted(&self.base.motion, torques, report)?;
            if self.base.driver.speeds().is_some() {
                self.driving.note_not_driven();
            }
            self.exerted = *torques;
        }
        Ok(())
    }
}
