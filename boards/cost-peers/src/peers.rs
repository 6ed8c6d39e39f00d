//! Two filters each, one per wheel or axis: the least that a speed loop of a two-wheeled base needs.

use core::hint::black_box;

use dsp_process::SplitProcess;
use firmware_demo::board::{Meter, Spread, thousand_nops};
use idsp::iir::{Biquad, BiquadClamp, DirectForm1, DirectForm2Transposed};
use pid::Pid;

const COUNT: u32 = 1000;

/// Measures everything and prints.
pub fn run() {
    let mut meter = Meter::start();
    let mut nops = Spread::new();
    nops.add(meter.measure(thousand_nops).1);
    nops.print("thousand-nops");
    pids(&mut meter);
    biquads(&mut meter);
    crate::rivals::run(&mut meter);
}

#[inline(never)]
fn pids(meter: &mut Meter) {
    let mut first = Pid::<f32>::new(0.3, 100.0);
    first.p(10.0, 100.0).i(4.5, 100.0).d(0.25, 100.0);
    let mut pair = black_box([first, first]);
    let mut inputs = Inputs(1);
    let mut spread = Spread::new();
    let mut outputs = [0.0; 2];
    for _ in 0..COUNT {
        let measured = [inputs.real(), inputs.real()];
        let cost = meter
            .measure(|| {
                let [right, left] = &mut pair;
                outputs = [
                    right.next_control_output(measured[0]).output,
                    left.next_control_output(measured[1]).output,
                ];
            })
            .1;
        spread.add(cost);
        outputs = black_box(outputs);
    }
    spread.print("peer/pid-pair");
}

#[inline(never)]
fn biquads(meter: &mut Meter) {
    // A low pass; what it does is of no matter to what it costs.
    let plain = Biquad::<f32>::from([[0.02, 0.04, 0.02], [1.0, -1.56, 0.64]]);
    let mut clamped = BiquadClamp::<f32>::from(plain.clone());
    (clamped.min, clamped.max) = (-100.0, 100.0);
    let (plain, clamped) = (
        black_box([plain.clone(), plain]),
        black_box([clamped.clone(), clamped]),
    );
    count(
        meter,
        "peer/biquad-df2t-pair",
        &plain,
        [(); 2].map(|()| DirectForm2Transposed::default()),
    );
    count(
        meter,
        "peer/biquad-df1-pair",
        &plain,
        [(); 2].map(|()| DirectForm1::default()),
    );
    count(
        meter,
        "peer/biquad-df1-clamped-pair",
        &clamped,
        [(); 2].map(|()| DirectForm1::default()),
    );
}

#[inline(never)]
fn count<B: SplitProcess<f32, f32, S>, S>(
    meter: &mut Meter,
    name: &str,
    filters: &[B; 2],
    states: [S; 2],
) {
    let mut states = black_box(states);
    let mut inputs = Inputs(2);
    let mut spread = Spread::new();
    let mut outputs = [0.0; 2];
    for _ in 0..COUNT {
        let measured = [inputs.real(), inputs.real()];
        let cost = meter
            .measure(|| {
                let ([right, left], [of_right, of_left]) = (filters, &mut states);
                outputs = [
                    right.process(of_right, measured[0]),
                    left.process(of_left, measured[1]),
                ];
            })
            .1;
        spread.add(cost);
        outputs = black_box(outputs);
    }
    spread.print(name);
}

/// Reproducible inputs in [−2, 2).
pub struct Inputs(u32);

impl Inputs {
    pub const fn new(seed: u32) -> Self {
        Self(seed)
    }

    pub fn real(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 as i32 >> 8) as f32 * (2.0 / 8_388_608.0)
    }
}
