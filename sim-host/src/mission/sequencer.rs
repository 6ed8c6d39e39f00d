//! The task of each tick: from route, events and hand-over rule.

use super::reference_sampler::{AccelerationAt, ReferenceSampler};
use super::{Change, Course, Event, HandOverRule, Mission, VelocityOrder, When};
use controller_core::maths::Libm;
use controller_core::motion::{Remaining, Task};
use controller_core::pose_error::pose_error;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Measured, Pose, Twist};

/// Gives the orders of each tick.
pub(crate) struct Sequencer<'a> {
    sampler: ReferenceSampler,
    rule: Option<HandOverRule>,
    events: &'a [Event],
    /// Half the distance of the wheels \[m\]: what a turn makes a wheel travel.
    lever: f64,
    now: Now,
    /// How far the localisation is still off: what is to be added to it.
    correction: Pose<f64>,
}

/// What the robot is doing.
#[derive(Clone, Copy)]
enum Now {
    Follows,
    /// At rest there.
    Parks(Reference<f64>),
    Drives(VelocityOrder),
}

impl Now {
    fn parks(goal: Pose<f64>) -> Self {
        Self::Parks(Reference::at_rest_with::<Libm>(goal))
    }
}

/// A tick's orders.
pub(crate) struct Orders {
    pub(crate) task: Task<f64>,
    /// Where the robot is to be.
    pub(crate) target: Reference<f64>,
    /// The reference and the way to go, in the tick that leaves it.
    pub(crate) left: Option<(Reference<f64>, f64)>,
    /// The localisation jumped.
    pub(crate) jumped: bool,
    /// The pose as the localisation has it.
    pub(crate) measured: Measured<f64>,
}

impl Sequencer<'static> {
    /// Of a mission's course alone.
    pub(crate) fn without_events(mission: &Mission, acceleration: AccelerationAt) -> Self {
        let Sequencer {
            sampler,
            rule,
            lever,
            now,
            ..
        } = Sequencer::new(mission, acceleration);
        Self {
            sampler,
            rule,
            events: &[],
            lever,
            now,
            correction: Pose::default(),
        }
    }

    /// Drives by this order from now on.
    pub(crate) const fn drive(&mut self, order: VelocityOrder) {
        self.now = Now::Drives(order);
    }
}

impl<'a> Sequencer<'a> {
    pub(crate) fn new(mission: &'a Mission, acceleration: AccelerationAt) -> Self {
        let (rule, now) = match &mission.course {
            Course::Park(goal) => (None, Now::parks(*goal)),
            Course::Drive => (None, Now::Drives(VelocityOrder::default())),
            Course::Follow { hand_over, .. } => (*hand_over, Now::Follows),
        };
        let mut correction = Pose::default();
        for event in &mission.events {
            if let Change::Jump(jump) = event.change {
                correction.x += jump.x;
                correction.y += jump.y;
                correction.theta += jump.theta;
            }
        }
        Self {
            sampler: ReferenceSampler::of(mission, acceleration),
            rule,
            events: &mission.events,
            lever: 0.5 * mission.base.robot.wheels.track_m,
            now,
            correction,
        }
    }

    /// Orders for a tick. `command` is what was commanded last, `distance` gives the distance at
    /// which parking takes over from a speed.
    pub(crate) fn at(
        &mut self,
        tick: usize,
        t: f64,
        truth: &Measured<f64>,
        command: &Twist<f64>,
        distance: impl Fn(f64) -> f64,
    ) -> Orders {
        let mut jumped = false;
        // 1 ns of slack: k·dt, in floating point, is not one tick late.
        while let Some((event, rest)) = self
            .events
            .split_first()
            .filter(|(e, _)| t >= e.at_s - 1e-9)
        {
            self.events = rest;
            match event.change {
                Change::Goal(goal) => self.now = Now::parks(goal),
                Change::Follow => self.now = Now::Follows,
                Change::Drive(order) => self.now = Now::Drives(order),
                Change::Jump(jump) => {
                    self.correction.x -= jump.x;
                    self.correction.y -= jump.y;
                    self.correction.theta -= jump.theta;
                    jumped = true;
                }
            }
        }
        let measured = Measured {
            pose: Pose {
                x: truth.pose.x - self.correction.x,
                y: truth.pose.y - self.correction.y,
                theta: truth.pose.theta - self.correction.theta,
            },
            twist: truth.twist,
        };
        let mut left = None;
        if matches!(self.now, Now::Follows)
            && let (Some(rule), Some(reference)) = (self.rule, self.sampler.at(tick))
        {
            let error = pose_error::<f64, Libm>(reference.pose(), &measured.pose);
            let (path_m, turn_rad) = self.sampler.to_go(tick);
            let remaining = Remaining { path_m, turn_rad }.with_error(&reference, &error);
            let due = match rule.when {
                When::Time(time) => t >= time - 1e-9,
                When::Distance => {
                    let passes_on = !self.sampler.rests_at_end();
                    self.sampler.is_over(tick)
                        || (passes_on && remaining.is_short::<Libm>(command, self.lever, distance))
                }
            };
            // Tick 0 starts, so it cannot hand over.
            if due && tick > 0 {
                self.now = Now::parks(rule.goal);
                left = Some((reference, remaining.path_m));
            }
        }
        let (target, task) = match self.now {
            Now::Parks(rest) => (rest, Task::Park(*rest.pose())),
            Now::Follows => {
                let target = self.sampler.at(tick);
                let target =
                    target.unwrap_or_else(|| Reference::at_rest_with::<Libm>(measured.pose));
                (target, Task::Follow(target))
            }
            // It has no place to be: it is where it is.
            Now::Drives(VelocityOrder {
                twist,
                hold_heading,
            }) => (
                Reference::new_with::<Libm>(measured.pose, twist, Accel::default()),
                Task::Drive {
                    twist,
                    hold_heading,
                },
            ),
        };
        Orders {
            task,
            target,
            left,
            jumped,
            measured,
        }
    }
}
