//! Toilets that a building needs for the people in it, and where it has one that is made for wheelchairs.
//!
//! Whoever plans the rooms and whoever judges a world ask here. Private homes are no matter of it.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::domain::{Access, Domain, Furnishing, RoomType, Shape, Zone, tags};
use crate::offer::{self, Wet};
use crate::scene_graph::{GraphRoom, Note, SceneGraph};

/// Tag of objects that are made for people in wheelchairs.
const ACCESSIBLE: &str = "accessible";
/// Code of the note that says which toilets a world lacks because somebody wanted it so.
pub const LEFT_OUT: &str = "toilets_left_out";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    rates: Vec<Rate>,
    desks: Desks,
    parted: Parted,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Rate {
    tags: Vec<String>,
    people: f64,
    source: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Desks {
    people: f64,
    source: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parted {
    above: u32,
    source: String,
}

fn table() -> &'static Table {
    static TABLE: LazyLock<Table> =
        LazyLock::new(|| toml::from_str(include_str!("../data/sanitary.toml")).expect("a test reads sanitary.toml"));
    &TABLE
}

/// Toilets for the people of a building.
#[derive(Debug, Clone, PartialEq)]
pub struct Need {
    /// People who are counted: those at desks, seats and places.
    pub people: u32,
    /// Water closets for them, one at least.
    pub closets: u32,
    /// True where women and men have their own.
    pub parted: bool,
    /// Where the figures come from.
    pub sources: Vec<&'static str>,
}

/// Returns true for a building that needs toilets: not for a home, which its own rules are for, nor for a room by itself.
pub fn applies(graph: &SceneGraph, domain: &Domain) -> bool {
    let worked_in = domain.room_types.iter().any(|k| matches!(k.zone, Zone::Staff | Zone::Public));
    let several = graph.rooms.iter().filter(|r| !r.circulation).count() > 1;
    let known = domain.room_types.iter().any(|k| is_for_all(domain, k));
    worked_in && several && known
}

/// Returns true where the world says that it lacks toilets because somebody wanted it so.
pub fn is_left_out(graph: &SceneGraph) -> bool {
    graph.conflicts.iter().any(|note: &Note| note.code == LEFT_OUT)
}

/// Returns true for rooms with a toilet that all may use: not those one enters through a room to sleep in, nor bathrooms.
pub fn is_for_all(domain: &Domain, kind: &RoomType) -> bool {
    let has = |shapes: &[Shape]| offer::has_shape(domain, kind, shapes);
    kind.access != Access::Host
        && kind.zone != Zone::Night
        && has(&[Shape::Toilet, Shape::Cubicle])
        && !has(&[Shape::Shower, Shape::Bathtub])
}

/// Returns true for toilets that are made for people in wheelchairs, whatever is asked for.
pub fn is_accessible(domain: &Domain, kind: &RoomType) -> bool {
    is_made_for_wheelchairs(domain, kind, false)
}

/// Returns true for toilets that people in wheelchairs can use; `step_free` where that is asked for, which some toilets wait for.
fn is_made_for_wheelchairs(domain: &Domain, kind: &RoomType, step_free: bool) -> bool {
    let made_for = |line: &Furnishing| {
        let tagged = |id: &str| domain.object(id).is_some_and(|o| o.tags.iter().any(|t| t == ACCESSIBLE));
        line.required && (step_free || !line.accessible) && domain.objects_of(&line.item).any(tagged)
    };
    is_for_all(domain, kind) && kind.furnishing.iter().any(made_for)
}

/// Returns how many water closets a toilet of a type has on so much floor, m^2.
pub fn closets(domain: &Domain, kind: &RoomType, area_m2: f64) -> u32 {
    let flushes = |line: &&Furnishing| {
        let shape = domain.anchor(&line.item).map(|o| o.shape);
        matches!(shape, Some(Shape::Toilet | Shape::Cubicle)) && line.instead_of.is_empty()
    };
    kind.furnishing.iter().filter(flushes).map(|line| line.units(area_m2)).sum()
}

/// Returns the line by which a toilet of a type has more closets on more floor.
pub fn growing_line<'a>(domain: &Domain, kind: &'a RoomType) -> Option<&'a Furnishing> {
    let flushes = |line: &&Furnishing| {
        let shape = domain.anchor(&line.item).map(|o| o.shape);
        line.max > 1 && line.area_per_item_m2 > 0.0 && matches!(shape, Some(Shape::Toilet | Shape::Cubicle))
    };
    kind.furnishing.iter().find(flushes)
}

