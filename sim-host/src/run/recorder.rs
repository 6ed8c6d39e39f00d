//! Collects the rows of a run and says when it has ended.

use super::watch::{Seen, Watch};
use crate::csv_out::Line;
use crate::mission::Mission;
use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::motion::Outcome;
use controller_core::safety::supervisor::State;
use controller_core::types::Measured;

pub(super) struct Recorder<'w> {
    pub(super) trace: Trace,
    /// For how long a parked robot is observed \[s\].
    observe_s: f64,
    last_event_s: f64,
    pub(super) parked_since: Option<f64>,
    keep: Keep<'w>,
    /// Rows taken.
    pub(super) ticks: usize,
}

/// What of a run is kept.
pub(super) enum Keep<'w> {
    /// Every row, which somebody may see as it comes.
    All(Watch<'w>),
    /// The last row, for runs by the thousand.
    Last,
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

    /// Takes a row. The run ends with it if the base stopped or failed for good, or has been parked for long enough.
    ///
    /// `measured` and `wheels` are for who watches.
    pub(super) fn ends_with(
        &mut self,
        row: TraceRow,
        hand_over: Option<HandOver>,
        measured: Measured<f64>,
        wheels: impl FnOnce() -> Option<super::WheelStates>,
    ) -> bool {
        let (parked, stopped) = match row.base.map(|base| base.state) {
            Some(state) => (
                state == State::Parked,
                matches!(state, State::Stopped | State::Fault),
            ),
            None => (row.report.outcome == Outcome::Parked, false),
        };
        self.parked_since = parked.then(|| self.parked_since.unwrap_or(row.t));
        self.trace.hand_over = hand_over.or(self.trace.hand_over);
        match &mut self.keep {
            Keep::Last => self.trace.rows.clear(),
            Keep::All(None) => {}
            Keep::All(Some(watch)) => watch(&Seen {
                line: Line {
                    tick: self.ticks,
                    row: &row,
                    handed_over: hand_over.is_some(),
                },
                measured,
                wheels: wheels(),
            }),
        }
        self.trace.rows.push(row);
        self.ticks += 1;
        let observed = |since: f64| row.t >= since.max(self.last_event_s) + self.observe_s;
        stopped || self.parked_since.is_some_and(observed)
    }
}
