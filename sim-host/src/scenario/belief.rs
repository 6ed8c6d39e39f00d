//! Gains and robot: what the controller believes, and what is true.

use super::file;
use super::source::{Checked, Source};
use crate::numbers;
use controller_core::error::{Field, ParamError};
use controller_core::paper::params::Params;
use controller_core::robot::Robot;

/// What the controller believes and how it is tuned: the paper's, but for the keys given.
pub(super) fn params(keys: &file::File, place: &Source<'_>) -> Checked<Params<f64>> {
    let mut params = Params::paper();
    let set = |field: &mut f64, key: Option<f64>| {
        if let Some(value) = key {
            *field = value;
        }
    };
    let gains = &keys.gains;
    for (field, key) in [
        (&mut params.tracking.k1, gains.k1),
        (&mut params.tracking.k2, gains.k2),
        (&mut params.tracking.k3, gains.k3),
        (&mut params.tracking.k_d1, gains.kd1),
        (&mut params.tracking.k_d2, gains.kd2),
        (&mut params.parking.k4, gains.k4),
        (&mut params.parking.k5, gains.k5),
        (&mut params.parking.k_c1, gains.kc1),
        (&mut params.parking.k_c2, gains.kc2),
        (&mut params.neurons.a, gains.a),
        (&mut params.neurons.b, gains.b),
        (&mut params.neurons.d, gains.d),
        (&mut params.max_tick_s, keys.controller.max_tick),
    ] {
        set(field, key);
    }
    let robot = &keys.robot;
    if robot.r.is_some() && (robot.r_right.is_some() || robot.r_left.is_some()) {
        return Err(place.error("robot.r", "is both radii: leave out r_right and r_left"));
    }
    let wheels = &mut params.robot.wheels;
    for (field, key) in [
        (&mut params.robot.mass_kg, robot.m),
        (&mut params.robot.inertia_kg_m2, robot.inertia),
        (&mut wheels.radius_right_m, robot.r.or(robot.r_right)),
        (&mut wheels.radius_left_m, robot.r.or(robot.r_left)),
        (&mut wheels.track_m, robot.l),
    ] {
        set(field, key);
    }
    params.max_wheel_torque_nm = robot.max_wheel_torque;
    if let Some(keys) = &keys.hand_over {
        params.reset = keys.reset.into();
    }
    match params.validate() {
        Ok(_) => Ok(params),
        Err(error) => Err(place.error(&key_of(&error, robot.r.is_some()), numbers::param(&error))),
    }
}

/// The key that sets a parameter of the core.
fn key_of(error: &ParamError, one_radius: bool) -> String {
    let name = error.field.name();
    match error.field {
        Field::RadiusRight | Field::RadiusLeft if one_radius => "robot.r".to_owned(),
        Field::Mass
        | Field::Inertia
        | Field::RadiusRight
        | Field::RadiusLeft
        | Field::Track
        | Field::WheelMatrix
        | Field::MaxWheelTorque => format!("robot.{name}"),
        Field::MaxTick => format!("controller.{name}"),
        _ => format!("gains.{name}"),
    }
}

/// The true robot: the one that the controller believes in, times the factors of `[plant]`.
pub(super) fn true_robot(
    robot: &Robot<f64>,
    plant: &file::Plant,
    place: &Source<'_>,
) -> Checked<Robot<f64>> {
    let mut robot = *robot;
    for (field, factor, key) in [
        (&mut robot.mass_kg, plant.mass_factor, "mass_factor"),
        (
            &mut robot.inertia_kg_m2,
            plant.inertia_factor,
            "inertia_factor",
        ),
        (
            &mut robot.wheels.radius_right_m,
            plant.r_right_factor,
            "r_right_factor",
        ),
        (
            &mut robot.wheels.radius_left_m,
            plant.r_left_factor,
            "r_left_factor",
        ),
        (&mut robot.wheels.track_m, plant.l_factor, "l_factor"),
    ] {
        let factor = factor.unwrap_or(1.0);
        if !(0.01..=100.0).contains(&factor) {
            return Err(place.error(&format!("plant.{key}"), "must be in 0.01 to 100"));
        }
        *field *= factor;
    }
    Ok(robot)
}
