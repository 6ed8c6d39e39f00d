//! The correction of odometry by fixes.

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector2, Vector3, Vector6};

use super::odometry::Moved;
use super::{Constants, Fix, carried};
use crate::oracle::motion::follow::wrapped;

/// Slides that are forgiven, and the share of one that a good fix forgives.
const SLIDES: (f64, f64) = (8.0, 0.05);

/// What a fix was good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// Part of it.
    Fused,
    /// An outlier.
    Rejected,
    /// The pose is what it and its like say.
    Relocalised,
}

/// Allowances of position and heading \[m, rad\].
type Slack = Vector2<f64>;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    q: Vector3<f64>,
    then: Vector3<f64>,
    count: u32,
    rolled: u32,
    slack: Slack,
    sliding: Slack,
}

/// State of the fusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fusion {
    /// The posture that is reported.
    pub q: Vector3<f64>,
    pending: Vector3<f64>,
    slack: Slack,
    candidate: Option<Candidate>,
    slides: f64,
    /// Turn per way \[rad/m\] and per turn, slip of tyres per acceleration \[s²/m\].
    pub bias: Vector3<f64>,
    /// Covariance of the errors of x, y, θ and these.
    covariance: Matrix6<f64>,
    /// Of the innovations: what fixes stay off by.
    mean: Vector3<f64>,
    /// Of odometry since the last fix: way in the world, way along it, turn; and what tyres of 1 s²/m did to way and turn.
    since: (Vector2<f64>, f64, f64, Vector3<f64>),
    /// Of the last fix that was taken \[s\].
    pub age: f64,
}

/// What follows from the source for position and heading.
struct Channel {
    /// g.
    gain: f64,
    gate: f64,
    agree: f64,
    /// Largest rate of correction of what may be noise.
    rate: f64,
}

fn channels(k: &Constants) -> [Channel; 2] {
    let of = |sigma: f64, bandwidth: f64| {
        let gain = 1.0 - (-bandwidth / k.rate).exp();
        let gate = k.gate * sigma * (2.0 / (2.0 - gain)).sqrt();
        let under_way = 1.0 / (1.0 - (-1.0_f64).exp());
        Channel {
            gain,
            gate,
            agree: k.gate * sigma * 2.0_f64.sqrt(),
            rate: k.rate * under_way * gain * gate,
        }
    };
    [of(k.sigma.0, k.bandwidth.0), of(k.sigma.1, k.bandwidth.1)]
}

fn allows(slack: &Slack, off: &Vector3<f64>) -> bool {
    off.xy().amax() <= slack.x && off.z.abs() <= slack.y
}

fn difference(of: &Vector3<f64>, from: &Vector3<f64>) -> Vector3<f64> {
    let off = of - from;
    Vector3::new(off.x, off.y, wrapped(off.z))
}

/// Variances of the errors of a pose that is stated, or that a fix has set, and of the biases.
fn errors(k: &Constants, stated: bool, bias: &Vector3<f64>) -> Matrix6<f64> {
    let [position, heading] = channels(k);
    let share = |gain: f64| if stated { gain } else { 1.0 };
    let position = share(position.gain) * k.sigma.0.powi(2);
    let heading = share(heading.gain) * k.sigma.1.powi(2);
    let pose = Vector3::new(position, position, heading);
    Matrix6::from_diagonal(&stacked(&pose, bias))
}

fn stacked(pose: &Vector3<f64>, bias: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(pose.x, pose.y, pose.z, bias.x, bias.y, bias.z)
}

/// Largest biases: radii that are wrong by the whole drift, each its way, a track that is wrong by it, tyres that lose it where they push with a
/// fifth of what they carry.
fn most(k: &Constants) -> Vector3<f64> {
    k.drift * Vector3::new(2.0 / k.track, 1.0, 1.0 / (0.2 * 9.81))
}

/// Variances of the biases of unknown wheels: radii that are wrong by an eighth of the drift, a track that is wrong by up to all of it, and tyres
/// that are anything from rigid to the softest.
fn unknown(k: &Constants) -> Vector3<f64> {
    let slips = if k.robot.is_some() { 1.0 } else { 0.0 };
    let shares = Vector3::new(1.0 / 64.0, 1.0 / 3.0, slips / 12.0);
    most(k).component_mul(&most(k)).component_mul(&shares)
}

