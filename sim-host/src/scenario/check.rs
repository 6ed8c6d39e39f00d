//! From keys to a [`Scenario`]: defaults, ranges, contradictions.

use super::source::{Checked, Source};
use super::{Controller, MathsBackEnd, Scenario, belief, file, ranges};
use crate::mission::check_length;
use crate::motion::{Profile, ReferenceMotion};
use crate::precision::Precision;
use controller_core::reference::{ConstantTwist, ParkingPlan};
use controller_core::types::{Measured, Pose, Twist};

pub(super) fn scenario(name: String, keys: &file::File, place: &Source<'_>) -> Checked<Scenario> {
    ranges::check(keys, place)?;
    let controller = controller(&keys.controller, place)?;
    let params = belief::params(keys, place)?;
    let robot = belief::true_robot(&params.robot, &keys.plant, place)?;
    let motion = motion(&keys.reference);
    let (duration_s, period_s) = timing(&keys.run, params.max_tick_s, place)?;
    let hand_over = match &keys.hand_over {
        Some(keys) => Some(hand_over(keys, &motion, duration_s, place)?),
        None => None,
    };
    let start = &keys.start;
    Ok(Scenario {
        name,
        description: keys.description.clone(),
        controller,
        params,
        robot,
        start: Measured {
            pose: Pose::new(start.x, start.y, start.theta),
            twist: Twist::new(start.v, start.w),
        },
        motion,
        hand_over,
        duration_s,
        period_s,
    })
}

fn controller(keys: &file::Controller, place: &Source<'_>) -> Checked<Controller> {
    if keys.precision == Precision::F64 && keys.maths != MathsBackEnd::Libm {
        let message =
            "computes in single precision only: set precision = \"f32\", or maths = \"libm\"";
        return Err(place.error("controller.maths", message));
    }
    Ok(Controller {
        kind: keys.kind,
        precision: keys.precision,
        maths: keys.maths,
        neurons: keys.neurons,
        parking: keys.parking,
    })
}

pub(super) fn motion(keys: &file::MotionKeys) -> ReferenceMotion {
    let start = Pose::new(keys.start.x, keys.start.y, keys.start.theta);
    let profile = |keys: &file::Profile| {
        let (amplitude, frequency, phase) = keys.sine.unwrap_or_default();
        Profile {
            mean: keys.mean,
            amplitude,
            frequency,
            phase,
        }
    };
    match (keys.v.sine, keys.w.sine) {
        (None, None) => ReferenceMotion::Constant(ConstantTwist {
            start,
            twist: Twist::new(keys.v.mean, keys.w.mean),
        }),
        _ => ReferenceMotion::Modulated {
            start,
            speed: profile(&keys.v),
            turn_rate: profile(&keys.w),
        },
    }
}

pub(super) fn timing(keys: &file::Run, max_tick: f64, place: &Source<'_>) -> Checked<(f64, f64)> {
    let file::Run { duration, period } = *keys;
    if !(period.is_finite() && period > 0.0) {
        return Err(place.error("run.period", "must be a finite number above 0"));
    }
    if period > max_tick {
        let message = format!("is above controller.max_tick = {max_tick} s");
        return Err(place.error("run.period", message));
    }
    let length = check_length(duration, period);
    length.map_err(|error| place.error("run.duration", error))?;
    Ok((duration, period))
}

fn hand_over(
    keys: &file::HandOver,
    motion: &ReferenceMotion,
    duration_s: f64,
    place: &Source<'_>,
) -> Checked<ParkingPlan<f64>> {
    // The first tick starts tracking, so there is nothing to hand over at 0.
    if !(keys.time > 0.0 && keys.time <= duration_s) {
        let message = "must be above 0 and within run.duration; without [hand_over] the robot tracks to the end";
        return Err(place.error("hand_over.time", message));
    }
    let goal = match (keys.target_at, keys.target) {
        (Some(_), Some(_)) => {
            let message = "says the same as target: leave one of them out";
            return Err(place.error("hand_over.target_at", message));
        }
        (None, None) => {
            let message = "needs target_at (a time on the reference) or target (a pose)";
            return Err(place.error("hand_over", message));
        }
        (None, Some(target)) => Pose::new(target.x, target.y, target.theta),
        (Some(at), None) => ranges::target_at(at, motion, place)?,
    };
    Ok(ParkingPlan {
        hand_over_s: keys.time,
        goal,
    })
}
