//! Whether a file can be driven, for people.

use super::{Closeness, Figures, Format, Options, Refusal, Repair, Trajectory, import};
use std::fmt;

/// What became of a file.
#[derive(Clone, Debug)]
pub enum FileVerdict {
    /// It can be driven.
    Drivable {
        /// What it was taken for.
        format: Format,
        /// Duration, length, peaks.
        figures: Figures,
        /// How close the reference passes the poses.
        closeness: Closeness,
        /// What had to be repaired.
        repairs: Vec<Repair>,
        /// The reference itself.
        trajectory: Box<Trajectory>,
    },
    /// It cannot, and why.
    Refused(Refusal),
}

/// Reads a file and gives the verdict, without running anything.
pub fn check(bytes: &[u8], options: &Options) -> FileVerdict {
    match import(bytes, options) {
        Ok(trajectory) => FileVerdict::Drivable {
            format: trajectory.source(),
            figures: trajectory.figures(),
            closeness: trajectory.closeness(),
            repairs: trajectory.repairs().to_vec(),
            trajectory: Box::new(trajectory),
        },
        Err(refusal) => FileVerdict::Refused(refusal),
    }
}

impl FileVerdict {
    /// Whether the file can be driven.
    pub fn is_drivable(&self) -> bool {
        matches!(self, Self::Drivable { .. })
    }
}

impl fmt::Display for FileVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => {
                if let Some(format) = refusal.format {
                    writeln!(f, "format     {format}")?;
                }
                write!(f, "verdict    refused\n  {refusal}")
            }
            Self::Drivable {
                format,
                figures,
                closeness,
                repairs,
                ..
            } => {
                writeln!(f, "format     {format}")?;
                writeln!(f, "verdict    drivable")?;
                write!(f, "{figures}")?;
                writeln!(
                    f,
                    "reference  within {:.2} mm and {:.2} mrad of every pose of the file",
                    1e3 * closeness.position_m,
                    1e3 * closeness.heading_rad
                )?;
                if repairs.is_empty() {
                    return f.write_str("repairs    none");
                }
                f.write_str("repairs")?;
                for repair in repairs {
                    write!(f, "\n  {repair}")?;
                }
                Ok(())
            }
        }
    }
}
