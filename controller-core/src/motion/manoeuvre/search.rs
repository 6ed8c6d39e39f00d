//! The quickest manoeuvre to a pose, by a bounded number of steps.

use super::candidate::{CANDIDATES, Candidate, Pace, PlanLimits, Target, likely, peak};
use super::path::{Ends, Path, Vector};
use super::profile::Quality;
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::scalar::residue;

/// Evaluations of a path's end in a second of ticks. One of 5,000 instructions every 2.5 ms is 2 % of a chip of
/// 100 MHz, and a search takes 0.3 s at most.
const PER_SECOND: f64 = 400.0;

/// The most evaluations in a tick, however long it is; one is the least.
const MOST_PER_TICK: u8 = 16;

/// Evaluations that an exact one counts as: it has twice their stretches.
const FINE: u8 = 2;

/// Evaluations in a search; then the best so far is polished.
const EVALUATIONS: u8 = 90;

/// Shapes that may be ruled out instead of an evaluation.
const GUESSES: u8 = 4;

/// Quasi-Newton steps for one shape.
const STEPS: u8 = 8;

/// The same from where it leads there roughly.
const POLISHING: u8 = 5;

/// A search under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Search<T> {
    pace: Pace,
    target: Target<T>,
    /// When the manoeuvre may start, for a robot that moves \[s\].
    ready: T,
    /// Turning into the line to the goal takes longer than driving along it.
    near: bool,
    /// No manoeuvre is quicker than this \[s\].
    least: T,
    /// Of the shape that is being tried.
    index: u8,
    /// So far, and those that belong to the ticks so far and were not made.
    evaluations: u8,
    left: u8,
    polishing: bool,
    solver: Option<Solver<T>>,
    best: Option<Best<T>>,
}

/// The quickest manoeuvre so far.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Best<T> {
    index: u8,
    duration: T,
    numbers: [T; 2],
    slope: Option<[Vector<T>; 2]>,
}

/// Broyden's method for two numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Solver<T> {
    numbers: [T; 2],
    /// Derivative of the end by the numbers, once it is known.
    slope: Option<[Vector<T>; 2]>,
    moved: [T; 2],
    residual: Vector<T>,
    first: T,
    step: u8,
    quality: Quality,
}

/// Where a manoeuvre leads.
struct Evaluation<T> {
    ends: Ends<T>,
    /// From there to the goal,
    residual: Vector<T>,
    /// and how far that is \[m\].
    miss: T,
}

/// What came of a tick of searching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// Not done.
    Searching,
    /// The quickest one is found.
    Found,
    /// No shape led there.
    Failed,
}

/// Evaluations in a tick of `dt` \[s\]: their rate is the same at every period that a chip may have.
fn per_tick<T: Scalar>(dt: T) -> u8 {
    let due = T::from_f64(PER_SECOND) * dt + T::HALF;
    let mut count = 1;
    while count < MOST_PER_TICK && T::from_i32(i32::from(count) + 1) <= due {
        count += 1;
    }
    count
}

/// When a robot that moves may start the manoeuvre that is searched for in ticks of `dt` \[s\].
///
/// The most that a search takes: its evaluations, the last shape's to its end if no other led there, what shapes were ruled out in, and
/// polishing; one each to start and to begin to polish.
pub(crate) fn ready_s<T: Scalar>(dt: T) -> T {
    let all = EVALUATIONS + STEPS + CANDIDATES.div_ceil(GUESSES) + FINE * (POLISHING + 1) + 2;
    // Never divided by 0, which a compiler that saves space does not see.
    let ticks = all.checked_div(per_tick(dt)).unwrap_or(all) + 3;
    T::from_i32(i32::from(ticks)) * dt
}

