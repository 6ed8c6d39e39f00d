//! How a run ends, and what comes after.

use super::*;

impl Runner<'_> {
    /// The end, if this is one.
    pub(super) fn ended(&self, quiet_s: f64, woken: bool) -> Option<End> {
        let report = self.rig.base().report();
        let rests = self.rest_s > REST.2;
        let late = quiet_s > 1.5 && woken;
        match report.state {
            State::Stopped if rests && late && self.gave_up() && self.outcome.found.is_none() => {
                Some(End::Beside)
            }
            State::Stopped | State::Fault if rests && late => {
                Some(End::Stopped(Why::of(report.cause)))
            }
            State::Parked if rests && quiet_s > 2.5 && self.intent != Intent::Follow => {
                Some(End::Parked)
            }
            State::Idle | State::Armed if late && self.intent == Intent::Quiet => {
                rests.then_some(End::Held)
            }
            _ => None,
        }
    }

    /// Everything is mended: the base is reset, armed and goes to a new goal. Whether it parked there.
    pub(super) fn again(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<bool> {
        for which in [0, 1] {
            if self.active[which] {
                self.heal(which);
            }
        }
        self.intent = match self.intent {
            Intent::Park(goal) => Intent::Park(goal),
            _ => Intent::Quiet,
        };
        let since = self.t;
        // Poses come back, batteries recover.
        while self.t < since + 1.5 {
            self.tick(watch)?;
        }
        self.wake()?;
        let since = self.t;
        loop {
            self.tick(watch)?;
            match self.state() {
                State::Parked if self.t > since + 1.0 => return Ok(true),
                State::Stopped if self.gave_up() && self.t > since + 0.5 => return Ok(false),
                State::Stopped | State::Fault if self.t > since + 0.5 => {
                    return Err(format!(
                        "mended and armed again, it stops: {:?}",
                        self.rig.base().report().cause
                    ));
                }
                _ => {}
            }
            if self.t - since > LONGEST_S.0 {
                if self.beside() {
                    return Ok(false);
                }
                return Err("mended and armed again, it does not park".to_owned());
            }
        }
    }
}
