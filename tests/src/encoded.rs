//! The bases of `bases/*.toml`, ideal but for their encoders: counts are whole, and rounded down.

use std::f64::consts::PI;
use std::path::Path;

use controller_core::hal::WheelCounts;
use controller_core::odometry::{Calibration, OdometryParams};
use controller_core::scalar::Scalar;
use controller_core::types::{Pose, WheelTorques, Wrench};
use controller_core::wheels::WheelGeometry;
use sim_host::mission::BaseSpec as File;

use crate::ideal::Robot;
use crate::motion_base::{Base, Body};

/// Counts per turn of a wheel.
pub const COUNTS: f64 = 2048.0;

/// The three bases, by their file's name.
pub fn bases() -> [(&'static str, File); 3] {
    ["hobby-1kg", "lab-10kg", "paper-30kg"].map(|name| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../bases");
        let file = File::load(&root.join(name).with_extension("toml"));
        (name, file.expect("a base of the project"))
    })
}

/// Odometry with 2,048 counts a turn.
pub fn odometry<T: Scalar>(file: &File, bandwidth: f64) -> OdometryParams<T> {
    let (f, wheels) = (T::from_f64, &file.robot.wheels);
    OdometryParams {
        wheels: WheelGeometry {
            radius_right_m: f(wheels.radius_right_m),
            radius_left_m: f(wheels.radius_left_m),
            track_m: f(wheels.track_m),
        },
        calibration: Calibration::NOMINAL,
        counts_per_turn: f(COUNTS),
        bandwidth: f(bandwidth),
    }
}

/// A robot with encoders.
#[derive(Clone, Copy, Debug)]
pub struct Encoded {
    /// The true robot.
    pub body: Body,
    /// True wheels: calibrated ones may differ from what odometry believes.
    pub wheels: WheelGeometry<f64>,
    /// Travel of the right and the left wheel \[m\].
    pub travel: (f64, f64),
}

impl Encoded {
    /// At rest at `pose`, both encoders in the middle of count 0.
    pub fn new(file: &File, pose: Pose<f64>) -> Self {
        let wheels = file.robot.wheels;
        let half = |radius: f64| PI * radius / COUNTS;
        Self {
            body: Body::at(pose.x, pose.y, pose.theta),
            wheels,
            travel: (half(wheels.radius_right_m), half(wheels.radius_left_m)),
        }
    }

    /// What moves it, as its file says.
    pub fn plant(file: &File) -> Base {
        Base::of(&file.motion())
    }

    /// What the encoders show; the counters wrap.
    pub fn counts(&self) -> WheelCounts {
        let count = |travel: f64, radius: f64| {
            (travel * COUNTS / (2.0 * PI * radius)).floor() as i64 as i32
        };
        WheelCounts {
            right: count(self.travel.0, self.wheels.radius_right_m),
            left: count(self.travel.1, self.wheels.radius_left_m),
        }
    }
}

impl Robot for Encoded {
    type Build = Base;
    type Held = WheelTorques<f64>;

    fn after(&self, plant: &Base, torques: &WheelTorques<f64>, dt: f64) -> Self {
        let (right, left) = (
            torques.right / self.wheels.radius_right_m,
            torques.left / self.wheels.radius_left_m,
        );
        let lever = 0.5 * self.wheels.track_m;
        let wrench = Wrench {
            force: right + left,
            moment: lever * (right - left),
        };
        let body = self.body.after(plant, &wrench, dt);
        let (before, after) = (self.body.twist, body.twist);
        let way = 0.5 * dt * (before.linear + after.linear);
        let turn = 0.5 * dt * (before.angular + after.angular);
        let (right, left) = self.travel;
        Self {
            body,
            travel: (right + (way + lever * turn), left + (way - lever * turn)),
            ..*self
        }
    }
}
