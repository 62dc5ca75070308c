//! A batch: worlds of one request, the seed counted up, each in files and in a record as soon as it is made.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use d3dgen_model::Document;
use d3dgen_model::brief::Brief;
use d3dgen_model::report::Report;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::style::Style;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::Generated;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::task::{self, Failure, Terms};
use d3dgen_store::{KeyRange, Store};
use serde::{Deserialize, Serialize};
use tonic::Status;

use super::{Level, Run};
use crate::error::Error;
use crate::{own, status};

/// Worlds of batches, by job and seed.
pub const WORLDS: &str = "job_worlds";

/// What to build, as it is stored.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Building {
    /// The sentence.
    pub prompt: String,
    /// What is asked for, in the place of the sentence.
    pub brief: Option<Brief>,
    /// Seed of the first world.
    pub seed: u64,
    /// Domain id.
    pub domain: Option<String>,
    /// Country.
    pub country: Option<String>,
    /// Rooms in total.
    pub rooms: Option<u32>,
    /// Net floor area, m2.
    pub area_m2: Option<f64>,
    /// Radius of the largest robot, m.
    pub robot_radius_m: Option<f64>,
    /// Body of the robot it is for.
    pub robot: RobotBody,
    /// How the building is to be.
    pub style: Style,
}

impl From<Request> for Building {
    fn from(r: Request) -> Self {
        let Request { prompt, brief, seed, domain, country, rooms, area_m2, robot_radius_m, robot, style } = r;
        Self { prompt, brief, seed, domain, country, rooms, area_m2, robot_radius_m, robot, style }
    }
}

impl Building {
    /// Returns the request for one of its seeds.
    pub fn request(&self, seed: u64) -> Request {
        let Self { prompt, brief, domain, country, rooms, area_m2, robot_radius_m, robot, style, .. } = self.clone();
        Request { prompt, brief, seed, domain, country, rooms, area_m2, robot_radius_m, robot, style }
    }
}

/// A batch to make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// The building of the first world.
    pub building: Building,
    /// How many worlds.
    pub count: u32,
}

/// A world of a batch, in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Its seed.
    pub seed: u64,
    /// Its name; empty when there is none.
    pub name: String,
    /// True when every hard rule holds.
    pub sound: bool,
    /// Counts and measures.
    pub figures: BTreeMap<String, f64>,
    /// Why there is no sound world.
    pub reason: Option<String>,
}

/// What is finished.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Done {
    /// Worlds tried.
    pub tried: u32,
    /// Sound ones among them.
    pub sound: u32,
    /// Seeds without a sound world, with the reason.
    pub failed: BTreeMap<u64, String>,
}

/// What came of a seed; an error ends the batch.
type Attempt = Result<Result<Generated, Failure>, d3dgen_pipeline::Error>;

/// Makes the worlds that are not there yet.
///
/// # Errors
/// `CANCELLED`; `UNAVAILABLE` when others wait for their turn: the batch goes on after them.
pub(super) fn run(run: &Run, spec: &Batch) -> Result<serde_json::Value, Status> {
    let mut done: Done = serde_json::from_value(run.job.checkpoint.clone()).unwrap_or_default();
    let dir = run.dir()?;
    let first = u64::from(done.tried);
    while done.tried < spec.count {
        run.check()?;
        if u64::from(done.tried) > first {
            run.give_way()?;
        }
        run.step("worlds", f64::from(done.tried) / f64::from(spec.count), &format!("{} of {}", done.tried, spec.count));
        let next = spec.building.seed + u64::from(done.tried);
        let most = run.cores().min((spec.count - done.tried) as usize);
        for (seed, made) in (next..).zip(side_by_side(run, spec, next, most)) {
            keep(run, &mut done, &dir, seed, made)?;
        }
    }
    serde_json::to_value(&done).map_err(|e| status::internal(&e))
}

