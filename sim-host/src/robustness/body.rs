//! The robot with everything that acts on it.

use super::condition::Disturbance;
use super::friction::Friction;
use crate::plant::Plant;
use controller_core::error::ParamError;
use controller_core::robot::Robot;
use controller_core::types::{Measured, WheelTorques, Wrench};
use controller_core::wheels::WheelMap;

/// The plant behind saturating actuators, with a push and friction.
#[derive(Clone, Debug)]
pub(super) struct Body {
    plant: Plant,
    wheels: WheelMap<f64>,
    saturation: Option<Wrench<f64>>,
    push_n: f64,
    friction: Option<Friction>,
}

impl Body {
    /// `believed` is the controller's idea of the robot, which the disturbance makes untrue.
    pub(super) fn new(
        believed: &Robot<f64>,
        start: &Measured<f64>,
        disturbance: &Disturbance,
    ) -> Result<Self, ParamError> {
        let robot = Robot {
            mass_kg: believed.mass_kg * disturbance.mass_factor,
            inertia_kg_m2: believed.inertia_kg_m2 * disturbance.inertia_factor,
            wheels: believed.wheels,
        };
        let friction = disturbance.wheel_friction_nm;
        Ok(Self {
            plant: Plant::new(robot, start),
            wheels: WheelMap::from_geometry(&robot.wheels)?,
            saturation: disturbance.saturation,
            push_n: disturbance.push_n,
            friction: (friction > 0.0).then(|| Friction::new(&robot, friction)),
        })
    }

    pub(super) fn truth(&self) -> Measured<f64> {
        self.plant.truth()
    }

    /// Moves on by `dt` \[s\] with both torques held; returns the wrench that the actuators exert.
    pub(super) fn advance(&mut self, torques: &WheelTorques<f64>, dt: f64) -> Wrench<f64> {
        let asked = self.wheels.wrench(torques);
        let exerted = match &self.saturation {
            None => asked,
            Some(limit) => Wrench {
                force: asked.force.clamp(-limit.force, limit.force),
                moment: asked.moment.clamp(-limit.moment, limit.moment),
            },
        };
        let acting = self.wheels.torques(&Wrench {
            force: exerted.force + self.push_n,
            ..exerted
        });
        match &self.friction {
            None => self.plant.advance(&acting, dt),
            Some(friction) => {
                // Friction changes within a tick, where a wheel stops.
                let substeps = (dt / SUBSTEP_S).ceil().max(1.0);
                let h = dt / substeps;
                for _ in 0..substeps as usize {
                    let speeds = self.wheels.wheel_speeds(&self.plant.truth().twist);
                    let left = friction.reduce(&acting, &speeds, h);
                    self.plant.advance(&left, h);
                }
            }
        }
        exerted
    }
}

/// Friction is held over this \[s\]: a wheel that turns back does so within it.
const SUBSTEP_S: f64 = 1.0e-3;
