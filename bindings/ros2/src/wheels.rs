//! Wheels, of which a base at the end of a line sends no counts.

use controller_core::types::Twist;
use controller_core::wheels::WheelMap;
use sim_host::run::WheelStates;

/// Speeds that follow from the measured twist, and angles that follow from the speeds since the first report.
#[derive(Clone, Copy, Debug)]
pub struct Wheels {
    map: WheelMap<f64>,
    angles: [f64; 2],
}

impl Wheels {
    /// At angle 0.
    pub const fn new(map: WheelMap<f64>) -> Self {
        Self {
            map,
            angles: [0.0; 2],
        }
    }

    /// After `dt_s` with this twist.
    pub fn advance(&mut self, dt_s: f64, twist: &Twist<f64>) -> WheelStates {
        let speeds = self.map.wheel_speeds(twist);
        for (angle, speed) in self.angles.iter_mut().zip([speeds.right, speeds.left]) {
            *angle += dt_s * speed;
        }
        WheelStates {
            angles: self.angles,
            speeds,
        }
    }
}
