//! Beds of rooms that people stay in overnight.

use super::asked_objects;
use crate::domain::{Domain, Furnishing, ObjectType, RoomType, Shape, Zone};
use crate::measures::sleepers_in;
use crate::scene_graph::GraphRoom;

/// Tag of objects that are mounted where they stand.
const FIXED: &str = "fixed";

/// Returns how many people a room of a type has beds for, least and most; `None` where nobody stays overnight.
pub fn sleeps(domain: &Domain, kind: &RoomType) -> Option<[u32; 2]> {
    if kind.zone != Zone::Night {
        return None;
    }
    kind.furnishing.iter().filter(|line| line.required).find_map(|line| {
        let each = sleepers_of(domain, &line.item);
        (each > 0).then(|| [line.min.max(1) * each, line.max.max(1) * each])
    })
}

/// Returns true for rooms that beds, stretchers or operating tables on wheels are brought to; what is `fixed` (a dentist's chair)
/// stays where it is.
pub fn rolls_beds(domain: &Domain, kind: &RoomType) -> bool {
    let rolls = |o: &ObjectType| o.shape == Shape::HospitalBed && !o.tags.iter().any(|t| t == FIXED);
    kind.furnishing.iter().any(|f| f.min > 0 && domain.anchor(&f.item).is_some_and(rolls))
}

/// Returns how many people sleep in the beds of an object or a group.
fn sleepers_of(domain: &Domain, item: &str) -> u32 {
    let of_one = |id: &str| {
        let bed = domain.object(id).filter(|o| matches!(o.shape, Shape::Bed | Shape::HospitalBed));
        bed.map_or(0, |o| o.sizes_m.first().map_or(1, |size| sleepers_in(*size)))
    };
    domain.counted_objects_of(item).map(|(id, count)| count * of_one(id)).sum()
}

/// Returns the line of the bed that a room is to have in the place of its usual one, where somebody asked for that.
pub fn other_bed<'a>(domain: &'a Domain, room: &GraphRoom) -> Option<&'a Furnishing> {
    let kind = domain.room_type_or_lent(&room.room_type)?;
    let is_bed = |item: &str| domain.anchor(item).is_some_and(|o| o.shape == Shape::Bed);
    let usual = kind.furnishing.first().filter(|f| f.required && is_bed(&f.item))?;
    let named = asked_objects(domain, kind, room);
    kind.furnishing.iter().find(|f| {
        f.instead_of.contains(&usual.item)
            && is_bed(&f.item)
            && domain.anchor(&f.item).is_some_and(|a| named.iter().any(|id| **id == a.id))
    })
}
