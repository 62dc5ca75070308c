//! The index as Parquet: one row a world, flat columns that any reader of tables shows.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::error::Error;
use crate::row::Row;

/// Rows that are written at once.
const ROWS: usize = 5_000;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Text,
    Whole,
    Real,
    Texts,
    Reals,
}

/// A value of a row.
#[derive(Debug, Clone, PartialEq)]
enum Cell {
    Text(Option<String>),
    Whole(i64),
    Real(Option<f64>),
    Texts(Vec<String>),
    Reals(Vec<f64>),
}

/// A world as the index has it: its row, and where its files are.
#[derive(Debug)]
pub struct Indexed<'a> {
    /// What is known of it.
    pub row: &'a Row,
    /// Its key in the shard.
    pub key: &'a str,
    /// Path of the shard.
    pub shard: &'a str,
    /// Split.
    pub split: &'a str,
    /// Extension, SHA-256 and size of each of its files.
    pub files: Vec<(String, String, u64)>,
}

/// The columns of the index.
#[derive(Debug, Clone)]
pub struct Columns {
    slots: Vec<String>,
    figures: Vec<String>,
}

const FIRST: &[(&str, Kind)] = &[
    ("key", Kind::Text),
    ("shard", Kind::Text),
    ("split", Kind::Text),
    ("files", Kind::Texts),
    ("digests", Kind::Texts),
    ("content_sha256", Kind::Text),
    ("bytes", Kind::Whole),
    ("task", Kind::Text),
    ("prompt", Kind::Text),
    ("seed", Kind::Whole),
    ("placement_variant", Kind::Whole),
    ("scenario_variant", Kind::Whole),
    ("domain", Kind::Text),
    ("kind", Kind::Text),
    ("country", Kind::Text),
    ("language", Kind::Text),
    ("rooms", Kind::Whole),
    ("room_types", Kind::Texts),
    ("assets", Kind::Texts),
    ("robots", Kind::Texts),
    ("robot_widths_m", Kind::Reals),
    ("clear_width_m", Kind::Real),
    ("rules_held", Kind::Texts),
    ("violated", Kind::Texts),
    ("attempts", Kind::Whole),
    ("models", Kind::Texts),
    ("generator", Kind::Text),
    ("snapshot_sha256", Kind::Text),
];

impl Columns {
    /// Returns the columns for these slots and figures.
    pub fn of(slots: &BTreeSet<String>, figures: &BTreeSet<String>) -> Self {
        let fixed: BTreeSet<&str> = FIRST.iter().map(|c| c.0).collect();
        let own = figures.iter().filter(|f| !fixed.contains(f.as_str()));
        Self { slots: slots.iter().cloned().collect(), figures: own.cloned().collect() }
    }

    fn all(&self) -> Vec<(String, Kind)> {
        let fixed = FIRST.iter().map(|(name, kind)| ((*name).to_owned(), *kind));
        let slots = self.slots.iter().map(|s| (format!("slot_{s}"), Kind::Text));
        let figures = self.figures.iter().map(|f| (f.clone(), Kind::Real));
        fixed.chain(slots).chain(figures).collect()
    }

    fn cells(&self, world: &Indexed<'_>) -> Vec<Cell> {
        let row = world.row;
        let text = |t: &str| Cell::Text(Some(t.to_owned()));
        let list = |l: &[String]| Cell::Texts(l.to_vec());
        let mut models: Vec<String> = row.models.values().cloned().collect();
        models.sort();
        models.dedup();
        let mut cells = vec![
            text(world.key),
            text(world.shard),
            text(world.split),
            Cell::Texts(world.files.iter().map(|f| f.0.clone()).collect()),
            Cell::Texts(world.files.iter().map(|f| f.1.clone()).collect()),
            text(&row.content_sha256),
            Cell::Whole(world.files.iter().map(|f| f.2).sum::<u64>() as i64),
            text(&row.task),
            text(&row.prompt),
            Cell::Whole(row.seed as i64),
            Cell::Whole(row.placement_variant.into()),
            Cell::Whole(row.scenario_variant.into()),
            text(&row.domain),
            Cell::Text(row.kind.clone()),
            Cell::Text(row.country.clone()),
            text(&row.language),
            Cell::Whole(row.rooms.into()),
            list(&row.room_types),
            list(&row.assets),
            list(&row.robots),
            Cell::Reals(row.robot_widths_m.clone()),
            Cell::Real(row.clear_width_m),
            list(&row.rules_held),
            list(&row.violated),
            Cell::Whole(row.attempts.into()),
            Cell::Texts(models),
            text(&row.generator),
            text(&row.snapshot_sha256),
        ];
        cells.extend(self.slots.iter().map(|s| Cell::Text(row.slots.get(s).cloned())));
        cells.extend(self.figures.iter().map(|f| Cell::Real(row.figures.get(f).copied())));
        cells
    }
}

/// Writes the index of one split.
pub struct Table {
    columns: Columns,
    kinds: Vec<Kind>,
    rows: Vec<Vec<Cell>>,
    writer: SerializedFileWriter<BufWriter<File>>,
    path: PathBuf,
}

