//! Pose and twist of a tick, also where the encoders gave nothing.

use super::io::Sensed;
use super::report::BaseReport;
use crate::error::StepFault;
use crate::gyro::GyroReport;
use crate::localiser::{Estimator, FixOutcome, ValidLocaliserParams};
use crate::maths::Maths;
use crate::odometry::{Accelerations, Odometry};
use crate::reference::sinc;
use crate::scalar::{Scalar, microseconds};
use crate::types::{Measured, Pose};

/// The localiser, and what it needs across ticks without a reading beside the report of the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Locator<T, const N: usize> {
    /// `None` before the first reading.
    localiser: Option<Estimator<T, N>>,
    /// Where the base is if there was no reading yet, or if it was `set` there since the last tick.
    start: Pose<T>,
    /// Time since the last reading \[s\].
    blind_s: T,
    set: bool,
}

/// What is known of the pose at a tick, beside what stands in its report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Located {
    /// How long the base has been without poses, and without a gyro that carries it instead \[µs\]; 0 without a localisation
    /// that could be stale.
    pub(super) fix_age_us: u32,
    pub(super) jumped: bool,
}

impl Located {
    /// Nothing is known of a tick that is refused.
    const NOT: Self = Self {
        fix_age_us: 0,
        jumped: false,
    };
}

impl<T: Scalar, const N: usize> Locator<T, N> {
    pub(super) fn new(start: Pose<T>) -> Self {
        Self {
            localiser: None,
            start,
            blind_s: T::ZERO,
            set: false,
        }
    }

    /// That of the last reading.
    pub(super) fn odometry(&self) -> Option<&Odometry<T>> {
        self.localiser.as_ref().map(Estimator::odometry)
    }

    /// For other parameters: begins anew, where it was by the last report.
    pub(super) fn begin_anew(&mut self, reported: Option<&Measured<T>>) {
        let last = reported.map(|measured| self.with_set(measured).pose);
        // In place: a whole one would be made on the stack first.
        self.localiser = None;
        self.start = last.unwrap_or(self.start);
        self.blind_s = T::ZERO;
        self.set = false;
    }

    /// What was measured, but where the base was set since.
    fn with_set(&self, measured: &Measured<T>) -> Measured<T> {
        Measured {
            pose: if self.set { self.start } else { measured.pose },
            ..*measured
        }
    }

    /// The pose is set; the next tick says that it jumped.
    pub(super) fn set_pose(&mut self, localisation: &ValidLocaliserParams<T>, pose: Pose<T>) {
        self.start = pose;
        self.set = true;
        if let Some(localiser) = &mut self.localiser {
            localiser.set_pose(localisation, pose);
        }
    }

    /// `accelerations` are those since the last tick. Where the base is goes into `report`.
    ///
    /// What the localiser refuses, a tick or an acceleration that is no number, is a fault there. Nothing has changed then.
    pub(super) fn advance<M: Maths<T>>(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        dt: T,
        accelerations: &Accelerations<T>,
        sensed: &Sensed<T>,
        report: &mut BaseReport<T>,
    ) -> Located {
        let Ok(counts) = sensed.counts else {
            blind(report);
            self.blind_s += dt;
            let last = report.measured.map(|measured| self.with_set(&measured));
            report.measured = last.map(|last| coast::<T, M>(&last, dt));
            return self.located(localisation, report, false);
        };
        let jumped = match &mut self.localiser {
            None => {
                // In two steps: a result that holds all of it would be copied to and fro.
                let pose = self.start;
                if let Err(fault) = Estimator::<T, N>::check(&pose) {
                    return refused(report, fault);
                }
                let localiser = self.localiser.insert(Estimator::new(localisation));
                localiser.begin(localisation, pose, counts);
                blind(report);
                report.measured = Some(Measured {
                    pose,
                    ..Measured::default()
                });
                false
            }
            Some(localiser) => {
                // The counts of a gap came in all of it.
                let dt = self.blind_s + dt;
                let (fix, gyro) = (sensed.fix.as_ref(), sensed.gyro.as_ref());
                let estimate =
                    match localiser.update::<M>(localisation, counts, dt, accelerations, fix, gyro)
                    {
                        Ok(estimate) => estimate,
                        Err(fault) => return refused(report, fault),
                    };
                report.measured = Some(estimate.measured);
                report.fix = estimate.fix;
                report.gyro = estimate.gyro;
                estimate.jumped
            }
        };
        self.blind_s = T::ZERO;
        report.blind = false;
        self.located(localisation, report, jumped)
    }

    fn located(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        report: &mut BaseReport<T>,
        jumped: bool,
    ) -> Located {
        let jumped = jumped || self.set;
        self.set = false;
        let Some(localiser) = &self.localiser else {
            report.curvature_bias = T::ZERO;
            report.turn_bias = T::ZERO;
            report.tyre_slip = T::ZERO;
            return Located {
                fix_age_us: 0,
                jumped,
            };
        };
        report.curvature_bias = localiser.curvature_bias();
        report.turn_bias = localiser.turn_bias();
        report.tyre_slip = localiser.tyre_slip();
        let fuses = localisation.params().fusion.is_some();
        Located {
            fix_age_us: if fuses {
                microseconds(localiser.uncarried_s(localisation) + self.blind_s)
            } else {
                0
            },
            jumped,
        }
    }
}

/// Reports a tick without a measurement.
fn blind<T: Scalar>(report: &mut BaseReport<T>) {
    report.blind = true;
    report.fix = FixOutcome::Absent;
    report.gyro = GyroReport::default();
}

/// A tick that the localiser refuses.
#[cold]
#[inline(never)]
fn refused<T: Scalar>(report: &mut BaseReport<T>, fault: StepFault) -> Located {
    blind(report);
    report.active_faults.add(fault.into());
    Located::NOT
}

/// Goes on along the arc of the present twist: Eq. (6) over `dt`.
pub(super) fn coast<T: Scalar, M: Maths<T>>(from: &Measured<T>, dt: T) -> Measured<T> {
    let Measured { pose, twist } = from;
    let turn = twist.angular * dt;
    let half = T::HALF * turn;
    let chord = twist.linear * dt * sinc::<T, M>(half);
    let (sine, cosine) = M::sin_cos(pose.theta + half);
    Measured {
        pose: Pose {
            x: pose.x + chord * cosine,
            y: pose.y + chord * sine,
            theta: pose.theta + turn,
        },
        twist: *twist,
    }
}
