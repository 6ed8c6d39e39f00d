//! Gains that follow from the limits of the base.

use super::limits::Limits;
use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::maths::Maths;
use crate::range::{check_ranges, larger, smaller};
use crate::scalar::Scalar;

/// Gains of following and parking. [`MotionGains::for_limits`] gives those that suit a base.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionGains<T = f32> {
    /// A \[1/s\]: decay of the pose neurons and of the transition offset. 0.1 to 100.
    pub decay: T,
    /// k₁ \[1/s\]: along the path. 1e-3 to 100.
    pub longitudinal: T,
    /// Largest speed that an error along the path adds \[m/s\]. 1e-3 to 100.
    pub longitudinal_bound: T,
    /// k₃ \[1/s\]: heading. 1e-3 to 100.
    pub heading: T,
    /// c \[1/s²\]: across the path; k₂ of the paper is c/(v_r² + v_f²). 1e-3 to 100.
    pub lateral: T,
    /// v_f \[m/s\]: below this reference speed lateral correction fades out. 1e-4 to 10.
    pub slow: T,
    /// k₄ \[1/s\]: towards the goal. 1e-3 to 100.
    pub approach: T,
    /// Deceleration that the approach to a far goal is planned with \[m/s²\]. 1e-4 to 1e3.
    pub approach_brake: T,
    /// Bandwidth of the speed loop, k_d1/m \[1/s\]. 0.1 to 1e3.
    pub speed_loop: T,
    /// Bandwidth of the turn-rate loop, k_d2/I \[1/s\]. 0.1 to 1e3.
    pub turn_loop: T,
    /// ω \[1/s\]: bandwidth of the disturbance estimate, the loop's integral action. 0 (none) to 50.
    pub disturbance: T,
    /// Largest disturbance that is compensated, as a share of the largest force and of the largest
    /// moment of the wheels. 0 to 1.
    pub disturbance_share: T,
}

cast!(MotionGains {
    decay,
    longitudinal,
    longitudinal_bound,
    heading,
    lateral,
    slow,
    approach,
    approach_brake,
    speed_loop,
    turn_loop,
    disturbance,
    disturbance_share
});

/// ω \[1/s\]. The velocity loops of 3 and 5/s then cross over at 5.7 and 7.7 rad/s with 59° and 54° of
/// phase margin, and with half the mass, 20 ms of delay and a speed estimate of 50 rad/s, at 11 and
/// 15 rad/s with 49° and 37°. See `docs/motion.md`.
pub(super) const DISTURBANCE: f64 = 2.5;

/// Force and moment at this share each take the quarter of a wheel's torque that commands leave.
const DISTURBANCE_SHARE: f64 = 0.125;

/// k_a, parking by feedback: gain on the bearing error, per unit of the approach's gain. With [`COUPLING`] the best of a search
/// over 90 hand-over states and 324 starts from rest at equal peak moment; `docs/motion.md`.
pub(crate) const BEARING: f64 = 1.6;

/// h, parking by feedback: how strongly the goal's heading curves the approach.
pub(crate) const COUPLING: f64 = 0.4;

/// Of exact poses: a lateral error \[m\], and the heading that following may make of it at any speed \[rad\]. In single precision
/// rounding, 1e-7 m, then asks for moments that nobody feels.
const EXACT: (f64, f64) = (1.0e-3, 0.014);

/// The heading that following may make of the noise of the position \[rad\].
pub(crate) const NOISE_HEADING_RAD: f64 = 0.03;

impl<T: Scalar> MotionGains<T> {
    /// Gains that suit ticks of `period_s` \[s\] and these limits.
    ///
    /// ```text
    /// A = 2/(5 T), 5 to 20/s        k₃ = min(max(A/5, 3/s), √(10 α_max))        c = min(c of k₃ and A by the lateral pair, k₃ √α_max)
    /// ```
    ///
    /// | symbol | argument | unit |
    /// | --- | --- | --- |
    /// | T | `period_s` | s |
    /// | α_max | `turn_accel` of the limits | rad/s² |
    ///
    /// * A neuron's lag is two and a half ticks, and no less than the 50 ms between the poses of a camera at 20 Hz. With 5/s and 3/s a base of ticks of
    ///   a quarter of a second is still stable (`docs/robustness.md`).
    /// * A heading takes five such lags. With velocity loop and disturbance estimate that leaves ten ticks of torque delay at 10 ms. And of an
    ///   error of 5 mrad, which a pose makes, it asks for no more than a manoeuvre leaves: k₃² · 5 mrad is a twentieth of α_max.
    /// * Turning from the 45° of an approach into the path, in k₃/c, takes some 0.8 (c/k₃)². Whatever the gain, no heading is asked for
    ///   that the base cannot stop at.
    ///
    /// The driving channel's time scale is √(0.6 m/s² / accel), that of an approach by feedback also √(2 rad/s² / turn_accel): a weak base
    /// gets slow gains instead of saturated ones. `docs/motion.md` has the tables.
    pub fn for_limits<M: Maths<T>>(limits: &Limits<T>, period_s: T) -> Self {
        let f = T::from_f64;
        let brake = smaller(limits.accel, limits.brake);
        let turn = smaller(M::sqrt(T::HALF * limits.turn_accel), T::ONE);
        let drive = smaller(M::sqrt(brake / f(0.6)), T::ONE);
        let decay = larger(smaller(f(20.0), f(0.4) / period_s), f(5.0));
        let (stiffest, steepest) = turning_limits::<T, M>(limits.turn_accel);
        let heading = smaller(larger(f(0.2) * decay, f(3.0)), stiffest);
        let gains = Self {
            decay,
            longitudinal: f(1.2) * larger(f(0.5), drive),
            longitudinal_bound: f(1.5) * drive,
            heading,
            lateral: smaller(stiffness::<T, M>(heading, decay), heading * steepest),
            slow: f(0.03),
            approach: f(1.2) * smaller(turn, drive),
            approach_brake: f(0.6) * limits.brake,
            speed_loop: f(3.0),
            turn_loop: f(5.0),
            disturbance: f(DISTURBANCE),
            disturbance_share: f(DISTURBANCE_SHARE),
        };
        let (aside, turned) = EXACT;
        Self {
            slow: larger(gains.slow, gains.slow_for(f(aside), f(turned))),
            ..gains
        }
    }

