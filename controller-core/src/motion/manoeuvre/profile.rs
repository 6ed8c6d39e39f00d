//! Motion of one axis from rest to rest, and from motion to rest, with limited jerk.

use crate::maths::Maths;
use crate::range::signed;
use crate::scalar::Scalar;

/// What one axis of a manoeuvre may use: metres and seconds for driving, radians and seconds for turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisLimits<T> {
    /// Largest rate.
    pub(crate) rate: T,
    /// Largest acceleration away from rest.
    pub(crate) up: T,
    /// Largest deceleration towards rest.
    pub(crate) down: T,
    /// Time in which the larger of the two is reached at the largest jerk \[s\].
    pub(crate) jerk_s: T,
}

/// How exactly a motion is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// To choose among manoeuvres: a ramp is a step of the acceleration up and one down again, each where half of its jerk time is over.
    /// It leads as far, and the place is off by τ²/24 of the acceleration meanwhile.
    Rough,
    /// To drive one.
    Fine,
}

/// Position, rate and acceleration of an axis at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AxisSample<T> {
    pub(crate) position: T,
    pub(crate) rate: T,
    pub(crate) accel: T,
}

/// A change of rate from 0 to 1: acceleration rises and falls linearly over `jerk_s` each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp<T> {
    duration: T,
    jerk_s: T,
}

impl<T: Scalar> Ramp<T> {
    /// Integral, value and slope at `t`, for −∞ < t < ∞.
    ///
    /// With τ the jerk time and a = 1/(T − τ): a t²/(2τ) first, a (t − τ/2) then, mirrored at the end.
    #[inline(always)]
    fn at(&self, t: T) -> AxisSample<T> {
        let (duration, rise) = (self.duration, self.jerk_s);
        if t <= T::ZERO {
            return AxisSample::default();
        }
        if t >= duration {
            return self.end(t);
        }
        let slope = T::ONE / (duration - rise);
        let third = T::from_f64(1.0 / 3.0);
        let left = duration - t;
        let corner = |t: T| {
            let accel = slope * t / rise;
            let rate = T::HALF * accel * t;
            AxisSample {
                position: third * rate * t,
                rate,
                accel,
            }
        };
        if t < rise {
            corner(t)
        } else if left < rise {
            let AxisSample {
                position,
                rate,
                accel,
            } = corner(left);
            AxisSample {
                position: T::HALF * duration - left + position,
                rate: T::ONE - rate,
                accel,
            }
        } else {
            let past = t - T::HALF * rise;
            let sixth = T::HALF * third;
            AxisSample {
                // a τ²/24 is what the corner adds to that of a straight ramp.
                position: T::HALF * slope * (past * past + sixth * T::HALF * rise * rise),
                rate: slope * past,
                accel: slope,
            }
        }
    }

    /// At its end and behind it.
    fn end(&self, t: T) -> AxisSample<T> {
        AxisSample {
            position: t - T::HALF * self.duration,
            rate: T::ONE,
            accel: T::ZERO,
        }
    }
}

/// A motion from rest to rest: up to a rate, on with it, and down again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Profile<T> {
    /// When it starts \[s\].
    pub(crate) start: T,
    /// Signed.
    pub(crate) peak: T,
    /// Duration of the ramp up \[s\].
    pub(crate) rise: T,
    /// Time at the peak \[s\].
    pub(crate) hold: T,
    /// Duration of the ramp down \[s\].
    pub(crate) fall: T,
    jerk_s: T,
}

impl<T: Scalar> AxisLimits<T> {
    /// Shortest ramp to `rate` ≥ 0 with this acceleration.
    ///
    /// The jerk time is the same for every ramp: below a τ the acceleration is less, not the time.
    fn ramp(&self, rate: T, accel: T) -> T {
        let straight = rate / accel;
        self.jerk_s
            + if straight > self.jerk_s {
                straight
            } else {
                self.jerk_s
            }
    }

