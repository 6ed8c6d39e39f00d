//! What the controller costs on a chip: executed instructions, flash, RAM and stack against checked-in budgets, and
//! the proofs that images neither panic nor allocate.
//!
//! Instructions are counted in the emulator, never timed. `cargo test -p tests --test chip budgets -- --nocapture` prints
//! the tables; with `UPDATE_BUDGETS=1` it writes what it measured to `firmware-demo/budgets.toml`. Static stack sizes
//! are not here: `-Z emit-stack-sizes` needs a nightly compiler. The painted stack of a run stands for them.

#[path = "../src/budget.rs"]
mod budget;
#[path = "../src/budget_image.rs"]
mod budget_image;
#[path = "../src/budget_report.rs"]
mod budget_report;
#[path = "../src/cycles.rs"]
mod cycles;
#[path = "../src/panic_link.rs"]
mod panic_link;

use std::collections::BTreeMap;
use std::fs;
use std::io::{Write, stderr};
use std::sync::OnceLock;

use budget::Table;
use budget_image::{
    BOARDS, Board, Elf, LEVELS, Rows, build, cargo_into, footprint, root, run, target_dir,
};
use cycles::Traced;
use sim_host::bench::{LawKind, Track, instructions};
use sim_host::pil::Footprint;
use tests::boards_target;
use tests::stated::{At, Stated};

/// The requirement: a whole tick on the Cortex-M4F for ordinary inputs, at opt level 3, with a reference whose heading
/// comes with its sine and cosine. Working these out in the tick has a budget of its own, `track-with-reference`.
const TICK: u64 = 300;
/// The requirement: most over least.
const SPREAD: f64 = 1.05;

/// One board at one opt level.
struct Measured {
    board: Board,
    level: &'static str,
    cost: Rows,
    pil: Rows,
    size: Footprint,
    /// Of the image that has the whole base and drives it along a route, nothing else.
    base: Footprint,
}

impl Measured {
    fn is_traced(&self) -> bool {
        self.board == BOARDS[0] && self.level == LEVELS[0]
    }
}

/// Everything, measured once.
fn measured() -> &'static [Measured] {
    static ALL: OnceLock<Vec<Measured>> = OnceLock::new();
    ALL.get_or_init(|| {
        let mut all = Vec::new();
        for board in BOARDS {
            for level in LEVELS {
                let cost = build(board, level, "cost");
                let pil = build(board, level, "pil");
                let base = build(board, level, "base");
                all.push(Measured {
                    board,
                    level,
                    cost: run(board, "cost", &cost),
                    pil: run(board, "pil", &pil),
                    size: footprint(&pil),
                    base: footprint(&base),
                });
            }
        }
        all
    })
}

/// Cycles that are modelled for ticks of the whole base on the Cortex-M4F at opt level 3, following and parking, traced once.
fn modelled() -> &'static [Traced; 2] {
    static TRACED: OnceLock<[Traced; 2]> = OnceLock::new();
    TRACED.get_or_init(|| {
        let (traced, console) = cycles::traced(&build(BOARDS[0], LEVELS[0], "trace"));
        let rows = Rows::parse(&console);
        // Of what is counted two calls, and the return from the first, are beside what is traced.
        for (traced, row) in traced.iter().zip(["base/follow", "base/park"]) {
            let mean = traced.instructions as f64 / traced.ticks as f64;
            assert!(
                (rows.row(row).1 - mean - 4.0).abs() < 0.01,
                "{row}: {:?}, traced {mean}",
                rows.row(row)
            );
        }
        traced
    })
}

