//! One world of a task: made, filtered, packed. A pure function of task, spec and snapshot.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use d3dgen_eval::figures::FIGURES;
use d3dgen_export::Subject;
use d3dgen_export::exporters::{self, File, plan};
use d3dgen_export::models::KeptModels;
use d3dgen_model::document::Document;
use d3dgen_model::report::{Report, Status};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{Generated, plugin_of, retrieve};
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::task::{self, Terms, caught};
use d3dgen_pipeline::{Error as StageError, brief, floorplan, placement, scenario, world};
use d3dgen_plugins::Registry;

use crate::digest::{of_members, sha256};
use crate::error::Error;
use crate::held_out;
use crate::pack::gzip;
use crate::physics;
use crate::row::{Failure, Row, Why};
use crate::snapshot::Snapshot;
use crate::spec::{Filter, Spec, StageName};
use crate::tasks::Task;

/// Name that every world has: what tells them apart is their key.
const WORLD_NAME: &str = "world";
/// Folders of exported files that worlds share: each of their files is kept once, by its digest.
const SHARED_FOLDERS: &[&str] = &["assets", "meshes", "models"];
/// Kinds of files that are small already; all others are compressed.
const COMPRESSED: &[&str] = &["glb", "gz", "pdf", "png", "usdz", "zip"];
/// How often a variant is tried.
const VARIANT_ATTEMPTS: u32 = 3;

/// What a task came to.
#[derive(Debug, Clone)]
pub enum Outcome {
    /// A world.
    World(Box<Made>),
    /// None, and why.
    Nothing(Failure),
}

/// A world as it is packed.
#[derive(Debug, Clone)]
pub struct Made {
    /// What is known of it.
    pub row: Row,
    /// Its files by extension, the row aside.
    pub members: BTreeMap<String, Vec<u8>>,
    /// Files that it shares with others, by name: the SHA-256 and the extension.
    pub models: BTreeMap<String, Vec<u8>>,
}

/// Makes the worlds of one spec under one snapshot.
pub struct Maker<'a> {
    spec: Spec,
    registry: Registry,
    /// The domains without the assets that one split has alone.
    without_held_out: Option<Registry>,
    kept: Kept<'a>,
    snapshot_sha256: String,
    evaluated: Vec<&'static str>,
    /// Measures that a physics engine takes.
    stepped: Vec<&'static str>,
}

/// The models of the asset database.
enum Kept<'a> {
    Lent(&'a dyn KeptModels),
    Shared(Arc<dyn KeptModels + Send>),
}

impl Kept<'_> {
    fn models(&self) -> &dyn KeptModels {
        match self {
            Self::Lent(models) => *models,
            Self::Shared(models) => &**models,
        }
    }
}

/// A place where one thread makes worlds: it remembers the plan that the next variant needs.
pub struct Bench<'m> {
    maker: &'m Maker<'m>,
    plan: Option<((String, u64), Generated)>,
}

impl<'a> Maker<'a> {
    /// Returns a maker; `kept` are the models of the asset database, for formats with models.
    ///
    /// # Errors
    /// As [`Snapshot::registry`].
    pub fn new(spec: &Spec, snapshot: &Snapshot, kept: &'a dyn KeptModels) -> Result<Self, Error> {
        Self::of(spec, snapshot, Kept::Lent(kept))
    }

    /// Returns a maker that shares the models with others.
    ///
    /// # Errors
    /// As [`Maker::new`].
    pub fn of_shared(spec: &Spec, snapshot: &Snapshot, kept: Arc<dyn KeptModels + Send>) -> Result<Self, Error> {
        Self::of(spec, snapshot, Kept::Shared(kept))
    }

    fn of(spec: &Spec, snapshot: &Snapshot, kept: Kept<'a>) -> Result<Self, Error> {
        let registry = snapshot.registry()?;
        let without_held_out =
            spec.splits.by_asset().then(|| held_out::without(&registry, spec.splits.held_out_assets));
        let snapshot_sha256 = snapshot.digest().to_owned();
        let (evaluated, stepped) = (spec.evaluated(), spec.stepped());
        Ok(Self { spec: spec.clone(), registry, without_held_out, kept, snapshot_sha256, evaluated, stepped })
    }

