//! C for cores that Rust has no compiler for, made by `wasm2c` of the WebAssembly build: one file with the calls of `twb.h`.
//!
//! Of `wasm2c`'s output only what it makes of functions and constants is taken; the run time is `portable/operations.c`, and what
//! turns the header's calls into those of WebAssembly is written here, by the header. Addresses are the machine's, so that nothing
//! is copied and a base stays in the caller's memory. That asks for three things, which are seen to before: no number in memory
//! is less aligned than the machine wants it, constants are one piece, and the stack is as long as the calls need at most.

use std::collections::HashMap;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{cargo_build, run};

/// Its name among the cores.
pub const NAME: &str = "portable";

/// Address of the constants: WebAssembly's stack would be below, and takes no less.
const CONSTANTS: u32 = 16;

/// What nothing is imported but: `memory::fence`.
const FENCE: &str = "twb_fence";

/// Loads and stores by bytes, for numbers at odd places.
const BY_BYTES: &str = "\
  (func $load16 (param i32) (result i32)
    (i32.or (i32.load8_u (local.get 0)) (i32.shl (i32.load8_u offset=1 (local.get 0)) (i32.const 8))))
  (func $load32 (param i32) (result i32)
    (i32.or (call $load16 (local.get 0)) (i32.shl (call $load16 (i32.add (local.get 0) (i32.const 2))) (i32.const 16))))
  (func $load64 (param i32) (result i64)
    (i64.or (i64.extend_i32_u (call $load32 (local.get 0)))
      (i64.shl (i64.extend_i32_u (call $load32 (i32.add (local.get 0) (i32.const 4)))) (i64.const 32))))
  (func $store16 (param i32 i32 i32)
    (local.set 0 (i32.add (local.get 0) (local.get 2)))
    (i32.store8 (local.get 0) (local.get 1))
    (i32.store8 offset=1 (local.get 0) (i32.shr_u (local.get 1) (i32.const 8))))
  (func $store32 (param i32 i32 i32)
    (call $store16 (local.get 0) (local.get 1) (local.get 2))
    (call $store16 (local.get 0) (i32.shr_u (local.get 1) (i32.const 16)) (i32.add (local.get 2) (i32.const 2))))
  (func $store64 (param i32 i64 i32)
    (call $store32 (local.get 0) (i32.wrap_i64 (local.get 1)) (local.get 2))
    (call $store32 (local.get 0) (i32.wrap_i64 (i64.shr_u (local.get 1) (i64.const 32))) (i32.add (local.get 2) (i32.const 4))))
";

/// An instruction, the function of [`BY_BYTES`] for it, and what makes its number of the other's.
const ACCESSES: [[&str; 3]; 16] = [
    ["i32.load16_u", "load16", ""],
    ["i32.load16_s", "load16", "i32.extend16_s"],
    ["i64.load16_u", "load16", "i64.extend_i32_u"],
    ["i32.load", "load32", ""],
    ["f32.load", "load32", "f32.reinterpret_i32"],
    ["i64.load32_u", "load32", "i64.extend_i32_u"],
    ["i64.load32_s", "load32", "i64.extend_i32_s"],
    ["i64.load", "load64", ""],
    ["f64.load", "load64", "f64.reinterpret_i64"],
    ["i32.store16", "store16", ""],
    ["i64.store16", "store16", "i32.wrap_i64"],
    ["i32.store", "store32", ""],
    ["f32.store", "store32", "i32.reinterpret_f32"],
    ["i64.store32", "store32", "i32.wrap_i64"],
    ["i64.store", "store64", ""],
    ["f64.store", "store64", "i64.reinterpret_f64"],
];

/// Writes the file and says where it is.
pub fn build(opt: &str, out: &Path, here: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let flags = format!(
        "-Cforce-unwind-tables=no -Cstrip=symbols -Clink-arg=-zstack-size={CONSTANTS} -Clink-arg=--allow-undefined"
    );
    let library = cargo_build("cdylib", "wasm32-unknown-unknown", opt, &flags)?.join("capi.wasm");
    let text = wabt("wasm2wat", &[library.as_os_str()])?;
    check(&text)?;
    let text = align(&text)?;
    let (aligned, module) = (
        library.with_extension("aligned.wat"),
        library.with_extension("aligned.wasm"),
    );
    fs::write(&aligned, &text)?;
    wabt(
        "wat2wasm",
        &[aligned.as_os_str(), "-o".as_ref(), module.as_os_str()],
    )?;
    let c = library.with_extension("c");
    wabt(
        "wasm2c",
        &["-n", "twb", "-o"]
            .map(AsRef::as_ref)
            .into_iter()
            .chain([c.as_os_str(), module.as_os_str()])
            .collect::<Vec<_>>(),
    )?;
    let header = fs::read_to_string(here.join("include/twb.h"))?;
    let part = |name: &str| fs::read_to_string(here.join("portable").join(name));
    let stacks = stacks(&text)?;
    let file = [
        "/* Made by `archives portable` of the core: change that, not this. */\n",
        &part("operations.c")?,
        &functions(&fs::read_to_string(c)?)?,
        &part("calls.c")?,
        &calls(&header, &stacks)?,
    ]
    .concat();
    let folder = out.join(NAME);
    fs::create_dir_all(&folder)?;
    let to = folder.join("twb.c");
    fs::write(&to, file)?;
    Ok(to)
}

