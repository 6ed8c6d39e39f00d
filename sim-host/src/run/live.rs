//! A robot that takes its orders while it runs: the tick of a mission, one at a time.

use super::paper_rival::PaperRival;
use super::world::tick;
use super::{Driver, body};
use crate::closed_loop::{ClosedLoop, ClosedLoopError};
use crate::mission::{
    AccelerationAt, BaseSpec, Course, End, HandOverRule, Mission, Route, Sequencer, VelocityOrder,
    When,
};
use crate::motion::ReferenceMotion;
use crate::precision::Precision;
use crate::scenario::ControlLaw;
use crate::world::{World, WorldSetup};
use controller_core::base::{BaseReport, Order};
use controller_core::maths::{Libm, Maths};
use controller_core::queue::ReferenceQueue;
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::types::{Measured, Pose, Twist};
use protocol::{Command, RejectReason, WirePose};

/// Who drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LiveLaw {
    /// The default law for a base.
    #[default]
    Default,
    /// The paper's, with neurons.
    Neural,
    /// The paper's backstepping without neurons.
    Plain,
}

/// Tolerance of a paper's law's goal check where poses have no noise \[m, rad\]: that of `bench`.
const ASKED: (f64, f64) = (0.005, 0.010);
/// The line to a goal for the paper's laws, as that of their Fig. 3: speed \[m/s\], its share of what the base can at most,
/// duration, and when parking takes over \[s\].
const LINE: (f64, f64, f64, f64) = (0.4, 0.5, 10.0, 9.0);
/// The paper's laws leave a route this long before its end \[s\], as in Fig. 3.
const LEFT_BEFORE_END_S: f64 = 1.0;

/// A base in a world, with orders from outside.
pub struct Live<'q> {
    closed_loop: ClosedLoop<'q>,
    /// Its course is the present order.
    mission: Mission,
    sequencer: Sequencer<'static>,
    law: LiveLaw,
    driver: Option<Driver>,
    /// The present order is of this time \[s\].
    begun_s: f64,
    host: bool,
}

impl<'q> Live<'q> {
    /// At rest, ordered to stay. Nothing goes through the queue.
    ///
    /// # Errors
    /// Parameters out of their range.
    pub fn new(
        queue: &'q mut ReferenceQueue<f32, 2>,
        base: &BaseSpec,
        setup: &WorldSetup,
        start: Pose<f64>,
        law: LiveLaw,
    ) -> Result<Self, ClosedLoopError> {
        let mission = Mission {
            name: "live".to_owned(),
            description: String::new(),
            base: base.clone(),
            robot: base.robot,
            precision: Precision::F32,
            start: Measured {
                pose: start,
                twist: Twist::default(),
            },
            course: Course::Park(start),
            events: Vec::new(),
            period_s: base.period_s(),
            end: End::At(f64::INFINITY),
            setup: Some(setup.clone()),
        };
        Ok(Self {
            closed_loop: ClosedLoop::new(queue.split().1, &mission, setup, None)?,
            sequencer: Sequencer::without_events(&mission, AccelerationAt::MiddleOfHold),
            mission,
            law,
            driver: None,
            begun_s: 0.0,
            host: true,
        })
    }

    /// Another order, from the next tick on.
    ///
    /// The paper's laws go to a goal along a straight line that ends in it, since they know moving references only.
    pub fn order(&mut self, course: Course) {
        let course = match (self.law, course) {
            (LiveLaw::Default, course) => course,
            (_, Course::Park(goal)) => line_to(goal, &self.mission.base),
            (_, Course::Follow { route, hand_over }) => Course::Follow {
                route,
                hand_over: hand_over.map(|rule| HandOverRule {
                    when: When::Time((rule.end_s - LEFT_BEFORE_END_S).max(0.0)),
                    ..rule
                }),
            },
            (_, Course::Drive) => Course::Drive,
        };
        self.mission.course = course;
        self.restart_course();
    }

    /// Drives with a speed and a turn rate until the next order.
    pub fn drive(&mut self, order: VelocityOrder) {
        let same = matches!(self.mission.course, Course::Drive);
        self.mission.course = Course::Drive;
        if !same {
            self.restart_course();
        }
        self.sequencer.drive(order);
    }

