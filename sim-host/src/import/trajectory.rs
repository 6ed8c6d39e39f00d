//! A reference that satisfies Eq. (6) at every instant.

use super::fit::motion::{Jerk, advance, travel};
use super::fit::{self, CLUSTER, Ends, Node, Rest, Target};
use super::noise::{self, Noise};
use super::ramps::{self, Ramps, fit_at_rest};
use super::raw::{Raw, RawSample};
use super::refusal::{Place, Reason, Refusal};
use super::repair::{Fix, Repair};
use super::time_warp::TimeWarp;
use super::{Closeness, Format, Options};

/// The reference at an instant. SI units, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time from the start.
    pub t: f64,
    /// Position.
    pub x: f64,
    /// Position.
    pub y: f64,
    /// Heading, counter-clockwise, not wrapped.
    pub theta: f64,
    /// Speed along the heading, negative when backing up.
    pub v: f64,
    /// Turn rate.
    pub w: f64,
    /// Rate of `v`.
    pub a: f64,
    /// Rate of `w`.
    pub alpha: f64,
    /// Left of the way until it rests at its end, in the last drive, which goes forward only or backward only; before that, and of a
    /// trajectory that does not rest at its end, 0.
    pub left: f64,
}

/// A trajectory that a wheeled base can follow: continuous in pose, twist and acceleration.
#[derive(Clone, Debug)]
pub struct Trajectory {
    pub(super) nodes: Vec<Node>,
    /// What the last drive has to go, by [`last_drive`].
    left: Vec<f64>,
    pub(super) time_warp: Option<TimeWarp>,
    samples: Vec<Sample>,
    repairs: Vec<Repair>,
    source: Format,
    closeness: Closeness,
    start: f64,
}

/// Speed \[m/s\] and turn rate \[rad/s\] below which a file means rest.
const REST: [f64; 2] = [1e-3, 1e-2];

/// Poses that stay for so long where they are, but for [`REST`], mean rest where no speed says what is meant \[s\].
const STAND_S: f64 = 0.1;

/// Whether a speed \[m/s\] and a turn rate \[rad/s\] mean rest.
pub(super) fn is_rest(v: f64, w: f64) -> bool {
    v.abs() < REST[0] && w.abs() < REST[1]
}

/// A path that is fitted creeps by less than this about a stand \[m\].
const CREEP: f64 = 1e-3;
/// Implied angular accelerations from here on are reported when they are smoothed \[rad/s²\].
const HARSH: f64 = 50.0;

impl Trajectory {
    /// Fits a reference to cleaned samples.
    pub(super) fn of(raw: Raw, start: f64, options: &Options) -> Result<Self, Refusal> {
        let Raw {
            format,
            samples,
            mut repairs,
        } = raw;
        let targets: Vec<Target> = samples
            .iter()
            .map(|s| Target {
                t: s.t,
                x: s.x,
                y: s.y,
                theta: s.theta,
            })
            .collect();
        let rest = Rest {
            start: at_rest(samples.iter()),
            end: at_rest(samples.iter().rev()),
        };
        // Relative to the first position: coordinates may be large, the path is not.
        let origin = targets.first().map_or([0.0; 2], |t| [t.x, t.y]);
        let local: Vec<Target> = targets
            .iter()
            .map(|t| Target {
                x: t.x - origin[0],
                y: t.y - origin[1],
                ..*t
            })
            .collect();
        let own = options.tolerance(format);
        let noise = Noise::of(&samples);
        let tolerance = noise.tolerance(own, options.tube_m.unwrap_or_default());
        let ends = if tolerance == own {
            Ends::Exact
        } else {
            Ends::Noisy
        };
        let Some((mut nodes, mut close)) = fit::fit(&local, rest, tolerance, ends) else {
            let span = samples.last().map_or(0.0, |s| s.t);
            let place = samples.last().map(|s| s.place.clone()).unwrap_or_default();
            return Err(Refusal::new(format, place, Reason::TooShort(span)));
        };
        if close.excess > 1.0 {
            return Err(undrivable(format, &samples, &close, tolerance, &noise));
        }
        let mut ramps = None;
        if options.rests
            && !(rest.start && rest.end)
            && samples.iter().all(|sample| sample.v.is_none())
            && let Some((later, at_rest, as_close)) =
                fit_at_rest(&local, &nodes, rest, tolerance, ends)
        {
            let moving = [
                (rest.start, samples.first(), nodes.first()),
                (rest.end, samples.last(), nodes.last()),
            ];
            for (rests, sample, node) in moving {
                if let (false, Some(sample), Some(node)) = (rests, sample, node)
                    && ramps::takes(node) > ramps::LEAST
                {
                    let what = Fix::AtRest {
                        speed: node.z[3],
                        turn_rate: node.z[4],
                    };
                    repairs.add(sample.place.clone(), sample.t + start, what);
                }
            }
            (ramps, nodes, close) = (Some(later), at_rest, as_close);
        }
        let passes = |t: f64| ramps.map_or(t, |ramps: Ramps| ramps.passes(t));
        for node in &mut nodes {
            node.z[0] += origin[0];
            node.z[1] += origin[1];
        }
        let mut trajectory = Self {
            left: last_drive(&nodes),
            nodes,
            time_warp: None,
            samples: Vec::new(),
            repairs: Vec::new(),
            source: format,
            closeness: Closeness {
                position_m: close.position,
                heading_rad: close.heading,
            },
            start,
        };
        for pair in samples.windows(2) {
            let [from, to] = pair else { continue };
            if to.t - from.t < CLUSTER {
                repairs.add(to.place.clone(), to.t + start, Fix::SharedKnot);
            } else if let (Some(a), Some(b)) = (from.w, to.w) {
                let implied = ((b - a) / (to.t - from.t)).abs();
                let turned = |t: f64| trajectory.at(passes(t)).alpha.abs();
                let mid = turned(0.5 * (from.t + to.t));
                let now = turned(from.t).max(mid).max(turned(to.t));
                if implied > HARSH && now < 0.5 * implied {
                    let what = Fix::Smoothed { implied, now };
                    repairs.add(to.place.clone(), to.t + start, what);
                }
            }
        }
        if tolerance != own
            && let Some(worst) = samples.get(close.worst)
        {
            let what = Fix::Noise {
                scatter: Closeness::from(noise.scatter),
                off: trajectory.closeness,
            };
            repairs.add(worst.place.clone(), worst.t + start, what);
        }
        trajectory.repairs = repairs.finish(start);
        let times: Vec<f64> = trajectory.nodes.iter().map(|n| n.t).collect();
        trajectory.samples = times.into_iter().map(|t| trajectory.at(t)).collect();
        Ok(trajectory)
    }

