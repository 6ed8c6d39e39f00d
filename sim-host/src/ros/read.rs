//! Messages of a bag, by their topics.

use super::container;
use super::messages::{
    BatteryBegin, Float64MultiArray, Header, JointState, Odometry, Path, Pose, Stamped, TfMessage,
    WithCovariance,
};
use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use mcap::MAGIC;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};

/// A bag's beginning and end.
pub fn is_bag(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Why a bag cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Not MCAP, or damaged before its first message.
    #[error("not a bag that can be read: {0}")]
    Mcap(String),
    /// No such topic, or several where one has to be named.
    #[error("{problem}; the bag has {}", list(topics))]
    Topic {
        /// What is wrong.
        problem: String,
        /// Each with its type.
        topics: Vec<(String, String)>,
    },
    /// A type that does not have it.
    #[error("{topic}: {kind} has no {wanted}")]
    Type {
        /// Which.
        topic: String,
        /// Its type.
        kind: String,
        /// What was looked for.
        wanted: &'static str,
    },
    /// A message that is not what its type says, or says less than is needed.
    #[error("{topic}, message {index}: {problem}")]
    Message {
        /// Which.
        topic: String,
        /// Counted from 0.
        index: usize,
        /// What is wrong.
        problem: String,
    },
    /// The messages do not make what is wanted of them.
    #[error("{0}")]
    Content(String),
}

fn list(topics: &[(String, String)]) -> String {
    let named = topics
        .iter()
        .map(|(topic, kind)| format!("{topic} ({kind})"));
    match topics {
        [] => "no messages of ROS 2".to_owned(),
        _ => named.collect::<Vec<_>>().join(", "),
    }
}

/// A message as it stands in the bag.
struct Entry {
    log_ns: u64,
    data: Vec<u8>,
}

/// All messages of a bag.
pub struct Messages {
    topics: BTreeMap<String, (String, Vec<Entry>)>,
    /// Why the bag ends before its end, if it does: what was read until there is good.
    pub cut: Option<String>,
}

/// A pose with the time of its stamp, or else of its arrival \[ns\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedPose {
    /// \[ns\].
    pub ns: u64,
    /// \[m\].
    pub position: [f64; 3],
    /// x, y, z, w.
    pub orientation: [f64; 4],
}

/// What is asked of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Of joints.
    Position,
    /// Of joints.
    Effort,
}

const ODOMETRY: &str = "nav_msgs/msg/Odometry";
const POSE: &str = "geometry_msgs/msg/PoseStamped";
const POSE_WITH_COVARIANCE: &str = "geometry_msgs/msg/PoseWithCovarianceStamped";
const PATH: &str = "nav_msgs/msg/Path";
const TF: &str = "tf2_msgs/msg/TFMessage";
const JOINTS: &str = "sensor_msgs/msg/JointState";
const ARRAY: &str = "std_msgs/msg/Float64MultiArray";
const FLOAT: &str = "std_msgs/msg/Float64";
const BATTERY: &str = "sensor_msgs/msg/BatteryState";

impl Messages {
    /// Reads a bag; of one that was cut off what is whole.
    ///
    /// # Errors
    /// Bytes that are no bag.
    pub fn read(bytes: &[u8]) -> Result<Self, ReadError> {
        let mut messages = Self {
            topics: BTreeMap::new(),
            cut: None,
        };
        let read = container::read(bytes, |channel, log_ns, data| {
            if channel.encoding != "cdr" {
                return;
            }
            let data = data.to_vec();
            let of_topic = messages.topics.entry(channel.topic.clone());
            let (_, entries) = of_topic.or_insert_with(|| (channel.kind.clone(), Vec::new()));
            entries.push(Entry { log_ns, data });
        });
        messages.cut = read.err();
        match (&messages.cut, messages.topics.is_empty()) {
            (Some(why), true) => Err(ReadError::Mcap(why.clone())),
            _ => Ok(messages),
        }
    }

    /// Every topic with its type.
    pub fn topics(&self) -> Vec<(String, String)> {
        let topics = self.topics.iter();
        topics
            .map(|(topic, (kind, _))| (topic.clone(), kind.clone()))
            .collect()
    }

