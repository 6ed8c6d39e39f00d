//! Gains that follow from the limits of the base.

use super::limits::Limits;
use crate::cast::cast;
use crate::error::{Field, ParamError};
use crate::maths::Maths;
use crate::range::{larger, smaller, within};
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
const DISTURBANCE: f64 = 2.5;

/// Force and moment at this share each take the quarter of a wheel's torque that commands leave.
const DISTURBANCE_SHARE: f64 = 0.125;

/// The heading that following may make of the noise of the position \[rad\].
pub(crate) const NOISE_HEADING_RAD: f64 = 0.03;

impl<T: Scalar> MotionGains<T> {
    /// Gains whose demands suit the limits.
    ///
    /// The turning channel's time scale is √(2 rad/s² / turn_accel), since its peak angular
    /// acceleration saturates at about 2 k₃²/9 · 1 rad/s², whatever the offset; the driving
    /// channel's is √(0.6 m/s² / accel). A weak base gets slow gains instead of saturated ones: with
    /// 10 N and 5 N m on 30 kg stiff gains lose 193 of 300 random starts, these none. Found by
    /// search over offsets, speeds and starts; `docs/motion.md` has the tables.
    pub fn for_limits<M: Maths<T>>(limits: &Limits<T>) -> Self {
        let f = T::from_f64;
        let brake = smaller(limits.accel, limits.brake);
        let turn = smaller(M::sqrt(T::HALF * limits.turn_accel), T::ONE);
        let drive = smaller(M::sqrt(brake / f(0.6)), T::ONE);
        Self {
            decay: f(5.0),
            longitudinal: f(1.2) * larger(f(0.5), drive),
            longitudinal_bound: f(1.5) * drive,
            heading: f(3.0) * turn,
            lateral: f(2.5) * turn * turn,
            slow: f(0.03) / larger(f(0.2), turn),
            approach: f(1.2) * smaller(turn, drive),
            approach_brake: f(0.6) * limits.brake,
            speed_loop: f(3.0),
            turn_loop: f(5.0),
            disturbance: f(DISTURBANCE),
            disturbance_share: f(DISTURBANCE_SHARE),
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

    /// B, the bound of the following law's s₂ and of its input: the heading that a lateral error asks for is sin e_θ = −B/2 at most.
    ///
    /// ```text
    /// B = 1.3 α_max/(2 k₃²/9),   1.3 ≤ B ≤ 1.6
    /// ```
    ///
    /// | symbol | argument | unit |
    /// | --- | --- | --- |
    /// | α_max | `turn_accel` | rad/s² |
    /// | k₃ | `heading` | 1/s |
    ///
    /// At 1.3 turning back out of that heading takes 2 k₃²/9, which is all that a weak base has by
    /// [`for_limits`](Self::for_limits); what a base has beyond that serves a steeper approach. From B = 2 on the
    /// heading would be a quarter turn, where the heading loop has no gain left; at 1.6 cos e_θ leaves it 0.6 of k₃.
    pub(super) fn lateral_bound(&self, turn_accel: T) -> T {
        let f = T::from_f64;
        let share = f(4.5) * turn_accel / (self.heading * self.heading);
        larger(smaller(f(1.3) * share, f(1.6)), f(1.3))
    }

    pub(crate) fn check(&self) -> Result<(), ParamError> {
        for (field, value, low, high) in [
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
        ] {
            within(field, value, low, high)?;
        }
        Ok(())
    }
}
