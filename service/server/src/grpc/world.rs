//! `WorldService`.

mod edit;
pub(crate) mod export;
mod generate;
mod import;
mod simulate;

use d3dgen_crowd::Options;
use d3dgen_model::Document;
use d3dgen_model::brief::Brief;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::hours;
use d3dgen_model::placements::Placements;
use d3dgen_model::report::Report;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scenario::Scenario;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::style::{Clutter, Style};
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::{attempt_seed, retrieve, world_name};
use d3dgen_pipeline::scenario::Wishes;
use d3dgen_pipeline::scene_graph::Request as Asked;
use d3dgen_pipeline::{brief, floorplan, placement, scenario, variations, world};
use d3dgen_plugins::Plugin;
use d3dgen_proto::v1::world_service_server::WorldService;
use d3dgen_proto::v1::{
    AssembleWorldRequest, AssembleWorldResponse, BatchWorld, BuildingRequest, CheckWorldRequest, CheckWorldResponse,
    CheckedWorld, EditWorldRequest, EditWorldResponse, ExportBatchRequest, ExportBatchResponse, ExportWorldRequest,
    ExportWorldResponse, Exporter, GenerateBatchRequest, GenerateBatchResponse, GenerateBriefRequest,
    GenerateBriefResponse, GenerateFloorplanRequest, GenerateFloorplanResponse, GeneratePlacementsRequest,
    GeneratePlacementsResponse, GenerateScenarioRequest, GenerateScenarioResponse, GenerateSceneGraphRequest,
    GenerateSceneGraphResponse, GenerateWorldRequest, GetBatchWorldRequest, GetBatchWorldResponse,
    ImportFloorplanRequest, ImportFloorplanResponse, ListBatchWorldsRequest, ListBatchWorldsResponse,
    ListExportersRequest, ListExportersResponse, RankedFloorplan, SimulateWorldRequest, SimulateWorldResponse,
};
use tonic::{Request, Response, Status};

use super::domain::plugin;
use super::page::Page;
use super::{Answer, Api, Once, caller};
use crate::convert::{document, message};
use crate::core::Core;
use crate::domains::Snapshot;
use crate::jobs::batch::{self, Batch};
use crate::jobs::{Job, Spec};
use crate::status::{self, invalid};

/// Plans of one answer at most.
const ALTERNATIVES: u32 = 16;
/// Seeds tried for each plan asked for.
const SEEDS: u32 = 3;

#[tonic::async_trait]
impl WorldService for Api {
    async fn generate_brief(&self, request: Request<GenerateBriefRequest>) -> Answer<GenerateBriefResponse> {
        let prompt = request.into_inner().prompt;
        self.short(move |core, _| {
            let read = brief::of_prompt(&prompt, &core.domains.now().registry);
            let read = read.ok_or_else(|| invalid("prompt", "has no words; describe a building"))?;
            Ok(GenerateBriefResponse { brief: Some(message(&read)) })
        })
        .await
    }

    async fn generate_scene_graph(
        &self,
        request: Request<GenerateSceneGraphRequest>,
    ) -> Answer<GenerateSceneGraphResponse> {
        let asked = building(request.into_inner().building)?;
        self.short(move |core, _| {
            let graph = brief::rooms(&asked, &core.domains.now().registry).map(|made| made.0);
            let graph = graph.map_err(|e| status::stage("building", e))?;
            Ok(GenerateSceneGraphResponse { scene_graph: Some(message(&graph)) })
        })
        .await
    }