    /// The `slow` with which a lateral error asks for at most this heading \[rad\], whatever the speed.
    ///
    /// ```text
    /// v_f = c e_y/(2 k₃ e_θ),   since c e_y v/(k₃ (v² + v_f²)) is largest at v = v_f
    /// ```
    ///
    /// | symbol | argument | unit |
    /// | --- | --- | --- |
    /// | c, k₃ | `lateral`, `heading` | 1/s², 1/s |
    /// | e_y | `lateral_m` | m |
    /// | e_θ | `heading_rad` | rad |
    pub fn slow_for(&self, lateral_m: T, heading_rad: T) -> T {
        T::HALF * self.lateral * lateral_m / (self.heading * heading_rad)
    }

    /// Decay \[1/s\] of the neurons of parking by feedback.
    ///
    /// ```text
    /// A₄ = min(A, 4 ζ² (k_a + 1 + h) k₄)          s² + A₄ s + A₄ (k_a + 1 + h) k₄ of a neuron and the bearing has damping ζ
    /// ```
    ///
    /// | symbol | argument | unit |
    /// | --- | --- | --- |
    /// | A, k₄ | `decay`, `approach` | 1/s |
    /// | ζ | that of the lateral pair, 0.8 | – |
    ///
    /// No quicker, though poses and ticks may allow it: a robot that friction holds gets no nearer, and a command that has fallen with the error
    /// already leaves it further off than one that still has some of the last second's.
    pub(crate) fn approach_decay(&self) -> T {
        let share = 4.0 * DAMPING * DAMPING * (BEARING + 1.0 + COUPLING);
        smaller(self.decay, T::from_f64(share) * self.approach)
    }

    pub(crate) fn check(&self) -> Result<(), ParamError> {
        check_ranges![
            (Field::DecayA, self.decay, 0.1, 100.0),
            (Field::K1, self.longitudinal, 1.0e-3, 100.0),
            (
                Field::LongitudinalBound,
                self.longitudinal_bound,
                1.0e-3,
                100.0,
            ),
            (Field::K3, self.heading, 1.0e-3, 100.0),
            (Field::K2, self.lateral, 1.0e-3, 100.0),
            (Field::SlowSpeed, self.slow, 1.0e-4, 10.0),
            (Field::K4, self.approach, 1.0e-3, 100.0),
            (Field::ApproachBrake, self.approach_brake, 1.0e-4, 1.0e3),
            (Field::SpeedLoop, self.speed_loop, 0.1, 1.0e3),
            (Field::TurnLoop, self.turn_loop, 0.1, 1.0e3),
            (Field::DisturbanceBandwidth, self.disturbance, 0.0, 50.0),
            (Field::DisturbanceShare, self.disturbance_share, 0.0, 1.0),
        ]
    }
}

/// The largest k₃ and c/k₃ \[1/s\] that suit a largest angular acceleration \[rad/s²\]: √(10 α_max) and √α_max; see
/// [`MotionGains::for_limits`].
pub(crate) fn turning_limits<T: Scalar, M: Maths<T>>(turn_accel: T) -> (T, T) {
    (M::sqrt(T::from_f64(10.0) * turn_accel), M::sqrt(turn_accel))
}

/// Damping of the lateral pair \[-\]: an overshoot of 1.5 %.
const DAMPING: f64 = 0.8;

/// k₃ and c whose lateral loop λ³ + (A + k₃)λ² + A k₃ λ + A c has the pair λ² + 2ζωλ + ω²:
///
/// ```text
/// k₃ = 2ζω + ω²/(A − 2ζω)          c = ω² (1 + ω²/(A (A − 2ζω)))
/// ```
///
/// | symbol | argument | unit |
/// | --- | --- | --- |
/// | ω | `omega` | 1/s |
/// | ζ | `damping` | – |
/// | A | `decay` | 1/s |
pub(crate) fn lateral_pair<T: Scalar>(omega: T, damping: T, decay: T) -> (T, T) {
    let sum = (damping + damping) * omega;
    let square = omega * omega;
    let third = square / (decay - sum);
    (sum + third, square * (T::ONE + third / decay))
}

/// The c of [`lateral_pair`] that belongs to k₃, with [`DAMPING`]: (4ζ² − 1) ω² − 2ζ (A + k₃) ω + A k₃ = 0.
fn stiffness<T: Scalar, M: Maths<T>>(heading: T, decay: T) -> T {
    let damping = T::from_f64(DAMPING);
    let square = T::from_f64(4.0 * DAMPING * DAMPING - 1.0);
    let half = damping * (decay + heading);
    let omega = (half - M::sqrt(half * half - square * decay * heading)) / square;
    lateral_pair(omega, damping, decay).1
}
