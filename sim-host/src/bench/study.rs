//! All runs, side by side.

use super::law::{Law, LawKind};
use super::tracks::{BadFile, Case, Named, TrackFile, cases};
use super::tuned::Tuned;
use super::{Class, Figures};
use crate::closed_loop::ClosedLoopError;
use crate::mission::{AccelerationAt, BaseSpec, Change, Mission, Sequencer};
use crate::precision::Precision;
use crate::run::{self, Driver, RivalLaw, RunError, motion_law, on_ideal_plant};
use crate::trace::Trace;
use crate::trials::REST_S;
use controller_core::error::ParamError;
use controller_core::motion::{Arrival, MotionParams};
use rayon::prelude::*;

/// What is run.
#[derive(Clone, Debug)]
pub struct Settings<'a> {
    /// Bases with their names; parking is run on those whose least times are known.
    pub bases: Vec<(String, BaseSpec)>,
    /// Classes.
    pub classes: Vec<Class>,
    /// Trajectory files.
    pub files: Vec<TrackFile<'a>>,
    /// Starts of parking, and worlds of the other tracks together.
    pub runs: usize,
    /// Settles everything that is drawn.
    pub seed: u64,
    /// Laws beside our own; all of them if empty.
    pub laws: Vec<LawKind>,
}

/// Why there is no benchmark.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// A file that cannot be driven.
    #[error(transparent)]
    File(#[from] BadFile),
    /// A parameter of a base.
    #[error("{0}")]
    Param(ParamError),
    /// A base or a world out of range.
    #[error(transparent)]
    ClosedLoop(#[from] ClosedLoopError),
    /// A run of our own law that was refused.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl From<ParamError> for BenchError {
    fn from(error: ParamError) -> Self {
        Self::Param(error)
    }
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Track and plant.
    pub class: Class,
    /// Index of the base.
    pub base: usize,
    /// For people.
    pub course: String,
    /// Of its world.
    pub seed: u64,
    /// Who drove.
    pub law: Law,
    /// The least time \[s\].
    pub minimum_s: f64,
    /// What came of it.
    pub figures: Figures,
}

/// The cases and laws of all classes, in the order of tables.
fn jobs(settings: &Settings<'_>) -> Result<Vec<(Case, Law)>, BenchError> {
    let bases: Vec<(usize, &Named)> = settings.bases.iter().enumerate().collect();
    let pairs = settings
        .classes
        .iter()
        .flat_map(|class| bases.iter().map(move |base| (*class, *base)));
    let pairs: Vec<_> = pairs.collect();
    // Fitting files takes seconds.
    let all: Vec<Vec<Case>> = pairs
        .into_par_iter()
        .map(|(class, base)| cases(class, base, &settings.files, settings.runs, settings.seed))
        .collect::<Result<_, _>>()?;
    let with_laws = all.into_iter().flatten().flat_map(|case| {
        let chosen = &settings.laws;
        let laws = Law::of(case.class.track).into_iter().filter(|law| {
            chosen.is_empty() || law.kind == LawKind::Default || chosen.contains(&law.kind)
        });
        laws.collect::<Vec<_>>()
            .into_iter()
            .map(move |law| (case.clone(), law))
    });
    Ok(with_laws.collect())
}

/// Number of runs that [`study`] makes.
///
/// # Errors
/// As [`study`].
pub fn runs(settings: &Settings<'_>) -> Result<usize, BenchError> {
    Ok(jobs(settings)?.len())
}

/// Runs every law on every case; the same runs for any number of threads. `done` is called after each.
///
/// # Errors
/// A file that cannot be driven, a base or a world out of range.
pub fn study(
    settings: &Settings<'_>,
    tuned: &Tuned,
    done: impl Fn() + Sync,
) -> Result<Vec<Run>, BenchError> {
    let jobs = jobs(settings)?;
    jobs.into_par_iter()
        .map(|(case, law)| {
            let (name, _) = &settings.bases[case.base];
            let gains = tuned.gains(&law, name, case.class.track);
            let figures = drive(&case.mission, law.kind, &gains)?;
            done();
            Ok(Run {
                class: case.class,
                base: case.base,
                course: case.course,
                seed: case.seed,
                law,
                minimum_s: case.minimum_s,
                figures,
            })
        })
        .collect()
}

/// One run.
pub(super) fn drive(
    mission: &Mission,
    kind: LawKind,
    gains: &[f32],
) -> Result<Figures, BenchError> {
    let trace = match ride(mission, kind, gains)? {
        Some(trace) => trace,
        None => return Ok(Figures::refused()),
    };
    Ok(Figures::of(mission, &trace))
}

/// The trace of a run; none if the law refused.
fn ride(mission: &Mission, kind: LawKind, gains: &[f32]) -> Result<Option<Trace>, BenchError> {
    let base = &mission.base;
    let body = run::body(mission, super::ASKED);
    let Some(rival) = kind.rival(gains, &body) else {
        return ours(mission, kind).map(Some);
    };
    let mut driver = Driver::new(rival, body, mission);
    let trace = match &mission.setup {
        Some(setup) => run::ride(mission, setup, &mut driver, REST_S)?,
        None => {
            let motion = MotionParams::<f32>::new(base.robot.cast(), base.limits.cast());
            let motion = MotionParams {
                gains: base.motion().gains.cast(),
                arrival: Arrival::exact(),
                ..motion
            };
            let motion = motion.validate()?;
            let sequencer = Sequencer::new(mission, AccelerationAt::MiddleOfHold);
            let mut law = RivalLaw::new(&mut driver, motion);
            match on_ideal_plant(mission, sequencer, &mut law) {
                Ok(trace) => trace,
                // A law that has no answer.
                Err(RunError::ControllerPort { .. }) => return Ok(None),
                Err(error) => return Err(error.into()),
            }
        }
    };
    Ok((!driver.has_refused()).then_some(trace))
}

/// Our own law, as `sim-host run` drives it.
fn ours(mission: &Mission, kind: LawKind) -> Result<Trace, BenchError> {
    let mut held;
    let mission = if kind == LawKind::HeadingHeld {
        held = mission.clone();
        for event in &mut held.events {
            if let Change::Drive(order) = &mut event.change {
                order.hold_heading = true;
            }
        }
        &held
    } else {
        mission
    };
    Ok(match &mission.setup {
        Some(setup) => run::drive_and_observe(mission, setup, REST_S)?,
        None => {
            let mut law = motion_law(&mission.base, Precision::F32)?;
            let sequencer = Sequencer::new(mission, AccelerationAt::MiddleOfHold);
            on_ideal_plant(mission, sequencer, law.as_mut())?
        }
    })
}
