//! The correction of odometry by fixes.

use nalgebra::{Vector2, Vector3};

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
    /// Turn per way \[rad/m\].
    pub bias: f64,
    way: f64,
    /// Of the last fix that was taken \[s\].
    pub age: f64,
}

/// What follows from the source for position and heading.
struct Channel {
    /// g.
    gain: f64,
    gate: f64,
    agree: f64,
    /// Largest rate of correction.
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

impl Fusion {
    /// At a posture.
    pub fn start(q: Vector3<f64>) -> Self {
        Self {
            q,
            pending: Vector3::zeros(),
            slack: Slack::zeros(),
            candidate: None,
            slides: 0.0,
            bias: 0.0,
            way: 0.0,
            age: 0.0,
        }
    }

    /// Elsewhere; what was learnt stays.
    pub fn set(&mut self, q: Vector3<f64>) {
        *self = Self {
            slides: self.slides,
            bias: self.bias,
            age: self.age,
            ..Self::start(q)
        };
    }

    /// A tick of odometry.
    pub fn advance(
        &mut self,
        k: &Constants,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        way: f64,
        dt: f64,
    ) {
        self.way += way;
        self.q = carried(&self.q, from, to);
        let [position, heading] = channels(k);
        let most = dt * Vector3::new(position.rate, position.rate, heading.rate);
        let spread = 1.0 - (-k.rate * dt).exp();
        let step = (spread * self.pending).inf(&most).sup(&-most);
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
        let gate = self.slack + Slack::new(position.gate, heading.gate);
        if allows(&gate, &off) {
            let share = Vector3::new(position.gain, position.gain, heading.gain);
            self.pending += share.component_mul(&off);
            self.learn(k, heading.gain, off.z);
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
        self.set(carried(&candidate.q, then, now));
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

    /// b ← b + β s off/(s² + s₀²), β = α²/4, s₀ = 1.8 σ α^1.5/b_max, b_max = 2 d/l.
    fn learn(&mut self, k: &Constants, alpha: f64, off: f64) {
        let most = 2.0 * k.drift / k.track;
        let s = std::mem::take(&mut self.way);
        if most > 0.0 {
            let s0 = 1.8 * k.sigma.1 * alpha.powf(1.5) / most;
            let step = alpha.powi(2) / 4.0 * s * off / (s.powi(2) + s0.powi(2));
            self.bias = (self.bias + step).clamp(-most, most);
        }
    }
}
