//! Path and time together: the quickest motion through the places of a tube.
//!
//! The motion goes from place to place with constant jerk in v and w; jerks and the time from each
//! place to the next are free. Linearised about the last motion, that is a convex problem, whose
//! steps a Riccati recursion solves in time linear in the places; the change of times is bounded,
//! the more so the later the round, so that what was linearised holds in the end.

use super::fit::motion::{ByState, Jerk, State, linearise};
use super::interior::{Convex, Row, Start, descend};
use super::limits::ReferenceLimits;
use super::time_scaling;
use nalgebra::{SMatrix, SVector};

/// A place of the tube, and the motion there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    /// The pose of the tube's middle: x, y, θ.
    pub(super) middle: [f64; 3],
    /// The tube's radius there \[m\], and how far the heading may depart \[rad\].
    pub(super) room: [f64; 2],
    /// Least time to the next place.
    pub(super) least: f64,
    /// The motion: state, jerk to the next place, time to it.
    pub(super) z: State,
    pub(super) u: Jerk,
    pub(super) h: f64,
}

/// Variables of a stage: changes of its state, of its jerk and of its time.
const WIDTH: usize = 10;
type Stacked = SVector<f64, WIDTH>;
type Square = SMatrix<f64, WIDTH, WIDTH>;
type Forward = SMatrix<f64, 7, WIDTH>;

/// Rounds of linearising; fewer in files so long that they would take a minute.
const ROUNDS: std::ops::Range<usize> = 3..16;
const WORK: usize = 40_000;
/// Largest part by which a time changes in the first round, and what is left of that in the next.
const FIRST_TRUST: f64 = 0.3;
const NEXT_TRUST: f64 = 0.85;
/// Part of the time that a round's optimum may lack. Many paths are as quick to 1e-4, and which of them is found then hangs on stamps of a nanosecond.
const GAIN: f64 = 1e-6;
/// A round that saves less than this part of the time is the last but for those that close gaps.
const SAVED: f64 = 1e-3;
/// Most rounds of those; gaps that are closed without a look at limits, which that hardly moves; and
/// gaps that are none \[SI units\].
const CLOSING: usize = 12;
const SMALL: f64 = 1e-5;
const CLOSED: f64 = 1e-10;
/// Weight of changes there, of the state and of jerks.
const NEAR: f64 = 1.0;
const NEAR_JERK: f64 = 1e-4;
/// Weight of ends that are missed: by the time that a metre there is worth, some 1 s, it leaves 1e-7.
const ENDS: f64 = 1e7;
/// Weight of changes of times and of jerks, for where nothing else says what they are.
const STILL: f64 = 1e-2;
const QUIET: f64 = 1e-6;
/// Sides of the polygon that stands for the tube.
const SIDES: usize = 16;

/// The quickest motion near the one given, from its first pose to its last; `rest` says whether
/// first and last stand, and else they are as fast as they are. `None` if none was found.
/// What the search took is added to `work`.
pub(super) fn quickest(
    mut stages: Vec<Stage>,
    limits: &ReferenceLimits,
    rest: [bool; 2],
    work: &mut usize,
) -> Option<Vec<Stage>> {
    let time = |stages: &[Stage]| -> f64 { stages.iter().map(|stage| stage.h).sum() };
    let rounds = (WORK / stages.len().max(1)).clamp(ROUNDS.start, ROUNDS.end);
    let mut trust = FIRST_TRUST;
    for _ in 0..rounds {
        let before = time(&stages);
        improve(&mut stages, limits, rest, Aim::Quick(trust), work)?;
        trust *= NEXT_TRUST;
        if time(&stages) > before * (1.0 - SAVED) {
            break;
        }
    }
    for _ in 0..CLOSING {
        if improve(&mut stages, limits, rest, Aim::Closed, work)? < CLOSED {
            // The last goes nowhere.
            let on_the_way = stages.split_last().map_or(&[][..], |(_, others)| others);
            return on_the_way
                .iter()
                .all(|stage| stage.h > 0.0)
                .then_some(stages);
        }
    }
    None
}

/// What a round is for.
#[derive(Clone, Copy, PartialEq)]
enum Aim {
    /// Less time; no time changes by more than this part of it.
    Quick(f64),
    /// The nearest motion without gaps, which what was linearised leaves between stages.
    Closed,
}

