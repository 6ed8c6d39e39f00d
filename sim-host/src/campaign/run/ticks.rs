//! A tick of a run, and what is checked in it.

use super::*;

impl Runner<'_> {
    pub(super) fn tick(&mut self, watch: &mut impl FnMut(&Tick<'_>)) -> Checked<()> {
        let before = *self.rig.base().report();
        let was = (before.state, check::severity(&before));
        for upset in self.active_upsets().collect::<Vec<_>>() {
            upset.apply(self.rig.world_mut(), false);
        }
        let place = self.rig.world().truth().pose;
        self.rig.advance().map_err(|error| error.to_string())?;
        self.t = 1.0e-6 * self.rig.world().now_us() as f64;
        let now = self.rig.world().truth();
        let moved = (now.pose.x - place.x).hypot(now.pose.y - place.y);
        self.account(moved);
        let order = self.order();
        let bad_age = self
            .active_upsets()
            .any(|upset| upset.what == What::FixAgeNan);
        let report = *self.rig.tick_with(&order, |sensed| {
            if let (true, Some(fix)) = (bad_age, &mut sensed.fix) {
                fix.age_s = f32::NAN;
            }
        });
        let limit = self.base.limits.wheel_torque_nm as f32;
        check::outputs(&report, self.rig.actuation(), limit)?;
        check::milder(was, &report, self.told)?;
        check::reacted(was.0, &report)?;
        let expected: Vec<UpsetKind> = self.upsets().map(|upset| upset.kind).collect();
        let right = |kind: FaultKind| {
            expected
                .iter()
                .any(|upset| expected::kinds(*upset).contains(&kind))
                || expected::at_any_goal(kind)
        };
        if let Some(fault) = check::wrong(&report, right) {
            let names: Vec<_> = expected.iter().map(|upset| upset.name()).collect();
            return Err(format!("{fault} is found under: {}", names.join(", ")));
        }
        self.told = false;
        self.begin_stop(&before, check::severity(&report));
        self.mutate(&report.action);
        watch(&Tick {
            rig: &self.rig,
            t: self.t,
            upset: self.active[0],
            stop: self.stop,
        });
        self.within()
    }

    /// Way and rest.
    pub(super) fn account(&mut self, moved: f64) {
        let dt = 1.0e-6 * f64::from(self.rig.dt_us());
        let twist = self.rig.world().truth().twist;
        let wheels = self.rig.world().wheel_speeds();
        self.way_m += moved;
        self.stop.way_m += moved;
        self.dt_worst = self.dt_worst.max(dt);
        let rests = twist.linear.abs() < REST.0
            && twist.angular.abs() < REST.1
            && self.bounds.rolls(wheels.right, wheels.left) < 2.0 * REST.0;
        self.rest_s = if rests { self.rest_s + dt } else { 0.0 };
        if self.first.is_some() {
            self.outcome.fastest = self.outcome.fastest.max(twist.linear.abs());
        }
    }

    /// A stop begins, or another one takes over: its way is measured from here.
    pub(super) fn begin_stop(
        &mut self,
        before: &controller_core::base::BaseReport<f32>,
        severity: Reaction,
    ) {
        let now = (severity > Reaction::RideOut).then_some(severity);
        if now == self.segment {
            return;
        }
        self.segment = now;
        let twist = self.rig.world().truth().twist;
        let wheels = Wheels {
            ice: self.upsets().find_map(|upset| upset.ice()),
            blocked: self
                .upsets()
                .any(|upset| upset.kind == UpsetKind::WheelBlocked),
        };
        let late = self
            .upsets()
            .map(|upset| upset.late_s())
            .fold(0.0, f64::max);
        let dt = 1.2 * self.period_s + late;
        let core = *self.rig.base().base();
        // A stop under way goes on as it began: what heals meanwhile does not give it a new plan.
        let left_m = match before.state {
            State::Stopping(_) => self.stop.bound_m - self.stop.way_m,
            _ => 0.0,
        };
        let bound_m = match severity {
            Reaction::RideOut => 0.0,
            Reaction::ControlledStop => {
                let anew = self.bounds.controlled(&core, before, &twist, dt, &wheels);
                (anew + self.unfound_m()).max(left_m)
            }
            Reaction::Brake => self.bounds.brake(&twist, &wheels),
            Reaction::Release => self.bounds.release(&twist, &wheels),
        };
        self.stop = Stop {
            way_m: 0.0,
            bound_m,
        };
    }

    /// A controlled stop goes by encoders; one that lies has to be found first, and the brake then takes over.
    /// What healed a moment ago still is in the estimate of speed. Until then the base is no faster than its limit.
    pub(super) fn unfound_m(&self) -> f64 {
        let lies = self.upsets().any(|upset| {
            matches!(
                upset.kind,
                UpsetKind::EncoderReversed | UpsetKind::EncoderStuck
            )
        });
        if lies {
            UNFOUND_S * self.limit_speed
        } else {
            0.0
        }
    }

    pub(super) fn mutate(&mut self, action: &WheelAction<f32>) {
        match (self.mutation, action) {
            (_, WheelAction::Drive(_)) => self.torque = *self.rig.actuation(),
            (Mutation::KeepsTorque, _) => self.rig.override_actuation(self.torque),
            (Mutation::BrakeCoasts, WheelAction::Brake) => {
                self.rig.override_actuation(Actuation::Release);
            }
            _ => {}
        }
    }

    /// No stop goes beyond its bound, nothing runs away.
    pub(super) fn within(&mut self) -> Checked<()> {
        let holds = self
            .active_upsets()
            .any(|upset| upset.kind == UpsetKind::DriveHolds);
        // Until its watchdog ends it a driver that does not listen is beyond any command.
        if holds {
            self.segment = None;
            return Ok(());
        }
        let speed = self.rig.world().truth().twist.linear.abs();
        if speed > RUNAWAY * self.limit_speed {
            return Err(format!("runs away at {speed:.2} m/s"));
        }
        if self.segment.is_some() {
            self.outcome.stop = self.outcome.stop.worse(self.stop);
            if self.stop.way_m > self.stop.bound_m {
                let Stop { way_m, bound_m } = self.stop;
                return Err(format!(
                    "{:?} goes {way_m:.3} m, beyond {bound_m:.3} m",
                    self.segment
                ));
            }
        }
        Ok(())
    }
}
