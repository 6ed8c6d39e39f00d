//! A bench recording: what the base is asked to drive by itself, and a row of what it measured in every tick.
//!
//! Rows are numbered on the chip from 0 and travel [`ROWS`] in a frame, in [`ROW_BYTES`] each, so that one that is lost on the
//! way is missed by its number.

use serde::{Deserialize, Serialize};

use super::values::{optional_real, real};
use super::{CHECK_LEN, HEADER_LEN, WirePose};

/// Bytes of a row.
pub const ROW_BYTES: usize = 16;
/// Rows in a frame: no more than what the longest other message takes in memory.
pub const ROWS: usize = 9;
/// Bytes of a frame of rows on the line, at most: stuffing and delimiter, header, kind, number of the first row, how many, rows,
/// check.
pub const ROWS_FRAME: usize = 2 + HEADER_LEN + 1 + 5 + 1 + ROWS * ROW_BYTES + CHECK_LEN;
/// Share of the line that rows may take \[%\]: the rest is for poses, states and answers.
const LINE_SHARE: u64 = 80;
/// Bits of a byte on a serial line: start, eight, stop.
const BITS: u64 = 10;

/// Bits per second that a line needs for a recording with a tick every so many µs.
pub const fn least_baud(period_us: u32) -> u32 {
    let bits = 1_000_000 * ROWS_FRAME as u64 * BITS * 100;
    let period_us = if period_us == 0 { 1 } else { period_us as u64 };
    // At most a million times some 223.
    bits.div_ceil(period_us * ROWS as u64 * LINE_SHARE) as u32
}

/// What to drive for a recording: levels of speed and turn rate, within a rectangle about the base and its bounds.
///
/// The base stands a tenth of the length inside the rear edge, in the middle of the width, and looks along the length. What stays
/// in the rectangle is the middle of the axle; the body needs its room around it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Excite {
    /// Along the heading at the begin, m.
    #[serde(deserialize_with = "real")]
    pub length_m: f32,
    /// Across it, m.
    #[serde(deserialize_with = "real")]
    pub width_m: f32,
    /// Largest speed that is ordered, m/s; within the base's limit. Less where the space is too short for it.
    #[serde(deserialize_with = "real")]
    pub speed: f32,
    /// Largest turn rate that is ordered, rad/s; within the base's limit.
    #[serde(deserialize_with = "real")]
    pub turn_rate: f32,
    /// For so long, s.
    #[serde(deserialize_with = "real")]
    pub duration_s: f32,
    /// Another drive for each.
    pub seed: u32,
}

/// Begin and end of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Recording {
    /// Rows follow, from number 0.
    Began {
        /// Torque that [`RecordedRow::command`] has as [`RecordedRow::FULL`], N m; `None`: commands are duties.
        #[serde(deserialize_with = "optional_real")]
        full_torque_nm: Option<f32>,
    },
    /// No more rows.
    Ended {
        /// How many there were.
        rows: u32,
        /// Why.
        end: RecordingEnd,
    },
}

/// Why a recording ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RecordingEnd {
    /// Its time was over.
    Complete,
    /// The base was about to leave its space.
    LeftSpace,
    /// A stop, a fault or another order; the state before says which.
    Stopped,
    /// No heartbeat of the host for too long.
    HostSilent,
    /// An encoder gave nothing, or more counts than a row has room for.
    Unread,
    /// A row found no room on its way to the line: it is too slow.
    Overflow,
}

/// What a tick measured, and what it put out until the next one. Right before left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[u8; ROW_BYTES]", into = "[u8; ROW_BYTES]")]
pub struct RecordedRow {
    /// Since the row before, µs.
    pub dt_us: u16,
    /// Counts since the row before.
    pub counts: [i16; 2],
    /// Duty, or torque, as a share of [`FULL`](Self::FULL).
    pub command: [i16; 2],
    /// Currents in steps of [`CURRENT_STEP_A`](Self::CURRENT_STEP_A), or [`NONE`](Self::NONE).
    pub current: [i16; 2],
    /// Supply in steps of [`SUPPLY_STEP_V`](Self::SUPPLY_STEP_V), 0 where it is not measured.
    pub supply: u16,
}

impl RecordedRow {
    /// Full duty, or full torque.
    pub const FULL: i16 = i16::MAX;
    /// A current that is not measured, or beyond ±65 A.
    pub const NONE: i16 = i16::MIN;
    /// A hundredth of what senses the current of the smallest base may err by.
    pub const CURRENT_STEP_A: f32 = 0.002;
    /// As small against the noise of a converter; up to 65 V.
    pub const SUPPLY_STEP_V: f32 = 0.001;

    /// A current in its steps.
    pub fn current_of(ampere: f32) -> i16 {
        let steps = ampere / Self::CURRENT_STEP_A;
        if steps.abs() < f32::from(i16::MAX) {
            round(steps) as i16
        } else {
            Self::NONE
        }
    }

