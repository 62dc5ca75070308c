//! Corridors that run all the way round: a room is one outline without holes, so a ring is made of two pieces of corridor
//! that are open to each other at both ends. The first has all the doors; this adds the second, which closes the ring.

use d3dgen_model::domain::Scheme;
use d3dgen_model::scene_graph::{BY_CIRCULATION, Connector, GraphEdge, GraphRoom};
use d3dgen_model::storeys::{LinkKind, VerticalLink};

use super::rooms;
use crate::reading::Reading;

/// Least area of a piece that closes a ring, m^2: it is as long as what it goes around is deep.
const LEAST_M2: f64 = 2.0;

/// Adds the piece of corridor that closes the ring of each storey whose form is one.
pub(crate) fn close(reading: &Reading, links: &[VerticalLink], rooms: &mut Vec<GraphRoom>, edges: &mut Vec<GraphEdge>) {
    let Some(form) = reading.style.form else { return };
    // stairs at both ends stand at one straight way
    if links.iter().filter(|l| l.kind == LinkKind::Stairs).count() > 1 {
        return;
    }
    let corridors: Vec<GraphRoom> = rooms.iter().filter(|r| r.circulation && !is_link(links, r)).cloned().collect();
    let mut number = rooms.iter().filter(|r| corridors.iter().any(|c| c.room_type == r.room_type)).count();
    for corridor in corridors {
        let beside = rooms.iter().filter(|r| r.level == corridor.level).count();
        if !Scheme::runs_around(form, beside + 1) {
            continue;
        }
        number += 1;
        let mut piece = rooms::circulation(reading);
        piece.id = format!("{}_{number}", piece.room_type);
        piece.name = format!("{} {number}", piece.name);
        piece.level = corridor.level;
        piece.area_range_m2[0] = piece.area_range_m2[0].min(LEAST_M2);
        edges.push(GraphEdge {
            a: piece.id.clone(),
            b: corridor.id,
            connector: Connector::Open,
            required: true,
            reason: BY_CIRCULATION.into(),
        });
        rooms.push(piece);
    }
}

fn is_link(links: &[VerticalLink], room: &GraphRoom) -> bool {
    links.iter().any(|l| l.room_ids.contains(&room.id))
}