fn wabt(tool: &str, arguments: &[&std::ffi::OsStr]) -> Result<String, Box<dyn Error>> {
    let mut command = Command::new(tool);
    match command.arg("--version").output() {
        Ok(_) => run(Command::new(tool).args(arguments)),
        Err(_) => Err(format!("{tool} is missing: it comes with the package `wabt`").into()),
    }
}

/// What the rest relies on.
fn check(text: &str) -> Result<(), String> {
    let lines = |start: &str| {
        text.lines()
            .map(str::trim)
            .filter(|line| line.starts_with(start))
            .collect::<Vec<_>>()
    };
    let strange = lines("(import")
        .into_iter()
        .find(|line| !line.contains(FENCE));
    if let Some(import) = strange {
        return Err(format!("{NAME}: needs {import}"));
    }
    for refused in ["call_indirect", "memory.grow", "(table", "(start"] {
        if let Some(line) = lines(refused).first() {
            return Err(format!("{NAME}: {line}"));
        }
    }
    let constants = format!("(i32.const {CONSTANTS})");
    match lines("(data").as_slice() {
        [one] if one.contains(&constants) => {}
        others => return Err(format!("{NAME}: {} pieces of constants", others.len())),
    }
    match lines("(global")
        .iter()
        .filter(|line| line.contains("(mut"))
        .count()
    {
        1 => Ok(()),
        more => Err(format!("{NAME}: {more} globals, one for the stack allowed")),
    }
}

/// With calls for numbers that are not aligned to four bytes, or to their length if that is less.
fn align(text: &str) -> Result<String, String> {
    let mut to = String::with_capacity(text.len());
    for line in text.lines() {
        let mut words = line.trim_end_matches(')').split_whitespace();
        let name = words.next().unwrap_or_default();
        let (mut offset, mut alignment) = (0, u32::MAX);
        let loads = name.contains(".load");
        if loads || name.contains(".store") {
            for word in words {
                let number = |text: &str| text.parse().map_err(|_| format!("{NAME}: {line}"));
                match word.split_once('=') {
                    Some(("offset", text)) => offset = number(text)?,
                    Some(("align", text)) => alignment = number(text)?,
                    _ => return Err(format!("{NAME}: {line}")),
                }
            }
        }
        let aligned = alignment >= 4 || name.contains('8') || alignment == 2 && name.contains("16");
        if aligned {
            to.push_str(line);
            to.push('\n');
            continue;
        }
        let Some([_, function, convert]) = ACCESSES.iter().find(|access| access[0] == name) else {
            return Err(format!("{NAME}: {line}"));
        };
        let rest = &line[line.trim_end_matches(')').len()..];
        let text = if loads {
            format!("i32.const {offset} i32.add call ${function} {convert}")
        } else {
            format!("{convert} i32.const {offset} call ${function}")
        };
        writeln!(to, "{text}{rest}").map_err(|error| error.to_string())?;
    }
    let end = to.rfind(')').ok_or("no module")?;
    to.insert_str(end, &format!("\n{BY_BYTES}"));
    Ok(to)
}

/// Most bytes of stack that each exported function takes, with all that it calls.
fn stacks(text: &str) -> Result<HashMap<String, u32>, String> {
    let mut functions: Vec<(u32, Vec<usize>)> = Vec::new();
    let mut exports = Vec::new();
    let mut last = ["", ""];
    for line in text.lines().map(|line| line.trim().trim_end_matches(')')) {
        if line.starts_with("(func") || line.starts_with("(import") {
            functions.push((0, Vec::new()));
        } else if let Some(export) = line.strip_prefix("(export \"")
            && let Some((name, number)) = export.split_once("\" (func ")
        {
            let number = number.parse().map_err(|_| format!("{NAME}: {line}"))?;
            exports.push((name.to_owned(), number));
        }
        if let Some(function) = functions.last_mut() {
            if let Some(called) = line.strip_prefix("call ") {
                // Those by bytes have no stack.
                function.1.extend(called.parse::<usize>());
            }
            // `stack pointer - bytes`, as every function begins that has a frame.
            if line == "i32.sub" && last[0] == "global.get 0" {
                let bytes = last[1].strip_prefix("i32.const ");
                let bytes = bytes.and_then(|bytes| bytes.parse::<u32>().ok());
                function.0 += bytes.ok_or_else(|| format!("{NAME}: a frame of unknown length"))?;
            }
        }
        last = [last[1], line];
    }
    let moves = text.matches("global.set 0").count();
    let frames = functions.iter().filter(|function| function.0 > 0).count();
    // Taken and given back; one that does not return gives nothing back.
    if moves < frames || moves == 0 {
        return Err(format!(
            "{NAME}: {frames} frames, {moves} moves of the stack"
        ));
    }
    let mut known = vec![None; functions.len()];
    let mut depths = HashMap::new();
    for (name, number) in exports {
        depths.insert(name, depth(number, &functions, &mut known, 0)?);
    }
    Ok(depths)
}

