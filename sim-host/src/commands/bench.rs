//! `bench`.

use super::error::CommandError;
use super::write::Writer;
use super::{robustness, say};
use crate::bench_args::BenchArgs;
use crate::cli::Output;
use indicatif::ProgressBar;
use sim_host::bench::{Class, Settings, TrackFile, FILES, Tuned, console, evaluations, tune, markdown, runs, study, summaries, write_csv};
use sim_host::scenario::{BASES, BuiltInBase};
use std::fs;

const NAME: &str = "bench";
/// Runs of `--quick`.
const QUICK: usize = 6;

pub fn bench(arguments: &BenchArgs, output: &Output) -> Result<(), CommandError> {
    let work = || compare(arguments, output);
    match arguments.threads {
        None => work(),
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build();
            pool.map_err(|error| CommandError::Threads(error.to_string()))?.install(work)
        }
    }
}

fn compare(arguments: &BenchArgs, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let mut owned = Vec::new();
    for path in &arguments.file {
        let bytes = fs::read(path).map_err(|cause| CommandError::Read { path: path.clone(), cause })?;
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        owned.push((name, bytes));
    }
    let more = owned.iter().map(|(name, bytes)| TrackFile { name, bytes });
    let seed = arguments.seed.draw()?;
    let settings = Settings {
        bases: bases(&arguments.bases)?,
        classes: classes(&arguments.only)?,
        files: FILES.iter().copied().chain(more).collect(),
        runs: if arguments.quick { QUICK } else { arguments.runs.get() },
        seed,
    };
    let tuned = if arguments.tune {
        let bar = ProgressBar::new(evaluations(settings.bases.len())).with_style(robustness::style());
        let tuned = tune(&settings.bases, FILES, || bar.inc(1));
        bar.finish_and_clear();
        let tuned = tuned?;
        writer.bytes("tuned.csv", tuned.csv().as_bytes())?;
        tuned
    } else {
        Tuned::built_in()
    };
    let bar = ProgressBar::new(runs(&settings)? as u64).with_style(robustness::style());
    let all = study(&settings, &tuned, || bar.inc(1));
    bar.finish_and_clear();
    let all = all?;
    let names: Vec<String> = settings.bases.iter().map(|(name, _)| name.clone()).collect();
    let rows = summaries(&all);
    say(&format!("{}: seed {seed}, {} runs of each class\n", names.join(" · "), settings.runs))?;
    for class in &settings.classes {
        say(&format!("{}\n", console(&rows, *class)))?;
    }
    writer.rows(NAME, |out| write_csv(&names, &all, out))?;
    writer.bytes(&format!("{NAME}.md"), markdown(&rows).as_bytes())?;
    say(&format!("results are in {}\n", output.out.display()))
}

/// The bases of these names; all built-in ones without a name.
fn bases(names: &[String]) -> Result<Vec<(String, sim_host::mission::BaseSpec)>, CommandError> {
    let chosen: Vec<&BuiltInBase> = if names.is_empty() {
        BASES.iter().collect()
    } else {
        let find = |name: &String| {
            BuiltInBase::find(name).ok_or_else(|| CommandError::NoLeastTimes(name.clone()))
        };
        names.iter().map(find).collect::<Result<_, _>>()?
    };
    chosen
        .into_iter()
        .map(|built_in| Ok((built_in.name.to_owned(), built_in.base()?)))
        .collect()
}

/// The classes whose names contain one of the words; all without a word.
fn classes(only: &[String]) -> Result<Vec<Class>, CommandError> {
    let mut classes = Class::all();
    if let Some(word) = only
        .iter()
        .find(|word| !classes.iter().any(|class| class.name().contains(word.as_str())))
    {
        return Err(CommandError::NoClass {
            word: word.clone(),
            names: classes.into_iter().map(Class::name).collect(),
        });
    }
    if !only.is_empty() {
        classes.retain(|class| only.iter().any(|word| class.name().contains(word.as_str())));
    }
    Ok(classes)
}
