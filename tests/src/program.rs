//! Programs for chips that tests write and build.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

/// Writes all of a package but its sources into a folder, with dependencies of these lines: those of the workspace as
/// `name.workspace = true`.
///
/// The package is the root of a workspace that has the same crates at the same places, by links: so cargo takes them for the same
/// and builds them once for these programs and the images of `firmware-demo`. Otherwise each would be built twice for every target
/// and opt level.
pub fn package(folder: &Path, name: &str, dependencies: &str) {
    let root = crate::root();
    let read = |file: &str| fs::read_to_string(root.join(file)).expect("a file of the workspace");
    fs::create_dir_all(folder.join("src")).expect("a folder can be made");
    let workspace = read("Cargo.toml");
    let (members, others): (Vec<&str>, Vec<&str>) = workspace
        .lines()
        .partition(|line| line.starts_with("members = ") || line.starts_with("default-members = "));
    for member in members[0].split('"').skip(1).step_by(2) {
        let top = member.split('/').next().expect("a folder");
        let (link, there) = (folder.join(top), root.join(top));
        // Another checkout may have the same target folder.
        if fs::read_link(&link).is_ok_and(|path| path == there) {
            continue;
        }
        let _ = fs::remove_file(&link);
        symlink(&there, &link).expect("a link can be made");
    }
    let manifest = format!(
        "[package]\nname = \"{name}\"\nversion = \"0.0.0\"\nedition = \"2024\"\nautotests = false\n\
         [dependencies]\n{dependencies}\n{}\n",
        others.join("\n")
    );
    fs::write(folder.join("Cargo.toml"), manifest).expect("a file can be written");
    // The same versions, and no question to the registry.
    fs::write(folder.join("Cargo.lock"), read("Cargo.lock")).expect("a file can be written");
}
