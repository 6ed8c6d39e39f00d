//! One wheel: stuck, reversed, slipping.

use super::debounce::Debounce;
use crate::safety::detector_params::{LEAST_COUNTS, SLOW, Timeout, ValidDetectorParams, WINDOW};
use crate::scalar::{Scalar, residue, seconds};

/// Without a count for so long a wheel stands: half of the window, for one that moves by half of
/// [`LEAST_COUNTS`] in it has counted.
const MOVED_WITHIN: Timeout = Timeout::AfterUs(50_000);
/// Without a count for so long its encoder may be what turns the other wheel against its torque: a window more, in which that shows.
/// A wheel that only changes its direction counts again before.
const CEASED_BEFORE: Timeout = Timeout::AfterUs(150_000);

/// Of a wheel that stands or turns back, so much more slowly its time counts while it is pushed the way that it is commanded with less than what
/// turns a free one: friction that is compensated on top moves light bases, whose law never asks for as much.
const HARDLY_PUSHED: u32 = 4;

/// What a wheel exerted since it was looked at last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Effort<T> {
    /// Torque times time \[N m s\].
    pub(super) impulse: T,
    /// Speed by the torques of both wheels \[rad/s\].
    pub(super) gained: T,
}

/// What a look knows of one wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Look<T> {
    /// Time since the last one.
    pub(super) us: u32,
    /// Counts since then; `None` without a reading now or ever before.
    pub(super) moved: Option<i32>,
    /// `None` where torques are not known.
    pub(super) effort: Option<Effort<T>>,
    /// Speed commanded \[rad/s\].
    pub(super) command: T,
    /// Its speed by the encoders less that by an outside twist, where there is one \[m/s\].
    pub(super) off: Option<T>,
}

impl<T: Scalar> Look<T> {
    /// Counts `moved`, the way that it is commanded to turn.
    fn along(&self, moved: i32) -> i32 {
        if self.command > T::ZERO {
            moved
        } else {
            moved.saturating_neg()
        }
    }

    /// It counts the way that it is commanded to turn.
    fn runs_ahead(&self) -> bool {
        self.moved.is_some_and(|moved| self.along(moved) > 0)
    }

    /// It counts the other way than it is commanded to turn.
    fn runs_back(&self) -> bool {
        self.command.abs() > T::ZERO && self.moved.is_some_and(|moved| self.along(moved) < 0)
    }
}

/// Commanded to turn at some speed.
#[inline(always)]
fn is_commanded<T: Scalar>(settings: &ValidDetectorParams<T>, command: T) -> bool {
    command.abs() >= settings.params.wheels.stuck.speed_rad_s
}

/// What a look shows of a wheel, a bit each: something that a fault may come of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Signs(u8);

impl Signs {
    /// It stands though it is pushed.
    const STANDS: u8 = 1;
    /// It is accelerated against its torque.
    const ACCELERATED: u8 = 2;
    /// It turns against command and torque.
    const TURNED: u8 = 4;
    const SLIPS: u8 = 8;

    /// There are none.
    pub(super) const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Both of two wheels.
    pub(super) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// A sign is shown now, or is not.
    #[inline(always)]
    const fn show(&mut self, shown: bool, sign: u8) {
        self.0 = if shown { self.0 | sign } else { self.0 & !sign };
    }

    const fn has(self, sign: u8) -> bool {
        self.0 & sign != 0
    }
}

/// What was found out about a wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct WheelDetections {
    pub(super) stuck: bool,
    pub(super) blocked: bool,
    /// It was accelerated against its torque, or turned against command and torque.
    pub(super) against: bool,
    /// It was sped up against its torque, or turned against command and torque.
    pub(super) reversed: bool,
    /// It has not counted for half a window,
    pub(super) silent: bool,
    /// though it is commanded to turn,
    pub(super) dead: bool,
    /// and has not since before what the other wheel does now.
    pub(super) ceased: bool,
    pub(super) slips: bool,
}

/// Two equal filters in a row, by the implicit Euler step: stable for any tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Twice<T> {
    first: T,
    second: T,
}

