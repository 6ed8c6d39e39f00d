//! Every equation of the paper is found in the docs, in the code and in a test; what the docs name exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Number of the paper's last equation.
const LAST: u32 = 27;

/// A path from the root of the workspace.
fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A text that has to be there.
fn read(path: &str) -> String {
    fs::read_to_string(root(path)).unwrap_or_else(|error| panic!("{path} is needed: {error}"))
}

/// All Rust sources under a folder, by their path from the root, but for this file.
fn sources(folder: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let entries = fs::read_dir(root(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    for entry in entries {
        let name = entry.expect("a folder can be listed").file_name();
        let path = format!("{folder}/{}", name.to_string_lossy());
        if root(&path).is_dir() {
            found.extend(sources(&path));
        } else if path.ends_with(".rs") && !path.ends_with("/traceability.rs") {
            let text = read(&path);
            found.push((path, text));
        }
    }
    found
}

/// The comments of a source, in one line each block.
fn comments(source: &str) -> String {
    let text = source
        .lines()
        .filter_map(|line| line.trim().strip_prefix("//"));
    let text = text.map(|line| line.trim_start_matches(['/', '!']).trim());
    text.collect::<Vec<_>>().join(" ")
}

/// Takes one of `openings` and the number and parenthesis after it from the start of `text`.
fn numbered<'a>(text: &'a str, openings: &[&str]) -> Option<(u32, &'a str)> {
    openings.iter().find_map(|opening| {
        let rest = text.strip_prefix(opening)?;
        let (number, rest) = rest.split_once(')')?;
        Some((number.parse().ok()?, rest))
    })
}

/// The equations that a text names: `Eq. (4)`, `Eqs. (4) and (5)`, `Eqs. (10)-(14)`, `Eq. (1) to Eq. (9)`.
fn equations(text: &str) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    for (at, _) in text.match_indices("Eq") {
        let Some((mut number, mut rest)) = numbered(&text[at..], &["Eq. (", "Eqs. ("]) else {
            continue;
        };
        found.insert(number);
        loop {
            let range = ["-(", "–(", " to (", " to Eq. (", "-Eq. ("];
            let list = [", (", " and (", ", and (", " or (", ", Eq. (", " and Eq. ("];
            if let Some((last, after)) = numbered(rest, &range) {
                found.extend(number..=last);
                (number, rest) = (last, after);
            } else if let Some((next, after)) = numbered(rest, &list) {
                found.insert(next);
                (number, rest) = (next, after);
            } else {
                break;
            }
        }
    }
    found
}

/// Panics with the numbers that `found` lacks.
fn assert_complete(place: &str, found: &BTreeSet<u32>) {
    let missing: Vec<u32> = (1..=LAST)
        .filter(|number| !found.contains(number))
        .collect();
    assert!(missing.is_empty(), "{place} does not name Eq. {missing:?}");
    let beyond: Vec<&u32> = found
        .iter()
        .filter(|number| **number == 0 || **number > LAST)
        .collect();
    assert!(
        beyond.is_empty(),
        "{place} names {beyond:?}, which the paper does not have"
    );
}

/// The reader of numbers knows the forms in use.
#[test]
fn lists_and_ranges_of_equations_are_read() {
    let text = "Eq. (3); Eqs. (4) and (5), Eqs. (10)-(12), (14). Eq. (20) to Eq. (22). Eq. 9, eq. (8), (7)";
    let expected = [3, 4, 5, 10, 11, 12, 14, 20, 21, 22];
    assert_eq!(equations(text), BTreeSet::from(expected));
}

#[test]
fn every_equation_is_in_the_derivation() {
    assert_complete(
        "docs/derivation.md",
        &equations(&read("docs/derivation.md")),
    );
}

#[test]
fn every_equation_is_in_the_code() {
    let sources = sources("controller-core/src");
    let found = sources
        .iter()
        .flat_map(|(_, text)| equations(&comments(text)));
    assert_complete("controller-core/src", &found.collect());
}

#[test]
fn every_equation_is_in_a_test() {
    let sources = sources("tests/tests");
    let found = sources
        .iter()
        .flat_map(|(_, text)| equations(&comments(text)));
    assert_complete("tests/tests", &found.collect());
}

/// Pages that name tests and items.
const DOCS: [&str; 3] = ["docs/errata.md", "docs/derivation.md", "docs/tuning.md"];

/// What stands between backticks and has `::` in it.
fn paths(text: &str) -> impl Iterator<Item = &str> {
    let quoted = text.split('`').skip(1).step_by(2);
    quoted.filter(|name| name.contains("::") && !name.contains([' ', '\n', '<', '(']))
}

