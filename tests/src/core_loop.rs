//! The core's controllers in closed loop with this crate's own robot, torque held between ticks.

use controller_core::error::StepFault;
use controller_core::maths::{Libm, Maths};
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::ValidParams;
use controller_core::paper::plain::PlainController;
use controller_core::paper::report::StepReport;
use controller_core::reference::Reference as Sample;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate};
use controller_core::types::{Measured, Wrench};
use nalgebra::{Vector2, Vector3};

use crate::core_params::{measured, pose, sample, validated};
use crate::ideal::Loop;
use crate::oracle::{Phase, Reset, Scenario, robot};
use crate::plant::{Body, MovingReference};

/// What the two controllers have in common.
pub trait Controller<T: Scalar>: Copy + PartialEq + std::fmt::Debug {
    /// Starts tracking.
    fn begin(
        params: &ValidParams<T>,
        reference: &Sample<T>,
        measured: &Measured<T>,
    ) -> Result<(Self, StepReport<T>), StepFault>;

    /// One tick.
    fn tick(
        &mut self,
        dt: T,
        demand: &Demand<T>,
        measured: &Measured<T>,
    ) -> Result<StepReport<T>, StepFault>;

    /// Step of the wrench at the hand-over.
    fn hand_over_step(&self) -> Option<Wrench<T>>;

    /// An acceleration neuron is outside its bounds.
    fn is_relaxing(&self) -> bool;
}

/// The neural controller with which formulas are proven: double precision, exact updates.
pub type Exact = NeuralController<f64, Libm, ExactMean>;

macro_rules! forward {
    () => {
        fn begin(
            params: &ValidParams<T>,
            reference: &Sample<T>,
            measured: &Measured<T>,
        ) -> Result<(Self, StepReport<T>), StepFault> {
            let controller = Self::start(params, reference, measured)?;
            let report = *controller.report();
            Ok((controller, report))
        }
        fn tick(
            &mut self,
            dt: T,
            demand: &Demand<T>,
            measured: &Measured<T>,
        ) -> Result<StepReport<T>, StepFault> {
            self.step(dt, demand, measured).copied()
        }
        fn hand_over_step(&self) -> Option<Wrench<T>> {
            self.hand_over_step()
        }
    };
}

impl<T: Scalar, M: Maths<T> + PartialEq, U: NeuronUpdate<T> + PartialEq> Controller<T>
    for NeuralController<T, M, U>
{
    forward!();

    fn is_relaxing(&self) -> bool {
        self.is_relaxing()
    }
}

impl<T: Scalar, M: Maths<T> + PartialEq> Controller<T> for PlainController<T, M> {
    forward!();

    fn is_relaxing(&self) -> bool {
        false
    }
}

/// One tick of a run: what was measured, and what the controller said of it.
#[derive(Clone, Copy, Debug)]
pub struct Tick<T> {
    /// Time \[s\].
    pub t: f64,
    /// The true robot.
    pub body: Body,
    /// The controller's report.
    pub report: StepReport<T>,
    /// At the tick of the hand-over: the report of a copy of the controller that went on tracking.
    pub unswitched: Option<StepReport<T>>,
    /// At the tick of the hand-over: the step of the wrench that the controller tells.
    pub wrench_step: Option<Wrench<T>>,
    /// An acceleration neuron is outside its bounds.
    pub relaxing: bool,
}

impl<T: Scalar> Tick<T> {
    /// (τ₁, τ₂) asked for.
    pub fn tau(&self) -> Vector2<f64> {
        let wrench = &self.report.wrench;
        Vector2::new(wrench.force.to_f64(), wrench.moment.to_f64())
    }

    /// (e_x, e_y, e_θ) as the controller sees it.
    pub fn error(&self) -> Vector3<f64> {
        let e = &self.report.error;
        Vector3::new(e.x.to_f64(), e.y.to_f64(), e.theta.to_f64())
    }

    /// (v_c, w_c).
    pub fn command(&self) -> Vector2<f64> {
        let command = &self.report.command;
        Vector2::new(command.linear.to_f64(), command.angular.to_f64())
    }

    /// (v̇_c, ẇ_c).
    pub fn command_rate(&self) -> Vector2<f64> {
        let rate = &self.report.command_rate;
        Vector2::new(rate.linear.to_f64(), rate.angular.to_f64())
    }

