//! What gives way when no plan is found, one thing after the other: a wall across the corridor, areas, what the prompt wants
//! beside each other, and at last the second staircase. The world says each of it.

use std::borrow::Cow;
use std::collections::BTreeMap;

use d3dgen_model::domain::{Domain, Zone};
use d3dgen_model::scene_graph::{BY_PROMPT, BY_STYLE, Connector, GraphEdge, GraphRoom, Note, Robot, SceneGraph};
use d3dgen_model::storeys::{LinkKind, VerticalLink};

/// Shares by which rooms may be smaller and larger than was meant; none is smaller than its type allows.
const SMALLER: f64 = 0.85;
const LARGER: f64 = 1.35;
/// Most over least area up to which the prompt gives the area in figures.
const TOLD: f64 = 1.3;

/// Rooms of one kind that are entered through the same room, at most: its walls have no place for more.
const MOST_BEHIND: usize = 3;

/// One thing that gives way; `None` where a graph has nothing of that kind.
type Step = fn(&SceneGraph, &Domain) -> Option<SceneGraph>;

/// Returns what to look for when there is no plan of a graph, each with more given up than the one before. Nothing is made before it
/// is asked for: most graphs have a plan.
pub(crate) fn steps<'g>(graph: &'g SceneGraph, domain: &'g Domain) -> impl Iterator<Item = SceneGraph> + 'g {
    let mut last = Cow::Borrowed(graph);
    let all: [Step; 4] = [unlocked, roomier, loosened, with_one_stair];
    all.into_iter().filter_map(move |step| {
        let next = step(&last, domain)?;
        last = Cow::Owned(next.clone());
        Some(next)
    })
}

/// Returns the graph with one room for all of a kind that serve the room they are entered through, where they are too many for its
/// walls: six showers behind one changing room are a room of six.
pub(crate) fn gathered(graph: &SceneGraph, domain: &Domain) -> Option<SceneGraph> {
    let mut out = graph.clone();
    for host in graph.rooms.iter().filter(|r| !r.circulation) {
        let mut kinds: BTreeMap<&str, Vec<&GraphRoom>> = BTreeMap::new();
        // docks stay as many as they are: each has its gate
        let serves = |r: &GraphRoom| {
            let kind = domain.room_type_or_generic(&r.room_type);
            kind.zone == Zone::Service && kind.outdoor_door_m.is_none()
        };
        for room in graph.rooms.iter().filter(|r| !r.locked && serves(r) && is_behind(graph, r, host)) {
            kinds.entry(&room.room_type).or_default().push(room);
        }
        for rooms in kinds.into_values().filter(|rooms| rooms.len() > MOST_BEHIND) {
            gather(&mut out, host, &rooms, domain);
        }
    }
    (out.rooms.len() < graph.rooms.len()).then_some(out)
}

/// Returns true for a room that is entered through a host alone.
fn is_behind(graph: &SceneGraph, room: &GraphRoom, host: &GraphRoom) -> bool {
    let walkable = |e: &&GraphEdge| e.required && matches!(e.connector, Connector::Door | Connector::Open);
    let mut ways = graph.edges.iter().filter(walkable).filter(|e| e.a == room.id || e.b == room.id);
    let first = ways.next();
    first.is_some_and(|e| e.a == room.id && e.b == host.id) && ways.next().is_none()
}