/// Tests are named `file.rs::test` in the docs.
#[test]
fn every_test_that_the_docs_name_exists() {
    let mut named = 0;
    for doc in DOCS {
        let text = read(doc);
        for (file, test) in paths(&text).filter_map(|name| name.split_once(".rs::")) {
            let source = read(&format!("tests/tests/{file}.rs"));
            assert!(
                source.contains(&format!("fn {test}(")),
                "{doc}: no {file}.rs::{test}"
            );
            named += 1;
        }
    }
    assert!(named > 0, "docs/errata.md shows its claims by tests");
}

/// Items are named `module::item` or `module::Type::item` in the docs.
#[test]
fn every_item_that_the_docs_name_exists() {
    let modules = sources("controller-core/src");
    for doc in DOCS {
        let text = read(doc);
        for name in paths(&text).filter(|name| !name.contains(".rs::") && *name != "file::test") {
            let (module, items) = name.split_once("::").expect("it has one");
            // A type may be named without its module.
            let is_type = module.starts_with(char::is_uppercase);
            let within = |path: &str| {
                let inside = path.trim_start_matches("controller-core/src/");
                inside
                    .trim_end_matches(".rs")
                    .split('/')
                    .any(|part| is_type || part == module)
            };
            let known = |item: &str| {
                let word = |text: &str| {
                    text.split(|c: char| !c.is_alphanumeric() && c != '_')
                        .any(|w| w == item)
                };
                modules
                    .iter()
                    .any(|(path, text)| within(path) && word(text))
            };
            let known = items.split("::").all(known);
            assert!(
                known || name == "module::function",
                "{doc}: no {name} in controller-core"
            );
        }
    }
}

/// A row of figures in `README.md` and in what it hands on to is read by a test, which knows it by its first cell.
#[test]
fn every_row_of_figures_is_read_by_a_test() {
    /// Formats, equations, and prose whose figures are read by phrases.
    const PROSE: [&str; 4] = [
        "Trajectory files",
        "Two laws",
        "Equations and modules",
        "Map",
    ];
    let sources: Vec<String> = ["tests/tests", "sim-host/tests", "sim-host/src/scenario"]
        .iter()
        .flat_map(|folder| sources(folder))
        .map(|(_, text)| text)
        .collect();
    let mut rows = 0;
    for page in [
        "README.md",
        "docs/paper.md",
        "docs/trajectories.md",
        "docs/chip.md",
    ] {
        let text = read(page);
        let mut heading = "";
        for (line, next) in text.lines().zip(text.lines().skip(1)) {
            heading = line
                .strip_prefix("## ")
                .or(line.strip_prefix("# "))
                .unwrap_or(heading);
            let Some((label, figures)) =
                line.strip_prefix("| ").and_then(|row| row.split_once(" |"))
            else {
                continue;
            };
            let is_head = next.starts_with("| ---") || line.starts_with("| ---");
            let has_figures = figures.contains(|c: char| c.is_ascii_digit());
            if is_head || !has_figures || (PROSE.contains(&heading) && !label.starts_with('`')) {
                continue;
            }
            rows += 1;
            let quoted = format!("\"{}\"", label.trim_matches('`'));
            assert!(
                sources.iter().any(|text| text.contains(&quoted)),
                "{page}: no test reads the row \"{label}\""
            );
        }
    }
    assert!(rows > 20, "{rows}");
}

/// The README is read in a few minutes: what is longer has a page of its own.
#[test]
fn the_readme_is_short() {
    let lines = read("README.md").lines().count();
    assert!(lines <= 150, "{lines}");
}

/// Paths that the map of the code names are there, and so are all pages that README and pages link to.
#[test]
fn what_the_documents_point_to_exists() {
    let architecture = read("docs/architecture.md");
    let quoted = architecture.split('`').skip(1).step_by(2);
    let mut named = 0;
    for path in quoted.filter(|name| name.contains('/') && !name.contains(['*', ' '])) {
        assert!(root(path).exists(), "docs/architecture.md: no {path}");
        named += 1;
    }
    assert!(named > 20, "{named}");
    let docs = fs::read_dir(root("docs")).expect("docs");
    let pages = docs.map(|entry| entry.expect("an entry").path());
    let tops = ["README.md", "CONTRIBUTING.md"].map(root);
    for page in pages.chain(tops) {
        if page.extension().is_none_or(|kind| kind != "md") {
            continue;
        }
        let text = fs::read_to_string(&page).expect("a page");
        let folder = page.parent().expect("it is in a folder");
        for link in text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let file = link.split('#').next().unwrap_or(link);
            let is_local = !file.is_empty() && !file.contains("://");
            assert!(
                !is_local || folder.join(file).exists(),
                "{}: no {link}",
                page.display()
            );
        }
    }
}
