//! Missions: from trajectory files, and what came of them.
//!
//! A [`Mission`](crate::mission::Mission) says what the robot is to do: follow a trajectory file or a motion of Eq. (6),
//! hand over to parking by itself, go to a pose, take up another goal on the way. [`crate::run::drive`] runs it;
//! [`DriveMetrics`] is what matters of its trace.
//!
//! ```
//! use sim_host::drive::{DriveMetrics, FileRun};
//! use sim_host::mission::BaseSpec;
//! use sim_host::run::drive;
//!
//! let file = "t,x,y,theta\n0,0,0,0\n2,0.5,0,0\n4,1.5,0,0\n6,2,0,0\n";
//! let (mission, scaling) = FileRun::default().mission("straight", file.as_bytes(), &BaseSpec::default())?;
//! assert!(scaling.factor < 1.5);
//! let metrics = DriveMetrics::of(&mission, &drive(&mission)?).ok_or("no rows")?;
//! assert!(metrics.parked_s.is_some() && metrics.run.final_error.position_m < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod file;
mod metrics;
mod summary;
mod table;

pub use file::{FileError, FileRun, Retiming, TOLERANCE, fitted, trajectory};
pub use metrics::{DriveMetrics, LimitUse, LimitedTicks, ON_PATH, StopFigures, TrackingFigures};
pub use summary::summary;
pub use table::{ChipTable, SAMPLE_BYTES, TABLE_TOLERANCE};
