//! What gains are worth: a sum of parts, the smaller the better.

use crate::trials::Figures;
use controller_core::maths::Libm;
use controller_core::motion::MotionGains;
use controller_core::tuning::motion::margins;
use serde::Serialize;

/// The parts of a score, weighted; means over runs. Without a unit: each figure stands over what would
/// be one point of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// Time until parked, from the route's end or the start of a park: a point for 10 s.
    pub time: f64,
    /// True error at the end: half a point for each 5 mm and for each 10 mrad, at most 5.
    pub error: f64,
    /// Root mean square distance to the reference: half a point for 10 mm, at most 2.5; that much also if the
    /// robot never came onto it.
    pub tracking: f64,
    /// Torque ripple at rest: half a point for 1 % of the wheels' limit, at most 2.5.
    pub ripple: f64,
    /// Root mean square torque: a fifth of a point for 10 % of the limit.
    pub effort: f64,
    /// Not parked, or stopped by a fault: 10 points, more than all the above of a run that parked.
    pub lost: f64,
    /// Margins below what is healthy, see [`health`].
    pub health: f64,
}

/// Points of a run that did not park.
const LOST: f64 = 10.0;

impl Score {
    /// Names of the parts, in order.
    pub const NAMES: [&str; 7] = [
        "time", "error", "tracking", "ripple", "effort", "lost", "health",
    ];

    /// The parts in the order of [`Score::NAMES`].
    pub const fn parts(&self) -> [f64; 7] {
        [
            self.time,
            self.error,
            self.tracking,
            self.ripple,
            self.effort,
            self.lost,
            self.health,
        ]
    }

    /// Their sum.
    pub fn total(&self) -> f64 {
        self.parts().iter().sum()
    }

    /// One run, whose route ends at `end_s` and is none where the robot only parks.
    pub(crate) fn of(figures: &Figures, end_s: Option<f64>) -> Self {
        let late = (figures.time_s - end_s.unwrap_or(0.0)).max(0.0);
        let error = figures.error_m / 5.0e-3 + figures.error_rad / 10.0e-3;
        let off = figures.tracking_m.map_or(5.0, |rms| rms / 10.0e-3);
        Self {
            time: 0.1 * late,
            error: (0.5 * error).min(5.0),
            tracking: end_s.map_or(0.0, |_| 0.5 * off.min(5.0)),
            ripple: 0.5 * (figures.ripple.unwrap_or(0.0) / 0.01).min(5.0),
            effort: 0.2 * figures.effort / 0.1,
            lost: if figures.parked { 0.0 } else { LOST },
            health: 0.0,
        }
    }

    /// The mean of runs, in their order.
    pub(crate) fn mean(runs: &[Self], health: f64) -> Self {
        let count = runs.len().max(1) as f64;
        let mean = |part: fn(&Self) -> f64| runs.iter().map(part).sum::<f64>() / count;
        Self {
            time: mean(|run| run.time),
            error: mean(|run| run.error),
            tracking: mean(|run| run.tracking),
            ripple: mean(|run| run.ripple),
            effort: mean(|run| run.effort),
            lost: mean(|run| run.lost),
            health,
        }
    }
}

/// Age of the poses that every loop of tuned gains survives \[s\]: twice the 60 ms of a camera that needs two frames
/// (`world::presets`), and half a period of 20 Hz.
pub const POSE_DELAY_S: f64 = 0.15;
/// Delay of the torque that every loop of tuned gains survives \[s\], on a base of this control period \[s\]: five times what
/// measuring, computing and holding take, one and a half ticks; at least the threshold of
/// [`controller_core::tuning::Concern::ShortOfTorqueDelay`], and no more than gains that follow from limits survive, 0.107 s at 20 ms
/// and 0.119 s at 50 ms: five times of what a tick of 50 ms takes, 0.375 s, survive only gains with which parks do not end.
pub const fn torque_delay_s(period_s: f64) -> f64 {
    (7.5 * period_s).clamp(0.05, 0.1)
}

/// What the linear loops lack of being healthy: for damping, [`POSE_DELAY_S`], [`torque_delay_s`] and the mass of
/// [`controller_core::tuning::Concern`] 10 points times the share that is missing; 20 more if a loop is unstable.
/// 0 for healthy gains.
pub fn health(gains: &MotionGains<f64>, period_s: f64) -> f64 {
    let worst = margins::<f64, Libm>(gains).worst();
    let missing = [
        worst.damping / 0.4,
        worst.pose_delay_s / POSE_DELAY_S,
        worst.torque_delay_s / torque_delay_s(period_s),
        worst.heavier / 2.0,
    ];
    let missing = missing.iter().map(|share| (1.0 - share).clamp(0.0, 1.0));
    let unstable = if worst.is_stable() { 0.0 } else { 20.0 };
    10.0 * missing.sum::<f64>() + unstable
}

#[cfg(test)]
mod tests {
    use super::health;
    use crate::mission::BaseSpec;
    use crate::scenario::BASES;
    use controller_core::motion::MotionGains;

    #[test]
    fn gains_for_limits_are_healthy_and_stiffer_ones_are_not() {
        let good = BaseSpec::default().motion().gains;
        assert_eq!(health(&good, 0.01), 0.0);
        // Unstable from (A + k₃) k₃/c = 18 times on.
        let stiff = MotionGains {
            lateral: 40.0 * good.lateral,
            ..good
        };
        assert!(health(&stiff, 0.01) > 20.0);
    }

    #[test]
    fn gains_for_limits_are_healthy_at_every_period() {
        for built_in in BASES {
            for period_s in [0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05] {
                let mut base = built_in.base().expect("a shipped file");
                base.gains = None;
                base.hardware.as_mut().expect("with hardware").period_s = period_s;
                let found = health(&base.motion().gains, period_s);
                assert_eq!(found, 0.0, "{} at {period_s} s", built_in.name);
            }
        }
    }
}
