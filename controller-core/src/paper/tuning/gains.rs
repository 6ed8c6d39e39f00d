//! Gains of the paper's law from a design specification.

use super::design::Design;
use super::spec::{DesignSpec, Tolerance};
use crate::maths::Maths;
use crate::paper::params::{Params, ParkingGains, TrackingGains};
use crate::range::smaller;
use crate::scalar::Scalar;
use crate::shunting::NeuronParams;
use crate::stability::edge;
use crate::tuning::error::{in_range, refused};
use crate::tuning::{DesignError, DesignParameter, Why};

impl<T: Scalar> DesignSpec<T> {
    /// [`DesignSpec::settling`] with the time that a tolerance amounts to. All rates scale with one over
    /// the time, so the stiffness k_c1 k₄ = m κ₁ k₄ scales with one over its square.
    ///
    /// # Errors
    /// A number out of range, a force beyond that of the wheels, or a settling time out of range that
    /// the tolerance amounts to.
    pub fn for_tolerance<M: Maths<T>>(
        base: &Params<T>,
        tolerance: Tolerance<T>,
        speed: T,
    ) -> Result<Self, DesignError> {
        let stiffness = match tolerance {
            Tolerance::Steady { force_n, error_m } => {
                in_range(DesignParameter::SteadyForce, force_n, 1.0e-6, 1.0e6)?;
                in_range(DesignParameter::SteadyError, error_m, 1.0e-6, 10.0)?;
                if let Some(most) = largest_force(base)
                    && force_n > most
                {
                    return Err(refused(
                        DesignParameter::SteadyForce,
                        force_n,
                        most,
                        Why::Torque,
                    ));
                }
                force_n / error_m
            }
            Tolerance::FullTorque { error_m } => {
                in_range(DesignParameter::FullTorqueError, error_m, 1.0e-6, 100.0)?;
                let Some(most) = largest_force(base) else {
                    return Err(refused(
                        DesignParameter::FullTorqueError,
                        error_m,
                        T::MAX,
                        Why::Torque,
                    ));
                };
                most / error_m
            }
        };
        let unlimited = Params {
            max_wheel_torque_nm: None,
            ..*base
        };
        // From 1 s on, by the scaling, which the neurons' part in the time makes inexact by some
        // percent: each turn leaves a tenth of that.
        let mut time = T::ONE;
        for _ in 0..5 {
            let found = gains::<T, M>(&unlimited, &Self::settling(time, T::ONE))?.parking;
            time = time * M::sqrt(found.k_c1 * found.k4 / stiffness);
        }
        Ok(Self::settling(time, speed))
    }
}

/// `base` with the gains that meet the specification, its robot, reset and limits unchanged.
///
/// With A = B = D = 4.5 ω, the lateral polynomial of `docs/derivation.md` is linear in k₃ and k₂ v_r²:
/// asking it to vanish at −ζω + jω√(1 − ζ²) gives both. ω, k₁ and k₄ = k₅ are found by bisection such
/// that the response of the linear loop, stretched by 1 + 0.3/A for what the neurons take off the gain
/// of so large an offset, has a tenth left at the specified time: an approximation, right to 5 %.
///
/// Refused are times for which the pair would not dominate (the loops lag too much), that are unstable
/// at half as much again as the speed, or for which 0.5 m would ask more torque of a wheel than it has.
///
/// # Errors
/// The first parameter of the specification that cannot be met, with the nearest value that can.
pub fn gains<T: Scalar, M: Maths<T>>(
    base: &Params<T>,
    spec: &DesignSpec<T>,
) -> Result<Params<T>, DesignError> {
    spec.check()?;
    let desired = spec.settling_s;
    let refusal = match solve::<T, M>(base, spec) {
        Ok(found) => return Ok(found),
        Err(refusal) => refusal,
    };
    let can = |settling_s: T| {
        let slower = DesignSpec {
            settling_s,
            ..*spec
        };
        solve::<T, M>(base, &slower).is_ok()
    };
    // How long it has to be for both channels, to 2 ms.
    let (mut low, mut high) = (desired, T::from_f64(100.0));
    if !can(high) {
        return Err(refused(
            DesignParameter::Settling,
            desired,
            high,
            Why::NoTime,
        ));
    }
    for _ in 0..16 {
        let settling_s = T::HALF * (low + high);
        if can(settling_s) {
            high = settling_s;
        } else {
            low = settling_s;
        }
    }
    Err(refused(DesignParameter::Settling, desired, high, refusal))
}

/// The gains, or what stands against the settling time.
fn solve<T: Scalar, M: Maths<T>>(base: &Params<T>, spec: &DesignSpec<T>) -> Result<Params<T>, Why> {
    let f = T::from_f64;
    let design = Design::new::<M>(base, spec);
    let desired = spec.settling_s;
    let most = f(20.0) / desired;
    // The slowest pair that is quick enough, or the quickest that can be had.
    let omega = edge(f(0.5) / desired, most, |omega| {
        design.lateral(omega).is_ok() && design.across_time(omega) > desired
    });
    if design.across_time(omega) > desired * f(1.001) {
        return Err(design.lateral(omega * f(1.01)).err().unwrap_or(Why::Lag));
    }
    let path = design.path(omega);
    let (speed_loop, turn_loop) = (T::ONE / spec.speed_lag_s, path.bandwidth);
    let a = path.a;
    let k1 = design.gain(speed_loop, a)?;
    let turning = design.gain(turn_loop, a)?;
    // k₄ = k₅: distance and heading shrink alike, and the robot stays on the arc that it came on.
    let k4 = smaller(turning, k1);
    let (m, i) = (base.robot.mass_kg, base.robot.inertia_kg_m2);
    Ok(Params {
        tracking: TrackingGains {
            k1,
            k2: path.lateral / (spec.speed * spec.speed),
            k3: path.heading,
            k_d1: m * speed_loop,
            k_d2: i * turn_loop,
        },
        parking: ParkingGains {
            k4,
            k5: k4,
            k_c1: m * speed_loop,
            k_c2: i * turn_loop,
        },
        neurons: NeuronParams { a, b: a, d: a },
        ..*base
    })
}

fn largest_force<T: Scalar>(base: &Params<T>) -> Option<T> {
    Some(base.robot.wheels.force_n(base.max_wheel_torque_nm?))
}