/// Returns the toilets that the people in rooms of these types need, each with its floor, m^2, and for how many it is where
/// that is known.
pub fn needed<'a>(domain: &Domain, rooms: impl Iterator<Item = (&'a RoomType, f64, Option<u32>)>) -> Need {
    let table = table();
    let (mut people, mut closets) = (0, 0.0);
    let mut sources: BTreeSet<&'static str> = BTreeSet::new();
    for (kind, area_m2, occupants) in rooms.filter(|(kind, ..)| kind.zone != Zone::Night) {
        let tags = domain.tags_of(kind);
        let rate = table.rates.iter().find(|rate| rate.tags.iter().any(|t| tags.contains(t.as_str())));
        let per = |line: &Furnishing, of: u32| if line.instead_of.is_empty() { of * line.units(area_m2) } else { 0 };
        let desks = || kind.furnishing.iter().map(|l| per(l, offer::desks_of(domain, &l.item))).max().unwrap_or(0);
        let seats = || kind.furnishing.iter().map(|l| per(l, offer::seats_of(domain, &l.item))).max().unwrap_or(0);
        let (here, each, source) = match rate {
            Some(rate) => (occupants.unwrap_or_else(seats), rate.people, &rate.source),
            None if offer::works_in(domain, kind) => {
                (occupants.unwrap_or_else(desks), table.desks.people, &table.desks.source)
            }
            None => continue,
        };
        if here > 0 {
            people += here;
            closets += f64::from(here) / each;
            sources.insert(source);
        }
    }
    let parted = people > table.parted.above;
    if parted {
        sources.insert(&table.parted.source);
    }
    let least = if parted { 2 } else { 1 };
    Need { people, closets: (closets.ceil() as u32).max(least), parted, sources: sources.into_iter().collect() }
}

/// Returns the storeys, from the ground up, that visitors come to and that have no toilet made for wheelchairs; the ground floor
/// counts too, whoever comes there, unless people sleep in the building.
pub fn without_accessible(graph: &SceneGraph, domain: &Domain) -> Vec<i32> {
    let kind = |r: &GraphRoom| domain.room_type_or_generic(&r.room_type);
    let wet = Wet::of(domain);
    let visited = |r: &&GraphRoom| {
        let tags = domain.tags_of(kind(r));
        !r.circulation
            && r.level >= 0
            && tags.contains(tags::PUBLIC)
            && !tags.contains(tags::WAY)
            && !wet.has_toilet(kind(r))
    };
    let mut levels: BTreeSet<i32> = graph.rooms.iter().filter(visited).map(|r| r.level).collect();
    // a ward by itself has its patients' own bathrooms
    if !graph.rooms.iter().any(|r| kind(r).zone == Zone::Night) {
        levels.insert(graph.rooms.iter().map(|r| r.level).filter(|l| *l >= 0).min().unwrap_or(0));
    }
    levels.retain(|level| {
        let here = graph.rooms.iter().filter(|r| r.level == *level);
        !here.clone().any(|r| is_made_for_wheelchairs(domain, kind(r), graph.accessible))
    });
    levels.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_tags_that_rooms_have_and_a_source() {
        let table = table();
        for rate in &table.rates {
            assert!(rate.tags.iter().all(|t| tags::is_known(t)), "{:?}", rate.tags);
            assert!(rate.people >= 1.0 && !rate.source.is_empty(), "{:?}", rate.tags);
        }
        assert!(table.desks.people >= 1.0 && !table.desks.source.is_empty() && !table.parted.source.is_empty());
    }
}
