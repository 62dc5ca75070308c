//! Numbers of rooms: those that nothing but a number tells apart are numbered along the corridor, as doors in a building
//! are, whichever of them the search put where.

use std::collections::BTreeSet;

use d3dgen_model::scene_graph::{Connector, GraphEdge, GraphRoom, SceneGraph};

use super::lattice::Cellbox;
use super::outline::{Mosaic, neighbors_around};
use super::spec::Brief;

/// What tells a room from others: what it and the rooms entered from it are to be, and their relations to all others.
#[derive(PartialEq)]
struct Face {
    rooms: Vec<GraphRoom>,
    /// Other room, by its place in `rooms` where it is one of them.
    links: BTreeSet<(usize, String, Connector, bool)>,
    apart: BTreeSet<(usize, String)>,
}

/// Exchanges rooms that are alike, so that their numbers rise clockwise around the corridor.
pub(crate) fn along_corridor(graph: &SceneGraph, brief: &Brief, boxes: &mut [(usize, Cellbox)]) {
    let Some(spine) = brief.spine.filter(|_| !brief.hub) else { return };
    let around = neighbors_around(spine, &Mosaic::new(boxes).stretches()).unwrap_or_default();
    let mut alike: Vec<(Face, Vec<usize>)> = Vec::new();
    let mut seen = vec![false; brief.rooms.len()];
    for room in around {
        let known = std::mem::replace(&mut seen[room], true);
        if known || brief.guests[room].is_some() || brief.rooms[room].host.is_some() || brief.in_core(room) {
            continue;
        }
        let Some(face) = Face::of(graph, brief, room) else { continue };
        match alike.iter_mut().find(|(other, _)| *other == face) {
            Some((_, rooms)) => rooms.push(room),
            None => alike.push((face, vec![room])),
        }
    }
    let mut becomes: Vec<usize> = (0..brief.rooms.len()).collect();
    for (_, there) in alike {
        let mut numbers = there.clone();
        numbers.sort_unstable();
        for (old, new) in there.into_iter().zip(numbers) {
            for (old, new) in company(brief, old).into_iter().zip(company(brief, new)) {
                becomes[old] = new;
            }
        }
    }
    boxes.iter_mut().for_each(|(room, _)| *room = becomes[*room]);
}

/// Returns a room and those that one enters from it.
fn company(brief: &Brief, room: usize) -> Vec<usize> {
    let entered = (0..brief.rooms.len()).filter(|&i| brief.rooms[i].host == Some(room));
    std::iter::once(room).chain(entered).collect()
}

impl Face {
    /// Returns what tells a room of the brief from others; `None` when the graph does not know it.
    fn of(graph: &SceneGraph, brief: &Brief, room: usize) -> Option<Self> {
        let company = company(brief, room);
        let ids: Vec<&str> = company.iter().map(|&i| brief.rooms[i].id.as_str()).collect();
        let unnamed = |id: &&str| Some(GraphRoom { id: String::new(), name: String::new(), ..graph.room(id)?.clone() });
        let place = |id: &str| ids.iter().position(|own| *own == id);
        let other = |id: &str| place(id).map_or_else(|| id.to_owned(), |i| i.to_string());
        let mut links = BTreeSet::new();
        for GraphEdge { a, b, connector, required, .. } in &graph.edges {
            for (own, far) in [(a, b), (b, a)] {
                links.extend(place(own).map(|i| (i, other(far), *connector, *required)));
            }
        }
        let mut apart = BTreeSet::new();
        for [a, b] in &graph.apart {
            for (own, far) in [(a, b), (b, a)] {
                apart.extend(place(own).map(|i| (i, other(far))));
            }
        }
        Some(Self { rooms: ids.iter().map(unnamed).collect::<Option<_>>()?, links, apart })
    }
}

/// Returns the highest number at the end of ids; 0 when none has one.
pub fn highest<'a>(ids: impl Iterator<Item = &'a str>) -> u32 {
    let number = |id: &str| id.rsplit('_').next().and_then(|n| n.parse::<u32>().ok());
    ids.filter_map(number).max().unwrap_or(0)
}
