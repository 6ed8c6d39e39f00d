//! Stretches of a log in which both wheels turn clearly and do not reverse.
//!
//! There Coulomb friction is a constant, and stiction, backlash and the shape of friction near zero
//! speed play no part.

use super::log::Log;

/// Longest stretch \[s\]. Motors settle in tenths of a second, so that longer ones add nothing, but
/// let disturbances that the model does not have add up.
pub const LONGEST_S: f64 = 4.0;
/// Shortest stretch \[s\]: its start state takes what little it holds.
pub const SHORTEST_S: f64 = 0.3;
/// Half of the time over which a speed is taken from the angles \[s\].
pub(super) const HALF_S: f64 = 0.05;
/// Fewest samples for the start state of four and something beside it.
pub(super) const FEWEST: usize = 12;

/// Rows first to last, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub(super) first: usize,
    pub(super) last: usize,
    /// Directions of the wheels.
    pub(super) sign: [f64; 2],
}

/// Wheel speeds \[rad/s\] from the angles up to so long before and after \[s\], or of the next rows.
pub(super) fn speeds(log: &Log, half_s: f64) -> Vec<[f64; 2]> {
    let last = log.t.len() - 1;
    (0..=last)
        .map(|row| {
            let t = log.t[row];
            let from = log.t.partition_point(|&other| other < t - half_s).min(row);
            let to = log.t.partition_point(|&other| other <= t + half_s) - 1;
            let (from, to) = if to > from {
                (from, to)
            } else {
                (row.saturating_sub(1), (row + 1).min(last))
            };
            let time = log.t[to] - log.t[from];
            [0, 1].map(|i| (log.angle[to][i] - log.angle[from][i]) / time)
        })
        .collect()
}

/// All stretches with both wheels faster than `slow` \[rad/s\] without rows that are `limited`, and that go over none after which
/// others are `missing`. None begins at the first row, or at one after missing ones: the current there belongs to a command that is
/// not in the log.
pub(super) fn stretches(
    log: &Log,
    speeds: &[[f64; 2]],
    slow: f64,
    limited: &[bool],
    missing: &[bool],
) -> Vec<Stretch> {
    let turns = |row: usize| {
        let speed = speeds[row];
        (speed[0].abs() > slow && speed[1].abs() > slow).then(|| speed.map(f64::signum))
    };
    // A speed is a mean over [`HALF_S`] about: a wheel may have stopped or reversed that long before it shows.
    let direction = |row: usize| {
        // Nor just after such rows: what a driver does while its limit lets go is its own.
        let just = |other: &usize| log.t[row] - log.t[*other] <= HALF_S;
        let at_limit = |other: usize| limited.get(other) == Some(&true);
        if (0..=row).rev().take_while(just).any(at_limit) {
            return None;
        }
        let near = |other: &usize| (log.t[*other] - log.t[row]).abs() <= HALF_S;
        let here = turns(row)?;
        let mut about = (0..row).rev().take_while(near);
        let mut after = (row + 1..speeds.len()).take_while(near);
        let same = |other: usize| turns(other) == Some(here);
        (about.all(same) && after.all(same)).then_some(here)
    };
    let begins = |row: usize| direction(row).filter(|_| !missing[row - 1]);
    let mut found = Vec::new();
    let mut row = 1;
    while row < speeds.len() {
        let Some(sign) = begins(row) else {
            row += 1;
            continue;
        };
        let first = row;
        while row < speeds.len()
            && begins(row) == Some(sign)
            && log.t[row] - log.t[first] <= LONGEST_S
        {
            row += 1;
        }
        let last = row - 1;
        if last - first + 1 >= FEWEST && log.t[last] - log.t[first] >= SHORTEST_S {
            found.push(Stretch { first, last, sign });
        }
    }
    found
}
