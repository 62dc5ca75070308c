//! What large buildings have besides, once for all, as programs of the domain say: where people arrive, what feeds and serves
//! so many.

use d3dgen_model::domain::Access;

use crate::built::planned::Planned;
use crate::reading::Reading;

/// Adds what a building of this size has, where the prompt leaves its rooms open.
pub(super) fn complete<'a>(reading: &Reading<'a>, rooms: &mut Vec<Planned<'a>>) {
    let open = reading.total.is_none() && reading.area_m2.is_none() && !reading.single && !reading.only;
    if !open || reading.closed && !reading.may_join {
        return;
    }
    let along = rooms.iter().filter(|r| r.kind.access != Access::Host).count();
    let unwanted = |id: &String| reading.wishes.forbidden.contains(id);
    for entry in reading.program.large.iter().filter(|l| along >= l.from_rooms as usize).flat_map(|l| &l.rooms) {
        let served = entry.room_types().any(|id| unwanted(id) || rooms.iter().any(|r| &r.room_type == id));
        if let Some(kind) = reading.domain.room_type(&entry.room_type).filter(|_| !served) {
            rooms.push(Planned::new(&kind.id, kind));
        }
    }
}

/// Returns true for a room that a large building has once for all.
pub(crate) fn is_of_all(reading: &Reading, room: &Planned) -> bool {
    let mut entries = reading.program.large.iter().flat_map(|l| &l.rooms);
    entries.any(|entry| entry.room_type == room.room_type)
}
