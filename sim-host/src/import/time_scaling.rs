//! Time scaling: the reference runs more slowly where a base could not follow, or as fast as it can.

use super::interior::{Start, WARM};
use super::limits::{Bound, LimitError, Loads, ReferenceLimits};
use super::time_optimal::{JerkRow, Problem, Row, Spline, dot};
use super::time_warp::{Tick, TimeWarp};
use super::trajectory::is_rest;
use super::{Closeness, Sample, Trajectory};
use std::fmt;

/// A part of the trajectory that is run more slowly.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaledSpan {
    /// From and to, in the file's time \[s\].
    pub file_s: (f64, f64),
    /// From and to, in the scaled time \[s\].
    pub run_s: (f64, f64),
    /// What the file exceeds most there, and by which factor; none where it only slows down
    /// towards a neighbour.
    pub exceeded: Option<(Bound, f64)>,
    /// Where it exceeds nothing: the limits that the run is nearest to there, which share it.
    pub nearest: Vec<Bound>,
}

/// What was scaled, where and by how much.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimeScaling {
    /// New duration by old.
    pub factor: f64,
    /// Largest local factor.
    pub slowest: f64,
    /// Where; empty if the file is within the limits and untouched.
    pub places: Vec<ScaledSpan>,
    /// What the time-scaled trajectory uses of the limits, at most 1.
    pub load: f64,
    /// How far the path departs from the file's, if it was smoothed.
    pub departure: Option<Closeness>,
    /// What the search took: its steps, each as often as there were limits to look at.
    pub work: usize,
}

/// How fast a trajectory may be run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// Nowhere faster than now.
    #[default]
    Own,
    /// As fast as the limits allow.
    Fastest,
}

/// Pieces of the law are at most this long \[s\], in the path's own time at first, then in that of the
/// run, unless there would be too many.
const SPACING: f64 = 0.006;
const MAX_PIECES: f64 = 1e5;
/// Times that the pieces are divided.
const REFINEMENTS: usize = 3;
/// Rounds of tightening where a limit is passed between the points that the problem looks at, before
/// everything is slowed by what is left.
const ROUNDS: usize = 8;
/// By how much more than it is passed a limit is tightened in the first of them, and by twice as much
/// in each one more: where nothing else helped, by an eighth.
const MORE: f64 = 1e-3;
/// The problem leaves this part of every limit to what is between those points.
const MARGIN: f64 = 0.002;
/// Accelerations take this long to rise to their limit, whatever jerk may be \[s\]: two ticks.
const RISE: f64 = 0.02;
/// Largest pace, in the path's own: where it stands, nothing else says how fast time may pass.
pub(super) const FASTEST: f64 = 100.0;
/// Part of the time that the optimum on pieces yet to be divided, and on the last ones, may lack: what
/// others begin with; a millisecond in a quarter of an hour.
const COARSE: f64 = WARM;
const FINE: f64 = 1e-6;
/// The search begins with a path's own pace if that uses the limits but for such a factor: paths that
/// were sought together with time use 0.999 to 1.002 of them, others mostly ten times as much.
const NEARLY: f64 = 2.0;
/// Within this part of its own pace a trajectory keeps it.
const KEPT: f64 = 1e-5;

impl Trajectory {
    /// The same path, run more slowly where `limits` would be exceeded, and what was scaled.
    ///
    /// Within the limits nothing changes, with [`Pace::Own`]. Elsewhere it is the fastest law of
    /// time that keeps them (`time_optimal`); it begins and ends at rest if the file does, else no faster than the file.
    ///
    /// # Errors
    /// A limit that is not positive.
    pub fn time_scaled(
        &self,
        limits: &ReferenceLimits,
        pace: Pace,
    ) -> Result<(Self, TimeScaling), LimitError> {
        limits.validate()?;
        let (_, load) = self.loads(limits).largest();
        if load <= 1.0 && pace == Pace::Own {
            let untouched = TimeScaling {
                factor: 1.0,
                slowest: 1.0,
                places: Vec::new(),
                load,
                departure: None,
                work: 0,
            };
            return Ok((self.clone(), untouched));
        }
        let own = |s: f64| self.most(s, pace);
        let (run, load, work) = self.without_time_warp().fastest(limits, &own, pace);
        let ticks = run.time_warp.iter().flat_map(TimeWarp::ticks);
        let places: Vec<_> = ticks.map(|tick| (tick.s, tick.t, tick.rate)).collect();
        let mut scaling = self.scaling(limits, &run, load, &places);
        scaling.work = work;
        Ok((run, scaling))
    }

