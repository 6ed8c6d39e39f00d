//! What rows of a log show to be broken before anything is fitted: rows that are missing, wheel angles that jump, currents of the
//! wrong sign.

use super::log::Log;
use super::{IdentifyError, SIDES};

/// A row that lasts this many times as long as those about it, and about a whole number of times, stands for several,
const LONGER: f64 = 1.7;
const WHOLE: f64 = 0.15;
/// and one that lasts so many times as long is a pause, whatever the command after it.
const PAUSE: f64 = 10.0;
/// Rows to each side that are compared with.
const ABOUT: usize = 5;
/// A command that changes by this share of the largest may have changed at any time since the row before.
const SAME: f64 = 0.005;
/// Rows that are lost once in this time leave nothing whole \[s\],
const OFTEN_S: f64 = 1.0;
/// if this share of the long ones are lost ones, and not late.
const LOST: f64 = 0.8;

/// How long each row lasts, over those about it.
pub(super) fn lengths(log: &Log) -> Vec<f64> {
    let lasts: Vec<f64> = log.t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let over_usual = |row: usize| {
        let end = (row + ABOUT + 1).min(lasts.len());
        let mut about = lasts[row.saturating_sub(ABOUT)..end].to_vec();
        about.sort_by(f64::total_cmp);
        lasts[row] / about[about.len() / 2]
    };
    (0..lasts.len()).map(over_usual).collect()
}

fn several(length: f64) -> bool {
    length > LONGER && (length - length.round()).abs() < WHOLE
}

/// Rows whose command may not have acted until the next row, for rows between them are not in the log.
pub(super) fn missing(log: &Log, lengths: &[f64]) -> Vec<bool> {
    let largest = [0, 1].map(|i| log.command.iter().fold(0.0, |most, c| c[i].abs().max(most)));
    let gap = |(row, &length): (usize, &f64)| {
        let (now, next) = (log.command[row], log.command[row + 1]);
        let changed = (0..2).any(|i| (next[i] - now[i]).abs() > SAME * largest[i]);
        length > PAUSE || (changed && several(length))
    };
    let gaps = lengths.iter().enumerate().map(gap);
    gaps.chain([false]).collect()
}

/// Why the motion says nothing, if rows are lost so often that commands which are not in the log acted everywhere.
pub(super) fn lost(log: &Log, lengths: &[f64]) -> Option<&'static str> {
    let lost = lengths.iter().filter(|length| several(**length)).count() as f64;
    let long = lengths.iter().filter(|length| **length > LONGER).count() as f64;
    let time_s = log.t[log.t.len() - 1] - log.t[0];
    (lost * OFTEN_S > time_s && lost > LOST * long)
        .then_some("rows are missing so often that nobody knows which commands acted")
}

/// What to say of them.
pub(super) fn warning(log: &Log, missing: &[bool]) -> Option<String> {
    let first = missing.iter().position(|missing| *missing)?;
    let gaps = missing.iter().filter(|missing| **missing).count();
    Some(format!(
        "rows are missing (gaps: {gaps}, the first after t = {} s), or their times are wrong: what was driven meanwhile is left out",
        log.t[first]
    ))
}

/// A jump of a wheel's angle is at least this far within one row \[rad\],
const JUMP_RAD: f64 = 0.3;
/// many times as fast as the two rows before and after,
const FASTER: f64 = 3.0;
/// and faster than the wheel is in all but a twentieth of the rows, by this factor.
const BEYOND: f64 = 1.5;

/// Commands, negative or positive ones, have to last for so many rows to say something about a current's sign or a dead encoder,
const ROWS: usize = 100;
/// and of currents this share of the energy that goes in and out in them has to come out.
const OUT: f64 = 0.5;

/// Refuses logs in which a counter stands still or jumps, or in which a current flows against its command.
///
/// # Errors
/// Which wheel, and when or with which commands.
pub(super) fn check(log: &Log) -> Result<(), IdentifyError> {
    for (i, side) in SIDES.into_iter().enumerate() {
        let driven = log.command.iter().filter(|command| command[i] != 0.0);
        let moved = |i: usize, by: f64| {
            let from = log.angle[0][i];
            log.angle.iter().any(|angle| (angle[i] - from).abs() > by)
        };
        if !moved(i, 0.0) && moved(1 - i, JUMP_RAD) && driven.count() >= ROWS {
            return Err(IdentifyError::Still(side));
        }
        if let Some((t_s, step_rad)) = jump(log, i) {
            return Err(IdentifyError::Jump {
                side,
                t_s,
                step_rad,
            });
        }
        let signs = [(1.0, "positive"), (-1.0, "negative")];
        if let Some((_, commands)) = signs.into_iter().find(|(sign, _)| against(log, i, *sign)) {
            return Err(IdentifyError::Current { side, commands });
        }
    }
    Ok(())
}

/// The first time at which a wheel's angle jumps, and how far.
fn jump(log: &Log, i: usize) -> Option<(f64, f64)> {
    let pairs = log.t.windows(2).zip(log.angle.windows(2));
    let speeds: Vec<f64> = pairs
        .map(|(t, angle)| ((angle[1][i] - angle[0][i]) / (t[1] - t[0])).abs())
        .collect();
    let mut sorted = speeds.clone();
    sorted.sort_by(f64::total_cmp);
    let fast = sorted[19 * sorted.len() / 20];
    let row = (2..speeds.len().saturating_sub(2)).find(|&row| {
        let about = [row - 2, row - 1, row + 1, row + 2].map(|other| speeds[other]);
        let about = about.into_iter().fold(0.0, f64::max);
        let step = (log.angle[row + 1][i] - log.angle[row][i]).abs();
        step > JUMP_RAD && speeds[row] > FASTER * about && speeds[row] > BEYOND * fast
    })?;
    Some((log.t[row + 1], log.angle[row + 1][i] - log.angle[row][i]))
}

/// Whether the current of a motor flows against its commands of this sign. Over a drive more energy goes into a motor than comes
/// back; a wheel that turns against its commands, too, is another matter.
fn against(log: &Log, i: usize, sign: f64) -> bool {
    let Some(current) = &log.current else {
        return false;
    };
    let (mut rows, mut sum, mut all, mut way) = (0, 0.0, 0.0, 0.0);
    for row in 0..log.t.len() - 1 {
        let command = log.command[row][i];
        if sign * command > 0.0 {
            // What a row measures is under the command of the row before.
            let energy = command * current[row + 1][i] * (log.t[row + 1] - log.t[row]);
            (rows, sum, all) = (rows + 1, sum + energy, all + energy.abs());
            way += command * (log.angle[row + 1][i] - log.angle[row][i]);
        }
    }
    rows >= ROWS && sum < -OUT * all && way > 0.0
}
