//! Messages of ROS 2 as this crate writes and reads them, with their definitions.
//!
//! Fields stand in the order of the definitions: CDR has no names.
#![allow(
    missing_docs,
    reason = "fields and constants are those of the definitions"
)]

use serde::{Deserialize, Serialize};

/// A type, and what a reader has to know of it.
pub struct Definition {
    /// With package.
    pub name: &'static str,
    /// Its fields, without the types that it is made of.
    text: &'static str,
    /// Those types, all the way down.
    parts: &'static [&'static Definition],
}

impl Definition {
    /// As a bag has it: the types that it is made of follow after lines of `=`.
    pub fn schema(&self) -> String {
        with_parts(self.text, self.parts)
    }
}

/// A definition, followed by those of its parts.
fn with_parts(text: &str, parts: &[&Definition]) -> String {
    let mut schema = text.to_owned();
    for part in parts {
        schema.push_str(&"=".repeat(80));
        let name = part.name.replace("/msg/", "/");
        schema.push_str(&format!("\nMSG: {name}\n{}", part.text));
    }
    schema
}

macro_rules! definitions {
    ($($constant:ident = $name:literal [$($part:ident),*] $text:literal;)+) => {
        $(pub const $constant: Definition = Definition {
            name: $name,
            text: $text,
            parts: &[$(&$part),*],
        };)+
    };
}

definitions! {
    TIME = "builtin_interfaces/msg/Time" [] "int32 sec\nuint32 nanosec\n";
    HEADER = "std_msgs/msg/Header" [TIME] "builtin_interfaces/Time stamp\nstring frame_id\n";
    POINT = "geometry_msgs/msg/Point" [] "float64 x\nfloat64 y\nfloat64 z\n";
    VECTOR = "geometry_msgs/msg/Vector3" [] "float64 x\nfloat64 y\nfloat64 z\n";
    QUATERNION = "geometry_msgs/msg/Quaternion" []
        "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
    POSE = "geometry_msgs/msg/Pose" [] "Point position\nQuaternion orientation\n";
    POSE_WITH_COVARIANCE = "geometry_msgs/msg/PoseWithCovariance" []
        "Pose pose\nfloat64[36] covariance\n";
    TWIST = "geometry_msgs/msg/Twist" [] "Vector3 linear\nVector3 angular\n";
    TWIST_WITH_COVARIANCE = "geometry_msgs/msg/TwistWithCovariance" []
        "Twist twist\nfloat64[36] covariance\n";
    TRANSFORM = "geometry_msgs/msg/Transform" [] "Vector3 translation\nQuaternion rotation\n";
    TRANSFORM_STAMPED = "geometry_msgs/msg/TransformStamped" []
        "std_msgs/Header header\nstring child_frame_id\nTransform transform\n";
    ODOMETRY = "nav_msgs/msg/Odometry"
        [HEADER, TIME, POSE_WITH_COVARIANCE, POSE, POINT, QUATERNION, TWIST_WITH_COVARIANCE, TWIST, VECTOR]
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n";
    TF_MESSAGE = "tf2_msgs/msg/TFMessage"
        [TRANSFORM_STAMPED, HEADER, TIME, TRANSFORM, VECTOR, QUATERNION]
        "geometry_msgs/TransformStamped[] transforms\n";
    JOINT_STATE = "sensor_msgs/msg/JointState" [HEADER, TIME]
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n";
    KEY_VALUE = "diagnostic_msgs/msg/KeyValue" [] "string key\nstring value\n";
    DIAGNOSTIC_STATUS = "diagnostic_msgs/msg/DiagnosticStatus" []
        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n";
    DIAGNOSTIC_ARRAY = "diagnostic_msgs/msg/DiagnosticArray" [HEADER, TIME, DIAGNOSTIC_STATUS, KEY_VALUE]
        "std_msgs/Header header\nDiagnosticStatus[] status\n";
}

/// `builtin_interfaces/Time`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

impl Time {
    pub const fn of_ns(ns: u64) -> Self {
        Self {
            sec: (ns / 1_000_000_000) as i32,
            nanosec: (ns % 1_000_000_000) as u32,
        }
    }

    /// Nanoseconds; none of a stamp that nobody set.
    pub fn ns(self) -> Option<u64> {
        let ns = i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec);
        u64::try_from(ns).ok().filter(|&ns| ns > 0)
    }
}

/// `std_msgs/Header`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// `geometry_msgs/Point`, `Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// `geometry_msgs/Quaternion`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

impl Quaternion {
    /// A turn about the vertical.
    pub fn of_heading(theta: f64) -> Self {
        let (z, w) = libm::sincos(0.5 * theta);
        Self {
            z,
            w,
            ..Self::default()
        }
    }

    /// Where the body's x axis points, seen from above.
    pub fn heading(self) -> f64 {
        let Self { x, y, z, w } = self;
        libm::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
    }
}

/// `geometry_msgs/Pose`, `Transform`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    pub position: Vector,
    pub orientation: Quaternion,
}

impl From<&controller_core::types::Pose<f64>> for Pose {
    fn from(pose: &controller_core::types::Pose<f64>) -> Self {
        Self {
            position: Vector {
                x: pose.x,
                y: pose.y,
                z: 0.0,
            },
            orientation: Quaternion::of_heading(pose.theta),
        }
    }
}

impl From<&controller_core::types::Twist<f64>> for Twist {
    fn from(twist: &controller_core::types::Twist<f64>) -> Self {
        Self {
            linear: Vector {
                x: twist.linear,
                ..Vector::default()
            },
            angular: Vector {
                z: twist.angular,
                ..Vector::default()
            },
        }
    }
}

/// `geometry_msgs/Twist`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    pub linear: Vector,
    pub angular: Vector,
}

/// `float64[36]`, in two halves: serde has no arrays so long. All zeros where it is unknown.
pub type Covariance = ([f64; 18], [f64; 18]);

/// `geometry_msgs/PoseWithCovariance`, `TwistWithCovariance`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WithCovariance<T> {
    pub value: T,
    pub covariance: Covariance,
}

/// `nav_msgs/Odometry`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    pub header: Header,
    pub child_frame_id: String,
    pub pose: WithCovariance<Pose>,
    pub twist: WithCovariance<Twist>,
}

/// `geometry_msgs/TransformStamped`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    pub transform: Pose,
}

/// `tf2_msgs/TFMessage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TfMessage {
    pub transforms: Vec<TransformStamped>,
}

/// `geometry_msgs/PoseStamped`, with a covariance also `PoseWithCovarianceStamped`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stamped<T> {
    pub header: Header,
    pub value: T,
}

/// `nav_msgs/Path`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    pub header: Header,
    pub poses: Vec<Stamped<Pose>>,
}

/// `sensor_msgs/JointState`. What is not known is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    pub header: Header,
    pub name: Vec<String>,
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub effort: Vec<f64>,
}

/// `diagnostic_msgs/KeyValue`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyValue {
    pub key: String,
    pub value: String,
}

/// `diagnostic_msgs/DiagnosticStatus`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    pub level: u8,
    pub name: String,
    pub message: String,
    pub hardware_id: String,
    pub values: Vec<KeyValue>,
}

/// `diagnostic_msgs/DiagnosticArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    pub header: Header,
    pub status: Vec<DiagnosticStatus>,
}

/// The beginning of `sensor_msgs/BatteryState`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BatteryBegin {
    pub header: Header,
    pub voltage: f32,
}

/// `std_msgs/Float64MultiArray`: its layout, then its data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Float64MultiArray {
    pub dim: Vec<(String, u32, u32)>,
    pub data_offset: u32,
    pub data: Vec<f64>,
}