    /// The fastest run of the path, with squared rates of time up to `most`; its load; and
    /// what the search took.
    pub(super) fn fastest(
        &self,
        limits: &ReferenceLimits,
        most: &dyn Fn(f64) -> f64,
        pace: Pace,
    ) -> (Self, f64, usize) {
        // A robot does not begin faster than it is said to, nor does it have to stop from more.
        let moves = [0.0, self.path_duration()].map(|s| (s, self.at(s)));
        let moves = moves.map(|(s, end)| (s, !is_rest(end.v, end.w)));
        let most = |s: f64| {
            let kept = moves.iter().any(|(end, moves)| *moves && s == *end);
            if kept { most(s).min(1.0) } else { most(s) }
        };
        let mut search = Search {
            spline: self.first_knots(),
            tight: Vec::new(),
            plain: self,
            limits,
            most: &most,
            pace,
        };
        let problem = search.problem();
        let (_, load) = self.loads(limits).largest();
        let c = if (NEARLY.recip()..NEARLY).contains(&load) {
            vec![1.0; problem.most.len()]
        } else {
            problem.slow()
        };
        let mut start = Start {
            c,
            ..Start::default()
        };
        for _ in 0..REFINEMENTS {
            let problem = search.problem();
            problem.solve(&mut start, COARSE);
            if !search.refine(&problem, &mut start) {
                break;
            }
        }
        let mut rounds = 0;
        loop {
            let mut c = search.problem().solve(&mut start, FINE);
            search.snap(&mut c);
            let law = search.law(&c);
            let run = self.with_time_warp(law);
            let load = search.tighten(&run, rounds);
            rounds += 1;
            if load <= 1.0 {
                return (run, load, start.work);
            }
            if rounds == ROUNDS {
                // All loads fall at least as fast as time is slowed.
                let slower = search.law(&c).slower(load);
                return (self.with_time_warp(slower), 1.0, start.work);
            }
        }
    }

    /// The largest squared rate of the path's own time.
    fn most(&self, s: f64, pace: Pace) -> f64 {
        match (&self.time_warp, pace) {
            (_, Pace::Fastest) => FASTEST * FASTEST,
            (None, Pace::Own) => 1.0,
            (Some(time_warp), Pace::Own) => time_warp.rate_at(s).powi(2),
        }
    }

    /// The knots of the path's own pieces, and more between them.
    fn first_knots(&self) -> Spline {
        let end = self.path_duration();
        let spacing = SPACING.max(end / MAX_PIECES);
        let mut knots = vec![0.0];
        for pair in self.nodes.windows(2) {
            let [from, to] = pair else { continue };
            let parts = ((to.t - from.t) / spacing).ceil().max(1.0);
            knots.extend((1..=parts as usize).map(|i| {
                let p = i as f64 / parts;
                from.t + p * (to.t - from.t)
            }));
        }
        Spline { knots }
    }

