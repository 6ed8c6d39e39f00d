//! Files.

use super::error::CommandError;
use crate::cli::Output;
use serde::Serialize;
use sim_host::csv_out::{self, Columns};
use sim_host::figure::{Drawing, Labelled, five_panels};
use sim_host::record;
use sim_host::trace::Trace;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Writes results and remembers what it wrote.
pub struct Writer<'a> {
    output: &'a Output,
}

impl<'a> Writer<'a> {
    pub fn new(output: &'a Output) -> Result<Self, CommandError> {
        fs::create_dir_all(&output.out).map_err(|error| failed(&output.out, &error))?;
        Ok(Self { output })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.output.out.join(name)
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
        let path = self.path(&format!("{name}.csv"));
        let file = File::create(&path).map_err(|error| failed(&path, &error))?;
        write(BufWriter::new(file)).map_err(|error| failed(&path, &error))
    }

    /// A file of that very name.
    pub fn bytes(&self, name: &str, bytes: &[u8]) -> Result<(), CommandError> {
        let path = self.path(name);
        fs::write(&path, bytes).map_err(|error| failed(&path, &error))
    }

    pub fn json(&self, name: &str, records: &[impl Serialize]) -> Result<(), CommandError> {
        let path = self.path(&format!("{name}.json"));
        let text = record::text(records).map_err(|error| failed(&path, &error))?;
        fs::write(&path, text).map_err(|error| failed(&path, &error))
    }
}

fn failed(path: &Path, cause: &dyn std::error::Error) -> CommandError {
    CommandError::Write {
        path: path.to_owned(),
        cause: cause.to_string(),
    }
}