    /// Returns a place for one thread.
    pub fn bench(&self) -> Bench<'_> {
        Bench { maker: self, plan: None }
    }

    /// Returns the domains that the worlds of a split are made of.
    fn registry(&self, split: &str) -> &Registry {
        let others = self.without_held_out.as_ref().filter(|_| split != self.spec.splits.held_out_for);
        others.unwrap_or(&self.registry)
    }
}

impl Bench<'_> {
    /// Makes the world of a task; a fault of the program in one world is an outcome, not the end.
    ///
    /// # Errors
    /// `Interrupted`; `Export` when a format cannot be written.
    pub fn make(&mut self, task: &Task<'_>, cancelled: &AtomicBool) -> Result<Outcome, Error> {
        let made = caught(|| self.attempt(task, cancelled)).unwrap_or_else(|crash| Err(Stopped::Task(crash)));
        match made {
            Ok(outcome) => Ok(outcome),
            Err(Stopped::Task(failure)) => {
                self.plan = self.plan.take().filter(|_| failure.why != task::Why::Crashed);
                Ok(Outcome::Nothing(Failure::of(task, failure.why.into(), failure.reason)))
            }
            Err(Stopped::Run(error)) => Err(error),
        }
    }

    fn attempt(&mut self, task: &Task<'_>, cancelled: &AtomicBool) -> Result<Outcome, Stopped> {
        let spec = &self.maker.spec;
        let registry = self.maker.registry(&task.prompt.split);
        let request = Request { seed: task.seed, ..task.prompt.request.clone() };
        if spec.last_stage() < StageName::World {
            return Ok(Outcome::World(Box::new(self.maker.early(task, &request, registry, cancelled)?)));
        }
        let asked = (format!("{:?}", task.prompt.request), task.seed);
        if self.plan.as_ref().is_none_or(|(of, _)| *of != asked) {
            let terms = Terms { name: Some(WORLD_NAME), allow_conflicts: spec.allow_conflicts };
            let made = task::make(&request, registry, terms, cancelled)?.map_err(Stopped::Task)?;
            self.plan = Some((asked, made));
        }
        let (_, first) = self.plan.as_ref().expect("it was just made");
        if (task.placement, task.scenario) == (0, 0) {
            return Ok(self.maker.pack(task, registry, first)?);
        }
        let variant = variant(task, first, registry, cancelled)?;
        Ok(self.maker.pack(task, registry, &variant)?)
    }
}

/// Why an attempt ended: because of its task, or because nothing can go on.
enum Stopped {
    Task(task::Failure),
    Run(Error),
}

impl From<StageError> for Stopped {
    fn from(error: StageError) -> Self {
        match error {
            StageError::Cancelled => Self::Run(Error::Interrupted),
            error => Self::Task(task::Failure::of(&error)),
        }
    }
}

impl From<Error> for Stopped {
    fn from(error: Error) -> Self {
        Self::Run(error)
    }
}

/// Returns another world of a plan: furnished anew, or with another scenario.
fn variant(
    task: &Task<'_>,
    first: &Generated,
    registry: &Registry,
    cancelled: &AtomicBool,
) -> Result<Generated, StageError> {
    let World { scene_graph: graph, floorplan: plan, .. } = &first.world;
    let plugin = plugin_of(registry, graph)?;
    let (domain, retrieved) = (plugin.domain(), retrieve(graph, plugin));
    let seeded = |seed| SceneGraph { seed, ..graph.clone() };
    let mut last = None;
    for attempt in 0..VARIANT_ATTEMPTS {
        let seed = |stage: &str, n: u32| {
            let label = format!("variant/{stage}/{n}/{attempt}");
            Stream::new(task.seed, &label).below(1 << 32) as u64 // exact in every JSON reader
        };
        let placements = match task.placement {
            0 => first.world.placements.clone(),
            n => {
                let graph = seeded(seed("placement", n));
                let limits = &retrieved.limits;
                placement::generate_until(&graph, plan, domain, limits, None, &mut |_| (), cancelled.into())?
            }
        };
        let graph_of_scenario = seeded(match task.scenario {
            0 => plan.seed,
            n => seed("scenario", n),
        });
        let scenario = scenario::generate(&graph_of_scenario, plan, &placements, domain)?;
        let mut world = world::assemble(WORLD_NAME, graph.clone(), plan.clone(), placements, scenario);
        world.brief.clone_from(&first.world.brief);
        let report = world::check(&world, domain, &retrieved);
        world.rules = Some(report.applied_rules());
        let sound = report.is_writable();
        last = Some(Generated { world, report, attempts: attempt + 1 });
        if sound {
            break;
        }
    }
    Ok(last.expect("at least one attempt is made"))
}

