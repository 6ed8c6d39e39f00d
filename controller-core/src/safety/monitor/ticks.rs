//! Late and long ticks.

use crate::safety::detector_params::TickDetectorParams;

/// Late ticks: in a row, among the last 64, and in all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Ticks {
    row: u8,
    /// The newest tick in the lowest bit; 1 is late.
    recent: u64,
    pub(super) late: u32,
}

impl Ticks {
    /// Whether there is too much jitter, and whether this tick was too long.
    pub(super) const fn advance(
        &mut self,
        settings: &TickDetectorParams,
        dt_us: u32,
    ) -> (bool, bool) {
        let late = settings.late.passed(dt_us);
        self.recent = (self.recent << 1) | late as u64;
        if late {
            self.row = self.row.saturating_add(1);
            self.late = self.late.saturating_add(1);
        } else {
            self.row = 0;
        }
        // A good tick ends it: what is over is not found again. Nor does it count the others.
        let jitter =
            late && (self.row >= settings.row || self.recent.count_ones() >= settings.of_64 as u32);
        (jitter, settings.long.passed(dt_us))
    }
}