/// Makes worlds of so many seeds, each on a thread of its own; in the order of seeds.
fn side_by_side(run: &Run, spec: &Batch, next: u64, count: usize) -> Vec<Attempt> {
    std::thread::scope(|scope| {
        let all: Vec<_> = (next..).take(count).map(|seed| scope.spawn(move || make(run, spec, seed))).collect();
        all.into_iter().map(|one| one.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    })
}

/// Keeps what came of a seed.
fn keep(run: &Run, done: &mut Done, dir: &Path, seed: u64, made: Attempt) -> Result<(), Status> {
    let made = outcome(dir, seed, made)?;
    done.tried += 1;
    done.sound += u32::from(made.sound);
    if let Some(reason) = &made.reason {
        done.failed.insert(seed, reason.clone());
        run.log(Level::Warning, &format!("seed {seed}: {reason}"));
    }
    run.checkpoint(done, |batch| own::put(batch, WORLDS, &key(&run.job.id, seed), &made))
}

/// Writes the world of a seed, and returns what is kept of it; a seed that is refused is noted, and the batch goes on.
fn outcome(dir: &Path, seed: u64, made: Attempt) -> Result<Made, Status> {
    Ok(match made.map_err(|error| status::stage("building", error))? {
        Ok(generated) => {
            write(dir, seed, &generated.world, &generated.report).map_err(|e| status::io(&e))?;
            let figures = generated.report.figures.iter().map(|(k, v)| (k.clone(), *v)).collect();
            let first = generated.report.rules.iter().find(|r| !r.violations.is_empty());
            let sound = generated.report.sound;
            let reason = (!sound).then(|| format!("breaks {}", first.map_or("a hard rule", |r| r.rule.as_str())));
            Made { seed, name: generated.world.name, sound, figures, reason }
        }
        Err(Failure { reason, .. }) => {
            Made { seed, name: String::new(), sound: false, figures: BTreeMap::new(), reason: Some(reason) }
        }
    })
}

fn make(run: &Run, spec: &Batch, seed: u64) -> Attempt {
    let now = run.core.domains.now();
    // what contradicts itself is in the world's scene graph
    let terms = Terms { allow_conflicts: true, ..Terms::default() };
    task::make(&spec.building.request(seed), &now.registry, terms, run.flag())
}

/// Writes a world's folder, whole or not at all.
fn write(dir: &Path, seed: u64, world: &World, report: &Report) -> std::io::Result<()> {
    let folder = folder(dir, seed);
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?; // of a run that was cut short: the same bytes
    }
    let fresh = tempfile::tempdir_in(dir)?;
    for (name, text) in [("world.json", world.to_json()), ("report.json", report.to_json())] {
        let file = std::fs::File::create(fresh.path().join(name))?;
        std::io::Write::write_all(&mut &file, text.as_bytes())?;
        file.sync_data()?;
    }
    std::fs::rename(fresh.keep(), folder)
}

fn folder(dir: &Path, seed: u64) -> PathBuf {
    dir.join(format!("world-{seed}"))
}

fn key(id: &str, seed: u64) -> String {
    format!("{id}/{seed:020}")
}

/// Returns worlds of a batch with seeds above `after`.
///
/// # Errors
/// `Store`.
pub fn list(store: &Store, id: &str, after: Option<u64>, most: usize) -> Result<Vec<Made>, Error> {
    let range = KeyRange::prefix(format!("{id}/"));
    let range = after.map_or(range.clone(), |seed| range.after(key(id, seed)));
    let mut found = Vec::new();
    own::each(store, WORLDS, &range, |_, made: Made| {
        found.push(made);
        Ok(if found.len() < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    })?;
    Ok(found)
}

/// Reads a world of a batch.
///
/// # Errors
/// `NOT_FOUND`; `DATA_LOSS` when its files are not what they were.
pub fn read(dir: &Path, seed: u64) -> Result<(World, Report), Status> {
    let folder = folder(dir, seed);
    let text = |name: &str| {
        std::fs::read_to_string(folder.join(name))
            .map_err(|_| Status::not_found(format!("there is no world of seed {seed} in this batch")))
    };
    let damaged = |e: d3dgen_model::Error| Status::data_loss(format!("the files of seed {seed} are damaged: {e}"));
    Ok((
        World::from_json(&text("world.json")?).map_err(damaged)?,
        Report::from_json(&text("report.json")?).map_err(damaged)?,
    ))
}

#[cfg(test)]
mod tests {
    use d3dgen_pipeline::Error;

    use super::*;

    #[test]
    fn a_seed_without_a_world_is_noted_and_ends_no_batch() {
        let dir = tempfile::tempdir().expect("a folder");
        let infeasible = Error::Infeasible { stage: "floorplan", message: "it is too dense".into() };
        for (error, reason) in [
            (infeasible, "it is too dense"),
            (Error::Refused { stage: "scene_graph", message: "it is too large".into() }, "it is too large"),
        ] {
            let kept = outcome(dir.path(), 7, Ok(Err(Failure::of(&error)))).expect("the batch goes on");
            assert!(!kept.sound && kept.seed == 7 && kept.reason.is_some_and(|r| r.contains(reason)), "{reason}");
        }
        let stopped = outcome(dir.path(), 7, Err(Error::Cancelled)).expect_err("it ends");
        assert_eq!(stopped.code(), tonic::Code::Cancelled);
    }
}