impl Table {
    /// Begins a file.
    ///
    /// # Errors
    /// `Write`.
    pub fn begin(path: &Path, columns: &Columns) -> Result<Self, Error> {
        let all = columns.all();
        let fields = all.iter().map(|(name, kind)| field(name, *kind)).collect::<Result<Vec<_>, _>>();
        let schema = fields.and_then(|fields| Type::group_type_builder("world").with_fields(fields).build());
        let schema = schema.map_err(refused(path))?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("d3dgen ", env!("CARGO_PKG_VERSION")).to_owned())
            .build();
        let file = BufWriter::new(File::create(path).map_err(Error::write(path))?);
        let writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).map_err(refused(path))?;
        let kinds = all.into_iter().map(|c| c.1).collect();
        Ok(Self { columns: columns.clone(), kinds, rows: Vec::new(), writer, path: path.to_path_buf() })
    }

    /// Adds a world.
    ///
    /// # Errors
    /// `Write`.
    pub fn add(&mut self, world: &Indexed<'_>) -> Result<(), Error> {
        self.rows.push(self.columns.cells(world));
        if self.rows.len() >= ROWS { self.flush() } else { Ok(()) }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// `Write`.
    pub fn finish(mut self) -> Result<(), Error> {
        if !self.rows.is_empty() {
            self.flush()?;
        }
        let mut file = self.writer.into_inner().map_err(refused(&self.path))?;
        file.flush().map_err(Error::write(&self.path))
    }

    fn flush(&mut self) -> Result<(), Error> {
        let rows = std::mem::take(&mut self.rows);
        let path = self.path.clone();
        let mut written = || -> Result<(), ParquetError> {
            let mut group = self.writer.next_row_group()?;
            let mut at = 0;
            while let Some(mut column) = group.next_column()? {
                write_column(&mut column, self.kinds[at], rows.iter().map(|row| &row[at]))?;
                column.close()?;
                at += 1;
            }
            group.close().map(|_| ())
        };
        written().map_err(refused(&path))
    }
}

fn refused(path: &Path) -> impl FnOnce(ParquetError) -> Error {
    let path = path.to_path_buf();
    move |error| Error::write(&path)(std::io::Error::other(error))
}

fn field(name: &str, kind: Kind) -> Result<TypePtr, ParquetError> {
    let primitive = |name: &str, of: Physical, repetition: Repetition| {
        let text = (of == Physical::BYTE_ARRAY).then_some(LogicalType::String);
        Type::primitive_type_builder(name, of).with_logical_type(text).with_repetition(repetition).build().map(Arc::new)
    };
    let list = |of: Physical| {
        let element = primitive("element", of, Repetition::REQUIRED)?;
        let list = Type::group_type_builder("list")
            .with_repetition(Repetition::REPEATED)
            .with_fields(vec![element])
            .build()?;
        Type::group_type_builder(name)
            .with_logical_type(Some(LogicalType::List))
            .with_repetition(Repetition::REQUIRED)
            .with_fields(vec![Arc::new(list)])
            .build()
            .map(Arc::new)
    };
    match kind {
        Kind::Text => primitive(name, Physical::BYTE_ARRAY, Repetition::OPTIONAL),
        Kind::Whole => primitive(name, Physical::INT64, Repetition::REQUIRED),
        Kind::Real => primitive(name, Physical::DOUBLE, Repetition::OPTIONAL),
        Kind::Texts => list(Physical::BYTE_ARRAY),
        Kind::Reals => list(Physical::DOUBLE),
    }
}

fn write_column<'c>(
    column: &mut SerializedColumnWriter<'_>,
    kind: Kind,
    cells: impl Iterator<Item = &'c Cell>,
) -> Result<(), ParquetError> {
    let (mut texts, mut wholes, mut reals) = (Vec::new(), Vec::new(), Vec::new());
    // definition: whether there is a value; repetition: whether it goes on with the list of the one before
    let (mut definitions, mut repetitions): (Vec<i16>, Vec<i16>) = (Vec::new(), Vec::new());
    let mut list = |length: usize| {
        definitions.extend(std::iter::repeat_n(i16::from(length > 0), length.max(1)));
        repetitions.extend((0..length.max(1)).map(|i| i16::from(i > 0)));
    };
    for cell in cells {
        match cell {
            Cell::Text(text) => {
                list(usize::from(text.is_some()));
                texts.extend(text.iter().map(|t| ByteArray::from(t.as_str())));
            }
            Cell::Whole(n) => wholes.push(*n),
            Cell::Real(x) => {
                list(usize::from(x.is_some()));
                reals.extend(x);
            }
            Cell::Texts(all) => {
                list(all.len());
                texts.extend(all.iter().map(|t| ByteArray::from(t.as_str())));
            }
            Cell::Reals(all) => {
                list(all.len());
                reals.extend(all);
            }
        }
    }
    match kind {
        Kind::Whole => column.typed::<Int64Type>().write_batch(&wholes, None, None)?,
        Kind::Text => column.typed::<ByteArrayType>().write_batch(&texts, Some(&definitions), None)?,
        Kind::Real => column.typed::<DoubleType>().write_batch(&reals, Some(&definitions), None)?,
        Kind::Texts => column.typed::<ByteArrayType>().write_batch(&texts, Some(&definitions), Some(&repetitions))?,
        Kind::Reals => column.typed::<DoubleType>().write_batch(&reals, Some(&definitions), Some(&repetitions))?,
    };
    Ok(())
}
