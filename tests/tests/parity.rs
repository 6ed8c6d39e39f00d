//! The emulated chips against this process: zero bits differ.
//!
//! One harness ([`compare`]) for the paper's law under control of the host, over both links: [`scenarios`] closed over the host's
//! plant, and random [`missions`] with ticks that are refused. [`images`] run by themselves and print a checksum. All need the
//! emulator, and fail with what to install where it is missing.

mod images;
mod missions;
mod scenarios;

use std::time::Duration;

use firmware_demo::host::{Chip, LinkKind, Machine, Options};
use sim_host::pil::{Bench, Cost, Parity};
use sim_host::scenario::Scenario;

const MACHINES: [Machine; 2] = [Machine::CortexM4F, Machine::Riscv32];
/// Longest silence: only a firmware that hangs gets there. The longest program takes 5 s by itself, and 22 s with three builds
/// beside it on two cores.
const LIMIT: Duration = Duration::from_secs(120);

/// What runs on both sides.
enum Work<'a> {
    /// Scenarios, one after another.
    Scenarios(&'a [Scenario]),
    /// Random missions of so many ticks together.
    Missions(u32),
}

/// What came of it.
#[derive(Default)]
struct Compared {
    parity: Parity,
    cost: Cost,
    saturated: usize,
}

/// Runs `work` on a chip and here. Instructions are counted if they are to be, which is slower.
fn compare(machine: Machine, link: LinkKind, counts: bool, work: &Work<'_>) -> Compared {
    let compared = match work {
        Work::Scenarios(scenarios) => {
            // The message of a missing emulator or target says what to install.
            let bench = Bench::start(machine, link, counts);
            let mut bench =
                bench.unwrap_or_else(|error| panic!("{machine:?} is not ready: {error}"));
            let compared = scenarios::fly(&mut bench, scenarios);
            assert_eq!(bench.frames_rejected().expect("answers"), 0);
            bench.finish().expect("ends in order");
            compared
        }
        Work::Missions(ticks) => {
            let mut chip = start(machine, link, counts);
            let compared = missions::fly(&mut chip, *ticks);
            let counters = chip.counters().expect("answers");
            assert_eq!(counters.frames_rejected, 0);
            assert!((512..4096).contains(&counters.stack_bytes), "{counters:?}");
            assert_eq!(chip.finish().expect("ends in order").code, Some(0));
            compared
        }
    };
    let Parity { first, .. } = compared.parity;
    assert!(
        compared.parity.is_exact(),
        "{machine:?} {link:?}: {first:?}"
    );
    assert_eq!(compared.parity.bits_apart, 0);
    compared
}

/// A chip that is asked tick by tick.
fn start(machine: Machine, link: LinkKind, icount: bool) -> Chip {
    let options = Options {
        machine,
        link,
        icount,
        core: None,
        silence: LIMIT,
    };
    Chip::start(&options).unwrap_or_else(|error| panic!("{machine:?} is not ready: {error}"))
}
