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

/// As letters of the page's encoding: an LZMA stream, which `1-wasm.js` unpacks with the same `lc`, `lp` and `pb`.
fn packed(program: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
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
    Ok(letters(&writer.finish()?))
}

/// Every byte is a letter of windows-1252, as browsers read it, and stays what it is within a script, but for two: they make another
/// letter of 0, and a line feed of a carriage return. With `<` a script might end, or a comment begin. These, moved by 64, stand behind
/// a `=`, and so does `=` itself.
fn letters(bytes: &[u8]) -> Vec<u8> {
    let mut letters = Vec::with_capacity(bytes.len() + bytes.len() / 50);
    for &byte in bytes {
        match byte {
            0 | b'\r' | b'<' | b'=' => letters.extend([b'=', byte + 64]),
            _ => letters.push(byte),
        }
    }
    letters
}

/// In ASCII, which is the same in every encoding of pages.
fn ascii(text: &str, escaped: fn(u32) -> String) -> String {
    let letters = text.chars().map(|c| match c {
        '\0'..='\x7f' => c.to_string(),
        _ => escaped(c.into()),
    });
    letters.collect()
}

fn page(program: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
    let read = |name: &str| -> std::io::Result<String> {
        Ok(lean(&fs::read_to_string(folder.join(name))?))
    };
    let scripts: String = SCRIPTS
        .iter()
        .map(|name| read(name))
        .collect::<Result<_, _>>()?;
    let html = ascii(&read(FRAME)?, |c| format!("&#{c};"))
        .replace("/*CSS*/", closed_up(&read(STYLE)?).trim_end())
        .replace("/*SIZE*/", &program.len().to_string())
        .replace(
            "/*JS*/",
            ascii(&scripts, |c| format!("\\u{{{c:x}}}")).trim_end(),
        );
    let (before, after) = html.split_once("/*WASM*/").ok_or("a place for it")?;
    let html = [before.as_bytes(), &packed(program)?, after.as_bytes()].concat();
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