    /// The quickest motion over `distance`, from rest to rest, starting at 0.
    ///
    /// The peak rate v solves |s| = v/2 (R_u(v) + R_d(v)), R_a(v) = max(v/a, τ) + τ:
    ///
    /// | | v |
    /// | --- | --- |
    /// | both ramps reach their acceleration | (−τ + √(τ² + 2 c \|s\|))/c, c = 1/u + 1/d |
    /// | only the weaker one (l) does | l (−3τ/2 + √(9τ²/4 + 2 \|s\|/l)) |
    /// | neither does | \|s\|/(2τ) |
    pub(crate) fn profile<M: Maths<T>>(&self, distance: T) -> Profile<T> {
        let f = T::from_f64;
        let (way, tau) = (distance.abs(), self.jerk_s);
        if way == T::ZERO {
            return Profile::default();
        }
        let (low, high) = if self.up < self.down {
            (self.up, self.down)
        } else {
            (self.down, self.up)
        };
        let c = T::ONE / self.up + T::ONE / self.down;
        let mut peak = (M::sqrt(tau * tau + c * (way + way)) - tau) / c;
        if peak < high * tau {
            let root = M::sqrt(f(2.25) * tau * tau + (way + way) / low);
            peak = low * (root - f(1.5) * tau);
            if peak < low * tau {
                peak = way / (tau + tau);
            }
        }
        let capped = peak > self.rate;
        if capped {
            peak = self.rate;
        }
        let (rise, fall) = (self.ramp(peak, self.up), self.ramp(peak, self.down));
        let hold = if capped {
            way / peak - T::HALF * (rise + fall)
        } else {
            T::ZERO
        };
        Profile {
            start: T::ZERO,
            peak: signed(peak, distance),
            rise,
            hold,
            fall,
            jerk_s: tau,
        }
    }

    /// From a rate and an acceleration to rest, from 0 on: the acceleration fades first, at the largest jerk.
    pub(crate) fn stop(&self, rate: T, accel: T) -> Stop<T> {
        let largest = if self.up > self.down {
            self.up
        } else {
            self.down
        };
        let fade = accel.abs() * self.jerk_s / largest;
        let faded = rate + T::HALF * accel * fade;
        Stop {
            rate,
            accel,
            fade,
            faded,
            hold: T::ZERO,
            ramp: Ramp {
                duration: if faded == T::ZERO {
                    T::ZERO
                } else {
                    self.ramp(faded.abs(), self.down)
                },
                jerk_s: self.jerk_s,
            },
        }
    }
}

impl<T: Scalar> Profile<T> {
    /// Nothing moves.
    pub(crate) fn is_empty(&self) -> bool {
        self.peak == T::ZERO
    }

    /// How long it takes \[s\].
    pub(crate) fn duration(&self) -> T {
        self.rise + self.hold + self.fall
    }

    /// When it ends \[s\]; 0 for one that moves nothing.
    pub(crate) fn end(&self) -> T {
        if self.is_empty() {
            T::ZERO
        } else {
            self.start + self.duration()
        }
    }

    /// The same way on a clock that is slower by this factor.
    pub(crate) fn slowed(self, by: T) -> Self {
        Self {
            start: by * self.start,
            peak: self.peak / by,
            rise: by * self.rise,
            hold: by * self.hold,
            fall: by * self.fall,
            jerk_s: by * self.jerk_s,
        }
    }

    #[cfg(test)]
    pub(crate) fn cast_for_test(&self) -> Profile<f64> {
        Profile {
            start: self.start.to_f64(),
            peak: self.peak.to_f64(),
            rise: self.rise.to_f64(),
            hold: self.hold.to_f64(),
            fall: self.fall.to_f64(),
            jerk_s: self.jerk_s.to_f64(),
        }
    }

    /// At time `t`, before, within and after it.
    pub(crate) fn at(&self, t: T) -> AxisSample<T> {
        if self.is_empty() {
            return AxisSample::default();
        }
        let t = t - self.start;
        if t < self.rise {
            let up = self.ramp(self.rise).at(t);
            return AxisSample {
                position: self.peak * up.position,
                rate: self.peak * up.rate,
                accel: self.peak * up.accel,
            };
        }
        let held = t - T::HALF * self.rise;
        let down = self.ramp(self.fall).at(t - self.rise - self.hold);
        AxisSample {
            position: self.peak * (held - down.position),
            rate: self.peak * (T::ONE - down.rate),
            accel: -(self.peak * down.accel),
        }
    }

