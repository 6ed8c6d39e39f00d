//! The benchmark: fair to the rivals, the same on any number of threads, and as its page states it.

use sim_host::bench::{
    ALLOWED_S, Class, HEADER, LawKind, Plant, Row, Run, Settings, Summary, Track, Tuned, better,
    html, instructions, markdown, minimum::Pool, study, summaries, write_csv,
};
use sim_host::figure::pareto;
use sim_host::scenario::BASES;
use std::error::Error;
use std::process::Command;
use std::sync::OnceLock;
use tests::stated::{At, Stated};

/// Starts of parking.
const RUNS: usize = 8;
/// The laws of the small set: MPC costs more than all others together, and Samson's never arrives in time.
const LAWS: [LawKind; 8] = [
    LawKind::TurnDriveTurn,
    LawKind::Ramsete,
    LawKind::Ltv,
    LawKind::Graceful,
    LawKind::GracefulOnTheWay,
    LawKind::PurePursuit,
    LawKind::Aicardi,
    LawKind::TwoPids,
];
/// In the order of the page.
const NAMES: [&str; 3] = ["paper-30kg", "lab-10kg", "hobby-1kg"];

fn class(track: Track, plant: Plant) -> Class {
    Class { track, plant }
}

fn settings(
    classes: &[Class],
    runs: usize,
    laws: &[LawKind],
) -> Result<Settings<'static>, Box<dyn Error>> {
    let bases = BASES
        .iter()
        .map(|built_in| Ok((built_in.name.to_owned(), built_in.base()?)));
    let bases: Vec<_> = bases.collect::<Result<_, Box<dyn Error>>>()?;
    assert_eq!(
        bases
            .iter()
            .map(|(name, _)| name.as_str())
            .collect::<Vec<_>>(),
        NAMES
    );
    Ok(Settings {
        bases,
        classes: classes.to_vec(),
        files: sim_host::bench::FILES.to_vec(),
        runs,
        seed: 1,
        laws: laws.to_vec(),
    })
}

/// The built-in bases with the default law and others.
fn driven(classes: &[Class], runs: usize, laws: &[LawKind]) -> Result<Vec<Run>, Box<dyn Error>> {
    let settings = settings(classes, runs, laws)?;
    Ok(study(&settings, &Tuned::built_in(), || {})?)
}

/// The small set: parking, ideal and realistic.
fn small() -> &'static [Run] {
    static RUN: OnceLock<Vec<Run>> = OnceLock::new();
    RUN.get_or_init(|| {
        let classes = [Plant::Ideal, Plant::Realistic].map(|plant| class(Track::Parking, plant));
        driven(&classes, RUNS, &LAWS).expect("the built-in bases are sound")
    })
}

fn row(rows: &[Row], of: Class, kind: LawKind) -> &Row {
    let of_class = better(rows, of);
    let mut own = of_class.into_iter().filter(|row| row.law.kind == kind);
    own.next().expect("every law ran")
}

fn each(row: &Row, figure: fn(&Summary) -> f64) -> Vec<f64> {
    row.bases.iter().map(figure).collect()
}

/// On the ideal plant the default law is first in time to arrive, on the front, and as quick as is asked.
#[test]
fn the_default_law_is_first_in_parking_on_the_ideal_plant() {
    let rows = summaries(small());
    let ideal = class(Track::Parking, Plant::Ideal);
    for summary in &row(&rows, ideal, LawKind::Default).bases {
        let name = NAMES[summary.base];
        let ratio = summary.ratio;
        assert!(summary.on_front && summary.failed == 0, "{name}");
        assert!(
            ratio.median <= 1.2 && ratio.most <= 1.4 && ratio.worst <= 1.6,
            "{name}: {ratio:?}"
        );
    }
    let sooner = rows.iter().filter(|row| row.class == ideal);
    let sooner = sooner.filter(|row| row.bases.iter().any(|summary| summary.wins_time));
    assert_eq!(sooner.count(), 0);
}

/// Motors, friction, late and noisy poses, mass and inertia that nobody knows.
const REAL: [Plant; 2] = [Plant::Realistic, Plant::BadFloor];

