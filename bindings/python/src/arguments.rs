//! Numbers as arguments, each within its limits. What is no number at all stays Python's `TypeError`, with a note of the name.

use crate::error;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::fmt::Display;
use std::num::NonZeroU32;

/// More than any machine has cores; each is a thread at once.
const MAX_THREADS: usize = 1024;
/// Members of a fleet have some 8 KB each.
const MAX_SIZE: usize = 65_536;
/// A step cannot be stopped: this is a quarter of an hour of a base at 100 Hz.
const MAX_TICKS: usize = 100_000;

type Given<'a, 'py> = &'a Bound<'py, PyAny>;

fn whole<'py, T>(key: &str, given: Given<'_, 'py>, least: T, most: T) -> PyResult<T>
where
    T: for<'a> FromPyObject<'a, 'py, Error = PyErr> + PartialOrd + Display,
{
    match given.extract::<T>() {
        Ok(number) if (&least..=&most).contains(&&number) => Ok(number),
        Err(error) if error.is_instance_of::<PyTypeError>(given.py()) => Err(error),
        _ => {
            let message = format!("{key} must be a whole number in {least} to {most}");
            Err(error::argument(key, &message))
        }
    }
}

pub fn seed(given: Given<'_, '_>) -> PyResult<u64> {
    whole("seed", given, 0, u64::MAX)
}

pub fn threads(given: Given<'_, '_>) -> PyResult<Option<usize>> {
    if given.is_none() {
        return Ok(None);
    }
    whole("threads", given, 1, MAX_THREADS).map(Some)
}

pub fn seeds(given: Given<'_, '_>) -> PyResult<NonZeroU32> {
    whole("seeds", given, NonZeroU32::MIN, sim_host::part::MAX_SEEDS)
}

pub fn evaluations(given: Given<'_, '_>) -> PyResult<u64> {
    whole("evaluations", given, 1, sim_host::tune::MAX_EVALUATIONS)
}

pub fn runs(given: Given<'_, '_>) -> PyResult<u64> {
    whole("runs", given, 1, sim_host::campaign::MAX_RUNS)
}

pub fn first(given: Given<'_, '_>) -> PyResult<u64> {
    whole("first", given, 0, sim_host::campaign::MAX_FIRST)
}

pub fn every(given: Given<'_, '_>) -> PyResult<usize> {
    whole("every", given, 1, u32::MAX as usize)
}

pub fn size(given: Given<'_, '_>) -> PyResult<usize> {
    whole("size", given, 1, MAX_SIZE)
}

pub fn ticks(given: Given<'_, '_>) -> PyResult<usize> {
    whole("ticks", given, 1, MAX_TICKS)
}

/// A part of a whole: (index, count).
pub fn shard(given: Given<'_, '_>) -> PyResult<Option<(usize, usize)>> {
    if given.is_none() {
        return Ok(None);
    }
    match given.extract::<(usize, usize)>() {
        Ok((index, count)) if index < count => Ok(Some((index, count))),
        _ => {
            let message =
                "shard must be (index, count), whole numbers, the index from 0 to below the count";
            Err(error::argument("shard", message))
        }
    }
}

/// A number above 0, or from 0 on.
pub fn positive(key: &str, number: f64, or_zero: bool) -> PyResult<()> {
    if number.is_finite() && (number > 0.0 || or_zero && number == 0.0) {
        return Ok(());
    }
    let limit = if or_zero { "not negative" } else { "above 0" };
    let message = format!("{key} must be a finite number, {limit}");
    Err(error::argument(key, &message))
}
