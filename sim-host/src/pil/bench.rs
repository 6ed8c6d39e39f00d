//! A chip that is ready to fly scenarios, one after another.

use super::setup::explain;
use super::{Cost, FIRMWARE, Footprint, OnChip, Parity, PilError};
use crate::run::{Watch, run_with_watched};
use crate::scenario::Scenario;
use crate::trace::Trace;
use firmware_demo::host::{Chip, ChipError, ChipLink, EmulatorOutcome, LinkKind, Machine, Options};
use protocol::pil::Answer;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::time::{Duration, Instant};

/// Longest silence of the chip before a run is given up: an emulator on a busy machine may be slow.
const SILENCE: Duration = Duration::from_secs(30);

/// An emulated chip on a link.
///
/// ```no_run
/// use firmware_demo::host::{LinkKind, Machine};
/// use sim_host::pil::Bench;
/// use sim_host::scenario::BuiltIn;
///
/// let scenario = BuiltIn::find("paper-line").ok_or("not built in")?.scenario()?;
/// let mut bench = Bench::start(Machine::CortexM4F, LinkKind::Fifo, true)?;
/// let flight = bench.fly(&scenario)?;
/// assert!(flight.parity.is_exact());
/// println!("{} bytes of stack", bench.stack_bytes()?);
/// bench.finish()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ChipBench<A> {
    chip: ChipLink<A>,
    machine: Machine,
}

/// A chip with the paper's law.
pub type Bench = ChipBench<Answer>;

/// What came of a scenario.
#[derive(Clone, Debug)]
pub struct Flight {
    /// As of any other run; the torques are the chip's.
    pub trace: Trace,
    /// Chip against host.
    pub parity: Parity,
    /// Instructions on the chip; all 0 if they were not counted.
    pub cost: Cost,
    /// Time that the run took, plant and shadow included.
    pub elapsed: Duration,
}

impl<A: DeserializeOwned + Debug> ChipBench<A> {
    pub(super) fn of(
        machine: Machine,
        start: impl FnOnce(&Options) -> Result<ChipLink<A>, ChipError>,
        link: LinkKind,
        count_instructions: bool,
    ) -> Result<Self, PilError> {
        let options = Options {
            machine,
            link,
            icount: count_instructions,
            core: None,
            silence: SILENCE,
        };
        match start(&options) {
            Ok(chip) => Ok(Self { chip, machine }),
            Err(error) => Err(explain(machine, error)),
        }
    }

    pub(super) const fn chip_mut(&mut self) -> &mut ChipLink<A> {
        &mut self.chip
    }

    pub(super) fn into_chip(self) -> ChipLink<A> {
        self.chip
    }

    /// Flash and RAM of the image.
    ///
    /// # Errors
    /// An image that cannot be read.
    pub fn footprint(&self) -> Result<Footprint, PilError> {
        let path = self.chip.image();
        let failed = |cause: String| PilError::Image {
            path: path.to_owned(),
            cause,
        };
        let elf = std::fs::read(path).map_err(|error| failed(error.to_string()))?;
        Footprint::of(&elf).map_err(|error| failed(error.to_string()))
    }

    /// The machine.
    pub fn machine(&self) -> Machine {
        self.machine
    }

    pub(super) fn ended(outcome: EmulatorOutcome) -> Result<(), PilError> {
        match outcome.code {
            Some(0) => Ok(()),
            code => Err(PilError::Ended {
                code,
                console: outcome.console,
            }),
        }
    }
}

impl Bench {
    /// Builds the firmware and starts it. Counting instructions makes the emulator slower.
    ///
    /// # Errors
    /// What is missing on this machine, or does not start.
    pub fn start(
        machine: Machine,
        link: LinkKind,
        count_instructions: bool,
    ) -> Result<Self, PilError> {
        Self::of(machine, Chip::start, link, count_instructions)
    }

    /// Flies a scenario with [`FIRMWARE`], whatever controller settings it has beside the law.
    ///
    /// # Errors
    /// A law that the firmware does not have, a fault of the controller, or a failed link.
    pub fn fly(&mut self, scenario: &Scenario) -> Result<Flight, PilError> {
        self.fly_watched(scenario, None)
    }

    /// As [`fly`](Self::fly), and `watch` sees every tick.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn fly_watched(
        &mut self,
        scenario: &Scenario,
        watch: Watch<'_>,
    ) -> Result<Flight, PilError> {
        let asked = &scenario.controller;
        if asked.kind != FIRMWARE.kind || asked.parking != FIRMWARE.parking {
            return Err(PilError::Law(scenario.name.clone()));
        }
        let params = scenario.params.cast::<f32>();
        let validated = params.validate().map_err(|cause| PilError::Params {
            name: scenario.name.clone(),
            cause,
        })?;
        self.chip.configure(&params)?;
        let mut controller = OnChip::new(&mut self.chip, validated);
        let start = Instant::now();
        let trace = run_with_watched(scenario, &mut controller, watch)?;
        Ok(Flight {
            trace,
            parity: *controller.parity(),
            cost: *controller.cost(),
            elapsed: start.elapsed(),
        })
    }

    /// The most bytes of stack in use since the start.
    ///
    /// # Errors
    /// A failed link.
    pub fn stack_bytes(&mut self) -> Result<u32, PilError> {
        Ok(self.chip.counters()?.stack_bytes)
    }

    /// Frames that either side had to throw away; 0 on links that lose nothing.
    ///
    /// # Errors
    /// A failed link.
    pub fn frames_rejected(&mut self) -> Result<u32, PilError> {
        Ok(self.chip.counters()?.frames_rejected)
    }

    /// Stops the firmware.
    ///
    /// # Errors
    /// A firmware that does not end, or not in order.
    pub fn finish(self) -> Result<(), PilError> {
        Self::ended(self.chip.finish()?)
    }
}
