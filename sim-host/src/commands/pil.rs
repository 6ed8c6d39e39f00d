//! `pil`.

use super::drive::{self, Done};
use super::error::CommandError;
use super::log::watched;
use super::write::Writer;
use super::{advise, say, tell};
use crate::cli::Output;
use crate::log_args::LogArgs;
use firmware_demo::host::{LinkKind, Machine};
use sim_host::advice::of_scenario;
use sim_host::csv_out::Columns;
use sim_host::figure::Labelled;
use sim_host::job::Job;
use sim_host::pil::{BaseBench, Bench, Cost, FIRMWARE, Flight, Footprint, Parity, Spread};
use sim_host::record::{ChipRecord, Finished, Record};
use sim_host::scenario::{Controller, Scenario};
use sim_host::table::{Column, side_by_side};
use std::time::Duration;

/// The chip, and the way to it.
#[derive(Clone, Copy)]
pub struct Board {
    pub machine: Machine,
    pub link: LinkKind,
}

impl Board {
    /// What the JSON file says of a flight, by its parity, cost and duration.
    fn record<C>(
        &self,
        (parity, instructions, elapsed): (Parity, C, Duration),
        stack_bytes: u32,
        image: Footprint,
    ) -> ChipRecord<C> {
        ChipRecord {
            machine: machine_name(self.machine),
            link: link_name(self.link),
            ticks_per_second: rate(&parity, elapsed),
            parity,
            instructions,
            stack_bytes,
            image,
        }
    }
}

/// Where the log of a run of that name goes.
type LogOf<'a> = dyn Fn(&str) -> LogArgs + 'a;

/// Flies all of them: scenarios of the paper's laws with its firmware, all else with the whole base.
pub fn all(jobs: &[Job], board: Board, log: &LogArgs, output: &Output) -> Result<(), CommandError> {
    let log = |name: &str| log.of_run(name, jobs.len());
    let writer = Writer::new(output)?;
    let scenarios: Vec<&Scenario> = jobs.iter().filter_map(Job::scenario).collect();
    let mut exact = true;
    if !scenarios.is_empty() {
        exact &= law(&scenarios, board, &log, &writer)?;
    }
    if scenarios.len() < jobs.len() {
        exact &= base(jobs, board, &log, &writer)?;
    }
    say(&format!("results are in {}\n", output.out.display()))?;
    if exact {
        Ok(())
    } else {
        Err(CommandError::Apart)
    }
}

/// Whether the whole base was bit-equal.
fn base(
    jobs: &[Job],
    board: Board,
    log: &LogOf<'_>,
    writer: &Writer<'_>,
) -> Result<bool, CommandError> {
    let mut bench = BaseBench::start(board.machine, board.link)?;
    let image = bench.footprint()?;
    let mut exact = true;
    let mut failed = Vec::new();
    for job in jobs {
        let Job::Mission { mission, file } = job else {
            continue;
        };
        let file = file.as_ref();
        drive::announce(mission, file)?;
        let log = log(&mission.name);
        let robot = &mission.base.name;
        let flight = watched(&log, Columns::Motion, robot, |watch| {
            bench.fly_watched(mission, watch)
        })?;
        exact &= flight.parity.is_exact();
        let done = Done {
            trace: flight.trace,
            label: machine_name(board.machine),
            chip: Some(board.record(
                (flight.parity, flight.cost, flight.elapsed),
                bench.stack_bytes()?,
                image,
            )),
        };
        match drive::results(mission, file, &done, true, writer) {
            Err(error @ CommandError::NotDone { .. }) => failed.push(error),
            other => other?,
        }
        say(&costs(&flight.cost.named()))?;
        say(&format!(
            "  {:.0} ticks/s over {}\n  {}\n",
            rate(&flight.parity, flight.elapsed),
            link_name(board.link),
            verdict(
                &flight.parity,
                "wheel outputs, state, pose and the law's terms"
            )
        ))?;
    }
    say_image(&image, bench.stack_bytes()?)?;
    bench.finish()?;
    CommandError::all(failed)?;
    Ok(exact)
}

/// Whether the paper's law was bit-equal.
fn law(
    scenarios: &[&Scenario],
    board: Board,
    log: &LogOf<'_>,
    writer: &Writer<'_>,
) -> Result<bool, CommandError> {
    let mut bench = Bench::start(board.machine, board.link, true)?;
    let image = bench.footprint()?;
    let (mut exact, mut total) = (true, Total::default());
    for &scenario in scenarios {
        advise(&of_scenario(scenario));
        note(scenario);
        let log = log(&scenario.name);
        let flight = watched(&log, Columns::Paper, &scenario.name, |watch| {
            bench.fly_watched(scenario, watch)
        })?;
        exact &= flight.parity.is_exact();
        total.add(&flight);
        let chip = board.record(
            (flight.parity, flight.cost, flight.elapsed),
            bench.stack_bytes()?,
            image,
        );
        write(scenario, flight, chip, writer)?;
    }
    if scenarios.len() > 1 {
        say(&format!("all scenarios\n{}", costs(&total.cost.named())))?;
        say(&format!("  {}\n", verdict(&total.parity, LAW_TERMS)))?;
    }
    say_image(&image, bench.stack_bytes()?)?;
    bench.finish()?;
    Ok(exact)
}