    /// The golden files' columns.
    pub fn columns(&self) -> [f64; 20] {
        let (q, twist, e, tau, c) = (
            &self.body.q,
            &self.body.twist,
            self.error(),
            self.tau(),
            self.command(),
        );
        let n = &self.report.neurons;
        let [s1, s2, s3] = [n.s1, n.s2, n.s3].map(T::to_f64);
        let [vs, ws] = [n.accel.linear, n.accel.angular].map(T::to_f64);
        let transition_offset = &self.report.transition_offset;
        let [bv, bw] = [transition_offset.linear, transition_offset.angular].map(T::to_f64);
        [
            self.t, q.x, q.y, q.z, twist.x, twist.y, e.x, e.y, e.z, s1, s2, s3, vs, ws, c.x, c.y,
            tau.x, tau.y, bv, bw,
        ]
    }
}

/// Runs `scenario` with the controller `C` at k dt; the first tick that has reached P hands over.
///
/// The robot feels the wheel torques of the report through the oracle's own B̄ of Eq. (3).
pub fn run<T: Scalar, C: Controller<T>>(scenario: &Scenario, dt: f64) -> Vec<Tick<T>>
where
    Libm: Maths<T>,
{
    let p = &scenario.params;
    let reset = scenario
        .switch
        .map_or(Reset::Corrected, |switch| switch.reset);
    let params = validated::<T>(p, reset);
    let wheel_map = robot::wheel_map(p);
    let mut reference = MovingReference::start(&scenario.reference);
    let body = Body {
        q: scenario.q0,
        twist: scenario.twist0,
    };
    let demanded = |q_r: &Vector3<f64>, t| sample::<T>(q_r, &scenario.target(Phase::Tracking, t));
    let first = demanded(&reference.q, 0.0);
    let (controller, report) = C::begin(&params, &first, &measured(&body.q, &body.twist))
        .expect("the start of a run is finite");
    let mut drive = Loop::new(controller, body, *p, dt);
    let samples = (scenario.duration / dt).round() as usize;
    let mut ticks = Vec::with_capacity(samples + 1);
    ticks.push(Tick {
        t: drive.t,
        body,
        report,
        unswitched: None,
        wrench_step: None,
        relaxing: drive.controller.is_relaxing(),
    });
    let mut parking = false;
    for k in 1..=samples {
        let torques = ticks[k - 1].report.torques;
        let torques = Vector2::new(torques.right.to_f64(), torques.left.to_f64());
        drive.hold(&(wheel_map * torques));
        let Loop { body, t, .. } = drive;
        let now = measured(&body.q, &body.twist);
        let mut unswitched = None;
        let demand = if parking {
            Demand::Park
        } else {
            reference.move_to(&scenario.reference, t);
            let sample = demanded(&reference.q, t);
            match &scenario.switch {
                Some(switch) if t >= switch.at - crate::oracle::sampled::SWITCH_SLACK => {
                    parking = true;
                    let mut copy = drive.controller;
                    let went_on = copy.tick(T::from_f64(dt), &Demand::Track(sample), &now);
                    unswitched = Some(went_on.expect("tracking goes on"));
                    Demand::HandOver {
                        reference: sample,
                        goal: pose(&switch.target),
                    }
                }
                _ => Demand::Track(sample),
            }
        };
        let report = drive
            .controller
            .tick(T::from_f64(dt), &demand, &now)
            .expect("a tick of a run is accepted");
        ticks.push(Tick {
            t,
            body,
            report,
            unswitched,
            wrench_step: unswitched.and_then(|_| drive.controller.hand_over_step()),
            relaxing: drive.controller.is_relaxing(),
        });
    }
    ticks
}

/// The tick of the hand-over.
pub fn hand_over<T: Scalar>(ticks: &[Tick<T>]) -> usize {
    ticks
        .iter()
        .position(|tick| tick.unswitched.is_some())
        .expect("the run hands over")
}

/// Largest change of (τ₁, τ₂) from one tick to the next; the step from no torque at the start counts.
pub fn largest_torque_change<T: Scalar>(ticks: &[Tick<T>]) -> Vector2<f64> {
    let mut before = Vector2::zeros();
    let mut largest = Vector2::zeros();
    for tick in ticks {
        largest = (tick.tau() - before).abs().sup(&largest);
        before = tick.tau();
    }
    largest
}
