//! Noise of recorded poses, told from motion, and what a reference has to leave to it.

use super::closeness::{AHEAD, room};
use super::raw::RawSample;

/// A standard deviation over the median magnitude of a normal distribution.
const BY_MEDIAN: f64 = 1.482_602_218_505_602;
/// Of so many recordings all poses but those of one are within what [`Noise::needs`] says.
const RECORDINGS: f64 = 100.0;

/// Noise of poses: standard deviations along an axis \[m\] and in heading \[rad\]; 0 where poses move rather than scatter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    pub(super) scatter: [f64; 2],
    count: f64,
}

impl Noise {
    /// By how far a base would move across its heading from each pose to the next, and how far each heading is off the line between its
    /// neighbours. Motion makes one of these like the one before; noise that is independent from pose to pose makes it opposite in sign,
    /// 67 and 73 % of the time (1/2 + asin(ρ)/π, of correlations −1/2 and −2/3). Medians are not moved by single steps.
    pub(super) fn of(samples: &[RawSample]) -> Self {
        let across = samples.windows(2).map(|pair| {
            let [from, to] = pair else { return 0.0 };
            // Of two equal variances, to one.
            step(from, to).1 / 2_f64.sqrt()
        });
        let turned = samples.windows(3).map(|three| {
            let [from, here, to] = three else { return 0.0 };
            let part = (here.t - from.t) / (to.t - from.t);
            let between = from.theta + part * (to.theta - from.theta);
            let variances = 1.0 + part * part + (1.0 - part) * (1.0 - part);
            (here.theta - between) / variances.sqrt()
        });
        Self {
            scatter: [scatter(across.collect()), scatter(turned.collect())],
            count: samples.len() as f64,
        }
    }

    /// How far from where the base was the farthest pose of so many recordings is expected: of N distances in the plane one is beyond
    /// σ √(2 ln N). Headings are a little nearer.
    fn farthest(&self, recordings: f64) -> [f64; 2] {
        let farthest = (2.0 * (recordings * self.count).ln()).sqrt();
        self.scatter.map(|scatter| farthest * scatter)
    }

    /// The same of this recording.
    pub(super) fn expected(&self) -> [f64; 2] {
        self.farthest(1.0)
    }

    /// How far all poses are off at most, but in one of [`RECORDINGS`].
    pub(super) fn needs(&self) -> [f64; 2] {
        self.farthest(RECORDINGS)
    }

    /// The tube that leaves room for all poses \[m\].
    pub(super) fn tube(&self) -> f64 {
        let [position, heading] = self.needs();
        position.max(AHEAD * heading)
    }

    /// How far off poses may be passed, `own` where they have no noise beyond it, and no farther than a tube lets them: a reference that
    /// is held closer to poses than their noise follows it to and fro. Of noise that is more than the tube it follows what it can.
    pub(super) fn tolerance(&self, own: [f64; 2], tube: f64) -> [f64; 2] {
        let most = room(tube);
        let (expected, needs) = (self.expected(), self.needs());
        [0, 1].map(|i| {
            let needs = if expected[i] > most[i] {
                0.0
            } else {
                needs[i].min(most[i])
            };
            needs.max(own[i])
        })
    }
}

/// A standard deviation, or 0 if less than half of the values are opposite in sign to the one before.
fn scatter(values: Vec<f64>) -> f64 {
    let pairs = values.windows(2);
    let opposite = pairs.filter(|pair| pair.iter().product::<f64>() < 0.0);
    if 2 * opposite.count() < values.len() {
        return 0.0;
    }
    let mut sizes: Vec<_> = values.into_iter().map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    BY_MEDIAN * sizes.get(sizes.len() / 2).copied().unwrap_or_default()
}

/// From a pose to the next: along the mean heading, across it, and the turn.
pub(super) fn step(from: &RawSample, to: &RawSample) -> (f64, f64, f64) {
    let (sin, cos) = libm::sincos(0.5 * (from.theta + to.theta));
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    (
        dx * cos + dy * sin,
        dy * cos - dx * sin,
        to.theta - from.theta,
    )
}