/// What has a budget, of one board at one opt level.
fn entries(measured: &Measured) -> Vec<(&'static str, u64)> {
    let Measured {
        cost,
        pil,
        size,
        base,
        ..
    } = measured;
    let tick = |part: &str| cost.most(&format!("tick/single+rational/{part}/ordinary"));
    let worst = |part: &str| {
        ["ordinary", "wrapped", "saturated", "large"]
            .map(|kind| cost.most(&format!("tick/single+rational/{part}/{kind}")))
            .into_iter()
            .fold(0, u64::max)
    };
    let stack = |part: &str| cost.most(&format!("stack/single+rational/{part}"));
    let mut entries = vec![
        ("track", tick("track")),
        ("track-worst", worst("track")),
        ("track-with-reference", tick("track-with-reference")),
        ("park", tick("park")),
        ("park-worst", worst("park")),
        ("start", worst("start")),
        ("hand-over", worst("hand-over")),
        ("monitor", worst("monitor")),
        ("motion-follow", cost.most("motion/follow")),
        ("motion-lead", cost.most("motion/lead")),
        ("motion-plan", cost.most("motion/plan")),
        ("motion-search-1ms", cost.most("motion/search-1ms")),
        ("motion-search-10ms", cost.most("motion/search-10ms")),
        ("motion-park", cost.most("motion/park")),
        ("motion-park-mean", cost.mean("motion/park")),
        ("base-first", cost.most("base/first")),
        ("base-follow", cost.most("base/follow")),
        ("base-follow-mean", cost.mean("base/follow")),
        ("base-plan", cost.most("base/plan")),
        ("base-park", cost.most("base/park")),
        ("base-park-mean", cost.mean("base/park")),
        ("base-fix", cost.most("base/with-fix")),
        ("shipped-fix", cost.most("shipped/with-fix")),
        ("shipped-follow", cost.most("shipped/follow")),
        ("shipped-follow-mean", cost.mean("shipped/follow")),
        ("shipped-park", cost.most("shipped/park")),
        ("shipped-park-mean", cost.mean("shipped/park")),
        ("shipped-plan", cost.most("shipped/plan")),
        ("shipped-velocity", cost.most("shipped/velocity")),
        ("shipped-velocity-mean", cost.mean("shipped/velocity")),
        ("localiser", cost.most("localiser/without-fix")),
        ("motor", cost.most("motor/commands")),
        ("base-flash", base.flash()),
        ("base-ram", cost.most("ram/base")),
        ("base-stack", cost.most("stack/base")),
        ("tick-stack", stack("track").max(stack("park"))),
        ("hand-over-stack", stack("hand-over")),
        ("pil-stack", pil.most("stack/pil")),
        ("pil-flash", size.flash()),
        ("pil-ram", size.ram()),
    ];
    if measured.is_traced() {
        let names = ["base-follow-cycles", "base-park-cycles"];
        let most = modelled().map(|traced| traced.per_tick().most);
        entries.extend(names.into_iter().zip(most));
    }
    entries
}

fn table() -> Table {
    measured()
        .iter()
        .map(|measured| {
            let section = format!("{}.{}", measured.board.name, measured.level);
            let entries = entries(measured).into_iter();
            (
                section,
                entries
                    .map(|(key, value)| (key.to_owned(), value))
                    .collect(),
            )
        })
        .collect()
}

/// A change for the worse fails with both numbers; one for the better asks to lower the budget.
#[test]
fn chip_images_keep_their_budgets() {
    let path = root().join("firmware-demo/budgets.toml");
    let text = fs::read_to_string(&path).expect("the budgets can be read");
    let table = table();
    println!("measured:\n{}", budget::print(&table));
    if std::env::var_os("UPDATE_BUDGETS").is_some() {
        let head: String = text
            .lines()
            .take_while(|line| line.starts_with('#'))
            .map(|line| format!("{line}\n"))
            .collect();
        fs::write(&path, head + &budget::print(&table)).expect("the budgets can be written");
        return;
    }
    let budgets = budget::parse(&text).expect("the budgets can be understood");
    let verdict = budget::compare(&budgets, &table);
    for hint in &verdict.hints {
        // Not by `println!`, which a passing test keeps to itself.
        let _ = writeln!(stderr(), "BETTER THAN ITS BUDGET {hint}");
    }
    assert!(
        verdict.failures.is_empty(),
        "worse than budgeted in firmware-demo/budgets.toml:\n  {}",
        verdict.failures.join("\n  ")
    );
}

/// The comparison itself: worse, better, missing on either side.
#[test]
fn a_budget_tells_worse_from_better() {
    let table = |text: &str| budget::parse(text).expect("a table");
    let budgets =
        table("# comment\n[a.b]\nworse = 100 # why\nbetter = 1_000\nsame = 0\ngone = 5\n");
    let measured = table("[a.b]\nworse = 101\nbetter = 979\nsame = 0\nnew = 1\n");
    let verdict = budget::compare(&budgets, &measured);
    let expected = [
        "[a.b] new: measured 1, no budget",
        "[a.b] worse: measured 101, budget 100 (+1.0 %)",
        "[a.b] gone: not measured, budget 5",
    ];
    assert_eq!(verdict.failures, expected);
    let hint = "[a.b] better: measured 979, budget 1000 (-2.1 %): lower the budget";
    assert_eq!(verdict.hints, [hint]);
    assert!(budget::compare(&measured, &measured).failures.is_empty());
    assert_eq!(table(&budget::print(&budgets)), budgets);
    assert!(budget::parse("key").is_err() && budget::parse("[a]\nkey = x").is_err());
    assert!(budget::parse("[a]\nkey = 1\nkey = 2").is_err());
}