impl<T: Scalar> Search<T> {
    /// A search for the way to `error`, the goal as the robot sees it now, while it moves on as in `begin`. `limits` are those of the
    /// `pace`.
    pub(crate) fn start<M: Maths<T>>(
        (limits, pace): (&PlanLimits<T>, Pace),
        error: &PoseError<T>,
        begin: &Path<T>,
        dt: T,
    ) -> Self {
        let position = Vector {
            x: error.x,
            y: error.y,
        };
        let moving = begin.duration() > T::ZERO;
        let turned = begin.turn_at(begin.stop_turn.duration()).position;
        let left = if moving {
            position.minus(begin.ends::<M>(Quality::Rough).stopping)
        } else {
            position
        };
        let turn = (error.theta - turned).wrap_angle();
        let distance = left.norm::<M>();
        let straight = limits.drive.profile::<M>(distance).duration();
        let target = Target {
            position,
            turn,
            bearing: M::atan2(left.y, left.x) - turned,
            distance,
            straight,
        };
        let aside = limits.turn.profile::<M>(turn).duration();
        let off_line = off_line(target.bearing);
        let into_line = limits.turn.profile::<M>(off_line).duration();
        Self {
            pace,
            target,
            ready: if moving { ready_s(dt) } else { T::ZERO },
            near: straight < into_line,
            least: if straight > aside { straight } else { aside },
            index: 0,
            evaluations: 0,
            left: 0,
            polishing: false,
            solver: None,
            best: None,
        }
    }

    /// Of the goal's distance, which may be so far that it is no number.
    pub(crate) fn residue(&self) -> T {
        residue([self.target.distance])
    }

    /// The shape is chosen.
    pub(crate) fn is_polishing(&self) -> bool {
        self.polishing
    }

    /// The goal is elsewhere by a little, and turned.
    pub(crate) fn correct(&mut self, moved: Vector<T>, turned: T) {
        self.target.position = self.target.position.plus(moved);
        self.target.turn = (self.target.turn + turned).wrap_angle();
    }

    /// When the manoeuvre starts, at the earliest \[s\].
    pub(crate) fn ready(&self) -> T {
        self.ready
    }

    /// A tick of `dt` on: as many evaluations as belong to it, one less in the tick that [starts](Self::start) the search. `plan` is what a
    /// manoeuvre at full pace may use. `path` has the motion at the begin, gets what is found, and is where manoeuvres are tried: a copy
    /// of each would be most of what a search needs of the stack.
    pub(crate) fn advance<M: Maths<T>>(
        &mut self,
        plan: &PlanLimits<T>,
        path: &mut Path<T>,
        dt: T,
        starts: bool,
    ) -> Progress {
        let limits = &plan.at(self.pace);
        self.left += per_tick(dt) - u8::from(starts);
        let mut progress = Progress::Searching;
        while progress == Progress::Searching {
            let work = self.next_work();
            let Some(left) = self.left.checked_sub(work) else {
                break;
            };
            self.left = left;
            progress = if self.polishing {
                self.polish::<M>(limits, path)
            } else {
                self.compare::<M>(limits, path)
            };
        }
        if progress != Progress::Found {
            path.forget_manoeuvre();
        }
        progress
    }

    /// What the next evaluation counts as.
    fn next_work(&self) -> u8 {
        match self.solver {
            Some(solver) if solver.quality == Quality::Fine => FINE,
            _ => 1,
        }
    }

