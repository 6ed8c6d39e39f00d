//! Odometry and the fusion with external poses, a second time, from what the crate's documentation says of them.
//!
//! Postures are (x, y, θ) with θ not wrapped; wheels are (right, left).

pub mod fusion;
pub mod odometry;

use nalgebra::{Rotation2, Vector2, Vector3};

use fusion::{Fusion, Taken};
use odometry::Odometry;

/// What the localiser knows of a base and of its source of poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constants {
    /// Radii, calibrated \[m\].
    pub radius: Vector2<f64>,
    /// Track, calibrated \[m\].
    pub track: f64,
    /// Counts of an encoder for a turn.
    pub counts_per_turn: f64,
    /// ω of the speed estimate \[rad/s\].
    pub omega: f64,
    /// Poses that are remembered.
    pub remembered: usize,
    /// σ of a fix \[m\], \[rad\].
    pub sigma: (f64, f64),
    /// Fixes per second.
    pub rate: f64,
    /// Bandwidths of both corrections \[rad/s\].
    pub bandwidth: (f64, f64),
    /// Standard deviations that are no outlier.
    pub gate: f64,
    /// Outliers that agree and are right.
    pub relocalise_after: u32,
    /// What odometry may be wrong by.
    pub drift: f64,
    /// How fast wheels may slide \[m/s\].
    pub slide: f64,
    /// Without a fix for longer the pose is stale \[s\].
    pub stale: f64,
    /// A robot whose tyres slip.
    pub robot: Option<Body>,
}

/// What tyres have to move, and what follows its twist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// \[kg\].
    pub mass: f64,
    /// \[kg m²\].
    pub inertia: f64,
    /// \[m\].
    pub track: f64,
    /// Bandwidth of the velocity loop \[rad/s\].
    pub bandwidth: f64,
}

/// An external pose, and how long ago it was valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// Posture.
    pub q: Vector3<f64>,
    /// \[s\].
    pub age: f64,
}

/// What became of a fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// There was none.
    Absent,
    /// Judged.
    Taken(Taken),
    /// Older than what is remembered, which is so old \[s\].
    TooOld(f64),
}

/// What a tick makes of it all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Posture.
    pub q: Vector3<f64>,
    /// (v, w).
    pub twist: Vector2<f64>,
    /// Of the fix.
    pub outcome: Outcome,
    /// Turn per way \[rad/m\] and per turn, slip of tyres per acceleration \[s²/m\].
    pub bias: Vector3<f64>,
    /// Of the last fix that was taken \[s\].
    pub age: f64,
    /// The pose is stale.
    pub stale: bool,
}

/// The localiser.
#[derive(Clone, Debug)]
pub struct Localiser {
    k: Constants,
    now: f64,
    odometry: Odometry,
    /// Time and posture of odometry, newest last.
    past: Vec<(f64, Vector3<f64>)>,
    fusion: Fusion,
}

/// `q` moved as odometry moved from `from` to `to`: the rigid map between both frames.
pub fn carried(q: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let turned = Rotation2::new(q.z - from.z) * (to.xy() - from.xy());
    Vector3::new(q.x + turned.x, q.y + turned.y, q.z + to.z - from.z)
}

impl Localiser {
    /// At rest.
    pub fn start(k: Constants, q: Vector3<f64>, counts: [i32; 2]) -> Self {
        Self {
            k,
            now: 0.0,
            odometry: Odometry::start(q, counts),
            past: vec![(0.0, q)],
            fusion: Fusion::start(&k, q),
        }
    }

    /// A tick with the accelerations that torques were to cause.
    pub fn tick(
        &mut self,
        counts: [i32; 2],
        dt: f64,
        accel: &Vector2<f64>,
        fix: Option<&Fix>,
    ) -> Estimate {
        let before = self.odometry.q;
        let bias = self.fusion.bias;
        let moved = self.odometry.advance(&self.k, counts, dt, accel, &bias);
        let q = self.odometry.q;
        self.now += dt;
        self.past.push((self.now, q));
        let too_many = self.past.len().saturating_sub(self.k.remembered);
        self.past.drain(..too_many);
        self.fusion.advance(&self.k, (&before, &q), &moved, dt);
        let outcome = match fix {
            None => Outcome::Absent,
            Some(fix) => match self.then(fix.age) {
                Ok(then) => Outcome::Taken(self.fusion.take(&self.k, fix, &then, &q)),
                Err(oldest) => Outcome::TooOld(oldest),
            },
        };
        Estimate {
            q: self.fusion.q,
            twist: moved.twist,
            outcome,
            bias: self.fusion.bias,
            age: self.fusion.age,
            stale: self.fusion.age > self.k.stale,
        }
    }

    /// Where odometry was, on the chord between two ticks.
    fn then(&self, age: f64) -> Result<Vector3<f64>, f64> {
        let at = self.now - age;
        let (oldest, first) = self.past[0];
        if at < oldest {
            return Err(self.now - oldest);
        }
        let later = self.past.iter().position(|(t, _)| *t >= at);
        match later {
            None => Ok(self.odometry.q),
            Some(0) => Ok(first),
            Some(i) => {
                let ((t0, q0), (t1, q1)) = (self.past[i - 1], self.past[i]);
                Ok(q0 + (q1 - q0) * ((at - t0) / (t1 - t0)))
            }
        }
    }

    /// Elsewhere on the map.
    pub fn set(&mut self, q: Vector3<f64>) {
        self.fusion.set(&self.k, q, true);
    }
}
