//! Where the results of tasks are: in the blocks of parts, or in the shards of a data set that is finished already.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::pack::{FAILURE, MODELS, ROW, key, scan};
use crate::part::Part;
use crate::row::{Failure, Row};
use crate::tasks::TaskId;

/// Folder of the shards of a data set.
pub const SHARDS: &str = "shards";
/// Name of shards of shared models.
pub const MODEL_SHARD: &str = "models-";
/// File of a data set with the tasks that came to no world, one a line.
pub const FAILURES: &str = "failures.jsonl";

/// The results of tasks, by task.
#[derive(Debug, Default)]
pub struct Shelf {
    files: Vec<PathBuf>,
    worlds: HashMap<TaskId, Place>,
    failures: HashMap<TaskId, Failure>,
    models: BTreeMap<String, Bytes>,
    figures: BTreeSet<String>,
}

/// A world in a tar file: where the header of its first member begins.
#[derive(Debug, Clone, Copy)]
struct Place {
    file: u32,
    at: u64,
}

/// Bytes in a file.
#[derive(Debug, Clone, Copy)]
struct Bytes {
    file: u32,
    at: u64,
    size: u64,
}

/// A world as it lies in a tar file.
#[derive(Debug)]
pub struct Stored {
    /// What is known of it.
    pub row: Row,
    /// The bytes of its row.
    pub row_bytes: Vec<u8>,
    /// Its other files, in their order.
    pub members: Vec<(String, Vec<u8>)>,
}

impl Shelf {
    /// Adds the finished blocks of a part.
    ///
    /// # Errors
    /// `Damaged` when a block is not what its ledger says; `Read`.
    pub fn add_part(&mut self, part: &Part) -> Result<(), Error> {
        for done in part.done() {
            self.add_tar(&part.block_file(done.block))?;
        }
        Ok(())
    }

    /// Adds the worlds of a finished data set.
    ///
    /// # Errors
    /// `Damaged`, `Read`.
    pub fn add_dataset(&mut self, folder: &Path) -> Result<(), Error> {
        for path in tars(folder)? {
            self.add_tar(&path)?;
        }
        for failure in failures(folder)? {
            let id = TaskId::parse(&failure.task);
            let id = id.ok_or_else(|| Error::damaged(&folder.join(FAILURES), "has a line without a task"))?;
            self.failures.insert(id, failure);
        }
        Ok(())
    }

    fn add_tar(&mut self, path: &Path) -> Result<(), Error> {
        let file = self.files.len() as u32;
        self.files.push(path.to_path_buf());
        let is_models = path.file_name().and_then(|n| n.to_str()).is_some_and(|n| n.starts_with(MODEL_SHARD));
        scan(path, 0, &mut |member| {
            if is_models || member.name.starts_with(MODELS) {
                let name = member.name.strip_prefix(MODELS).unwrap_or(&member.name).to_owned();
                self.models.entry(name).or_insert(Bytes { file, at: member.bytes_at, size: member.size });
                return Ok(true);
            }
            let at = member.header_at;
            match member.key().map(|(_, ext)| ext == FAILURE) {
                Some(true) => {
                    let failure: Failure = json(path, &member.read().map_err(Error::read(path))?)?;
                    let id = TaskId::parse(&failure.task).ok_or_else(|| Error::damaged(path, "has no task"))?;
                    self.failures.insert(id, failure);
                }
                Some(false)
                    if member.name.ends_with(&format!(".{ROW}")) && key(&member.name).is_some_and(|k| k.1 == ROW) =>
                {
                    let row: Row = json(path, &member.read().map_err(Error::read(path))?)?;
                    let id =
                        TaskId::parse(&row.task).ok_or_else(|| Error::damaged(path, "has a row without a task"))?;
                    self.figures.extend(row.figures.into_keys());
                    self.worlds.insert(id, Place { file, at });
                }
                _ => {}
            }
            Ok(true)
        })
    }

    /// Returns true when it is known what became of a task.
    pub fn has(&self, id: TaskId) -> bool {
        self.worlds.contains_key(&id) || self.failures.contains_key(&id)
    }

    /// Returns why a task came to no world.
    pub fn failure(&self, id: TaskId) -> Option<&Failure> {
        self.failures.get(&id)
    }

