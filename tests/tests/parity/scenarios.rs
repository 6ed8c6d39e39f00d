//! Both paper cases and ten seeded scenarios, closed over the host's plant with the chip's torques.

use super::{Compared, MACHINES, Work, compare};
use firmware_demo::host::{LinkKind, Machine};
use sim_host::pil::Bench;
use sim_host::scenario::{BuiltIn, PAPER, Scenario};
use tests::random::Random;
use tests::stated::{At, Stated};

const SEEDS: std::ops::Range<u64> = 0..10;
/// 20 s, the length of both paper cases as well: 12 runs are 240,000 ticks.
const FULL: u32 = 20_000;
/// 12 runs are 21,600 ticks, each with its hand-over.
const SHORT: u32 = 1_800;
/// Two runs of 300 ticks and their starts.
const SERIAL_TICKS: u64 = 602;

/// A scenario of `ticks` ms from a seed: start, reference (every other one a sinusoid), hand-over
/// time, gains with kc apart from kd, neurons, reset rule and torque limit are all drawn.
fn seeded(seed: u64, ticks: u32) -> Scenario {
    let mut random = Random(0x5EED_0B17 + 1000 * seed);
    let mut draw = |low: f64, high: f64| 0.5 * (low + high) + random.within(0.5 * (high - low));
    let duration = f64::from(ticks) * 1.0e-3;
    let reference = if seed.is_multiple_of(2) {
        format!(
            "v = {{ v0 = {}, v1 = {}, Ov = {}, pv = {} }}\nw = {{ w0 = {}, w1 = {}, Ow = {} }}",
            draw(0.2, 0.7),
            draw(-0.2, 0.2),
            draw(0.1, 2.0),
            draw(-3.0, 3.0),
            draw(-0.2, 0.2),
            draw(-0.3, 0.3),
            draw(0.1, 1.5),
        )
    } else {
        format!("v = {}\nw = {}", draw(0.1, 0.8), draw(-0.4, 0.4))
    };
    let reset = match seed % 3 {
        0 => "torque-continuous",
        1 => "printed",
        _ => "zero",
    };
    // A third without a limit, a third that saturates at times, a third that saturates often.
    let limit = match seed % 3 {
        0 => String::new(),
        1 => format!("max_wheel_torque = {}\n", draw(1.0, 2.0)),
        _ => format!("max_wheel_torque = {}\n", draw(0.2, 0.5)),
    };
    let hand_over = draw(0.3, 0.8) * duration;
    let text = format!(
        "description = \"seed {seed}\"
[run]
duration = {duration}
period = 0.001
[gains]
k1 = {}\nk2 = {}\nk3 = {}\nk4 = {}\nk5 = {}
kd1 = {}\nkd2 = {}\nkc1 = {}\nkc2 = {}
A = {}\nB = {}\nD = {}
[robot]
m = {}\nI = {}\nr_right = {}\nr_left = {}\n{limit}
[start]
x = {}\ny = {}\ntheta = {}\nv = {}\nw = {}
[reference]
start = {{ x = {}, y = {}, theta = {} }}
{reference}
[hand_over]
time = {hand_over}
target_at = {}
reset = \"{reset}\"
",
        draw(0.5, 1.5),
        draw(2.0, 8.0),
        draw(1.0, 3.0),
        draw(0.8, 1.6),
        draw(0.8, 1.6),
        draw(60.0, 120.0),
        draw(50.0, 100.0),
        draw(60.0, 200.0),
        draw(50.0, 160.0),
        draw(3.0, 6.0),
        draw(1.0, 5.0),
        draw(1.0, 5.0),
        draw(10.0, 40.0),
        draw(5.0, 20.0),
        draw(0.09, 0.11),
        draw(0.09, 0.11),
        draw(-1.0, 1.0),
        draw(-1.0, 1.0),
        draw(-3.0, 3.0),
        draw(-0.3, 0.3),
        draw(-0.3, 0.3),
        draw(-0.5, 0.5),
        draw(-0.5, 0.5),
        draw(-3.0, 3.0),
        hand_over + draw(0.2, 1.0),
    );
    Scenario::parse(&format!("seed-{seed}.toml"), &text).expect("in order")
}

