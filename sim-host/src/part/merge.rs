//! Files put together.

use super::error::{FileProblem, MergeError};
use super::file::{self, Header, Part, Program, VERSION};
use super::{Shard, Study};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Files of one study.
#[derive(Debug)]
pub struct Parts {
    parts: Vec<(PathBuf, Part)>,
    broken: Vec<(PathBuf, FileProblem)>,
}

impl Parts {
    /// Reads files, in any order.
    ///
    /// # Errors
    /// None of them can be read.
    pub fn read(paths: &[PathBuf]) -> Result<Self, MergeError> {
        let (mut parts, mut broken) = (Vec::new(), Vec::new());
        for path in paths {
            match file::read(path) {
                Ok(part) => parts.push((path.clone(), part)),
                Err(problem) => broken.push((path.clone(), problem)),
            }
        }
        if parts.is_empty() {
            return Err(MergeError::NoPart(broken));
        }
        Ok(Self { parts, broken })
    }

    /// What made the first of them.
    pub fn command(&self) -> &str {
        let first = self.parts.first();
        first.map_or("", |(_, part)| part.header.command.as_str())
    }

    /// The study, and all of its runs in their order.
    ///
    /// # Errors
    /// Parts of several studies or of another program, or that are missing, there twice and different, or damaged.
    pub fn merge<S: Study>(self) -> Result<(S, Vec<S::Run>), MergeError> {
        let Some((first_path, first)) = self.parts.first() else {
            return Err(MergeError::NoPart(self.broken));
        };
        for (path, part) in &self.parts {
            if let Some((what, theirs, ours)) = difference(part, first) {
                return Err(MergeError::Stranger {
                    path: path.clone(),
                    first: first_path.clone(),
                    what,
                    theirs,
                    ours,
                });
            }
        }
        let first = first.header.clone();
        let other = |what, theirs, ours| MergeError::OtherProgram {
            path: first_path.clone(),
            what,
            theirs,
            ours,
        };
        // Before anything that another version may write otherwise.
        if first.program.version != VERSION {
            let theirs = first.program.version;
            return Err(other("the version", theirs, VERSION.to_owned()));
        }
        let wrong = |error: &dyn std::fmt::Display| MergeError::Study(error.to_string());
        let mut study: S = serde_json::from_value(first.settings.clone()).map_err(|e| wrong(&e))?;
        study.made_by(&first.arguments);
        let checks = [first.program.built_in, Program::of(&study).built_in];
        if checks[0] != checks[1] {
            let [theirs, ours] = checks.map(file::hexadecimal);
            return Err(other(BUILT_IN, theirs, ours));
        }
        let (runs, count) = (first.runs, first.shard.count());
        let mut by_number: BTreeMap<usize, (PathBuf, Part)> = BTreeMap::new();
        for (path, part) in self.parts {
            let shard = part.header.shard;
            match by_number.get(&shard.number()) {
                Some((other, there)) if there.records != part.records => {
                    return Err(MergeError::Twice {
                        shard,
                        paths: [other.clone(), path],
                    });
                }
                Some(_) => {}
                None => {
                    by_number.insert(shard.number(), (path, part));
                }
            }
        }
        let all = (1..=count).filter_map(|number| Shard::new(number, count).ok());
        let missing = all.filter(|shard| !by_number.contains_key(&shard.number()));
        let missing: Vec<_> = missing
            .map(|shard| (shard, command_line(&first, shard)))
            .collect();
        if !missing.is_empty() {
            return Err(MergeError::Missing {
                missing,
                broken: self.broken,
            });
        }
        let mut whole = Vec::with_capacity(runs);
        for (path, part) in by_number.into_values() {
            let decoded = decode(&study, runs, &part);
            whole.extend(decoded.map_err(|problem| MergeError::Broken { path, problem })?);
        }
        match study.count() {
            Ok(count) if count == whole.len() => Ok((study, whole)),
            Ok(count) => Err(wrong(&format!("it has {count} runs, not {}", whole.len()))),
            Err(error) => Err(wrong(&error)),
        }
    }
}

