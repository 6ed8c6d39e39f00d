//! Counts executed instructions on an emulated board and prints lines `name min mean max`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
fn run() {
    chip::run();
}

#[cfg(target_os = "none")]
mod chip {
    use core::hint::black_box;

    use firmware_demo::board::print::Line;
    use firmware_demo::board::{Meter, Spread, high_water_mark, thousand_nops};
    use firmware_demo::pil::stand_in;
    use firmware_demo::protocol::{
        Command, Decoder, MAX_CONTENT, MAX_FRAME, Measure, Report, Telemetry, WirePose, WireTwist,
        encode,
    };
    use firmware_demo::queue::Receiver;
    use firmware_demo::telemetry::Outbox;
    use heapless::spsc::Queue;

    const INPUTS: u32 = 1000;

    /// Measures everything and prints.
    pub fn run() {
        let mut meter = Meter::start();
        let mut nops = Spread::new();
        nops.add(meter.measure(thousand_nops).1);
        nops.print("thousand-nops");
        tick(&mut meter);
        wire(&mut meter);
        queue(&mut meter);
        Line::new()
            .text("stack-bytes")
            .number(high_water_mark())
            .print();
    }

    fn tick(meter: &mut Meter) {
        let mut inputs = Inputs(1);
        let mut report = Report::default();
        let mut spread = Spread::new();
        for _ in 0..INPUTS {
            let measure = inputs.measure();
            spread.add(meter.measure(|| stand_in(&measure, &mut report)).1);
        }
        spread.print("tick");
    }

    /// A question in, an answer out: what the link costs beside the tick.
    fn wire(meter: &mut Meter) {
        let mut inputs = Inputs(2);
        let mut decoder = Decoder::<Command, MAX_CONTENT>::new();
        let (mut decode, mut write) = (Spread::new(), Spread::new());
        for _ in 0..INPUTS {
            let measure = inputs.measure();
            let mut frame = [0; MAX_FRAME];
            let Ok(question) = encode(7, &Command::Measure(measure), &mut frame) else {
                return;
            };
            let mut good = 0_u32;
            decode.add(
                meter
                    .measure(|| {
                        for &byte in question {
                            if let Some(Ok(_)) = decoder.push(byte) {
                                good = good.wrapping_add(1);
                            }
                        }
                    })
                    .1,
            );
            if good != 1 {
                Line::new().text("decode-failed").print();
            }
            let mut report = Report::default();
            stand_in(&measure, &mut report);
            let answer = Telemetry::Report(report);
            let mut frame = [0; MAX_FRAME];
            write.add(meter.measure(|| encode(7, &answer, &mut frame).is_ok()).1);
        }
        decode.print("decode-measure");
        write.print("encode-report");
    }

    fn queue(meter: &mut Meter) {
        let mut queue = Queue::<Report, 8>::new();
        let (outbox, inbox) = Outbox::split(&mut queue, 2);
        // As in a board's statics, where the optimiser does not see the queue behind the handles.
        let (mut outbox, mut inbox) = (black_box(outbox), black_box(inbox));
        let report = Report::default();
        let mut spread = Spread::new();
        for _ in 0..INPUTS {
            spread.add(meter.measure(|| outbox.offer(|| report)).1);
            drain(&mut inbox);
        }
        spread.print("telemetry-offer");
    }

    #[inline(never)]
    fn drain(inbox: &mut Receiver<'_, Report, 8>) {
        while inbox.receive().is_some() {}
    }

    /// Reproducible inputs (xorshift32).
    struct Inputs(u32);

    impl Inputs {
        fn measure(&mut self) -> Measure {
            Measure {
                tick: self.bits(),
                dt: 0.001,
                pose: WirePose {
                    x: self.real(),
                    y: self.real(),
                    theta: self.real(),
                },
                twist: WireTwist {
                    v: self.real(),
                    w: self.real(),
                },
            }
        }

        fn bits(&mut self) -> u32 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 17;
            self.0 ^= self.0 << 5;
            self.0
        }

        /// In [-2, 2).
        fn real(&mut self) -> f32 {
            (self.bits() as i32) as f32 * (2.0 / 2_147_483_648.0)
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; build it with");
    println!("  cargo build -p firmware-demo --release --target thumbv7em-none-eabihf --bin cost");
    println!("and run it with");
    println!("  qemu-system-arm -M mps2-an386 -icount shift=10 -display none -monitor none \\");
    println!("    -serial none -semihosting-config enable=on,target=native -kernel IMAGE");
    println!("For RISC-V: riscv32imafc-unknown-none-elf, qemu-system-riscv32 -M virt -bios none,");
    println!("-icount shift=0.");
}
