//! The tools, one row each: what an agent may ask for, and what is done then.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use d3dgen_assets::search::{Filters, SearchQuery};
use d3dgen_export::exporters::plan;
use d3dgen_model::edits::Edit;
use d3dgen_model::report::{Fate, Report, Status};
use d3dgen_model::world::World;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_pipeline::{Stop, generate as pipeline, world};
use d3dgen_prompt::PromptReader;
use d3dgen_store::index::Mode;
use rmcp::model::{JsonObject, Tool as Listed, ToolAnnotations};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::workshop::Workshop;
use crate::commands::assets::common;
use crate::commands::formats::{self, FormatArgs};
use crate::commands::generate::Job;
use crate::commands::generate::one::Maker;
use crate::commands::{brief, edit, knowledge};
use crate::error::Error;
use crate::output::Output;
use crate::progress::Progress;
use crate::summary;

/// Most rules or assets that one call lists.
const MOST_FOUND: usize = 50;

/// What a tool answers.
pub struct Answer {
    /// For whoever reads.
    pub text: String,
    /// The same as data.
    pub data: Value,
    /// A picture.
    pub png: Option<Vec<u8>>,
}

impl Answer {
    /// Returns data with the text that it is as JSON.
    fn of(data: Value) -> Self {
        Self { text: data.to_string(), data, png: None }
    }
}

type Run = dyn Fn(&Workshop, JsonObject, &AtomicBool) -> Result<Answer, Error> + Send + Sync;

/// A tool.
pub struct Tool {
    /// Its name.
    pub name: &'static str,
    about: &'static str,
    writes: bool,
    schema: Arc<JsonObject>,
    run: Box<Run>,
}

impl Tool {
    /// Returns a tool that only looks.
    fn reading<A: DeserializeOwned + JsonSchema + 'static>(
        name: &'static str,
        about: &'static str,
        run: fn(&Workshop, A, &AtomicBool) -> Result<Answer, Error>,
    ) -> Self {
        let run = move |workshop: &Workshop, arguments: JsonObject, stop: &AtomicBool| {
            let arguments = serde_json::from_value(Value::Object(arguments));
            let arguments = arguments.map_err(|e| Error::Input(format!("arguments of `{name}`: {e}")))?;
            run(workshop, arguments, stop)
        };
        let schema = schemars::generate::SchemaSettings::draft2020_12()
            .with(|s| s.inline_subschemas = true)
            .into_generator()
            .into_root_schema_for::<A>();
        let schema = schema.as_object().cloned().unwrap_or_default();
        Self { name, about, writes: false, schema: Arc::new(schema), run: Box::new(run) }
    }

    /// Returns the tool as one that writes files.
    fn writing(self) -> Self {
        Self { writes: true, ..self }
    }

    /// Returns the tool as clients list it.
    pub fn listed(&self) -> Listed {
        let hints = ToolAnnotations::new().read_only(!self.writes).open_world(false);
        Listed::new(self.name, self.about, Arc::clone(&self.schema)).with_annotations(hints)
    }

    /// Does what the tool is for.
    ///
    /// # Errors
    /// `Input` for arguments that do not fit its schema, and those of the command.
    pub fn call(&self, workshop: &Workshop, arguments: JsonObject, stop: &AtomicBool) -> Result<Answer, Error> {
        (self.run)(workshop, arguments, stop)
    }
}

