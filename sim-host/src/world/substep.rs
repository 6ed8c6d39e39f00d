//! A substep of the contacts: what is given and what is found. Symbols as in [`super::contact`].

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

pub(super) fn norm([f, y]: [f64; 2]) -> f64 {
    (f * f + y * y).sqrt()
}
