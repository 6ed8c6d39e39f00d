//! Builds the page: one HTML file, with the program in it.
//!
//! ```sh
//! cargo run -p page --bin page                       # target/page.html
//! cargo run -p page --bin page -- --out page.html
//! ```
//!
//! It needs `rustup target add wasm32-unknown-unknown`, and nothing else. A page is refused that needs anything from outside of
//! it, or that has more than [`MOST_BYTES`].

use lzma_rust2::{LzmaOptions, LzmaWriter};
use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Most bytes of the page.
const MOST_BYTES: usize = 400_000;
/// The page's scripts, in order, and its style.
const SCRIPTS: [&str; 6] = [
    "1-wasm.js",
    "2-rows.js",
    "3-map.js",
    "4-plots.js",
    "5-main.js",
    "6-board.js",
];
const STYLE: &str = "page.css";
const FRAME: &str = "page.html";
/// Where the target's programs are.
const TARGET: &str = "wasm32-unknown-unknown";

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = target_dir().join("page.html");
    let mut arguments = env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--out" => out = PathBuf::from(arguments.next().ok_or("--out needs a file")?),
            other => return Err(format!("{other} is not known: there is --out FILE").into()),
        }
    }
    let program = program()?;
    let html = page(&program)?;
    if let Some(folder) = out.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(&out, &html)?;
    println!(
        "{}: {} bytes, of which {} a program of {}",
        out.display(),
        html.len(),
        packed(&program)?.len(),
        program.len()
    );
    Ok(())
}

/// The library as a program for browsers.
fn program() -> Result<Vec<u8>, Box<dyn Error>> {
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--locked", "--package", "page", "--lib"])
        .args(["--profile", "page", "--target", TARGET])
        .current_dir(root())
        .env("CARGO_TARGET_DIR", target_dir())
        .status()?;
    if !status.success() {
        return Err(format!("it needs the target: rustup target add {TARGET}").into());
    }
    let wasm = fs::read(target_dir().join(TARGET).join("page").join("page.wasm"))?;
    if imports(&wasm) {
        return Err("the program needs something from outside of it".into());
    }
    Ok(wasm)
}

/// Whether a wasm module has a section of imports (2).
fn imports(wasm: &[u8]) -> bool {
    let mut rest = wasm.get(8..).unwrap_or_default();
    while let Some((&id, after)) = rest.split_first() {
        let (mut length, mut shift, mut at) = (0_usize, 0, 0);
        while let Some(byte) = after.get(at) {
            length |= usize::from(byte & 0x7f) << shift;
            (shift, at) = (shift + 7, at + 1);
            if byte & 0x80 == 0 {
                break;
            }
        }
        if id == 2 {
            return true;
        }
        rest = after.get(at + length..).unwrap_or_default();
    }
    false
}

/// As text: base91 of an LZMA stream, which `1-wasm.js` unpacks with the same `lc`, `lp` and `pb`.
fn packed(program: &[u8]) -> Result<String, Box<dyn Error>> {
    let options = LzmaOptions {
        lc: 4,
        lp: 0,
        pb: 0,
        nice_len: LzmaOptions::NICE_LEN_MAX,
        depth_limit: 1000,
        ..LzmaOptions::with_preset(9)
    };
    let mut writer = LzmaWriter::new_no_header(Vec::new(), &options, false)?;
    writer.write_all(program)?;
    Ok(base91(&writer.finish()?))
}

/// Thirteen bits in two digits, the lowest first: 91 of them are what ASCII prints but for the space and `&`, `<` and `>`, which mean
/// something in HTML.
fn base91(bytes: &[u8]) -> String {
    const BITS: u32 = 13;
    let digits: Vec<char> = ('!'..='~').filter(|c| !"&<>".contains(*c)).collect();
    let mut text = String::new();
    let (mut held, mut count) = (0_u32, 0);
    // What is left at the end is filled up with zeros, of which the program's length tells.
    for &byte in bytes.iter().chain(&[0; 2]) {
        held |= u32::from(byte) << count;
        count += 8;
        if count >= BITS {
            let value = (held & ((1 << BITS) - 1)) as usize;
            text.push(digits[value % digits.len()]);
            text.push(digits[value / digits.len()]);
            (held, count) = (held >> BITS, count - BITS);
        }
    }
    text
}

fn page(program: &[u8]) -> Result<String, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
    let read = |name: &str| -> std::io::Result<String> {
        Ok(lean(&fs::read_to_string(folder.join(name))?))
    };
    let scripts: String = SCRIPTS
        .iter()
        .map(|name| read(name))
        .collect::<Result<_, _>>()?;
    let html = read(FRAME)?
        .replace("/*CSS*/", closed_up(&read(STYLE)?).trim_end())
        .replace("/*JS*/", scripts.trim_end())
        .replace("/*SIZE*/", &program.len().to_string())
        .replace("/*WASM*/", &packed(program)?);
    if html.len() > MOST_BYTES {
        let most = MOST_BYTES;
        return Err(format!("the page has {} bytes, at most are {most}", html.len()).into());
    }
    Ok(html)
}

/// Without indentation and comments of their own lines, which nobody reads here.
fn lean(text: &str) -> String {
    let lines = text.lines().map(str::trim);
    let kept = lines.filter(|line| !line.is_empty() && !line.starts_with("//"));
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// A style without the blanks beside its punctuation.
fn closed_up(style: &str) -> String {
    [" {", "{ ", "; ", ": ", ", ", " }"]
        .iter()
        .fold(style.to_owned(), |style, pair| {
            style.replace(pair, pair.trim())
        })
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn target_dir() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}
