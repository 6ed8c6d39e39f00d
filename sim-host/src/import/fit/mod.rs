//! The smoothest drivable motion that passes the poses of a file within a tolerance.
//!
//! State (x, y, θ, v, w, a, α), driven by jerk in v and w that is constant between knots: every
//! motion of this kind satisfies Eq. (6) exactly, with v and w once and θ twice continuously
//! differentiable. Sought is the one with the least jerk among those that stay within the
//! tolerance of every pose; jerk counts squared while small and by its size beyond, so that a
//! planned step of acceleration stays a step and does not ring.
//!
//! Given a pull for every pose, along, across and in heading, it is a linear-quadratic problem
//! around the last iterate (Gauss-Newton; one Riccati recursion per step, linear in the knots).
//! Poses that are missed by more than the tolerance pull harder in the next round; once none is,
//! those with room to spare let go, and of all iterates within the tolerance the smoothest is
//! taken. Only headings and positions enter: speeds, curvatures and accelerations of a file may
//! mean nothing.

pub(super) mod grid;
pub(super) mod motion;
mod newton;

pub(super) use grid::{CLUSTER, Target};
use grid::{Knot, knots};
use motion::{Jerk, State, advance};
pub(super) use newton::Rest;
use newton::{Iterate, Weights, step};

/// A state, and the jerk that drives it from there to the next node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) t: f64,
    pub(super) z: State,
    pub(super) u: Jerk,
}

/// How close the poses are passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Closeness {
    /// Largest distance \[m\] and angle \[rad\].
    pub(super) position: f64,
    pub(super) heading: f64,
    /// The larger of the two in tolerances; at most 1 if all poses are passed within theirs.
    pub(super) excess: f64,
    /// The target where distance or angle, in tolerances, is largest.
    pub(super) worst: usize,
}

/// Turning counts as much as driving on an arm of this length \[m\].
const ARM: f64 = 0.2;
/// Jerk up to this counts squared, beyond by its size \[m/s³\]: where a file steps from one
/// acceleration to another, so may the reference, without ringing on both sides.
const CORNER: f64 = 1.0;
/// Rounds of the search; fewer, down to the first, in files so long that they would take a minute.
const ROUNDS: std::ops::Range<usize> = 20..60;
const WORK: usize = 4_000_000;
/// Newton steps at the start of the search, which settle the shape, and in every round.
const FIRST_STEPS: usize = 10;
const STEPS: usize = 2;
/// Newton has converged when no pose moves more than this \[m, rad\].
const STILL: f64 = 1e-9;
/// Pull of a pose at the start of the search, in units of 1 / tolerance².
const FIRST_PULL: f64 = 0.1;
/// First and last pose pull this much more: the robot parks at the last.
const ENDS: f64 = 1e5;
/// Limits of the change of a pull in one round.
const MORE: [f64; 2] = [2.0, 100.0];
/// The same once the tolerance is kept.
const TRIM: [f64; 2] = [0.5, 10.0];
/// Rounds spent on that.
const POLISH: usize = 12;
/// Bounds of the pull of a pose, in units of the first.
const LEAST: f64 = 1e-3;
const MOST: f64 = 1e14;
/// Along and across together are a distance.
const SIDE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// How first and last pose are passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ends {
    /// As good as exactly.
    Exact,
    /// As the others: they have the same noise, and what begins exactly there has to shunt to be among them.
    Noisy,
}

/// Fits; the closeness says whether the tolerance was reached. `None` for less than two knots.
pub(super) fn fit(
    targets: &[Target],
    rest: Rest,
    tolerance: [f64; 2],
    ends: Ends,
) -> Option<(Vec<Node>, Closeness)> {
    let knots = knots(targets);
    if knots.len() < 2 {
        return None;
    }
    let box_size = [SIDE * tolerance[0], SIDE * tolerance[0], tolerance[1]];
    let pull = box_size.map(|b| FIRST_PULL / (b * b));
    let mut weights = Weights {
        pose: vec![pull; targets.len()],
        jerk: vec![Jerk::new(1.0, ARM * ARM); knots.len()],
        rest: 1e10,
    };
    let exact: &[usize] = match ends {
        Ends::Exact => &[0, targets.len() - 1],
        Ends::Noisy => &[],
    };
    for &end in exact {
        if let Some(weight) = weights.pose.get_mut(end) {
            *weight = weight.map(|p| ENDS * p);
        }
    }
    let mut iterate = guess(&knots, targets);
    let mut best: Option<Candidate> = None;
    let mut polish = 0;
    let rounds = (WORK / knots.len()).clamp(ROUNDS.start, ROUNDS.end);
    for round in 0..rounds {
        let steps = if round == 0 { FIRST_STEPS } else { STEPS };
        let Some(next) = settle(&knots, targets, rest, &weights, &iterate, steps) else {
            break;
        };
        iterate = next;
        let roughness = soften(&knots, &iterate, &mut weights.jerk);
        let (closeness, misses) = closeness(&nodes(&knots, &iterate), targets, box_size);
        let excess = closeness.excess;
        let candidate = Candidate {
            iterate: iterate.clone(),
            closeness,
            excess: excess.max(1.0),
            roughness,
        };
        if best.as_ref().is_none_or(|best| candidate.beats(best)) {
            best = Some(candidate);
        }
        polish += usize::from(polish > 0 || excess <= 1.0);
        if polish > POLISH {
            break;
        }
        // Only the poses that are missed pull harder: a hard place makes no noise elsewhere. Once
        // none is missed, those with room to spare let go.
        for (i, (weight, miss)) in weights.pose.iter_mut().zip(misses).enumerate() {
            if exact.contains(&i) {
                continue;
            }
            for ((weight, miss), pull) in weight.iter_mut().zip(miss).zip(pull) {
                let range = match (miss > 1.0, polish) {
                    (true, 0) => MORE,
                    (false, 0) => [1.0, 1.0],
                    _ => TRIM,
                };
                let factor = (miss * miss).clamp(range[0], range[1]);
                *weight = (*weight * factor).clamp(LEAST * pull, MOST * pull);
            }
        }
    }
    match best {
        Some(best) => Some((nodes(&knots, &best.iterate), best.closeness)),
        // The numbers ran away at once, as where nothing near can be driven. What the fit began with is no motion, whatever it passes.
        None => {
            let begun = nodes(&knots, &iterate);
            let (mut closeness, _) = closeness(&begun, targets, box_size);
            closeness.excess = f64::INFINITY;
            Some((begun, closeness))
        }
    }
}

