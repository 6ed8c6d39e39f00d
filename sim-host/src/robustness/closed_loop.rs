//! One run.

use super::body::Body;
use super::condition::Disturbance;
use super::law::{self, ComparedLaw};
use super::{Case, StudyError};
use crate::controller_port;
use crate::metrics::{PARKED, SETTLED};
use crate::mission::{AccelerationAt, Mission, Sequencer};
use crate::run::{Law, PaperLaw};
use crate::scenario::ControlLaw;
use controller_core::maths::{Libm, Maths};
use controller_core::motion::Task;
use controller_core::pose_error::pose_error;
use controller_core::types::Wrench;
use serde::{Deserialize, Serialize};

/// How a run ended, the best first.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum RunVerdict {
    /// Within 5 cm and 0.05 rad of the goal, as a norm.
    #[default]
    Arrived,
    /// Beside the goal, but within [`LOST`] of it.
    Missed,
    /// Not arrived, and further than [`LOST`] from the reference at the hand-over.
    LostFollowing,
    /// Further than [`LOST`] from the goal at the end.
    LostParking,
    /// The controller refused a tick.
    Refused,
}

/// A robot whose |(e_x, e_y, e_θ)| is larger is lost \[m, rad\]: half of what it starts with.
pub const LOST: f64 = 0.5;

impl RunVerdict {
    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Arrived => "arrived",
            Self::Missed => "beside",
            Self::LostFollowing => "lost following",
            Self::LostParking => "lost parking",
            Self::Refused => "refused",
        }
    }
}

/// The figures of a run. Errors are the true ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// From when on |(e_x, e_y, e_θ)| < 0.05 up to the hand-over.
    pub settling_s: Option<f64>,
    /// From when on it is below 0.01 with respect to the goal.
    pub parked_s: Option<f64>,
    /// Distance to the goal at the end.
    pub final_m: f64,
    /// Heading error at the end, as a magnitude.
    pub final_rad: f64,
    /// Standard deviations over the last second before the hand-over: force \[N\], moment \[N m\].
    #[serde(with = "WrenchRecord")]
    pub following_std: Wrench<f64>,
    /// The same over the last second of the run.
    #[serde(with = "WrenchRecord")]
    pub rest_std: Wrench<f64>,
    /// Largest force exerted \[N\].
    pub peak_force_n: f64,
    /// Largest moment exerted \[N m\].
    pub peak_moment_nm: f64,
    /// How it ended.
    pub verdict: RunVerdict,
}

/// [`Wrench`] with its parts.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Wrench<f64>")]
struct WrenchRecord {
    force: f64,
    moment: f64,
}

/// Runs a case.
///
/// # Errors
/// A built-in case that cannot be read, or parameters that the core refuses.
pub fn run(
    disturbance: &Disturbance,
    case: Case,
    law: ComparedLaw,
    seed: u64,
) -> Result<Run, StudyError> {
    let scenario = law::scenario(case, disturbance)?;
    let mut mission = scenario.mission(law::base_with_limits(disturbance));
    let kind = match law {
        ComparedLaw::Neural => ControlLaw::Neural,
        ComparedLaw::Plain => ControlLaw::Plain,
        ComparedLaw::Default => {
            law::hand_over_by_distance(&mut mission);
            let mut law = law::default_law(&mission, disturbance)?;
            let sequencer = Sequencer::new(&mission, AccelerationAt::MiddleOfHold);
            return close(&mission, sequencer, law.as_mut(), disturbance, seed);
        }
    };
    let mut controller = controller_port::for_scenario(&scenario.with_law(kind))?;
    let sequencer = Sequencer::new(&mission, AccelerationAt::Tick);
    let mut law = PaperLaw::new(controller.as_mut());
    close(&mission, sequencer, &mut law, disturbance, seed)
}

