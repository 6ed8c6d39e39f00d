//! A driver's own loop on the speed of its wheel.

use controller_core::maths::{Libm, Maths};

/// A loop demands torque `gain` ω_c + `integral` − `gain` ω.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpeedLoop {
    /// What the loop is tuned for \[kg m²\]; a wheel with less to move follows sooner.
    moved_kg_m2: f64,
    loop_s: f64,
    /// Speed that its model has reached, and what the wheel lacked of it at the start of the substep \[rad/s\].
    model: f64,
    behind: f64,
    /// Torque that it has integrated \[N m\].
    pub integral: f64,
}

impl SpeedLoop {
    pub fn new(moved_kg_m2: f64, loop_s: f64) -> Self {
        Self {
            moved_kg_m2,
            loop_s,
            model: 0.0,
            behind: 0.0,
            integral: 0.0,
        }
    }

    /// Torque per speed \[N m s/rad\].
    pub fn gain(&self) -> f64 {
        self.moved_kg_m2 / self.loop_s
    }

    /// The model of the loop: ω_m' = (ω_c − ω_m)/T, exactly.
    pub fn follow(&mut self, desired: f64, omega: f64, h: f64) {
        self.behind = self.model - omega;
        self.model -= (desired - self.model) * Libm::exp_m1(-h / self.loop_s);
    }

    /// What the wheel lacks of the model is a load. J e' = −(J/T) e − z + load with z' = J/(4T²) e
    /// is critically damped; without load the model is met and z stays 0.
    pub fn integrate(&mut self, h: f64) {
        let gain = self.moved_kg_m2 / (4.0 * self.loop_s * self.loop_s);
        self.integral += h * gain * self.behind;
    }

    /// Begins anew, at a speed of the wheel.
    pub fn forget(&mut self, omega: f64) {
        self.model = omega;
        self.integral = 0.0;
    }
}