    /// One evaluation of the shape that is being tried: rough ones until it leads there, then, if it may be the quickest, exact ones.
    /// What leads there roughly need not lead there.
    fn compare<M: Maths<T>>(&mut self, limits: &PlanLimits<T>, path: &mut Path<T>) -> Progress {
        let is_late = self.best.is_some() && self.evaluations >= EVALUATIONS;
        if is_late || (self.solver.is_none() && self.is_done()) {
            return self.begin_polishing();
        }
        if self.solver.is_none() {
            self.solver = self.next_guess::<M>(limits);
        }
        let Some((solver, candidate)) = self.tried::<M>(limits) else {
            return Progress::Searching;
        };
        self.evaluations = self.evaluations.saturating_add(self.next_work());
        let Evaluation {
            ends,
            residual,
            miss,
        } = self.evaluate::<M>(limits, path, &solver, &candidate);
        let duration = path.duration();
        let f = T::from_f64;
        let enough = match solver.quality {
            Quality::Rough => f(5.0e-4) * self.target.distance,
            // The rest is polished.
            Quality::Fine => f(1.0e-4) * (T::ONE + self.target.distance),
        };
        if miss > enough {
            if self.is_hopeless(path, duration, miss)
                || !self.corrects(&candidate, &ends.drives, residual, miss)
            {
                self.next_shape();
            }
        } else if self.best.is_some_and(|best| duration >= best.duration) {
            self.next_shape();
        } else {
            let exact = solver.quality == Quality::Fine;
            if exact || self.best.is_none() {
                self.best = Some(Best {
                    index: self.index,
                    // One that leads there roughly is better than none.
                    duration: if exact { duration } else { T::MAX },
                    numbers: solver.numbers,
                    slope: solver.slope,
                });
            }
            if exact {
                self.next_shape();
            } else {
                self.solver = Some(Solver::refine(solver.numbers, solver.slope));
            }
        }
        Progress::Searching
    }

    /// This shape will not be the quickest, although it does not lead there yet: at the speed and turn rate that it has, what it
    /// misses takes less time than it is slower by.
    fn is_hopeless(&self, path: &Path<T>, duration: T, miss: T) -> bool {
        self.best.is_some_and(|best| {
            let turned = miss / self.target.distance;
            let more = miss / peak(&path.drives) + turned / peak(&path.turns);
            duration > best.duration + more
        })
    }

    /// The solver has another step to make.
    fn corrects(
        &mut self,
        candidate: &Candidate<T>,
        ends: &[Vector<T>; 2],
        residual: Vector<T>,
        miss: T,
    ) -> bool {
        let Some(solver) = &mut self.solver else {
            return false;
        };
        solver.advance(candidate, ends, residual, miss, &self.target)
    }

    fn next_shape(&mut self) {
        self.solver = None;
        self.index += 1;
    }

    /// There is no shape left that could be quicker by much, or time is up, which is longer for a robot that stands and knows no way.
    fn is_done(&self) -> bool {
        let good = T::from_f64(1.03) * self.least + self.ready;
        let is_enough = |best: Best<T>| best.duration < good || self.index >= likely(self.near);
        let stands = self.ready == T::ZERO;
        let most = if stands { 2 * EVALUATIONS } else { EVALUATIONS };
        self.best.is_some_and(is_enough) || self.evaluations >= most || self.index >= CANDIDATES
    }

    /// The first guess for the next shape that may be quicker; `None` if none of the next [`GUESSES`] may.
    fn next_guess<M: Maths<T>>(&mut self, limits: &PlanLimits<T>) -> Option<Solver<T>> {
        let bound = self.best.map_or(T::MAX, |best| best.duration);
        for _ in 0..GUESSES {
            let candidate = self.candidate::<M>(limits, self.index)?;
            if let Some(numbers) = candidate.guess::<M>(limits, &self.target, bound) {
                return Some(Solver::start(numbers));
            }
            self.index += 1;
        }
        None
    }

    fn begin_polishing(&mut self) -> Progress {
        match self.best {
            Some(best) => {
                self.index = best.index;
                self.polishing = true;
                self.solver = Some(Solver::refine(best.numbers, best.slope));
                Progress::Searching
            }
            None => Progress::Failed,
        }
    }

    /// One exact evaluation of the best shape.
    fn polish<M: Maths<T>>(&mut self, limits: &PlanLimits<T>, path: &mut Path<T>) -> Progress {
        let Some((solver, candidate)) = self.tried::<M>(limits) else {
            return Progress::Failed;
        };
        let Evaluation {
            ends,
            residual,
            miss,
        } = self.evaluate::<M>(limits, path, &solver, &candidate);
        // Ten times the rounding of the sum in single precision.
        let enough = T::from_f64(2.0e-6) * (T::ONE + self.target.distance);
        if miss <= enough || !self.corrects(&candidate, &ends.drives, residual, miss) {
            Progress::Found
        } else {
            Progress::Searching
        }
    }