    fn ramp(&self, duration: T) -> Ramp<T> {
        Ramp {
            duration,
            jerk_s: self.jerk_s,
        }
    }
}

/// A stretch of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece<T> {
    from: T,
    position: T,
    rate: T,
    half_accel: T,
    sixth_jerk: T,
}

impl<T: Scalar> Piece<T> {
    const fn rest(from: T, position: T) -> Self {
        Self {
            from,
            position,
            rate: T::ZERO,
            half_accel: T::ZERO,
            sixth_jerk: T::ZERO,
        }
    }

    pub(crate) fn position(&self, t: T) -> T {
        let t = t - self.from;
        self.position + t * (self.rate + t * (self.half_accel + t * self.sixth_jerk))
    }

    pub(crate) fn rate(&self, t: T) -> T {
        let t = t - self.from;
        let (b, c) = (self.half_accel, self.sixth_jerk);
        self.rate + t * (b + b + t * (c + c + c))
    }

    /// The way from h before `middle` to h behind it, which one stretch covers: 2 h (v + j h²/6), v the rate in the middle.
    pub(crate) fn way(&self, middle: T, half: T) -> T {
        let way = half * (self.rate(middle) + self.sixth_jerk * half * half);
        way + way
    }

    fn accel(&self, t: T) -> T {
        let half = self.half_accel + three::<T>() * self.sixth_jerk * (t - self.from);
        half + half
    }

    #[inline(always)]
    fn at(&self, t: T) -> AxisSample<T> {
        // Horner's scheme, on its own quotients for the derivatives.
        let Self {
            mut position,
            mut rate,
            mut half_accel,
            sixth_jerk,
            ..
        } = *self;
        let t = t - self.from;
        half_accel += t * sixth_jerk;
        rate += t * half_accel;
        position += t * rate;
        half_accel += t * sixth_jerk;
        rate += t * half_accel;
        half_accel += t * sixth_jerk;
        AxisSample {
            position,
            rate,
            accel: half_accel + half_accel,
        }
    }

    /// The stretch that follows at `t`, with this rate.
    fn held(&self, t: T, rate: T) -> Self {
        Self {
            rate,
            ..Self::rest(t, self.position(t))
        }
    }

    /// The stretch that follows at `t`, in which the rate changes by `by` over `ramp` \[s\], with one acceleration.
    fn accelerating(&self, t: T, by: T, ramp: T) -> Self {
        let last = self.at(t);
        Self {
            from: t,
            position: last.position,
            rate: last.rate,
            half_accel: T::HALF * by / ramp,
            sixth_jerk: T::ZERO,
        }
    }

    /// The stretch that follows at `t`, with another jerk.
    fn onward(&self, t: T, sixth_jerk: T) -> Self {
        let AxisSample {
            position,
            rate,
            accel,
        } = self.at(t);
        Self {
            from: t,
            position,
            rate,
            half_accel: T::HALF * accel,
            sixth_jerk,
        }
    }
}

fn three<T: Scalar>() -> T {
    T::ONE + T::ONE + T::ONE
}

/// Two profiles, one after the other, as stretches of constant jerk. They are lent: the same ones to every call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pieces<T> {
    /// Which of the two is next, or under way; 2 behind both.
    pub(crate) number: u8,
    /// Stretches of it that have begun.
    begun: u8,
    /// The present stretch,
    pub(crate) piece: Piece<T>,
    /// and when it ends; [`Scalar::MAX`] for the last.
    pub(crate) until: T,
}

impl<T: Scalar> Pieces<T> {
    /// Stretches of two profiles and what lies between them: so often is there a next one.
    pub(crate) const MOST: u8 = 2 * 8 + 1;