impl Maker<'_> {
    /// Returns the documents of the stages before the world.
    fn early(
        &self,
        task: &Task<'_>,
        request: &Request,
        registry: &Registry,
        cancelled: &AtomicBool,
    ) -> Result<Made, Stopped> {
        let (graph, _) = brief::rooms(request, registry)?;
        let plugin = plugin_of(registry, &graph)?;
        let (domain, limits) = (plugin.domain(), retrieve(&graph, plugin).limits);
        let last = self.spec.last_stage();
        let mut files = vec![(StageName::SceneGraph, File::new("scene_graph.json", graph.to_json()))];
        if last >= StageName::Floorplan {
            let plan = floorplan::generate_until(&graph, domain, &limits, None, cancelled.into())?;
            files.push((StageName::Floorplan, File::new("floorplan.json", plan.to_json())));
            if last >= StageName::Placement {
                let stop = cancelled.into();
                let placements = placement::generate_until(&graph, &plan, domain, &limits, None, &mut |_| (), stop)?;
                files.push((StageName::Placement, File::new("placements.json", placements.to_json())));
                if last >= StageName::Scenario {
                    let scenario = scenario::generate(&graph, &plan, &placements, domain)?;
                    files.push((StageName::Scenario, File::new("scenario.json", scenario.to_json())));
                }
            }
        }
        let wanted = files.into_iter().filter(|(stage, _)| self.spec.stages.contains(stage)).map(|(_, file)| file);
        Ok(self.packed(Row::of(task, &graph), wanted.collect()))
    }

    /// Packs a world that is sound and that the filters keep.
    fn pack(&self, task: &Task<'_>, registry: &Registry, made: &Generated) -> Result<Outcome, Error> {
        let Generated { world, report, attempts } = made;
        if !report.is_writable() {
            let broken = report.rules.iter().find_map(|r| r.violations.first());
            let reason = broken.map_or_else(String::new, |v| format!("{}: {}", v.code, v.message));
            return Ok(Outcome::Nothing(Failure::of(task, Why::Unsound, reason)));
        }
        let plugin = registry.get(&world.scene_graph.domain);
        let domain = plugin.map(|p| p.domain()).expect("the world was made of this domain");
        let subject = Subject::new(world, domain, self.kept.models());
        let mut row = Row::of_world(task, world, report, *attempts);
        self.measure(world, report, &mut row.figures);
        row.figures.extend(physics::measured(&subject, &self.stepped)?);
        if let Some(reason) = self.spec.filters.iter().find_map(|f| refused(f, &row, report)) {
            return Ok(Outcome::Nothing(Failure::of(task, Why::Filtered, reason)));
        }
        let mut files = self.documents(world, report);
        for format in &self.spec.formats {
            let exported = exported(format, &subject)?;
            files.extend(
                exported.into_iter().filter(|file| !files.iter().any(|f| f.path == file.path)).collect::<Vec<_>>(),
            );
        }
        Ok(Outcome::World(Box::new(self.packed(row, files))))
    }

    /// Returns the documents of the stages that are wanted.
    fn documents(&self, world: &World, report: &Report) -> Vec<File> {
        let document = |stage: &StageName| match stage {
            StageName::SceneGraph => vec![File::new("scene_graph.json", world.scene_graph.to_json())],
            StageName::Floorplan => vec![File::new("floorplan.json", world.floorplan.to_json())],
            StageName::Placement => vec![File::new("placements.json", world.placements.to_json())],
            StageName::Scenario => vec![File::new("scenario.json", world.scenario.to_json())],
            StageName::World => {
                vec![File::new("report.json", report.to_json()), File::new("world.json", world.to_json())]
            }
        };
        self.spec.stages.iter().flat_map(document).collect()
    }

    /// Adds the measures of `d3dgen eval` that are asked for.
    fn measure(&self, world: &World, report: &Report, figures: &mut BTreeMap<String, f64>) {
        if self.evaluated.is_empty() {
            return;
        }
        let measured = d3dgen_eval::measure(world, Some(report), "", &d3dgen_eval::Known::default());
        let wanted = FIGURES.iter().filter(|f| self.evaluated.contains(&f.name));
        figures.extend(wanted.filter_map(|f| Some((f.name.to_owned(), (f.of)(&measured)?))));
    }

    /// Sorts files into members and shared models, and sums them.
    fn packed(&self, mut row: Row, files: Vec<File>) -> Made {
        let (mut members, mut models) = (BTreeMap::new(), BTreeMap::new());
        for File { path, bytes } in files {
            let kind = path.rsplit_once('.').map_or("bin", |(_, kind)| kind);
            if path.split('/').any(|folder| SHARED_FOLDERS.contains(&folder)) {
                let name = format!("{}.{kind}", sha256(&bytes));
                row.models.insert(path, name.clone());
                models.insert(name, bytes);
                continue;
            }
            let ext = path.replace('/', ".");
            let (ext, bytes) =
                if COMPRESSED.contains(&kind) { (ext, bytes) } else { (format!("{ext}.gz"), gzip(&bytes)) };
            row.paths.insert(ext.clone(), path);
            members.insert(ext, bytes);
        }
        let sums: Vec<(&str, String)> = members.iter().map(|(ext, bytes)| (ext.as_str(), sha256(bytes))).collect();
        row.content_sha256 = of_members(sums.iter().map(|(ext, sum)| (*ext, sum.as_str())));
        row.snapshot_sha256.clone_from(&self.snapshot_sha256);
        Made { row, members, models }
    }
}

