//! Goals and paths, as messages have them, for a base.

use protocol::{TimedSample, WirePose, WireReference, WireTwist};
use sim_host::drive::{FileError, Retiming, fitted};
use sim_host::import::Trajectory;
use sim_host::mission::BaseSpec;
use sim_host::monitor::SAMPLE_S;
use sim_host::ros::messages::{Header, Path, Pose, Quaternion, Stamped};
use std::fmt::Write as _;

/// Rotations whose axis is farther from the vertical are not planar: |x| and |y| of the quaternion.
const PLANAR: f64 = 1.0e-3;

/// Why something is not driven.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// Of another frame: whoever sends it transforms it.
    #[error("in the frame `{found}`, not in `{wanted}`")]
    Frame {
        /// The message's.
        found: String,
        /// The base's.
        wanted: String,
    },
    /// Not finite, or not in the plane.
    #[error("no pose in the plane: {0}")]
    Pose(&'static str),
    /// A path that says nothing of when.
    #[error("all stamps are the same: a path has the time of each pose in its stamp")]
    Untimed,
    /// A path that cannot be driven.
    #[error(transparent)]
    Path(#[from] FileError),
}

/// Whether a message is of the frame that the base knows.
fn framed(header: &Header, wanted: &str) -> Result<(), Refused> {
    // Some write frames with a slash in front, as ROS 1 had them.
    if header.frame_id.trim_start_matches('/') == wanted {
        return Ok(());
    }
    Err(Refused::Frame {
        found: header.frame_id.clone(),
        wanted: wanted.to_owned(),
    })
}

/// A pose in the plane.
fn planar(pose: &Pose) -> Result<[f64; 3], Refused> {
    let Quaternion { x, y, z, w } = pose.orientation;
    let norm = (x * x + y * y + z * z + w * w).sqrt();
    let position = pose.position;
    if !(position.x.is_finite() && position.y.is_finite() && norm.is_finite()) {
        return Err(Refused::Pose("not finite"));
    }
    if norm < 0.5 {
        return Err(Refused::Pose("the quaternion is 0"));
    }
    if x.abs().max(y.abs()) > PLANAR * norm {
        return Err(Refused::Pose("the rotation is not about the vertical"));
    }
    Ok([position.x, position.y, pose.orientation.heading()])
}

/// Where to park.
///
/// # Errors
/// Another frame, or no pose in the plane.
pub fn goal(message: &Stamped<Pose>, frame: &str) -> Result<WirePose, Refused> {
    framed(&message.header, frame)?;
    let [x, y, theta] = planar(&message.value)?;
    Ok(WirePose {
        x: x as f32,
        y: y as f32,
        theta: theta as f32,
    })
}

/// The samples of a path that begins and ends at rest, within the limits of the base.
#[derive(Clone, Debug)]
pub struct Samples {
    trajectory: Trajectory,
    next: u32,
}

impl Samples {
    /// Of a path whose poses have the time of each in their stamps.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn of(path: &Path, frame: &str, base: &BaseSpec) -> Result<Self, Refused> {
        framed(&path.header, frame)?;
        // Relative to the first one: a double has microseconds of a day, not of this century.
        let stamp = |pose: &Stamped<Pose>| {
            let stamp = pose.header.stamp;
            (i64::from(stamp.sec), i64::from(stamp.nanosec))
        };
        let (sec, nanosec) = path.poses.first().map_or((0, 0), stamp);
        let mut rows = Vec::with_capacity(path.poses.len());
        for pose in &path.poses {
            // Many leave those of the poses empty.
            if !pose.header.frame_id.is_empty() {
                framed(&pose.header, frame)?;
            }
            let (s, ns) = stamp(pose);
            let t = (s - sec) as f64 + 1.0e-9 * (ns - nanosec) as f64;
            rows.push((t, planar(&pose.value)?));
        }
        if rows.len() > 1 && rows.iter().all(|(t, _)| *t == 0.0) {
            return Err(Refused::Untimed);
        }
        let (trajectory, _) = fitted(table(&rows).as_bytes(), base, &Retiming::default())?;
        Ok(Self {
            trajectory,
            next: 0,
        })
    }

    /// The next one, if it is of this time or an earlier one \[s since the beginning\]. The last one stands.
    pub fn until(&mut self, t: f64) -> Option<TimedSample> {
        let at = f64::from(self.next) * SAMPLE_S;
        if at > t || self.is_over() {
            return None;
        }
        self.next += 1;
        let sample = self.trajectory.at(at);
        let wire = |v: f64, w: f64| WireTwist {
            v: v as f32,
            w: w as f32,
        };
        Some(TimedSample {
            t: at as f32,
            reference: WireReference {
                pose: WirePose {
                    x: sample.x as f32,
                    y: sample.y as f32,
                    theta: sample.theta as f32,
                },
                twist: wire(sample.v, sample.w),
                accel: wire(sample.a, sample.alpha),
                left: sample.left as f32,
            },
        })
    }

    /// All of them are out, one behind the end among them.
    pub fn is_over(&self) -> bool {
        f64::from(self.next) * SAMPLE_S > self.trajectory.duration() + 1.5 * SAMPLE_S
    }
}

