//! What C and C++ get: the header under strict compilers, every call with every bad argument, and a mission whose bits are Rust's.

#[path = "support/mission.rs"]
mod mission;

use std::collections::BTreeMap;
use std::ffi::CStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::{env, fs};

use capi::names;
use controller_core::base::BaseParams;
use controller_core::motor::{DriverParams, SpeedParams};
use firmware_demo::robots::LAB_10KG;
use protocol::{CRC, MAX_ROBOT_BLOB, ROBOT_BLOB_VERSION, encode_robot};
use tests::program::package;
use tests::stated::{At, Stated};

const STRICT: [&str; 4] = ["-pedantic", "-Wall", "-Wextra", "-Werror"];

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scratch() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("c");
    fs::create_dir_all(&folder).expect("a folder can be made");
    folder
}

/// Where the workspace and all images are built, since most of what they depend on is the same.
fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("..")
}

fn succeed(command: &mut Command) -> Output {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(
        output.status.success(),
        "{command:?} failed:\n{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// The archives that are built here: of the host, of both emulated boards, and the largest.
const CORES: [&str; 4] = ["host", "cortex-m4f", "rv32imafc", "rv32imac"];

/// The folder with the archives of [`CORES`] and the portable C.
fn archives() -> &'static Path {
    &built().0
}

/// With what the builder printed of them.
fn built() -> &'static (PathBuf, String) {
    static BUILT: OnceLock<(PathBuf, String)> = OnceLock::new();
    BUILT.get_or_init(|| {
        let out = scratch().join("archives");
        let output = succeed(
            Command::new(env!("CARGO_BIN_EXE_archives"))
                .env("CARGO_TARGET_DIR", scratch())
                .env("CARGO_BUILD_BUILD_DIR", target())
                .arg("--out")
                .arg(&out)
                .args(CORES)
                .arg("portable"),
        );
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        (out, printed)
    })
}

fn blob(params: &BaseParams<f32>) -> Vec<u8> {
    let mut bytes = [0; MAX_ROBOT_BLOB];
    encode_robot(params, &mut bytes)
        .expect("a blob has room")
        .to_vec()
}

/// With the check made right again.
fn checked(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let check = CRC.checksum(&bytes[..end]).to_le_bytes();
    bytes[end..].copy_from_slice(&check);
    bytes
}

/// `robots.h`: the robot of the examples, with blobs that are to be refused beside it.
fn robot_header() -> &'static Path {
    // Once, for tests run side by side.
    static WRITTEN: OnceLock<PathBuf> = OnceLock::new();
    WRITTEN.get_or_init(write_robots)
}

/// The bytes of the array in a robot's header.
fn bytes_in(header: &str) -> Vec<u8> {
    let (_, array) = header.split_once("] = {").expect("an array");
    let words = array.split([',', '}']).map(str::trim);
    words
        .map_while(|word| u8::from_str_radix(word.strip_prefix("0x")?, 16).ok())
        .collect()
}

fn write_robots() -> PathBuf {
    let good = blob(&LAB_10KG.base);
    let mut other_version = good.clone();
    other_version[4..6].copy_from_slice(&(ROBOT_BLOB_VERSION + 1).to_le_bytes());
    let mut heavy = LAB_10KG.base;
    heavy.motion.robot.mass_kg = -1.0;
    let mut speeds = LAB_10KG.base;
    speeds.driver = DriverParams::Speeds(SpeedParams {
        max_speed_rad_s: 20.0,
        min_speed_rad_s: 0.0,
        lag_s: 0.02,
        breakaway_nm: 0.0,
    });
    speeds.detectors.wheels.stuck.torque_nm = 0.0;
    let mut no_parameters = good[..24].to_vec();
    no_parameters[6..8].copy_from_slice(&12_u16.to_le_bytes());
    let kept = fs::read_to_string(here().join("examples/lab_10kg.h")).expect("the examples' robot");
    assert_eq!(
        bytes_in(&kept),
        good,
        "run `sim-host constants lab-10kg --c --out bindings/c/examples`"
    );
    let mut text = kept;
    for (name, bytes) in [
        ("other_version", checked(other_version)),
        ("out_of_range", blob(&heavy)),
        ("no_parameters", checked(no_parameters)),
        ("with_speed_drivers", blob(&speeds)),
    ] {
        writeln!(text, "static const uint8_t {name}[] = {{").expect("text");
        for byte in bytes {
            write!(text, "{byte},").expect("text");
        }
        text.push_str("};\n");
    }
    let folder = scratch().join("robot");
    fs::create_dir_all(&folder).expect("a folder can be made");
    fs::write(folder.join("robots.h"), text).expect("a file can be written");
    folder
}

