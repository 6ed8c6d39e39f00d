//! Knots of the fit: one per cluster of samples, and more where the file has gaps.

/// A pose that the fit is to pass.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Target {
    pub(in super::super) t: f64,
    pub(in super::super) x: f64,
    pub(in super::super) y: f64,
    pub(in super::super) theta: f64,
}

/// Samples closer than this share a knot \[s\].
pub(in super::super) const CLUSTER: f64 = 1e-3;
/// Knots are not farther apart than this \[s\], …
const STEP: f64 = 0.025;
/// … unless there would be more than this many between two samples, …
const PIECES: f64 = 128.0;
/// … or in all.
const MAX_KNOTS: f64 = 400_000.0;

/// A knot.
#[derive(Clone, Debug)]
pub(super) struct Knot {
    pub(super) t: f64,
    /// The targets that belong to it.
    pub(super) targets: std::ops::Range<usize>,
}

/// Knots for targets in strictly increasing time.
pub(super) fn knots(targets: &[Target]) -> Vec<Knot> {
    let Some(last) = targets.last() else {
        return Vec::new();
    };
    let mut clusters: Vec<Knot> = Vec::new();
    for (i, target) in targets.iter().enumerate() {
        match clusters.last_mut() {
            Some(knot) if target.t - knot.t < CLUSTER => knot.targets.end = i + 1,
            _ => clusters.push(Knot {
                t: target.t,
                targets: i..i + 1,
            }),
        }
    }
    // The last knot is the last sample, so that the reference ends where the file ends.
    if clusters.len() > 1
        && let Some(knot) = clusters.last_mut()
    {
        knot.t = last.t;
    }
    let room = (MAX_KNOTS - clusters.len() as f64).max(1.0);
    let step = STEP.max(last.t / room);
    let mut knots = Vec::with_capacity(clusters.len());
    let mut before: Option<f64> = None;
    for cluster in clusters {
        if let Some(from) = before {
            let gap = cluster.t - from;
            let pieces = (gap / step).ceil().clamp(1.0, PIECES) as usize;
            for i in 1..pieces {
                knots.push(Knot {
                    t: from + gap * i as f64 / pieces as f64,
                    targets: 0..0,
                });
            }
        }
        before = Some(cluster.t);
        knots.push(cluster);
    }
    knots
}