/// One round: the best change of the motion, linearised. Gives the largest gap that there was, or
/// `None` if no change was found.
fn improve(
    stages: &mut [Stage],
    limits: &ReferenceLimits,
    rest: [bool; 2],
    aim: Aim,
    work: &mut usize,
) -> Option<f64> {
    let mut problem = Linearised::of(stages, rest, aim);
    let gap = problem.loose();
    let start = vec![0.0; WIDTH * stages.len()];
    let (change, arrived) = if aim == Aim::Closed && gap < SMALL {
        problem.cost(&start);
        let arrived = problem.factorise();
        (problem.solve(), arrived)
    } else {
        let rows = limit_rows(stages, limits, aim).into_iter();
        let mut start = Start {
            c: start,
            ..Start::default()
        };
        let found = descend(&mut problem, &mut start, rows, GAIN);
        *work += start.work;
        found
    };
    for (stage, change) in stages.iter_mut().zip(change.chunks_exact(WIDTH)) {
        let change = Stacked::from_column_slice(change);
        stage.z += change.fixed_rows::<7>(0);
        stage.u += change.fixed_rows::<2>(7);
        stage.h += change[TIME];
    }
    arrived.then_some(gap)
}

/// Places of variables in a stage, after x, y.
const THETA: usize = 2;
const V: usize = 3;
const W: usize = 4;
const A: usize = 5;
const ALPHA: usize = 6;
const JERK: usize = 7;
const TURN_JERK: usize = 8;
const TIME: usize = 9;

/// What a limit is on: one or two of a stage's variables, with factors.
#[derive(Clone, Copy, Debug)]
struct Factors([(usize, f64); 2]);

impl Factors {
    fn of(pairs: &[(usize, f64)], scale: f64) -> Self {
        let pair = |i: usize| {
            pairs
                .get(i)
                .map_or((TIME, 0.0), |(at, by)| (*at, by * scale))
        };
        Self([pair(0), pair(1)])
    }
}

/// Rows of limits on the changes of every stage.
fn limit_rows(stages: &[Stage], limits: &ReferenceLimits, aim: Aim) -> Vec<Row<Factors>> {
    let mut rows = Vec::new();
    let last = stages.len().saturating_sub(1);
    let jerks = time_scaling::jerk_limits(limits);
    let inner = libm::cos(std::f64::consts::PI / SIDES as f64);
    for (piece, stage) in stages.iter().enumerate() {
        // What factors make of the variables is at most `most`.
        let mut one_sided = |factors: &[(usize, f64)], now: f64, most: f64| {
            if !most.is_finite() {
                return;
            }
            let g = Factors::of(factors, most.recip());
            let h = 1.0 - now / most;
            rows.push(Row { piece, g, h });
        };
        let z = &stage.z;
        // Where the direction may change, what a place may do is looked at when time is scaled.
        let (ahead, back) = if z[V] >= 0.0 {
            (limits.max_accel, limits.max_decel)
        } else {
            (limits.max_decel, limits.max_accel)
        };
        one_sided(&[(A, 1.0)], z[A], ahead);
        one_sided(&[(A, -1.0)], -z[A], back);
        let lateral = z[V] * z[W];
        let mut both = |factors: &[(usize, f64)], now: f64, most: f64| {
            let other: Vec<_> = factors.iter().map(|(i, factor)| (*i, -factor)).collect();
            one_sided(factors, now, most);
            one_sided(&other, -now, most);
        };
        both(&[(V, 1.0)], z[V], limits.max_speed);
        both(&[(W, 1.0)], z[W], limits.max_turn_rate);
        both(&[(ALPHA, 1.0)], z[ALPHA], limits.max_angular_accel);
        both(&[(V, z[W]), (W, z[V])], lateral, limits.max_lateral);
        if let Some(drive) = limits.drive {
            let push = 0.5 * drive.mass * drive.wheel_radius;
            let turn = drive.inertia * drive.wheel_radius / drive.track;
            for side in [1.0, -1.0] {
                let (arm, turn) = (0.5 * side * drive.track, side * turn);
                both(&[(V, 1.0), (W, arm)], z[V] + arm * z[W], drive.rim_speed);
                let torque = push * z[A] + turn * z[ALPHA];
                both(&[(A, push), (ALPHA, turn)], torque, drive.wheel_torque);
            }
        }
        if piece < last {
            both(&[(JERK, 1.0)], stage.u[0], jerks[0]);
            both(&[(TURN_JERK, 1.0)], stage.u[1], jerks[1]);
        }
        if piece > 0 && piece < last {
            let off = [0, 1, 2].map(|i| stage.z[i] - stage.middle[i]);
            both(&[(THETA, 1.0)], off[2], stage.room[1]);
            for side in 0..SIDES {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * side as f64 / SIDES as f64);
                let away = cos * off[0] + sin * off[1];
                one_sided(&[(0, cos), (1, sin)], away, inner * stage.room[0]);
            }
        }
        if piece < last {
            let trust = match aim {
                Aim::Quick(trust) => trust,
                Aim::Closed => FIRST_TRUST,
            };
            for (sign, most) in [(1.0, trust), (-1.0, trust.min(1.0 - stage.least / stage.h))] {
                let g = Factors::of(&[(TIME, sign)], stage.h.recip());
                rows.push(Row { piece, g, h: most });
            }
        }
    }
    rows
}

