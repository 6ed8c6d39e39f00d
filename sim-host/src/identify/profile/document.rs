//! A base's file as text: keys are set, comments and everything else stay.

use super::ProfileError;
use toml_edit::{Array, DocumentMut, Item, Key, Table, TableLike, Value};

/// Tables that an update writes to.
const TABLES: [&str; 4] = ["robot", "motor", "battery", "friction"];

pub(super) struct Document(DocumentMut);

impl Document {
    pub fn parse(text: &str) -> Result<Self, ProfileError> {
        let document: DocumentMut = text.parse()?;
        for table in TABLES {
            if document.get(table).is_some_and(|t| !t.is_table_like()) {
                return Err(ProfileError::NotATable(table));
            }
        }
        Ok(Self(document))
    }

    pub fn text(&self) -> String {
        self.0.to_string()
    }

    pub fn has(&self, table: &str, key: &str) -> bool {
        self.get(table, key).is_some()
    }

    pub fn has_table(&self, table: &str) -> bool {
        self.0.contains_key(table)
    }

    /// A number; TOML has integers apart.
    pub fn number(&self, table: &str, key: &str) -> Option<f64> {
        let item = self.get(table, key)?;
        item.as_float()
            .or_else(|| item.as_integer().map(|whole| whole as f64))
    }

    fn get(&self, table: &str, key: &str) -> Option<&Item> {
        self.0.get(table)?.as_table_like()?.get(key)
    }

    fn table(&mut self, table: &str) -> Option<&mut dyn TableLike> {
        let new = || Item::Table(Table::new());
        let item = self.0.entry(table).or_insert_with(new);
        item.as_table_like_mut()
    }

    pub fn set(&mut self, table: &str, key: &str, number: f64) {
        self.put(table, key, rounded(number).into());
    }

    pub fn set_pair(&mut self, table: &str, key: &str, pair: [f64; 2]) {
        let pair = Array::from_iter(pair.map(rounded));
        self.put(table, key, pair.into());
    }

    /// Over the old value, whose comment stays, or as a new key.
    fn put(&mut self, table: &str, key: &str, new: Value) {
        let Some(table) = self.table(table) else {
            return;
        };
        match table.get_mut(key).and_then(Item::as_value_mut) {
            Some(old) => {
                let decor = old.decor().clone();
                *old = new;
                *old.decor_mut() = decor;
            }
            None => {
                table.insert(key, Item::Value(new));
            }
        }
    }

    pub fn remove(&mut self, table: &str, key: &str) {
        if let Some(table) = self.table(table) {
            table.remove(key);
        }
    }

    /// Gives a key another name: it keeps its place and its comments.
    pub fn rename(&mut self, table: &str, from: &str, to: &str) {
        let Some(item) = self.0.get_mut(table) else {
            return;
        };
        match item {
            Item::Table(table) => {
                let order: Vec<_> = table.iter().map(|(key, _)| key.to_owned()).collect();
                let Some((key, item)) = table.remove_entry(from) else {
                    return;
                };
                let renamed = Key::new(to).with_leaf_decor(key.leaf_decor().clone());
                table.insert_formatted(&renamed, item);
                let place = |key: &Key| {
                    let old = if key.get() == to { from } else { key.get() };
                    order.iter().position(|k| k == old)
                };
                table.sort_values_by(|a, _, b, _| place(a).cmp(&place(b)));
            }
            // A line of its own has neither order nor comments to keep.
            _ => {
                if let Some(table) = item.as_table_like_mut()
                    && let Some(item) = table.remove(from)
                {
                    table.insert(to, item);
                }
            }
        }
    }
}

/// Six digits: more than any interval has.
pub(super) fn rounded(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}
