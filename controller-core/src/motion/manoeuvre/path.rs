//! Turns and drives on one clock, and where they lead.

use super::profile::{AxisSample, Course, Piece, Pieces, Profile, Stop};
use crate::maths::Maths;
use crate::scalar::Scalar;
use crate::types::Accel;

/// A manoeuvre: the motion at its begin comes to rest, while two turns and two drives add to it.
///
/// θ(t) and v(t) are sums of closed forms, θ(0) = 0. The position is their integral,
/// x' = v cos θ, y' = v sin θ, in the frame of the robot at time 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Path<T> {
    pub(crate) stop_drive: Stop<T>,
    pub(crate) stop_turn: Stop<T>,
    pub(crate) turns: [Profile<T>; 2],
    pub(crate) drives: [Profile<T>; 2],
}

/// A displacement \[m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Vector<T> {
    pub(crate) x: T,
    pub(crate) y: T,
}

impl<T: Scalar> Vector<T> {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
        }
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
        }
    }

    pub(crate) fn scaled(self, by: T) -> Self {
        Self {
            x: by * self.x,
            y: by * self.y,
        }
    }

    pub(crate) fn norm<M: Maths<T>>(self) -> T {
        M::sqrt(self.x * self.x + self.y * self.y)
    }
}

/// How well a displacement is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// To some millimetres, to choose among manoeuvres.
    Rough,
    /// To hundredths of a millimetre, to drive one.
    Fine,
}

/// Gauss' rule on (−1, 1): a node on each side of 0 and its weight, with two points and with four.
fn gauss<T: Scalar>(quality: Quality) -> ([(T, T); 2], usize) {
    let f = T::from_f64;
    match quality {
        Quality::Rough => {
            let pair = (f(0.577_350_269_189_625_8), T::ONE);
            ([pair; 2], 1)
        }
        Quality::Fine => {
            let outer = (f(0.861_136_311_594_052_6), f(0.347_854_845_137_453_8));
            let inner = (f(0.339_981_043_584_856_3), f(0.652_145_154_862_546_1));
            ([outer, inner], 2)
        }
    }
}

/// The most stretches: eight of each of four profiles and one behind them, four corners of both stops.
const STRETCHES: u8 = 2 * (2 * 8 + 1) + 2 * 4;

/// Displacements by the motion at the begin and by both drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ends<T> {
    pub(crate) stopping: Vector<T>,
    pub(crate) drives: [Vector<T>; 2],
}

impl<T: Scalar> Path<T> {
    /// Nothing but the motion at the begin is left.
    pub(crate) fn forget_manoeuvre(&mut self) {
        self.turns = [Profile::default(); 2];
        self.drives = [Profile::default(); 2];
    }

    /// When everything is at rest \[s\].
    pub(crate) fn duration(&self) -> T {
        let [a, b] = [self.stop_drive.duration(), self.stop_turn.duration()];
        let mut last = if a > b { a } else { b };
        for profile in self.turns.iter().chain(&self.drives) {
            let end = profile.end();
            if end > last {
                last = end;
            }
        }
        last
    }

    /// Heading, turn rate and its rate at `t`.
    pub(crate) fn turn_at(&self, t: T) -> AxisSample<T> {
        at(&self.stop_turn, &self.turns, t)
    }

    /// Travel, speed and acceleration at `t`.
    pub(crate) fn drive_at(&self, t: T) -> AxisSample<T> {
        at(&self.stop_drive, &self.drives, t)
    }

    /// Where the motion at the begin and each of the drives lead: ∫ v (cos θ, sin θ) dt.
    ///
    /// Between the instants at which a jerk steps speed and heading are polynomials: Gauss' rule has nothing but the sine of a
    /// cubic to err by. Where the robot does not turn, or does not drive, nothing has to be summed.
    ///
    /// Apart, for the sake of the stack.
    #[inline(never)]
    pub(crate) fn ends<M: Maths<T>>(&self, quality: Quality) -> Ends<T> {
        let (rule, pairs) = gauss(quality);
        let rule = rule.get(..pairs).unwrap_or_default();
        let (mut turn, mut drive) = (Pieces::of(&self.turns), Pieces::of(&self.drives));
        let mut ends = Ends::default();
        let turned = self.stop_turn.distance();
        let mut from = T::ZERO;
        for _ in 0..STRETCHES {
            let mut to = if turn.until < drive.until {
                turn.until
            } else {
                drive.until
            };
            for stop in [&self.stop_turn, &self.stop_drive] {
                if from < stop.duration() {
                    for jerk in stop.jerks() {
                        if jerk > from && jerk < to {
                            to = jerk;
                        }
                    }
                }
            }
            if to == T::MAX {
                break;
            }
            if to > from {
                let stretch = Stretch {
                    from,
                    to,
                    stop_turn: (from < self.stop_turn.duration()).then_some(&self.stop_turn),
                    turned,
                    turn: turn.piece,
                };
                if from < self.stop_drive.duration() {
                    let stop = &self.stop_drive;
                    let stopped = stretch.ends::<M>(rule, |t| stop.at(t).rate);
                    ends.stopping = ends.stopping.plus(stopped);
                }
                if !drive.piece.rests() {
                    let driven = stretch.ends::<M>(rule, |t| drive.piece.rate(t));
                    let [a, b] = &mut ends.drives;
                    let end = if drive.number == 0 { a } else { b };
                    *end = end.plus(driven);
                }
            }
            if turn.until <= to {
                turn.advance(&self.turns);
            }
            if drive.until <= to {
                drive.advance(&self.drives);
            }
            from = to;
        }
        ends
    }
}

