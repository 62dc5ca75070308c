//! What the rules that a world breaks say of its scene graph: which room needs a door of its own, which more floor, and at last
//! which room the building cannot have. The world says each of it.
//!
//! Another seed deals the same rooms anew; where each deal breaks the same rule at the same room, the graph is at fault.

use std::collections::BTreeSet;

use d3dgen_model::report::{Report, Violation};
use d3dgen_model::scene_graph::{BY_CIRCULATION, Connector, GraphEdge, GraphRoom, Note, Robot, SceneGraph};
use d3dgen_model::world::World;

use crate::grow::enlarge;

/// Factor by which the floor of a room grows that lacks an object.
const MORE_FLOOR: f64 = 1.35;
/// How much more floor the rooms below one that juts out get than juts out, and the most, as factors: not all of it comes to lie there.
const BELOW: f64 = 1.5;
const MOST_BELOW: f64 = 1.3;

/// Returns the graph with what its broken rules ask for; `None` where there is nothing of that kind.
pub(crate) fn mended(graph: &SceneGraph, report: &Report) -> Option<SceneGraph> {
    // whoever asks for a robot that the rooms are made for is told which one fits
    if graph.robots.iter().any(Robot::is_fitted) {
        return None;
    }
    let mut out = graph.clone();
    let mut changed = false;
    // however many things a room lacks, it grows once
    let mut grown: BTreeSet<&str> = BTreeSet::new();
    for broken in violations(report) {
        let note = match broken.code.as_str() {
            "private_passage" => own_door(&mut out, &broken.subject),
            "object_missing" if grown.insert(&broken.subject) => more_floor(&mut out, &broken.subject),
            "storey_in_the_air" => more_below(&mut out, broken),
            _ => None,
        };
        changed |= note.is_some();
        // what was not large enough yet grows again
        let new = note.filter(|n| !out.conflicts.contains(n));
        out.conflicts.extend(new);
    }
    changed.then_some(out)
}

/// Returns the graph without the rooms of the prompt where the rules of a world are broken, and what hangs on them; `None` where
/// they are broken elsewhere.
pub(crate) fn without_broken(graph: &SceneGraph, world: &World, report: &Report) -> Option<SceneGraph> {
    let mut gone: Vec<(&GraphRoom, String)> = Vec::new();
    for broken in violations(report) {
        let room = room_of(world, &broken.subject).and_then(|id| graph.room(id));
        let known = room.filter(|r| gone.iter().all(|(g, _)| g.id != r.id));
        // the building is not one without the others
        let Some(room) = known.filter(|r| r.requested && !r.circulation && !r.entrance && !r.locked) else { continue };
        gone.push((room, format!("{}: {}", broken.code, broken.message)));
    }
    if gone.is_empty() || gone.len() == graph.rooms.iter().filter(|r| !r.circulation).count() {
        return None;
    }
    let mut out = graph.clone();
    for (room, why) in &gone {
        remove(&mut out, &room.id);
        let message = format!("no plan was found in which {} keeps the rules ({why}); it was left out", room.name);
        out.conflicts.push(Note { code: "room_left_out".into(), message });
    }
    Some(out)
}

fn violations(report: &Report) -> impl Iterator<Item = &Violation> {
    report.rules.iter().flat_map(|r| &r.violations).filter(|v| !v.given)
}

/// Returns the room that something lies in, or that it is.
fn room_of<'w>(world: &'w World, subject: &'w str) -> Option<&'w str> {
    let stands = world.placements.placements.iter().find(|p| p.placement_id == subject);
    stands.map(|p| p.room_id.as_str()).or_else(|| world.floorplan.room(subject).map(|r| r.room_id.as_str()))
}

/// Gives a room that one enters through another one's a door to the circulation of its storey.
fn own_door(graph: &mut SceneGraph, id: &str) -> Option<Note> {
    let room = graph.room(id)?.clone();
    let hub = graph.rooms.iter().find(|r| r.circulation && r.level == room.level && r.unit == room.unit);
    let hub = hub.or_else(|| graph.rooms.iter().find(|r| r.circulation && r.level == room.level))?.clone();
    let walkable = |e: &GraphEdge| matches!(e.connector, Connector::Door | Connector::Open);
    let through = |e: &&mut GraphEdge| e.required && walkable(e) && e.a == room.id && e.b != hub.id;
    let edge = graph.edges.iter_mut().find(through)?;
    let host = std::mem::replace(&mut edge.b, hub.id);
    (edge.connector, edge.reason) = (Connector::Door, BY_CIRCULATION.into());
    let host = graph.room(&host).map_or(host.clone(), |r| r.name.clone());
    let message = format!("{} would be reached only through {host}; it has a door of its own", room.name);
    Some(Note { code: "own_door".into(), message })
}

/// Gives a room more floor for what does not fit in it.
fn more_floor(graph: &mut SceneGraph, id: &str) -> Option<Note> {
    let room = graph.rooms.iter_mut().find(|r| r.id == id && !r.locked)?;
    enlarge(room, MORE_FLOOR);
    let message = format!("{} is larger than meant, for what has to stand in it", room.name);
    Some(Note { code: "room_larger".into(), message })
}

