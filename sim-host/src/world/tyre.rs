//! A tyre over one substep: a spring that forgets over its relaxation length.
//!
//! ```text
//! z' = s − |r ω| z/σ     F = k z     s = r ω − u of the rim forward, −v sideways
//! ```
//!
//! over h by the θ-method. θ = 1/2 is the trapezoidal rule, of second order; 1/2 + β/h takes force and slip a time β further on,
//! which damps a swing of ω by the share β ω of the critical damping: what rubber loses. With F_θ = F + θ (F⁺ − F) = f/h:
//!
//! ```text
//! s⁺ = c f − e     c = (1 + θ h |r ω|/σ)/(θ² h² k)     e = F/(θ² h k) + s (1 − θ)/θ
//! ```
//!
//! | symbol | name | unit |
//! | --- | --- | --- |
//! | z, s | deflection and slip; ⁺ at the end | m, m/s |
//! | F, f | force of the floor on the wheel, and its impulse | N, N s |
//! | k, σ | stiffness, relaxation length | N/m, m |
//! | β | time by which rubber's losses are given | s |

use super::pair::Pair;

/// What a tyre of each wheel is over a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tyre {
    /// 1/θ, θ the share of the end in the mean.
    per_end: Pair,
    /// θ h/σ, what it forgets per speed of the tread \[s/m\].
    fade: Pair,
    /// 1/(θ² h² k) \[m/s per N s\].
    give: Pair,
    /// 1/(θ² h k) \[m/s per N\].
    held: Pair,
    /// (1 − θ)/θ.
    kept: Pair,
}

/// Tyres in substeps of h.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tyres {
    /// k \[N/m\].
    stiff: Pair,
    /// θ of tyres that hold and roll, and what they are by it.
    end: Pair,
    rolling: Tyre,
    /// h/σ \[s/m\].
    forget: f64,
    h: f64,
}

impl Tyre {
    fn new(end: Pair, stiff: Pair, forget: f64, h: f64) -> Self {
        let held = 1.0 / (end * end * stiff * h);
        Self {
            per_end: 1.0 / end,
            fade: end * forget,
            give: held / h,
            held,
            kept: (1.0 - end) / end,
        }
    }

    /// c for a speed of the tread.
    #[inline(always)]
    pub fn give(&self, tread: Pair) -> Pair {
        self.give * (1.0 + self.fade * tread)
    }

    /// e for a force and a slip at the start.
    #[inline(always)]
    pub fn held(&self, force: Pair, slip: Pair) -> Pair {
        self.held * force + self.kept * slip
    }

    /// Force at the end, from those at the start and in the mean. Of a wheel that slips it is the mean: grip bounds it.
    #[inline(always)]
    pub fn end(&self, force: Pair, mean: Pair, slipping: [bool; 2]) -> Pair {
        let end = force + (mean - force) * self.per_end;
        if slipping == [false; 2] {
            return end;
        }
        Pair([0, 1].map(|i| if slipping[i] { mean[i] } else { end[i] }))
    }
}

/// Energy that rubber loses in a swing, over 2π times what it stores: 0.05 to 0.3, of natural rubber near the lower end.
const LOSS_FACTOR: f64 = 0.1;

impl Tyres {
    /// Over `h` \[s\], of stiffnesses k \[N/m\] and relaxation length σ \[m\], between wheel and body that give way by
    /// `per_impulse` \[m/s per N s\].
    pub fn new(stiff: Pair, relaxation_m: f64, per_impulse: Pair, h: f64) -> Self {
        let forget = h / relaxation_m;
        let swing = (stiff * per_impulse).map(f64::sqrt) * h;
        // A loss factor is twice the share of the critical damping. A swing that substeps do not follow is damped more, as the
        // wheel's speed is: by 1/2 it is none.
        let lost = 0.5 * LOSS_FACTOR / swing;
        let unresolved = (swing * swing / 12.0).map(|share| share.min(0.5));
        let end = 0.5 + lost + unresolved;
        Self {
            stiff,
            end,
            rolling: Tyre::new(end, stiff, forget, h),
            forget,
            h,
        }
    }

    /// For wheels of which some slip and whose treads move so fast. A tyre that slips is deflected as far as its grip goes,
    /// whatever the slip; one that rolls on by more than its relaxation length has forgotten the start: both are what they end as, θ = 1.
    #[inline(always)]
    pub fn of(&self, slipping: [bool; 2], tread: Pair) -> Tyre {
        let forgets = Pair::both(self.forget) * tread;
        if slipping == [false; 2] && forgets.all(Pair::both(1.0), |all, one| all <= one) {
            return self.rolling;
        }
        self.implicit([0, 1].map(|i| slipping[i] || forgets[i] > 1.0))
    }

    #[cold]
    fn implicit(&self, which: [bool; 2]) -> Tyre {
        let end = Pair([0, 1].map(|i| if which[i] { 1.0 } else { self.end[i] }));
        Tyre::new(end, self.stiff, self.forget, self.h)
    }
}
