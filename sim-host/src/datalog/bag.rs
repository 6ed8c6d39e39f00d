//! MCAP: chunks of messages of ROS 2, compressed.

use super::messages::{BASE_FRAME, ODOM_FRAME, diagnosis, header, joints, odometry, transform};
use super::{About, Fields, Sample, Source, Status};
use crate::csv_out::{Cell, Kind, unit};
use crate::ros::messages::{self as ros, Time};
use byteorder::LittleEndian;
use cdr_encoding::to_writer;
use mcap::records::MessageHeader;
use mcap::{Compression, McapError, WriteOptions, Writer};
use serde::ser::{Serialize, SerializeTuple, Serializer};
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// Plain CDR, little-endian.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];
/// Uncompressed size of a chunk \[bytes\]: what a crash may cost, some 1,400 ticks. Larger ones make a bag hardly smaller.
const CHUNK: u64 = 1 << 19;
/// Longest time between two diagnostics \[ns\]: what tools of ROS count on.
const DIAGNOSTICS_NS: u64 = 1_000_000_000;

/// A bag that grows.
pub struct Bag<W: Write + Seek> {
    writer: Writer<W>,
    source: Source,
    robot: String,
    epoch_ns: u64,
    /// Between odometry, frames and joints.
    pause_ns: u64,
    /// The pause in which they were written last.
    pause: Option<u64>,
    /// From the first tick on, which tells the types of its fields.
    channels: Option<Channels>,
    buffer: Vec<u8>,
    /// What the diagnostics said last, and when.
    said: Option<(Status, u64)>,
}

#[derive(Clone, Copy)]
struct Channels {
    report: u16,
    odometry: u16,
    tf: u16,
    joints: u16,
    diagnostics: u16,
}

impl Source {
    /// The type of its message.
    const fn message(self) -> &'static str {
        match self {
            Self::Paper => "twb_msgs/msg/PaperTick",
            Self::Motion => "twb_msgs/msg/MotionTick",
            Self::Board => "twb_msgs/msg/BoardTick",
            Self::Campaign => "twb_msgs/msg/CampaignTick",
        }
    }
}