/// What programs of the host are linked with: the archive, or C for any core. Below [`archives`].
const HOST: [&str; 2] = ["lib/host/libtwb.a", PORTABLE];

/// The same functions in C.
const PORTABLE: &str = "portable/twb.c";

/// What a program is linked with for `functions`, below [`archives`]: C is compiled once for each compiler, since it is as long as
/// a hundred of the programs here.
fn linked(functions: &str, compiler: Command, compiled: &OnceLock<PathBuf>) -> PathBuf {
    let source = archives().join(functions);
    if functions != PORTABLE {
        return source;
    }
    let compile = |mut compiler: Command| {
        let name = Path::new(compiler.get_program()).display();
        let object = scratch().join(format!("{name}-portable.o"));
        succeed(compiler.arg("-c").arg(source).arg("-o").arg(&object));
        object
    };
    compiled.get_or_init(|| compile(compiler)).clone()
}

/// The compiler of the host in a language standard.
fn host_compiler(compiler: &str, standard: &str) -> Command {
    let mut compiler = Command::new(compiler);
    compiler
        .args([standard, "-O1", "-ffp-contract=off"])
        .args(STRICT)
        .arg("-I")
        .arg(here().join("include"));
    compiler
}

/// Builds a program of the host from sources of `tests/c` with the archive, in a language standard.
fn program(name: &str, compiler: &str, standard: &str, sources: &[&str]) -> PathBuf {
    program_with(HOST[0], name, compiler, standard, sources)
}

fn program_with(
    functions: &str,
    name: &str,
    compiler: &str,
    standard: &str,
    sources: &[&str],
) -> PathBuf {
    static PORTABLE_OF_HOST: OnceLock<PathBuf> = OnceLock::new();
    let functions_of_host = linked(
        functions,
        host_compiler("gcc", "-std=c99"),
        &PORTABLE_OF_HOST,
    );
    let to = scratch().join(format!("{name}-{}", functions.replace('/', "-")));
    succeed(
        host_compiler(compiler, standard)
            .arg("-I")
            .arg(robot_header())
            .args(
                sources
                    .iter()
                    .map(|source| here().join("tests/c").join(source)),
            )
            .arg(functions_of_host)
            .arg("-o")
            .arg(&to),
    );
    to
}

#[test]
fn headers_are_clean_in_every_standard() {
    let languages = [
        ("gcc", "c", &["c99", "c11", "c17"][..], "twb.h"),
        ("g++", "c++", &["c++11", "c++17", "c++20"], "twb.h"),
        ("g++", "c++", &["c++17", "c++20"], "twb.hpp"),
    ];
    for (compiler, language, standards, header) in languages {
        for standard in standards {
            // Included twice, as programs do.
            let source = scratch().join(format!("{language}-{standard}-{header}.source"));
            let text = format!(
                "#include \"{header}\"\n#include \"{header}\"\nint main(void) {{ return 0; }}\n"
            );
            fs::write(&source, text).expect("a file can be written");
            succeed(
                Command::new(compiler)
                    .arg(format!("-std={standard}"))
                    .args(STRICT)
                    .args(["-fsyntax-only", "-x", language])
                    .arg("-I")
                    .arg(here().join("include"))
                    .arg(&source),
            );
        }
    }
}