    /// Of two empty profiles.
    const NONE: Self = Self {
        number: 2,
        begun: 0,
        piece: Piece::rest(T::ZERO, T::ZERO),
        until: T::MAX,
    };

    /// From time 0 on.
    pub(crate) fn of(profiles: &[Profile<T>; 2], quality: Quality) -> Self {
        let mut pieces = Self {
            number: 0,
            ..Self::NONE
        };
        pieces.wait(profiles);
        if quality == Quality::Rough {
            pieces.delay(profiles);
        }
        pieces
    }

    /// At rest until the next profile that is not empty.
    fn wait(&mut self, profiles: &[Profile<T>; 2]) {
        self.begun = 0;
        self.until = T::MAX;
        while let Some(profile) = profiles.get(usize::from(self.number)) {
            if !profile.is_empty() {
                self.until = profile.start;
                return;
            }
            self.number += 1;
        }
    }

    /// What moves now; `None` between and behind the profiles.
    pub(crate) fn moving(&self) -> Option<&Piece<T>> {
        (self.begun > 0).then_some(&self.piece)
    }

    /// The next stretch: where the last ended.
    ///
    /// A ramp of duration R and jerk time τ changes the rate by v with the jerk ±v/((R − τ) τ), for τ at its begin and at its end.
    /// Where it ends the rate is known, and no rounding is carried on.
    fn advance(&mut self, profiles: &[Profile<T>; 2]) {
        let Some(profile) = profiles.get(usize::from(self.number)) else {
            return;
        };
        let (from, tau, peak) = (self.until, profile.jerk_s, profile.peak);
        let jerk = |ramp: T| T::from_f64(1.0 / 6.0) * peak / ((ramp - tau) * tau);
        let last = self.piece;
        self.begun += 1;
        let risen = profile.start + profile.rise;
        let (piece, until) = match self.begun {
            1 => (last.onward(from, jerk(profile.rise)), from + tau),
            2 => (last.onward(from, T::ZERO), risen - tau),
            3 => (last.onward(from, -jerk(profile.rise)), risen),
            4 => (last.held(from, peak), risen + profile.hold),
            5 => (last.onward(from, -jerk(profile.fall)), from + tau),
            6 => (last.onward(from, T::ZERO), profile.end() - tau),
            7 => (last.onward(from, jerk(profile.fall)), profile.end()),
            _ => {
                self.piece = Piece::rest(from, last.position(from));
                self.number += 1;
                self.wait(profiles);
                return;
            }
        };
        self.piece = piece;
        self.until = until;
    }

    /// The next stretch of this quality, that of all before.
    pub(crate) fn go_on(&mut self, profiles: &[Profile<T>; 2], quality: Quality) {
        match quality {
            Quality::Rough => self.advance_roughly(profiles),
            Quality::Fine => self.advance(profiles),
        }
    }

    /// The next stretch, with steps of the acceleration.
    fn advance_roughly(&mut self, profiles: &[Profile<T>; 2]) {
        let Some(profile) = profiles.get(usize::from(self.number)) else {
            return;
        };
        let (from, tau, peak) = (self.until, profile.jerk_s, profile.peak);
        let corner = T::HALF * tau;
        let last = self.piece;
        self.begun += 1;
        let risen = profile.start + profile.rise;
        let (piece, until) = match self.begun {
            1 => (
                last.accelerating(from, peak, profile.rise - tau),
                risen - corner,
            ),
            2 => (last.held(from, peak), risen + profile.hold + corner),
            3 => {
                let fall = last.accelerating(from, -peak, profile.fall - tau);
                (fall, profile.end() - corner)
            }
            _ => {
                self.piece = Piece::rest(from, last.position(from));
                self.number += 1;
                self.wait(profiles);
                self.delay(profiles);
                return;
            }
        };
        self.piece = piece;
        self.until = until;
    }

    /// The next profile starts at its first step of the acceleration.
    fn delay(&mut self, profiles: &[Profile<T>; 2]) {
        if let Some(profile) = profiles.get(usize::from(self.number)) {
            self.until += T::HALF * profile.jerk_s;
        }
    }