    async fn generate_floorplan(
        &self,
        request: Request<GenerateFloorplanRequest>,
    ) -> Answer<GenerateFloorplanResponse> {
        let asked = request.into_inner();
        if asked.alternative_count > ALTERNATIVES {
            let count = asked.alternative_count;
            return Err(invalid("alternative_count", format!("is {count}, at most {ALTERNATIVES}")));
        }
        self.work(move |core, stop| {
            let graph: SceneGraph = document("scene_graph", asked.scene_graph)?;
            let pinned: Option<Floorplan> = asked.pinned.map(|p| document("pinned", Some(p))).transpose()?;
            let now = core.domains.now();
            let plans = plans(&graph, &now, pinned.as_ref(), asked.alternative_count.max(1), stop)?;
            let ranked = plans.into_iter().map(|(cost, plan)| RankedFloorplan {
                seed: plan.seed,
                cost,
                floorplan: Some(message(&plan)),
            });
            Ok(GenerateFloorplanResponse { alternatives: ranked.collect() })
        })
        .await
    }

    async fn generate_placements(
        &self,
        request: Request<GeneratePlacementsRequest>,
    ) -> Answer<GeneratePlacementsResponse> {
        let asked = request.into_inner();
        self.work(move |core, stop| {
            let graph: SceneGraph = document("scene_graph", asked.scene_graph)?;
            let plan: Floorplan = document("floorplan", asked.floorplan)?;
            let pinned: Option<Placements> = asked.pinned.map(|p| document("pinned", Some(p))).transpose()?;
            let now = core.domains.now();
            let plugin = plugin(&now, "scene_graph.domain", &graph.domain)?;
            let limits = retrieve(&graph, plugin).limits;
            let graph = SceneGraph { seed: plan.seed, ..graph };
            let made = placement::generate_until(
                &graph,
                &plan,
                plugin.domain(),
                &limits,
                pinned.as_ref(),
                &mut |_| (),
                stop.into(),
            );
            // rooms that the graph lacks are the plan's fault, all else that of what was pinned
            let fits = plan.rooms.iter().all(|r| graph.room(&r.room_id).is_some());
            let field = if pinned.is_some() && fits { "pinned" } else { "floorplan" };
            let placements = made.map_err(|e| status::stage(field, e))?;
            Ok(GeneratePlacementsResponse { placements: Some(message(&placements)) })
        })
        .await
    }

