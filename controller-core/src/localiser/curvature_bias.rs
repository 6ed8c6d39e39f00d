//! What odometry turns too much or too little on its way: wheels that are not as large as stated.

use crate::range::clamp;
use crate::scalar::Scalar;

/// How fast the curvature bias is learnt from fixes, and how far it is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Learning<T> {
    /// β.
    gain: T,
    /// s₀² \[m²\].
    short: T,
    /// b_max \[rad/m\].
    most: T,
}

impl<T: Scalar> Learning<T> {
    /// For headings of standard deviation `noise` \[rad\] of which the share `alpha` is taken.
    ///
    /// | symbol | what |
    /// | --- | --- |
    /// | b_max = 2 d/l | curvature bias of radii that are wrong by the share d, each its way, at the track l |
    /// | β = α²/4 | heading and curvature bias are one critically damped filter then, with both poles at half of the heading's bandwidth |
    /// | s₀ = 1.8 σ α^1.5/b_max | way between fixes below which it is learnt more slowly, so that noise never shakes it by more than b_max/5 |
    ///
    /// The last by the steady variance: for s far above s₀ that of such a filter, 2 β² σ²/(s² α (4 − 2 α − β)), so a
    /// deviation of 0.18 σ α^1.5/s; for s far below, steps of β s σ/s₀² that decay at β s²/(α s₀²) a fix leave
    /// 0.35 σ α^1.5/s₀ at any speed. Odometry that is said to be exact, d = 0, learns nothing.
    pub(super) fn new(alpha: T, noise: T, most: T) -> Self {
        let f = T::from_f64;
        if most <= T::ZERO {
            return Self {
                gain: T::ZERO,
                short: T::ONE,
                most: T::ZERO,
            };
        }
        let short = f(1.8) * noise * alpha / most;
        Self {
            gain: f(0.25) * alpha * alpha,
            short: short * short * alpha,
            most,
        }
    }
}

/// The curvature bias: turn that odometry has to add per way \[rad/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CurvatureBias<T> {
    pub(super) value: T,
    /// Way since the last good fix, backward negative \[m\].
    way: T,
}

impl<T: Scalar> CurvatureBias<T> {
    /// A tick's way.
    pub(super) fn drive(&mut self, travel: T) {
        self.way += travel;
    }

    /// A heading was off by `off` \[rad\] after the way since the last: b ← b + β s off/(s² + s₀²), within ± b_max.
    pub(super) fn learn(&mut self, learning: &Learning<T>, off: T) {
        let s = self.way;
        let step = learning.gain * s * off / (s * s + learning.short);
        self.value = clamp(self.value + step, learning.most);
        self.way = T::ZERO;
    }

    /// A gyro turned by `more` per way than the wheels; at most `most` is believed \[rad/m\].
    pub(super) fn correct(&mut self, most: T, more: T) {
        self.value = clamp(self.value + more, most);
    }

    /// The pose was set: what lies behind says nothing any more.
    pub(super) fn forget_way(&mut self) {
        self.way = T::ZERO;
    }
}
