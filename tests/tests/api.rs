//! The public interface of what is published, beside that of the last release: what breaks a program that uses it is
//! marked in the changelog.
//!
//! `tests/golden/api/` has a line for each public item, from the compiler's own documentation; only a release writes it anew
//! (`sh release/run prepare`, which sets `UPDATE_API`). New items need no mark, unless they break somebody: a field of a struct
//! whose fields are public, a variant of an enum or a field of a variant, none of them `#[non_exhaustive]`, and an item of
//! a trait, which may be one that others implement.

use super::root;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is published.
const PUBLISHED: [Published; 2] = [
    Published {
        package: "controller-core",
        library: "controller_core",
        section: "controller-core",
        least: 1_000,
    },
    Published {
        package: "controller-core-protocol",
        library: "protocol",
        section: "protocol",
        least: 100,
    },
];

/// A package, its library, where the changelog tells of it, and how many items it surely has.
struct Published {
    package: &'static str,
    library: &'static str,
    section: &'static str,
    least: usize,
}

/// The public items of a package with all features, sorted.
fn items(published: &Published) -> BTreeSet<String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("api");
    let arguments = [
        "rustdoc",
        "--quiet",
        "--locked",
        "--offline",
        "--lib",
        "--all-features",
    ];
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .args([
            "--package",
            published.package,
            "--",
            "-Z",
            "unstable-options",
        ])
        .args(["--output-format", "json"])
        // The compiler that is pinned writes this form as any nightly one does; it only has to be asked.
        .env("RUSTC_BOOTSTRAP", "1")
        .env("CARGO_TARGET_DIR", &folder)
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let json = folder
        .join("doc")
        .join(format!("{}.json", published.library));
    let api = public_api::Builder::from_rustdoc_json(json)
        .omit_blanket_impls(true)
        .omit_auto_trait_impls(true)
        .build()
        .expect("documentation of this compiler");
    api.items().map(ToString::to_string).collect()
}

fn golden(package: &str) -> PathBuf {
    root()
        .join("tests/golden/api")
        .join(format!("{package}.txt"))
}

fn lines(text: &str) -> BTreeSet<String> {
    text.lines().map(str::to_owned).collect()
}

/// The path of an item without what is generic, for example `controller_core::motion::Limits::speed`.
fn path(item: &str) -> String {
    let mut depth = 0_u32;
    let plain: String = item
        .chars()
        .filter(|c| match c {
            '<' => {
                depth += 1;
                false
            }
            // Of a generic, not of the arrow before what is returned.
            '>' if depth > 0 => {
                depth -= 1;
                false
            }
            _ => depth == 0,
        })
        .collect();
    let word = match plain.strip_prefix("impl") {
        // Of an implementation, what it is for.
        Some(rest) => rest
            .rsplit(" for ")
            .next()
            .and_then(|rest| rest.split_whitespace().next()),
        None => plain.split_whitespace().find(|word| word.contains("::")),
    };
    let word = word.unwrap_or_default();
    let end = word.find(['(', '=', '{', ',']).unwrap_or(word.len());
    word[..end]
        .trim_end_matches(':')
        .trim_start_matches('&')
        .to_owned()
}

/// What breaks a program that was written for `before`.
fn breaking(before: &BTreeSet<String>, now: &BTreeSet<String>) -> Vec<String> {
    let gone = before.difference(now).map(|item| format!("- {item}"));
    let open = |kind: &str, parent: &str| {
        let heads = before.iter().filter(|item| path(item) == parent);
        heads
            .clone()
            .any(|item| item.starts_with(&format!("pub {kind}")))
    };
    let has_members = |parent: &str| {
        let inside = format!("pub {parent}::");
        before.iter().any(|item| item.starts_with(&inside))
    };
    let breaks = |item: &&String| {
        let path = path(item);
        let Some((parent, _)) = path.rsplit_once("::") else {
            return false;
        };
        let member = item.starts_with(&format!("pub {path}"));
        (member && has_members(parent) && (open("struct ", parent) || open(parent, parent)))
            || (member && open("enum ", parent))
            || open("trait ", parent)
    };
    let added = now
        .difference(before)
        .filter(breaks)
        .map(|item| format!("+ {item}"));
    gone.chain(added).collect()
}

/// Text under `## [Unreleased]`, `### package`, in the parts that tell of what is no longer as it was.
fn listed(changelog: &str, package: &str) -> String {
    let section = |text: &str, head: &str, level: &str| -> String {
        let from = text.split_once(head).map_or("", |(_, rest)| rest);
        let end = from.find(level).unwrap_or(from.len());
        from[..end].to_owned()
    };
    let unreleased = section(changelog, "\n## [Unreleased]\n", "\n## ");
    let package = section(&unreleased, &format!("\n### {package}\n"), "\n### ");
    let parts = ["Changed", "Removed"];
    parts
        .map(|part| section(&package, &format!("\n#### {part}\n"), "\n#### "))
        .concat()
}

