//! A part of a data set while it is made: a folder with the spec, the snapshot, blocks of finished tasks and a ledger.
//!
//! A block is some tasks in a row. Its file is written first, whole or not at all, then its line in the ledger; what the ledger
//! lacks is made again, and gives the same bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use serde::{Deserialize, Serialize};

use crate::digest::{sha256, sha256_of_file};
use crate::error::Error;
use crate::maker::{Maker, Outcome};
use crate::pack::{block, write_whole};
use crate::snapshot::Snapshot;
use crate::spec::Spec;
use crate::standing;
use crate::tasks::{Task, TaskId, Tasks};

/// Name of the spec's file.
pub const SPEC: &str = "spec.toml";
const ABOUT: &str = "part.json";
const LEDGER: &str = "ledger.jsonl";
const BLOCKS: &str = "blocks";
const LOCK: &str = "lock";
const FORMAT: &str = "d3dgen-part/1";

/// What a part is of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct About {
    format: String,
    spec_sha256: String,
    snapshot: String,
    tasks_per_block: u64,
    shard: u64,
    shards: u64,
}

/// A finished block.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Done {
    /// Number of the block, from 0.
    pub block: u64,
    /// SHA-256 of its file.
    pub sha256: String,
    /// Size of its file.
    pub bytes: u64,
    /// Worlds in it.
    pub worlds: u64,
    /// Tasks in it that came to none.
    pub failed: u64,
}

/// A data set, or a shard of one, that is being made.
#[derive(Debug)]
pub struct Part {
    folder: PathBuf,
    about: About,
    /// The text of the spec as it was given.
    pub spec_text: String,
    /// The spec.
    pub spec: Spec,
    /// All of its tasks, of other shards too.
    pub tasks: Tasks,
    /// What its worlds depend on beside their request.
    pub snapshot: Snapshot,
    done: Mutex<BTreeMap<u64, Done>>,
    /// Blocks whose results come from elsewhere.
    taken: BTreeSet<u64>,
    /// Held by the one run that adds to it; none where it is only read.
    _lock: Option<fs::File>,
}

/// Which part of a data set to make: shard `of.0` of `of.1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, from 0.
    pub number: u64,
    /// How many shards there are.
    pub of: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { number: 0, of: 1 };
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((number, of)) if number < of => Ok(Self { number, of }),
            _ => Err(format!("`{text}` is no shard: write k/n with k from 0 to n-1, as 0/4")),
        }
    }
}

impl Part {
    /// Begins a part in a folder, or goes on with the one that is there.
    ///
    /// # Errors
    /// `Input` when the folder holds a part of something else; `Write`.
    pub fn begin(
        folder: &Path,
        spec_text: &str,
        snapshot: &Snapshot,
        shard: Shard,
        tasks_per_block: u64,
    ) -> Result<Self, Error> {
        let about = About {
            format: FORMAT.into(),
            spec_sha256: sha256(spec_text.as_bytes()),
            snapshot: snapshot.file_name(),
            tasks_per_block,
            shard: shard.number,
            shards: shard.of,
        };
        fs::create_dir_all(folder.join(BLOCKS)).map_err(Error::write(folder))?;
        let lock = Some(lock(folder)?);
        if folder.join(ABOUT).exists() {
            mend_ledger(folder)?;
            standing::begin(folder);
            let part = Self { _lock: lock, ..Self::open(folder)? };
            // a run that goes on keeps its blocks, whatever their size
            let same = About { tasks_per_block: part.about.tasks_per_block, ..about };
            if part.about != same {
                return Err(Error::Input(different(folder, &part.about, &same)));
            }
            return Ok(part);
        }
        write_whole(&folder.join(SPEC), |f| f.write_all(spec_text.as_bytes()))?;
        snapshot.write(folder)?;
        let text = serde_json::to_string_pretty(&about).expect("it has string keys only");
        write_whole(&folder.join(ABOUT), |f| f.write_all(text.as_bytes()))?;
        Ok(Self { _lock: lock, ..Self::open(folder)? })
    }

