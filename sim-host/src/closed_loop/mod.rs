//! The whole base of [`controller_core::base`] in a world that is not kind: encoders, late poses, motors,
//! friction, slip, uneven ticks, faults.
//!
//! [`PlantHal`] is the plant behind the hardware traits. On it runs the firmware's control task, by orders ([`ClosedLoop`]) or
//! by bytes through the whole control server ([`Board`]).
//!
//! The controller is the chip's, in single precision with the core's own maths; [`crate::world`] is the
//! truth it is measured against, and they share no code. A run is settled by its mission and a seed.

mod board;
mod by_orders;
mod convert;
mod hal;
mod mirror;

pub use board::Board;
pub use by_orders::{ClosedLoop, ClosedLoopError};
pub(crate) use convert::order;
pub use convert::{assumed, params};
pub use hal::PlantHal;
pub use mirror::{LineMirror, Mirror, MirrorError};