/// A change of the motion, linearised, with the equations of a step.
struct Linearised {
    aim: Aim,
    links: Vec<Link>,
    /// To the next stage.
    times: Vec<f64>,
    /// Of the first and the last stage: wanted changes, and their weights.
    ends: [(State, State); 2],
    /// The equations of a step, stage by stage: curvature and right-hand side.
    weights: Vec<Square>,
    right: Vec<Stacked>,
    /// Of the Riccati recursion; and what gives the change of the first state.
    gains: Vec<Gain>,
    first: ByState,
}

/// From a stage to the next: the change of the state there by all variables, and the gap that the
/// present motion has.
#[derive(Clone, Copy)]
struct Link {
    forward: Forward,
    missing: State,
    /// What is left of the gap with the present variables.
    left: State,
}

/// How jerk and time of a stage follow from its state.
#[derive(Clone, Copy)]
struct Gain {
    state: SMatrix<f64, 3, 7>,
    /// Inverse of their own curvature.
    inverse: SMatrix<f64, 3, 3>,
    /// Curvature of what comes after.
    after: ByState,
}

impl Linearised {
    fn of(stages: &[Stage], rest: [bool; 2], aim: Aim) -> Self {
        let links = stages.windows(2).map(|pair| match pair {
            [from, to] => Link::of(from, &to.z),
            _ => Link::default(),
        });
        let end = |stage: Option<&Stage>, rests: bool| {
            let (mut wanted, mut weight) = (State::zeros(), State::zeros());
            if let Some(stage) = stage {
                for i in 0..7 {
                    let middle = stage.middle.get(i);
                    (wanted[i], weight[i]) = match middle {
                        Some(middle) => (middle - stage.z[i], ENDS),
                        None if rests => (-stage.z[i], ENDS),
                        None if i < A => (0.0, ENDS),
                        None => (0.0, 0.0),
                    };
                }
            }
            (wanted, weight)
        };
        Self {
            aim,
            links: links.collect(),
            times: stages.iter().map(|stage| stage.h).collect(),
            ends: [end(stages.first(), rest[0]), end(stages.last(), rest[1])],
            weights: vec![Square::zeros(); stages.len()],
            right: vec![Stacked::zeros(); stages.len()],
            gains: Vec::new(),
            first: ByState::zeros(),
        }
    }
}

impl Default for Link {
    fn default() -> Self {
        Self {
            forward: Forward::zeros(),
            missing: State::zeros(),
            left: State::zeros(),
        }
    }
}

impl Link {
    fn of(from: &Stage, to: &State) -> Self {
        let (next, by_state, by_jerk) = linearise(&from.z, &from.u, from.h);
        let (sin, cos) = libm::sincos(next[2]);
        // What a little more time adds is what the motion does at its end.
        let by_time = State::from([
            next[3] * cos,
            next[3] * sin,
            next[4],
            next[5],
            next[6],
            from.u[0],
            from.u[1],
        ]);
        let mut forward = Forward::zeros();
        forward.fixed_columns_mut::<7>(0).copy_from(&by_state);
        forward.fixed_columns_mut::<2>(7).copy_from(&by_jerk);
        forward.fixed_columns_mut::<1>(9).copy_from(&by_time);
        Self {
            forward,
            missing: next - to,
            left: next - to,
        }
    }
}

/// The variables of a stage.
fn stacked(variables: &[f64], piece: usize) -> Stacked {
    let part = variables.get(WIDTH * piece..WIDTH * (piece + 1));
    part.map_or(Stacked::zeros(), Stacked::from_column_slice)
}

impl Convex<Factors> for Linearised {
    fn dot(&self, g: &Factors, variables: &[f64], piece: usize) -> f64 {
        let part = variables.get(WIDTH * piece..).unwrap_or_default();
        let by = |(i, factor): (usize, f64)| factor * part.get(i).copied().unwrap_or_default();
        by(g.0[0]) + by(g.0[1])
    }

