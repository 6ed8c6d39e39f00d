//! The way of every stop, beside its bound.

use super::Checked;
use super::timeline::Timeline;
use crate::campaign::bounds::{Bounds, Wheels};
use crate::campaign::expected::Rule;
use crate::campaign::fault_injection::FaultInjectionKind;
use crate::campaign::outcome::Stop;
use crate::closed_loop::Board;
use controller_core::base::{BaseParams, BaseReport};
use controller_core::safety::Reaction;
use controller_core::safety::supervisor::State;

/// Faster than this share of the limit a base on level floor is out of control. A wheel that is reversed or
/// stuck may add some before it is found.
const RUNAWAY: f64 = 1.5;

pub(super) struct Stops {
    bounds: Bounds,
    period_s: f64,
    limit_speed: f64,
    /// The present stop, and by what it stops.
    present: Stop,
    segment: Option<Reaction>,
    /// The one that came nearest to its bound.
    pub(super) worst: Stop,
}

impl Stops {
    pub(super) fn new(bounds: Bounds, period_s: f64, limit_speed: f64) -> Self {
        Self {
            bounds,
            period_s,
            limit_speed,
            present: Stop::default(),
            segment: None,
            worst: Stop::default(),
        }
    }

    pub(super) const fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    pub(super) const fn present(&self) -> Stop {
        self.present
    }

    /// The base has moved by this \[m\].
    pub(super) fn moved(&mut self, way_m: f64) {
        self.present.way_m += way_m;
    }

    /// What acts on the base changes: a stop under way is measured from here, with what is left.
    pub(super) const fn anew(&mut self) {
        self.segment = None;
    }

    /// A stop begins, or another one takes over: its way is measured from here. `before` is the report that the tick
    /// began with.
    pub(super) fn begin(
        &mut self,
        board: &Board<'_>,
        timeline: &Timeline<'_>,
        before: &BaseReport<f32>,
        severity: Reaction,
    ) {
        let now = (severity > Reaction::Ignore).then_some(severity);
        if now == self.segment {
            return;
        }
        self.segment = now;
        let twist = board.world().truth().twist;
        let wheels = Wheels {
            ice: timeline.begun().find_map(|injection| injection.ice()),
            blocked: timeline
                .begun()
                .any(|injection| injection.kind == FaultInjectionKind::WheelBlocked),
        };
        let late = timeline
            .begun()
            .map(|injection| injection.late_s())
            .fold(0.0, f64::max);
        let dt = 1.2 * self.period_s + late;
        let core = *board.task().controller().base();
        // A stop under way goes on as it began: what heals meanwhile does not give it a new plan.
        let left_m = match before.state {
            State::Stopping(_) => self.present.bound_m - self.present.way_m,
            _ => 0.0,
        };
        let bound_m = match severity {
            Reaction::Ignore => 0.0,
            Reaction::ControlledStop => {
                let anew = self.bounds.controlled(&core, before, &twist, dt, &wheels);
                (anew + self.unfound_m(board.task().params(), timeline)).max(left_m)
            }
            Reaction::Brake => self.bounds.brake(&twist, &wheels),
            Reaction::Release => self.bounds.release(&twist, &wheels),
        };
        self.present = Stop {
            way_m: 0.0,
            bound_m,
        };
    }

    /// A controlled stop goes by encoders; a faulty one has to be found first, and the brake then takes over.
    /// What healed a moment ago still is in the estimate of speed. Until then the base is no faster than its limit: for the
    /// time that it takes to find a reversed encoder that is pushed, after the way F/(m κ²) in which the velocity loop's
    /// feedback raises the force to what counts as pushed (see [`controller_core::safety::Monitor`]).
    fn unfound_m(&self, params: &BaseParams<f32>, timeline: &Timeline<'_>) -> f64 {
        let faulty = timeline.begun().any(|injection| {
            matches!(
                injection.kind,
                FaultInjectionKind::EncoderReversed | FaultInjectionKind::EncoderStuck
            )
        });
        if !faulty {
            return 0.0;
        }
        let found = Rule::of(FaultInjectionKind::EncoderReversed).within_s(params, None);
        let robot = &params.motion.robot;
        let force = 2.0 * params.detectors.wheels.stuck.torque_nm
            / robot.wheels.radius_right_m.min(robot.wheels.radius_left_m);
        let loop_rate = params.motion.gains.speed_loop;
        let built = force / (robot.mass_kg * loop_rate * loop_rate);
        f64::from(built) + found.unwrap_or_default() * self.limit_speed
    }

    /// No stop goes beyond its bound, nothing runs away at the true `speed` \[m/s\].
    pub(super) fn check(&mut self, speed: f64, timeline: &Timeline<'_>) -> Checked<()> {
        if timeline.drive_holds() {
            self.segment = None;
            return Ok(());
        }
        if speed > RUNAWAY * self.limit_speed {
            return Err(format!("runs away at {speed:.2} m/s"));
        }
        if self.segment.is_some() {
            self.worst = self.worst.worse(self.present);
            let Stop { way_m, bound_m } = self.present;
            if way_m > bound_m {
                return Err(format!(
                    "{:?} goes {way_m:.3} m, beyond {bound_m:.3} m",
                    self.segment
                ));
            }
        }
        Ok(())
    }
}