impl<T: Scalar> Twice<T> {
    /// (s/(s + a))² of an input that moved by `step`; `shrink` = 1/(1 + a dt).
    fn high_pass(&self, step: T, shrink: T) -> Self {
        let first = (self.first + step) * shrink;
        let second = (self.second + (first - self.first)) * shrink;
        Self { first, second }
    }

    /// 1/(s + a)² of an input of which that is the integral over the step `dt`.
    fn low_pass(&self, integral: T, dt: T, shrink: T) -> Self {
        let first = (self.first + integral) * shrink;
        let second = (self.second + first * dt) * shrink;
        Self { first, second }
    }

    /// The low-pass under a constant input that settled at `output`.
    fn settled(output: T, a: T) -> Self {
        Self {
            first: a * output,
            second: output,
        }
    }

    /// Wild inputs are forgotten instead of kept.
    fn or_zero(self) -> Self {
        if self.residue() == T::ZERO {
            self
        } else {
            Self::default()
        }
    }

    fn residue(&self) -> T {
        residue([self.first, self.second])
    }
}

/// Detectors of one wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wheel<T> {
    /// y \[rad\].
    seen: Twice<T>,
    /// x \[rad\].
    expected: Twice<T>,
    pushed: Pushed,
    /// Time without a count.
    silent: Debounce,
    against: Debounce,
    beyond: Debounce,
    /// The last reading of its encoder.
    count: Option<i32>,
    /// Of the last look.
    pub(super) signs: Signs,
}

/// What becomes of a wheel that is commanded to turn at some speed, with a torque that way which turns a free one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Pushed {
    /// Counts since it began to stand still.
    crept: i32,
    /// Counts since it began to turn against command and torque, below zero.
    back: i32,
    stands: Debounce,
    backs: Debounce,
    /// Stands or turns back, not pushed hard enough.
    hardly: Debounce,
}

impl<T: Scalar> Wheel<T> {
    /// Counts since the last look, of a wheel whose encoder now gives `count`.
    #[inline(always)]
    pub(super) fn moved(&mut self, count: Option<i32>) -> Option<i32> {
        let moved = match (count, self.count) {
            (Some(now), Some(last)) => Some(now.wrapping_sub(last)),
            _ => None,
        };
        if count.is_some() {
            self.count = count;
        }
        moved
    }

    /// A look at it, whole: its signs are those of now.
    #[inline(always)]
    pub(super) fn advance(&mut self, settings: &ValidDetectorParams<T>, now: &Look<T>) {
        self.push(settings, now);
        self.filter(settings, now);
        self.compare(settings, now);
    }

    /// The first part of a look: whether it moves, and as it is pushed.
    #[inline(always)]
    pub(super) fn push(&mut self, settings: &ValidDetectorParams<T>, now: &Look<T>) {
        let stuck = &settings.params.wheels.stuck;
        let (stands, turned) = match now.effort {
            Some(effort)
                if is_commanded(settings, now.command)
                    && effort.impulse.abs() >= settings.pushed_nm * seconds(now.us) =>
            {
                self.pushed.advance(stuck.after, effort.impulse, now)
            }
            Some(_) if stuck.torque_nm == T::ZERO => {
                let Look {
                    us, moved, command, ..
                } = *now;
                self.pushed.advance_by_way(settings, us, moved, command)
            }
            Some(effort) if is_commanded(settings, now.command) && !now.runs_ahead() => {
                self.pushed.hardly(stuck.after, effort.impulse, now)
            }
            _ => self.pushed.not(),
        };
        let still = now.moved.is_none_or(|counts| counts == 0);
        self.silent.count(still, now.us);
        self.signs.show(stands, Signs::STANDS);
        self.signs.show(turned, Signs::TURNED);
    }

    /// The last part: what is seen against what is expected.
    #[inline(always)]
    pub(super) fn compare(&mut self, settings: &ValidDetectorParams<T>, now: &Look<T>) {
        let compared = self.compared();
        // Counts that are missing are not counts that stand still.
        let accelerated = self.moves_against(settings, compared, now.us) && now.moved.is_some();
        let slips = self.moves_beyond(settings, compared, now);
        self.signs.show(accelerated, Signs::ACCELERATED);
        self.signs.show(slips, Signs::SLIPS);
    }

