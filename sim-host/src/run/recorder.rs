//! Collects the rows of a run and says when it has ended.

use super::watch::{Seen, Watch};
use crate::csv_out::Line;
use crate::mission::Mission;
use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::types::Measured;

pub(super) struct Recorder<'w> {
    pub(super) trace: Trace,
    /// For how long a parked robot is observed \[s\].
    observe_s: f64,
    last_event_s: f64,
    pub(super) parked_since: Option<f64>,
    keep: Keep<'w>,
    /// Ticks seen.
    pub(super) ticks: usize,
}

/// What of a run is kept.
pub(super) enum Keep<'w> {
    /// Every row, which somebody may see as it comes.
    All(Watch<'w>),
    /// The last row, for runs by the thousand. It is called at every tick.
    Last(&'w mut dyn FnMut()),
}

impl<'w> Recorder<'w> {
    pub(super) fn new(mission: &Mission, observe_s: f64, keep: Keep<'w>) -> Self {
        Self {
            trace: Trace {
                period_s: mission.period_s,
                ..Trace::default()
            },
            observe_s,
            last_event_s: mission.events.last().map_or(0.0, |event| event.at_s),
            parked_since: None,
            keep,
            ticks: 0,
        }
    }

    /// Whether the run ends with the tick at `t` \[s\]: the base has been parked for long enough.
    pub(super) fn ends_at(&mut self, t: f64, parked: bool) -> bool {
        self.ticks += 1;
        if let Keep::Last(each) = &mut self.keep {
            each();
        }
        self.parked_since = parked.then(|| self.parked_since.unwrap_or(t));
        let observed = |since: f64| t >= since.max(self.last_event_s) + self.observe_s;
        self.parked_since.is_some_and(observed)
    }

    /// Whether the row of a tick is to be taken; `is_last`: none comes after it.
    pub(super) const fn wants(&self, is_last: bool) -> bool {
        is_last || matches!(self.keep, Keep::All(_))
    }

    /// Takes the row of the present tick. `measured` and `wheels` are for who watches.
    pub(super) fn take(
        &mut self,
        row: TraceRow,
        hand_over: Option<HandOver>,
        measured: Measured<f64>,
        wheels: impl FnOnce() -> Option<super::WheelStates>,
    ) {
        self.trace.hand_over = hand_over.or(self.trace.hand_over);
        match &mut self.keep {
            Keep::Last(_) => self.trace.rows.clear(),
            Keep::All(None) => {}
            Keep::All(Some(watch)) => watch(&Seen {
                line: Line {
                    tick: self.trace.rows.len(),
                    row: &row,
                    handed_over: hand_over.is_some(),
                },
                measured,
                wheels: wheels(),
            }),
        }
        self.trace.rows.push(row);
    }
}
