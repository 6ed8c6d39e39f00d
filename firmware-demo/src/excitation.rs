//! What a base drives by itself for a bench recording: levels of speed and turn rate, within a rectangle.
//!
//! ```text
//!            width             runs to and fro along the length, straight and weaving, forward and backward;
//!     +--------|--------+      half turns on the spot between them; a new speed each 0.3 to 1 s, a new turn rate as often
//!     |                 |      or twice, both of 30 to 100 % of what was ordered
//!     |        ^        |
//!     |     begin       |  1/10 of the length behind the begin
//!     +-----------------+
//! ```
//!
//! The excitation is a source of velocity orders, as a host is: everything that watches over a base that is driven by one
//! watches here, limits, faults, the button, a host that falls silent. What it adds is the rectangle: a run ends a margin
//! before an edge, and where a controlled stop would end beyond an edge ([`controlled_stop`] bounds its way) the base is to begin it.
//!
//! Pure: time and motion are arguments; the same seed with the same motion orders the same.
//!
//! [`controlled_stop`]: controller_core::safety::controlled_stop

use core::f32::consts::{PI, TAU};

use controller_core::angle::wrap;
use controller_core::maths::{Maths, Single};
use controller_core::motion::Limits;
use controller_core::safety::Stopping;
use controller_core::types::{Pose, Twist};
use protocol::{Excite, RecordingEnd};

/// Share of the length that is behind the base at the begin.
pub const BEHIND: f32 = 0.1;
/// Share of the shorter side at which a run turns round before an edge.
const MARGIN: f32 = 0.1;
/// Sides of the rectangle \[m\].
pub const SIDES: (f32, f32) = (0.3, 50.0);
/// Lengths of a drive \[s\]: time for each kind of motion, and less than a clock of 32 bits of µs wraps around in.
pub const DURATIONS: (f32, f32) = (5.0, 600.0);
/// Steps in which a speed is sought that the space is long enough for, and the least one, as shares.
const SLOWER: f32 = 0.95;
const SLOWEST: f32 = 0.1;
/// Levels as shares of what was ordered.
const LEVELS: (f32, f32) = (0.3, 1.0);
/// Time of a level \[s\].
const TIMES: (f32, f32) = (0.3, 1.0);
/// Time that a new order takes to slow the base down \[s\]: the lags of driving by velocity.
const LAG_S: f32 = 0.2;
/// A base slower than this has halted \[m/s, rad/s\],
const HALTED: (f32, f32) = (0.02, 0.05);
/// or after this time \[µs\].
const HALT_US: u32 = 1_500_000;
/// Longest run \[µs\]: in a large space there are turns as often.
const RUN_US: u32 = 4_000_000;
/// Turns of this and more go either way \[rad\].
const EITHER: f32 = 2.0;
/// Less than this is not turned between two runs \[rad\].
const AHEAD: f32 = 0.5;

/// How the base moves now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where it is.
    pub pose: Pose<f32>,
    /// Measured.
    pub twist: Twist<f32>,
    /// Of a controlled stop that began now.
    pub stopping: Stopping<f32>,
}

/// What a tick asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Drive so.
    Drive(Twist<f32>),
    /// Stop, for this reason.
    End(RecordingEnd),
}

/// A number that is drawn anew after some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Level {
    value: f32,
    left_us: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Leg {
    /// Along the heading, or against it.
    Run { forward: bool, straight: bool },
    /// To rest; then a run if the base has been turned for it.
    Halt { turned: bool },
    /// On the spot: its sense, what is left \[rad\], the heading before.
    Turn { sense: f32, left: f32, before: f32 },
    /// To rest for good.
    End,
}

/// A drive under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    order: Excite,
    track_m: f32,
    random: Random,
    begin: Option<Pose<f32>>,
    run_us: u32,
    leg: Leg,
    leg_us: u32,
    /// Runs so far, modulo what changes with them.
    runs: u8,
    /// The last turn on the spot, to the left above 0 \[rad\].
    turned: f32,
    speed: Level,
    turn: Level,
}