/// Each number of an enumeration has the name that it has in Rust, and there are no others.
#[test]
fn the_header_has_every_state_cause_and_fault() {
    let header = fs::read_to_string(here().join("include/twb.h")).expect("the header");
    let of_header = |prefix: &str| {
        let defined = header.lines().filter_map(|line| {
            let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
            let name = name.strip_prefix(prefix)?.to_ascii_lowercase();
            let value = value.split(' ').next()?.strip_suffix('u')?;
            Some((value.parse().ok()?, name))
        });
        defined.collect::<Vec<(u32, String)>>()
    };
    let of_rust = |first: u32, name: fn(u32) -> &'static CStr| {
        let names =
            (first..).map(|code| (code, name(code).to_str().expect("a name").replace(' ', "_")));
        let known = names.take_while(|(_, name)| name != "unknown");
        known.collect::<Vec<_>>()
    };
    assert_eq!(of_header("TWB_FAULT_"), of_rust(1, names::fault));
    assert_eq!(of_header("TWB_CAUSE_"), of_rust(0, names::cause));
    let mut states = of_rust(0, names::state);
    for (_, name) in &mut states {
        *name = name.replace("_for_a_fault", "_fault");
    }
    assert_eq!(of_header("TWB_STATE_"), states);
}

/// What `bad_arguments.c` prints.
fn assert_all_refused(text: &str) {
    let checks: u32 = text
        .split_whitespace()
        .next()
        .and_then(|word| word.parse().ok())
        .expect("a number of checks");
    assert!(checks > 3600 && text.contains(" 0 failed"), "{text}");
}

#[test]
fn every_call_refuses_every_bad_argument_and_changes_nothing() {
    for functions in HOST {
        let sources = ["bad_arguments.c"];
        let program = program_with(functions, "bad_arguments", "gcc", "-std=c99", &sources);
        let output = succeed(&mut Command::new(program));
        assert_all_refused(&String::from_utf8_lossy(&output.stdout));
    }
}

/// There the caller's pointers are the addresses of the portable C; on the host, pieces of memory are.
#[test]
fn portable_c_refuses_every_bad_argument_where_pointers_are_addresses() {
    assert_all_refused(&CORTEX_M4F.run(PORTABLE, &["bad_arguments.c"]));
}

#[test]
fn an_emergency_stop_from_an_interrupt_is_obeyed_by_the_tick_that_it_interrupts() {
    for functions in HOST {
        let sources = ["interrupted.c"];
        let program = program_with(functions, "interrupted", "gcc", "-std=c99", &sources);
        let output = succeed(&mut Command::new(program));
        let text = String::from_utf8_lossy(&output.stdout);
        assert_eq!(
            text.trim(),
            "100 stops within a tick, 10 within a begin, all obeyed"
        );
    }
}

/// As `twb_tick` says in the header.
#[test]
fn a_tick_that_comes_too_late_is_a_latched_stop_with_torques() {
    let program = program("late", "gcc", "-std=c99", &["late.c"]);
    let output = succeed(&mut Command::new(program));
    let text = String::from_utf8_lossy(&output.stdout);
    let stop = "stopping for a fault, tick_too_long, driven, 6.667 rad/s";
    let lines: Vec<_> = text.lines().collect();
    // A pose is missing then, as ever.
    assert_eq!(lines[0], "90000 stopping, pose_stale, driven, 6.667 rad/s");
    assert_eq!(
        lines[1..],
        [100_000, 500_000, 600_000, 2_000_000].map(|us| format!("{us} {stop}"))
    );
}

#[test]
fn the_class_parks_a_base() {
    let program = program("park", "g++", "-std=c++17", &["park.cpp"]);
    let output = succeed(&mut Command::new(program));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.starts_with("parked at 1.00") || text.starts_with("parked at 0.99"),
        "{text}"
    );
}

/// The class for ros2_control, whose headers are in no registry: compiled and called by the declarations that it uses.
#[test]
fn a_base_under_ros2_control_drives_and_stops() {
    let control = here().join("../ros2/control");
    for standard in ["-std=c++17", "-std=c++20"] {
        let program = scratch().join(format!("system{standard}"));
        succeed(
            Command::new("g++")
                .args([standard, "-O1", "-ffp-contract=off"])
                .args(STRICT)
                .args(["include", "tests/stub"].map(|folder| {
                    let folder = control.join(folder);
                    format!("-I{}", folder.display())
                }))
                .arg(format!("-I{}", here().join("include").display()))
                .arg(format!("-I{}", robot_header().display()))
                .arg(control.join("tests/system.cpp"))
                .arg(archives().join("lib/host/libtwb.a"))
                .arg("-o")
                .arg(&program),
        );
        let output = succeed(&mut Command::new(program));
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.starts_with("a base under ros2_control"), "{text}");
    }
}

