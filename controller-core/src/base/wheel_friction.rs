//! The friction of each wheel while the base creeps, by velocity or beside its goal, found by what breaks a standing wheel loose.
//!
//! A wheel that is to creep lives on friction that is compensated well: the velocity loop of a light base at 0.05 rad/s has a
//! twentieth of the torque that its friction has, and friction is known to a third. By the measured speed alone the motor layer adds
//! stiction up to ten blends ([`crate::motor`]), which pushes a wheel that is to roll more slowly by up to twice its friction.
//!
//! Here counts tell. A wheel whose count is overdue has come to a halt: what is compensated rises until it turns. What broke it loose
//! is its static friction; two thirds of that remain while it rolls.
//!
//! A base beside its goal ([`Creeps::BesideGoal`]) moves by steps rather than steadily. The motor layer's stiction stays, since what it gives too
//! much ends with the step, and what rises comes on top. It rises as far as the disturbance estimate would go, and half as far again, since what
//! holds a wheel at rest is half as much again as what brakes it while it turns: nobody may have stated what holds the wheels, such as a floor that they
//! sink into. The estimate takes seconds to get there, at the speeds that millimetres ask for.
//!
//! Friction that is compensated too much makes a base hunt: it drives past its goal and back, and since what is compensated changes its sign with the
//! command, the estimate of a steady disturbance never finds it. So a wheel that has turned beside a goal and is commanded the other way, which is how it
//! went too far, is compensated by [`LESS`] less from there on.

use crate::hal::WheelCounts;
use crate::motor::Motor;
use crate::range::{larger, smaller};
use crate::scalar::Scalar;
use crate::types::{WheelSpeeds, WheelTorques};

/// A wheel has come to a halt that is without a count for as many times of a count.
const OVERDUE: f64 = 2.5;
/// The stiction of the parameters is gathered in this time \[s\].
const RISE_S: f64 = 0.1;
/// Beside a goal, all that may be gathered: slower than a velocity loop, of 0.1 to 0.2 s, catches a wheel that breaks loose \[s\].
const RISE_BESIDE_S: f64 = 0.5;
/// Beside a goal a wheel is without a count for longer: than half a period of a base that hunts about its goal, at 5 Hz or more \[s\].
const STILL_S: f64 = 0.1;
/// Most static friction that is compensated, in stictions; beside a goal in what may hold a wheel, stated or not.
const MOST: f64 = 1.5;
/// Taken off what is compensated beside a goal whenever a wheel that has turned is commanded the other way, in Coulomb frictions of the parameters: three
/// times, and what was stated a third too high, as friction is known, is no longer too much.
const LESS: f64 = 0.1;
/// Most that is taken off so, in the same: beyond half of it nothing but the goal's tolerance makes a base hunt.
const MOST_LESS: f64 = 0.5;
/// Dry friction while turning over that at rest, of bearings and gears: currents to turn free and to start are as 2 to 3.
const SLIDING: f64 = 2.0 / 3.0;

/// How a base creeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Creeps {
    /// As it is told to, by velocity.
    ByVelocity,
    /// Near a goal that it is not parked at, with no manoeuvre under way.
    BesideGoal,
}

/// Both wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrictionWatch<T> {
    counts: Option<WheelCounts>,
    /// How the base did in the last tick; `None` makes nothing of the rest.
    creeps: Option<Creeps>,
    right: Wheel<T>,
    left: Wheel<T>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Wheel<T> {
    /// By velocity: compensated beyond the Coulomb friction of the parameters while it rolls, in the sense of the command \[N m\].
    rolling: T,
    /// On top, since it came to a halt. Beside a goal below 0 where it hunts.
    gathered: T,
    /// Time since the last count \[s\].
    silent_s: T,
    commanded: T,
    halted: bool,
    /// Beside a goal: it has turned since it was last commanded the other way.
    turned: bool,
}

