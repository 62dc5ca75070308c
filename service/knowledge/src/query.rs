//! What is asked of a knowledge base: a building, where it stands, its rooms and its robots.

use crate::figure::Facts;
use d3dgen_model::domain::{Daylight, Domain, Zone};
use d3dgen_model::offer::rolls_beds;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::scene_graph::{Robot, SceneGraph};

/// Floor area that one person is reckoned with when nothing says how many there are, m^2.
const AREA_PER_PERSON_M2: f64 = 10.0;

/// Space name of rooms to sleep in.
const SLEEPING: &str = "bedroom";

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
    /// True when somebody in a wheelchair lives or works there: rules for their homes ask more than those without steps.
    pub wheelchair: bool,
    /// Room types of the building, each once, in scene-graph order.
    pub rooms: Vec<QueryRoom>,
    /// People at a time, as stated or reckoned from the area.
    pub persons: u32,
    /// False when `persons` is only reckoned from the area.
    pub persons_stated: bool,
    /// Robots that work in it.
    pub robots: Vec<Robot>,
}

/// A room type at hand and the names under which knowledge bases speak of it.
#[derive(Debug, Clone, PartialEq)]
pub struct QueryRoom {
    /// Room type id.
    pub room_type: String,
    /// `space_type` names besides the id itself.
    pub spaces: Vec<String>,
    /// How many there are.
    pub count: u32,
    /// True for corridors, halls and lobbies that were added to connect rooms.
    pub circulation: bool,
    /// Part of the building it belongs to.
    pub zone: Zone,
    /// Its need for a window.
    pub daylight: Daylight,
    /// True when beds on wheels stand in it.
    pub beds: bool,
    /// Largest net floor area that the scene graph allows any such room, m^2.
    pub area_max_m2: f64,
}

impl Query {
    /// Returns the query of a scene graph.
    pub fn of_graph(graph: &SceneGraph, domain: &Domain) -> Self {
        let mut rooms: Vec<QueryRoom> = Vec::new();
        for room in &graph.rooms {
            if let Some(known) = rooms.iter_mut().find(|r| r.room_type == room.room_type) {
                known.count += 1;
                known.circulation |= room.circulation;
                known.area_max_m2 = known.area_max_m2.min(room.area_range_m2[1]);
            } else {
                rooms.push(QueryRoom {
                    circulation: room.circulation,
                    area_max_m2: room.area_range_m2[1],
                    ..QueryRoom::of(&room.room_type, 1, domain)
                });
            }
        }
        let (persons, persons_stated) = persons(graph);
        Self {
            country_code: graph.place_code().map(str::to_owned),
            domain: graph.domain.clone(),
            building_type: graph.building_type.clone(),
            accessible: graph.accessible,
            wheelchair: graph.wheelchair,
            rooms,
            persons,
            persons_stated,
            robots: graph.robots.clone(),
        }
    }

    /// Returns how many people a floor area is reckoned with, m^2.
    pub(crate) fn persons_of_area(area_m2: f64) -> u32 {
        (area_m2 / AREA_PER_PERSON_M2).ceil() as u32
    }

    /// Returns what formulas may ask about the building.
    pub(crate) fn facts(&self) -> Facts {
        let robot_radius = self.robots.iter().map(|r| r.radius_m).reduce(f64::max);
        let largest = |of: fn(&RobotBody) -> Option<f64>| {
            self.robots.iter().filter_map(|r| r.body.as_ref().and_then(of)).reduce(f64::max)
        };
        let robot_body = [largest(|b| b.width_m), largest(|b| b.length_m)];
        let sleeps = |r: &&QueryRoom| r.room_type == SLEEPING || r.spaces.iter().any(|s| s == SLEEPING);
        let bedrooms = self.rooms.iter().filter(sleeps).map(|r| r.count).sum();
        Facts { persons: self.persons, robots: self.robot_count(), robot_radius, robot_body, bedrooms }
    }

    /// Returns the number of robots.
    pub fn robot_count(&self) -> u32 {
        self.robots.iter().map(|r| r.count).sum()
    }
}

impl QueryRoom {
    /// Returns what rules may ask about `count` rooms of a type, whose area is at most the usual.
    pub(crate) fn of(room_type: &str, count: u32, domain: &Domain) -> Self {
        let kind = domain.room_type_or_generic(room_type);
        Self {
            room_type: room_type.to_owned(),
            // the spaces of the generic room type say nothing about a room that only the prompt names
            spaces: domain.room_type_or_lent(room_type).map(|t| t.spaces.clone()).unwrap_or_default(),
            count,
            circulation: domain.circulation.room_type == room_type,
            zone: kind.zone,
            daylight: kind.daylight,
            beds: rolls_beds(domain, kind),
            area_max_m2: kind.area_m2.max,
        }
    }
}

/// Returns how many people there are at a time, and whether the prompt says so.
fn persons(graph: &SceneGraph) -> (u32, bool) {
    let o = &graph.occupancy;
    // desks are used by staff: count the larger of the two
    let stated = o.staff.unwrap_or(0).max(o.desks.unwrap_or(0)) + o.beds.unwrap_or(0) + o.visitors.unwrap_or(0);
    let held: u32 = graph.rooms.iter().filter_map(|r| r.occupants).sum();
    let area: f64 = graph.rooms.iter().map(|r| r.target_area_m2).sum();
    match stated.max(held) {
        0 => (Query::persons_of_area(area), false),
        n => (n, true),
    }
}