    async fn generate_scenario(&self, request: Request<GenerateScenarioRequest>) -> Answer<GenerateScenarioResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| {
            let graph: SceneGraph = document("scene_graph", asked.scene_graph)?;
            let plan: Floorplan = document("floorplan", asked.floorplan)?;
            let placements: Placements = document("placements", asked.placements)?;
            let now = core.domains.now();
            let plugin = plugin(&now, "scene_graph.domain", &graph.domain)?;
            if let Some(hour) = asked.hour.as_ref().filter(|h| hours::get(h).is_none()) {
                return Err(invalid("hour", format!("`{hour}` is no hour; there are {}", hours::ids().join(", "))));
            }
            let brief = brief::of_plan(&graph.prompt, Some(&plan), &now.registry);
            let (hour, brief) = (asked.hour.as_deref(), brief.as_ref());
            let wishes = Wishes { name: &asked.name, hour, brief, kept: None };
            let made = scenario::generate_as(&graph, &plan, &placements, plugin.domain(), &wishes);
            let scenario = made.map_err(|e| status::stage("placements", e))?;
            Ok(GenerateScenarioResponse { scenario: Some(message(&scenario)) })
        })
        .await
    }

    async fn import_floorplan(&self, request: Request<ImportFloorplanRequest>) -> Answer<ImportFloorplanResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| import::import(&asked, &core.domains.now().registry)).await
    }

    async fn assemble_world(&self, request: Request<AssembleWorldRequest>) -> Answer<AssembleWorldResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| {
            let graph: SceneGraph = document("scene_graph", asked.scene_graph)?;
            let plan: Floorplan = document("floorplan", asked.floorplan)?;
            let placements: Placements = document("placements", asked.placements)?;
            let scenario: Scenario = document("scenario", asked.scenario)?;
            let name = world_named(asked.name)?.unwrap_or_else(|| world_name(&graph));
            let brief = brief::of_plan(&graph.prompt, Some(&plan), &core.domains.now().registry);
            let world = World { brief, ..world::assemble(&name, graph, plan, placements, scenario) };
            Ok(AssembleWorldResponse { world: Some(judged(core, world)?) })
        })
        .await
    }

    type GenerateWorldStream = generate::Events;

    async fn generate_world(&self, request: Request<GenerateWorldRequest>) -> Answer<Self::GenerateWorldStream> {
        self.generate(request.into_inner()).map(Response::new)
    }

    async fn generate_batch(&self, request: Request<GenerateBatchRequest>) -> Answer<GenerateBatchResponse> {
        let who = caller(&request).name;
        let change = move |core: &Core, asked: GenerateBatchRequest, once: &Once| {
            let (building, count, most) = (building(asked.building)?, asked.world_count, core.config.jobs.batch_worlds);
            if count == 0 || count > most {
                return Err(invalid("world_count", format!("is {count}, needs 1 to {most}")));
            }
            if building.seed.checked_add(u64::from(count)).is_none() {
                return Err(invalid("building.seed", format!("leaves no {count} seeds")));
            }
            // what no seed can make is refused now
            let graph = brief::rooms(&building, &core.domains.now().registry).map(|made| made.0);
            graph.map_err(|e| status::stage("building", e))?;
            let title: String = format!("{count} worlds: {}", building.prompt).chars().take(200).collect();
            let spec = Spec::Batch(Batch { building: building.into(), count });
            let job = core.jobs.start(&who, title, spec, None, |job, batch| {
                once.also(core, &GenerateBatchResponse { job: Some(super::job::message(job)) }, batch);
            })?;
            Ok(GenerateBatchResponse { job: Some(super::job::message(&job)) })
        };
        {
            let id = request.get_ref().request_id.clone();
            self.change("GenerateBatch", request, id, change).await
        }
    }

    async fn list_batch_worlds(&self, request: Request<ListBatchWorldsRequest>) -> Answer<ListBatchWorldsResponse> {
        let caller = caller(&request);
        let mut asked = request.into_inner();
        let (size, token) = (std::mem::take(&mut asked.page_size), std::mem::take(&mut asked.page_token));
        let page = Page::new(size, &token, &asked)?;
        let id = batch_of(self.job_of(&asked.job_id, &caller)?)?.id;
        self.lookup(move |core| {
            let all = batch::list(&core.databases.own, &id, None, usize::MAX).map_err(status::own)?;
            let (found, next_page_token) = page.cut(all.into_iter().filter(|w| !w.name.is_empty()));
            let entry = |w: batch::Made| BatchWorld { seed: w.seed, name: w.name, sound: w.sound, figures: w.figures };
            Ok(ListBatchWorldsResponse { worlds: found.into_iter().map(entry).collect(), next_page_token })
        })
        .await
    }

    async fn get_batch_world(&self, request: Request<GetBatchWorldRequest>) -> Answer<GetBatchWorldResponse> {
        let caller = caller(&request);
        let asked = request.into_inner();
        let id = batch_of(self.job_of(&asked.job_id, &caller)?)?.id;
        self.work(move |core, _| {
            let (world, report) = batch::read(&core.job_dir(&id), asked.seed)?;
            Ok(GetBatchWorldResponse { world: Some(checked(&world, &report)) })
        })
        .await
    }

    async fn edit_world(&self, request: Request<EditWorldRequest>) -> Answer<EditWorldResponse> {
        let asked = request.into_inner();
        self.work(move |core, stop| {
            let mut world: World = document("world", asked.world)?;
            let changed_room_ids = edit::apply(&mut world, asked.edits, &core.domains.now(), stop.into())?;
            let problems = world.check();
            if !problems.is_empty() {
                return Err(status::problems("world", &problems));
            }
            Ok(EditWorldResponse { world: Some(judged(core, world)?), changed_room_ids })
        })
        .await
    }

    async fn check_world(&self, request: Request<CheckWorldRequest>) -> Answer<CheckWorldResponse> {
        let asked = request.into_inner();
        self.work(move |core, _| {
            let world: World = document("world", asked.world)?;
            Ok(CheckWorldResponse { report: Some(message(&report(core, &world)?)) })
        })
        .await
    }

    type ExportWorldStream = export::Pieces<ExportWorldResponse>;

    async fn export_world(&self, request: Request<ExportWorldRequest>) -> Answer<Self::ExportWorldStream> {
        let asked = request.into_inner();
        self.work(move |core, stop| {
            let world: World = document("world", asked.world)?;
            let found = report(core, &world)?;
            export::refuse_unsound(&found, "the world")?;
            let mut files = export::files(core, &world, &asked.formats, stop)?;
            // whoever has the files can open the world again
            files.push(("report.json".into(), found.to_json().into_bytes()));
            files.push(("world.json".into(), world.to_json().into_bytes()));
            export::archive(files, stop, |chunk| ExportWorldResponse { chunk })
        })
        .await
    }

    type ExportBatchStream = export::Pieces<ExportBatchResponse>;

    async fn export_batch(&self, request: Request<ExportBatchRequest>) -> Answer<Self::ExportBatchStream> {
        let caller = caller(&request);
        let asked = request.into_inner();
        let id = batch_of(self.job_of(&asked.job_id, &caller)?)?.id;
        self.work(move |core, stop| export::batch(core, &id, &asked, stop)).await
    }

    type SimulateWorldStream = export::Pieces<SimulateWorldResponse>;

    async fn simulate_world(&self, request: Request<SimulateWorldRequest>) -> Answer<Self::SimulateWorldStream> {
        let asked = request.into_inner();
        self.work(move |core, stop| {
            let world: World = document("world", asked.world)?;
            let options = Options { seconds: asked.seconds.unwrap_or(simulate::USUAL_S), seed: asked.seed };
            let files = simulate::files(core, &world, options, asked.film, stop)?;
            export::archive(files, stop, |chunk| SimulateWorldResponse { chunk })
        })
        .await
    }

    async fn list_exporters(&self, request: Request<ListExportersRequest>) -> Answer<ListExportersResponse> {
        let asked = request.into_inner();
        let page = Page::new(asked.page_size, &asked.page_token, &ListExportersRequest::default())?;
        let all = d3dgen_export::exporters::all().iter();
        let (exporters, next_page_token) =
            page.cut(all.map(|e| Exporter { name: e.name().into(), about: e.about().into() }));
        Ok(Response::new(ListExportersResponse { exporters, next_page_token }))
    }
}