fn say_image(image: &Footprint, stack_bytes: u32) -> Result<(), CommandError> {
    say(&format!(
        "image: {} bytes of flash (code {}, constants {}), {} of RAM and {stack_bytes} of stack\n",
        image.flash(),
        image.text,
        image.rodata + image.data,
        image.ram(),
    ))
}

/// What is compared of the paper's law.
const LAW_TERMS: &str = "torques, velocity commands, neuron states and every other term";

#[derive(Default)]
struct Total {
    parity: Parity,
    cost: Cost,
}

impl Total {
    fn add(&mut self, flight: &Flight) {
        self.parity.merge(&flight.parity);
        self.cost.merge(&flight.cost);
    }
}

/// Says which settings of the file the firmware does not follow.
fn note(scenario: &Scenario) {
    let asked = scenario.controller;
    if asked != FIRMWARE {
        tell(&format!(
            "note: {}: the chip runs {}; the file says {}\n",
            scenario.name,
            settings(&FIRMWARE),
            settings(&asked),
        ));
    }
}

/// In the words of scenario files.
fn settings(controller: &Controller) -> String {
    let word = |value: Result<serde_json::Value, _>| match value {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    };
    format!(
        "precision {}, maths {}, neurons {}",
        word(serde_json::to_value(controller.precision)),
        word(serde_json::to_value(controller.maths)),
        word(serde_json::to_value(controller.neurons)),
    )
}

fn write(
    scenario: &Scenario,
    flight: Flight,
    chip: ChipRecord,
    writer: &Writer<'_>,
) -> Result<(), CommandError> {
    let mut flown = scenario.clone();
    flown.controller = FIRMWARE;
    let run = Finished::scenario(&flown, flight.trace).ok_or(CommandError::NoRows)?;
    let (name, label) = (&scenario.name, chip.machine);
    say(&format!("{name}: {}\n", scenario.description))?;
    let metrics = &run.metrics;
    say(&format!("{}\n", side_by_side(&[Column { label, metrics }])))?;
    say(&costs(&chip.instructions.named()))?;
    say(&format!(
        "  {:.0} ticks/s over {}\n  {}\n",
        chip.ticks_per_second,
        chip.link,
        verdict(&chip.parity, LAW_TERMS)
    ))?;
    let file = format!("{name}-pil");
    let title = format!("{name} on {label}: {}", scenario.description);
    let trace = &run.trace;
    writer.figure(&file, &title, Labelled { label, trace }, None)?;
    let record = Record {
        chip: Some(chip),
        ..Record::from(&run)
    };
    writer.json(&file, &[record])?;
    writer.csv(&file, trace, Columns::Paper)
}

fn costs(named: &[(&str, Spread)]) -> String {
    let mut text = format!(
        "  {:<24} {:>6} {:>9} {:>6} {:>8}\n",
        "instructions per tick", "least", "mean", "most", "ticks"
    );
    for (name, spread) in named {
        if let Some(mean) = spread.mean() {
            text.push_str(&format!(
                "    {name:<22} {:>6} {mean:>9.2} {:>6} {:>8}\n",
                spread.least, spread.most, spread.ticks
            ));
        }
    }
    text
}

fn verdict(parity: &Parity, terms: &str) -> String {
    let Parity { ticks, numbers, .. } = parity;
    match parity.first {
        None => format!(
            "bit-equal to the host: 0 of {numbers} numbers differ in {ticks} ticks ({terms})"
        ),
        Some(first) => format!(
            "NOT bit-equal to the host: {} of {numbers} numbers differ, by {} bits, in {} of \
             {ticks} ticks; first {} in tick {}, {:e} on the chip and {:e} here",
            parity.numbers_apart,
            parity.bits_apart,
            parity.ticks_apart,
            first.signal,
            first.tick,
            first.chip,
            first.host,
        ),
    }
}

fn rate(parity: &Parity, elapsed: Duration) -> f64 {
    parity.ticks as f64 / elapsed.as_secs_f64().max(1.0e-9)
}

fn machine_name(machine: Machine) -> &'static str {
    match machine {
        Machine::CortexM4F => "Cortex-M4F",
        Machine::Riscv32 => "riscv32imafc",
    }
}

fn link_name(link: LinkKind) -> &'static str {
    match link {
        LinkKind::Uart => "uart",
        LinkKind::Fifo => "fifo",
        LinkKind::None => "none",
    }
}
