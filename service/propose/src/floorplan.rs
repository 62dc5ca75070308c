//! The proposal of a floorplan: rectangles for each room.

use std::fmt::Write as _;

use d3dgen_knowledge::Retrieval;
use d3dgen_llm::Request as LlmRequest;
use d3dgen_model::domain::Daylight;
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::geometry::{Polygon, Rect, to_mm};
use d3dgen_model::proposal::{Fate, ItemKind, ProposedItem, Spot, StageProposal};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::floorplan::{Follow, MOST_SKETCHED, Sketch};
use d3dgen_pipeline::generate::{Generated, Stage, attempt_seed, retrieve};
use d3dgen_pipeline::{Error, floorplan, placement};

use crate::ask::{Question, Trial, not_asked, propose as ask};
use crate::json::{OutlineAnswer, PlanAnswer, RectAnswer, plan_schema, quoted};
use crate::prompt::{fenced, prompts};
use crate::scene_graph::unread;
use crate::{Desk, examples, works_not_out};

/// Most rooms and rectangles of a room in an answer that are read.
const MOST_ROOMS: usize = 200;
const MOST_RECTS: usize = 8;
/// Seeds under which a proposed plan is furnished.
const SEEDS: u32 = 3;
/// Output tokens of an answer, and more of them for each room.
const TOKENS: (u32, u32) = (4096, 120);
/// Share of its area from which on an outline is as proposed, and from which on it is near it.
const SAME: f64 = 0.97;
const NEAR: f64 = 0.3;

/// Asks for a floorplan of a building that stands; returns the building that it became.
pub fn propose(desk: &mut Desk<'_, '_>, base: &Generated) -> Result<(Option<Generated>, StageProposal), Error> {
    let graph = &base.world.scene_graph;
    if graph.has_storeys() {
        let note = "the building has several storeys, whose plans follow from each other: they are planned as ever";
        return Ok((None, not_asked(Stage::Floorplan, note)));
    }
    if graph.rooms.len() > MOST_SKETCHED {
        let note = format!("{} rooms are more than the {MOST_SKETCHED} that are asked for", graph.rooms.len());
        return Ok((None, not_asked(Stage::Floorplan, &note)));
    }
    let question = question(desk, graph);
    let base = base.clone();
    ask(desk, question, move |desk, answer: PlanAnswer| judge(desk, &base, &answer))
}

fn question(desk: &Desk<'_, '_>, graph: &SceneGraph) -> Question {
    let domain = desk.plugin.domain();
    let retrieved = retrieve(graph, desk.plugin);
    let (constraints, constraint_ids) = prompts().floorplan.constraints(&retrieved);
    let corridor = retrieved.limits.corridor_m(&domain.circulation);
    let mut rooms = String::new();
    for room in &graph.rooms {
        let kind = domain.room_type_or_generic(&room.room_type);
        let light = if kind.daylight == Daylight::Required { ", daylight" } else { "" };
        let entrance = if room.entrance { ", entrance from outside" } else { "" };
        let [min, max] = room.area_range_m2;
        let _ = writeln!(
            rooms,
            "- {}: {}, {min}-{max}, {}, {}{light}{entrance}",
            room.id, room.room_type, room.target_area_m2, kind.min_dimension_m
        );
    }
    let mut edges = String::new();
    let mut listed: Vec<_> = graph.edges.iter().collect();
    listed.sort_by_key(|e| !e.required);
    for edge in listed {
        let (connector, wish) = (edge.connector.name(), if edge.required { "" } else { " (wish)" });
        let _ = writeln!(edges, "- {} - {}: {connector}{wish}", edge.a, edge.b);
    }
    for [a, b] in &graph.apart {
        let _ = writeln!(edges, "- {a} - {b}: must not touch");
    }
    let text = prompts().floorplan.asked(&[
        ("request", &fenced(&desk.request.prompt)),
        ("rooms", rooms.trim_end()),
        ("edges", edges.trim_end()),
        ("constraints", &constraints),
        ("corridor", &format!("{corridor:.2}")),
        ("examples", &examples::plans(desk.registry, desk.plugin)),
    ]);
    let mut request =
        LlmRequest::new(Stage::Floorplan.name(), text).with_system(prompts().system.trim()).with_schema(plan_schema());
    request.max_output_tokens = TOKENS.0.saturating_add(TOKENS.1.saturating_mul(graph.rooms.len() as u32));
    Question { stage: Stage::Floorplan, request, constraint_ids }
}

fn judge(desk: &mut Desk<'_, '_>, base: &Generated, answer: &PlanAnswer) -> Result<Trial<Generated>, Error> {
    let graph = &base.world.scene_graph;
    let sketches: Vec<Sketch> = answer
        .rooms
        .iter()
        .take(MOST_ROOMS)
        .map(|r| Sketch { room_id: r.room_id.clone(), rects: r.rectangles.iter().take(MOST_RECTS).map(rect).collect() })
        .collect();
    let retrieved = retrieve(graph, desk.plugin);
    let mut found = Ok(Err(String::new()));
    for follow in [Follow::Closely, Follow::Roughly] {
        let plan = floorplan::propose(graph, desk.plugin.domain(), &retrieved.limits, &sketches, follow, desk.stop());
        found = plan.and_then(|plan| furnished(desk, (graph, &retrieved), plan));
        if !matches!(found, Ok(Err(_)) | Err(Error::Infeasible { .. })) {
            break;
        }
    }
    let (result, note) = match found {
        Ok(Ok(made)) => (Some(made), "the plan follows the proposal as far as the rules allow".to_owned()),
        Ok(Err(why)) => (None, format!("the proposed plan could not be used, so it is as without a model: {why}")),
        Err(error) if !works_not_out(&error) => return Err(error),
        Err(error) => (None, format!("the proposed plan could not be used, so it is as without a model: {error}")),
    };
    let plan = result.as_ref().map_or(&base.world.floorplan, |m| &m.world.floorplan);
    let mut items = fates(&answer.rooms, plan, result.is_some());
    let like = |i: &ProposedItem| matches!(i.fate, Fate::Kept | Fate::Moved);
    if result.is_some() && !items.iter().any(like) {
        let note = "no room of the plan could lie near where it was proposed, so the plan is as without a model";
        let items = fates(&answer.rooms, &base.world.floorplan, false);
        return Ok(Trial { result: None, items, note: note.into() });
    }
    items.extend(unread(answer.rooms.len(), MOST_ROOMS, ItemKind::Room, "rooms"));
    Ok(Trial { result, items, note })
}

