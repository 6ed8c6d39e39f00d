//! Substeps in which a wheel slips: one wheel after the other, until nothing changes.
//!
//! A tyre within its grip holds (slip = c f − e); beyond it the impulse has the size of the grip
//! and points against the slip. That is the tyre's law with a larger give, the same both ways, so
//! a single number per wheel is looked for.

use super::pair::Pair;
use super::substep::{Frame, Task};

/// Impulses of the floor and which wheels slip.
#[cold]
pub(super) fn solve(task: &Task, frame: &Frame, forward: Pair) -> ([Pair; 2], [bool; 2]) {
    let mut floor = [0, 1].map(|i| [forward[i].clamp(-task.grip[i], task.grip[i]), 0.0]);
    let mut slipping = [false; 2];
    let mut speed = task.free;
    for (i, impulse) in floor.into_iter().enumerate() {
        push(frame, &mut speed, i, impulse);
    }
    for sweep in 0..SWEEPS {
        let mut change: f64 = 0.0;
        for step in 0..2 {
            // There and back, so that neither wheel is always first to take a sideways impulse.
            let i = if sweep % 2 == 0 { step } else { 1 - step };
            let old = floor[i];
            let (new, slips) = one(task, frame, i, &speed, old);
            let difference = [new[0] - old[0], new[1] - old[1]];
            push(frame, &mut speed, i, difference);
            floor[i] = new;
            slipping[i] = slips;
            change = change.max(size(difference) / (size(new) + f64::MIN_POSITIVE));
        }
        if change < SETTLED {
            break;
        }
    }
    let [right, left] = floor;
    ([0, 1].map(|n| Pair([right[n], left[n]])), slipping)
}

/// Adds what an impulse on wheel `i` does.
fn push(frame: &Frame, speed: &mut [f64; 3], i: usize, [f, y]: [f64; 2]) {
    let push = frame.push([Pair::both(f), Pair::both(y)]);
    for (speed, push) in speed.iter_mut().zip(push) {
        *speed += push[i];
    }
}

/// Sizes of impulses forward and leftward.
#[inline(always)]
pub(super) fn norm([f, y]: [Pair; 2]) -> Pair {
    (f * f + y * y).map(f64::sqrt)
}

fn size([f, y]: [f64; 2]) -> f64 {
    norm([Pair::both(f), Pair::both(y)])[0]
}

/// Each sweep leaves at most 0.6 of an error (two locked wheels on the 30 kg base), mostly a tenth.
const SWEEPS: usize = 50;
/// Relative change at which impulses count as found: a thousandth of what a substep changes.
const SETTLED: f64 = 1.0e-9;

/// One wheel, the other held: the impulse that keeps its law.
fn one(task: &Task, frame: &Frame, i: usize, speed: &[f64; 3], old: [f64; 2]) -> ([f64; 2], bool) {
    let &Frame { along, across, .. } = frame;
    let others = frame.forward(speed)[i] - along * old[0];
    let sideways = frame.sideways(speed) - across * old[1];
    let at = |give: f64| {
        let f = forward(task, frame, i, others, give);
        [f, (task.held[1][i] - sideways) / (across + give)]
    };
    let stuck = at(task.give[i]);
    let grip = task.grip[i];
    if grip <= 0.0 {
        return ([0.0; 2], true);
    }
    if size(stuck) <= grip {
        return (stuck, false);
    }
    // |impulse| = K/(A + give) if one direction rules, so 1/|impulse| is nearly linear in give.
    let per_grip = 1.0 / grip;
    let (mut low, mut low_value) = (task.give[i], 1.0 / size(stuck) - per_grip);
    let mut give = low + (along + task.rim[i]) * (size(stuck) / grip - 1.0);
    let mut found = stuck;
    for _ in 0..SECANTS {
        found = at(give);
        let value = 1.0 / size(found) - per_grip;
        let slope = (value - low_value) / (give - low);
        if value.abs() < 1.0e-12 * per_grip || slope.is_nan() || slope <= 0.0 {
            break;
        }
        (low, low_value) = (give, value);
        give = (give - value / slope).max(task.give[i]);
    }
    let scale = grip / size(found);
    ([found[0] * scale, found[1] * scale], true)
}

/// The secant gains digits faster than it doubles them; most wheels need two.
const SECANTS: usize = 8;

/// Forward impulse for a give: others + (along + give) f − r ω(f) = e, rising in f and linear in
/// three pieces, of which exactly one holds.
fn forward(task: &Task, frame: &Frame, i: usize, others: f64, give: f64) -> f64 {
    let (along, r) = (frame.along, frame.radius[i]);
    let pull = task.held[0][i] - others;
    let held = pull / (along + give);
    let (momentum, dry, per_inertia) = (task.momentum[i], task.dry[i], task.per_inertia[i]);
    let left = momentum - r * held;
    if left.abs() <= dry {
        return held;
    }
    let sign = 1.0_f64.copysign(left);
    (pull + r * (momentum - sign * dry) * per_inertia) / (along + give + task.rim[i])
}