/// Why a bag is not written.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    #[error(transparent)]
    Mcap(#[from] McapError),
    #[error(transparent)]
    Cdr(#[from] cdr_encoding::Error),
}

impl<W: Write + Seek> Bag<W> {
    pub fn new(out: W, about: &About<'_>) -> Result<Self, BagError> {
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("sim-host ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            // A hundredth smaller than the default, 3; more than 6 gains nothing.
            .compression_level(6)
            // The same bytes on any number of processors.
            .compression_threads(0)
            .chunk_size(Some(CHUNK))
            // A chunk is written when it is whole: a file that ends early ends behind one.
            .disable_seeking(true);
        Ok(Self {
            writer: options.create(out)?,
            source: about.source,
            robot: about.robot.to_owned(),
            epoch_ns: ns(about.epoch_s),
            pause_ns: ns(about.rate_hz.recip()).max(1),
            pause: None,
            channels: None,
            buffer: Vec::new(),
            said: None,
        })
    }

    pub fn add(&mut self, sample: &Sample, fields: &Fields) -> Result<(), BagError> {
        let time_ns = self.epoch_ns + ns(sample.time_s);
        let channels = match self.channels {
            Some(channels) => channels,
            None => self.open(fields)?,
        };
        self.channels = Some(channels);
        self.put(channels.report, time_ns, &Report(fields))?;
        // Counted from the beginning: uneven ticks do not make them fewer.
        let pause = ns(sample.time_s) / self.pause_ns;
        if self.pause != Some(pause) {
            self.pause = Some(pause);
            self.standard(sample, time_ns, channels)?;
        }
        self.diagnose(&sample.status, time_ns, channels.diagnostics)?;
        Ok(())
    }

    /// Odometry, frames, joints.
    fn standard(
        &mut self,
        sample: &Sample,
        time_ns: u64,
        channels: Channels,
    ) -> Result<(), BagError> {
        let stamp = Time::of_ns(time_ns);
        if let Some(measured) = &sample.measured {
            let odometry = odometry(header(stamp, ODOM_FRAME), BASE_FRAME, measured);
            self.put(channels.odometry, time_ns, &odometry)?;
        }
        let frames = [
            (BASE_FRAME, sample.measured.map(|measured| measured.pose)),
            ("base_link_true", sample.truth),
            ("reference", sample.reference),
        ];
        let transforms = frames
            .into_iter()
            .filter_map(|(frame, pose)| Some(transform(header(stamp, ODOM_FRAME), frame, &pose?)));
        let transforms = transforms.collect();
        self.put(channels.tf, time_ns, &ros::TfMessage { transforms })?;
        self.put(channels.joints, time_ns, &joints(header(stamp, ""), sample))
    }

    /// When something changed, and once a second.
    fn diagnose(&mut self, status: &Status, time_ns: u64, channel: u16) -> Result<(), BagError> {
        let due = |(said, at): &(Status, u64)| said != status || time_ns >= at + DIAGNOSTICS_NS;
        if !self.said.as_ref().is_none_or(due) {
            return Ok(());
        }
        let array = ros::DiagnosticArray {
            header: header(Time::of_ns(time_ns), ""),
            status: vec![diagnosis(&self.robot, status)],
        };
        self.put(channel, time_ns, &array)?;
        self.said = Some((status.clone(), time_ns));
        Ok(())
    }

    fn open(&mut self, fields: &Fields) -> Result<Channels, BagError> {
        let report = definition(fields);
        let standard = |definition: ros::Definition| (definition.name, definition.schema());
        let mut channel = |topic: &str, (name, schema): (&str, String)| {
            let id = self.writer.add_schema(name, "ros2msg", schema.as_bytes())?;
            self.writer.add_channel(id, topic, "cdr", &BTreeMap::new())
        };
        Ok(Channels {
            report: channel("/report", (self.source.message(), report))?,
            odometry: channel("/odom", standard(ros::ODOMETRY))?,
            tf: channel("/tf", standard(ros::TF_MESSAGE))?,
            joints: channel("/joint_states", standard(ros::JOINT_STATE))?,
            diagnostics: channel("/diagnostics", standard(ros::DIAGNOSTIC_ARRAY))?,
        })
    }

    fn put(
        &mut self,
        channel: u16,
        time_ns: u64,
        message: &impl Serialize,
    ) -> Result<(), BagError> {
        self.buffer.clear();
        self.buffer.extend(ENCAPSULATION);
        to_writer::<_, LittleEndian, _>(&mut self.buffer, message)?;
        let header = MessageHeader {
            channel_id: channel,
            // Nobody looks for gaps in what one writer wrote, and a counter of every tick is 2 to 4 bytes of it, compressed.
            sequence: 0,
            log_time: time_ns,
            publish_time: time_ns,
        };
        Ok(self.writer.write_to_known_channel(&header, &self.buffer)?)
    }

    /// Ends the chunk.
    pub fn flush(&mut self) -> Result<(), BagError> {
        Ok(self.writer.flush()?)
    }

    pub fn finish(mut self) -> Result<(), BagError> {
        self.writer.finish()?;
        Ok(())
    }
}

fn ns(seconds: f64) -> u64 {
    (1.0e9 * seconds.max(0.0)).round() as u64
}

/// The fields of a row as a message: a column is a field of the same name.
struct Report<'a>(&'a Fields);

impl Serialize for Report<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for (_, cell) in self.0 {
            match cell {
                Cell::Number(number) | Cell::Scientific(number) | Cell::Fixed(number) => {
                    tuple.serialize_element(number)?;
                }
                Cell::Single(number) => tuple.serialize_element(number)?,
                Cell::Whole(number) => tuple.serialize_element(number)?,
                Cell::Flag(flag) => tuple.serialize_element(flag)?,
                Cell::Text(text) => tuple.serialize_element(text)?,
                Cell::Nothing(Kind::Number) => tuple.serialize_element(&f64::NAN)?,
                Cell::Nothing(Kind::Whole) => tuple.serialize_element(&0_u64)?,
                Cell::Nothing(Kind::Flag) => tuple.serialize_element(&false)?,
                Cell::Nothing(Kind::Text) => tuple.serialize_element("")?,
            }
        }
        tuple.end()
    }
}

fn definition(fields: &Fields) -> String {
    let line = |(name, cell): &(&str, Cell)| {
        let kind = match (cell, cell.kind()) {
            (Cell::Single(_), _) => "float32",
            (_, Kind::Number) => "float64",
            (_, Kind::Whole) => "uint64",
            (_, Kind::Flag) => "bool",
            (_, Kind::Text) => "string",
        };
        match unit(name) {
            "" => format!("{kind} {name}\n"),
            unit => format!("{kind} {name}  # {unit}\n"),
        }
    };
    fields.iter().map(line).collect()
}