    /// Where a run is slower than this trajectory, by places of it: its own time, the time of the run,
    /// and the rate of the first by the second.
    pub(super) fn scaling(
        &self,
        limits: &ReferenceLimits,
        run: &Self,
        load: f64,
        places: &[(f64, f64, f64)],
    ) -> TimeScaling {
        let mut scaling = TimeScaling {
            factor: run.duration() / self.duration(),
            slowest: 1.0,
            places: Vec::new(),
            load,
            departure: None,
            work: 0,
        };
        let plain = self.without_time_warp();
        let mut open: Option<ScaledSpan> = None;
        let mut last: Option<(Sample, f64)> = None;
        for &(s, t, rate) in places {
            let sample = plain.at(s);
            let (from, before) = last.replace((sample, t)).unwrap_or((sample, t));
            scaling.slowest = scaling.slowest.max(rate.recip());
            if rate >= 1.0 - 1e-9 {
                scaling.places.extend(open.take());
                continue;
            }
            let here = open.get_or_insert(ScaledSpan {
                file_s: (from.t, s),
                run_s: (before, t),
                exceeded: None,
                nearest: Vec::new(),
            });
            (here.file_s.1, here.run_s.1) = (s, t);
            let mut loads = limits.loads(&sample);
            loads.merge(&limits.jerk_loads(&from, &sample));
            let (bound, load) = loads.largest();
            if load > here.exceeded.map_or(1.0, |(_, most)| most) {
                here.exceeded = Some((bound, load));
            }
        }
        scaling.places.extend(open);
        for span in &mut scaling.places {
            if span.exceeded.is_none() {
                span.nearest = run.loads_within(limits, span.run_s, places).nearest();
            }
        }
        scaling
    }

    /// What a run uses of the limits from one time of it to another.
    fn loads_within(
        &self,
        limits: &ReferenceLimits,
        (from, to): (f64, f64),
        places: &[(f64, f64, f64)],
    ) -> Loads {
        let times = places.iter().map(|(_, t, _)| *t);
        let samples: Vec<Sample> = times
            .filter(|t| (from..=to).contains(t))
            .map(|t| self.at(t))
            .collect();
        let mut most = Loads::default();
        for sample in &samples {
            most.merge(&limits.loads(sample));
        }
        for pair in samples.windows(2) {
            if let [from, to] = pair {
                most.merge(&limits.jerk_loads(from, to));
            }
        }
        most
    }

    /// What a trajectory uses of the limits.
    fn loads(&self, limits: &ReferenceLimits) -> Loads {
        let mut most = Loads::default();
        for loads in self.piece_loads(limits) {
            most.merge(&loads);
        }
        most
    }

    /// The same of every piece of its law of time, or of its path if time is not scaled.
    fn piece_loads(&self, limits: &ReferenceLimits) -> Vec<Loads> {
        let ends: Vec<f64> = match &self.time_warp {
            Some(time_warp) => time_warp.ticks().iter().map(|tick| tick.t).collect(),
            None => self.nodes.iter().map(|node| node.t).collect(),
        };
        let mut from = self.at(0.0);
        let of_piece = |pair: &[f64]| {
            let [start, end] = pair else {
                return Loads::default();
            };
            let to = self.at(*end);
            let mut most = limits.jerk_loads(&from, &to);
            most.merge(&limits.loads(&from));
            for i in 1..4 {
                let t = start + (end - start) * f64::from(i) / 4.0;
                most.merge(&limits.loads(&self.at(t)));
            }
            most.merge(&limits.loads(&to));
            from = to;
            most
        };
        ends.windows(2).map(of_piece).collect()
    }
}

/// The search for a law of time.
struct Search<'a> {
    spline: Spline,
    /// By how much limits are tightened, for every piece; empty before any is.
    tight: Vec<Loads>,
    plain: &'a Trajectory,
    limits: &'a ReferenceLimits,
    most: &'a dyn Fn(f64) -> f64,
    pace: Pace,
}