/// Returns every tool, in the order of a session.
pub fn all() -> Vec<Tool> {
    vec![
        Tool::reading("domains", "Kinds of building that can be made, with their room types.", domains),
        Tool::reading("brief", "What a sentence is understood as, fact by fact, before anything is planned.", read_brief),
        Tool::reading(
            "generate",
            "Make a checked world from a sentence, in a folder of its name; an earlier world of that name is replaced. \
             Answers which wishes are met, what was assumed, and a picture of the plan.",
            generate,
        )
        .writing(),
        Tool::reading("worlds", "Names of the worlds there are.", worlds),
        Tool::reading("rooms", "Rooms, walls and doors of a world, with their ids.", rooms),
        Tool::reading("objects", "Furniture of a world or of one of its rooms, with ids and positions in m.", objects),
        Tool::reading("plan", "Picture of the plan of a world.", draw),
        Tool::reading(
            "edit",
            "Change a world: move a wall, add or remove a room, move, swap, add or remove an object, furnish anew, lock. \
             The rest stays; the outcome is checked.",
            change,
        )
        .writing(),
        Tool::reading("check", "Judge a world: hard rules, building rules with figures and sources, wishes.", check),
        Tool::reading("rules", "Search the database of building rules.", rules),
        Tool::reading("assets", "Search the database of 3D models.", find_assets),
        Tool::reading("export", "Write a world in the formats of simulators.", export).writing(),
    ]
}

/// No arguments.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Nothing {}

/// A sentence.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Prompt {
    /// What to build, in a sentence of any of the languages that are read.
    prompt: String,
}

/// A world to make.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Wanted {
    /// What to build, in a sentence.
    prompt: String,
    /// Name of the world: a-z, 0-9 and _.
    name: String,
    /// Seed of all choices.
    #[serde(default)]
    seed: u64,
    /// Kind of building (`domains` lists them); otherwise read from the prompt.
    domain: Option<String>,
    /// Country or division whose rules apply: a code (DE, CA-ON), its name or a city.
    country: Option<String>,
    /// Number of rooms, corridors not counted.
    rooms: Option<u32>,
    /// Floor area, m2.
    area_m2: Option<f64>,
    /// Formats to write, arena and plan when none is given; `all` for every one.
    #[serde(default)]
    formats: Vec<String>,
    /// Build what contradicts itself too.
    #[serde(default)]
    allow_conflicts: bool,
}

/// A world there is.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Named {
    /// Name of the world.
    world: String,
}

/// A world, or a room of it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct NamedRoom {
    /// Name of the world.
    world: String,
    /// Id of a room; all rooms otherwise.
    room_id: Option<String>,
}

/// Changes of a world.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Changes {
    /// Name of the world.
    world: String,
    /// The changes, in their order.
    edits: Vec<Edit>,
    /// Name of the world to write; the changed one replaces the old one otherwise.
    name: Option<String>,
}

/// A search among building rules.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RuleSearch {
    /// What to find, in any words.
    words: String,
    /// Only rules that apply in this country, by its code.
    country: Option<String>,
    /// Only rules of this kind of building.
    domain: Option<String>,
    /// Most rules to list, at most 50.
    #[serde(default = "usual_limit")]
    limit: usize,
}

/// A search among models.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AssetSearch {
    /// What to find, in any words; "under 80 cm wide" may be among them.
    words: String,
    /// Room type it is for.
    room_type: Option<String>,
    /// Only assets of this kind of building.
    domain: Option<String>,
    /// Most assets to list, at most 50.
    #[serde(default = "usual_limit")]
    limit: usize,
}

/// A world to write for a simulator.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Export {
    /// Name of the world.
    world: String,
    /// Formats; `all` for every one.
    formats: Vec<String>,
}

const fn usual_limit() -> usize {
    10
}

fn domains(workshop: &Workshop, _: Nothing, _: &AtomicBool) -> Result<Answer, Error> {
    let list: Vec<Value> = workshop
        .registry
        .iter()
        .map(|plugin| {
            let domain = plugin.domain();
            let rooms: Vec<&str> = domain.room_types.iter().map(|r| r.id.as_str()).collect();
            let kinds: Vec<&str> = domain.programs.iter().map(|p| p.id.as_str()).collect();
            json!({"id": domain.id, "title": domain.title, "building_types": kinds, "room_types": rooms})
        })
        .collect();
    Ok(Answer::of(json!({ "domains": list })))
}

fn read_brief(workshop: &Workshop, asked: Prompt, _: &AtomicBool) -> Result<Answer, Error> {
    let read = PromptReader::new(&workshop.registry).read(&asked.prompt);
    Ok(Answer { text: brief::lines(&read, false), data: json!(read.brief), png: None })
}