    /// On to the stretch of the time `t`, which may lie several ahead.
    ///
    /// What a stretch is follows from where the one before it ended, and not from when it was asked for: the way to a time does not
    /// matter.
    #[inline(always)]
    fn go_on_to(&mut self, profiles: &[Profile<T>; 2], t: T) {
        let mut left = Self::MOST;
        while t >= self.until && left > 0 {
            self.advance(profiles);
            left -= 1;
        }
    }
}

/// The motion at the begin, as stretches of constant jerk. It is lent: the same one to every call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StopPieces<T> {
    /// Stretches that have begun.
    begun: u8,
    /// The present one,
    pub(crate) piece: Piece<T>,
    /// and when it ends; [`Scalar::MAX`] once it stands.
    pub(crate) until: T,
}

impl<T: Scalar> StopPieces<T> {
    /// Stretches behind the first: so often is there a next one.
    pub(crate) const MOST: u8 = 6;

    /// Of an axis without motion at the begin.
    const STANDING: Self = Self {
        begun: Self::MOST,
        piece: Piece::rest(T::ZERO, T::ZERO),
        until: T::MAX,
    };

    /// Until time 0 the acceleration is that of the begin.
    pub(crate) fn of(stop: &Stop<T>) -> Self {
        if stop.is_over() {
            return Self::STANDING;
        }
        Self {
            begun: 0,
            piece: Piece {
                rate: stop.rate,
                half_accel: T::HALF * stop.accel,
                ..Piece::rest(T::ZERO, T::ZERO)
            },
            until: T::ZERO,
        }
    }

    fn stands(&self) -> bool {
        self.until >= T::MAX
    }

    /// What moves now; `None` once it stands.
    pub(crate) fn moving(&self) -> Option<&Piece<T>> {
        (self.begun < Self::MOST).then_some(&self.piece)
    }

    /// The next stretch: the acceleration fades, the rate is kept, and a ramp ends it.
    fn advance(&mut self, stop: &Stop<T>) {
        let Ramp { duration, jerk_s } = stop.ramp;
        let (from, last) = (self.until, self.piece);
        let brakes = stop.fade + stop.hold;
        let sixth = |accel: T, over: T| T::from_f64(1.0 / 6.0) * accel / over;
        self.begun += 1;
        let ramp = || sixth(stop.faded / (duration - jerk_s), jerk_s);
        let (piece, until) = match self.begun {
            1 if stop.fade > T::ZERO => {
                (last.onward(from, -sixth(stop.accel, stop.fade)), stop.fade)
            }
            1 | 2 => {
                let kept = Piece {
                    rate: stop.faded,
                    ..Piece::rest(stop.fade, stop.faded_at())
                };
                self.begun = 2;
                (kept, brakes)
            }
            3 if stop.faded != T::ZERO => (last.onward(from, -ramp()), brakes + jerk_s),
            4 => (last.onward(from, T::ZERO), brakes + (duration - jerk_s)),
            5 => (last.onward(from, ramp()), stop.duration()),
            _ => {
                self.begun = Self::MOST;
                (Piece::rest(from, stop.distance()), T::MAX)
            }
        };
        self.piece = piece;
        self.until = until;
    }

    /// As [`Pieces::go_on`]. While the acceleration fades both are the same.
    pub(crate) fn go_on(&mut self, stop: &Stop<T>, quality: Quality) {
        let Ramp { duration, jerk_s } = stop.ramp;
        let (from, corner) = (self.until, T::HALF * jerk_s);
        self.advance(stop);
        if quality == Quality::Fine || stop.faded == T::ZERO {
            return;
        }
        match self.begun {
            2 => self.until += corner,
            3 => {
                self.begun = 5;
                self.piece = self
                    .piece
                    .accelerating(from, -stop.faded, duration - jerk_s);
                self.until = stop.duration() - corner;
            }
            _ => {}
        }
    }

    /// On to time `t`, as [`Pieces::go_on_to`].
    #[inline(always)]
    fn go_on_to(&mut self, stop: &Stop<T>, t: T) {
        let mut left = Self::MOST;
        while t >= self.until && left > 0 {
            self.advance(stop);
            left -= 1;
        }
    }
}

