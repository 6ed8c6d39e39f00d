//! The fastest law of time within limits, jerk included.
//!
//! The path is the trajectory itself with its own time s as parameter. With q = (ds/dt)², speeds
//! scale with √q, accelerations are a q + v q′/2, and jerk is √q (j q + 3 a q′/2 + v q″/2): the first
//! two are linear in q, so that standstill is no singular point, and the third is, divided by √q.
//! What jerk may be, J/√q, is convex; its tangent is below it, hence a problem with the tangent in
//! its place is convex and has only motions that keep the limit, and renewed at every step it
//! leads to the optimum.
//!
//! q is a quadratic spline. Sought is the least ∫ ds/√q, by a primal-dual interior-point method. A
//! spline's piece depends on three coefficients, so that each step solves equations with five
//! diagonals: linear in the number of pieces.

use super::interior::{self, Active, Convex, Start};

/// A row of limits on the coefficients of a piece.
pub(super) type Row = interior::Row<[f64; 3]>;

/// |√q g| is at most 1, with q from `value` on the coefficients of the piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct JerkRow {
    pub(super) piece: usize,
    pub(super) g: [f64; 3],
    pub(super) value: [f64; 3],
}

/// Pieces of a quadratic spline: `n + 1` knots, `n + 2` coefficients.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    /// Increasing.
    pub(super) knots: Vec<f64>,
}

impl Spline {
    /// Number of pieces.
    pub(super) fn pieces(&self) -> usize {
        self.knots.len().saturating_sub(1)
    }

    fn length(&self, piece: Option<usize>) -> f64 {
        let ends = piece.and_then(|i| Some((self.knots.get(i)?, self.knots.get(i + 1)?)));
        ends.map_or(0.0, |(from, to)| to - from)
    }

    /// Value, first and second derivative at a part `p` of a piece, as factors of its coefficients.
    pub(super) fn factors(&self, piece: usize, p: f64) -> [[f64; 3]; 3] {
        let h = self.length(Some(piece));
        let before = self.length(piece.checked_sub(1));
        let after = self.length(Some(piece + 1));
        // Control points: the ends are between neighbouring coefficients, the middle is one.
        let (start, end) = (before / (before + h), h / (h + after));
        let bezier = [
            [1.0 - start, start, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 1.0 - end, end],
        ];
        let r = 1.0 - p;
        let combine = |weights: [f64; 3]| {
            let mut sum = [0.0; 3];
            for (weight, point) in weights.iter().zip(&bezier) {
                for (sum, part) in sum.iter_mut().zip(point) {
                    *sum += weight * part;
                }
            }
            sum
        };
        [
            combine([r * r, 2.0 * p * r, p * p]),
            combine([-2.0 * r / h, 2.0 * (r - p) / h, 2.0 * p / h]),
            combine([2.0, -4.0, 2.0].map(|c| c / (h * h))),
        ]
    }
}

/// The product of a row with the coefficients of its piece.
pub(super) fn dot(g: &[f64; 3], coefficients: &[f64], piece: usize) -> f64 {
    let part = coefficients.get(piece..piece + 3).unwrap_or_default();
    g.iter().zip(part).map(|(g, c)| g * c).sum()
}

/// The problem: the largest coefficients, rows of limits.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) spline: Spline,
    /// Of every coefficient.
    pub(super) most: Vec<f64>,
    /// Of every knot, equally many, so that what one has can be found again.
    pub(super) rows: Vec<Row>,
    /// The same of every piece.
    pub(super) jerks: Vec<JerkRow>,
}

/// Abscissae and weights of two points on \[0, 1\].
const GAUSS: [(f64, f64); 2] = [
    (0.211_324_865_405_187_1, 0.5),
    (0.788_675_134_594_812_9, 0.5),
];
/// Part of the limits that a start within them uses.
const INSIDE: f64 = 0.8;
impl Problem {
    /// Coefficients that are slow enough if q changes little.
    pub(super) fn slow(&self) -> Vec<f64> {
        let mut c = self.most.clone();
        let mut lower = |piece: usize, most: f64| {
            for c in c.get_mut(piece..piece + 3).unwrap_or_default() {
                *c = c.min(0.5 * most);
            }
        };
        for row in &self.rows {
            let steady = row.g.iter().sum::<f64>();
            // Not by the larger one of it and 0: of -0, as on a path that is exactly straight, machines differ in which that is.
            if steady > 0.0 {
                lower(row.piece, row.h / steady);
            }
        }
        for row in &self.jerks {
            let steady = row.g.iter().sum::<f64>();
            lower(row.piece, libm::pow(steady.abs(), -2.0 / 3.0));
        }
        c
    }

