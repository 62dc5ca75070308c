//! Snapshots: all records of a store in one file, whatever backend they are in, and the way back into a new store.
//!
//! Derived indexes are not in it; they are built again. The file, numbers in little endian: 16 bytes `d3dgen-snapshot`
//! and line feed; length (4) and text of a JSON header; for each record 1 (1), the lengths of table (1), key (2) and
//! value (4), then those three, the value as it is stored, with its own checksum; 0 (1); XXH3-64 of all before (8).

use std::fs::File;
use std::hash::Hasher;
use std::io::{BufReader, Read, Seek, Write};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_64;

use crate::error::{Error, Result};
use crate::files;
use crate::format::FORMAT;
use crate::kv::KeyRange;
use crate::records::{self, KEY_LIMIT, Loader, Options, PAYLOAD_LIMIT, Progress, Steps, Store};

const MAGIC: &[u8; 16] = b"d3dgen-snapshot\n";

/// The format of snapshots that is written.
const SNAPSHOT_FORMAT: u32 = 1;

/// Longest header, bytes.
const HEADER_LIMIT: u32 = 1 << 16;

/// What surrounds a payload in the file at most, bytes.
const ENVELOPE_LIMIT: usize = 64;

/// What a snapshot says about itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// Format of the file.
    pub snapshot_format: u32,
    /// Format of the store, which that of the records follows.
    pub store_format: u32,
    /// Revision of the store when the snapshot was taken; a restored store goes on from it.
    pub revision: u64,
    /// How many records there are.
    pub records: u64,
    /// What took it.
    pub written_by: String,
}

/// Writes all records of `store`, as they are now, to the new file `path`: whole, or not at all. Others read meanwhile;
/// with `redb`, the writer goes on writing.
///
/// # Errors
/// [`Error::Exists`]; [`Error::Damaged`] when a record is damaged, which a snapshot must not carry on;
/// [`Error::Cancelled`]; [`Error::Io`].
pub fn write(
    store: &Store,
    path: impl AsRef<Path>,
    written_by: &str,
    observe: &mut dyn FnMut(Progress),
    cancelled: &AtomicBool,
) -> Result<Summary> {
    let path = path.as_ref();
    let view = store.view()?;
    let mut tables = Vec::new();
    for table in view.tables()? {
        tables.push((view.count(&table)?, table));
    }
    let summary = Summary {
        snapshot_format: SNAPSHOT_FORMAT,
        store_format: FORMAT,
        revision: view.revision()?,
        records: tables.iter().map(|(count, _)| count).sum(),
        written_by: written_by.to_owned(),
    };
    let mut steps = Steps::new(summary.records, observe, cancelled);
    steps.report()?;
    files::write_whole(path, false, |file| {
        let mut out = Hashed { inner: file, hash: XxHash3_64::new() };
        let mut put = |bytes: &[u8]| out.put(bytes).map_err(Error::io(path));
        let header =
            serde_json::to_vec(&summary).map_err(|e| Error::Io { path: path.to_path_buf(), source: e.into() })?;
        put(MAGIC)?;
        put(&u32::try_from(header.len()).unwrap_or(u32::MAX).to_le_bytes())?;
        put(&header)?;
        for (expected, table) in &tables {
            let mut found = 0;
            view.raw().scan(table, &KeyRange::all(), &mut |key, value| {
                records::checked(table, key, value)?;
                put(&record_head(table, key, value))?;
                put(table.as_bytes())?;
                put(key)?;
                put(value)?;
                found += 1;
                steps.step()?;
                Ok(ControlFlow::Continue(()))
            })?;
            if found != *expected {
                let reason = format!("table {table} has {found} records, {expected} were stored: verify tells more");
                return Err(Error::Corrupt { path: store.dir().to_path_buf(), reason });
            }
        }
        put(&[0])?;
        let hash = out.hash.finish();
        out.put(&hash.to_le_bytes()).map_err(Error::io(path))
    })?;
    steps.report()?;
    Ok(summary)
}

/// Reads a whole snapshot and checks every byte of it.
///
/// # Errors
/// [`Error::Snapshot`], [`Error::Newer`], [`Error::Io`].
pub fn check(path: impl AsRef<Path>) -> Result<Summary> {
    let path = path.as_ref();
    let mut file = File::open(path).map_err(Error::io(path))?;
    read(&mut file, path, &mut |_, _, _| Ok(()))
}

/// Makes a store in `dir`, which is missing or empty, of the snapshot `path`, with the backend of `options`, and opens
/// it for writing. Nothing is written before the whole snapshot was checked, and `dir` is no store before all of it is
/// there.
///
/// # Errors
/// Those of [`check`] and [`Store::create`]; [`Error::Cancelled`].
pub fn restore(
    path: impl AsRef<Path>,
    dir: impl AsRef<Path>,
    options: &Options,
    observe: &mut dyn FnMut(Progress),
    cancelled: &AtomicBool,
) -> Result<Store> {
    let path = path.as_ref();
    let mut file = File::open(path).map_err(Error::io(path))?;
    let summary = read(&mut file, path, &mut |_, _, _| Ok(()))?;
    let mut steps = Steps::new(summary.records, observe, cancelled);
    steps.report()?;
    let store = records::fill(dir.as_ref(), options, |new| {
        let mut loader = Loader::new(new);
        file.rewind().map_err(Error::io(path))?;
        // Checked again: the file could have been changed in between.
        let summary = read(&mut file, path, &mut |table, key, value| {
            loader.add(table, key, value.to_vec())?;
            steps.step()
        })?;
        loader.finish(summary.revision)
    })?;
    steps.report()?;
    Ok(store)
}

