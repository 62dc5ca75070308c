//! A folder of models into the database: walked, read, judged, kept; what is there already is passed over, what cannot
//! be used is named with its reason.
//!
//! Reading is the caller's ([`Reads`]), so that files of others are read in processes of their own. It can be stopped at
//! any time and goes on where it stopped: every few models are kept for good.

mod packages;
mod units;
mod walk;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};

use d3dgen_mesh::Model3d;
use d3dgen_model::Document;
use serde::{Deserialize, Serialize};

use crate::annotate::{Subject, annotate, look_around};
use crate::annotation::{Annotation, Origin};
use crate::catalog::Catalog;
use crate::database::{Database, IngestedFile, Kind, NewAsset, Provenance};
use crate::error::Error;
use crate::plausibility::Declared;
use crate::readers::{Facts, Pool, ReadModel};
pub use walk::{Walk, walk};

/// Models kept with one change.
const BATCH: usize = 24;

/// A model as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Read {
    /// Geometry, z up and in meters as the file declares.
    pub model: Model3d,
    /// What the file says about itself.
    pub declared: Declared,
    /// The other files that it is made of.
    pub companions: Vec<PathBuf>,
}

/// Reads models, several at once if it can.
pub trait Reads {
    /// Reads files and hands each result to `each` in their order, until it breaks. A result is an error with a reason
    /// for people when the file cannot be used.
    ///
    /// # Errors
    /// When nothing can be read at all.
    fn read(
        &self,
        files: &[PathBuf],
        root: &Path,
        each: &mut dyn FnMut(usize, Result<Read, String>) -> ControlFlow<()>,
    ) -> Result<(), Error>;
}

impl From<ReadModel> for Read {
    fn from(read: ReadModel) -> Self {
        Self { declared: declared(&read.facts), model: read.model, companions: read.companions }
    }
}

/// Returns what a file says of its axes and unit.
pub fn declared(facts: &Facts) -> Declared {
    Declared {
        format: facts.format.clone(),
        up_axis: facts.up_axis.as_deref().and_then(|a| a.chars().next()).filter(|a| "XYZ".contains(*a)),
        up_axis_authored: facts.up_axis_authored,
        unit_authored: facts.meters_per_unit_authored,
        unit_beside: None,
        simulator: None,
    }
}

impl Reads for Pool {
    fn read(
        &self,
        files: &[PathBuf],
        root: &Path,
        each: &mut dyn FnMut(usize, Result<Read, String>) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        self.read(files, Some(root), |place, result| each(place, result.map(Read::from).map_err(|r| r.reason)))
    }
}

/// What became of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "is")]
pub enum Outcome {
    /// It is a new asset.
    Added {
        /// The asset.
        asset_id: String,
    },
    /// It was there in another form.
    Updated {
        /// The asset.
        asset_id: String,
    },
    /// It was there as it is, or is a copy of another file.
    Unchanged {
        /// The asset.
        asset_id: String,
    },
    /// It cannot be used.
    Refused {
        /// Why, and what would help.
        reason: String,
    },
}

/// What became of a folder.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Summary {
    /// Files by path below the folder.
    pub files: BTreeMap<String, Outcome>,
    /// True when it was stopped before its end.
    pub cancelled: bool,
}

