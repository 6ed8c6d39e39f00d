//! Many runs in a few numbers.

use super::{ASKED, Class, Law, LawKind, Run};

/// Median, nine tenths and most of a figure; infinite where runs have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Half of the runs are at most here.
    pub median: f64,
    /// Nine tenths.
    pub most: f64,
    /// All.
    pub worst: f64,
}

impl Spread {
    /// Of values of which some are infinite.
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = values.len().saturating_sub(1);
            let rank = (share * last as f64).round() as usize;
            values.get(rank).copied().unwrap_or(f64::INFINITY)
        };
        Self {
            median: at(0.5),
            most: at(0.9),
            worst: at(1.0),
        }
    }
}

/// A law in a class, on a base.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Track and plant.
    pub class: Class,
    /// Index of the base.
    pub base: usize,
    /// Who drove.
    pub law: Law,
    /// Number of runs.
    pub runs: usize,
    /// How many did not arrive.
    pub failed: usize,
    /// Time until truly arrived \[s\].
    pub time_s: Spread,
    /// The same over the least time.
    pub ratio: Spread,
    /// The same ratio of [`ALLOWED_S`] less.
    pub late: Spread,
    /// Distance to the goal at the end \[m\].
    pub error_m: Spread,
    /// Heading error at the end \[rad\].
    pub error_rad: Spread,
    /// Root mean square distance to the reference \[m\].
    pub rms_m: Spread,
    /// Largest distance \[m\].
    pub peak_m: Spread,
    /// Largest torque step of a wheel, over its limit.
    pub torque_step: Spread,
    /// Root mean square jerk of a rim \[m/s³\].
    pub jerk: Spread,
    /// Work \[J\].
    pub energy_j: Spread,
    /// It is on the Pareto front of time and exactness.
    pub on_front: bool,
    /// Sooner there than our own law, at equal or better exactness.
    pub wins_time: bool,
    /// Closer to its reference than our own law.
    pub wins_tracking: bool,
}

/// A law in a class, on all bases.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Track and plant.
    pub class: Class,
    /// Who drove.
    pub law: Law,
    /// In the order of bases.
    pub bases: Vec<Summary>,
}

/// What parking on real hardware may take beside its share of the least time \[s\].
pub const ALLOWED_S: f64 = 0.5;
/// Sooner, or closer, by less than this share is no difference.
const DIFFERENCE: f64 = 0.01;

impl Summary {
    fn of(runs: &[&Run]) -> Option<Self> {
        let first = runs.first()?;
        let all = |figure: fn(&Run) -> f64| Spread::of(runs.iter().map(|run| figure(run)));
        let late = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
        Some(Self {
            class: first.class,
            base: first.base,
            law: first.law,
            runs: runs.len(),
            failed: runs.iter().filter(|run| run.figures.failed).count(),
            time_s: Spread::of(runs.iter().map(|run| late(run.figures.arrived_s))),
            ratio: Spread::of(
                runs.iter()
                    .map(|run| late(run.figures.arrived_s) / run.minimum_s),
            ),
            late: Spread::of(
                runs.iter()
                    .map(|run| (late(run.figures.arrived_s) - ALLOWED_S) / run.minimum_s),
            ),
            error_m: all(|run| run.figures.error_m),
            error_rad: all(|run| run.figures.error_rad),
            rms_m: Spread::of(runs.iter().map(|run| late(run.figures.rms_m))),
            peak_m: Spread::of(runs.iter().map(|run| late(run.figures.peak_m))),
            torque_step: all(|run| run.figures.torque_step),
            jerk: all(|run| run.figures.jerk),
            energy_j: all(|run| run.figures.energy_j),
            on_front: false,
            wins_time: false,
            wins_tracking: false,
        })
    }

    /// What a figure shows beside time: the end of a park, the distance to the reference elsewhere.
    pub fn exactness(&self) -> f64 {
        match self.class.track {
            super::Track::Parking => self.error_m.median,
            _ => self.rms_m.median,
        }
    }

    /// As exact as what is asked, or as another.
    fn is_as_exact_as(&self, other: &Self) -> bool {
        let most = |own: f64, asked: f64| own.max(asked);
        self.failed * other.runs <= other.failed * self.runs
            && self.error_m.most <= most(other.error_m.most, ASKED.0)
            && self.error_rad.most <= most(other.error_rad.most, ASKED.1)
    }
}

/// All laws of all classes, in the order of their runs; of each rival both flavours.
pub fn summaries(runs: &[Run]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let mut classes: Vec<Class> = Vec::new();
    for run in runs {
        if !classes.contains(&run.class) {
            classes.push(run.class);
        }
    }
    for class in classes {
        let of_class: Vec<&Run> = runs.iter().filter(|run| run.class == class).collect();
        let mut laws: Vec<Law> = Vec::new();
        let mut bases: Vec<usize> = Vec::new();
        for run in &of_class {
            if !laws.contains(&run.law) {
                laws.push(run.law);
            }
            if !bases.contains(&run.base) {
                bases.push(run.base);
            }
        }
        let mut of_laws: Vec<Row> = laws
            .into_iter()
            .map(|law| Row {
                class,
                law,
                bases: bases
                    .iter()
                    .filter_map(|base| {
                        let own = of_class
                            .iter()
                            .filter(|run| run.law == law && run.base == *base);
                        Summary::of(&own.copied().collect::<Vec<_>>())
                    })
                    .collect(),
            })
            .collect();
        for at in 0..bases.len() {
            judge(&mut of_laws, at);
        }
        rows.extend(of_laws);
    }
    rows
}

/// Who is on the front, and who is better than our own law, on a base.
fn judge(rows: &mut [Row], at: usize) {
    let all: Vec<Summary> = rows
        .iter()
        .filter_map(|row| row.bases.get(at).cloned())
        .collect();
    let ours = all
        .iter()
        .find(|summary| summary.law.kind == LawKind::Default);
    for row in rows.iter_mut() {
        let Some(own) = row.bases.get_mut(at) else {
            continue;
        };
        let point = |summary: &Summary| (summary.ratio.median, summary.exactness());
        let (time, off) = point(own);
        let beaten = all.iter().map(point).any(|(other_time, other_off)| {
            other_time <= time && other_off <= off && (other_time < time || other_off < off)
        });
        own.on_front = time.is_finite() && off.is_finite() && !beaten;
        let Some(ours) = ours else { continue };
        if matches!(own.law.kind, LawKind::Default | LawKind::HeadingHeld) {
            continue;
        }
        let better = |rival: f64, ours: f64| rival < (1.0 - DIFFERENCE) * ours;
        own.wins_time = own.is_as_exact_as(ours) && better(own.ratio.median, ours.ratio.median);
        own.wins_tracking = own.failed * ours.runs <= ours.failed * own.runs
            && better(own.rms_m.median, ours.rms_m.median);
    }
}
