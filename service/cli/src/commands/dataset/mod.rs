//! `d3dgen dataset`: many worlds as one data set that people can train on.

#[cfg(feature = "cluster")]
pub mod cluster;
mod disk;
mod extend;
mod make;
mod merge;
mod sample;
mod serve;
mod snapshot;
mod status;
mod verify;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::Subcommand;
use d3dgen_dataset::Error as DatasetError;
use d3dgen_dataset::assemble::{self, Assembled, Whole};
use d3dgen_dataset::part::{Done, Part};
use d3dgen_dataset::shelf::Shelf;
use d3dgen_dataset::standing::{self, Pace, WORK};

use crate::error::Error;
use crate::interrupt;
use crate::progress::Progress;

/// How often a run says how far it is where there is no terminal.
const SAY: Duration = Duration::from_secs(20);

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// Make the data set of a spec, or one shard of it
    Make(Box<make::Args>),
    /// Pin rules, domains, assets and program in one file, for runs on several machines
    Snapshot(snapshot::Args),
    /// Put shards together: the same bytes as one run would have given
    Merge(merge::Args),
    /// Make a data set with more seeds out of one that is there
    Extend(Box<extend::Args>),
    /// Look whether every file, row and world of a data set is as it should be
    Verify(verify::Args),
    /// Say how far a data set is
    Status(status::Args),
    /// Write some worlds of a data set as folders, to look at
    Sample(sample::Args),
    /// Show a data set's gallery and files to this machine's browser
    Serve(serve::Args),
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::Make(args) => args.run(),
            Action::Snapshot(args) => args.run(),
            Action::Merge(args) => args.run(),
            Action::Extend(args) => args.run(),
            Action::Verify(args) => args.run(),
            Action::Status(args) => args.run(),
            Action::Sample(args) => args.run(),
            Action::Serve(args) => args.run(),
        }
    }
}

/// Progress of a run: a moving line on a terminal, now and then a plain line elsewhere.
struct Talk {
    progress: Progress,
    said: Mutex<Instant>,
}

impl Talk {
    fn of(worlds: u64) -> Self {
        Self { progress: Progress::of(worlds as usize), said: Mutex::new(Instant::now()) }
    }

    /// Moves on by some worlds.
    fn moved(&self, worlds: u64, said: impl FnOnce() -> String) {
        (0..worlds).for_each(|_| self.progress.count());
        let mut last = self.said.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if last.elapsed() >= SAY {
            *last = Instant::now();
            self.progress.done(&said());
        }
    }
}

/// How fast a run goes, as it says here and leaves it in the part for others.
struct Runs<'p> {
    part: &'p Part,
    talk: Talk,
    all: u64,
    begun: Instant,
    before: u64,
    counts: Mutex<Counts>,
}

/// What a run has on the disk.
#[derive(Clone, Copy)]
struct Counts {
    done: u64,
    failed: u64,
    bytes: u64,
    told: Option<Instant>,
}

/// How often a run leaves word of its pace.
const TELL: Duration = Duration::from_secs(1);

impl<'p> Runs<'p> {
    fn of(part: &'p Part) -> Self {
        let all = part.own_tasks();
        let before = part.done();
        let failed = before.iter().map(|d| d.failed).sum();
        let done = failed + before.iter().map(|d| d.worlds).sum::<u64>();
        let bytes = before.iter().map(|d| d.bytes).sum();
        let talk = Talk::of(all);
        talk.moved(done, String::new);
        let counts = Mutex::new(Counts { done, failed, bytes, told: None });
        Self { part, talk, all, begun: Instant::now(), before: done, counts }
    }

    /// Returns the bytes on the disk.
    fn bytes(&self) -> u64 {
        self.counts.lock().unwrap_or_else(std::sync::PoisonError::into_inner).bytes
    }

