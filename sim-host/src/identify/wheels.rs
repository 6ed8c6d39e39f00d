//! The two wheels as one linear system between reversals, and its solution while each motor drives or brakes.
//!
//! With wheel speeds w and commands u held from row to row, the motors make torques of v commands,
//!
//! ```text
//! E dw/dt = v - loss |v| sign(w) - (D - D_e) w - s sign(w),   tau dv/dt = u - D_e w - v,   da/dt = w
//! ```
//!
//! | symbol | meaning | per command u = torque | u = voltage |
//! | --- | --- | --- | --- |
//! | E | inertia seen by the wheels, 2 x 2 | kg m^2 | V s^2 |
//! | D | damping, diagonal | N m s | V s |
//! | D_e | the part of it that is back-EMF | 0 | V s |
//! | s | Coulomb friction | N m | V |
//! | tau | lag of a motor: L/R of its winding, and what a driver adds | s | s |
//! | loss | share of the torque that the gear's teeth hold back: 1 - efficiency | 0 | 1 |
//!
//! **Gear.** While a motor drives its wheel 1 - loss of its torque arrives, while it brakes 1 + loss: either is
//! linear, and v is 0 where one becomes the other. So a row is solved in pieces ([`super::ride`]), each with its own [`Mode`].
//!
//! **Battery.** Duties a of a battery of V_0 behind R_b give u = a V with V = V_0 - R_b (a_R i_R + a_L i_L) and
//! i = alpha v: with q = 1/(1 + R_b sum a^2 alpha), v settles at a q V_0 - H w,
//!
//! ```text
//! H = diag(D_e) - q R_b a (a alpha D_e)^T,   lag matrix T = (1 - q R_b a (a alpha)^T) diag(tau)
//! ```
//!
//! tau is far below the time in which wheels settle. So what is slow, y, and what is fast, z, are taken apart, P being
//! E^-1 (1 -+ loss):
//!
//! ```text
//! w = y - N z, v = M w + c + z:   dy/dt = A y + P c - E^-1 s sign(w),   dz/dt = -(T^-1 + M P) z
//! M = -H - T M A,   A = P M - E^-1 (D - D_e),   N = (P - A N) F T,   F = (1 + T M P)^-1
//! c = F (a q V_0 + T M E^-1 s sign(w))
//! ```
//!
//! M and N follow by iteration. Of one wheel with the rate r = A at tau = 0, the slow root x = tau A of x (1 - x) = tau r is what M
//! converges to, each turn leaving 2 x of what the one before was off by, and N half of that: it converges while x is below 1/2,
//! beyond which the wheel swings. The number of turns is bounded, so that a fit may pass there. z fades as exp(-(F T)^-1 t). A piece ends where M w + c + z of a motor passes 0.
//!
//! **No lag.** A fit begins at lags of 0, and one that finds 0 is free to be a little below. There F T has no inverse, and z is
//! gone at once: what it does is then taken to first order of tau, which goes on smoothly below 0.
//!
//! The motor current is i = alpha v: alpha = 1/R for voltages, 1/k for torques (k torque per ampere
//! at the wheel, which is also its back-EMF constant; R resistance). beta = alpha D_e is k/R, and 0
//! for torques.

use super::drivetrain::Drivetrain;
use super::source::Feed;
use nalgebra::{Matrix2, Vector2};

/// Names and order of the parameters of [`Wheels`].
pub(super) const DYNAMIC: usize = 8;
/// Turns of the iterations of M and N end when one changes them by less than this share, which is less than any log shows by
/// orders of magnitude.
const CONVERGED: f64 = 1.0e-10;
/// Most turns. Of what is to be found they leave 1e-10 at tau A = 0.07, 5e-7 at 0.15 and 2e-4 at 0.25, where a log does show it: what is
/// off by 4e-5 of the torque is a hundredth of the friction of a base whose motors are strong, and more than its interval.
const TURNS: usize = 12;
/// tau A above which lags are not solved well. There tau r, which is the lag over the settling time, is 0.16.
const SLOWEST: f64 = 0.2;