/// An axis of a manoeuvre under way: what its stop and its profiles say of a time, from tick to tick with cubics instead of
/// closed forms. They are lent: the same ones to every call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Course<T> {
    pieces: Pieces<T>,
    stop: StopPieces<T>,
}

impl<T: Scalar> Course<T> {
    /// Of an axis that does not move.
    pub(crate) const STANDING: Self = Self {
        pieces: Pieces::NONE,
        stop: StopPieces::STANDING,
    };

    /// Up to time `t`.
    pub(crate) fn of(stop: &Stop<T>, profiles: &[Profile<T>; 2], t: T) -> Self {
        let mut course = Self {
            pieces: Pieces::of(profiles, Quality::Fine),
            stop: StopPieces::of(stop),
        };
        course.go_on_to(stop, profiles, t);
        course
    }

    /// On to time `t`, no earlier than that of the last call.
    #[inline(always)]
    pub(crate) fn go_on_to(&mut self, stop: &Stop<T>, profiles: &[Profile<T>; 2], t: T) {
        self.stop.go_on_to(stop, t);
        self.pieces.go_on_to(profiles, t);
    }

    /// At the time that it has gone on to.
    #[inline(always)]
    pub(crate) fn at(&self, t: T) -> AxisSample<T> {
        let mut sample = self.pieces.piece.at(t);
        if self.stop.stands() {
            sample.position += self.stop.piece.position;
        } else {
            let stop = self.stop.piece.at(t);
            sample.position += stop.position;
            sample.rate += stop.rate;
            sample.accel += stop.accel;
        }
        sample
    }

    /// The acceleration alone, at a time that may lie a little ahead.
    pub(crate) fn accel_at(&self, stop: &Stop<T>, profiles: &[Profile<T>; 2], t: T) -> T {
        let accel = if t < self.pieces.until {
            self.pieces.piece.accel(t)
        } else {
            accel_beyond(profiles, t)
        };
        if self.stop.stands() {
            accel
        } else if t < self.stop.until {
            accel + self.stop.piece.accel(t)
        } else {
            accel + stop_accel_beyond(stop, t)
        }
    }

    /// The motion at the begin is over, and so is the first of two profiles.
    pub(crate) fn is_at_last(&self, [_, last]: &[Profile<T>; 2]) -> bool {
        self.stop.stands() && (self.pieces.number > 0 || last.is_empty())
    }
}

/// A few times a manoeuvre; apart from its ticks, which are quicker for it.
#[cold]
#[inline(never)]
fn accel_beyond<T: Scalar>([a, b]: &[Profile<T>; 2], t: T) -> T {
    a.at(t).accel + b.at(t).accel
}

/// The same of a stop.
#[cold]
#[inline(never)]
fn stop_accel_beyond<T: Scalar>(stop: &Stop<T>, t: T) -> T {
    stop.at(t).accel
}

/// From a rate and an acceleration at time 0 to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stop<T> {
    rate: T,
    accel: T,
    /// Until the acceleration is 0 \[s\].
    fade: T,
    /// Rate then.
    faded: T,
    /// How long that is kept \[s\].
    hold: T,
    /// From then on.
    ramp: Ramp<T>,
}

impl<T: Scalar> Stop<T> {
    /// Where it stands: a ramp covers half of what its rate would in its time.
    pub(crate) fn distance(&self) -> T {
        self.faded_at() + self.faded * (self.hold + T::HALF * self.ramp.duration)
    }

    /// The same, braking so late that it stands after `distance`; `None` where it cannot stop within that.
    pub(crate) fn standing_at(self, distance: T) -> Option<Self> {
        if self.faded * distance <= T::ZERO {
            return None;
        }
        let hold = (distance - self.distance()) / self.faded + self.hold;
        (hold >= T::ZERO).then_some(Self { hold, ..self })
    }

    /// There was no motion at the begin.
    pub(crate) fn is_over(&self) -> bool {
        self.rate == T::ZERO && self.accel == T::ZERO
    }