    /// Moves on by a block, if one came home; `more` is said beside the pace.
    fn moved(&self, block: Option<&Done>, more: &str) -> Result<(), DatasetError> {
        let (tasks, failed, bytes) = block.map_or((0, 0, 0), |d| (d.worlds + d.failed, d.failed, d.bytes));
        let mut counts = self.counts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *counts = Counts {
            done: counts.done + tasks,
            failed: counts.failed + failed,
            bytes: counts.bytes + bytes,
            told: counts.told,
        };
        let Counts { done, failed, .. } = *counts;
        let pace = Pace::of(done - self.before, self.begun.elapsed().as_secs_f64(), self.all.saturating_sub(done));
        let rate = pace.map_or(0.0, |p| p.per_second);
        if let Some(pace) = pace.filter(|_| counts.told.is_none_or(|told| told.elapsed() >= TELL)) {
            counts.told = Some(Instant::now());
            standing::tell(self.part, &pace)?;
        }
        drop(counts);
        let said = format!("{rate:.1} a second, {failed} without a world{more}");
        self.talk.progress.doing(&said);
        self.talk.moved(tasks, || format!("{done} of {}: {said}", self.all));
        Ok(())
    }

    /// Goes on unless somebody wants the run to stop, here or from elsewhere.
    fn go_on(&self) -> Result<(), DatasetError> {
        if standing::is_to_stop(self.part) { Err(DatasetError::Interrupted) } else { go_on() }
    }
}

/// Goes on unless the user pressed Ctrl-C.
fn go_on() -> Result<(), DatasetError> {
    interrupt::check().map_err(|_| DatasetError::Interrupted)
}

/// Refuses a folder that holds a data set or somebody's work.
fn check_new(out: &Path) -> Result<(), Error> {
    if assemble::is_finished(out) {
        let there = out.display();
        return Err(Error::Input(format!(
            "{there} holds a finished data set; name another folder, or `d3dgen dataset extend {there} --seeds N --out DIR`"
        )));
    }
    let Ok(entries) = std::fs::read_dir(out) else { return Ok(()) };
    let names: Vec<_> = entries.filter_map(|e| Some(e.ok()?.file_name())).collect();
    // what is left of putting a data set into its place goes on
    match names.iter().find(|n| *n != WORK).filter(|_| !names.iter().any(|n| n == WORK)) {
        Some(name) => Err(Error::Input(format!(
            "{} holds `{}` and is no data set in the making; name an empty or new folder",
            out.display(),
            name.to_string_lossy()
        ))),
        None => Ok(()),
    }
}

/// Puts the data set of a part together and into its place.
fn finish(part: &Part, shelf: &Shelf, out: &Path) -> Result<Assembled, Error> {
    interrupt::listen();
    let fresh = part.folder().join("new");
    let clear = || match std::fs::remove_dir_all(&fresh) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::Write { path: fresh.clone(), source })
        }
        _ => Ok(()),
    };
    clear()?; // what an earlier run left
    std::fs::create_dir_all(&fresh).map_err(|source| Error::Write { path: fresh.clone(), source })?;
    let talk = Talk::of(part.tasks.len());
    talk.progress.doing("packing");
    let made = assemble::assemble(&Whole::of(part), shelf, &fresh, &mut |number| {
        talk.moved(1, || format!("packing {} of {}", number + 1, part.tasks.len()));
        go_on()
    });
    talk.progress.finish();
    let made = match made {
        Ok(made) => made,
        Err(error) => {
            clear()?;
            return Err(error.into());
        }
    };
    assemble::publish(&fresh, out)?;
    Ok(made)
}

/// Removes the folder where a data set was made.
fn clear_work(work: &Path) -> Result<(), Error> {
    std::fs::remove_dir_all(work).map_err(|source| Error::Write { path: work.to_path_buf(), source })
}

/// Says what a data set has.
fn tell(made: &Assembled, out: &Path) {
    let splits: Vec<String> = made.splits.iter().map(|(name, n)| format!("{name} {n}")).collect();
    eprintln!(
        "{} worlds ({}), {} tasks without one, {}",
        made.worlds,
        splits.join(", "),
        made.failed,
        disk::size(made.bytes)
    );
    eprintln!("  folder       {}", out.display());
}

/// Opens the parts in folders: those of shards, or one where a data set is made.
fn parts(folders: &[PathBuf]) -> Result<Vec<Part>, Error> {
    let open = |folder: &PathBuf| {
        let work = folder.join(WORK);
        match [work, folder.clone()].iter().find(|place| Part::is_at(place)) {
            Some(place) => Part::open(place).map_err(Error::from),
            None => Err(Error::Input(format!(
                "{} is no shard of a data set: name folders that `dataset make --shard k/n` wrote",
                folder.display()
            ))),
        }
    };
    folders.iter().map(open).collect()
}
