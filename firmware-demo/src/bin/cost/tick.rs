//! A whole tick of each controller: error, neurons, law with analytic rates, torque, wheel map, limit, finite
//! check and report.

use core::hint::black_box;

use controller_core::maths::{Maths, Single};
use controller_core::paper::demand::Demand;
use controller_core::paper::lyapunov::{neuron_energy, pose_energy, velocity_energy};
use controller_core::paper::neural::NeuralController;
use controller_core::paper::params::ValidParams;
use controller_core::paper::plain::PlainController;
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::NeuronUpdate;
use controller_core::types::{Accel, Measured, Pose, Twist};
use firmware_demo::board::Meter;

use crate::call;
use crate::inputs::Inputs;
use crate::kinds::{KINDS, Kind, measured, params, reference};
use crate::print::{Row, complain};

/// Inputs per row.
const COUNT: u32 = 1000;
/// The control period \[s\].
const DT: f32 = 1.0e-3;

/// The meter, and what the harness executes around a tick.
pub struct Bench {
    meter: Meter,
    call: u32,
}

impl Bench {
    /// Measures the harness.
    #[inline(never)]
    pub fn new(mut meter: Meter) -> Self {
        let [kind, ..] = &KINDS;
        let mut inputs = Inputs::new(1);
        let (pose, twist, accel) = reference(&mut inputs);
        let now = measured(&mut inputs, &pose, kind);
        let sample = Reference::new(pose, twist, accel);
        let call = params(kind)
            .and_then(|params| NeuralController::start(&params, &sample, &now).ok())
            .map_or(0, |mut controller| {
                call::overhead(
                    &mut meter,
                    &mut controller,
                    DT,
                    &Demand::Track(sample),
                    &now,
                )
            });
        complain(&["call"], "not-measured", u32::from(call == 0));
        Self { meter, call }
    }

    /// For whatever is not a tick.
    pub fn meter(&mut self) -> &mut Meter {
        &mut self.meter
    }
}

/// What went on in a row beside the cost.
#[derive(Default)]
struct Seen {
    faults: u32,
    limited: u32,
}

impl Seen {
    fn check(&self, kind: &Kind, name: &[&str]) {
        complain(name, "faults", self.faults);
        match kind.limited {
            Some(true) => complain(name, "unlimited", COUNT.saturating_sub(self.limited)),
            Some(false) => complain(name, "limited", self.limited),
            None => (),
        }
    }
}

/// One tick, called as firmware calls it. On its own, so that the compiler moves nothing of the harness into the
/// region between the two readings; whether the tick is accepted is asked of a copy beforehand.
#[inline(never)]
fn cost<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    bench: &mut Bench,
    controller: &mut NeuralController<T, M, U>,
    dt: T,
    demand: &Demand<T>,
    now: &Measured<T>,
) -> u32 {
    bench
        .meter
        .measure(move || {
            let _ = controller.step(dt, demand, now);
        })
        .1
        .saturating_sub(bench.call)
}

/// [`cost`] and the making of the reference, as when it comes as numbers.
#[inline(never)]
fn cost_with_reference<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    bench: &mut Bench,
    controller: &mut NeuralController<T, M, U>,
    dt: T,
    (pose, twist, accel): &(Pose<T>, Twist<T>, Accel<T>),
    now: &Measured<T>,
) -> u32 {
    bench
        .meter
        .measure(move || {
            let demand = Demand::Track(Reference::new_with::<M>(*pose, *twist, *accel));
            let _ = controller.step(dt, &demand, now);
        })
        .1
        .saturating_sub(bench.call)
}

/// Whether a tick would be accepted.
#[inline(never)]
fn accepts<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    controller: &NeuralController<T, M, U>,
    dt: T,
    demand: &Demand<T>,
    now: &Measured<T>,
) -> bool {
    let mut copy = *controller;
    copy.step(dt, demand, now).is_ok()
}

/// Ticks in both phases, the one-off ticks, and what a monitor adds, for one choice of types.
#[inline(never)]
pub fn neural<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(bench: &mut Bench, name: &str) {
    for kind in &KINDS {
        let Some(params) = params::<T>(kind) else {
            complain(&["tick", name], "params", 1);
            return;
        };
        phases::<T, M, U>(bench, name, kind, &params);
    }
}

