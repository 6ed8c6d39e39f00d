//! Gyro and wheels disagree: which of the two is wrong.
//!
//! | seen | it is |
//! | --- | --- |
//! | the same reading, again and again, while the wheels turn the base | the gyro: stuck |
//! | turns of the same size the other way | the gyro: reversed; no wheel that slides turns a base so |
//! | turns as if one wheel had turned the other way | that wheel's encoder: reversed |
//! | external headings side with the wheels | the gyro |
//! | none of these for 0.15 s, and a wheel turns | a wheel slides |

use super::params::ValidGyroParams;
use super::reading::GyroFault;
use crate::scalar::Scalar;

/// The gyro's own signatures show within this time \[s\].
const SIGNATURE_S: f64 = 0.05;
/// A wheel slides that has disagreed for so long \[s\].
const SLIDES_S: f64 = 0.15;
/// Over for so long, and it has ended \[s\].
const OVER_S: f64 = 0.1;
/// Equal readings in a row that no gyro gives that is turned.
const SAME: u8 = 4;
/// How exactly opposite turns are reversed ones, as a share.
const MIRRORED: f64 = 0.25;

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
}

/// A wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Right.
    Right,
    /// Left.
    Left,
}

/// What a disagreement turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    /// The gyro lies.
    Gyro(GyroFault),
    /// An encoder counts the wrong way.
    Encoder(Side),
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
    ) -> Option<Finding> {
        let f = T::from_f64;
        if self.lasts_s <= T::ZERO {
            if let Some(apart) = seen {
                self.lasts_s = turned.t;
                self.apart = apart;
            }
            return None;
        }
        self.apart += turned.gyro - turned.wheels;
        self.gyro += turned.gyro;
        self.wheels += turned.wheels;
        self.way += turned.travel * gyro.two_per_track;
        if seen.is_some() {
            self.lasts_s += turned.t;
            self.over_s = T::ZERO;
        } else {
            self.over_s += turned.t;
            if self.over_s > f(OVER_S) {
                *self = Self::default();
            }
            return None;
        }
        let (wheels, way) = (self.wheels.abs(), self.way.abs());
        if self.lasts_s < f(SIGNATURE_S) {
            return None;
        }
        let large = |turn: T| turn > gyro.rounding + gyro.rounding;
        if large(wheels) && turned.same >= SAME {
            return Some(Finding::Gyro(GyroFault::Stuck));
        }
        if large(wheels) && (self.gyro + self.wheels).abs() < f(MIRRORED) * wheels {
            return Some(Finding::Gyro(GyroFault::Reversed));
        }
        // The way of a wheel of the wrong sign counts twice: (r − l)/track is −2 way/track with −r for r, +2 with −l for l.
        if large(way) && (self.gyro + self.way).abs() < f(MIRRORED) * way {
            return Some(Finding::Encoder(Side::Right));
        }
        let left = large(way) && (self.gyro - self.way).abs() < f(MIRRORED) * way;
        left.then_some(Finding::Encoder(Side::Left))
    }

    /// An external heading is off by `off` from the gyro's, with this variance of the two: whether it is the wheels' instead.
    ///
    /// Both began the disagreement at the same heading, so the wheels' is off by `apart` the other way, less what came since the fix.
    pub(super) fn sides_with_wheels(&self, off: T, variance: T) -> bool {
        let gate = T::from_f64(super::params::GATE * super::params::GATE) * variance;
        self.lasts_s > T::ZERO && off * self.apart < T::ZERO && off * off > gate
    }

    /// A wheel slides. `same` equal readings may be those of a gyro that is stuck.
    pub(super) fn slides(&self, same: u8) -> bool {
        let now = self.over_s <= T::ZERO;
        // Without a turn, and without a way, it may be either encoder.
        let suspected = |way: T| (self.gyro + way).abs() < T::from_f64(MIRRORED) * self.wheels.abs();
        let encoder = suspected(self.way) || suspected(-self.way);
        now && self.lasts_s > T::from_f64(SLIDES_S) && same < SAME && !encoder
    }

    pub(super) fn lasts(&self) -> bool {
        self.lasts_s > T::ZERO
    }
}
