//! One tick of a localiser, with parameters that are lent.

use super::fusion::{BodyAccel, Carried, Correction, Moved};
use super::history::History;
use super::{Estimate, Fix, FixOutcome, Refusal, SURE, ValidLocaliserParams};
use crate::error::{Input, StepFault};
use crate::gyro::{
    Encoder, GyroHeading, GyroOutcome, GyroParams, GyroReading, GyroRefusal, GyroReport, Rolled,
};
use crate::hal::WheelCounts;
use crate::maths::Maths;
use crate::odometry::{self, Accelerations, Odometry};
use crate::scalar::Scalar;
use crate::types::{Accel, Measured, Pose};

/// How much the heading that a gyro carries may be in doubt, as a standard deviation \[rad\]. Three of it lead a base aside by 6 % of its way, three times what
/// wheels alone may be wrong by. A bias that was learnt to 1 mrad/s leaves that after 20 s, one of which a limit of 20°/s is all that is known within a tenth of a second.
const DOUBT_RAD: f64 = 0.02;

/// What a localiser remembers; its parameters are lent: they exist once, wherever it is built in.
// In this order: what a tick needs of odometry and fusion is nearest, the history of poses last. With `Locator` a tick takes 40
// instructions less.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Estimator<T, const N: usize> {
    odometry: Odometry<T>,
    correction: Correction<T>,
    /// Time since a gyro last carried the heading, and that within [`DOUBT_RAD`] \[s\].
    alone_s: T,
    gyro: Option<GyroHeading<T>>,
    history: History<T, N>,
}

/// What the wheels did in a tick.
pub(crate) struct Tick<T> {
    pub(crate) rolled: odometry::Moved<T>,
    /// Of the tyres.
    strain: Accel<T>,
    dt: T,
}

impl<T: Scalar, const N: usize> Estimator<T, N> {
    /// Of [`GyroHeading::encoder`].
    pub(crate) fn encoder(&self) -> Option<Encoder> {
        self.gyro.as_ref()?.encoder()
    }

    /// A pose to start from.
    pub(crate) fn check(pose: &Pose<T>) -> Result<(), StepFault> {
        pose.check(Input::Pose)
    }

    /// Of a robot at the origin that has not [begun](Self::begin).
    #[inline(always)]
    pub(crate) fn new(localisation: &ValidLocaliserParams<T>) -> Self {
        const { assert!(N >= 2, "a ring of at least two poses") };
        let odometry = &localisation.params().odometry;
        let (pose, counts) = (Pose::default(), WheelCounts::default());
        Self {
            odometry: Odometry::of_checked(odometry, pose, counts),
            history: History::new(),
            correction: Correction::new(localisation.fusion.as_ref(), pose),
            gyro: localisation.gyro.as_ref().map(|gyro| {
                let mut heading = GyroHeading::new(gyro);
                heading.set(localisation.fix_heading_variance());
                heading
            }),
            alone_s: T::ZERO,
        }
    }

    /// Before the first update: at rest at a pose that was [checked](Self::check), with the encoders at `counts`.
    pub(crate) fn begin(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        pose: Pose<T>,
        counts: WheelCounts,
    ) {
        self.odometry.begin(pose, counts);
        self.history.begin(pose);
        self.correction.state(localisation.fusion.as_ref(), pose);
    }

    /// The first half of a tick, what the wheels did; see [`Localiser::update_with`](super::Localiser::update_with).
    ///
    /// # Errors
    /// As there.
    #[inline(always)]
    pub(crate) fn roll(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        counts: WheelCounts,
        dt: T,
        accelerations: &Accelerations<T>,
    ) -> Result<Tick<T>, StepFault> {
        if !dt.is_finite() {
            return Err(StepFault::NotFinite(Input::Tick));
        }
        if dt <= T::ZERO {
            return Err(StepFault::TickNotPositive);
        }
        if !accelerations.is_finite() {
            return Err(StepFault::NotFinite(Input::Accel));
        }
        let strain = localisation.tyres.strain(&accelerations.exerted);
        Ok(Tick {
            rolled: self.odometry.roll(counts, &strain),
            strain,
            dt,
        })
    }

