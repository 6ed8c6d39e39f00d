//! Parts in Parquet files.

use super::error::{FileProblem, WriteError};
use super::{Shard, Study};
use crate::csv_out::{Cell, Kind, Sheet};
use crc::{CRC_64_XZ, Crc, Digest};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The column of the runs as they are.
const RECORD: &str = "record";
/// The name in the file's metadata under which it tells what it is.
const HEADER: &str = "two-wheeled-base.part";
/// And its checksum.
const HEADER_CHECK: &str = "two-wheeled-base.part.check";
/// A checksum against mistakes, not against forgery.
const CHECK: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// What a file tells of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    /// What made it.
    pub program: Program,
    pub command: String,
    /// To make the other parts; says nothing of the study.
    pub arguments: Vec<String>,
    pub settings: serde_json::Value,
    /// Number of all runs.
    pub runs: usize,
    pub shard: Shard,
    /// Of its runs as they are kept.
    pub records: u64,
    /// Of its columns: runs that are read as others than were written do not make the same ones.
    pub columns: u64,
}

/// Of this program.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// As far as programs may differ between parts of one study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Program {
    pub version: String,
    /// Of the texts that the study reads inside the program.
    pub built_in: u64,
}

impl Program {
    pub(super) fn of(study: &impl Study) -> Self {
        let mut digest = CHECK.digest();
        for text in study.built_in() {
            field(&mut digest, text.as_bytes());
        }
        Self {
            version: VERSION.to_owned(),
            built_in: digest.finalize(),
        }
    }
}

/// A part as it was read.
#[derive(Debug)]
pub(super) struct Part {
    pub header: Header,
    pub records: Vec<ByteArray>,
}

/// Writes runs of a study, which are those of a part of it, and returns their number. The file is there with all its runs, or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write<S: Study>(
    path: &Path,
    study: &S,
    shard: Shard,
    runs: &[S::Run],
) -> Result<(), WriteError> {
    let broken = |error: &dyn std::fmt::Display| WriteError::Record(error.to_string());
    let count = study.count().map_err(|e| broken(&e))?;
    let sheet = study
        .sheet(shard.places(count).start, runs)
        .map_err(|e| broken(&e))?;
    let records = runs
        .iter()
        .map(postcard::to_allocvec)
        .collect::<Result<Vec<_>, _>>();
    let records = records.map_err(|e| broken(&e))?;
    let records: Vec<_> = records.into_iter().map(ByteArray::from).collect();
    let header = Header {
        program: Program::of(study),
        command: S::COMMAND.to_owned(),
        // There are no other parts of a whole, which has the same bytes wherever it was put together.
        arguments: match shard {
            Shard::WHOLE => Vec::new(),
            _ => study.arguments(),
        },
        settings: serde_json::to_value(study).map_err(|e| broken(&e))?,
        runs: count,
        shard,
        records: records_check(&records),
        columns: columns_check(&sheet),
    };
    let header = serde_json::to_string(&header).map_err(|e| broken(&e))?;
    // On the same disk, so that it takes its name at once; two writers do not meet.
    let mut beside = path.as_os_str().to_owned();
    beside.push(format!(".{}", std::process::id()));
    let beside = PathBuf::from(beside);
    let written = write_file(&beside, &sheet, &records, header);
    let named = written.and_then(|()| Ok(fs::rename(&beside, path)?));
    if named.is_err() {
        // The first error is the one to tell.
        let _ = fs::remove_file(&beside);
    }
    named
}

pub(super) fn records_check(records: &[ByteArray]) -> u64 {
    let mut digest = CHECK.digest();
    for record in records {
        field(&mut digest, record.data());
    }
    digest.finalize()
}

pub(super) fn columns_check(sheet: &Sheet) -> u64 {
    let mut digest = CHECK.digest();
    for (name, cells) in sheet {
        field(&mut digest, name.as_bytes());
        for cell in cells {
            field(&mut digest, cell.to_string().as_bytes());
        }
    }
    digest.finalize()
}

/// As checksums are shown.
pub(super) fn hexadecimal(check: u64) -> String {
    format!("{check:016x}")
}

/// Of a text alone.
pub(super) fn text_check(text: &str) -> u64 {
    CHECK.checksum(text.as_bytes())
}

/// With its length, so that two fields are not one.
fn field(digest: &mut Digest<'_, u64>, bytes: &[u8]) {
    digest.update(&(bytes.len() as u64).to_le_bytes());
    digest.update(bytes);
}

