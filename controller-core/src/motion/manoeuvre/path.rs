//! Turns and drives on one clock, and where they lead.

use super::profile::{AxisSample, Profile, Stop};
use crate::maths::Maths;
use crate::scalar::Scalar;

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

/// Gauss' rule on (−1, 1) with two and with four points: nodes and weights of one half.
const GAUSS: [&[(f64, f64)]; 2] = [
    &[(0.577_350_269_189_625_8, 1.0)],
    &[
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_8),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    ],
];

/// Displacements by the motion at the begin and by both drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ends<T> {
    pub(crate) stopping: Vector<T>,
    pub(crate) drives: [Vector<T>; 2],
}

impl<T: Scalar> Path<T> {
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
        let [a, b] = &self.turns;
        let both = sum(a.at(t), b.at(t));
        if self.stop_turn.is_over() {
            both
        } else {
            sum(self.stop_turn.at(t), both)
        }
    }

    /// Travel, speed and acceleration at `t`.
    pub(crate) fn drive_at(&self, t: T) -> AxisSample<T> {
        let [a, b] = &self.drives;
        let both = sum(a.at(t), b.at(t));
        if self.stop_drive.is_over() {
            both
        } else {
            sum(self.stop_drive.at(t), both)
        }
    }

    /// Where the motion at the begin and each of the drives lead.
    ///
    /// By parts, as the travel s is smoother than the speed and counts only while the robot turns:
    ///
    /// ```text
    /// ∫ v (cos θ, sin θ) dt = s(T) (cos θ(T), sin θ(T)) + ∫ s ω (sin θ, −cos θ) dt
    /// ```
    ///
    /// Gauss' rule between the corners of all profiles, where the integrand is smooth.
    pub(crate) fn ends<M: Maths<T>>(&self, quality: Quality) -> Ends<T> {
        let (corners, last) = self.corners(quality);
        let (sine, cosine) = M::sin_cos_near(self.turn_at(last).position);
        let travel = |t| {
            let stopping = if self.stop_drive.is_over() {
                T::ZERO
            } else {
                self.stop_drive.at(t).position
            };
            [
                stopping,
                self.drives[0].at(t).position,
                self.drives[1].at(t).position,
            ]
        };
        let mut sums = travel(last).map(|way| Vector {
            x: way * cosine,
            y: way * sine,
        });
        let [two, four] = GAUSS;
        let rule = match quality {
            Quality::Rough => two,
            Quality::Fine => four,
        };
        for pair in corners.windows(2) {
            let [from, to] = *pair else { continue };
            if to > last {
                break;
            }
            let half = T::HALF * (to - from);
            let middle = from + half;
            if half <= T::ZERO || self.turn_at(middle).rate == T::ZERO {
                continue;
            }
            for &(node, weight) in rule {
                for node in [-node, node] {
                    let t = middle + half * T::from_f64(node);
                    let turn = self.turn_at(t);
                    let (sine, cosine) = M::sin_cos_near(turn.position);
                    let share = T::from_f64(weight) * half * turn.rate;
                    for (sum, way) in sums.iter_mut().zip(travel(t)) {
                        sum.x += share * way * sine;
                        sum.y -= share * way * cosine;
                    }
                }
            }
        }
        let [stopping, a, b] = sums;
        Ends {
            stopping,
            drives: [a, b],
        }
    }

    /// Where ramps begin and end, in `Fine` quality also where jerks step, in order, and the last of these times; behind it
    /// there is nothing but [`Scalar::MAX`].
    fn corners(&self, quality: Quality) -> ([T; CORNERS], T) {
        let mut sorted = [T::MAX; CORNERS];
        let (mut last, mut count) = (T::ZERO, 0);
        let mut add = |time: T| {
            if time > last {
                last = time;
            }
            // Pushes what is later one place on; without an index there is none to be out of bounds.
            count += 1;
            let mut time = time;
            for place in sorted.iter_mut().take(count) {
                if time < *place {
                    core::mem::swap(place, &mut time);
                }
            }
        };
        add(T::ZERO);
        for stop in [&self.stop_turn, &self.stop_drive] {
            add(stop.duration());
            if quality == Quality::Fine {
                stop.jerks().into_iter().for_each(&mut add);
            }
        }
        for profile in self.turns.iter().chain(&self.drives) {
            if !profile.is_empty() {
                profile.corners().into_iter().for_each(&mut add);
                if quality == Quality::Fine {
                    profile.jerks().into_iter().for_each(&mut add);
                }
            }
        }
        (sorted, last)
    }
}

/// 0, four corners of both stops, and eight of four profiles.
const CORNERS: usize = 1 + 2 * 4 + 4 * 8;

fn sum<T: Scalar>(a: AxisSample<T>, b: AxisSample<T>) -> AxisSample<T> {
    AxisSample {
        position: a.position + b.position,
        rate: a.rate + b.rate,
        accel: a.accel + b.accel,
    }
}