/// Ticks of the mission: 33 cycles of parking, driving by velocity, following, stops and faults.
const TICKS: u32 = 200_000;

/// What Rust gives.
fn expected() -> &'static str {
    static RUN: OnceLock<String> = OnceLock::new();
    RUN.get_or_init(|| mission::run(&LAB_10KG.base, TICKS))
}

#[test]
fn a_mission_from_c_has_the_bits_of_rust() {
    let expected = expected();
    let numbers = |key: &str, radix| {
        let mut words = expected.split_whitespace();
        words.find(|word| *word == key).expect("the key");
        u32::from_str_radix(words.next().expect("its number"), radix).expect("a number")
    };
    // All states but a stop that a latched fault waits for and a brake that none does; silent encoders, poses, host and driver.
    assert_eq!(numbers("states", 16), 0b111_0011_1111, "{expected}");
    assert_eq!(numbers("faults", 16) & 0x407, 0x407, "{expected}");
    assert!(numbers("parked", 10) > TICKS / 5, "{expected}");
    for functions in HOST {
        let sources = ["run_mission.c", "mission.c"];
        let program = program_with(functions, "mission", "gcc", "-std=c99", &sources);
        let output = succeed(Command::new(program).arg(TICKS.to_string()));
        assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), expected);
    }
}

#[test]
fn cmake_finds_the_archive_and_its_example_parks() {
    // By itself, and as it is ordered.
    for core in ["", "portable"] {
        let build = scratch().join(format!("cmake-{core}"));
        // A cache that another checkout left in the same target folder is refused.
        if build.exists() {
            fs::remove_dir_all(&build).expect("it can be removed");
        }
        succeed(
            Command::new("cmake")
                .arg("-S")
                .arg(here().join("examples/cmake"))
                .arg("-B")
                .arg(&build)
                .arg(format!("-DTWB_CORE={core}"))
                .arg(format!("-DCMAKE_C_FLAGS={}", STRICT.join(" ")))
                .arg(format!("-Dtwb_DIR={}", archives().display())),
        );
        succeed(Command::new("cmake").arg("--build").arg(&build));
        let output = succeed(&mut Command::new(build.join("park")));
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.starts_with("parked at"), "{text}");
    }
}

/// What the packages for other build systems name is what the builder builds; those systems are not here to ask.
#[test]
fn packages_name_archives_that_there_are() {
    let output = Command::new(env!("CARGO_BIN_EXE_archives"))
        .arg("no such core")
        .output()
        .expect("the builder can be started");
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let (_, cores) = said.split_once("there are ").expect("a list of cores");
    let cores: Vec<&str> = cores.split([',', ' ', '"', '\n']).collect();
    let package = here().join("package");
    for (file, least) in [
        ("twb-config.cmake", 5),
        ("CMakeLists.txt", 3),
        ("platformio.py", 7),
        ("zephyr/CMakeLists.txt", 8),
    ] {
        let text = fs::read_to_string(package.join(file)).expect("a file of the package");
        let words = text.split(|c: char| !c.is_alphanumeric() && c != '-');
        // As the value of a setting or in an assignment; flags that are compared with stand in MATCHES.
        let named: Vec<&str> = words
            .filter(|word| cores.contains(word) && *word != "host")
            .collect();
        assert!(named.len() >= least, "{file}: {named:?}");
        for line in text
            .lines()
            .filter(|line| line.contains("set(TWB_CORE ") || line.contains("set(twb_cores_"))
        {
            let core = line
                .trim_end_matches(')')
                .rsplit(' ')
                .next()
                .unwrap_or_default();
            assert!(
                cores.contains(&core) || core == "rv32${CMAKE_MATCH_1}",
                "{file}: {line}"
            );
        }
    }
}

