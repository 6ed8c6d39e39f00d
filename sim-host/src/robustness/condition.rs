//! What is wrong with the world, and with the controller's idea of it.

use crate::precision::Precision;
use controller_core::types::Wrench;

/// Everything that may differ from the nominal loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Control period \[s\]; torques are held over it.
    pub period_s: f64,
    /// True mass over believed mass.
    pub mass_factor: f64,
    /// True moment of inertia over believed one.
    pub inertia_factor: f64,
    /// Largest force \[N\] and moment \[N m\] that act, each on its own.
    ///
    /// The paper's law does not know of it. The default law gets it as its limits: see
    /// [`super::base_with_limits`].
    pub saturation: Option<Wrench<f64>>,
    /// White noise of a measured position, per sample and axis, standard deviation \[m\].
    pub position_noise_m: f64,
    /// The same of the heading \[rad\].
    pub heading_noise_rad: f64,
    /// The same of v \[m/s\] and w \[rad/s\].
    pub twist_noise: f64,
    /// Age of a pose when the controller gets it \[s\]. Twists are not late: encoders are near.
    pub pose_latency_s: f64,
    /// A constant force along the robot's heading \[N\], for example a slope.
    pub push_n: f64,
    /// Coulomb friction of each wheel \[N m\].
    pub wheel_friction_nm: f64,
    /// Number type of the controller.
    pub precision: Precision,
    /// Length of the run \[s\].
    pub duration_s: f64,
}

impl Disturbance {
    /// Nothing wrong, at 10 ms.
    pub const NOMINAL: Self = Self {
        period_s: 0.01,
        mass_factor: 1.0,
        inertia_factor: 1.0,
        saturation: None,
        position_noise_m: 0.0,
        heading_noise_rad: 0.0,
        twist_noise: 0.0,
        pose_latency_s: 0.0,
        push_n: 0.0,
        wheel_friction_nm: 0.0,
        precision: Precision::F64,
        duration_s: 20.0,
    };

    /// Whether runs differ by their seed.
    pub fn is_random(&self) -> bool {
        self.position_noise_m > 0.0 || self.heading_noise_rad > 0.0 || self.twist_noise > 0.0
    }
}

/// What a condition changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Nothing.
    Nominal,
    /// Control period.
    Period,
    /// Mass and inertia other than believed.
    Inertia,
    /// Torque saturation.
    Saturation,
    /// Noise of poses or twists.
    Noise,
    /// Age of poses.
    Latency,
    /// Forces that the model does not know.
    Force,
    /// Single precision.
    Precision,
    /// Several at once.
    Together,
}

/// A range that a figure is expected in; one number if both are equal.
pub type Range = (f64, f64);

/// Figures of the paper's law that an independent double-precision calculation gave, in units of
/// the table. Nothing where it gave none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// Settling time \[s\].
    pub settling_s: Option<Range>,
    /// Position error at the end \[mm\].
    pub final_mm: Option<Range>,
    /// Standard deviation of the moment while following \[N m\].
    pub moment_std_nm: Option<f64>,
    /// The robot is lost, or never settles.
    pub fails: bool,
}

/// A line of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// For people.
    pub name: String,
    /// What it changes.
    pub group: Group,
    /// By how much.
    pub disturbance: Disturbance,
    /// For the line and the curve.
    pub expected: [Expected; 2],
}
