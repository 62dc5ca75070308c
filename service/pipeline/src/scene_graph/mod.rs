//! Stage `scene_graph`: from a prompt to rooms and relations.
//!
//! No language model: rules over the words of the prompt and the data of the domains. `reading` understands the prompt
//! with the modules about words, `program` completes the rooms, `rooms` names, sizes and furnishes them, `edges`
//! connects them.

mod addresses;
mod apiece;
mod beds;
mod building;
mod charging;
mod comparisons;
mod compounds;
mod deal;
mod docks;
mod dwelling;
mod edges;
mod fixtures;
mod given;
mod groups;
mod homes;
mod keeps;
mod labels;
mod language;
mod large;
mod layout;
mod listed;
mod measures;
mod mentions;
mod named_for;
mod negation;
mod numbered;
mod numbers;
mod objects;
mod parts;
mod places;
mod practitioners;
mod program;
mod proposed;
mod qualities;
mod reading;
mod relations;
mod ring;
mod robot_rules;
mod robots;
mod rooms;
mod seated;
mod seats;
mod senses;
mod sharing;
mod single;
mod spread;
mod stations;
mod stays;
mod storeys;
mod styles;
mod subsets;
mod text;
mod umlauts;
mod units;
mod unknown;
mod unread;
mod vital;
mod wishes;
mod words;
mod workers;

use d3dgen_knowledge::Query;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::style::Style;
use d3dgen_plugins::Registry;

pub(crate) use self::charging::{dock_rank, docks_held, most_docks, widest_m};
pub(crate) use self::edges::rules_here;
pub(crate) use self::given::room_type_called;
pub use self::given::{Brought, Label, Understood, of_plan, understand};
use self::program::Planned;
pub(crate) use self::proposed::suits;
pub use self::proposed::{BY_PROPOSAL, Draft, DraftEdge, DraftRoom, Settled, propose};
use self::reading::Reading;
pub(crate) use self::rooms::wished_assets;
pub(crate) use self::seats::shortages;
pub(crate) use self::vital::is_missed;
pub(crate) use self::words::{brings, cleans};
use crate::Error;

/// Reason of the doors to the corridor or hall.
const BY_CIRCULATION: &str = "circulation";

/// Reason of the edges that a prompt asks for.
pub(crate) const BY_PROMPT: &str = "prompt";

/// Reason of the openings of an open layout.
pub(crate) const BY_STYLE: &str = "style";

/// Reason of the edge between a room and the one it is entered from.
pub(crate) const BY_HOST: &str = "host";

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
        deal::even_out(planned, &mut rooms, &levels, reading::is_dwelling(reading.program));
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
