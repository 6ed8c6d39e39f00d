//! Axis limits, and what falls outside them.

/// A curve's values may stretch an axis made for the main run by this share of its span, at each
/// end. More would flatten the curve that the figure is about.
const STRETCH: f64 = 0.35;
/// Free space at each end, as a share of the span.
const MARGIN: f64 = 0.07;

/// Lowest and highest of some values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub low: f64,
    pub high: f64,
}

impl Span {
    /// Of all values; (0, 0) if there are none.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let empty = Self {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        let span = values.fold(empty, |span, value| Self {
            low: span.low.min(value),
            high: span.high.max(value),
        });
        if span.low <= span.high {
            span
        } else {
            Self {
                low: 0.0,
                high: 0.0,
            }
        }
    }

    /// Both.
    pub fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Stretched towards `other`, within reason.
    pub fn stretched(self, other: Self) -> Self {
        let reach = STRETCH * (self.high - self.low);
        Self {
            low: self.low.min(other.low.max(self.low - reach)),
            high: self.high.max(other.high.min(self.high + reach)),
        }
    }

    /// With free space at both ends; never empty.
    pub fn padded(self) -> (f64, f64) {
        let span = self.high - self.low;
        let margin = if span > 1.0e-9 { MARGIN * span } else { 0.5 };
        (self.low - margin, self.high + margin)
    }
}
