//! Budgets: a checked-in table of numbers, compared with what was measured.

use std::collections::BTreeMap;
use std::fmt::Write;

/// Numbers by section and key.
pub type Table = BTreeMap<String, BTreeMap<String, u64>>;

/// An improvement beyond this share asks for a lower budget.
const WORTH_LOWERING: f64 = 0.02;

/// Reads `[section]`, `key = number` and comments: the part of TOML that a table of numbers needs.
///
/// # Errors
/// The line that is none of these.
pub fn parse(text: &str) -> Result<Table, String> {
    let mut table = Table::new();
    let mut section = String::new();
    for (at, line) in text.lines().enumerate() {
        let wrong = || format!("line {}: {line}", at + 1);
        let content = line.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        if let Some(rest) = content.strip_prefix('[') {
            section = rest.strip_suffix(']').ok_or_else(wrong)?.to_owned();
        } else {
            let (key, value) = content.split_once('=').ok_or_else(wrong)?;
            let value = value.trim().replace('_', "").parse().map_err(|_| wrong())?;
            let entries = table.entry(section.clone()).or_default();
            if entries.insert(key.trim().to_owned(), value).is_some() {
                return Err(wrong());
            }
        }
    }
    Ok(table)
}

/// The table as [`parse`] reads it.
pub fn print(table: &Table) -> String {
    let mut text = String::new();
    for (section, entries) in table {
        let _ = writeln!(text, "\n[{section}]");
        for (key, value) in entries {
            let _ = writeln!(text, "{key} = {value}");
        }
    }
    text
}

/// What the comparison says.
#[derive(Debug, Default)]
pub struct BudgetVerdict {
    /// Worse than its budget, without a budget, or not measured: each fails.
    pub failures: Vec<String>,
    /// So much better that the budget can be lowered.
    pub hints: Vec<String>,
}

/// Compares every number with its budget; a smaller one is better.
pub fn compare(budgets: &Table, measured: &Table) -> BudgetVerdict {
    let mut verdict = BudgetVerdict::default();
    let find = |table: &Table, section: &str, key: &str| -> Option<u64> {
        table.get(section)?.get(key).copied()
    };
    for (section, entries) in measured {
        for (key, &value) in entries {
            let Some(budget) = find(budgets, section, key) else {
                let line = format!("[{section}] {key}: measured {value}, no budget");
                verdict.failures.push(line);
                continue;
            };
            let more = value as f64 / budget as f64 - 1.0;
            let sides = format!(
                "[{section}] {key}: measured {value}, budget {budget} ({:+.1} %)",
                100.0 * more
            );
            if value > budget {
                verdict.failures.push(sides);
            } else if more < -WORTH_LOWERING {
                verdict.hints.push(format!("{sides}: lower the budget"));
            }
        }
    }
    for (section, entries) in budgets {
        for (key, budget) in entries {
            if find(measured, section, key).is_none() {
                let line = format!("[{section}] {key}: not measured, budget {budget}");
                verdict.failures.push(line);
            }
        }
    }
    verdict
}
