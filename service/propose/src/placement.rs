//! The proposal of furniture: objects at poses.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::fmt::Write as _;

use d3dgen_llm::Request as LlmRequest;
use d3dgen_model::domain::{Domain, Mount, RoomType};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::proposal::{Fate, ItemKind, ProposedItem, Spot, StageProposal};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_pipeline::Error;
use d3dgen_pipeline::generate::{Generated, Stage, retrieve};
use d3dgen_pipeline::placement::{Refusal, Wish, propose_room};

use crate::ask::{Question, Trial, propose as ask};
use crate::json::{FurnitureAnswer, ObjectAnswer, furniture_schema, quoted};
use crate::prompt::{fenced, prompts};
use crate::scene_graph::unread;
use crate::{Desk, examples};

/// Most objects of an answer that are read.
const MOST_OBJECTS: usize = 2000;
/// Most rooms that are asked for.
const MOST_ROOMS: usize = 40;
/// Kinds of object that a question names for a room.
const MOST_KINDS: usize = 10;
/// Output tokens of an answer, and more of them for each room.
const TOKENS: (u32, u32) = (4096, 500);
/// How often rooms that break a rule are furnished as ever before all of them are.
const ROUNDS: usize = 4;
/// Farthest that an object is from where it was proposed when it is as proposed, m, and when it is near it.
const SAME_M: f64 = 0.1;
const NEAR_M: f64 = 1.5;
/// Largest difference of headings that are the same, rad.
const SAME_RAD: f64 = 0.1;

/// Asks for the furniture of a building that stands; returns the building that it became.
pub fn propose(desk: &mut Desk<'_, '_>, base: &Generated) -> Result<(Option<Generated>, StageProposal), Error> {
    let question = question(desk, base);
    let base = base.clone();
    ask(desk, question, move |desk, answer: FurnitureAnswer| judge(desk, &base, &answer))
}

fn question(desk: &Desk<'_, '_>, base: &Generated) -> Question {
    let domain = desk.plugin.domain();
    let (graph, plan) = (&base.world.scene_graph, &base.world.floorplan);
    let (constraints, constraint_ids) = prompts().placement.constraints(&retrieve(graph, desk.plugin));
    let mut rooms = String::new();
    let asked: Vec<&PlanRoom> = plan.rooms.iter().filter(|r| !r.circulation).take(MOST_ROOMS).collect();
    for room in &asked {
        let kind = domain.room_type_or_generic(&room.room_type);
        let _ = writeln!(rooms, "- {} ({}): {}", room.room_id, room.room_type, examples::floor(room));
        let openings = openings(plan, room);
        let _ = writeln!(rooms, "  {openings}");
        let _ = writeln!(rooms, "  {}", usual(domain, kind));
    }
    let text = prompts().placement.asked(&[
        ("request", &fenced(&desk.request.prompt)),
        ("rooms", rooms.trim_end()),
        ("constraints", &constraints),
        ("examples", &examples::furniture(desk.registry, desk.plugin)),
    ]);
    let mut request = LlmRequest::new(Stage::Placement.name(), text)
        .with_system(prompts().system.trim())
        .with_schema(furniture_schema());
    request.max_output_tokens = TOKENS.0.saturating_add(TOKENS.1.saturating_mul(asked.len() as u32));
    Question { stage: Stage::Placement, request, constraint_ids }
}

fn openings(plan: &Floorplan, room: &PlanRoom) -> String {
    let at = |line: &d3dgen_model::Segment| {
        let middle = line.middle();
        format!("({:.2}, {:.2}; {:.2})", middle.x, middle.y, line.length())
    };
    let doors: Vec<String> = plan.doors_of(&room.room_id).map(|d| at(&d.line)).collect();
    let windows: Vec<String> = plan.windows.iter().filter(|w| w.room_id == room.room_id).map(|w| at(&w.line)).collect();
    let windows = if windows.is_empty() { "none".to_owned() } else { windows.join(" ") };
    format!("doors {}; windows {windows}", doors.join(" "))
}

/// Returns what stands in rooms of a type, in words.
fn usual(domain: &Domain, kind: &RoomType) -> String {
    let mut seen = BTreeSet::new();
    let mut out: Vec<String> = Vec::new();
    for line in &kind.furnishing {
        let Some(object) = domain.anchor(&line.item) else { continue };
        let asked = matches!(object.mount, Mount::Floor | Mount::Wall);
        if !asked || out.len() >= MOST_KINDS || !seen.insert(&object.id) {
            continue;
        }
        let [w, d, _] = object.sizes_m.first().copied().unwrap_or([0.5; 3]);
        let required = if line.required { ", required" } else { "" };
        out.push(format!("{} {w:.2} x {d:.2}, {}-{}{required}", object.id, line.min, line.max));
    }
    if out.is_empty() { "nothing".to_owned() } else { out.join("; ") }
}

/// What a room's wishes became.
struct Room {
    placements: Vec<Placement>,
    unplaced: Vec<d3dgen_model::placements::Unplaced>,
    refused: Vec<Option<Refusal>>,
}

