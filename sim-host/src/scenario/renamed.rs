//! Names of base files that have changed. The old ones are read for one release more, with a note.

use toml::Table;

/// Table, old key, new key.
pub const RENAMED_KEYS: [(&str, &str, &str); 4] = [
    ("policy", "gave_up", "goal_unreachable"),
    ("gains", "along", "longitudinal"),
    ("gains", "along_bound", "longitudinal_bound"),
    ("gains", "across", "lateral"),
];

/// A note for each old name in the text of a base's file.
pub(super) fn notes(file: &str, text: &str) -> Vec<String> {
    let tables: Table = toml::from_str(text).unwrap_or_default();
    let note = |old: &str, new: &str| {
        format!("{file}: `{old}` is `{new}` now; the old name is read for one release more")
    };
    let table = |name: &str| tables.get(name).and_then(toml::Value::as_table);
    let mut notes = Vec::new();
    for (name, old, new) in RENAMED_KEYS {
        if table(name).is_some_and(|table| table.contains_key(old)) {
            notes.push(note(&format!("{name}.{old}"), &format!("{name}.{new}")));
        }
    }
    let responses = table("policy").into_iter().flatten();
    let reactions = responses.filter_map(|(_, response)| response.get("reaction")?.as_str());
    if reactions.into_iter().any(|reaction| reaction == "ride-out") {
        notes.push(note("ride-out", "ignore"));
    }
    notes
}

#[cfg(test)]
mod tests {
    use crate::mission::BaseSpec;
    use crate::scenario::BuiltInBase;

    /// The old names mean what the new ones do; each old one gives a note that has both.
    #[test]
    fn old_names_are_read_and_noted() {
        let text = BuiltInBase::find("hobby-1kg").expect("built in").text;
        let parse = |policy: &str| {
            BaseSpec::parse("mine.toml", &format!("{text}\n[policy]\n{policy}\n")).expect("a base")
        };
        let old = parse(
            "gave_up = { reaction = \"brake\", latch = true }\npose_jump = { reaction = \"ride-out\", latch = false }",
        );
        let new = parse(
            "goal_unreachable = { reaction = \"brake\", latch = true }\npose_jump = { reaction = \"ignore\", latch = false }",
        );
        assert_eq!(old.policy, new.policy);
        assert_eq!(new.notes.len(), 0);
        for (note, [before, after]) in old.notes.iter().zip([
            ["`policy.gave_up`", "`policy.goal_unreachable`"],
            ["`ride-out`", "`ignore`"],
        ]) {
            assert!(note.contains(before) && note.contains(after), "{note}");
        }
        assert_eq!(old.notes.len(), 2);
        let gains = text
            .replace("longitudinal =", "along =")
            .replace("lateral =", "across =");
        let gains = BaseSpec::parse("mine.toml", &gains).expect("a base");
        assert_eq!(gains.gains, new.gains);
        assert_eq!(gains.notes.len(), 2);
    }
}
