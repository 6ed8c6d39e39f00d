//! Names that are constants of the program, read back as what they were.

use serde::{Deserialize, Deserializer};
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// A name. Where this stands instead of what it is, `serde` does not try to borrow it from its input.
pub(crate) type Name = &'static str;

static KNOWN: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// Each different name is kept for good, once; there are as many as the program has.
fn kept(name: String) -> &'static str {
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(name) = known.get(name.as_str()) {
        return name;
    }
    let name: &'static str = name.leak();
    known.insert(name);
    name
}

/// One.
pub(crate) fn one<'de, D: Deserializer<'de>>(input: D) -> Result<&'static str, D::Error> {
    String::deserialize(input).map(kept)
}

/// A list.
pub(crate) fn list<'de, D: Deserializer<'de>>(input: D) -> Result<Vec<&'static str>, D::Error> {
    let names = Vec::<String>::deserialize(input)?;
    Ok(names.into_iter().map(kept).collect())
}
