//! Builds `libtwb.a` for cores, as `include/twb.h` declares it.
//!
//! ```sh
//! cargo run -p capi --bin archives                      # all cores, into target/twb
//! cargo run -p capi --bin archives -- host cortex-m4f   # these
//! cargo run -p capi --bin archives -- --opt s host      # smaller and slower
//! cargo run -p capi --bin archives -- portable          # C for cores that Rust does not have
//! ```
//!
//! Of the static library that Rust makes, one object is linked with all that the header's functions need and nothing else, and
//! only their names stay visible: two such archives, or another Rust library, are in nobody's way. An archive is refused if it
//! needs a symbol that no C library has (a panic that is reachable does), if it exports another name than the header has, or if
//! it is larger than [`MOST_BYTES`].
//!
//! The folder is at once what CMake (`find_package`), Zephyr (a module), ESP-IDF (a component), PlatformIO and Arduino (a library)
//! take: headers in `include/`, archives in `lib/CORE/`; Arduino has its own copies, in `src/`, where it looks.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

mod portable;

/// Most bytes of an archive.
const MOST_BYTES: u64 = 300_000;

/// A core that archives are built for.
struct Core {
    /// Its folder.
    name: &'static str,
    /// Its target triple.
    target: &'static str,
    /// What its archive may leave to the C library: bare targets bring their own.
    leaves: &'static [&'static str],
    /// Where Arduino looks for it, by the board's `build.mcu` and floating-point unit.
    arduino: &'static [&'static str],
}

const fn bare(name: &'static str, target: &'static str, arduino: &'static [&'static str]) -> Core {
    Core {
        name,
        target,
        leaves: &[],
        arduino,
    }
}

const CORES: [Core; 10] = [
    Core {
        name: "host",
        target: HOST,
        leaves: &["memcpy", "memmove", "memset", "memcmp", "bcmp"],
        arduino: &[],
    },
    bare(
        "cortex-m0plus",
        "thumbv6m-none-eabi",
        &["cortex-m0plus", "cortex-m0"],
    ),
    bare("cortex-m3", "thumbv7m-none-eabi", &["cortex-m3"]),
    bare(
        "cortex-m4",
        "thumbv7em-none-eabi",
        &["cortex-m4", "cortex-m7"],
    ),
    bare(
        "cortex-m4f",
        "thumbv7em-none-eabihf",
        &[
            "cortex-m4/fpv4-sp-d16-hard",
            "cortex-m7/fpv5-sp-d16-hard",
            "cortex-m7/fpv5-d16-hard",
        ],
    ),
    bare("cortex-m33", "thumbv8m.main-none-eabi", &["cortex-m33"]),
    bare(
        "cortex-m33f",
        "thumbv8m.main-none-eabihf",
        &["cortex-m33/fpv5-sp-d16-hard"],
    ),
    bare(
        "rv32imc",
        "riscv32imc-unknown-none-elf",
        &["esp32c2", "esp32c3"],
    ),
    bare(
        "rv32imac",
        "riscv32imac-unknown-none-elf",
        &["esp32c6", "esp32h2"],
    ),
    bare("rv32imafc", "riscv32imafc-unknown-none-elf", &["esp32p4"]),
];

/// The machine that this is built on.
const HOST: &str = env!("TARGET");

fn main() -> Result<(), Box<dyn Error>> {
    let mut opt = "3".to_owned();
    let mut out = target_dir().join("twb");
    let mut names = Vec::new();
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--opt" => opt = value()?,
            "--out" => out = PathBuf::from(value()?),
            "-h" | "--help" => {
                println!("{}", usage());
                return Ok(());
            }
            _ if argument.starts_with('-') => {
                return Err(format!("no option {argument}: see --help").into());
            }
            _ => names.push(argument),
        }
    }
    for name in &names {
        if !CORES.iter().any(|core| core.name == name) && name != portable::NAME {
            return Err(format!("no core {name}: there are {}", known()).into());
        }
    }
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let api = declared(&fs::read_to_string(here.join("include/twb.h"))?);
    let tools = Tools::find()?;
    copy_all(&here.join("package"), &out)?;
    copy_all(&here.join("examples"), &out.join("examples"))?;
    for folder in ["include", "src"] {
        copy_all(&here.join("include"), &out.join(folder))?;
    }
    println!(
        "{:<14} {:>9} {:>9}  archive",
        "core", "flash [B]", "size [B]"
    );
    for core in &CORES {
        if names.is_empty() || names.iter().any(|name| name == core.name) {
            let (flash, size, archive) = build(core, &opt, &out, &api, &tools)?;
            let archive = archive.display();
            println!("{:<14} {flash:>9} {size:>9}  {archive}", core.name);
        }
    }
    if names.is_empty() || names.iter().any(|name| name == portable::NAME) {
        let file = portable::build(&opt, &out, here)?;
        println!(
            "{:<14} {:>9} {:>9}  {}",
            portable::NAME,
            "-",
            "-",
            file.display()
        );
    }
    Ok(())
}

