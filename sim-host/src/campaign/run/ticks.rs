//! A tick of a run, and what is checked in it.

use super::*;
use controller_core::safety::Timeout;
use controller_core::safety::supervisor::Then;

impl Runner<'_, '_> {
    pub(super) fn tick(&mut self, watch: &mut impl FnMut(&Tick<'_, '_>)) -> Checked<()> {
        let before = self.report();
        let was = (before.state, check::severity(&before));
        for injection in self.active_upsets().collect::<Vec<_>>() {
            injection.apply(self.board.world_mut(), false);
        }
        let place = self.board.world().truth().pose;
        self.board.advance().map_err(|error| error.to_string())?;
        self.t = 1.0e-6 * self.board.world().now_us() as f64;
        let now = self.board.world().truth();
        let moved = (now.pose.x - place.x).hypot(now.pose.y - place.y);
        self.account(moved);
        self.exchange();
        self.board.tick();
        self.answers()?;
        let report = self.report();
        self.obeyed(&report)?;
        let limit = self.base.limits.wheel_torque_nm as f32;
        check::outputs(&report, self.board.actuation(), limit)?;
        check::milder(was, &report, self.received.frees, self.received.reset)?;
        check::reacted(was.0, &report)?;
        let rules: Vec<_> = self
            .upsets()
            .map(|injection| Rule::of(injection.kind))
            .collect();
        let right = |why| !self.mended && rules.iter().any(|rule| rule.allows(why));
        if let Some(why) = check::wrong(&before, &report, right) {
            return Err(format!("{why} is found, which it is not"));
        }
        self.count(&before);
        self.begin_stop(&before, check::severity(&report));
        self.mutate(&report.action);
        watch(&Tick {
            board: &self.board,
            t: self.t,
            injection: self.active[0],
            stop: self.stop,
        });
        self.within()
    }

    /// The report of the last tick, with what was really applied to the wheels: after a driver's error they are released.
    fn report(&self) -> BaseReport<f32> {
        BaseReport {
            action: *self.board.task().output(),
            ..*self.board.report()
        }
    }

    /// A stop that has arrived is obeyed.
    fn obeyed(&mut self, report: &BaseReport<f32>) -> Checked<()> {
        let dt = 1.0e-6 * f64::from(self.board.dt_us());
        // When in a tick a frame came is not known; in a long one the base was blind, not the host silent.
        let received_s = dt.min(self.period_s);
        let since = |received, so_far| if received { received_s } else { so_far + dt };
        self.since_frame_s = since(self.received.any, self.since_frame_s);
        self.unread_s = since(self.received.read, self.unread_s);
        let state = report.state;
        // One tick is left for the reaction.
        let patience = match self.board.task().params().detectors.command {
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
        match self.received.stop {
            Some(true) if !matches!(state, State::Braking(Then::Fault) | State::Fault) => Err(
                format!("an emergency stop came, and the base is in {state:?}"),
            ),
            Some(_) if !check::stops(state) => {
                Err(format!("a stop came, and the base is in {state:?}"))
            }
            _ => Ok(()),
        }
    }

    /// Way and rest.
    pub(super) fn account(&mut self, moved: f64) {
        let dt = 1.0e-6 * f64::from(self.board.dt_us());
        let twist = self.board.world().truth().twist;
        let wheels = self.board.world().wheel_speeds();
        self.way_m += moved;
        self.stop.way_m += moved;
        self.dt_worst = self.dt_worst.max(dt);
        let rests = twist.linear.abs() < REST.0
            && twist.angular.abs() < REST.1
            && self.bounds.rolls(wheels.right, wheels.left) < 2.0 * REST.0;
        self.rest_s = if rests { self.rest_s + dt } else { 0.0 };
        let parked = self.state() == State::Parked;
        self.parked_s = if parked { self.parked_s + dt } else { 0.0 };
        if self.first.is_some() {
            self.outcome.fastest = self.outcome.fastest.max(twist.linear.abs());
        }
    }

    /// A stop begins, or another one takes over: its way is measured from here.
    pub(super) fn begin_stop(&mut self, before: &BaseReport<f32>, severity: Reaction) {
        let now = (severity > Reaction::Ignore).then_some(severity);
        if now == self.segment {
            return;
        }
        self.segment = now;
        let twist = self.board.world().truth().twist;
        let wheels = Wheels {
            ice: self.upsets().find_map(|injection| injection.ice()),
            blocked: self
                .upsets()
                .any(|injection| injection.kind == FaultInjectionKind::WheelBlocked),
        };
        let late = self
            .upsets()
            .map(|injection| injection.late_s())
            .fold(0.0, f64::max);
        let dt = 1.2 * self.period_s + late;
        let core = *self.board.task().controller().base();
        // A stop under way goes on as it began: what heals meanwhile does not give it a new plan.
        let left_m = match before.state {
            State::Stopping(_) => self.stop.bound_m - self.stop.way_m,
            _ => 0.0,
        };
        let bound_m = match severity {
            Reaction::Ignore => 0.0,
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
    /// What healed a moment ago still is in the estimate of speed. Until then the base is no faster than its limit: for the
    /// time that it takes to find a reversed encoder that is pushed, after the way F/(m κ²) in which the velocity loop's
    /// feedback raises the force to what counts as pushed (see [`controller_core::safety::Monitor`]).
    fn unfound_m(&self) -> f64 {
        let lies = self.upsets().any(|injection| {
            matches!(
                injection.kind,
                FaultInjectionKind::EncoderReversed | FaultInjectionKind::EncoderStuck
            )
        });
        if !lies {
            return 0.0;
        }
        let params = self.board.task().params();
        let found = Rule::of(FaultInjectionKind::EncoderReversed).within_s(params, None);
        let robot = &params.motion.robot;
        let force = 2.0 * params.detectors.wheels.stuck.torque_nm
            / robot.wheels.radius_right_m.min(robot.wheels.radius_left_m);
        let loop_rate = params.motion.gains.speed_loop;
        let built = force / (robot.mass_kg * loop_rate * loop_rate);
        f64::from(built) + found.unwrap_or_default() * self.limit_speed
    }

    pub(super) fn mutate(&mut self, action: &WheelAction<f32>) {
        match (self.mutation, action) {
            (_, WheelAction::Drive(_)) => self.torque = *self.board.actuation(),
            (Mutation::KeepsTorque, _) => self.board.override_actuation(self.torque),
            (Mutation::BrakeCoasts, WheelAction::Brake) => {
                self.board.override_actuation(Actuation::Release);
            }
            _ => {}
        }
    }

    /// No stop goes beyond its bound, nothing runs away.
    pub(super) fn within(&mut self) -> Checked<()> {
        let holds = self
            .active_upsets()
            .any(|injection| injection.kind == FaultInjectionKind::DriveHolds);
        // Until its watchdog ends it a driver that does not listen is beyond any command.
        if holds {
            self.segment = None;
            return Ok(());
        }
        let speed = self.board.world().truth().twist.linear.abs();
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
