//! The whole base on a chip, with the same base here as a shadow.

use super::bench::ChipBench;
use super::cost::Spread;
use super::{Parity, PilError};
use crate::closed_loop::{Mirror, MirrorError};
use crate::mission::Mission;
use crate::run::{Watch, fly};
use crate::trace::Trace;
use crate::world::{WorldKeys, WorldSetup};
use controller_core::base::BaseParams;
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use firmware_demo::host::{BaseChip, ChipError, LinkKind, Machine};
use protocol::pil::{BaseAnswer, BaseInput, BaseTicked, WheelOutput};
use protocol::{BaseTick, Command, RejectReason};
use serde::Serialize;
use std::time::{Duration, Instant};

/// What came of a mission.
#[derive(Clone, Debug)]
pub struct BaseFlight {
    /// As of any other run; the motors were the chip's.
    pub trace: Trace,
    /// Chip against host.
    pub parity: Parity,
    /// Instructions on the chip.
    pub cost: BaseCost,
    /// Time that the run took, plant and shadow included.
    pub elapsed: Duration,
}

/// Executed instructions of a tick of the control task, drivers included, by the supervisor's state. Decoding the
/// question and encoding the answer are the link's business and not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct BaseCost {
    /// Along a trajectory.
    pub following: Spread,
    /// To a goal, and at it.
    pub parking: Spread,
    /// Disarmed, armed, stopping.
    pub other: Spread,
}

impl BaseCost {
    fn add(&mut self, state: State, instructions: u32) {
        match state {
            State::Tracking => self.following.add(instructions),
            State::Parking | State::Parked => self.parking.add(instructions),
            _ => self.other.add(instructions),
        }
    }

    /// With the names for a table.
    pub fn named(&self) -> [(&'static str, Spread); 3] {
        [
            ("following", self.following),
            ("parking, parked", self.parking),
            ("other", self.other),
        ]
    }
}

/// An emulated chip with the whole base.
pub type BaseBench = ChipBench<BaseAnswer>;

impl BaseBench {
    /// Builds the firmware and starts it.
    ///
    /// # Errors
    /// What is missing on this machine, or does not start.
    pub fn start(machine: Machine, link: LinkKind) -> Result<Self, PilError> {
        Self::of(machine, BaseChip::start, link, true)
    }

    /// Flies a mission in its world, or in a perfect one.
    ///
    /// # Errors
    /// Parameters that the base refuses, or a failed link.
    pub fn fly(&mut self, mission: &Mission) -> Result<BaseFlight, PilError> {
        self.fly_watched(mission, None)
    }

    /// As [`fly`](Self::fly), and `watch` sees every tick.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn fly_watched(
        &mut self,
        mission: &Mission,
        watch: Watch<'_>,
    ) -> Result<BaseFlight, PilError> {
        let perfect = || WorldSetup {
            world: WorldKeys::default(),
            seed: 1,
        };
        let setup = mission.setup.clone().unwrap_or_else(perfect);
        let mut mirror = ChipMirror {
            chip: self.chip_mut(),
            parity: Parity::default(),
            cost: BaseCost::default(),
        };
        let start = Instant::now();
        let trace = fly(mission, &setup, &mut mirror, watch).map_err(|cause| PilError::Base {
            name: mission.name.clone(),
            cause,
        })?;
        Ok(BaseFlight {
            trace,
            parity: mirror.parity,
            cost: mirror.cost,
            elapsed: start.elapsed(),
        })
    }

    /// The most bytes of stack in use since the start.
    ///
    /// # Errors
    /// A failed link.
    pub fn stack_bytes(&mut self) -> Result<u32, PilError> {
        Ok(self.chip_mut().counters()?.stack_bytes)
    }

    /// Stops the firmware.
    ///
    /// # Errors
    /// A firmware that does not end, or not in order.
    pub fn finish(self) -> Result<(), PilError> {
        Self::ended(self.into_chip().finish()?)
    }
}

struct ChipMirror<'a> {
    chip: &'a mut BaseChip,
    parity: Parity,
    cost: BaseCost,
}

/// The chip takes a command that the base here refuses, or the other way round.
#[derive(Debug, thiserror::Error)]
#[error("{command:?}: the chip says {chip:?}, the host {host:?}")]
struct OtherAnswer {
    command: Command,
    chip: Result<(), RejectReason>,
    host: Result<(), RejectReason>,
}