fn close(
    mission: &Mission,
    mut sequencer: Sequencer<'_>,
    law: &mut dyn Law,
    disturbance: &Disturbance,
    seed: u64,
) -> Result<Run, StudyError> {
    let mut body = Body::new(&mission.base.robot, &mission.start, disturbance, seed)?;
    let dt = disturbance.period_s;
    let ticks = (disturbance.duration_s / dt).round() as usize;
    let mut observer = RunObserver::new(disturbance);
    for tick in 0..=ticks {
        let t = tick as f64 * dt;
        let truth = body.truth();
        let command = law.command();
        let distance = |speed| law.hand_over_distance(speed);
        let orders = sequencer.at(tick, t, &body.measure(), &command, distance);
        let Ok(acted) = law.tick(dt, &orders) else {
            observer.run.verdict = RunVerdict::Refused;
            break;
        };
        let error = pose_error::<f64, Libm>(orders.target.pose(), &truth.pose);
        let exerted = body.advance(&acted.torques)?;
        observer.position_m = Libm::sqrt(error.x * error.x + error.y * error.y);
        observer.heading_rad = error.theta.abs();
        let parking = matches!(orders.task, Task::Park(_));
        observer.see(t, error.norm::<Libm>(), parking, &exerted);
    }
    Ok(observer.finish())
}

/// Collects the figures of a run tick by tick.
struct RunObserver {
    run: Run,
    /// The first tick since which the error has been inside the band.
    inside_since: Option<f64>,
    parked_since: Option<f64>,
    /// The last error while following.
    left_with: f64,
    last_norm: f64,
    position_m: f64,
    heading_rad: f64,
    /// Wrenches of the ticks so far, and how many of them were exerted while following.
    exerted: Vec<Wrench<f64>>,
    followed: usize,
    /// Ticks in a second.
    second: usize,
}

impl RunObserver {
    fn new(disturbance: &Disturbance) -> Self {
        Self {
            run: Run::default(),
            inside_since: None,
            parked_since: None,
            left_with: f64::INFINITY,
            last_norm: f64::INFINITY,
            position_m: f64::INFINITY,
            heading_rad: f64::INFINITY,
            exerted: Vec::new(),
            followed: 0,
            second: (1.0 / disturbance.period_s).round() as usize,
        }
    }

    fn see(&mut self, t: f64, norm: f64, parking: bool, exerted: &Wrench<f64>) {
        let run = &mut self.run;
        if parking {
            run.settling_s = self.inside_since;
            self.parked_since = (norm < PARKED).then(|| self.parked_since.unwrap_or(t));
        } else {
            self.inside_since = (norm < SETTLED).then(|| self.inside_since.unwrap_or(t));
            self.left_with = norm;
            self.followed = self.exerted.len() + 1;
        }
        self.last_norm = norm;
        run.peak_force_n = run.peak_force_n.max(exerted.force.abs());
        run.peak_moment_nm = run.peak_moment_nm.max(exerted.moment.abs());
        self.exerted.push(*exerted);
    }

    fn finish(self) -> Run {
        let mut run = self.run;
        run.parked_s = self.parked_since;
        run.final_m = self.position_m;
        run.final_rad = self.heading_rad;
        let (followed, _) = self.exerted.split_at(self.followed);
        run.following_std = deviation(followed, self.second);
        run.rest_std = deviation(&self.exerted, self.second);
        if run.verdict != RunVerdict::Refused {
            // `<` alone: what is not a number has not arrived.
            run.verdict = if self.last_norm < SETTLED {
                RunVerdict::Arrived
            } else if self.last_norm < LOST && self.left_with < LOST {
                RunVerdict::Missed
            } else if self.last_norm < LOST {
                RunVerdict::LostFollowing
            } else {
                RunVerdict::LostParking
            };
        }
        run
    }
}

/// Standard deviations of the last `count` of `wrenches`.
fn deviation(wrenches: &[Wrench<f64>], count: usize) -> Wrench<f64> {
    let skipped = wrenches.len().saturating_sub(count);
    let last = || wrenches.iter().skip(skipped);
    let count = last().count().max(1) as f64;
    let of = |pick: fn(&Wrench<f64>) -> f64| {
        let mean = last().map(pick).sum::<f64>() / count;
        Libm::sqrt(last().map(|w| (pick(w) - mean).powi(2)).sum::<f64>() / count)
    };
    Wrench {
        force: of(|wrench| wrench.force),
        moment: of(|wrench| wrench.moment),
    }
}
