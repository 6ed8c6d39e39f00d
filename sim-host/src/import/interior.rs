//! A primal-dual interior-point method: the least time within rows of limits.
//!
//! Mehrotra's: every step looks how far it would come straight for the optimum, and then corrects
//! for how slack and multiplier change together. What the equations of a step look like is the
//! problem's own ([`Convex`]): they are solved in time linear in the number of pieces.

/// A row of limits: `g` on the variables of a piece is at most `h`, in parts of the limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<const W: usize> {
    pub(super) piece: usize,
    pub(super) g: [f64; W],
    pub(super) h: f64,
}

/// What is sought the least of, and the equations of a step towards it.
pub(super) trait Convex<const W: usize> {
    /// The product of a row with the variables of its piece.
    fn dot(&self, g: &[f64; W], variables: &[f64], piece: usize) -> f64;

    /// Renews the limits that are tangents.
    fn renew(&self, _variables: &[f64], _limits: &mut [Active<W>]) {}

    /// The time; the equations are set to its slope and curvature.
    fn cost(&mut self, variables: &[f64]) -> f64;

    /// By how much variables miss what ties pieces together.
    fn loose(&self) -> f64 {
        0.0
    }

    /// Adds `weight` g gᵀ to the equations.
    fn weigh(&mut self, piece: usize, g: &[f64; W], weight: f64);

    /// Adds `push` g on the right.
    fn push(&mut self, piece: usize, g: &[f64; W], push: f64);

    /// Factorises the equations; false if the numbers ran away.
    fn factorise(&mut self) -> bool;

    /// Solves them with what is on the right; [`Self::factorise`] comes first.
    fn solve(&self) -> Vec<f64>;
}

/// Most steps; 25 to 60 are usual.
const STEPS: usize = 150;
/// The descent is lost once so many times the time could be gained.
const LOST: f64 = 1e6;
/// Part of a limit by which an optimum may be beyond it.
const MISS: f64 = 1e-5;
/// Slack at the start, at least, and what could be gained there in parts of the time.
const FIRST_SLACK: f64 = 0.05;
const FIRST_GAP: f64 = 0.1;
/// A step goes this part of the way to the nearest limit.
const NEAR: f64 = 0.99;

/// A limit as the method sees it.
pub(super) struct Active<const W: usize> {
    pub(super) row: Row<W>,
    /// What is left of it.
    slack: f64,
    /// Its multiplier.
    dual: f64,
    /// By how much the variables have more left than the slack says.
    miss: f64,
    /// By how much the step lowers the slack.
    falls: f64,
    /// What the product of slack and multiplier is to be.
    aim: f64,
}

/// Variables of the least time but for a part `gain` of it, from ones that may be beyond limits; and
/// whether the descent arrived.
pub(super) fn descend<const W: usize>(
    problem: &mut impl Convex<W>,
    mut c: Vec<f64>,
    mut active: Vec<Active<W>>,
    gain: f64,
) -> (Vec<f64>, bool) {
    let mut fresh = true;
    for _ in 0..STEPS {
        problem.renew(&c, &mut active);
        let time = problem.cost(&c);
        let count = active.len() as f64;
        let mut worst: f64 = problem.loose();
        for limit in &mut active {
            let left = limit.row.h - problem.dot(&limit.row.g, &c, limit.row.piece);
            if fresh {
                limit.slack = left.max(FIRST_SLACK);
                limit.dual = FIRST_GAP * time / (count * limit.slack);
            }
            limit.slack = limit.slack.max(left);
            limit.miss = left - limit.slack;
            worst = worst.max(-limit.miss);
        }
        fresh = false;
        let gap: f64 = active.iter().map(|l| l.slack * l.dual).sum();
        if gap < gain * time && worst < MISS {
            return (c, true);
        }
        for limit in &active {
            problem.weigh(limit.row.piece, &limit.row.g, limit.dual / limit.slack);
        }
        if gap > LOST * time || !problem.factorise() {
            break;
        }
        for limit in &active {
            let push = limit.dual * limit.miss / limit.slack;
            problem.push(limit.row.piece, &limit.row.g, push);
        }
        // Straight for the optimum, to see how far that goes; then with what this says of the
        // centre, and of how slack and multiplier change together.
        let straight = problem.solve();
        for limit in &mut active {
            limit.falls = problem.dot(&limit.row.g, &straight, limit.row.piece) - limit.miss;
            limit.aim = 0.0;
        }
        let (primal, dual) = longest(&active, 1.0);
        let after: f64 = active
            .iter()
            .map(|l| (l.slack - primal * l.falls) * (l.dual + dual * l.change()))
            .sum();
        let mu = (after / gap).powi(3) * gap / count;
        for limit in &mut active {
            limit.aim = mu + limit.falls * limit.change();
            problem.push(limit.row.piece, &limit.row.g, -limit.aim / limit.slack);
        }
        let step = problem.solve();
        if !step.iter().all(|step| step.is_finite()) {
            break;
        }
        for limit in &mut active {
            limit.falls = problem.dot(&limit.row.g, &step, limit.row.piece) - limit.miss;
        }
        let (primal, dual) = longest(&active, NEAR);
        for limit in &mut active {
            limit.dual += dual * limit.change();
            limit.slack -= primal * limit.falls;
        }
        for (c, step) in c.iter_mut().zip(&step) {
            *c += primal * step;
        }
    }
    (c, false)
}

impl<const W: usize> Active<W> {
    pub(super) fn new(row: Row<W>) -> Self {
        Self {
            row,
            slack: 1.0,
            dual: 0.0,
            miss: 0.0,
            falls: 0.0,
            aim: 0.0,
        }
    }

    /// The change of the multiplier that goes with the step.
    fn change(&self) -> f64 {
        (self.aim + self.dual * self.falls) / self.slack - self.dual
    }
}

/// The longest steps of variables and of multipliers, at most 1, that go a part of the way to the
/// nearest limit.
fn longest<const W: usize>(active: &[Active<W>], part: f64) -> (f64, f64) {
    let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
    for limit in active {
        if limit.falls > 0.0 {
            primal = primal.min(part * limit.slack / limit.falls);
        }
        let change = limit.change();
        if change < 0.0 {
            dual = dual.min(-part * limit.dual / change);
        }
    }
    (primal, dual)
}