    fn cost(&mut self, variables: &[f64]) -> f64 {
        let mut time = 0.0;
        let count = self.times.len();
        let mean = self.times.iter().sum::<f64>() / count as f64;
        let stages = self.weights.iter_mut().zip(&mut self.right).enumerate();
        for (piece, (weights, right)) in stages {
            weights.fill(0.0);
            right.fill(0.0);
            let change = stacked(variables, piece);
            let Some(h) = self.times.get(piece) else {
                continue;
            };
            let last = piece + 1 == count;
            let (state, jerk, duration) = match self.aim {
                Aim::Quick(_) => (0.0, QUIET * mean, STILL * mean / (h * h)),
                Aim::Closed => (NEAR, NEAR_JERK, mean / (h * h)),
            };
            for i in 0..WIDTH {
                let weight = match i {
                    _ if last && i > ALPHA => 1.0,
                    TIME => duration,
                    JERK | TURN_JERK => jerk,
                    _ => state,
                };
                weights[(i, i)] += weight;
                right[i] -= weight * change[i];
            }
            if !last {
                time += h + change[TIME];
                if self.aim != Aim::Closed {
                    right[TIME] -= 1.0;
                }
            }
            let ends = [(piece == 0, 0), (last, 1)];
            for (_, end) in ends.into_iter().filter(|(is_end, _)| *is_end) {
                let Some((wanted, weight)) = self.ends.get(end) else {
                    continue;
                };
                for i in 0..7 {
                    weights[(i, i)] += weight[i];
                    right[i] += weight[i] * (wanted[i] - change[i]);
                }
            }
        }
        for (piece, link) in self.links.iter_mut().enumerate() {
            let (here, next) = (stacked(variables, piece), stacked(variables, piece + 1));
            link.left = link.missing + link.forward * here - next.fixed_rows::<7>(0);
        }
        time
    }

    fn loose(&self) -> f64 {
        let left = self.links.iter().map(|link| link.left.amax());
        left.fold(0.0, f64::max)
    }

    fn weigh(&mut self, piece: usize, g: &Factors, weight: f64) {
        let Some(weights) = self.weights.get_mut(piece) else {
            return;
        };
        for (i, a) in g.0 {
            for (j, b) in g.0 {
                weights[(i, j)] += weight * a * b;
            }
        }
    }

    fn push(&mut self, piece: usize, g: &Factors, push: f64) {
        let Some(right) = self.right.get_mut(piece) else {
            return;
        };
        for (i, factor) in g.0 {
            right[i] += push * factor;
        }
    }

    fn factorise(&mut self) -> bool {
        self.gains.clear();
        let Some(last) = self.weights.last() else {
            return false;
        };
        let mut after: ByState = last.fixed_view::<7, 7>(0, 0).into_owned();
        for (link, weights) in self.links.iter().zip(&self.weights).rev() {
            let all = weights + link.forward.transpose() * after * link.forward;
            let Some(inverse) = all.fixed_view::<3, 3>(7, 7).into_owned().try_inverse() else {
                return false;
            };
            let cross = all.fixed_view::<3, 7>(7, 0).into_owned();
            let state = -inverse * cross;
            self.gains.push(Gain {
                state,
                inverse,
                after,
            });
            let here = all.fixed_view::<7, 7>(0, 0) + cross.transpose() * state;
            after = (here + here.transpose()) * 0.5;
        }
        self.gains.reverse();
        let Some(first) = after.try_inverse() else {
            return false;
        };
        self.first = first;
        self.first.iter().all(|v| v.is_finite())
    }

    fn solve(&self) -> Vec<f64> {
        let count = self.right.len();
        let mut pushes = vec![SVector::<f64, 3>::zeros(); count];
        let part = |piece: usize| {
            self.right
                .get(piece)
                .copied()
                .unwrap_or_else(Stacked::zeros)
        };
        let mut pull: State = part(count - 1).fixed_rows::<7>(0).into_owned();
        let backwards = self.links.iter().zip(&self.gains).enumerate().rev();
        for (piece, (link, gain)) in backwards {
            let all = part(piece) + link.forward.transpose() * (pull - gain.after * link.left);
            let inputs = all.fixed_rows::<3>(7).into_owned();
            if let Some(push) = pushes.get_mut(piece) {
                *push = gain.inverse * inputs;
            }
            pull = all.fixed_rows::<7>(0) + gain.state.transpose() * inputs;
        }
        let mut state = self.first * pull;
        let mut change = vec![0.0; WIDTH * count];
        let stages = change.chunks_exact_mut(WIDTH).enumerate();
        for (piece, change) in stages {
            let mut all = Stacked::zeros();
            all.fixed_rows_mut::<7>(0).copy_from(&state);
            if let (Some(link), Some(gain)) = (self.links.get(piece), self.gains.get(piece)) {
                let push = pushes.get(piece).copied().unwrap_or_else(SVector::zeros);
                all.fixed_rows_mut::<3>(7)
                    .copy_from(&(gain.state * state + push));
                state = link.forward * all + link.left;
            }
            change.copy_from_slice(all.as_slice());
        }
        change
    }
}
