//! The LTV unicycle controller.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, error, gain, sin_cos};
use crate::plan::Plan;
use controller_core::reference::Reference;

/// Speeds between rest and the limit for which gains are worked out at the start, as WPILib does.
const SPEEDS: usize = 33;
/// A reference that is slower is taken for one of this speed \[m/s\]; WPILib's number.
const LEAST: f64 = 1.0e-4;
/// Rounds of doubling: the horizon is two to this power.
const ROUNDS: usize = 40;

/// A linear-quadratic regulator about the reference, scheduled by its speed; it parks along a plan of turns and a drive.
#[derive(Clone, Copy, Debug)]
pub struct LtvUnicycle {
    along: f32,
    /// On e_y, for positive speeds, and on e_θ.
    across: [(f32, f32); SPEEDS],
    /// Table places in a metre a second.
    scale: f32,
    plan: Plan,
}

impl LtvUnicycle {
    /// Tolerable errors \[m, m, rad\] and efforts \[m/s, rad/s\]: the defaults of WPILib.
    pub const GAINS: [Gain; 5] = [
        Gain {
            name: "x",
            usual: 0.0625,
        },
        Gain {
            name: "y",
            usual: 0.125,
        },
        Gain {
            name: "heading",
            usual: 2.0,
        },
        Gain {
            name: "speed",
            usual: 1.0,
        },
        Gain {
            name: "turn rate",
            usual: 2.0,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        let weight = |at: usize| {
            let tolerable = f64::from(gain(gains, at));
            1.0 / (tolerable * tolerable)
        };
        let dt = f64::from(body.period_s);
        let top = f64::from(body.limits.speed);
        let mut across = [(0.0, 0.0); SPEEDS];
        for (at, gains) in across.iter_mut().enumerate() {
            let v = top * at as f64 / (SPEEDS - 1) as f64;
            let v = if v > LEAST { v } else { LEAST };
            let [y, heading] = lateral(v, dt, (weight(1), weight(2)), weight(4));
            *gains = (y as f32, heading as f32);
        }
        Self {
            along: scalar(dt, weight(0), weight(3)) as f32,
            across,
            scale: (SPEEDS - 1) as f32 / body.limits.speed,
            plan: Plan::new(body),
        }
    }

    /// (v, w) = (v_r cos e_θ, w_r) + K(v_r) e.
    pub fn track(&self, now: &Now, reference: &Reference<f32>) -> Wanted {
        let e = error(reference.pose(), &now.pose);
        let (v, w) = (reference.twist().linear, reference.twist().angular);
        let place = self.scale * v.abs();
        let at = if place < (SPEEDS - 2) as f32 {
            place as usize
        } else {
            SPEEDS - 2
        };
        let share = place - at as f32;
        let share = if share < 1.0 { share } else { 1.0 };
        let entry = |at: usize| self.across.get(at).copied().unwrap_or_default();
        let (low, high) = (entry(at), entry(at + 1));
        let side = if v < 0.0 { -1.0 } else { 1.0 };
        let y = side * (low.0 + share * (high.0 - low.0));
        let heading = low.1 + share * (high.1 - low.1);
        Wanted::of(
            v * sin_cos(e.theta).1 + self.along * e.x,
            w + y * e.y + heading * e.theta,
        )
        .with(*reference.accel())
    }
}

impl Rival for LtvUnicycle {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        let reference = self.plan.reference(now, job)?;
        Some(self.track(now, &reference))
    }
}

/// The gain of an integrator x⁺ = x + dt u: p = q + p − (dt p)²/(r + dt² p), K = dt p/(r + dt² p).
fn scalar(dt: f64, q: f64, r: f64) -> f64 {
    let b = dt * dt;
    let p = 0.5 * (q + root(q * q + 4.0 * q * r / b));
    dt * p / (r + b * p)
}

fn root(value: f64) -> f64 {
    use controller_core::maths::{Libm, Maths};
    Libm::sqrt(value)
}

