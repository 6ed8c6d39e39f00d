//! Shapes of manoeuvres: which turns and drives overlap, and by how much.

use super::path::{Path, Vector};
use super::profile::{AxisLimits, Profile};
use crate::maths::Maths;
use crate::motion::limits::rim_speed;
use crate::range::larger;
use crate::scalar::Scalar;

/// Share of the limits that a parking manoeuvre plans with; the rest is feedback's.
pub(crate) const PLAN_SHARE: f64 = 0.95;

/// What a manoeuvre may use, of both axes and of the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlanLimits<T> {
    pub(crate) drive: AxisLimits<T>,
    pub(crate) turn: AxisLimits<T>,
    /// Largest speed of either wheel's rim \[m/s\].
    pub(crate) rim: T,
    /// Half of the distance between the wheels \[m\].
    pub(crate) half_track: T,
}

/// How much of the limits a manoeuvre uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pace {
    /// Half the accelerations.
    pub(crate) slower: bool,
    /// Half the jerk.
    pub(crate) smoother: bool,
}

impl<T: Scalar> PlanLimits<T> {
    /// What a manoeuvre of this pace may use.
    pub(crate) fn at(&self, pace: Pace) -> Self {
        let limits = if pace.slower { self.slower() } else { *self };
        if pace.smoother {
            limits.smoother()
        } else {
            limits
        }
    }

    /// With half the accelerations, which twice the stated mass leaves to the same wheels: where the robot did not follow at full
    /// ones.
    fn slower(&self) -> Self {
        let axis = |axis: &AxisLimits<T>| AxisLimits {
            up: T::HALF * axis.up,
            down: T::HALF * axis.down,
            ..*axis
        };
        Self {
            drive: axis(&self.drive),
            turn: axis(&self.turn),
            ..*self
        }
    }

    /// With half the jerk: for a robot that moves, where ramps of two motions may coincide.
    fn smoother(&self) -> Self {
        let axis = |axis: &AxisLimits<T>| AxisLimits {
            jerk_s: axis.jerk_s + axis.jerk_s,
            ..*axis
        };
        Self {
            drive: axis(&self.drive),
            turn: axis(&self.turn),
            ..*self
        }
    }

    /// The largest |v| + l |w|/2 of these turns and drives \[m/s\], where it is beyond the rim's; `None` where it is not.
    ///
    /// Each |rate| is a trapezoid but for its corners, so the sum is largest where one of them reaches or leaves its peak.
    fn fastest_beyond(&self, turns: &[Profile<T>; 2], drives: &[Profile<T>; 2]) -> Option<T> {
        if rim_speed(peak(drives), peak(turns), self.half_track) <= self.rim {
            return None;
        }
        let rate = |[a, b]: &[Profile<T>; 2], t: T| a.at(t).rate + b.at(t).rate;
        let mut fastest = self.rim;
        for profile in turns.iter().chain(drives) {
            let risen = profile.start + profile.rise;
            for t in [risen, risen + profile.hold] {
                fastest = larger(
                    rim_speed(rate(drives, t), rate(turns, t), self.half_track),
                    fastest,
                );
            }
        }
        (fastest > self.rim).then_some(fastest)
    }
}

/// The larger peak of both.
pub(crate) fn peak<T: Scalar>([a, b]: &[Profile<T>; 2]) -> T {
    larger(a.peak.abs(), b.peak.abs())
}

/// Where a manoeuvre has to lead, in the frame of the robot at its begin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Target<T> {
    pub(crate) position: Vector<T>,
    /// Turn left when the motion at the begin has come to rest \[rad\], in (−π, π].
    pub(crate) turn: T,
    /// Bearing from there, for the first guess \[rad\].
    pub(crate) bearing: T,
    /// Distance from there \[m\],
    pub(crate) distance: T,
    /// and how long driving it takes, from rest to rest \[s\].
    pub(crate) straight: T,
}

/// The shape of a manoeuvre. Two numbers are left, which the end position determines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Candidate<T> {
    /// Turn, drive, turn. Left: angle of the first turn, distance.
    OneDrive {
        /// Backward.
        backward: bool,
        /// Share of the first turn that the drive overlaps.
        first: T,
        /// Share of the last turn that the drive overlaps.
        last: T,
    },
    /// Two drives while the robot turns, once or there and back. Left: both distances.
    TwoDrives {
        /// Angle of the first turn \[rad\]; the second one makes up for it.
        swing: T,
        /// Share of the time without a drive before the first one.
        before: T,
        /// The same between the two.
        between: T,
    },
}

/// Overlaps of turn, drive, turn: all at once where turns are short against the drive, less where they are long. Without any it leads
/// everywhere.
const ONE_DRIVE: [(f64, f64); 5] = [(1.0, 1.0), (0.75, 1.0), (0.5, 1.0), (0.5, 0.75), (0.0, 0.0)];

