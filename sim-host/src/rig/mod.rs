//! The whole base of [`controller_core::base`] in a world that is not kind: encoders, late poses, motors,
//! friction, slip, uneven ticks, faults.
//!
//! [`PlantHal`] is the plant behind the hardware traits. On it runs the firmware's control task, by orders ([`Rig`]) or
//! by bytes through the whole station ([`Board`]).
//!
//! The controller is the chip's, in single precision with the core's own maths; [`crate::world`] is the
//! truth it is measured against, and they share no code. A run is settled by its mission and a seed.

mod board;
mod convert;
mod hal;
mod mirror;
mod run;
mod trial;

pub use board::Board;
pub use convert::params;
pub use hal::PlantHal;
pub use mirror::{Mirror, MirrorError};
pub use run::{drive, fly, watch};
pub use trial::{Rig, RigError};

use crate::world::WorldKeys;

/// Where a mission takes place, if not on the ideal plant.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The true plant; `body` are factors on the robot that the controller believes in.
    pub world: WorldKeys,
    /// Settles all noise.
    pub seed: u64,
}
