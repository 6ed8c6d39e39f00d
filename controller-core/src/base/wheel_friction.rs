//! The friction of each wheel while the base drives by velocity, found by what breaks a standing wheel loose.
//!
//! A wheel that is to creep lives on friction that is compensated well: the velocity loop of a light base at 0.05 rad/s has a
//! twentieth of the torque that its friction has, and friction is known to a third. By the measured speed alone the motor layer adds
//! stiction up to ten blends ([`crate::motor`]), which pushes a wheel that is to roll more slowly by up to twice its friction.
//!
//! Here counts tell. A wheel whose count is overdue has come to a halt: what is compensated rises until it turns. What broke it loose
//! is its static friction; two thirds of that remain while it rolls.

use crate::hal::WheelCounts;
use crate::motor::WheelFriction;
use crate::scalar::Scalar;
use crate::types::{WheelSpeeds, WheelTorques};

/// A wheel has come to a halt that is without a count for as many times of a count.
const OVERDUE: f64 = 2.5;
/// The stiction of the parameters is gathered in this time \[s\].
const RISE_S: f64 = 0.1;
/// Most that is gathered, in stictions.
const MOST: f64 = 1.5;
/// Dry friction while turning over that at rest, of bearings and gears: currents to turn free and to start are as 2 to 3.
const SLIDING: f64 = 2.0 / 3.0;

/// Both wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FrictionWatch<T> {
    counts: Option<WheelCounts>,
    right: Wheel<T>,
    left: Wheel<T>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wheel<T> {
    /// Compensated beyond the Coulomb friction of the parameters while it rolls, in the sense of the command \[N m\].
    rolling: T,
    /// On top, since it came to a halt.
    gathered: T,
    /// Time since the last count that way \[s\].
    silent_s: T,
    commanded: T,
    halted: bool,
}

/// A tick of both wheels.
pub(super) struct Turning<'a, T> {
    pub(super) friction: &'a WheelFriction<T>,
    /// \[rad\].
    pub(super) per_count: T,
    pub(super) counts: Option<WheelCounts>,
    /// Of the last tick, which the counts followed.
    pub(super) commanded: WheelSpeeds<T>,
    pub(super) torques: WheelTorques<T>,
    pub(super) dt: T,
}

impl<T: Scalar> FrictionWatch<T> {
    /// Takes a tick; what is to be compensated beyond the Coulomb friction \[N m\].
    pub(super) fn advance(&mut self, now: &Turning<'_, T>) -> WheelTorques<T> {
        let moved = match (self.counts, now.counts) {
            (Some(before), Some(counts)) => (
                counts.right.wrapping_sub(before.right),
                counts.left.wrapping_sub(before.left),
            ),
            _ => (0, 0),
        };
        self.counts = now.counts.or(self.counts);
        let (commanded, torques) = (&now.commanded, &now.torques);
        self.right
            .advance(now, moved.0, commanded.right, torques.right);
        self.left
            .advance(now, moved.1, commanded.left, torques.left);
        WheelTorques {
            right: self.right.rolling + self.right.gathered,
            left: self.left.rolling + self.left.gathered,
        }
    }
}

impl<T: Scalar> Wheel<T> {
    fn advance(&mut self, now: &Turning<'_, T>, moved: i32, commanded: T, torque: T) {
        let f = T::from_f64;
        let turned_back = commanded * self.commanded <= T::ZERO;
        self.commanded = commanded;
        if turned_back {
            self.silent_s = T::ZERO;
            self.halted = false;
            return;
        }
        let forward = commanded > T::ZERO;
        let friction = now.friction;
        if moved != 0 && (moved > 0) == forward {
            if self.halted {
                let torque = if forward { torque } else { -torque };
                let known = friction.coulomb_nm + torque;
                let broke = known + self.rolling + self.gathered;
                let left = f(SLIDING) * broke - known;
                // A wheel that was only slow says nothing new. What is too much the disturbance estimate takes back.
                if left > self.rolling {
                    self.rolling = left;
                }
                self.gathered = T::ZERO;
            }
            self.silent_s = T::ZERO;
            self.halted = false;
        } else {
            self.silent_s += now.dt;
        }
        let patience = f(OVERDUE) * now.per_count / commanded.abs() + now.dt;
        if self.silent_s > patience {
            self.halted = true;
            let more = self.gathered + friction.stiction_nm * now.dt / f(RISE_S);
            let most = f(MOST) * friction.stiction_nm - self.rolling;
            self.gathered = if more < most { more } else { most };
        }
    }
}
