//! Mutation of inputs, and which of them to go on with.

use std::any::Any;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::random::Random;

/// What a run met.
#[derive(Clone, Debug, Default)]
pub struct Met(Vec<u64>);

impl Met {
    /// Something, by what tells it from others.
    pub fn saw(&mut self, what: impl Hash) {
        let mut hasher = DefaultHasher::new();
        what.hash(&mut hasher);
        self.0.push(hasher.finish());
    }
}

/// What is tried.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name, and that of its folder of inputs.
    pub name: &'static str,
    /// Panics if what has to hold does not.
    pub run: fn(&[u8], &mut Met),
    /// Real inputs.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Longest input.
    pub longest: usize,
    /// What real inputs are made of.
    pub words: &'static [&'static str],
    /// Inputs in a test.
    pub in_a_test: u64,
}

/// What came of it.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Inputs tried.
    pub tried: u64,
    /// Different things met.
    pub met: usize,
    /// Inputs that met something new, the real ones first.
    pub kept: Vec<Vec<u8>>,
    /// The input that failed, and what it said.
    pub failed: Option<(Vec<u8>, String)>,
}

/// The inputs of a folder, in order of their names; none if there is no such folder.
///
/// # Errors
/// A file that cannot be read.
pub fn inputs(folder: &Path) -> io::Result<Vec<Vec<u8>>> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .map(|entries| {
            entries
                .filter_map(|entry| Some(entry.ok()?.path()))
                .collect()
        })
        .unwrap_or_default();
    files.sort();
    files.iter().map(fs::read).collect()
}

/// Inputs that are kept.
const MOST_KEPT: usize = 5_000;

/// Numbers at which something may change, as text.
const NUMBERS: [&str; 16] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "1e-320",
    "1e308",
    "-1e308",
    "1e39",
    "nan",
    "inf",
    "-inf",
    "3.141592653589793",
    "1e-9",
    "65536",
    "9223372036854775808",
    "0x10",
];

fn mutate(target: &Target, kept: &[Vec<u8>], dice: &mut Random) -> Vec<u8> {
    let mut input = kept[dice.below(kept.len())].clone();
    for _ in 0..=dice.below(4) {
        let at = dice.below(input.len() + 1);
        match dice.below(9) {
            0 => {
                if let Some(byte) = input.get_mut(at) {
                    *byte ^= 1 << dice.below(8);
                }
            }
            1 => {
                if let Some(byte) = input.get_mut(at) {
                    *byte = dice.bits() as u8;
                }
            }
            2 => input.insert(at, dice.bits() as u8),
            3 => {
                let end = (at + 1 + dice.below(16)).min(input.len());
                input.drain(at.min(end)..end);
            }
            4 => {
                let end = (at + 1 + dice.below(64)).min(input.len());
                let piece = input[at.min(end)..end].to_vec();
                let to = dice.below(input.len() + 1);
                input.splice(to..to, piece);
            }
            5 => {
                // The begin of this and the end of another.
                let other = &kept[dice.below(kept.len())];
                let from = dice.below(other.len() + 1);
                input.truncate(at);
                input.extend(&other[from..]);
            }
            6 if !target.words.is_empty() => {
                let word = target.words[dice.below(target.words.len())];
                input.splice(at..at, word.bytes());
            }
            7 => {
                // Another number in the place of one.
                let digit = |byte: &u8| byte.is_ascii_digit();
                if let Some(begin) = input.iter().skip(at).position(digit).map(|i| i + at) {
                    let end = input[begin..]
                        .iter()
                        .position(|byte| !(digit(byte) || b".eE-+".contains(byte)))
                        .map_or(input.len(), |i| i + begin);
                    let number = NUMBERS[dice.below(NUMBERS.len())];
                    input.splice(begin..end, number.bytes());
                }
            }
            _ => {
                let number = dice.bits().to_le_bytes();
                let end = (at + 4).min(input.len());
                input.splice(at..end, number[..4].iter().copied());
            }
        }
    }
    input.truncate(target.longest);
    input
}

fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    let text = text.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string));
    text.unwrap_or_default()
}

/// Tries inputs, `more` real ones among the first, as long as `goes_on` says so of how many there were; ends with one that fails.
pub fn fuzz(
    target: &Target,
    seed: u64,
    more: Vec<Vec<u8>>,
    mut goes_on: impl FnMut(u64) -> bool,
) -> Outcome {
    let mut dice = Random(seed);
    let mut outcome = Outcome::default();
    let mut known = HashSet::new();
    let mut first = (target.seeds)();
    first.extend(more);
    first.push(Vec::new());
    let mut waiting = first.into_iter();
    while goes_on(outcome.tried) {
        let (input, real) = match waiting.next() {
            Some(input) => (input, true),
            None => (mutate(target, &outcome.kept, &mut dice), false),
        };
        let mut met = Met::default();
        let run = catch_unwind(AssertUnwindSafe(|| (target.run)(&input, &mut met)));
        outcome.tried += 1;
        if let Err(panic) = run {
            outcome.failed = Some((input, said(panic.as_ref())));
            break;
        }
        let news = met.0.into_iter().filter(|what| known.insert(*what)).count();
        if real || (news > 0 && outcome.kept.len() < MOST_KEPT) {
            outcome.kept.push(input);
        }
    }
    outcome.met = known.len();
    outcome
}
