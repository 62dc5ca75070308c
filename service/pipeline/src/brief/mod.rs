//! Stage `brief`: what is asked for, from words; and from there to the rooms.
//!
//! The rules of `d3dgen-prompt` read every prompt into a brief, which the finished world answers fact by fact. The rooms are made
//! of the same brief where the older reader of `d3dgen-program` does not know the prompt's language, or where somebody wrote
//! the brief; else of the words by that reader, unless the rooms of the brief keep more of what was asked for.

use std::collections::BTreeMap;

use d3dgen_model::brief::{Ask, Brief, Fact};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::scene_graph::{Note, SceneGraph};
use d3dgen_model::stage::Error;
use d3dgen_plugins::Registry;
use d3dgen_prompt::{PromptReader, ReadPrompt};

mod kept;

use crate::scene_graph::{self, Request, says_nothing};

/// Things that one reading must keep more of a brief than the other in order to be taken instead.
const MISSED: usize = 2;

/// Code of what is assumed where a building has parts of which one was planned.
const PART_PLANNED: &str = "part_planned";

/// Code of what is told where a request overrules the kind of building that its words suggest.
const BY_FLAG: &str = "domain_flag";

/// Codes of what is assumed where a prompt names no building that a domain knows.
const NO_BUILDING: [&str; 2] = ["default_domain", "domain_from_rooms"];

/// Reads a prompt; none where there are no words.
pub fn of_prompt(prompt: &str, registry: &Registry) -> Option<Brief> {
    read(prompt, registry).map(|read| read.brief)
}

fn read(prompt: &str, registry: &Registry) -> Option<ReadPrompt> {
    (!prompt.trim().is_empty()).then(|| PromptReader::new(registry).read(prompt))
}

/// Reads the prompt of a building that is planned; none for a plan that somebody brought, which has the name of its file there.
pub fn of_plan(prompt: &str, plan: Option<&Floorplan>, registry: &Registry) -> Option<Brief> {
    if plan.is_some_and(Floorplan::is_given) { None } else { of_prompt(prompt, registry) }
}

/// Makes the rooms of a request, with the brief that they answer to.
///
/// # Errors
/// `Refused` for prompts without words, kinds of buildings that no domain knows, absurd sizes, unknown domains and countries.
pub fn rooms(request: &Request, registry: &Registry) -> Result<(SceneGraph, Option<Brief>), Error> {
    if let Some(brief) = &request.brief {
        return Ok((rooms_of(brief, request, registry)?, Some(brief.clone())));
    }
    let Some(ReadPrompt { brief, told_by_a_part, .. }) = read(&request.prompt, registry) else {
        return Ok((scene_graph::generate(request, registry)?, None));
    };
    let mut graph = rooms_of_prompt(&brief, request, registry)?;
    graph.assumptions.extend(likely_rooms(&brief, &told_by_a_part, &graph));
    Ok((graph, Some(brief)))
}

/// Makes the rooms of a prompt that was read into a brief.
fn rooms_of_prompt(brief: &Brief, request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let of_words = brief.languages.first().is_none_or(|l| scene_graph::reads(l));
    let free = request.domain.is_none();
    if !of_words || free && says_nothing(brief) {
        return rooms_of(brief, request, registry);
    }
    let graph = scene_graph::generate_with(brief, request, registry)?;
    let graph = in_its_kind(brief, graph, request, registry)?;
    let unnamed = graph.assumptions.iter().any(|n| NO_BUILDING.contains(&n.code.as_str()));
    // a kind of building that no domain knows is no home by its rooms
    let unknown = free && unnamed && brief.building.as_ref().is_some_and(|b| b.domain.is_none());
    if unknown { rooms_of(brief, request, registry) } else { Ok(fuller(brief, graph, request, registry)) }
}

