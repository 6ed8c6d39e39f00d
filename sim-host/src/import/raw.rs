//! Samples as a reader hands them over, and the checks common to all formats.

use super::refusal::{Place, Reason, Refusal};
use super::repair::{Fix, Repairs};
use super::{Format, MAX_SAMPLES};
use controller_core::types::FARTHEST_M;
use std::f64::consts::{PI, TAU};

/// Latest time taken \[s\]; beyond, it is not in seconds.
const MAX_TIME: f64 = 1e11;
/// Largest heading taken \[rad\].
const MAX_HEADING: f64 = 1e6;
/// Fastest motion between samples that is not a jump \[m/s\], \[rad/s\].
const MAX_SPEED: f64 = 100.0;
const MAX_TURN_RATE: f64 = 200.0;
/// Distance \[m\] and angle \[rad\] that rounding may put between two equal poses.
const ROUNDING: f64 = 1e-4;
/// Nobody knows what the base does in a longer gap \[s\].
const MAX_GAP: f64 = 30.0;
/// Headings this far off the motion (mean) are of no wheeled base, and degrees if that leaves this share of it \[rad\].
const ASKEW: f64 = 0.1;
const ASKEW_SHARE: f64 = 0.2;
/// Repeats of an instant may go back by this much \[s\].
const REPEAT: f64 = 1e-9;

/// One sample of a file.
#[derive(Clone, Debug)]
pub(super) struct RawSample {
    pub(super) place: Place,
    pub(super) t: f64,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) theta: f64,
    /// Speed, if the file has it and it is finite.
    pub(super) v: Option<f64>,
    /// Turn rate, if the file tells it and it means something.
    pub(super) w: Option<f64>,
}

/// What a reader hands over.
#[derive(Clone, Debug)]
pub(super) struct Raw {
    pub(super) format: Format,
    pub(super) samples: Vec<RawSample>,
    pub(super) repairs: Repairs,
}

impl Raw {
    /// Checks every value and the order of time, drops repeats, unwraps headings, starts time at 0.
    /// Returns the time of the file's first sample.
    pub(super) fn clean(&mut self) -> Result<f64, Refusal> {
        let format = self.format;
        let refuse = |place: &Place, field: &str, reason| {
            Err(Refusal::new(format, place.clone().field(field), reason))
        };
        if self.samples.len() > MAX_SAMPLES {
            let reason = Reason::TooManySamples { limit: MAX_SAMPLES };
            return Err(Refusal::new(format, Place::default(), reason));
        }
        for sample in &self.samples {
            for (field, value, limit) in [
                ("t", sample.t, MAX_TIME),
                ("x", sample.x, FARTHEST_M),
                ("y", sample.y, FARTHEST_M),
                ("theta", sample.theta, MAX_HEADING),
            ] {
                if value.is_nan() || value.abs() > limit {
                    let reason = if value.is_finite() && matches!(field, "x" | "y") {
                        Reason::Far(value)
                    } else {
                        Reason::OutOfRange { value, limit }
                    };
                    return refuse(&sample.place, field, reason);
                }
            }
        }
        if let Some((place, reason)) = degrees(&self.samples) {
            return refuse(&place, "theta", reason);
        }
        let mut kept: Vec<RawSample> = Vec::with_capacity(self.samples.len());
        for mut sample in self.samples.drain(..) {
            let Some(last) = kept.last() else {
                kept.push(sample);
                continue;
            };
            let dt = sample.t - last.t;
            let chord = libm::hypot(sample.x - last.x, sample.y - last.y);
            sample.theta = unwrap(last, &sample, dt);
            let turn = (sample.theta - last.theta).abs();
            if dt < -REPEAT {
                return refuse(&sample.place, "t", Reason::TimeGoesBack(-dt));
            }
            let (far, round) = (MAX_SPEED * dt.max(0.0), MAX_TURN_RATE * dt.max(0.0));
            if chord > ROUNDING + far || turn > ROUNDING + round {
                let reason = Reason::Jump {
                    apart_m: chord,
                    apart_rad: turn,
                    dt_s: dt,
                };
                return Err(Refusal::new(format, sample.place, reason));
            }
            if dt > MAX_GAP {
                return refuse(&sample.place, "t", Reason::Gap(dt));
            }
            if dt <= 0.0 {
                self.repairs.add(sample.place, sample.t, Fix::DroppedRepeat);
                continue;
            }
            kept.push(sample);
        }
        let count = kept.len();
        let Some(first) = kept.first() else {
            return refuse(&Place::default(), "samples", Reason::TooFewSamples(0));
        };
        let start = first.t;
        for sample in &mut kept {
            sample.t -= start;
            // -0.0 is a zero like any other; nothing below may tell them apart.
            sample.x += 0.0;
            sample.y += 0.0;
            sample.v = sample.v.map(|v| v + 0.0);
        }
        self.samples = kept;
        if count < 2 {
            return refuse(&Place::default(), "samples", Reason::TooFewSamples(count));
        }
        Ok(start)
    }
}

/// Whether headings beyond a whole turn are degrees: the place of the first of these, and by how much they fit better.
///
/// Of an arc the chord points where the middle of the two headings does, or away from there backward.
fn degrees(samples: &[RawSample]) -> Option<(Place, Reason)> {
    let first = samples.iter().find(|sample| sample.theta.abs() > TAU)?;
    let off = |unit: f64| {
        let (mut way, mut sum) = (0.0, 0.0);
        for pair in samples.windows(2) {
            let [from, to] = pair else { continue };
            let (dx, dy) = (to.x - from.x, to.y - from.y);
            let chord = libm::hypot(dx, dy);
            let middle = unit * from.theta + 0.5 * wrap(unit * (to.theta - from.theta));
            way += chord;
            sum += chord * libm::sin(libm::atan2(dy, dx) - middle).abs();
        }
        // Of samples that do not move it is no number, and no less than any.
        libm::asin(sum / way)
    };
    let (radians, degrees) = (off(1.0), off(PI / 180.0));
    let reason = Reason::Degrees {
        radians_off_rad: radians,
        degrees_off_rad: degrees,
    };
    (radians > ASKEW && degrees < ASKEW_SHARE * radians).then(|| (first.place.clone(), reason))
}

/// The heading of `to` on the branch that its turn rates tell, or else nearest to `from`.
fn unwrap(from: &RawSample, to: &RawSample, dt: f64) -> f64 {
    let expected = match (from.w, to.w) {
        (Some(a), Some(b)) => 0.5 * dt * (a + b),
        _ => 0.0,
    };
    // A rate that would turn the base more than once is not trusted with the branch.
    let expected = if expected.abs() < TAU { expected } else { 0.0 };
    from.theta + expected + wrap(to.theta - from.theta - expected)
}

/// The same angle in (−π, π].
pub(super) fn wrap(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}
