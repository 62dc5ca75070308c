//! A finished data set of the results of its tasks: shards, index, card, gallery, checksums. What is written depends on spec and
//! snapshot alone, not on the parts that the results come from nor on their order.

mod card;
mod gallery;
mod statistics;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use self::gallery::Gallery;
use self::statistics::Statistics;
use self::table::{Columns, Indexed, Table};
use crate::digest::{Summed, of_members, sha256, sha256_of_file};
use crate::error::Error;
use crate::pack::{ROW, TarWriter};
use crate::part::{Part, SPEC};
use crate::shelf::{FAILURES, MODEL_SHARD, SHARDS, Shelf, Stored};
use crate::snapshot::Snapshot;
use crate::spec::Spec;
use crate::tasks::{Task, Tasks};

/// Folder of the index.
pub const INDEX: &str = "index";
/// Checksums of all files; the last one to come into its place.
pub const SUMS: &str = "SHA256SUMS";
const CARD: &str = "README.md";
const LOADER: &str = include_str!("load.py");
/// Bytes of models after which another shard of them begins.
const MODEL_SHARD_BYTES: u64 = 512 << 20;

/// What a data set is of.
#[derive(Debug)]
pub struct Whole<'a> {
    /// The text of the spec.
    pub spec_text: &'a str,
    /// The spec.
    pub spec: &'a Spec,
    /// Its tasks.
    pub tasks: &'a Tasks,
    /// What its worlds depend on beside their request.
    pub snapshot: &'a Snapshot,
}

impl<'a> Whole<'a> {
    /// Returns the data set that a part is of.
    pub fn of(part: &'a Part) -> Self {
        Self { spec_text: &part.spec_text, spec: &part.spec, tasks: &part.tasks, snapshot: &part.snapshot }
    }

    /// Returns the splits that have a prompt, sorted.
    pub fn splits(&self) -> BTreeSet<String> {
        self.tasks.prompts().iter().map(|p| p.split.clone()).collect()
    }
}

/// What came of an assembly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Assembled {
    /// Worlds.
    pub worlds: u64,
    /// Tasks that came to none.
    pub failed: u64,
    /// Bytes of all files.
    pub bytes: u64,
    /// Worlds by split.
    pub splits: BTreeMap<String, u64>,
}

/// Writes the data set into a new folder; `news` hears of each task, and ends the work by an error.
///
/// # Errors
/// `Input` with the tasks of which nothing is known, or when no task came to a world; `Write`, `Full`, `Damaged`; what `news` returns.
pub fn assemble(
    whole: &Whole<'_>,
    shelf: &Shelf,
    out: &Path,
    news: &mut dyn FnMut(u64) -> Result<(), Error>,
) -> Result<Assembled, Error> {
    check_complete(whole, shelf)?;
    for folder in [SHARDS, INDEX, "plots"] {
        let folder = out.join(folder);
        fs::create_dir_all(&folder).map_err(Error::write(&folder))?;
    }
    let mut writing = Writing::begin(whole, shelf, out)?;
    for task in whole.tasks.iter() {
        writing.task(&task, shelf)?;
        news(task.number)?;
    }
    writing.finish(whole, shelf)
}

fn check_complete(whole: &Whole<'_>, shelf: &Shelf) -> Result<(), Error> {
    let lacking: Vec<u64> = whole.tasks.iter().filter(|t| !shelf.has(t.id)).map(|t| t.number).collect();
    let Some((first, last)) = lacking.first().zip(lacking.last()) else { return Ok(()) };
    Err(Error::Input(format!(
        "{} of {} tasks are in no part, the first is task {first}, the last task {last}: make the shards that are missing, or run them again to the end",
        lacking.len(),
        whole.tasks.len()
    )))
}

/// Puts an assembled data set into its place; the checksums come last, so that a folder with them is whole.
///
/// # Errors
/// `Write`.
pub fn publish(fresh: &Path, out: &Path) -> Result<(), Error> {
    let refused = || Error::write(out);
    let entries = fs::read_dir(fresh).map_err(Error::read(fresh))?;
    let mut names = entries.map(|e| e.map(|e| e.file_name())).collect::<std::io::Result<Vec<_>>>().map_err(refused())?;
    names.sort_by_key(|name| name == SUMS);
    let _ = fs::remove_file(out.join(SUMS)); // an earlier one is no longer true
    for name in names {
        let target = out.join(&name);
        if target.is_dir() {
            fs::remove_dir_all(&target).map_err(refused())?;
        }
        fs::rename(fresh.join(&name), &target).map_err(refused())?;
    }
    Ok(())
}

/// Returns true when a folder holds a finished data set.
pub fn is_finished(folder: &Path) -> bool {
    folder.join(SUMS).is_file() && folder.join(SPEC).is_file() && folder.join(INDEX).is_dir()
}