    /// A supply in its steps.
    pub fn supply_of(volt: f32) -> u16 {
        let steps = volt / Self::SUPPLY_STEP_V;
        if steps > 0.0 && steps < f32::from(u16::MAX) {
            round(steps) as u16
        } else {
            0
        }
    }

    /// A duty, or a torque as a share of the full one.
    pub fn command_of(share: f32) -> i16 {
        // Beyond the ends, and what is not a number, `as` takes the nearest and 0.
        round(share * f32::from(Self::FULL)) as i16
    }
}

/// To the nearest whole number, within ±65,536.
fn round(value: f32) -> i32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value + half) as i32
}

impl From<RecordedRow> for [u8; ROW_BYTES] {
    fn from(row: RecordedRow) -> Self {
        let RecordedRow {
            dt_us,
            counts: [counts_right, counts_left],
            command: [command_right, command_left],
            current: [current_right, current_left],
            supply,
        } = row;
        let [a, b] = dt_us.to_le_bytes();
        let [c, d] = counts_right.to_le_bytes();
        let [e, f] = counts_left.to_le_bytes();
        let [g, h] = command_right.to_le_bytes();
        let [i, j] = command_left.to_le_bytes();
        let [k, l] = current_right.to_le_bytes();
        let [m, n] = current_left.to_le_bytes();
        let [o, p] = supply.to_le_bytes();
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]
    }
}

impl From<[u8; ROW_BYTES]> for RecordedRow {
    fn from([a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]: [u8; ROW_BYTES]) -> Self {
        let pair = |[a, b]: [u8; 2], [c, d]: [u8; 2]| {
            [i16::from_le_bytes([a, b]), i16::from_le_bytes([c, d])]
        };
        Self {
            dt_us: u16::from_le_bytes([a, b]),
            counts: pair([c, d], [e, f]),
            command: pair([g, h], [i, j]),
            current: pair([k, l], [m, n]),
            supply: u16::from_le_bytes([o, p]),
        }
    }
}

/// Rows that follow each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordedRows {
    /// Number of the first.
    pub first: u32,
    /// How many there are; the last frame may have less than [`ROWS`].
    pub count: u8,
    /// The rows; those beyond `count` are nothing.
    pub rows: [RecordedRow; ROWS],
}

/// An external pose that the base took in a tick of the recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordedPose {
    /// Number of the tick's row.
    pub row: u32,
    /// Where the base was,
    pub pose: WirePose,
    /// so long before that tick, s.
    #[serde(deserialize_with = "real")]
    pub age_s: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Decoder, MAX_CONTENT, MAX_FRAME, Telemetry, encode};

    fn row(number: i16) -> RecordedRow {
        RecordedRow {
            dt_us: 5000,
            counts: [number, -number],
            command: [RecordedRow::FULL, -RecordedRow::FULL],
            current: [RecordedRow::NONE, 1500],
            supply: 24_000,
        }
    }

    #[test]
    fn the_fullest_frame_of_rows_fits_and_is_no_longer_than_stated() {
        let rows = RecordedRows {
            first: u32::MAX,
            count: ROWS as u8,
            rows: core::array::from_fn(|number| row(i16::MIN + 1 + number as i16)),
        };
        let mut frame = [0; MAX_FRAME];
        let bytes = encode(u16::MAX, &Telemetry::Rows(rows), &mut frame).expect("it fits");
        assert_eq!(bytes.len(), ROWS_FRAME);
        let mut decoder = Decoder::<Telemetry, MAX_CONTENT>::new();
        let frame = bytes.iter().find_map(|byte| decoder.push(*byte));
        let message = frame.expect("a frame").expect("a sound one").message;
        assert_eq!(message, Telemetry::Rows(rows));
        // No message takes more memory because of the rows.
        assert!(size_of::<RecordedRows>() <= size_of::<crate::FieldParams>());
    }

    #[test]
    fn quantities_are_rounded_to_their_steps_and_said_to_be_missing_beyond() {
        assert_eq!(RecordedRow::current_of(-1.2349), -617);
        assert_eq!(RecordedRow::current_of(66.0), RecordedRow::NONE);
        assert_eq!(RecordedRow::current_of(f32::NAN), RecordedRow::NONE);
        assert_eq!(RecordedRow::supply_of(12.3456), 12_346);
        assert_eq!(RecordedRow::supply_of(f32::NAN), 0);
        assert_eq!(RecordedRow::supply_of(-1.0), 0);
        assert_eq!(RecordedRow::command_of(-1.0), -RecordedRow::FULL);
        assert_eq!(RecordedRow::command_of(0.5), 16_384);
    }

    #[test]
    fn the_line_that_a_recording_needs() {
        // 9 rows in 160 bytes of ten bits, of four fifths of the line.
        assert_eq!(least_baud(10_000), 22_223);
        assert_eq!(least_baud(5_000), 44_445);
        assert_eq!(least_baud(1_000), 222_223);
        assert!(least_baud(1) > least_baud(2));
    }
}