fn judge(desk: &mut Desk<'_, '_>, base: &Generated, answer: &FurnitureAnswer) -> Result<Trial<Generated>, Error> {
    let (graph, plan) = (&base.world.scene_graph, &base.world.floorplan);
    let reseeded = SceneGraph { seed: plan.seed, ..graph.clone() };
    let retrieved = retrieve(graph, desk.plugin);
    let mut by_room: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (n, object) in answer.objects.iter().take(MOST_OBJECTS).enumerate() {
        by_room.entry(&object.room_id).or_default().push(n);
    }
    let mut rooms: BTreeMap<&str, Room> = BTreeMap::new();
    for room in &plan.rooms {
        let Some(wanted) = by_room.get(room.room_id.as_str()) else { continue };
        let wishes: Vec<Wish> = wanted.iter().map(|&n| wish(&answer.objects[n])).collect();
        let storey = plan.storey_at(room.level);
        let known = (desk.plugin.domain(), &retrieved.limits);
        let found = propose_room(&reseeded, &storey, room, known, &wishes, desk.stop());
        desk.check()?;
        let (placements, unplaced, refused) = (found.placements, found.unplaced, found.refused);
        rooms.insert(&room.room_id, Room { placements, unplaced, refused });
    }
    let mut given_up: BTreeMap<String, String> = BTreeMap::new();
    for round in 0..=ROUNDS {
        let made = desk.judged((graph, &retrieved), plan.clone(), together(base, &rooms))?;
        if made.report.is_writable() {
            let made = Generated { attempts: base.attempts, ..made };
            return Ok(told(base, answer, &by_room, &rooms, &given_up, made));
        }
        let broken = blamed(&made, &rooms, round == ROUNDS);
        if broken.is_empty() {
            break;
        }
        for (room, rule) in broken {
            rooms.remove(room.as_str());
            given_up.insert(room, rule);
        }
    }
    rooms.clear();
    Ok(told(base, answer, &by_room, &rooms, &given_up, base.clone()))
}

fn wish(object: &ObjectAnswer) -> Wish {
    Wish { object: object.object.clone(), x: object.x_m, y: object.y_m, yaw_rad: (object.yaw_deg % 360.0).to_radians() }
}

/// Returns the furniture of all rooms: the proposed, and that of the other rooms as it was.
fn together(base: &Generated, rooms: &BTreeMap<&str, Room>) -> Placements {
    let before = &base.world.placements;
    let mut out = Placements { placements: Vec::new(), unplaced: Vec::new(), ..*before };
    for room in &base.world.floorplan.rooms {
        let id = room.room_id.as_str();
        match rooms.get(id) {
            Some(new) => {
                out.placements.extend(new.placements.iter().cloned());
                out.unplaced.extend(new.unplaced.iter().cloned());
            }
            None => {
                out.placements.extend(before.placements.iter().filter(|p| p.room_id == id).cloned());
                out.unplaced.extend(before.unplaced.iter().filter(|u| u.room_id == id).cloned());
            }
        }
    }
    out
}

/// Returns the proposed rooms that broken rules point at, each with the rule; all of them when none is pointed at.
fn blamed(made: &Generated, rooms: &BTreeMap<&str, Room>, all: bool) -> Vec<(String, String)> {
    let mut out: BTreeMap<String, String> = BTreeMap::new();
    let mut first = None;
    for rule in &made.report.rules {
        for violation in &rule.violations {
            first = first.or(Some(rule.rule.clone()));
            let subject = violation.subject.as_str();
            let door = made.world.floorplan.doors.iter().filter(|d| d.door_id == subject).flat_map(|d| &d.room_ids);
            let object = made.world.placements.placements.iter().filter(|p| p.placement_id == subject);
            let named = door.chain(object.map(|p| &p.room_id)).map(String::as_str).chain([subject]);
            for room in named.filter(|r| rooms.contains_key(r)) {
                out.entry(room.to_owned()).or_insert_with(|| rule.rule.clone());
            }
        }
    }
    if all || out.is_empty() {
        let rule = first.unwrap_or_default();
        out = rooms.keys().map(|r| ((*r).to_owned(), rule.clone())).collect();
    }
    out.into_iter().collect()
}

