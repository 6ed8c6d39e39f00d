//! How often the intervals hold the true values: many logs of a base as its file has it.

use super::record::base_log;
use super::{Entry, IdentifyError, Known, Options, Quantity as Q, SIDES, Verdict, identify};
use crate::mission::{BaseSpec, Hardware};
use crate::rate::clopper_pearson;
use crate::world::{MotorParams, WorldError};
use rayon::prelude::*;
use serde::Serialize;

/// Share of the logs in which intervals have to hold the true value. They are meant for 95 %.
pub const LEAST: f64 = 0.9;
/// Probability, at most, at which a quantity whose true share is [`LEAST`] fails by chance. At a share of 95 %, which intervals are
/// meant for, that of 20 logs or more is below 1.7e-4, so that one of 21 quantities fails in less than one of 250 studies.
pub const CHANCE: f64 = 0.01;

/// Why there is no coverage.
#[derive(Debug, thiserror::Error)]
pub enum CoverageError {
    /// A base of ideal torques.
    #[error("the base has no motors: nothing to identify")]
    NoMotors,
    /// Hardware that is no plant.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A log that contradicts itself, of which none is recorded here.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

/// What many logs said of a quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// Name.
    pub name: String,
    /// The true value.
    pub truth: f64,
    /// Logs that gave a number.
    pub given: usize,
    /// Of these, those whose interval contains the true value.
    pub within: usize,
    /// Mean of half widths over the true value.
    pub half_width: f64,
    /// Mean of errors over the true value.
    pub error: f64,
}

impl Rate {
    /// Share of the numbers whose interval contains the true value; 1 if there were none.
    pub fn share(&self) -> f64 {
        match self.given {
            0 => 1.0,
            given => self.within as f64 / given as f64,
        }
    }

    /// Whether the share is below [`LEAST`], and not by chance: the upper bound of Clopper and Pearson's with the tail [`CHANCE`], which
    /// is the one-sided binomial test.
    pub fn fails(&self) -> bool {
        self.given > 0 && clopper_pearson(self.within, self.given, CHANCE).1 < LEAST
    }

    /// 95 % interval of that share for all logs of this kind.
    pub fn interval(&self) -> [f64; 2] {
        clopper_pearson(self.within, self.given, 0.025).into()
    }
}

/// Rates of all quantities that any log gave.
///
/// # Errors
/// A base that cannot be driven.
pub fn coverage(base: &BaseSpec, runs: usize, seed: u64) -> Result<Vec<Rate>, CoverageError> {
    let hardware = base.hardware.as_ref().ok_or(CoverageError::NoMotors)?;
    let mut known = Known::default();
    let motor = hardware.drivers.motor().ok_or(CoverageError::NoMotors)?;
    known.gear = Some(motor.gear_ratio);
    known.current_limit_a = Some(motor.current_limit_a);
    let options = Options {
        known,
        latency_s: hardware.pose_source.map_or(0.0, |source| source.latency_s),
        ..Options::default()
    };
    let logs: Vec<Vec<Entry>> = (0..runs as u64)
        .into_par_iter()
        .map(|run| {
            let log = base_log(base, (hardware, motor), seed.wrapping_add(run))?;
            let found = identify(&log, &options)?;
            Ok([found.quantities, found.combinations].concat())
        })
        .collect::<Result<_, CoverageError>>()?;
    let truths = truths(base, (hardware, motor)).into_iter();
    let rates = truths.map(|(name, truth)| {
        let mut rate = Rate {
            name,
            truth,
            given: 0,
            within: 0,
            half_width: 0.0,
            error: 0.0,
        };
        for entry in logs.iter().flatten().filter(|e| e.name == rate.name) {
            if let Verdict::Identified { value, half_width } = entry.verdict {
                let error = value - truth;
                rate.given += 1;
                rate.within += usize::from(error.abs() <= half_width);
                rate.half_width += half_width / truth.abs();
                rate.error += error / truth;
            }
        }
        let given = rate.given.max(1) as f64;
        rate.half_width /= given;
        rate.error /= given;
        rate
    });
    Ok(rates.collect())
}

/// True values by name, of all that a log with duties, supply, currents, counts and poses can determine.
pub fn truths(base: &BaseSpec, (hardware, motor): (&Hardware, &MotorParams)) -> Vec<(String, f64)> {
    let robot = base.robot_with_rotors();
    let wheels = &robot.wheels;
    let named = |q: Q, value: f64| (q.name().to_owned(), value);
    let constant = motor
        .strength
        .map(|s| s * motor.gear_ratio * motor.kt_nm_per_a);
    let mut all = vec![
        named(Q::RadiusRight, wheels.radius_right_m),
        named(Q::RadiusLeft, wheels.radius_left_m),
        named(Q::Track, wheels.track_m),
        named(Q::Mass, robot.mass_kg),
        named(Q::Inertia, robot.inertia_kg_m2),
        named(Q::MotorConstantRight, constant[0]),
        named(Q::MotorConstantLeft, constant[1]),
        named(Q::ResistanceRight, motor.resistance_ohm),
        named(Q::ResistanceLeft, motor.resistance_ohm),
        named(Q::ViscousRight, hardware.friction.viscous_nm_s),
        named(Q::ViscousLeft, hardware.friction.viscous_nm_s),
        named(Q::CoulombRight, hardware.friction.coulomb_nm),
        named(Q::CoulombLeft, hardware.friction.coulomb_nm),
    ];
    for (i, side) in SIDES.into_iter().enumerate() {
        all.push((
            format!("torque_constant_{side}"),
            constant[i] / motor.gear_ratio,
        ));
        all.push((
            format!("lag_{side}"),
            motor.inductance_h / motor.resistance_ohm,
        ));
        all.push((format!("efficiency_{side}"), motor.gear_efficiency));
        all.push((format!("dead_band_{side}"), motor.dead_band));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::Rate;

    /// Sums of the binomial distribution at 90 %: up to 30 of 40 are 0.5 %, up to 31 are 1.5 %; of 200 it is up to 169 and 170;
    /// and a single log never tells.
    #[test]
    fn a_share_fails_that_chance_hardly_makes() {
        let fails = |within: usize, given: usize| {
            let rate = Rate {
                name: "mass".to_owned(),
                truth: 1.0,
                given,
                within,
                half_width: 0.0,
                error: 0.0,
            };
            rate.fails()
        };
        assert!(fails(30, 40) && !fails(31, 40) && !fails(35, 40));
        assert!(fails(169, 200) && !fails(170, 200));
        assert!(!fails(0, 0) && !fails(0, 1) && !fails(1, 2) && fails(0, 3));
    }
}
