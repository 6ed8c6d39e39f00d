//! A tick in messages of ROS 2.

use super::{Level, Sample, Status};
use crate::ros::messages::{
    DiagnosticStatus, Header, JointState, KeyValue, Odometry, Time, TransformStamped,
    WithCovariance,
};
use controller_core::types::{Measured, Pose};

/// The wheels' joints, right before left as everywhere here.
pub const JOINTS: [&str; 2] = ["right_wheel_joint", "left_wheel_joint"];
/// Where poses of a base count from.
pub const ODOM_FRAME: &str = "odom";
/// The base.
pub const BASE_FRAME: &str = "base_link";

/// A stamp in a frame.
pub fn header(stamp: Time, frame: &str) -> Header {
    Header {
        stamp,
        frame_id: frame.to_owned(),
    }
}

/// What the base knows of itself. Covariances are 0: not known.
pub fn odometry(header: Header, base_frame: &str, measured: &Measured<f64>) -> Odometry {
    Odometry {
        header,
        child_frame_id: base_frame.to_owned(),
        pose: WithCovariance {
            value: (&measured.pose).into(),
            ..WithCovariance::default()
        },
        twist: WithCovariance {
            value: (&measured.twist).into(),
            ..WithCovariance::default()
        },
    }
}

/// Where a frame is.
pub fn transform(header: Header, child_frame: &str, pose: &Pose<f64>) -> TransformStamped {
    TransformStamped {
        header,
        child_frame_id: child_frame.to_owned(),
        transform: pose.into(),
    }
}

/// Torques of both wheels; angles and speeds where they are known.
pub fn joints(header: Header, sample: &Sample) -> JointState {
    let wheels = sample.wheels;
    JointState {
        header,
        name: JOINTS.map(str::to_owned).into(),
        position: wheels.map_or_else(Vec::new, |wheels| wheels.angles.into()),
        velocity: wheels.map_or_else(Vec::new, |wheels| {
            vec![wheels.speeds.right, wheels.speeds.left]
        }),
        effort: vec![sample.torques.right, sample.torques.left],
    }
}

/// A key of a diagnosis.
pub fn value(key: &str, value: impl Into<String>) -> KeyValue {
    KeyValue {
        key: key.to_owned(),
        value: value.into(),
    }
}

/// How a base fares.
pub fn diagnosis(robot: &str, status: &Status) -> DiagnosticStatus {
    let message = match status.cause.as_str() {
        "" => status.state.to_owned(),
        cause => format!("{} ({cause})", status.state),
    };
    DiagnosticStatus {
        level: match status.level {
            Level::Ok => 0,
            Level::Warning => 1,
            Level::Error => 2,
        },
        name: "base".to_owned(),
        message,
        hardware_id: robot.to_owned(),
        values: vec![
            value("state", status.state),
            value("cause", status.cause.clone()),
            value("active_faults", status.faults.join("+")),
        ],
    }
}
