//! Outcomes put together: a cell for each trouble and state.

use super::fault_injection::FaultInjectionKind;
use super::outcome::{End, Failing, RunOutcome, Stop, Why};
use super::plan::Target;
use serde::Serialize;
use std::collections::BTreeMap;

/// What came of a trouble in a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Trouble.
    pub injection: FaultInjectionKind,
    /// State.
    pub target: Target,
    /// Runs.
    pub runs: usize,
    /// That parked in spite of it.
    pub parked: usize,
    /// That stayed as they were.
    pub held: usize,
    /// That were stopped, by what.
    pub stopped: BTreeMap<Why, usize>,
    /// That failed as it is stated.
    pub known: BTreeMap<Failing, usize>,
    /// With something against the rules.
    pub violations: usize,
    /// That were mended, reset and parked.
    pub again: usize,
    /// In which the trouble was found.
    pub found: usize,
    /// After what time at the latest \[s\].
    pub found_s: f64,
    /// Longest way until then \[m\].
    pub blind_m: f64,
    /// The stop nearest to its bound.
    pub stop: Stop,
    /// Longest stop \[m\].
    pub way_m: f64,
    /// Farthest from its goal that a parked base truly was \[m\], and the largest heading error \[rad\].
    pub parked_off: (f64, f64),
}

impl Cell {
    fn new(injection: FaultInjectionKind, target: Target) -> Self {
        Self {
            injection,
            target,
            runs: 0,
            parked: 0,
            held: 0,
            stopped: BTreeMap::new(),
            known: BTreeMap::new(),
            violations: 0,
            again: 0,
            found: 0,
            found_s: 0.0,
            blind_m: 0.0,
            stop: Stop::default(),
            way_m: 0.0,
            parked_off: (0.0, 0.0),
        }
    }

    fn take(&mut self, outcome: &RunOutcome) {
        self.runs += 1;
        self.again += usize::from(outcome.again);
        match &outcome.end {
            Ok(End::Parked) => self.parked += 1,
            Ok(End::Held) => self.held += 1,
            Ok(End::Stopped(why)) => *self.stopped.entry(*why).or_default() += 1,
            Ok(End::Known(failing)) => *self.known.entry(*failing).or_default() += 1,
            Err(_) => self.violations += 1,
        }
        if let Some(found) = &outcome.found {
            self.found += 1;
            self.found_s = self.found_s.max(found.after_s);
            self.blind_m = self.blind_m.max(found.way_m);
        }
        if let Some((m, rad)) = outcome.parked {
            self.parked_off = (self.parked_off.0.max(m), self.parked_off.1.max(rad));
        }
        self.stop = self.stop.worse(outcome.stop);
        self.way_m = self.way_m.max(outcome.stop.way_m);
    }

    /// How often it was stopped by what, the most frequent first; in brackets what failed as it is stated.
    pub fn reasons(&self) -> String {
        let mut reasons: Vec<_> = self.stopped.iter().collect();
        reasons.sort_by_key(|(why, count)| (usize::MAX - **count, **why));
        let texts: Vec<_> = reasons
            .into_iter()
            .map(|(why, count)| format!("{} {count}", why.name()))
            .chain(
                self.known
                    .iter()
                    .map(|(failing, count)| format!("({} {count})", failing.name())),
            )
            .collect();
        texts.join(", ")
    }
}

/// A cell for each trouble and state that occurred, in their order; `base` leaves out all others.
pub fn cells(outcomes: &[RunOutcome], base: Option<usize>) -> Vec<Cell> {
    let mut cells = BTreeMap::new();
    for outcome in outcomes {
        if base.is_some_and(|base| base != outcome.base) {
            continue;
        }
        let (injection, target) = (outcome.injection, outcome.target);
        cells
            .entry((injection, target))
            .or_insert_with(|| Cell::new(injection, target))
            .take(outcome);
    }
    cells.into_values().collect()
}

/// A cell as it stands in a file.
#[derive(Debug, Serialize)]
pub struct CellRecord {
    trouble: &'static str,
    state: &'static str,
    runs: usize,
    parked: usize,
    held: usize,
    stopped: BTreeMap<&'static str, usize>,
    known: BTreeMap<&'static str, usize>,
    violations: usize,
    again_parked: usize,
    found: usize,
    found_worst_s: f64,
    way_until_found_worst_m: f64,
    stop_worst_share: f64,
    stop_worst_m: f64,
    parked_off_worst_m: f64,
    parked_off_worst_rad: f64,
}

impl From<&Cell> for CellRecord {
    fn from(cell: &Cell) -> Self {
        let stopped = cell.stopped.iter();
        Self {
            trouble: cell.injection.name(),
            state: cell.target.name(),
            runs: cell.runs,
            parked: cell.parked,
            held: cell.held,
            stopped: stopped.map(|(why, count)| (why.name(), *count)).collect(),
            known: cell
                .known
                .iter()
                .map(|(failing, count)| (failing.name(), *count))
                .collect(),
            violations: cell.violations,
            again_parked: cell.again,
            found: cell.found,
            found_worst_s: cell.found_s,
            way_until_found_worst_m: cell.blind_m,
            stop_worst_share: cell.stop.share(),
            stop_worst_m: cell.way_m,
            parked_off_worst_m: cell.parked_off.0,
            parked_off_worst_rad: cell.parked_off.1,
        }
    }
}
