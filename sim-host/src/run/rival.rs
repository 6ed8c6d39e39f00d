//! A rival in the loop: its demands go through the core's own limits, velocity loop, disturbance estimate and motor layer.
//!
//! The core follows a reference that is where the robot is and moves as the rival wants it: its pose feedback
//! has nothing to do, and all the rest works as for the default law.

use super::law::{Acted, Computed, Law};
use crate::controller_port::ControllerPortError;
use crate::mission::{Mission, Orders};
use controller_core::base::Order;
use controller_core::error::StepFault;
use controller_core::maths::Single;
use controller_core::motion::{
    Mode, MotionController, MotionReport, Outcome, Task, ValidMotionParams,
};
use controller_core::pose_error::pose_error;
use controller_core::reference::Reference;
use controller_core::shunting::RationalMean;
use controller_core::types::{Accel, Measured, Twist};
use rivals::{Body, Job, Now, Path, Rival, Wanted};

/// A rival with what all of them share: the goal check, the limits of its demands, and their rates.
pub(crate) struct Driver {
    rival: Box<dyn Rival>,
    body: Body,
    samples: Vec<Reference<f32>>,
    t: Option<f64>,
    smoothed: Twist<f32>,
    /// Inside of the tolerance since \[s\].
    arrived_at: Option<f64>,
    /// It had no answer to a job.
    refused: bool,
}

/// Decay of the filter behind the rates of demands \[1/s\]: a quicker one passes more of the poses' noise, a slower one comes late.
/// The rivals' gains are searched with it.
const RATES: f32 = 8.0;

/// A robot that left its goal by this many tolerances drives on.
const LEFT: f32 = 2.0;

impl Driver {
    /// On a mission.
    pub(crate) fn new(rival: Box<dyn Rival>, body: Body, mission: &Mission) -> Self {
        let samples = mission.samples();
        Self {
            rival,
            body,
            samples: samples
                .iter()
                .map(Reference::cast_with::<f32, Single>)
                .collect(),
            t: None,
            smoothed: Twist::default(),
            arrived_at: None,
            refused: false,
        }
    }

    /// It stands at its goal, as far as it knows.
    pub(crate) const fn has_arrived(&self) -> bool {
        self.arrived_at.is_some()
    }

    /// It had no answer.
    pub(crate) const fn has_refused(&self) -> bool {
        self.refused
    }

    /// The order to the base.
    pub(crate) fn order(&mut self, t: f64, seen: &Measured<f32>, task: &Task<f64>) -> Order<f32> {
        Order::Follow(self.reference(t, seen, task))
    }

    /// A reference that is where the robot is and moves as the rival wants.
    fn reference(&mut self, t: f64, seen: &Measured<f32>, task: &Task<f64>) -> Reference<f32> {
        let since = self.t.map_or(0.0, |before| t - before);
        let first = self.t.is_none();
        self.t = Some(t);
        let dt = since as f32;
        let wanted = match task {
            // The loop starts from rest.
            _ if first => Wanted::default(),
            Task::Drive { twist, .. } => Wanted {
                twist: twist.cast(),
                accel: None,
            },
            Task::Follow(_) => {
                self.arrived_at = None;
                let tick = (t / f64::from(self.body.period_s)).round() as usize;
                self.ask(seen, dt, None, tick)
            }
            Task::Park(goal) => {
                let goal = goal.cast();
                let e = pose_error::<f32, Single>(&goal, &seen.pose);
                let wide = if self.has_arrived() { LEFT } else { 1.0 };
                let near = wide * self.body.distance_m;
                let inside = e.x * e.x + e.y * e.y < near * near
                    && e.theta.abs() < wide * self.body.heading_rad;
                self.arrived_at = inside.then(|| self.arrived_at.unwrap_or(t));
                if inside {
                    Wanted::default()
                } else {
                    self.ask(seen, dt, Some(goal), 0)
                }
            }
        };
        let twist = self.within_limits(wanted.twist);
        // Rates that a law does not know are those of its demands, behind a filter.
        let share = if since > 0.0 {
            dt * RATES / (1.0 + dt * RATES)
        } else {
            0.0
        };
        self.smoothed.linear += share * (twist.linear - self.smoothed.linear);
        self.smoothed.angular += share * (twist.angular - self.smoothed.angular);
        let accel = wanted.accel.unwrap_or(Accel {
            linear: RATES * (twist.linear - self.smoothed.linear),
            angular: RATES * (twist.angular - self.smoothed.angular),
        });
        Reference::new(seen.pose, twist, accel)
    }