/// Gives the storey below one that juts out as much more floor as that.
fn more_below(graph: &mut SceneGraph, broken: &Violation) -> Option<Note> {
    let level: i32 = broken.subject.rsplit(' ').next()?.parse().ok()?;
    let below = if level > 0 { level - 1 } else { level + 1 };
    let factor = (1.0 + BELOW * broken.measured?).min(MOST_BELOW);
    let mut rooms = graph.rooms.iter_mut().filter(|r| r.level == below && !r.circulation && !r.locked).peekable();
    rooms.peek()?;
    rooms.for_each(|room| enlarge(room, factor));
    let message = format!("the rooms of level {below} are larger than meant, for level {level} to stand on them");
    Some(Note { code: "storey_larger".into(), message })
}

/// Takes a room out, with what is entered through it alone.
fn remove(graph: &mut SceneGraph, id: &str) {
    let behind = |e: &&GraphEdge| e.required && e.b == id;
    let behind: Vec<String> = graph.edges.iter().filter(behind).map(|e| e.a.clone()).collect();
    graph.rooms.retain(|r| r.id != id);
    graph.edges.retain(|e| e.a != id && e.b != id);
    graph.apart.retain(|pair| pair.iter().all(|room| room != id));
    for room in behind {
        let reached = graph.edges.iter().any(|e| e.required && (e.a == room || e.b == room));
        let circulates = graph.room(&room).is_none_or(|r| r.circulation);
        if !reached && !circulates {
            remove(graph, &room);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use d3dgen_model::document::Document;
    use d3dgen_model::report::RuleResult;
    use d3dgen_plugins::Registry;

    use super::*;
    use crate::generate::{Generated, Settings, generate_world};
    use crate::scene_graph::Request;

    fn flat() -> Generated {
        let request =
            Request { prompt: "flat with two bedrooms and a walk-in closet".into(), seed: 1, ..Request::default() };
        let made =
            generate_world(&request, &Registry::builtin(), &Settings::default(), &mut |_| (), &AtomicBool::new(false));
        made.expect("the prompt is plain")
    }

    /// Returns the report with one thing that breaks a rule.
    fn broken(report: &Report, code: &str, subject: &str, measured: Option<f64>) -> Report {
        let violation = Violation {
            code: code.into(),
            subject: subject.into(),
            measured,
            required: None,
            unit: String::new(),
            message: "it does".into(),
            given: false,
        };
        let rule = RuleResult { rule: code.into(), title: String::new(), checked: 1, violations: vec![violation] };
        Report { rules: vec![rule], ..report.clone() }
    }

    #[test]
    fn each_broken_rule_changes_what_is_at_fault_and_says_so() {
        let made = flat();
        let graph = &made.world.scene_graph;
        let mend = |code: &str, subject: &str, measured| mended(graph, &broken(&made.report, code, subject, measured));

        let door = mend("private_passage", "walk_in_closet_1", None).expect("it has a host");
        let hub = door.edges.iter().find(|e| e.a == "walk_in_closet_1" && e.required).expect("it is reached");
        assert!(door.room(&hub.b).is_some_and(|r| r.circulation), "{}", hub.b);
        let larger = mend("object_missing", "bedroom_1", None).expect("it may grow");
        let area = |g: &SceneGraph| g.room("bedroom_1").expect("it is there").target_area_m2;
        assert!(area(&larger) > 1.3 * area(graph));
        let twice = {
            let mut report = broken(&made.report, "object_missing", "bedroom_1", None);
            let another = report.rules[0].violations[0].clone();
            report.rules[0].violations.push(another);
            mended(graph, &report).expect("it may grow")
        };
        assert_eq!(area(&twice), area(&larger), "two things are missing in one room");
        let below = mend("storey_in_the_air", "level 1", Some(0.1)).expect("there is a storey below");
        assert!((area(&below) / area(graph) - 1.15).abs() < 0.02);
        for next in [door, larger, below] {
            assert_eq!(next.check(), vec![]);
            assert_eq!(next.conflicts.len(), graph.conflicts.len() + 1);
        }
        assert_eq!(mend("door_blocked", "door_1", None), None);
    }

    #[test]
    fn a_room_that_breaks_rules_at_last_is_left_out_and_named() {
        let made = flat();
        let mut graph = made.world.scene_graph.clone();
        graph.apart.push(["walk_in_closet_1".into(), "living_room_1".into()]);
        let (graph, world) = (&graph, &made.world);
        let without = |subject: &str| without_broken(graph, world, &broken(&made.report, "wall_gap", subject, None));
        let less = without("walk_in_closet_1").expect("it can be left out");
        assert!(less.room("walk_in_closet_1").is_none());
        assert_eq!(less.apart, Vec::<[String; 2]>::new(), "nothing is kept apart from it any more");
        assert!(less.conflicts.last().is_some_and(|n| n.message.contains("left out")));
        assert_eq!(less.check(), vec![]);
        assert_eq!(without("hallway_1"), None, "the building is none without it");
        // what stands in a room is that room's
        let stands = world.placements.placements.iter().find(|p| p.room_id == "bedroom_1").expect("it is furnished");
        let less = without(&stands.placement_id).expect("it can be left out");
        assert!(less.room("bedroom_1").is_none());
        assert_eq!(less.check(), vec![]);
    }
}
