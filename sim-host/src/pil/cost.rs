//! Instructions that a tick takes, by what it does.

use controller_core::paper::report::Phase;
use serde::Serialize;

/// Least, mean and most of what was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Spread {
    /// How many ticks.
    pub ticks: u64,
    /// Fewest instructions; 0 without ticks.
    pub least: u32,
    /// Most instructions.
    pub most: u32,
    /// Sum of all.
    pub sum: u64,
}

impl Spread {
    /// Adds one tick.
    pub fn add(&mut self, instructions: u32) {
        self.least = match self.ticks {
            0 => instructions,
            _ => self.least.min(instructions),
        };
        self.most = self.most.max(instructions);
        self.ticks += 1;
        self.sum += u64::from(instructions);
    }

    /// The mean; none without ticks.
    pub fn mean(&self) -> Option<f64> {
        (self.ticks > 0).then(|| self.sum as f64 / self.ticks as f64)
    }

    fn merge(&mut self, other: &Self) {
        if other.ticks == 0 {
            return;
        }
        if self.ticks == 0 {
            *self = *other;
            return;
        }
        self.least = self.least.min(other.least);
        self.most = self.most.max(other.most);
        self.ticks += other.ticks;
        self.sum += other.sum;
    }
}

/// Executed instructions of the core's step, its report included, by phase. Decoding the question
/// and encoding the answer are the link's business and not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Cost {
    /// The start: once per run.
    pub start: Spread,
    /// Ticks that follow the reference.
    pub tracking: Spread,
    /// The tick that changes from tracking to parking.
    pub hand_over: Spread,
    /// Ticks that go to the goal.
    pub parking: Spread,
}

impl Cost {
    /// Adds a tick after the start.
    pub fn add(&mut self, phase: Phase, handed_over: bool, instructions: u32) {
        let spread = match (handed_over, phase) {
            (true, _) => &mut self.hand_over,
            (false, Phase::Tracking) => &mut self.tracking,
            (false, Phase::Parking) => &mut self.parking,
        };
        spread.add(instructions);
    }

    /// Adds another run.
    pub fn merge(&mut self, other: &Self) {
        self.start.merge(&other.start);
        self.tracking.merge(&other.tracking);
        self.hand_over.merge(&other.hand_over);
        self.parking.merge(&other.parking);
    }

    /// With the names for a table.
    pub fn named(&self) -> [(&'static str, Spread); 4] {
        [
            ("start", self.start),
            ("tracking", self.tracking),
            ("hand-over", self.hand_over),
            ("parking", self.parking),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_merge_as_if_counted_together() {
        let (mut one, mut other, mut both) = (Cost::default(), Cost::default(), Cost::default());
        for (at, instructions) in [250, 240, 300, 260].into_iter().enumerate() {
            let cost = if at < 2 { &mut one } else { &mut other };
            cost.add(Phase::Parking, at == 3, instructions);
            both.add(Phase::Parking, at == 3, instructions);
        }
        one.merge(&other);
        assert_eq!(one, both);
        assert_eq!((one.parking.least, one.parking.most), (240, 300));
        assert_eq!(one.hand_over.ticks, 1);
        assert_eq!(one.tracking.mean(), None);
    }
}