/// All that can be built.
fn known() -> String {
    let cores = CORES.iter().map(|core| core.name);
    cores.chain([portable::NAME]).collect::<Vec<_>>().join(", ")
}

fn usage() -> String {
    format!(
        "usage: archives [--opt LEVEL] [--out FOLDER] [CORE]...\nbuilds libtwb.a, into target/twb, for optimisation level 3, for all cores: {}",
        known()
    )
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn target_dir() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Copies what is in a folder, with all below it.
fn copy_all(from: &Path, to: &Path) -> std::io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if entry.file_type()?.is_dir() {
            copy_all(&from, &to)?;
        } else {
            fs::copy(from, to)?;
        }
    }
    Ok(())
}

/// The names of the functions that a header declares, in order.
fn declared(header: &str) -> Vec<String> {
    let names = header.lines().filter_map(|line| {
        let (before, _) = line.split_once('(')?;
        let name = before.rsplit([' ', '*']).next()?;
        let declares = !line.starts_with([' ', '#', '/']) && name.starts_with("twb_");
        declares.then(|| name.to_owned())
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// What comes with the compiler.
struct Tools(PathBuf);

impl Tools {
    fn find() -> Result<Self, Box<dyn Error>> {
        let sysroot = run(Command::new(rustc()).args(["--print", "sysroot"]))?;
        let folder = PathBuf::from(sysroot.trim())
            .join("lib/rustlib")
            .join(HOST)
            .join("bin");
        if !folder.join("llvm-ar").exists() {
            return Err("llvm-ar is missing: rustup component add llvm-tools".into());
        }
        Ok(Self(folder))
    }

    fn run(&self, tool: &str) -> Command {
        Command::new(self.0.join(tool))
    }
}

fn rustc() -> std::ffi::OsString {
    env::var_os("RUSTC").unwrap_or_else(|| "rustc".into())
}

/// Runs a command that has to succeed; what it printed.
fn run(command: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = command.output()?;
    if !output.status.success() {
        let complaint = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{command:?} failed:\n{complaint}").into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// The archive of a core: bytes of flash, bytes of the file, and where it is.
fn build(
    core: &Core,
    opt: &str,
    out: &Path,
    api: &[String],
    tools: &Tools,
) -> Result<(u64, u64, PathBuf), Box<dyn Error>> {
    let library = cargo_build("staticlib", core.target, opt, &flags(core))?.join("libcapi.a");
    let folder = out.join("lib").join(core.name);
    fs::create_dir_all(&folder)?;
    let [linked, named, object] = ["linked.o", "named.o", "twb.o"].map(|name| folder.join(name));
    let needed = api.iter().map(|name| format!("--undefined={name}"));
    run(tools
        .run("rust-lld")
        .args(["-flavor", "gnu", "-r", "--gc-sections"])
        .args(needed)
        .arg("-o")
        .args([&linked, &library]))?;
    let kept = api
        .iter()
        .map(|name| format!("--keep-global-symbol={name}"));
    run(tools
        .run("llvm-objcopy")
        .args(["--strip-debug", "--strip-unneeded"])
        // Bitcode for link-time optimisation by Rust, which nobody does any more.
        .args([
            "--remove-section=.llvmbc",
            "--remove-section=.llvmcmd",
            "--remove-section=.comment",
        ])
        .args(kept)
        .args(short_names(&linked, tools)?)
        .args([&linked, &named]))?;
    // Sections of one name become one.
    run(tools
        .run("rust-lld")
        .args(["-flavor", "gnu", "-r", "-o"])
        .args([&object, &named]))?;
    run(tools
        .run("llvm-objcopy")
        .arg("--strip-unneeded")
        .arg(&object))?;
    for file in [&linked, &named] {
        fs::remove_file(file)?;
    }
    check_symbols(core, api, tools, &object)?;
    let archive = folder.join("libtwb.a");
    if archive.exists() {
        fs::remove_file(&archive)?;
    }
    run(tools.run("llvm-ar").arg("rcsD").args([&archive, &object]))?;
    let size = fs::metadata(&archive)?.len();
    if size > MOST_BYTES {
        return Err(format!("{}: {size} bytes, at most {MOST_BYTES} allowed", core.name).into());
    }
    let sections = run(tools.run("llvm-size").arg("-A").arg(&object))?;
    fs::remove_file(&object)?;
    for place in core.arduino {
        let folder = out.join("src").join(place);
        fs::create_dir_all(&folder)?;
        fs::copy(&archive, folder.join("libtwb.a"))?;
    }
    Ok((flash(&sections), size, archive))
}

/// What gives functions and constants that nobody calls by name, and their sections, short names: paths and hashes would take 20 kB. Sections
/// of constants get one name, under which they become one section: a header for each would take 3 kB.
fn short_names(object: &Path, tools: &Tools) -> Result<Vec<String>, Box<dyn Error>> {
    let mut arguments = Vec::new();
    let mut shorts = Vec::new();
    let symbols = run(tools.run("llvm-nm").arg("--just-symbol-name").arg(object))?;
    for name in symbols.lines() {
        let path = if name.starts_with("_ZN") {
            // `..4tick17h` and 16 digits, `E`.
            name.get(..name.len().saturating_sub(20)).unwrap_or(name)
        } else if name.starts_with("_R") {
            // Of the compiler's own library, in the newer scheme: the path is in front.
            name
        } else if name.starts_with(".Lanon.") || name.starts_with(".Lswitch.table.") {
            // Constants and jump tables.
            "c"
        } else {
            continue;
        };
        let last = path.rsplit(|c: char| c.is_ascii_digit()).next();
        let short = format!("{}.{}", last.unwrap_or_default(), shorts.len());
        arguments.push(format!("--redefine-sym={name}={short}"));
        shorts.push((name, short));
    }
    let sections = run(tools.run("llvm-size").arg("-A").arg(object))?;
    let sections = sections
        .lines()
        .filter_map(|line| line.split_whitespace().next());
    for section in sections {
        let of_function = shorts.iter().find(|(name, _)| section.ends_with(name));
        if section.starts_with(".rodata..L") {
            arguments.push(format!("--rename-section={section}=.rodata.c"));
        } else if let Some((name, short)) = of_function {
            let renamed = section.replace(name, short);
            arguments.push(format!("--rename-section={section}={renamed}"));
        }
    }
    Ok(arguments)
}

/// Builds the crate with what only archives have; where its library is.
fn cargo_build(
    kind: &str,
    target: &str,
    opt: &str,
    flags: &str,
) -> Result<PathBuf, Box<dyn Error>> {
    // Of its own, so that other builds of the same crates need not begin anew, and another one for each level.
    let target_dir = target_dir().join(format!("c-{opt}"));
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    run(Command::new(cargo)
        .current_dir(root())
        .env("CARGO_TARGET_DIR", &target_dir)
        .env("CARGO_PROFILE_CHIP_OPT_LEVEL", opt)
        .env("RUSTFLAGS", flags)
        .args(["rustc", "--quiet", "--locked", "-p", "capi", "--lib"])
        .args(["--crate-type", kind, "--features", "archive"])
        .args(["--profile", "chip", "--target", target]))?;
    Ok(target_dir.join(target).join("chip"))
}

/// Nothing unwinds, so that no tables for it are due.
fn flags(core: &Core) -> String {
    let mut flags = "-Cforce-unwind-tables=no".to_owned();
    if core.name.starts_with("rv32") {
        // A place in a table of jumps is 32 bytes of an archive there, with relocation and symbol; a comparison is six.
        flags.push_str(" -Cllvm-args=--riscv-min-jump-table-entries=1000");
    }
    if core.name == "rv32imc" {
        // Loads and stores are atomic there, as on the Cortex-M0+; the queues of `heapless` know the latter only.
        flags.push_str(" --cfg=has_atomic_load_store");
    }
    flags
}

/// Exports what the header declares, and needs nothing.
fn check_symbols(
    core: &Core,
    api: &[String],
    tools: &Tools,
    object: &Path,
) -> Result<(), Box<dyn Error>> {
    let names = |option: &str| {
        let table = run(tools
            .run("llvm-nm")
            .args(["--extern-only", "--just-symbol-name", option])
            .arg(object))?;
        let mut names: Vec<String> = table.lines().map(str::to_owned).collect();
        names.sort();
        Ok::<_, Box<dyn Error>>(names)
    };
    let exported = names("--defined-only")?;
    if exported != api {
        return Err(format!("{}: exports {exported:?}, declared are {api:?}", core.name).into());
    }
    let needed = names("--undefined-only")?;
    let strange = needed
        .iter()
        .find(|name| !core.leaves.contains(&name.as_str()));
    match strange {
        Some(name) => Err(format!("{}: needs {name}", core.name).into()),
        None => Ok(()),
    }
}

/// Bytes of code and constants.
fn flash(sections: &str) -> u64 {
    let sizes = sections.lines().filter_map(|line| {
        let mut words = line.split_whitespace();
        let (name, size) = (words.next()?, words.next()?);
        let kept = [".text", ".rodata", ".data"];
        kept.iter()
            .any(|kept| name.starts_with(kept))
            .then(|| size.parse::<u64>().ok())?
    });
    sizes.sum()
}
