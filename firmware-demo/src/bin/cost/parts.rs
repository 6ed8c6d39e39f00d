//! What a tick of the law is made of, and what stands beside it.

use core::hint::black_box;

use controller_core::angle::wrap;
use controller_core::maths::{Maths, Single};
use controller_core::queue::{TimedReference, interpolate};
use controller_core::reference::Reference;
use controller_core::shunting::NeuronParams;
use controller_core::shunting::{NeuronUpdate, Shunting};
use controller_core::types::{Accel, Pose, Twist};
use firmware_demo::board::Meter;

use crate::inputs::Inputs;
use crate::print::{Row, complain};

const COUNT: u32 = 1000;

/// One function of one argument in [−scale, scale), moved by `offset`.
fn function<R>(
    meter: &mut Meter,
    name: &[&str],
    (scale, offset): (f32, f32),
    call: impl Fn(f32) -> R,
) {
    let mut inputs = Inputs::new(3);
    let mut row = Row::new();
    for _ in 0..COUNT {
        let x = offset + inputs.real::<f32>(scale);
        row.add(meter.measure(|| call(x)).1);
    }
    row.print(name);
}

/// The functions of a back end, inlined as the tick has them.
#[inline(never)]
pub fn maths<M: Maths<f32>>(meter: &mut Meter, name: &str) {
    let path = |function| ["maths", name, function];
    function(meter, &path("sin_cos"), (3.0, 0.0), M::sin_cos);
    function(meter, &path("sin_cos_near"), (3.0, 0.0), M::sin_cos_near);
    function(
        meter,
        &path("sin_cos-beyond-1e4"),
        (1.0e5, 2.0e5),
        M::sin_cos,
    );
    function(meter, &path("asin"), (1.0, 0.0), M::asin);
    function(meter, &path("atan2"), (3.0, 0.0), |y| M::atan2(y, 0.7));
    function(meter, &path("sqrt"), (3.0, 3.1), M::sqrt);
    function(meter, &path("exp_m1"), (1.0, -1.1), M::exp_m1);
}

/// The wrap inside (−π, π], within a few turns, and far away.
#[inline(never)]
pub fn angle(meter: &mut Meter) {
    function(meter, &["wrap", "inside"], (3.0, 0.0), wrap);
    function(meter, &["wrap", "one-turn-off"], (3.0, 6.3), wrap);
    function(meter, &["wrap", "beyond-1e4"], (1.0e5, 2.0e5), wrap);
}

/// One neuron over one tick, without the checks of a neuron on its own.
#[inline(never)]
pub fn neuron<U: NeuronUpdate<f32>>(meter: &mut Meter, name: &str) {
    let coefficients = NeuronParams {
        a: 4.0,
        b: 4.0,
        d: 4.0,
    };
    let Ok(shunting) = Shunting::new(&coefficients) else {
        return complain(&["neuron", name], "params", 1);
    };
    let mut inputs = Inputs::new(4);
    let (mut state, mut before) = (0.0, 0.0);
    let dt = black_box(1.0e-3);
    let mut row = Row::new();
    for _ in 0..COUNT {
        let now = inputs.real::<f32>(5.0);
        let cost = meter
            .measure(|| state = shunting.step::<U, Single>(state, (before, now), dt))
            .1;
        row.add(cost);
        before = now;
    }
    row.print(&["neuron", name]);
}

fn sample(inputs: &mut Inputs) -> (Pose<f32>, Twist<f32>, Accel<f32>) {
    (
        Pose::new(inputs.real(2.0), inputs.real(2.0), inputs.real(1.5)),
        Twist::new(inputs.real(1.0), inputs.real(1.0)),
        Accel::new(inputs.real(1.0), inputs.real(1.0)),
    )
}

/// A reference made from numbers, and one interpolated from the queue.
#[inline(never)]
pub fn reference(meter: &mut Meter) {
    let mut inputs = Inputs::new(5);
    let mut new = Row::new();
    let mut made = None;
    for _ in 0..COUNT {
        let (pose, twist, accel) = sample(&mut inputs);
        let cost = meter
            .measure(|| made = Some(Reference::new(pose, twist, accel)))
            .1;
        new.add(cost);
        made = black_box(made);
    }
    new.print(&["reference", "new"]);

    let mut row = Row::new();
    for _ in 0..COUNT {
        let mut timed = |t| {
            let (pose, twist, accel) = sample(&mut inputs);
            let reference = Reference::new(pose, twist, accel);
            TimedReference { t, reference }
        };
        let (from, to) = (timed(1.0), timed(1.02));
        let t = 1.0 + (0.01 + inputs.real::<f32>(0.01));
        let cost = meter
            .measure(|| made = Some(interpolate::<f32, Single>(&from, &to, t)))
            .1;
        row.add(cost);
        made = black_box(made);
    }
    row.print(&["reference", "interpolate"]);
    #[cfg(not(feature = "panic-proof"))]
    queue(meter);
}

/// The same through the queue. The handles of heapless divide by a length that the compiler does not know, so that a
/// panic is reachable as far as the linker can tell: not in a proven image.
#[cfg(not(feature = "panic-proof"))]
#[inline(never)]
fn queue(meter: &mut Meter) {
    use controller_core::queue::ReferenceQueue;

    let mut inputs = Inputs::new(8);
    let mut queue = ReferenceQueue::<f32, 8>::new();
    let (producer, consumer) = queue.split();
    let (mut producer, mut consumer) = (black_box(producer), black_box(consumer));
    let (mut within, mut next) = (Row::new(), Row::new());
    let mut faults = 0_u32;
    let mut made = None;
    // Samples every 20 ms, asked for every 5 ms: three of four calls stay within a span.
    let mut pushed = 0_u32;
    for tick in 1..COUNT {
        let t = black_box(tick as f32 * 5.0e-3);
        while pushed as f32 * 20.0e-3 < t + 40.0e-3 {
            let (pose, twist, accel) = sample(&mut inputs);
            let reference = Reference::new(pose, twist, accel);
            let t = pushed as f32 * 20.0e-3;
            faults += u32::from(producer.push(TimedReference { t, reference }).is_err());
            pushed += 1;
        }
        let waiting = consumer.waiting();
        let cost = meter.measure(|| made = consumer.at::<Single>(t).ok()).1;
        faults += u32::from(made.is_none());
        made = black_box(made);
        if consumer.waiting() == waiting {
            within.add(cost);
        } else {
            next.add(cost);
        }
    }
    within.print(&["reference", "queue-within-span"]);
    next.print(&["reference", "queue-next-span"]);
    complain(&["reference"], "faults", faults);
}
