//! The two wheels as one linear system between reversals, and its solution.
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
//! linear, and v is near 0 where one becomes the other. So a row is solved in pieces, each with its own [`Mode`]. A v
//! that passes 0 while it is fast is taken to first order of tau.
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
//! M and N follow by iteration. z fades within a row, and while it does, w moves by N z, which is done at once. All
//! of that is smooth in tau: an estimate of a lag of 0 is free to be a little below.
//!
//! The motor current is i = alpha v: alpha = 1/R for voltages, 1/k for torques (k torque per ampere
//! at the wheel, which is also its back-EMF constant; R resistance). beta = alpha D_e is k/R, and 0
//! for torques.

use super::drivetrain::Drivetrain;
use super::source::Feed;
use nalgebra::{Matrix2, Vector2};

/// Names and order of the parameters of [`Wheels`].
pub(super) const DYNAMIC: usize = 8;
/// Steps to M and N, each of which leaves a share tau/T of what the one before did: 0.05^4 is 6e-6.
const TURNS: usize = 4;

/// Parameters of the system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wheels {
    per_inertia: Matrix2<f64>,
    emf: Vector2<f64>,
    /// D - D_e.
    bearing: Vector2<f64>,
    coulomb: Vector2<f64>,
    lag: Vector2<f64>,
    loss: Vector2<f64>,
    band: Vector2<f64>,
    source_ohm: f64,
    drain: f64,
    alpha: Vector2<f64>,
}

/// State: angles \[rad\], speeds \[rad/s\] and v.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) angle: Vector2<f64>,
    pub(super) speed: Vector2<f64>,
    pub(super) torque: Vector2<f64>,
}

/// Derivatives of angle and speed at the end of a row by the speed at its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    pub(super) angle: Matrix2<f64>,
    pub(super) speed: Matrix2<f64>,
    pub(super) torque: Matrix2<f64>,
}

/// Both motors under a feed: v settles at `feed` - `feedback` w, with the lag matrix `lag`.
#[derive(Clone, Copy, Debug)]
struct Motors {
    feed: Vector2<f64>,
    feedback: Matrix2<f64>,
    lag: Matrix2<f64>,
}

/// The linear system while each motor drives or brakes, apart in what is slow and what is fast.
#[derive(Clone, Copy, Debug)]
struct Mode {
    /// P, E^-1 gain.
    pull: Matrix2<f64>,
    /// M, N, A, F.
    feedback: Matrix2<f64>,
    late: Matrix2<f64>,
    rate: Matrix2<f64>,
    ahead: Matrix2<f64>,
}

/// Solution over a time h: with A the rate, exp(A h) and its first and second integrals.
#[derive(Clone, Copy, Debug)]
struct Step {
    speed: Matrix2<f64>,
    once: Matrix2<f64>,
    twice: Matrix2<f64>,
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

    fn motors(&self, feed: &Feed) -> Motors {
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

    /// The system under `motors` of which the right and the left one drive or brake.
    fn mode(&self, motors: &Motors, drives: [bool; 2]) -> Option<Mode> {
        let gain = Vector2::from_fn(|i, _| {
            if drives[i] {
                1.0 - self.loss[i]
            } else {
                1.0 + self.loss[i]
            }
        });
        let pull = self.per_inertia * Matrix2::from_diagonal(&gain);
        let drag = self.per_inertia * Matrix2::from_diagonal(&self.bearing);
        let mut feedback = -motors.feedback;
        for _ in 0..TURNS {
            feedback = -motors.feedback - motors.lag * feedback * (pull * feedback - drag);
        }
        let rate = pull * feedback - drag;
        let ahead = (Matrix2::identity() + motors.lag * feedback * pull).try_inverse()?;
        let mut late = Matrix2::zeros();
        for _ in 0..TURNS {
            late = (pull - rate * late) * ahead * motors.lag;
        }
        Some(Mode {
            pull,
            feedback,
            late,
            rate,
            ahead,
        })
    }
}

impl Motors {
    /// v once it follows w.
    fn settled(&self, speed: &Vector2<f64>) -> Vector2<f64> {
        self.feed - self.feedback * speed
    }
}

impl Mode {
    /// c: what v follows at a speed of 0.
    fn offset(&self, motors: &Motors, slowed: &Vector2<f64>) -> Vector2<f64> {
        self.ahead * (motors.feed + motors.lag * self.feedback * slowed)
    }