    /// An error that lists what there is.
    pub fn lacks(&self, problem: impl Into<String>) -> ReadError {
        ReadError::Topic {
            problem: problem.into(),
            topics: self.topics(),
        }
    }

    /// The only topic of one of these types.
    ///
    /// # Errors
    /// None of them, or several.
    pub fn only(&self, kinds: &[&str], what: &str) -> Result<&str, ReadError> {
        let mut found = self.topics.iter();
        let found: Vec<_> = found
            .by_ref()
            .filter(|(_, (kind, _))| kinds.contains(&kind.as_str()))
            .map(|(topic, _)| topic.as_str())
            .collect();
        match found[..] {
            [topic] => Ok(topic),
            [] => Err(self.lacks(format!("no topic with {what}"))),
            _ => Err(self.lacks(format!("several topics with {what}: name one"))),
        }
    }

    fn of(&self, topic: &str) -> Result<(&str, &[Entry]), ReadError> {
        match self.topics.get(topic) {
            Some((kind, entries)) => Ok((kind, entries)),
            None => Err(self.lacks(format!("no topic {topic}"))),
        }
    }

    /// Poses of a topic that has some, of transforms those of a child frame: `/tf:base_link`. None: of the only topic with
    /// poses.
    ///
    /// # Errors
    /// No such topic, or messages that cannot be read.
    pub fn poses(&self, topic: Option<&str>) -> Result<Vec<StampedPose>, ReadError> {
        let topic = match topic {
            Some(topic) => topic,
            None => self.only(&[ODOMETRY, POSE, POSE_WITH_COVARIANCE, PATH], "poses")?,
        };
        let (topic, frame) = match topic.split_once(':') {
            Some((topic, frame)) => (topic, Some(frame)),
            None => (topic, None),
        };
        let (kind, entries) = self.of(topic)?;
        let mut poses = Vec::new();
        let mut frames = BTreeSet::new();
        // A path is sent again and again, as it grows: the last one is the whole.
        let from = match kind {
            PATH => entries.len().saturating_sub(1),
            _ => 0,
        };
        for (index, entry) in entries.iter().enumerate().skip(from) {
            let decode = Decode {
                topic,
                index,
                entry,
            };
            match kind {
                ODOMETRY => {
                    let Odometry { header, pose, .. } = decode.message()?;
                    poses.push(decode.stamped(&header, &pose.value));
                }
                POSE => {
                    let Stamped::<Pose> { header, value } = decode.message()?;
                    poses.push(decode.stamped(&header, &value));
                }
                POSE_WITH_COVARIANCE => {
                    let Stamped::<WithCovariance<Pose>> { header, value } = decode.message()?;
                    poses.push(decode.stamped(&header, &value.value));
                }
                PATH => {
                    let path: Path = decode.message()?;
                    let each = path.poses.iter();
                    poses.extend(each.map(|pose| decode.stamped(&pose.header, &pose.value)));
                }
                TF => {
                    let tf: TfMessage = decode.message()?;
                    let Some(frame) = frame else {
                        return Err(self.lacks(format!(
                            "{topic} has transforms: name a child frame, as in {topic}:base_link"
                        )));
                    };
                    let names = tf.transforms.iter().map(|t| t.child_frame_id.clone());
                    frames.extend(names);
                    let those = tf.transforms.iter();
                    let those = those.filter(|transform| transform.child_frame_id == frame);
                    poses.extend(those.map(|t| decode.stamped(&t.header, &t.transform)));
                }
                _ => {
                    return Err(ReadError::Type {
                        topic: topic.to_owned(),
                        kind: kind.to_owned(),
                        wanted: "poses",
                    });
                }
            }
        }
        match (poses.is_empty(), frame) {
            (false, _) => Ok(poses),
            (true, Some(frame)) if kind == TF => {
                let names = Vec::from_iter(frames).join(", ");
                let problem = format!("{topic} has no child frame {frame}; there are: {names}");
                Err(ReadError::Content(problem))
            }
            (true, _) => Err(ReadError::Content(format!("{topic} has no poses"))),
        }
    }

