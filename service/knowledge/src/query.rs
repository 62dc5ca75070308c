//! What is asked of a knowledge base: a building, where it stands, its rooms and its robots.

use d3dgen_model::domain::Domain;
use d3dgen_model::scene_graph::{Occupancy, Robot, SceneGraph};

/// The building whose rules are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Query {
    /// ISO 3166-1 alpha-2 code, or a subdivision (`US-CA`); absent means international rules only.
    pub country_code: Option<String>,
    /// Domain id (`hospital`).
    pub domain: String,
    /// Building type inside the domain (`ward`), where known.
    pub building_type: Option<String>,
    /// True when wheelchair access is asked for.
    pub accessible: bool,
    /// Room types of the building, each once, in scene-graph order.
    pub rooms: Vec<QueryRoom>,
    /// Head counts, where known.
    pub occupancy: Occupancy,
    /// Robots that work in it.
    pub robots: Vec<Robot>,
}

/// A room type at hand and the names under which knowledge bases speak of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryRoom {
    /// Room type id.
    pub room_type: String,
    /// `space_type` names besides the id itself.
    pub spaces: Vec<String>,
    /// How many there are.
    pub count: u32,
    /// True for corridors, halls and lobbies that were added to connect rooms.
    pub circulation: bool,
}

impl Query {
    /// Returns the query of a scene graph.
    pub fn of_graph(graph: &SceneGraph, domain: &Domain) -> Self {
        let mut rooms: Vec<QueryRoom> = Vec::new();
        for room in &graph.rooms {
            if let Some(known) = rooms.iter_mut().find(|r| r.room_type == room.room_type) {
                known.count += 1;
                known.circulation |= room.circulation;
                continue;
            }
            rooms.push(QueryRoom {
                room_type: room.room_type.clone(),
                spaces: domain.room_type(&room.room_type).map(|t| t.spaces.clone()).unwrap_or_default(),
                count: 1,
                circulation: room.circulation,
            });
        }
        Self {
            country_code: graph.country_code.clone(),
            domain: graph.domain.clone(),
            building_type: graph.building_type.clone(),
            accessible: graph.accessible,
            rooms,
            occupancy: graph.occupancy.clone(),
            robots: graph.robots.clone(),
        }
    }
}
