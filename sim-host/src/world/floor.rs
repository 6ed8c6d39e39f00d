//! Grip, slope and pushes at a place and a time.

use super::params::{FloorParams, GRAVITY, PushParams};
use controller_core::maths::{Libm, Maths};

/// Grip of a wheel that stands at (x, y) at `time_s`.
pub(super) fn mu(floor: &FloorParams, [x, y]: [f64; 2], time_s: f64) -> f64 {
    let covers = |[from, to]: [f64; 2], value: f64| (from..=to).contains(&value);
    let patch =
        floor.patch.iter().rev().find(|patch| {
            covers(patch.time_s, time_s) && covers(patch.x_m, x) && covers(patch.y_m, y)
        });
    patch.map_or(floor.mu, |patch| patch.mu)
}

/// Load of the right and the left wheel \[N\].
pub(super) fn loads(floor: &FloorParams, mass_kg: f64, share: f64, right: f64) -> [f64; 2] {
    let (_, cosine) = Libm::sin_cos(floor.slope_rad);
    let load = mass_kg * GRAVITY * cosine * share;
    [load * right, load * (1.0 - right)]
}

/// Force of gravity along the floor, in the world's x and y \[N\].
pub(super) fn downhill(floor: &FloorParams, mass_kg: f64) -> [f64; 2] {
    let (steep, _) = Libm::sin_cos(floor.slope_rad);
    let (sine, cosine) = Libm::sin_cos(floor.downhill_rad);
    let force = mass_kg * GRAVITY * steep;
    [force * cosine, force * sine]
}

/// Sum of the pushes at `time_s`: force in x, in y, moment. A window holds from its start to just
/// before its end.
pub(super) fn pushes(pushes: &[PushParams], time_s: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for push in pushes {
        if (push.time_s[0]..push.time_s[1]).contains(&time_s) {
            sum[0] += push.force_x_n;
            sum[1] += push.force_y_n;
            sum[2] += push.moment_nm;
        }
    }
    sum
}
