//! The realistic plant with a disturbance in it, from torques to measurements.

use super::StudyError;
use super::condition::Disturbance;
use crate::world::{Actuation, BodyKeys, FrictionParams, PoseSourceParams, World, WorldKeys};
use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist, WheelTorques, Wrench};
use controller_core::wheels::WheelMap;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// A world behind saturating actuators, with a push along the robot, a pose with each tick and twists with noise.
#[derive(Clone, Debug)]
pub(super) struct Body {
    world: World,
    wheels: WheelMap<f64>,
    saturation: Option<Wrench<f64>>,
    push_n: f64,
    period_us: u32,
    /// The newest pose that arrived. A robot that has not moved for long before the start is known there.
    pose: Pose<f64>,
    twist_noise: f64,
    random: Pcg64Mcg,
}

impl Body {
    /// `believed` is the controller's idea of the robot, which the disturbance makes untrue. All noise follows from
    /// `seed` alone, so that laws compared meet the same noise.
    pub(super) fn new(
        believed: &Robot<f64>,
        start: &Measured<f64>,
        disturbance: &Disturbance,
        seed: u64,
    ) -> Result<Self, StudyError> {
        let friction_nm = disturbance.wheel_friction_nm;
        let keys = WorldKeys {
            body: BodyKeys {
                mass_factor: disturbance.mass_factor,
                inertia_factor: disturbance.inertia_factor,
                ..BodyKeys::default()
            },
            friction: FrictionParams {
                static_nm: friction_nm,
                coulomb_nm: friction_nm,
                ..FrictionParams::default()
            },
            pose_source: Some(PoseSourceParams {
                rate_hz: 1.0 / disturbance.period_s,
                latency_s: disturbance.pose_latency_s,
                noise_m: disturbance.position_noise_m,
                noise_rad: disturbance.heading_noise_rad,
                drop_probability: 0.0,
                bias_m: [0.0; 2],
                bias_rad: 0.0,
            }),
            ..WorldKeys::default()
        };
        Ok(Self {
            world: World::new(&keys.params(believed), start, seed)?,
            wheels: WheelMap::from_geometry(&believed.wheels)?,
            saturation: disturbance.saturation,
            push_n: disturbance.push_n,
            period_us: (1.0e6 * disturbance.period_s).round() as u32,
            pose: start.pose,
            twist_noise: disturbance.twist_noise,
            random: Pcg64Mcg::seed_from_u64(seed),
        })
    }

    pub(super) fn truth(&self) -> Measured<f64> {
        self.world.truth()
    }

    /// The measurement of a tick.
    pub(super) fn measure(&mut self) -> Measured<f64> {
        if let Some((pose, _)) = self.world.fix() {
            self.pose = pose;
        }
        let Twist { linear, angular } = self.world.truth().twist;
        let noise = [(); 2].map(|()| -> f64 { StandardNormal.sample(&mut self.random) });
        Measured {
            pose: self.pose,
            twist: Twist {
                linear: linear + self.twist_noise * noise[0],
                angular: angular + self.twist_noise * noise[1],
            },
        }
    }

    /// Moves on by a period with both torques held; returns the wrench that the actuators exert.
    pub(super) fn advance(
        &mut self,
        torques: &WheelTorques<f64>,
    ) -> Result<Wrench<f64>, StudyError> {
        let asked = self.wheels.wrench(torques);
        let exerted = match &self.saturation {
            None => asked,
            Some(limit) => Wrench {
                force: asked.force.clamp(-limit.force, limit.force),
                moment: asked.moment.clamp(-limit.moment, limit.moment),
            },
        };
        let WheelTorques { right, left } = self.wheels.torques(&Wrench {
            force: exerted.force + self.push_n,
            ..exerted
        });
        let command = Actuation::Torque { right, left };
        self.world.advance(&command, self.period_us)?;
        Ok(exerted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(disturbance: &Disturbance, seed: u64) -> Body {
        let start = Measured {
            pose: Pose::default(),
            twist: Twist::new(1.0, 0.0),
        };
        Body::new(&Robot::paper(), &start, disturbance, seed).expect("a plant")
    }

    fn poses(disturbance: &Disturbance, seed: u64, ticks: usize) -> Vec<f64> {
        let mut body = body(disturbance, seed);
        let next = |_| {
            let x = body.measure().pose.x;
            body.advance(&WheelTorques::default()).expect("a tick");
            x
        };
        (0..ticks).map(next).collect()
    }

    #[test]
    fn a_late_pose_is_that_of_so_many_ticks_ago() {
        let late = Disturbance {
            pose_latency_s: 0.03,
            ..Disturbance::NOMINAL
        };
        let expected = [0.0, 0.0, 0.0, 0.0, 0.01, 0.02];
        for (x, expected) in poses(&late, 0, 6).iter().zip(expected) {
            assert!((x - expected).abs() < 1.0e-9, "{x} for {expected}");
        }
    }

    #[test]
    fn noise_has_the_deviation_asked_for_and_follows_from_the_seed() {
        let noisy = Disturbance {
            position_noise_m: 0.005,
            ..Disturbance::NOMINAL
        };
        let off = |seed| -> Vec<f64> {
            let x = poses(&noisy, seed, 10_001);
            let truth = (0..x.len()).map(|tick| 0.01 * tick as f64);
            x.iter().zip(truth).skip(1).map(|(x, at)| x - at).collect()
        };
        let values = off(1);
        let mean_square = values.iter().map(|v| v * v).sum::<f64>() / 1.0e4;
        // The relative error of a deviation from n samples is 1/sqrt(2 n) = 0.7 %; four of them.
        assert!((mean_square.sqrt() / 0.005 - 1.0).abs() < 0.03);
        assert_eq!(values, off(1));
        assert_ne!(values, off(2));
    }

    #[test]
    fn friction_holds_a_standing_robot_and_takes_its_part_of_a_moving_ones_torque() {
        let rubbed = Disturbance {
            wheel_friction_nm: 0.2,
            ..Disturbance::NOMINAL
        };
        let speed = |torque: f64| {
            let start = Measured::default();
            let mut body = Body::new(&Robot::paper(), &start, &rubbed, 0).expect("a plant");
            let both = WheelTorques {
                right: torque,
                left: torque,
            };
            for _ in 0..100 {
                body.advance(&both).expect("a tick");
            }
            body.truth().twist.linear
        };
        assert!(speed(0.15).abs() < 1.0e-9);
        // 0.8 N m at 0.1 m on each side move 30 kg for a second.
        assert!((speed(1.0) - 16.0 / 30.0).abs() < 1.0e-3, "{}", speed(1.0));
    }
}
