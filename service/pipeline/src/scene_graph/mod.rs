//! Stage `scene_graph`: from a prompt to rooms and relations.
//!
//! No language model: rules over the words of the prompt and the data of the domains. The way of a prompt through the
//! folders, in this order:
//!
//! 1. `tokens`: text into words, numbers and measures, in the language it is in.
//! 2. `subject`: the building and its parts, and where it stands.
//! 3. `machines`: the robots; `levels`: the storeys. Their words name no rooms.
//! 4. `named`: the rooms and objects that are called by a name.
//! 5. `people`: who lives, works, sleeps and is treated there, which says how many rooms there are of some.
//! 6. `wished`: how many rooms of which type, and how they lie to each other; what nobody can plan.
//! 7. `reading` runs these steps and holds what they found: all that the prompt says, and nothing more.
//! 8. `built`: the rooms that are missing, names and sizes of all, doors; `levels` deals them to the storeys.
//!
//! `given` makes the graph of a plan that somebody brings, `proposed` that of what a language model proposes.

mod built;
mod draft;
mod given;
mod heard;
mod levels;
mod machines;
mod named;
mod people;
mod proposed;
mod reading;
mod subject;
mod tokens;
mod wished;

use d3dgen_knowledge::Query;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::style::Style;
use d3dgen_plugins::Registry;

pub(crate) use self::built::edges::rules_here;
use self::built::program::Planned;
pub(crate) use self::built::rooms::wished_assets;
pub(crate) use self::built::vital::is_missed;
use self::built::{edges, program, ring, rooms, workers};
pub(crate) use self::given::room_type_called;
pub use self::given::{Brought, Label, Understood, of_plan, understand};
use self::levels::deal;
pub(crate) use self::machines::charging::{dock_rank, docks_held, most_docks, widest_m};
use self::machines::{charging, robot_rules, robots};
use self::people::homes;
pub(crate) use self::people::seats::shortages;
pub(crate) use self::proposed::suits;
pub use self::proposed::{BY_PROPOSAL, Draft, DraftEdge, DraftRoom, Settled, propose};
use self::reading::Reading;
use self::subject::programs::is_dwelling;
pub(crate) use self::tokens::words::{brings, cleans};
use self::wished::wishes::MANY;
use crate::Error;

/// Returns the ISO 639-1 codes of the languages that prompts are read in.
pub fn languages() -> Vec<&'static str> {
    tokens::words::words().languages.keys().map(String::as_str).collect()
}

/// Reason of the doors to the corridor or hall.
const BY_CIRCULATION: &str = "circulation";

/// Reason of the edges that a prompt asks for.
pub(crate) const BY_PROMPT: &str = "prompt";

/// Reason of the openings of an open layout.
pub(crate) const BY_STYLE: &str = "style";

/// Reason of the edge between a room and the one it is entered from.
pub(crate) const BY_HOST: &str = "host";

/// Most rooms one world is planned for.
const MAX_ROOMS: u32 = MANY as u32;

/// Largest building, m^2.
const MAX_AREA_M2: f64 = 200_000.0;

/// A room for more people each is no place to work at but one to meet or wash in.
const MOST_IN_OFFICE: u32 = 4;

/// What to build: a prompt, and flags that overrule it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// What people ask for, in English, German, French, Spanish, Chinese or Korean.
    pub prompt: String,
    /// Seed of every random choice.
    pub seed: u64,
    /// Domain id; read from the prompt when absent.
    pub domain: Option<String>,
    /// Country as ISO 3166-1 alpha-2 code or name; read from the prompt when absent.
    pub country: Option<String>,
    /// Rooms in total, circulation aside.
    pub rooms: Option<u32>,
    /// Net floor area in total, m^2.
    pub area_m2: Option<f64>,
    /// Radius of the largest robot, m.
    pub robot_radius_m: Option<f64>,
    /// Body of the robot that the building is for, and whether it is made so that it fits.
    pub robot: RobotBody,
    /// How the building is to be; what is absent is read from the prompt.
    pub style: Style,
}

/// Turns a request into a scene graph.
///
/// # Errors
/// `Refused` for prompts without words, absurd sizes, unknown domains and countries, with what would work.
pub fn generate(request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let mut reading = reading::read(request, registry)?;
    let mut planned = program::complete(&mut reading);
    Ok(settle(request, registry, &mut reading, &mut planned))
}

fn refused(message: String) -> Error {
    Error::Refused { stage: "scene_graph", message }
}

/// Returns the graph of rooms, with those that building rules ask for beside them.
fn settle<'a>(
    request: &Request,
    registry: &'a Registry,
    reading: &mut Reading<'a>,
    planned: &mut Vec<Planned<'a>>,
) -> SceneGraph {
    let draft = assemble(request, reading.clone(), planned);
    if let Some(plugin) = registry.get(&draft.domain) {
        let missing = d3dgen_knowledge::missing_rooms(plugin.knowledge(), &Query::of_graph(&draft, plugin.domain()));
        if program::follow_rules(reading, planned, &missing) {
            return assemble(request, reading.clone(), planned);
        }
    }
    draft
}

/// Describes and connects the rooms.
fn assemble(request: &Request, mut reading: Reading, planned: &[Planned]) -> SceneGraph {
    let mut rooms = rooms::describe(&mut reading, planned);
    reading.occupancy.residents = homes::house(&reading, planned, &mut rooms);
    let levels = deal::levels(&mut reading);
    let (mut web, links) = if levels.len() > 1 {
        let areas: Vec<f64> = rooms.iter().map(|r| r.target_area_m2).collect();
        let dealt = deal::deal(&mut reading, planned, &areas, &levels);
        rooms.iter_mut().zip(dealt).for_each(|(room, level)| room.level = level);
        workers::name_toilets(reading.domain, &mut rooms);
        deal::even_out(planned, &mut rooms, &levels, is_dwelling(reading.program));
        let (all, web, links) = deal::connect(&mut reading, planned, rooms, &levels);
        rooms = all;
        (web, links)
    } else {
        (edges::connect(&mut reading, planned, &mut rooms), Vec::new())
    };
    ring::close(&reading, &links, &mut rooms, &mut web.edges);
    charging::add_docks(reading.domain, &reading.robots, &reading.docked, &mut rooms);
    robots::send(&reading.errand, &rooms, &mut reading.robots);
    let robot_rules = robot_rules::of_rooms(&reading.robot_rules, &rooms);
    edges::state_unmet(&mut reading, &rooms, &web.edges);
    SceneGraph {
        version: 1,
        prompt: request.prompt.clone(),
        seed: request.seed,
        domain: reading.domain.id.clone(),
        building_type: reading.building_type,
        country_code: reading.country_code,
        language: reading.language.into(),
        area_m2: reading.area_m2,
        occupancy: reading.occupancy,
        accessible: reading.accessible,
        style: reading.style,
        rooms,
        edges: web.edges,
        apart: web.apart,
        links,
        forbidden_room_types: reading.wishes.forbidden,
        robots: reading.robots,
        robot_rules,
        two_way: reading.two_way,
        assumptions: reading.assumptions,
        conflicts: reading.conflicts,
    }
}
