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
use super::substep::{Frame, Solved, Task, norm};

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