/// What counts tell of a wheel.
enum Heard {
    /// It is to turn the other way, or not at all.
    TurnedBack,
    /// It has been at a halt, and turns.
    Freed,
    /// It is at a halt.
    Halted,
    /// It turns, or may be about to.
    Turns,
}

/// A tick of both wheels.
pub(super) struct Turning<'a, T> {
    pub(super) creeps: Creeps,
    pub(super) motor: &'a Motor<T>,
    /// \[rad\].
    pub(super) per_count: T,
    pub(super) counts: Option<WheelCounts>,
    /// Of the last tick, which the counts followed.
    pub(super) commanded: WheelSpeeds<T>,
    pub(super) torques: WheelTorques<T>,
    pub(super) dt: T,
}

impl<T: Scalar> FrictionWatch<T> {
    /// Of a base that does not creep.
    pub(super) const NEW: Self = Self {
        counts: None,
        creeps: None,
        right: Wheel::NEW,
        left: Wheel::NEW,
    };

    /// The base does not creep: what was found is of no use any more.
    pub(super) const fn forget(&mut self) {
        self.creeps = None;
    }

    /// Takes a tick; what is to be compensated beyond the Coulomb friction \[N m\]. Wheels turn at `speeds`, and at most `unknown_nm` \[N m\] holds each of
    /// them that nobody has stated.
    pub(super) fn advance(
        &mut self,
        now: &Turning<'_, T>,
        speeds: &WheelSpeeds<T>,
        unknown_nm: T,
    ) -> WheelTorques<T> {
        if self.creeps != Some(now.creeps) {
            *self = Self {
                creeps: Some(now.creeps),
                ..Self::NEW
            };
        }
        let moved = match (self.counts, now.counts) {
            (Some(before), Some(counts)) => (
                counts.right.wrapping_sub(before.right),
                counts.left.wrapping_sub(before.left),
            ),
            _ => (0, 0),
        };
        self.counts = now.counts.or(self.counts);
        let (commanded, torques) = (&now.commanded, &now.torques);
        let (right, left) = (&mut self.right, &mut self.left);
        match now.creeps {
            Creeps::ByVelocity => WheelTorques {
                right: right.creep(now, moved.0, commanded.right, torques.right),
                left: left.creep(now, moved.1, commanded.left, torques.left),
            },
            Creeps::BesideGoal => {
                let motor = now.motor;
                let stiction = motor.params().friction.stiction_nm;
                let most = T::from_f64(MOST) * (stiction + unknown_nm) - stiction;
                let (beyond_right, beyond_left) = (
                    right.nudge(now, moved.0, commanded.right, most),
                    left.nudge(now, moved.1, commanded.left, most),
                );
                WheelTorques {
                    right: motor.stiction_nm(speeds.right) + beyond_right,
                    left: motor.stiction_nm(speeds.left) + beyond_left,
                }
            }
        }
    }
}

impl<T: Scalar> Wheel<T> {
    const NEW: Self = Self {
        rolling: T::ZERO,
        gathered: T::ZERO,
        silent_s: T::ZERO,
        commanded: T::ZERO,
        halted: false,
        turned: false,
    };

