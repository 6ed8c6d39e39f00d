//! What the controller measures of the robot.

use super::condition::Disturbance;
use controller_core::types::{Measured, Pose, Twist};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::collections::VecDeque;

/// Poses with noise, some ticks late; twists with noise.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    noise: Pcg64Mcg,
    position_m: f64,
    heading_rad: f64,
    twist: f64,
    /// Poses on their way, the oldest first; full once it holds the delay and one.
    underway: VecDeque<Pose<f64>>,
    delay: usize,
}

impl Sensor {
    /// A sensor whose noise follows from `seed` alone, so that laws compared meet the same noise.
    pub(super) fn new(disturbance: &Disturbance, seed: u64) -> Self {
        Self {
            noise: Pcg64Mcg::seed_from_u64(seed),
            position_m: disturbance.position_noise_m,
            heading_rad: disturbance.heading_noise_rad,
            twist: disturbance.twist_noise,
            underway: VecDeque::new(),
            delay: (disturbance.pose_latency_s / disturbance.period_s).round() as usize,
        }
    }

    /// The measurement of a tick. A robot that has not moved for long before the start is known
    /// there: until the first late pose is in, the start's is used.
    pub(super) fn measure(&mut self, truth: &Measured<f64>) -> Measured<f64> {
        let pose = Pose {
            x: truth.pose.x + self.position_m * self.normal(),
            y: truth.pose.y + self.position_m * self.normal(),
            theta: truth.pose.theta + self.heading_rad * self.normal(),
        };
        let twist = Twist {
            linear: truth.twist.linear + self.twist * self.normal(),
            angular: truth.twist.angular + self.twist * self.normal(),
        };
        self.underway.push_back(pose);
        if self.underway.len() > self.delay + 1 {
            self.underway.pop_front();
        }
        Measured {
            pose: self.underway.front().copied().unwrap_or(pose),
            twist,
        }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Measured<f64> {
        Measured {
            pose: Pose::new(x, 0.0, 0.0),
            twist: Twist::new(1.0, 0.0),
        }
    }

    #[test]
    fn a_late_pose_is_that_of_so_many_ticks_ago() {
        let late = Disturbance {
            pose_latency_s: 0.03,
            ..Disturbance::NOMINAL
        };
        let mut sensor = Sensor::new(&late, 0);
        let measured: Vec<_> = (0..6)
            .map(|tick| sensor.measure(&at(f64::from(tick))).pose.x)
            .collect();
        assert_eq!(measured, [0.0, 0.0, 0.0, 0.0, 1.0, 2.0]);
    }

    #[test]
    fn noise_has_the_deviation_asked_for_and_follows_from_the_seed() {
        let noisy = Disturbance {
            position_noise_m: 0.005,
            ..Disturbance::NOMINAL
        };
        let draw = |seed| {
            let mut sensor = Sensor::new(&noisy, seed);
            let mut next = || sensor.measure(&at(0.0)).pose.x;
            (0..10_000).map(|_| next()).collect::<Vec<f64>>()
        };
        let values = draw(1);
        let mean_square = values.iter().map(|v| v * v).sum::<f64>() / 1.0e4;
        // The relative error of a deviation from n samples is 1/sqrt(2 n) = 0.7 %; four of them.
        assert!((mean_square.sqrt() / 0.005 - 1.0).abs() < 0.03);
        assert_eq!(values, draw(1));
        assert_ne!(values, draw(2));
    }
}
