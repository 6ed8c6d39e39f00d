//! What the wheels are to be told in a tick.

use controller_core::demand::Demand;
use controller_core::error::StepFault;
use controller_core::hal::WheelDrive;
use controller_core::maths::{Maths, Single};
use controller_core::neural::NeuralController;
use controller_core::queue::Gap;
use controller_core::reference::Reference;
use controller_core::report::Phase;
use controller_core::types::{Accel, Measured, Pose, Twist, WheelTorques};

use super::watch::{Held, at_rest};
use super::{Arrival, ControlTask, Mission, SensorFault};
use crate::fault::{Cause, Fault};
use crate::supervisor::{Event, State};

type Torques = Result<Option<WheelTorques<f32>>, Fault>;

impl<D: WheelDrive> ControlTask<'_, D> {
    /// Torques to set, or `None` to release.
    pub(super) fn decide(
        &mut self,
        elapsed_us: u32,
        sensed: Result<Measured<f32>, SensorFault>,
    ) -> Torques {
        let settings = self.settings.get();
        let late = self
            .overruns
            .too_many(elapsed_us, settings.late_us, settings.overruns_to_fault);
        if self
            .silence
            .lost(settings.link, elapsed_us, settings.period_us)
        {
            self.apply(Event::LinkLost, Cause::LinkLost);
        }
        if !self.state.is_live() {
            return Ok(None);
        }
        if late {
            return Err(Fault::Overrun);
        }
        let measured = sensed.map_err(|SensorFault| Fault::Sensor)?;
        self.mission.run_us = self.mission.run_us.saturating_add(elapsed_us.into());
        self.mission.ticks = self.mission.ticks.wrapping_add(1);
        let torques = match self.state {
            State::Armed | State::Parked => self.wait(&measured)?,
            State::Tracking => Some(self.track(elapsed_us, &measured)?),
            State::Parking => self.park(elapsed_us, &measured)?,
            State::Idle | State::Stopped | State::Fault => None,
        };
        self.watch_wheels(elapsed_us, &measured, torques)
    }

    /// Starts as soon as two references make a trajectory; until then armed wheels hold zero torque.
    fn wait(&mut self, measured: &Measured<f32>) -> Torques {
        // Before all times, so what is waiting comes later, and tells when.
        let Err(Gap::TooEarly { first_s }) = self.references.at::<Single>(f32::MIN) else {
            return Ok((self.state == State::Armed).then(WheelTorques::default));
        };
        let Ok(reference) = self.references.at::<Single>(first_s) else {
            return Ok(None);
        };
        self.apply(Event::Track, Cause::References);
        let controller = NeuralController::start(&self.params, &reference, measured)?;
        let torques = controller.report().torques;
        self.mission = Mission {
            controller: Some(controller),
            first_s,
            ..Mission::default()
        };
        Ok(Some(torques))
    }

    fn track(
        &mut self,
        elapsed_us: u32,
        measured: &Measured<f32>,
    ) -> Result<WheelTorques<f32>, Fault> {
        let (reference, goal) = match self.references.at::<Single>(self.mission.now_s()) {
            Ok(reference) => {
                return self.step(elapsed_us, &Demand::Track(reference), measured);
            }
            // A trajectory that ends at rest is complete, one that ends in motion was cut off.
            Err(Gap::Underrun { last }) if *last.reference.twist() == Twist::default() => {
                self.apply(Event::TrajectoryEnded, Cause::TrajectoryEnded);
                (last.reference, *last.reference.pose())
            }
            gap => {
                self.apply(Event::Underrun, Cause::Underrun);
                self.mission.braking = Some(0);
                let reference = match gap {
                    Err(Gap::Underrun { last }) => last.reference,
                    _ => here(measured),
                };
                (reference, self.stopping_place(measured))
            }
        };
        self.hand_over(elapsed_us, reference, goal, measured)
    }

    fn park(&mut self, elapsed_us: u32, measured: &Measured<f32>) -> Torques {
        let torques = match self.mission.goal.take() {
            Some(goal) => self.leave_for(elapsed_us, goal, measured)?,
            None => self.step(elapsed_us, &Demand::Park, measured)?,
        };
        let settings = self.settings.get();
        let (rest, there) = self.mission.stands(&settings.arrival, measured);
        let wanted = if self.mission.braking.is_some() {
            rest
        } else {
            there
        };
        let dwell_us = settings.arrival.dwell_us;
        let stands = self.mission.arrived.holds(wanted, elapsed_us, dwell_us);
        match &mut self.mission.braking {
            Some(braking_us) => {
                *braking_us = braking_us.saturating_add(elapsed_us);
                if stands || *braking_us >= settings.stop_limit_us {
                    self.apply(Event::Halted, Cause::Underrun);
                    return Ok(None);
                }
            }
            None if stands => {
                self.apply(Event::Reached, Cause::Reached);
                return Ok(None);
            }
            None => {}
        }
        Ok(Some(torques))
    }

    /// To a commanded goal: from tracking by the hand-over, else by a start from what the robot does now.
    fn leave_for(
        &mut self,
        elapsed_us: u32,
        goal: Pose<f32>,
        measured: &Measured<f32>,
    ) -> Result<WheelTorques<f32>, Fault> {
        self.mission.braking = None;
        self.mission.arrived = Held::default();
        let tracking = |controller: &NeuralController| controller.report().phase == Phase::Tracking;
        let reference = if self.mission.controller.as_ref().is_some_and(tracking) {
            match self.references.at::<Single>(self.mission.now_s()) {
                Ok(reference) => reference,
                Err(Gap::Underrun { last }) => last.reference,
                Err(_) => here(measured),
            }
        } else {
            let reference = here(measured);
            let controller = NeuralController::start(&self.params, &reference, measured)?;
            self.mission.controller = Some(controller);
            reference
        };
        self.hand_over(elapsed_us, reference, goal, measured)
    }

    fn hand_over(
        &mut self,
        elapsed_us: u32,
        reference: Reference<f32>,
        goal: Pose<f32>,
        measured: &Measured<f32>,
    ) -> Result<WheelTorques<f32>, Fault> {
        self.mission.handed_over = true;
        self.references.clear();
        let demand = Demand::HandOver { reference, goal };
        self.step(elapsed_us, &demand, measured)
    }

    fn step(
        &mut self,
        elapsed_us: u32,
        demand: &Demand<f32>,
        measured: &Measured<f32>,
    ) -> Result<WheelTorques<f32>, Fault> {
        let Some(controller) = &mut self.mission.controller else {
            return Err(StepFault::WrongPhase.into());
        };
        let report = controller.step(elapsed_us as f32 * 1e-6, demand, measured)?;
        Ok(report.torques)
    }

    /// Where parking has the robot stop from what it does now: v/k4 ahead, where the parking law commands the
    /// very speed v, and turned on by w/k5, at most by a radian.
    fn stopping_place(&self, measured: &Measured<f32>) -> Pose<f32> {
        let (pose, twist) = (&measured.pose, &measured.twist);
        let gains = &self.params.params().parking;
        let ahead = twist.linear / gains.k4;
        let turn = (twist.angular / gains.k5).clamp(-1.0, 1.0);
        let (sine, cosine) = Single::sin_cos(pose.theta);
        Pose::new(
            pose.x + ahead * cosine,
            pose.y + ahead * sine,
            pose.theta + turn,
        )
    }

    /// A wheel that stands still under torque for too long has lost its encoder, or is blocked.
    fn watch_wheels(
        &mut self,
        elapsed_us: u32,
        measured: &Measured<f32>,
        torques: Option<WheelTorques<f32>>,
    ) -> Torques {
        let speeds = self.params.wheels().wheel_speeds(&measured.twist);
        let watch = &self.settings.get().stall;
        let told = torques.unwrap_or_default();
        if self.mission.stall.stuck(watch, &told, &speeds, elapsed_us) {
            Err(Fault::EncoderStuck)
        } else {
            Ok(torques)
        }
    }
}

impl Mission {
    /// Time on the clock of the trajectory \[s\].
    fn now_s(&self) -> f32 {
        self.first_s + self.run_us as f32 * 1e-6
    }

    /// Whether the robot stands, and at its goal.
    fn stands(&self, arrival: &Arrival, measured: &Measured<f32>) -> (bool, bool) {
        let rest = at_rest(arrival, measured);
        let there = self.controller.as_ref().is_some_and(|controller| {
            let error = &controller.report().error;
            error.x.abs() < arrival.along_m && error.theta.abs() < arrival.heading_rad
        });
        (rest, rest && there)
    }
}

/// What the robot does now, as a reference.
fn here(measured: &Measured<f32>) -> Reference<f32> {
    Reference::new::<Single>(measured.pose, measured.twist, Accel::default())
}