    /// Returns the names of all figures that any world has.
    pub fn figures(&self) -> &BTreeSet<String> {
        &self.figures
    }

    /// Returns the names of all shared models.
    pub fn models(&self) -> impl Iterator<Item = &str> {
        self.models.keys().map(String::as_str)
    }

    /// Returns a shared model.
    ///
    /// # Errors
    /// `Read`; `Damaged` when no file has it.
    pub fn model(&self, name: &str) -> Result<Vec<u8>, Error> {
        let missing = || Error::damaged(Path::new(name), "is a shared model that no file has");
        let place = self.models.get(name).ok_or_else(missing)?;
        let path = &self.files[place.file as usize];
        let mut file = File::open(path).map_err(Error::read(path))?;
        file.seek(SeekFrom::Start(place.at)).map_err(Error::read(path))?;
        let mut bytes = Vec::new();
        file.take(place.size).read_to_end(&mut bytes).map_err(Error::read(path))?;
        Ok(bytes)
    }

    /// Returns the world of a task; none where it came to none.
    ///
    /// # Errors
    /// `Read`, `Damaged`.
    pub fn world(&self, id: TaskId) -> Result<Option<Stored>, Error> {
        let Some(place) = self.worlds.get(&id) else { return Ok(None) };
        stored(&self.files[place.file as usize], place.at).map(Some)
    }
}

/// Reads the world whose first member's header begins at a place of a tar file.
fn stored(path: &Path, at: u64) -> Result<Stored, Error> {
    let (mut of, mut row, mut members) = (String::new(), None, Vec::new());
    scan(path, at, &mut |member| {
        let Some((key, ext)) = member.key().map(|(k, e)| (k.to_owned(), e.to_owned())) else { return Ok(false) };
        if !of.is_empty() && key != of {
            return Ok(false);
        }
        of = key;
        let bytes = member.read().map_err(Error::read(path))?;
        if ext == ROW {
            row = Some((json::<Row>(path, &bytes)?, bytes));
        } else {
            members.push((ext, bytes));
        }
        Ok(true)
    })?;
    let (row, row_bytes) = row.ok_or_else(|| Error::damaged(path, format!("has no row of {of}")))?;
    Ok(Stored { row, row_bytes, members })
}

/// Returns the tar files of a data set, sorted.
///
/// # Errors
/// `Read`.
pub fn tars(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let shards = folder.join(SHARDS);
    let entries = fs::read_dir(&shards).map_err(Error::read(&shards))?;
    let mut paths =
        entries.map(|e| e.map(|e| e.path())).collect::<std::io::Result<Vec<_>>>().map_err(Error::read(&shards))?;
    paths.retain(|p| p.extension().is_some_and(|e| e == "tar"));
    paths.sort();
    Ok(paths)
}

/// Returns the tasks of a data set that came to no world.
///
/// # Errors
/// `Read`, `Damaged`.
pub fn failures(folder: &Path) -> Result<Vec<Failure>, Error> {
    let path = folder.join(FAILURES);
    let text = fs::read_to_string(&path).map_err(Error::read(&path))?;
    text.lines().map(|line| json(&path, line.as_bytes())).collect()
}

/// Returns the tasks of a part's finished blocks that came to no world, the first `most` of them.
///
/// # Errors
/// `Read`, `Damaged`.
pub fn failures_of(part: &Part, most: usize) -> Result<Vec<Failure>, Error> {
    let mut found = Vec::new();
    for done in part.done().iter().filter(|d| d.failed > 0) {
        let path = part.block_file(done.block);
        scan(&path, 0, &mut |member| {
            if member.key().is_some_and(|(_, ext)| ext == FAILURE) {
                found.push(json(&path, &member.read().map_err(Error::read(&path))?)?);
            }
            Ok(found.len() < most)
        })?;
        if found.len() >= most {
            break;
        }
    }
    Ok(found)
}

fn json<T: serde::de::DeserializeOwned>(path: &Path, bytes: &[u8]) -> Result<T, Error> {
    serde_json::from_slice(bytes)
        .map_err(|e| Error::damaged(path, format!("has a line or member that cannot be read: {e}")))
}
