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
//! 7. `read` runs these steps, `reading` holds what they found: all that the prompt says, and nothing more.
//! 8. `built`: the rooms that are missing, names and sizes of all, doors; `levels` deals them to the storeys, `settle`
//!    states them as the graph.
//!
//! `given` makes the graph of a plan that somebody brings, `proposed` that of what a language model proposes.

mod briefed;
mod built;
mod draft;
mod given;
mod guessed;
mod heard;
mod levels;
mod machines;
mod named;
mod people;
mod proposed;
mod read;
mod reading;
mod request;
mod settle;
mod subject;
mod tokens;
mod wished;

use d3dgen_model::brief::Brief;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;

pub use self::briefed::says_nothing;
use self::built::program;
pub use self::built::rooms::wished_assets;
pub use self::built::vital::is_missed;
pub use self::given::room_type_called;
pub use self::given::{Brought, Label, Understood, of_plan, understand};
pub use self::people::seats::{Short, short_rooms, shortages};
pub use self::proposed::{BY_PROPOSAL, Draft, DraftEdge, DraftRoom, Settled, propose};
pub use self::request::Request;
use self::subject::programs;

/// Returns the ISO 639-1 codes of the languages that prompts are read in.
pub fn languages() -> Vec<&'static str> {
    tokens::words::words().languages.keys().map(String::as_str).collect()
}

/// Turns a request into a scene graph.
///
/// # Errors
/// `Refused` for prompts without words, absurd sizes, unknown domains and countries, with what would work.
pub fn generate(request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let mut reading = read::read(request, registry)?;
    let mut planned = program::complete(&mut reading);
    Ok(settle::settle(request, registry, &mut reading, &mut planned))
}

/// As [`generate`], with a brief of the same prompt: what it states and the words here were not read for is planned as well.
///
/// # Errors
/// As [`generate`].
pub fn generate_with(brief: &Brief, request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let mut reading = read::read(request, registry)?;
    briefed::restore(&mut reading, brief, registry);
    let mut planned = program::complete(&mut reading);
    Ok(settle::settle(request, registry, &mut reading, &mut planned))
}

/// Returns true for languages, by ISO 639-1 code, that [`generate`] reads.
pub fn reads(language: &str) -> bool {
    tokens::words::words().languages.contains_key(language)
}

/// Returns true for a graph of a building that people live in.
pub fn is_home(graph: &SceneGraph, registry: &Registry) -> bool {
    let domain = registry.get(&graph.domain).map(|p| p.domain());
    domain.is_some_and(|d| programs::is_dwelling(programs::program_of(d, graph.building_type.as_deref())))
}

/// Turns a brief into a scene graph; the flags of the request overrule it, its prompt is not read.
///
/// # Errors
/// `Refused` for kinds of buildings that no domain knows, absurd sizes, unknown domains and countries.
pub fn of_brief(brief: &Brief, request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let mut reading = briefed::read(brief, request, registry)?;
    let mut planned = program::complete(&mut reading);
    Ok(settle::settle(request, registry, &mut reading, &mut planned))
}