    /// The reference at `t` seconds from the start. Before the start it stands at the first pose,
    /// after the end at the last.
    pub fn at(&self, t: f64) -> Sample {
        let end = self.duration();
        let inside = t.clamp(0.0, end);
        let (s, rate, rate_dot) = match &self.time_warp {
            Some(time_warp) => time_warp.at(inside),
            None => (inside, 1.0, 0.0),
        };
        let number = self.nodes.partition_point(|n| n.t <= s).saturating_sub(1);
        let Some(node) = self.nodes.get(number) else {
            return Sample::default();
        };
        let z = advance(&node.z, &node.u, s - node.t);
        let way = travel(&node.z, &node.u, s - node.t);
        let left = self.left.get(self.nodes.len() - 1 - number);
        let left = left.map_or(0.0, |left| left - way);
        let moving = if t < 0.0 || t > end { 0.0 } else { 1.0 };
        Sample {
            t,
            x: z[0],
            y: z[1],
            theta: z[2],
            v: moving * z[3] * rate,
            w: moving * z[4] * rate,
            a: moving * (z[5] * rate * rate + z[3] * rate_dot),
            alpha: moving * (z[6] * rate * rate + z[4] * rate_dot),
            left: moving * left.abs(),
        }
    }

    /// Seconds from start to end.
    pub fn duration(&self) -> f64 {
        match &self.time_warp {
            Some(time_warp) => time_warp.duration(),
            None => self.path_duration(),
        }
    }

    /// Seconds that the file takes.
    pub(super) fn path_duration(&self) -> f64 {
        self.nodes.last().map_or(0.0, |n| n.t)
    }

    /// Rates of a and α at a place of the path, at the pace of the file.
    pub(super) fn path_jerk(&self, s: f64) -> Jerk {
        let after = self.nodes.partition_point(|n| n.t <= s);
        let node = self.nodes.get(after.saturating_sub(1));
        node.map_or(Jerk::zeros(), |node| node.u)
    }

    /// The path's own time at a time of the run.
    pub(super) fn path_time(&self, t: f64) -> f64 {
        self.time_warp
            .as_ref()
            .map_or(t, |time_warp| time_warp.at(t).0)
    }

    /// The time of the run at a time of the path.
    pub(super) fn run_time(&self, s: f64) -> f64 {
        self.time_warp
            .as_ref()
            .map_or(s, |time_warp| time_warp.time_of(s))
    }

    /// Another path, at its own pace.
    pub(super) fn with_nodes(&self, nodes: Vec<Node>) -> Self {
        Self {
            left: last_drive(&nodes),
            nodes,
            ..self.without_time_warp()
        }
    }