/// At most 300 instructions in each phase, and the same for all ordinary inputs within 5 %.
#[test]
fn a_tick_with_the_references_heading_given_takes_300_instructions_at_most() {
    for measured in measured() {
        let Measured {
            board, level, cost, ..
        } = measured;
        assert_eq!(cost.row("thousand-nops"), (1000, 1000.0, 1000));
        for phase in ["track", "park"] {
            let (least, _, most) = cost.row(&format!("tick/single+rational/{phase}/ordinary"));
            println!("{} opt {level} {phase}: {least} to {most}", board.name);
            assert!(
                most as f64 <= SPREAD * least as f64,
                "{phase}: {least} to {most}"
            );
            if board.name == "cortex-m4f" && *level == "3" {
                assert!(most <= TICK, "{phase}: {most} instructions");
            }
        }
    }
}

/// No image holds any part of an allocator, and the undefined symbol of the panic proof is in none.
#[test]
fn images_neither_allocate_nor_panic() {
    measured();
    for board in BOARDS {
        for level in LEVELS {
            for bin in ["cost", "pil"] {
                let image = target_dir(level).join(board.target).join("chip").join(bin);
                let symbols = Elf::read(&image).symbols();
                assert!(
                    symbols.iter().any(|name| name.contains("NeuralController")),
                    "{symbols:?}"
                );
                let bad = [
                    "__rust_alloc",
                    "__rust_no_alloc",
                    "__rdl_",
                    "__rg_",
                    "malloc",
                    "a_panic_is_reachable",
                    "panicking",
                ];
                let found: Vec<_> = symbols
                    .iter()
                    .filter(|name| bad.iter().any(|bad| name.contains(bad)))
                    .collect();
                assert!(
                    found.is_empty(),
                    "{bin} for {} at {level}: {found:?}",
                    board.name
                );
            }
        }
    }
}

/// The proof is one: a panic that can be reached does not link, and the same program without it does.
#[test]
fn a_reachable_panic_does_not_link() {
    let program = |expression: &str| {
        format!("fn run() {{ let values = black_box([1_u32, 2, 3]); black_box({expression}); }}")
    };
    for board in BOARDS {
        for level in LEVELS {
            let fine = program("values.get(black_box(7_usize))");
            let (links, words) = panic_link::link(board, level, &fine, &[]);
            assert!(links, "{words}");
            assert_does_not_link(board, level, &program("values[black_box(7_usize)]"));
        }
    }
}

/// The handles of queues divide by a length that heapless forgets. Each of their functions for itself links, whatever it is
/// called with, and also where LLVM inlines only what makes code no larger; those of heapless itself do not.
#[test]
fn handles_of_queues_cannot_panic_by_themselves() {
    let handles = include_str!("../src/queue_handles.rs");
    let bare = "use heapless::spsc::Producer; \
                fn enqueue(p: &mut Producer<'static, u32>, v: u32) -> bool { p.enqueue(v).is_ok() } \
                fn run() { black_box(enqueue as fn(_, _) -> _); }";
    for board in BOARDS {
        for level in LEVELS {
            assert_does_not_link(board, level, bare);
            for arguments in [&[][..], &["-Cllvm-args=-inline-threshold=0"]] {
                let (links, words) = panic_link::link(board, level, handles, arguments);
                assert!(links, "{} at {level}, {arguments:?}: {words}", board.name);
            }
        }
    }
}

fn assert_does_not_link(board: Board, level: &str, program: &str) {
    let (links, words) = panic_link::link(board, level, program, &[]);
    let name = board.name;
    assert!(!links, "a reachable panic was linked for {name} at {level}");
    assert!(
        words.contains("undefined symbol: a_panic_is_reachable"),
        "{words}"
    );
}

