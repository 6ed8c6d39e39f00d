//! Packages as the registry gets them: complete by themselves.

use super::root;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The packages as they are published, unpacked; nothing is built. Cargo has nothing to warn of.
fn packages() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages");
    // No older ones.
    let _ = fs::remove_dir_all(&folder);
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args([
        "package",
        "--no-verify",
        "--offline",
        "--locked",
        "--allow-dirty",
    ]);
    for name in PUBLISHED {
        cargo.args(["--package", name]);
    }
    let output = cargo
        .arg("--target-dir")
        .arg(&folder)
        .current_dir(root())
        .output();
    let output = output.expect("cargo runs");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && !message.contains("warning"),
        "{message}"
    );
    let unpack = |name: &str| {
        let stem = format!("{name}-{}", version());
        let archive = folder.join("package").join(format!("{stem}.crate"));
        let tar = Command::new("tar")
            .arg("-xzf")
            .arg(&archive)
            .arg("-C")
            .arg(&folder)
            .status();
        assert!(tar.expect("tar runs").success());
        folder.join(stem)
    };
    PUBLISHED.map(unpack).to_vec()
}

/// Of the project.
fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
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

const PUBLISHED: [&str; 2] = ["controller-core", "controller-core-protocol"];

#[test]
fn a_package_has_its_readme_and_licences_and_links_only_to_what_it_has() {
    for (name, folder) in PUBLISHED.into_iter().zip(packages()) {
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
        assert!(followed >= 2, "{name}: both licences: {followed}");
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
        let manifest = Path::new(package["manifest_path"].as_str().expect("a path"));
        let folder = manifest.parent().expect("a folder");
        let readme = fs::read_to_string(folder.join("README.md")).expect("a README");
        assert!(readme.contains("Minimum Rust version: 1.88;"), "{name}");
    }
    published.sort_unstable();
    assert_eq!(published, PUBLISHED);
}

/// A copy of what a release writes, with the script that writes it.
fn copy_for_release() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("release");
    let _ = fs::remove_dir_all(&folder);
    for file in [
        "Cargo.toml",
        "CHANGELOG.md",
        "controller-core/Cargo.toml",
        "protocol/Cargo.toml",
        "bindings/c/package/library.json",
        "bindings/c/package/library.properties",
        "release/run",
    ] {
        let copy = folder.join(file);
        fs::create_dir_all(copy.parent().expect("a folder")).expect("a folder");
        fs::copy(root().join(file), copy).expect("a copy");
    }
    folder
}

/// `release/run text`, which is all that a release changes but for what Cargo writes; what it says if it refuses.
fn release(folder: &Path, arguments: &[&str]) -> Result<(), String> {
    let script = Command::new("sh")
        .arg("release/run")
        .arg("text")
        .args(arguments)
        .current_dir(folder)
        .output();
    let output = script.expect("a shell");
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stderr).into_owned()),
    }
}

#[test]
fn a_release_writes_its_version_everywhere_and_refuses_one_that_misleads() {
    let folder = copy_for_release();
    let read = |file: &str| fs::read_to_string(folder.join(file)).expect("a file");
    let write = |text: &str| fs::write(folder.join("CHANGELOG.md"), text).expect("written");
    let before = read("CHANGELOG.md");
    let refuses = |arguments: &[&str], why: &str| {
        let message = release(&folder, arguments).expect_err("refused");
        assert!(message.contains(why), "{message}");
    };
    // As if nothing had been released yet, whatever has been since.
    let (head, _) = before.split_once("## [Unreleased]\n").expect("a heading");
    let entry = "\n### controller-core\n\n#### Added\n\n- `wrap`.\n";
    write(&format!("{head}## [Unreleased]\n{entry}"));
    for (arguments, why) in [
        (&["1.0"][..], "three numbers"),
        (&["01.0.0"], "three numbers"),
        (&["0.2.0", "git@host:project"], "begins with https://"),
    ] {
        refuses(arguments, why);
    }
    assert_eq!(
        read("Cargo.toml"),
        fs::read_to_string(root().join("Cargo.toml")).expect("a file")
    );
    release(
        &folder,
        &["0.2.0", "https://example.org/project", "2030-01-02"],
    )
    .expect("released");
    for (file, text) in [
        ("Cargo.toml", "[workspace.package]\nversion = \"0.2.0\"\n"),
        (
            "Cargo.toml",
            "controller-core = { path = \"controller-core\", version = \"0.2.0\" }",
        ),
        (
            "Cargo.toml",
            "protocol = { path = \"protocol\", version = \"0.2.0\", package",
        ),
        ("bindings/c/package/library.json", "\"version\": \"0.2.0\""),
        ("bindings/c/package/library.properties", "\nversion=0.2.0\n"),
        (
            "controller-core/Cargo.toml",
            "\nrepository = \"https://example.org/project\"\n",
        ),
        (
            "protocol/Cargo.toml",
            "\nrepository = \"https://example.org/project\"\n",
        ),
        (
            "CHANGELOG.md",
            "## [Unreleased]\n\n## [0.2.0] - 2030-01-02\n\n### controller-core\n",
        ),
    ] {
        assert!(read(file).contains(text), "{file}:\n{}", read(file));
    }
    // Other versions stay: those of dependencies.
    let others = |text: &str| {
        text.lines()
            .filter(|line| !line.contains("0.2.0"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let old = fs::read_to_string(root().join("Cargo.toml")).expect("a file");
    let same = old.lines().filter(|line| {
        others(&read("Cargo.toml"))
            .iter()
            .any(|other| other == line)
    });
    assert_eq!(same.count(), others(&read("Cargo.toml")).len());

    refuses(&["0.3.0"], "nothing under [Unreleased]");
    let after = read("CHANGELOG.md");
    let fixed = "## [Unreleased]\n\n### controller-core\n\n#### Fixed\n\n- A sign.\n";
    write(&after.replace("## [Unreleased]\n", fixed));
    refuses(&["0.2.0"], "does not come after 0.2.0");
    refuses(&["0.1.9"], "does not come after 0.2.0");
    let changed = fixed.replace("Fixed", "Changed");
    write(&after.replace("## [Unreleased]\n", &changed));
    refuses(&["0.2.1"], "changes that break users of 0.2.0");
    release(&folder, &["0.10.0"]).expect("released");
    // What only the simulator changes breaks no user of a package.
    let after = read("CHANGELOG.md");
    write(&after.replace(
        "## [Unreleased]\n",
        &changed.replace("controller-core", "sim-host"),
    ));
    release(&folder, &["0.10.1"]).expect("released");
    let headings = read("CHANGELOG.md");
    let order: Vec<_> = headings
        .lines()
        .filter(|line| line.starts_with("## ["))
        .collect();
    assert!(
        order[0] == "## [Unreleased]" && order[1].starts_with("## [0.10.1] - 2"),
        "{order:?}"
    );
}

/// One version, wherever it stands.
#[test]
fn packages_for_other_ecosystems_have_the_same_version() {
    let version = version();
    for (file, text) in [
        (
            "bindings/c/package/library.json",
            format!("\"version\": \"{version}\""),
        ),
        (
            "bindings/c/package/library.properties",
            format!("\nversion={version}\n"),
        ),
    ] {
        let read = fs::read_to_string(root().join(file)).expect("a file");
        assert!(read.contains(&text), "{file}: {text}");
    }
}
