//! The map from odometry's frame to the world's, and its correction.

use super::covariance::{Covariance, SOFTEST, Since};
use super::mean_innovation::MeanInnovation;
use super::params::Fusion;
use super::{Fix, FixOutcome};
use crate::angle::wrap;
use crate::maths::Maths;
use crate::odometry::Biases;
use crate::range::{clamp, larger, smaller};
use crate::scalar::Scalar;
use crate::types::Pose;

/// Relocalisations by wheels that slide, beyond those that were forgiven, before such a one is not believed.
///
/// Every one takes `relocalise_after` fixes: a base that slides for a second at 20 Hz has 7. Wheels that go on sliding
/// are a wrong radius, or a faulty encoder; then fixes are rejected until the pose is stale, which is a fault.
const SLIDES: f64 = 8.0;

/// Share of a slide that each good fix forgives: at 20 Hz a slide a second.
const FORGIVEN: f64 = 0.05;

/// How far off an honest pose may be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Slack<T> {
    m: T,
    rad: T,
}

/// Outliers that agree: their mean, at the time of the last of them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate<T> {
    pose: Pose<T>,
    /// The pose of odometry at that time.
    then: Pose<T>,
    count: u8,
    /// How far the next may be off if the wheels roll.
    slack: Slack<T>,
    /// And if they slide.
    sliding: Slack<T>,
    /// How many of them, the last ones, agree if the wheels roll.
    rolled: u8,
}

/// State of the fusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Correction<T> {
    /// The pose that is reported. With the pose of odometry it is the map between the frames.
    pub(super) pose: Pose<T>,
    /// What rounding has taken off that.
    lost: Pose<T>,
    /// What is still to be corrected.
    pending: Pose<T>,
    /// What drift may have added to the error since fixes last took it away.
    slack: Slack<T>,
    /// Of fixes since the pose was set.
    mean: MeanInnovation<T>,
    candidate: Option<Candidate<T>>,
    /// Slides that good fixes have not forgiven yet.
    slides: T,
    /// What is known of the pose and of the wheels.
    covariance: Covariance<T>,
    /// What odometry did since the last fix.
    since: Since<T>,
    /// What odometry has to add.
    pub(super) biases: Biases<T>,
    pub(super) fix_age_s: T,
}

/// A fix beside the pose that is believed, at its own time.
pub(super) struct Innovation<T> {
    off: Pose<T>,
    then: Pose<T>,
}

impl<T: Copy> Innovation<T> {
    /// Off in the heading \[rad\].
    pub(super) const fn heading(&self) -> T {
        self.off.theta
    }
}

impl<T: Scalar> Correction<T> {
    /// At a pose that is stated.
    pub(super) fn new(fusion: Option<&Fusion<T>>, pose: Pose<T>) -> Self {
        Self {
            pose,
            lost: Pose::default(),
            pending: Pose::default(),
            slack: Slack::default(),
            mean: MeanInnovation::default(),
            candidate: None,
            slides: T::ZERO,
            covariance: fusion.map_or(Covariance::NONE, |fusion| {
                Covariance::stated(&fusion.growth)
            }),
            since: Since::default(),
            biases: Biases::NONE,
            fix_age_s: T::ZERO,
        }
    }

    /// The heading was carried wrongly, by so much \[rad\].
    pub(super) fn turn(&mut self, by: T) {
        self.pose.theta += by;
    }

    /// Elsewhere, where somebody says that the robot is. What is known of the wheels stays.
    pub(super) fn state(&mut self, fusion: Option<&Fusion<T>>, pose: Pose<T>) {
        if let Some(fusion) = fusion {
            self.covariance.state(&fusion.growth);
        }
        self.put(pose);
    }

    fn put(&mut self, pose: Pose<T>) {
        self.pose = pose;
        self.lost = Pose::default();
        self.pending = Pose::default();
        self.slack = Slack::default();
        self.mean = MeanInnovation::default();
        self.candidate = None;
        self.since = Since::default();
    }

    /// A gyro turned by `more` per way than the wheels; at most `most` is believed \[rad/m\].
    pub(super) fn correct_curvature(&mut self, most: T, more: T) {
        self.biases.per_way = clamp(self.biases.per_way + more, most);
    }