/// Returns what to build.
fn building(asked: Option<BuildingRequest>) -> Result<Asked, Status> {
    let asked = super::required("building", asked)?;
    for (field, value) in
        [("building.floor_area_m2", asked.floor_area_m2), ("building.robot_radius_m", asked.robot_radius_m)]
    {
        if value.is_some_and(|v| !v.is_finite() || v <= 0.0) {
            return Err(invalid(field, "needs a figure above 0"));
        }
    }
    let clutter = asked.clutter.as_deref().map(|name| {
        Clutter::of(name).ok_or_else(|| invalid("building.clutter", format!("`{name}` is none of low, normal, high")))
    });
    let clutter = clutter.transpose()?;
    let style = Style::of_words(asked.styles.iter().map(String::as_str)).map_err(|e| invalid("building.styles", e))?;
    let robot = asked.robot.map_or_else(RobotBody::default, |r| RobotBody {
        width_m: r.width_m,
        length_m: r.length_m,
        height_m: r.height_m,
        turning_radius_m: r.turning_radius_m,
        climb_m: r.climb_m,
        fit: r.fit,
    });
    if let Some(problem) = robot.problems().into_iter().next() {
        return Err(invalid("building.robot", problem));
    }
    let brief: Option<Brief> = asked.brief.map(|b| document("building.brief", Some(b))).transpose()?;
    if brief.as_ref().is_some_and(|b| !asked.prompt.is_empty() && asked.prompt != b.prompt) {
        return Err(invalid("building.prompt", "is not that of building.brief; leave it empty"));
    }
    Ok(Asked {
        prompt: asked.prompt,
        brief,
        seed: asked.seed,
        domain: asked.domain_id,
        country: asked.country,
        rooms: asked.room_count,
        area_m2: asked.floor_area_m2,
        robot_radius_m: asked.robot_radius_m,
        robot,
        style: Style { clutter, ..style },
    })
}