/// Gaps of two drives: early, late, in the middle, apart.
const TWO_DRIVES: [(f64, f64); 4] = [(0.0, 0.0), (1.0, 0.0), (0.25, 0.25), (0.0, 0.5)];

/// Swings, in units of the angle whose turn takes as long as the drive ([`Candidate::numbered`]).
const SWINGS: [f64; 5] = [0.0, -1.0, 1.0, -2.0, 2.0];

/// Gaps for each swing.
const GAPS: u8 = TWO_DRIVES.len() as u8;

/// Shapes with one drive: of each overlap one forward and one backward.
const ONE: u8 = 2 * ONE_DRIVE.len() as u8;

/// Number of shapes: below [`ONE`] with one drive, then two for each swing and gap.
pub(crate) const CANDIDATES: u8 = ONE + SWINGS.len() as u8 * GAPS;

/// Shapes to a goal that is a matter of driving, in the order in which they are tried.
const FAR: [u8; CANDIDATES as usize] = [
    0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 12, 13, 14, 15, 18, 19, 22, 23, 26, 27, // likely
    8, 9, 16, 17, 20, 21, 24, 25, 28, 29,
];

/// The same to a goal that is a matter of turning: two drives come first.
const NEAR: [u8; CANDIDATES as usize] = [
    10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 26, 4, 5, // likely
    8, 9, 6, 7, 23, 24, 25, 27, 28, 29, 0, 1, 2, 3,
];

/// So many shapes are tried, and the others where none of these leads to the goal: where one does, they are rarely quicker.
pub(crate) fn likely(near: bool) -> u8 {
    if near { 16 } else { 20 }
}

impl<T: Scalar> Candidate<T> {
    /// Shape number `index`; `None` behind the last. `near`: the goal is a matter of turning. Of a goal on the
    /// robot's line that is none: two drives along one line lead nowhere else, however long they are.
    ///
    /// The unit of swings, √(d α/a): turning by it, and driving d, take the same time, and with s ∝ a T² and
    /// φ ∝ α T² a sideways shift of φ s takes the least.
    pub(crate) fn numbered<M: Maths<T>>(
        index: u8,
        near: bool,
        limits: &PlanLimits<T>,
        target: &Target<T>,
    ) -> Option<Self> {
        let f = T::from_f64;
        let shapes = if near { &NEAR } else { &FAR };
        let shape = *shapes.get(usize::from(index))?;
        Some(if let Some(index) = shape.checked_sub(ONE) {
            let unit = M::sqrt(target.distance * limits.turn.up / limits.drive.up);
            let most = T::FRAC_PI_2;
            let unit = if unit > most { most } else { unit };
            let (before, between) = TWO_DRIVES[usize::from(index) % TWO_DRIVES.len()];
            Self::TwoDrives {
                swing: unit * f(SWINGS[usize::from(index / GAPS) % SWINGS.len()]),
                before: f(before),
                between: f(between),
            }
        } else {
            let (first, last) = ONE_DRIVE[usize::from(shape / 2) % ONE_DRIVE.len()];
            Self::OneDrive {
                backward: shape % 2 == 1,
                first: f(first),
                last: f(last),
            }
        })
    }

    /// The first guess of the two numbers; `None` if this shape cannot take less than `best` \[s\].
    pub(crate) fn guess<M: Maths<T>>(
        &self,
        limits: &PlanLimits<T>,
        target: &Target<T>,
        best: T,
    ) -> Option<[T; 2]> {
        let f = T::from_f64;
        let straight = target.straight;
        let turning = |angle| limits.turn.profile::<M>(angle).duration();
        match *self {
            Self::OneDrive {
                backward,
                first,
                last,
            } => {
                let (turned, distance) = if backward {
                    (T::PI, -target.distance)
                } else {
                    (T::ZERO, target.distance)
                };
                let angle = (target.bearing + turned).wrap_angle();
                // The turns of the curved way are shorter than those of the straight one: by a fifth is assumed.
                let apart = (T::ONE - first) * turning(angle)
                    + (T::ONE - last) * turning(target.turn - angle);
                (straight + f(0.8) * apart < best).then_some([angle, distance])
            }
            Self::TwoDrives { swing, .. } => {
                let least = turning(swing) + turning(target.turn - swing);
                let half = T::HALF * target.distance;
                // Drives that take longer than all turning want turns of their own.
                (least < best && straight < f(1.2) * least).then_some([half, -half])
            }
        }
    }