impl Mirror for ChipMirror<'_> {
    fn begin(&mut self, params: &BaseParams<f32>, start: Pose<f32>) -> Result<(), MirrorError> {
        Ok(self.chip.begin(params, start)?)
    }

    fn command(
        &mut self,
        command: &Command,
        host: Result<(), RejectReason>,
    ) -> Result<(), MirrorError> {
        let chip = match self.chip.command(command) {
            Ok(()) => Ok(()),
            Err(ChipError::Rejected(reason)) => Err(reason),
            Err(error) => return Err(error.into()),
        };
        if chip == host {
            Ok(())
        } else {
            let command = *command;
            Err(Box::new(OtherAnswer {
                command,
                chip,
                host,
            }))
        }
    }

    fn tick(&mut self, input: &BaseInput, here: &BaseTicked) -> Result<WheelOutput, MirrorError> {
        let chip = self.chip.tick(input)?;
        let pairs = signals(&chip).into_iter().zip(signals(here));
        let pairs = pairs.map(|((signal, chip), (_, host))| (signal, chip, host));
        self.parity.compare(here.tick.tick, pairs);
        self.cost.add(here.tick.state, chip.instructions);
        Ok(chip.output)
    }
}

/// What is compared of a tick: what the wheels get, and the terms of the report that travel as telemetry. The tick's number by
/// its low half, names by a hash of 16 bits.
fn signals(ticked: &BaseTicked) -> Vec<(&'static str, f32)> {
    let BaseTick {
        tick,
        state,
        action,
        outcome,
        flags,
        active_faults,
        ignored,
        retries,
        x,
        y,
        theta,
        v,
        w,
        e_x,
        e_y,
        e_theta,
        v_c,
        w_c,
        e_v,
        e_w,
        load_force,
        load_moment,
        tau_right,
        tau_left,
    } = ticked.tick;
    let (output, right, left) = match ticked.output {
        WheelOutput::Release => (0, 0.0, 0.0),
        WheelOutput::Brake => (1, 0.0, 0.0),
        WheelOutput::Torque { right, left } => (2, right, left),
        WheelOutput::Duty { right, left } => (3, right, left),
        WheelOutput::Speed { right, left } => (4, right, left),
    };
    // Halves of words are exact as floats; states and outcomes by their names.
    let half = |word: u32, shift: u32| f32::from((word >> shift) as u16);
    let name = |name: String| {
        let sum = name.bytes().fold(0_u16, |sum, byte| {
            sum.wrapping_mul(31).wrapping_add(u16::from(byte))
        });
        f32::from(sum)
    };
    vec![
        ("output", f32::from(output as u8)),
        ("output_right", right),
        ("output_left", left),
        ("tick", half(tick, 0)),
        ("state", name(format!("{state:?}"))),
        ("action", name(format!("{action:?}"))),
        ("outcome", name(format!("{outcome:?}"))),
        ("flags", f32::from(flags)),
        ("faults_low", half(active_faults, 0)),
        ("faults_high", half(active_faults, 16)),
        ("ignored", half(ignored, 0)),
        ("retries", f32::from(retries)),
        ("x", x),
        ("y", y),
        ("theta", theta),
        ("v", v),
        ("w", w),
        ("e_x", e_x),
        ("e_y", e_y),
        ("e_theta", e_theta),
        ("v_c", v_c),
        ("w_c", w_c),
        ("e_v", e_v),
        ("e_w", e_w),
        ("load_force", load_force),
        ("load_moment", load_moment),
        ("tau_right", tau_right),
        ("tau_left", tau_left),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bit of what the wheels get, a flag, a state: each difference is found and named.
    #[test]
    fn every_difference_is_found() {
        let host = BaseTicked::default();
        type Change = fn(&mut BaseTicked);
        let changes: [(&str, Change); 4] = [
            ("output_left", |t| {
                t.output = WheelOutput::Duty {
                    right: 0.0,
                    left: -0.0,
                };
            }),
            ("flags", |t| t.tick.flags = 1 << 9),
            ("state", |t| t.tick.state = State::Parking),
            ("e_y", |t| t.tick.e_y = f32::from_bits(1)),
        ];
        for (signal, change) in changes {
            let mut chip = host;
            change(&mut chip);
            let mut parity = Parity::default();
            let pairs = signals(&chip).into_iter().zip(signals(&host));
            parity.compare(7, pairs.map(|((name, chip), (_, host))| (name, chip, host)));
            assert!(!parity.is_exact());
            let named = signals(&chip)
                .into_iter()
                .zip(signals(&host))
                .filter(|((_, chip), (_, host))| chip.to_bits() != host.to_bits());
            assert!(named.into_iter().any(|((name, _), _)| name == signal));
        }
    }
}
