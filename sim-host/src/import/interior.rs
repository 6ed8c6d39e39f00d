//! A primal-dual interior-point method: the least time within rows of limits.
//!
//! Mehrotra's: every step looks how far it would come straight for the optimum, and then corrects
//! for how slack and multiplier change together. What the equations of a step look like is the
//! problem's own ([`Convex`]): they are solved in time linear in the number of pieces. Most of the
//! time goes with what is read and written of the limits, hence a step passes through them four times only.
//!
//! A descent leaves a [`Start`] for problems like its own, which takes a third of the steps.

/// A row of limits: factors `g` on the variables of a piece make at most `h`, in parts of the limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<G> {
    pub(super) piece: usize,
    pub(super) g: G,
    pub(super) h: f64,
}

/// What is sought the least of, and the equations of a step towards it.
pub(super) trait Convex<G> {
    /// The product of a row with the variables of its piece.
    fn dot(&self, g: &G, variables: &[f64], piece: usize) -> f64;

    /// Renews the limits that are tangents.
    fn renew(&self, _variables: &[f64], _limits: &mut [Active<G>]) {}

    /// The time; the equations are set to its slope and curvature.
    fn cost(&mut self, variables: &[f64]) -> f64;

    /// By how much variables miss what ties pieces together.
    fn loose(&self) -> f64 {
        0.0
    }

    /// Adds `weight` g gᵀ to the equations.
    fn weigh(&mut self, piece: usize, g: &G, weight: f64);

    /// Adds `push` g on the right.
    fn push(&mut self, piece: usize, g: &G, push: f64);

    /// Factorises the equations; false if the numbers ran away.
    fn factorise(&mut self) -> bool;

    /// Solves them with what is on the right; [`Self::factorise`] comes first.
    fn solve(&self) -> Vec<f64>;
}

/// Most steps; 20 to 40 are usual, 2 to 12 from where a like problem leaves off.
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
/// A slack of which the variables leave at least this part is what they leave: tangents that are
/// renewed move limits far away by a little, and if those were missed all steps would be the shorter.
const LEFT: f64 = 0.9;
/// Where this part of the time could be gained, a descent of a problem like this one begins: near the
/// optimum, and not so near limits that one which has moved stops it. Ten times as much is as good.
pub(super) const WARM: f64 = 1e-3;

/// A limit as the method sees it.
#[derive(Clone, Copy)]
pub(super) struct Active<G> {
    pub(super) row: Row<G>,
    pair: Pair,
    /// The inverse of the slack.
    per_slack: f64,
    /// By how much the variables have more left than the slack says.
    miss: f64,
    /// By how much the step lowers the slack.
    falls: f64,
    /// What the product of slack and multiplier is to be, over the slack.
    aim: f64,
}

/// What is left of a limit, and its multiplier: 0 before a descent has found one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    slack: f64,
    dual: f64,
}

const UNKNOWN: Pair = Pair {
    slack: 1.0,
    dual: 0.0,
};

impl Pair {
    /// That of a limit which holds for a part of where this one did.
    pub(super) fn of_part(self, part: f64) -> Self {
        Self {
            dual: part * self.dual,
            ..self
        }
    }

    /// That of the same limit in parts of what is left of it.
    pub(super) fn of_rest(self) -> Self {
        Self {
            slack: 1.0,
            dual: self.slack * self.dual,
        }
    }
}

/// Where a descent begins: variables, and a pair for every limit, or none.
#[derive(Clone, Debug, Default)]
pub(super) struct Start {
    pub(super) c: Vec<f64>,
    pub(super) pairs: Vec<Pair>,
    /// What descents from here have taken: their steps, each as often as there were limits.
    pub(super) work: usize,
}