    /// Puts both turns and both drives with these two numbers into `path`.
    fn put_profiles<M: Maths<T>>(
        &self,
        limits: &PlanLimits<T>,
        target: &Target<T>,
        numbers: &[T; 2],
        path: &mut Path<T>,
    ) {
        let [first_number, second_number] = *numbers;
        let ([a, b], [c, d]) = (&mut path.turns, &mut path.drives);
        match *self {
            Self::OneDrive { first, last, .. } => {
                *a = limits.turn.profile::<M>(first_number);
                *b = limits.turn.profile::<M>(target.turn - first_number);
                *c = limits.drive.profile::<M>(second_number);
                *d = Profile::default();
                c.start = a.duration() * (T::ONE - first);
                let wanted = c.start + c.duration() - last * b.duration();
                // One ends before the other starts: ramps that overlap would add up their jerks.
                let earliest = a.duration();
                b.start = if wanted > earliest { wanted } else { earliest };
            }
            Self::TwoDrives {
                swing,
                before,
                between,
            } => {
                *a = limits.turn.profile::<M>(swing);
                *b = limits.turn.profile::<M>(target.turn - swing);
                *c = limits.drive.profile::<M>(first_number);
                *d = limits.drive.profile::<M>(second_number);
                let slack = a.duration() + b.duration() - c.duration() - d.duration();
                if slack > T::ZERO {
                    let one = before * slack;
                    d.start = one + between * slack + c.duration();
                    c.start = one;
                } else {
                    a.start = -(before * slack);
                    d.start = c.duration();
                }
                b.start = a.start + a.duration();
            }
        }
    }

    /// Lays out the manoeuvre with these two numbers in `path`, after the motion there at its begin, from `ready` on \[s\].
    ///
    /// Apart, for the sake of the stack: what it needs the integration of the path, which follows, does not need as well.
    #[inline(never)]
    pub(crate) fn lay_out<M: Maths<T>>(
        &self,
        limits: &PlanLimits<T>,
        target: &Target<T>,
        numbers: &[T; 2],
        ready: T,
        path: &mut Path<T>,
    ) {
        self.put_profiles::<M>(limits, target, numbers, path);
        if let Some(fastest) = limits.fastest_beyond(&path.turns, &path.drives) {
            // Peaks yield, by one factor: that costs less time than a slower clock for the whole. A peak that is cut lasts longer and
            // may meet more of the other axis: what is beyond then does take the slower clock.
            let share = limits.rim / fastest;
            let mut cut = *limits;
            cut.drive.rate = share * peak(&path.drives);
            cut.turn.rate = share * peak(&path.turns);
            self.put_profiles::<M>(&cut, target, numbers, path);
            if let Some(fastest) = limits.fastest_beyond(&path.turns, &path.drives) {
                let by = fastest / limits.rim;
                for profile in path.turns.iter_mut().chain(&mut path.drives) {
                    *profile = profile.slowed(by);
                }
            }
        }
        // What adds to the motion at the begin brakes when that has come to rest, what is against it starts then:
        // decelerations do not add up.
        let mut shift = ready;
        for (profiles, stop) in [
            (&path.turns, &path.stop_turn),
            (&path.drives, &path.stop_drive),
        ] {
            for profile in profiles {
                let busy = if profile.peak * stop.braked_from() < T::ZERO {
                    profile.start
                } else {
                    profile.start + profile.rise + profile.hold
                };
                let wait = stop.duration() - busy;
                if !profile.is_empty() && wait > shift {
                    shift = wait;
                }
            }
        }
        for profile in path.turns.iter_mut().chain(&mut path.drives) {
            profile.start += shift;
        }
    }

    /// Derivative of the end by the two numbers, as the ends of both drives tell it.
    ///
    /// An end is about proportional to its distance. Turning earlier turns the whole drive; what overlaps the
    /// turn is turned less, by three tenths is assumed. The steps after the first measure it.
    pub(crate) fn slope(&self, numbers: &[T; 2], ends: &[Vector<T>; 2]) -> [Vector<T>; 2] {
        let per = |end: Vector<T>, number: T| {
            if number == T::ZERO {
                Vector {
                    x: T::ONE,
                    y: T::ZERO,
                }
            } else {
                end.scaled(T::ONE / number)
            }
        };
        match self {
            Self::OneDrive { .. } => {
                let turned = T::from_f64(0.7);
                let turning = Vector {
                    x: -turned * ends[0].y,
                    y: turned * ends[0].x,
                };
                [turning, per(ends[0], numbers[1])]
            }
            Self::TwoDrives { .. } => [per(ends[0], numbers[0]), per(ends[1], numbers[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{CANDIDATES, FAR, NEAR};

    #[test]
    fn every_shape_is_tried_once() {
        for shapes in [FAR, NEAR] {
            let mut sorted = shapes;
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..CANDIDATES), "{shapes:?}");
        }
    }
}
