//! A bench recording as it comes in: whole, or it is known which row is missing.

use crate::csv_out::{Column, columns, write_file};
use protocol::{RecordedPose, RecordedRow, RecordedRows, Recording, RecordingEnd, Telemetry};
use std::io::Write;

/// Rows that did not come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("rows {from} to {before} did not arrive", before = before - 1)]
pub struct Lost {
    /// Number of the first.
    pub from: u32,
    /// Number of the one after the last.
    pub before: u32,
}

/// What came of a recording so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedDrive {
    /// The torque of a full command \[N m\], inside; `None` where commands are duties. Outside: whether it has begun.
    began: Option<Option<f32>>,
    rows: Vec<RecordedRow>,
    poses: Vec<RecordedPose>,
    lost: Option<Lost>,
    ended: Option<RecordingEnd>,
}

/// A row with what it has in common with those before it.
struct Row<'a> {
    t: f64,
    row: &'a RecordedRow,
    counts: [i64; 2],
    pose: Option<&'a RecordedPose>,
    /// Of torques.
    full: Option<f64>,
}

impl Row<'_> {
    fn command(&self, side: usize) -> f64 {
        let share = f64::from(self.row.command[side]) / f64::from(RecordedRow::FULL);
        self.full.map_or(share, |full| full * share)
    }

    fn current(&self, side: usize) -> f64 {
        let steps = f64::from(self.row.current[side]);
        steps * f64::from(RecordedRow::CURRENT_STEP_A)
    }

    fn counts(&self, side: usize) -> f64 {
        self.counts[side] as f64
    }
}

impl RecordedDrive {
    /// Takes what belongs to a recording. The base has one at a time: another begin begins anew.
    pub fn take(&mut self, message: &Telemetry) {
        match message {
            Telemetry::Recording(Recording::Began { full_torque_nm }) => {
                *self = Self {
                    began: Some(*full_torque_nm),
                    ..Self::default()
                };
            }
            Telemetry::Rows(RecordedRows { first, count, rows }) => {
                self.missing_before(*first);
                self.rows.extend(rows.iter().take((*count).into()));
            }
            Telemetry::RecordedPose(pose) => self.poses.push(*pose),
            Telemetry::Recording(Recording::Ended { rows, end }) => {
                self.missing_before(*rows);
                self.ended = Some(*end);
            }
            _ => {}
        }
    }

    /// The first gap stays: what comes after it is in no place.
    fn missing_before(&mut self, number: u32) {
        let from = u32::try_from(self.rows.len()).unwrap_or(u32::MAX);
        if number != from && self.lost.is_none() {
            self.lost = Some(Lost {
                from,
                before: number.max(from.saturating_add(1)),
            });
        }
    }

    /// Rows so far.
    pub fn rows(&self) -> &[RecordedRow] {
        &self.rows
    }

    /// External poses so far.
    pub fn poses(&self) -> &[RecordedPose] {
        &self.poses
    }

    /// Rows that did not arrive though later ones did.
    pub const fn lost(&self) -> Option<Lost> {
        self.lost
    }

    /// Why it is over, once it is.
    pub const fn ended(&self) -> Option<RecordingEnd> {
        self.ended
    }

    /// Rows without a supply, rows without currents. A column that is not whole is not written.
    pub fn lacking(&self) -> [usize; 2] {
        let without = |lacks: fn(&RecordedRow) -> bool| {
            let rows = self.rows.iter();
            rows.filter(|row| lacks(row)).count()
        };
        [
            without(|row| row.supply == 0),
            without(|row| row.current.contains(&RecordedRow::NONE)),
        ]
    }