/// What programs of one version may differ in.
const BUILT_IN: &str = "the checksum of its built-in files";

/// The runs of a part, if they are those that were written.
fn decode<S: Study>(study: &S, runs: usize, part: &Part) -> Result<Vec<S::Run>, FileProblem> {
    let places = part.header.shard.places(runs);
    let as_written = part.records.len() == places.len()
        && file::records_check(&part.records) == part.header.records;
    if !as_written {
        return Err(FileProblem::Damaged);
    }
    let records = part.records.iter();
    let decoded = records.map(|record| postcard::from_bytes(record.data()));
    let decoded: Vec<S::Run> = decoded
        .collect::<Result<_, _>>()
        .map_err(|_| FileProblem::Damaged)?;
    // A program of the same version whose runs have other parts reads others.
    let sheet = study
        .sheet(places.start, &decoded)
        .map_err(|_| FileProblem::Damaged)?;
    match file::columns_check(&sheet) == part.header.columns {
        true => Ok(decoded),
        false => Err(FileProblem::Damaged),
    }
}

/// The first thing in which two parts are not of one study: its name, and both values.
fn difference(part: &Part, first: &Part) -> Option<(String, String, String)> {
    let (a, b) = (&part.header, &first.header);
    let named = |what: &str, a: String, b: String| (a != b).then(|| (what.to_owned(), a, b));
    let checks = [a, b].map(|header| file::hexadecimal(header.program.built_in));
    let [built_in, of_first] = checks;
    named("the command", a.command.clone(), b.command.clone())
        // Another version may have other settings.
        .or_else(|| {
            named(
                "the version",
                a.program.version.clone(),
                b.program.version.clone(),
            )
        })
        .or_else(|| setting(&a.settings, &b.settings))
        .or_else(|| named(BUILT_IN, built_in, of_first))
        .or_else(|| {
            let parts = |count: usize| count.to_string();
            named(
                "the number of parts",
                parts(a.shard.count()),
                parts(b.shard.count()),
            )
        })
        .or_else(|| named("the number of runs", a.runs.to_string(), b.runs.to_string()))
}

fn setting(a: &Value, b: &Value) -> Option<(String, String, String)> {
    if a == b {
        return None;
    }
    let (a, b) = (a.as_object()?, b.as_object()?);
    let keys = a.keys().chain(b.keys());
    let mut differing = keys.filter(|key| a.get(*key) != b.get(*key));
    let key = differing.next()?;
    let inside = a.get(key).zip(b.get(key)).and_then(|(a, b)| setting(a, b));
    let value = |side: Option<&Value>| side.map_or_else(|| "nothing".to_owned(), brief);
    Some(match inside {
        Some((inner, a, b)) => (format!("{key}.{inner}"), a, b),
        None => (key.clone(), value(a.get(key)), value(b.get(key))),
    })
}

/// Texts of files are not for a line.
fn brief(value: &Value) -> String {
    match value.as_str() {
        Some(text) if text.lines().count() > 1 => {
            let check = file::hexadecimal(file::text_check(text));
            format!("a text with the checksum {check}")
        }
        _ => value.to_string(),
    }
}

/// What to type for a part of a study.
fn command_line(header: &Header, shard: Shard) -> String {
    let mut words = vec!["sim-host".to_owned(), header.command.clone()];
    words.extend(header.arguments.iter().map(|word| quoted(word)));
    words.push(format!("--shard {shard}"));
    words.join(" ")
}

/// A word as it is typed in a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn a_shell_reads_the_same_words() {
        for (word, text) in [
            ("--seeds", "--seeds"),
            ("my robot.toml", "'my robot.toml'"),
            ("it's", r"'it'\''s'"),
            ("", "''"),
            ("$HOME", "'$HOME'"),
        ] {
            assert_eq!(quoted(word), text);
        }
    }
}
