//! A building of which only the rooms are known.

use std::collections::BTreeMap;

use d3dgen_model::domain::Domain;
use d3dgen_model::scene_graph::Robot;

use crate::query::{Query, QueryRoom};

/// A building known by its room types only.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Building {
    /// ISO 3166 code; absent means international rules only.
    pub country_code: Option<String>,
    /// Building type inside the domain, where known.
    pub building_type: Option<String>,
    /// True when wheelchair access is asked for.
    pub accessible: bool,
    /// True when somebody in a wheelchair lives or works there.
    pub wheelchair: bool,
    /// Room types with how many there are of each.
    pub rooms: BTreeMap<String, u32>,
    /// People at a time; reckoned from usual areas when absent.
    pub persons: Option<u32>,
    /// Robots that work in it.
    pub robots: Vec<Robot>,
}

impl Building {
    /// Returns what to ask a knowledge base; room types that the domain does not know are taken as plain rooms.
    pub fn query(&self, domain: &Domain) -> Query {
        let rooms: Vec<QueryRoom> = self.rooms.iter().map(|(id, count)| QueryRoom::of(id, *count, domain)).collect();
        let usual = |id: &str| domain.room_type_or_generic(id).area_m2.target;
        let area: f64 = self.rooms.iter().map(|(id, count)| usual(id) * f64::from(*count)).sum();
        Query {
            country_code: self.country_code.clone(),
            domain: domain.id.clone(),
            building_type: self.building_type.clone(),
            accessible: self.accessible,
            wheelchair: self.wheelchair,
            rooms,
            persons: self.persons.unwrap_or_else(|| Query::persons_of_area(area)),
            persons_stated: self.persons.is_some(),
            robots: self.robots.clone(),
        }
    }
}