/// An iterate that may be the answer.
struct Candidate {
    iterate: Iterate,
    closeness: Closeness,
    /// Misses in tolerances, 1 if all are within.
    excess: f64,
    roughness: f64,
}

impl Candidate {
    fn beats(&self, other: &Self) -> bool {
        (self.excess, self.roughness) < (other.excess, other.roughness)
    }
}

/// Newton steps until no pose moves. `None` if the numbers ran away.
fn settle(
    knots: &[Knot],
    targets: &[Target],
    rest: Rest,
    weights: &Weights,
    start: &Iterate,
    steps: usize,
) -> Option<Iterate> {
    let mut iterate = start.clone();
    for _ in 0..steps {
        let (next, change) = step(knots, targets, rest, weights, &iterate)?;
        iterate = next;
        if change < STILL {
            break;
        }
    }
    Some(iterate)
}

/// Weights that make the next squares of jerk count like its size where it is large. Returns the
/// sum that is sought least.
fn soften(knots: &[Knot], iterate: &Iterate, weights: &mut [Jerk]) -> f64 {
    let mut sum = 0.0;
    for ((weight, jerk), span) in weights.iter_mut().zip(&iterate.u).zip(knots.windows(2)) {
        let [from, to] = span else { continue };
        let size = [jerk[0], ARM * jerk[1]].map(|j| (1.0 + (j / CORNER).powi(2)).sqrt());
        sum += (to.t - from.t) * (size[0] + size[1] - 2.0);
        *weight = Jerk::new(size[0].recip(), ARM * ARM / size[1]);
    }
    sum
}

/// How close nodes pass the targets; and for each, the miss along, across and in heading, in parts
/// of the box.
fn closeness(nodes: &[Node], targets: &[Target], box_size: [f64; 3]) -> (Closeness, Vec<[f64; 3]>) {
    let mut found = Closeness {
        position: 0.0,
        heading: 0.0,
        excess: 0.0,
        worst: 0,
    };
    let mut misses = Vec::with_capacity(targets.len());
    let mut largest = 0.0;
    let mut k = 0;
    for (i, target) in targets.iter().enumerate() {
        while nodes.get(k + 1).is_some_and(|next| next.t <= target.t) {
            k += 1;
        }
        let Some(node) = nodes.get(k) else { continue };
        let z = advance(&node.z, &node.u, target.t - node.t);
        let (dx, dy) = (z[0] - target.x, z[1] - target.y);
        let (sin, cos) = libm::sincos(target.theta);
        let heading = (z[2] - target.theta).abs();
        found.position = found.position.max(libm::hypot(dx, dy));
        found.heading = found.heading.max(heading);
        let away = SIDE * libm::hypot(dx, dy) / box_size[0];
        found.excess = found.excess.max(away).max(heading / box_size[2]);
        let miss = [
            (dx * cos + dy * sin).abs() / box_size[0],
            (dy * cos - dx * sin).abs() / box_size[1],
            heading / box_size[2],
        ];
        let here = miss.into_iter().fold(0.0, f64::max);
        if here > largest {
            largest = here;
            found.worst = i;
        }
        misses.push(miss);
    }
    (found, misses)
}

/// The nodes of an iterate; the jerk of the last is zero.
fn nodes(knots: &[Knot], iterate: &Iterate) -> Vec<Node> {
    let jerks = iterate.u.iter().chain(std::iter::repeat(&ZERO));
    let states = knots.iter().zip(&iterate.z);
    states
        .zip(jerks)
        .map(|((knot, z), u)| Node {
            t: knot.t,
            z: *z,
            u: *u,
        })
        .collect()
}

const ZERO: Jerk = Jerk::new(0.0, 0.0);

/// Straight from pose to pose at constant speed.
fn guess(knots: &[Knot], targets: &[Target]) -> Iterate {
    let mut z = Vec::with_capacity(knots.len());
    let mut k = 0;
    for knot in knots {
        while targets.get(k + 2).is_some() && targets.get(k + 1).is_some_and(|t| t.t <= knot.t) {
            k += 1;
        }
        let mut state = State::zeros();
        if let (Some(from), Some(to)) = (targets.get(k), targets.get(k + 1)) {
            let dt = to.t - from.t;
            let s = (knot.t - from.t) / dt;
            let (dx, dy, turn) = (to.x - from.x, to.y - from.y, to.theta - from.theta);
            let (sin, cos) = libm::sincos(from.theta + 0.5 * turn);
            let rate = dt.max(CLUSTER).recip();
            state = State::from([
                from.x + s * dx,
                from.y + s * dy,
                from.theta + s * turn,
                (dx * cos + dy * sin) * rate,
                turn * rate,
                0.0,
                0.0,
            ]);
        }
        z.push(state);
    }
    let u = vec![ZERO; knots.len().saturating_sub(1)];
    Iterate { z, u }
}