/// Returns the judged proposal with what became of each object.
fn told(
    base: &Generated,
    answer: &FurnitureAnswer,
    by_room: &BTreeMap<&str, Vec<usize>>,
    rooms: &BTreeMap<&str, Room>,
    given_up: &BTreeMap<String, String>,
    made: Generated,
) -> Trial<Generated> {
    let all: Vec<&ObjectAnswer> = answer.objects.iter().take(MOST_OBJECTS).collect();
    let mut items: Vec<ProposedItem> = all.iter().map(|o| blank(o)).collect();
    for (&room_id, wanted) in by_room {
        let here: Vec<&Placement> = made.world.placements.placements.iter().filter(|p| p.room_id == room_id).collect();
        if base.world.floorplan.room(room_id).is_none() {
            wanted.iter().for_each(|&n| items[n].reason = "the building has no such room".into());
            continue;
        }
        let refused = rooms.get(room_id).map_or(&[][..], |r| &r.refused);
        for (n, stands) in matched(&all, wanted, &here) {
            let k = wanted.iter().position(|w| *w == n);
            let refusal = k.and_then(|k| refused.get(k)).and_then(Option::as_ref);
            settle(&mut items[n], all[n], stands, refusal, given_up.get(room_id));
        }
    }
    let used = items.iter().any(|i| matches!(i.fate, Fate::Kept | Fate::Moved)) && !rooms.is_empty();
    items.extend(unread(answer.objects.len(), MOST_OBJECTS, ItemKind::Object, "objects"));
    let note = if !used {
        "no object of it could stand at or near its place, so the furniture is as without a model".to_owned()
    } else if given_up.is_empty() {
        "objects stand at or near where they were proposed, with what their rooms need beside them".to_owned()
    } else {
        format!("{} of the rooms are furnished as without a model: a rule would have been broken", given_up.len())
    };
    Trial { result: used.then_some(made), items, note }
}

fn blank(object: &ObjectAnswer) -> ProposedItem {
    let place = [object.x_m, object.y_m, object.yaw_deg];
    let sane = place.iter().all(|v| v.is_finite() && v.abs() < 1e6);
    ProposedItem {
        kind: ItemKind::Object,
        proposed: quoted(&format!("{} in {}", object.object, object.room_id)),
        fate: Fate::Dropped,
        id: None,
        from: sane.then(|| spot(object.x_m, object.y_m, heading(object.yaw_deg.to_radians()))),
        to: None,
        rule: None,
        reason: String::new(),
    }
}

fn spot(x: f64, y: f64, yaw_rad: f64) -> Spot {
    Spot { x_m: to_mm(x), y_m: to_mm(y), yaw_rad: Some((yaw_rad * 1e4).round() / 1e4), width_m: None, depth_m: None }
}

/// Returns a heading in (-pi, pi].
fn heading(yaw_rad: f64) -> f64 {
    let turned = yaw_rad.rem_euclid(TAU);
    if turned > TAU / 2.0 + 1e-9 { turned - TAU } else { turned }
}

/// Returns for each wish of a room the object that stands for it: the nearest pairs first.
fn matched<'p>(all: &[&ObjectAnswer], wanted: &[usize], here: &[&'p Placement]) -> Vec<(usize, Option<&'p Placement>)> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for &n in wanted {
        for (k, p) in here.iter().enumerate().filter(|(_, p)| p.object == all[n].object) {
            let far = far(all[n], p);
            pairs.push((if far.is_finite() { far } else { f64::MAX }, n, k));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken: BTreeMap<usize, usize> = BTreeMap::new();
    let mut used = BTreeSet::new();
    for (_, n, k) in pairs {
        if !taken.contains_key(&n) && used.insert(k) {
            taken.insert(n, k);
        }
    }
    wanted.iter().map(|n| (*n, taken.get(n).map(|&k| here[k]))).collect()
}

/// Returns how far an object stands from where it was proposed, m, along the worse axis.
fn far(object: &ObjectAnswer, p: &Placement) -> f64 {
    (object.x_m - p.pose.x).abs().max((object.y_m - p.pose.y).abs())
}

/// Says what became of one object.
fn settle(
    item: &mut ProposedItem,
    object: &ObjectAnswer,
    stands: Option<&Placement>,
    refusal: Option<&Refusal>,
    given_up: Option<&String>,
) {
    if let Some(refusal) = refusal {
        item.rule.clone_from(&refusal.rule);
        item.reason.clone_from(&refusal.reason);
    }
    if let Some(rule) = given_up {
        item.rule = Some(rule.clone());
        item.reason = "the room is furnished as without a model: a rule would have been broken".into();
    }
    let Some(p) = stands else {
        if item.reason.is_empty() {
            item.reason = "the room has no more of these".into();
        }
        return;
    };
    item.id = Some(p.placement_id.clone());
    item.to = Some(spot(p.pose.x, p.pose.y, p.pose.yaw_rad));
    let far = far(object, p);
    let turned = heading(object.yaw_deg.to_radians() - p.pose.yaw_rad).abs() > SAME_RAD;
    item.fate = match far {
        far if given_up.is_some() || !far.is_finite() => Fate::Replaced,
        far if far <= SAME_M && !turned => Fate::Kept,
        far if far <= NEAR_M => Fate::Moved,
        _ => Fate::Replaced,
    };
    if item.fate == Fate::Kept {
        (item.rule, item.reason) = (None, String::new());
    } else if item.reason.is_empty() {
        let turn = if turned { ", turned" } else { "" };
        item.reason = format!("it stands {far:.2} m away{turn}, at the nearest place that breaks no rule");
        if item.fate == Fate::Replaced {
            item.reason = "the room's own furnishing has it elsewhere".into();
        }
    }
}