    /// What its signs mean, with what is remembered, where it is commanded to turn at `command` \[rad/s\] and turns at `outside` by
    /// an outside twist.
    pub(super) fn detections(
        &self,
        settings: &ValidDetectorParams<T>,
        command: T,
        outside: Option<T>,
    ) -> WheelDetections {
        let has = |sign| self.signs.has(sign);
        let (stands, slips) = (has(Signs::STANDS), has(Signs::SLIPS));
        let (accelerated, turned) = (has(Signs::ACCELERATED), has(Signs::TURNED));
        let slow = T::HALF * settings.params.wheels.stuck.speed_rad_s;
        let blocked = stands && outside.is_some_and(|speed| speed.abs() < slow);
        let silent = self.silent.has_lasted(MOVED_WITHIN);
        let commanded = is_commanded(settings, command);
        WheelDetections {
            stuck: stands && !blocked,
            blocked,
            against: accelerated || turned,
            reversed: (accelerated && self.turns_against()) || turned,
            silent,
            dead: silent && commanded,
            ceased: commanded && self.silent.has_lasted(CEASED_BEFORE),
            slips,
        }
    }

    /// The part in the middle: what is seen and what is expected.
    #[inline(always)]
    pub(super) fn filter(&mut self, settings: &ValidDetectorParams<T>, now: &Look<T>) {
        let dt = seconds::<T>(now.us);
        let shrink = T::ONE / (T::ONE + T::from_f64(WINDOW) * dt);
        let step = T::from_i32(now.moved.unwrap_or(0)) * settings.per_count;
        let seen = self.seen.high_pass(step, shrink);
        let expected = match now.effort {
            Some(effort) => self.expected.low_pass(effort.gained, dt, shrink),
            None => Twice::settled(seen.or_zero().second, T::from_f64(WINDOW)),
        };
        (self.seen, self.expected) = (seen, expected);
        if seen.residue() + expected.residue() != T::ZERO {
            (self.seen, self.expected) = (seen.or_zero(), expected.or_zero());
        }
    }

    /// y sgn x ≤ −|x|/2 where |x| is at least 2 D and 8 counts; see the [module](super).
    #[inline(always)]
    fn moves_against(
        &mut self,
        settings: &ValidDetectorParams<T>,
        (expected, along): (T, T),
        dt_us: u32,
    ) -> bool {
        let load = settings.load_travel;
        let enough = expected >= load + load && expected >= settings.least_travel;
        // An encoder that dies on the way looks like braking against the torque: while it may be found stuck,
        // this waits.
        let against =
            enough && along <= -(T::HALF * expected) && self.pushed.stands == Debounce::NONE;
        self.against
            .holds(against, dt_us, settings.params.wheels.reversed)
    }

    /// s/(s + a) φ sgn x < 0: by its counts of the window the wheel turns against its torque.
    fn turns_against(&self) -> bool {
        let speed = self.seen.first;
        if self.expected.second < T::ZERO {
            speed > T::ZERO
        } else {
            speed < T::ZERO
        }
    }

    /// y sgn x > 2 |x| + S/a² with the torque pushing that way by at least half the load (without torque it
    /// is a push from outside), or the outside twist says so.
    ///
    /// A wheel with grip moves the whole robot, as x expects; one without moves only itself, and a wheel is
    /// lighter than half a robot by far. Twice |x| forgives a robot that is half as heavy as stated. A wheel that slips is driven at
    /// its command all the same, and counts: an encoder that dies, or whose sign changes, while its wheel brakes is another fault's.
    #[inline(always)]
    fn moves_beyond(
        &mut self,
        settings: &ValidDetectorParams<T>,
        (expected, along): (T, T),
        now: &Look<T>,
    ) -> bool {
        let slip = &settings.params.wheels.slip;
        let pushed = expected >= T::HALF * settings.load_travel;
        let most = expected + expected + settings.slip_travel;
        let slid = |off: T| off.abs() > slip.speed_m_s;
        let runs = || !self.silent.has_lasted(MOVED_WITHIN) && !now.runs_back();
        let beyond = (pushed && along > most && runs()) || now.off.is_some_and(slid);
        self.beyond.holds(beyond, now.us, slip.after)
    }

