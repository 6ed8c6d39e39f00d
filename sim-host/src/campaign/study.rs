//! All runs, side by side.

use super::fault_injection::FaultInjectionKind;
use super::outcome::{RunOutcome, Violation};
use super::plan::{Bases, Plan};
use super::run::{Mutation, run};
use crate::closed_loop::ClosedLoopError;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// No kind of trouble has one of the words in its name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no trouble has such a word in its name; there are: {}", .0.join(", "))]
pub struct NoTrouble(pub Vec<&'static str>);

/// Numbers of `count` runs from `first` on, of troubles whose name has one of the words `only`; of all if there is none.
///
/// # Errors
/// Words that no trouble has.
pub fn numbers(
    bases: &Bases,
    first: u64,
    count: u64,
    only: &[String],
) -> Result<Vec<u64>, NoTrouble> {
    let chosen = |kind: FaultInjectionKind| {
        only.is_empty() || only.iter().any(|text| kind.name().contains(text.as_str()))
    };
    if !bases.kinds().iter().copied().any(chosen) {
        return Err(NoTrouble(
            bases.kinds().iter().map(|kind| kind.name()).collect(),
        ));
    }
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let all = (first..).filter(|number| chosen(bases.trouble(*number)));
    Ok(all.take(count).collect())
}

/// Part `index` of `count` of a campaign, counted from 0: one behind the other they are the whole. Sizes differ by one at
/// most; what is not there is empty.
pub fn shard(numbers: &[u64], index: usize, count: usize) -> &[u64] {
    let bound = |part: usize| match count {
        0 => 0,
        // Without overflow for any number of parts.
        _ => (numbers.len() as u128 * part as u128 / count as u128) as usize,
    };
    let (from, to) = (bound(index), bound(index.saturating_add(1)));
    numbers.get(from..to).unwrap_or_default()
}

/// Runs of the campaign of `seed`, in order. `done` is called after each.
///
/// A run is settled by seed and number alone: nothing depends on the number of threads, which is rayon's. A
/// panic is a violation of its run.
///
/// # Errors
/// See [`fn@run`].
pub fn study(
    bases: &Bases,
    seed: u64,
    runs: impl IntoParallelIterator<Item = u64>,
    mutation: &Mutation,
    done: impl Fn() + Sync,
) -> Result<Vec<RunOutcome>, ClosedLoopError> {
    let one = |number| {
        let plan = Plan::draw(bases, seed, number);
        let outcome = catch_unwind(AssertUnwindSafe(|| run(bases, &plan, mutation, |_| {})));
        done();
        outcome.unwrap_or_else(|panic| {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied());
            Ok(RunOutcome {
                end: Err(Violation {
                    at_s: 0.0,
                    what: format!("panic: {}", text.unwrap_or("without a text")),
                }),
                ..RunOutcome::begin(&plan)
            })
        })
    };
    runs.into_par_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::shard;

    /// Any number of parts, one behind the other, is the whole; none is longer than another by more than one.
    #[test]
    fn parts_make_the_whole() {
        for length in [0, 1, 7, 60] {
            let numbers: Vec<u64> = (100..100 + length).collect();
            for count in 1..70 {
                let parts: Vec<_> = (0..count).map(|i| shard(&numbers, i, count)).collect();
                assert_eq!(parts.concat(), numbers, "{count} parts of {length}");
                let sizes = parts.iter().map(|part| part.len());
                let (least, most) = (sizes.clone().min(), sizes.max());
                assert!(most <= least.map(|least| least + 1), "{count} of {length}");
            }
        }
        assert!(shard(&[1, 2], 2, 2).is_empty() && shard(&[1, 2], 0, 0).is_empty());
        assert!(shard(&[1, 2], usize::MAX, usize::MAX).is_empty());
    }
}
