//! Substeps in which a wheel slips: one wheel after the other, until nothing changes.
//!
//! A tyre within its grip holds (slip = c f − e); beyond it the impulse has the size of the grip
//! and points against the slip. That is the tyre's law with a larger give, the same both ways, so
//! a single number per wheel is looked for.

use super::substep::{Frame, Task, norm};

/// Impulses of the floor and which wheels slip.
pub(super) fn solve(task: &Task, frame: &Frame, forward: [f64; 2]) -> ([[f64; 2]; 2], [bool; 2]) {
    let mut floor = [0, 1].map(|i| [forward[i].clamp(-task.grip[i], task.grip[i]), 0.0]);
    let mut slipping = [false; 2];
    let mut speed = task.free;
    for (i, impulse) in floor.into_iter().enumerate() {
        frame.push(&mut speed, i, impulse);
    }
    for sweep in 0..SWEEPS {
        let mut change: f64 = 0.0;
        for step in 0..2 {
            // There and back, so that neither wheel is always first to take a sideways impulse.
            let i = if sweep % 2 == 0 { step } else { 1 - step };
            let old = floor[i];
            let (new, slips) = one(task, frame, i, &speed, old);
            let difference = [new[0] - old[0], new[1] - old[1]];
            frame.push(&mut speed, i, difference);
            floor[i] = new;
            slipping[i] = slips;
            change = change.max(norm(difference) / (norm(new) + f64::MIN_POSITIVE));
        }
        if change < SETTLED {
            break;
        }
    }
    (floor, slipping)
}

/// Each sweep leaves at most 0.6 of an error (two locked wheels on the 30 kg base), mostly a tenth.
const SWEEPS: usize = 50;
/// Relative change at which impulses count as found: a thousandth of what a substep changes.
const SETTLED: f64 = 1.0e-9;

/// One wheel, the other held: the impulse that keeps its law.
fn one(task: &Task, frame: &Frame, i: usize, speed: &[f64; 3], old: [f64; 2]) -> ([f64; 2], bool) {
    let (along, across) = (frame.along(), frame.across());
    let others = frame.forward(speed, i) - along * old[0];
    let sideways = frame.sideways(speed) - across * old[1];
    let at = |give: f64| {
        let f = forward(task, frame, i, others, give);
        [f, (task.held[i][1] - sideways) / (across + give)]
    };
    let stuck = at(task.give[i]);
    let grip = task.grip[i];
    if grip <= 0.0 {
        return ([0.0; 2], true);
    }
    if norm(stuck) <= grip {
        return (stuck, false);
    }
    // |impulse| = K/(A + give) if one direction rules, so 1/|impulse| is nearly linear in give.
    let per_grip = 1.0 / grip;
    let r = frame.radius[i];
    let (mut low, mut low_value) = (task.give[i], 1.0 / norm(stuck) - per_grip);
    let mut give = low + (along + r * r / task.inertia[i]) * (norm(stuck) / grip - 1.0);
    let mut found = stuck;
    for _ in 0..SECANTS {
        found = at(give);
        let value = 1.0 / norm(found) - per_grip;
        let slope = (value - low_value) / (give - low);
        if value.abs() < 1.0e-12 * per_grip || slope.is_nan() || slope <= 0.0 {
            break;
        }
        (low, low_value) = (give, value);
        give = (give - value / slope).max(task.give[i]);
    }
    let scale = grip / norm(found);
    ([found[0] * scale, found[1] * scale], true)
}

/// The secant gains digits faster than it doubles them; most wheels need two.
const SECANTS: usize = 8;

/// Forward impulse for a give: others + (along + give) f − r ω(f) = e, rising in f and linear in
/// three pieces, of which exactly one holds.
fn forward(task: &Task, frame: &Frame, i: usize, others: f64, give: f64) -> f64 {
    let (along, r) = (frame.along(), frame.radius[i]);
    let pull = task.held[i][0] - others;
    let held = pull / (along + give);
    let (momentum, dry, inertia) = (task.momentum[i], task.dry[i], task.inertia[i]);
    let left = momentum - r * held;
    if left.abs() <= dry {
        return held;
    }
    let sign = 1.0_f64.copysign(left);
    (pull + r * (momentum - sign * dry) / inertia) / (along + give + r * r / inertia)
}
