//! Robot constants, gains and neuron constants.

use nalgebra::Matrix2;
use serde::Deserialize;

/// Every constant of the paper's laws, under the paper's names.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Params {
    /// Mass of the body \[kg\].
    pub m: f64,
    /// Moment of inertia about the vertical axis through the mass centre \[kg m²\].
    #[serde(rename = "I")]
    pub inertia: f64,
    /// Wheel radius \[m\].
    pub r: f64,
    /// Distance of the two wheels \[m\].
    pub l: f64,
    /// Gain of e_x in tracking \[1/s\].
    pub k1: f64,
    /// Gain of e_y in tracking \[1/m²\].
    pub k2: f64,
    /// Gain of sin e_θ in tracking \[1/s\].
    pub k3: f64,
    /// Gain of e_x in parking \[1/s\].
    pub k4: f64,
    /// Gain of e_θ in parking \[1/s\].
    pub k5: f64,
    /// Linear velocity gain in tracking \[N s/m\].
    pub kd1: f64,
    /// Angular velocity gain in tracking \[N m s\].
    pub kd2: f64,
    /// Linear velocity gain in parking \[N s/m\].
    pub kc1: f64,
    /// Angular velocity gain in parking \[N m s\].
    pub kc2: f64,
    /// Passive decay rate of a neuron \[1/s\].
    #[serde(rename = "A")]
    pub a: f64,
    /// Upper bound of a neuron.
    #[serde(rename = "B")]
    pub b: f64,
    /// Magnitude of the lower bound of a neuron, which stays in \[-D, B\].
    #[serde(rename = "D")]
    pub d: f64,
}

impl Params {
    /// The paper's robot (30 kg, 15 kg m²) with gains that meet every claim of its text; the paper prints none.
    pub fn recommended() -> Self {
        Self {
            m: 30.0,
            inertia: 15.0,
            r: 0.1,
            l: 0.5,
            k1: 0.9,
            k2: 6.0,
            k3: 2.0,
            k4: 1.2,
            k5: 1.2,
            kd1: 90.0,
            kd2: 75.0,
            kc1: 90.0,
            kc2: 75.0,
            a: 4.0,
            b: 4.0,
            d: 4.0,
        }
    }

    /// M̄ = diag(m, I) of Eq. (3).
    pub fn mass_matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.m, 0.0, 0.0, self.inertia)
    }

    /// k_d of Eq. (11).
    pub fn tracking_gain(&self) -> Matrix2<f64> {
        Matrix2::new(self.kd1, 0.0, 0.0, self.kd2)
    }

    /// k_c of Eq. (14) and Eq. (21).
    pub fn parking_gain(&self) -> Matrix2<f64> {
        Matrix2::new(self.kc1, 0.0, 0.0, self.kc2)
    }
}