/// The files of a data set while they are written.
struct Writing<'a> {
    out: &'a Path,
    splits: BTreeMap<String, Split>,
    failures: BufWriter<File>,
    statistics: Statistics,
    gallery: Gallery,
    gallery_step: u64,
    title: String,
    sums: BTreeMap<String, (String, u64)>,
    models: BTreeSet<String>,
}

/// The shards and the index of one split.
struct Split {
    name: String,
    per_shard: u64,
    /// Tasks of this split that came before.
    tasks: u64,
    shard: Option<(String, TarWriter<Summed<BufWriter<File>>>)>,
    table: Table,
}

impl<'a> Writing<'a> {
    fn begin(whole: &Whole<'_>, shelf: &Shelf, out: &'a Path) -> Result<Self, Error> {
        let slots: BTreeSet<String> = whole.tasks.prompts().iter().flat_map(|p| p.slots.keys().cloned()).collect();
        let columns = Columns::of(&slots, shelf.figures());
        let begin = |name: String| {
            let table = Table::begin(&out.join(INDEX).join(format!("{name}.parquet")), &columns)?;
            let per_shard = whole.spec.worlds_per_shard;
            Ok((name.clone(), Split { name, per_shard, tasks: 0, shard: None, table }))
        };
        let splits = whole.splits().into_iter().map(begin).collect::<Result<_, Error>>()?;
        let path = out.join(FAILURES);
        let failures = BufWriter::new(File::create(&path).map_err(Error::write(&path))?);
        let shown = u64::from(whole.spec.gallery);
        let gallery_step = if shown == 0 { u64::MAX } else { whole.tasks.len().div_ceil(shown) };
        let title = if whole.spec.title.is_empty() { &whole.spec.name } else { &whole.spec.title };
        Ok(Self {
            out,
            splits,
            failures,
            statistics: Statistics::default(),
            gallery: Gallery::default(),
            gallery_step,
            title: title.clone(),
            sums: BTreeMap::new(),
            models: BTreeSet::new(),
        })
    }

    fn task(&mut self, task: &Task<'_>, shelf: &Shelf) -> Result<(), Error> {
        let split = self.splits.get_mut(&task.prompt.split).expect("every prompt's split was begun");
        if let Some((name, sum)) = split.next_task(self.out)? {
            self.sums.insert(name, sum);
        }
        let Some(stored) = shelf.world(task.id)? else {
            let failure = shelf.failure(task.id).expect("it was looked whether it is known");
            self.statistics.miss(failure);
            let path = self.out.join(FAILURES);
            let line = serde_json::to_string(failure).expect("it has string keys only");
            return writeln!(self.failures, "{line}").map_err(Error::write(&path));
        };
        let key = format!("world-{:06}", task.number);
        let (shard, bytes) = split.add(&key, &stored, self.out)?;
        self.statistics.add(&stored.row, &split.name, bytes);
        self.models.extend(stored.row.models.values().cloned());
        if task.number.is_multiple_of(self.gallery_step) {
            self.gallery.add(&key, &split.name, &shard, &stored);
        }
        Ok(())
    }

    fn finish(mut self, whole: &Whole<'_>, shelf: &Shelf) -> Result<Assembled, Error> {
        self.failures.flush().map_err(Error::write(&self.out.join(FAILURES)))?;
        for (_, split) in std::mem::take(&mut self.splits) {
            self.sums.extend(split.finish(self.out)?);
        }
        if self.statistics.worlds == 0 {
            return Err(Error::Input(format!(
                "none of the {} tasks came to a world: {}",
                whole.tasks.len(),
                first_reason(whole, shelf)
            )));
        }
        let has_models = !self.models.is_empty();
        self.write_models(shelf)?;
        self.statistics.sort();
        let plots = self.statistics.plots();
        for (file, _, svg) in &plots {
            self.write(&format!("plots/{file}"), svg.as_bytes())?;
        }
        let named: Vec<(String, String)> = plots.into_iter().map(|(file, title, _)| (file, title)).collect();
        let card = card::card(whole, &self.statistics, &named, has_models);
        self.write(CARD, card.as_bytes())?;
        self.write("index.html", self.gallery.page(&self.title, self.statistics.worlds).as_bytes())?;
        self.write("load.py", LOADER.as_bytes())?;
        self.write(SPEC, whole.spec_text.as_bytes())?;
        self.write(&whole.snapshot.file_name(), &whole.snapshot.to_bytes())?;
        let written: Vec<String> = whole.splits().iter().map(|s| format!("{INDEX}/{s}.parquet")).collect();
        for name in written.into_iter().chain([FAILURES.to_owned()]) {
            let path = self.out.join(&name);
            let size = fs::metadata(&path).map_err(Error::read(&path))?.len();
            self.sums.insert(name, (sha256_of_file(&path)?, size));
        }
        let bytes = self.sums.values().map(|s| s.1).sum();
        let lines: String = self.sums.iter().map(|(name, (sum, _))| format!("{sum}  {name}\n")).collect();
        self.write(SUMS, lines.as_bytes())?;
        let Statistics { worlds, splits, .. } = &self.statistics;
        Ok(Assembled { worlds: *worlds, failed: self.statistics.missed(), bytes, splits: splits.clone() })
    }

