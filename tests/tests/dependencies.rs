//! What depends on what.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The packages that a package is built of, as `cargo tree` has them; `arguments` choose its features.
fn built_of(package: &str, arguments: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--edges", "normal"])
        .args([
            "--prefix",
            "none",
            "--format",
            "{lib}",
            "--package",
            package,
        ])
        .args(arguments)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("names");
    text.lines().map(|line| line.trim().to_owned()).collect()
}

/// The last three are what `heapless` is made of.
#[test]
fn the_core_needs_numbers_and_queues_only() {
    let own = ["controller_core", "heapless", "libm", "micromath"];
    let below = ["byteorder", "hash32", "stable_deref_trait"];
    let expected: BTreeSet<_> = own.into_iter().chain(below).map(str::to_owned).collect();
    assert_eq!(built_of("controller-core", &[]), expected);
}

/// Other front ends take the simulator without command line, figures and progress bars.
#[test]
fn the_simulator_is_a_library_without_its_command_line() {
    let cli = ["clap", "indicatif", "mcap", "tiny_skia", "ttf_parser"];
    let whole = built_of("sim-host", &[]);
    let library = built_of("sim-host", &["--no-default-features"]);
    for name in cli {
        assert!(whole.contains(name), "{name}");
        assert!(!library.contains(name), "{name}");
    }
    assert!(library.contains("controller_core"));
    // The wheel has figures, and nothing of the command line.
    let wheel = built_of("pyapi", &[]);
    assert!(wheel.contains("tiny_skia") && !wheel.contains("clap") && !wheel.contains("indicatif"));
}