    /// When it stands \[s\].
    pub(crate) fn duration(&self) -> T {
        self.fade + self.hold + self.ramp.duration
    }

    /// The rate that it brakes from.
    pub(crate) fn braked_from(&self) -> T {
        self.faded
    }

    /// At `t` since the acceleration has faded, with so much of the ramp done.
    #[inline(always)]
    fn braking(&self, t: T, ramp: &AxisSample<T>) -> AxisSample<T> {
        AxisSample {
            position: self.faded_at() + self.faded * (t - ramp.position),
            rate: self.faded * (T::ONE - ramp.rate),
            accel: -(self.faded * ramp.accel),
        }
    }

    /// Where the acceleration has faded.
    fn faded_at(&self) -> T {
        let third = T::from_f64(1.0 / 3.0);
        self.fade * (self.rate + third * self.accel * self.fade)
    }

    /// At time `t`, a little before the begin as well.
    pub(crate) fn at(&self, t: T) -> AxisSample<T> {
        if t <= T::ZERO {
            let gained = self.accel * t;
            return AxisSample {
                position: t * (self.rate + T::HALF * gained),
                rate: self.rate + gained,
                accel: self.accel,
            };
        }
        if t < self.fade {
            // a(t) = a₀ (1 − t/T)
            let left = T::ONE - t / self.fade;
            let third = T::from_f64(1.0 / 3.0);
            let gained = T::HALF * self.accel * t;
            return AxisSample {
                position: t * (self.rate + third * gained * (left + T::ONE + T::ONE)),
                rate: self.rate + gained * (left + T::ONE),
                accel: self.accel * left,
            };
        }
        if self.faded == T::ZERO {
            return AxisSample {
                position: self.faded_at(),
                ..AxisSample::default()
            };
        }
        let t = t - self.fade;
        self.braking(t, &self.ramp.at(t - self.hold))
    }
}

#[cfg(test)]
mod tests {
    use super::{AxisLimits, AxisSample, Course, Profile};
    use crate::maths::Libm;

    const AXES: [AxisLimits<f64>; 3] = [
        AxisLimits {
            rate: 1.2,
            up: 1.0,
            down: 1.5,
            jerk_s: 0.075,
        },
        AxisLimits {
            rate: 3.0,
            up: 0.9,
            down: 0.9,
            jerk_s: 0.0225,
        },
        AxisLimits {
            rate: 0.5,
            up: 2.0,
            down: 0.7,
            jerk_s: 0.1,
        },
    ];

    /// An acceleration fades at the largest jerk, which is that of the larger acceleration, whichever way that is.
    #[test]
    fn a_stop_fades_its_acceleration_at_the_largest_jerk() {
        for axis in AXES {
            let jerk = axis.up.max(axis.down) / axis.jerk_s;
            for accel in [axis.up, -axis.down, 0.3] {
                let stop = axis.stop(0.4, accel);
                assert!((stop.fade - accel.abs() / jerk).abs() < 1e-12, "{axis:?}");
            }
        }
    }

    /// Covers the distance, ends at rest, stays within every limit, and its samples are each other's
    /// derivatives, for distances over all cases of the peak rate.
    #[test]
    fn profiles_end_where_they_should() {
        for axis in AXES {
            for i in 0..60 {
                let way = 1e-5 * 1.25_f64.powi(i);
                for way in [way, -way] {
                    let profile = Profile {
                        start: 0.3,
                        ..axis.profile::<Libm>(way)
                    };
                    let end = profile.at(profile.end());
                    assert!(
                        (end.position - way).abs() < 1e-12 * way.abs().max(1.0),
                        "{way}"
                    );
                    assert!(end.rate.abs() < 1e-12 && profile.peak.abs() <= axis.rate);
                    check(|t| profile.at(t), 0.3, profile.duration(), &axis);
                }
            }
        }
    }