type Matrix = [[f64; 2]; 2];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let mut product = [[0.0; 2]; 2];
    for (row, of) in product.iter_mut().zip(a) {
        for (column, sum) in row.iter_mut().enumerate() {
            *sum = of[0] * b[0][column] + of[1] * b[1][column];
        }
    }
    product
}

fn plus(a: &Matrix, b: &Matrix) -> Matrix {
    let mut sum = *a;
    for (row, other) in sum.iter_mut().zip(b) {
        row[0] += other[0];
        row[1] += other[1];
    }
    sum
}

fn transposed(a: &Matrix) -> Matrix {
    [[a[0][0], a[1][0]], [a[0][1], a[1][1]]]
}

fn inverse(a: &Matrix) -> Matrix {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    [
        [a[1][1] / determinant, -a[0][1] / determinant],
        [-a[1][0] / determinant, a[0][0] / determinant],
    ]
}

/// Gains on e_y and e_θ at speed v > 0, by structured doubling of the discrete Riccati equation of
/// y⁺ = y + v dt θ + v dt²/2 w, θ⁺ = θ + dt w.
fn lateral(v: f64, dt: f64, (q_y, q_heading): (f64, f64), r: f64) -> [f64; 2] {
    let a: Matrix = [[1.0, v * dt], [0.0, 1.0]];
    let b = [0.5 * v * dt * dt, dt];
    let mut turn = a;
    let mut g: Matrix = [
        [b[0] * b[0] / r, b[0] * b[1] / r],
        [b[1] * b[0] / r, b[1] * b[1] / r],
    ];
    let mut h: Matrix = [[q_y, 0.0], [0.0, q_heading]];
    for _ in 0..ROUNDS {
        let one: Matrix = [[1.0, 0.0], [0.0, 1.0]];
        let w = inverse(&plus(&one, &times(&g, &h)));
        let next = times(&times(&turn, &w), &turn);
        g = plus(
            &g,
            &times(&times(&turn, &times(&w, &g)), &transposed(&turn)),
        );
        h = plus(
            &h,
            &times(&transposed(&turn), &times(&times(&h, &w), &turn)),
        );
        turn = next;
        if turn[0][0].abs() + turn[0][1].abs() + turn[1][0].abs() + turn[1][1].abs() < 1.0e-12 {
            break;
        }
    }
    // K = (r + bᵀ H b)⁻¹ bᵀ H A.
    let row = [
        b[0] * h[0][0] + b[1] * h[1][0],
        b[0] * h[0][1] + b[1] * h[1][1],
    ];
    let effort = r + row[0] * b[0] + row[1] * b[1];
    [
        (row[0] * a[0][0] + row[1] * a[1][0]) / effort,
        (row[0] * a[0][1] + row[1] * a[1][1]) / effort,
    ]
}

#[cfg(test)]
mod tests {
    use super::{lateral, scalar};

    /// At short periods both go to the closed forms of continuous time: k_x = √(q/r), k_y = √(q_y/r),
    /// k_θ = √(q_θ/r + 2 v k_y).
    #[test]
    fn gains_go_to_those_of_continuous_time() {
        // A discrete weight is a rate times the period.
        let dt = 1.0e-4;
        let (q_y, q_heading, r) = (64.0, 0.25, 0.25);
        let [y, heading] = lateral(0.7, dt, (q_y * dt, q_heading * dt), r * dt);
        let expected_y = f64::sqrt(q_y / r);
        let expected_heading = f64::sqrt(q_heading / r + 2.0 * 0.7 * expected_y);
        assert!((y / expected_y - 1.0).abs() < 1e-3, "{y} {expected_y}");
        assert!((heading / expected_heading - 1.0).abs() < 1e-3, "{heading}");
        let x = scalar(dt, 256.0 * dt, dt);
        assert!((x / 16.0 - 1.0).abs() < 1e-3, "{x}");
    }
}
