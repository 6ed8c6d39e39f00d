//! Every field of the parameters. Patterns are without `..`: a field that is new in the core does not
//! compile until it is written.

mod localiser;
mod motion;
mod motor;
mod safety;

use super::writer::Writer;
use controller_core::base::BaseParams;
use controller_core::motion::AtRest;
use controller_core::robot::Robot;
use controller_core::wheels::WheelGeometry;

/// What the file names; everything else by its path from there.
pub(super) fn imports(out: &mut Writer, params: &BaseParams<f32>) {
    out.line("use controller_core::base::BaseParams;");
    out.line("use controller_core::safety::{Reaction, Response, Timeout};");
    let motor = if params.motor.is_some() {
        "motor, "
    } else {
        ""
    };
    out.line(&format!(
        "use controller_core::{{localiser, motion, {motor}odometry, robot, safety, wheels}};"
    ));
}

pub(super) fn base(out: &mut Writer, params: &BaseParams<f32>) {
    let BaseParams {
        motion: of_motion,
        localiser: of_localiser,
        motor: of_motor,
        detectors,
        policy,
        supervisor,
    } = params;
    motion::motion(out, of_motion);
    localiser::localiser(out, of_localiser);
    match of_motor {
        Some(params) => motor::motor(out, params),
        None => out.field("motor", "None", "The driver takes torques itself."),
    }
    safety::detectors(out, detectors);
    safety::policy(out, policy);
    safety::supervisor(out, supervisor);
}

pub(super) fn robot(out: &mut Writer, robot: &Robot<f32>) {
    let Robot {
        mass_kg,
        inertia_kg_m2,
        wheels: of_wheels,
    } = robot;
    out.open("robot: robot::Robot {");
    out.number("mass_kg", *mass_kg, "[kg]");
    out.number(
        "inertia_kg_m2",
        *inertia_kg_m2,
        "About the axle's middle [kg m^2].",
    );
    wheels(out, of_wheels);
    out.close("},");
}

fn wheels(out: &mut Writer, wheels: &WheelGeometry<f32>) {
    let WheelGeometry {
        radius_right_m,
        radius_left_m,
        track_m,
    } = wheels;
    out.open("wheels: wheels::WheelGeometry {");
    out.number("radius_right_m", *radius_right_m, "[m]");
    out.number("radius_left_m", *radius_left_m, "[m]");
    out.number("track_m", *track_m, "Between the wheels [m].");
    out.close("},");
}

fn at_rest(rest: AtRest) -> &'static str {
    match rest {
        AtRest::Hold => "motion::AtRest::Hold",
        AtRest::Release => "motion::AtRest::Release",
    }
}
