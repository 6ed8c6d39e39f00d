//! A stop that has arrived is obeyed, and a host that is silent is missed in time.

use super::Checked;
use crate::campaign::check::{self, Received};
use crate::closed_loop::Board;
use controller_core::base::BaseReport;
use controller_core::safety::Timeout;
use controller_core::safety::supervisor::{Cause, State, Then};

pub(super) struct Obedience {
    period_s: f64,
    /// Time since the last sound frame reached the base \[s\].
    since_frame_s: f64,
    /// The same of a frame that the protocol reads \[s\].
    unread_s: f64,
    /// Cause of the state at the last tick.
    was: Cause,
}

impl Obedience {
    pub(super) const fn new(period_s: f64) -> Self {
        Self {
            period_s,
            since_frame_s: 0.0,
            unread_s: 0.0,
            was: Cause::PowerOn,
        }
    }

    pub(super) fn check(
        &mut self,
        board: &Board<'_>,
        received: &Received,
        report: &BaseReport<f32>,
    ) -> Checked<()> {
        let dt = 1.0e-6 * f64::from(board.dt_us());
        // When in a tick a frame came is not known; in a long one the base was blind, not the host silent.
        let received_s = dt.min(self.period_s);
        let since = |received, so_far| if received { received_s } else { so_far + dt };
        self.since_frame_s = since(received.any, self.since_frame_s);
        self.unread_s = since(received.read, self.unread_s);
        let state = report.state;
        // One tick is left for the reaction.
        let patience = match board.task().params().detectors.command {
            Timeout::AfterUs(us) => 1.0e-6 * f64::from(us),
            Timeout::Off => f64::INFINITY,
        };
        let lost = report.cause == Cause::LinkLost && self.was != Cause::LinkLost;
        self.was = report.cause;
        if lost && self.since_frame_s + 2.0 * self.period_s < patience {
            return Err(format!(
                "the link is lost after {:.3} s",
                self.since_frame_s
            ));
        }
        let silent = self.unread_s;
        if silent >= patience && state.is_live() && !check::stops(state) {
            return Err(format!(
                "no frame comes for {silent:.3} s, and the base is in {state:?}"
            ));
        }
        match received.stop {
            Some(true) if !matches!(state, State::Braking(Then::Fault) | State::Fault) => Err(
                format!("an emergency stop came, and the base is in {state:?}"),
            ),
            Some(_) if !check::stops(state) => {
                Err(format!("a stop came, and the base is in {state:?}"))
            }
            _ => Ok(()),
        }
    }
}
