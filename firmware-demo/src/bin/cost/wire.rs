//! What the link and the telemetry queue cost beside the tick.

use core::hint::black_box;

use controller_core::paper::demand::Demand;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Measured, Pose, Twist};
use firmware_demo::board::Meter;
use firmware_demo::queue::Receiver;
use firmware_demo::telemetry::TelemetryQueue;
use heapless::spsc::Queue;
use protocol::pil::{Answer, Question, Report};
use protocol::{Decoder, MAX_CONTENT, MAX_FRAME, encode};

use crate::inputs::Inputs;
use crate::print::{Row, complain};

const COUNT: u32 = 1000;

/// Measures everything and prints.
#[inline(never)]
pub fn measure(meter: &mut Meter) {
    frames(meter);
    queue(meter);
}

/// A question in, an answer out.
#[inline(never)]
fn frames(meter: &mut Meter) {
    let mut inputs = Inputs::new(2);
    let mut decoder = Decoder::<Question, MAX_CONTENT>::new();
    let (mut decode, mut write) = (Row::new(), Row::new());
    let mut lost = 0_u32;
    for _ in 0..COUNT {
        let question = question(&mut inputs);
        let mut frame = [0; MAX_FRAME];
        let Ok(bytes) = encode(7, &question, &mut frame) else {
            lost += 1;
            continue;
        };
        let mut good = 0_u32;
        let cost = meter
            .measure(|| {
                for &byte in bytes {
                    if let Some(Ok(_)) = decoder.push(byte) {
                        good = good.wrapping_add(1);
                    }
                }
            })
            .1;
        decode.add(cost);
        lost += u32::from(good != 1);
        let answer = Answer::Report(Report {
            tick: inputs.bits(),
            e_x: inputs.real(1.0),
            e_y: inputs.real(1.0),
            e_theta: inputs.real(1.0),
            ..Report::default()
        });
        let mut frame = [0; MAX_FRAME];
        write.add(meter.measure(|| encode(7, &answer, &mut frame).is_ok()).1);
    }
    decode.print(&["wire", "decode-tick"]);
    write.print(&["wire", "encode-report"]);
    complain(&["wire"], "lost", lost);
}

fn question(inputs: &mut Inputs) -> Question {
    let mut pose = || Pose::new(inputs.real(2.0), inputs.real(2.0), inputs.real(2.0));
    let (at, measured) = (pose(), pose());
    let mut twist = || Twist::new(inputs.real(1.0), inputs.real(1.0));
    let (reference, twist) = (twist(), twist());
    let demand = Demand::Track(Reference::new(at, reference, Accel::default()));
    Question::Tick {
        dt: 0.001,
        demand: (&demand).into(),
        measured: (&Measured {
            pose: measured,
            twist,
        })
            .into(),
    }
}

#[inline(never)]
fn queue(meter: &mut Meter) {
    let mut queue = Queue::<Report, 8>::new();
    let (telemetry, inbox) = TelemetryQueue::split(&mut queue, 2);
    // As in a board's statics, where the optimiser does not see the queue behind the handles.
    let (mut telemetry, mut inbox) = (black_box(telemetry), black_box(inbox));
    let report = Report::default();
    let mut row = Row::new();
    for _ in 0..COUNT {
        row.add(meter.measure(|| telemetry.offer(|| report)).1);
        drain(&mut inbox);
    }
    row.print(&["wire", "telemetry-offer"]);
}

#[inline(never)]
fn drain(inbox: &mut Receiver<'_, Report, 8>) {
    while inbox.receive().is_some() {}
}
