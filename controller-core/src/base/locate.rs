//! Pose and twist of a tick, also where the encoders gave nothing.

use super::io::Sensed;
use crate::error::StepFault;
use crate::gyro::GyroReport;
use crate::localiser::{Estimate, FixOutcome, Localiser, ValidLocaliserParams};
use crate::maths::Maths;
use crate::reference::sinc;
use crate::scalar::Scalar;
use crate::types::{Accel, Measured, Pose, WheelSpeeds};

/// The localiser, and what it needs across ticks without a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Locator<T, const N: usize> {
    /// `None` before the first reading.
    localiser: Option<Localiser<T, N>>,
    start: Pose<T>,
    /// Time since the last reading \[s\].
    blind_s: T,
    last: Option<Measured<T>>,
    set: bool,
}

/// What is known at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Located<T> {
    pub(super) measured: Option<Measured<T>>,
    pub(super) fix: FixOutcome<T>,
    /// How long the base has been without poses, and without a gyro that carries it instead \[s\]; `None` without a localisation
    /// that could be stale.
    pub(super) fix_age_s: Option<T>,
    pub(super) jumped: bool,
    pub(super) blind: bool,
    pub(super) curvature_bias: T,
    pub(super) gyro: GyroReport<T>,
}

impl<T: Scalar, const N: usize> Locator<T, N> {
    pub(super) fn new(start: Pose<T>) -> Self {
        Self {
            localiser: None,
            start,
            blind_s: T::ZERO,
            last: None,
            set: false,
        }
    }

    /// Speeds at which the wheels turn \[rad/s\]; of the last reading where there is no new one.
    pub(super) fn wheel_speeds(&self) -> WheelSpeeds<T> {
        let localiser = self.localiser.as_ref();
        localiser.map_or_else(WheelSpeeds::default, Localiser::wheel_speeds)
    }

    /// For other parameters: begins anew, where it was.
    pub(super) fn begin_anew(&mut self) {
        *self = Self::new(self.last.map_or(self.start, |last| last.pose));
    }

    /// The pose is set; the next tick says that it jumped.
    pub(super) fn set_pose(&mut self, pose: Pose<T>) {
        self.start = pose;
        self.set = true;
        if let Some(localiser) = &mut self.localiser {
            localiser.set_pose(pose);
        }
        if let Some(last) = &mut self.last {
            last.pose = pose;
        }
    }

    /// `accel` is what the torques exerted since the last tick were to cause.
    ///
    /// # Errors
    /// The localiser's: a tick or an acceleration that is no number. Nothing has changed then.
    pub(super) fn advance<M: Maths<T>>(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        dt: T,
        accel: &Accel<T>,
        sensed: &Sensed<T>,
    ) -> Result<Located<T>, StepFault> {
        let Ok(counts) = sensed.counts else {
            self.blind_s += dt;
            let coasted = self.last.map(|last| coast::<T, M>(&last, dt));
            self.last = coasted;
            return Ok(self.located(coasted, None, true));
        };
        let estimate = match &mut self.localiser {
            None => {
                // In two steps: a result that holds all of it would be copied to and fro.
                let pose = self.start;
                Localiser::<T, N>::check(&pose)?;
                let localiser = self.localiser.insert(Localiser::new(localisation));
                localiser.begin(pose, counts);
                Estimate {
                    measured: Measured {
                        pose,
                        ..Measured::default()
                    },
                    ..Estimate::default()
                }
            }
            Some(localiser) => {
                // The counts of a gap came in all of it.
                let dt = self.blind_s + dt;
                localiser.update_with::<M>(
                    counts,
                    dt,
                    accel,
                    sensed.fix.as_ref(),
                    sensed.gyro.as_ref(),
                )?
            }
        };
        self.blind_s = T::ZERO;
        self.last = Some(estimate.measured);
        Ok(self.located(Some(estimate.measured), Some(&estimate), false))
    }

    fn located(
        &mut self,
        measured: Option<Measured<T>>,
        estimate: Option<&Estimate<T>>,
        blind: bool,
    ) -> Located<T> {
        let fused =
            |localiser: &&Localiser<T, N>| localiser.localisation().params().fusion.is_some();
        let fusing = self.localiser.as_ref().filter(fused);
        let fix_age_s = fusing.map(|localiser| localiser.uncarried_s() + self.blind_s);
        let jumped = self.set || estimate.is_some_and(|estimate| estimate.jumped);
        self.set = false;
        Located {
            measured,
            fix: estimate.map_or(FixOutcome::Absent, |estimate| estimate.fix),
            fix_age_s,
            jumped,
            blind,
            curvature_bias: self
                .localiser
                .as_ref()
                .map_or(T::ZERO, Localiser::curvature_bias),
            gyro: estimate.map_or_else(GyroReport::default, |estimate| estimate.gyro),
        }
    }
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