    /// A tick by velocity; what is compensated \[N m\].
    fn creep(&mut self, now: &Turning<'_, T>, moved: i32, commanded: T, torque: T) -> T {
        let f = T::from_f64;
        let forward = commanded > T::ZERO;
        let friction = &now.motor.params().friction;
        // Counts of a wheel that is pushed back are none of its way.
        let turns = moved != 0 && (moved > 0) == forward;
        match self.listen(now, turns, commanded, T::ZERO) {
            Heard::Freed => {
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
            Heard::Halted => self.gather(
                friction.stiction_nm * now.dt / f(RISE_S),
                f(MOST) * friction.stiction_nm - self.rolling,
            ),
            Heard::TurnedBack | Heard::Turns => {}
        }
        self.rolling + self.gathered
    }

    /// A tick beside a goal; what is compensated beyond Coulomb friction and stiction, `most` at most \[N m\]. What is left of it when the wheel turns shortens
    /// the next halt.
    fn nudge(&mut self, now: &Turning<'_, T>, moved: i32, commanded: T, most: T) -> T {
        let f = T::from_f64;
        self.turned |= moved != 0;
        match self.listen(now, moved != 0, commanded, f(STILL_S)) {
            Heard::TurnedBack => {
                let coulomb = now.motor.params().friction.coulomb_nm;
                let less = if self.turned { f(LESS) } else { T::ZERO };
                let left = smaller(self.gathered, T::ZERO) - less * coulomb;
                self.gathered = larger(left, -f(MOST_LESS) * coulomb);
                self.turned = false;
            }
            Heard::Freed => self.gathered = f(SLIDING) * self.gathered,
            Heard::Halted => self.gather(most * now.dt / f(RISE_BESIDE_S), most),
            Heard::Turns => {}
        }
        self.gathered
    }

    /// Whether it turns, by its counts: at a halt it is `still_s` after a count is overdue.
    fn listen(&mut self, now: &Turning<'_, T>, turns: bool, commanded: T, still_s: T) -> Heard {
        let turned_back = commanded * self.commanded <= T::ZERO;
        self.commanded = commanded;
        if turned_back || turns {
            let freed = self.halted && !turned_back;
            self.silent_s = T::ZERO;
            self.halted = false;
            return if turned_back {
                Heard::TurnedBack
            } else if freed {
                Heard::Freed
            } else {
                Heard::Turns
            };
        }
        self.silent_s += now.dt;
        let patience = T::from_f64(OVERDUE) * now.per_count / commanded.abs() + now.dt + still_s;
        if self.silent_s <= patience {
            return Heard::Turns;
        }
        self.halted = true;
        Heard::Halted
    }

    fn gather(&mut self, more: T, most: T) {
        let more = self.gathered + more;
        self.gathered = if more < most { more } else { most };
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::{Creeps, FrictionWatch, Turning};
    use crate::hal::WheelCounts;
    use crate::motor::{Motor, MotorParams, WheelFriction};
    use crate::types::{WheelSpeeds, WheelTorques};

    /// Of toy motors of 12 V.
    pub(in crate::base) fn motor() -> Motor<f64> {
        let params = MotorParams {
            gear_ratio: 34.0,
            gear_efficiency: 0.75,
            torque_constant_nm_per_a: 0.010_5,
            resistance_ohm: 2.15,
            supply_v: 12.0,
            max_current_a: 3.0,
            friction: WheelFriction {
                coulomb_nm: 0.04,
                stiction_nm: 0.04,
                viscous_nm_s: 0.0,
                blend_rad_s: 0.02,
            },
            dead_band: 0.03,
            rotor_inertia_kg_m2: 5.0e-7,
        };
        params.validate().expect("valid")
    }

    const PER_COUNT: f64 = 0.003;

    /// A tick of 5 ms by velocity with both wheels alike.
    fn tick(watch: &mut FrictionWatch<f64>, counts: i32, commanded: f64, torque: f64) -> f64 {
        creep(watch, Creeps::ByVelocity, counts, commanded, torque)
    }

    fn creep(
        watch: &mut FrictionWatch<f64>,
        creeps: Creeps,
        counts: i32,
        commanded: f64,
        torque: f64,
    ) -> f64 {
        let both = |value| (value, value);
        let (right, left) = both(commanded);
        let turning = Turning {
            creeps,
            motor: &motor(),
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
        let found = watch.advance(&turning, &WheelSpeeds::default(), 0.02);
        assert_eq!(found.right, found.left);
        found.right
    }

    /// 0.1 rad/s are a count in 30 ms: after 75 ms without one the compensation rises, by a stiction in 0.1 s, to one and a half.
    #[test]
    fn a_wheel_that_stands_is_pushed_more_and_more() {
        for way in [1.0, -1.0] {
            let mut watch = FrictionWatch::NEW;
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
            let mut watch = FrictionWatch::NEW;
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
        let mut watch = FrictionWatch::NEW;
        let mut last = 0.0;
        for number in 0..60 {
            last = tick(&mut watch, -number, 0.1, 0.0);
        }
        assert!(last > 0.03, "{last}");
    }

    /// 0.1 rad/s are a count in 30 ms: at a halt after 75 ms and a tenth of a second, then within half a second to half a stiction and 3/2 of what nobody has
    /// stated; two thirds of that remain when the wheel turns, either way, and none when it is to turn back.
    #[test]
    fn beside_a_goal_a_standing_wheel_is_nudged() {
        for way in [1, -1] {
            let mut watch = FrictionWatch::NEW;
            let mut turn = |counts, speed| {
                let (speed, torque) = (f64::from(way) * speed, f64::from(way) * 0.01);
                creep(&mut watch, Creeps::BesideGoal, counts, speed, torque) - 0.04
            };
            let rise: [f64; 160] = core::array::from_fn(|_| turn(0, 0.1));
            assert!(rise[..36].iter().all(|more| *more == 0.0));
            assert!((rise[87] - rise[37] - 0.025).abs() < 1e-12, "{rise:?}");
            assert!((rise[159] - 0.05).abs() < 1e-12);
            for counts in [1, 0, 1] {
                assert!((turn(counts, 0.1) - 0.1 / 3.0).abs() < 1e-12);
            }
            let again: [f64; 160] = core::array::from_fn(|_| turn(1, 0.1));
            assert!(
                again[..35]
                    .iter()
                    .all(|more| (more - 0.1 / 3.0).abs() < 1e-12)
            );
            assert!((again[159] - 0.05).abs() < 1e-12);
            assert!(turn(1, -0.1) <= 0.0);
        }
    }

    /// Back and forth across its goal: a tenth of the Coulomb friction of 0.04 N m less each time, down to half of it. One that stands is none that hunts,
    /// wherever it is commanded.
    #[test]
    fn beside_a_goal_a_wheel_that_hunts_is_pushed_less() {
        let mut watch = FrictionWatch::NEW;
        let mut turn = |counts, speed| creep(&mut watch, Creeps::BesideGoal, counts, speed, 0.0);
        for number in 0..20 {
            let way = if number % 2 == 0 { 0.1 } else { -0.1 };
            assert_eq!(turn(0, way), 0.04);
        }
        for number in 0..20 {
            let (way, counts) = if number % 2 == 0 { (0.1, 1) } else { (-0.1, 0) };
            let taken = f64::min(0.004 * f64::from(number + 1), 0.02);
            for _ in 0..3 {
                assert!((turn(counts, way) - (0.04 - taken)).abs() < 1e-12);
            }
        }
        // Short of it at last: nudged from there.
        let rise: [f64; 160] = core::array::from_fn(|_| turn(0, -0.1));
        assert!((rise[31] - 0.02).abs() < 1e-12, "{rise:?}");
        assert!(rise[40] > rise[39] && rise[159] > 0.06, "{rise:?}");
    }

    /// What one way of creeping found is none of the other's.
    #[test]
    fn another_way_of_creeping_begins_anew() {
        for (first, then, least) in [
            (Creeps::ByVelocity, Creeps::BesideGoal, 0.04),
            (Creeps::BesideGoal, Creeps::ByVelocity, 0.0),
        ] {
            let mut watch = FrictionWatch::NEW;
            let found: [f64; 160] = core::array::from_fn(|_| creep(&mut watch, first, 0, 0.1, 0.0));
            assert!(found[159] > 0.05);
            assert_eq!(creep(&mut watch, then, 0, 0.1, 0.0), least);
        }
    }
}