    /// Counts blocks as done whose every task is to be had elsewhere.
    #[must_use]
    pub fn taking(self, elsewhere: impl Fn(&Task<'_>) -> bool) -> Self {
        let whole = |b: &u64| self.tasks_of(*b).filter_map(|n| self.tasks.get(n)).all(|task| elsewhere(&task));
        let taken = self.own_blocks().filter(whole).collect();
        Self { taken, ..self }
    }

    /// Returns true when a folder holds a part.
    pub fn is_at(folder: &Path) -> bool {
        folder.join(ABOUT).exists()
    }

    /// Opens the part in a folder.
    ///
    /// # Errors
    /// `Read`, `Spec`, or `Damaged` when it is none.
    pub fn open(folder: &Path) -> Result<Self, Error> {
        let file = folder.join(ABOUT);
        let text = fs::read_to_string(&file).map_err(Error::read(&file))?;
        let about: About =
            serde_json::from_str(&text).map_err(|e| Error::damaged(&file, format!("is no part of a data set: {e}")))?;
        if about.format != FORMAT || about.tasks_per_block == 0 || about.shard >= about.shards {
            return Err(Error::damaged(&file, format!("is not of the form {FORMAT}")));
        }
        let path = folder.join(SPEC);
        let spec_text = fs::read_to_string(&path).map_err(Error::read(&path))?;
        if sha256(spec_text.as_bytes()) != about.spec_sha256 {
            return Err(Error::damaged(&path, "was changed since the run began; begin another one in a new folder"));
        }
        let spec = Spec::from_toml(&spec_text, &path.display().to_string())?;
        let tasks = Tasks::of(&spec).map_err(Error::Input)?;
        let snapshot = Snapshot::read(&folder.join(&about.snapshot))?;
        let done = Mutex::new(read_ledger(folder)?);
        Ok(Self {
            folder: folder.to_path_buf(),
            about,
            spec_text,
            spec,
            tasks,
            snapshot,
            done,
            taken: BTreeSet::new(),
            _lock: None,
        })
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the number of tasks of a block.
    pub fn tasks_per_block(&self) -> u64 {
        self.about.tasks_per_block
    }

    /// Returns the number of blocks of all shards.
    pub fn blocks(&self) -> u64 {
        self.tasks.len().div_ceil(self.about.tasks_per_block)
    }

    /// Returns the numbers of this shard's blocks that are not done.
    pub fn missing(&self) -> Vec<u64> {
        let done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        self.own_blocks().filter(|b| !done.contains_key(b) && !self.taken.contains(b)).collect()
    }

    /// Returns the numbers of this shard's blocks.
    pub fn own_blocks(&self) -> impl Iterator<Item = u64> {
        (self.about.shard..self.blocks()).step_by(self.about.shards as usize)
    }

    /// Returns how many tasks this shard has.
    pub fn own_tasks(&self) -> u64 {
        self.own_blocks().map(|b| self.tasks_of(b).count() as u64).sum()
    }

    /// Returns true while a run adds to it.
    ///
    /// # Errors
    /// `Read` when the system does not say.
    pub fn is_held(&self) -> Result<bool, Error> {
        let path = self.folder.join(LOCK);
        let file = match fs::File::open(&path) {
            Ok(file) => file,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(false),
            Err(e) => return Err(Error::read(&path)(e)),
        };
        match file.try_lock_shared() {
            Ok(()) => Ok(false),
            Err(fs::TryLockError::WouldBlock) => Ok(true),
            Err(fs::TryLockError::Error(source)) => Err(Error::read(&path)(source)),
        }
    }

    /// Returns the numbers of the tasks of a block.
    pub fn tasks_of(&self, block: u64) -> std::ops::Range<u64> {
        let from = block * self.about.tasks_per_block;
        from..(from + self.about.tasks_per_block).min(self.tasks.len())
    }

    /// Returns the blocks that are done, by number.
    pub fn done(&self) -> Vec<Done> {
        let done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        done.values().cloned().collect()
    }

    /// Returns where the file of a block is.
    pub fn block_file(&self, block: u64) -> PathBuf {
        self.folder.join(BLOCKS).join(format!("{block:06}.tar"))
    }

    /// Writes a block and its line in the ledger.
    ///
    /// # Errors
    /// `Write`, or `Full` when the disk is; what the ledger says is then still true.
    pub fn keep(&self, number: u64, bytes: &[u8], worlds: u64) -> Result<Done, Error> {
        write_whole(&self.block_file(number), |f| f.write_all(bytes))?;
        let tasks = self.tasks_of(number);
        let failed = (tasks.end - tasks.start).saturating_sub(worlds);
        let entry = Done { block: number, sha256: sha256(bytes), bytes: bytes.len() as u64, worlds, failed };
        let mut done = self.done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let path = self.folder.join(LEDGER);
        let line = serde_json::to_string(&entry).expect("it has string keys only") + "\n";
        let appended = OpenOptions::new().create(true).append(true).open(&path).and_then(|mut file| {
            file.write_all(line.as_bytes())?;
            file.sync_data()
        });
        appended.map_err(Error::write(&path))?;
        done.insert(number, entry.clone());
        Ok(entry)
    }

    /// Makes the blocks that are missing, on several threads.
    ///
    /// `news` hears of each block that is done, and ends the run by an error: before each block it is asked with none.
    ///
    /// # Errors
    /// `Interrupted`; `Write`, `Full`, `Export`; what `news` returns.
    pub fn run(
        &self,
        maker: &Maker<'_>,
        threads: usize,
        cancelled: &AtomicBool,
        news: &(dyn Fn(Option<&Done>) -> Result<(), Error> + Sync),
    ) -> Result<(), Error> {
        let missing = self.missing();
        let next = AtomicUsize::new(0);
        let stop = AtomicBool::new(false);
        let first_error: Mutex<Option<Error>> = Mutex::new(None);
        let work = || -> Result<(), Error> {
            let mut bench = maker.bench();
            while !stop.load(Ordering::Relaxed) {
                let Some(&number) = missing.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                news(None)?;
                let outcomes = outcomes(&self.tasks, self.tasks_of(number), &mut bench, cancelled)?;
                let worlds = worlds_in(&outcomes);
                let done = self.keep(number, &block(&outcomes), worlds)?;
                news(Some(&done))?;
            }
            Ok(())
        };
        thread::scope(|scope| {
            for _ in 0..threads.clamp(1, missing.len().max(1)) {
                scope.spawn(|| {
                    if let Err(error) = work() {
                        stop.store(true, Ordering::Relaxed);
                        let mut first = first_error.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                        first.get_or_insert(error);
                    }
                });
            }
        });
        first_error.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).map_or(Ok(()), Err)
    }

    /// Looks at every block whether its file is what the ledger says.
    ///
    /// # Errors
    /// `Damaged` with the first that is not; `Read`.
    pub fn check(&self) -> Result<(), Error> {
        for done in self.done() {
            let path = self.block_file(done.block);
            if sha256_of_file(&path)? != done.sha256 {
                return Err(Error::damaged(
                    &path,
                    "is not what the ledger says; remove it and its line, and run again",
                ));
            }
        }
        Ok(())
    }

    /// Returns why another part cannot be merged with this one; none when it can.
    pub fn differs_from(&self, other: &Self) -> Option<String> {
        let same = |about: &About| (about.spec_sha256.clone(), about.snapshot.clone());
        (same(&self.about) != same(&other.about)).then(|| different(&other.folder, &other.about, &self.about))
    }
}

/// Returns what becomes of some tasks.
///
/// # Errors
/// `Interrupted`, `Export`.
pub fn outcomes(
    tasks: &Tasks,
    numbers: std::ops::Range<u64>,
    bench: &mut crate::maker::Bench<'_>,
    cancelled: &AtomicBool,
) -> Result<Vec<(TaskId, Outcome)>, Error> {
    numbers.filter_map(|n| tasks.get(n)).map(|task| Ok((task.id, bench.make(&task, cancelled)?))).collect()
}

/// Returns how many of the outcomes are worlds.
pub fn worlds_in(outcomes: &[(TaskId, Outcome)]) -> u64 {
    outcomes.iter().filter(|(_, o)| matches!(o, Outcome::World(_))).count() as u64
}

fn different(folder: &Path, there: &About, wanted: &About) -> String {
    let what = if there.spec_sha256 != wanted.spec_sha256 {
        "of another spec".to_owned()
    } else if there.snapshot != wanted.snapshot {
        format!(
            "of another snapshot, {}: rules, domains, assets or the program have changed; make all parts with --snapshot {}",
            there.snapshot, there.snapshot
        )
    } else {
        format!("shard {}/{}", there.shard, there.shards)
    };
    format!("{} is {what}", folder.display())
}

/// Reads the ledger; a last line that was cut off is a block that is not done.
fn read_ledger(folder: &Path) -> Result<BTreeMap<u64, Done>, Error> {
    let path = folder.join(LEDGER);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(e) => return Err(Error::read(&path)(e)),
    };
    let mut done = BTreeMap::new();
    let mut lines = text.split_inclusive('\n').peekable();
    while let Some(line) = lines.next() {
        match serde_json::from_str::<Done>(line) {
            Ok(entry) if line.ends_with('\n') => {
                let size = fs::metadata(folder.join(BLOCKS).join(format!("{:06}.tar", entry.block))).map(|m| m.len());
                if size.is_ok_and(|size| size == entry.bytes) {
                    done.insert(entry.block, entry);
                }
            }
            _ if lines.peek().is_none() => {}
            _ => {
                return Err(Error::damaged(&path, format!("has a line that is none of a ledger: {}", line.trim_end())));
            }
        }
    }
    Ok(done)
}

/// Takes a last line that was cut off out of the ledger, so that the next one begins on a line of its own.
fn mend_ledger(folder: &Path) -> Result<(), Error> {
    let path = folder.join(LEDGER);
    let Ok(text) = fs::read_to_string(&path) else { return Ok(()) };
    let whole = text.rfind('\n').map_or(0, |at| at + 1);
    if whole == text.len() {
        return Ok(());
    }
    let file = OpenOptions::new().write(true).open(&path).map_err(Error::write(&path))?;
    file.set_len(whole as u64).map_err(Error::write(&path))
}

/// Takes the lock of a part, so that no two runs write one ledger; it goes with the process.
fn lock(folder: &Path) -> Result<fs::File, Error> {
    let path = folder.join(LOCK);
    let file = fs::File::create(&path).map_err(Error::write(&path))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(fs::TryLockError::WouldBlock) => {
            Err(Error::Input(format!("{} is being made by another run; wait for it, or stop it", folder.display())))
        }
        Err(fs::TryLockError::Error(source)) => Err(Error::write(&path)(source)),
    }
}
