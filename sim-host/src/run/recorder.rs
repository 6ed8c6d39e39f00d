//! Collects the rows of a run and says when it has ended.

use crate::mission::Mission;
use crate::trace::{HandOver, Trace, TraceRow};
use controller_core::motion::Outcome;
use controller_core::safety::supervisor::State;

pub(super) struct Recorder {
    pub(super) trace: Trace,
    /// For how long a parked robot is observed \[s\].
    observe_s: f64,
    last_event_s: f64,
    pub(super) parked_since: Option<f64>,
    keep: Keep,
    /// Rows taken.
    pub(super) ticks: usize,
}

/// What of a run is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    /// Every row.
    All,
    /// The last row, for runs by the thousand.
    Last,
}

impl Recorder {
    pub(super) fn new(mission: &Mission, observe_s: f64, keep: Keep) -> Self {
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
    pub(super) fn ends_with(&mut self, row: TraceRow, hand_over: Option<HandOver>) -> bool {
        let (parked, stopped) = match row.base.map(|base| base.state) {
            Some(state) => (
                state == State::Parked,
                matches!(state, State::Stopped | State::Fault),
            ),
            None => (row.report.outcome == Outcome::Parked, false),
        };
        self.parked_since = parked.then(|| self.parked_since.unwrap_or(row.t));
        self.trace.hand_over = hand_over.or(self.trace.hand_over);
        if self.keep == Keep::Last {
            self.trace.rows.clear();
        }
        self.trace.rows.push(row);
        self.ticks += 1;
        let observed = |since: f64| row.t >= since.max(self.last_event_s) + self.observe_s;
        stopped || self.parked_since.is_some_and(observed)
    }
}
