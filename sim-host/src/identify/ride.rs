//! A ride along the rows of a stretch: each row solved in pieces, as motors turn from driving to braking and back.

use super::source::Feed;
use super::wheels::{Mode, Motors, Step, Wheels};
use nalgebra::{Matrix2, Vector2};

/// A lag below this share of a row is none: what is neglected then is its square.
const NO_LAG: f64 = 1.0e-3;
/// What is fast has faded after this many lags, to exp(-5).
const FADED: f64 = 5.0;
/// How near to 0 a v has passed it, as a share of what it changes by: the speed is wrong by the square of it.
const PASSED: f64 = 1.0e-4;

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

/// Each motor turns from driving to braking and back once while it is fast, and once after.
const PIECES: usize = 4;

/// What the motors of a row do: whether each has no lag to speak of, whether it drives its wheel at the start, and which one
/// turns to the other after which share of what is left of the row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    no_lag: [bool; 2],
    drives: [bool; 2],
    turns: [Option<(usize, f64)>; PIECES],
}

/// A ride along the rows of a stretch, which keeps what rows have in common.
pub(super) struct Ride<'a> {
    turning: Turning<'a>,
    modes: Modes,
    course: &'a mut Vec<Course>,
    at: usize,
}

/// Wheels that all turn their way.
#[derive(Clone, Copy)]
struct Turning<'a> {
    wheels: &'a Wheels,
    /// Directions of the wheels, and what Coulomb friction slows them by, E^-1 s sign.
    sign: Vector2<f64>,
    slowed: Vector2<f64>,
}

/// What is solved under one feed.
#[derive(Default)]
struct Modes {
    share: [f64; 2],
    known: [Option<Solved>; 4],
}

/// A mode, and its last step of a whole row, with what that is for.
#[derive(Clone, Copy)]
struct Solved {
    mode: Mode,
    row: Option<(f64, [bool; 2], Step)>,
}

impl Modes {
    /// That of motors which drive their wheels, or brake.
    fn of(
        &mut self,
        wheels: &Wheels,
        feed: &Feed,
        motors: &Motors,
        drives: [bool; 2],
    ) -> Option<&mut Solved> {
        // A stiff source lets modes be those of any feed.
        if wheels.source_ohm != 0.0 && self.share != feed.share {
            (self.share, self.known) = (feed.share, [None; 4]);
        }
        let known = &mut self.known[index(drives)];
        if known.is_none() {
            let mode = wheels.mode(motors, drives)?;
            *known = Some(Solved { mode, row: None });
        }
        known.as_mut()
    }
}

impl Solved {
    /// The step over what is left of a row of `h`.
    fn rest(&mut self, no_lag: [bool; 2], rest: f64, h: f64) -> Step {
        if rest != h {
            return self.mode.step(rest, no_lag);
        }
        match self.row {
            // Clocks written with six digits jitter by a microsecond's rounding only.
            Some((known_h, known, step)) if (known_h - h).abs() < 1.0e-9 && known == no_lag => step,
            _ => {
                let step = self.mode.step(h, no_lag);
                self.row = Some((h, no_lag, step));
                step
            }
        }
    }
}

impl<'a> Ride<'a> {
    /// A ride that decides on the rows of which `course` does not know yet.
    pub(super) fn new(wheels: &'a Wheels, sign: [f64; 2], course: &'a mut Vec<Course>) -> Self {
        let sign = Vector2::from(sign);
        Self {
            turning: Turning {
                wheels,
                sign,
                slowed: wheels.per_inertia * wheels.coulomb.component_mul(&sign),
            },
            modes: Modes::default(),
            course,
            at: 0,
        }
    }

