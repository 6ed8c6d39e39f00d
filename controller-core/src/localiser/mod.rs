//! Where the robot is: odometry, drawn towards external poses that come rarely, late and noisy.
//!
//! Odometry is smooth and drifts; a camera, beacons or a lidar match do not drift, but each of their
//! poses is wrong by millimetres, is some ticks old, and now and then is nonsense. [`Localiser`]
//! reports the pose of odometry under a rigid map from its frame to the world's, and corrects that map
//! bit by bit: noise is filtered, the pose never steps, and at constant speed nothing lags.
//!
//! * A [`Fix`] is compared with the pose at *its* time, from a ring of the last N poses, under the
//!   map of today: neither its age nor corrections since then are mistaken for errors.
//! * Of the innovation a Kalman filter's share is taken, and spread over the time between fixes: at rest that of the
//!   stated bandwidth, on the way more, since odometry's errors grow with way and turn. A heading correction turns the
//!   robot where it stands, and not the world about its origin.
//! * Headings and places that are off on the way, always to the same side, show that the wheels are not as large as
//!   stated, and headings that are off after turns, always by the same share, that they are not as far apart: odometry learns this curvature
//!   bias and this turn bias with the pose, and keeps them where no fix comes. So it learns what tyres slip under what they transmit, of a
//!   robot whose mass and inertia it knows.
//! * Fixes that stay to one side of the pose for longer than noise does, while the base moves, say that wheels slid: then more of each is taken.
//! * An innovation that noise and the odometry's drift cannot explain is an outlier. Outliers that
//!   agree with each other are right: the pose is set, and the estimate says `jumped`, for
//!   [`declare_jump`](crate::motion::MotionController::declare_jump).
//!
//! ```
//! use controller_core::hal::WheelCounts;
//! use controller_core::localiser::{Fix, FixOutcome, FusionParams, Localiser, LocaliserParams};
//! use controller_core::maths::Single;
//! use controller_core::odometry::{Calibration, OdometryParams};
//! use controller_core::types::Pose;
//! use controller_core::wheels::WheelGeometry;
//!
//! let wheels = WheelGeometry { radius_right_m: 0.035, radius_left_m: 0.035, track_m: 0.14 };
//! let params = LocaliserParams {
//!     odometry: OdometryParams {
//!         wheels, calibration: Calibration::NOMINAL, counts_per_turn: 2048.0, bandwidth: 50.0,
//!     },
//!     fusion: Some(FusionParams::for_source(5.0e-3_f32, 5.0e-3, 20.0)),
//!     gyro: None,
//! };
//! let localisation = params.validate()?;
//! let counts = WheelCounts::default();
//! let mut localiser = Localiser::<f32, 32>::start(&localisation, Pose::default(), counts)?;
//! let fix = Fix { pose: Pose::new(0.004, 0.0, 0.0), age_s: 0.0 };
//! let estimate = localiser.update::<Single>(counts, 0.01, Some(&fix))?;
//! assert_eq!(estimate.fix, FixOutcome::Fused);
//! assert_eq!(estimate.measured.pose.x, 0.0); // corrected from the next tick on
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

mod covariance;
mod estimator;
mod fusion;
mod history;
mod mean_innovation;
mod noise;
mod params;
mod parking;

pub use history::LEAST_APART_S;
pub use noise::filtered_share;
pub use params::{FusionParams, LocaliserParams, ValidLocaliserParams};

use crate::error::StepFault;
use crate::gyro::{GyroReading, GyroReport};
use crate::hal::WheelCounts;
use crate::maths::Maths;
use crate::odometry::Accelerations;
use crate::scalar::Scalar;
use crate::types::{Accel, Measured, Pose, WheelSpeeds};
pub(crate) use estimator::Estimator;

/// Standard deviations by which a heading that a gyro carries may be off.
const SURE: f64 = 3.0;

/// An external pose that was valid some time ago.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fix<T = f32> {
    /// In the world frame; the heading may be wrapped or not.
    pub pose: Pose<T>,
    /// How long before this tick it was valid \[s\], 0 or more.
    pub age_s: T,
}

/// What became of the fix of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FixOutcome<T> {
    /// There was none.
    #[default]
    Absent,
    /// Part of it is being taken over.
    Fused,
    /// An outlier: nothing is taken of it, but it is remembered for its successors to agree with.
    Rejected,
    /// The last of so many outliers that agree: the pose is now what they say.
    Relocalised,
    /// Not a fix that could be used; nothing is remembered of it.
    Refused(Refusal<T>),
}

/// Why a fix cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal<T> {
    /// A coordinate or the age is NaN or infinite, or the pose farther than one [may be](Pose::is_near).
    NotFinite,
    /// It is from the future.
    NegativeAge,
    /// It is older than the poses that are remembered, or than the start.
    TooOld {
        /// Age of the oldest pose remembered \[s\].
        oldest_s: T,
    },
    /// The localiser was set up without fusion.
    NoFusion,
}

