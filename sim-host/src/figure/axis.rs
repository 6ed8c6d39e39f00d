//! An axis: its range, and where numbers or names are on it.

/// An axis has at most so many steps between its numbers.
const MOST_STEPS: f64 = 7.5;
/// An axis of so many decades has a number for each only.
const MANY_DECADES: f64 = 3.5;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    Linear,
    Log,
}

#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub range: (f64, f64),
    pub scale: Scale,
    pub label: String,
    /// Names at 1, 2, 3 instead of numbers.
    pub names: Vec<String>,
}

impl Axis {
    pub fn new(range: (f64, f64), label: &str) -> Self {
        Self {
            range,
            scale: Scale::Linear,
            label: label.to_owned(),
            names: Vec::new(),
        }
    }

    pub fn log(range: (f64, f64), label: &str) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::new(range, label)
        }
    }

    pub fn named(range: (f64, f64), names: Vec<String>) -> Self {
        Self {
            names,
            ..Self::new(range, "")
        }
    }

    /// Where a value is, from 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Log => (value / low).ln() / (high / low).ln(),
        }
    }

    /// Values with their names or numbers.
    pub fn marks(&self) -> Vec<(f64, String)> {
        if !self.names.is_empty() {
            let places = (1..).map(f64::from);
            return places.zip(self.names.iter().cloned()).collect();
        }
        let values = match self.scale {
            Scale::Linear => linear(self.range),
            Scale::Log => log(self.range),
        };
        // A minus, not a hyphen.
        let number = |value: f64| (value, format!("{value}").replace('-', "−"));
        values.into_iter().map(number).collect()
    }
}

/// Multiples of 1, 2, 2.5 or 5, without the noise of their last digits.
fn linear((low, high): (f64, f64)) -> Vec<f64> {
    let least = (high - low) / MOST_STEPS;
    if !(least.is_finite() && least > 0.0) {
        return Vec::new();
    }
    let decade = 10_f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0].map(|step| step * decade);
    let step = steps.into_iter().find(|step| *step >= least);
    let step = step.unwrap_or(10.0 * decade);
    let digits = 10_f64.powf(1.0 - decade.log10().round());
    // Not within rounding of an end that is a multiple itself.
    let from = (low / step - 1.0e-9).ceil();
    let count = (high / step + 1.0e-9).floor() - from;
    (0..=count as u32)
        .map(|n| step * (from + f64::from(n)))
        // Of no number a minus zero.
        .map(|value| (value * digits).round() / digits + 0.0)
        .collect()
}

/// Decades, or 1, 2 and 5 in each if there are few.
fn log((low, high): (f64, f64)) -> Vec<f64> {
    let multiples: &[f64] = if (high / low).log10() > MANY_DECADES {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    // Of a negative power of ten the nearest number, which prints as it.
    let power = |n: i32| {
        if n < 0 {
            1.0 / 10_f64.powi(-n)
        } else {
            10_f64.powi(n)
        }
    };
    let inside = |value: &f64| (low * (1.0 - 1.0e-9)..=high * (1.0 + 1.0e-9)).contains(value);
    decades
        .flat_map(|n| multiples.iter().map(move |multiple| multiple * power(n)))
        .filter(inside)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::Axis;

    fn numbers(axis: &Axis) -> Vec<String> {
        axis.marks().into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn numbers_are_round() {
        let linear = |low, high| numbers(&Axis::new((low, high), ""));
        assert_eq!(linear(0.0, 20.0), ["0", "5", "10", "15", "20"]);
        assert_eq!(linear(-0.24, 0.23), ["−0.2", "−0.1", "0", "0.1", "0.2"]);
        assert_eq!(
            linear(-1.1, 0.5),
            ["−1", "−0.75", "−0.5", "−0.25", "0", "0.25", "0.5"]
        );
        assert_eq!(
            linear(0.3, 0.3000007),
            [
                "0.3",
                "0.3000001",
                "0.3000002",
                "0.3000003",
                "0.3000004",
                "0.3000005",
                "0.3000006",
                "0.3000007"
            ]
        );
        assert_eq!(
            linear(2.0e6, 9.0e6),
            [
                "2000000", "3000000", "4000000", "5000000", "6000000", "7000000", "8000000",
                "9000000"
            ]
        );
        assert_eq!(linear(1.0, 1.0), [""; 0]);
        assert_eq!(linear(f64::NEG_INFINITY, 1.0), [""; 0]);
        let log = |low, high| numbers(&Axis::log((low, high), ""));
        assert_eq!(log(0.01, 1000.0), ["0.01", "0.1", "1", "10", "100", "1000"]);
        assert_eq!(log(0.04, 3.5), ["0.05", "0.1", "0.2", "0.5", "1", "2"]);
    }

    #[test]
    fn a_value_is_at_its_share() {
        let linear = Axis::new((-1.0, 3.0), "");
        assert_eq!((linear.share(-1.0), linear.share(2.0)), (0.0, 0.75));
        let log = Axis::log((0.01, 100.0), "");
        assert!((log.share(1.0) - 0.5).abs() < 1.0e-12);
    }
}
