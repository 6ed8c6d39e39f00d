//! The two wheels as one linear system between reversals, and its exact solution.
//!
//! With wheel speeds w and commands u held from row to row,
//!
//! ```text
//! E dw/dt = u - D w - s sign(w),   da/dt = w
//! ```
//!
//! | symbol | meaning | per command u = torque | u = voltage |
//! | --- | --- | --- | --- |
//! | E | inertia seen by the wheels, 2 x 2 | kg m^2 | V s^2 |
//! | D | damping, diagonal | N m s | V s |
//! | s | Coulomb friction | N m | V |
//!
//! The motor current is i = alpha u - beta w: alpha = 1/R and beta = k/R for voltages (k torque per
//! ampere at the wheel, which is also its back-EMF constant; R resistance), alpha = 1/k and beta = 0
//! for torques.

use nalgebra::{Matrix2, Vector2};

/// Names and order of the parameters of [`Wheels`].
pub(super) const DYNAMIC: usize = 8;
/// With alpha and beta of both sides.
pub(super) const WITH_CURRENT: usize = 12;

/// Parameters of the system: E by rows, D, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wheels {
    damping: Vector2<f64>,
    coulomb: Vector2<f64>,
    inverse: Matrix2<f64>,
}

/// State: angles \[rad\] and speeds \[rad/s\].
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) angle: Vector2<f64>,
    pub(super) speed: Vector2<f64>,
}

/// Solution over one step h: with A = -E^-1 D, exp(A h) and its first and second integrals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    h: f64,
    pub(super) speed: Matrix2<f64>,
    pub(super) once: Matrix2<f64>,
    twice: Matrix2<f64>,
}

impl Wheels {
    /// From E by rows, D, s; nothing if E cannot be inverted.
    pub(super) fn new(p: &[f64]) -> Option<Self> {
        let [e11, e12, e21, e22, d1, d2, s1, s2] = *p.get(..DYNAMIC)? else {
            return None;
        };
        Some(Self {
            damping: Vector2::new(d1, d2),
            coulomb: Vector2::new(s1, s2),
            inverse: Matrix2::new(e11, e12, e21, e22).try_inverse()?,
        })
    }

    /// The solution over `h` \[s\] by Taylor's series; 0 < h |A| < 3 is taken to rounding.
    pub(super) fn step(&self, h: f64) -> Step {
        let a = -h * self.inverse * Matrix2::from_diagonal(&self.damping);
        let mut term = Matrix2::identity();
        let (mut speed, mut once, mut twice) =
            (Matrix2::zeros(), Matrix2::zeros(), Matrix2::zeros());
        // 3^24 / 24! is 5e-13, and with h |A| < 0.3 ten terms would do.
        for n in 0..24 {
            let n = f64::from(n);
            speed += term;
            once += term / (n + 1.0);
            twice += term / ((n + 1.0) * (n + 2.0));
            term = term * a / (n + 1.0);
            if term.amax() < 1.0e-17 {
                break;
            }
        }
        Step {
            h,
            speed,
            once: once * h,
            twice: twice * h * h,
        }
    }

    /// The step for `h`, the one before if it was as long.
    pub(super) fn step_like(&self, before: Option<Step>, h: f64) -> Step {
        match before {
            // Clocks written with six digits jitter by a microsecond's rounding only.
            Some(step) if (step.h - h).abs() < 1.0e-9 => step,
            _ => self.step(h),
        }
    }

    /// The state after a step under command `u`.
    pub(super) fn advance(&self, step: &Step, state: State, u: [f64; 2], sign: [f64; 2]) -> State {
        let push = Vector2::from(u) - self.coulomb.component_mul(&Vector2::from(sign));
        let accel = self.inverse * push;
        State {
            angle: state.angle + step.once * state.speed + step.twice * accel,
            speed: step.speed * state.speed + step.once * accel,
        }
    }
}