impl Excitation {
    /// A drive that begins where the first tick finds the base; `None` where a number of `order` is out of its range. The speed is
    /// one from which the base stops within a third of the length, `stop_m` being the way of a stop; `None` if that is less
    /// than a tenth of the order's.
    pub fn new(
        order: &Excite,
        limits: &Limits<f32>,
        track_m: f32,
        stop_m: impl Fn(f32) -> f32,
    ) -> Option<Self> {
        // What is not a number is in no range.
        let within = |value: f32, (low, high): (f32, f32)| low <= value && value <= high;
        let fits = within(order.length_m, SIDES)
            && within(order.width_m, SIDES)
            && within(order.duration_s, DURATIONS)
            && within(order.speed, (f32::MIN_POSITIVE, limits.speed))
            && within(order.turn_rate, (f32::MIN_POSITIVE, limits.turn_rate));
        if !fits {
            return None;
        }
        let speeds = core::iter::successors(Some(order.speed), |speed| Some(SLOWER * speed));
        let speed = speeds
            .take_while(|speed| *speed > SLOWEST * order.speed)
            .find(|speed| 3.0 * (stop_m(*speed) + LAG_S * speed) <= order.length_m)?;
        Some(Self {
            order: Excite { speed, ..*order },
            track_m,
            random: Random::new(order.seed),
            begin: None,
            run_us: 0,
            leg: Leg::Run {
                forward: true,
                straight: true,
            },
            leg_us: 0,
            runs: 0,
            turned: 0.0,
            speed: Level::default(),
            turn: Level::default(),
        })
    }

    /// The tick `dt_us` after the last; without a motion the base does not know of one yet, and is to stand.
    pub fn advance(&mut self, dt_us: u32, motion: Option<&Motion>) -> Step {
        let Some(motion) = motion else {
            return Step::Drive(Twist::default());
        };
        self.run_us = self.run_us.saturating_add(dt_us);
        self.leg_us = self.leg_us.saturating_add(dt_us);
        let begin = *self.begin.get_or_insert(motion.pose);
        let place = Place::of(&begin, motion);
        if place.ends_outside(&self.order) {
            return Step::End(RecordingEnd::LeftSpace);
        }
        if self.leg != Leg::End && self.run_us as f32 * 1.0e-6 >= self.order.duration_s {
            self.enter(Leg::End);
        }
        for level in [&mut self.speed, &mut self.turn] {
            level.left_us = level.left_us.saturating_sub(dt_us);
        }
        match self.leg {
            Leg::Run { forward, straight } => self.run(&place, forward, straight),
            Leg::Turn {
                sense,
                left,
                before,
            } => self.turn(&place, sense, left, before),
            Leg::Halt { turned } => {
                if self.halted(motion) {
                    self.depart(&place, turned);
                }
                Step::Drive(Twist::default())
            }
            Leg::End if self.halted(motion) => Step::End(RecordingEnd::Complete),
            Leg::End => Step::Drive(Twist::default()),
        }
    }

    fn halted(&self, Motion { twist, .. }: &Motion) -> bool {
        let rests = twist.linear.abs() < HALTED.0 && twist.angular.abs() < HALTED.1;
        rests || self.leg_us > HALT_US
    }

    fn enter(&mut self, leg: Leg) {
        self.leg = leg;
        self.leg_us = 0;
        (self.speed, self.turn) = Default::default();
    }