    /// Tries what the solver says of the shape in `path`.
    fn evaluate<M: Maths<T>>(
        &self,
        limits: &PlanLimits<T>,
        path: &mut Path<T>,
        solver: &Solver<T>,
        candidate: &Candidate<T>,
    ) -> Evaluation<T> {
        candidate.lay_out::<M>(limits, &self.target, &solver.numbers, self.ready, path);
        let ends = path.ends::<M>(solver.quality);
        let [a, b] = ends.drives;
        let reached = ends.stopping.plus(a.plus(b));
        let residual = self.target.position.minus(reached);
        Evaluation {
            ends,
            residual,
            miss: residual.norm::<M>(),
        }
    }

    /// The shape that is being tried.
    fn tried<M: Maths<T>>(&self, limits: &PlanLimits<T>) -> Option<(Solver<T>, Candidate<T>)> {
        self.solver.zip(self.candidate::<M>(limits, self.index))
    }

    fn candidate<M: Maths<T>>(&self, limits: &PlanLimits<T>, index: u8) -> Option<Candidate<T>> {
        Candidate::numbered::<M>(index, self.near, limits, &self.target)
    }
}

/// What a robot turns by until it looks along the line through a goal at this bearing, towards the goal or away from it \[rad\].
fn off_line<T: Scalar>(bearing: T) -> T {
    let bearing = bearing.wrap_angle().abs();
    if bearing > T::FRAC_PI_2 {
        T::PI - bearing
    } else {
        bearing
    }
}

impl<T: Scalar> Solver<T> {
    /// From a guess on, roughly.
    fn start(numbers: [T; 2]) -> Self {
        Self {
            numbers,
            slope: None,
            moved: [T::ZERO; 2],
            residual: Vector::default(),
            first: T::ZERO,
            step: 0,
            quality: Quality::Rough,
        }
    }

    /// From numbers that are about right on, exactly.
    fn refine(numbers: [T; 2], slope: Option<[Vector<T>; 2]>) -> Self {
        Self {
            slope,
            quality: Quality::Fine,
            ..Self::start(numbers)
        }
    }

