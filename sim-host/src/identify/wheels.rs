//! The two wheels as one linear system between reversals, and its solution.
//!
//! With wheel speeds w and commands u held from row to row, the motors make torques of v commands,
//!
//! ```text
//! E dw/dt = v - (D - D_e) w - s sign(w),   tau dv/dt = u - D_e w - v,   da/dt = w
//! ```
//!
//! | symbol | meaning | per command u = torque | u = voltage |
//! | --- | --- | --- | --- |
//! | E | inertia seen by the wheels, 2 x 2 | kg m^2 | V s^2 |
//! | D | damping, diagonal | N m s | V s |
//! | D_e | the part of it that is back-EMF | 0 | V s |
//! | s | Coulomb friction | N m | V |
//! | tau | lag of a motor: L/R of its winding, and what a driver adds | s | s |
//!
//! tau is far below the time in which wheels settle. So after a jump of u, v soon follows w, and what
//! it does before moves w by a little that is done at once, where the row begins. What is left is a
//! system in w alone, which is solved exactly. It has v to tau^2 and is smooth in tau: an estimate of
//! a lag of 0 is free to be a little below.
//!
//! The motor current is i = alpha v: alpha = 1/R for voltages, 1/k for torques (k torque per ampere
//! at the wheel, which is also its back-EMF constant; R resistance). beta = alpha D_e is k/R, and 0
//! for torques.

use nalgebra::{Matrix2, Vector2};

/// Names and order of the parameters of [`Wheels`].
pub(super) const DYNAMIC: usize = 8;

/// Parameters of the system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wheels {
    lag: Vector2<f64>,
    damping: Vector2<f64>,
    coulomb: Vector2<f64>,
    /// Of the inertia while v follows w.
    inverse: Matrix2<f64>,
}

/// State: angles \[rad\], speeds \[rad/s\], and what of v is left of jumps of u.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) angle: Vector2<f64>,
    pub(super) speed: Vector2<f64>,
    pub(super) left: Vector2<f64>,
}

/// Solution over one step h: with A = -E^-1 D, exp(A h) and its first and second integrals; and the
/// share of v that is left of a jump of u.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    h: f64,
    pub(super) speed: Matrix2<f64>,
    pub(super) once: Matrix2<f64>,
    twice: Matrix2<f64>,
    left: Vector2<f64>,
}

impl Wheels {
    /// From E by rows, D, s, with D_e and tau; nothing if the inertia cannot be inverted.
    pub(super) fn new(p: &[f64], emf: [f64; 2], lag: [f64; 2]) -> Option<Self> {
        let [e11, e12, e21, e22, d1, d2, s1, s2] = *p.get(..DYNAMIC)? else {
            return None;
        };
        let (damping, lag) = (Vector2::new(d1, d2), Vector2::from(lag));
        let inertia = Matrix2::new(e11, e12, e21, e22);
        Some(Self {
            lag,
            damping,
            coulomb: Vector2::new(s1, s2),
            inverse: eased(&inertia, &damping, &emf.into(), &lag)?,
        })
    }

    /// The solution over `h` \[s\] by Taylor's series; 0 < h |A| < 3 is taken to rounding.
    pub(super) fn step(&self, h: f64) -> Step {
        let a = h * self.rate();
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
            left: self.lag.map(|lag| left(lag, h)),
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

    /// The state from which a row goes on whose command is `now`, after one whose command was
    /// `before`.
    ///
    /// v makes up for the jump of u over a time of tau, so that an impulse is lost (or left over);
    /// and in that time the angle has not yet felt it:
    ///
    /// ```text
    /// w <- w + E^-1 tau (u_before - u_now),   a <- a - tau E^-1 tau (u_before - u_now),
    /// v is u_before - u_now further off
    /// ```
    pub(super) fn switched(&self, state: State, before: [f64; 2], now: [f64; 2]) -> State {
        let jump = Vector2::from(before) - Vector2::from(now);
        let late = self.inverse * self.lag.component_mul(&jump);
        State {
            angle: state.angle - self.lag.component_mul(&late),
            speed: state.speed + late,
            left: state.left + jump,
        }
    }

    /// dw/dt = E^-1 (u - D w - s sign(w)).
    pub(super) fn acceleration(
        &self,
        speed: Vector2<f64>,
        u: [f64; 2],
        sign: [f64; 2],
    ) -> [f64; 2] {
        let held = self.damping.component_mul(&speed);
        let dry = self.coulomb.component_mul(&Vector2::from(sign));
        (self.inverse * (Vector2::from(u) - held - dry)).into()
    }

    /// dw/dt by w: -E^-1 D.
    pub(super) fn rate(&self) -> Matrix2<f64> {
        -self.inverse * Matrix2::from_diagonal(&self.damping)
    }

    /// The state after a step under command `u`.
    pub(super) fn advance(&self, step: &Step, state: State, u: [f64; 2], sign: [f64; 2]) -> State {
        let push = Vector2::from(u) - self.coulomb.component_mul(&Vector2::from(sign));
        let accel = self.inverse * push;
        State {
            angle: state.angle + step.once * state.speed + step.twice * accel,
            speed: step.speed * state.speed + step.once * accel,
            left: step.left.component_mul(&state.left),
        }
    }
}

/// The inverse of the inertia that the wheels feel while v follows w.
///
/// There v = u - D_e w - tau dv/dt, and with dv/dt = -D_e dw/dt - tau d^2v/dt^2 the back-EMF of a
/// moment ago helps an acceleration as a lesser inertia does, to tau^2
///
/// ```text
/// E - tau D_e (1 + tau (E - tau D_e)^-1 D)
/// ```
fn eased(
    inertia: &Matrix2<f64>,
    damping: &Vector2<f64>,
    emf: &Vector2<f64>,
    lag: &Vector2<f64>,
) -> Option<Matrix2<f64>> {
    let help = Matrix2::from_diagonal(&lag.component_mul(emf));
    let first = (inertia - help).try_inverse()?;
    let fading = first * Matrix2::from_diagonal(damping);
    let again = Matrix2::from_diagonal(lag) * help * fading;
    (inertia - help - again).try_inverse()
}

/// exp(-h/tau). Where tau is 0 this is 0 with all its derivatives, and so it is below.
fn left(lag: f64, h: f64) -> f64 {
    if lag > 0.0 { (-h / lag).exp() } else { 0.0 }
}
