//! A time warp: where on the file's own time the base is.

/// A knot of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tick {
    /// Time of the base.
    pub(super) t: f64,
    /// Time of the file.
    pub(super) s: f64,
    /// ds/dt and d²s/dt².
    pub(super) rate: f64,
    pub(super) rate_dot: f64,
}

/// s(t): quintic between knots, so that s, ds/dt and d²s/dt² are continuous, and with them pose,
/// twist and acceleration of what runs under the law.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TimeWarp {
    ticks: Vec<Tick>,
}

/// Samples of a warped trajectory are about this far apart \[s\].
const SPACING: f64 = 0.02;

impl TimeWarp {
    pub(super) fn new(ticks: Vec<Tick>) -> Self {
        Self { ticks }
    }

    pub(super) fn duration(&self) -> f64 {
        self.ticks.last().map_or(0.0, |tick| tick.t)
    }

    pub(super) fn ticks(&self) -> &[Tick] {
        &self.ticks
    }

    /// The law with time running `factor` times as long.
    pub(super) fn slower(mut self, factor: f64) -> Self {
        for tick in &mut self.ticks {
            tick.t *= factor;
            tick.rate /= factor;
            tick.rate_dot /= factor * factor;
        }
        self
    }

    /// s, ds/dt and d²s/dt² at t within the law.
    pub(super) fn at(&self, t: f64) -> (f64, f64, f64) {
        let after = self.ticks.partition_point(|tick| tick.t <= t);
        let (Some(from), Some(to)) = (
            self.ticks.get(after.saturating_sub(1)),
            self.ticks.get(after),
        ) else {
            let end = self.ticks.last();
            return end.map_or((0.0, 1.0, 0.0), |e| (e.s, e.rate, e.rate_dot));
        };
        let h = to.t - from.t;
        let p = (t - from.t) / h;
        // s = s0 + h (r0 p + d0 h p²/2 + c3 p³ + c4 p⁴ + c5 p⁵), from value, slope, curvature at p = 1.
        let rise = (to.s - from.s) / h - from.rate - 0.5 * h * from.rate_dot;
        let slope = to.rate - from.rate - h * from.rate_dot;
        let curvature = h * (to.rate_dot - from.rate_dot);
        let c3 = 10.0 * rise - 4.0 * slope + 0.5 * curvature;
        let c4 = -15.0 * rise + 7.0 * slope - curvature;
        let c5 = 6.0 * rise - 3.0 * slope + 0.5 * curvature;
        let tail = p * p * p * (c3 + p * (c4 + p * c5));
        let s = from.s + h * (p * (from.rate + 0.5 * h * p * from.rate_dot) + tail);
        let rate =
            from.rate + h * p * from.rate_dot + p * p * (3.0 * c3 + p * (4.0 * c4 + p * 5.0 * c5));
        let rate_dot = from.rate_dot + p * (6.0 * c3 + p * (12.0 * c4 + p * 20.0 * c5)) / h;
        (s, rate, rate_dot)
    }

    /// The rate at s: of the ticks beside it, the lower one.
    pub(super) fn rate_at(&self, s: f64) -> f64 {
        let after = self.ticks.partition_point(|tick| tick.s <= s);
        let near = after.saturating_sub(1)..(after + 1).min(self.ticks.len());
        let rates = self.ticks.get(near).unwrap_or_default().iter();
        rates.map(|tick| tick.rate).fold(f64::INFINITY, f64::min)
    }

    /// The time at which the law is at s.
    pub(super) fn time_of(&self, s: f64) -> f64 {
        let after = self.ticks.partition_point(|tick| tick.s <= s);
        let (Some(from), Some(to)) = (
            self.ticks.get(after.saturating_sub(1)),
            self.ticks.get(after),
        ) else {
            return self.duration();
        };
        let (mut low, mut high) = (from.t, to.t);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.at(middle).0 < s {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Instants of samples: knots, thinned, with the first and the last.
    pub(super) fn times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = Vec::new();
        for tick in &self.ticks {
            if times.last().is_none_or(|last| tick.t >= last + SPACING) {
                times.push(tick.t);
            }
        }
        let end = self.duration();
        if times.len() > 1 && times.last().is_some_and(|last| *last < end) {
            times.pop();
        }
        if times.last().is_some_and(|last| *last < end) {
            times.push(end);
        }
        times
    }
}
