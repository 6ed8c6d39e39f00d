//! Where wheels meet bearings and floor: impulses of one substep that keep every bound.
//!
//! Time stepping at the level of impulses: speeds at the end of the substep and the impulses that
//! make them are solved together, so dry friction neither chatters nor creeps, a rolling wheel
//! rolls exactly, and no step size is too long for a stiff tyre. The order of thought is that of
//! Moreau and of Stewart and Trinkle for rigid bodies with Coulomb friction.
//!
//! | symbol | name | unit |
//! | --- | --- | --- |
//! | u, v, w | forward and leftward speed of the centre of mass, turn rate | m/s, rad/s |
//! | f, y | impulse of the floor on a wheel, forward and leftward | N s |
//! | p | angular momentum that a wheel would have without floor and dry friction | N m s |
//! | D | its inertia with the implicit part of damping | kg m² |
//! | t | largest impulse of dry friction | N m s |
//! | c, e | give of the tyre: slip = c f − e; 0 if rigid | m/s per N s, m/s |

use super::slide;

/// The body as contacts see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// 1/m.
    pub per_mass: f64,
    /// 1/I about the centre of mass.
    pub per_inertia: f64,
    /// Half the track.
    pub half: f64,
    /// Centre of mass ahead of the axle.
    pub ahead: f64,
    pub radius: [f64; 2],
}

/// A substep to be solved. Pairs are right, left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    /// (u, v, w) without any contact.
    pub free: [f64; 3],
    pub momentum: [f64; 2],
    pub inertia: [f64; 2],
    pub dry: [f64; 2],
    pub give: [f64; 2],
    /// e forward and leftward of each wheel.
    pub held: [[f64; 2]; 2],
    /// Largest impulse of the floor on each wheel.
    pub grip: [f64; 2],
    /// Share of each wheel in a sideways impulse while both hold.
    pub share: [f64; 2],
}

/// What a substep ends with.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Solved {
    /// (u, v, w).
    pub speed: [f64; 3],
    pub omega: [f64; 2],
    /// Impulse of the floor on each wheel, forward and leftward.
    pub floor: [[f64; 2]; 2],
    pub slipping: [bool; 2],
}

impl Frame {
    /// +b for the right wheel, −b for the left: an impulse forward at the right turns left.
    pub fn lever(&self, i: usize) -> f64 {
        if i == 0 { self.half } else { -self.half }
    }

    /// Speed of a wheel's contact over the floor, forward; it is (u + lever w).
    pub fn forward(&self, speed: &[f64; 3], i: usize) -> f64 {
        speed[0] + self.lever(i) * speed[2]
    }

    /// Speed of the axle sideways, the same at both wheels: v − d w.
    pub fn sideways(&self, speed: &[f64; 3]) -> f64 {
        speed[1] - self.ahead * speed[2]
    }

    /// Adds what an impulse on wheel `i` does.
    pub fn push(&self, speed: &mut [f64; 3], i: usize, [f, y]: [f64; 2]) {
        speed[0] += self.per_mass * f;
        speed[1] += self.per_mass * y;
        speed[2] += self.per_inertia * (self.lever(i) * f - self.ahead * y);
    }

    /// Change of the forward speed at a wheel per impulse there.
    pub fn along(&self) -> f64 {
        self.per_mass + self.half * self.half * self.per_inertia
    }

    /// The same sideways.
    pub fn across(&self) -> f64 {
        self.per_mass + self.ahead * self.ahead * self.per_inertia
    }
}

impl Task {
    /// Speed of wheel `i` under the impulse `f` of the floor: what is left after dry friction.
    pub fn omega(&self, frame: &Frame, i: usize, f: f64) -> f64 {
        let left = self.momentum[i] - frame.radius[i] * f;
        let beyond = (left.abs() - self.dry[i]).max(0.0);
        beyond.copysign(left) / self.inertia[i]
    }

    /// Dry friction that wheel `i` feels under `f`: −1, 1, or none if it is held.
    fn turning(&self, frame: &Frame, i: usize, f: f64) -> Option<f64> {
        let left = self.momentum[i] - frame.radius[i] * f;
        (left.abs() > self.dry[i]).then_some(1.0_f64.copysign(left))
    }

