//! Stack bytes of a tick: painted, then looked at, less what an empty call leaves.

use core::hint::black_box;

use controller_core::maths::{Libm, Maths, Micromath, Single};
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::Params;
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Accel, Measured, Pose, Twist};
use firmware_demo::board::{high_water_mark, paint};

use crate::print::{complain, line};

/// The painter leaves this much below itself alone; what is measured goes deeper by it.
const MARGIN: usize = 1024;

/// Calls `work` deeper than the painter's margin and returns the mark.
#[inline(never)]
pub fn mark(mut work: impl FnMut()) -> u32 {
    paint();
    deeper(&mut work);
    high_water_mark()
}

#[inline(never)]
fn deeper(work: &mut dyn FnMut()) {
    let spacer = black_box([0_u8; MARGIN]);
    work();
    black_box(&spacer);
}

/// Prints the stack of a tick for each choice of types.
#[inline(never)]
pub fn measure() {
    tick::<f32, Single, RationalMean>("single+rational");
    tick::<f32, Single, ExactMean>("single+exact");
    tick::<f32, Libm, ExactMean>("libm+exact");
    tick::<f32, Micromath, RationalMean>("micromath+rational");
    tick::<f64, Libm, ExactMean>("f64-libm+exact");
}

#[inline(never)]
fn tick<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(name: &str) {
    let f = T::from_f64;
    let now = Measured {
        pose: Pose::new(f(0.1), f(0.2), f(0.3)),
        twist: Twist::new(f(0.1), f(0.2)),
    };
    let accel = Accel::default();
    let sample = Reference::new_with::<M>(Pose::default(), Twist::new(f(0.4), f(0.1)), accel);
    let Some(Ok(mut controller)) = Params::<T>::paper()
        .validate()
        .ok()
        .map(|params| NeuralController::<T, M, U>::start(&params, &sample, &now))
    else {
        return complain(&["stack", name], "start", 1);
    };
    let dt = black_box(f(1.0e-3));
    let empty = mark(|| ());
    let mut step = |demand: &Demand<T>| {
        mark(|| {
            black_box(controller.step(dt, demand, &now).is_ok());
        })
        .saturating_sub(empty)
    };
    let track = step(&Demand::Track(sample));
    let hand_over = step(&Demand::HandOver {
        reference: sample,
        goal: Pose::default(),
    });
    let park = step(&Demand::Park);
    line(&["stack", name, "track"]).number(track).print();
    line(&["stack", name, "park"]).number(park).print();
    line(&["stack", name, "hand-over"])
        .number(hand_over)
        .print();
}
