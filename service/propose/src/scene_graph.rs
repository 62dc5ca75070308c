//! The proposal of a scene graph: rooms, their areas and objects, connections.

use std::fmt::Write as _;

use d3dgen_llm::Request as LlmRequest;
use d3dgen_model::domain::{Domain, GENERIC_ROOM_TYPE};
use d3dgen_model::proposal::{Fate, FateCounts, ItemKind, ProposedItem, StageProposal};
use d3dgen_model::scene_graph::{Connector, SceneGraph};
use d3dgen_model::world::World;
use d3dgen_pipeline::Error;
use d3dgen_pipeline::generate::{Generated, Stage, contradictions, furnish_and_check, retrieve};
use d3dgen_pipeline::scene_graph::{self, BY_PROPOSAL, Draft, DraftEdge, DraftRoom};

use crate::ask::{Question, Trial, propose as ask};
use crate::json::{GraphAnswer, graph_schema, quoted};
use crate::prompt::{fenced, prompts};
use crate::{Desk, examples, works_not_out};

/// Most rooms, objects of a room and connections of an answer that are read.
const MOST_ROOMS: usize = 600;
const MOST_OBJECTS: usize = 30;
const MOST_EDGES: usize = 2000;
/// Room types and objects that a question names.
const MOST_TYPES: usize = 80;
/// Output tokens of an answer, and more of them for each room of the graph without proposals.
const TOKENS: (u32, u32) = (4096, 160);
/// How near two rooms are that were wished near each other, m.
const NEAR_M: f64 = 5.0;

/// Asks for a scene graph; returns the world that it became.
pub fn propose(desk: &mut Desk<'_, '_>, own: &SceneGraph) -> Result<(Option<Generated>, StageProposal), Error> {
    let question = question(desk, own);
    let own = own.clone();
    ask(desk, question, move |desk, answer: GraphAnswer| judge(desk, &own, &answer))
}

fn question(desk: &Desk<'_, '_>, own: &SceneGraph) -> Question {
    let domain = desk.plugin.domain();
    let (constraints, constraint_ids) = prompts().scene_graph.constraints(&retrieve(own, desk.plugin));
    let text = prompts().scene_graph.asked(&[
        ("request", &fenced(&desk.request.prompt)),
        ("domain", &domain.title),
        ("building", own.building_type.as_deref().unwrap_or("as the request says")),
        ("country", own.country_code.as_deref().unwrap_or("not given")),
        ("types", &types(domain)),
        ("constraints", &constraints),
        ("circulation", &domain.circulation.room_type),
        ("examples", &examples::graphs(desk.registry, domain)),
    ]);
    let mut request = LlmRequest::new(Stage::SceneGraph.name(), text)
        .with_system(prompts().system.trim())
        .with_schema(graph_schema());
    request.max_output_tokens = TOKENS.0.saturating_add(TOKENS.1.saturating_mul(own.rooms.len() as u32));
    Question { stage: Stage::SceneGraph, request, constraint_ids }
}

fn types(domain: &Domain) -> String {
    let mut out = String::new();
    let asked = domain.room_types.iter().filter(|t| t.id != GENERIC_ROOM_TYPE && t.id != domain.circulation.room_type);
    for kind in asked.take(MOST_TYPES) {
        let range = kind.area_m2;
        let _ = writeln!(out, "- {}: {}, {}-{}, {}", kind.id, kind.label, range.min, range.max, range.target);
    }
    out.trim_end().to_owned()
}

fn judge(desk: &mut Desk<'_, '_>, own: &SceneGraph, answer: &GraphAnswer) -> Result<Trial<Generated>, Error> {
    let draft = draft(answer);
    let mut settled = scene_graph::propose(desk.request, desk.registry, &draft)?;
    for item in &mut settled.items {
        item.proposed = quoted(&item.proposed);
    }
    for (all, most, kind, what) in [
        (answer.rooms.len(), MOST_ROOMS, ItemKind::Room, "rooms"),
        (answer.edges.len(), MOST_EDGES, ItemKind::Edge, "connections"),
    ] {
        settled.items.extend(unread(all, most, kind, what));
    }
    let mut trial = Trial { result: None, items: settled.items, note: String::new() };
    let kept = |i: &ProposedItem| i.kind == ItemKind::Room && matches!(i.fate, Fate::Kept | Fate::Moved);
    if !trial.items.iter().any(kept) {
        trial.note = "no room of it is of use, so the rooms are those without a model".into();
        give_up(&mut trial.items);
        return Ok(trial);
    }
    if contradictions(&settled.graph).len() > contradictions(own).len() {
        trial.note = "with it the rooms contradict the prompt, so they are those without a model".into();
        give_up(&mut trial.items);
        return Ok(trial);
    }
    let made = furnish_and_check(&settled.graph, desk.registry, desk.settings, desk.observe, desk.cancelled);
    match made {
        Ok(made) if made.report.is_writable() => {
            trial.note = "the building has the proposed rooms, as the prompt and the rules allow".into();
            trial.result = Some(made);
        }
        Err(error) if !works_not_out(&error) => return Err(error),
        other => {
            let why = other.err().map_or_else(|| "it would break hard rules".to_owned(), |e| e.to_string());
            trial.note = format!("no sound building was found with it, so the rooms are those without a model: {why}");
            give_up(&mut trial.items);
        }
    }
    Ok(trial)
}