    fn ask(
        &mut self,
        seen: &Measured<f32>,
        dt: f32,
        goal: Option<controller_core::types::Pose<f32>>,
        tick: usize,
    ) -> Wanted {
        let now = Now {
            pose: seen.pose,
            twist: seen.twist,
            dt,
        };
        let job = match goal {
            Some(goal) => Job::Park(goal),
            None => Job::Follow(Path {
                samples: &self.samples,
                tick,
            }),
        };
        let wanted = self.rival.advance(&now, &job);
        self.refused |= wanted.is_none();
        wanted.unwrap_or_default()
    }

    /// Both by one factor, so that the curvature stays, as the core does for the rims; what is no number is rest.
    fn within_limits(&self, twist: Twist<f32>) -> Twist<f32> {
        let limits = &self.body.limits;
        if !twist.is_finite() {
            return Twist::default();
        }
        let beyond = (twist.linear.abs() / limits.speed)
            .max(twist.angular.abs() / limits.turn_rate)
            .max(1.0);
        Twist::new(twist.linear / beyond, twist.angular / beyond)
    }
}

/// What a rival may know of a base. `asked` is the tolerance of its goal check where poses have no noise \[m, rad\].
pub(crate) fn body(mission: &Mission, (distance, heading): (f64, f64)) -> Body {
    let base = &mission.base;
    let arrival = match &base.hardware {
        // Poses with noise: the tolerance that the default law has there.
        Some(hardware) if mission.setup.is_some() => hardware
            .localiser::<f32>(&base.robot.wheels)
            .validate_with::<Single>()
            .ok()
            .map(|localisation| localisation.arrival()),
        _ => None,
    };
    Body {
        limits: base.limits.cast(),
        period_s: mission.period_s as f32,
        distance_m: arrival.map_or(distance as f32, |arrival| arrival.distance_m),
        heading_rad: arrival.map_or(heading as f32, |arrival| arrival.heading_rad),
    }
}

/// A rival on the ideal plant.
pub(crate) struct RivalLaw<'a> {
    driver: &'a mut Driver,
    motion: ValidMotionParams<f32>,
    controller: Option<MotionController<f32, Single, RationalMean>>,
    /// The last order was to park.
    parks: bool,
    t: f64,
}

impl<'a> RivalLaw<'a> {
    /// With the core's parameters of the base.
    pub(crate) fn new(driver: &'a mut Driver, motion: ValidMotionParams<f32>) -> Self {
        Self {
            driver,
            motion,
            controller: None,
            parks: false,
            t: 0.0,
        }
    }

    /// What the core reported last, as of a law that parks: what it follows is the rival.
    fn report(&self) -> MotionReport<f32> {
        let controller = self.controller.as_ref();
        let mut report = controller.map_or_else(MotionReport::default, |c| *c.report());
        if self.parks {
            report.mode = Mode::Parking;
            if self.driver.has_arrived() {
                report.outcome = Outcome::Parked;
            }
        }
        report
    }
}

impl Law for RivalLaw<'_> {
    fn tick(&mut self, dt: f64, orders: &Orders) -> Result<Acted, ControllerPortError> {
        let mut measured: Measured<f32> = orders.measured.cast();
        measured.pose.theta = controller_core::angle::wrap(orders.measured.pose.theta) as f32;
        if self.controller.is_some() {
            self.t += dt;
        }
        let reference = self.driver.reference(self.t, &measured, &orders.task);
        if self.driver.has_refused() {
            return Err(ControllerPortError::Fault(StepFault::WrongPhase));
        }
        let task = Task::Follow(reference);
        match &mut self.controller {
            None => {
                let started = MotionController::start(&self.motion, &task, &measured)?;
                self.controller = Some(started);
            }
            Some(controller) => {
                controller.step(dt as f32, &task, &measured)?;
            }
        }
        self.parks = matches!(orders.task, Task::Park(_));
        let report = self.report();
        Ok(Acted {
            torques: report.torques.cast(),
            outcome: report.outcome,
            hand_over_step: None,
        })
    }

    fn computed(&self) -> Computed {
        Computed {
            report: self.report().cast(),
            paper: None,
        }
    }

    fn command(&self) -> Twist<f64> {
        let controller = self.controller.as_ref();
        controller.map_or(Twist::default(), |c| c.report().command.cast())
    }

    fn hand_over_distance(&self, speed: f64) -> f64 {
        f64::from(self.motion.hand_over_distance(speed as f32))
    }
}
