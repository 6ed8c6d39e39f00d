//! Packages as the registry gets them: complete by themselves.

use super::root;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A package as it is published, unpacked; nothing is built. Cargo has nothing to warn of.
fn package(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages");
    let unpacked = folder.join("unpacked");
    let output = Command::new(env!("CARGO"))
        .args([
            "package",
            "--no-verify",
            "--offline",
            "--locked",
            "--allow-dirty",
        ])
        .args(["--package", name, "--target-dir"])
        .arg(&folder)
        .current_dir(root())
        .output()
        .expect("cargo runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && !told.contains("warning"),
        "{told}"
    );
    let archive = fs::read_dir(folder.join("package")).expect("packages");
    let named = |path: &PathBuf| {
        let file = path.file_name().expect("a name").to_string_lossy();
        let version = file.strip_prefix(&format!("{name}-")).map(str::to_owned);
        version.is_some_and(|rest| {
            rest.starts_with(|c: char| c.is_ascii_digit()) && rest.ends_with(".crate")
        })
    };
    let paths = archive.map(|entry| entry.expect("an entry").path());
    let newest = paths.filter(named).max_by_key(|path| {
        let about = path.metadata().expect("a file");
        about.modified().expect("a time")
    });
    let archive = newest.expect("the package");
    let inside = unpacked.join(archive.file_stem().expect("a name"));
    if inside.exists() {
        fs::remove_dir_all(&inside).expect("old ones go");
    }
    fs::create_dir_all(&unpacked).expect("a folder");
    let tar = Command::new("tar")
        .arg("-xzf")
        .arg(&archive)
        .arg("-C")
        .arg(&unpacked)
        .status();
    assert!(tar.expect("tar runs").success());
    inside
}

/// All files with their texts; those that are none are empty.
fn texts(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(texts(&path));
        } else {
            let text = fs::read_to_string(&path).unwrap_or_default();
            found.insert(path, text);
        }
    }
    found
}

/// Where the links of a Markdown text lead.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let ends = text.split("](").skip(1);
    ends.filter_map(|rest| rest.split([')', ' ', '#']).next())
}

const PUBLISHED: [&str; 1] = ["controller-core"];

#[test]
fn a_package_has_its_readme_and_licences_and_links_only_to_what_it_has() {
    for name in PUBLISHED {
        let folder = package(name);
        let licence = |file: &str| fs::read(folder.join(file)).expect("in the package");
        for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let own = fs::read(root().join(file)).expect("of the project");
            assert!(licence(file) == own, "{name}: {file}");
        }
        let mut followed = 0;
        for (path, text) in texts(&folder) {
            let is_markdown = path.extension().is_some_and(|extension| extension == "md");
            let comments = |line: &&str| is_markdown || line.trim_start().starts_with("//");
            for line in text.lines().filter(comments) {
                for link in links(line) {
                    // Names of items are checked by rustdoc.
                    let leads_out = link.starts_with("https://") || !link.contains(['/', '.']);
                    let there = path.parent().expect("a folder").join(link).exists();
                    assert!(
                        leads_out || (is_markdown && there),
                        "{}: {link}",
                        path.display()
                    );
                    followed += usize::from(there);
                }
            }
        }
        assert!(followed >= 3, "{name}: README, licences: {followed}");
        assert!(
            folder
                .join("README.md")
                .metadata()
                .is_ok_and(|about| about.len() > 500)
        );
    }
}

/// What a registry shows and what its documentation is built for.
#[test]
fn manifests_have_what_a_registry_asks_for() {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--no-deps",
            "--offline",
            "--locked",
            "--format-version",
            "1",
        ])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    let mut published = Vec::new();
    for package in packages {
        let name = package["name"].as_str().expect("a name");
        // Null: to any registry; an empty list: to none.
        if package["publish"].as_array().is_some_and(Vec::is_empty) {
            continue;
        }
        published.push(name);
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        assert!((20..=160).contains(&text("description").len()), "{name}");
        assert_eq!(text("license"), "MIT OR Apache-2.0", "{name}");
        assert_eq!(text("readme"), "README.md", "{name}");
        assert_eq!(text("documentation"), format!("https://docs.rs/{name}"));
        let words = |key: &str| -> Vec<String> {
            let list = package[key].as_array().expect("a list").iter();
            list.map(|word| word.as_str().expect("a word").to_owned())
                .collect()
        };
        let keywords = words("keywords");
        // The registry's rules.
        assert!((1..=5).contains(&keywords.len()), "{name}: {keywords:?}");
        assert!(
            keywords.iter().all(|word| word.len() <= 20),
            "{name}: {keywords:?}"
        );
        assert!((1..=5).contains(&words("categories").len()), "{name}");
        let docs = &package["metadata"]["docs"]["rs"];
        assert_eq!(docs["default-target"], "thumbv7em-none-eabihf", "{name}");
        // What the tests build it with, and no more.
        assert_eq!(text("rust_version"), "1.88", "{name}");
        let run = fs::read_to_string(root().join("tests/run")).expect("the tests' script");
        assert!(run.contains("msrv=1.88.0\n"), "{name}");
        let readme = fs::read_to_string(root().join(name).join("README.md")).expect("a README");
        assert!(readme.contains("Minimum Rust version: 1.88;"), "{name}");
    }
    published.sort_unstable();
    assert_eq!(published, PUBLISHED);
}