    fn run(&mut self, place: &Place, forward: bool, straight: bool) -> Step {
        let margin = MARGIN * self.order.length_m.min(self.order.width_m);
        let sense = if forward { 1.0 } else { -1.0 };
        if place.heads_out(&self.order, margin, sense) || self.leg_us > RUN_US {
            self.enter(Leg::Halt { turned: false });
            return Step::Drive(Twist::default());
        }
        if self.speed.left_us == 0 {
            self.speed = self.random.level(self.order.speed);
        }
        if self.turn.left_us == 0 && !straight {
            let side = 1.0_f32.copysign(-self.turn.value);
            let Level { value, left_us } = self.random.level(self.order.turn_rate);
            self.turn = Level {
                value: side * value,
                left_us: left_us / 2,
            };
        }
        // The inner wheel turns on, at half of the speed at least: a wheel that reverses for moments shows little.
        let most = self.speed.value / self.track_m;
        let turn = self.turn.value.abs().min(most).copysign(self.turn.value);
        Step::Drive(Twist::new(sense * self.speed.value, turn))
    }

    fn turn(&mut self, place: &Place, sense: f32, left: f32, before: f32) -> Step {
        let left = left - sense * wrap(place.heading - before);
        if left <= place.turns_on {
            self.enter(Leg::Halt { turned: true });
            return Step::Drive(Twist::default());
        }
        self.leg = Leg::Turn {
            sense,
            left,
            before: place.heading,
        };
        if self.turn.left_us == 0 {
            self.turn = self.random.level(self.order.turn_rate);
        }
        Step::Drive(Twist::new(0.0, sense * self.turn.value))
    }

    /// On from a halt: twice forward, twice backward, each time to the far end, every other one weaving.
    ///
    /// A base that weaves as it slows down brakes one wheel harder than its acceleration limits brake both: with small limits and
    /// much friction motors would never brake otherwise, and a drive in which they do not shows no gear losses.
    fn depart(&mut self, place: &Place, turned: bool) {
        let next = self.runs.wrapping_add(1);
        let forward = next & 2 == 0;
        let run = Leg::Run {
            forward,
            straight: next & 1 == 0,
        };
        if !turned {
            let Excite {
                length_m, width_m, ..
            } = self.order;
            let far = if place.x < (0.5 - BEHIND) * length_m {
                (1.0 - BEHIND - MARGIN) * length_m
            } else {
                (MARGIN - BEHIND) * length_m
            };
            let aside = 0.5 * (self.random.share() - 0.5) * width_m;
            let bearing = Single::atan2(aside - place.y, far - place.x);
            let facing = if forward { bearing } else { bearing + PI };
            let near = wrap(facing - place.heading);
            // To the other side than last time where that is not much farther.
            let to_left = if near.abs() > EITHER && near * self.turned > 0.0 {
                near - TAU.copysign(near)
            } else {
                near
            };
            if to_left.abs() > AHEAD {
                self.turned = to_left;
                self.enter(Leg::Turn {
                    sense: 1.0_f32.copysign(to_left),
                    left: to_left.abs(),
                    before: place.heading,
                });
                return;
            }
        }
        self.runs = next;
        self.enter(run);
    }
}

/// The base in the rectangle, whose origin and axis are the pose at the begin.
struct Place {
    x: f32,
    y: f32,
    heading: f32,
    /// Of the way, forward above 0.
    speed: f32,
    /// Way \[m\] and turn \[rad\] of a controlled stop.
    stop_m: f32,
    stop_rad: f32,
    /// Turn until a new order has stopped it \[rad\].
    turns_on: f32,
}

impl Place {
    fn of(begin: &Pose<f32>, motion: &Motion) -> Self {
        let Motion {
            pose,
            twist,
            stopping,
        } = motion;
        let (sine, cosine) = Single::sin_cos(begin.theta);
        let (dx, dy) = (pose.x - begin.x, pose.y - begin.y);
        let turn = twist.angular;
        Self {
            x: dx * cosine + dy * sine,
            y: dy * cosine - dx * sine,
            heading: pose.theta - begin.theta,
            speed: twist.linear,
            stop_m: stopping.distance_m,
            stop_rad: stopping.angle_rad.copysign(turn),
            turns_on: stopping.angle_rad + LAG_S * turn.abs(),
        }
    }