/// Puts the first of some rooms in the place of all.
fn gather(out: &mut SceneGraph, host: &GraphRoom, rooms: &[&GraphRoom], domain: &Domain) {
    let most = domain.room_type_or_generic(&rooms[0].room_type).area_m2.max;
    let sum = |of: fn(&GraphRoom) -> f64| rooms.iter().map(|r| of(r)).sum::<f64>().min(most);
    let (area, largest) = (sum(|r| r.target_area_m2), sum(|r| r.area_range_m2[1]));
    let people: u32 = rooms.iter().filter_map(|r| r.occupants).fold(0, u32::saturating_add);
    let gone = |id: &String| rooms[1..].iter().any(|r| &r.id == id);
    out.rooms.retain(|r| !gone(&r.id));
    out.edges.retain(|e| !gone(&e.a) && !gone(&e.b));
    out.apart.retain(|pair| !pair.iter().any(gone));
    let Some(room) = out.rooms.iter_mut().find(|r| r.id == rooms[0].id) else { return };
    (room.target_area_m2, room.area_range_m2[1]) = (area, largest.max(area));
    room.occupants = (people > 0).then_some(people);
    let (count, kind) = (rooms.len(), &rooms[0].name);
    let message =
        format!("{count} rooms like {kind} have no place at the walls of {}; they are one of {area:.0} m2", host.name);
    out.conflicts.push(Note { code: "rooms_gathered".into(), message });
}

/// Returns the graph with one corridor for all instead of one behind a lock.
fn unlocked(graph: &SceneGraph, domain: &Domain) -> Option<SceneGraph> {
    let names = || domain.circulation.locked.iter().map(|part| &part.corridor);
    let inner = graph.rooms.iter().find(|r| r.circulation && names().any(|name| name == &r.name))?;
    let outer = graph.rooms.iter().find(|r| r.circulation && r.id != inner.id)?;
    let mut out = graph.clone();
    out.rooms.retain(|r| r.id != inner.id);
    out.edges.retain(|e| {
        let own = e.a == inner.id || e.b == inner.id;
        !(own && (!e.required || e.a == outer.id || e.b == outer.id))
    });
    for end in out.edges.iter_mut().flat_map(|e| [&mut e.a, &mut e.b]) {
        if *end == inner.id {
            end.clone_from(&outer.id);
        }
    }
    let message =
        format!("no plan was found with a {} of its own; all rooms open to one corridor", inner.name.to_lowercase());
    out.conflicts.push(Note { code: "lock_not_built".into(), message });
    Some(out)
}

/// Returns the graph with wider ranges of areas; what the prompt gives in figures stays. Rooms do not grow for a robot that they
/// are to be made for: whoever asks for that is told which robot fits.
fn roomier(graph: &SceneGraph, domain: &Domain) -> Option<SceneGraph> {
    if graph.robots.iter().any(Robot::is_fitted) {
        return None;
    }
    let mut out = graph.clone();
    let mut wider = false;
    let open = |r: &&mut GraphRoom| r.area_range_m2[1] > TOLD * r.area_range_m2[0];
    for room in out.rooms.iter_mut().filter(|r| !r.circulation && !r.locked).filter(open) {
        let range = domain.room_type_or_generic(&room.room_type).area_m2;
        let [low, high] = room.area_range_m2;
        let wide = [(SMALLER * low).max(range.min).min(low), LARGER * high];
        wider |= wide != [low, high];
        room.area_range_m2 = wide;
    }
    let message = "no plan was found with rooms of the areas that were meant; some are smaller or larger".into();
    out.conflicts.push(Note { code: "areas_gave_way".into(), message });
    wider.then_some(out)
}

/// Returns the graph with what the prompt wants beside each other as wishes.
fn loosened(graph: &SceneGraph, _: &Domain) -> Option<SceneGraph> {
    let mut out = graph.clone();
    let wished = |reason: &str| reason == BY_PROMPT || reason == BY_STYLE;
    let reached =
        |room: &str| graph.edges.iter().any(|e| e.required && !wished(&e.reason) && (e.a == room || e.b == room));
    for edge in out.edges.iter_mut().filter(|e| e.required && wished(&e.reason)) {
        if reached(&edge.a) && reached(&edge.b) {
            edge.required = false;
            let (a, b) = (&edge.a, &edge.b);
            out.conflicts.push(Note {
                code: "adjacency_not_built".into(),
                message: format!("no plan was found with {a} and {b} joined as asked; it is a wish now"),
            });
        }
    }
    (out.conflicts.len() > graph.conflicts.len()).then_some(out)
}