#[test]
fn archives_are_as_large_as_stated() {
    let mut page = Stated::of("docs/c.md");
    let mut cores = 0;
    for line in built().1.lines().skip(1) {
        let mut words = line.split_whitespace();
        let core = format!("`{}`", words.next().expect("a core"));
        let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
        let [flash, size] = numbers[..] else { continue };
        cores += 1;
        for (column, bytes) in [
            ("flash, opt-level 3 \\[B\\]", flash),
            ("archive \\[B\\]", size),
        ] {
            page.exactly(At::Cell("Cost", &core, column), &[bytes]);
        }
    }
    assert_eq!(cores, CORES.len());
}

/// Whoever asks the builder what it takes is told; and so is who asks for what there is not.
#[test]
fn the_builder_says_what_it_takes() {
    for (argument, code, told) in [
        (
            "--help",
            0,
            "usage: archives [--opt LEVEL] [--out FOLDER] [CORE]...",
        ),
        ("--help", 0, "rv32imafc, portable"),
        ("--cores", 1, "no option --cores: see --help"),
        ("z80", 1, "no core z80: there are host, cortex-m0plus, "),
    ] {
        let mut builder = Command::new(env!("CARGO_BIN_EXE_archives"));
        let output = builder.arg(argument).output().expect("it runs");
        let said = if code == 0 {
            &output.stdout
        } else {
            &output.stderr
        };
        let said = String::from_utf8_lossy(said);
        assert_eq!(output.status.code(), Some(code));
        assert!(said.contains(told), "{said}");
    }
}

/// Xtensa is what the portable C is for; the compiler of the ESP8266 has neither floats nor divisions in its library.
#[test]
fn portable_c_is_clean_for_xtensa_and_needs_nothing_but_its_compilers_functions() {
    // As Arduino and PlatformIO find it.
    let source = archives().join("src/twb_portable.c");
    let object = scratch().join("xtensa.o");
    succeed(
        Command::new("xtensa-lx106-elf-gcc")
            .args(["-std=c99", "-O1", "-ffreestanding", "-mlongcalls", "-c"])
            .args(STRICT)
            .arg("-I")
            .arg(here().join("include"))
            .arg(source)
            .arg("-o")
            .arg(&object),
    );
    let symbols = succeed(Command::new("xtensa-lx106-elf-nm").arg("-g").arg(&object));
    let symbols = String::from_utf8_lossy(&symbols.stdout).into_owned();
    let (mut calls, mut needed) = (0, 0);
    for line in symbols.lines() {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["U", name] if name.starts_with("__") => needed += 1,
            [_, "T", name] if name.starts_with("twb_") => calls += 1,
            _ => panic!("{line}"),
        }
    }
    assert!(calls == 17 && needed > 10, "{symbols}");
}

/// What PlatformIO's builder has of a board, and what the script makes of it.
#[test]
fn the_script_for_platformio_links_the_archive_of_the_board_or_compiles_c() {
    let script = r#"
import json, os, sys
os.chdir(sys.argv[1])
class Env(dict):
    def __init__(self, board, flags):
        self.update(CCFLAGS=flags)
        self.board, self.added = board, {}
    def BoardConfig(self):
        return self.board
    def Append(self, **added):
        self.added.update(added)
for board, flags in [
    ({"build.cpu": "cortex-m4", "build.mcu": "stm32f411ret6"}, ["-mfloat-abi=hard"]),
    ({"build.cpu": "cortex-m4", "build.mcu": "nrf52840"}, ["-mfloat-abi=softfp"]),
    ({"build.mcu": "esp32c3"}, []),
    ({"build.mcu": "esp32s3"}, []),
]:
    env = Env(board, flags)
    exec(open("platformio.py").read(), {"env": env, "Import": lambda name: None})
    paths = [os.path.basename(path) for path in env.added.get("LIBPATH", [])]
    print(*paths, *env.added.get("LIBS", []), *env.added.get("CPPDEFINES", []))
"#;
    let output = succeed(
        Command::new("python3")
            .args(["-c", script])
            .arg(here().join("package")),
    );
    assert_eq!(
        String::from_utf8_lossy(&output.stdout),
        "cortex-m4f twb\ncortex-m4 twb\nrv32imc twb\nTWB_PORTABLE\n"
    );
}

