//! Closed loops of the law for a real base, [`controller_core::motion`].
//!
//! A [`Mission`](crate::mission::Mission) says what the robot is to do: follow a trajectory file or a motion of Eq. (6),
//! hand over to parking by itself, go to a pose, take up another goal on the way. [`drive`] runs it
//! against the plant of [`crate::plant`]; [`DriveTrace`] has a row for each control tick with all
//! that the controller reported, [`DriveMetrics`] what matters of it.
//!
//! ```
//! use sim_host::drive::{DriveMetrics, FileRun, drive};
//! use sim_host::mission::BaseSpec;
//!
//! let file = "t,x,y,theta\n0,0,0,0\n2,0.5,0,0\n4,1.5,0,0\n6,2,0,0\n";
//! let (mission, scaling) = FileRun::default().mission("straight", file.as_bytes(), &BaseSpec::default())?;
//! assert!(scaling.factor < 1.5);
//! let metrics = DriveMetrics::of(&mission, &drive(&mission)?).ok_or("no rows")?;
//! assert!(metrics.parked_s.is_some() && metrics.run.final_error.position_m < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod csv;
mod driver;
mod file;
mod in_world;
mod metrics;
mod note;
mod run;
mod summary;
mod table;
mod trace;

pub use csv::{COLUMNS, write as write_csv};
pub use driver::{Driver, StartError};
pub use file::{FileError, FileRun, TOLERANCE, fitted, trajectory, verdict};
pub use in_world::{drive_and_observe, drive_in_world, fly};
pub use metrics::{DriveMetrics, LimitUse, LimitedTicks, ON_PATH, StopFigures, TrackingFigures};
pub use note::{BaseNote, cause, fix_name, state_name};
pub use run::{DriveError, drive};
pub use summary::summary;
pub use table::{ChipTable, SAMPLE_BYTES, TABLE_TOLERANCE};
pub use trace::{DriveHandOver, DriveRow, DriveTrace};