    /// Solves the substep; `guess` is the forward impulses of the last one.
    pub fn solve(&self, frame: &Frame, guess: [f64; 2]) -> Solved {
        let mut forward = guess;
        // Wheels that turn or are held: a piecewise linear system, whose pieces are right at the
        // first try but in substeps where a wheel starts or stops.
        for _ in 0..PIECES {
            let turning = [0, 1].map(|i| self.turning(frame, i, forward[i]));
            let (next, across) = self.held_by_floor(frame, turning);
            forward = next;
            if [0, 1].map(|i| self.turning(frame, i, forward[i])) != turning {
                continue;
            }
            let floor = [0, 1].map(|i| [forward[i], self.across_of(i, across)]);
            if (0..2).all(|i| norm(floor[i]) <= self.grip[i]) {
                return self.end(frame, floor, [false; 2]);
            }
            break;
        }
        let (floor, slipping) = slide::solve(self, frame, forward);
        self.end(frame, floor, slipping)
    }

    /// Sideways impulse of one wheel when the axle slips sideways by `slip`, or shares `total`.
    fn across_of(&self, i: usize, (total, slip): (f64, f64)) -> f64 {
        if self.give[i] > 0.0 {
            (slip + self.held[i][1]) / self.give[i]
        } else {
            total * self.share[i]
        }
    }

    /// Both wheels hold on the floor: three linear equations in both forward impulses and the
    /// whole sideways one. Returns the forward ones, and (whole, slip) sideways.
    fn held_by_floor(&self, frame: &Frame, turning: [Option<f64>; 2]) -> ([f64; 2], (f64, f64)) {
        let (along, across) = (frame.along(), frame.across());
        let between = frame.per_mass - frame.half * frame.half * frame.per_inertia;
        let skew = frame.half * frame.ahead * frame.per_inertia;
        let mut diagonal = [0.0; 2];
        let mut right_side = [0.0; 2];
        for i in 0..2 {
            diagonal[i] = along + self.give[i];
            right_side[i] = self.held[i][0] - frame.forward(&self.free, i);
            if let Some(sign) = turning[i] {
                let r = frame.radius[i];
                diagonal[i] += r * r / self.inertia[i];
                right_side[i] += r * (self.momentum[i] - sign * self.dry[i]) / self.inertia[i];
            }
        }
        // Two tyres side by side: 1/c = 1/c₁ + 1/c₂, and e is their mean weighted by 1/c.
        let (give, held) = if self.give[0] > 0.0 {
            let stiff = self.give.map(|c| 1.0 / c);
            let both = stiff[0] + stiff[1];
            let pull = stiff[0] * self.held[0][1] + stiff[1] * self.held[1][1];
            (1.0 / both, pull / both)
        } else {
            (0.0, 0.0)
        };
        let last = across + give;
        let pull = held - frame.sideways(&self.free);
        // Sideways impulse eliminated: its column is (−skew, +skew), its diagonal `last`.
        let less = skew * skew / last;
        let a = diagonal[0] - less;
        let b = diagonal[1] - less;
        let off = between + less;
        let first = right_side[0] + skew * pull / last;
        let second = right_side[1] - skew * pull / last;
        let determinant = a * b - off * off;
        let right = (b * first - off * second) / determinant;
        let left = (a * second - off * first) / determinant;
        let whole = (pull + skew * (right - left)) / last;
        ([right, left], (whole, give * whole - held))
    }

    fn end(&self, frame: &Frame, floor: [[f64; 2]; 2], slipping: [bool; 2]) -> Solved {
        let mut speed = self.free;
        for (i, impulse) in floor.into_iter().enumerate() {
            frame.push(&mut speed, i, impulse);
        }
        Solved {
            speed,
            omega: [0, 1].map(|i| self.omega(frame, i, floor[i][0])),
            floor,
            slipping,
        }
    }
}

/// Two wheels with three states each need at most a few corrections; more means a cycle.
const PIECES: usize = 8;

pub(super) fn norm([f, y]: [f64; 2]) -> f64 {
    (f * f + y * y).sqrt()
}