/// Says of rooms whose names no lexicon has as what they were furnished, by a part of their names.
fn likely_rooms(brief: &Brief, told: &BTreeMap<String, String>, graph: &SceneGraph) -> Option<Note> {
    let asked = |(name, id): &(&String, &String)| {
        let same =
            |a: &Ask| matches!(&a.fact, Fact::Rooms(r) if &r.room.name == *name && r.room.id.as_ref() == Some(*id));
        brief.asks.iter().any(same) && graph.rooms.iter().any(|r| &r.room_type == *id)
    };
    let all: Vec<String> =
        told.iter().filter(asked).map(|(name, id)| format!("`{name}` ({})", id.replace('_', " "))).collect();
    let message = format!("no room is known by these names; furnished by a part of them: {}", all.join(", "));
    (!all.is_empty()).then(|| Note::new("room_likely", message))
}

/// Returns the rooms of a prompt in the kind of building that its words name, where one odd room had moved them to another: a house
/// with a music room is a house.
fn in_its_kind(brief: &Brief, graph: SceneGraph, request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let named = brief.building.as_ref().filter(|b| b.confidence >= 1.0 && !b.words.is_empty());
    let domain = named.and_then(|b| b.domain.as_ref()).filter(|d| **d != graph.domain && request.domain.is_none());
    let Some(domain) = domain else { return Ok(graph) };
    let flagged = Request { domain: Some(domain.clone()), ..request.clone() };
    let mut other = scene_graph::generate_with(brief, &flagged, registry)?;
    // two kinds of offices are near enough
    if scene_graph::is_home(&other, registry) == scene_graph::is_home(&graph, registry) {
        return Ok(graph);
    }
    other.conflicts.retain(|note| note.code != BY_FLAG);
    Ok(other)
}

/// Returns the rooms that were made of the words, or those of the brief alone where these keep more of what it asks for.
fn fuller(brief: &Brief, of_words: SceneGraph, request: &Request, registry: &Registry) -> SceneGraph {
    let missed = kept::missed(brief, &of_words);
    // what a home has is said in many words of which the brief has no fact
    let home = scene_graph::is_home(&of_words, registry);
    if missed < MISSED || !brief.not_understood.is_empty() || home || has_parts(&of_words) {
        return of_words;
    }
    match rooms_of(brief, request, registry) {
        Ok(graph) if same(&graph, &of_words) && kept::missed(brief, &graph) == 0 => graph,
        _ => of_words,
    }
}

/// Returns true for a graph of departments or units, which no fact of a brief says.
fn has_parts(graph: &SceneGraph) -> bool {
    graph.rooms.iter().any(|r| r.unit.is_some()) || graph.assumptions.iter().any(|n| n.code == PART_PLANNED)
}

/// Returns true for graphs of one kind of building, of which the first says for how many people it is where the other does.
fn same(a: &SceneGraph, b: &SceneGraph) -> bool {
    let told = |graph: &SceneGraph| [graph.occupancy.staff.is_some(), graph.occupancy.beds.is_some()];
    let peopled = told(a).into_iter().zip(told(b)).all(|(own, other)| own || !other);
    a.domain == b.domain && a.building_type == b.building_type && peopled
}

/// Makes the rooms of a brief; the flags of the request overrule it.
///
/// # Errors
/// As [`rooms`].
pub fn rooms_of(brief: &Brief, request: &Request, registry: &Registry) -> Result<SceneGraph, Error> {
    let mut graph = scene_graph::of_brief(brief, request, registry)?;
    graph.prompt.clone_from(&brief.prompt);
    if let Some(first) = brief.languages.first() {
        graph.language.clone_from(first);
    }
    if !brief.not_understood.is_empty() {
        let words: Vec<&str> = brief.not_understood.iter().map(|w| w.text.as_str()).collect();
        let message = format!("not understood, and so not planned: `{}`", words.join("`, `"));
        graph.conflicts.push(Note::new("not_understood", message));
    }
    Ok(graph)
}