fn generate(workshop: &Workshop, asked: Wanted, stop: &AtomicBool) -> Result<Answer, Error> {
    let formats = if asked.formats.is_empty() { formats::usual() } else { asked.formats };
    let path = workshop.path(&asked.name)?;
    let maker = Maker {
        registry: &workshop.registry,
        formats: FormatArgs::without_png(formats).chosen(&workshop.args.store)?,
        allow_conflicts: asked.allow_conflicts,
        proposals: None,
        flag: stop,
    };
    let request = Request {
        prompt: asked.prompt,
        seed: asked.seed,
        domain: asked.domain,
        country: asked.country,
        rooms: asked.rooms,
        area_m2: asked.area_m2,
        ..Request::default()
    };
    let job = Job { request, name: Some(asked.name.clone()), path };
    let made = maker.make(&job, &Progress::silent())?;
    let png = if made.sound() { Some(picture(workshop, &workshop.world(&asked.name)?)?) } else { None };
    Ok(Answer { text: made.page(), data: made.json(), png })
}

fn worlds(workshop: &Workshop, _: Nothing, _: &AtomicBool) -> Result<Answer, Error> {
    Ok(Answer::of(json!({ "worlds": workshop.names() })))
}

fn rooms(workshop: &Workshop, asked: Named, _: &AtomicBool) -> Result<Answer, Error> {
    let world = workshop.world(&asked.world)?;
    let plan = &world.floorplan;
    let rooms: Vec<Value> = plan
        .rooms
        .iter()
        .map(|r| {
            json!({
                "room_id": r.room_id, "room_type": r.room_type, "name": r.name, "level": r.level,
                "area_m2": r.net_area_m2, "polygon": r.net_polygon, "circulation": r.circulation,
            })
        })
        .collect();
    Ok(Answer::of(json!({ "rooms": rooms, "walls": plan.walls, "doors": plan.doors })))
}

fn objects(workshop: &Workshop, asked: NamedRoom, _: &AtomicBool) -> Result<Answer, Error> {
    let world = workshop.world(&asked.world)?;
    if let Some(id) = asked.room_id.as_ref().filter(|id| !world.floorplan.rooms.iter().any(|r| r.room_id == **id)) {
        return Err(Error::Input(format!("world `{}` has no room `{id}`; `rooms` lists them", asked.world)));
    }
    let among = |room: &str| asked.room_id.as_deref().is_none_or(|id| id == room);
    let list: Vec<Value> = world
        .placements
        .placements
        .iter()
        .filter(|p| among(&p.room_id))
        .map(|p| json!({"placement_id": p.placement_id, "room_id": p.room_id, "object": p.object, "asset": p.asset, "pose": p.pose, "size_m": p.size_m}))
        .collect();
    Ok(Answer::of(json!({ "objects": list })))
}

fn draw(workshop: &Workshop, asked: Named, _: &AtomicBool) -> Result<Answer, Error> {
    let world = workshop.world(&asked.world)?;
    let png = Some(picture(workshop, &world)?);
    Ok(Answer { text: format!("plan of {}", world.name), data: json!({"world": world.name}), png })
}

fn picture(workshop: &Workshop, world: &World) -> Result<Vec<u8>, Error> {
    let domain = workshop.plugin(world)?.domain();
    Ok(plan::png(&plan::svg(world, domain))?)
}

