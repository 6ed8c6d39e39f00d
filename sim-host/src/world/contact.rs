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

use super::pair::Pair;
use super::slide::{self, norm};
use super::substep::{Frame, Solved, Task};

impl Task {
    /// Angular momenta of the wheels under forward impulses of the floor, but for dry friction.
    #[inline(always)]
    fn left(&self, frame: &Frame, forward: Pair) -> Pair {
        self.momentum - frame.radius * forward
    }

    /// Dry friction that wheels feel: −1, 1, or 0 for one that is held.
    #[inline(always)]
    fn turning(&self, left: Pair) -> Pair {
        left.with(self.dry, |left, dry| {
            if left.abs() > dry {
                1.0_f64.copysign(left)
            } else {
                0.0
            }
        })
    }

    /// Whether [`turning`](Self::turning) is as it was.
    #[inline(always)]
    fn goes_on(&self, turning: Pair, left: Pair) -> bool {
        let beyond = (turning * left).all(self.dry, |beyond, dry| beyond > dry);
        beyond || self.turning(left) == turning
    }

    /// Solves the substep; `guess` is the forward impulses of the last one.
    #[inline(always)]
    pub fn solve(&self, frame: &Frame, guess: Pair) -> Solved {
        let mut forward = guess;
        let mut turning = self.turning(self.left(frame, forward));
        // Wheels that turn or are held: a piecewise linear system, whose pieces are right at the
        // first try but in substeps where a wheel starts or stops.
        for _ in 0..PIECES {
            let (next, across) = self.held_by_floor(frame, turning);
            forward = next;
            let left = self.left(frame, forward);
            if !self.goes_on(turning, left) {
                turning = self.turning(left);
                continue;
            }
            let floor = [forward, self.shared(across)];
            if norm(floor).all(self.grip, |size, grip| size <= grip) {
                return self.end(frame, floor, left, [false; 2]);
            }
            break;
        }
        let (floor, slipping) = slide::solve(self, frame, forward);
        self.end(frame, floor, self.left(frame, floor[0]), slipping)
    }

    /// Tyres give; rigid ones do not.
    #[inline(always)]
    fn gives(&self) -> bool {
        self.give[0] > 0.0
    }

    /// Sideways impulses of the wheels when the axle slips sideways by `slip`, or shares `total`.
    #[inline(always)]
    fn shared(&self, (total, slip): (f64, f64)) -> Pair {
        if self.gives() {
            (slip + self.held[1]) / self.give
        } else {
            total * self.share
        }
    }

    /// Both wheels hold on the floor: three linear equations in both forward impulses and the
    /// whole sideways one. Returns the forward ones, and (whole, slip) sideways.
    #[inline(always)]
    fn held_by_floor(&self, frame: &Frame, turning: Pair) -> (Pair, (f64, f64)) {
        let &Frame { skew, radius, .. } = frame;
        let still = frame.along + self.give;
        let pull = self.held[0] - frame.forward(&self.free);
        // Also of wheels that are held, which do not need it: both at once cost as much as one.
        let rolling = still + self.rim;
        let driven = pull + radius * (self.momentum - turning * self.dry) * self.per_inertia;
        let turns = |i: usize, yes: Pair, no: Pair| if turning[i] == 0.0 { no[i] } else { yes[i] };
        let diagonal = [turns(0, rolling, still), turns(1, rolling, still)];
        let right_side = [turns(0, driven, pull), turns(1, driven, pull)];
        // Two tyres side by side: 1/c = 1/c₁ + 1/c₂, and e is their mean weighted by 1/c.
        let (give, held, per_last) = if self.gives() {
            let stiff = 1.0 / self.give;
            let both = stiff[0] + stiff[1];
            let pull = stiff * self.held[1];
            let give = 1.0 / both;
            (
                give,
                (pull[0] + pull[1]) * give,
                both / (1.0 + frame.across * both),
            )
        } else {
            (0.0, 0.0, frame.per_across)
        };
        let pull = held - frame.sideways(&self.free);
        // Sideways impulse eliminated: its column is (−skew, +skew), its diagonal 1/`per_last`.
        let [less, moved] = (Pair([skew * skew, skew * pull]) * per_last).0;
        let [a, b] = [diagonal[0] - less, diagonal[1] - less];
        let off = frame.between + less;
        let [first, second] = [right_side[0] + moved, right_side[1] - moved];
        let determinant = a * b - off * off;
        let forward = Pair([b * first - off * second, a * second - off * first]) / determinant;
        let whole = (pull + skew * (forward[0] - forward[1])) * per_last;
        (forward, (whole, give * whole - held))
    }

    #[inline(always)]
    fn end(&self, frame: &Frame, floor: [Pair; 2], left: Pair, slipping: [bool; 2]) -> Solved {
        let push = frame.push(floor);
        // What is left after dry friction.
        let beyond = (left.abs() - self.dry).or_zero();
        Solved {
            speed: [0, 1, 2].map(|n| self.free[n] + push[n][0] + push[n][1]),
            omega: beyond.with(left, f64::copysign) * self.per_inertia,
            floor,
            slipping,
        }
    }
}

/// Two wheels with three states each need at most a few corrections; more means a cycle.
const PIECES: usize = 8;
