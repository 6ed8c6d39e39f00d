//! Ends at rest for a file that moves there and does not say how fast.
//!
//! A robot starts from rest and is to stop at the last pose. Where a file states no speeds nobody asks for another end: its poses
//! are passed later, so that there is time to come to its pace and to leave it, and fitted anew. The ramps are
//! brisker than bases are, whose limits slow them.

use super::fit::{self, Closeness, Ends, Node, Rest, Target};

/// Acceleration \[m/s²\] and angular acceleration \[rad/s²\] of a ramp: of the first try, half of that in each one more.
const BRISK: [f64; 2] = [10.0, 50.0];
/// How often a fit is tried.
const TRIES: usize = 4;
/// From the second try on a ramp takes at least this \[s\], about the time between two knots.
pub(super) const LEAST: f64 = 0.02;

/// Seconds that a motion takes to come to the pace of its file, and to leave it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ramps {
    start: f64,
    end: f64,
    /// Of the file.
    duration: f64,
}

impl Ramps {
    /// Of a motion that moves at ends where it does not rest.
    fn of(nodes: &[Node], rest: Rest) -> Self {
        let duration = nodes.last().map_or(0.0, |node| node.t);
        let takes = |node: Option<&Node>| node.map_or(0.0, takes).min(duration);
        Self {
            start: takes(nodes.first().filter(|_| !rest.start)),
            end: takes(nodes.last().filter(|_| !rest.end)),
            duration,
        }
    }

    fn doubled(self, rest: Rest) -> Self {
        let doubled = |ramp: f64, rests| {
            if rests {
                ramp
            } else {
                2.0 * ramp.max(0.5 * LEAST)
            }
        };
        Self {
            start: doubled(self.start, rest.start),
            end: doubled(self.end, rest.end),
            ..self
        }
    }

    /// When the motion is where the file is at a time.
    pub(super) fn passes(self, t: f64) -> f64 {
        // With constant acceleration a ramp has half the way that the pace has.
        let reached = |t: f64, ramp: f64| match t < 0.5 * ramp {
            true => (2.0 * ramp * t).sqrt(),
            false => t + 0.5 * ramp,
        };
        if 2.0 * t < self.duration {
            return reached(t, self.start);
        }
        let whole = self.duration + 0.5 * (self.start + self.end);
        whole - reached(self.duration - t, self.end)
    }
}

/// Seconds that a ramp to what a node moves at takes, at first.
pub(super) fn takes(node: &Node) -> f64 {
    let [v, w] = [node.z[3], node.z[4]];
    (v / BRISK[0]).abs().max((w / BRISK[1]).abs())
}

/// The fit to the same poses that rests at both ends, with its ramps; `nodes` and `rest` are those of the file. `None` if it misses poses.
pub(super) fn fit_at_rest(
    targets: &[Target],
    nodes: &[Node],
    rest: Rest,
    tolerance: [f64; 2],
    ends: Ends,
) -> Option<(Ramps, Vec<Node>, Closeness)> {
    let both = Rest {
        start: true,
        end: true,
    };
    let mut ramps = Ramps::of(nodes, rest);
    for _ in 0..TRIES {
        let later: Vec<Target> = targets
            .iter()
            .map(|target| Target {
                t: ramps.passes(target.t),
                ..*target
            })
            .collect();
        if let Some((nodes, close)) = fit::fit(&later, both, tolerance, ends)
            && close.excess <= 1.0
        {
            return Some((ramps, nodes, close));
        }
        ramps = ramps.doubled(rest);
    }
    None
}
