//! `d3dgen generate`: from a sentence to checked worlds on disk.

mod batch;
pub(super) mod one;
mod proposals;

use std::path::PathBuf;
use std::time::Instant;

use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::variations;
use d3dgen_plugins::Registry;

use super::formats;
use crate::error::Error;
use crate::interrupt;
use crate::output::{Output, check_collection, check_free};
use crate::progress::Progress;
use crate::registry::RegistryArgs;
use crate::remote::{self, Remote, ServerArgs};
use crate::request::RequestArgs;
use crate::summary::{Summary, closing};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// What to build, in a sentence (`-`: from standard input)
    #[arg(allow_hyphen_values = true, required_unless_present = "brief")]
    prompt: Option<String>,
    /// Folder to write: new, empty, or an earlier output, which is replaced; with --count it gets a folder for each seed,
    /// and worlds of other seeds in it stay
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    request: RequestArgs,
    /// Number of worlds, the seed counted up
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    count: u64,
    /// Number of worlds with truly different plans, chosen among five times as many seeds
    #[arg(long, value_name = "N", conflicts_with = "count", value_parser = clap::value_parser!(u64).range(2..=1000))]
    variations: Option<u64>,
    /// Name of the world, lower case with underscores; with --count the seed is added
    #[arg(long, value_name = "NAME", value_parser = super::world_name)]
    name: Option<String>,
    /// Build what contradicts itself too, as `conflicts` of the scene graph says; otherwise it is refused
    #[arg(long)]
    allow_conflicts: bool,
    /// Print one JSON line for each world
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    formats: formats::FormatArgs,
    #[command(flatten)]
    registry: RegistryArgs,
    #[command(flatten)]
    proposals: proposals::ProposalArgs,
    #[command(flatten)]
    server: ServerArgs,
}

/// One world to be made.
pub(super) struct Job {
    pub request: Request,
    pub name: Option<String>,
    pub path: PathBuf,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        if let Some(remote) = self.server.instead_of(&self.registry)? {
            return self.ask(&remote);
        }
        // the process ends with it: to take it apart would take a fifteenth of the time of a world
        let registry = std::mem::ManuallyDrop::new(self.registry.load()?);
        let (formats, flag) = (self.formats.chosen(&self.registry.store)?, interrupt::flag());
        let proposals = self.proposals.proposals()?;
        if proposals.is_some() && self.variations.is_some() {
            return Err(Error::Input(
                "--variations chooses among plans made without a model; use it without --propose".into(),
            ));
        }
        let maker = one::Maker { registry: &registry, formats, allow_conflicts: self.allow_conflicts, proposals, flag };
        let request = self.request.request(self.prompt.as_deref())?;
        if self.count == 1 && self.variations.is_none() {
            let job = Job { request, name: self.name, path: self.out };
            let progress = Progress::of(1);
            let made = maker.make(&job, &progress);
            progress.finish();
            let made = made?;
            if self.json {
                one::print_json(&made)?;
            }
            eprint!("{}", made.page());
            return verdict(&[made], 0);
        }
        let seeds = match self.variations {
            Some(count) => different(&request, maker.registry, count)?,
            None => self.seeds(&request)?,
        };
        let jobs = self.jobs(&request, &seeds)?;
        let progress = Progress::of(jobs.len());
        let (worlds, failed) = batch::run(&maker, &jobs, &progress, self.json)?;
        eprintln!("{}  {:<12} {}", closing(&worlds), "folder", self.out.display());
        verdict(&worlds, failed)
    }

    /// Has a server make the worlds, one after the other.
    fn ask(&self, remote: &Remote) -> Result<(), Error> {
        if self.variations.is_some() {
            return Err(Error::Input("--variations chooses among plans made here; use it without --server".into()));
        }
        if self.proposals.is_asked() {
            return Err(Error::Input("--propose asks a model from here; use it without --server".into()));
        }
        let formats = self.formats.names()?;
        let (png, allow_conflicts) = (self.formats.png(), self.allow_conflicts);
        let maker = remote::generate::Maker { remote, formats: &formats, png, allow_conflicts };
        let request = self.request.request(self.prompt.as_deref())?;
        let jobs = match self.count {
            1 => vec![Job { request, name: self.name.clone(), path: self.out.clone() }],
            _ => self.jobs(&request, &self.seeds(&request)?)?,
        };
        let progress = Progress::of(jobs.len());
        let (mut worlds, mut failed) = (Vec::new(), 0);
        for job in &jobs {
            let output = Output::new(&job.path)?;
            let begun = Instant::now();
            match maker.make(&job.request, job.name.as_deref(), &output, &progress) {
                Ok(made) => {
                    let kept = output.commit()?;
                    let times = vec![("server", begun.elapsed())];
                    let summary = Summary::new(&made, &job.path, times).with_kept(kept);
                    if self.json {
                        one::print_json(&summary)?;
                    }
                    worlds.push(summary);
                }
                Err(Error::Stage(error)) if jobs.len() > 1 => {
                    failed += 1;
                    progress.say(&format!("seed {}: {error}", job.request.seed));
                }
                Err(error) => return Err(error),
            }
            progress.count();
        }
        progress.finish();
        match (&worlds[..], jobs.len()) {
            ([made], 1) => eprint!("{}", made.page()),
            _ => eprintln!("{}  {:<12} {}", closing(&worlds), "folder", self.out.display()),
        }
        verdict(&worlds, failed)
    }

    /// Returns the seeds of `--count`.
    fn seeds(&self, request: &Request) -> Result<Vec<u64>, Error> {
        let last = request.seed.checked_add(self.count - 1);
        let last =
            last.ok_or_else(|| Error::Input(format!("--seed {} leaves no {} seeds", request.seed, self.count)))?;
        Ok((request.seed..=last).collect())
    }

    /// Returns a job for each seed, after a look at all the folders they will write.
    fn jobs(&self, request: &Request, seeds: &[u64]) -> Result<Vec<Job>, Error> {
        check_collection(&self.out)?;
        let job = |&seed: &u64| Job {
            request: Request { seed, ..request.clone() },
            name: self.name.as_ref().map(|name| format!("{name}_{seed}")),
            path: self.out.join(seed.to_string()),
        };
        let jobs: Vec<Job> = seeds.iter().map(job).collect();
        for job in &jobs {
            check_free(&job.path)?;
        }
        drop(Output::new(&jobs[0].path)?); // the folder can be written
        Ok(jobs)
    }
}

/// Returns seeds whose plans differ truly, and says by how much.
fn different(request: &Request, registry: &Registry, count: u64) -> Result<Vec<u64>, Error> {
    let found = variations::seeds(request, registry, count as usize, interrupt::flag().into())?;
    for v in &found {
        let share = 100.0 * v.difference;
        eprintln!("seed {}: at least {share:.0} % of the floor is used otherwise than in each other plan", v.plan.seed);
    }
    Ok(found.iter().map(|v| v.plan.seed).collect())
}

/// Returns how the command ends: well only when every world asked for is sound.
fn verdict(worlds: &[Summary], failed: usize) -> Result<(), Error> {
    let unsound: Vec<&str> = worlds.iter().filter(|w| !w.sound()).map(Summary::name).collect();
    let all = worlds.len() + failed;
    match unsound.first() {
        None if failed == 0 => Ok(()),
        None if failed == all => Err(Error::Input(format!("none of {all} worlds could be made"))),
        None => Err(Error::Unsound(format!("{failed} of {all} worlds could not be made"))),
        Some(first) => Err(Error::Unsound(format!(
            "{} of {all} worlds break hard rules and are not written, only their reports: first {first}",
            unsound.len(),
        ))),
    }
}
