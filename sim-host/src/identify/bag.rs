//! The log of a bag of ROS 2.

use super::log::{Drive, Fix, Log, MIN_ROWS, voltages};
use crate::ros::messages::Quaternion;
use crate::ros::read::{Field, Messages, ReadError, StampedPose};
use std::f64::consts::TAU;

/// Where a bag has what a log needs: topics. What is not named is looked for under its usual name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Topics {
    /// Wheel angles \[rad\]; else `/joint_states`.
    pub angle: Option<String>,
    /// Encoder counts, in place of angles.
    pub counts: Option<String>,
    /// Wheel torques \[N m\]; else the efforts of `/joint_states`, if nothing else acts.
    pub torque: Option<String>,
    /// Duties.
    pub duty: Option<String>,
    /// Voltages at the motors.
    pub voltage: Option<String>,
    /// Voltage of the battery.
    pub supply: Option<String>,
    /// Motor currents.
    pub current: Option<String>,
    /// External poses.
    pub pose: Option<String>,
    /// Names of the joints, right before left; else those of this crate's own bags.
    pub joints: Option<[String; 2]>,
}

/// The names of a quantity are those of a log's columns.
impl Topics {
    /// States a topic, `duty=/wheel_commands`.
    ///
    /// # Errors
    /// Another quantity, or nothing behind `=`.
    pub fn state(&mut self, text: &str) -> Result<(), String> {
        let known = "angle, counts, torque, duty, voltage, supply, current, pose";
        let (name, topic) = text
            .split_once('=')
            .filter(|(_, topic)| topic.starts_with('/'))
            .ok_or_else(|| format!("`{text}` is not NAME=/TOPIC"))?;
        let place = match name {
            "angle" => &mut self.angle,
            "counts" => &mut self.counts,
            "torque" => &mut self.torque,
            "duty" => &mut self.duty,
            "voltage" => &mut self.voltage,
            "supply" => &mut self.supply,
            "current" => &mut self.current,
            "pose" => &mut self.pose,
            _ => return Err(format!("`{name}` is none of {known}")),
        };
        *place = Some(topic.to_owned());
        Ok(())
    }
}

/// Where this crate and most robots have their wheels.
const JOINT_STATES: &str = "/joint_states";

type Pairs = Vec<(u64, [f64; 2])>;

impl Log {
    /// Takes a log from a bag: a row for each message with wheel angles. Stamps count where messages have them, else the time
    /// at which they were recorded.
    ///
    /// A row's command is the last one given before the middle of the row, so that it does not matter which of the two messages
    /// of a tick is stamped first. Poses count for the row that is nearest, moved there with the speed between neighbouring ones.
    ///
    /// # Errors
    /// What is wrong, with topic and message.
    pub fn of_bag(
        messages: &Messages,
        topics: &Topics,
        counts_per_turn: Option<f64>,
    ) -> Result<Self, ReadError> {
        let joints = topics
            .joints
            .clone()
            .unwrap_or_else(|| crate::datalog::messages::JOINTS.map(str::to_owned));
        let pairs = |topic: &str, field| messages.pairs(topic, field, &joints);
        let (mut angles, step_rad) = match (&topics.counts, counts_per_turn) {
            (Some(topic), Some(counts)) => {
                let step = TAU / counts;
                let mut angles = pairs(topic, Field::Position)?;
                for (_, pair) in &mut angles {
                    *pair = pair.map(|count| step * count);
                }
                (angles, Some(step))
            }
            (Some(_), None) => {
                let problem =
                    "counts need --counts-per-turn (counts of one whole turn of the wheel)";
                return Err(ReadError::Content(problem.to_owned()));
            }
            (None, counts) => {
                let topic = topics.angle.as_deref().unwrap_or(JOINT_STATES);
                (
                    pairs(topic, Field::Position)?,
                    counts.map(|counts| TAU / counts),
                )
            }
        };
        let (duties, drive, commands) = match (&topics.duty, &topics.voltage, &topics.torque) {
            (Some(topic), None, None) => (true, Drive::Duty, pairs(topic, Field::Effort)?),
            (None, Some(topic), None) => (false, Drive::Voltage, pairs(topic, Field::Effort)?),
            (None, None, torque) => {
                let topic = torque.as_deref().unwrap_or(JOINT_STATES);
                (false, Drive::Torque, pairs(topic, Field::Effort)?)
            }
            _ => {
                let problem = "name one of the topics duty, voltage, torque";
                return Err(messages.lacks(problem));
            }
        };
        let currents = match &topics.current {
            Some(topic) => Some(pairs(topic, Field::Effort)?),
            None => None,
        };
        let supplies = match &topics.supply {
            Some(topic) => Some(messages.numbers(topic)?),
            None => None,
        };
        // Rows from where everything has begun; repeats of an instant say nothing.
        let begun = [
            commands.first().map(|(ns, _)| *ns),
            currents.as_ref().and_then(|c| c.first()).map(|(ns, _)| *ns),
            supplies.as_ref().and_then(|s| s.first()).map(|(ns, _)| *ns),
        ];
        let begun = begun.into_iter().flatten().max().unwrap_or(u64::MAX);
        angles.sort_by_key(|(ns, _)| *ns);
        angles.dedup_by_key(|(ns, _)| *ns);
        let mut middles = middles(&angles);
        let after = middles.partition_point(|ns| *ns < begun);
        middles.drain(..after);
        angles.drain(..after);
        let rows: Vec<u64> = angles.iter().map(|(ns, _)| *ns).collect();
        let (Some(&first), true) = (rows.first(), rows.len() >= MIN_ROWS) else {
            let problem = format!(
                "{} rows with wheel angles and commands are too few: at least {MIN_ROWS} are needed",
                rows.len()
            );
            return Err(ReadError::Content(problem));
        };
        let command = held(commands, &middles);
        let current = currents.map(|currents| nearest(currents, &rows));
        let finite = |pairs: &[[f64; 2]]| pairs.iter().flatten().all(|number| number.is_finite());
        let angle: Vec<[f64; 2]> = angles.into_iter().map(|(_, pair)| pair).collect();
        if !finite(&angle) || !finite(&command) || !current.as_deref().is_none_or(finite) {
            return Err(ReadError::Content(
                "a wheel's number is not finite".to_owned(),
            ));
        }
        if duties && command.iter().flatten().any(|duty| duty.abs() > 1.0) {
            return Err(ReadError::Content(
                "a duty is not within -1 to 1".to_owned(),
            ));
        }
        let (drive, command, supply) = match supplies.filter(|_| duties) {
            Some(supplies) => {
                let measured = nearest(supplies, &rows);
                if !measured.iter().all(|volts| volts.is_finite()) {
                    return Err(ReadError::Content("a supply is not finite".to_owned()));
                }
                let (command, under) = voltages(&command, &measured);
                (Drive::Voltage, command, Some(under))
            }
            None => (drive, command, None),
        };
        let poses = match &topics.pose {
            Some(topic) => messages.poses(Some(topic))?,
            None => Vec::new(),
        };
        Ok(Self {
            t: rows.iter().map(|ns| seconds(first, *ns)).collect(),
            drive,
            command,
            supply,
            angle,
            step_rad,
            current,
            fixes: fixes(&poses, &rows)?,
        })
    }
}