/// Checks the name of a world: it becomes the name of folders.
fn world_named(name: Option<String>) -> Result<Option<String>, Status> {
    let fits =
        |n: &str| (1..=64).contains(&n.len()) && n.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'_'));
    match name {
        Some(name) if !fits(&name) => Err(invalid("name", "has 1 to 64 of a-z, 0-9 and _")),
        other => Ok(other),
    }
}

fn batch_of(job: Job) -> Result<Job, Status> {
    match job.spec {
        Spec::Batch(_) => Ok(job),
        _ => Err(invalid("job_id", format!("is a job of kind {}, not a batch", job.spec.kind()))),
    }
}

/// Returns true when a plan is to be kept.
fn has_locked_rooms(plan: &Floorplan) -> bool {
    plan.rooms.iter().any(|r| r.locked)
}

/// Returns an error once nobody waits for the answer.
fn go_on(stop: &std::sync::atomic::AtomicBool) -> Result<(), Status> {
    match stop.load(std::sync::atomic::Ordering::SeqCst) {
        true => Err(Status::cancelled("the call was given up")),
        false => Ok(()),
    }
}

/// Returns different plans of a graph with their costs, best first.
fn plans(
    graph: &SceneGraph,
    now: &Snapshot,
    pinned: Option<&Floorplan>,
    count: u32,
    stop: &std::sync::atomic::AtomicBool,
) -> Result<Vec<(f64, Floorplan)>, Status> {
    let plugin = plugin(now, "scene_graph.domain", &graph.domain)?;
    let limits = retrieve(graph, plugin).limits;
    let field = if pinned.is_some_and(has_locked_rooms) { "pinned" } else { "scene_graph" };
    let domain = plugin.domain();
    let mut refused = None;
    if count > 1 {
        let found = variations::variations(graph, domain, &limits, pinned, count as usize, stop.into());
        let mut found = found.map_err(|e| status::stage(field, e))?;
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.plan.seed.cmp(&b.plan.seed)));
        return Ok(found.into_iter().map(|v| (v.cost, v.plan)).collect());
    }
    for attempt in 0..SEEDS {
        let graph = SceneGraph { seed: attempt_seed(graph.seed, attempt), ..graph.clone() };
        match floorplan::generate_until(&graph, domain, &limits, pinned, stop.into()) {
            Ok(plan) => return Ok(vec![(plan.cost.iter().map(|term| term.cost).sum(), plan)]),
            Err(error @ d3dgen_pipeline::Error::Infeasible { .. }) => refused = refused.or(Some(error)),
            Err(error) => return Err(status::stage(field, error)),
        }
    }
    match refused {
        Some(error) => Err(status::stage("scene_graph", error)),
        None => Ok(Vec::new()),
    }
}

/// Judges a world.
pub(super) fn report(core: &Core, world: &World) -> Result<Report, Status> {
    let now = core.domains.now();
    let plugin: &dyn Plugin = plugin(&now, "world.scene_graph.domain", &world.scene_graph.domain)?;
    Ok(world::check(world, plugin.domain(), &retrieve(&world.scene_graph, plugin)))
}

fn judged(core: &Core, world: World) -> Result<CheckedWorld, Status> {
    let found = report(core, &world)?;
    Ok(checked(&world, &found))
}

pub(super) fn checked(world: &World, report: &Report) -> CheckedWorld {
    CheckedWorld { world: Some(message(world)), report: Some(message(report)) }
}
