//! From the supervisor's output to what the wheels are to do: the motion law, the stop plan, or neither.

use super::io::{DriveCommand, WheelAction};
use super::wheel_friction::{Creeps, FrictionWatch, Turning};
use crate::error::StepFault;
use crate::maths::Maths;
use crate::motion::{Asked, MotionLaw, MotionReport, Outcome, PathEnd, Task, ValidMotionParams};
use crate::range::smaller;
use crate::safety::{OutputMode, StopPlan};
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Accel, Measured, Twist, WheelSpeeds, WheelTorques};

/// What is driven, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Driving<T, M, U> {
    /// What the orders amount to.
    pub(super) task: Option<Task<T>>,
    /// Of the path that the task follows.
    pub(super) end: PathEnd<T>,
    /// At work while there is a report of it.
    law: MotionLaw<T, M, U>,
    /// Of a controlled stop, and the time since its begin \[s\].
    stop: Option<(StopPlan<T>, T)>,
    /// While creeping.
    friction: FrictionWatch<T>,
}

/// A tick of a base, as far as driving goes.
pub(super) struct Tick<'a, T> {
    pub(super) motion: &'a ValidMotionParams<T>,
    /// What the supervisor lets through.
    pub(super) mode: OutputMode,
    /// `None` before the first reading.
    pub(super) measured: Option<&'a Measured<T>>,
    pub(super) jumped: bool,
    /// Of [`Taken`](super::orders::Taken).
    pub(super) other_goal: bool,
    /// Of the wheels, as measured.
    pub(super) speeds: WheelSpeeds<T>,
    /// Of a base with motors that creeps.
    pub(super) turning: Option<Turning<'a, T>>,
    pub(super) dt: T,
}

/// What came of a tick.
pub(super) struct Driven<T> {
    pub(super) action: WheelAction<T>,
    /// Whether the base stands at its goal, if it was on its way to one.
    pub(super) at_goal: Option<bool>,
}