fn write_file(
    path: &Path,
    sheet: &Sheet,
    records: &[ByteArray],
    header: String,
) -> Result<(), WriteError> {
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        // No two are alike.
        .set_column_dictionary_enabled(ColumnPath::from(RECORD), false)
        .set_key_value_metadata(Some(vec![
            KeyValue::new(HEADER_CHECK.to_owned(), hexadecimal(text_check(&header))),
            KeyValue::new(HEADER.to_owned(), header),
        ]))
        .build();
    let file = File::create(path)?;
    let mut writer = SerializedFileWriter::new(file, schema(sheet)?, Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    for (_, cells) in sheet {
        if let Some(kind) = cells.first().map(Cell::kind) {
            column(&mut rows, kind, cells)?;
        }
    }
    put::<ByteArrayType>(&mut rows, records, None)?;
    rows.close()?;
    let file = writer.into_inner()?;
    file.sync_all()?;
    Ok(())
}

/// The columns of the table, and the record. A part without runs has the record only: nothing tells what its columns are of.
fn schema(sheet: &Sheet) -> ParquetResult<TypePtr> {
    let mut fields = Vec::new();
    for (name, cells) in sheet {
        if let Some(kind) = cells.first().map(Cell::kind) {
            let (physical, logical) = match kind {
                Kind::Number => (Physical::DOUBLE, None),
                Kind::Whole => (Physical::INT64, Some(LogicalType::integer(64, false))),
                Kind::Flag => (Physical::BOOLEAN, None),
                Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            };
            let column = Type::primitive_type_builder(name, physical)
                .with_logical_type(logical)
                .with_repetition(Repetition::OPTIONAL);
            fields.push(Arc::new(column.build()?));
        }
    }
    let record = Type::primitive_type_builder(RECORD, Physical::BYTE_ARRAY)
        .with_repetition(Repetition::REQUIRED);
    fields.push(Arc::new(record.build()?));
    let runs = Type::group_type_builder("runs").with_fields(fields);
    Ok(Arc::new(runs.build()?))
}

fn column(
    rows: &mut SerializedRowGroupWriter<'_, File>,
    kind: Kind,
    cells: &[Cell],
) -> ParquetResult<()> {
    let there = |cell: &Cell| i16::from(!matches!(cell, Cell::Nothing(_)));
    let levels: Vec<i16> = cells.iter().map(there).collect();
    let levels = Some(levels.as_slice());
    match kind {
        Kind::Number => {
            let number = |cell: &Cell| match cell {
                Cell::Number(number) | Cell::Scientific(number) => Some(*number),
                Cell::Single(number) => Some(f64::from(*number)),
                _ => None,
            };
            put::<DoubleType>(
                rows,
                &cells.iter().filter_map(number).collect::<Vec<_>>(),
                levels,
            )
        }
        Kind::Whole => {
            let number = |cell: &Cell| match cell {
                // The bits of an unsigned one, as the column is declared.
                Cell::Whole(number) => Some(number.cast_signed()),
                _ => None,
            };
            put::<Int64Type>(
                rows,
                &cells.iter().filter_map(number).collect::<Vec<_>>(),
                levels,
            )
        }
        Kind::Flag => {
            let flag = |cell: &Cell| match cell {
                Cell::Flag(flag) => Some(*flag),
                _ => None,
            };
            put::<BoolType>(
                rows,
                &cells.iter().filter_map(flag).collect::<Vec<_>>(),
                levels,
            )
        }
        Kind::Text => {
            let text = |cell: &Cell| match cell {
                Cell::Text(text) => Some(ByteArray::from(text.as_str())),
                _ => None,
            };
            put::<ByteArrayType>(
                rows,
                &cells.iter().filter_map(text).collect::<Vec<_>>(),
                levels,
            )
        }
    }
}

fn put<T: DataType>(
    rows: &mut SerializedRowGroupWriter<'_, File>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> ParquetResult<()> {
    if let Some(mut column) = rows.next_column()? {
        column.typed::<T>().write_batch(values, levels, None)?;
        column.close()?;
    }
    Ok(())
}

/// Reads a file.
pub(super) fn read(path: &Path) -> Result<Part, FileProblem> {
    let file = SerializedFileReader::new(File::open(path)?)?;
    let about = file.metadata().file_metadata();
    let entry = |key: &str| {
        let mut entries = about.key_value_metadata().into_iter().flatten();
        let entry = entries.find(|entry| entry.key == key);
        entry.and_then(|entry| entry.value.as_deref())
    };
    let header = entry(HEADER).ok_or(FileProblem::Foreign)?;
    if entry(HEADER_CHECK) != Some(hexadecimal(text_check(header)).as_str()) {
        return Err(FileProblem::Damaged);
    }
    let header = serde_json::from_str(header);
    let header: Header = header.map_err(FileProblem::Header)?;
    let columns = about.schema_descr().columns();
    let record = columns.iter().position(|column| column.name() == RECORD);
    let record = record.ok_or(FileProblem::Foreign)?;
    let mut records = Vec::new();
    for group in 0..file.num_row_groups() {
        let rows = file.get_row_group(group)?;
        // The library takes these as they are, and panics.
        let place = rows.metadata().column(record);
        let numbers = [
            place.data_page_offset(),
            place.dictionary_page_offset().unwrap_or(0),
            place.compressed_size(),
        ];
        if numbers.iter().any(|number| *number < 0) {
            return Err(FileProblem::Damaged);
        }
        let ColumnReader::ByteArrayColumnReader(mut column) = rows.get_column_reader(record)?
        else {
            return Err(FileProblem::Foreign);
        };
        let many = usize::try_from(rows.metadata().num_rows()).unwrap_or_default();
        column.read_records(many, None, None, &mut records)?;
    }
    Ok(Part { header, records })
}