/// A cross compiler, an emulator, and the core's archive.
struct Board {
    core: &'static str,
    compiler: &'static str,
    machine: &'static [&'static str],
    map: &'static str,
    emulator: &'static [&'static str],
    /// The portable C as its compiler makes it.
    portable: OnceLock<PathBuf>,
}

static CORTEX_M4F: Board = Board {
    core: "cortex-m4f",
    compiler: "arm-none-eabi-gcc",
    machine: &[
        "-mcpu=cortex-m4",
        "-mthumb",
        "-mfloat-abi=hard",
        "-mfpu=fpv4-sp-d16",
    ],
    map: "mps2-an386.ld",
    emulator: &["qemu-system-arm", "-M", "mps2-an386"],
    portable: OnceLock::new(),
};

static RV32IMAFC: Board = Board {
    core: "rv32imafc",
    compiler: "riscv64-unknown-elf-gcc",
    machine: &["-march=rv32imafc", "-mabi=ilp32f"],
    map: "virt.ld",
    emulator: &["qemu-system-riscv32", "-M", "virt", "-bios", "none"],
    portable: OnceLock::new(),
};

impl Board {
    /// Its archive, below [`archives`].
    fn archive(&self) -> String {
        format!("lib/{}/libtwb.a", self.core)
    }

    /// The distribution's cross compiler, without a C library.
    fn compiler(&self) -> Command {
        let mut compiler = Command::new(self.compiler);
        compiler
            .args(self.machine)
            .args(["-std=c99", "-O2", "-ffreestanding", "-nostdlib"])
            .args(["-ffp-contract=off", "-fno-tree-loop-distribute-patterns"])
            .args(STRICT)
            .arg("-I")
            .arg(here().join("include"));
        compiler
    }

    /// What a program of the board is linked with.
    fn functions(&self, functions: &str) -> PathBuf {
        linked(functions, self.compiler(), &self.portable)
    }

    /// What a program in C prints on the emulated board.
    fn run(&self, functions: &str, program: &[&str]) -> String {
        let sources = here().join("tests/c");
        let name = [program[0], functions].join("-").replace('/', "-");
        let image = scratch().join(format!("{}-{name}", self.core));
        succeed(
            self.compiler()
                .arg(format!("-DTICKS={TICKS}u"))
                .arg("-I")
                .arg(sources.join("bare"))
                .arg("-I")
                .arg(robot_header())
                .arg("-T")
                .arg(sources.join(self.map))
                .arg(sources.join("emulated.c"))
                .args(program.iter().map(|source| sources.join(source)))
                .arg(self.functions(functions))
                .args(["-lgcc", "-o"])
                .arg(&image),
        );
        let (program, arguments) = self.emulator.split_first().expect("a program");
        let output = succeed(
            Command::new("timeout")
                .args(["120", program])
                .args(arguments)
                .args([
                    "-nographic",
                    "-semihosting-config",
                    "enable=on,target=native",
                ])
                .arg("-kernel")
                .arg(&image),
        );
        let printed = [output.stdout, output.stderr].concat();
        String::from_utf8_lossy(&printed).trim().to_owned()
    }
}

impl Board {
    /// Runs the mission in C, which has to have the bits of Rust; the bytes of stack that its begin, the rest of it, and a report took.
    fn mission(&self, functions: &str) -> Vec<f64> {
        let printed = self.run(functions, &["run_emulated.c", "mission.c"]);
        let (bits, stack) = printed.split_once("\nstack ").expect("two lines");
        assert_eq!(bits, expected());
        let numbers = stack.split(' ').map(|word| word.parse());
        numbers.collect::<Result<_, _>>().expect("numbers")
    }
}

#[test]
fn a_mission_from_c_has_the_bits_of_rust_on_an_emulated_rv32() {
    RV32IMAFC.mission(&RV32IMAFC.archive());
    RV32IMAFC.mission(PORTABLE);
}