impl<T> Driven<T> {
    const fn only(action: WheelAction<T>) -> Self {
        Self {
            action,
            at_goal: None,
        }
    }
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> Driving<T, M, U> {
    /// Nothing to do, and no torque.
    pub(super) const IDLE: Self = Self {
        task: None,
        end: PathEnd::NEW,
        law: MotionLaw::IDLE,
        stop: None,
        friction: FrictionWatch::NEW,
    };

    /// What the wheels are to do. `report` is the motion law's of the last tick and becomes that of this one; `None` while
    /// its torque does not flow.
    ///
    /// # Errors
    /// A step that the motion law refuses.
    pub(super) fn act(
        &mut self,
        tick: &Tick<'_, T>,
        report: &mut Option<MotionReport<T>>,
    ) -> Result<Driven<T>, StepFault> {
        let beyond = self.beyond_coulomb(tick);
        if tick.mode != OutputMode::ControlledStop {
            self.stop = None;
        }
        let Tick { motion, speeds, .. } = *tick;
        match tick.mode {
            OutputMode::Drive | OutputMode::Hold => match (&self.task, tick.measured) {
                (Some(task), Some(measured)) => {
                    let (jumped, dt) = (tick.jumped, tick.dt);
                    let asked = Asked {
                        task,
                        other_goal: tick.other_goal,
                    };
                    let report = step(&mut self.law, motion, asked, measured, jumped, dt, report)?;
                    let at_goal = report.outcome == Outcome::Parked;
                    Ok(Driven {
                        action: drive(motion, report, (speeds, tick.dt), beyond),
                        at_goal: matches!(task, Task::Park(_)).then_some(at_goal),
                    })
                }
                // Armed before the first reading: nothing to go by yet, so nothing is exerted.
                _ => Ok(without_torque(report)),
            },
            OutputMode::ControlledStop => match tick.measured {
                Some(measured) => {
                    let report = self.brake_along_plan(tick, measured, report)?;
                    Ok(Driven::only(drive(
                        motion,
                        report,
                        (speeds, tick.dt),
                        beyond,
                    )))
                }
                None => Ok(without_torque(report)),
            },
            OutputMode::ZeroTorque => Ok(without_torque(report)),
            OutputMode::Brake => {
                self.let_go(report);
                Ok(Driven::only(WheelAction::Brake))
            }
            OutputMode::Release => {
                self.let_go(report);
                Ok(Driven::only(WheelAction::Release))
            }
        }
    }

    /// What the wheels' friction is found to be beyond its Coulomb part, while the base creeps and has motors.
    fn beyond_coulomb(&mut self, tick: &Tick<'_, T>) -> Option<WheelTorques<T>> {
        let Some(turning) = &tick.turning else {
            self.friction.forget();
            return None;
        };
        let unknown_nm = tick.motion.unknown_torque_nm();
        Some(self.friction.advance(turning, &tick.speeds, unknown_nm))
    }

    /// The controlled stop: the motion law along a plan that begins at its last command.
    fn brake_along_plan<'r>(
        &mut self,
        tick: &Tick<'_, T>,
        measured: &Measured<T>,
        report: &'r mut Option<MotionReport<T>>,
    ) -> Result<&'r MotionReport<T>, StepFault> {
        let &Tick { motion, dt, .. } = tick;
        // Of a tick that is too long for a step as much as one takes: who stops is not let go for being late.
        let dt = smaller(dt, motion.params().max_tick_s);
        let (plan, t) = match self.stop {
            Some((plan, t)) => (plan, t + dt),
            None => {
                let (command, rate) = match report {
                    Some(report) => (report.command, report.command_rate),
                    None => (measured.twist, Accel::default()),
                };
                (StopPlan::new::<M>(motion, &command, &rate), T::ZERO)
            }
        };
        let first = self.stop.is_none();
        self.stop = Some((plan, t));
        let task = plan.task::<M>(t, dt, &measured.pose);
        let jumped = tick.jumped || first;
        let asked = Asked {
            task: &task,
            other_goal: false,
        };
        step(&mut self.law, motion, asked, measured, jumped, dt, report)
    }

    /// Whether and how the base creeps.
    pub(super) fn creeps(&self) -> Option<Creeps> {
        match self.task {
            Some(Task::Drive { .. }) => Some(Creeps::ByVelocity),
            Some(Task::Park(_)) if self.law.is_beside_goal() => Some(Creeps::BesideGoal),
            _ => None,
        }
    }

    /// The references ended, as [`Action::ParkAtLastReference`](crate::safety::supervisor::Action::ParkAtLastReference) says; whether there were
    /// any.
    pub(super) fn park_at_last_reference(&mut self) -> bool {
        let Some(Task::Follow(last)) = &self.task else {
            return false;
        };
        self.task = Some(Task::Park(*last.pose()));
        true
    }

    /// A wheel slides; see [`MotionController::declare_slide`](crate::motion::MotionController::declare_slide).
    pub(super) fn declare_slide(&mut self) {
        self.law.declare_slide();
    }

    fn let_go(&mut self, report: &mut Option<MotionReport<T>>) {
        *report = None;
        self.task = None;
    }

    /// What the wheels exert until the next tick is not known.
    pub(super) fn note_not_driven(&mut self) {
        self.law.note_not_driven();
    }

    /// What the wheels really exert until the next tick, for the law whose last report this is.
    ///
    /// # Errors
    /// A torque that is not finite.
    pub(super) fn note_exerted(
        &mut self,
        motion: &ValidMotionParams<T>,
        torques: &WheelTorques<T>,
        report: &mut MotionReport<T>,
    ) -> Result<(), StepFault> {
        self.law.note_applied(motion, torques, report)
    }
}

/// The motion law's step, or its start where there is no report yet.
fn step<'r, T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    law: &mut MotionLaw<T, M, U>,
    motion: &ValidMotionParams<T>,
    asked: Asked<'_, T>,
    measured: &Measured<T>,
    jumped: bool,
    dt: T,
    report: &'r mut Option<MotionReport<T>>,
) -> Result<&'r MotionReport<T>, StepFault> {
    let starts = report.is_none();
    let current = report.get_or_insert_default();
    let taken = if starts {
        law.begin(motion, asked.task, measured, current)
    } else {
        if jumped {
            law.declare_jump();
        }
        law.step(motion, dt, asked, measured, current)
    };
    match taken {
        Ok(()) => Ok(report.get_or_insert_default()),
        Err(fault) => {
            if starts {
                *report = None;
            }
            Err(fault)
        }
    }
}

/// Enabled, with no law at work.
fn without_torque<T: Scalar>(report: &mut Option<MotionReport<T>>) -> Driven<T> {
    *report = None;
    Driven::only(WheelAction::Drive(DriveCommand::default()))
}

/// Torques of a step, and what a motor driver needs with them: the measured `speeds` go on as commanded over half a tick of `dt`.
fn drive<T: Scalar>(
    motion: &ValidMotionParams<T>,
    report: &MotionReport<T>,
    (speeds, dt): (WheelSpeeds<T>, T),
    beyond_coulomb: Option<WheelTorques<T>>,
) -> WheelAction<T> {
    let half = T::HALF * dt;
    let gained = Twist {
        linear: half * report.command_rate.linear,
        angular: half * report.command_rate.angular,
    };
    let gained = motion.wheels().wheel_speeds(&gained);
    WheelAction::Drive(DriveCommand {
        torques: report.torques,
        desired: motion.wheels().wheel_speeds(&report.command),
        speeds: WheelSpeeds {
            right: speeds.right + gained.right,
            left: speeds.left + gained.left,
        },
        beyond_coulomb,
    })
}