/// Whether the name of an item stands in code quotes, alone or in a path.
fn is_marked(item: &str, listed: &str) -> bool {
    let path = path(item.get(2..).unwrap_or_default());
    let name = path.rsplit("::").next().unwrap_or_default();
    let quoted = listed.split('`').skip(1).step_by(2);
    let mut words = quoted.flat_map(|code| code.split(|c: char| !c.is_alphanumeric() && c != '_'));
    !name.is_empty() && words.any(|word| word == name)
}

#[test]
fn no_breaking_change_is_unmarked() {
    let changelog = fs::read_to_string(root().join("CHANGELOG.md")).expect("a changelog");
    for published in PUBLISHED {
        let (package, now) = (published.package, items(&published));
        assert!(
            now.len() > published.least,
            "{package}: {} items",
            now.len()
        );
        if std::env::var_os("UPDATE_API").is_some() {
            let text: String = now.iter().map(|item| format!("{item}\n")).collect();
            fs::write(golden(package), text).expect("written");
            continue;
        }
        let before = fs::read_to_string(golden(package)).expect("the last release's items");
        let listed = listed(&changelog, published.section);
        let breaking = breaking(&lines(&before), &now);
        let unmarked: Vec<_> = breaking
            .iter()
            .filter(|item| !is_marked(item, &listed))
            .collect();
        assert!(
            unmarked.is_empty(),
            "{package}: programs that use these break, and CHANGELOG.md does not name them under Changed or Removed:\n{unmarked:#?}"
        );
    }
}

/// A small crate's items, and what each change of it is taken for.
#[test]
fn what_breaks_a_program_is_found_and_what_does_not_is_not() {
    let before = "\
pub mod a
pub fn a::step<T: a::Scalar>(T) -> core::result::Result<T, a::Error>
pub struct a::Limits<T>
pub a::Limits::speed: T
pub struct a::Hidden
pub fn a::Hidden::new() -> Self
#[non_exhaustive] pub enum a::Error
pub a::Error::Late
pub enum a::Order<T>
pub a::Order::Park(a::Pose<T>)
pub a::Order::Drive
pub a::Order::Drive::twist: T
pub trait a::Wheels: a::ErrorType
pub fn a::Wheels::release(&mut self) -> core::result::Result<(), Self::Error>
impl core::fmt::Display for a::Error";
    for (change, expected) in [
        ("", 0),
        ("+pub fn a::new(u8)", 0),
        ("+pub a::Error::Early", 0),
        ("+pub fn a::Limits<T>::cast(&self)", 0),
        ("+pub a::Hidden::shown: u8", 0),
        ("+pub struct a::More\n+pub a::More::field: u8", 0),
        ("+impl core::error::Error for a::Error", 0),
        ("+pub a::Limits::jerk: T", 1),
        ("+pub a::Order::Stop", 1),
        ("+pub a::Order::Drive::hold: bool", 1),
        ("+pub fn a::Wheels::brake(&mut self)", 1),
        ("-impl core::fmt::Display for a::Error", 1),
        ("-pub a::Error::Late", 1),
        (
            "-pub fn a::step<T: a::Scalar>(T) -> core::result::Result<T, a::Error>\n+pub fn a::step<T: a::Scalar>(T, T) -> T",
            1,
        ),
    ] {
        let before = lines(before);
        let mut now = before.clone();
        for line in change.lines() {
            match line.split_at(1) {
                ("+", item) => assert!(now.insert(item.to_owned())),
                (_, item) => assert!(now.remove(item), "{item}"),
            }
        }
        let found = breaking(&before, &now);
        assert_eq!(found.len(), expected, "{change}: {found:?}");
    }
}

#[test]
fn a_mark_is_an_entry_of_this_package_in_this_release() {
    let changelog = "\
# Changelog

## [Unreleased]

### controller-core

#### Added

- `other` is new.

#### Changed

- `motion::Limits` has `jerk`; plain words like speed mark nothing.

### sim-host

#### Removed

- `gone`.

## [0.1.0]

### controller-core

#### Removed

- `old`.
";
    let listed = listed(changelog, "controller-core");
    for (item, marked) in [
        ("+ pub controller_core::motion::Limits::jerk: T", true),
        ("- pub struct controller_core::motion::Limits<T>", true),
        (
            "- impl<T: core::marker::Copy> core::clone::Clone for controller_core::motion::Limits<T>",
            true,
        ),
        ("- pub fn controller_core::motion::jerk<T>(T) -> T", true),
        ("- pub controller_core::motion::Limits::speed: T", false),
        ("- pub fn controller_core::other()", false),
        ("- pub fn controller_core::gone()", false),
        ("- pub fn controller_core::old()", false),
    ] {
        assert_eq!(is_marked(item, &listed), marked, "{item}");
    }
}