    /// Pairs of a topic, right before left: of the named `joints` the `field`, or the first two numbers of an array.
    ///
    /// # Errors
    /// No such topic, or messages that cannot be read.
    pub fn pairs(
        &self,
        topic: &str,
        field: Field,
        joints: &[String; 2],
    ) -> Result<Vec<(u64, [f64; 2])>, ReadError> {
        let (kind, entries) = self.of(topic)?;
        let pairs = entries.iter().enumerate().map(|(index, entry)| {
            let decode = Decode {
                topic,
                index,
                entry,
            };
            match kind {
                JOINTS => {
                    let state: JointState = decode.message()?;
                    let [right, left] = joints;
                    let pair = [
                        decode.joint(&state, right, field)?,
                        decode.joint(&state, left, field)?,
                    ];
                    Ok((state.header.stamp.ns().unwrap_or(entry.log_ns), pair))
                }
                ARRAY => {
                    let array: Float64MultiArray = decode.message()?;
                    match array.data[..] {
                        [right, left] => Ok((entry.log_ns, [right, left])),
                        _ => Err(decode.wrong(format!("{} numbers, not 2", array.data.len()))),
                    }
                }
                _ => Err(ReadError::Type {
                    topic: topic.to_owned(),
                    kind: kind.to_owned(),
                    wanted: "pairs of wheels",
                }),
            }
        });
        pairs.collect()
    }

    /// Voltages of a battery, or plain numbers.
    ///
    /// # Errors
    /// No such topic, or messages that cannot be read.
    pub fn numbers(&self, topic: &str) -> Result<Vec<(u64, f64)>, ReadError> {
        let (kind, entries) = self.of(topic)?;
        let numbers = entries.iter().enumerate().map(|(index, entry)| {
            let decode = Decode {
                topic,
                index,
                entry,
            };
            match kind {
                BATTERY => {
                    let battery: BatteryBegin = decode.message()?;
                    let ns = battery.header.stamp.ns().unwrap_or(entry.log_ns);
                    Ok((ns, f64::from(battery.voltage)))
                }
                FLOAT => Ok((entry.log_ns, decode.message::<f64>()?)),
                _ => Err(ReadError::Type {
                    topic: topic.to_owned(),
                    kind: kind.to_owned(),
                    wanted: "voltage",
                }),
            }
        });
        numbers.collect()
    }
}

/// A message to be decoded.
struct Decode<'a> {
    topic: &'a str,
    index: usize,
    entry: &'a Entry,
}

impl Decode<'_> {
    fn wrong(&self, problem: impl Into<String>) -> ReadError {
        ReadError::Message {
            topic: self.topic.to_owned(),
            index: self.index,
            problem: problem.into(),
        }
    }

    /// What comes behind the fields that are read is left alone.
    fn message<T: DeserializeOwned>(&self) -> Result<T, ReadError> {
        let (head, body) = self
            .entry
            .data
            .split_at_checked(4)
            .ok_or_else(|| self.wrong("shorter than its head"))?;
        let decoded = match head {
            [0, 1, ..] => from_bytes::<T, LittleEndian>(body),
            [0, 0, ..] => from_bytes::<T, BigEndian>(body),
            _ => return Err(self.wrong("not plain CDR")),
        };
        let (message, _) = decoded.map_err(|error| self.wrong(error.to_string()))?;
        Ok(message)
    }

    fn stamped(&self, header: &Header, pose: &Pose) -> StampedPose {
        let (p, q) = (pose.position, pose.orientation);
        StampedPose {
            ns: header.stamp.ns().unwrap_or(self.entry.log_ns),
            position: [p.x, p.y, p.z],
            orientation: [q.x, q.y, q.z, q.w],
        }
    }

    fn joint(&self, state: &JointState, name: &str, field: Field) -> Result<f64, ReadError> {
        let values = match field {
            Field::Position => &state.position,
            Field::Effort => &state.effort,
        };
        let index = state.name.iter().position(|joint| joint == name);
        let index = index.ok_or_else(|| {
            let names = state.name.join(", ");
            self.wrong(format!("no joint {name}; there are: {names}"))
        })?;
        let value = values.get(index).copied();
        value.ok_or_else(|| self.wrong(format!("no {field:?} of {name}").to_lowercase()))
    }
}
