//! The base's ticks on the clock of this machine.

/// Drift of a board's crystal against this clock, generously: ceramic resonators are within 0.5 %, crystals far below.
const DRIFT: f64 = 1.0e-3;
/// Reports later than that on their clock are of another run of it \[ns\].
const LOST_NS: i64 = 1_000_000_000;

/// Reports that all come later than that \[ns\], for [`LATE_FOR_NS`], are not late: the clock here was set forward. A line or
/// a machine that is held up delivers what has waited, and the last of it is on time.
const LATE_NS: i64 = 50_000_000;
/// Longer than anything holds up a line that does not end \[ns\].
const LATE_FOR_NS: i64 = 1_000_000_000;

/// When a tick was, as far as it can be known: as far apart as the ticks, whatever the line and this machine do in between.
#[derive(Clone, Copy, Debug)]
pub struct TickClock {
    tick_ns: i64,
    last: Option<Last>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    tick: u32,
    /// On the base's clock, since its first tick here.
    base_ns: i64,
    /// What of the clock here that is, at the earliest report.
    offset_ns: i64,
    /// What came of it.
    stamp_ns: i64,
    /// Where the last reports were all late: since when on the base's clock, and the offset of the earliest of them.
    late: Option<(i64, i64)>,
}

impl TickClock {
    /// Of a base with a tick every so many microseconds.
    pub fn new(period_us: u32) -> Self {
        Self {
            tick_ns: 1_000 * i64::from(period_us),
            last: None,
        }
    }

    /// The time of a tick whose report came at `now_ns`, on the same clock; and on the base's own, since its first report.
    pub fn stamp(&mut self, tick: u32, now_ns: i64) -> (i64, i64) {
        let of = |last: &Last| -> Option<Last> {
            let passed_ns = i64::from(tick.wrapping_sub(last.tick)) * self.tick_ns;
            let base_ns = last.base_ns + passed_ns;
            // The way of the fastest report counts; it ages, since crystals differ.
            let aged_ns = last.offset_ns + (passed_ns as f64 * DRIFT) as i64;
            let here_ns = now_ns - base_ns;
            let late = (here_ns > aged_ns + LATE_NS).then(|| {
                let (since_ns, least_ns) = last.late.unwrap_or((base_ns, here_ns));
                (since_ns, least_ns.min(here_ns))
            });
            let (offset_ns, late) = match late {
                Some((since_ns, least_ns)) if base_ns - since_ns >= LATE_FOR_NS => (least_ns, None),
                late => (aged_ns.min(here_ns), late),
            };
            let lost = now_ns - base_ns - last.offset_ns;
            (lost.abs() < LOST_NS).then_some(Last {
                tick,
                base_ns,
                offset_ns,
                // A report on a faster way shows that those before it were stamped late: time does not go back for that.
                stamp_ns: (base_ns + offset_ns).max(last.stamp_ns + passed_ns / 2),
                late,
            })
        };
        let last = self.last.as_ref().and_then(of).unwrap_or(Last {
            tick,
            base_ns: 0,
            offset_ns: now_ns,
            stamp_ns: now_ns,
            late: None,
        });
        self.last = Some(last);
        (last.stamp_ns, last.base_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reports that come up to 15 ms late are stamped 20 ms apart, within the drift allowed for, and never later than they came.
    #[test]
    fn stamps_are_as_even_as_ticks() {
        let mut clock = TickClock::new(1_000);
        let mut before = None;
        for report in 0..500_u32 {
            let late_ns = i64::from(report * 7919 % 16) * 1_000_000;
            let now_ns = 5_000_000_000 + i64::from(report) * 20_000_000 + late_ns;
            let (stamp, base) = clock.stamp(report.wrapping_mul(20).wrapping_sub(100), now_ns);
            assert!(stamp <= now_ns);
            assert_eq!(base, i64::from(report) * 20_000_000);
            if let Some(before) = before.filter(|_| report > 16) {
                let apart: i64 = stamp - before;
                // Up to 16 reports until the next fast one, of 20 us each.
                assert!((apart - 20_000_000).abs() <= 320_000, "{apart}");
            }
            before = Some(stamp);
        }
    }

    /// A tick every 15 ms, of which a second has no whole number: two minutes later stamps are still those of the arrival.
    #[test]
    fn a_period_that_does_not_divide_a_second_is_kept() {
        let mut clock = TickClock::new(15_000);
        for report in 0..8_000_u32 {
            let now_ns = 5_000_000_000 + 15_000_000 * i64::from(report);
            let (stamp, base) = clock.stamp(report, now_ns);
            assert_eq!((stamp, base), (now_ns, now_ns - 5_000_000_000));
        }
    }

    /// As by NTP. A line that is held up for 0.9 s is none: its last report is on time.
    #[test]
    fn a_clock_that_is_set_forward_is_followed_after_a_second() {
        for held_up in [false, true] {
            let mut clock = TickClock::new(1_000);
            for report in 0..200_i64 {
                let at_ns = 5_000_000_000 + 20_000_000 * report;
                let now_ns = match report {
                    ..100 => at_ns,
                    _ if !held_up => at_ns + 900_000_000,
                    // All at once.
                    100..145 => 5_000_000_000 + 20_000_000 * 145,
                    _ => at_ns,
                };
                let (stamp, _) = clock.stamp(20 * report as u32, now_ns);
                if held_up {
                    // No more than the drift that is allowed for, in 0.9 s.
                    assert!(
                        (stamp - at_ns).abs() <= 900_000,
                        "{report}: {}",
                        stamp - at_ns
                    );
                } else if report > 150 {
                    assert!(
                        (now_ns - stamp).abs() < 1_000_000,
                        "{report}: {}",
                        now_ns - stamp
                    );
                }
            }
        }
    }

    /// The first report was 90 ms under way.
    #[test]
    fn time_does_not_go_back() {
        let mut clock = TickClock::new(1_000);
        let mut before = clock.stamp(20, 1_090_000_000).0;
        for report in 1..20_i64 {
            let (stamp, _) =
                clock.stamp(20 + 20 * report as u32, 1_000_000_000 + 20_000_000 * report);
            assert!(stamp >= before + 10_000_000, "{report}");
            before = stamp;
        }
        // By then it has caught up.
        assert_eq!(before, 1_000_000_000 + 20_000_000 * 19);
    }

    #[test]
    fn a_base_that_begins_anew_is_stamped_by_its_arrival() {
        let mut clock = TickClock::new(1_000);
        clock.stamp(60_000, 1_000_000_000);
        assert_eq!(clock.stamp(20, 9_000_000_000).0, 9_000_000_000);
    }
}