    /// The part of all limits that coefficients use, at most.
    fn load(&self, c: &[f64]) -> f64 {
        let rows = self.rows.iter().map(|r| dot(&r.g, c, r.piece) / r.h);
        let jerks = self.jerks.iter().map(|r| {
            let q = dot(&r.value, c, r.piece).max(0.0);
            dot(&r.g, c, r.piece).abs() * q.sqrt()
        });
        let boxes = c.iter().zip(&self.most).map(|(c, most)| c / most);
        rows.chain(jerks).chain(boxes).fold(0.0, f64::max)
    }

    /// Coefficients of the fastest law but for a part `gain` of its time, from positive ones that may
    /// be beyond limits; `start` becomes one for problems like this one.
    pub(super) fn solve(&self, start: &mut Start, gain: f64) -> Vec<f64> {
        let found = self.descend(start, gain);
        if found.1 {
            return found.0;
        }
        // The way from beyond the limits may lead nowhere; the way from within them is longer.
        let within = INSIDE / self.load(&start.c).max(INSIDE);
        start.c.iter_mut().for_each(|c| *c *= within);
        start.pairs.clear();
        self.descend(start, gain).0
    }

    /// The same by one descent; and whether it arrived.
    fn descend(&self, start: &mut Start, gain: f64) -> (Vec<f64>, bool) {
        let pieces = self.spline.pieces();
        let c = start.c.clone();
        // Coefficients are positive in parts of themselves.
        for pair in start.pairs.iter_mut().take(2 * c.len()).skip(1).step_by(2) {
            *pair = pair.of_rest();
        }
        // A coefficient alone, as a row of a piece that has it: positive, and at most so large.
        let boxes = self
            .most
            .iter()
            .zip(&c)
            .enumerate()
            .flat_map(|(i, (most, here))| {
                let piece = i.min(pieces.saturating_sub(1));
                [(1.0 / most, 1.0), (-1.0 / here, 0.0)].map(|(factor, h)| {
                    let mut g = [0.0; 3];
                    if let Some(one) = g.get_mut(i - piece) {
                        *one = factor;
                    }
                    Row { piece, g, h }
                })
            });
        let blanks = self.jerks.iter().flat_map(|row| {
            let (piece, g) = (row.piece, row.g);
            [Row { piece, g, h: 1.0 }; 2]
        });
        let mut descent = Descent {
            problem: self,
            system: Banded::new(c.len()),
            first_jerk: 2 * c.len() + self.rows.len(),
        };
        let rows = boxes.chain(self.rows.iter().copied()).chain(blanks);
        interior::descend(&mut descent, start, rows, gain)
    }

    /// The start of a descent on pieces that are parts of these, from that of one on these: `parents` has,
    /// of every piece of `spline`, the one that it is of, and the part of it that it is.
    pub(super) fn divided(
        &self,
        spline: &Spline,
        parents: &[(usize, f64)],
        start: &Start,
    ) -> Start {
        let knots = &spline.knots;
        // A coefficient acts at the middle of three knots.
        let middles = knots.windows(2).map(|pair| 0.5 * pair.iter().sum::<f64>());
        let first = knots.first().copied().into_iter();
        let places = first.chain(middles).chain(knots.last().copied());
        let pieces = self.spline.pieces();
        let mut pairs = Vec::new();
        let mut rest = start.pairs.as_slice();
        let mut inherit = |count: usize, per: usize, parents: &[(usize, f64)]| {
            let (here, after) = rest.split_at_checked(count * per).unwrap_or_default();
            rest = after;
            for (parent, part) in parents {
                let of = here.get(per * parent..per * (parent + 1));
                let of = of.unwrap_or_default().iter();
                pairs.extend(of.map(|pair| pair.of_part(*part)));
            }
        };
        let mut coefficients = vec![(0, 1.0)];
        coefficients.extend(parents.iter().map(|(piece, part)| (piece + 1, *part)));
        coefficients.push((pieces + 1, 1.0));
        inherit(pieces + 2, 2, &coefficients);
        let last = [(pieces, 1.0)];
        let at_knots = self.rows.len() / (pieces + 1);
        inherit(pieces + 1, at_knots, &[parents, &last].concat());
        inherit(pieces, 2 * self.jerks.len() / pieces.max(1), parents);
        Start {
            c: places.map(|s| self.value(&start.c, s)).collect(),
            pairs,
            ..*start
        }
    }

    /// q at a place of the path.
    fn value(&self, c: &[f64], s: f64) -> f64 {
        let knots = &self.spline.knots;
        let after = knots.partition_point(|knot| *knot <= s);
        let piece = after.clamp(1, self.spline.pieces()) - 1;
        let from = knots.get(piece).copied().unwrap_or_default();
        let p = ((s - from) / self.spline.length(Some(piece))).clamp(0.0, 1.0);
        dot(&self.spline.factors(piece, p)[0], c, piece)
    }