#[test]
fn a_mission_from_c_has_the_bits_of_rust_on_an_emulated_cortex_m4f() {
    let archive = CORTEX_M4F.mission(&CORTEX_M4F.archive());
    let portable = CORTEX_M4F.mission(PORTABLE);
    let mut header = Stated::of("bindings/c/include/twb.h");
    let calls = "twb_init takes #, twb_tick # and twb_get_report #";
    header.about(At::Phrase(calls), &archive);
    let calls = "as portable C #, # and #.";
    header.about(At::Phrase(calls), &portable);
}

/// A core with what an image in Rust needs of its run time.
struct Image<'a> {
    board: &'a Board,
    target: &'a str,
    run_time: &'a str,
    linker: &'a [&'a str],
    map: &'a str,
    icount: &'a str,
}

impl Image<'_> {
    /// These functions with names that no function of the image has, once their ticks are counted.
    fn object(&self, functions: &str) -> PathBuf {
        let name = format!("{}-{}", self.board.core, functions.replace('/', "-"));
        scratch().join(format!("called-{name}.o"))
    }

    /// What each tick of the image of `tests/overhead` took, and the duties of both motors: in Rust, or through these functions.
    fn ticks(&self, through: Option<&str>) -> Vec<[u32; 3]> {
        // Once for each image, and one after the other: they are built at the same place.
        static COUNTED: Mutex<BTreeMap<String, Vec<[u32; 3]>>> = Mutex::new(BTreeMap::new());
        let mut counted = COUNTED.lock().unwrap_or_else(PoisonError::into_inner);
        let image = format!("{} {through:?}", self.board.core);
        let ticks = counted.entry(image);
        ticks.or_insert_with(|| self.count(through)).clone()
    }

    fn count(&self, through: Option<&str>) -> Vec<[u32; 3]> {
        let folder = scratch().join("overhead").join(self.board.core);
        let dependencies = format!(
            "{}\ncapi = {{ path = \"bindings/c\" }}\ncontroller-core.workspace = true\nprotocol.workspace = true\n\
             firmware-demo = {{ workspace = true, features = [\"panic-proof\", \"robots\"] }}",
            self.run_time
        );
        package(&folder, "overhead", &dependencies);
        let copy = |from: PathBuf, to: &str| {
            fs::copy(from, folder.join(to)).expect("a file can be copied");
        };
        copy(here().join("tests/overhead/tick.rs"), "src/main.rs");
        let maps = here().join("../../firmware-demo/memory");
        copy(maps.join(self.map), "memory.x");
        let search = format!("-L{}", folder.display());
        let mut linked = Vec::new();
        if let Some(functions) = through {
            let object = self.object(functions);
            let names = ["init", "arm", "tick"];
            succeed(
                Command::new(self.board.compiler.replace("gcc", "objcopy"))
                    .args(names.map(|name| format!("--redefine-sym=twb_{name}=called_{name}")))
                    .args(names.map(|name| format!("--keep-global-symbol=called_{name}")))
                    .arg(self.board.functions(functions))
                    .arg(&object),
            );
            linked.push(format!("{}", object.display()));
        }
        let flags = self.linker.iter().copied().chain([search.as_str()]);
        let flags = flags.chain(linked.iter().map(String::as_str));
        let flags = flags.map(|flag| format!("-Clink-arg={flag}"));
        succeed(
            Command::new(env!("CARGO"))
                .current_dir(&folder)
                .env("CARGO_TARGET_DIR", target())
                .args(["rustc", "--quiet", "--profile", "chip"])
                .args(["--target", self.target, "--", "--check-cfg", "cfg(in_rust)"])
                .args(through.is_none().then_some("--cfg=in_rust"))
                // For the program alone: flags of all would build what it depends on anew for each configuration.
                .args(flags),
        );
        let (program, arguments) = self.board.emulator.split_first().expect("a program");
        let output = succeed(
            Command::new("timeout")
                .args(["120", program])
                .args(arguments)
                .args(["-nographic", "-semihosting-config"])
                .args(["enable=on,target=native", "-icount", self.icount, "-kernel"])
                .arg(target().join(self.target).join("chip/overhead")),
        );
        let printed = [output.stdout, output.stderr].concat();
        let printed = String::from_utf8_lossy(&printed);
        let rows = printed.lines().filter_map(|line| {
            let mut numbers = line.strip_prefix("tick ")?.split(' ');
            let mut number = || numbers.next()?.parse().ok();
            Some([number()?, number()?, number()?])
        });
        rows.collect()
    }

    /// What each tick takes in Rust and through these functions.
    fn both(&self, functions: &str) -> Vec<[u32; 2]> {
        let (rust, c) = (self.ticks(None), self.ticks(Some(functions)));
        assert_eq!((rust.len(), c.len()), (3000, 3000));
        let both = rust.iter().zip(&c).map(|(rust, c)| {
            assert_eq!(rust[1..], c[1..], "the duties");
            [rust[0], c[0]]
        });
        both.collect()
    }

    /// Most and mean that a tick takes more through the archive than in Rust.
    fn more(&self) -> (i64, f64) {
        let both = self.both(&self.board.archive());
        let more = both
            .iter()
            .map(|[rust, c]| i64::from(*c) - i64::from(*rust));
        let more: Vec<i64> = more.collect();
        let mean = more.iter().sum::<i64>() as f64 / more.len() as f64;
        let most = *more.iter().max().expect("ticks");
        let rust: u32 = both.iter().map(|[rust, _]| rust).sum();
        let rust = f64::from(rust) / both.len() as f64;
        println!(
            "{}: {mean:.1} more than {rust:.1}, at most {most}",
            self.board.core
        );
        (most, mean)
    }
}

