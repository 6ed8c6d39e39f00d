//! Gains of the rivals, searched.
//!
//! The search of [`crate::tune`], with its budget of evaluations, and its score: time, error at the end, tracking, effort,
//! and ten points for a run that does not park. On the ideal plant, for each base, and for parking and for following by
//! themselves. Starts and seeds of the search are not those of the comparison unless a seed is chosen so.

use super::study::drive;
use super::tracks::{self, Named, TrackFile};
use super::tuned::Tuned;
use super::{BenchError, Class, Figures, LawKind, Plant, Track};
use crate::mission::{Course, End, HandOverRule, Mission};
use crate::trials;
use crate::tune::{Score, simplex};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Sets of gains that are tried, and simplexes: those of `tune`.
const SEARCH: (u64, usize) = (240, 3);
/// The same for a law whose tick costs a hundred times as much.
const SHORT_SEARCH: (u64, usize) = (60, 1);
/// Starts of parking in which each set is tried.
const STARTS: usize = 8;
/// Of the search.
const SEED: u64 = 1_000_001;
/// A gain that is 0 where published begins here.
const LEAST: f64 = 1.0e-2;
/// How long a run may last, after the end of its reference if it has one \[s\]: who is later is as good as lost.
const LATE_S: f64 = 15.0;

/// How many sets [`tune`] tries.
pub fn evaluations(bases: usize) -> u64 {
    let each: u64 = LawKind::RIVALS.into_iter().map(|kind| budget(kind).0).sum();
    2 * bases as u64 * each
}

const fn budget(kind: LawKind) -> (u64, usize) {
    match kind {
        LawKind::Mpc => SHORT_SEARCH,
        _ => SEARCH,
    }
}

/// Searches the gains of all rivals on bases.
///
/// # Errors
/// A file that cannot be driven, a base out of range.
pub fn tune(
    bases: &[Named],
    files: &[TrackFile<'_>],
    done: impl Fn() + Sync,
) -> Result<Tuned, BenchError> {
    let mut jobs = Vec::new();
    for (at, base) in bases.iter().enumerate() {
        for track in [Track::Parking, Track::Files] {
            let missions = missions((at, base), track, files)?;
            for kind in LawKind::RIVALS {
                jobs.push((kind, base.0.clone(), track, missions.clone()));
            }
        }
    }
    let found = jobs.into_par_iter().map(|(kind, base, track, missions)| {
        let gains = search(kind, &missions, &done)?;
        Ok((kind, base, track, gains))
    });
    Ok(Tuned::of_search(found.collect::<Result<_, BenchError>>()?))
}

/// What a set of gains is tried on.
fn missions(
    base: (usize, &Named),
    track: Track,
    files: &[TrackFile<'_>],
) -> Result<Vec<Mission>, BenchError> {
    let of = |track| {
        let class = Class {
            track,
            plant: Plant::Ideal,
        };
        tracks::cases(class, base, files, STARTS, SEED)
    };
    let mut cases = of(track)?;
    if track == Track::Files {
        cases.extend(of(Track::Paper)?);
    }
    let missions = cases.into_iter().map(|case| Mission {
        end: End::Parked(end_s(&case.mission).unwrap_or(0.0) + LATE_S),
        ..case.mission
    });
    Ok(missions.collect())
}

fn search(
    kind: LawKind,
    missions: &[Mission],
    done: &(impl Fn() + Sync),
) -> Result<Vec<f32>, BenchError> {
    let usual: Vec<f64> = kind
        .gains()
        .iter()
        .map(|gain| libm::log(f64::from(gain.usual).max(LEAST)))
        .collect();
    let (evaluations, starts) = budget(kind);
    let mut looked = vec![usual.clone()];
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    while looked.len() < simplex::look(evaluations) {
        let near = |log: &f64| -> f64 {
            let normal: f64 = StandardNormal.sample(&mut random);
            log + simplex::SPREAD * normal
        };
        let drawn = usual.iter().map(near).collect();
        looked.push(drawn);
    }
    let cost = |logs: &[f64]| {
        let gains = gains(logs);
        let scores = missions
            .iter()
            .map(|mission| Ok(score(mission, &drive(mission, kind, &gains)?)));
        let scores = scores.collect::<Result<Vec<_>, BenchError>>()?;
        Ok::<f64, BenchError>(Score::mean(&scores, 0.0).total())
    };
    let published = cost_of(kind, missions)?;
    let found = simplex::minimise(looked, (evaluations, starts), cost, done)?;
    let best = found
        .into_iter()
        .reduce(|a, b| if b.0 < a.0 { b } else { a });
    Ok(match best {
        // Zeros that the search cannot have may still be best.
        Some((value, logs)) if value < published => gains(&logs),
        _ => kind.usual(),
    })
}

fn cost_of(kind: LawKind, missions: &[Mission]) -> Result<f64, BenchError> {
    let gains = kind.usual();
    let scores = missions
        .iter()
        .map(|mission| Ok(score(mission, &drive(mission, kind, &gains)?)));
    let scores = scores.collect::<Result<Vec<_>, BenchError>>()?;
    Ok(Score::mean(&scores, 0.0).total())
}

/// Three digits: more mean nothing.
fn gains(logs: &[f64]) -> Vec<f32> {
    let round = |log: &f64| {
        let value = libm::exp(*log);
        format!("{value:.2e}").parse().unwrap_or(value as f32)
    };
    logs.iter().map(round).collect()
}

/// When the reference ends, if there is one.
fn end_s(mission: &Mission) -> Option<f64> {
    match &mission.course {
        Course::Follow {
            hand_over: Some(HandOverRule { end_s, .. }),
            ..
        } => Some(*end_s),
        _ => None,
    }
}

/// The score of `tune`.
fn score(mission: &Mission, figures: &Figures) -> Score {
    let end_s = end_s(mission);
    let late = end_s.unwrap_or(0.0) + LATE_S;
    let parked = figures.parked_s.is_some() && !figures.failed;
    let as_trial = trials::Figures {
        parked,
        time_s: figures.parked_s.unwrap_or(late),
        error_m: figures.error_m,
        error_rad: figures.error_rad,
        tracking_m: figures.rms_m,
        ripple: None,
        effort: 0.0,
        peak: None,
        stopped: None,
        found: Vec::new(),
    };
    Score::of(&as_trial, end_s)
}