    /// The solution over `h` \[s\] by Taylor's series; 0 < h |A| < 3 is taken to rounding.
    fn step(&self, h: f64) -> Step {
        let a = h * self.rate;
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
            if term.amax() < 1.0e-15 {
                break;
            }
        }
        Step {
            speed,
            once: once * h,
            twice: twice * h * h,
        }
    }
}

/// What the motors of a row do: whether each drives its wheel at the start, and which one turns to the other after which
/// share of what is left of the row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    drives: [bool; 2],
    turns: [Option<(usize, f64)>; 2],
}

/// A ride along the rows of a stretch, which keeps what rows have in common.
pub(super) struct Ride<'a> {
    wheels: &'a Wheels,
    /// Directions of the wheels, and what Coulomb friction slows them by, E^-1 s sign.
    sign: Vector2<f64>,
    slowed: Vector2<f64>,
    /// What modes and steps hold for.
    share: [f64; 2],
    h: f64,
    modes: [Option<Mode>; 4],
    steps: [Option<Step>; 4],
    course: &'a mut Vec<Course>,
    at: usize,
}

impl<'a> Ride<'a> {
    /// A ride that decides on the rows of which `course` does not know yet.
    pub(super) fn new(wheels: &'a Wheels, sign: [f64; 2], course: &'a mut Vec<Course>) -> Self {
        let sign = Vector2::from(sign);
        Self {
            wheels,
            sign,
            slowed: wheels.per_inertia * wheels.coulomb.component_mul(&sign),
            share: [0.0; 2],
            h: 0.0,
            modes: [None; 4],
            steps: [None; 4],
            course,
            at: 0,
        }
    }

    /// Whether each motor drives its wheel.
    fn drives(&self, v: &Vector2<f64>) -> [bool; 2] {
        [0, 1].map(|i| v[i] * self.sign[i] >= 0.0)
    }

    fn mode(&mut self, feed: &Feed, motors: &Motors, drives: [bool; 2]) -> Option<Mode> {
        // A stiff source lets modes be those of any feed.
        if self.wheels.source_ohm != 0.0 && self.share != feed.share {
            self.share = feed.share;
            self.modes = [None; 4];
            self.steps = [None; 4];
        }
        let at = index(drives);
        if self.modes[at].is_none() {
            self.modes[at] = self.wheels.mode(motors, drives);
        }
        self.modes[at]
    }

    /// The whole row's step.
    fn step(&mut self, mode: &Mode, drives: [bool; 2], h: f64) -> Step {
        // Clocks written with six digits jitter by a microsecond's rounding only.
        if (self.h - h).abs() >= 1.0e-9 {
            self.h = h;
            self.steps = [None; 4];
        }
        *self.steps[index(drives)].get_or_insert_with(|| mode.step(h))
    }

    /// Feeds of the next row, what each motor does there once v follows, and the mode.
    fn follows(&mut self, feed: &Feed, speed: &Vector2<f64>) -> Option<(Motors, Course, Mode)> {
        let motors = self.wheels.motors(feed);
        let known = self.course.get(self.at).copied();
        self.at += 1;
        if let Some(course) = known {
            return Some((motors, course, self.mode(feed, &motors, course.drives)?));
        }
        let drives = self.drives(&motors.settled(speed));
        let mode = self.mode(feed, &motors, drives)?;
        // Not as if tau were 0, for v that is near to it.
        let drives = self.drives(&(mode.feedback * speed + mode.offset(&motors, &self.slowed)));
        let course = Course {
            drives,
            turns: [None; 2],
        };
        self.course.push(course);
        Some((motors, course, self.mode(feed, &motors, drives)?))
    }

    /// The state at `speed` under `feed` once v follows, with its derivative by that speed.
    pub(super) fn settled(
        &mut self,
        angle: Vector2<f64>,
        speed: Vector2<f64>,
        feed: &Feed,
    ) -> Option<(State, Carried)> {
        let (motors, _, mode) = self.follows(feed, &speed)?;
        let torque = mode.feedback * speed + mode.offset(&motors, &self.slowed);
        let state = State {
            angle,
            speed,
            torque,
        };
        let carried = Carried {
            angle: Matrix2::zeros(),
            speed: Matrix2::identity(),
            torque: mode.feedback,
        };
        Some((state, carried))
    }