    /// A tick in which odometry `moved`: the robot moves with it, and what is to be corrected is, by the exponential that the noise
    /// is derived for. `carried` is a heading that a gyro carries.
    #[inline(always)]
    pub(super) fn advance<M: Maths<T>>(
        &mut self,
        fusion: &Fusion<T>,
        moved: &Moved<'_, T>,
        carried: Option<&Carried<T>>,
        dt: T,
    ) {
        let way = displacement::<T, M>(&self.pose, moved.from, moved.to);
        let (dx, dy) = (way.x, way.y);
        let since = &mut self.since;
        since.x += dx;
        since.y += dy;
        since.way += moved.travel;
        since.turn += moved.turn();
        // Of the way forward tyres lose what accelerates the base, of that backward likewise.
        let BodyAccel { along, aside } = moved.accel;
        let (along, aside) = if moved.travel < T::ZERO {
            (along, aside)
        } else {
            (-along, -aside)
        };
        since.slip.x += along * dx - aside * dy;
        since.slip.y += along * dy + aside * dx;
        since.slip.theta -= moved.turn_lost;
        let share = -M::exp_m1(-(fusion.spread * dt));
        let (position, heading) = (&fusion.position, &fusion.heading);
        let step = Pose {
            x: position.step(self.pending.x, share, dt),
            y: position.step(self.pending.y, share, dt),
            theta: heading.step(self.pending.theta, share, dt),
        };
        self.pose.advance(&sum(&way, &step, T::ONE), &mut self.lost);
        self.pending = sum(&self.pending, &step, -T::ONE);
        let driven = fusion.driven(moved);
        match carried {
            None => self.slack.grow(&driven),
            Some(carried) => self.slack.carry(fusion, &driven, carried, dt),
        }
        if let Some(candidate) = &mut self.candidate {
            candidate.slack.grow(&driven);
            candidate.sliding.grow(&driven);
            candidate.sliding.slide(fusion, dt);
        }
        self.fix_age_s += dt;
    }

    /// Compares a fix of the time when odometry was at `then`; it is at `now`.
    #[inline(always)]
    pub(super) fn compare<M: Maths<T>>(
        &self,
        fix: &Fix<T>,
        then: Pose<T>,
        now: &Pose<T>,
    ) -> Innovation<T> {
        let target = sum(&self.pose, &self.pending, T::ONE);
        let off = difference(&fix.pose, &moved_along::<T, M>(&target, now, &then));
        Innovation { off, then }
    }

    /// Judges a fix. `carried` is the variance of a heading that a gyro carries \[rad²\].
    pub(super) fn take<M: Maths<T>>(
        &mut self,
        fusion: &Fusion<T>,
        fix: &Fix<T>,
        innovation: &Innovation<T>,
        now: &Pose<T>,
        carried: Option<T>,
    ) -> FixOutcome<T> {
        let (position, heading) = (&fusion.position, &fusion.heading);
        let Innovation { off, then } = innovation;
        let since = core::mem::take(&mut self.since);
        self.covariance.pass(&fusion.growth, &since, carried);
        let gate = Slack {
            m: position.gate + self.slack.m,
            rad: heading.gate + self.slack.rad,
        };
        if gate.allows(off) {
            self.mean.see(off);
            let excess = self
                .mean
                .excess(self.covariance.innovations(&fusion.growth));
            let (x, y, theta) = excess;
            if x > T::ZERO || y > T::ZERO || theta > T::ZERO {
                self.doubt(fusion, &since, excess, carried.is_some());
            }
            let taken = self.covariance.take(&fusion.growth, off);
            self.mean.take(&taken.pose);
            self.pending = sum(&self.pending, &taken.pose, T::ONE);
            let learnt = &taken.biases;
            self.correct_curvature(fusion.most_curvature(), learnt.per_way);
            let biases = &mut self.biases;
            biases.per_turn = clamp(biases.per_turn + learnt.per_turn, fusion.drift);
            // No tyre turns less than it rolls by what it pushes.
            let slip = clamp(biases.slip + learnt.slip, fusion.most_slip());
            biases.slip = larger(slip, T::ZERO);
            self.slack.m = self.slack.m * (T::ONE - position.gain);
            self.slack.rad = self.slack.rad * (T::ONE - heading.gain);
            self.candidate = None;
            let left = self.slides - T::from_f64(FORGIVEN);
            self.slides = if left > T::ZERO { left } else { T::ZERO };
            self.fix_age_s = fix.age_s;
            return FixOutcome::Fused;
        }
        let candidate = match &self.candidate {
            Some(earlier) => earlier.joined::<M>(&fix.pose, then, fusion),
            None => Candidate::first(&fix.pose, then, fusion),
        };
        let slid = candidate.rolled < fusion.relocalise_after;
        let tired = slid && self.slides > T::from_f64(SLIDES);
        if candidate.count < fusion.relocalise_after || tired {
            self.candidate = Some(candidate);
            return FixOutcome::Rejected;
        }
        if slid {
            self.slides += T::ONE;
        }
        self.covariance.set(&fusion.growth);
        self.put(moved_along::<T, M>(&candidate.pose, then, now));
        self.fix_age_s = fix.age_s;
        FixOutcome::Relocalised
    }

