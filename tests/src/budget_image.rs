//! Firmware images: building, running in the emulator, and what the linker put into them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};

use sim_host::pil::Footprint;

/// The host half of `cost`, here and not by another build of that program.
#[path = "../../firmware-demo/src/bin/cost/host.rs"]
mod host;

/// An instruction set with an emulated board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// In tables.
    pub name: &'static str,
    /// Target triple.
    pub target: &'static str,
    /// What the host half of `cost` calls it.
    pub machine: &'static str,
}

/// The emulated boards.
pub const BOARDS: [Board; 2] = [
    Board {
        name: "cortex-m4f",
        target: "thumbv7em-none-eabihf",
        machine: "arm",
    },
    Board {
        name: "riscv32imafc",
        target: "riscv32imafc-unknown-none-elf",
        machine: "riscv",
    },
];

/// The opt levels that are proven and counted; the first is the profile's own.
pub const LEVELS: [&str; 2] = ["3", "s"];

/// The workspace's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Where images of an opt level are built: those of the profile's own level where all other tests build theirs, most of which
/// are the same; those of another level apart.
pub fn target_dir(level: &str) -> PathBuf {
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    if level == LEVELS[0] {
        scratch.join("..")
    } else {
        scratch.join(format!("chip-{level}"))
    }
}

/// Cargo in `folder`, building into another one.
pub fn cargo_into(folder: &Path, target_dir: &Path) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", target_dir);
    command
}

/// The same for images of an opt level.
pub fn cargo(folder: &Path, level: &str) -> Command {
    let mut command = cargo_into(folder, &target_dir(level));
    command
        // What is the same at all levels, macros and build scripts, is built once.
        .env("CARGO_BUILD_BUILD_DIR", target_dir(LEVELS[0]))
        .env("CARGO_PROFILE_CHIP_OPT_LEVEL", level);
    command
}

/// Builds a binary of `firmware-demo` in the profile `chip`, with the proof that no panic is reachable.
pub fn build(board: Board, level: &str, bin: &str) -> PathBuf {
    // What counts ticks does so for the robots of `bases/` as well.
    let features = if bin == "cost" {
        "panic-proof,robots"
    } else {
        "panic-proof"
    };
    let mut command = cargo(&root(), level);
    command
        .args([
            "build",
            "--quiet",
            "--profile",
            "chip",
            "-p",
            "firmware-demo",
        ])
        .args([
            "--features",
            features,
            "--target",
            board.target,
            "--bin",
            bin,
        ]);
    succeed(&mut command);
    target_dir(level).join(board.target).join("chip").join(bin)
}

/// Runs an image under the emulator's instruction count and returns its rows; `program` is `cost` for an image that
/// counts by itself, `pil` for the processor in the loop.
pub fn run(board: Board, program: &str, image: &Path) -> Rows {
    let image = image.to_str().expect("a path of letters");
    let rows = host::run(&[board.machine, program, image]);
    Rows::parse(&rows.unwrap_or_else(|error| panic!("{} {program} {image}: {error}", board.name)))
}

/// Runs a command that has to succeed.
pub fn succeed(command: &mut Command) -> Output {
    let output = command.output().expect("cargo can be started");
    assert!(
        output.status.success(),
        "{command:?} failed:\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Least, mean and most of each row of an image.
#[derive(Clone, Debug, Default)]
pub struct Rows(BTreeMap<String, (u64, f64, u64)>);

impl Rows {
    /// Lines `name min mean max` or `name number`.
    pub fn parse(text: &str) -> Self {
        let complaints: Vec<&str> = text.lines().filter(|line| line.starts_with('!')).collect();
        assert!(complaints.is_empty(), "{complaints:?}:\n{text}");
        let rows = text.lines().map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let number = |word: &str| {
                word.parse::<u64>()
                    .unwrap_or_else(|_| panic!("not a row: {line}"))
            };
            match *words.as_slice() {
                [name, only] => (
                    name.to_owned(),
                    (number(only), number(only) as f64, number(only)),
                ),
                [name, least, mean, most] => {
                    let mean = mean.parse().unwrap_or_else(|_| panic!("not a row: {line}"));
                    (name.to_owned(), (number(least), mean, number(most)))
                }
                _ => panic!("not a row: {line}"),
            }
        });
        Self(rows.collect())
    }

    /// With the rows of another image.
    pub fn extend(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// Least, mean and most.
    pub fn row(&self, name: &str) -> (u64, f64, u64) {
        *self
            .0
            .get(name)
            .unwrap_or_else(|| panic!("no row {name} among {:?}", self.0.keys()))
    }

    /// Most.
    pub fn most(&self, name: &str) -> u64 {
        self.row(name).2
    }

    /// Mean, rounded.
    pub fn mean(&self, name: &str) -> u64 {
        self.row(name).1.round() as u64
    }

    /// `278`, or `2546 … 2652 … 2771` where it varies.
    pub fn show(&self, name: &str) -> String {
        match self.row(name) {
            (least, _, most) if least == most => format!("{most}"),
            (least, mean, most) => format!("{least} … {mean:.0} … {most}"),
        }
    }
}

/// What an image occupies, without stack, as `sim-host pil` tells it.
pub fn footprint(image: &Path) -> Footprint {
    Footprint::of(&bytes(image)).unwrap_or_else(|error| panic!("{}: {error}", image.display()))
}

fn bytes(image: &Path) -> Vec<u8> {
    fs::read(image).unwrap_or_else(|error| panic!("{}: {error}", image.display()))
}

/// An image of 32 bits, little endian, as the linker wrote it.
pub struct Elf {
    bytes: Vec<u8>,
}

struct Section {
    kind: u32,
    offset: u32,
    size: u32,
    link: u32,
}

impl Elf {
    const SYMBOLS: u32 = 2;

    /// Reads an image.
    pub fn read(image: &Path) -> Self {
        let bytes = bytes(image);
        assert_eq!(&bytes[..6], b"\x7fELF\x01\x01", "{}", image.display());
        Self { bytes }
    }

    fn word(&self, at: u32) -> u32 {
        let at = at as usize;
        u32::from_le_bytes(self.bytes[at..at + 4].try_into().expect("four bytes"))
    }

    fn half(&self, at: u32) -> u32 {
        self.word(at) & 0xFFFF
    }

    fn text(&self, at: u32) -> String {
        let rest = &self.bytes[at as usize..];
        let end = rest.iter().position(|&byte| byte == 0).expect("an end");
        String::from_utf8_lossy(&rest[..end]).into_owned()
    }

    fn section(&self, index: u32) -> Section {
        let at = self.word(32) + index * self.half(46);
        Section {
            kind: self.word(at + 4),
            offset: self.word(at + 16),
            size: self.word(at + 20),
            link: self.word(at + 24),
        }
    }

    fn sections(&self) -> impl Iterator<Item = Section> {
        (0..self.half(48)).map(|index| self.section(index))
    }

    /// Names of all symbols.
    pub fn symbols(&self) -> Vec<String> {
        const ENTRY: u32 = 16;
        let mut names = Vec::new();
        for table in self
            .sections()
            .filter(|section| section.kind == Self::SYMBOLS)
        {
            let strings = self.section(table.link);
            for at in (0..table.size).step_by(ENTRY as usize) {
                names.push(self.text(strings.offset + self.word(table.offset + at)));
            }
        }
        names
    }
}
