//! `d3dgen dataset make`: the worlds of a spec, all of them or one shard, here on every core.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use d3dgen_dataset::assemble::is_finished;
use d3dgen_dataset::maker::{Maker, Outcome};
use d3dgen_dataset::part::{Done, Part, Shard};
use d3dgen_dataset::shelf::Shelf;
use d3dgen_dataset::snapshot::Snapshot;
use d3dgen_dataset::spec::Spec;
use d3dgen_dataset::standing::WORK;
use d3dgen_dataset::tasks::Tasks;

use super::{Runs, Talk, check_new, clear_work, disk, finish, tell};
use crate::commands::assets::Kept;
use crate::error::Error;
use crate::input::text;
use crate::interrupt;
use crate::parallel::default_threads;
use crate::registry::RegistryArgs;

/// Worlds that a dry run makes.
const SAMPLE: u64 = 16;
/// Blocks that a shard has at least, so that its threads end together, where it has so many tasks.
const BLOCKS_OF_A_SHARD: u64 = 32;
/// Tasks of a block where there are many.
pub const MOST_OF_A_BLOCK: u64 = 50;

/// Seconds that a block takes one of many workers, about.
#[cfg(feature = "cluster")]
const SECONDS_OF_A_BLOCK: f64 = 25.0;
/// Blocks that workers have at least among them, where there are so many tasks.
#[cfg(feature = "cluster")]
const LEAST_BLOCKS: u64 = 16;
/// Tasks of their blocks at most.
#[cfg(feature = "cluster")]
const MOST_OF_A_LONG_BLOCK: u64 = 2_000;

/// What a sample of worlds took.
struct Sample {
    count: u64,
    bytes: u64,
    failed: u64,
    time: Duration,
}

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// The spec, a TOML file (docs/datasets.md)
    spec: PathBuf,
    /// Folder of the data set, new or empty; a run that was stopped goes on in it
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Only this shard, k/n with k from 0: a part that `dataset merge` takes
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    run: RunArgs,
    #[cfg(feature = "cluster")]
    #[command(flatten)]
    cluster: super::cluster::LeaderArgs,
    /// Make a few worlds, say what time and disk all of them take, and write nothing
    #[arg(long)]
    dry_run: bool,
}

/// Flags of every run that makes worlds.
#[derive(clap::Args)]
pub struct RunArgs {
    /// Snapshot to make the worlds of; otherwise the rules, domains and assets as they are when the run begins
    #[arg(long, value_name = "FILE")]
    pub snapshot: Option<PathBuf>,
    /// Number of threads; otherwise one for each core
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Worlds in a row that are kept at once: what a run that is stopped loses at most for each thread; the same for all
    /// shards of a data set [default: 50, fewer where there would be too few blocks; for workers as many as take about 25 s]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub block: Option<u64>,
    #[command(flatten)]
    disk: disk::DiskArgs,
    #[command(flatten)]
    pub registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let (path, spec_text) = text(&self.spec, "spec.toml")?;
        let spec = Spec::from_toml(&spec_text, &path.display().to_string())?;
        if self.dry_run {
            return self.run.estimate(&spec);
        }
        let work = match self.shard {
            Some(_) => self.out.clone(),
            None => {
                let work = self.out.join(WORK);
                if is_finished(&self.out) && Part::is_at(&work) {
                    eprintln!("{} was finished; only its traces are removed", self.out.display());
                    return clear_work(&work); // a run that was killed in its last step
                }
                check_new(&self.out)?;
                work
            }
        };
        let part = self.part(&work, (&spec, &spec_text))?;
        self.fill(&part)?;
        if self.shard.is_some() {
            let done = part.done();
            let (worlds, failed) = done.iter().fold((0, 0), |(w, f), d| (w + d.worlds, f + d.failed));
            let bytes = disk::size(done.iter().map(|d| d.bytes).sum());
            eprintln!(
                "{worlds} worlds, {failed} tasks without one, {bytes}; put the shards together with `d3dgen dataset merge`"
            );
            return Ok(());
        }
        let mut shelf = Shelf::default();
        shelf.add_part(&part)?;
        let made = finish(&part, &shelf, &self.out)?;
        clear_work(&work)?;
        tell(&made, &self.out);
        Ok(())
    }
}

impl Args {
    /// Begins the part, or goes on with it. For workers its blocks are of a length that is measured, where none is said.
    fn part(&self, work: &Path, texts: (&Spec, &str)) -> Result<Part, Error> {
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        #[cfg(feature = "cluster")]
        if self.run.block.is_none() && !Part::is_at(work) && self.cluster.asked()?.is_some() {
            return self.run.part_of_long_blocks(work, texts, shard);
        }
        self.run.part(work, texts, shard)
    }

    /// Has what is missing of a part made: by workers where a queue is named, else here.
    fn fill(&self, part: &Part) -> Result<(), Error> {
        #[cfg(feature = "cluster")]
        if let Some(leader) = self.cluster.asked()? {
            return leader.lead(part, &|written| self.run.disk.guard(part.folder()).check(written));
        }
        self.run.make(part)
    }
}

