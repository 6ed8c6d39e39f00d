//! No public function of the core can panic: each is linked by itself into an image in which a panic that can be reached does not link.
//!
//! With every back end, both number types, every neuron update. What tests have the time for is opt level `s`; `sh tests/panic-free`
//! does levels 3, s and z, and the images of the real boards.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

#[path = "../src/budget_image.rs"]
#[allow(dead_code)]
mod budget_image;
#[path = "../src/panic_link.rs"]
mod panic_link;

use budget_image::BOARDS;

/// The program, without its frame.
const PROGRAM: &str = include_str!("../src/public_functions.rs");
/// Another one, for the ends of queues, which have no constructor to call them by.
const HANDLES: &str = include_str!("../src/queue_handles.rs");

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the core") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// A public function that is not in the program fails this test by its name.
#[test]
fn every_public_function_is_in_the_program() {
    let mut files = Vec::new();
    let core = Path::new(env!("CARGO_MANIFEST_DIR")).join("../controller-core/src");
    sources(&core, &mut files);
    let mut names = BTreeSet::new();
    for file in files {
        let text = fs::read_to_string(&file).expect("a source of the core");
        for line in text.lines() {
            let line = line.trim_start();
            let rest = line
                .strip_prefix("pub fn ")
                .or_else(|| line.strip_prefix("pub const fn "));
            if let Some(rest) = rest {
                let end = rest.find(['(', '<']).expect("a function has arguments");
                names.insert(rest[..end].to_owned());
            }
        }
    }
    let programs = format!("{PROGRAM}{HANDLES}");
    let missing: Vec<_> = names
        .iter()
        .filter(|name| {
            !programs
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == *name)
        })
        .collect();
    assert!(names.len() > 150, "{}", names.len());
    assert!(missing.is_empty(), "not linked: {missing:?}");
}

/// Opt levels, from the environment if it says so.
fn levels() -> Vec<String> {
    let levels = std::env::var("PANIC_FREE_LEVELS").unwrap_or_else(|_| "s".to_owned());
    levels.split_whitespace().map(str::to_owned).collect()
}

#[test]
fn no_public_function_can_panic() {
    for board in BOARDS {
        for level in levels() {
            let (links, words) = panic_link::link(board, &level, PROGRAM, &["-Awarnings"]);
            assert!(links, "{} at {level}: {words}", board.name);
            println!("{} at {level}: no panic in any public function", board.name);
        }
    }
}