/// 1/n!, as far as a step takes them: 3^25/27! is 8e-17.
const PER_FACTORIAL: [f64; 28] = {
    let mut all = [1.0; 28];
    let mut n = 1;
    while n < all.len() {
        all[n] = all[n - 1] / n as f64;
        n += 1;
    }
    all
};

/// Parameters of the system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wheels {
    pub(super) per_inertia: Matrix2<f64>,
    pub(super) emf: Vector2<f64>,
    /// D - D_e.
    pub(super) bearing: Vector2<f64>,
    pub(super) coulomb: Vector2<f64>,
    pub(super) lag: Vector2<f64>,
    pub(super) loss: Vector2<f64>,
    pub(super) band: Vector2<f64>,
    pub(super) source_ohm: f64,
    pub(super) drain: f64,
    pub(super) alpha: Vector2<f64>,
}

/// Both motors under a feed: v settles at `feed` - `feedback` w, with the lag matrix `lag`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motors {
    pub(super) feed: Vector2<f64>,
    pub(super) feedback: Matrix2<f64>,
    pub(super) lag: Matrix2<f64>,
}

/// The linear system while each motor drives or brakes, apart in what is slow and what is fast.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    /// P, E^-1 gain.
    pub(super) pull: Matrix2<f64>,
    /// M, N, A, F, F T.
    pub(super) feedback: Matrix2<f64>,
    pub(super) late: Matrix2<f64>,
    pub(super) rate: Matrix2<f64>,
    pub(super) ahead: Matrix2<f64>,
    pub(super) fading: Matrix2<f64>,
}

/// Solution over a time h: with A the rate, exp(A h) and its first and second integrals; and what is left of z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) speed: Matrix2<f64>,
    pub(super) once: Matrix2<f64>,
    pub(super) twice: Matrix2<f64>,
    pub(super) left: Matrix2<f64>,
}

/// What is slow, y, and what is fast, z, of speed and torque.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    pub(super) slow: Vector2<f64>,
    pub(super) fast: Vector2<f64>,
}

impl Wheels {
    /// From E by rows, D, s, with D_e, alpha (0 if no current is known) and what lies between command and wheel.
    pub(super) fn new(
        p: &[f64],
        emf: [f64; 2],
        alpha: [f64; 2],
        train: Drivetrain,
    ) -> Option<Self> {
        let [e11, e12, e21, e22, d1, d2, s1, s2] = *p.get(..DYNAMIC)? else {
            return None;
        };
        let emf = Vector2::from(emf);
        Some(Self {
            per_inertia: Matrix2::new(e11, e12, e21, e22).try_inverse()?,
            emf,
            bearing: Vector2::new(d1, d2) - emf,
            coulomb: Vector2::new(s1, s2),
            lag: train.lag.into(),
            loss: train.loss.into(),
            band: train.band.into(),
            source_ohm: train.source_ohm,
            drain: train.drain,
            alpha: alpha.into(),
        })
    }

    pub(super) fn motors(&self, feed: &Feed) -> Motors {
        let mut share = Vector2::from(feed.share);
        for (share, band) in share.iter_mut().zip(self.band.iter()) {
            // Without a band exactly as commanded, whatever a command is.
            if *band != 0.0 && *share != 0.0 {
                *share -= band
                    .clamp(-share.abs(), share.abs())
                    .copysign(*share * band);
            }
        }
        let drawn = share.component_mul(&self.alpha);
        let sag = self.source_ohm / (1.0 + self.source_ohm * share.dot(&drawn));
        let less = sag * share * drawn.transpose();
        let emf = Matrix2::from_diagonal(&self.emf);
        Motors {
            // q = 1 - R_b q sum a^2 alpha.
            feed: share
                * (feed.open(self.source_ohm, self.drain) * (1.0 - sag * share.dot(&drawn))),
            feedback: emf - less * emf,
            lag: (Matrix2::identity() - less) * Matrix2::from_diagonal(&self.lag),
        }
    }