    /// |x| and y sgn x.
    #[inline(always)]
    fn compared(&self) -> (T, T) {
        let (x, y) = (self.expected.second, self.seen.second);
        if x < T::ZERO { (-x, -y) } else { (x, y) }
    }
}

impl Pushed {
    /// Not pushed: neither does it stand nor turn back.
    #[inline(always)]
    fn not(&mut self) -> (bool, bool) {
        *self = Self::default();
        (false, false)
    }

    /// Pushed hard enough; whether it stands, and whether it turns back.
    #[inline(always)]
    fn advance<T: Scalar>(&mut self, after: Timeout, push: T, now: &Look<T>) -> (bool, bool) {
        let forward = now.command > T::ZERO;
        // Without a reading the wheel is not known to stand or to turn; that is a fault of its own.
        let moved = now.moved.filter(|_| forward == (push > T::ZERO));
        let Some(moved) = moved else {
            return self.not();
        };
        let stands = self.stands_still(moved, now.us, after);
        (stands, self.turns_back(now.along(moved), now.us, after))
    }

    /// Not pushed hard enough, and without a count the way that it is commanded: where it is pushed that way, it stands, or turns back by at least
    /// [`LEAST_COUNTS`].
    #[cold]
    #[inline(never)]
    fn hardly<T: Scalar>(&mut self, after: Timeout, push: T, now: &Look<T>) -> (bool, bool) {
        let moved = now.moved.filter(|_| push * now.command > T::ZERO);
        let Some(moved) = moved else {
            return self.not();
        };
        *self = Self {
            hardly: self.hardly,
            back: self.back.saturating_add(now.along(moved)),
            ..Self::default()
        };
        let lasts = self.hardly.holds(true, now.us / HARDLY_PUSHED, after);
        let turns = self.back <= -LEAST_COUNTS;
        (lasts && !turns, lasts && turns)
    }

    /// Of a driver that closes its own speed loop, which pushes the way that it is commanded: the slower that is, the less of the time counts. See [`SLOW`].
    #[cold]
    #[inline(never)]
    fn advance_by_way<T: Scalar>(
        &mut self,
        settings: &ValidDetectorParams<T>,
        us: u32,
        moved: Option<i32>,
        command: T,
    ) -> (bool, bool) {
        if !is_commanded(settings, command) {
            return self.not();
        }
        let stuck = &settings.params.wheels.stuck;
        let share = command.abs() / (T::from_f64(SLOW) * stuck.speed_rad_s);
        let counts = if share < T::ONE {
            (share * T::from_u32(us)).to_u32()
        } else {
            us
        };
        let now = Look {
            us: counts,
            moved,
            command,
            ..Look::default()
        };
        self.advance(stuck.after, command, &now)
    }

    /// No more than one count to and fro (the edge on which an encoder may tremble) all the while. A wheel
    /// that holds a place is not commanded to turn and never counts.
    #[inline(always)]
    fn stands_still(&mut self, moved: i32, us: u32, after: Timeout) -> bool {
        let crept = self.crept.saturating_add(moved);
        let still = (-1..=1).contains(&crept);
        self.crept = if still { crept } else { 0 };
        if !still {
            self.hardly = Debounce::NONE;
        }
        self.stands.holds(still, us, after)
    }

    /// At least [`LEAST_COUNTS`] the other way all the while, none the way that it is pushed.
    ///
    /// Bridges that feed the back-EMF forward give a reversed wheel less torque the faster it turns: it goes at a steady
    /// speed, and no acceleration shows it. A sound wheel is turned back only by more than it is pushed with, three times the
    /// load; one that still rolls back is braked by what the torque is above the load, twice the load, for all the time.
    #[inline(always)]
    fn turns_back(&mut self, along: i32, us: u32, after: Timeout) -> bool {
        if along > 0 {
            (self.back, self.backs) = (0, Debounce::NONE);
            return false;
        }
        self.back = self.back.saturating_add(along);
        self.backs.holds(true, us, after) && self.back <= -LEAST_COUNTS
    }
}