/// What was measured on a board at opt level 3.
fn fastest(board: Board) -> &'static Measured {
    let mut all = measured().iter();
    let found = all.find(|measured| measured.board == board && measured.level == "3");
    found.expect("every board was measured at opt level 3")
}

/// The table of `docs/chip.md`, and what stands below it. Also prints the tables that it has no room for: back ends,
/// parts, peers.
#[test]
fn the_document_states_what_is_measured() {
    let mut page = Stated::of("docs/chip.md");
    let columns = ["Cortex-M4F", "RISC-V (rv32imafc)"];
    for (board, column) in BOARDS.into_iter().zip(columns) {
        let measured = fastest(board);
        let figures = BTreeMap::from_iter(entries(measured));
        for (row, keys) in [
            (
                "paper's law, one tick tracking / parking",
                &["track", "park"][..],
            ),
            (
                "with the reference's heading worked out in the tick",
                &["track-with-reference", "park"],
            ),
            ("start / hand-over, once", &["start", "hand-over"]),
            (
                "default law, one tick following / parking / while a manoeuvre is searched for, most",
                &["motion-follow", "motion-park", "motion-plan"],
            ),
            (
                "the same in searches to goals all around, from rest and from motion, every 1 ms / every 10 ms, most",
                &["motion-search-1ms", "motion-search-10ms"],
            ),
            (
                "robots of `bases/`, one tick from encoder counts to duties, following / parking / by velocity / with a pose, most",
                &[
                    "shipped-follow",
                    "shipped-park",
                    "shipped-velocity",
                    "shipped-fix",
                ],
            ),
            (
                "their mean, following / parking / by velocity",
                &[
                    "shipped-follow-mean",
                    "shipped-park-mean",
                    "shipped-velocity-mean",
                ],
            ),
            (
                "they while a manoeuvre is searched for, 0.35 s at most, most",
                &["shipped-plan"],
            ),
            (
                "a base without motors at 1 kHz, to torques, first / following / parking / with a pose, most",
                &["base-first", "base-follow", "base-park", "base-fix"],
            ),
            (
                "the same, mean of following / parking",
                &["base-follow-mean", "base-park-mean"],
            ),
            (
                "the same while a manoeuvre is searched for, 0.35 s at most, most",
                &["base-plan"],
            ),
            (
                "flash of the whole base with a route, RAM and stack [bytes]",
                &["base-flash", "base-ram", "base-stack"],
            ),
            (
                "localiser; motor layer, both wheels",
                &["localiser", "motor"],
            ),
            (
                "flash, RAM, stack of the `pil` image with protocol [bytes]",
                &["pil-flash", "pil-ram", "pil-stack"],
            ),
        ] {
            let figures: Vec<f64> = keys.iter().map(|key| figures[key] as f64).collect();
            page.exactly(At::Cell("On a chip", row, column), &figures);
        }
    }
    let arm = fastest(BOARDS[0]);
    let figures = BTreeMap::from_iter(entries(arm));
    let [follow, park] = modelled().map(|traced| traced.per_tick());
    let cycles = [follow.least, follow.most, park.least, park.most];
    page.exactly(
        At::Row("On a chip", "cycles that the processor's manual has for ticks of the whole base that accelerate, following / parking, mean"),
        &cycles.map(|cycles| cycles as f64),
    );
    page.exactly(
        At::Phrase("limited torques cost up to #;"),
        &[figures["park-worst"].max(figures["track-worst"]) as f64],
    );
    let peers = peers();
    println!("{}", budget_report::back_ends(&arm.cost));
    println!("{}", budget_report::inputs(&arm.cost));
    println!("{}", budget_report::parts(&arm.cost));
    println!("{}", budget_report::peers(&arm.cost, peers));
    let all: Vec<_> = measured()
        .iter()
        .map(|m| (m.board.name, m.level, &m.cost, &m.pil, m.size))
        .collect();
    println!("{}", budget_report::images(&all));
    rivals_cost_what_the_benchmark_says(peers);
    let tick = |path: &str, part: &str| arm.cost.row(&format!("tick/{path}/{part}/ordinary")).1;
    page.exactly(
        At::Phrase("two `pid` PIDs #"),
        &[peers.row("peer/pid-pair").1],
    );
    // Means, for their cost depends on the numbers.
    page.exactly(
        At::Phrase("the paper's tick on `libm` # / #"),
        &[tick("libm+exact", "track"), tick("libm+exact", "park")],
    );
    page.about(
        At::Phrase("and in `f64` # / #."),
        &[
            tick("f64-libm+exact", "track"),
            tick("f64-libm+exact", "park"),
        ],
    );
}

