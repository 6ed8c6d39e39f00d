//! What became of a file, for people.

use super::{Refusal, Trajectory};
use std::fmt;

/// What became of a file, as text: whether it can be driven, with its figures and repairs, or why not.
#[derive(Clone, Copy, Debug)]
pub struct FileVerdict<'a>(pub Result<&'a Trajectory, &'a Refusal>);

impl fmt::Display for FileVerdict<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Err(refusal) => {
                if let Some(format) = refusal.format {
                    writeln!(f, "format     {format}")?;
                }
                write!(f, "verdict    refused\n  {refusal}")
            }
            Ok(trajectory) => {
                let closeness = trajectory.closeness();
                writeln!(f, "format     {}", trajectory.source())?;
                writeln!(f, "verdict    drivable")?;
                write!(f, "{}", trajectory.figures())?;
                writeln!(
                    f,
                    "reference  within {:.2} mm and {:.2} mrad of every pose of the file",
                    1e3 * closeness.position_m,
                    1e3 * closeness.heading_rad
                )?;
                if trajectory.repairs().is_empty() {
                    return f.write_str("repairs    none");
                }
                f.write_str("repairs")?;
                for repair in trajectory.repairs() {
                    write!(f, "\n  {repair}")?;
                }
                Ok(())
            }
        }
    }
}