#[cfg(test)]
mod tests {
    use super::{Driven, Driving, Tick};
    use crate::base::wheel_friction::tests::motor;
    use crate::base::wheel_friction::{Creeps, FrictionWatch, Turning};
    use crate::base::{DriveCommand, WheelAction};
    use crate::error::{Input, StepFault};
    use crate::hal::WheelCounts;
    use crate::maths::Libm;
    use crate::motion::{Limits, MotionParams, MotionReport, Task, ValidMotionParams};
    use crate::reference::Reference;
    use crate::robot::Robot;
    use crate::safety::OutputMode;
    use crate::shunting::RationalMean;
    use crate::types::{Accel, Measured, Pose, Twist, WheelSpeeds, WheelTorques};

    const DT: f64 = 0.01;
    const SPEEDS: WheelSpeeds<f64> = WheelSpeeds {
        right: 3.0,
        left: 5.0,
    };
    /// Driving an arc.
    const ARC: Twist<f64> = Twist {
        linear: 0.5,
        angular: 0.4,
    };

    /// The paper's robot, on the spot.
    struct Bench {
        motion: ValidMotionParams<f64>,
        driving: Driving<f64, Libm, RationalMean>,
        report: Option<MotionReport<f64>>,
        measured: Option<Measured<f64>>,
    }

    impl Bench {
        fn with(task: Option<Task<f64>>) -> Self {
            let motion = MotionParams::new(Robot::paper(), Limits::PAPER).validate();
            Self {
                motion: motion.expect("valid"),
                driving: Driving {
                    task,
                    ..Driving::IDLE
                },
                report: None,
                measured: Some(Measured::default()),
            }
        }

        /// Following an arc that it is beside of, moving as it is to.
        fn following() -> Self {
            let pose = Pose::new(0.02, 0.05, 0.1);
            let arc = Reference::new_with::<Libm>(pose, ARC, Accel::default());
            let mut bench = Self::with(Some(Task::Follow(arc)));
            bench.measured = Some(Measured {
                pose: Pose::default(),
                twist: ARC,
            });
            bench
        }

        fn act(&mut self, mode: OutputMode) -> Driven<f64> {
            self.turning(mode, None).expect("a sound tick")
        }

        fn turning(
            &mut self,
            mode: OutputMode,
            turning: Option<Turning<'_, f64>>,
        ) -> Result<Driven<f64>, StepFault> {
            let tick = Tick {
                motion: &self.motion,
                mode,
                measured: self.measured.as_ref(),
                jumped: false,
                other_goal: false,
                speeds: SPEEDS,
                turning,
                dt: DT,
            };
            self.driving.act(&tick, &mut self.report)
        }

        fn drive(driven: &Driven<f64>) -> DriveCommand<f64> {
            match driven.action {
                WheelAction::Drive(drive) => drive,
                other => panic!("{other:?}"),
            }
        }
    }

