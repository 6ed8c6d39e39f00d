//! A substep of the contacts: what is given and what is found. Symbols as in [`super::contact`].

use super::pair::Pair;

/// The body as contacts see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// 1/m.
    pub per_mass: f64,
    /// 1/I about the centre of mass.
    pub per_inertia: f64,
    /// Centre of mass ahead of the axle.
    pub ahead: f64,
    pub radius: Pair,
    /// +b for the right wheel, −b for the left, b half the track: an impulse forward at the right turns left.
    pub lever: Pair,
    /// Change of the forward speed at a wheel per impulse there, and per impulse at the other wheel.
    pub along: f64,
    pub between: f64,
    /// Change of the sideways speed per impulse sideways, its inverse, and per impulse forward at the left wheel.
    pub across: f64,
    pub per_across: f64,
    pub skew: f64,
}

/// A substep to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    /// (u, v, w) without any contact.
    pub free: [f64; 3],
    pub momentum: Pair,
    /// 1/D.
    pub per_inertia: Pair,
    /// r²/D: change of the speed of a wheel's rim per impulse there, while it turns.
    pub rim: Pair,
    pub dry: Pair,
    pub give: Pair,
    /// e forward and leftward of each wheel.
    pub held: [Pair; 2],
    /// Largest impulse of the floor on each wheel.
    pub grip: Pair,
    /// Share of each wheel in a sideways impulse while both hold.
    pub share: Pair,
}

/// What a substep ends with.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Solved {
    /// (u, v, w).
    pub speed: [f64; 3],
    pub omega: Pair,
    /// Impulse of the floor on each wheel, forward and leftward.
    pub floor: [Pair; 2],
    pub slipping: [bool; 2],
}

impl Frame {
    /// Of mass, inertia, half the track, the centre of mass ahead of the axle, and radii.
    pub fn new(mass: f64, inertia: f64, half: f64, ahead: f64, radius: [f64; 2]) -> Self {
        let (per_mass, per_inertia) = (1.0 / mass, 1.0 / inertia);
        let across = per_mass + ahead * ahead * per_inertia;
        Self {
            per_mass,
            per_inertia,
            ahead,
            radius: Pair(radius),
            lever: Pair([half, -half]),
            along: per_mass + half * half * per_inertia,
            between: per_mass - half * half * per_inertia,
            across,
            per_across: 1.0 / across,
            skew: half * ahead * per_inertia,
        }
    }

    /// Speeds of the wheels' contacts over the floor, forward; a wheel has (u + lever w).
    #[inline(always)]
    pub fn forward(&self, speed: &[f64; 3]) -> Pair {
        speed[0] + self.lever * speed[2]
    }

    /// Speed of the axle sideways, the same at both wheels: v − d w.
    #[inline(always)]
    pub fn sideways(&self, speed: &[f64; 3]) -> f64 {
        speed[1] - self.ahead * speed[2]
    }

    /// What impulses forward and leftward do, of each wheel: changes of u, v and w.
    #[inline(always)]
    pub fn push(&self, [f, y]: [Pair; 2]) -> [Pair; 3] {
        [
            self.per_mass * f,
            self.per_mass * y,
            self.per_inertia * (self.lever * f - self.ahead * y),
        ]
    }
}
