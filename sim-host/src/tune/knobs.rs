//! The gains that are searched, and their logarithms.

use controller_core::motion::MotionGains;

/// A gain that is searched.
#[derive(Clone, Copy, Debug)]
pub struct Knob {
    /// Its key in `[gains]`.
    pub key: &'static str,
    /// With its unit, for people.
    pub unit: &'static str,
    get: fn(&MotionGains<f64>) -> f64,
    set: fn(&mut MotionGains<f64>, f64),
    /// What the core accepts.
    range: (f64, f64),
}

macro_rules! knobs {
    ($($key:ident, $unit:literal, $low:literal, $high:literal;)*) => {
        /// All of them. The other gains are bounds, which follow from the limits.
        pub const KNOBS: [Knob; 8] = [$(Knob {
            key: stringify!($key),
            unit: $unit,
            get: |gains| gains.$key,
            set: |gains, value| gains.$key = value,
            range: ($low, $high),
        }),*];
    };
}

knobs! {
    longitudinal, "1/s", 1.0e-3, 100.0;
    heading, "1/s", 1.0e-3, 100.0;
    lateral, "1/s^2", 1.0e-3, 100.0;
    approach, "1/s", 1.0e-3, 100.0;
    speed_loop, "1/s", 0.1, 1.0e3;
    turn_loop, "1/s", 0.1, 1.0e3;
    disturbance, "1/s", 1.0e-2, 50.0;
    decay, "1/s", 0.1, 100.0;
}

impl Knob {
    /// Its value.
    pub fn of(&self, gains: &MotionGains<f64>) -> f64 {
        (self.get)(gains)
    }

    /// Sets it, within what the core accepts.
    pub fn put(&self, gains: &mut MotionGains<f64>, value: f64) {
        (self.set)(gains, value.clamp(self.range.0, self.range.1));
    }
}

/// Logarithms of all knobs. Gains act by their ratios: a step of the simplex is the same share of each.
pub(super) fn logs(gains: &MotionGains<f64>) -> Vec<f64> {
    let value = |knob: &Knob| knob.of(gains).clamp(knob.range.0, knob.range.1);
    KNOBS.iter().map(|knob| libm::log(value(knob))).collect()
}

/// `plain` with the knobs of these logarithms, rounded to three digits: more mean nothing, and a file
/// should say exactly what was tried.
pub(super) fn gains(plain: &MotionGains<f64>, logs: &[f64]) -> MotionGains<f64> {
    let mut gains = *plain;
    for (knob, log) in KNOBS.iter().zip(logs) {
        let value = libm::exp(*log);
        let rounded = format!("{value:.2e}").parse().unwrap_or(value);
        knob.put(&mut gains, rounded);
    }
    gains
}
