//! What a user should know of a scenario before the robot finds out.

use crate::scenario::{ControlLaw, Scenario};
use controller_core::maths::Libm;
use controller_core::paper::stability::{
    longitudinal_tracking_is_stable, max_stable_speed, parking_is_stable,
};

/// Warnings about gains and speeds, each one sentence.
///
/// They come from the linearised loop of the neural law; plain backstepping has no such limits.
pub fn warnings(scenario: &Scenario) -> Vec<String> {
    let mut warnings = Vec::new();
    if scenario.controller.kind == ControlLaw::Plain {
        return warnings;
    }
    let params = &scenario.params;
    let speed = scenario.motion.largest_speed();
    match max_stable_speed::<f64, Libm>(params) {
        Some(limit) if speed > limit => warnings.push(format!(
            "the reference reaches {speed:.3} m/s; above {limit:.3} m/s these gains let the robot \
             weave about the path: lower k2 (as 1/v_r²), or raise A or k3"
        )),
        Some(_) => {}
        None => warnings.push(
            "with these gains the heading loop is unstable at every speed: raise A or kd2, or \
             lower k3"
                .to_owned(),
        ),
    }
    if !longitudinal_tracking_is_stable(params) {
        warnings.push(
            "with these gains tracking is unstable along the path: lower k1, or raise A or kd1"
                .to_owned(),
        );
    }
    if scenario.hand_over.is_some() && !parking_is_stable(params) {
        warnings.push(
            "with these gains parking is unstable: lower k4 and k5, or raise A, kc1 and kc2"
                .to_owned(),
        );
    }
    warnings
}
