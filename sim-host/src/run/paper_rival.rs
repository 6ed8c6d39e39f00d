//! The paper's laws as rivals: over the whole base, where they know references and one hand-over only.

use crate::controller_port::{ControllerPort, InProcess};
use crate::scenario::ControlLaw;
use controller_core::maths::{Libm, Single};
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::Params;
use controller_core::paper::plain::PlainController;
use controller_core::reference::Reference;
use controller_core::shunting::ExactMean;
use controller_core::types::{Accel, Measured, Twist};
use rivals::{Job, Now, Rival, Wanted};

/// A law of the paper: what it commands of its velocity loop is what it wants.
pub(crate) struct PaperRival {
    controller: Box<dyn ControllerPort>,
    /// The reference that it followed last.
    left: Option<Reference<f64>>,
    parks: bool,
}

impl PaperRival {
    /// With the paper's gains, in single precision as on a chip; the neurons are those of scenario files that say nothing of them.
    pub(crate) fn new(kind: ControlLaw) -> Option<Self> {
        type Neural = NeuralController<f32, Single, ExactMean>;
        type Plain = PlainController<f32, Single>;
        let params = Params::<f64>::paper().cast::<f32>().validate().ok()?;
        let controller: Box<dyn ControllerPort> = match kind {
            ControlLaw::Neural => Box::new(InProcess::<_, Single, Neural>::new(params)),
            ControlLaw::Plain => Box::new(InProcess::<_, Single, Plain>::new(params)),
        };
        Some(Self {
            controller,
            left: None,
            parks: false,
        })
    }
}

impl Rival for PaperRival {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        let measured: Measured<f64> = Measured {
            pose: now.pose.cast(),
            twist: now.twist.cast(),
        };
        let dt = f64::from(now.dt);
        let answer = match job {
            Job::Follow(path) => {
                let reference = path.at(0)?.cast_with::<f64, Libm>();
                let started = self.left.replace(reference).is_some();
                if started {
                    self.controller
                        .step(dt, &Demand::Track(reference), &measured)
                } else {
                    self.controller.start(&reference, &measured)
                }
            }
            Job::Park(goal) => {
                let reference = self.left?;
                let goal = goal.cast();
                let first = !std::mem::replace(&mut self.parks, true);
                let demand = if first {
                    Demand::HandOver { reference, goal }
                } else {
                    Demand::Park
                };
                self.controller.step(dt, &demand, &measured)
            }
        };
        let report = answer.ok()?.report;
        let twist: Twist<f32> = report.command.cast();
        let rate: Accel<f32> = report.command_rate.cast();
        Some(Wanted {
            twist,
            accel: Some(rate),
        })
    }
}
