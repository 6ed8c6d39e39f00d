//! Design specifications and margins for the paper's law, [`crate::paper::neural`].

mod design;
mod gains;
mod spec;

pub use gains::gains;
pub use spec::{DesignSpec, Tolerance};

use crate::maths::Maths;
use crate::paper::params::Params;
use crate::paper::stability::{PathLoop, lateral, longitudinal, max_stable_speed};
use crate::scalar::Scalar;
use crate::tuning::{Channel, LoopMargins, Warning, concern};

/// Margins of the paper's law at one reference speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperMargins<T> {
    /// Tracking, e_x: k₁, k_d1.
    pub longitudinal: LoopMargins<T>,
    /// Tracking, e_y and e_θ: k₂, k₃, k_d2.
    pub lateral: LoopMargins<T>,
    /// Parking, distance: k₄, k_c1.
    pub approach: LoopMargins<T>,
    /// Parking, heading: k₅, k_c2.
    pub heading: LoopMargins<T>,
    /// 4 k₁ k_d1: V₁ + V₂ of Eqs. (25)-(27) never rises if this and the next are at least 1.
    pub lyapunov_longitudinal: T,
    /// 4 k₂ k₃ k_d2.
    pub lyapunov_lateral: T,
    /// Largest stable reference speed \[m/s\], [`max_stable_speed`]; 0 if there is none.
    pub max_speed: T,
}

impl<T: Scalar> PaperMargins<T> {
    /// The worst of all loops, field by field.
    pub fn worst(&self) -> LoopMargins<T> {
        let parking = self.approach.worse(&self.heading);
        self.longitudinal.worse(&self.lateral).worse(&parking)
    }

    /// What is not healthy, if anything.
    pub fn warnings(&self) -> impl Iterator<Item = Warning> {
        [
            (Channel::Longitudinal, self.longitudinal),
            (Channel::Lateral, self.lateral),
            (Channel::Approach, self.approach),
            (Channel::Heading, self.heading),
        ]
        .into_iter()
        .filter_map(|(channel, margins)| concern(channel, &margins))
    }
}

/// Margins of any gains at reference speed `speed` \[m/s\], not 0. Where B and D differ: the worse of
/// both, which is necessary and not sufficient.
///
/// ```
/// use controller_core::maths::Libm;
/// use controller_core::paper::params::Params;
/// use controller_core::paper::tuning::margins;
///
/// let mut params = Params::<f64>::paper();
/// assert_eq!(margins::<f64, Libm>(&params, 0.4).warnings().count(), 0);
/// // The same gains at 1.3 m/s, above their largest stable speed.
/// let fast = margins::<f64, Libm>(&params, 1.3);
/// assert!(fast.max_speed < 1.3);
/// let warning = fast.warnings().next().expect("one");
/// assert_eq!(warning.to_string(), "across the path: the loop is unstable");
/// ```
pub fn margins<T: Scalar, M: Maths<T>>(params: &Params<T>, speed: T) -> PaperMargins<T> {
    let (tracking, parking) = (&params.tracking, &params.parking);
    let (m, i) = (params.robot.mass_kg, params.robot.inertia_kg_m2);
    let neurons = params.neurons;
    let a = neurons.a;
    let both = |of: &dyn Fn(T) -> LoopMargins<T>| {
        let upper = of(neurons.b);
        if neurons.b == neurons.d {
            upper
        } else {
            upper.worse(&of(neurons.d))
        }
    };
    let channel =
        |gain: T, loop_gain: T| both(&|b| longitudinal(gain, loop_gain, a, b).margins::<M>());
    let four = T::from_f64(4.0);
    PaperMargins {
        longitudinal: channel(tracking.k1, tracking.k_d1 / m),
        lateral: both(&|b| {
            let path = PathLoop {
                lateral: tracking.k2 * speed * speed,
                heading: tracking.k3,
                bandwidth: tracking.k_d2 / i,
                a,
                b,
            };
            lateral(&path).margins::<M>()
        }),
        approach: channel(parking.k4, parking.k_c1 / m),
        heading: channel(parking.k5, parking.k_c2 / i),
        lyapunov_longitudinal: four * tracking.k1 * tracking.k_d1,
        lyapunov_lateral: four * tracking.k2 * tracking.k3 * tracking.k_d2,
        max_speed: max_stable_speed::<T, M>(params).unwrap_or(T::ZERO),
    }
}
