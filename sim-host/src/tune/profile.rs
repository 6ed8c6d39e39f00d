//! Gains into a robot's file.

use super::knobs::KNOBS;
use crate::scenario::RENAMED_KEYS;
use controller_core::motion::MotionGains;
use toml_edit::{DocumentMut, Item, Table, TomlError, value};

/// Writes [`KNOBS`] into `[gains]` and leaves everything else as it is, comments too.
///
/// # Errors
/// Text that is not TOML.
pub fn update(text: &str, gains: &MotionGains<f64>) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    let item = document
        .entry("gains")
        .or_insert_with(|| Item::Table(Table::new()));
    if let Some(table) = item.as_table_like_mut() {
        for (_, old, new) in RENAMED_KEYS.iter().filter(|(table, ..)| *table == "gains") {
            if let Some(item) = table.remove(old) {
                table.insert(new, item);
            }
        }
        for knob in KNOBS {
            let number = knob.of(gains);
            match table.get_mut(knob.key).and_then(Item::as_value_mut) {
                Some(old) => {
                    let decor = old.decor().clone();
                    *old = number.into();
                    *old.decor_mut() = decor;
                }
                None => {
                    table.insert(knob.key, value(number));
                }
            }
        }
    }
    Ok(document.to_string())
}

#[cfg(test)]
mod tests {
    use super::update;
    use crate::mission::BaseSpec;
    use crate::scenario::BuiltInBase;

    #[test]
    fn comments_stay_and_the_file_reads_back() {
        let text = BuiltInBase::find("lab-10kg").expect("built in").text;
        // `[gains]` is the last table of the file; here it is somebody's own.
        let (before, _) = text.split_once("[gains]").expect("has gains");
        let with = format!("{before}[gains]\nalong = 9.0   # by ear\nslow = 0.05\n");
        let mut gains = BaseSpec::default().motion().gains;
        gains.longitudinal = 1.25;
        let updated = update(&with, &gains).expect("TOML");
        assert!(
            updated.contains("longitudinal = 1.25   # by ear")
                && updated.contains("# two lead batteries")
        );
        let read = BaseSpec::parse("mine.toml", &updated).expect("a base");
        let read = read.gains.expect("gains");
        assert_eq!(
            (read.longitudinal, read.heading, read.slow),
            (1.25, gains.heading, 0.05)
        );
    }
}