/// How to ingest.
pub struct Options<'a> {
    /// Domain under which assets are kept when nothing else tells.
    pub domain: Option<&'a str>,
    /// By whom, when, why.
    pub by: &'a Provenance,
    /// How many models are judged at once.
    pub workers: usize,
    /// Hears of each file as it is done: how many of how many, and which.
    pub progress: &'a (dyn Fn(usize, usize, &str) + Sync),
    /// Asked now and then; what is kept by then stays.
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl Summary {
    /// Returns the assets that are new or other than before, each once.
    pub fn changed(&self) -> Vec<String> {
        let ids = self.files.values().filter_map(|outcome| match outcome {
            Outcome::Added { asset_id } | Outcome::Updated { asset_id } => Some(asset_id.clone()),
            Outcome::Unchanged { .. } | Outcome::Refused { .. } => None,
        });
        ids.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Returns how many were added, updated, unchanged and refused.
    pub fn counts(&self) -> [usize; 4] {
        let mut counts = [0; 4];
        for outcome in self.files.values() {
            counts[match outcome {
                Outcome::Added { .. } => 0,
                Outcome::Updated { .. } => 1,
                Outcome::Unchanged { .. } => 2,
                Outcome::Refused { .. } => 3,
            }] += 1;
        }
        counts
    }

    /// Returns the files that were refused, with the reasons.
    pub fn refused(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files.iter().filter_map(|(path, outcome)| match outcome {
            Outcome::Refused { reason } => Some((path.as_str(), reason.as_str())),
            _ => None,
        })
    }
}

/// A file to be read, with its digest.
struct Wanted {
    file: PathBuf,
    path: String,
    hash: String,
    is_update: bool,
    /// Factor of the unit that the files beside it agree on, once that is known.
    unit_beside: Option<f64>,
}

/// A model that was read, on its way to be judged.
struct Job {
    place: usize,
    read: Result<Read, String>,
}

/// A model that was judged.
type Judged = (usize, Result<NewAsset, String>);

/// Ingests a folder, or one file.
///
/// # Errors
/// `File` when the folder cannot be walked; `Store` when the database cannot be written.
pub fn ingest(
    database: &Database,
    folder: &Path,
    catalog: &Catalog,
    reads: &dyn Reads,
    options: &Options<'_>,
) -> Result<Summary, Error> {
    let mut summary = Summary::default();
    let Walk { root, models, refused, shapes } = walk(folder)?;
    for (path, reason) in refused.into_iter().chain(shapes) {
        summary.files.insert(path, Outcome::Refused { reason });
    }
    let total = models.len();
    let (wanted, later) = sift(database, &root, models, &mut summary, options)?;
    summary.cancelled = (options.cancelled)();
    if !summary.cancelled {
        keep_all(database, &root, &wanted, total - later.len(), catalog, reads, options, &mut summary)?;
    }
    if !summary.cancelled {
        let odd = units::unlike_their_neighbors(database, wanted, &summary)?;
        keep_all(database, &root, &odd, total - later.len(), catalog, reads, options, &mut summary)?;
    }
    let mut others = copies(database, &root, later, &mut summary)?;
    while !others.is_empty() && !summary.cancelled {
        // One of each content at a time: the next may be a copy of it.
        let mut seen = BTreeSet::new();
        let (first, rest): (Vec<_>, Vec<_>) = others.into_iter().partition(|o| seen.insert(o.hash.clone()));
        keep_all(database, &root, &first, total - rest.len(), catalog, reads, options, &mut summary)?;
        others = copies(database, &root, rest, &mut summary)?;
    }
    Ok(summary)
}

/// Parts what has to be read from what is there already and from what may be copies of others, which wait for these.
fn sift(
    database: &Database,
    root: &Path,
    models: Vec<(String, PathBuf)>,
    summary: &mut Summary,
    options: &Options<'_>,
) -> Result<(Vec<Wanted>, Vec<Wanted>), Error> {
    let (mut wanted, mut later, mut seen) = (Vec::new(), Vec::new(), BTreeSet::new());
    for (path, file) in models {
        if (options.cancelled)() {
            break;
        }
        let hash = match walk::digest(&file, root) {
            Ok(hash) => hash,
            Err(reason) => {
                summary.files.insert(path, Outcome::Refused { reason });
                continue;
            }
        };
        let before = database.ingested(&path)?;
        let as_it_was = before.as_ref().is_some_and(|b| b.hash == hash);
        let file = Wanted { file, path, hash, is_update: before.is_some(), unit_beside: None };
        if let Some(before) = before
            && as_it_was
            && database.get(&before.asset_id)?.is_some()
        {
            if walk::are_unchanged(&before.companions, root) {
                summary.files.insert(file.path, Outcome::Unchanged { asset_id: before.asset_id });
            } else {
                wanted.push(file);
            }
        } else if !seen.insert(file.hash.clone()) || !database.with_content(&file.hash)?.is_empty() {
            later.push(file);
        } else {
            wanted.push(file);
        }
    }
    Ok((wanted, later))
}

/// Notes copies of files that are kept, and returns those that only look like it: beside them lie other materials or
/// pictures of the same names.
fn copies(database: &Database, root: &Path, later: Vec<Wanted>, summary: &mut Summary) -> Result<Vec<Wanted>, Error> {
    let (mut notes, mut others) = (Vec::new(), Vec::new());
    for copy in later {
        let originals = database.with_content(&copy.hash)?;
        if originals.is_empty() {
            if !summary.cancelled {
                let reason = "is a copy of a file that was refused".to_owned();
                summary.files.insert(copy.path, Outcome::Refused { reason });
            }
            continue;
        }
        let mut note = None;
        for asset_id in originals {
            let Some(Origin::Ingested { path, .. }) = database.get(&asset_id)?.map(|a| a.origin) else { continue };
            let Some(original) = database.ingested(&path)? else { continue };
            let companions = walk::beside(&original.companions, &path, &copy.path);
            if walk::are_unchanged(&companions, root) {
                note = Some(IngestedFile { hash: copy.hash.clone(), asset_id, companions });
                break;
            }
        }
        match note {
            Some(note) => {
                summary.files.insert(copy.path.clone(), Outcome::Unchanged { asset_id: note.asset_id.clone() });
                notes.push((copy.path, note));
            }
            None => others.push(copy),
        }
    }
    if !notes.is_empty() {
        database.note_copies(&notes)?;
    }
    Ok(others)
}

/// Reads, judges and keeps: readers hand models to judges, which hand them to this thread, which keeps them in order.
#[allow(clippy::too_many_arguments)]
fn keep_all(
    database: &Database,
    root: &Path,
    wanted: &[Wanted],
    total: usize,
    catalog: &Catalog,
    reads: &dyn Reads,
    options: &Options<'_>,
    summary: &mut Summary,
) -> Result<(), Error> {
    let files: Vec<PathBuf> = wanted.iter().map(|w| w.file.clone()).collect();
    let workers = options.workers.max(1);
    let (jobs, work) = sync_channel::<Job>(1);
    let (done, judged) = sync_channel::<Judged>(workers);
    let work = Mutex::new(work);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let (work, done) = (&work, done.clone());
            scope.spawn(move || judge_all(work, &done, root, wanted, catalog, options));
        }
        drop(done);
        let keeper = scope.spawn(|| keep_in_order(database, wanted, total, judged, options, summary));
        let outcome = reads.read(&files, root, &mut |place, read| {
            let stop = (options.cancelled)() || jobs.send(Job { place, read }).is_err();
            if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        drop(jobs);
        let kept = keeper.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        outcome.and(kept)
    })
}

