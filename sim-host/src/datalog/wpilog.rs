//! WPILOG, version 1.0: records of entries, each with its type; not compressed.
//!
//! The format is the data log of WPILib (`wpiutil/doc/datalog.adoc`). Structs bring their schemas as entries
//! `/.schema/struct:NAME`, which AdvantageScope needs to draw them.

use super::{Fields, Sample};
use crate::csv_out::{Cell, Kind, unit};
use controller_core::types::Pose;
use std::io::{BufWriter, Write};

const MAGIC: &[u8] = b"WPILOG";
const VERSION: u16 = 0x0100;
/// What is written at once \[bytes\]: what a crash may cost, some 60 ticks.
const CHUNK: usize = 1 << 16;
/// Schemas, from the parts to the whole.
const SCHEMAS: [(&str, &str); 3] = [
    ("Rotation2d", "double value"),
    ("Translation2d", "double x;double y"),
    ("Pose2d", "Translation2d translation;Rotation2d rotation"),
];

/// A log that grows.
pub struct Wpilog<W: Write> {
    out: BufWriter<W>,
    epoch_us: u64,
    next: u32,
    /// From the first tick on, which tells the types of its fields.
    entries: Option<Entries>,
}

#[derive(Clone)]
struct Entries {
    measured: u32,
    truth: u32,
    reference: u32,
    poses: u32,
    torques: u32,
    angles: u32,
    speeds: u32,
    faults: u32,
    fields: Vec<u32>,
}

impl<W: Write> Wpilog<W> {
    pub fn new(out: W, epoch_s: f64) -> std::io::Result<Self> {
        let mut out = BufWriter::with_capacity(CHUNK, out);
        out.write_all(MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        let about = concat!("sim-host ", env!("CARGO_PKG_VERSION"));
        out.write_all(&(about.len() as u32).to_le_bytes())?;
        out.write_all(about.as_bytes())?;
        Ok(Self {
            out,
            epoch_us: us(epoch_s),
            next: 1,
            entries: None,
        })
    }

    pub fn add(&mut self, sample: &Sample, fields: &Fields) -> std::io::Result<()> {
        let time_us = self.epoch_us + us(sample.time_s);
        let entries = match self.entries.take() {
            Some(entries) => entries,
            None => self.open(fields, time_us)?,
        };
        let poses = [
            (
                entries.measured,
                sample.measured.map(|measured| measured.pose),
            ),
            (entries.truth, sample.truth),
            (entries.reference, sample.reference),
        ];
        let mut all = Vec::new();
        for (entry, pose) in poses {
            if let Some(pose) = pose {
                let bytes = pose2d(&pose);
                self.record(entry, time_us, &bytes)?;
                all.extend(bytes);
            }
        }
        self.record(entries.poses, time_us, &all)?;
        let torques = [sample.torques.right, sample.torques.left];
        self.record(entries.torques, time_us, &doubles(&torques))?;
        if let Some(wheels) = &sample.wheels {
            let speeds = [wheels.speeds.right, wheels.speeds.left];
            self.record(entries.angles, time_us, &doubles(&wheels.angles))?;
            self.record(entries.speeds, time_us, &doubles(&speeds))?;
        }
        self.record(entries.faults, time_us, &strings(&sample.status.faults))?;
        for (entry, (_, cell)) in entries.fields.iter().zip(fields) {
            match cell {
                Cell::Number(number) | Cell::Scientific(number) | Cell::Fixed(number) => {
                    self.record(*entry, time_us, &number.to_le_bytes())?;
                }
                Cell::Single(number) => {
                    self.record(*entry, time_us, &number.to_le_bytes())?;
                }
                Cell::Whole(number) => self.record(*entry, time_us, &number.to_le_bytes())?,
                Cell::Flag(flag) => self.record(*entry, time_us, &[u8::from(*flag)])?,
                Cell::Text(text) => self.record(*entry, time_us, text.as_bytes())?,
                Cell::Nothing(Kind::Text) => self.record(*entry, time_us, b"")?,
                // No number is what a log has no record of.
                Cell::Nothing(_) => {}
            }
        }
        self.entries = Some(entries);
        Ok(())
    }

    pub fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }

    fn open(&mut self, fields: &Fields, time_us: u64) -> std::io::Result<Entries> {
        for (name, schema) in SCHEMAS {
            let entry = self.start(
                &format!("/.schema/struct:{name}"),
                "structschema",
                "",
                time_us,
            )?;
            self.record(entry, time_us, schema.as_bytes())?;
        }
        let mut start = |name: &str, kind: &str| self.start(name, kind, "", time_us);
        let entries = Entries {
            measured: start("/pose/measured", "struct:Pose2d")?,
            truth: start("/pose/true", "struct:Pose2d")?,
            reference: start("/pose/reference", "struct:Pose2d")?,
            poses: start("/pose/all", "struct:Pose2d[]")?,
            torques: start("/wheels/torque", "double[]")?,
            angles: start("/wheels/angle", "double[]")?,
            speeds: start("/wheels/speed", "double[]")?,
            faults: start("/faults", "string[]")?,
            fields: Vec::new(),
        };
        let mut columns = Vec::with_capacity(fields.len());
        for (name, cell) in fields {
            let kind = match (cell, cell.kind()) {
                (Cell::Single(_), _) => "float",
                (_, Kind::Number) => "double",
                (_, Kind::Whole) => "int64",
                (_, Kind::Flag) => "boolean",
                (_, Kind::Text) => "string",
            };
            let metadata = match unit(name) {
                "" => String::new(),
                unit => format!("{{\"unit\":\"{unit}\"}}"),
            };
            columns.push(self.start(&format!("/report/{name}"), kind, &metadata, time_us)?);
        }
        Ok(Entries {
            fields: columns,
            ..entries
        })
    }

    /// Announces an entry.
    fn start(
        &mut self,
        name: &str,
        kind: &str,
        metadata: &str,
        time_us: u64,
    ) -> std::io::Result<u32> {
        let entry = self.next;
        self.next += 1;
        let mut payload = vec![0];
        payload.extend(entry.to_le_bytes());
        for text in [name, kind, metadata] {
            payload.extend((text.len() as u32).to_le_bytes());
            payload.extend(text.as_bytes());
        }
        self.record(0, time_us, &payload)?;
        Ok(entry)
    }

    /// A record: lengths of the next three numbers, entry, size, time, payload.
    fn record(&mut self, entry: u32, time_us: u64, payload: &[u8]) -> std::io::Result<()> {
        let size = payload.len() as u64;
        let numbers = [u64::from(entry), size, time_us].map(|number| (number, length(number)));
        let [entry_bytes, size_bytes, time_bytes] = numbers.map(|(_, bytes)| bytes - 1);
        // At most 1 + 3 * 8 bytes.
        let mut head = [0; 25];
        let (first, mut rest) = head.split_at_mut(1);
        first.fill((entry_bytes | size_bytes << 2 | time_bytes << 4) as u8);
        let mut head_bytes = 1;
        for (number, bytes) in numbers {
            let (place, after) = rest.split_at_mut(bytes);
            place.copy_from_slice(number.to_le_bytes().get(..bytes).unwrap_or_default());
            rest = after;
            head_bytes += bytes;
        }
        self.out
            .write_all(head.get(..head_bytes).unwrap_or_default())?;
        self.out.write_all(payload)
    }
}

/// Bytes that a number needs, at least one.
const fn length(number: u64) -> usize {
    match number {
        0 => 1,
        _ => (64 - number.leading_zeros()).div_ceil(8) as usize,
    }
}

fn us(seconds: f64) -> u64 {
    (1.0e6 * seconds.max(0.0)).round() as u64
}

fn pose2d(pose: &Pose<f64>) -> Vec<u8> {
    doubles(&[pose.x, pose.y, pose.theta])
}

fn doubles(numbers: &[f64]) -> Vec<u8> {
    numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect()
}

fn strings(texts: &[&str]) -> Vec<u8> {
    let mut bytes = (texts.len() as u32).to_le_bytes().to_vec();
    for text in texts {
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
    }
    bytes
}