#[cfg(test)]
impl<T: Scalar> Wheel<T> {
    pub(super) fn seen_is_finite(&self) -> bool {
        [self.seen, self.expected]
            .iter()
            .all(|filter| filter.first.is_finite() && filter.second.is_finite())
    }

    /// y and x.
    pub(super) fn seen_and_expected(&self) -> (T, T) {
        (self.seen.second, self.expected.second)
    }
}

#[cfg(test)]
mod tests {
    use super::{Debounce, Effort, Look, MOVED_WITHIN, Pushed, Signs, Twice, Wheel};
    use crate::safety::detector_params::{Timeout, ValidDetectorParams};
    use crate::safety::monitor::tests::params;

    /// Longer than any timeout.
    const LONG_US: u32 = 10_000_000;

    /// With travels that differ enough.
    fn settings() -> ValidDetectorParams<f64> {
        let mut settings = params().validate().expect("valid");
        settings.load_travel = 0.3;
        settings.least_travel = 0.1;
        settings.slip_travel = 0.2;
        settings
    }

    /// A wheel that moved by `seen` where `expected` was.
    fn wheel(expected: f64, seen: f64) -> Wheel<f64> {
        let second = |second| Twice { first: 0.0, second };
        Wheel {
            expected: second(expected),
            seen: second(seen),
            ..Wheel::default()
        }
    }

    fn look() -> Look<f64> {
        Look {
            us: LONG_US,
            moved: Some(0),
            ..Look::default()
        }
    }

    /// Against its torque by half of what is expected, where that is twice what the load accounts for and no less than the least.
    #[test]
    fn a_wheel_is_accelerated_against_its_torque_from_half_of_what_is_expected_on() {
        let mut settings = settings();
        for (least, most) in [(0.1, 0.6), (0.7, 0.7)] {
            settings.least_travel = least;
            let against = |expected: f64, seen: f64| {
                let mut wheel = wheel(expected, seen);
                let compared = wheel.compared();
                wheel.moves_against(&settings, compared, LONG_US)
            };
            for sign in [1.0, -1.0] {
                let (more, less) = (1.001 * sign * most, 0.999 * sign * most);
                assert!(against(more, -0.501 * more), "{least} {sign}");
                assert!(!against(more, -0.499 * more) && !against(more, 0.501 * more));
                assert!(!against(less, -less), "{least} {sign}");
            }
        }
        // While it may be found stuck this waits.
        let mut wheel = wheel(1.0, -1.0);
        let compared = wheel.compared();
        wheel.pushed.stands.count(true, 1);
        assert!(!wheel.moves_against(&settings, compared, LONG_US));
    }

    #[test]
    fn a_wheel_turns_against_its_torque_by_its_counts_of_the_window() {
        for (expected, speed, against) in [
            (1.0, -0.1, true),
            (1.0, 0.1, false),
            (-1.0, 0.1, true),
            (-1.0, -0.1, false),
            (-1.0, 0.0, false),
            (1.0, 0.0, false),
        ] {
            let mut wheel = wheel(expected, 0.0);
            wheel.seen.first = speed;
            assert_eq!(wheel.turns_against(), against, "{expected} {speed}");
        }
    }

    /// Beyond twice what is expected and the slip's own way, pushed by half the load at least, counting, and not run back; or faster than
    /// an outside twist says.
    #[test]
    fn a_wheel_slips_beyond_what_its_torque_explains() {
        let settings = settings();
        let beyond = |expected: f64, seen: f64, silent_us: u32, now: &Look<f64>| {
            let mut wheel = wheel(expected, seen);
            wheel.silent.count(true, silent_us);
            let compared = wheel.compared();
            wheel.moves_beyond(&settings, compared, now)
        };
        let now = look();
        for sign in [1.0, -1.0] {
            assert!(beyond(0.151 * sign, 0.503 * sign, 0, &now));
            assert!(!beyond(0.151 * sign, 0.501 * sign, 0, &now), "too little");
            assert!(!beyond(0.149 * sign, 0.9 * sign, 0, &now), "not pushed");
            assert!(!beyond(0.151 * sign, -0.9 * sign, 0, &now), "the other way");
        }
        let Timeout::AfterUs(silent) = MOVED_WITHIN else {
            panic!("a time");
        };
        assert!(beyond(0.2, 1.0, silent - 1, &now) && !beyond(0.2, 1.0, silent, &now));
        let back = Look {
            command: 1.0,
            moved: Some(-1),
            ..now
        };
        assert!(!beyond(0.2, 1.0, 0, &back));
        let most = settings.params.wheels.slip.speed_m_s;
        for off in [most, -most] {
            let off = |share: f64| Look {
                off: Some(share * off),
                ..now
            };
            assert!(beyond(0.0, 0.0, 0, &off(1.001)) && !beyond(0.0, 0.0, 0, &off(0.999)));
        }
    }