/// Of the rows; the last one's is its beginning.
fn middles(rows: &Pairs) -> Vec<u64> {
    let next = rows.iter().skip(1).chain(rows.last());
    let pairs = rows.iter().zip(next);
    pairs.map(|((a, _), (b, _))| a.midpoint(*b)).collect()
}

fn seconds(from_ns: u64, to_ns: u64) -> f64 {
    1.0e-9 * (i128::from(to_ns) - i128::from(from_ns)) as f64
}

/// At each instant the last value until then.
fn held(mut values: Pairs, at: &[u64]) -> Vec<[f64; 2]> {
    values.sort_by_key(|(ns, _)| *ns);
    let last = |ns: &u64| {
        let after = values.partition_point(|(time, _)| time <= ns);
        values.get(after.saturating_sub(1)).map(|(_, value)| *value)
    };
    at.iter().filter_map(last).collect()
}

/// At each instant the value that is nearest in time.
fn nearest<T: Copy>(mut values: Vec<(u64, T)>, at: &[u64]) -> Vec<T> {
    values.sort_by_key(|(ns, _)| *ns);
    let times: Vec<u64> = values.iter().map(|(ns, _)| *ns).collect();
    let value = |ns: &u64| {
        values
            .get(nearest_index(&times, *ns))
            .map(|(_, value)| *value)
    };
    at.iter().filter_map(value).collect()
}

/// Where in rising times.
fn nearest_index(times: &[u64], ns: u64) -> usize {
    let after = times.partition_point(|time| *time <= ns);
    let before = after.saturating_sub(1);
    match (times.get(before), times.get(after)) {
        (Some(a), Some(b)) if b.abs_diff(ns) < a.abs_diff(ns) => after,
        _ => before,
    }
}

fn fixes(poses: &[StampedPose], rows: &[u64]) -> Result<Vec<Fix>, ReadError> {
    let mut planar: Vec<(u64, [f64; 3])> = Vec::with_capacity(poses.len());
    for pose in poses {
        let [x, y, _] = pose.position;
        let [qx, qy, qz, qw] = pose.orientation;
        let turned = Quaternion {
            x: qx,
            y: qy,
            z: qz,
            w: qw,
        };
        if ![x, y, qx, qy, qz, qw]
            .iter()
            .all(|number| number.is_finite())
        {
            return Err(ReadError::Content("a pose is not finite".to_owned()));
        }
        planar.push((pose.ns, [x, y, turned.heading()]));
    }
    planar.sort_by_key(|(ns, _)| *ns);
    let mut fixes: Vec<Fix> = Vec::with_capacity(planar.len());
    for (index, (ns, pose)) in planar.iter().enumerate() {
        let row = nearest_index(rows, *ns);
        let at = rows.get(row).copied().unwrap_or_default();
        // Beyond the rows, or a second one of a row.
        let beyond =
            rows.first().is_none_or(|first| ns < first) || rows.last().is_none_or(|last| ns > last);
        if beyond || fixes.last().is_some_and(|fix| fix.row == row) {
            continue;
        }
        let towards = match at > *ns {
            true => planar.get(index + 1),
            false => index.checked_sub(1).and_then(|before| planar.get(before)),
        };
        let moved = match towards {
            Some((other, to)) if other != ns && at != *ns => {
                let share = seconds(*ns, at) / seconds(*ns, *other);
                let [dx, dy, turn] = [to[0] - pose[0], to[1] - pose[1], wrapped(to[2] - pose[2])];
                [
                    pose[0] + share * dx,
                    pose[1] + share * dy,
                    pose[2] + share * turn,
                ]
            }
            _ => *pose,
        };
        fixes.push(Fix {
            row,
            pose: moved,
            age_s: 0.0,
        });
    }
    Ok(fixes)
}

fn wrapped(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > 0.5 * TAU {
        turned - TAU
    } else {
        turned
    }
}