/// Both paper cases, with the hand-over moved into the run if that is shorter, and all seeds.
fn scenarios(ticks: u32) -> Vec<Scenario> {
    let paper = PAPER.map(|name| {
        let mut scenario = BuiltIn::find(name)
            .expect("built in")
            .scenario()
            .expect("in order");
        let duration_s = f64::from(ticks) * scenario.period_s;
        if duration_s < scenario.duration_s {
            let plan = scenario.hand_over.as_mut().expect("a hand-over");
            plan.hand_over_s = 0.6 * duration_s;
        }
        scenario.duration_s = duration_s;
        scenario
    });
    paper
        .into_iter()
        .chain(SEEDS.map(|seed| seeded(seed, ticks)))
        .collect()
}

/// Flies all of them.
pub(super) fn fly(bench: &mut Bench, scenarios: &[Scenario]) -> Compared {
    let mut flown = Compared::default();
    for scenario in scenarios {
        let name = &scenario.name;
        let flight = bench.fly(scenario);
        let flight = flight.unwrap_or_else(|error| panic!("{name}: {error}"));
        let rate = flight.parity.ticks as f64 / flight.elapsed.as_secs_f64();
        println!("{:?} {name}: {rate:.0} ticks/s", bench.machine());
        assert!(flight.parity.is_exact(), "{name}: {:?}", flight.parity);
        let saturated = flight
            .trace
            .rows
            .iter()
            .filter(|row| row.report.limited.torque);
        flown.saturated += saturated.count();
        flown.parity.merge(&flight.parity);
        flown.cost.merge(&flight.cost);
    }
    flown
}

/// Every part of the controller was at work: both laws, hand-overs, limits.
fn covers_everything(flown: &Compared, runs: u64) {
    assert_eq!(flown.cost.start.ticks, runs);
    assert_eq!(flown.cost.hand_over.ticks, runs);
    let fifth = flown.parity.ticks / 5;
    assert!(flown.cost.tracking.ticks > fifth && flown.cost.parking.ticks > fifth);
    assert!(flown.saturated > 50, "{}", flown.saturated);
}

/// The ticks that docs/chip.md states: these and those over the serial port.
fn state(column: &str, flown: &Compared) {
    let label = "ticks compared with the host, bits different";
    let ticks = flown.parity.ticks + SERIAL_TICKS;
    Stated::of("docs/chip.md").exactly(At::Cell("On a chip", label, column), &[ticks as f64]);
}

#[test]
fn cortex_m4f_computes_the_same_bits_in_200_000_ticks() {
    let flown = compare(
        Machine::CortexM4F,
        LinkKind::Fifo,
        false,
        &Work::Scenarios(&scenarios(FULL)),
    );
    assert!(flown.parity.ticks >= 200_000, "{}", flown.parity.ticks);
    covers_everything(&flown, 12);
    state("Cortex-M4F", &flown);
}

#[test]
fn riscv_computes_the_same_bits_in_20_000_ticks() {
    let flown = compare(
        Machine::Riscv32,
        LinkKind::Fifo,
        false,
        &Work::Scenarios(&scenarios(SHORT)),
    );
    assert!(flown.parity.ticks >= 20_000, "{}", flown.parity.ticks);
    covers_everything(&flown, 12);
    state("RISC-V (rv32imafc)", &flown);
}

#[test]
fn serial_port_carries_the_same_bits() {
    for machine in MACHINES {
        let scenarios = [seeded(1, 300), seeded(2, 300)];
        let flown = compare(machine, LinkKind::Uart, false, &Work::Scenarios(&scenarios));
        assert_eq!(flown.parity.ticks, SERIAL_TICKS);
    }
}

/// What `sim-host pil` counts of the paper's cases: every tick of parking the same.
#[test]
fn parking_takes_the_instructions_that_the_document_says() {
    let paper = &scenarios(FULL)[..2];
    let parking = compare(
        Machine::CortexM4F,
        LinkKind::Fifo,
        true,
        &Work::Scenarios(paper),
    )
    .cost
    .parking;
    assert_eq!(parking.least, parking.most);
    Stated::of("docs/chip.md").exactly(
        At::Phrase("`pil` counts # for parking"),
        &[f64::from(parking.most)],
    );
}