    /// Fixes stay to one side: the pose is more off than is known, at most by what the wheels did `since` the last one. A heading that a gyro
    /// `carries` does not slide.
    #[cold]
    #[inline(never)]
    fn doubt(&mut self, fusion: &Fusion<T>, since: &Since<T>, excess: (T, T, T), carries: bool) {
        let turned = fusion.two_per_track * since.way.abs() + since.turn.abs();
        let rolled = turned / fusion.two_per_track;
        let within = |excess: T, most: T| smaller(larger(excess, T::ZERO), most * most);
        let (x, y, heading) = excess;
        let heading = if carries {
            T::ZERO
        } else {
            within(heading, turned)
        };
        let more = (within(x, rolled), within(y, rolled), heading);
        self.covariance.widen(&fusion.growth, more);
    }
}

impl<T: Scalar> Candidate<T> {
    fn first(fix: &Pose<T>, then: &Pose<T>, fusion: &Fusion<T>) -> Self {
        let slack = Slack {
            m: fusion.position.agree,
            rad: fusion.heading.agree,
        };
        Self {
            pose: *fix,
            then: *then,
            count: 1,
            slack,
            sliding: slack,
            rolled: 1,
        }
    }

    /// With one more outlier; anew from it, if it disagrees. Outliers that agree only if the wheels slide
    /// agree that odometry is wrong, not by how much: of them the last is taken, not the mean.
    fn joined<M: Maths<T>>(&self, fix: &Pose<T>, then: &Pose<T>, fusion: &Fusion<T>) -> Self {
        let expected = moved_along::<T, M>(&self.pose, &self.then, then);
        let off = difference(fix, &expected);
        let first = Self::first(fix, then, fusion);
        let count = self.count.saturating_add(1);
        if !self.slack.allows(&off) {
            let count = if self.sliding.allows(&off) { count } else { 1 };
            return Self { count, ..first };
        }
        let rolled = self.rolled.saturating_add(1);
        let weight = T::ONE / T::from_i32(i32::from(rolled));
        Self {
            pose: sum(&expected, &off, weight),
            count,
            rolled,
            ..first
        }
    }
}

/// What odometry did in a tick.
pub(super) struct Moved<'a, T> {
    pub(super) from: &'a Pose<T>,
    pub(super) to: &'a Pose<T>,
    /// Between the two \[m\], backward negative.
    pub(super) chord: T,
    /// Way of the middle \[m\], backward negative.
    pub(super) travel: T,
    pub(super) accel: BodyAccel<T>,
    /// Of [`Moved`](crate::odometry::Moved).
    pub(super) turn_lost: T,
}

/// Acceleration of a base by its tyres \[m/s²\]: forward and to the left.
pub(super) struct BodyAccel<T> {
    pub(super) along: T,
    pub(super) aside: T,
}

/// A heading that a gyro carries.
pub(super) struct Carried<T> {
    /// How far it may be off \[rad\].
    pub(super) off: T,
    /// The wheels disagree with it.
    pub(super) slides: bool,
}

impl<T: Scalar> Moved<'_, T> {
    /// \[rad\].
    fn turn(&self) -> T {
        self.to.theta - self.from.theta
    }
}

/// How far a tick drove, times the share that odometry may be wrong by.
struct Driven<T> {
    travel: T,
    drift_m: T,
    drift_rad: T,
}

impl<T: Scalar> Fusion<T> {
    /// The largest curvature bias \[rad/m\]: that of radii which are wrong by the whole drift, each its way.
    fn most_curvature(&self) -> T {
        self.drift * self.two_per_track
    }

