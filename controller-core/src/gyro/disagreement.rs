//! Gyro and wheels disagree: which of the two is wrong.
//!
//! | seen | it is |
//! | --- | --- |
//! | the same reading, again and again, while the wheels turn the base | the gyro: stuck |
//! | turns of the same size the other way, and the gyro's are not those that both had before | the gyro: reversed |
//! | turns as if one wheel had turned the other way | its encoder, which counts the wrong way: its own detector says so sooner, but not of a wheel that is hardly pushed |
//! | external headings side with the wheels | the gyro |
//! | none of these for 0.05 s, and a wheel turns | a wheel slides |

use super::params::{ValidGyroParams, WINDOW_S};
use super::reading::GyroFault;
use crate::scalar::Scalar;

/// The gyro's own signatures show within this time \[s\].
const SIGNATURE_S: f64 = 0.05;
/// So long an encoder that counts the wrong way is left to its own detector \[s\]: twice as long as that takes.
const ENCODER_S: f64 = 1.0;
/// Over for so long, and it has ended \[s\].
const OVER_S: f64 = 0.1;
/// Equal readings in a row that no gyro gives that is turned.
const SAME: u8 = 4;
/// How exactly opposite turns are reversed ones, as a share.
const MIRRORED: f64 = 0.25;
/// Over this turn that is no chance any more \[rad\]: a base on ice sways by some degrees.
const LARGE: f64 = 0.1;
/// Turns are against each other that are apart by this share of both.
const AGAINST: f64 = 0.4;
/// Standard deviations from which on a heading sides with the wheels.
const SIDES: f64 = 4.0;

/// Since gyro and wheels began to disagree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Disagreement<T> {
    /// Time for which it was seen, 0 for none, and since it was last seen \[s\].
    lasts_s: T,
    over_s: T,
    /// Turn of the gyro less that of the wheels, what came before the first sign included \[rad\].
    pub(super) apart: T,
    /// Turns since the first sign \[rad\], and twice the way over the track.
    gyro: T,
    wheels: T,
    way: T,
    /// Time of these \[s\].
    turns_s: T,
    /// Turn rate while they agreed, over a window \[rad/s\].
    agreed: T,
}

/// What a reading showed.
pub(super) struct Turned<T> {
    /// Since the last reading \[s\].
    pub(super) t: T,
    /// Turns by gyro and wheels \[rad\].
    pub(super) gyro: T,
    pub(super) wheels: T,
    /// Way of the middle \[m\].
    pub(super) travel: T,
    /// Equal readings in a row.
    pub(super) same: u8,
}

impl<T: Scalar> Disagreement<T> {
    /// Takes a reading; `seen` is the turn apart in the window where it is beyond what is honest.
    pub(super) fn take(
        &mut self,
        gyro: &ValidGyroParams<T>,
        turned: &Turned<T>,
        seen: Option<T>,
    ) -> Option<GyroFault> {
        let f = T::from_f64;
        if self.lasts_s <= T::ZERO {
            if let Some(apart) = seen {
                self.lasts_s = turned.t;
                self.apart = apart;
            } else {
                let (window, turn) = (f(WINDOW_S), T::HALF * (turned.gyro + turned.wheels));
                self.agreed = (window * self.agreed + turn) / (window + turned.t);
            }
            return None;
        }
        self.apart += turned.gyro - turned.wheels;
        self.gyro += turned.gyro;
        self.wheels += turned.wheels;
        self.way += turned.travel * gyro.two_per_track;
        self.turns_s += turned.t;
        if seen.is_some() {
            self.lasts_s += turned.t;
            self.over_s = T::ZERO;
        } else {
            self.over_s += turned.t;
            if self.over_s > f(OVER_S) {
                *self = Self {
                    agreed: self.agreed,
                    ..Self::default()
                };
            }
            return None;
        }
        if self.lasts_s < f(SIGNATURE_S) {
            return None;
        }
        self.signature(gyro, turned.same, f(LARGE))
    }

    /// What only a faulty gyro does; a turn of `large` the other way is no chance.
    fn signature(&self, gyro: &ValidGyroParams<T>, same: u8, large: T) -> Option<GyroFault> {
        let wheels = self.wheels.abs();
        if same >= SAME && wheels > gyro.rounding + gyro.rounding {
            Some(GyroFault::Stuck)
        } else if self.mirrors() && wheels > large {
            Some(GyroFault::Reversed)
        } else {
            None
        }
    }

    /// The gyro turns as far as the wheels, the other way, and did not before.
    fn mirrors(&self) -> bool {
        let mirrored = T::from_f64(MIRRORED) * self.wheels.abs();
        (self.gyro + self.wheels).abs() < mirrored && !self.gyro_goes_on()
    }

    /// The gyro's turn is nearer to what both turned while they agreed, twice as near as the wheels': it is these that have changed. A base
    /// cannot turn round as quickly as a sign can.
    fn gyro_goes_on(&self) -> bool {
        let due = self.agreed * self.turns_s;
        let gyro = (self.gyro - due).abs();
        gyro + gyro < (self.wheels - due).abs()
    }

    /// An external heading is off by `off` from the gyro's, with this variance of the two: whether it is the wheels' instead.
    ///
    /// Both began the disagreement at the same heading, so the wheels' is off by `apart` the other way, less what came since the fix.
    pub(super) fn sides_with_wheels(
        &self,
        gyro: &ValidGyroParams<T>,
        off: T,
        variance: T,
        same: u8,
    ) -> Option<GyroFault> {
        let gate = T::from_f64(SIDES * SIDES) * variance;
        let sides = self.lasts_s > T::ZERO && off * self.apart < T::ZERO && off * off > gate;
        let signature = self.signature(gyro, same, gyro.rounding);
        sides.then(|| signature.unwrap_or(GyroFault::Disagrees))
    }

    /// For so long a wheel slides \[s\]; 0 if none does. `same` equal readings may be those of a gyro that is stuck.
    pub(super) fn slides_s(&self, same: u8) -> T {
        let now = self.over_s <= T::ZERO && self.lasts_s > T::from_f64(SIGNATURE_S);
        let signed = || same >= SAME || self.mirrors();
        let early = self.lasts_s < T::from_f64(ENCODER_S);
        if now && !signed() && !(early && self.may_be_encoder()) {
            self.lasts_s
        } else {
            T::ZERO
        }
    }

    /// The way of a wheel whose encoder counts the wrong way counts twice: what the gyro turns is then −2 way/track on the right and
    /// +2 way/track on the left, against the turn of the wheels.
    #[inline(never)]
    pub(super) fn may_be_encoder(&self) -> bool {
        let f = T::from_f64;
        let (gyro, wheels) = (self.gyro, self.wheels);
        let near = |way: T| (gyro + way).abs() < f(MIRRORED) * wheels.abs();
        let against = (gyro - wheels).abs() > f(AGAINST) * (gyro.abs() + wheels.abs());
        against && (near(self.way) || near(-self.way))
    }

    pub(super) fn lasts(&self) -> bool {
        self.lasts_s > T::ZERO
    }
}