    /// Samples in strictly increasing time, at most about 25 ms apart, from 0 to the end.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What had to be repaired in the file.
    pub fn repairs(&self) -> &[Repair] {
        &self.repairs
    }

    /// The format of the file.
    pub fn source(&self) -> Format {
        self.source
    }

    /// How close the poses of the file are passed, but for the departure of a path that was smoothed
    /// afterwards ([`super::TimeScaling`]).
    pub fn closeness(&self) -> Closeness {
        self.closeness
    }

    /// Time of the file's first sample, on the clock of the file \[s\].
    pub fn file_start_s(&self) -> f64 {
        self.start
    }

    /// The same path at the pace of the file. Without samples: only for [`Self::at`].
    pub(super) fn without_time_warp(&self) -> Self {
        Self {
            nodes: self.nodes.clone(),
            left: self.left.clone(),
            time_warp: None,
            samples: Vec::new(),
            repairs: self.repairs.clone(),
            ..*self
        }
    }

    /// The same path under another law of time.
    pub(super) fn with_time_warp(&self, time_warp: TimeWarp) -> Self {
        let mut trajectory = Self {
            time_warp: Some(time_warp),
            ..self.without_time_warp()
        };
        let times = trajectory
            .time_warp
            .as_ref()
            .map(TimeWarp::times)
            .unwrap_or_default();
        trajectory.samples = times.into_iter().map(|t| trajectory.at(t)).collect();
        trajectory
    }
}

/// Whether the first of these samples stands: by its speed, or by where those after it are.
fn at_rest<'a>(mut samples: impl Iterator<Item = &'a RawSample>) -> bool {
    let Some(end) = samples.next() else {
        return false;
    };
    if let Some(v) = end.v {
        return is_rest(v, end.w.unwrap_or(0.0));
    }
    for sample in samples {
        let way = libm::hypot(sample.x - end.x, sample.y - end.y);
        if !is_rest(way / STAND_S, (sample.theta - end.theta) / STAND_S) {
            return false;
        }
        if (sample.t - end.t).abs() >= STAND_S {
            return true;
        }
    }
    false
}

/// The way to the end from each node behind the last stand or change of direction, from the end backward; below 0 where it is driven
/// backward \[m\]. Empty if the path does not rest at its end.
fn last_drive(nodes: &[Node]) -> Vec<f64> {
    let rests = |end: &Node| is_rest(end.z[3], end.z[4]);
    if !nodes.last().is_some_and(rests) {
        return Vec::new();
    }
    let mut way = 0.0_f64;
    let mut left = vec![way];
    for pair in nodes.windows(2).rev() {
        let [from, to] = pair else { continue };
        let v = from.z[3];
        // The end is a stand as well.
        let has_driven = way.abs() > CREEP;
        if has_driven && v * way < 0.0 && v.abs() > REST[0] {
            break;
        }
        way += travel(&from.z, &from.u, to.t - from.t);
        left.push(way);
        if has_driven && v.abs() < REST[0] {
            break;
        }
    }
    left
}

/// The refusal of poses that no wheeled base passes: where it moves across its heading by more
/// than a turn explains, or else where the fit missed most. Of poses whose noise alone is more than the tolerance the steps tell nothing.
fn undrivable(
    format: Format,
    samples: &[RawSample],
    close: &fit::Closeness,
    tolerance: [f64; 2],
    noise: &Noise,
) -> Refusal {
    if noise
        .expected()
        .iter()
        .zip(tolerance)
        .any(|(expected, most)| *expected > most)
    {
        let reason = Reason::Noise {
            scatter: Closeness::from(noise.scatter),
            needs_m: noise.tube(),
        };
        return Refusal::new(format, Place::default(), reason);
    }
    let step = |i: usize| {
        Some(noise::step(
            samples.get(i.checked_sub(1)?)?,
            samples.get(i)?,
        ))
    };
    let slip = |i| {
        step(i).map_or(0.0, |(forward, sideways, turn): (f64, f64, f64)| {
            sideways.abs() - 0.5 * (forward * turn).abs()
        })
    };
    // The first of equal ones, but for rounding.
    let most = (1..samples.len()).map(slip).fold(0.0, f64::max);
    let most = (1..samples.len()).find(|&i| slip(i) >= (1.0 - 1.0e-9) * most);
    let worst = most
        .filter(|&i| slip(i) > tolerance[0])
        .unwrap_or(close.worst.max(1));
    let (forward_m, sideways_m, turn_rad) = step(worst).unwrap_or_default();
    let reason = Reason::Undrivable {
        forward_m,
        sideways_m,
        turn_rad,
    };
    let place = samples.get(worst).map(|s| s.place.clone());
    Refusal::new(format, place.unwrap_or_default(), reason)
}
