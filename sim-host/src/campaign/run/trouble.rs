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
        self.begin(&self.plan.injection);
        self.stop_at = self.plan.stop.map(|(after, _)| self.t + after);
    }

    pub(super) fn strike_again(&mut self, stopping_since: Option<f64>) {
        let (Some((delay, injection)), Some(began), None) =
            (self.plan.second, stopping_since, self.second)
        else {
            return;
        };
        let stops = matches!(self.state(), State::Stopping(_) | State::Braking(_));
        // One that cannot be stopped by any command would hide what the first one does.
        if self.t < began + delay || !stops || injection.kind == FaultInjectionKind::DriveHolds {
            return;
        }
        self.second = Some(self.t);
        self.segment = None;
        self.active[1] = true;
        self.outcome.second = Some(injection.kind);
        self.begin(&injection);
    }

    /// What the world and the host do at once.
    fn begin(&mut self, injection: &FaultInjection) {
        injection.apply(self.board.world_mut(), true);
        match injection.what {
            What::EmergencyStop => self.host.stop(BUTTON),
            What::OrderNan { park } => self.host.ask_in_vain(expected::no_number(park)),
            _ => {}
        }
    }

    pub(super) fn upsets(&self) -> impl Iterator<Item = FaultInjection> + use<> {
        let second = self
            .second
            .and(self.plan.second)
            .map(|(_, injection)| injection);
        let first = self.first.map(|_| self.plan.injection);
        first.into_iter().chain(second)
    }

    pub(super) fn active_upsets(&self) -> impl Iterator<Item = FaultInjection> + use<> {
        let second = self.plan.second.map(|(_, injection)| injection);
        let first = self.active[0].then_some(self.plan.injection);
        first.into_iter().chain(second.filter(|_| self.active[1]))
    }

    pub(super) fn heal(&mut self, which: usize) {
        let injection = match which {
            0 => Some(self.plan.injection),
            _ => self.plan.second.map(|(_, injection)| injection),
        };
        self.active[which] = false;
        if let Some(injection) = injection {
            injection.heal(self.board.world_mut());
        }
        // The other may be of the same kind.
        for injection in self.active_upsets().collect::<Vec<_>>() {
            injection.apply(
                self.board.world_mut(),
                matches!(injection.what, What::PlantFault(_)),
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
        let rule = Rule::of(self.plan.injection.kind);
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
