//! How the plant is measured and when: tables with defaults of a perfect world.

use serde::Deserialize;

/// Wheel encoders.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EncoderParams {
    /// Counts per turn of a wheel, after gears and quadrature: 1 to 1e7.
    pub counts_per_turn: f64,
    /// Probability per tick and wheel of false counts, 0 to 1.
    pub glitch_probability: f64,
    /// False counts of a glitch, in either direction; they stay.
    pub glitch_counts: u32,
}

impl Default for EncoderParams {
    /// 4096 counts without glitches.
    fn default() -> Self {
        Self {
            counts_per_turn: 4096.0,
            glitch_probability: 0.0,
            glitch_counts: 0,
        }
    }
}

/// A camera, lidar or beacon system that measures the pose of the axle's middle.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseSourceParams {
    /// Poses per second \[Hz\], above 0 to 10,000.
    pub rate_hz: f64,
    /// Time from the moment that a pose is of until it arrives \[s\], 0 to 10.
    #[serde(default)]
    pub latency_s: f64,
    /// Standard deviation of x and of y \[m\].
    #[serde(default)]
    pub noise_m: f64,
    /// Standard deviation of the heading \[rad\].
    #[serde(default)]
    pub noise_rad: f64,
    /// Probability that a pose never arrives, 0 to 1.
    #[serde(default)]
    pub drop_probability: f64,
    /// Constant error of x and of y \[m\].
    #[serde(default)]
    pub bias_m: [f64; 2],
    /// Constant error of the heading \[rad\].
    #[serde(default)]
    pub bias_rad: f64,
}

/// A gyro about the vertical; bias and scale of a run are drawn within their limits.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GyroParams {
    /// Samples per second \[Hz\], 1 to 10,000.
    pub rate_hz: f64,
    /// Time from the last moment that a sample is of until it arrives \[s\], 0 to 0.1.
    #[serde(default)]
    pub latency_s: f64,
    /// Noise density \[rad/s/√Hz\].
    #[serde(default)]
    pub noise_density: f64,
    /// Largest bias at the start \[rad/s\].
    #[serde(default)]
    pub bias_limit: f64,
    /// How fast the bias wanders \[rad/s/√s\].
    #[serde(default)]
    pub bias_walk: f64,
    /// Largest error of the scale, as a share.
    #[serde(default)]
    pub scale_error: f64,
    /// Rate at which it clips \[rad/s\].
    #[serde(default = "endless")]
    pub range: f64,
    /// Least step of its output \[rad/s\].
    #[serde(default)]
    pub resolution: f64,
}

fn endless() -> f64 {
    f64::INFINITY
}

/// Noise of the driver's measurements, once per tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NoiseParams {
    /// Standard deviation of the supply voltage \[V\].
    pub supply_v: f64,
    /// Standard deviation of each motor's current \[A\].
    pub current_a: f64,
}

/// How evenly ticks come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TickParams {
    /// Largest deviation either way of an ordinary tick \[µs\], evenly spread.
    pub jitter_us: u32,
    /// Probability that a tick is late, 0 to 1.
    pub late_probability: f64,
    /// Median lateness of a late tick \[µs\].
    pub late_median_us: f64,
    /// Spread of that lateness: standard deviation of its natural logarithm, 0 to 3.
    pub late_spread: f64,
}
