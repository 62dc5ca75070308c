//! Desks of rooms that people work in.

use crate::domain::{Domain, Furnishing, RoomType, Shape, Zone};

/// Most desks of a room for one team: rooms with more are open ones.
pub const MOST_IN_TEAM: u32 = 12;

/// Returns the least and most desks of a room type; `None` where nobody has one.
pub fn desks(domain: &Domain, kind: &RoomType) -> Option<[u32; 2]> {
    let each = |item: &str| desks_of(domain, item);
    let line = kind.furnishing.iter().filter(|f| f.required && each(&f.item) > 0).max_by_key(|f| f.max)?;
    Some([line.min * each(&line.item), line.max * each(&line.item)])
}

/// Returns how many desks an object or a group has.
pub fn desks_of(domain: &Domain, item: &str) -> u32 {
    let is_desk = |id: &str| domain.object(id).is_some_and(|o| o.shape == Shape::Desk);
    domain.counted_objects_of(item).filter(|(id, _)| is_desk(id)).map(|(_, count)| count).sum()
}

/// Returns true for rooms that people have their desk in: not tables of a course, nor workbenches.
pub fn works_in(domain: &Domain, kind: &RoomType) -> bool {
    let chair = |id: &str| domain.object(id).is_some_and(|o| o.shape == Shape::SwivelChair);
    let desk = |f: &Furnishing| {
        let group = domain.group(&f.item);
        f.required && desks_of(domain, &f.item) > 0 && group.is_some_and(|g| g.members.iter().any(|m| chair(&m.object)))
    };
    kind.zone == Zone::Day && kind.furnishing.first().is_some_and(desk)
}

/// Returns the most desks of a room type, 0 for rooms that nobody has a desk in.
pub fn most_desks(domain: &Domain, kind: &RoomType) -> u32 {
    if works_in(domain, kind) { desks(domain, kind).map_or(0, |d| d[1]) } else { 0 }
}
