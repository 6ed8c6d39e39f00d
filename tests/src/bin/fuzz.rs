//! Rubbish into everything that takes something from outside, for as long as one likes; `tests::fuzz` says what.
//!
//! `cargo run --profile test -p tests --bin fuzz -- [--minutes 10] [--target NAME] [--seed N] [--corpus tests/corpus]`: all targets in turn,
//! for so many minutes each. Inputs that met something new go to the folder `out/fuzz/NAME`, one that failed beside it, and its path
//! is printed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use tests::fuzz::{TARGETS, Target, fuzz, inputs};

fn option(name: &str) -> Option<String> {
    let mut arguments = std::env::args().skip_while(|argument| argument != name);
    arguments.nth(1)
}

fn run(target: &Target, minutes: f64, seed: u64, corpus: &Path) -> std::io::Result<bool> {
    let started = Instant::now();
    let most = Duration::from_secs_f64(60.0 * minutes);
    let more = inputs(&corpus.join(target.name))?;
    let outcome = fuzz(target, seed, more, |_| started.elapsed() < most);
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "{}: {} inputs in {seconds:.0} s, {} things met, {} inputs kept",
        target.name,
        outcome.tried,
        outcome.met,
        outcome.kept.len()
    );
    let folder = Path::new("out/fuzz").join(target.name);
    fs::create_dir_all(&folder)?;
    for (number, input) in outcome.kept.iter().enumerate() {
        fs::write(folder.join(format!("{number:05}")), input)?;
    }
    if let Some((input, message)) = outcome.failed {
        let path = folder.join("failed");
        fs::write(&path, input)?;
        println!(
            "{}: {message}; the input is {}",
            target.name,
            path.display()
        );
        return Ok(false);
    }
    Ok(true)
}

fn main() -> ExitCode {
    let number =
        |name: &str, default: f64| option(name).map_or(Some(default), |text| text.parse().ok());
    let (Some(minutes), Some(seed)) = (number("--minutes", 10.0), number("--seed", 1.0)) else {
        eprintln!("--minutes and --seed take a number");
        return ExitCode::from(2);
    };
    let corpus = PathBuf::from(option("--corpus").unwrap_or_else(|| "tests/corpus".to_owned()));
    let only = option("--target");
    let mut whole = true;
    for target in &TARGETS {
        if only.as_ref().is_none_or(|name| name == target.name) {
            match run(target, minutes, seed as u64, &corpus) {
                Ok(passed) => whole &= passed,
                Err(error) => {
                    eprintln!("{error}");
                    return ExitCode::FAILURE;
                }
            }
        }
    }
    if whole {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