    /// The next two numbers; false if this leads nowhere, and nothing is left of use.
    ///
    /// The slope is a guess from the ends at first, and then Broyden's: changed least so that it explains the last step.
    fn advance(
        &mut self,
        candidate: &Candidate<T>,
        ends: &[Vector<T>; 2],
        residual: Vector<T>,
        miss: T,
        target: &Target<T>,
    ) -> bool {
        let f = T::from_f64;
        let rough = self.quality == Quality::Rough;
        let proportional = matches!(candidate, Candidate::TwoDrives { .. });
        if self.step == 0 {
            self.first = miss;
        }
        let most = if rough { STEPS } else { POLISHING };
        if self.step >= most || (rough && self.step == 4 && miss > f(0.3) * self.first) {
            return false;
        }
        let [a, b] = match self.slope {
            Some(slope) if self.step == 0 => slope,
            Some([a, b]) if !rough || self.step > 1 || !proportional => {
                let [u, v] = self.moved;
                let length = u * u + v * v;
                let unexplained = self
                    .residual
                    .minus(residual)
                    .minus(a.scaled(u))
                    .minus(b.scaled(v));
                [
                    a.plus(unexplained.scaled(u / length)),
                    b.plus(unexplained.scaled(v / length)),
                ]
            }
            _ => candidate.slope(&self.numbers, ends),
        };
        self.slope = Some([a, b]);
        let determinant = a.x * b.y - b.x * a.y;
        let step = [
            (residual.x * b.y - residual.y * b.x) / determinant,
            (a.x * residual.y - a.y * residual.x) / determinant,
        ];
        if !(step[0].is_finite() && step[1].is_finite()) {
            return false;
        }
        // No further than the guess may be wrong.
        let reach = f(0.3) + target.distance;
        let limits = [if proportional { reach } else { f(0.7) }, reach];
        self.moved = [clamp(step[0], limits[0]), clamp(step[1], limits[1])];
        if self.moved == [T::ZERO; 2] {
            return false;
        }
        self.numbers = [
            self.numbers[0] + self.moved[0],
            self.numbers[1] + self.moved[1],
        ];
        self.residual = residual;
        self.step += 1;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::profile::{AxisLimits, Profile};
    use super::{Pace, PlanLimits, Progress, Search, ready_s};
    use crate::maths::{Libm, Maths, Single};
    use crate::motion::manoeuvre::PLAN_SHARE;
    use crate::motion::manoeuvre::path::Path;
    use crate::pose_error::PoseError;
    use crate::scalar::Scalar;

    /// A heavy base that turns slowly, and a light one that turns quickly: speed, up, down, jerk; turn rate,
    /// acceleration, jerk.
    const BASES: [[f64; 7]; 2] = [
        [2.5, 1.5, 1.5, 20.0, 3.0, 0.9, 40.0],
        [0.8, 1.0, 1.5, 30.0, 6.0, 15.0, 300.0],
    ];

    fn limits<T: Scalar>(base: &[f64; 7]) -> PlanLimits<T> {
        let f = T::from_f64;
        let [speed, up, down, jerk, turn_rate, turn_accel, turn_jerk] = *base;
        PlanLimits {
            drive: AxisLimits {
                rate: f(speed),
                up: f(up),
                down: f(down),
                jerk_s: f(up.max(down) / jerk),
            },
            turn: AxisLimits {
                rate: f(turn_rate),
                up: f(turn_accel),
                down: f(turn_accel),
                jerk_s: f(turn_accel / turn_jerk),
            },
            rim: f(speed.max(0.2 * turn_rate)),
            half_track: f(0.2),
        }
    }

    /// Goals on a spiral of 1 mm to 3 m, from rest and from motion.
    fn goals() -> impl Iterator<Item = (PoseError<f64>, f64, f64)> {
        (0..400).map(|i| {
            let i = f64::from(i);
            let (distance, bearing) = (1e-3 * 3000.0_f64.powf(i / 400.0), 2.399_963 * i);
            let error = PoseError {
                x: distance * bearing.cos(),
                y: distance * bearing.sin(),
                theta: (1.618_034 * i).wrap_angle(),
            };
            let moving = (i as i32 % 3 - 1) as f64;
            (error, 0.5 * moving, 0.3 * moving * bearing.sin())
        })
    }

    /// Every goal is reached, in a bounded number of ticks, to a tenth of a millimetre and a milliradian: a path
    /// integrated in 40,000 steps ends there.
    fn ends_at_the_goal<T: Scalar, M: Maths<T>>(tolerance: f64) {
        for base in BASES {
            let (limits, exact) = (limits::<T>(&base), limits::<f64>(&base));
            for (error, v, w) in goals() {
                let mut path = Path {
                    stop_drive: limits.drive.stop(T::from_f64(v), T::from_f64(0.4 * v)),
                    stop_turn: limits.turn.stop(T::from_f64(w), T::from_f64(-w)),
                    ..Path::default()
                };
                let dt = T::from_f64(0.01);
                let mut search =
                    Search::start::<M>((&limits, Pace::default()), &error.cast(), &path, dt);
                let mut ticks = 1;
                while search.advance::<M>(&limits, &mut path, dt, false) == Progress::Searching {
                    ticks += 1;
                }
                assert_ne!(path.drives, [Profile::default(); 2], "{error:?}");
                assert!(ticks <= 40, "{ticks}");
                let profile = |p: &Profile<T>| p.cast_for_test();
                let path = Path {
                    stop_drive: exact.drive.stop(v, 0.4 * v),
                    stop_turn: exact.turn.stop(w, -w),
                    turns: [profile(&path.turns[0]), profile(&path.turns[1])],
                    drives: [profile(&path.drives[0]), profile(&path.drives[1])],
                };
                let steps = 40_000;
                let h = path.duration() / f64::from(steps);
                let (mut x, mut y, mut rim) = (0.0, 0.0, 0.0_f64);
                for i in 0..steps {
                    let t = (f64::from(i) + 0.5) * h;
                    let (sine, cosine) = Libm::sin_cos(path.turn_at(t).position);
                    x += h * path.drive_at(t).rate * cosine;
                    y += h * path.drive_at(t).rate * sine;
                    let turning = exact.half_track * path.turn_at(t).rate.abs();
                    rim = rim.max(path.drive_at(t).rate.abs() + turning);
                }
                let miss = (x - error.x).hypot(y - error.y);
                let turned = (path.turn_at(path.duration()).position - error.theta).wrap_angle();
                assert!(
                    miss < tolerance && turned.abs() < 10.0 * tolerance,
                    "{error:?} {v} {w}: {miss}"
                );
                // Corners of ramps bulge between the instants that are looked at: by less than what a plan leaves of the limits.
                // Motion at the begin is the governor's.
                assert!(
                    v != 0.0 || PLAN_SHARE * rim <= exact.rim,
                    "{error:?}: {rim} of {}",
                    exact.rim
                );
            }
        }
    }

    /// A way is found to a goal that lies ahead of, or behind, a robot that creeps towards it: where friction stopped it. Both drives of two
    /// lie on one line there, which their lengths do not lead off: tried first they took all evaluations, and a quarter of the searches of the heavy base failed.
    #[test]
    fn a_goal_on_the_robots_line_is_found() {
        for base in BASES {
            let pace = Pace {
                smoother: true,
                ..Pace::default()
            };
            let limits = limits::<f64>(&base).at(pace);
            let goals = 600;
            let mut failed = 0;
            for i in 0..goals {
                let i = f64::from(i);
                let part = |of: f64| 2.0 * (of * i).rem_euclid(1.0) - 1.0;
                let x = 5e-4 * 40.0_f64.powf(i / f64::from(goals)) * part(0.618_034).signum();
                let error = PoseError {
                    x,
                    y: 0.05 * x * part(0.754_878),
                    theta: 1e-3 * part(0.569_840),
                };
                let mut path = Path {
                    stop_drive: limits.drive.stop(1.2 * x, 0.0),
                    stop_turn: limits.turn.stop(error.theta, 0.0),
                    ..Path::default()
                };
                let mut search = Search::start::<Libm>((&limits, pace), &error, &path, 0.01);
                let progress = loop {
                    match search.advance::<Libm>(&limits, &mut path, 0.01, false) {
                        Progress::Searching => {}
                        progress => break progress,
                    }
                };
                failed += u32::from(progress == Progress::Failed);
            }
            assert_eq!(failed, 0);
        }
    }

    /// A robot that moves is never late for its manoeuvre, whatever the period; two of three starts here move.
    #[test]
    fn a_search_ends_before_the_manoeuvre_may_start() {
        for base in BASES {
            let limits = limits::<f32>(&base);
            for dt in [0.0005_f32, 0.001, 0.0025, 0.005, 0.01, 0.02, 0.1] {
                for (error, v, w) in goals() {
                    let mut path = Path {
                        stop_drive: limits.drive.stop(v as f32, 0.0),
                        stop_turn: limits.turn.stop(w as f32, 0.0),
                        ..Path::default()
                    };
                    let pace = Pace::default();
                    let mut search =
                        Search::start::<Single>((&limits, pace), &error.cast(), &path, dt);
                    let mut ticks = 1_u16;
                    let mut starts = true;
                    while search.advance::<Single>(&limits, &mut path, dt, starts)
                        == Progress::Searching
                    {
                        ticks += 1;
                        starts = false;
                    }
                    assert!(f32::from(ticks) * dt <= ready_s(dt), "{ticks} of {dt} s");
                }
            }
        }
    }

    #[test]
    fn manoeuvres_end_at_the_goal() {
        ends_at_the_goal::<f64, Libm>(1e-4);
    }

    #[test]
    fn manoeuvres_end_at_the_goal_in_single_precision() {
        ends_at_the_goal::<f32, Single>(1e-4);
    }
}
