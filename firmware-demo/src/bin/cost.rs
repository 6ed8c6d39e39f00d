//! Counts executed instructions and stack bytes on an emulated board, and prints lines `name min mean max`.
//!
//! Names are paths, for `tests/budgets` to read: `tick/single+rational/track/ordinary 278 278.00 278`. Lines
//! `stack/…` are bytes. A line that begins with `!` says that something measured is not what it claims to be.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(run);

#[cfg(target_os = "none")]
#[path = "cost/base.rs"]
mod base;

#[cfg(target_os = "none")]
#[path = "cost/call.rs"]
mod call;

#[cfg(target_os = "none")]
#[path = "cost/parts.rs"]
mod parts;

#[cfg(target_os = "none")]
#[path = "cost/inputs.rs"]
mod inputs;

#[cfg(target_os = "none")]
#[path = "cost/kinds.rs"]
mod kinds;

#[cfg(target_os = "none")]
#[path = "cost/print.rs"]
mod print;

#[cfg(all(target_os = "none", feature = "robots"))]
#[path = "cost/shipped.rs"]
mod shipped;

#[cfg(target_os = "none")]
#[path = "cost/stack.rs"]
mod stack;

#[cfg(target_os = "none")]
#[path = "cost/tick.rs"]
mod tick;

#[cfg(target_os = "none")]
#[path = "cost/wheels.rs"]
mod wheels;

#[cfg(target_os = "none")]
#[path = "cost/wire.rs"]
mod wire;

#[cfg(target_os = "none")]
fn run() {
    use controller_core::maths::{Libm, Micromath, Single};
    use controller_core::shunting::{ExactMean, RationalMean};
    use firmware_demo::board::{Meter, thousand_nops};
    use print::Row;

    let mut meter = Meter::start();
    let mut nops = Row::new();
    nops.add(meter.measure(thousand_nops).1);
    nops.print(&["thousand-nops"]);
    stack::measure();

    let mut bench = tick::Bench::new(meter);
    tick::neural::<f32, Single, RationalMean>(&mut bench, "single+rational");
    tick::neural::<f32, Single, ExactMean>(&mut bench, "single+exact");
    tick::neural::<f32, Libm, ExactMean>(&mut bench, "libm+exact");
    tick::neural::<f32, Micromath, RationalMean>(&mut bench, "micromath+rational");
    tick::neural::<f64, Libm, ExactMean>(&mut bench, "f64-libm+exact");
    tick::plain(&mut bench);

    let meter = bench.meter();
    parts::maths::<Single>(meter, "single");
    parts::maths::<Libm>(meter, "libm");
    parts::maths::<Micromath>(meter, "micromath");
    parts::angle(meter);
    parts::neuron::<RationalMean>(meter, "rational");
    parts::neuron::<ExactMean>(meter, "exact");
    parts::reference(meter);
    wheels::odometry(meter);
    wheels::localiser(meter);
    wheels::motor(meter);

    base::motion(meter);
    base::searches(meter);
    base::lead(meter);
    base::ticks(meter);
    base::bytes();
    #[cfg(feature = "robots")]
    shipped::ticks(meter);

    wire::measure(meter);
}

#[cfg(all(not(target_os = "none"), feature = "host"))]
#[path = "cost/host.rs"]
mod host;

#[cfg(all(not(target_os = "none"), feature = "host"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    print!("{}", host::run(&arguments)?);
    Ok(())
}

#[cfg(all(not(target_os = "none"), not(feature = "host")))]
fn main() {
    println!("This program runs on an emulated board; build it with");
    println!(
        "  cargo build -p firmware-demo --profile chip --target thumbv7em-none-eabihf --bin cost"
    );
    println!("and let its other half run it, which needs the feature `host`:");
    println!("  cargo run -p firmware-demo --features host --bin cost -- arm cost IMAGE");
    println!(
        "For RISC-V: riscv32imafc-unknown-none-elf and `riscv`; `pil` instead of `cost` closes"
    );
    println!("the loop with that image. `cargo test -p tests --test chip budgets` does all that.");
}
