//! Where in a file a key stands, and errors that show the place.

use crate::import::Reason;
use crate::numbers;
use controller_core::error::ParamError;
use std::fmt;
use std::io::{self, ErrorKind};
use std::ops::Range;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// A scenario that cannot be used: which file, which line, which key, and why.
///
/// Its `Display` shows the line:
///
/// ```text
/// my.toml:12: gains.k2: k2 is below its smallest value 1e-6
///    |
/// 12 | k2 = -3.0
///    |      ^^^^
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    /// The file as the user named it.
    pub file: String,
    /// Line, counted from 1; none if the file could not be read.
    pub line: Option<usize>,
    /// The key with its tables, `gains.k2`; empty if the error is of no key.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// The line and a marker below it.
    excerpt: String,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.key.is_empty() {
            write!(f, ": {}", self.key)?;
        }
        write!(f, ": {}{}", self.message, self.excerpt)
    }
}

impl std::error::Error for ScenarioError {}

impl ScenarioError {
    /// Of a key of a file with this text.
    pub(crate) fn of_key(file: &str, text: &str, path: &str, message: &str) -> Self {
        Source::new(file, text).error(path, message)
    }
}

const IS_MISSING: &str = "is missing";

/// What a file describes.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Robot,
    Scenario,
}

/// The text of a file, to point into.
pub(super) struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl<'a> Source<'a> {
    pub fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, text }
    }

    /// An error of the key at `path`, or of the table that lacks it.
    pub fn error(&self, path: &str, message: impl fmt::Display) -> ScenarioError {
        self.place(path.to_owned(), self.span_of(path), message.to_string())
    }

    /// The core's error of a key, or of a table; the core's name of a parameter is not always the key's.
    pub fn param_error(&self, path: &str, error: &ParamError) -> ScenarioError {
        match path.contains('.') {
            true => self.error(path, numbers::problem(error)),
            false => self.error(path, numbers::param(error)),
        }
    }

    /// An error of the TOML reader about a file that is to be of this kind, or that it is of the other one.
    pub fn misread(&self, kind: Kind, error: &toml::de::Error) -> ScenarioError {
        let of_scenario = self.has("run");
        let of_robot = self.has("limits") && self.has("robot");
        match kind {
            Kind::Scenario if of_robot && !of_scenario => self.error("limits", "is a robot's, not a scenario's: `--base` takes it, beside a trajectory file, or `verify`"),
            Kind::Robot if of_scenario => self.error("run", "is a scenario's, not a robot's: `run` takes it"),
            _ => self.reader_error(error),
        }
    }

    /// An error of the TOML reader, which knows the place but not always the key.
    pub fn reader_error(&self, error: &toml::de::Error) -> ScenarioError {
        let span = error.span();
        let table = span.as_ref().map_or_else(String::new, |s| self.key_at(s));
        let missing = error.message().strip_prefix("missing field `");
        match missing.and_then(|rest| rest.strip_suffix('`')) {
            // The reader points at the table that lacks the key.
            Some(key) if table.is_empty() => self.place(key.to_owned(), span, IS_MISSING.into()),
            Some(key) => self.place(format!("{table}.{key}"), span, IS_MISSING.into()),
            None => self.place(table, span, error.message().to_owned()),
        }
    }

    fn place(&self, key: String, span: Option<Range<usize>>, message: String) -> ScenarioError {
        // A missing table has no place of its own; the top of the file stands for it.
        let span = span.unwrap_or(0..0);
        let before = &self.text[..span.start.min(self.text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count();
        let content = self.text.lines().nth(line - 1).unwrap_or("");
        let room = content.chars().count().saturating_sub(column);
        let width = self.text.get(span).map_or(1, |s| s.chars().count());
        let marker = "^".repeat(width.clamp(1, room.max(1)));
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        let indent = " ".repeat(column);
        let excerpt = format!("\n{margin} |\n{number} | {content}\n{margin} | {indent}{marker}");
        ScenarioError {
            file: self.file.to_owned(),
            line: Some(line),
            key,
            message,
            excerpt,
        }
    }

    /// Whether the file has this key.
    pub fn has(&self, key: &str) -> bool {
        let document = DeTable::parse(self.text);
        document.is_ok_and(|document| span_in(document.get_ref(), &[key]).is_some())
    }

    fn span_of(&self, path: &str) -> Option<Range<usize>> {
        let document = DeTable::parse(self.text).ok()?;
        let parts: Vec<&str> = path.split('.').collect();
        span_in(document.get_ref(), &parts)
    }

    fn key_at(&self, span: &Range<usize>) -> String {
        // The reader points at nothing when it means the whole file.
        if span.is_empty() {
            return String::new();
        }
        let mut path = Vec::new();
        match DeTable::parse(self.text) {
            Ok(document) => {
                path_to(document.get_ref(), span, &mut path);
            }
            // Not TOML: what stands before the equals sign will be the key.
            Err(_) => {
                let start = self.text[..span.start].rfind('\n').map_or(0, |at| at + 1);
                let line = self.text[start..].lines().next().unwrap_or("");
                path.extend(line.split_once('=').map(|(key, _)| key.trim().to_owned()));
            }
        }
        path.reverse();
        path.join(".")
    }
}

/// The place of the value at `path`, or of the innermost table on the way that exists.
fn span_in(table: &DeTable<'_>, path: &[&str]) -> Option<Range<usize>> {
    let (first, rest) = path.split_first()?;
    // `push[0]` is the first [[push]].
    let (name, place) = match first
        .strip_suffix(']')
        .and_then(|part| part.split_once('['))
    {
        Some((name, place)) => (name, place.parse::<usize>().ok()),
        None => (*first, None),
    };
    let (key, value) = table.iter().find(|(key, _)| key.get_ref() == name)?;
    match value.get_ref() {
        DeValue::Array(all) => {
            let item = place.and_then(|place| all.get(place));
            let inner = item.and_then(|item| span_in(item.get_ref().as_table()?, rest));
            inner.or_else(|| Some(item.map_or_else(|| value.span(), |item| item.span())))
        }
        // The name of a table says more than its whole body.
        DeValue::Table(inner) => span_in(inner, rest).or_else(|| Some(key.span())),
        _ => Some(value.span()),
    }
}

/// Pushes the names that lead to `span`, innermost first; returns whether it found the place.
fn path_to(table: &DeTable<'_>, span: &Range<usize>, path: &mut Vec<String>) -> bool {
    let covers = |s: Range<usize>| s.start <= span.start && span.end <= s.end;
    for (key, value) in table {
        let inside = match value.get_ref() {
            DeValue::Table(inner) => path_to(inner, span, path),
            _ => false,
        };
        if inside || covers(key.span()) || covers(value.span()) {
            path.push(key.get_ref().to_string());
            return true;
        }
    }
    false
}

/// Where the built-in ones are told, for a `path` to nothing that looks like the name of one.
pub(crate) fn if_named(path: &Path, cause: &io::Error) -> &'static str {
    let is_name = path.components().count() == 1 && path.extension().is_none();
    if is_name && cause.kind() == ErrorKind::NotFound {
        "; built in are the scenarios of `sim-host list` and the bases of `sim-host run --help`"
    } else {
        ""
    }
}

/// The text of a file; `file` is the name that errors show.
pub(crate) fn text(file: &str, bytes: Vec<u8>) -> Checked<String> {
    String::from_utf8(bytes).map_err(|error| {
        let bytes = error.as_bytes();
        let offset = error.utf8_error().valid_up_to();
        let before = bytes.iter().take(offset);
        ScenarioError {
            file: file.to_owned(),
            line: Some(1 + before.filter(|&&byte| byte == b'\n').count()),
            key: String::new(),
            message: Reason::NotText { offset }.to_string(),
            excerpt: String::new(),
        }
    })
}

/// What `parse` makes of a file; it gets the file's name and text.
pub(super) fn load<T>(
    path: &Path,
    parse: impl FnOnce(&str, &str) -> Result<T, ScenarioError>,
) -> Result<T, ScenarioError> {
    let file = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => parse(&file, &text(&file, bytes)?),
        Err(error) => Err(ScenarioError {
            file,
            line: None,
            key: String::new(),
            message: format!("cannot be read: {error}{}", if_named(path, &error)),
            excerpt: String::new(),
        }),
    }
}

/// What a key was read as, or what is wrong with it.
pub(super) type Checked<T> = Result<T, ScenarioError>;
