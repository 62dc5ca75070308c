//! What rooms of a type offer to those who use them, by the lines they are furnished with: beds, seats, desks, counters,
//! toilets, docks for robots.
//!
//! Every stage asks here, so that a room has as many beds for the one that counts them as for the one that places them. What
//! it is not for: how much of it one room of a plan has got (its placements say that).

mod beds;
mod desks;
mod docks;
mod places;
mod seats;
mod wet;

pub use beds::{other_bed, rolls_beds, sleeps};
pub use desks::{MOST_IN_TEAM, desks, desks_of, most_desks, works_in};
pub use docks::{LAST_RANK, dock_rank, docks_held, docks_needed_m2, has_docks, most_docks, widest_circle_m};
pub use places::{Places, places};
pub use seats::{Seating, counters, has_counters, seated_in, seating, seats_across, seats_of, seats_on};
pub use wet::Wet;

use crate::domain::{Domain, RoomType, Shape};
use crate::scene_graph::GraphRoom;

/// Returns the objects that a room type is furnished with, most important first; each as often as it is named.
pub fn furniture<'a>(domain: &'a Domain, kind: &'a RoomType) -> impl Iterator<Item = &'a str> {
    kind.furnishing.iter().flat_map(|line| domain.objects_of(&line.item))
}

/// Returns true for rooms with an object of one of these shapes.
pub fn has_shape(domain: &Domain, kind: &RoomType, shapes: &[Shape]) -> bool {
    furniture(domain, kind).any(|id| domain.object(id).is_some_and(|o| shapes.contains(&o.shape)))
}

/// Returns true when an object stands in rooms of a type, or of another type of the same part of the building.
pub fn suits(domain: &Domain, kind: &RoomType, object: &str) -> bool {
    let has = |k: &RoomType| {
        let item = k.furnishing.iter().any(|line| line.item == object);
        item || furniture(domain, k).any(|id| id == object)
    };
    has(kind) || domain.room_types.iter().any(|k| k.zone == kind.zone && has(k))
}

/// Returns the objects that somebody asked for in a room: they are wished for before what its type begins with. Docks are
/// for robots, whoever wishes for them.
pub fn asked_objects<'a>(domain: &Domain, kind: &RoomType, room: &'a GraphRoom) -> Vec<&'a String> {
    let usual = kind.furnishing.first().and_then(|f| domain.anchor(&f.item));
    let all = &room.wished_assets;
    let own = all.iter().position(|id| usual.is_some_and(|o| &o.id == id)).unwrap_or(0);
    let is_dock = |id: &String| domain.object(id).is_some_and(|o| o.shape == Shape::Dock);
    all[..own].iter().filter(|id| !is_dock(id)).collect()
}
