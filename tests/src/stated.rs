//! Figures that the documents state. A figure stands in its document only: a test finds it there and compares what
//! it measured, by [`Stated::exactly`] where the run has the same bits on every machine, by [`Stated::to_a_digit`]
//! where another calculation made the figure, by [`Stated::about`] where the document rounds on purpose, by
//! [`Stated::at_most`] where it states a bound.
//!
//! A figure that is not true fails with the line as it should read; `UPDATE_DOCS=1` writes it instead.

use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Where figures stand in a document.
#[derive(Clone, Copy, Debug)]
pub enum At<'a> {
    /// The cells of a table's row: the heading above the table, and the row's first cells as they are written, joined
    /// by ` | `. All numbers of the cells after these, in order.
    Row(&'a str, &'a str),
    /// One cell of such a row: the third is the cell's own heading, in the table's first row.
    Cell(&'a str, &'a str, &'a str),
    /// A phrase that occurs once, with `#` for each number; line breaks count as spaces.
    Phrase(&'a str),
}

/// A number as it is written.
#[derive(Clone, Debug, PartialEq)]
struct Number {
    place: Range<usize>,
    value: f64,
    decimals: usize,
    exponent: bool,
    commas: bool,
}

impl Number {
    /// The number that begins at `at`, if one does.
    fn read(text: &str, at: usize) -> Option<Self> {
        let before = text[..at].chars().next_back();
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
        let rest = &text[at..];
        // A hyphen is a sign at the start of a word only; between numbers it is a range.
        let minus = if rest.starts_with('−') {
            '−'.len_utf8()
        } else if rest.starts_with('-') && before.is_none_or(|c| c.is_whitespace() || c == '(') {
            1
        } else {
            0
        };
        if minus == 0 && before.is_some_and(is_word) {
            return None;
        }
        // The middle of `1,800`.
        if before == Some(',') && text[..at - 1].ends_with(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let digits = |from: usize| rest[from..].bytes().take_while(u8::is_ascii_digit).count();
        let mut end = minus + digits(minus);
        if end == minus {
            return None;
        }
        let mut commas = false;
        while rest[end..].starts_with(',') && digits(end + 1) == 3 {
            end += 4;
            commas = true;
        }
        let mut decimals = 0;
        if rest[end..].starts_with('.') && digits(end + 1) > 0 {
            decimals = digits(end + 1);
            end += 1 + decimals;
        }
        let mut exponent = false;
        if rest[end..].starts_with('e') {
            let sign = usize::from(rest[end + 1..].starts_with('-'));
            let power = digits(end + 1 + sign);
            if power > 0 {
                end += 1 + sign + power;
                exponent = true;
            }
        }
        let value = rest[..end].replace('−', "-").replace(',', "");
        Some(Self {
            place: at..at + end,
            value: value.parse().ok()?,
            decimals,
            exponent,
            commas,
        })
    }

    /// All of a part of a text.
    fn all(text: &str, part: Range<usize>) -> Vec<Self> {
        let mut found = Vec::new();
        let mut at = part.start;
        while at < part.end {
            if let Some(number) = Self::read(text, at) {
                at = number.place.end;
                found.push(number);
            } else {
                at += text[at..].chars().next().map_or(1, char::len_utf8);
            }
        }
        found
    }

    /// Another value in the same form.
    fn write(&self, value: f64) -> String {
        let decimals = self.decimals;
        let written = if self.exponent {
            format!("{value:.decimals$e}")
        } else {
            format!("{value:.decimals$}")
        };
        // No sign for what rounds to 0.
        let is_zero = !written.bytes().any(|b| (b'1'..=b'9').contains(&b));
        let (sign, digits) = match written.strip_prefix('-') {
            Some(digits) if is_zero => ("", digits),
            Some(digits) => ("−", digits),
            None => ("", written.as_str()),
        };
        let (whole, rest) = digits.split_at(digits.find(['.', 'e']).unwrap_or(digits.len()));
        let mut grouped = String::new();
        for (at, digit) in whole.chars().enumerate() {
            if self.commas && at > 0 && (whole.len() - at).is_multiple_of(3) {
                grouped.push(',');
            }
            grouped.push(digit);
        }
        format!("{sign}{grouped}{rest}")
    }

    /// A unit of the last digit.
    fn last_digit(&self) -> f64 {
        let power = if self.exponent && self.value != 0.0 {
            self.value.abs().log10().floor()
        } else {
            0.0
        };
        10.0_f64.powf(power - self.decimals as f64)
    }
}

/// How measured figures compare with stated ones.
#[derive(Clone, Copy, Debug, PartialEq)]
enum How {
    Exactly,
    ToADigit,
    About,
    AtMost,
}

impl How {
    fn holds(self, stated: &Number, measured: f64) -> bool {
        let off = (measured - stated.value).abs();
        // A figure at the very edge is inside, whatever its binary form.
        let digit = stated.last_digit() * (1.0 + 1e-9);
        match self {
            Self::Exactly => stated.write(measured) == stated.write(stated.value),
            Self::ToADigit => off <= digit,
            Self::About => off <= digit.max(0.1 * stated.value.abs() * (1.0 + 1e-9)),
            Self::AtMost => measured <= stated.value,
        }
    }
}

/// Part of a text up to the next heading, after the one that begins with `heading`.
fn section(text: &str, heading: &str) -> Option<Range<usize>> {
    let mut at = 0;
    let mut found: Option<Range<usize>> = None;
    let mut code = false;
    for line in text.split_inclusive('\n') {
        code ^= line.starts_with("```");
        if line.starts_with('#') && !code {
            if let Some(part) = &mut found {
                part.end = at;
                break;
            }
            if line.trim_start_matches('#').trim().starts_with(heading) {
                found = Some(at..text.len());
            }
        }
        at += line.len();
    }
    found
}

/// The end of `text` from `at` on that matches a phrase, and the numbers in it.
fn matching(text: &str, mut at: usize, phrase: &str) -> Option<Vec<Number>> {
    let mut found = Vec::new();
    for wanted in phrase.chars() {
        let rest = &text[at..];
        if wanted == '#' {
            let number = Number::read(text, at)?;
            at = number.place.end;
            found.push(number);
        } else if wanted == ' ' {
            let space = rest.len() - rest.trim_start().len();
            if space == 0 {
                return None;
            }
            at += space;
        } else {
            at += rest.strip_prefix(wanted).map(|_| wanted.len_utf8())?;
        }
    }
    Some(found)
}

/// Start and end of the one row that begins with `label`, under a heading.
fn row(text: &str, heading: &str, label: &str) -> Result<Range<usize>, String> {
    let part = section(text, heading).ok_or(format!("no section \"{heading}\""))?;
    let start = format!("\n| {label} |");
    let mut rows = text[part.clone()]
        .match_indices(&start)
        .map(|(from, _)| part.start + from + 1);
    let row = rows
        .next()
        .ok_or(format!("no row \"{label}\" under \"{heading}\""))?;
    if rows.next().is_some() {
        return Err(format!("two rows \"{label}\" under \"{heading}\""));
    }
    let end = text[row..].find('\n').map_or(text.len(), |end| row + end);
    Ok(row..end)
}

/// The part of a row below a heading of its table.
fn cell(text: &str, row: &Range<usize>, column: &str) -> Option<Range<usize>> {
    let above = text[..row.start].rfind("\n\n").map_or(0, |at| at + 2);
    let head = text[above..].lines().next()?;
    let number = head.split('|').position(|cell| cell.trim() == column)?;
    let mut from = row.start;
    for (at, cell) in text[row.clone()].split('|').enumerate() {
        if at == number {
            return Some(from..from + cell.len());
        }
        from += cell.len() + 1;
    }
    None
}

/// The numbers at a place of a text.
fn find(text: &str, at: At) -> Result<Vec<Number>, String> {
    match at {
        At::Row(heading, label) => {
            let row = row(text, heading, label)?;
            Ok(Number::all(text, row.start + label.len() + 4..row.end))
        }
        At::Cell(heading, label, column) => {
            let row = row(text, heading, label)?;
            let cell = cell(text, &row, column).ok_or(format!("no column \"{column}\""))?;
            Ok(Number::all(text, cell))
        }
        At::Phrase(phrase) => {
            let mut all = text
                .char_indices()
                .filter_map(|(from, _)| matching(text, from, phrase));
            let found = all.next().ok_or(format!("no phrase \"{phrase}\""))?;
            if all.next().is_some() {
                return Err(format!("the phrase \"{phrase}\" is there twice"));
            }
            Ok(found)
        }
    }
}

/// The lines of a text that hold some numbers, with these replaced; and the whole text.
fn replaced(text: &str, numbers: &[Number], measured: &[f64]) -> (String, String) {
    let (mut all, mut from) = (String::new(), 0);
    for (number, &value) in numbers.iter().zip(measured) {
        all.push_str(&text[from..number.place.start]);
        all.push_str(&number.write(value));
        from = number.place.end;
    }
    let first = numbers.first().map_or(0, |number| number.place.start);
    let start = text[..first].rfind('\n').map_or(0, |at| at + 1);
    let rest = &text[from..];
    let end = all.len() + rest.find('\n').unwrap_or(rest.len());
    all.push_str(rest);
    (all[start..end].to_owned(), all)
}

/// One writer at a time.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A picture of the documents, by its path from the root of the workspace: byte for byte what is drawn. `UPDATE_DOCS=1` writes it instead.
pub fn picture(name: &str, drawn: &[u8]) {
    let path = crate::root().join(name);
    // Not by `assert_eq`, which would print all of it.
    if fs::read(&path).is_ok_and(|shown| shown == drawn) {
        return;
    }
    assert!(
        std::env::var_os("UPDATE_DOCS").is_some(),
        "{name} shows something else; UPDATE_DOCS=1 writes it"
    );
    fs::write(&path, drawn).unwrap_or_else(|error| panic!("{name} cannot be written: {error}"));
}

/// The figures of one document. What is wrong is collected, and said when this is dropped.
#[derive(Debug)]
#[must_use]
pub struct Stated {
    name: String,
    path: PathBuf,
    wrong: Vec<String>,
}

impl Stated {
    /// A document, by its path from the root of the workspace.
    pub fn of(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            path: crate::root().join(name),
            wrong: Vec::new(),
        }
    }

    fn text(&self) -> String {
        fs::read_to_string(&self.path).unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }

    /// The stated numbers, for what is derived from them.
    pub fn numbers(&self, at: At) -> Vec<f64> {
        let found = find(&self.text(), at).unwrap_or_else(|error| panic!("{}: {error}", self.name));
        found.iter().map(|number| number.value).collect()
    }

    fn compare(&mut self, how: How, at: At, measured: &[f64]) {
        let _alone = alone();
        let text = self.text();
        let numbers = match find(&text, at) {
            Ok(numbers) if numbers.len() == measured.len() => numbers,
            Ok(numbers) => {
                let stated: Vec<f64> = numbers.iter().map(|number| number.value).collect();
                self.wrong
                    .push(format!("{at:?}: states {stated:?}, measured {measured:?}"));
                return;
            }
            Err(error) => {
                self.wrong
                    .push(format!("{at:?}: {error}; measured {measured:?}"));
                return;
            }
        };
        let holds = |(stated, &value): (&Number, &f64)| how.holds(stated, value);
        if numbers.iter().zip(measured).all(holds) {
            return;
        }
        let (line, all) = replaced(&text, &numbers, measured);
        let wrong = format!("{how:?} {at:?}, measured {measured:?}\n{line}");
        self.update(how, &all, &wrong);
    }

    /// Measured figures that, rounded as stated, have the digits stated.
    pub fn exactly(&mut self, at: At, measured: &[f64]) {
        self.compare(How::Exactly, at, measured);
    }

    /// Measured figures within a unit of the last digit stated.
    pub fn to_a_digit(&mut self, at: At, measured: &[f64]) {
        self.compare(How::ToADigit, at, measured);
    }

    /// Measured figures within a tenth, or a unit of the last digit if that is more: better than that fails as well, for
    /// a document that says less than is true misleads too.
    pub fn about(&mut self, at: At, measured: &[f64]) {
        self.compare(How::About, at, measured);
    }

    /// Measured figures within the bounds stated.
    pub fn at_most(&mut self, at: At, measured: &[f64]) {
        self.compare(How::AtMost, at, measured);
    }

    /// A table whose first line is `first`, as a test makes it.
    pub fn table(&mut self, first: &str, printed: &str) {
        self.part(first, printed, |text| {
            let from = text.find(&format!("\n{first}\n"))? + 1;
            let end = text[from..]
                .find("\n\n")
                .map_or(text.len(), |end| from + end + 1);
            Some(from..end)
        });
    }

    /// The first block of text under a heading, as a program prints it.
    pub fn block(&mut self, heading: &str, printed: &str) {
        self.fenced(heading, "```text\n", printed);
    }

    /// The first block of Rust under a heading, as a program writes it.
    pub fn rust(&mut self, heading: &str, written: &str) {
        self.fenced(heading, "```rust\n", written);
    }

    fn fenced(&mut self, heading: &str, fence: &str, printed: &str) {
        self.part(heading, printed, |text| {
            let part = section(text, heading)?;
            let from = part.start + text[part].find(fence)? + fence.len();
            let end = from + text[from..].find("```")?;
            Some(from..end)
        });
    }

    fn part(&mut self, name: &str, printed: &str, find: impl Fn(&str) -> Option<Range<usize>>) {
        let _alone = alone();
        let text = self.text();
        let trimmed = |text: &str| -> String {
            let lines = text.trim_end().lines().map(str::trim_end);
            lines.map(|line| format!("{line}\n")).collect()
        };
        let printed = trimmed(printed);
        let Some(part) = find(&text) else {
            self.wrong.push(format!("there is no \"{name}\""));
            return;
        };
        if trimmed(&text[part.clone()]) == printed {
            return;
        }
        let all = format!("{}{printed}{}", &text[..part.start], &text[part.end..]);
        self.update(
            How::Exactly,
            &all,
            &format!("\"{name}\" should read\n{printed}"),
        );
    }

    /// Writes the document, or keeps what is wrong with it.
    fn update(&mut self, how: How, all: &str, wrong: &str) {
        // A bound is somebody's decision.
        if std::env::var_os("UPDATE_DOCS").is_some() && how != How::AtMost {
            fs::write(&self.path, all)
                .unwrap_or_else(|error| panic!("{} cannot be written: {error}", self.name));
        } else {
            self.wrong.push(wrong.to_owned());
        }
    }
}

impl Drop for Stated {
    fn drop(&mut self) {
        if !self.wrong.is_empty() && !std::thread::panicking() {
            panic!(
                "{} does not say what was measured (UPDATE_DOCS=1 writes it):\n{}",
                self.name,
                self.wrong.join("\n")
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{At, How, Number, find, replaced};

    const TEXT: &str = "\
# Head

| | line, neural | x2 |
| --- | --- | --- |
| peak [N] | 20, −17.50 | 2,275 / 1.7e-6 |
| twice | 1 | |
| twice | 2 | |

The plain law, 1,800 times, starts with 47 N and
−164 N m, `f32`, in 4.95–4.98 s, v1.2, 5 of 5.
";

    fn values(at: At) -> Result<Vec<f64>, String> {
        Ok(find(TEXT, at)?.iter().map(|number| number.value).collect())
    }

    #[test]
    fn rows_and_phrases_are_found() {
        let row = |label| values(At::Row("Head", label));
        assert_eq!(row("peak [N]"), Ok(vec![20.0, -17.5, 2275.0, 1.7e-6]));
        assert_eq!(row("peak [N] | 20, −17.50"), Ok(vec![2275.0, 1.7e-6]));
        assert!(row("twice").is_err() && row("none").is_err());
        let cell = |column| values(At::Cell("Head", "peak [N]", column));
        assert_eq!(cell("line, neural"), Ok(vec![20.0, -17.5]));
        assert!(cell("line").is_err());
        assert!(values(At::Row("Tail", "peak [N]")).is_err());
        let phrase = |phrase| values(At::Phrase(phrase));
        assert_eq!(phrase("starts with # N and # N m"), Ok(vec![47.0, -164.0]));
        assert_eq!(phrase("in #–# s"), Ok(vec![4.95, 4.98]));
        assert_eq!(phrase("# times"), Ok(vec![1800.0]));
        assert!(phrase("v#").is_err() && phrase("f#").is_err() && phrase("| #").is_err());
    }

    #[test]
    fn figures_are_compared_by_the_digits_stated() {
        let number = |text: &str| Number::read(text, 0).expect("a number");
        for (how, stated, good, bad) in [
            (How::Exactly, "4.98", 4.9849, 4.9851),
            (How::Exactly, "−7.2", -7.24, -7.26),
            (How::Exactly, "0.02", 0.0151, -0.02),
            (How::Exactly, "2,275", 2275.0, 2276.0),
            (How::Exactly, "1.7e-6", 1.74e-6, 1.76e-6),
            (How::ToADigit, "0.86", 0.87, 0.871),
            (How::About, "20", 22.0, 22.1),
            (How::About, "0.5", 0.6, 0.61),
            (How::About, "40", 36.0, 35.9),
            (How::About, "1e-6", 2e-6, 2.1e-6),
            (How::AtMost, "5", 0.1, 5.01),
        ] {
            assert!(how.holds(&number(stated), good), "{stated} {good}");
            assert!(!how.holds(&number(stated), bad), "{stated} {bad}");
        }
    }

    #[test]
    fn what_should_be_there_is_written_in_the_same_form() {
        let numbers = find(TEXT, At::Row("Head", "peak [N]")).expect("found");
        let (line, all) = replaced(TEXT, &numbers, &[19.6, -0.001, 12_345.4, 2.06e-6]);
        assert_eq!(line, "| peak [N] | 20, 0.00 | 12,345 / 2.1e-6 |");
        assert_eq!(
            all.replace(&line, ""),
            TEXT.replace("| peak [N] | 20, −17.50 | 2,275 / 1.7e-6 |", "")
        );
    }
}