    /// Writes a file, and sums it.
    fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let path = self.out.join(name);
        fs::write(&path, bytes).map_err(Error::write(&path))?;
        self.sums.insert(name.to_owned(), (sha256(bytes), bytes.len() as u64));
        Ok(())
    }

    /// Writes the models that the worlds share, by name.
    fn write_models(&mut self, shelf: &Shelf) -> Result<(), Error> {
        let (mut number, mut held, mut shard) = (0, 0, None);
        for name in std::mem::take(&mut self.models) {
            let bytes = shelf.model(&name)?;
            if held > 0 && held + bytes.len() as u64 > MODEL_SHARD_BYTES {
                self.sums.extend(shard.take().map(|s| close(s, self.out)).transpose()?);
                (number, held) = (number + 1, 0);
            }
            held += bytes.len() as u64;
            let open = match shard.take() {
                Some(open) => open,
                None => open(format!("{SHARDS}/{MODEL_SHARD}{number:06}.tar"), self.out)?,
            };
            let (_, tar) = shard.insert(open);
            tar.add(&name, &bytes).map_err(Error::write(self.out))?;
        }
        self.sums.extend(shard.map(|s| close(s, self.out)).transpose()?);
        Ok(())
    }
}

type OpenShard = (String, TarWriter<Summed<BufWriter<File>>>);
type Sum = (String, (String, u64));

fn open(name: String, out: &Path) -> Result<OpenShard, Error> {
    let path: PathBuf = out.join(&name);
    let file = File::create(&path).map_err(Error::write(&path))?;
    Ok((name, TarWriter::new(Summed::new(BufWriter::with_capacity(1 << 18, file)))))
}

fn close((name, tar): OpenShard, out: &Path) -> Result<Sum, Error> {
    let path = out.join(&name);
    let (mut file, sum, bytes) = tar.finish().map_err(Error::write(&path))?.finish();
    file.flush().map_err(Error::write(&path))?;
    Ok((name, (sum, bytes)))
}

impl Split {
    /// Counts a task; where it begins a shard, the one before is closed and its sum returned.
    fn next_task(&mut self, out: &Path) -> Result<Option<Sum>, Error> {
        let begins = self.tasks.is_multiple_of(self.per_shard);
        let number = self.tasks / self.per_shard;
        self.tasks += 1;
        if !begins {
            return Ok(None);
        }
        let closed = self.shard.take().map(|shard| close(shard, out)).transpose()?;
        self.shard = Some(open(format!("{SHARDS}/{}-{number:06}.tar", self.name), out)?);
        Ok(closed)
    }

    /// Adds a world to shard and index; returns the shard's path and the bytes of its files.
    fn add(&mut self, key: &str, stored: &Stored, out: &Path) -> Result<(String, u64), Error> {
        let (shard, tar) = self.shard.as_mut().expect("the first task opens a shard");
        let row_member = (ROW.to_owned(), stored.row_bytes.clone());
        let mut files = Vec::new();
        for (ext, bytes) in std::iter::once(&row_member).chain(&stored.members) {
            tar.add(&format!("{key}.{ext}"), bytes).map_err(Error::write(&out.join(&*shard)))?;
            files.push((ext.clone(), sha256(bytes), bytes.len() as u64));
        }
        if of_members(files.iter().map(|(ext, sum, _)| (ext.as_str(), sum.as_str()))) != stored.row.content_sha256 {
            let task = &stored.row.task;
            return Err(Error::Input(format!(
                "the files of task {task} are not those that were made: its block is damaged"
            )));
        }
        let bytes = files.iter().map(|f| f.2).sum();
        self.table.add(&Indexed { row: &stored.row, key, shard, split: &self.name, files })?;
        Ok((shard.clone(), bytes))
    }

    fn finish(mut self, out: &Path) -> Result<Option<Sum>, Error> {
        self.table.finish()?;
        self.shard.take().map(|shard| close(shard, out)).transpose()
    }
}

fn first_reason(whole: &Whole<'_>, shelf: &Shelf) -> String {
    let first = whole.tasks.get(0).and_then(|task| shelf.failure(task.id));
    first.map_or_else(String::new, |f| format!("`{}` was {}: {}", f.prompt, f.why.name(), f.reason))
}