    /// What the row does, so far as it is known before it is solved.
    fn course(
        &mut self,
        feed: &Feed,
        motors: &Motors,
        speed: &Vector2<f64>,
        torque: Option<&Vector2<f64>>,
        h: f64,
    ) -> Option<Course> {
        self.at += 1;
        if let Some(known) = self.course.get(self.at - 1) {
            return Some(*known);
        }
        let lag = self.turning.wheels.lag;
        let no_lag = [lag.x <= NO_LAG * h, lag.y <= NO_LAG * h];
        let mut drives = self.settles(feed, motors, speed)?;
        if let Some(torque) = torque {
            let so_far = self.turning.drives(torque);
            for (i, drives) in drives.iter_mut().enumerate() {
                *drives = if no_lag[i] { *drives } else { so_far[i] };
            }
        }
        let course = Course {
            no_lag,
            drives,
            turns: [None; PIECES],
        };
        self.course.push(course);
        Some(course)
    }

    /// Whether each motor drives its wheel once v follows, not as if tau were 0.
    fn settles(&mut self, feed: &Feed, motors: &Motors, speed: &Vector2<f64>) -> Option<[bool; 2]> {
        let turning = self.turning;
        let drives = turning.drives(&motors.settled(speed));
        let mode = &self.modes.of(turning.wheels, feed, motors, drives)?.mode;
        Some(turning.drives(&(mode.feedback * speed + mode.offset(motors, &turning.slowed))))
    }

    /// The state at `speed` under `feed` once v follows, with its derivative by that speed.
    pub(super) fn settled(
        &mut self,
        angle: Vector2<f64>,
        speed: Vector2<f64>,
        feed: &Feed,
    ) -> Option<(State, Carried)> {
        let Turning { wheels, slowed, .. } = self.turning;
        let motors = wheels.motors(feed);
        let course = self.course(feed, &motors, &speed, None, 0.0)?;
        let mode = &self.modes.of(wheels, feed, &motors, course.drives)?.mode;
        let torque = mode.feedback * speed + mode.offset(&motors, &slowed);
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
        let turning = self.turning;
        let Turning { wheels, slowed, .. } = turning;
        let motors = wheels.motors(feed);
        let decided = self.at < self.course.len();
        let mut course = self.course(feed, &motors, &state.speed, Some(&state.torque), h)?;
        let mut now = course;
        let modes = &mut self.modes;
        let mut solved = modes.of(wheels, feed, &motors, now.drives)?;
        let mut offset = solved.mode.offset(&motors, &slowed);
        state.speed += turning.turned_at_once(&solved.mode, &offset, &course, &state);
        let mut carried = Carried {
            angle: Matrix2::zeros(),
            speed: Matrix2::identity(),
            torque: Matrix2::zeros(),
        };
        let mut rest = h;
        for piece in 0..=PIECES {
            let push = solved.mode.pull * offset - slowed;
            let parts = solved.mode.parts(&offset, &state.speed, &state.torque);
            // Of a row that is decided only what it does is worked out.
            let mut whole = None;
            if let (false, Some(turn)) = (decided, course.turns.get_mut(piece)) {
                let to_end = solved.rest(now.no_lag, rest, h);
                let mode = &solved.mode;
                let torque =
                    |step: &Step| mode.whole(&offset, &mode.stepped(step, &parts, &push)).1;
                let ends = [state.torque - parts.fast, torque(&to_end)];
                *turn = turning.turn(mode, &now, rest, ends, torque);
                whole = Some(to_end);
            }
            let turn = course.turns.get(piece).copied().flatten();
            let step = match (turn, whole) {
                (Some((_, part)), _) => solved.mode.step(part * rest, now.no_lag),
                (None, Some(whole)) => whole,
                (None, None) => solved.rest(now.no_lag, rest, h),
            };
            let mode = &solved.mode;
            let after = mode.stepped(&step, &parts, &push);
            state.angle += step.once * parts.slow + step.twice * push
                - mode.late * (mode.fading * (parts.fast - after.fast));
            (state.speed, state.torque) = mode.whole(&offset, &after);
            if CARRIED {
                carried.angle += step.once * carried.speed;
                carried.speed = step.speed * carried.speed;
            }
            let Some((i, part)) = turn else { break };
            rest -= part * rest;
            now.drives[i] = !now.drives[i];
            solved = modes.of(wheels, feed, &motors, now.drives)?;
            offset = solved.mode.offset(&motors, &slowed);
        }
        if CARRIED {
            carried.torque = solved.mode.feedback * carried.speed;
        }
        self.course[self.at - 1] = course;
        Some((state, carried))
    }
}