/// What is known after a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate<T> {
    /// Pose and twist now.
    pub measured: Measured<T>,
    /// What became of the fix.
    pub fix: FixOutcome<T>,
    /// Turn that odometry adds per way, learnt from the headings of fixes \[rad/m\]: wheels of other radii than
    /// stated. At most 2 `drift`/track, where it stays if odometry is worse than that; 0 without fusion.
    pub curvature_bias: T,
    /// Turn that odometry adds per turn, learnt likewise \[rad/rad\]: wheels that are not as far apart as stated. At most `drift`; 0 without
    /// fusion, and while a gyro carries the heading nothing is learnt.
    pub turn_bias: T,
    /// What tyres slip per acceleration, learnt likewise \[s²/m\]: 1/(C g) of tyres that are C times as stiff, per unit of slip, as they are
    /// loaded. Odometry takes off what they lose of way and turn by the accelerations that it is given.
    /// 0, rigid, to `drift`/(0.2 g); 0 without [a robot](ValidLocaliserParams::with_robot).
    pub tyre_slip: T,
    /// The pose was set: the caller has to `declare_jump` to the controller.
    pub jumped: bool,
    /// How long ago the last fix that was fused was valid \[s\]; without any, time since the start.
    pub fix_age_s: T,
    /// `fix_age_s` is above `stale_s`. Never without fusion.
    pub stale: bool,
    /// What is known of the gyro.
    pub gyro: GyroReport<T>,
}

/// Pose and twist from encoders and fixes; remembers N ≥ 2 poses, as far back as N − 1 ticks, of [`LEAST_APART_S`] at least.
///
/// A tick costs odometry, one sine and cosine and an exponential; a fix adds two of the former, three
/// updates of twenty-one covariances and a walk through at most N poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Localiser<T, const N: usize> {
    localisation: ValidLocaliserParams<T>,
    estimator: Estimator<T, N>,
}

impl<T: Scalar, const N: usize> Localiser<T, N> {
    /// At rest at `pose`, with the encoders at `counts`.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn start(
        localisation: &ValidLocaliserParams<T>,
        pose: Pose<T>,
        counts: WheelCounts,
    ) -> Result<Self, StepFault> {
        Estimator::<T, N>::check(&pose)?;
        let mut localiser = Self {
            localisation: *localisation,
            estimator: Estimator::new(localisation),
        };
        localiser.estimator.begin(localisation, pose, counts);
        Ok(localiser)
    }

    /// One tick, `dt` \[s\] after the last; `fix` if one has come.
    ///
    /// # Errors
    /// A `dt` that is not positive and finite. Nothing has changed then.
    pub fn update<M: Maths<T>>(
        &mut self,
        counts: WheelCounts,
        dt: T,
        fix: Option<&Fix<T>>,
    ) -> Result<Estimate<T>, StepFault> {
        self.update_with_accel::<M>(counts, dt, &Accel::default(), fix)
    }

    /// [`update`](Self::update) with the acceleration that the torques of this tick were to cause; see
    /// [`Odometry::update_with_accel`](crate::odometry::Odometry::update_with_accel).
    ///
    /// # Errors
    /// A `dt` that is not positive and finite, an acceleration that is not finite. Nothing has changed
    /// then.
    pub fn update_with_accel<M: Maths<T>>(
        &mut self,
        counts: WheelCounts,
        dt: T,
        accel: &Accel<T>,
        fix: Option<&Fix<T>>,
    ) -> Result<Estimate<T>, StepFault> {
        self.update_with::<M>(counts, dt, accel, fix, None)
    }

    /// [`update_with_accel`](Self::update_with_accel) with what a gyro measured, if a reading has come.
    ///
    /// # Errors
    /// As there.
    pub fn update_with<M: Maths<T>>(
        &mut self,
        counts: WheelCounts,
        dt: T,
        accel: &Accel<T>,
        fix: Option<&Fix<T>>,
        reading: Option<&GyroReading<T>>,
    ) -> Result<Estimate<T>, StepFault> {
        let Self {
            localisation,
            estimator,
        } = self;
        let accelerations = Accelerations::exerted(*accel);
        let tick = estimator.roll(localisation, counts, dt, &accelerations)?;
        Ok(estimator.update::<M>(localisation, tick, &accelerations, fix, reading))
    }

    /// Puts the robot elsewhere on the map, with the same duty to declare it as a relocalisation.
    /// Speeds carry on; corrections under way are dropped.
    pub fn set_pose(&mut self, pose: Pose<T>) {
        self.estimator.set_pose(&self.localisation, pose);
    }

    /// See [`Odometry::back_emf_speeds`](crate::odometry::Odometry::back_emf_speeds).
    pub fn back_emf_speeds(&self) -> WheelSpeeds<T> {
        self.estimator.odometry().back_emf_speeds()
    }

    /// The pose of the last update.
    pub fn pose(&self) -> &Pose<T> {
        self.estimator.pose(&self.localisation)
    }

    /// How long ago the last fix that was fused was valid \[s\]; without any, time since the start.
    pub fn fix_age_s(&self) -> T {
        self.estimator.fix_age_s()
    }

    /// The same for whoever watches over how long a base drives without fixes: while a gyro carries the heading to 20 mrad (a standard deviation), and for at most
    /// [`carry_s`](crate::gyro::GyroParams::carry_s), the time since it last did not.
    pub fn uncarried_s(&self) -> T {
        self.estimator.uncarried_s(&self.localisation)
    }

    /// Turn that odometry adds per way \[rad/m\]; see [`Estimate::curvature_bias`].
    pub const fn curvature_bias(&self) -> T {
        self.estimator.curvature_bias()
    }

    /// Turn that odometry adds per turn \[rad/rad\]; see [`Estimate::turn_bias`].
    pub const fn turn_bias(&self) -> T {
        self.estimator.turn_bias()
    }

    /// What tyres slip per acceleration \[s²/m\]; see [`Estimate::tyre_slip`].
    pub const fn tyre_slip(&self) -> T {
        self.estimator.tyre_slip()
    }

    /// The parameters in use.
    pub fn localisation(&self) -> &ValidLocaliserParams<T> {
        &self.localisation
    }
}
