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

#[cfg(test)]
mod tests {
    use super::{FrictionWatch, Turning};
    use crate::hal::WheelCounts;
    use crate::motor::WheelFriction;
    use crate::types::{WheelSpeeds, WheelTorques};

    const FRICTION: WheelFriction<f64> = WheelFriction {
        coulomb_nm: 0.04,
        stiction_nm: 0.04,
        viscous_nm_s: 0.0,
        blend_rad_s: 0.02,
    };
    const PER_COUNT: f64 = 0.003;

    /// A tick of 5 ms with both wheels alike.
    fn tick(watch: &mut FrictionWatch<f64>, counts: i32, commanded: f64, torque: f64) -> f64 {
        let both = |value| (value, value);
        let (right, left) = both(commanded);
        let turning = Turning {
            friction: &FRICTION,
            per_count: PER_COUNT,
            counts: Some(WheelCounts {
                right: counts,
                left: counts,
            }),
            commanded: WheelSpeeds { right, left },
            torques: WheelTorques {
                right: torque,
                left: torque,
            },
            dt: 0.005,
        };
        let found = watch.advance(&turning);
        assert_eq!(found.right, found.left);
        found.right
    }

    /// 0.1 rad/s are a count in 30 ms: after 75 ms without one the compensation rises, by a stiction in 0.1 s, to one and a half.
    #[test]
    fn a_wheel_that_stands_is_pushed_more_and_more() {
        for way in [1.0, -1.0] {
            let mut watch = FrictionWatch::default();
            let rise: [f64; 100] = core::array::from_fn(|_| tick(&mut watch, 0, 0.1 * way, 0.0));
            assert!(rise[..16].iter().all(|beyond| *beyond == 0.0));
            assert!((rise[37] - rise[17] - 0.04).abs() < 1e-12, "{rise:?}");
            assert!((rise[99] - 0.06).abs() < 1e-12);
            // Ordered to stand it is not pushed; what was found stays.
            assert!((tick(&mut watch, 0, 0.0, 0.0) - 0.06).abs() < 1e-12);
        }
    }

    /// Loose at 0.04 + 0.04 N m, of which the law gave 0.004, either way: two thirds are left.
    #[test]
    fn what_broke_it_loose_tells_its_friction() {
        for way in [1, -1] {
            let mut watch = FrictionWatch::default();
            let mut turn = |counts: i32| {
                let (speed, torque) = (0.1 * f64::from(way), 0.004 * f64::from(way));
                tick(&mut watch, way * counts, speed, torque)
            };
            let mut beyond = 0.0;
            while beyond < 0.0359 {
                beyond = turn(0);
            }
            let known = 0.04 + 0.004;
            let rolling = 2.0 / 3.0 * (known + beyond) - known;
            assert!((turn(1) - rolling).abs() < 1e-12);
            // A count in every 30 ms: it rolls, and nothing more is added.
            for number in 0..120 {
                assert!((turn(2 + number / 6) - rolling).abs() < 1e-12);
            }
            // Slow for a while, and no more friction than before.
            for _ in 0..18 {
                turn(21);
            }
            assert!((turn(22) - rolling).abs() < 1e-12);
        }
    }

    /// Counts of a wheel that is pushed back are none of its way.
    #[test]
    fn counts_the_other_way_do_not_free_it() {
        let mut watch = FrictionWatch::default();
        let mut last = 0.0;
        for number in 0..60 {
            last = tick(&mut watch, -number, 0.1, 0.0);
        }
        assert!(last > 0.03, "{last}");
    }
}
