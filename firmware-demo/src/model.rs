//! A small robot that moves with the torques applied to its wheels: for the demonstration, the emulated robot and tests.
//!
//! Rigid body on two wheels, no slip, a little rolling resistance; Eqs. (1) to (3) by semi-implicit Euler
//! steps. The simulator of the project has the accurate one.

use controller_core::base::WheelAction;
use controller_core::maths::{Maths, Single};
use controller_core::paper::params::ValidParams;
use controller_core::types::{Measured, WheelSpeeds, WheelTorques};

/// The robot.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    params: ValidParams<f32>,
    state: Measured<f32>,
    /// Share of the speed that rolling resistance takes in a second.
    drag_per_s: f32,
}

impl Model {
    /// At `state`, with mass, inertia and wheels of `params`.
    pub const fn new(params: ValidParams<f32>, state: Measured<f32>) -> Self {
        Self {
            params,
            state,
            drag_per_s: 0.05,
        }
    }

    /// What perfect sensors measure.
    pub const fn measured(&self) -> &Measured<f32> {
        &self.state
    }

    /// How fast the wheels turn.
    pub fn wheel_speeds(&self) -> WheelSpeeds<f32> {
        self.params.wheels().wheel_speeds(&self.state.twist)
    }

    /// Lets `dt` \[s\] pass with `action` applied to the wheels; shorted motors take the speed away with a time constant of 0.2 s.
    pub fn act(&mut self, dt: f32, action: &WheelAction<f32>) {
        self.advance(dt, action.torques());
        if *action == WheelAction::Brake {
            let keep = 1.0 - 5.0 * dt;
            let twist = &mut self.state.twist;
            twist.linear *= keep;
            twist.angular *= keep;
        }
    }

    /// Lets `dt` \[s\] pass with `torques` at the wheels; `None` lets them coast.
    pub fn advance(&mut self, dt: f32, torques: Option<WheelTorques<f32>>) {
        let wrench = self.params.wheels().wrench(&torques.unwrap_or_default());
        let robot = &self.params.params().robot;
        let Measured { pose, twist } = &mut self.state;
        let keep = 1.0 - self.drag_per_s * dt;
        twist.linear = keep * twist.linear + dt * (wrench.force / robot.mass_kg);
        twist.angular = keep * twist.angular + dt * (wrench.moment / robot.inertia_kg_m2);
        let (sine, cosine) = Single::sin_cos(pose.theta);
        pose.x += dt * twist.linear * cosine;
        pose.y += dt * twist.linear * sine;
        pose.theta += dt * twist.angular;
    }
}