/// Says of everything that was taken that it is not, after all.
fn give_up(items: &mut Vec<ProposedItem>) {
    items.retain(|i| i.fate != Fate::Added);
    for item in items.iter_mut().filter(|i| matches!(i.fate, Fate::Kept | Fate::Moved)) {
        item.fate = Fate::Replaced;
        item.reason = "the rooms are those without a model".into();
    }
}

/// Returns the entry for what was too much to read.
pub fn unread(all: usize, most: usize, kind: ItemKind, what: &str) -> Option<ProposedItem> {
    let more = all.checked_sub(most).filter(|n| *n > 0)?;
    Some(ProposedItem {
        kind,
        proposed: format!("{more} more {what}"),
        fate: Fate::Dropped,
        id: None,
        from: None,
        to: None,
        rule: None,
        reason: format!("of one answer {most} {what} are read"),
    })
}

fn draft(answer: &GraphAnswer) -> Draft {
    let rooms = answer.rooms.iter().take(MOST_ROOMS).map(|r| DraftRoom {
        id: r.id.clone(),
        room_type: r.room_type.clone(),
        name: r.name.clone(),
        area_m2: r.area_m2,
        objects: r.objects.iter().take(MOST_OBJECTS).cloned().collect(),
    });
    let edges = answer.edges.iter().take(MOST_EDGES).map(|e| DraftEdge {
        a: e.a.clone(),
        b: e.b.clone(),
        connector: e.connector,
    });
    Draft { rooms: rooms.collect(), edges: edges.collect() }
}

/// Says of the wishes that a proposal added to the graph whether the finished world grants them.
pub fn look_at_wishes(record: &mut StageProposal, world: &World) {
    for item in record.items.iter_mut().filter(|i| i.fate == Fate::Kept) {
        let Some(id) = item.id.clone() else { continue };
        match item.kind {
            ItemKind::Edge => {
                let Some((a, b)) = id.split_once(" - ") else { continue };
                let graph = &world.scene_graph;
                let between = |e: &&d3dgen_model::scene_graph::GraphEdge| {
                    e.reason == BY_PROPOSAL && (e.a == a && e.b == b || e.a == b && e.b == a)
                };
                if graph.edges.iter().find(between).is_some_and(|e| !is_met(world, a, b, e.connector)) {
                    item.fate = Fate::Dropped;
                    item.reason = "the plan does not join the two: it was a wish, and others went before it".into();
                }
            }
            ItemKind::Object => {
                let Some((room, object)) = id.split_once('/') else { continue };
                let stands = world.placements.placements.iter().find(|p| p.room_id == room && p.object == object);
                match stands {
                    Some(p) => item.id = Some(p.placement_id.clone()),
                    None => {
                        let why = world.placements.unplaced.iter().find(|u| u.room_id == room && u.item == object);
                        item.fate = Fate::Dropped;
                        item.id = None;
                        item.reason = why.map_or_else(|| "it found no place".into(), |u| u.reason.clone());
                    }
                }
            }
            ItemKind::Room => {}
        }
    }
    record.counts = FateCounts::of(&record.items);
}

/// Returns true when two rooms meet as wished.
fn is_met(world: &World, a: &str, b: &str, connector: Connector) -> bool {
    let both = |ids: &[String]| ids.iter().any(|r| r == a) && ids.iter().any(|r| r == b);
    let plan = &world.floorplan;
    let door = plan.doors.iter().any(|d| both(&d.room_ids));
    let wall = door || plan.walls.iter().any(|w| both(&w.room_ids));
    let bounds = |id: &str| plan.room(id).map(|r| r.polygon.bounds());
    match connector {
        Connector::Door | Connector::Open => door,
        Connector::Wall => wall,
        Connector::Near => wall || bounds(a).zip(bounds(b)).is_some_and(|(a, b)| a.gap(&b) <= NEAR_M),
    }
}