impl Search<'_> {
    /// Limits at every piece.
    fn problem(&self) -> Problem {
        let knots = &self.spline.knots;
        let most = self.most();
        let (mut rows, mut jerks) = (Vec::new(), Vec::new());
        let tight = |piece: usize, bound| {
            let found = self.tight.get(piece).map(|tight| tight.of(bound));
            (1.0 - MARGIN) / found.unwrap_or_default().max(1.0)
        };
        let limits = self.limits;
        let jerks_within = jerk_limits(limits);
        let pieces = self.spline.pieces();
        let points: Vec<Sample> = knots.iter().map(|s| self.plain.at(*s)).collect();
        for (piece, pair) in knots.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            // Next to a knot the direction may change: there the limits of both hold.
            let near = points.get(piece.saturating_sub(1)..(piece + 3).min(points.len()));
            let speeds = near.unwrap_or_default().iter().map(|point| point.v);
            let (back, ahead) = speeds.fold((0.0_f64, 0.0_f64), |(b, a), v| (b.min(v), a.max(v)));
            let reverses = back < 0.0 && ahead > 0.0;
            let last = points.last().filter(|_| piece + 1 == pieces);
            let ends = [points.get(piece).zip(Some(0.0)), last.zip(Some(1.0))];
            for (point, p) in ends.into_iter().flatten() {
                let [value, slope, _] = self.spline.factors(piece, p);
                // The lowest is the only one that counts.
                let ceilings = self.limits.ceilings(point);
                let shares = ceilings.map(|(bound, high)| high * tight(piece, bound).powi(2));
                let share = shares.into_iter().fold(f64::INFINITY, f64::min);
                let g = value.map(|v| v / share);
                rows.push(Row { piece, g, h: 1.0 });
                for row in self.limits.rows(point, reverses) {
                    if !row.high.is_finite() && !row.low.is_finite() {
                        continue;
                    }
                    let share = tight(piece, row.bound);
                    for limit in [row.high * share, row.low * share] {
                        let mut g = [0.0; 3];
                        for ((g, value), slope) in g.iter_mut().zip(value).zip(slope) {
                            *g = (row.c * value + row.d * slope) / limit;
                        }
                        rows.push(Row { piece, g, h: 1.0 });
                    }
                }
            }
            for p in [0.25, 0.75] {
                let s = from + p * (to - from);
                let point = self.plain.at(s);
                let jerk = self.plain.path_jerk(s);
                let [value, slope, second] = self.spline.factors(piece, p);
                for (bound, limit, j, a, v) in [
                    (Bound::Jerk, jerks_within[0], jerk[0], point.a, point.v),
                    (
                        Bound::AngularJerk,
                        jerks_within[1],
                        jerk[1],
                        point.alpha,
                        point.w,
                    ),
                ] {
                    if !limit.is_finite() {
                        continue;
                    }
                    let limit = limit * tight(piece, bound);
                    let mut g = [0.0; 3];
                    let factors = value.into_iter().zip(slope).zip(second);
                    for (g, ((value, slope), second)) in g.iter_mut().zip(factors) {
                        *g = (j * value + 1.5 * a * slope + 0.5 * v * second) / limit;
                    }
                    jerks.push(JerkRow { piece, g, value });
                }
            }
        }
        Problem {
            spline: self.spline.clone(),
            most,
            rows,
            jerks,
        }
    }

    /// The largest coefficients, by the pace.
    fn most(&self) -> Vec<f64> {
        let count = self.spline.pieces() + 2;
        // Of the pieces that a coefficient bears on, the slowest.
        let knots = &self.spline.knots;
        let knot = |i: usize| knots.get(i.min(knots.len() - 1)).copied().unwrap_or(0.0);
        (0..count)
            .map(|i| {
                let (from, to) = (knot(i.saturating_sub(2)), knot(i + 1));
                let at = |p: f64| (self.most)(from + p * (to - from));
                at(0.0).min(at(0.5)).min(at(1.0))
            })
            .collect()
    }

    /// Divides the pieces that take long, and the law with them; false if none does.
    fn refine(&mut self, problem: &Problem, start: &mut Start) -> bool {
        let law = self.law(&start.c);
        let spacing = SPACING.max(law.duration() / MAX_PIECES);
        let mut knots = Vec::new();
        // Of every new piece: the one that it is of, and the part of it that it is.
        let mut parents = Vec::new();
        let mut divided = false;
        for (piece, pair) in law.ticks().windows(2).enumerate() {
            let [from, to] = pair else { continue };
            let parts = ((to.t - from.t) / spacing).ceil().clamp(1.0, 64.0);
            divided |= parts > 2.0;
            for i in 0..parts as usize {
                let p = i as f64 / parts;
                knots.push(from.s + p * (to.s - from.s));
                parents.push((piece, parts.recip()));
            }
        }
        knots.extend(self.spline.knots.last());
        self.spline = Spline { knots };
        *start = problem.divided(&self.spline, &parents, start);
        divided
    }

    /// Where the law is at the pace that is allowed but for rounding, it keeps that pace.
    fn snap(&self, c: &mut [f64]) {
        if self.pace == Pace::Own {
            for (c, most) in c.iter_mut().zip(self.most()) {
                if *c > most * (1.0 - KEPT) {
                    *c = most;
                }
            }
        }
    }

    /// The law of time of coefficients.
    fn law(&self, c: &[f64]) -> TimeWarp {
        let mut t = 0.0;
        let mut ticks = Vec::with_capacity(self.spline.knots.len());
        let tick = |piece, p, s, t| {
            let [value, slope, _] = self.spline.factors(piece, p);
            Tick {
                t,
                s,
                rate: dot(&value, c, piece).sqrt(),
                rate_dot: 0.5 * dot(&slope, c, piece),
            }
        };
        for (piece, pair) in self.spline.knots.windows(2).enumerate() {
            let [from, to] = pair else { continue };
            ticks.push(tick(piece, 0.0, *from, t));
            for (p, weight) in GAUSS {
                let [value, ..] = self.spline.factors(piece, p);
                t += weight * (to - from) / dot(&value, c, piece).sqrt();
            }
            if piece + 1 == self.spline.pieces() {
                ticks.push(tick(piece, 1.0, *to, t));
            }
        }
        TimeWarp::new(ticks)
    }

    /// Tightens the limits that a law passes, where it does, and returns the largest load.
    fn tighten(&mut self, time_scaled: &Trajectory, round: usize) -> f64 {
        let more = 1.0 + MORE * f64::from(1 << round);
        let pieces = time_scaled.piece_loads(self.limits);
        let mut largest: f64 = 0.0;
        self.tight.resize(pieces.len(), Loads::default());
        for (piece, loads) in pieces.iter().enumerate() {
            let (_, load) = loads.largest();
            largest = largest.max(load);
            if load <= 1.0 {
                continue;
            }
            let near = piece.saturating_sub(1)..(piece + 2).min(pieces.len());
            for tight in self.tight.get_mut(near).unwrap_or_default() {
                tight.tighten(loads, more);
            }
        }
        largest
    }
}

