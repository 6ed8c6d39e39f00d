//! What is left of the fixes' noise.

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
