//! Doors, and which rooms they join.

use d3dgen_model::floorplan::{Door, DoorKind};

use super::approach;
use super::site::Site;
use crate::compliance::reading::Reading;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// Space name of the main entrance in pairs of rooms.
const ENTRANCE: &str = "entry";

/// Reads a quantity of every door the constraint is about.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    match rule.quantity.measure {
        Measure::NoDoorBetween | Measure::RoomsAdjacent => return read_pairs(site, a, rule),
        Measure::NoSharedWall | Measure::SharedWall => return read_walls(site, a, rule),
        Measure::DoorLanding
        | Measure::DoorPullDepth
        | Measure::DoorPushDepth
        | Measure::LatchPullSide
        | Measure::LatchPushSide => {
            return approach::read(site, rule.quantity.measure, |d| concerns(site, a, d));
        }
        _ => {}
    }
    let doors = site.world.floorplan.doors.iter().filter(|d| concerns(site, a, d));
    let value = |d: &Door| match rule.quantity.measure {
        Measure::DoorWidth => Some(d.clear_width_m),
        Measure::DoorOpeningWidth => Some(d.line.length()),
        Measure::DoorHeight => Some(d.height_m),
        // the floor of a world is one plane: no document has a sill in a door
        Measure::Threshold => Some(0.0),
        Measure::OpensOutward => opens_outward(a, site, d),
        // a yes-or-no rule: 1 when the leaf does not stand in the way
        Measure::SwingIntoCirculation => Some(if opens_into_circulation(site, d) { 0.0 } else { 1.0 }),
        _ => None,
    };
    doors.filter_map(|d| Some(Reading::new(&d.door_id, value(d)?))).collect()
}

fn concerns(site: &Site, a: &Applicable, door: &Door) -> bool {
    let leaf = door.kind != DoorKind::Open;
    let room_type = |id: &String| site.world.floorplan.room(id).map(|r| r.room_type.as_str());
    match &a.scope {
        Scope::Doors => leaf,
        Scope::Entrance => door.entrance,
        Scope::Circulation => {
            leaf && door.room_ids.iter().any(|id| site.world.floorplan.room(id).is_some_and(|r| r.circulation))
        }
        // the door of a room, not those of the closets and bathrooms that hang on it
        Scope::Rooms(types) => {
            let hangs_on = |inner: &str, outer: &str| {
                site.domain.room_type_or_lent(inner).is_some_and(|t| t.hosts.iter().any(|h| h == outer))
            };
            let ends: Vec<&str> = door.room_ids.iter().filter_map(room_type).collect();
            let kept = a.guards.is_empty() || site.rooms_of(a).any(|r| door.room_ids.contains(&r.plan.room_id));
            leaf && kept
                && ends.iter().any(|own| types.contains(*own) && !ends.iter().any(|other| hangs_on(other, own)))
        }
        Scope::Building | Scope::Objects(_) => false,
    }
}

/// Returns 1 when no leaf of a door opens into the room the constraint is about: sliding doors keep it clear too.
fn opens_outward(a: &Applicable, site: &Site, door: &Door) -> Option<f64> {
    let room = site.rooms_of(a).find(|r| door.room_ids.contains(&r.plan.room_id))?;
    let inward = door.swing.as_ref().is_some_and(|s| s.into_room_id.as_ref() == Some(&room.plan.room_id));
    Some(if inward { 0.0 } else { 1.0 })
}

fn opens_into_circulation(site: &Site, door: &Door) -> bool {
    let into = door.swing.as_ref().and_then(|s| s.into_room_id.as_ref());
    into.and_then(|id| site.world.floorplan.room(id)).is_some_and(|r| r.circulation)
}

/// Reads, for each room the constraint is about, whether the pair of rooms is as it should be.
fn read_pairs(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    let to_entrance = rule.quantity.to.iter().any(|t| t == ENTRANCE);
    if rule.to.is_empty() && !to_entrance {
        return Vec::new();
    }
    let rooms = site.rooms_of(a).map(|room| {
        let meets = room.doors.iter().any(|d| {
            let other = d.room_ids.iter().find(|id| **id != room.plan.room_id);
            let other = other.and_then(|id| site.world.floorplan.room(id));
            other.is_some_and(|o| rule.to.contains(&o.room_type)) || (to_entrance && d.entrance)
        });
        Reading::flag(&room.plan.room_id, meets == (rule.quantity.measure == Measure::RoomsAdjacent))
    });
    rooms.collect()
}

/// Reads, for each room the constraint is about, whether it keeps away from rooms of the other kind.
fn read_walls(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    let walls = &site.world.floorplan.walls;
    let is_other = |id: &String| site.world.floorplan.room(id).is_some_and(|r| rule.to.contains(&r.room_type));
    let rooms = site.rooms_of(a).filter(|_| !rule.to.is_empty()).map(|room| {
        let own = |ids: &[String]| ids.contains(&room.plan.room_id);
        let meets = walls.iter().filter(|w| own(&w.room_ids)).flat_map(|w| &w.room_ids);
        let meets = meets.filter(|id| **id != room.plan.room_id).any(is_other);
        Reading::flag(&room.plan.room_id, meets == (rule.quantity.measure == Measure::SharedWall))
    });
    rooms.collect()
}