    /// The other half, where it is now.
    #[inline(always)]
    pub(crate) fn update<M: Maths<T>>(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        Tick { rolled, strain, dt }: Tick<T>,
        accelerations: &Accelerations<T>,
        fix: Option<&Fix<T>>,
        reading: Option<&GyroReading<T>>,
    ) -> Estimate<T> {
        let before = *self.odometry.pose();
        let tyres = &localisation.tyres;
        let turn = match (&mut self.gyro, &localisation.gyro) {
            (Some(heading), Some(gyro)) => {
                let rolled = Rolled {
                    travel: rolled.travel,
                    turn: rolled.turn,
                    counted: rolled.counted(),
                    dt,
                };
                let turn = heading.advance(gyro, &rolled, reading);
                if let Some(more) = heading.curvature(gyro) {
                    self.correction.correct_curvature(gyro.most_per_way(), more);
                    self.odometry.set_biases(&self.correction.biases);
                }
                let sure = heading.heading_variance() < T::from_f64(DOUBT_RAD * DOUBT_RAD);
                self.alone_s = if heading.carries() && sure {
                    T::ZERO
                } else {
                    self.alone_s + dt
                };
                turn
            }
            _ => rolled.turn,
        };
        let (measured, chord) =
            self.odometry
                .integrate::<M>(&rolled, turn, dt, accelerations, (&strain, tyres.most_s));
        let Some(fusion) = &localisation.fusion else {
            return Estimate {
                measured,
                fix: fix.map_or(FixOutcome::Absent, |_| {
                    FixOutcome::Refused(Refusal::NoFusion)
                }),
                curvature_bias: self.correction.biases.per_way,
                gyro: self.gyro_report(reading),
                ..Estimate::default()
            };
        };
        self.history.push(measured.pose, dt);
        let carried = self.gyro.as_ref().filter(|gyro| gyro.carries());
        let carried = carried.map(|gyro| Carried {
            off: T::from_f64(SURE) * M::sqrt(gyro.heading_variance()),
            slides: gyro.slides_now(),
        });
        let moved = Moved {
            from: &before,
            to: &measured.pose,
            chord,
            travel: rolled.travel,
            accel: BodyAccel {
                along: strain.linear,
                aside: measured.twist.linear * measured.twist.angular,
            },
            turn_lost: rolled.turn_lost,
        };
        self.correction
            .advance::<M>(fusion, &moved, carried.as_ref(), dt);
        let outcome = match fix {
            None => FixOutcome::Absent,
            Some(fix) => match self.then(fix) {
                Err(refusal) => FixOutcome::Refused(refusal),
                Ok(then) => {
                    let variance = fusion.growth.fix_heading();
                    let (correction, gyro) = (&mut self.correction, &mut self.gyro);
                    let mut innovation = correction.compare::<M>(fix, then, &measured.pose);
                    let misled = match (&mut *gyro, &localisation.gyro) {
                        (Some(heading), Some(gyro)) => {
                            heading.judge(gyro, innovation.heading(), variance)
                        }
                        _ => None,
                    };
                    if let Some(misled) = misled {
                        correction.turn(-misled);
                        innovation = correction.compare::<M>(fix, then, &measured.pose);
                    }
                    let carried = gyro.as_ref().filter(|gyro| gyro.carries());
                    let carried = carried.map(GyroHeading::heading_variance);
                    // What is lent to a call is made in memory: here and not in every tick.
                    let pose = measured.pose;
                    let outcome = correction.take::<M>(fusion, fix, &innovation, &pose, carried);
                    self.odometry.set_biases(&correction.biases);
                    if let (FixOutcome::Fused, Some(heading), Some(gyro)) =
                        (&outcome, gyro, &localisation.gyro)
                    {
                        heading.fused(gyro, innovation.heading(), variance);
                    }
                    outcome
                }
            },
        };
        let jumped = outcome == FixOutcome::Relocalised;
        if let (true, Some(gyro)) = (jumped, &mut self.gyro) {
            gyro.set(fusion.growth.fix_heading());
        }
        let fix_age_s = self.correction.fix_age_s;
        Estimate {
            measured: Measured {
                pose: self.correction.pose,
                twist: measured.twist,
            },
            fix: outcome,
            jumped,
            curvature_bias: self.correction.biases.per_way,
            turn_bias: self.correction.biases.per_turn,
            tyre_slip: self.correction.biases.slip,
            fix_age_s,
            stale: fix_age_s > fusion.stale_s,
            gyro: self.gyro_report(reading),
        }
    }