    /// Torques of the law, wheel speeds of its command, and measured ones that went on with its acceleration for half a tick: wheels of 0.1 m,
    /// half a metre apart.
    #[test]
    fn wheels_get_what_the_law_says() {
        let mut bench = Bench::following();
        for mode in [OutputMode::Drive, OutputMode::Hold, OutputMode::Drive] {
            let driven = bench.act(mode);
            let (drive, report) = (Bench::drive(&driven), bench.report.expect("at work"));
            assert_eq!(drive.torques, report.torques);
            assert_eq!((drive.beyond_coulomb, driven.at_goal), (None, None));
            let wheels = |Twist { linear, angular }| {
                [1.0, -1.0].map(|side| (linear + side * 0.25 * angular) / 0.1)
            };
            let rate = report.command_rate;
            let gained = wheels(Twist::new(rate.linear, rate.angular)).map(|rate| 0.5 * DT * rate);
            let [right, left] = wheels(report.command);
            let found = [
                drive.desired.right,
                drive.desired.left,
                drive.speeds.right,
                drive.speeds.left,
            ];
            let expected = [right, left, 3.0 + gained[0], 5.0 + gained[1]];
            for (found, expected) in found.iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{mode:?}: {found} {expected}"
                );
            }
        }
        let rate = bench.report.expect("at work").command_rate;
        assert!(rate.linear != 0.0 && rate.angular != 0.0, "{rate:?}");
    }

    /// Whether it stands there is said of a goal, and of nothing else.
    #[test]
    fn a_base_at_its_goal_says_so() {
        let mut bench = Bench::with(Some(Task::Park(Pose::default())));
        assert_eq!(bench.act(OutputMode::Drive).at_goal, Some(false));
        let stands = (0..200).find(|_| bench.act(OutputMode::Drive).at_goal == Some(true));
        assert!(stands.is_some(), "{:?}", bench.report);
        assert_eq!(bench.act(OutputMode::Hold).at_goal, Some(true));
    }

    /// Outputs are enabled, and no law is at work: without a task, and before the first reading.
    #[test]
    fn without_a_task_or_a_reading_nothing_is_exerted() {
        let early = || {
            let mut bench = Bench::following();
            bench.measured = None;
            bench
        };
        let mut driven = Bench::following();
        driven.act(OutputMode::Drive);
        for (mut bench, mode) in [
            (Bench::with(None), OutputMode::Drive),
            (early(), OutputMode::Drive),
            (early(), OutputMode::ControlledStop),
            (driven, OutputMode::ZeroTorque),
        ] {
            let task = bench.driving.task;
            let driven = bench.act(mode);
            assert_eq!(Bench::drive(&driven), DriveCommand::default());
            assert_eq!((driven.at_goal, bench.report), (None, None));
            assert_eq!(bench.driving.task, task);
        }
    }

    /// A stop has a clock of its own, from its first tick on; who drives on in between begins the next one anew.
    #[test]
    fn each_stop_begins_anew() {
        let mut bench = Bench::following();
        bench.act(OutputMode::Drive);
        for round in 0..2 {
            for tick in 0..5 {
                let driven = bench.act(OutputMode::ControlledStop);
                assert_eq!(driven.at_goal, None);
                let report = bench.report.expect("at work");
                assert_eq!(Bench::drive(&driven).torques, report.torques);
                let (_, t) = bench.driving.stop.expect("a stop");
                assert!(
                    (t - DT * f64::from(tick)).abs() < 1e-15,
                    "{round} {tick}: {t}"
                );
            }
            bench.act(OutputMode::Drive);
            assert!(bench.driving.stop.is_none());
        }
    }

    /// The task is over as well.
    #[test]
    fn wheels_are_let_go() {
        for (mode, action) in [
            (OutputMode::Brake, WheelAction::Brake),
            (OutputMode::Release, WheelAction::Release),
        ] {
            let mut bench = Bench::following();
            bench.act(OutputMode::Drive);
            let driven = bench.act(mode);
            assert_eq!((driven.action, driven.at_goal), (action, None));
            assert_eq!((bench.report, bench.driving.task), (None, None));
        }
    }

    /// Wheels that are commanded to creep and stand; for a base that drives otherwise nothing is compensated, and nothing is remembered.
    #[test]
    fn friction_is_found_while_driving_by_velocity() {
        let motor = motor();
        let turning = || Turning {
            creeps: Creeps::ByVelocity,
            motor: &motor,
            per_count: 0.003,
            counts: Some(WheelCounts::default()),
            commanded: WheelSpeeds {
                right: 0.1,
                left: 0.2,
            },
            torques: WheelTorques::default(),
            dt: DT,
        };
        let mut bench = Bench::following();
        for _ in 0..2 {
            let mut alone = FrictionWatch::NEW;
            let mut last = None;
            for _ in 0..20 {
                let driven = bench.turning(OutputMode::Drive, Some(turning()));
                last = Bench::drive(&driven.expect("a sound tick")).beyond_coulomb;
                assert_eq!(last, Some(alone.advance(&turning(), &SPEEDS, 0.0)));
            }
            let last = last.expect("beyond");
            assert!(last.right > 0.0 && last.left > last.right, "{last:?}");
            let otherwise = bench.act(OutputMode::Drive);
            assert_eq!(Bench::drive(&otherwise).beyond_coulomb, None);
        }
    }

    /// Neither what was measured nor what was exerted; a law that did not start is not at work.
    #[test]
    fn what_is_no_number_is_refused() {
        let mut bench = Bench::following();
        let sound = bench.measured;
        let lost = Pose {
            y: f64::NAN,
            ..Pose::default()
        };
        for started in [false, true] {
            bench.measured = Some(Measured {
                pose: lost,
                twist: ARC,
            });
            assert!(bench.turning(OutputMode::Drive, None).is_err());
            assert_eq!(bench.report.is_some(), started);
            bench.measured = sound;
            bench.act(OutputMode::Drive);
        }
        let torques = WheelTorques {
            right: f64::NAN,
            left: 0.0,
        };
        let Bench {
            driving,
            motion,
            report: Some(report),
            ..
        } = &mut bench
        else {
            panic!("the law is at work");
        };
        let noted = driving.note_exerted(motion, &torques, report);
        assert_eq!(noted, Err(StepFault::NotFinite(Input::Applied)));
        let noted = driving.note_exerted(motion, &WheelTorques::default(), report);
        assert_eq!(noted, Ok(()));
    }
}
