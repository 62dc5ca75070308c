//! Rules about what was asked for: rooms, connections, adjacency, exclusions.

use std::collections::BTreeSet;

use d3dgen_knowledge::jurisdiction::rules_here;
use d3dgen_model::domain::{Adjacency, AdjacencyRelation};
use d3dgen_model::scene_graph::Connector;

use super::Findings;
use crate::context::{Context, ON_LINE_M, Room, shared};

/// Common boundary from which rooms count as sharing a wall, m.
const WALL_M: f64 = 0.3;

pub fn rooms(c: &Context, out: &mut Findings) {
    let asked: BTreeSet<(&str, &str)> = c.graph().rooms.iter().map(|r| (r.id.as_str(), r.room_type.as_str())).collect();
    let built: BTreeSet<(&str, &str)> =
        c.plan().rooms.iter().map(|r| (r.room_id.as_str(), r.room_type.as_str())).collect();
    for (id, kind) in asked.union(&built) {
        out.look();
        if !built.contains(&(*id, *kind)) {
            out.add(*id, format!("the {kind} asked for is not in the plan"));
        } else if !asked.contains(&(*id, *kind)) {
            out.add(*id, format!("the {kind} in the plan was not asked for"));
        }
    }
}

/// Returns true when a door or open passage joins the rooms.
fn joined(c: &Context, a: &str, b: &str) -> bool {
    c.plan().doors.iter().any(|d| d.room_ids.iter().any(|r| r == a) && d.room_ids.iter().any(|r| r == b) && a != b)
}

/// Returns the length of the boundary the rooms share, m.
fn common_wall(a: &Room, b: &Room) -> f64 {
    let each =
        a.plan.polygon.edges().flat_map(|e| b.plan.polygon.edges().filter_map(move |f| shared(&e, &f, ON_LINE_M)));
    each.map(|(from, to)| to - from).sum()
}

fn share_wall(c: &Context, a: &str, b: &str) -> bool {
    match (c.room(a), c.room(b)) {
        (Some(a), Some(b)) => common_wall(a, b) >= WALL_M,
        _ => false,
    }
}

pub fn edges(c: &Context, out: &mut Findings) {
    for edge in c.graph().edges.iter().filter(|e| e.required) {
        let holds = match edge.connector {
            Connector::Door | Connector::Open => joined(c, &edge.a, &edge.b),
            Connector::Wall => share_wall(c, &edge.a, &edge.b),
            Connector::Near => continue,
        };
        out.look();
        if !holds {
            let how = if edge.connector == Connector::Wall { "wall" } else { "door" };
            out.add(format!("{}|{}", edge.a, edge.b), format!("the required {how} is not there ({})", edge.reason));
        }
    }
}

/// Returns the adjacency rules of this strength that hold in the building's country.
fn pairs<'c>(c: &'c Context, relation: AdjacencyRelation) -> impl Iterator<Item = &'c Adjacency> {
    rules_here(c.domain, c.graph().place_code()).filter(move |p| p.relation == relation)
}

fn of_type<'c>(c: &'c Context, room_type: &'c str) -> impl Iterator<Item = &'c str> {
    c.rooms.iter().filter(move |r| r.plan.room_type == room_type).map(|r| r.plan.room_id.as_str())
}

pub fn must(c: &Context, out: &mut Findings) {
    for pair in pairs(c, AdjacencyRelation::Must) {
        let others: Vec<&str> = of_type(c, &pair.b).collect();
        if others.is_empty() {
            continue;
        }
        // what is asked to be apart is not joined for custom's sake
        let apart = |id: &str, other: &str| {
            c.graph().apart.iter().any(|[a, b]| (a == id && b == other) || (a == other && b == id))
        };
        for id in of_type(c, &pair.a).filter(|id| !others.iter().all(|other| apart(id, other))) {
            let holds = others.iter().any(|other| match pair.via.as_str() {
                "door" | "open" => joined(c, id, other),
                "wall" => share_wall(c, id, other) || joined(c, id, other),
                _ => true,
            });
            out.look();
            if !holds {
                out.add(id, format!("has no {} to a {}: {} ({})", pair.via, pair.b, pair.reason, pair.source));
            }
        }
    }
}

pub fn must_not(c: &Context, out: &mut Findings) {
    let asked = |a: &str, b: &str| {
        let edges = c.graph().edges.iter().filter(|e| e.required);
        edges.into_iter().any(|e| (e.a == a && e.b == b) || (e.a == b && e.b == a))
    };
    for pair in pairs(c, AdjacencyRelation::MustNot) {
        for a in of_type(c, &pair.a) {
            for b in of_type(c, &pair.b).filter(|b| *b != a) {
                out.look();
                let meet = joined(c, a, b) || (pair.via == "wall" && share_wall(c, a, b));
                // what the prompt itself asks for goes before the rule; the scene graph reports the conflict
                if meet && !asked(a, b) {
                    out.add(format!("{a}|{b}"), format!("share a {}: {} ({})", pair.via, pair.reason, pair.source));
                }
            }
        }
    }
    for [a, b] in &c.graph().apart {
        out.look();
        if joined(c, a, b) || share_wall(c, a, b) {
            out.add(format!("{a}|{b}"), "were to be kept apart and share a door or wall");
        }
    }
}

pub fn forbidden(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        out.look();
        if c.graph().forbidden_room_types.contains(&room.plan.room_type) {
            out.add(&room.plan.room_id, format!("a {} was ruled out", room.plan.room_type));
        }
    }
}
