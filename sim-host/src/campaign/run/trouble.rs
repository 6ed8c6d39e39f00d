//! Trouble comes, is found, goes.

use super::*;

impl Runner<'_> {
    pub(super) fn strike(&mut self) {
        self.first = Some(self.t);
        self.active[0] = true;
        self.outcome.at_s = self.t;
        self.way_m = 0.0;
        // A stop under way goes on with what is left from here.
        self.segment = None;
        self.plan.upset.apply(self.rig.world_mut(), true);
        if self.plan.upset.what == What::EmergencyStop {
            self.rig.emergency_stop();
        }
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
        upset.apply(self.rig.world_mut(), true);
        if upset.what == What::EmergencyStop {
            self.rig.emergency_stop();
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
            upset.heal(self.rig.world_mut());
        }
        // The other may be of the same kind.
        for upset in self.active_upsets().collect::<Vec<_>>() {
            upset.apply(self.rig.world_mut(), matches!(upset.what, What::Defect(_)));
        }
        // What a driver held until now only begins to stop.
        self.segment = None;
    }

    pub(super) fn detect(&mut self, after_s: f64) {
        if self.outcome.found.is_some() {
            return;
        }
        let report = self.rig.base().report();
        let kinds = expected::kinds(self.plan.upset.kind);
        let button = self.plan.upset.kind == UpsetKind::EmergencyStop;
        let mut acted = report
            .findings
            .iter()
            .filter(|fault| kinds.contains(&fault.kind()));
        let why = acted.next().map(|fault| Why::Fault(fault.kind()));
        let why = why.or(button.then_some(Why::Button));
        self.outcome.found = why.map(|why| Detection {
            why,
            after_s,
            way_m: self.way_m,
        });
    }

    pub(super) fn overdue(&self, after_s: f64, deadline_s: Option<f64>) -> Checked<()> {
        let Some(deadline) = deadline_s else {
            return Ok(());
        };
        let healed = self.plan.heal_s.is_some_and(|heal| heal < deadline);
        // A host that gives an order, whatever it says, is not silent.
        let ordered = self
            .outcome
            .second
            .is_some_and(|kind| kind == UpsetKind::OrderNan);
        let woken = self.plan.upset.kind == UpsetKind::HostSilent && (self.told || ordered);
        if after_s > deadline && self.outcome.found.is_none() && !healed && !woken {
            return Err(format!("not found within {deadline:.3} s"));
        }
        Ok(())
    }
}