/// Both axes of a path that is driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Courses<T> {
    turn: Course<T>,
    drive: Course<T>,
}

impl<T: Scalar> Courses<T> {
    /// Of a path on which nothing moves.
    pub(crate) const STANDING: Self = Self {
        turn: Course::STANDING,
        drive: Course::STANDING,
    };

    /// Up to time `t`.
    pub(crate) fn of(path: &Path<T>, t: T) -> Self {
        Self {
            turn: Course::of(&path.stop_turn, &path.turns, t),
            drive: Course::of(&path.stop_drive, &path.drives, t),
        }
    }

    /// On to time `t`, no earlier than that of the last call: what [`Path::turn_at`] and [`Path::drive_at`] say but for rounding.
    #[inline(always)]
    pub(crate) fn go_on_to(&mut self, path: &Path<T>, t: T) -> (AxisSample<T>, AxisSample<T>) {
        self.turn.go_on_to(&path.stop_turn, &path.turns, t);
        self.drive.go_on_to(&path.stop_drive, &path.drives, t);
        (self.turn.at(t), self.drive.at(t))
    }

    /// At a time that may lie a little ahead.
    #[inline(always)]
    pub(crate) fn accel_at(&self, path: &Path<T>, t: T) -> Accel<T> {
        Accel {
            linear: self.drive.accel_at(&path.stop_drive, &path.drives, t),
            angular: self.turn.accel_at(&path.stop_turn, &path.turns, t),
        }
    }

    /// What is driven now is driven to the end.
    pub(crate) fn is_last_drive(&self, path: &Path<T>) -> bool {
        let [one, other] = &path.drives;
        self.drive.is_at_last(&path.drives) || (one.is_empty() && other.is_empty())
    }
}

/// A stretch of time in which no jerk steps.
struct Stretch<'a, T> {
    from: T,
    to: T,
    /// While the turn at the begin lasts.
    stop_turn: Option<&'a Stop<T>>,
    /// What it turns in all.
    turned: T,
    turn: Piece<T>,
}

impl<T: Scalar> Stretch<'_, T> {
    /// ∫ v (cos θ, sin θ) dt for a speed v(t).
    fn ends<M: Maths<T>>(&self, rule: &[(T, T)], speed: impl Fn(T) -> T) -> Vector<T> {
        let half = T::HALF * (self.to - self.from);
        let middle = self.from + half;
        let mut sum = Vector::default();
        let straight = self.turn.rests() && self.stop_turn.is_none();
        if straight {
            // Simpson's rule: the speed is a parabola.
            let heading = self.turned + self.turn.position(middle);
            let (sine, cosine) = M::sin_cos_near(heading);
            let four = T::from_f64(4.0);
            let way = half
                * T::from_f64(1.0 / 3.0)
                * (speed(self.from) + four * speed(middle) + speed(self.to));
            return Vector {
                x: way * cosine,
                y: way * sine,
            };
        }
        for &(node, weight) in rule {
            let (offset, weight) = (half * node, half * weight);
            for t in [middle - offset, middle + offset] {
                let turned = match self.stop_turn {
                    Some(stop) => stop.at(t).position,
                    None => self.turned,
                };
                let heading = turned + self.turn.position(t);
                let (sine, cosine) = M::sin_cos_near(heading);
                let way = weight * speed(t);
                sum.x += way * cosine;
                sum.y += way * sine;
            }
        }
        sum
    }
}

/// An axis at `t`: the stop, if there was motion at the begin, and both profiles.
fn at<T: Scalar>(stop: &Stop<T>, [a, b]: &[Profile<T>; 2], t: T) -> AxisSample<T> {
    let both = sum(a.at(t), b.at(t));
    if stop.is_over() {
        both
    } else {
        sum(stop.at(t), both)
    }
}

fn sum<T: Scalar>(a: AxisSample<T>, b: AxisSample<T>) -> AxisSample<T> {
    AxisSample {
        position: a.position + b.position,
        rate: a.rate + b.rate,
        accel: a.accel + b.accel,
    }
}