    /// The state after a row of `h` \[s\] under `feed`; what is carried only if it is asked for, since most rides are for the
    /// states alone.
    pub(super) fn row<const CARRIED: bool>(
        &mut self,
        mut state: State,
        feed: &Feed,
        h: f64,
    ) -> Option<(State, Carried)> {
        let wheels = self.wheels;
        let decided = self.at < self.course.len();
        let (motors, mut course, mut mode) = self.follows(feed, &state.speed)?;
        let mut drives = course.drives;
        let mut offset = mode.offset(&motors, &self.slowed);
        let new = mode.feedback * state.speed + offset;
        let fast = state.torque - new;
        let left = fast.component_mul(&wheels.lag.map(|lag| left(lag, h)));
        state.angle -= mode.late * (mode.ahead * (motors.lag * (fast - left)));
        let extra = Vector2::from_fn(|i, _| {
            let ahead = if drives[i] {
                self.sign[i]
            } else {
                -self.sign[i]
            };
            let other = other_way(-ahead * state.torque[i], ahead * new[i]);
            -wheels.loss[i] * self.sign[i] * wheels.lag[i] * other
        });
        state.speed += mode.late * fast + wheels.per_inertia * extra;
        let mut carried = Carried {
            angle: Matrix2::zeros(),
            speed: Matrix2::identity(),
            torque: Matrix2::zeros(),
        };
        // Each motor may begin to brake or to drive once; v settles, it does not swing.
        let mut rest = h;
        for piece in 0..3 {
            let push = mode.pull * offset - self.slowed;
            let whole = if rest == h {
                self.step(&mode, drives, h)
            } else {
                mode.step(rest)
            };
            if let (false, Some(turn)) = (decided, course.turns.get_mut(piece)) {
                let end = whole.speed * state.speed + whole.once * push;
                let (from, to) = (
                    mode.feedback * state.speed + offset,
                    mode.feedback * end + offset,
                );
                // Where v is 0, as if it fell evenly: it is small all about there.
                *turn = (0..2)
                    .filter(|&i| self.drives(&to)[i] != drives[i])
                    .map(|i| (i, zero(from[i], to[i])))
                    .min_by(|a, b| a.1.total_cmp(&b.1));
            }
            let turn = course.turns.get(piece).copied().flatten();
            let step = turn.map_or(whole, |(_, part)| mode.step(part * rest));
            state.angle += step.once * state.speed + step.twice * push;
            state.speed = step.speed * state.speed + step.once * push;
            if CARRIED {
                carried.angle += step.once * carried.speed;
                carried.speed = step.speed * carried.speed;
            }
            let Some((i, part)) = turn else { break };
            rest -= part * rest;
            drives[i] = !drives[i];
            mode = self.mode(feed, &motors, drives)?;
            offset = mode.offset(&motors, &self.slowed);
        }
        self.course[self.at - 1] = course;
        state.speed -= mode.late * left;
        state.torque = mode.feedback * state.speed + offset + left;
        if CARRIED {
            carried.torque = mode.feedback * carried.speed;
        }
        Some((state, carried))
    }
}

/// Where a line from `from` to `to` is 0, 0 to 1; 0 of one that is not.
fn zero(from: f64, to: f64) -> f64 {
    if from * to < 0.0 {
        from / (from - to)
    } else {
        0.0
    }
}

/// Place of a mode.
fn index(drives: [bool; 2]) -> usize {
    usize::from(drives[0]) + 2 * usize::from(drives[1])
}

/// While v goes to `new` from `old` the other way, v = new - (old + new) exp(-t/tau): the integral of |v| less that of v,
/// over tau; 0 for one that goes no other way.
fn other_way(old: f64, new: f64) -> f64 {
    let (old, new) = (old.max(0.0), new.max(0.0));
    let until = if new > 0.0 { (old / new).ln_1p() } else { 0.0 };
    2.0 * (old - new * until)
}

/// exp(-h/tau). Where tau is 0 this is 0 with all its derivatives, and so it is below.
fn left(lag: f64, h: f64) -> f64 {
    if lag > 0.0 { (-h / lag).exp() } else { 0.0 }
}
