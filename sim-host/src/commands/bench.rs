//! `bench`.

use super::error::CommandError;
use super::write::Writer;
use super::{part, say};
use crate::bench_args::BenchArgs;
use crate::cli::Output;
use indicatif::ProgressBar;
use sim_host::bench::{
    ARRIVED, Class, DRIVEN, FILES, LawKind, Settings, Track, TrackFile, Tuned, console,
    evaluations, html, markdown, runs, study, summaries, tune, verdict, write_csv,
};
use sim_host::figure::pareto;
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
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads.get())
                .build();
            pool.map_err(|error| CommandError::Threads(error.to_string()))?
                .install(work)
        }
    }
}

fn compare(arguments: &BenchArgs, output: &Output) -> Result<(), CommandError> {
    let writer = Writer::new(output)?;
    let classes = classes(&arguments.only)?;
    if let Some(path) = arguments.file.first()
        && !classes.iter().any(|class| class.track == Track::Files)
    {
        return Err(CommandError::FileOfNoClass(path.clone()));
    }
    let mut owned = Vec::new();
    for path in &arguments.file {
        let bytes = fs::read(path).map_err(|cause| CommandError::Read {
            path: path.clone(),
            cause,
        })?;
        let name = path
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        owned.push((name, bytes));
    }
    let more = owned.iter().map(|(name, bytes)| TrackFile { name, bytes });
    let seed = arguments.seed.draw()?;
    let settings = Settings {
        bases: bases(&arguments.bases)?,
        classes,
        files: FILES.iter().copied().chain(more).collect(),
        runs: if arguments.quick {
            QUICK
        } else {
            arguments.runs.get()
        },
        seed,
        laws: laws(&arguments.law)?,
    };
    let tuned = if arguments.tune {
        let bar = ProgressBar::new(evaluations(settings.bases.len())).with_style(part::style());
        let tuned = tune(&settings.bases, FILES, || bar.inc(1));
        bar.finish_and_clear();
        let tuned = tuned?;
        writer.bytes("tuned.csv", tuned.csv().as_bytes())?;
        tuned
    } else {
        Tuned::built_in()
    };
    let bar = ProgressBar::new(runs(&settings)? as u64).with_style(part::style());
    let all = study(&settings, &tuned, || bar.inc(1));
    bar.finish_and_clear();
    let all = all?;
    let names: Vec<String> = settings
        .bases
        .iter()
        .map(|(name, _)| name.clone())
        .collect();
    let rows = summaries(&all);
    let about = about(&settings, &names);
    say(&format!("{about}\n"))?;
    let mut figures = Vec::new();
    for class in &settings.classes {
        say(&format!(
            "{}\n{}\n",
            console(&rows, *class),
            verdict(&rows, *class, &names)
        ))?;
        let figure = pareto(&rows, *class, &names)?;
        let file = format!(
            "{NAME}-{}",
            class.name().replace(", ", "-").replace(' ', "-")
        );
        writer.drawing(&file, &figure)?;
        figures.push(figure.svg());
    }
    say(
        "figures of bases side by side, medians of runs; !: better than the default law; front: * on the Pareto front of time and exactness\n",
    )?;
    writer.rows(NAME, |out| write_csv(&names, &all, out))?;
    writer.bytes(&format!("{NAME}.md"), markdown(&rows).as_bytes())?;
    writer.bytes(
        &format!("{NAME}.html"),
        html(&rows, &names, &about, &figures).as_bytes(),
    )?;
    say(&format!("results are in {}\n", output.out.display()))
}

/// What was run.
fn about(settings: &Settings<'_>, names: &[String]) -> String {
    let files: Vec<&str> = settings.files.iter().map(|file| file.name).collect();
    format!(
        "bases   {}\nseed    {}\nruns    {} of each class and base; one of a course on the ideal plant, but for parking\n\
         files   {}\narrived within {:.0} mm and {:.0} mrad for good, truly; velocity orders: within {:.0} % of the limits",
        names.join(" · "),
        settings.seed,
        settings.runs,
        files.join(", "),
        1.0e3 * ARRIVED.0,
        1.0e3 * ARRIVED.1,
        1.0e2 * DRIVEN,
    )
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

/// The laws whose names contain one of the words; all without a word.
fn laws(only: &[String]) -> Result<Vec<LawKind>, CommandError> {
    let all = LawKind::all();
    let has =
        |law: &LawKind, word: &String| law.name().to_lowercase().contains(&word.to_lowercase());
    if let Some(word) = only
        .iter()
        .find(|word| !all.iter().any(|law| has(law, word)))
    {
        return Err(CommandError::NoLaw {
            word: word.clone(),
            names: all.into_iter().map(LawKind::name).collect(),
        });
    }
    let chosen = all
        .into_iter()
        .filter(|law| only.iter().any(|word| has(law, word)));
    Ok(chosen.collect())
}

/// The classes whose names contain one of the words; all without a word.
fn classes(only: &[String]) -> Result<Vec<Class>, CommandError> {
    let mut classes = Class::all();
    if let Some(word) = only.iter().find(|word| {
        !classes
            .iter()
            .any(|class| class.name().contains(word.as_str()))
    }) {
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