/// Largest rates of acceleration and of angular acceleration.
pub(super) fn jerk_limits(limits: &ReferenceLimits) -> [f64; 2] {
    let accel = limits.max_accel.max(limits.max_decel);
    [
        limits.max_jerk.min(accel / RISE),
        limits.max_angular_jerk.min(limits.max_angular_accel / RISE),
    ]
}

/// Abscissae and weights of three points on \[0, 1\].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

impl fmt::Display for TimeScaling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.places.is_empty() && self.factor == 1.0 && self.departure.is_none() {
            return f.write_str("within the limits, time not scaled");
        }
        let (factor, slowest) = (self.factor, self.slowest);
        write!(
            f,
            "time scaled by {factor:.3} in all, up to {slowest:.2} locally"
        )?;
        if let Some(by) = self.departure {
            let (mm, mrad) = (1e3 * by.position_m, 1e3 * by.heading_rad);
            write!(
                f,
                "\n  path smoothed by up to {mm:.1} mm and {mrad:.0} mrad"
            )?;
        }
        for place in &self.places {
            let ((from, to), (run_from, run_to)) = (place.file_s, place.run_s);
            write!(
                f,
                "\n  {from:.3} to {to:.3} s takes {:.3} s",
                run_to - run_from
            )?;
            if let Some((bound, load)) = place.exceeded {
                write!(f, ": {bound} {load:.2} times the limit")?;
            }
            if !place.nearest.is_empty() {
                let nearest: Vec<_> = place.nearest.iter().map(Bound::to_string).collect();
                write!(f, ": nearest to the limits of {}", nearest.join(" and "))?;
            }
        }
        Ok(())
    }
}
