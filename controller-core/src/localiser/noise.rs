//! What is left of the fixes' noise.

use crate::maths::Maths;
use crate::motion::{HEADING_DEVIATIONS, NEW_APPROACH};
use crate::odometry::OdometryParams;
use crate::scalar::Scalar;

/// 1/e.
const KEPT: f64 = 0.367_879_441_171_442_3;

/// Variance of the reported pose over that of a fix.
///
/// Two things happen to the noise n of fixes T apart. The target of the correction follows them,
/// s⁺ = (1 − g) s + g n with g = 1 − exp(−ω T), so that E s² = S = σ² g/(2 − g); and what is still to
/// be corrected, p⁺ = p + g (n − s), is spread: p falls by κ = exp(−ω_s T) until the next fix. Their
/// difference is what is reported. Before a fix
///
/// ```text
/// E s p = κ g S/(1 − κ(1 − g))          E p² = 2 g κ² (S − E s p)/(1 − κ²)
/// ```
///
/// and the mean of E (s − p e^{−ω_s t})² over the time t between two fixes comes to
///
/// ```text
/// σ_f² = σ² g/(2 − g) · (1 − g (1 − κ)/((1 − κ(1 − g)) ω_s T))
/// ```
///
/// Here ω_s T = 1: corrections are spread over the time between fixes. For small ωT it is the
/// σ² ωT/2 of a first-order filter that is driven by white noise.
///
/// | symbol | name | unit |
/// | --- | --- | --- |
/// | σ, σ_f | standard deviation of a fix, of what is reported | m or rad |
/// | ω, ω_s | bandwidth of the correction, of its spreading | rad/s |
/// | T | time between fixes | s |
/// | g | share of an innovation that is taken; `gain`, 0 to 1 | 1 |
pub fn filtered_share<T: Scalar>(gain: T) -> T {
    let kept = T::from_f64(KEPT);
    let two = T::ONE + T::ONE;
    let smoothed = gain * (T::ONE - kept) / (T::ONE - kept * (T::ONE - gain));
    gain / (two - gain) * (T::ONE - smoothed)
}

/// Noise of the parking law per standard deviation of the filtered noise; its radius is 5 of them, so
/// 3 σ_f.
///
/// The law's radius is meant for noise that is new at every tick, of which its neurons let a sixth
/// through: √(A dt/2) at 5 1/s and 10 ms. Filtered noise is slower than the neurons and passes whole,
/// but so is the robot, which follows it instead of trembling. Inside 1.5 radii the law gives up the direction
/// to the goal, so the radius has to hold what the filter wanders within the seconds of an approach. With filters
/// of 0.2, 0.8, 3 rad/s a radius of 1 σ_f parks all of 16 runs too, within 2.5 instead of 3.0 mm, but up to 1.5 s later.
/// More than 3 only leaves the robot farther beside its goal.
const COLOUR: f64 = 0.6;

/// Standard deviation of an encoder's rounding, 1/√12 of a count.
const ROUNDING: f64 = 0.288_675;

/// Standard deviations of the filtered noise in the tolerance of arrival: the noise radius, 5 [`COLOUR`], and one more.
const DISTANCE_DEVIATIONS: f64 = 5.0 * COLOUR + 1.0;

/// Noise of the pose below which a robot parks no better, \[m\] and \[rad\].
///
/// What is left beside the goal is corrected by a [`NEW_APPROACH`], which drives 5 cm and turns by 0.1 rad. However well the pose is known, a robot misses by a
/// share of both: tyres slip, and friction and mass are not what they are held for. With the `drift` of odometry for that share, 2 %, it parks
/// within 1 mm and 2 mrad. Those are the tolerance of arrival at this noise.
pub(super) fn least_noise<T: Scalar>(drift: T) -> (T, T) {
    let (way, turn) = NEW_APPROACH;
    (
        T::from_f64(way / DISTANCE_DEVIATIONS) * drift,
        T::from_f64(turn / HEADING_DEVIATIONS) * drift,
    )
}

/// The bandwidth at which a filter leaves `least` of the `noise` of fixes that come at `rate_hz` \[rad/s\], by σ_f² = σ² ωT/2; it
/// leaves less where ωT is not small.
pub(super) fn bandwidth_for<T: Scalar>(noise: T, least: T, rate_hz: T) -> T {
    let share = least / noise;
    T::from_f64(2.0) * rate_hz * (share * share)
}

/// σ of the parking law \[m\]: fixes and encoders, which know nothing of each other.
pub(super) fn pose_noise<T: Scalar, M: Maths<T>>(odometry: &OdometryParams<T>, filtered: T) -> T {
    let fixes = T::from_f64(COLOUR) * filtered;
    let counts = T::from_f64(ROUNDING) * odometry.travel_per_count_m();
    M::sqrt(fixes * fixes + counts * counts)
}

#[cfg(test)]
mod tests {
    use super::{KEPT, filtered_share};

    /// A correction that takes all of a fix leaves what is not spread yet before the next, 1/e; one that takes little is a filter of
    /// first order that is driven by white noise, ωT/2.
    #[test]
    fn the_share_has_its_limits() {
        assert!((filtered_share(1.0_f64) - KEPT).abs() < 1e-15);
        for gain in [1e-6_f64, 1e-4] {
            assert!((filtered_share(gain) / gain - 0.5).abs() < gain);
        }
    }

    /// Between its limits it is what the two recursions above settle at, fix by fix, with their mean over the time to the next.
    #[test]
    fn the_share_is_what_the_recursions_settle_at() {
        for gain in [0.1, 0.5, 0.9] {
            // Of s and p before a fix: E s², E s p, E p².
            let (mut ss, mut sp, mut pp) = (0.0, 0.0, 0.0);
            let mut mean = 0.0;
            // 0.9² to the power of 500 is left of the start.
            for _ in 0..500 {
                let fix = gain * gain;
                let next = (
                    (1.0 - gain) * (1.0 - gain) * ss + fix,
                    (1.0 - gain) * (sp - gain * ss) + fix,
                    pp - 2.0 * gain * sp + fix * ss + fix,
                );
                mean = next.0 - 2.0 * (1.0 - KEPT) * next.1 + 0.5 * (1.0 - KEPT * KEPT) * next.2;
                (ss, sp, pp) = (next.0, KEPT * next.1, KEPT * KEPT * next.2);
            }
            assert!((filtered_share(gain) - mean).abs() < 1e-12, "{gain}");
        }
    }
}