    /// A stop that begins now ends beyond an edge.
    fn ends_outside(&self, order: &Excite) -> bool {
        self.ends_beyond(order, 0.0, 0.0, 1.0_f32.copysign(self.speed))
    }

    /// As a run that turns round in time has to know it.
    fn heads_out(&self, order: &Excite, margin: f32, sense: f32) -> bool {
        self.ends_beyond(order, margin, LAG_S, sense)
    }

    /// A stop that begins `lag_s` from now ends beyond an edge, less the margin, that the base moves towards.
    fn ends_beyond(&self, order: &Excite, margin: f32, lag_s: f32, sense: f32) -> bool {
        let way = sense * (self.stop_m + lag_s * self.speed.abs());
        let rear = margin - BEHIND * order.length_m;
        let front = (1.0 - BEHIND) * order.length_m - margin;
        let side = 0.5 * order.width_m - margin;
        // Straight on, and along the chord of the arc.
        [0.0, 0.5 * self.stop_rad].into_iter().any(|turn| {
            let (sine, cosine) = Single::sin_cos(self.heading + turn);
            let (x, y) = (self.x + way * cosine, self.y + way * sine);
            let (ahead, aside) = (sense * cosine, sense * sine);
            // Not a number is nowhere inside.
            let inside = |value: f32| value >= 0.0;
            !((inside(front - x) || (margin > 0.0 && ahead < 0.0))
                && (inside(x - rear) || (margin > 0.0 && ahead > 0.0))
                && (inside(side - y) || (margin > 0.0 && aside < 0.0))
                && (inside(side + y) || (margin > 0.0 && aside > 0.0)))
        })
    }
}

/// Marsaglia's xorshift of 32 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Random(u32);

impl Random {
    const fn new(seed: u32) -> Self {
        // Of 0 it would stay 0; neighbours begin far apart.
        let mixed = seed.wrapping_mul(0x9E37_79B9) ^ 0x85EB_CA6B;
        Self(if mixed == 0 { 1 } else { mixed })
    }

    /// 0 to below 1.
    fn share(&mut self) -> f32 {
        let Self(mut bits) = *self;
        bits ^= bits << 13;
        bits ^= bits >> 17;
        bits ^= bits << 5;
        *self = Self(bits);
        (bits >> 8) as f32 / 16_777_216.0
    }

    fn between(&mut self, (low, high): (f32, f32)) -> f32 {
        low + (high - low) * self.share()
    }

