//! A first solution by hand, and the sizes of friction that count as 1.

use super::fit::Fit;
use super::log::Drive;
use super::physics::{Chart, MOTION};
use super::quantity::{COUNT, Quantity};
use super::structure::Given;
use nalgebra::DVector;

/// Solves for what is not stated, one quantity after the other; what cannot be solved for is 1.
pub(super) fn direct(
    given: &Given,
    y: &DVector<f64>,
    poses: bool,
    motion: Option<&Fit>,
) -> (Chart, [f64; COUNT]) {
    let known = |q: Quantity, other: f64| given.known.get(q).unwrap_or(other);
    let good = |x: f64| if x.is_finite() && x > 0.0 { x } else { 1.0 };
    use Quantity as Q;
    // Of the order of a small robot where nothing else is known.
    let radius = [(Q::RadiusRight, y[0]), (Q::RadiusLeft, y[1])]
        .map(|(q, fitted)| known(q, if poses { good(fitted) } else { 0.1 }));
    let track = known(Q::Track, if poses { good(1.0 / y[2]) } else { 0.4 });
    let supply = known(
        Q::Supply,
        if given.drive == Drive::Duty {
            12.0
        } else {
            1.0
        },
    );
    let wheel = known(Q::WheelInertia, 0.0);
    let (e, d, s) = (&y.as_slice()[3..7], [y[7], y[8]], [y[9], y[10]]);
    let with_current = motion.is_some_and(|fit| fit.value.len() > MOTION.len());
    let constants = [Q::MotorConstantRight, Q::MotorConstantLeft];
    let resistances = [Q::ResistanceRight, Q::ResistanceLeft];
    let mut q = [1.0; COUNT];
    let mut gain = [1.0; 2];
    let mut drag = [0.0; 2];
    for i in 0..2 {
        let (alpha, beta) = (y[11 + 2 * i], y[12 + 2 * i]);
        let (k, resistance) = match (given.drive, with_current) {
            (Drive::Torque, true) => (good(1.0 / alpha), 1.0),
            (Drive::Torque, false) => (1.0, 1.0),
            (_, true) => (good(beta * supply / alpha), good(supply / alpha)),
            // All damping as if from back-EMF.
            (_, false) => (good(d[i] * supply), 1.0),
        };
        let (k, resistance) = (known(constants[i], k), known(resistances[i], resistance));
        q[constants[i].index()] = k;
        q[resistances[i].index()] = resistance;
        if given.drive != Drive::Torque {
            gain[i] = k * supply / resistance;
            drag[i] = k * k / resistance;
        }
    }
    let mean = radius[0] * radius[1];
    let total = 0.5 * (e[0] + e[1]) * gain[0] + 0.5 * (e[2] + e[3]) * gain[1] - wheel;
    let turning = 0.5 * (e[0] - e[1]) * gain[0] + 0.5 * (e[3] - e[2]) * gain[1] - wheel;
    q[Q::RadiusRight.index()] = radius[0];
    q[Q::RadiusLeft.index()] = radius[1];
    q[Q::Track.index()] = track;
    q[Q::Mass.index()] = known(Q::Mass, good(2.0 * total / mean));
    q[Q::Inertia.index()] = known(Q::Inertia, good(0.5 * turning * track * track / mean));
    q[Q::WheelInertia.index()] = wheel;
    q[Q::Supply.index()] = supply;
    for (i, [c, t]) in [
        [Q::ViscousRight, Q::CoulombRight],
        [Q::ViscousLeft, Q::CoulombLeft],
    ]
    .into_iter()
    .enumerate()
    {
        q[c.index()] = known(c, d[i] * gain[i] - drag[i]);
        q[t.index()] = known(t, s[i] * gain[i]);
    }
    let damping = d[0].abs() * gain[0] + d[1].abs() * gain[1];
    let chart = Chart {
        drive: given.drive,
        viscous: good(0.5 * damping),
        // Worth the damping at 1 rad/s, or its own size.
        coulomb: good(0.5 * (damping + s[0].abs() * gain[0] + s[1].abs() * gain[1])),
    };
    let x = Quantity::ALL.map(|quantity| chart.coordinate(quantity, q[quantity.index()]));
    (chart, x)
}
