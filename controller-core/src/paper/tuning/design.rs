//! One trial of a design: the lateral pair placed, its response, what it asks of the base.

use super::spec::DesignSpec;
use crate::maths::Maths;
use crate::paper::params::Params;
use crate::paper::stability::{PathLoop, lateral, longitudinal};
use crate::range::smaller;
use crate::scalar::Scalar;
use crate::stability::{Polynomial, edge};
use crate::tuning::Why;
use crate::tuning::response::{Response, response};

/// A/ω: the neurons are this much faster than the lateral pair, as with the gains G.
const NEURONS: f64 = 4.5;
/// Bandwidth of a velocity loop over A beyond which it counts as ideal for the time of a response.
const STIFF: f64 = 7.0;
/// How much longer than the linear loop the neurons take, times A \[1/s\]: an error e is answered with
/// A/(A + |e|) of the linear gain. Fitted for 0.5 m; over A from 0.7/s to 6/s right to 3 %.
const SOFTER: f64 = 0.3;
/// The offset that the specification is about \[m\].
const OFFSET: f64 = 0.5;

/// Gains for a trial of ω, and what stands against them.
pub(super) struct Design<'a, T> {
    base: &'a Params<T>,
    spec: &'a DesignSpec<T>,
    /// Imaginary part of the pair for ω = 1.
    swing: T,
}

impl<'a, T: Scalar> Design<'a, T> {
    pub(super) fn new<M: Maths<T>>(base: &'a Params<T>, spec: &'a DesignSpec<T>) -> Self {
        let swing = M::sqrt(T::ONE - spec.damping * spec.damping);
        Self { base, spec, swing }
    }

    /// k₃ and k₂ v_r² that place the pair.
    pub(super) fn path(&self, omega: T) -> PathLoop<T> {
        let a = T::from_f64(NEURONS) * omega;
        let with = |lateral: T, heading: T| PathLoop {
            lateral,
            heading,
            bandwidth: T::ONE / self.spec.turn_lag_s,
            a,
            b: a,
        };
        let polynomial = |path: PathLoop<T>| lateral(&path).characteristic();
        let root = (-self.spec.damping * omega, self.swing * omega);
        let none = polynomial(with(T::ZERO, T::ZERO));
        let minus = none.scaled(-T::ONE);
        let at = |p: Polynomial<T>| p.plus(&minus).value_at(root);
        let (hr, hi) = at(polynomial(with(T::ZERO, T::ONE)));
        let (xr, xi) = at(polynomial(with(T::ONE, T::ZERO)));
        let (nr, ni) = none.value_at(root);
        let determinant = hr * xi - xr * hi;
        let heading = (xr * ni - nr * xi) / determinant;
        let lateral = (nr * hi - hr * ni) / determinant;
        with(lateral, heading)
    }

    /// The pair can be had, or what stands against it.
    pub(super) fn lateral(&self, omega: T) -> Result<(), Why> {
        let f = T::from_f64;
        let path = self.path(omega);
        let placed = path.heading > T::ZERO && path.lateral > T::ZERO;
        let whole = lateral(&path).characteristic();
        let decay = f(0.98) * self.spec.damping * omega;
        if !(placed && whole.shifted(decay).is_hurwitz()) {
            return Err(Why::Lag);
        }
        let faster = PathLoop {
            lateral: f(2.25) * path.lateral,
            ..path
        };
        if !lateral(&faster).is_stable() {
            return Err(Why::Stability);
        }
        let Some(limit) = self.base.max_wheel_torque_nm else {
            return Ok(());
        };
        // e_θ = e_y'/v_r, so ẇ = −e_y'''/v_r.
        let peak = self.response(&path, omega).peak_third;
        let moment = self.base.robot.inertia_kg_m2 * f(OFFSET) * peak / self.spec.speed;
        let wheels = &self.base.robot.wheels;
        if largest_radius(self.base) * moment / wheels.track_m > limit {
            return Err(Why::Torque);
        }
        Ok(())
    }

    pub(super) fn across_time(&self, omega: T) -> T {
        let path = self.path(omega);
        softer(path.a) * self.response(&path, omega).tenth_s
    }

    fn response(&self, path: &PathLoop<T>, omega: T) -> Response<T> {
        // A stiffer loop changes nothing that can be seen, but is stiff to integrate.
        let path = PathLoop {
            bandwidth: smaller(path.bandwidth, T::from_f64(STIFF) * path.a),
            ..*path
        };
        let push = path.lateral * path.b * (path.b + path.bandwidth);
        let horizon = T::from_f64(9.0) / (self.spec.damping * omega);
        response(&lateral(&path).characteristic(), push, horizon)
    }

    /// The pose gain of a channel that settles in time.
    pub(super) fn gain(&self, bandwidth: T, a: T) -> Result<T, Why> {
        let f = T::from_f64;
        let desired = self.spec.settling_s;
        let bandwidth = smaller(bandwidth, f(STIFF) * a);
        let run = |gain: T| {
            let whole = longitudinal(gain, bandwidth, a, a).characteristic();
            let push = gain * a * (a + bandwidth);
            let mut found = response(&whole, push, f(7.0) / gain);
            found.tenth_s = softer(a) * found.tenth_s;
            found
        };
        let gain = edge(T::ZERO, a / f(4.0), |gain| run(gain).tenth_s > desired);
        let found = run(gain);
        if found.tenth_s > desired * f(1.001) {
            return Err(Why::Lag);
        }
        if let Some(limit) = self.base.max_wheel_torque_nm {
            let force = self.base.robot.mass_kg * f(OFFSET) * found.peak_second;
            if T::HALF * largest_radius(self.base) * force > limit {
                return Err(Why::Torque);
            }
        }
        Ok(gain)
    }
}

fn softer<T: Scalar>(a: T) -> T {
    T::ONE + T::from_f64(SOFTER) / a
}

fn largest_radius<T: Scalar>(base: &Params<T>) -> T {
    let wheels = &base.robot.wheels;
    if wheels.radius_right_m > wheels.radius_left_m {
        wheels.radius_right_m
    } else {
        wheels.radius_left_m
    }
}