    fn gyro_report(&self, reading: Option<&GyroReading<T>>) -> GyroReport<T> {
        match (&self.gyro, reading) {
            (Some(gyro), _) => gyro.report(),
            (None, Some(_)) => GyroReport {
                outcome: GyroOutcome::Refused(GyroRefusal::NoGyro),
                ..GyroReport::default()
            },
            (None, None) => GyroReport::default(),
        }
    }

    /// The pose of odometry at the time of a fix.
    #[inline(always)]
    fn then(&self, fix: &Fix<T>) -> Result<Pose<T>, Refusal<T>> {
        if !(fix.pose.is_near() && fix.age_s.is_finite()) {
            return Err(Refusal::NotFinite);
        }
        if fix.age_s < T::ZERO {
            return Err(Refusal::NegativeAge);
        }
        let then = self.history.at(fix.age_s);
        then.map_err(|oldest_s| Refusal::TooOld { oldest_s })
    }

    /// See [`Localiser::set_pose`](super::Localiser::set_pose).
    pub(crate) fn set_pose(&mut self, localisation: &ValidLocaliserParams<T>, pose: Pose<T>) {
        if localisation.fusion.is_none() {
            self.odometry.set_pose(pose);
        }
        self.correction.state(localisation.fusion.as_ref(), pose);
        if let Some(gyro) = &mut self.gyro {
            gyro.set(localisation.fix_heading_variance());
        }
    }

    pub(crate) const fn odometry(&self) -> &Odometry<T> {
        &self.odometry
    }

    /// See [`Odometry::count_from`].
    pub(crate) fn count_from(&mut self, counts: WheelCounts, dt: T) {
        self.odometry.count_from(counts, dt);
    }

    pub(super) fn pose(&self, localisation: &ValidLocaliserParams<T>) -> &Pose<T> {
        if localisation.fusion.is_none() {
            self.odometry.pose()
        } else {
            &self.correction.pose
        }
    }

    pub(super) const fn fix_age_s(&self) -> T {
        self.correction.fix_age_s
    }

    /// See [`Localiser::uncarried_s`](super::Localiser::uncarried_s).
    pub(crate) fn uncarried_s(&self, localisation: &ValidLocaliserParams<T>) -> T {
        match &localisation.params().gyro {
            Some(gyro) => self.alone_s(gyro),
            None => self.correction.fix_age_s,
        }
    }

    /// The same of a base with a gyro. Apart, so that one without does not work it out and throw it away.
    #[inline(never)]
    fn alone_s(&self, gyro: &GyroParams<T>) -> T {
        let age = self.correction.fix_age_s;
        if age <= gyro.carry_s && self.alone_s < age {
            self.alone_s
        } else {
            age
        }
    }

    pub(crate) const fn curvature_bias(&self) -> T {
        self.correction.biases.per_way
    }

    pub(crate) const fn tyre_slip(&self) -> T {
        self.correction.biases.slip
    }

    pub(crate) const fn turn_bias(&self) -> T {
        self.correction.biases.per_turn
    }
}