    #[test]
    fn stops_end_at_rest() {
        for axis in AXES {
            for rate in [-0.4, -0.01, 0.0, 0.2, 0.5] {
                for share in [-1.0, -0.3, 0.0, 0.9] {
                    let accel = share * axis.up.min(axis.down);
                    let stop = axis.stop(rate, accel);
                    let start = stop.at(0.0);
                    assert!((start.rate, start.accel, start.position) == (rate, accel, 0.0));
                    let end = stop.at(stop.duration());
                    assert!(end.rate.abs() < 1e-12);
                    assert!((end.position - stop.distance()).abs() < 1e-12);
                    if stop.duration() > 0.0 {
                        check(|t| stop.at(t), 0.0, stop.duration(), &axis);
                    }
                }
            }
        }
    }

    /// From tick to tick, several stretches in one as well, and laid out anew at any of them, a course says what the closed forms do.
    #[test]
    fn a_course_is_what_the_closed_forms_say() {
        for axis in AXES {
            // Braking at once, later, without an acceleration that fades, and where it stands once that has faded.
            let late = axis.stop(0.3, -0.2).standing_at(1.7);
            let stops = [
                axis.stop(-0.3, 0.2),
                late.expect("far enough"),
                axis.stop(0.3, 0.0),
                axis.stop(-0.5 * 0.2 * 0.2 * axis.jerk_s / axis.up.max(axis.down), 0.2),
            ];
            let courses = [(0.8, -0.3), (0.02, 1.5), (0.0, 0.4), (-0.6, 0.0)];
            for (stop, (one, other)) in stops.into_iter().zip(courses) {
                let first = axis.profile::<Libm>(one);
                let first = Profile {
                    start: 0.11,
                    ..first
                };
                let second = Profile {
                    start: first.end() + 0.07,
                    ..axis.profile::<Libm>(other)
                };
                let profiles = [first, second];
                let exact = |t| {
                    let (stop, [a, b]) = (stop.at(t), profiles.map(|profile| profile.at(t)));
                    let position = stop.position + a.position + b.position;
                    let rate = stop.rate + a.rate + b.rate;
                    [position, rate, stop.accel + a.accel + b.accel]
                };
                // 1e-12 of numbers of the size of 1, a hundred roundings of each of some ten stretches.
                let differs = |sample: &AxisSample<f64>, exact: [f64; 3]| {
                    let sample = [sample.position, sample.rate, sample.accel];
                    (sample.iter().zip(exact)).any(|(a, b)| (a - b).abs() > 1.0e-12)
                };
                for dt in [0.000_7, 0.013, 0.31] {
                    let mut course = Course::of(&stop, &profiles, -0.5 * dt);
                    for tick in 0..(6.0 / dt) as u32 {
                        let t = dt * (f64::from(tick) - 0.5);
                        course.go_on_to(&stop, &profiles, t);
                        assert!(!differs(&course.at(t), exact(t)), "{axis:?} {t}");
                        assert_eq!(course, Course::of(&stop, &profiles, t), "{t}");
                        let ahead = t + 0.5 * dt;
                        let accel = course.accel_at(&stop, &profiles, ahead);
                        assert!((accel - exact(ahead)[2]).abs() < 1.0e-12, "{axis:?} {t}");
                    }
                }
            }
        }
    }

    fn check(
        at: impl Fn(f64) -> AxisSample<f64>,
        start: f64,
        duration: f64,
        axis: &AxisLimits<f64>,
    ) {
        let largest = axis.up.max(axis.down);
        let n = 2000;
        let h = duration / f64::from(n);
        for i in 1..n {
            let t = start + f64::from(i) * h;
            let (a, b, c) = (at(t - h), at(t), at(t + h));
            assert!(b.accel.abs() <= largest * (1.0 + 1e-9));
            assert!((c.accel - b.accel).abs() <= largest / axis.jerk_s * h * (1.0 + 1e-6) + 1e-9);
            // Central differences err by h² times a third derivative.
            let jerk = largest / axis.jerk_s;
            assert!(((c.position - a.position) / (2.0 * h) - b.rate).abs() <= jerk * h * h + 1e-9);
            assert!(((c.rate - a.rate) / (2.0 * h) - b.accel).abs() <= jerk * h + 1e-9);
        }
    }
}
