//! A controller of the core, called directly.

use super::{Answer, ControllerPort, ControllerPortError};
use controller_core::error::StepFault;
use controller_core::maths::Maths;
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::ValidParams;
use controller_core::paper::plain::PlainController;
use controller_core::paper::report::StepReport;
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronUpdate;
use controller_core::types::{Measured, Wrench};
use std::marker::PhantomData;

/// The calls that the core's controllers share; see there.
#[allow(missing_docs, clippy::missing_errors_doc)]
pub trait Control<T: Scalar>: Sized {
    fn start(
        params: &ValidParams<T>,
        reference: &Reference<T>,
        measured: &Measured<T>,
    ) -> Result<Self, StepFault>;
    fn step(&mut self, dt: T, demand: &Demand<T>, measured: &Measured<T>) -> Result<(), StepFault>;
    fn report(&self) -> &StepReport<T>;
    fn hand_over_step(&self) -> Option<Wrench<T>>;
    fn is_relaxing(&self) -> bool;
}

macro_rules! forward {
    () => {
        fn start(
            params: &ValidParams<T>,
            reference: &Reference<T>,
            measured: &Measured<T>,
        ) -> Result<Self, StepFault> {
            Self::start(params, reference, measured)
        }
        fn step(
            &mut self,
            dt: T,
            demand: &Demand<T>,
            measured: &Measured<T>,
        ) -> Result<(), StepFault> {
            self.step(dt, demand, measured).map(|_| ())
        }
        fn report(&self) -> &StepReport<T> {
            self.report()
        }
        fn hand_over_step(&self) -> Option<Wrench<T>> {
            self.hand_over_step()
        }
    };
}

impl<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>> Control<T> for NeuralController<T, M, U> {
    forward!();
    fn is_relaxing(&self) -> bool {
        self.is_relaxing()
    }
}

impl<T: Scalar, M: Maths<T>> Control<T> for PlainController<T, M> {
    forward!();
    fn is_relaxing(&self) -> bool {
        false
    }
}

/// A [`ControllerPort`] that runs the controller `C` in this process.
#[derive(Clone, Debug)]
pub struct InProcess<T, M, C> {
    params: ValidParams<T>,
    controller: Option<C>,
    back_end: PhantomData<M>,
}

impl<T: Scalar, M: Maths<T>, C: Control<T>> InProcess<T, M, C> {
    /// A controller port that is not started yet.
    pub fn new(params: ValidParams<T>) -> Self {
        Self {
            params,
            controller: None,
            back_end: PhantomData,
        }
    }

    /// The controller, once started.
    pub fn controller(&self) -> Option<&C> {
        self.controller.as_ref()
    }
}

impl<T: Scalar, M: Maths<T>, C: Control<T>> ControllerPort for InProcess<T, M, C> {
    fn start(
        &mut self,
        reference: &Reference<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError> {
        let reference = reference.cast_with::<T, M>();
        let measured = measured.cast();
        let controller = C::start(&self.params, &reference, &measured)?;
        Ok(answer(self.controller.insert(controller)))
    }

    fn step(
        &mut self,
        dt: f64,
        demand: &Demand<f64>,
        measured: &Measured<f64>,
    ) -> Result<Answer, ControllerPortError> {
        let controller = self
            .controller
            .as_mut()
            .ok_or(ControllerPortError::NotStarted)?;
        let demand = demand.cast_with::<T, M>();
        let measured = measured.cast();
        controller.step(T::from_f64(dt), &demand, &measured)?;
        Ok(answer(controller))
    }
}

fn answer<T: Scalar, C: Control<T>>(controller: &C) -> Answer {
    Answer {
        report: controller.report().cast(),
        hand_over_step: controller.hand_over_step().map(|step| step.cast()),
        relaxing: controller.is_relaxing(),
    }
}