impl Turning<'_> {
    /// Whether each motor drives its wheel.
    fn drives(&self, v: &Vector2<f64>) -> [bool; 2] {
        let ahead = v.component_mul(&self.sign);
        [ahead.x >= 0.0, ahead.y >= 0.0]
    }

    /// By how much motors without lag change the speed that came from the other side of 0: to first order of a lag.
    fn turned_at_once(
        &self,
        mode: &Mode,
        offset: &Vector2<f64>,
        course: &Course,
        state: &State,
    ) -> Vector2<f64> {
        if course.no_lag == [false; 2] {
            return Vector2::zeros();
        }
        let (wheels, new) = (self.wheels, mode.feedback * state.speed + offset);
        wheels.per_inertia
            * Vector2::from_fn(|i, _| {
                if !course.no_lag[i] {
                    return 0.0;
                }
                let ahead = if course.drives[i] {
                    self.sign[i]
                } else {
                    -self.sign[i]
                };
                let other = other_way(-ahead * state.torque[i], ahead * new[i]);
                -wheels.loss[i] * self.sign[i] * wheels.lag[i] * other
            })
    }

    /// Which motor's v is the first to pass 0 in what is left of a row, and after which share of it. `settling` is v as if it
    /// followed at once, `to` v at the end, `at` v after any step.
    fn turn(
        &self,
        mode: &Mode,
        now: &Course,
        rest: f64,
        [settling, to]: [Vector2<f64>; 2],
        at: impl Fn(&Step) -> Vector2<f64>,
    ) -> Option<(usize, f64)> {
        // What is fast is over by then; what is slow may go on, or back.
        let soon = (FADED * self.wheels.lag.max() / rest).clamp(0.0, 1.0);
        let passes = |i: usize| {
            let sign = if now.drives[i] {
                self.sign[i]
            } else {
                -self.sign[i]
            };
            let ahead = |share: f64| sign * at(&mode.step(share * rest, now.no_lag))[i];
            let end = (1.0, sign * to[i]);
            if end.1 >= 0.0 && sign * settling[i] >= 0.0 {
                return None;
            }
            let mut from = (0.0, ahead(0.0).max(0.0));
            for to in [(soon, ahead(soon)), end] {
                if to.1 < 0.0 {
                    return Some((i, zero(from, to, ahead)));
                }
                from = to;
            }
            None
        };
        (0..2).filter_map(passes).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Where f is 0 between a place where it is not below 0 and one where it is, by the rule of false position (Illinois).
fn zero(mut from: (f64, f64), mut to: (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    let small = PASSED * (from.1 - to.1);
    for _ in 0..8 {
        let at = from.0 + (to.0 - from.0) * from.1 / (from.1 - to.1);
        let here = f(at);
        if here.abs() <= small {
            return at;
        }
        if here < 0.0 {
            to = (at, here);
            from.1 *= 0.5;
        } else {
            from = (at, here);
            to.1 *= 0.5;
        }
    }
    from.0 + (to.0 - from.0) * from.1 / (from.1 - to.1)
}

/// Place of a mode.
fn index(drives: [bool; 2]) -> usize {
    usize::from(drives[0]) + 2 * usize::from(drives[1])
}

/// While v goes to `new` from `old` the other way, v = new - (old + new) exp(-t/tau): the integral of |v| less that of v,
/// over tau; 0 for one that goes no other way.
fn other_way(old: f64, new: f64) -> f64 {
    let (old, new) = (old.max(0.0), new.max(0.0));
    if old == 0.0 {
        return 0.0;
    }
    let until = if new > 0.0 { (old / new).ln_1p() } else { 0.0 };
    2.0 * (old - new * until)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::drivetrain::Drivetrain;
    use crate::identify::wheels::DYNAMIC;

    /// E, D, s of a base of 1 kg, its wheels coupled through the body.
    const DYNAMICS: [f64; DYNAMIC] = [0.05, 0.01, 0.01, 0.05, 0.3, 0.33, 0.4, 0.3];
    const LOSS: [f64; 2] = [0.25, 0.3];
    const SOURCE_OHM: f64 = 0.3;
    const OPEN_V: f64 = 12.0;
    const ALPHA: [f64; 2] = [0.5, 0.45];

    fn wheels(lag: [f64; 2]) -> Wheels {
        let train = Drivetrain {
            lag,
            loss: LOSS,
            band: [0.0; 2],
            source_ohm: SOURCE_OHM,
            drain: 0.0,
        };
        Wheels::new(&DYNAMICS, [0.28, 0.3], ALPHA, train).expect("an inertia")
    }

    /// The equations of this module as they stand, in steps of `dt` of Runge and Kutta's method.
    fn integrated(wheels: &Wheels, state: &State, share: [f64; 2], h: f64, dt: f64) -> State {
        let rates = |w: Vector2<f64>, v: Vector2<f64>| {
            let share = Vector2::from(share);
            let current = v.component_mul(&wheels.alpha);
            let volts = share * (OPEN_V - SOURCE_OHM * share.dot(&current));
            let loss = v.abs().component_mul(&wheels.loss);
            let torque = v - loss - wheels.bearing.component_mul(&w) - wheels.coulomb;
            let follows = volts - wheels.emf.component_mul(&w) - v;
            (
                wheels.per_inertia * torque,
                follows.component_div(&wheels.lag),
            )
        };
        let (mut w, mut v, mut angle) = (state.speed, state.torque, state.angle);
        for _ in 0..(h / dt).round() as usize {
            let (w1, v1) = rates(w, v);
            let (w2, v2) = rates(w + 0.5 * dt * w1, v + 0.5 * dt * v1);
            let (w3, v3) = rates(w + 0.5 * dt * w2, v + 0.5 * dt * v2);
            let (w4, v4) = rates(w + dt * w3, v + dt * v3);
            let from = w;
            w += dt / 6.0 * (w1 + 2.0 * (w2 + w3) + w4);
            v += dt / 6.0 * (v1 + 2.0 * (v2 + v3) + v4);
            angle += 0.5 * dt * (from + w);
        }
        State {
            angle,
            speed: w,
            torque: v,
        }
    }

    /// Rows whose motors drive, brake, and turn from one to the other fast, slowly, both at once and there and back.
    #[test]
    fn rows_are_those_of_the_differential_equation() {
        let shares = [
            [0.6, 0.6],
            [0.5, 0.2],
            [0.1, 0.5],
            [0.45, 0.12],
            [0.3, 0.3],
            [0.27, 0.28],
            [0.6, 0.05],
            [0.1, 0.6],
            [0.24, 0.26],
        ];
        let h = 0.005;
        for lag in [[5.0e-4, 6.0e-4], [2.0e-4, 1.0e-4]] {
            let wheels = wheels(lag);
            let mut course = Vec::new();
            let mut ride = Ride::new(&wheels, [1.0; 2], &mut course);
            let feed = |share| Feed::unloaded(share, OPEN_V);
            let start = ride.settled(Vector2::zeros(), Vector2::new(10.0, 9.0), &feed(shares[0]));
            let mut state = start.expect("a system").0;
            let mut turned = 0;
            for share in shares.into_iter().cycle().take(90) {
                let exact = integrated(&wheels, &state, share, h, 1.0e-6);
                state = ride
                    .row::<false>(state, &feed(share), h)
                    .expect("a system")
                    .0;
                // The square of `PASSED`, of tens of radians per second.
                let off = [
                    (state.angle - exact.angle).amax() / h,
                    (state.speed - exact.speed).amax(),
                    (state.torque - exact.torque).amax(),
                ];
                assert!(
                    off.iter().all(|off| *off < 1.0e-6),
                    "{lag:?}, {share:?}: {off:?}"
                );
            }
            for course in &course {
                turned += course.turns.iter().flatten().count();
            }
            assert!(turned > 60, "{turned}");
        }
    }
}