/// What is done with each record: table, key and value with its envelope.
type Each<'a> = dyn FnMut(&str, &[u8], &[u8]) -> Result<()> + 'a;

/// Reads the file from its beginning and calls `visit` with table, key and value, which were checked.
fn read(file: &mut File, path: &Path, visit: &mut Each<'_>) -> Result<Summary> {
    let not = |reason: String| Error::Snapshot { path: path.to_path_buf(), reason };
    let mut input = Input { inner: BufReader::with_capacity(1 << 16, file), hash: XxHash3_64::new(), path };
    let summary = read_header(&mut input)?;
    let mut found = 0;
    let (mut last_table, mut last_key) = (String::new(), Vec::new());
    while input.number(1)? == 1 {
        let [table, key, value] = [input.number(1)?, input.number(2)?, input.number(4)?];
        if key > KEY_LIMIT || value > PAYLOAD_LIMIT + ENVELOPE_LIMIT {
            return Err(not(format!("record {found} is larger than records are")));
        }
        let table = String::from_utf8(input.bytes(table)?).unwrap_or_default();
        let (key, value) = (input.bytes(key)?, input.bytes(value)?);
        records::check_table(&table)
            .and_then(|()| records::check_record(&table, &key, None))
            .and_then(|()| records::checked(&table, &key, &value))
            .map_err(|e| not(e.to_string()))?;
        if found > 0 && (&last_table, &last_key) >= (&table, &key) {
            return Err(not(format!("record {found} is out of order")));
        }
        visit(&table, &key, &value)?;
        (last_table, last_key) = (table, key);
        found += 1;
    }
    let computed = input.hash.finish();
    let stored = input.bytes(8)?;
    if stored != computed.to_le_bytes() {
        return Err(not("its checksum differs".to_owned()));
    }
    if found != summary.records {
        return Err(not(format!("it has {found} records and promises {}", summary.records)));
    }
    match input.inner.read(&mut [0]) {
        Ok(0) => Ok(summary),
        Ok(_) => Err(not("something follows its end".to_owned())),
        Err(source) => Err(Error::Io { path: path.to_path_buf(), source }),
    }
}

fn read_header(input: &mut Input<'_>) -> Result<Summary> {
    let path = input.path.to_path_buf();
    if input.bytes(MAGIC.len())? != MAGIC {
        return Err(Error::Snapshot { path, reason: "it does not begin as one".to_owned() });
    }
    let length = input.number(4)?;
    if length > HEADER_LIMIT as usize {
        return Err(Error::Snapshot { path, reason: format!("its header has {length} bytes, limit {HEADER_LIMIT}") });
    }
    let header: Summary = serde_json::from_slice(&input.bytes(length)?)
        .map_err(|e| Error::Snapshot { path: path.clone(), reason: format!("its header cannot be read: {e}") })?;
    for (found, known) in [(header.snapshot_format, SNAPSHOT_FORMAT), (header.store_format, FORMAT)] {
        if found > known {
            return Err(Error::Newer { path, found, known, written_by: header.written_by });
        }
    }
    Ok(header)
}

/// What stands before table, key and value. All lengths fit: names, keys and payloads are limited.
fn record_head(table: &str, key: &[u8], value: &[u8]) -> [u8; 8] {
    let [k0, k1, ..] = key.len().to_le_bytes();
    let [v0, v1, v2, v3, ..] = value.len().to_le_bytes();
    let [t0, ..] = table.len().to_le_bytes();
    [1, t0, k0, k1, v0, v1, v2, v3]
}

struct Hashed<W> {
    inner: W,
    hash: XxHash3_64,
}

impl<W: Write> Hashed<W> {
    fn put(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.hash.write(bytes);
        self.inner.write_all(bytes)
    }
}

struct Input<'a> {
    inner: BufReader<&'a mut File>,
    hash: XxHash3_64,
    path: &'a Path,
}

impl Input<'_> {
    fn bytes(&mut self, length: usize) -> Result<Vec<u8>> {
        let mut bytes = vec![0; length];
        self.inner.read_exact(&mut bytes).map_err(|source| match source.kind() {
            std::io::ErrorKind::UnexpectedEof => {
                Error::Snapshot { path: self.path.to_path_buf(), reason: "it is cut off".to_owned() }
            }
            _ => Error::Io { path: self.path.to_path_buf(), source },
        })?;
        self.hash.write(&bytes);
        Ok(bytes)
    }

    /// Reads a number of `size` bytes, 4 at most.
    fn number(&mut self, size: usize) -> Result<usize> {
        Ok(self.bytes(size)?.iter().rev().fold(0, |number, byte| (number << 8) | usize::from(*byte)))
    }
}