/// Parks on real hardware and on bad floors, from every start that has a least time.
#[test]
fn the_page_states_parking_on_real_hardware() -> Result<(), Box<dyn Error>> {
    let classes = REAL.map(|plant| class(Track::Parking, plant));
    let runs = driven(&classes, 200, &[LawKind::Default])?;
    let rows = summaries(&runs);
    let mut page = Stated::of("docs/bench.md");
    for (base, name) in NAMES.into_iter().enumerate() {
        let figures = classes.map(|of| {
            let summary = &row(&rows, of, LawKind::Default).bases[base];
            let own = runs.iter().filter(|run| {
                run.law.kind == LawKind::Default && run.class == of && run.base == base
            });
            let slow = own.filter(|run| {
                let arrived = run.figures.arrived_s.unwrap_or(f64::INFINITY);
                arrived - ALLOWED_S > 2.5 * run.minimum_s
            });
            let slow = 100.0 * slow.count() as f64 / summary.runs as f64;
            assert_eq!(summary.failed, 0, "{name}");
            [summary.late.median, summary.late.most, slow]
        });
        let [median, most, slow] = figures[0];
        assert!(
            median <= 1.5 && most <= 2.0 && slow == 0.0,
            "{name}: {figures:?}"
        );
        page.exactly(At::Row("Parking on real hardware", name), &figures.concat());
    }
    Ok(())
}

/// Files on real hardware and on bad floors: how late, and how far beside the path.
#[test]
fn the_page_states_files_on_real_hardware() -> Result<(), Box<dyn Error>> {
    let classes = REAL.map(|plant| class(Track::Files, plant));
    let rows = summaries(&driven(&classes, 32, &[LawKind::TurnDriveTurn])?);
    let mut page = Stated::of("docs/bench.md");
    for kind in [LawKind::Default, LawKind::TurnDriveTurn] {
        let figures = classes.map(|of| {
            let row = row(&rows, of, kind);
            let off = each(row, |s| 1.0e3 * s.rms_m.median);
            [each(row, |s| s.ratio.median), off].concat()
        });
        page.exactly(
            At::Row("Files on real hardware", kind.name()),
            &figures.concat(),
        );
    }
    Ok(())
}

/// Velocity orders stop nobody: friction brakes a wheel harder than its torque drives it, on the bad floor most of all, and that is no
/// fault. How soon and how closely they are obeyed the page states, beside what rivals' setpoints go through.
#[test]
fn the_page_states_velocity_orders() -> Result<(), Box<dyn Error>> {
    let classes = [Plant::Ideal, Plant::Realistic, Plant::BadFloor]
        .map(|plant| class(Track::Velocity, plant));
    let runs = driven(&classes, 20, &[LawKind::HeadingHeld, LawKind::RateLimits])?;
    assert_eq!(runs.len(), 3 * 3 * (1 + 20 + 20));
    for Run { figures, .. } in &runs {
        assert_eq!(figures.stopped, None);
    }
    let rows = summaries(&runs);
    let mut page = Stated::of("docs/bench.md");
    for kind in [LawKind::Default, LawKind::HeadingHeld, LawKind::RateLimits] {
        let of_plants = classes.map(|of| row(&rows, of, kind));
        let times = of_plants.map(|row| each(row, |s| s.ratio.median));
        let off = each(of_plants[2], |s| 1.0e3 * s.rms_m.median);
        let figures = [times.concat(), off].concat();
        page.exactly(At::Row("Velocity orders", kind.name()), &figures);
    }
    Ok(())
}

/// The page's small table, of this very set: the better of both flavours.
#[test]
fn the_page_states_the_small_set() {
    let rows = summaries(small());
    let mut page = Stated::of("docs/bench.md");
    for kind in std::iter::once(LawKind::Default).chain(LAWS) {
        let both = [Plant::Ideal, Plant::Realistic]
            .map(|plant| row(&rows, class(Track::Parking, plant), kind));
        let mut figures = Vec::new();
        for row in both {
            // A law that never arrives has a stroke there.
            figures.extend(
                each(row, |s| s.ratio.median)
                    .into_iter()
                    .filter(|time| time.is_finite()),
            );
            figures.extend(each(row, |s| 100.0 * s.failed as f64 / s.runs as f64));
        }
        page.exactly(At::Row("A small set", kind.name()), &figures);
    }
}

