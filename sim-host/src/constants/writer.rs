//! Lines of Rust.

use controller_core::safety::Timeout;
use std::fmt::Write as _;

/// Writes lines at their depth.
pub(super) struct Writer {
    text: String,
    depth: usize,
}

impl Writer {
    pub(super) fn new() -> Self {
        let (text, depth) = (String::new(), 0);
        Self { text, depth }
    }

    pub(super) fn text(self) -> String {
        self.text
    }

    pub(super) fn line(&mut self, line: &str) {
        if !line.is_empty() {
            self.text.push_str(&"    ".repeat(self.depth));
        }
        // Writing to a string does not fail.
        let _ = writeln!(self.text, "{line}");
    }

    pub(super) fn open(&mut self, line: &str) {
        self.line(line);
        self.depth += 1;
    }

    pub(super) fn close(&mut self, line: &str) {
        self.depth -= 1;
        self.line(line);
    }

    /// A field with what it is above it.
    pub(super) fn field(&mut self, name: &str, value: &str, about: &str) {
        if !about.is_empty() {
            self.line(&format!("// {about}"));
        }
        self.line(&format!("{name}: {value},"));
    }

    pub(super) fn number(&mut self, name: &str, value: f32, about: &str) {
        self.field(name, &number(value), about);
    }

    pub(super) fn timeout(&mut self, name: &str, value: Timeout, about: &str) {
        self.field(name, &timeout(value), about);
    }
}

/// The shortest text that gives the same bits back.
pub(super) fn number(value: f32) -> String {
    if value.is_finite() {
        format!("{value:?}")
    } else if value.is_nan() {
        "f32::NAN".to_owned()
    } else if value > 0.0 {
        "f32::INFINITY".to_owned()
    } else {
        "f32::NEG_INFINITY".to_owned()
    }
}

/// Digits in threes.
pub(super) fn whole(value: u32) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('_');
        }
        text.push(digit);
    }
    text
}

fn timeout(value: Timeout) -> String {
    match value {
        Timeout::AfterUs(us) => format!("Timeout::AfterUs({})", whole(us)),
        Timeout::Off => "Timeout::Off".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{number, whole};

    #[test]
    fn numbers_come_back_with_the_same_bits() {
        for value in [0.1, -0.0, 1.0e-5, 3.0e30, 16_777_217.0, f32::MIN_POSITIVE] {
            let back: f32 = number(value).parse().expect("a number");
            assert_eq!(back.to_bits(), value.to_bits());
            assert!(number(value).contains(['.', 'e']), "{value} is a float");
        }
    }

    #[test]
    fn whole_numbers_are_grouped() {
        let grouped = [0, 999, 1_000, 1_234_567].map(whole);
        assert_eq!(grouped, ["0", "999", "1_000", "1_234_567"]);
    }
}