    /// The largest lag that is solved well \[s\]. Braking motors settle sooner than driving ones; the battery, which delays them, is
    /// left out.
    pub(super) fn largest_lag(&self) -> f64 {
        let pull = self.per_inertia * Matrix2::from_diagonal(&self.loss.map(|loss| 1.0 + loss));
        let rate = pull * Matrix2::from_diagonal(&self.emf)
            + self.per_inertia * Matrix2::from_diagonal(&self.bearing);
        let half = 0.5 * rate.trace();
        let apart = (half * half - rate.determinant()).max(0.0).sqrt();
        match half + apart {
            fastest if fastest > 0.0 => SLOWEST * (1.0 - SLOWEST) / fastest,
            // Wheels that nothing holds back never settle: any lag is short beside that.
            _ => f64::INFINITY,
        }
    }

    /// The system under `motors` of which the right and the left one drive or brake.
    pub(super) fn mode(&self, motors: &Motors, drives: [bool; 2]) -> Option<Mode> {
        let gain = Vector2::from_fn(|i, _| {
            if drives[i] {
                1.0 - self.loss[i]
            } else {
                1.0 + self.loss[i]
            }
        });
        let pull = self.per_inertia * Matrix2::from_diagonal(&gain);
        let drag = self.per_inertia * Matrix2::from_diagonal(&self.bearing);
        let feedback = converged(-motors.feedback, |m| {
            -motors.feedback - motors.lag * m * (pull * m - drag)
        });
        let rate = pull * feedback - drag;
        let ahead = (Matrix2::identity() + motors.lag * feedback * pull).try_inverse()?;
        let fading = ahead * motors.lag;
        let late = converged(Matrix2::zeros(), |n| (pull - rate * n) * fading);
        Some(Mode {
            pull,
            feedback,
            late,
            rate,
            ahead,
            fading,
        })
    }
}

/// Where `turn` leaves a matrix as it is, or how near to it [`TURNS`] lead.
fn converged(mut from: Matrix2<f64>, turn: impl Fn(&Matrix2<f64>) -> Matrix2<f64>) -> Matrix2<f64> {
    for _ in 0..TURNS {
        let to = turn(&from);
        let change = (to - from).amax();
        from = to;
        if change <= CONVERGED * from.amax() {
            break;
        }
    }
    from
}

impl Motors {
    /// v once it follows w.
    pub(super) fn settled(&self, speed: &Vector2<f64>) -> Vector2<f64> {
        self.feed - self.feedback * speed
    }
}

impl Mode {
    /// c: what v follows at a speed of 0.
    pub(super) fn offset(&self, motors: &Motors, slowed: &Vector2<f64>) -> Vector2<f64> {
        self.ahead * (motors.feed + motors.lag * self.feedback * slowed)
    }

    /// What is slow and what is fast of a speed and a torque.
    pub(super) fn parts(
        &self,
        offset: &Vector2<f64>,
        speed: &Vector2<f64>,
        torque: &Vector2<f64>,
    ) -> Parts {
        let fast = torque - (self.feedback * speed + offset);
        Parts {
            slow: speed + self.late * fast,
            fast,
        }
    }

    /// Those after this step, `push` being P c - E^-1 s sign.
    pub(super) fn stepped(&self, step: &Step, parts: &Parts, push: &Vector2<f64>) -> Parts {
        Parts {
            slow: step.speed * parts.slow + step.once * push,
            fast: step.left * parts.fast,
        }
    }

    /// Speed and torque of both parts.
    pub(super) fn whole(
        &self,
        offset: &Vector2<f64>,
        parts: &Parts,
    ) -> (Vector2<f64>, Vector2<f64>) {
        let speed = parts.slow - self.late * parts.fast;
        (speed, self.feedback * speed + offset + parts.fast)
    }