/// The whole tables are of runs by the thousand. What a tick takes is that of today's images in each of their rows.
#[test]
fn the_page_states_what_a_tick_takes() {
    const KINDS: [LawKind; 6] = [
        LawKind::Default,
        LawKind::HeadingHeld,
        LawKind::RateLimits,
        LawKind::Samson,
        LawKind::Neural,
        LawKind::Plain,
    ];
    let column = HEADER[HEADER.len() - 1];
    let mut page = Stated::of("docs/bench.md");
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/bench.md"))
        .expect("docs/bench.md");
    let mut rows = 0;
    for table in text.split("\n### ").skip(1) {
        let title = table.lines().next().unwrap_or_default();
        let mut classes = Class::all().into_iter();
        let class = classes.find(|class| class.name().eq_ignore_ascii_case(title));
        let class = class.unwrap_or_else(|| panic!("no class \"{title}\""));
        for row in table.lines().filter(|row| row.starts_with("| ")).skip(2) {
            let label = row.split('|').nth(1).unwrap_or_default().trim();
            let name = label.trim_end_matches(", tuned");
            let mut kinds = KINDS.into_iter().chain(LAWS);
            let kind = kinds.find(|kind| kind.name() == name);
            let kind = kind.unwrap_or_else(|| panic!("no law \"{name}\""));
            // A stroke where no chip runs it.
            let most = instructions(kind, class.track).map(f64::from);
            page.exactly(At::Cell(title, label, column), most.as_slice());
            rows += 1;
        }
    }
    assert!(rows > 60, "{rows}");
}

/// README's short table: medians, in bold where a rival is sooner.
#[test]
fn the_readme_states_the_small_set() {
    const ROWS: [(LawKind, &str); 5] = [
        (LawKind::Default, "default law"),
        (LawKind::TurnDriveTurn, "turn-drive-turn"),
        (LawKind::Ltv, "LTV unicycle (WPILib)"),
        (LawKind::Graceful, "graceful (Nav2)"),
        (LawKind::PurePursuit, "regulated pure pursuit (Nav2)"),
    ];
    let rows = summaries(small());
    let mut page = Stated::of("README.md");
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../README.md"))
        .expect("README.md");
    for (kind, label) in ROWS {
        let both = [Plant::Ideal, Plant::Realistic]
            .map(|plant| row(&rows, class(Track::Parking, plant), kind));
        let figures: Vec<f64> = both
            .iter()
            .flat_map(|row| each(row, |s| s.ratio.median))
            .collect();
        page.exactly(At::Row("Beside other laws", label), &figures);
        let start = format!("| {label} |");
        let line = text
            .lines()
            .find(|line| line.starts_with(&start))
            .unwrap_or_default();
        let sooner = both
            .iter()
            .flat_map(|row| &row.bases)
            .filter(|summary| summary.wins_time);
        assert_eq!(
            line.matches("**").count(),
            2 * sooner.count(),
            "{line}: bold where it is sooner"
        );
    }
}

/// A rival that is ours in all but its plan: what it takes is what its closed form says, so loop and limits cost it nothing.
#[test]
fn turning_and_driving_takes_the_time_of_its_closed_form() -> Result<(), Box<dyn Error>> {
    let rows = summaries(small());
    let ideal = class(Track::Parking, Plant::Ideal);
    let own = row(&rows, ideal, LawKind::TurnDriveTurn);
    for summary in &own.bases {
        let base = BASES[summary.base].base()?;
        let Pool(starts) = Pool::of(NAMES[summary.base], &base).ok_or("no least times")?;
        let mut shares: Vec<f64> = starts
            .iter()
            .map(|start| start.turn_drive_turn_s / start.minimum_s)
            .collect();
        shares.sort_by(f64::total_cmp);
        let closed = shares[shares.len() / 2];
        let ratio = summary.ratio.median / closed;
        assert!(
            (0.8..1.2).contains(&ratio),
            "{} {ratio}",
            NAMES[summary.base]
        );
    }
    Ok(())
}

/// Every law that parks at all does so on every base, with gains that were searched for it.
#[test]
fn tuned_rivals_arrive() {
    let rows = summaries(small());
    // Ramsete has no feedback at rest: what a plan's end leaves, it leaves (docs/bench.md).
    for kind in LAWS.into_iter().filter(|kind| *kind != LawKind::Ramsete) {
        for summary in &row(&rows, class(Track::Parking, Plant::Ideal), kind).bases {
            let what = format!("{} on {}", kind.name(), NAMES[summary.base]);
            assert!(
                4 * summary.failed <= summary.runs,
                "{what}: {} of {}",
                summary.failed,
                summary.runs
            );
        }
    }
}