/// Variables of the least time but for a part `gain` of it, from ones that may be beyond limits; and
/// whether the descent arrived. Then the start is one for problems like this one.
pub(super) fn descend<G>(
    problem: &mut impl Convex<G>,
    start: &mut Start,
    rows: impl Iterator<Item = Row<G>>,
    gain: f64,
) -> (Vec<f64>, bool) {
    let mut c = start.c.clone();
    let pairs = start
        .pairs
        .iter()
        .copied()
        .chain(std::iter::repeat(UNKNOWN));
    let active = rows.zip(pairs).map(|(row, pair)| Active::new(row, pair));
    let mut active: Vec<_> = active.collect();
    let count = active.len() as f64;
    let mut far = true;
    // Of the last step, for variables and for multipliers.
    let mut taken = [0.0; 2];
    for _ in 0..STEPS {
        start.work += active.len();
        problem.renew(&c, &mut active);
        let time = problem.cost(&c);
        let (mut gap, mut worst) = (0.0, problem.loose());
        for limit in &mut active {
            limit.take(taken);
            let Row { piece, g, h } = &limit.row;
            let left = h - problem.dot(g, &c, *piece);
            worst = worst.max(-left);
            let Pair { slack, dual } = &mut limit.pair;
            if *dual == 0.0 {
                *slack = left.max(FIRST_SLACK);
                *dual = FIRST_GAP * time / (count * *slack);
            }
            if left > LEFT * *slack {
                *slack = left;
            }
            limit.miss = left - *slack;
            gap += *slack * *dual;
            limit.per_slack = slack.recip();
            let stiff = *dual * limit.per_slack;
            problem.weigh(*piece, g, stiff);
            problem.push(*piece, g, stiff * limit.miss);
        }
        if far && gap < WARM * time && worst < WARM {
            far = false;
            start.c.clone_from(&c);
            start.pairs = active.iter().map(|limit| limit.pair).collect();
        }
        if gap < gain * time && worst < MISS {
            return (c, true);
        }
        if gap > LOST * time || !problem.factorise() {
            break;
        }
        // Straight for the optimum, to see how far that goes; then with what this says of the
        // centre, and of how slack and multiplier change together.
        let straight = problem.solve();
        let mut longest = Longest::new(1.0);
        // Of slack by change of multiplier, of fall by multiplier, of both changes.
        let mut sums = [0.0; 3];
        for limit in &mut active {
            limit.falls = problem.dot(&limit.row.g, &straight, limit.row.piece) - limit.miss;
            limit.aim = 0.0;
            let change = longest.include(limit);
            sums[0] += limit.pair.slack * change;
            sums[1] += limit.falls * limit.pair.dual;
            sums[2] += limit.falls * change;
        }
        let [primal, dual] = longest.steps();
        let after = gap + dual * sums[0] - primal * sums[1] - primal * dual * sums[2];
        let mu = (after / gap).powi(3) * gap / count;
        for limit in &mut active {
            limit.aim = (mu + limit.falls * limit.change()) * limit.per_slack;
            problem.push(limit.row.piece, &limit.row.g, -limit.aim);
        }
        let step = problem.solve();
        if !step.iter().all(|step| step.is_finite()) {
            break;
        }
        let mut longest = Longest::new(NEAR);
        for limit in &mut active {
            limit.falls = problem.dot(&limit.row.g, &step, limit.row.piece) - limit.miss;
            longest.include(limit);
        }
        taken = longest.steps();
        let [primal, _] = taken;
        for (c, step) in c.iter_mut().zip(&step) {
            *c += primal * step;
        }
    }
    (c, false)
}

impl<G> Active<G> {
    fn new(row: Row<G>, pair: Pair) -> Self {
        Self {
            row,
            pair,
            per_slack: 1.0,
            miss: 0.0,
            falls: 0.0,
            aim: 0.0,
        }
    }

    /// Takes parts of a step.
    fn take(&mut self, [primal, dual]: [f64; 2]) {
        self.pair = Pair {
            slack: self.pair.slack - primal * self.falls,
            dual: self.pair.dual + dual * self.change(),
        };
    }

    /// The change of the multiplier that goes with the step.
    fn change(&self) -> f64 {
        self.aim + self.pair.dual * (self.falls * self.per_slack - 1.0)
    }
}

/// The longest steps of variables and of multipliers, at most 1, that go a part of the way to the
/// nearest limit.
struct Longest {
    part: f64,
    /// The largest parts of a slack and of a multiplier that whole steps take.
    takes: [f64; 2],
}

impl Longest {
    fn new(part: f64) -> Self {
        let takes = [part; 2];
        Self { part, takes }
    }

    /// Looks at a limit too; gives the change of its multiplier.
    fn include<G>(&mut self, limit: &Active<G>) -> f64 {
        let change = limit.change();
        let [primal, dual] = &mut self.takes;
        *primal = primal.max(limit.falls * limit.per_slack);
        *dual = dual.max(-change / limit.pair.dual);
        change
    }

    fn steps(&self) -> [f64; 2] {
        self.takes.map(|takes| self.part / takes)
    }
}