static IMAGE_M4F: Image<'_> = Image {
    board: &CORTEX_M4F,
    target: "thumbv7em-none-eabihf",
    run_time: "cortex-m-rt = \"0.7.5\"",
    linker: &["--nmagic", "-Tlink.x"],
    map: "mps2-an386.x",
    icount: "shift=10",
};

#[test]
fn a_tick_from_c_takes_few_instructions_more() {
    let riscv = Image {
        board: &RV32IMAFC,
        target: "riscv32imafc-unknown-none-elf",
        run_time: "riscv-rt = { version = \"0.16\", features = [\"single-hart\"] }",
        linker: &["-Tmemory.x", "-Tlink.x"],
        map: "virt.x",
        icount: "shift=0",
    };
    let mut page = Stated::of("docs/c.md");
    for (image, core) in [
        (&IMAGE_M4F, "the emulated Cortex-M4F"),
        (&riscv, "the RV32IMAFC"),
    ] {
        let (most, mean) = image.more();
        let phrase = format!("# instructions more than in Rust on {core}, at most #");
        page.exactly(At::Phrase(&phrase), &[mean, most as f64]);
    }
}

#[test]
fn a_tick_of_portable_c_takes_at_most_three_times_the_instructions() {
    let both = IMAGE_M4F.both(PORTABLE);
    let mean = |part: usize| {
        let sum: u64 = both.iter().map(|ticks| u64::from(ticks[part])).sum();
        sum as f64 / both.len() as f64
    };
    let (rust, c) = (mean(0), mean(1));
    println!("{c:.0} instructions, {rust:.0} in Rust");
    assert!(c <= 3.0 * rust, "{c} against {rust}");
    let size = succeed(Command::new("arm-none-eabi-size").arg(IMAGE_M4F.object(PORTABLE)));
    let text = String::from_utf8_lossy(&size.stdout).into_owned();
    let row = text.lines().nth(1).expect("a row of numbers");
    let sizes: Vec<f64> = row
        .split_whitespace()
        .map_while(|word| word.parse().ok())
        .collect();
    // Code with constants; then what a program would have to keep for it.
    assert_eq!(sizes[1..3], [0.0, 0.0], "data and bss: {text}");
    let mut page = Stated::of("docs/c.md");
    page.about(
        At::Phrase("A tick takes # instructions in the mean, # in Rust"),
        &[c, rust],
    );
    page.about(
        At::Phrase("the file takes # bytes of flash there"),
        &sizes[..1],
    );
}
