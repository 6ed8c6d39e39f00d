//! Controller ports: what passes between the loop and a controller.

use controller_core::error::{Input, StepFault};
use controller_core::maths::Libm;
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::Params;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Measured, Pose, Twist};
use sim_host::controller_port::{
    Answer, ControllerPort, ControllerPortError, InProcess, for_scenario,
};
use sim_host::run::{RunError, run_with};
use sim_host::scenario::{BuiltIn, Scenario};

type Single = NeuralController<f32, Libm>;

fn scenario() -> Scenario {
    BuiltIn::find("paper-curve")
        .expect("built in")
        .scenario()
        .expect("in order")
}

fn reference() -> Reference<f64> {
    Reference::new_with::<Libm>(
        Pose::new(0.1, 0.2, 0.3),
        Twist::new(0.4, 0.15),
        Accel::default(),
    )
}

fn measured() -> Measured<f64> {
    Measured {
        pose: Pose::new(-0.1, 1.0 / 3.0, 0.7),
        twist: Twist::new(0.05, -0.02),
    }
}

#[test]
fn a_widened_report_holds_the_very_bits() {
    let params = Params::<f32>::paper().validate().expect("in order");
    let mut controller = InProcess::<f32, Libm, Single>::new(params);
    controller.start(&reference(), &measured()).expect("starts");
    let demand = Demand::Track(reference());
    let answer = controller.step(0.01, &demand, &measured()).expect("steps");
    let ours = answer.report;

    let (r, m) = (reference().cast_with::<f32, Libm>(), measured().cast());
    let mut direct = Single::start(&params, &r, &m).expect("starts");
    let theirs = direct.step(0.01_f32, &Demand::Track(r), &m).expect("steps");

    let bits = |wide: f64| (wide as f32).to_bits();
    assert_eq!(bits(ours.wrench.force), theirs.wrench.force.to_bits());
    assert_eq!(bits(ours.torques.left), theirs.torques.left.to_bits());
    assert_eq!(
        bits(ours.neurons.accel.angular),
        theirs.neurons.accel.angular.to_bits()
    );
    assert_eq!(ours, theirs.cast());
    assert_ne!(ours.wrench.force, 0.0);
}

#[test]
fn narrowing_to_the_same_type_changes_nothing() {
    let params = scenario().params;
    assert_eq!(params.cast::<f64>(), params);
    let demand = Demand::HandOver {
        reference: reference(),
        goal: Pose::new(1.0, 2.0, 3.0),
    };
    assert_eq!(demand.cast_with::<f64, Libm>(), demand);
    assert_eq!(measured().cast::<f64>(), measured());
}

#[test]
fn a_pilot_that_was_not_started_says_so() {
    let mut controller = for_scenario(&scenario()).expect("in order");
    let refused = controller.step(0.01, &Demand::Park, &measured());
    assert!(matches!(refused, Err(ControllerPortError::NotStarted)));
}

#[test]
fn faults_of_the_controller_come_through() {
    let mut controller = for_scenario(&scenario()).expect("in order");
    controller.start(&reference(), &measured()).expect("starts");
    let mut lost = measured();
    lost.pose.x = f64::NAN;
    let refused = controller.step(0.01, &Demand::Track(reference()), &lost);
    let expected = StepFault::NotFinite(Input::Pose);
    assert!(matches!(refused, Err(ControllerPortError::Fault(fault)) if fault == expected));
}

/// Works for a while, then is gone: what a cable does.
struct Unplugged {
    ticks: usize,
    inner: Box<dyn ControllerPort>,
}

impl ControllerPort for Unplugged {
    fn start(
        &mut self,
        reference: &Reference<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError> {
        self.inner.start(reference, measured)
    }

    fn step(
        &mut self,
        dt: f64,
        demand: &Demand<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError> {
        match self.ticks.checked_sub(1) {
            Some(left) => self.ticks = left,
            None => return Err(ControllerPortError::Link("the cable is out".into())),
        }
        self.inner.step(dt, demand, measured)
    }
}

#[test]
fn a_run_ends_with_the_time_and_the_cause() {
    let scenario = scenario();
    let inner = for_scenario(&scenario).expect("in order");
    let error = run_with(&scenario, &mut Unplugged { ticks: 249, inner }).expect_err("unplugged");
    assert!(
        matches!(&error, RunError::ControllerPort { time_s, .. } if *time_s == 0.25),
        "{error:?}"
    );
    let shown = error.to_string();
    assert!(
        shown.contains("paper-curve") && shown.contains("t = 0.25 s"),
        "{shown}"
    );
}
