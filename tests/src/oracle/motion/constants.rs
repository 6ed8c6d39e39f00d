//! What the law knows of a base, and what follows from it.

use nalgebra::{Matrix2, Vector2};

use super::Pair;
use super::neuron::Rule;

/// Who yields where both wheels cannot be served.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// Both.
    KeepCurvature,
    /// The force.
    TurnFirst,
    /// The moment.
    DriveFirst,
}

/// Share of the wheels' torque for commands.
pub(super) const COMMAND_SHARE: f64 = 0.75;

/// σ_max of section 8.
pub const LARGEST_LOAD: f64 = 0.4;

/// A base, its limits and gains. Names are those of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// (m, I) \[kg, kg m²\].
    pub inertia: Pair,
    /// Radii, right and left \[m\].
    pub radius: Vector2<f64>,
    /// l \[m\].
    pub track: f64,
    /// Largest speed and turn rate.
    pub speed: Pair,
    /// Largest speed of the faster wheel's rim \[m/s\].
    pub rim_speed: f64,
    /// Largest acceleration away from rest.
    pub accel: Pair,
    /// Largest acceleration towards rest.
    pub brake: Pair,
    /// Largest rate of change of what is fed forward.
    pub jerk: Pair,
    /// Largest torque of a wheel \[N m\].
    pub torque: f64,
    /// Who yields.
    pub policy: Policy,
    /// A \[1/s\].
    pub a: f64,
    /// k₁ \[1/s\].
    pub k1: f64,
    /// B_v \[m/s\].
    pub b_v: f64,
    /// k₃ \[1/s\].
    pub k3: f64,
    /// c \[1/s²\].
    pub c: f64,
    /// v_f \[m/s\].
    pub v_f: f64,
    /// k₄ \[1/s\].
    pub k4: f64,
    /// p \[m/s²\].
    pub p: f64,
    /// (κ₁, κ₂) \[1/s\].
    pub kappa: Pair,
    /// ω of the disturbance estimate \[1/s\].
    pub omega: f64,
    /// Largest disturbance that is compensated, as a share of the largest force and moment.
    pub disturbance_share: f64,
    /// σ of a pose \[m\].
    pub sigma: f64,
    /// Tolerance of arrival \[m\], \[rad\].
    pub tolerance: (f64, f64),
    /// How long the robot has to be inside \[s\].
    pub dwell: f64,
    /// Once parked there is no torque.
    pub release: bool,
    /// A stall: \[m/s\], \[s\].
    pub stall: (f64, f64),
    /// New approaches.
    pub retries: u8,
    /// Jumps of the error that are detected \[m\], \[rad\].
    pub jump: Option<(f64, f64)>,
    /// How neurons are advanced.
    pub rule: Rule,
}

impl Constants {
    /// Wheel torques (right, left) to (force, moment), by virtual work.
    pub fn wheels_to_wrench(&self) -> Matrix2<f64> {
        let lever = self.track / 2.0;
        Matrix2::new(1.0, 1.0, lever, -lever) * Matrix2::from_diagonal(&self.radius.map(f64::recip))
    }

    /// The largest force and moment of the wheels.
    pub fn largest_wrench(&self) -> Pair {
        let force = self.torque / self.radius.x + self.torque / self.radius.y;
        Pair::new(force, self.track / 2.0 * force)
    }

    /// The largest angular acceleration of a command, with the limits' and with what the wheels give to one (section 5).
    pub fn turning_reach(&self) -> f64 {
        self.accel
            .y
            .min(COMMAND_SHARE * self.largest_wrench().y / self.inertia.y)
    }

    /// D of section 8.
    pub fn disturbance_bound(&self) -> Pair {
        self.disturbance_share * self.largest_wrench()
    }

    /// L of section 6.
    pub fn wrench_rate_limit(&self) -> Pair {
        let accel = self.accel.sup(&self.brake);
        let reach = self.largest_wrench().component_div(&self.inertia);
        let fed = (1.0 + 2.0 * LARGEST_LOAD) * self.jerk;
        let rate = fed + self.kappa.component_mul(&(accel + reach));
        self.inertia.component_mul(&rate) + self.omega * self.disturbance_bound()
    }

    /// Radius in which the direction of the goal is noise \[m\], and whether that is the poses' noise.
    pub fn noise_radius(&self) -> (f64, bool) {
        let least = 3e-4;
        let noise = 5.0 * self.sigma;
        (noise.max(least), noise > least)
    }

    /// A twist within the limits: each axis, and along its arc the faster wheel's rim.
    pub fn reachable(&self, twist: &Pair) -> Pair {
        let each = twist.sup(&-self.speed).inf(&self.speed);
        each * (self.rim_speed / self.rim(&each).max(self.rim_speed))
    }

    /// Speed of the faster wheel's rim.
    pub fn rim(&self, twist: &Pair) -> f64 {
        twist.x.abs() + self.track / 2.0 * twist.y.abs()
    }
}