    /// The solution over `h` \[s\] by Taylor's series; 0 < h |A| < 3 is taken to rounding. z is that of motors of which these
    /// have `no_lag`.
    pub(super) fn step(&self, h: f64, no_lag: [bool; 2]) -> Step {
        let a = h * self.rate;
        let (trace, determinant) = (a.trace(), a.determinant());
        // A series in a is p + q a, for a^2 = trace a - determinant (Cayley, Hamilton): Horner's rule with two numbers, from the
        // last term on. No vector grows by more than this size; what is left out is below rounding.
        let size = 2.0 * a.amax();
        let last = match size {
            _ if size < 0.1 => 10,
            _ if size < 0.4 => 14,
            _ if size < 1.5 => 20,
            _ => 27,
        };
        let (mut p, mut q) = (0.0, 0.0);
        let mut down_to = |least: usize, from: usize| {
            for n in (least..=from).rev() {
                (p, q) = (PER_FACTORIAL[n] - determinant * q, p + trace * q);
            }
            Matrix2::from_diagonal_element(p) + q * a
        };
        // Sums of a^n / (n + 2)!, of a^n / (n + 1)! and of a^n / n!.
        let (twice, once, speed) = (down_to(2, last), down_to(1, 1), down_to(0, 0));
        Step {
            speed,
            once: once * h,
            twice: twice * h * h,
            left: self.left(h, no_lag),
        }
    }

    /// exp(-(F T)^-1 h), where a motor has no lag of each motor by itself.
    fn left(&self, h: f64, no_lag: [bool; 2]) -> Matrix2<f64> {
        let lag = self.fading.diagonal();
        match self.fading.try_inverse() {
            Some(rate) if no_lag == [false; 2] => decayed(&rate, h),
            _ => Matrix2::from_diagonal(&Vector2::from_fn(|i, _| {
                if no_lag[i] { 0.0 } else { (-h / lag[i]).exp() }
            })),
        }
    }
}

/// exp(-G h) of a G whose eigenvalues m - d and m + d are real and above 0: (G - m)^2 = d^2.
fn decayed(rate: &Matrix2<f64>, h: f64) -> Matrix2<f64> {
    let m = 0.5 * rate.trace();
    let d = (m * m - rate.determinant()).max(0.0).sqrt();
    let (slow, quick) = ((-(m - d) * h).exp(), (-(m + d) * h).exp());
    let apart = if d * h > 1.0e-3 {
        0.5 * (slow - quick) / d
    } else {
        // sinh(x) is x but for a share of x^2/6.
        h * (-m * h).exp()
    };
    Matrix2::from_diagonal_element(0.5 * (slow + quick) + m * apart) - rate * apart
}

#[cfg(test)]
mod tests {
    use super::{DYNAMIC, Wheels};
    use crate::identify::drivetrain::Drivetrain;

    /// The largest lag of wheels with an inertia of 0.05 and this damping, and emf as a part of it.
    fn largest_lag(damping: f64, emf: f64) -> f64 {
        let train = Drivetrain {
            lag: [1.0e-3; 2],
            loss: [0.0; 2],
            band: [0.0; 2],
            source_ohm: 0.0,
            drain: 0.0,
        };
        let dynamics: [f64; DYNAMIC] = [0.05, 0.0, 0.0, 0.05, damping, damping, 0.1, 0.1];
        let wheels = Wheels::new(&dynamics, [emf; 2], [0.0; 2], train).expect("an inertia");
        wheels.largest_lag()
    }

    /// tau r = 0.16 at r = D/E; without damping, or with one that is found a little below 0, there is none.
    #[test]
    fn a_lag_is_long_beside_the_time_in_which_wheels_settle() {
        for emf in [0.0, 0.5] {
            assert!((largest_lag(0.5, emf) - 0.016).abs() < 1.0e-9);
        }
        for damping in [0.0, -0.0, -1.0e-6] {
            assert_eq!(largest_lag(damping, 0.0), f64::INFINITY);
        }
    }
}