    /// Tangents of what jerk may be.
    fn renew(&self, c: &[f64], limits: &mut [Active<[f64; 3]>]) {
        for (row, pair) in self.jerks.iter().zip(limits.chunks_exact_mut(2)) {
            let q = dot(&row.value, c, row.piece).max(f64::MIN_POSITIVE);
            let root = q.sqrt();
            for (limit, sign) in pair.iter_mut().zip([root, -root]) {
                for ((g, jerk), value) in limit.row.g.iter_mut().zip(row.g).zip(row.value) {
                    *g = sign * jerk + 0.5 * value / q;
                }
                limit.row.h = 1.5;
            }
        }
    }

    /// The time that the law takes; the system is set to its slope and curvature.
    fn cost(&self, c: &[f64], system: &mut Banded) -> f64 {
        system.clear();
        let mut time = 0.0;
        for piece in 0..self.spline.pieces() {
            let h = self.spline.length(Some(piece));
            for (p, weight) in GAUSS {
                let [value, ..] = self.spline.factors(piece, p);
                let q = dot(&value, c, piece);
                let here = h * weight / q.sqrt();
                time += here;
                system.weigh(piece, &value, 0.75 * here / (q * q));
                system.push(piece, &value, 0.5 * here / q);
            }
        }
        time
    }
}

/// The problem with the equations of a step.
struct Descent<'a> {
    problem: &'a Problem,
    system: Banded,
    /// Limits from here on are tangents.
    first_jerk: usize,
}

impl Convex<[f64; 3]> for Descent<'_> {
    fn dot(&self, g: &[f64; 3], variables: &[f64], piece: usize) -> f64 {
        dot(g, variables, piece)
    }

    fn renew(&self, variables: &[f64], limits: &mut [Active<[f64; 3]>]) {
        let tangents = limits.get_mut(self.first_jerk..).unwrap_or_default();
        self.problem.renew(variables, tangents);
    }

    fn cost(&mut self, variables: &[f64]) -> f64 {
        self.problem.cost(variables, &mut self.system)
    }

    fn weigh(&mut self, piece: usize, g: &[f64; 3], weight: f64) {
        self.system.weigh(piece, g, weight);
    }

    fn push(&mut self, piece: usize, g: &[f64; 3], push: f64) {
        self.system.push(piece, g, push);
    }

    fn factorise(&mut self) -> bool {
        self.system.factorise()
    }

    fn solve(&self) -> Vec<f64> {
        self.system.solve()
    }
}

/// A symmetric system with five diagonals.
struct Banded {
    /// The diagonal, and the two beside it.
    rows: Vec<[f64; 3]>,
    right: Vec<f64>,
}

impl Banded {
    fn new(n: usize) -> Self {
        Self {
            rows: vec![[0.0; 3]; n],
            right: vec![0.0; n],
        }
    }

    fn clear(&mut self) {
        self.rows.fill([0.0; 3]);
        self.right.fill(0.0);
    }

    /// Adds `weight` g gᵀ.
    fn weigh(&mut self, piece: usize, g: &[f64; 3], weight: f64) {
        let rows = self.rows.get_mut(piece..piece + 3).unwrap_or_default();
        for (i, row) in rows.iter_mut().enumerate() {
            let right = g.get(i..).unwrap_or_default();
            let own = right.first().copied().unwrap_or_default();
            for (sum, other) in row.iter_mut().zip(right) {
                *sum += weight * own * other;
            }
        }
    }

    /// Adds `push` g on the right.
    fn push(&mut self, piece: usize, g: &[f64; 3], push: f64) {
        let right = self.right.get_mut(piece..piece + 3).unwrap_or_default();
        for (sum, g) in right.iter_mut().zip(g) {
            *sum += push * g;
        }
    }

    /// Factorises in place; false if the numbers ran away.
    fn factorise(&mut self) -> bool {
        for k in 0..self.rows.len() {
            let [d, e, f] = self.rows.get(k).copied().unwrap_or_default();
            if !(d > 0.0 && d.is_finite()) {
                return false;
            }
            let (l1, l2) = (e / d, f / d);
            if let Some(row) = self.rows.get_mut(k) {
                *row = [d, l1, l2];
            }
            if let Some(row) = self.rows.get_mut(k + 1) {
                row[0] -= l1 * e;
                row[1] -= l1 * f;
            }
            if let Some(row) = self.rows.get_mut(k + 2) {
                row[0] -= l2 * f;
            }
        }
        true
    }

    /// Solves with what is on the right; [`Self::factorise`] comes first.
    fn solve(&self) -> Vec<f64> {
        let mut x = self.right.clone();
        for (k, [_, l1, l2]) in self.rows.iter().enumerate() {
            let here = x.get(k).copied().unwrap_or_default();
            for (next, l) in x.iter_mut().skip(k + 1).zip([l1, l2]) {
                *next -= l * here;
            }
        }
        for (k, [d, l1, l2]) in self.rows.iter().enumerate().rev() {
            let after = x.get(k + 1..).unwrap_or_default().iter();
            let carried: f64 = after.zip([l1, l2]).map(|(x, l)| x * l).sum();
            if let Some(x) = x.get_mut(k) {
                *x = *x / d - carried;
            }
        }
        x
    }
}