/// The README's table: the whole base beside the least that drives such a robot, on the same maths.
#[test]
fn the_readme_says_what_a_tick_costs() {
    let arm = fastest(BOARDS[0]);
    let figures = BTreeMap::from_iter(entries(arm));
    let peers = peers();
    // The stack follows its circle, so what is counted is what it does.
    let off_mm = peers.most("peer/stack-off-mm");
    assert!(off_mm <= 5, "{off_mm} mm");
    let mut page = Stated::of("README.md");
    let stack = peers.row("peer/stack");
    let traced = &modelled()[0];
    let per_instruction = [traced.cycles.least, traced.cycles.most]
        .map(|cycles| cycles as f64 / traced.instructions as f64);
    page.to_a_digit(At::Phrase("one takes # to # cycles"), &per_instruction);
    // Cycles a tick over those of 10 ms at 100 MHz [%].
    let shares =
        per_instruction.map(|cycles| 100.0 * cycles * figures["shipped-follow"] as f64 / 1.0e6);
    page.to_a_digit(At::Phrase("a robot takes # to # % of the time"), &shares);
    page.exactly(
        At::Phrase("Flash # bytes, RAM #, stack #."),
        &["base-flash", "base-ram", "base-stack"].map(|key| figures[key] as f64),
    );
    for (row, cells) in [
        (
            "a robot of `bases/` to duties, following",
            &["shipped-follow-mean", "shipped-follow"].map(|key| figures[key] as f64)[..],
        ),
        (
            "the same, parking",
            &["shipped-park-mean", "shipped-park"].map(|key| figures[key] as f64),
        ),
        (
            "the same, driven by velocity",
            &["shipped-velocity-mean", "shipped-velocity"].map(|key| figures[key] as f64),
        ),
        (
            "the same with an external pose; while it searches for a manoeuvre, 0.35 s at most",
            &["shipped-fix", "shipped-plan"].map(|key| figures[key] as f64),
        ),
        (
            "odometry, Ramsete, a PID with feed-forward for each wheel, to duties; nothing else",
            &[stack.1, stack.2 as f64],
        ),
    ] {
        page.exactly(At::Row("What a tick costs", row), cells);
    }
}

/// `sim-host bench` prints the most instructions of a rival's tick; a board counted them.
fn rivals_cost_what_the_benchmark_says(peers: &Rows) {
    const NAMES: [(LawKind, &str); 9] = [
        (LawKind::TurnDriveTurn, "turn-drive-turn"),
        (LawKind::Ramsete, "ramsete"),
        (LawKind::Ltv, "ltv"),
        (LawKind::Graceful, "graceful"),
        (LawKind::GracefulOnTheWay, "graceful-on-the-way"),
        (LawKind::PurePursuit, "pure-pursuit"),
        (LawKind::Aicardi, "aicardi"),
        (LawKind::Samson, "samson"),
        (LawKind::TwoPids, "two-pids"),
    ];
    for (kind, name) in NAMES {
        let counted = ["follow", "park"].map(|job| peers.row(&format!("rival/{job}/{name}")).2);
        println!("{};{};{}", kind.name(), counted[0], counted[1]);
        assert_eq!(
            [Track::Files, Track::Parking].map(|track| instructions(kind, track)),
            counted.map(|most| Some(most as u32)),
            "sim-host/src/bench/chip.csv: {}",
            kind.name()
        );
    }
}

/// The peers are a workspace of their own, for their dependencies burden nobody. Counted once.
fn peers() -> &'static Rows {
    static PEERS: OnceLock<Rows> = OnceLock::new();
    PEERS.get_or_init(|| {
        let mut command = cargo_into(&root().join("boards/cost-peers"), &boards_target());
        command
            .args(["build", "--quiet", "--locked", "--release"])
            .args(["--features", "panic-proof"]);
        budget_image::succeed(&mut command);
        let images = boards_target().join(BOARDS[0].target).join("release");
        let mut rows = run(BOARDS[0], "cost", &images.join("cost-peers"));
        rows.extend(run(BOARDS[0], "cost", &images.join("cost-stack")));
        rows
    })
}