/// As a table of [`sim_host::import`]. Its speeds only say that a path begins and ends at rest: between there they are what
/// neighbours make of them.
fn table(rows: &[(f64, [f64; 3])]) -> String {
    let mut text = String::from("t,x,y,theta,v\n");
    for (at, (t, [x, y, theta])) in rows.iter().enumerate() {
        let neighbours = at
            .checked_sub(1)
            .and_then(|before| Some((rows.get(before)?, rows.get(at + 1)?)));
        let v = neighbours.map_or(0.0, |((t0, a), (t1, b))| {
            let along = (b[0] - a[0]) * theta.cos() + (b[1] - a[1]) * theta.sin();
            if t1 > t0 { along / (t1 - t0) } else { 0.0 }
        });
        // Writing to a string does not fail.
        let _ = writeln!(text, "{t},{x},{y},{theta},{v}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim_host::ros::messages::{Time, Vector};

    fn stamped(t: f64, x: f64, theta: f64) -> Stamped<Pose> {
        Stamped {
            header: Header {
                stamp: Time::of_ns(1_700_000_000_000_000_000 + (1.0e9 * t) as u64),
                frame_id: "odom".to_owned(),
            },
            value: Pose {
                position: Vector {
                    x,
                    ..Vector::default()
                },
                orientation: Quaternion::of_heading(theta),
            },
        }
    }

    fn line(duration: f64) -> Path {
        // From rest to rest: a cosine.
        let pose = |n: i32| {
            let t = 0.1 * f64::from(n);
            let share = 0.5 - 0.5 * (std::f64::consts::PI * t / duration).cos();
            stamped(t, share, 0.0)
        };
        Path {
            header: stamped(0.0, 0.0, 0.0).header,
            poses: (0..=(10.0 * duration) as i32).map(pose).collect(),
        }
    }

    #[test]
    fn a_goal_has_its_heading_and_its_frame() {
        let message = stamped(0.0, 1.5, -2.0);
        let pose = goal(&message, "odom").expect("a goal");
        assert_eq!((pose.x, pose.y), (1.5, 0.0));
        assert!((pose.theta + 2.0).abs() < 1.0e-6);
        let error = goal(&message, "map").expect_err("another frame");
        assert!(matches!(error, Refused::Frame { .. }), "{error}");
    }

    #[test]
    fn what_is_no_pose_in_the_plane_is_refused() {
        let mut tilted = stamped(0.0, 0.0, 0.3);
        tilted.value.orientation.x = 0.1;
        let mut none = stamped(0.0, 0.0, 0.0);
        none.value.orientation = Quaternion::default();
        let mut far = stamped(0.0, 0.0, 0.0);
        far.value.position.y = f64::NAN;
        for message in [tilted, none, far] {
            let refused = goal(&message, "odom").expect_err("no pose");
            assert!(matches!(refused, Refused::Pose(_)), "{refused}");
        }
    }

    #[test]
    fn a_path_becomes_samples_from_rest_to_rest() {
        let base = BaseSpec::default();
        let mut samples = Samples::of(&line(4.0), "odom", &base).expect("drivable");
        let mut all = Vec::new();
        assert_eq!(samples.until(-1.0), None);
        while let Some(sample) = samples.until(100.0) {
            all.push(sample);
        }
        let (first, last) = (all[0].reference, all[all.len() - 1].reference);
        assert!(first.twist.v.abs() < 1.0e-6, "{first:?}");
        assert_eq!(last.twist, WireTwist::default());
        assert!((last.pose.x - 1.0).abs() < 2.0e-3, "{last:?}");
        assert!(all.windows(2).all(|pair| pair[1].t > pair[0].t));
        // The base knows how far it is to the end.
        let left = |sample: &TimedSample| sample.reference.left;
        assert!((left(&all[1]) - 1.0).abs() < 5.0e-3, "{:?}", all[1]);
        assert!(
            all[1..]
                .windows(2)
                .all(|pair| left(&pair[1]) <= left(&pair[0]))
        );
        assert_eq!(last.left, 0.0);
        assert!(samples.is_over());
    }

    #[test]
    fn a_path_with_a_pose_of_another_frame_is_refused() {
        let mut path = line(2.0);
        path.poses[3].header.frame_id.clear();
        let samples = Samples::of(&path, "odom", &BaseSpec::default());
        assert!(samples.is_ok(), "{samples:?}");
        path.poses[7].header.frame_id = "map".to_owned();
        let refused = Samples::of(&path, "odom", &BaseSpec::default()).expect_err("a pose in map");
        assert!(matches!(refused, Refused::Frame { .. }), "{refused}");
    }

    #[test]
    fn a_path_without_times_is_refused() {
        let mut path = line(2.0);
        for pose in &mut path.poses {
            pose.header.stamp = Time::default();
        }
        let refused = Samples::of(&path, "odom", &BaseSpec::default());
        assert_eq!(refused.expect_err("untimed"), Refused::Untimed);
        let empty = Path {
            poses: Vec::new(),
            ..path
        };
        let refused = Samples::of(&empty, "odom", &BaseSpec::default());
        assert!(matches!(refused, Err(Refused::Path(_))));
    }
}