    /// The largest slip of tyres \[s²/m\].
    fn most_slip(&self) -> T {
        self.drift * T::from_f64(SOFTEST)
    }

    /// Errors of the radii of opposite sign turn a straight run by twice their share of travel over
    /// track.
    fn driven(&self, moved: &Moved<'_, T>) -> Driven<T> {
        let travel = moved.chord.abs();
        let turn = moved.turn().abs();
        Driven {
            travel,
            drift_m: self.drift * travel,
            drift_rad: self.drift * (self.two_per_track * travel + turn),
        }
    }
}

impl<T: Scalar> Slack<T> {
    /// A heading that is off takes the position along.
    fn grow(&mut self, driven: &Driven<T>) {
        self.m += driven.drift_m + self.rad * driven.travel;
        self.rad += driven.drift_rad;
    }

    /// Where a gyro carries the heading, that is off by what its filter says, and wheels that slide take the position along.
    fn carry(&mut self, fusion: &Fusion<T>, driven: &Driven<T>, heading: &Carried<T>, dt: T) {
        let slid = if heading.slides {
            dt * fusion.slide
        } else {
            T::ZERO
        };
        self.m += driven.drift_m + heading.off * driven.travel + slid;
        self.rad = heading.off;
    }

    /// Wheels that slide, against each other at the worst, for `dt`.
    fn slide(&mut self, fusion: &Fusion<T>, dt: T) {
        let slid = dt * fusion.slide;
        self.m += slid;
        self.rad += fusion.two_per_track * slid;
    }

    /// Written so that what is not a number is not allowed.
    fn allows(&self, off: &Pose<T>) -> bool {
        off.x.abs() <= self.m && off.y.abs() <= self.m && off.theta.abs() <= self.rad
    }
}

/// `pose`, carried along by what odometry did from `from` to `to`: rigidly, forward or back in time.
///
/// Inlined, as what calls it in every tick and for every fix: poses stay in registers, and a tick with a fix takes 115 instructions
/// less.
#[inline(always)]
fn moved_along<T: Scalar, M: Maths<T>>(pose: &Pose<T>, from: &Pose<T>, to: &Pose<T>) -> Pose<T> {
    sum(pose, &displacement::<T, M>(pose, from, to), T::ONE)
}

/// The way of that, in the frame of `pose`.
#[inline(always)]
fn displacement<T: Scalar, M: Maths<T>>(pose: &Pose<T>, from: &Pose<T>, to: &Pose<T>) -> Pose<T> {
    let (sine, cosine) = M::sin_cos(pose.theta - from.theta);
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    Pose {
        x: dx * cosine - dy * sine,
        y: dx * sine + dy * cosine,
        theta: to.theta - from.theta,
    }
}

fn sum<T: Scalar>(pose: &Pose<T>, step: &Pose<T>, weight: T) -> Pose<T> {
    Pose {
        x: pose.x + weight * step.x,
        y: pose.y + weight * step.y,
        theta: pose.theta + weight * step.theta,
    }
}

/// Coordinate by coordinate in the world, the heading's wrapped.
fn difference<T: Scalar>(of: &Pose<T>, from: &Pose<T>) -> Pose<T> {
    Pose {
        x: of.x - from.x,
        y: of.y - from.y,
        theta: wrap(of.theta - from.theta),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::localiser::LocaliserParams;

    /// A heading that a gyro carries may be off by what the gyro says, and no more with the way; the place by the drift, by where that
    /// heading has led, and by what a wheel slides while the two disagree.
    #[test]
    fn a_carried_heading_bounds_the_slack() {
        let params = LocaliserParams::for_test();
        let fusion = params.validate().expect("valid").fusion.expect("fixes");
        let driven = Driven {
            travel: 0.3,
            drift_m: 0.006,
            drift_rad: 0.024,
        };
        // 0.5 m/s for 10 ms.
        for (slides, slid) in [(false, 0.0), (true, 0.005)] {
            let mut slack = Slack { m: 0.1, rad: 0.2 };
            slack.carry(&fusion, &driven, &Carried { off: 0.02, slides }, 0.01);
            assert!((slack.m - (0.1 + 0.006 + 0.02 * 0.3 + slid)).abs() < 1e-15);
            assert_eq!(slack.rad, 0.02);
        }
    }
}
