//! What was identified, as keys of a robot's file.

use super::{Identified, Quantity, Verdict};
use toml_edit::{DocumentMut, Item, Table, TomlError, value};

/// Writes keys into a TOML document and leaves everything else in it as it is, comments too:
/// `[robot]` gets m, I, r (mean of both wheels) and l, `[wheels]` and `[motor]` the rest by their
/// names. What was neither identified nor stated gets no key; what stands there stays.
///
/// # Errors
/// Text that is not TOML.
pub fn update(text: &str, found: &Identified) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    let number = |quantity| match found.of(quantity)? {
        Verdict::Stated { value } | Verdict::Identified { value, .. } => Some(*value),
        Verdict::NotIdentifiable { .. } => None,
    };
    let right = number(Quantity::RadiusRight);
    let radius = right.zip(number(Quantity::RadiusLeft));
    let robot = [
        ("m", number(Quantity::Mass)),
        ("I", number(Quantity::Inertia)),
        ("r", radius.map(|(right, left)| 0.5 * (right + left))),
        ("l", number(Quantity::Track)),
    ];
    for (key, number) in robot {
        set(&mut document, "robot", key, number);
    }
    for quantity in Quantity::ALL {
        use Quantity as Q;
        let table = match quantity {
            Q::Track | Q::Mass | Q::Inertia => continue,
            Q::MotorConstantRight | Q::MotorConstantLeft => "motor",
            Q::ResistanceRight | Q::ResistanceLeft | Q::Supply => "motor",
            _ => "wheels",
        };
        set(&mut document, table, quantity.name(), number(quantity));
    }
    Ok(document.to_string())
}

fn set(document: &mut DocumentMut, table: &str, key: &str, number: Option<f64>) {
    let Some(number) = number else { return };
    let item = document
        .entry(table)
        .or_insert_with(|| Item::Table(Table::new()));
    if let Some(table) = item.as_table_like_mut() {
        // Six digits: more than any interval has.
        let rounded = format!("{number:.5e}").parse().unwrap_or(number);
        match table.get_mut(key).and_then(Item::as_value_mut) {
            Some(old) => {
                let decor = old.decor().clone();
                *old = rounded.into();
                *old.decor_mut() = decor;
            }
            None => {
                table.insert(key, value(rounded));
            }
        }
    }
}