impl RunArgs {
    /// Returns the snapshot of the worlds: the one that is named, that of the part in a folder, or one that is taken now.
    fn snapshot(&self, folder: Option<&Path>) -> Result<Snapshot, Error> {
        Ok(match (&self.snapshot, folder.filter(|folder| Part::is_at(folder))) {
            (Some(file), _) => Snapshot::read(file)?,
            (None, Some(folder)) => Part::open(folder)?.snapshot,
            (None, None) => Snapshot::take(&self.registry.load()?)?,
        })
    }

    /// Begins a part whose blocks take a worker a while, by a sample of its worlds.
    #[cfg(feature = "cluster")]
    fn part_of_long_blocks(&self, folder: &Path, (spec, text): (&Spec, &str), shard: Shard) -> Result<Part, Error> {
        let snapshot = self.snapshot(None)?;
        let tasks = Tasks::of(spec).map_err(Error::Input)?;
        let sample = self.sample(spec, &snapshot, &tasks)?;
        let each = sample.time.as_secs_f64() / sample.count.max(1) as f64;
        let long = (SECONDS_OF_A_BLOCK / each.max(1e-3)) as u64;
        let block = long.min(tasks.len() / LEAST_BLOCKS).clamp(1, MOST_OF_A_LONG_BLOCK);
        eprintln!("blocks of {block} tasks: {:.0} ms a task in a sample of {}", each * 1000.0, sample.count);
        Ok(Part::begin(folder, text, &snapshot, shard, block)?)
    }

    /// Begins a part in a folder, or goes on with the one there, under the snapshot it began with.
    pub fn part(&self, folder: &Path, (spec, spec_text): (&Spec, &str), shard: Shard) -> Result<Part, Error> {
        let snapshot = self.snapshot(Some(folder))?;
        let block = self.block.unwrap_or_else(|| {
            let tasks = Tasks::of(spec).map_or(1, |tasks| tasks.len());
            (tasks / (shard.of * BLOCKS_OF_A_SHARD)).clamp(1, MOST_OF_A_BLOCK)
        });
        Ok(Part::begin(folder, spec_text, &snapshot, shard, block)?)
    }

    fn threads(&self) -> usize {
        self.threads.map_or_else(default_threads, usize::from)
    }

    /// Makes what is missing of a part.
    pub fn make(&self, part: &Part) -> Result<(), Error> {
        interrupt::listen();
        if part.missing().is_empty() {
            return Ok(());
        }
        let kept = Kept::of(&self.registry.store)?;
        let maker = Maker::new(&part.spec, &part.snapshot, &kept)?;
        let guard = self.disk.guard(part.folder());
        let runs = Runs::of(part);
        let news = |done: Option<&Done>| {
            runs.go_on()?;
            match done {
                None => guard.check(runs.bytes()),
                done => runs.moved(done, ""),
            }
        };
        let result = part.run(&maker, self.threads(), interrupt::flag(), &news);
        runs.talk.progress.finish();
        Ok(result?)
    }

    /// Says what a data set takes, from a sample of its worlds.
    fn estimate(&self, spec: &Spec) -> Result<(), Error> {
        let tasks = Tasks::of(spec).map_err(Error::Input)?;
        let sample = self.sample(spec, &self.snapshot(None)?, &tasks)?;
        self.tell_estimate(&tasks, &sample);
        Ok(())
    }

    /// Makes some worlds, evenly over all tasks, and keeps none.
    fn sample(&self, spec: &Spec, snapshot: &Snapshot, tasks: &Tasks) -> Result<Sample, Error> {
        interrupt::listen();
        let kept = Kept::of(&self.registry.store)?;
        let maker = Maker::new(spec, snapshot, &kept)?;
        let mut bench = maker.bench();
        let mut sample = Sample { count: SAMPLE.min(tasks.len()), bytes: 0, failed: 0, time: Duration::ZERO };
        let count = sample.count;
        let talk = Talk::of(count);
        for i in 0..count {
            let Some(task) = tasks.get(i * tasks.len() / count) else { break };
            let begun = Instant::now();
            match bench.make(&task, interrupt::flag())? {
                Outcome::World(made) => sample.bytes += made.members.values().map(Vec::len).sum::<usize>() as u64,
                Outcome::Nothing(failure) => {
                    sample.failed += 1;
                    talk.progress.say(&format!("`{}`, seed {}: {}", failure.prompt, failure.seed, failure.reason));
                }
            }
            sample.time += begun.elapsed();
            talk.moved(1, || format!("sample {} of {count}", i + 1));
        }
        talk.progress.finish();
        Ok(sample)
    }

    fn tell_estimate(&self, tasks: &Tasks, &Sample { count, bytes, failed, time }: &Sample) {
        let scale = tasks.len() as f64 / count as f64;
        let threads = self.threads();
        let took = |seconds: f64| humantime::format_duration(Duration::from_secs(seconds.ceil() as u64)).to_string();
        let (each, disk) = (time.as_secs_f64() / count as f64, (bytes as f64 * scale) as u64);
        let cpu = time.as_secs_f64() * scale;
        eprintln!("{} tasks of {} prompts; from {count} of them:", tasks.len(), tasks.prompts().len());
        eprintln!(
            "  time         {} on {threads} threads ({:.0} ms a task)",
            took(cpu / threads as f64),
            each * 1000.0
        );
        eprintln!(
            "  disk         {} of worlds, shared models aside; twice that while they are packed",
            disk::size(disk)
        );
        eprintln!("  without one  {failed} of {count}");
    }
}
