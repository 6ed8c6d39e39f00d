//! Processor in the loop: the controller on an emulated chip, the plant here.
//!
//! A [`Bench`] builds the firmware in release mode with the proof that it cannot panic, starts the
//! emulator and flies scenarios with it. In lock step runs the host's own single-precision
//! controller on the same inputs, and both reports are compared bit for bit. A [`BaseBench`] does the same
//! with the whole base: the firmware's control task, on the realistic plant.

mod base;
mod bench;
mod cost;
mod footprint;
mod on_chip;
mod parity;
mod setup;

pub use base::{BaseBench, BaseCost, BaseFlight};
pub use bench::{Bench, ChipBench, Flight};
pub use cost::{Cost, Spread};
pub use footprint::Footprint;
pub use on_chip::OnChip;
pub use parity::{Difference, Parity, pairs};
pub use setup::PilError;

use crate::precision::Precision;
use crate::scenario::{ControlLaw, Controller, MathsBackEnd, ParkingLaw, Update};

/// The controller that the firmware has.
pub const FIRMWARE: Controller = Controller {
    kind: ControlLaw::Neural,
    precision: Precision::F32,
    maths: MathsBackEnd::Single,
    neurons: Update::RationalMean,
    parking: ParkingLaw::Paper,
};
