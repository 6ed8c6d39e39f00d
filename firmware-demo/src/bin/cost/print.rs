//! Rows with a path for a name.

use firmware_demo::board::print::Line;

/// Least, most and mean of what was measured under one name.
pub struct Row {
    least: u32,
    most: u32,
    sum: u32,
    count: u32,
}

impl Row {
    pub const fn new() -> Self {
        Self {
            least: u32::MAX,
            most: 0,
            sum: 0,
            count: 0,
        }
    }

    pub fn add(&mut self, value: u32) {
        self.least = self.least.min(value);
        self.most = self.most.max(value);
        self.sum = self.sum.saturating_add(value);
        self.count = self.count.saturating_add(1);
    }

    /// Prints `a/b/c min mean max`.
    #[inline(never)]
    pub fn print(&self, name: &[&str]) {
        line(name)
            .number(self.least)
            .mean(self.sum, self.count)
            .number(self.most)
            .print();
    }
}

/// A line that begins with a path.
pub fn line(name: &[&str]) -> Line {
    let mut line = Line::new();
    for (at, part) in name.iter().enumerate() {
        line = if at == 0 { line } else { line.text("/") };
        line = line.text(part);
    }
    line
}

/// Says that `count` of the measured calls were not what the row says; nothing for 0.
#[inline(never)]
pub fn complain(name: &[&str], what: &str, count: u32) {
    if count > 0 {
        Line::new().text("!").text(what).text(" ").print();
        line(name).number(count).print();
    }
}