/// Returns the files of a format, or of one file of it: `plan`, `plan.svg`.
fn exported(format: &str, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
    let Subject { world, domain, .. } = *subject;
    let (name, one) = format.split_once('.').map_or((format, None), |(name, _)| (name, Some(format)));
    let exporter = exporters::get(name).expect("the spec was checked");
    let mut files = match one {
        Some("plan.svg") => vec![File::new("plan.svg", plan::svg(world, domain))],
        Some("plan.pdf" | "plan.dxf") => plan::files(world, domain, false)?,
        _ => exporter.export(subject)?,
    };
    if let Some(one) = one {
        files.retain(|f| f.path == one || f.path.rsplit('/').next() == one.split_once('.').map(|(_, file)| file));
    }
    Ok(files)
}

/// Returns why a filter takes a world out; none when it stays.
fn refused(filter: &Filter, row: &Row, report: &Report) -> Option<String> {
    if let Some(rule) = &filter.rule {
        let named = |c: &&d3dgen_model::report::ConstraintResult| c.constraint_id == *rule || c.name == *rule;
        let broken = report.constraints.iter().filter(named).find(|c| c.status == Status::Violated)?;
        return Some(format!("violates {rule} at `{}`", broken.subject));
    }
    let name = filter.measure.as_deref()?;
    let Some(value) = row.figures.get(name) else {
        let known: Vec<&str> = row.figures.keys().map(String::as_str).collect();
        return Some(format!("has no measure `{name}`; it has {}", known.join(", ")));
    };
    if let Some(min) = filter.min.filter(|min| value < min) {
        return Some(format!("{name} is {value}, less than {min}"));
    }
    filter.max.filter(|max| value > max).map(|max| format!("{name} is {value}, more than {max}"))
}