/// Returns a building with another plan, or why it is not sound.
fn furnished(
    desk: &Desk<'_, '_>,
    (graph, retrieved): (&SceneGraph, &Retrieval),
    plan: Floorplan,
) -> Result<Result<Generated, String>, Error> {
    let (domain, limits) = (desk.plugin.domain(), &retrieved.limits);
    let mut why = String::new();
    for attempt in 0..SEEDS {
        let seed = attempt_seed(graph.seed, attempt);
        let reseeded = SceneGraph { seed, ..graph.clone() };
        let plan = Floorplan { seed, ..plan.clone() };
        let placements = placement::generate_until(&reseeded, &plan, domain, limits, None, &mut |_| (), desk.stop())?;
        let made = desk.judged((graph, retrieved), plan, placements)?;
        if made.report.is_writable() {
            return Ok(Ok(made));
        }
        let broken = made.report.rules.iter().find_map(|r| Some((&r.rule, r.violations.first()?)));
        why = broken.map_or(why, |(rule, v)| format!("it would break {rule}: {}", v.message));
    }
    Ok(Err(why))
}

fn rect(r: &RectAnswer) -> Rect {
    Rect { x0: r.x_m, y0: r.y_m, x1: r.x_m + r.width_m, y1: r.y_m + r.depth_m }
}

/// Returns what became of each proposed outline.
fn fates(rooms: &[OutlineAnswer], plan: &Floorplan, used: bool) -> Vec<ProposedItem> {
    let mut items: Vec<ProposedItem> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for room in rooms.iter().take(MOST_ROOMS) {
        let rects: Vec<Rect> = room.rectangles.iter().take(MOST_RECTS).map(rect).collect();
        let mut item = ProposedItem {
            kind: ItemKind::Room,
            proposed: quoted(&room.room_id),
            fate: Fate::Dropped,
            id: None,
            from: spot(&rects),
            to: None,
            rule: None,
            reason: String::new(),
        };
        match plan.room(&room.room_id) {
            None => item.reason = "the building has no such room".into(),
            Some(_) if !seen.insert(&room.room_id) => item.reason = "the room is there twice".into(),
            Some(found) => {
                item.id = Some(found.room_id.clone());
                item.to = spot(&found.polygon.rects());
                let share = if used { alike(&rects, &found.polygon) } else { 0.0 };
                item.fate = match share {
                    s if s >= SAME => Fate::Kept,
                    s if s >= NEAR => Fate::Moved,
                    _ => Fate::Replaced,
                };
                if item.fate != Fate::Kept {
                    item.reason = match (used, item.from.is_some()) {
                        (_, false) => "its rectangles have no sane size".into(),
                        (false, _) => "the plan is as without a model".into(),
                        _ => format!("{:.0} % of its floor is where it was proposed", 100.0 * share),
                    };
                }
            }
        }
        items.push(item);
    }
    for room in plan.rooms.iter().filter(|r| used && !seen.contains(&r.room_id)) {
        items.push(ProposedItem {
            kind: ItemKind::Room,
            proposed: room.room_id.clone(),
            fate: Fate::Added,
            id: Some(room.room_id.clone()),
            from: None,
            to: spot(&room.polygon.rects()),
            rule: None,
            reason: "the proposal has no outline for it".into(),
        });
    }
    items
}

/// Returns middle and extent of rectangles; `None` when they are none that a document can hold.
fn spot(rects: &[Rect]) -> Option<Spot> {
    let all = rects.iter().copied().reduce(|a, b| a.union(&b))?;
    let sane = [all.x0, all.y0, all.x1, all.y1].iter().all(|v| v.is_finite() && v.abs() < 1e6);
    (sane && all.width() > 0.0 && all.height() > 0.0).then(|| Spot {
        x_m: to_mm(all.center().x),
        y_m: to_mm(all.center().y),
        yaw_rad: None,
        width_m: Some(to_mm(all.width())),
        depth_m: Some(to_mm(all.height())),
    })
}

/// Returns what an outline has in common with rectangles, as a share of both together.
fn alike(rects: &[Rect], outline: &Polygon) -> f64 {
    let own = outline.rects();
    let common: f64 = rects.iter().flat_map(|a| own.iter().map(|b| a.common_area(b))).sum();
    let sum: f64 = rects.iter().chain(&own).map(Rect::area).sum();
    let both = sum - common;
    if both > 0.0 && both.is_finite() { (common / both).clamp(0.0, 1.0) } else { 0.0 }
}
