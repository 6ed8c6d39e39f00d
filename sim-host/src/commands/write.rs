//! Files.

use super::error::CommandError;
use crate::cli::Output;
use serde::Serialize;
use sim_host::csv_out::{self, Columns};
use sim_host::figure::{Drawing, Labelled, five_panels};
use sim_host::record;
use sim_host::trace::Trace;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Writes results and remembers what it wrote.
pub struct Writer<'a> {
    output: &'a Output,
}

impl<'a> Writer<'a> {
    pub fn new(output: &'a Output) -> Result<Self, CommandError> {
        // A device is none either, which `is_file` does not say.
        if output.out.exists() && !output.out.is_dir() {
            return Err(CommandError::OutIsFile(output.out.clone()));
        }
        fs::create_dir_all(&output.out).map_err(|error| failed(&output.out, &error))?;
        Ok(Self { output })
    }

    /// Where a result goes: over an older one, but over no file that the command names.
    fn place(&self, name: &str) -> Result<PathBuf, CommandError> {
        let path = self.output.out.join(name);
        match named(&path) {
            0 => Ok(path),
            _ => Err(CommandError::OverInput(path)),
        }
    }

    pub fn figure(
        &self,
        name: &str,
        title: &str,
        main: Labelled<'_>,
        other: Option<Labelled<'_>>,
    ) -> Result<(), CommandError> {
        self.drawing(name, &five_panels(title, main, other)?)
    }

    /// As SVG and PNG.
    pub fn drawing(&self, name: &str, drawing: &Drawing) -> Result<(), CommandError> {
        self.bytes(&format!("{name}.svg"), drawing.svg().as_bytes())?;
        self.bytes(&format!("{name}.png"), &drawing.png()?)
    }

    pub fn csv(&self, name: &str, trace: &Trace, columns: Columns) -> Result<(), CommandError> {
        let every = self.output.every.get();
        self.rows(name, |out| csv_out::write(trace, columns, every, out))
    }

    /// A CSV file, by what writes it.
    pub fn rows(
        &self,
        name: &str,
        write: impl FnOnce(BufWriter<File>) -> csv::Result<()>,
    ) -> Result<(), CommandError> {
        let path = self.place(&format!("{name}.csv"))?;
        let file = File::create(&path).map_err(|error| failed(&path, &error))?;
        write(BufWriter::new(file)).map_err(|error| failed(&path, &error))
    }

    /// A file of that very name.
    pub fn bytes(&self, name: &str, bytes: &[u8]) -> Result<(), CommandError> {
        let path = self.place(name)?;
        fs::write(&path, bytes).map_err(|error| failed(&path, &error))
    }

    /// Before there are any records.
    pub fn check_json(&self, name: &str) -> Result<(), CommandError> {
        check(&self.place(&format!("{name}.json"))?)
    }

    pub fn json(&self, name: &str, records: &[impl Serialize]) -> Result<(), CommandError> {
        let path = self.place(&format!("{name}.json"))?;
        let text = record::text(records).map_err(|error| failed(&path, &error))?;
        fs::write(&path, text).map_err(|error| failed(&path, &error))
    }
}

/// Whether a file can be written later, which stays as it is: for those who would move a robot or end a file before they find out.
pub fn check(path: &Path) -> Result<(), CommandError> {
    // Its own argument names it once.
    if named(path) > 1 {
        return Err(CommandError::OverInput(path.to_owned()));
    }
    let is_new = path.symlink_metadata().is_err();
    // A pipe is for one writer.
    if path.exists() && !path.is_file() && !path.is_dir() {
        return Ok(());
    }
    let mut open = OpenOptions::new();
    let opened = open.append(true).create(true).open(path).map(drop);
    let tried = opened.and_then(|()| match is_new {
        true => fs::remove_file(path),
        false => Ok(()),
    });
    tried.map_err(|error| failed(path, &error))
}

/// How many arguments of the command are this file, or a part of it, as `BAG:TOPIC` is.
pub fn named(path: &Path) -> usize {
    let Ok(path) = path.canonicalize() else {
        return 0;
    };
    let is_path = |text: &str| {
        Path::new(text)
            .canonicalize()
            .is_ok_and(|named| named == path)
    };
    let arguments = std::env::args_os().skip(1);
    let names = |argument: &OsString| {
        let text = argument.to_string_lossy();
        let value = text.split_once('=').map_or(&*text, |(_, value)| value);
        let whole = value.rsplit_once(':').map_or(value, |(file, _)| file);
        [&*text, value, whole].into_iter().any(is_path)
    };
    arguments.filter(names).count()
}

fn failed(path: &Path, cause: &dyn std::error::Error) -> CommandError {
    CommandError::Write {
        path: path.to_owned(),
        cause: cause.to_string(),
    }
}
