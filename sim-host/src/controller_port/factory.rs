//! From the names in a scenario to the types of the core.

use super::{ControllerPort, InProcess};
use crate::precision::Precision;
use crate::scenario::{ControlLaw, MathsBackEnd, Scenario, Update};
use controller_core::error::ParamError;
use controller_core::maths::{Libm, Maths, Micromath, Single};
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::ValidParams;
use controller_core::paper::plain::PlainController;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactHeld, ExactMean, RationalMean};

/// The controller that a scenario names.
///
/// # Errors
/// Parameters that the core refuses. A [`Scenario`] that was read from a file has none.
pub fn for_scenario(scenario: &Scenario) -> Result<Box<dyn ControllerPort>, ParamError> {
    Ok(match scenario.controller.precision {
        Precision::F64 => with_maths::<f64, Libm>(scenario, scenario.params.validate()?),
        Precision::F32 => {
            let params = scenario.params.cast::<f32>().validate()?;
            match scenario.controller.maths {
                MathsBackEnd::Libm => with_maths::<f32, Libm>(scenario, params),
                MathsBackEnd::Micromath => with_maths::<f32, Micromath>(scenario, params),
                MathsBackEnd::Single => with_maths::<f32, Single>(scenario, params),
            }
        }
    })
}

fn with_maths<T: Scalar, M: Maths<T>>(
    scenario: &Scenario,
    params: ValidParams<T>,
) -> Box<dyn ControllerPort> {
    type Neural<T, M, U> = InProcess<T, M, NeuralController<T, M, U>>;
    let controller = &scenario.controller;
    match (controller.kind, controller.neurons) {
        (ControlLaw::Plain, _) => Box::new(InProcess::<T, M, PlainController<T, M>>::new(params)),
        (ControlLaw::Neural, Update::ExactHeld) => Box::new(Neural::<T, M, ExactHeld>::new(params)),
        (ControlLaw::Neural, Update::ExactMean) => Box::new(Neural::<T, M, ExactMean>::new(params)),
        (ControlLaw::Neural, Update::RationalMean) => {
            Box::new(Neural::<T, M, RationalMean>::new(params))
        }
    }
}
