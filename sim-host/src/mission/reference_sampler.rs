//! The route, sampled at every tick.

use super::{Course, Mission, Route};
use controller_core::maths::Libm;
use controller_core::reference::Reference;
use controller_core::types::{Accel, Pose, Twist};

/// When, between a tick and the next, a law takes the acceleration of its reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AccelerationAt {
    /// At the tick, as the paper's laws do.
    Tick,
    /// In the middle of the time for which the torque is held.
    MiddleOfHold,
}

/// The reference at each tick, and the way that it goes.
pub(super) struct ReferenceSampler {
    /// Pose and twist of the tick, acceleration as the law takes it.
    references: Vec<Reference<f64>>,
    /// Metres and radians that the reference has moved since the start.
    travelled: Vec<(f64, f64)>,
}

impl ReferenceSampler {
    /// Of a mission's route; empty without one.
    pub(super) fn of(mission: &Mission, acceleration: AccelerationAt) -> Self {
        let Course::Follow { route, hand_over } = &mission.course else {
            return Self {
                references: Vec::new(),
                travelled: Vec::new(),
            };
        };
        let dt = mission.period_s;
        let lead_s = match acceleration {
            AccelerationAt::Tick => 0.0,
            AccelerationAt::MiddleOfHold => 0.5 * dt,
        };
        let end = hand_over.map_or(f64::INFINITY, |rule| rule.end_s);
        let ticks = (end.min(mission.longest_s()) / dt).ceil() as usize;
        let times = (0..=ticks).map(|tick| tick as f64 * dt);
        let references: Vec<_> = match route {
            Route::File(file) => times
                .map(|t| {
                    // At the start the controller exerts nothing yet: an acceleration asked for then
                    // fades in, and leaves it behind.
                    let lead_s = if t > 0.0 { lead_s } else { 0.0 };
                    let (now, ahead) = (file.at(t), file.at(t + lead_s));
                    Reference::new_with::<Libm>(
                        Pose::new(now.x, now.y, now.theta),
                        Twist::new(now.v, now.w),
                        Accel::new(ahead.a, ahead.alpha),
                    )
                    .with_left(now.left)
                })
                .collect(),
            Route::Motion(motion) => {
                let (mut now, mut ahead) = (motion.walk(), motion.walk());
                times
                    .map(|t| {
                        let here = now.advance_to(t);
                        let accel = *ahead.advance_to(t + lead_s).accel();
                        Reference::new_with::<Libm>(*here.pose(), *here.twist(), accel)
                    })
                    .collect()
            }
        };
        let mut way = (0.0, 0.0);
        let mut travelled = vec![way];
        for pair in references.windows(2) {
            let [from, to] = pair else { continue };
            let (a, b) = (from.twist(), to.twist());
            way.0 += 0.5 * dt * (a.linear.abs() + b.linear.abs());
            way.1 += 0.5 * dt * (a.angular.abs() + b.angular.abs());
            travelled.push(way);
        }
        Self {
            references,
            travelled,
        }
    }

    /// All of it.
    pub(super) fn into_samples(self) -> Vec<Reference<f64>> {
        self.references
    }

    /// The reference at a tick; at rest behind the last one.
    pub(super) fn at(&self, tick: usize) -> Option<Reference<f64>> {
        let last = self.references.last()?;
        let resting = || Reference::at_rest_with::<Libm>(*last.pose());
        Some(self.references.get(tick).copied().unwrap_or_else(resting))
    }

    /// It comes to rest at its end: it is followed until then.
    pub(super) fn rests_at_end(&self) -> bool {
        self.references.last().is_some_and(Reference::stands)
    }

    /// Metres and radians still to go from a tick on.
    pub(super) fn to_go(&self, tick: usize) -> (f64, f64) {
        let all = self.travelled.last().copied().unwrap_or_default();
        let done = self.travelled.get(tick).copied().unwrap_or(all);
        (all.0 - done.0, all.1 - done.1)
    }

    /// Whether the route has ended by a tick.
    pub(super) fn is_over(&self, tick: usize) -> bool {
        tick + 1 >= self.references.len()
    }
}