fn change(workshop: &Workshop, asked: Changes, stop: &AtomicBool) -> Result<Answer, Error> {
    let mut world = workshop.world(&asked.world)?;
    if let Some(name) = &asked.name {
        world.name.clone_from(name);
    }
    let out = workshop.path(asked.name.as_deref().unwrap_or(&asked.world))?;
    let formats = FormatArgs::without_png(formats::usual()).chosen(&workshop.args.store)?;
    let edits = edit::checked(asked.edits)?;
    let plugin = workshop.plugin(&world)?;
    let (edited, kept) = edit::write(&world, &edits, plugin, &formats, &out, Stop::from(stop))?;
    let changed =
        if edited.changed_room_ids.is_empty() { "no room".into() } else { edited.changed_room_ids.join(", ") };
    let mut text = format!("{}; changed: {changed}\n", summary::verdict(&edited.report));
    text += &summary::broken_lines(&edited.report).iter().map(|line| format!("{line}\n")).collect::<String>();
    let data = json!({
        "world": edited.world.name, "written": kept.is_none(), "changed_room_ids": edited.changed_room_ids,
        "judged": judgement(&edited.report),
    });
    let png = if kept.is_none() { Some(picture(workshop, &edited.world)?) } else { None };
    Ok(Answer { text, data, png })
}

fn check(workshop: &Workshop, asked: Named, _: &AtomicBool) -> Result<Answer, Error> {
    let world = workshop.world(&asked.world)?;
    let plugin = workshop.plugin(&world)?;
    let retrieved = pipeline::retrieve(&world.scene_graph, plugin);
    let report = world::check(&world, plugin.domain(), &retrieved);
    let wishes = workshop.report(&asked.world)?.asks;
    let mut data = judgement(&report);
    data["asks"] = json!(wishes);
    data["constraints_violated"] =
        json!(report.constraints.iter().filter(|c| c.status == Status::Violated).collect::<Vec<_>>());
    let met = wishes.iter().filter(|a| a.fate == Fate::Honored).count();
    let text = format!("{}; {met} of {} wishes met\n{data}", summary::verdict(&report), wishes.len());
    Ok(Answer { text, data, png: None })
}

/// Returns the verdict with the hard rules that are broken.
fn judgement(report: &Report) -> Value {
    json!({
        "sound": report.sound, "verdict": summary::verdict(report), "hard_rules": report.rules.len(),
        "broken": summary::broken_lines(report), "constraints": report.summary,
    })
}

fn rules(workshop: &Workshop, asked: RuleSearch, _: &AtomicBool) -> Result<Answer, Error> {
    let limit = asked.limit.clamp(1, MOST_FOUND);
    let search = knowledge::search::Args::of(asked.words, asked.country, asked.domain, limit, workshop.args.clone());
    let answer = search.answer()?;
    let found: Vec<Value> = answer.found.iter().map(knowledge::search::json).collect();
    let lines: String = answer.found.iter().map(knowledge::search::shown).collect();
    let text = answer.note.map(|note| format!("{note}\n")).unwrap_or_default() + &lines;
    Ok(Answer { text, data: json!({ "rules": found }), png: None })
}

fn find_assets(workshop: &Workshop, asked: AssetSearch, _: &AtomicBool) -> Result<Answer, Error> {
    let mut filters = Filters::default();
    if let Some(domain) = &asked.domain {
        filters.add(&format!("domain={domain}"))?;
    }
    let query = SearchQuery {
        text: asked.words,
        filters,
        room_type: asked.room_type,
        domain: asked.domain,
        limit: asked.limit.clamp(1, MOST_FOUND),
        mode: Mode::Hybrid,
        one_per_object: true,
        ..SearchQuery::default()
    };
    let world = common::World::load(&workshop.args)?;
    let found = world.searcher(&workshop.args.store)?.search(&query)?;
    Ok(Answer::of(json!({ "assets": found.iter().map(common::json_line).collect::<Vec<_>>() })))
}

fn export(workshop: &Workshop, asked: Export, _: &AtomicBool) -> Result<Answer, Error> {
    let world = workshop.world(&asked.world)?;
    let formats = FormatArgs::with_png(asked.formats).chosen(&workshop.args.store)?;
    let path = workshop.path(&asked.world)?;
    let output = Output::adding_to(&path)?;
    formats.write(&world, workshop.plugin(&world)?.domain(), &output)?;
    output.commit()?;
    Ok(Answer::of(json!({ "world": world.name, "formats": formats.names(), "folder": path.display().to_string() })))
}