fn depth(
    function: usize,
    functions: &[(u32, Vec<usize>)],
    known: &mut [Option<u32>],
    calls: usize,
) -> Result<u32, String> {
    if let Some(depth) = known[function] {
        return Ok(depth);
    }
    if calls > functions.len() {
        return Err(format!("{NAME}: functions that call each other"));
    }
    let (own, called) = &functions[function];
    let mut most = 0;
    for called in called {
        most = most.max(depth(*called, functions, known, calls + 1)?);
    }
    known[function] = Some(own + most);
    Ok(own + most)
}

/// Functions and constants of what `wasm2c` wrote.
fn functions(c: &str) -> Result<String, String> {
    let mut to = String::with_capacity(c.len());
    let mut lines = c.lines();
    let mut constants = 0;
    let (mut prototypes, mut bodies) = (String::new(), String::new());
    while let Some(line) = lines.next() {
        let of_core = line.starts_with("static ") && line.contains("(Z_twb_instance_t*");
        let data = line.starts_with("static const u8 data_segment_data");
        if of_core && line.ends_with(';') {
            prototypes.push_str(line);
            prototypes.push('\n');
        } else if of_core && line.contains(" w2c_") {
            bodies.push_str(line);
            bodies.push('\n');
            for line in lines.by_ref() {
                bodies.push_str(line);
                bodies.push('\n');
                if line == "}" {
                    break;
                }
            }
        } else if data {
            let mut bytes = String::new();
            for line in lines.by_ref().take_while(|line| *line != "};") {
                bytes.push_str(line);
                bytes.push('\n');
                constants += line.matches("0x").count();
            }
            // 16: what a stack is aligned to, and where addresses are looked at by their last bits.
            writeln!(
                to,
                "\nstatic const struct constants {{\n    u8 none[{CONSTANTS}];\n    u8 bytes[{constants}];\n}} constants \
                 __attribute__((aligned(16))) = {{{{0}}, {{\n{bytes}}}}};\n"
            )
            .map_err(|error| error.to_string())?;
        }
    }
    if constants == 0 || bodies.is_empty() || prototypes.is_empty() {
        return Err(format!(
            "{NAME}: `wasm2c` wrote something else than version 1.0.32 does"
        ));
    }
    to.push_str(&prototypes);
    to.push('\n');
    to.push_str(&bodies);
    let fence = format!("(*Z_envZ_{FENCE})(instance->Z_env_instance)");
    Ok(to
        .replace("Z_twb_instance_t", "call_t")
        .replace(&fence, &format!("{FENCE}(instance)")))
}

/// The header's functions.
fn calls(header: &str, stacks: &HashMap<String, u32>) -> Result<String, String> {
    let mut to = String::new();
    for line in header.lines() {
        let declares = !line.starts_with([' ', '#', '/', '}']) && line.ends_with(");");
        let Some((before, parameters)) = line.split_once('(') else {
            continue;
        };
        let name = before.rsplit([' ', '*']).next().unwrap_or_default();
        if !declares || !name.starts_with("twb_") {
            continue;
        }
        let stack = stacks
            .get(name)
            .ok_or_else(|| format!("{NAME}: {name} is not exported"))?;
        let mut arguments = "&call".to_owned();
        let parameters = parameters.trim_end_matches(");").split(", ");
        for (number, parameter) in parameters.filter(|one| *one != "void").enumerate() {
            let name = parameter.rsplit([' ', '*']).next().unwrap_or_default();
            arguments.push_str(", ");
            if parameter.contains('*') {
                let piece = number + 1;
                write!(arguments, "address(&call, {piece}, {name})")
            } else if parameter.starts_with("size_t") {
                write!(arguments, "bytes({name})")
            } else {
                write!(arguments, "(u32){name}")
            }
            .map_err(|error| error.to_string())?;
        }
        let result = match before.trim_end_matches(name).trim() {
            "const char *" => "text(",
            "int32_t" => "(int32_t)(",
            _ => "(",
        };
        let declared = line.trim_end_matches(';');
        writeln!(
            to,
            "\n{declared} {{\n    CALL({stack});\n    return {result}w2c_{name}({arguments}));\n}}"
        )
        .map_err(|error| error.to_string())?;
    }
    Ok(to)
}