    /// A share of `most`, for a time.
    fn level(&mut self, most: f32) -> Level {
        Level {
            value: most * self.between(LEVELS),
            left_us: (1.0e6 * self.between(TIMES)) as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::motion::SaturationPolicy;

    const LIMITS: Limits<f32> = Limits {
        speed: 1.2,
        turn_rate: 3.0,
        rim_speed: 1.2,
        accel: 1.0,
        brake: 1.5,
        turn_accel: 6.0,
        jerk: 20.0,
        turn_jerk: 80.0,
        wheel_torque_nm: 2.0,
        policy: SaturationPolicy::KeepCurvature,
    };
    const ORDER: Excite = Excite {
        length_m: 2.0,
        width_m: 1.0,
        speed: 0.7,
        turn_rate: 1.8,
        duration_s: 40.0,
        seed: 1,
    };
    const DT_US: u32 = 5000;

    fn stop_m(speed: f32) -> f32 {
        speed * speed / (2.0 * 0.8 * LIMITS.brake)
    }

    /// A point that takes orders within accelerations; a stop of it is one with less of them.
    #[derive(Clone, Copy)]
    struct Point {
        pose: Pose<f32>,
        twist: Twist<f32>,
    }

    impl Point {
        fn motion(&self) -> Motion {
            let Twist { linear, angular } = self.twist;
            Motion {
                pose: self.pose,
                twist: self.twist,
                stopping: Stopping {
                    distance_m: stop_m(linear),
                    angle_rad: angular * angular / (2.0 * 0.8 * LIMITS.turn_accel),
                    time_s: 0.0,
                },
            }
        }

        fn follow(&mut self, order: &Twist<f32>) {
            let dt = DT_US as f32 * 1.0e-6;
            let towards = |now: f32, to: f32, accel: f32| {
                let most = accel * dt;
                now + (to - now).max(-most).min(most)
            };
            self.twist.linear = towards(self.twist.linear, order.linear, LIMITS.accel);
            self.twist.angular = towards(self.twist.angular, order.angular, LIMITS.turn_accel);
            let (sine, cosine) = Single::sin_cos(self.pose.theta);
            self.pose.x += dt * self.twist.linear * cosine;
            self.pose.y += dt * self.twist.linear * sine;
            self.pose.theta += dt * self.twist.angular;
        }
    }

    /// Seconds of each motion: forward, backward, to the left, to the right on the spot, in arcs; and how it ended.
    fn drive(order: &Excite, begin: Pose<f32>) -> ([f32; 5], RecordingEnd) {
        let mut excitation = Excitation::new(order, &LIMITS, 0.35, stop_m).expect("an order");
        let mut point = Point {
            pose: begin,
            twist: Twist::default(),
        };
        let (sine, cosine) = Single::sin_cos(begin.theta);
        let mut seconds = [0.0; 5];
        for _ in 0..200_000 {
            match excitation.advance(DT_US, Some(&point.motion())) {
                Step::End(end) => return (seconds, end),
                Step::Drive(twist) => {
                    assert!(twist.linear.abs() <= order.speed, "{twist:?}");
                    assert!(twist.angular.abs() <= order.turn_rate, "{twist:?}");
                    point.follow(&twist);
                }
            }
            let (dx, dy) = (point.pose.x - begin.x, point.pose.y - begin.y);
            let (x, y) = (dx * cosine + dy * sine, dy * cosine - dx * sine);
            let inside = (-BEHIND * order.length_m..=(1.0 - BEHIND) * order.length_m).contains(&x)
                && y.abs() <= 0.5 * order.width_m;
            assert!(inside, "{order:?}: at {x}, {y}");
            let Twist { linear, angular } = point.twist;
            let dt = DT_US as f32 * 1.0e-6;
            let turns = angular.abs() > 0.1;
            for (sum, holds) in seconds.iter_mut().zip([
                linear > 0.1,
                linear < -0.1,
                turns && angular > 0.0 && linear.abs() < 0.01,
                turns && angular < 0.0 && linear.abs() < 0.01,
                turns && linear.abs() > 0.1,
            ]) {
                *sum += if holds { dt } else { 0.0 };
            }
        }
        panic!("{order:?}: no end")
    }

    #[test]
    fn every_drive_stays_in_its_space_moves_in_every_way_and_ends_in_time() {
        for seed in 0..200 {
            for (length_m, width_m, speed) in [(2.0, 1.0, 0.7), (1.0, 0.6, 0.7), (5.0, 5.0, 1.2)] {
                let order = Excite {
                    length_m,
                    width_m,
                    speed,
                    seed,
                    ..ORDER
                };
                let begin = Pose::new(3.0, -2.0, 0.1 * seed as f32);
                let (seconds, end) = drive(&order, begin);
                assert_eq!(end, RecordingEnd::Complete, "{order:?}");
                // Of 40 s.
                let least = seconds.iter().copied().fold(f32::INFINITY, f32::min);
                assert!(least > 0.5, "{order:?}: {seconds:?}");
                assert!(seconds.iter().sum::<f32>() > 25.0, "{order:?}: {seconds:?}");
            }
        }
    }

    #[test]
    fn the_same_seed_orders_the_same_and_another_another() {
        let twists = |seed| {
            let order = Excite { seed, ..ORDER };
            let mut excitation = Excitation::new(&order, &LIMITS, 0.35, stop_m).expect("an order");
            let still = Point {
                pose: Pose::default(),
                twist: Twist::default(),
            };
            [(); 400].map(|()| excitation.advance(DT_US, Some(&still.motion())))
        };
        assert_eq!(twists(7), twists(7));
        assert_ne!(twists(7), twists(8));
        // A seed of 0 and one that the mixing makes 0 draw as well.
        for seed in [0, 0x85EB_CA6B_u32.wrapping_mul(0x144C_BC89)] {
            assert!(twists(seed).windows(2).any(|pair| pair[0] != pair[1]));
        }
    }

    #[test]
    fn what_is_beyond_an_edge_or_nowhere_ends_the_drive() {
        let at = |pose, linear| {
            let mut excitation = Excitation::new(&ORDER, &LIMITS, 0.35, stop_m).expect("an order");
            let begin = Point {
                pose: Pose::default(),
                twist: Twist::default(),
            };
            excitation.advance(DT_US, Some(&begin.motion()));
            let twist = Twist::new(linear, 0.0);
            excitation.advance(DT_US, Some(&Point { pose, twist }.motion()))
        };
        let left = Step::End(RecordingEnd::LeftSpace);
        assert!(matches!(at(Pose::new(1.7, 0.0, 0.0), 0.1), Step::Drive(_)));
        // 0.7 m/s take 0.2 m.
        assert_eq!(at(Pose::new(1.7, 0.0, 0.0), 0.7), left);
        assert_eq!(at(Pose::new(1.81, 0.0, 0.0), 0.0), left);
        assert_eq!(at(Pose::new(-0.21, 0.0, 0.0), 0.0), left);
        assert_eq!(at(Pose::new(0.5, 0.51, 0.0), 0.0), left);
        assert_eq!(at(Pose::new(0.5, -0.51, 0.0), 0.0), left);
        assert_eq!(at(Pose::new(f32::NAN, 0.0, 0.0), 0.0), left);
        assert_eq!(at(Pose::new(0.0, 0.0, f32::NAN), 0.1), left);
    }

    #[test]
    fn orders_out_of_range_are_refused_and_a_speed_too_high_for_the_space_is_lowered() {
        let speed = |order: &Excite| {
            Excitation::new(order, &LIMITS, 0.35, stop_m).map(|excitation| excitation.order.speed)
        };
        assert_eq!(speed(&ORDER), Some(0.7));
        let short = speed(&Excite {
            length_m: 0.6,
            ..ORDER
        });
        assert!(
            short.is_some_and(|speed| (0.2..0.5).contains(&speed)),
            "{short:?}"
        );
        for wrong in [
            Excite {
                length_m: 0.2,
                ..ORDER
            },
            Excite {
                width_m: 51.0,
                ..ORDER
            },
            Excite {
                width_m: f32::NAN,
                ..ORDER
            },
            Excite {
                speed: 1.3,
                ..ORDER
            },
            Excite {
                speed: 0.0,
                ..ORDER
            },
            Excite {
                turn_rate: f32::INFINITY,
                ..ORDER
            },
            Excite {
                turn_rate: -1.0,
                ..ORDER
            },
            Excite {
                duration_s: 4.0,
                ..ORDER
            },
            Excite {
                duration_s: 601.0,
                ..ORDER
            },
        ] {
            assert_eq!(speed(&wrong), None, "{wrong:?}");
        }
        // A base that does not stop anywhere near.
        assert!(Excitation::new(&ORDER, &LIMITS, 0.35, |_| 5.0).is_none());
    }

    #[test]
    fn a_base_that_knows_of_no_motion_yet_stands_and_loses_no_time() {
        let mut excitation = Excitation::new(&ORDER, &LIMITS, 0.35, stop_m).expect("an order");
        let before = excitation;
        assert_eq!(
            excitation.advance(DT_US, None),
            Step::Drive(Twist::default())
        );
        assert_eq!(excitation, before);
    }
}