#[inline(never)]
fn phases<T: Scalar, M: Maths<T>, U: NeuronUpdate<T>>(
    bench: &mut Bench,
    name: &str,
    kind: &Kind,
    params: &ValidParams<T>,
) {
    let mut inputs = Inputs::new(1);
    let dt = black_box(T::from_f64(f64::from(DT)));
    let (mut start, mut hand_over, mut monitor) = (Row::new(), Row::new(), Row::new());
    let (mut track, mut track_all, mut park) = (Row::new(), Row::new(), Row::new());
    let mut seen_track = Seen::default();
    let mut seen_park = Seen::default();
    // Ten runs, so that the one-off ticks are met ten times.
    for _ in 0..10 {
        let (pose, twist, accel) = reference(&mut inputs);
        let sample = Reference::new_with::<M>(pose, twist, accel);
        let now = measured(&mut inputs, &pose, kind);
        let mut slot = None;
        start.add(
            bench
                .meter
                .measure(|| slot = NeuralController::<T, M, U>::start(params, &sample, &now).ok())
                .1,
        );
        let Some(mut controller) = slot else {
            seen_track.faults += 1;
            continue;
        };
        for turn in 0..COUNT / 5 {
            let (pose, twist, accel) = reference(&mut inputs);
            let now = measured(&mut inputs, &pose, kind);
            let demand = Demand::Track(Reference::new_with::<M>(pose, twist, accel));
            seen_track.faults += u32::from(!accepts(&controller, dt, &demand, &now));
            if turn % 2 == 0 {
                track.add(cost(bench, &mut controller, dt, &demand, &now));
                seen_track.limited += u32::from(controller.report().saturated);
            } else {
                // The same with the heading's sine and cosine worked out within.
                let numbers = (pose, twist, accel);
                track_all.add(cost_with_reference(
                    bench,
                    &mut controller,
                    dt,
                    &numbers,
                    &now,
                ));
            }
            let (report, state) = (*controller.report(), controller.state());
            let gains = &params.params().tracking;
            let robot = &params.params().robot;
            let energy = || {
                pose_energy::<T, M>(gains, &report.error)
                    + velocity_energy(robot, &report.velocity_error)
                    + neuron_energy(&state)
            };
            monitor.add(bench.meter.measure(energy).1);
        }
        let (pose, twist, accel) = reference(&mut inputs);
        let now = measured(&mut inputs, &pose, kind);
        let goal = pose;
        let demand = Demand::HandOver {
            reference: Reference::new_with::<M>(pose, twist, accel),
            goal,
        };
        seen_park.faults += u32::from(!accepts(&controller, dt, &demand, &now));
        hand_over.add(cost(bench, &mut controller, dt, &demand, &now));
        for _ in 0..COUNT / 10 {
            // The goal stays, so the robot is drawn around it; its heading is drawn anew.
            let now = measured(&mut inputs, &goal, kind);
            seen_park.faults += u32::from(!accepts(&controller, dt, &Demand::Park, &now));
            park.add(cost(bench, &mut controller, dt, &Demand::Park, &now));
            seen_park.limited += u32::from(controller.report().saturated);
        }
    }
    let row = |part| ["tick", name, part, kind.name];
    track.print(&row("track"));
    track_all.print(&row("track-with-reference"));
    park.print(&row("park"));
    start.print(&row("start"));
    hand_over.print(&row("hand-over"));
    monitor.print(&row("monitor"));
    seen_track.check(kind, &row("track"));
    seen_park.check(kind, &row("park"));
}

#[inline(never)]
fn plain_cost(
    bench: &mut Bench,
    controller: &mut PlainController<f32, Single>,
    dt: f32,
    demand: &Demand<f32>,
    now: &Measured<f32>,
) -> u32 {
    bench
        .meter
        .measure(move || {
            let _ = controller.step(dt, demand, now);
        })
        .1
        .saturating_sub(bench.call)
}

/// Plain backstepping, Eqs. (10)-(14): what the neurons cost is the difference.
#[inline(never)]
pub fn plain(bench: &mut Bench) {
    let [kind, ..] = &KINDS;
    let mut inputs = Inputs::new(1);
    let mut faults = 0_u32;
    let dt = black_box(DT);
    let (mut track, mut park) = (Row::new(), Row::new());
    let (pose, twist, accel) = reference(&mut inputs);
    let now = measured(&mut inputs, &pose, kind);
    let sample = Reference::new(pose, twist, accel);
    let Some(Ok(mut controller)) =
        params::<f32>(kind).map(|p| PlainController::<f32, Single>::start(&p, &sample, &now))
    else {
        complain(&["plain"], "start", 1);
        return;
    };
    for _ in 0..COUNT {
        let (pose, twist, accel) = reference(&mut inputs);
        let now = measured(&mut inputs, &pose, kind);
        let demand = Demand::Track(Reference::new(pose, twist, accel));
        let mut copy = controller;
        faults += u32::from(copy.step(dt, &demand, &now).is_err());
        track.add(plain_cost(bench, &mut controller, dt, &demand, &now));
    }
    let (pose, twist, accel) = reference(&mut inputs);
    let demand = Demand::HandOver {
        reference: Reference::new(pose, twist, accel),
        goal: pose,
    };
    faults += u32::from(controller.step(dt, &demand, &now).is_err());
    for _ in 0..COUNT {
        let now = measured(&mut inputs, &pose, kind);
        let mut copy = controller;
        faults += u32::from(copy.step(dt, &Demand::Park, &now).is_err());
        park.add(plain_cost(bench, &mut controller, dt, &Demand::Park, &now));
    }
    track.print(&["tick", "plain-single", "track", kind.name]);
    park.print(&["tick", "plain-single", "park", kind.name]);
    complain(&["plain"], "faults", faults);
}