    /// Writes the columns of a log of `identify`: those that every row has.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: impl Write) -> csv::Result<()> {
        let [has_supply, has_currents] = self.lacking().map(|rows| rows == 0);
        let full = self.began.flatten().map(f64::from);
        type Columns<'a, const N: usize> = [Column<Row<'a>>; N];
        let always: Columns<'_, 3> = columns![row;
            "t" => row.t,
            "counts_right" => row.counts(0),
            "counts_left" => row.counts(1),
        ];
        let torques: Columns<'_, 2> = columns![row;
            "torque_right" => row.command(0),
            "torque_left" => row.command(1),
        ];
        let duties: Columns<'_, 2> = columns![row;
            "duty_right" => row.command(0),
            "duty_left" => row.command(1),
        ];
        let supply: Columns<'_, 1> = columns![row;
            "supply" => f64::from(row.row.supply) * f64::from(RecordedRow::SUPPLY_STEP_V),
        ];
        let currents: Columns<'_, 2> = columns![row;
            "current_right" => row.current(0),
            "current_left" => row.current(1),
        ];
        let poses: Columns<'_, 4> = columns![row;
            "x" => row.pose.map(|pose| pose.pose.x),
            "y" => row.pose.map(|pose| pose.pose.y),
            "theta" => row.pose.map(|pose| pose.pose.theta),
            "age" => row.pose.map(|pose| pose.age_s),
        ];
        let mut columns = Vec::from(always);
        columns.extend(if full.is_some() { torques } else { duties });
        if has_supply {
            columns.extend(supply);
        }
        if has_currents {
            columns.extend(currents);
        }
        if !self.poses.is_empty() {
            columns.extend(poses);
        }
        let mut poses = self.poses.iter().peekable();
        let mut counts = [0_i64; 2];
        let mut us = 0_u64;
        let rows = (0..).zip(&self.rows).map(|(number, row)| {
            us += u64::from(row.dt_us);
            for (sum, moved) in counts.iter_mut().zip(row.counts) {
                *sum += i64::from(moved);
            }
            Row {
                t: us as f64 / 1.0e6,
                row,
                counts,
                pose: poses.next_if(|pose| pose.row == number),
                full,
            }
        });
        write_file(&columns, rows, out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::{ROWS, WirePose};

    fn rows(first: u32, count: u8) -> Telemetry {
        let row = RecordedRow {
            dt_us: 10_000,
            counts: [3, -2],
            command: [RecordedRow::FULL, 0],
            current: [500, -250],
            supply: 24_000,
        };
        Telemetry::Rows(RecordedRows {
            first,
            count,
            rows: [row; ROWS],
        })
    }

    fn began(full_torque_nm: Option<f32>) -> Telemetry {
        Telemetry::Recording(Recording::Began { full_torque_nm })
    }

    fn ended(rows: u32) -> Telemetry {
        let end = RecordingEnd::Complete;
        Telemetry::Recording(Recording::Ended { rows, end })
    }

    #[test]
    fn a_lost_frame_is_named_by_its_rows() {
        let taken = |messages: &[Telemetry]| {
            let mut drive = RecordedDrive::default();
            messages.iter().for_each(|message| drive.take(message));
            (drive.lost(), drive.rows().len())
        };
        let whole = [began(None), rows(0, 9), rows(9, 4), ended(13)];
        assert_eq!(taken(&whole), (None, 13));
        let (first, last) = (
            Lost { from: 0, before: 9 },
            Lost {
                from: 9,
                before: 13,
            },
        );
        assert_eq!(taken(&[began(None), rows(9, 4), ended(13)]).0, Some(first));
        assert_eq!(taken(&[began(None), rows(0, 9), ended(13)]).0, Some(last));
        assert_eq!(last.to_string(), "rows 9 to 12 did not arrive");
        // Twice the same, or a begin that was missed, is not whole either.
        assert!(taken(&[began(None), rows(0, 9), rows(0, 9)]).0.is_some());
        assert!(taken(&[rows(18, 9)]).0.is_some());
    }

    #[test]
    fn rows_become_the_columns_of_a_log() {
        let mut drive = RecordedDrive::default();
        drive.take(&began(Some(2.0)));
        drive.take(&rows(0, 2));
        drive.take(&Telemetry::RecordedPose(RecordedPose {
            row: 1,
            pose: WirePose {
                x: 1.5,
                y: 0.0,
                theta: -0.25,
            },
            age_s: 0.02,
        }));
        let mut bytes = Vec::new();
        drive.write(&mut bytes).expect("written");
        let text = String::from_utf8(bytes).expect("UTF-8");
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(
            lines[0],
            "t,counts_right,counts_left,torque_right,torque_left,supply,current_right,current_left,x,y,theta,age"
        );
        assert!(lines[1].starts_with("0.01,3,-2,2,0,24"), "{}", lines[1]);
        assert!(lines[1].ends_with(",,,,"), "{}", lines[1]);
        assert!(lines[2].starts_with("0.02,6,-4,2,0,24"), "{}", lines[2]);
        assert!(lines[2].ends_with(",1.5,0,-0.25,0.02"), "{}", lines[2]);
        // One row without a supply, and there is no column of it.
        let bare = RecordedRow {
            supply: 0,
            ..drive.rows[0]
        };
        drive.rows.push(bare);
        assert_eq!(drive.lacking(), [1, 0]);
        let mut bytes = Vec::new();
        drive.write(&mut bytes).expect("written");
        let text = String::from_utf8(bytes).expect("UTF-8");
        assert!(!text.contains("supply") && text.contains("current_left"));
    }
}