    fn restart_course(&mut self) {
        // The time of the next tick, as far as ticks come evenly.
        self.begun_s = 1.0e-6 * self.world().now_us() as f64;
        self.sequencer = Sequencer::without_events(&self.mission, AccelerationAt::MiddleOfHold);
        let kind = match self.law {
            LiveLaw::Default => None,
            LiveLaw::Neural => Some(ControlLaw::Neural),
            LiveLaw::Plain => Some(ControlLaw::Plain),
        };
        let rival = kind.and_then(PaperRival::new);
        self.driver = rival
            .map(|rival| Driver::new(Box::new(rival), body(&self.mission, ASKED), &self.mission));
    }

    /// Whether there is a host that gives orders.
    pub const fn set_host(&mut self, alive: bool) {
        self.host = alive;
    }

    /// A command from a host; inside what the base says of it.
    ///
    /// # Errors
    /// None: there is no other base to ask.
    pub fn command(
        &mut self,
        command: &Command,
    ) -> Result<Result<(), RejectReason>, ClosedLoopError> {
        self.closed_loop.command(command)
    }

    /// Picks the robot up, puts it down elsewhere, and says so to the base if it is `announced`.
    ///
    /// # Errors
    /// As [`command`](Self::command).
    pub fn place(
        &mut self,
        pose: Pose<f64>,
        announced: bool,
    ) -> Result<Result<(), RejectReason>, ClosedLoopError> {
        self.closed_loop.world_mut().place(pose);
        if !announced {
            return Ok(Ok(()));
        }
        let pose: Pose<f32> = pose.cast();
        self.command(&Command::SetPose {
            pose: WirePose::from(&pose),
        })
    }

    /// Lets the world go on to the next tick, and gives its order.
    ///
    /// # Errors
    /// A command that the world refuses, which no base gives.
    pub fn tick(&mut self) -> Result<(), ClosedLoopError> {
        self.closed_loop.advance()?;
        if !self.host {
            self.closed_loop.tick(&Order::None)?;
            return Ok(());
        }
        let t = self.time_s();
        let laws = (&mut self.sequencer, self.driver.as_mut());
        let times = (t, t - self.begun_s);
        tick(&self.mission, &mut self.closed_loop, laws, times)?;
        Ok(())
    }

    fn time_s(&self) -> f64 {
        1.0e-6 * self.closed_loop.world().now_us() as f64 - self.mission.period_s
    }

    /// The reference of the present order at each tick; empty if it has none.
    pub fn references(&self) -> Vec<Reference<f64>> {
        self.mission.samples()
    }

    /// The law had no answer to the present order.
    pub fn has_refused(&self) -> bool {
        self.driver.as_ref().is_some_and(Driver::has_refused)
    }

    /// The world, for what truly happens.
    pub const fn world(&self) -> &World {
        self.closed_loop.world()
    }

    /// The world, to put faults into.
    pub const fn world_mut(&mut self) -> &mut World {
        self.closed_loop.world_mut()
    }

    /// What the base said in the last tick.
    pub const fn report(&self) -> &BaseReport<f32> {
        self.closed_loop.report()
    }

    /// The base.
    pub const fn base(&self) -> &BaseSpec {
        &self.mission.base
    }
}

/// The line that ends in a goal, with its heading.
fn line_to(goal: Pose<f64>, base: &BaseSpec) -> Course {
    let (speed, share, end_s, left_s) = LINE;
    let speed = speed.min(share * base.limits.speed);
    let (sin, cos) = Libm::sin_cos(goal.theta);
    let length = speed * end_s;
    let start = Pose::new(goal.x - length * cos, goal.y - length * sin, goal.theta);
    Course::Follow {
        route: Route::Motion(ReferenceMotion::Constant(ConstantTwist {
            start,
            twist: Twist::new(speed, 0.0),
        })),
        hand_over: Some(HandOverRule {
            goal,
            end_s,
            when: When::Time(left_s),
        }),
    }
}