    /// A wheel that stands though it is pushed is blocked where an outside twist says that it does stand, by half of the speed that it is
    /// commanded.
    #[test]
    fn a_wheel_that_stands_is_blocked_where_the_robot_does() {
        let settings = settings();
        let mut wheel = wheel(0.0, 0.0);
        wheel.signs.show(true, Signs::STANDS);
        let half = 0.5 * settings.params.wheels.stuck.speed_rad_s;
        for (outside, blocked) in [
            (Some(0.99 * half), true),
            (Some(-0.99 * half), true),
            (Some(1.01 * half), false),
            (Some(-1.01 * half), false),
            (None, false),
        ] {
            let found = wheel.detections(&settings, 1.0, outside);
            assert_eq!(
                (found.blocked, found.stuck),
                (blocked, !blocked),
                "{outside:?}"
            );
        }
    }

    /// What is pushed, not pushed for a look, and pushed again stands from then on.
    #[test]
    fn a_wheel_that_was_not_pushed_meanwhile_begins_anew() {
        let mut pushed = Pushed::default();
        let now = Look {
            us: 600,
            moved: Some(0),
            command: 1.0,
            ..Look::default()
        };
        let after = Timeout::AfterUs(1000);
        assert_eq!(pushed.advance(after, 1.0, &now), (false, false));
        assert_eq!(pushed.not(), (false, false));
        assert_eq!(pushed.stands, Debounce::NONE);
        assert_eq!(pushed.advance(after, 1.0, &now), (false, false));
        assert_eq!(pushed.advance(after, 1.0, &now), (true, false));
        // Nor by an effort against the command.
        assert_eq!(pushed.advance(after, -1.0, &now), (false, false));
        assert_eq!(pushed.stands, Debounce::NONE);
    }

    /// Without torques what is expected is what is seen, for as long; with them it is what they explain.
    #[test]
    fn without_torques_what_is_seen_is_expected() {
        let settings = settings();
        let mut wheel = Wheel::default();
        let now = Look {
            us: 10_000,
            moved: Some(100),
            ..Look::default()
        };
        wheel.filter(&settings, &now);
        let (seen, expected) = wheel.seen_and_expected();
        assert!(seen > 0.1 && seen == expected, "{seen} {expected}");
        let driven = Look {
            effort: Some(Effort {
                impulse: 1.0,
                gained: 0.5,
            }),
            ..now
        };
        let mut driven_wheel = wheel;
        driven_wheel.filter(&settings, &driven);
        wheel.filter(&settings, &now);
        assert_eq!(driven_wheel.seen, wheel.seen);
        assert_ne!(driven_wheel.expected, wheel.expected);
    }

    /// 1/(s + a)² of a² y is y: with any tick a filter that settled at y stays there.
    #[test]
    fn a_settled_filter_stays_where_it_is() {
        for (output, a) in [(0.3_f64, 5.0), (-2.0, 0.4)] {
            for dt in [1e-4, 1e-2, 0.5] {
                let settled = Twice::settled(output, a);
                let next = settled.low_pass(a * a * output * dt, dt, 1.0 / (1.0 + a * dt));
                assert!((next.second - output).abs() < 1e-15 * output.abs() * 10.0);
                assert!((next.first - a * output).abs() < 1e-14);
            }
        }
    }
}