/// Nothing is known of a pose beyond a hundred thousand times a fix's variance.
fn known(k: &Constants, p: Matrix6<f64>) -> Matrix6<f64> {
    let most = (1e5 * k.sigma.0.powi(2), 1e5 * k.sigma.1.powi(2));
    if p[(0, 0)] + p[(1, 1)] <= most.0 && p[(2, 2)] <= most.1 {
        return p;
    }
    let bias = p.diagonal().fixed_rows::<3>(3).into();
    let pose = Vector3::new(most.0, most.0, most.1);
    Matrix6::from_diagonal(&stacked(&pose, &bias))
}

impl Fusion {
    /// At a posture.
    pub fn start(k: &Constants, q: Vector3<f64>) -> Self {
        Self {
            q,
            pending: Vector3::zeros(),
            slack: Slack::zeros(),
            candidate: None,
            slides: 0.0,
            bias: Vector3::zeros(),
            covariance: errors(k, true, &unknown(k)),
            mean: Vector3::zeros(),
            since: Default::default(),
            age: 0.0,
        }
    }

    /// Elsewhere; what was learnt stays.
    pub fn set(&mut self, k: &Constants, q: Vector3<f64>, stated: bool) {
        *self = Self {
            slides: self.slides,
            bias: self.bias,
            covariance: errors(
                k,
                stated,
                &self.covariance.diagonal().fixed_rows::<3>(3).into(),
            ),
            age: self.age,
            ..Self::start(k, q)
        };
    }

    /// A tick of odometry.
    pub fn advance(
        &mut self,
        k: &Constants,
        (from, to): (&Vector3<f64>, &Vector3<f64>),
        moved: &Moved,
        dt: f64,
    ) {
        let before = self.q;
        self.q = carried(&self.q, from, to);
        let step = (self.q - before).xy();
        self.since.0 += step;
        self.since.1 += moved.way;
        self.since.2 += to.z - from.z;
        let forward = if moved.way < 0.0 { -1.0 } else { 1.0 };
        let left = Vector2::new(-step.y, step.x);
        let lost = forward * (moved.pushed.x * step + moved.pushed.y * left);
        self.since.3 -= Vector3::new(lost.x, lost.y, moved.turn_lost);
        let [position, heading] = channels(k);
        let spread = 1.0 - (-k.rate * dt).exp();
        // Noise, at no more than its rate, and what is none.
        let gate = Vector3::new(position.gate, position.gate, heading.gate);
        let most = dt * Vector3::new(position.rate, position.rate, heading.rate);
        let noise = self.pending.inf(&gate).sup(&-gate);
        let step = (spread * noise).inf(&most).sup(&-most) + spread * (self.pending - noise);
        self.q += step;
        self.pending -= step;
        let travel = (to - from).xy().norm();
        let turn = (to.z - from.z).abs();
        let drift = k.drift * Slack::new(travel, 2.0 / k.track * travel + turn);
        // A heading that is off takes the position along.
        let grow = |slack: &mut Slack| *slack += drift + Slack::new(slack.y * travel, 0.0);
        grow(&mut self.slack);
        if let Some(candidate) = &mut self.candidate {
            grow(&mut candidate.slack);
            grow(&mut candidate.sliding);
            candidate.sliding += dt * k.slide * Slack::new(1.0, 2.0 / k.track);
        }
        self.age += dt;
    }

    /// A fix of the time when odometry was at `then`; it is at `now`.
    pub fn take(
        &mut self,
        k: &Constants,
        fix: &Fix,
        then: &Vector3<f64>,
        now: &Vector3<f64>,
    ) -> Taken {
        let [position, heading] = channels(k);
        let believed = carried(&(self.q + self.pending), now, then);
        let off = difference(&fix.q, &believed);
        let (_, way, turn, _) = self.since;
        self.pass(k, position.gain, heading.gain);
        let gate = self.slack + Slack::new(position.gate, heading.gate);
        if allows(&gate, &off) {
            self.doubt(k, &off, way.abs() + k.track / 2.0 * turn.abs());
            self.correct(k, &off);
            let kept = Slack::new(1.0 - position.gain, 1.0 - heading.gain);
            self.slack.component_mul_assign(&kept);
            self.candidate = None;
            self.slides = (self.slides - SLIDES.1).max(0.0);
            self.age = fix.age;
            return Taken::Fused;
        }
        let agree = Slack::new(position.agree, heading.agree);
        let candidate = self.joined(fix, then, agree);
        let slid = candidate.rolled < k.relocalise_after;
        if candidate.count < k.relocalise_after || (slid && self.slides > SLIDES.0) {
            self.candidate = Some(candidate);
            return Taken::Rejected;
        }
        self.slides += f64::from(u8::from(slid));
        self.set(k, carried(&candidate.q, then, now), false);
        self.age = fix.age;
        Taken::Relocalised
    }

