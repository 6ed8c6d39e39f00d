//! Trouble comes, is found, goes.

use super::*;

impl Runner<'_, '_> {
    pub(super) fn strike(&mut self) {
        self.first = Some(self.t);
        self.active[0] = true;
        self.outcome.at_s = self.t;
        self.way_m = 0.0;
        // A stop under way goes on with what is left from here.
        self.segment = None;
        self.begin(&self.plan.upset);
        self.stop_at = self.plan.stop.map(|(after, _)| self.t + after);
    }

    pub(super) fn strike_again(&mut self, stopping_since: Option<f64>) {
        let (Some((delay, upset)), Some(began), None) =
            (self.plan.second, stopping_since, self.second)
        else {
            return;
        };
        let stops = matches!(self.state(), State::Stopping(_) | State::Braking(_));
        // One that cannot be stopped by any command would hide what the first one does.
        if self.t < began + delay || !stops || upset.kind == UpsetKind::DriveHolds {
            return;
        }
        self.second = Some(self.t);
        self.segment = None;
        self.active[1] = true;
        self.outcome.second = Some(upset.kind);
        self.begin(&upset);
    }

    /// What the world and the host do at once.
    fn begin(&mut self, upset: &Upset) {
        upset.apply(self.board.world_mut(), true);
        match upset.what {
            What::EmergencyStop => self.host.stop(BUTTON),
            What::OrderNan { park } => self.host.ask_in_vain(expected::no_number(park)),
            _ => {}
        }
    }

    pub(super) fn upsets(&self) -> impl Iterator<Item = Upset> + use<> {
        let second = self.second.and(self.plan.second).map(|(_, upset)| upset);
        let first = self.first.map(|_| self.plan.upset);
        first.into_iter().chain(second)
    }

    pub(super) fn active_upsets(&self) -> impl Iterator<Item = Upset> + use<> {
        let second = self.plan.second.map(|(_, upset)| upset);
        let first = self.active[0].then_some(self.plan.upset);
        first.into_iter().chain(second.filter(|_| self.active[1]))
    }

    pub(super) fn heal(&mut self, which: usize) {
        let upset = match which {
            0 => Some(self.plan.upset),
            _ => self.plan.second.map(|(_, upset)| upset),
        };
        self.active[which] = false;
        if let Some(upset) = upset {
            upset.heal(self.board.world_mut());
        }
        // The other may be of the same kind.
        for upset in self.active_upsets().collect::<Vec<_>>() {
            upset.apply(
                self.board.world_mut(),
                matches!(upset.what, What::Defect(_)),
            );
        }
        // What a driver held until now only begins to stop.
        self.segment = None;
    }

    pub(super) fn detect(&mut self, after_s: f64) {
        if self.outcome.found.is_some() {
            return;
        }
        let report = self.board.report();
        let rule = Rule::of(self.plan.upset.kind);
        let mut found = report
            .active_faults
            .iter()
            .map(|fault| Why::Fault(fault.kind()));
        let stopped = Some(Why::of(report.cause)).filter(|_| check::stops(report.state));
        let refused = self.refused.then_some(Why::Refused);
        let why = found
            .find(|why| rule.allows(*why))
            .or(stopped.filter(|why| rule.allows(*why)))
            .or(refused.filter(|why| rule.allows(*why)));
        self.outcome.found = why.map(|why| Detection {
            why,
            after_s,
            way_m: self.way_m,
        });
    }
}