/// Returns the graph with one staircase in place of two.
fn with_one_stair(graph: &SceneGraph, _: &Domain) -> Option<SceneGraph> {
    let stairs = |l: &&VerticalLink| l.kind == LinkKind::Stairs;
    let gone: Vec<&String> = graph.links.iter().filter(stairs).skip(1).flat_map(|l| &l.room_ids).collect();
    if gone.is_empty() {
        return None;
    }
    let mut out = graph.clone();
    out.rooms.retain(|r| !gone.contains(&&r.id));
    out.edges.retain(|e| !gone.contains(&&e.a) && !gone.contains(&&e.b));
    out.links.retain(|l| !l.room_ids.iter().any(|id| gone.contains(&id)));
    let message = "no plan was found with two staircases at the ends of its storeys; it has one".into();
    out.conflicts.push(Note { code: "one_stair".into(), message });
    Some(out)
}

#[cfg(test)]
mod tests {
    use d3dgen_model::document::Document;
    use d3dgen_plugins::Registry;

    use super::*;
    use crate::scene_graph::{Request, generate};

    #[test]
    fn rooms_that_a_host_has_no_walls_for_become_one() {
        let registry = Registry::builtin();
        let prompt =
            "A gym with a changing room for men and one for women, each with six showers, and a bouldering hall";
        let request = Request { prompt: prompt.into(), seed: 1, ..Request::default() };
        let mut graph = generate(&request, &registry).expect("the prompt is plain");
        let domain = registry.get(&graph.domain).expect("it is built in").domain();
        let host = graph.rooms.iter().find(|r| r.room_type == "locker_room").expect("it is named").clone();
        let shower = |n: usize| GraphRoom {
            id: format!("shower_{n}"),
            room_type: "changing_showers".into(),
            target_area_m2: 8.0,
            ..host.clone()
        };
        graph.rooms.retain(|r| r.room_type != "changing_showers");
        graph.edges.retain(|e| !e.a.starts_with("changing_showers") && !e.b.starts_with("changing_showers"));
        let door = |n: usize| GraphEdge {
            a: format!("shower_{n}"),
            b: host.id.clone(),
            connector: Connector::Door,
            required: true,
            reason: "test".into(),
        };
        let with = |n: usize| {
            let mut graph = graph.clone();
            graph.rooms.extend((0..n).map(shower));
            graph.edges.extend((0..n).map(door));
            graph
        };
        assert_eq!(gathered(&with(3), domain), None);
        let one = gathered(&with(6), domain).expect("six are too many");
        let left: Vec<&GraphRoom> = one.rooms.iter().filter(|r| r.id.starts_with("shower_")).collect();
        assert_eq!(left.len(), 1);
        assert!((left[0].target_area_m2 - 40.0).abs() < 1e-9, "{}", left[0].target_area_m2);
        assert_eq!(one.check(), vec![]);
        assert!(one.conflicts.iter().any(|n| n.code == "rooms_gathered"));
    }

    #[test]
    fn each_step_gives_up_more_and_says_so() {
        let registry = Registry::builtin();
        let prompt = "Surgical department with two operating rooms next to each other, recovery and a waiting area";
        let request = Request { prompt: prompt.into(), seed: 1, ..Request::default() };
        let graph = generate(&request, &registry).expect("the prompt is plain");
        let domain = registry.get(&graph.domain).expect("it is built in").domain();
        let steps: Vec<SceneGraph> = steps(&graph, domain).collect();
        let codes: Vec<&str> = steps.iter().filter_map(|s| s.conflicts.last()).map(|n| n.code.as_str()).collect();
        assert_eq!(codes[..2], ["lock_not_built", "areas_gave_way"]);
        assert_eq!(graph.rooms.iter().filter(|r| r.circulation).count(), 2);
        for step in &steps {
            assert_eq!(step.check(), vec![]);
            assert_eq!(step.rooms.iter().filter(|r| r.circulation).count(), 1);
        }
        let wider = |r: &GraphRoom| graph.room(&r.id).is_some_and(|old| r.area_range_m2[1] > old.area_range_m2[1]);
        assert!(steps[1].rooms.iter().any(wider));
    }
}
