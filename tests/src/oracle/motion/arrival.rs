//! Sections 7 and 9: parked, stuck, stalled, tried again; for a robot that parks by feedback.

use nalgebra::Vector3;

use super::Pair;
use super::command::Command;
use super::constants::Constants;

/// Decay of the offset that stops a parked robot \[1/s\].
pub const STOPPING: f64 = 12.0;
/// Rests that may end by themselves before one counts as an attempt.
const LOSSES: u8 = 3;

/// The latch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Latch {
    /// Parked.
    pub parked: bool,
    inside: f64,
}

/// New approaches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attempts {
    /// So far.
    pub count: u8,
    /// No more.
    pub given_up: bool,
    losses: u8,
    /// Driving out: 1 behind the goal, −1 in front of it.
    pub out: f64,
    stuck: f64,
    parked: f64,
    came: f64,
}

/// How a robot stands to its goal.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// To the goal.
    pub e: Vector3<f64>,
    /// Measured.
    pub twist: Pair,
    /// Of the last tick.
    pub command: &'a Command,
    /// Backing up, of the last tick.
    pub backs: bool,
}

/// Inside this a parked robot stays.
fn leave_distance(k: &Constants) -> f64 {
    2.0 * k.tolerance.0 + 5.0 * k.sigma
}

fn least(k: &Constants) -> f64 {
    k.tolerance.0.max(k.noise_radius().0)
}

/// How far a retry drives out.
pub fn way_out(k: &Constants) -> f64 {
    (20.0 * least(k)).max(0.05)
}

fn patience(k: &Constants) -> f64 {
    8.0 / k.k4 + 4.0 * k.dwell
}

impl View<'_> {
    fn distance(&self) -> f64 {
        self.e.x.hypot(self.e.y)
    }

    fn is_near(&self, k: &Constants) -> bool {
        self.distance() < 10.0 * least(k) && self.e.z.abs() < 10.0 * k.tolerance.1
    }
}

impl Latch {
    /// After `dt`.
    pub fn after(&self, k: &Constants, at: &View<'_>, dt: f64) -> Self {
        let close = at.distance() < leave_distance(k);
        let fit = if self.parked {
            self.inside < 1.0 || (close && at.e.z.abs() < 1.3 * k.tolerance.1)
        } else {
            // Where a stop would end: the offset's way, and the velocity loop's lag.
            let (c, rate) = (at.command.twist, at.command.rate);
            let way = (rate + 2.0 * STOPPING * c) / STOPPING.powi(2)
                + (at.twist - c - dt * rate).component_div(&k.kappa);
            let left = (at.e.x - way.x).powi(2) + at.e.y.powi(2);
            let enough = if self.inside > 0.0 { 1.3 } else { 1.0 } * k.tolerance.0;
            close && left < enough.powi(2) && (at.e.z - way.y).abs() < k.tolerance.1
        };
        if !fit {
            return Self::default();
        }
        let inside = self.inside + dt;
        Self {
            parked: self.parked || inside > k.dwell,
            inside,
        }
    }
}

impl Attempts {
    /// Parking is possible.
    pub fn may_park(&self) -> bool {
        self.out == 0.0 && !self.given_up
    }

    /// The error to the goal, or to the place to drive out to.
    pub fn aim(&self, k: &Constants, e: &Vector3<f64>) -> Vector3<f64> {
        let moved = self.out * way_out(k);
        Vector3::new(e.x - moved * e.z.cos(), e.y - moved * e.z.sin(), e.z)
    }

    fn spend(&mut self, k: &Constants) -> bool {
        if self.count < k.retries {
            self.count += 1;
            true
        } else {
            self.given_up = true;
            false
        }
    }

    /// After `dt`; whether the law begins afresh. `latch`: now, `lost`: parked until now.
    pub fn advance(
        &mut self,
        k: &Constants,
        at: &View<'_>,
        latch: &Latch,
        lost: bool,
        dt: f64,
    ) -> bool {
        if self.given_up {
            return false;
        }
        let (distance, way_out) = (at.distance(), way_out(k));
        if self.out != 0.0 {
            self.stuck += dt;
            let left = self.aim(k, &at.e).xy().norm();
            if left < way_out / 4.0 || self.stuck > patience(k) {
                (self.out, self.stuck) = (0.0, 0.0);
                return true;
            }
            return false;
        }
        if latch.parked {
            self.stuck = 0.0;
            self.parked += dt;
            return false;
        }
        if lost {
            let slightly = distance <= leave_distance(k) && at.e.z.abs() <= 4.0 * k.tolerance.1;
            let soon = self.parked < patience(k) && at.is_near(k);
            self.parked = 0.0;
            self.stuck = 0.0;
            if !(slightly || soon) {
                (self.count, self.losses) = (0, 0);
            } else if self.losses < LOSSES {
                self.losses += 1;
            } else {
                self.losses = 0;
                self.spend(k);
            }
            return true;
        }
        if latch.inside > 0.0 && latch.inside <= k.dwell {
            return false;
        }
        if distance > way_out {
            self.came = if at.backs { -1.0 } else { 1.0 };
        }
        let asked = k.rim(&at.command.twist);
        let creeps = k.rim(&at.twist) < 4.0 * k.k4 * least(k) && asked <= k.stall.0;
        if at.is_near(k) || creeps {
            let level = distance > k.tolerance.0 && at.e.x.abs() < k.tolerance.0 / 2.0;
            self.stuck += if level { 4.0 * dt } else { dt };
        } else if distance < way_out {
            self.stuck += dt / 6.0;
        } else {
            self.stuck = (self.stuck - dt).max(0.0);
        }
        if self.stuck <= patience(k) {
            return false;
        }
        self.stuck = 0.0;
        if self.spend(k) {
            self.out = if self.came < 0.0 { -1.0 } else { 1.0 };
        }
        true
    }
}

/// Time of a stall after `dt`.
pub fn stalled_for(
    k: &Constants,
    before: f64,
    command: &Pair,
    twist: &Pair,
    saturated: bool,
    dt: f64,
) -> f64 {
    let (asked, done) = (k.rim(command), k.rim(twist));
    let stuck = if asked > k.stall.0 {
        done < 0.1 * asked
    } else {
        saturated && done < 0.1 * k.stall.0
    };
    if stuck { before + dt } else { 0.0 }
}
