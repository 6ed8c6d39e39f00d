//! A gyro about the vertical: turns measured without the wheels, and how its own faults are found.
//!
//! Wheels that slide, radii and tracks that are not as stated, turn odometry away; a gyro does not see the floor. What it
//! has is noise, a bias that wanders, a scale error, an age. [`GyroHeading`] integrates its rate, learns the bias, and
//! compares its turn with the wheels'.
//!
//! ```text
//! counts  -> wheels' turn, delayed by the reading's age --+
//!                                                         +-> e, turn of the gyro less that of the wheels
//! reading -> (ω_g − b) T, or the step of a fused heading -+     |-> heading: the wheels' turn + e
//!                                                               |-> slip: e in a window of 0.1 s, beyond what is honest
//!                                                               |-> curvature bias of the wheels, b where the wheels stand
//! fixes   -> heading and b, by a Kalman filter of two states ---+-> which is wrong, where both disagree
//! ```
//!
//! A base without one is as it was, bit for bit. Derivation, sources of the numbers and figures: `docs/gyro.md`.

mod disagreement;
mod heading;
mod params;
mod reading;
mod spread;

pub(crate) use heading::Encoder;
pub use heading::{GyroHeading, GyroReport, Rolled};
pub use params::{GyroParams, ValidGyroParams};
pub use reading::{GyroFault, GyroOutcome, GyroReading, GyroRefusal};