    /// The outliers so far and this one: their mean if the wheels roll, the last one if they slide, this one alone if it
    /// agrees with none.
    fn joined(&self, fix: &Fix, then: &Vector3<f64>, agree: Slack) -> Candidate {
        let alone = Candidate {
            q: fix.q,
            then: *then,
            count: 1,
            rolled: 1,
            slack: agree,
            sliding: agree,
        };
        let Some(earlier) = &self.candidate else {
            return alone;
        };
        let expected = carried(&earlier.q, &earlier.then, then);
        let off = difference(&fix.q, &expected);
        let count = earlier.count + 1;
        if allows(&earlier.slack, &off) {
            let rolled = earlier.rolled + 1;
            let q = expected + off / f64::from(rolled);
            Candidate {
                q,
                count,
                rolled,
                ..alone
            }
        } else if allows(&earlier.sliding, &off) {
            Candidate { count, ..alone }
        } else {
            alone
        }
    }

    /// The errors since the last fix: those that odometry carries along, and those that come to them.
    fn pass(&mut self, k: &Constants, position: f64, heading: f64) {
        let (moved, way, turn, slipped) = std::mem::take(&mut self.since);
        // What a turn of the whole way does, and one that grows along it: by the way, and by the turn.
        let aside = Vector2::new(-moved.y, moved.x);
        let mut f = Matrix6::identity();
        f.fixed_view_mut::<2, 1>(0, 2).copy_from(&aside);
        for (column, turned, led) in [
            (3, way, Vector2::zeros()),
            (4, turn, Vector2::zeros()),
            (5, slipped.z, slipped.xy()),
        ] {
            let grows = aside * (turned / 2.0) + led;
            f.fixed_view_mut::<2, 1>(0, column).copy_from(&grows);
            f[(2, column)] = turned;
        }
        let rest = |gain: f64, sigma: f64| (gain * sigma).powi(2) / (1.0 - gain);
        let slid = rest(position, k.sigma.0) + (0.06 * k.drift).powi(2) * way.abs();
        let turned = rest(heading, k.sigma.1) + k.drift.powi(2) / 3.0 * turn.abs();
        let unknown = unknown(k);
        let (way, turn) = (way.abs(), turn.abs());
        let changed = 0.01 * unknown.component_mul(&Vector3::new(way, turn, way));
        let more = stacked(&Vector3::new(slid, slid, turned), &changed);
        let mut p = f * self.covariance * f.transpose() + Matrix6::from_diagonal(&more);
        for i in 0..3 {
            p[(3 + i, 3 + i)] = p[(3 + i, 3 + i)].min(unknown[i]);
        }
        self.covariance = known(k, p);
    }

    /// What the mean of seven innovations is off by beyond three of its standard deviations, wheels slid by, of the way that the faster one `rolled`.
    fn doubt(&mut self, k: &Constants, off: &Vector3<f64>, rolled: f64) {
        self.mean = 0.75 * self.mean + 0.25 * off;
        let radius = Vector3::new(1.0, 1.0, k.track / 2.0);
        let sigma = Vector3::new(k.sigma.0, k.sigma.0, k.sigma.1);
        for i in 0..3 {
            let expected = (self.covariance[(i, i)] + sigma[i].powi(2)) / 7.0;
            let beyond = (self.mean[i].powi(2) - 9.0 * expected).max(0.0);
            self.covariance[(i, i)] += beyond.min((rolled / radius[i]).powi(2));
        }
        self.covariance = known(k, self.covariance);
    }

    /// All three coordinates at once, K = P Hᵀ (H P Hᵀ + R)⁻¹, and P in Joseph's form.
    fn correct(&mut self, k: &Constants, off: &Vector3<f64>) {
        let (m, rad) = (k.sigma.0.powi(2), k.sigma.1.powi(2));
        let r = Matrix3::from_diagonal(&Vector3::new(m, m, rad));
        let h = SMatrix::<f64, 3, 6>::identity();
        let p = self.covariance;
        let sum = h * p * h.transpose() + r;
        let gain = p * h.transpose() * sum.try_inverse().expect("positive definite");
        let left = Matrix6::identity() - gain * h;
        self.covariance = left * p * left.transpose() + gain * r * gain.transpose();
        let step = gain * off;
        self.pending += step.xyz();
        self.mean -= step.xyz();
        let most = most(k);
        let least = Vector3::new(-most.x, -most.y, 0.0);
        let learnt = self.bias + step.fixed_rows::<3>(3);
        self.bias = learnt.inf(&most).sup(&least);
    }
}
