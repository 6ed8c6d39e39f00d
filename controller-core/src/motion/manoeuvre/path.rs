//! Turns and drives on one clock, and where they lead.

use super::profile::{AxisSample, Course, Piece, Pieces, Profile, Quality, Stop, StopPieces};
use crate::maths::Maths;
use crate::range::smaller;
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

/// The most stretches: those of both axes, of their profiles and of their stops.
const STRETCHES: u8 = 2 * (Pieces::<f32>::MOST + StopPieces::<f32>::MOST + 1);

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
        let mut turn = Pieces::of(&self.turns, quality);
        let mut drive = Pieces::of(&self.drives, quality);
        let mut stop_turn = StopPieces::of(&self.stop_turn);
        let mut stop_drive = StopPieces::of(&self.stop_drive);
        let mut ends = Ends::default();
        let mut from = T::ZERO;
        for _ in 0..STRETCHES {
            let to = smaller(
                smaller(turn.until, drive.until),
                smaller(stop_turn.until, stop_drive.until),
            );
            if to == T::MAX {
                break;
            }
            if to > from {
                let half = T::HALF * (to - from);
                let [a, b] = &mut ends.drives;
                let driven = if drive.number == 0 { a } else { b };
                let stretch = Stretch {
                    middle: from + half,
                    half,
                    turns: [&turn.piece, &stop_turn.piece],
                    turning: turn.moving().or(stop_turn.moving()).is_some(),
                };
                match (drive.moving(), stop_drive.moving()) {
                    (None, None) => {}
                    (Some(piece), None) => stretch.add::<M>(quality, &mut [(piece, driven)]),
                    (None, Some(stop)) => {
                        stretch.add::<M>(quality, &mut [(stop, &mut ends.stopping)]);
                    }
                    (Some(piece), Some(stop)) => {
                        let both = &mut [(piece, driven), (stop, &mut ends.stopping)];
                        stretch.add::<M>(quality, both);
                    }
                }
                from = to;
            }
            if turn.until <= to {
                turn.go_on(&self.turns, quality);
            }
            if drive.until <= to {
                drive.go_on(&self.drives, quality);
            }
            if stop_turn.until <= to {
                stop_turn.go_on(&self.stop_turn, quality);
            }
            if stop_drive.until <= to {
                stop_drive.go_on(&self.stop_drive, quality);
            }
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
    middle: T,
    /// Of its duration \[s\].
    half: T,
    /// What it turns by: a profile, and the motion at the begin.
    turns: [&'a Piece<T>; 2],
    turning: bool,
}

impl<T: Scalar> Stretch<'_, T> {
    /// Adds ∫ v (cos θ, sin θ) dt of each of what is driven to its end.
    ///
    /// By a call: once in an image, not once for each of what may be driven.
    #[inline(never)]
    fn add<M: Maths<T>>(&self, quality: Quality, driven: &mut [(&Piece<T>, &mut Vector<T>)]) {
        let Self { middle, half, .. } = *self;
        if !self.turning {
            let (sine, cosine) = M::sin_cos_near(self.heading(middle));
            for (piece, end) in driven {
                let way = piece.way(middle, half);
                end.x += way * cosine;
                end.y += way * sine;
            }
            return;
        }
        let (rule, pairs) = self.rule(quality);
        for &(node, weight) in rule.iter().take(pairs) {
            let (offset, weight) = (half * node, half * weight);
            for t in [middle - offset, middle + offset] {
                let (sine, cosine) = M::sin_cos_near(self.heading(t));
                for (piece, end) in driven.iter_mut() {
                    let way = weight * piece.rate(t);
                    end.x += way * cosine;
                    end.y += way * sine;
                }
            }
        }
    }

    fn heading(&self, t: T) -> T {
        let [turn, stop] = self.turns;
        turn.position(t) + stop.position(t)
    }

    /// Gauss' rule on (−1, 1): a node on each side of 0 and its weight, with two points or with four.
    ///
    /// Two err by (2h)⁵/4320 of the fourth derivative of v sin θ, of which 4 v′ θ′³ is the most: where the heading changes by Δ and
    /// the speed by v, by 4/4320 Δ³ of the way 2h v. At 1/8 rad that is 2e-6 of it: a hundredth of a millimetre in all.
    fn rule(&self, quality: Quality) -> ([(T, T); 2], usize) {
        let f = T::from_f64;
        let turned = || {
            let [turn, stop] = self.turns;
            turn.way(self.middle, self.half) + stop.way(self.middle, self.half)
        };
        if quality == Quality::Rough || turned().abs() <= f(0.125) {
            ([(f(0.577_350_269_189_625_8), T::ONE); 2], 1)
        } else {
            let outer = (f(0.861_136_311_594_052_6), f(0.347_854_845_137_453_8));
            let inner = (f(0.339_981_043_584_856_3), f(0.652_145_154_862_546_1));
            ([outer, inner], 2)
        }
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

#[cfg(test)]
mod tests {
    use super::super::profile::{AxisLimits, AxisSample, Profile, Quality, Stop};
    use super::{Courses, Path, Vector};
    use crate::maths::{Libm, Maths};

    const DRIVE: AxisLimits<f64> = AxisLimits {
        rate: 0.6,
        up: 1.0,
        down: 1.5,
        jerk_s: 0.075,
    };
    const TURN: AxisLimits<f64> = AxisLimits {
        rate: 1.5,
        up: 2.0,
        down: 2.0,
        jerk_s: 0.1,
    };

    fn starting(start: f64, mut profile: Profile<f64>) -> Profile<f64> {
        profile.start = start;
        profile
    }

    /// From motion: both axes come to rest while both turns and both drives overlap, with ramps of jerk alone among them, a hold, and a
    /// pause.
    fn curved() -> Path<f64> {
        let turns = [0.6, -1.9].map(|angle| TURN.profile::<Libm>(angle));
        let drives = [0.9, -0.004].map(|way| DRIVE.profile::<Libm>(way));
        Path {
            stop_drive: DRIVE.stop(0.5, -0.4),
            stop_turn: TURN.stop(-0.8, 0.7),
            turns: [starting(0.1, turns[0]), starting(1.6, turns[1])],
            drives: [starting(0.4, drives[0]), starting(3.6, drives[1])],
        }
    }

    /// Along the path in small steps, each of what is driven by itself: the motion at the begin, and both drives.
    fn in_small_steps(path: &Path<f64>) -> [Vector<f64>; 3] {
        let steps = 40_000;
        let h = path.duration() / f64::from(steps);
        let mut ends = [Vector::default(); 3];
        for i in 0..steps {
            let t = (f64::from(i) + 0.5) * h;
            let (sine, cosine) = Libm::sin_cos(path.turn_at(t).position);
            let [a, b] = path.drives.map(|profile| profile.at(t).rate);
            for (end, rate) in ends.iter_mut().zip([path.stop_drive.at(t).rate, a, b]) {
                end.x += h * rate * cosine;
                end.y += h * rate * sine;
            }
        }
        ends
    }

    fn ends(path: &Path<f64>, quality: Quality) -> [Vector<f64>; 3] {
        let ends = path.ends::<Libm>(quality);
        let [a, b] = ends.drives;
        [ends.stopping, a, b]
    }

    /// What is exact is so to a hundredth of a millimetre, 2e-6 for each of some stretches of a metre in all; what is rough to the a
    /// τ²/24 by which the middle of a ramp is off, 0.4 mm, of two ramps, times angles of about 1.
    #[test]
    fn ends_are_the_integral() {
        let path = curved();
        let exact = in_small_steps(&path);
        for (quality, tolerance) in [(Quality::Fine, 1.0e-5), (Quality::Rough, 1.0e-3)] {
            for (end, exact) in ends(&path, quality).iter().zip(&exact) {
                let off = Libm::sqrt((end.x - exact.x).powi(2) + (end.y - exact.y).powi(2));
                assert!(off < tolerance, "{quality:?}: {off} of {exact:?}");
            }
        }
    }

    /// Both axes are sums of the stop and of both profiles, and all of it is over with the last of them. Tick by tick as well.
    #[test]
    fn an_axis_is_the_sum_of_its_motions() {
        let mut path = curved();
        assert_eq!(path.duration(), path.drives[1].end());
        assert!(path.duration() > path.turns[1].end());
        let mut courses = Courses::of(&path, 0.0);
        for tick in 0..500_u16 {
            let t = 0.01 * f64::from(tick);
            let sum = |[stop, a, b]: [AxisSample<f64>; 3]| {
                let of = |get: fn(&AxisSample<f64>) -> f64| get(&stop) + get(&a) + get(&b);
                [of(|s| s.position), of(|s| s.rate), of(|s| s.accel)]
            };
            let [a, b] = path.turns.map(|turn| turn.at(t));
            let turn = sum([path.stop_turn.at(t), a, b]);
            let [a, b] = path.drives.map(|drive| drive.at(t));
            let drive = sum([path.stop_drive.at(t), a, b]);
            let near = |sample: &AxisSample<f64>, exact: [f64; 3]| {
                let sample = [sample.position, sample.rate, sample.accel];
                sample
                    .iter()
                    .zip(exact)
                    .all(|(a, b)| (a - b).abs() < 1.0e-12)
            };
            assert!(
                near(&path.turn_at(t), turn) && near(&path.drive_at(t), drive),
                "{t}"
            );
            let (turned, driven) = courses.go_on_to(&path, t);
            assert!(near(&turned, turn) && near(&driven, drive), "{t}");
            let accel = courses.accel_at(&path, t);
            assert!((accel.linear - drive[2]).abs() < 1.0e-12, "{t}");
            assert!((accel.angular - turn[2]).abs() < 1.0e-12, "{t}");
            assert_eq!(
                courses.is_last_drive(&path),
                t >= path.drives[0].end(),
                "{t}"
            );
        }
        // Without the second drive the first is the last, once the robot has come to rest; without any nothing else is to come.
        path.drives[1] = Profile::default();
        assert!(!Courses::of(&path, 0.1).is_last_drive(&path));
        let rests = path.stop_drive.duration() + 0.01;
        assert!(Courses::of(&path, rests).is_last_drive(&path));
        path.forget_manoeuvre();
        assert_eq!((path.turns, path.drives), Default::default());
        assert!(Courses::of(&path, 0.1).is_last_drive(&path));
        let last = f64::max(path.stop_drive.duration(), path.stop_turn.duration());
        assert_eq!(path.duration(), last);
    }

    /// Straight on, or on the spot, nothing has to be summed, however roughly: the ways are those of the profiles and of the stop.
    #[test]
    fn straight_ends_are_exact() {
        let straight = Path {
            turns: [Profile::default(); 2],
            stop_turn: Stop::default(),
            ..curved()
        };
        for quality in [Quality::Fine, Quality::Rough] {
            let expected = [straight.stop_drive.distance(), 0.9, -0.004];
            for (end, way) in ends(&straight, quality).iter().zip(expected) {
                assert!(
                    (end.x - way).abs() < 1.0e-12 && end.y == 0.0,
                    "{end:?} {way}"
                );
            }
            let on_the_spot = Path {
                drives: [Profile::default(); 2],
                stop_drive: Stop::default(),
                ..curved()
            };
            assert_eq!(ends(&on_the_spot, quality), [Vector::default(); 3]);
        }
    }
}
