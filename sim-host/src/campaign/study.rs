//! All runs, side by side.

use super::outcome::{RunOutcome, Violation};
use super::plan::{Bases, Plan};
use super::run::{Mutation, run};
use crate::closed_loop::ClosedLoopError;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

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
