//! Adjacency fidelity: are the connections of the scene graph built?
//!
//! The measure of the graph-to-plan literature (House-GAN's compatibility is the same question as an edit distance): the
//! share of edges that the plan has. A `door` edge is built by any door or passage between the two rooms, an `open` edge by
//! a passage without a leaf, a `wall` edge by a wall with both rooms on its sides or a door between them. `near` is not
//! judged. Pairs to be kept apart must share neither wall nor door.

use d3dgen_model::floorplan::{DoorKind, Floorplan};
use d3dgen_model::scene_graph::Connector;
use d3dgen_model::world::World;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::share;

/// Connections asked for against connections built.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adjacency {
    /// Edges that must be built.
    pub required: u32,
    /// Share of them that are.
    pub required_share: f64,
    /// Edges that were wished for.
    pub wished: u32,
    /// Share of them that are built.
    pub wished_share: f64,
    /// Pairs to be kept apart.
    pub apart: u32,
    /// Share of them that are.
    pub apart_share: f64,
    /// Required edges that are missing and pairs that are not apart, room ids.
    pub broken: Vec<[String; 2]>,
}

/// Measures a world.
pub(crate) fn measure(world: &World) -> Adjacency {
    let (plan, graph) = (&world.floorplan, &world.scene_graph);
    let (mut counts, mut broken) = ([[0usize; 2]; 2], Vec::new());
    for edge in &graph.edges {
        let Some(is_built) = built(plan, &edge.a, &edge.b, edge.connector) else { continue };
        let of = &mut counts[usize::from(edge.required)];
        of[0] += 1;
        of[1] += usize::from(is_built);
        if edge.required && !is_built {
            broken.push([edge.a.clone(), edge.b.clone()]);
        }
    }
    let joined: Vec<_> = graph.apart.iter().filter(|[a, b]| built(plan, a, b, Connector::Wall) == Some(true)).collect();
    broken.extend(joined.iter().map(|pair| (*pair).clone()));
    let [[wished, wished_built], [required, required_built]] = counts;
    Adjacency {
        required: required as u32,
        required_share: share(required_built, required),
        wished: wished as u32,
        wished_share: share(wished_built, wished),
        apart: graph.apart.len() as u32,
        apart_share: share(graph.apart.len() - joined.len(), graph.apart.len()),
        broken,
    }
}

/// Returns whether a connection is there; `None` for one that is not judged.
fn built(plan: &Floorplan, a: &str, b: &str, how: Connector) -> Option<bool> {
    let both = |ids: &[String]| ids.iter().any(|i| i == a) && ids.iter().any(|i| i == b);
    let door = plan.doors.iter().any(|d| both(&d.room_ids));
    match how {
        Connector::Door => Some(door),
        Connector::Open => Some(plan.doors.iter().any(|d| d.kind == DoorKind::Open && both(&d.room_ids))),
        Connector::Wall => Some(door || plan.walls.iter().any(|w| both(&w.room_ids))),
        Connector::Near => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_missing_door_is_found_and_so_is_a_shared_wall() {
        let mut world = sample::world();
        let found = measure(&world);
        assert_eq!((found.required, found.required_share, found.broken.len()), (1, 1.0, 0));
        world.floorplan.doors.retain(|d| d.door_id != "door_1");
        let found = measure(&world);
        assert_eq!((found.required_share, found.broken), (0.0, vec![["a_1".to_owned(), "b_1".to_owned()]]));
        world.scene_graph.edges[0].connector = Connector::Wall;
        assert_eq!(measure(&world).required_share, 1.0, "they share a wall");
        world.scene_graph.apart = vec![["a_1".into(), "b_1".into()]];
        assert_eq!(measure(&world).apart_share, 0.0);
    }

    #[test]
    fn an_open_edge_needs_a_passage_without_a_leaf() {
        let mut world = sample::world();
        world.scene_graph.edges[0].connector = Connector::Open;
        assert_eq!(measure(&world).required_share, 0.0);
        world.floorplan.doors[0].kind = DoorKind::Open;
        assert_eq!(measure(&world).required_share, 1.0);
    }
}