/// Threads, order of work and what else is run change nothing.
#[test]
fn the_same_bytes_on_any_number_of_threads() -> Result<(), Box<dyn Error>> {
    let classes = [
        class(Track::Parking, Plant::Realistic),
        class(Track::Paper, Plant::BadFloor),
        class(Track::Velocity, Plant::Realistic),
    ];
    let laws = [LawKind::Ltv, LawKind::Neural, LawKind::RateLimits];
    let mut settings = settings(&classes, 2, &laws)?;
    // The base of 10 kg.
    settings.bases.rotate_left(1);
    settings.bases.truncate(1);
    let names: Vec<String> = settings
        .bases
        .iter()
        .map(|(name, _)| name.clone())
        .collect();
    let bytes = |threads: usize| -> Result<Vec<u8>, Box<dyn Error>> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let runs = pool.install(|| study(&settings, &Tuned::built_in(), || {}))?;
        let mut out = Vec::new();
        write_csv(&names, &runs, &mut out)?;
        out.extend(markdown(&summaries(&runs)).into_bytes());
        Ok(out)
    };
    let one = bytes(1)?;
    assert!(one.len() > 5_000, "{}", one.len());
    // Not by `assert_eq`, which would print all of it.
    assert!(one == bytes(3)?, "other bytes on three threads");
    Ok(())
}

/// One file that asks for no other: no address, no script, every class with its table and figure. If there is a browser, it
/// shows them too.
#[test]
fn the_report_is_a_page_by_itself() -> Result<(), Box<dyn Error>> {
    let rows = summaries(small());
    let names = NAMES.map(str::to_owned);
    let classes = [Plant::Ideal, Plant::Realistic].map(|plant| class(Track::Parking, plant));
    let figures = classes.map(|class| {
        pareto(&rows, class, &names).map_or_else(|_| String::new(), |figure| figure.svg())
    });
    let page = html(&rows, &names, "seed 1 <&>", &figures);
    assert!(page.contains("seed 1 &lt;&amp;&gt;"));
    for word in [
        "src=",
        "<script",
        "<link",
        "@import",
        "url(http",
        "href=\"http",
    ] {
        assert!(!page.contains(word), "{word}");
    }
    for part in ["<section", "<table", "<svg", "<figure"] {
        assert_eq!(page.matches(part).count(), classes.len(), "{part}");
        let close = part.replace('<', "</");
        assert_eq!(page.matches(&close).count(), classes.len(), "{close}");
    }
    let browsers = ["chromium-headless-shell", "chromium", "google-chrome"];
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("bench.html");
    std::fs::write(&file, &page)?;
    let shown = browsers.iter().find_map(|browser| {
        let mut command = Command::new(browser);
        command.args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]);
        command
            .arg(format!("file://{}", file.display()))
            .output()
            .ok()
    });
    match shown {
        Some(output) => {
            let dom = String::from_utf8(output.stdout)?;
            assert!(dom.contains("<title>Benchmark</title>"), "{dom:.200}");
            assert_eq!(dom.matches("</table>").count(), classes.len());
            assert_eq!(dom.matches("</svg>").count(), classes.len());
        }
        None => println!("no browser here: looked at by its structure only"),
    }
    Ok(())
}

/// Gains that travel with the program are those of these laws.
#[test]
fn every_rival_has_tuned_gains_on_every_base() {
    let tuned = Tuned::built_in();
    for kind in LawKind::RIVALS {
        for base in NAMES {
            for track in [Track::Parking, Track::Files, Track::Paper] {
                let found = tuned.of(kind, base, track);
                let count = found.map(|gains| gains.len());
                assert_eq!(count, Some(kind.gains().len()), "{} {base}", kind.name());
            }
        }
    }
}

/// A file is driven, or said not to be.
#[test]
fn a_file_that_no_class_drives_is_refused() {
    let here = tempfile::tempdir().expect("a directory");
    std::fs::write(here.path().join("empty.json"), "").expect("written");
    for (only, told) in [
        (
            "parking, ideal",
            "error: empty.json: none of the classes that `--only` leaves drives files\n",
        ),
        (
            "files, ideal",
            "error: empty.json: the file: the file is empty\n",
        ),
    ] {
        let run = ["bench", "--quick", "--file", "empty.json", "--only", only];
        let output = crate::program::sim_host(here.path(), &run);
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(String::from_utf8_lossy(&output.stderr), told);
    }
}