fn judge_all(
    work: &Mutex<Receiver<Job>>,
    done: &SyncSender<Judged>,
    root: &Path,
    wanted: &[Wanted],
    catalog: &Catalog,
    options: &Options<'_>,
) {
    loop {
        let job = work.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(Job { place, read }) = job else { return };
        let Some(file) = wanted.get(place) else { return };
        let asset = read.and_then(|read| judge(file, read, root, catalog, options));
        if done.send((place, asset)).is_err() {
            return;
        }
    }
}

/// Annotates a model and moves it into its own frame.
fn judge(
    w: &Wanted,
    mut read: Read,
    root: &Path,
    catalog: &Catalog,
    options: &Options<'_>,
) -> Result<NewAsset, String> {
    read.declared.unit_beside = w.unit_beside;
    let origin = Origin::Ingested { path: w.path.clone(), hash: w.hash.clone() };
    let annotation = annotate_file(&read, &w.file, Some(root), options.domain, origin, catalog);
    let annotation = annotation.ok_or("has no triangle: there is nothing to see")?;
    if let Some(problem) = annotation.check().first() {
        return Err(format!("cannot be described: {problem}"));
    }
    let companions = walk::digests(&read.companions, root);
    let mut model = read.model;
    model.name = annotation.asset_id.rsplit('/').next().unwrap_or_default().to_owned();
    crate::moved::move_by(&mut model, &annotation.model_from_file);
    Ok(NewAsset::new(annotation, Some(model), companions))
}

/// Annotates a model that was read from a file, with what lies beside it; none without a triangle.
pub fn annotate_file(
    read: &Read,
    file: &Path,
    root: Option<&Path>,
    domain: Option<&str>,
    origin: Origin,
    catalog: &Catalog,
) -> Option<Annotation> {
    let around = look_around(file, root);
    let mut declared = read.declared.clone();
    declared.simulator = around.simulator;
    let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let subject = Subject { model: &read.model, declared, stem: &stem, around: &around, domain, origin };
    annotate(&subject, catalog)
}

/// Keeps what was judged, in the order of the files, a few at a time.
fn keep_in_order(
    database: &Database,
    wanted: &[Wanted],
    total: usize,
    judged: Receiver<Judged>,
    options: &Options<'_>,
    summary: &mut Summary,
) -> Result<(), Error> {
    let mut waiting: BTreeMap<usize, Result<NewAsset, String>> = BTreeMap::new();
    let mut batch: Vec<(usize, NewAsset)> = Vec::new();
    let (mut next, known) = (0, total - wanted.len());
    for (place, result) in judged {
        waiting.insert(place, result);
        while let Some(result) = waiting.remove(&next) {
            let Some(file) = wanted.get(next) else { break };
            match result {
                Ok(asset) => batch.push((next, asset)),
                Err(reason) => {
                    summary.files.insert(file.path.clone(), Outcome::Refused { reason });
                }
            }
            next += 1;
            (options.progress)(known + next, total, &file.path);
            if batch.len() >= BATCH {
                keep(database, wanted, std::mem::take(&mut batch), options.by, summary)?;
            }
        }
    }
    summary.cancelled |= next < wanted.len();
    keep(database, wanted, batch, options.by, summary)
}

fn keep(
    database: &Database,
    wanted: &[Wanted],
    batch: Vec<(usize, NewAsset)>,
    by: &Provenance,
    summary: &mut Summary,
) -> Result<(), Error> {
    let (places, assets): (Vec<usize>, Vec<NewAsset>) = batch.into_iter().unzip();
    let ids = database.put(Kind::Ingest, assets, by)?;
    for (file, asset_id) in places.iter().filter_map(|p| wanted.get(*p)).zip(ids) {
        let outcome = if file.is_update { Outcome::Updated { asset_id } } else { Outcome::Added { asset_id } };
        summary.files.insert(file.path.clone(), outcome);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
