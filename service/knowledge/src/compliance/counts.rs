//! Figures of the whole building: areas, numbers of rooms and of water closets.

use std::collections::BTreeSet;

use d3dgen_model::domain::Shape;

use super::site::{Room, Site};
use crate::compliance::reading::Reading;
use crate::freespace::FreeSpace;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// Meters of an inch.
const INCH_M: f64 = 0.0254;

/// Reads a quantity of the building; nothing when it has none (no bed for beds per toilet).
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    figure(site, a, rule).map(|v| Reading::new("building", v)).into_iter().collect()
}

fn figure(site: &Site, a: &Applicable, rule: &Rule) -> Option<f64> {
    let area = |circulation_only: bool| site.net_area(circulation_only);
    let toilets = site.count(&[Shape::Toilet, Shape::Cubicle]);
    let per_toilet = |n: f64| (toilets > 0 && n > 0.0).then(|| n / toilets as f64);
    let each = |whole: f64, parts: f64| (parts > 0.0).then(|| whole / parts);
    let persons = f64::from(site.retrieval.persons);
    let beds = site.rooms.iter().map(|r| r.beds()).sum::<usize>() as f64;
    match rule.quantity.measure {
        Measure::BuildingArea => Some(area(false)),
        Measure::CirculationShare => (area(true) > 0.0).then(|| area(true) / area(false)),
        Measure::RoomsPresent | Measure::RoomNeededAbovePersons => match &a.scope {
            Scope::Rooms(types) => Some(site.rooms.iter().filter(|r| types.contains(&r.plan.room_type)).count() as f64),
            _ => None,
        },
        Measure::ToiletsForPersons => Some(toilets as f64),
        Measure::CirculationAllowance => {
            (area(true) > 0.0 && area(false) > area(true)).then(|| area(true) / (area(false) - area(true)))
        }
        Measure::LargestRoomArea => site.rooms_of(a).map(|r| r.plan.net_area_m2).reduce(f64::max),
        Measure::BuildingAreaPerPerson => each(area(false), persons),
        Measure::BuildingAreaPerWorkplace => each(area(false), site.count(&[Shape::Desk]) as f64),
        Measure::BuildingAreaPerBed => each(site.gross_area(), beds),
        Measure::PersonsPerRoom => each(persons, site.rooms_of(a).count() as f64),
        Measure::BedsPerRoomKind => each(beds, site.rooms_of(a).count() as f64).filter(|_| beds > 0.0),
        Measure::PersonsPerObject => each(persons, picked(site, rule)),
        Measure::DocksPerRobot => each(site.count(&[Shape::Dock]) as f64, f64::from(site.retrieval.robots)),
        Measure::Exits => Some(site.exits().count() as f64),
        Measure::DesksPerArea => {
            let rooms: f64 = site.rooms_of(a).map(|r| r.plan.net_area_m2).sum();
            each(site.count(&[Shape::Desk]) as f64, rooms / rule.quantity.base)
        }
        Measure::PersonsBySingleExit => Some(persons).filter(|_| site.exits().count() == 1),
        Measure::ExitWidthPerPerson => {
            let width: f64 = site.exits().map(|d| d.clear_width_m).sum();
            let unit = if a.constraint.unit.starts_with("in ") { INCH_M } else { 1.0 };
            each(width / unit, persons)
        }
        Measure::GrossBuildingArea => Some(site.gross_area()),
        Measure::BedsInBuilding => Some(beds).filter(|n| *n > 0.0),
        Measure::LargestDimension => {
            site.rooms_of(a).map(|r| FreeSpace::new(&r.plan.net_polygon, &[]).largest_square()).reduce(f64::max)
        }
        Measure::RoomsCounted => {
            let counted = site.rooms.iter().filter(|r| rule.to.contains(&r.plan.room_type)).count();
            Some(if rule.to.is_empty() { site.rooms_of(a).count() } else { counted } as f64)
        }
        Measure::RoomKindArea => Some(site.rooms_of(a).map(|r| r.plan.net_area_m2).fold(0.0, |a, b| a + b)),
        Measure::CeilingOfMost => height_of_share(site, rule.quantity.base),
        Measure::KindAreaPerBed => each(site.rooms_of(a).map(|r| r.plan.net_area_m2).sum(), beds),
        Measure::EnsuiteRooms => {
            let rooms = site.rooms.iter().filter(|r| !r.plan.circulation && has_for_itself(site, r, rule));
            Some(rooms.count() as f64)
        }
        Measure::ReachesExitWithout => leads_out(site, rule),
        // a world is one level floor
        Measure::FloorStep | Measure::FloorSlope => Some(0.0),
        Measure::FloorFlat => Some(1.0),
        Measure::PersonsPerToilet => per_toilet(f64::from(site.retrieval.persons)),
        Measure::BedsPerToilet => per_toilet(site.rooms.iter().map(|r| r.beds()).sum::<usize>() as f64),
        _ => None,
    }
}

/// Returns how many objects of the row's kinds there are.
fn picked(site: &Site, rule: &Rule) -> f64 {
    let kinds = site.rooms.iter().flat_map(|r| &r.objects).filter_map(|o| o.kind);
    kinds.filter(|k| rule.quantity.picks(k)).count() as f64
}

/// Returns true for a room with a room of the other kind whose only door leads to it.
fn has_for_itself(site: &Site, room: &Room, rule: &Rule) -> bool {
    let plan = &site.world.floorplan;
    let ids = room.doors.iter().flat_map(|d| &d.room_ids).filter(|id| **id != room.plan.room_id);
    let own =
        |id: &&String| plan.room(id).is_some_and(|r| rule.to.contains(&r.room_type)) && plan.doors_of(id).count() == 1;
    ids.into_iter().any(|id| own(&id))
}

/// Returns 1 when every room but those of the other kind has a way out around these; `None` where there are none.
fn leads_out(site: &Site, rule: &Rule) -> Option<f64> {
    let plan = &site.world.floorplan;
    let shunned = |id: &String| plan.room(id).is_some_and(|r| rule.to.contains(&r.room_type));
    if !plan.rooms.iter().any(|r| rule.to.contains(&r.room_type)) {
        return None;
    }
    let mut reached: BTreeSet<&String> = site.exits().flat_map(|d| &d.room_ids).filter(|id| !shunned(id)).collect();
    loop {
        let touches = |d: &&d3dgen_model::floorplan::Door| d.room_ids.iter().any(|id| reached.contains(id));
        let next: Vec<&String> = plan.doors.iter().filter(touches).flat_map(|d| &d.room_ids).collect();
        let before = reached.len();
        reached.extend(next.into_iter().filter(|id| !shunned(id)));
        if reached.len() == before {
            break;
        }
    }
    let all = plan.rooms.iter().all(|r| reached.contains(&r.room_id) || shunned(&r.room_id));
    Some(if all { 1.0 } else { 0.0 })
}

/// Returns the clear height that rooms of at least this share of the net floor area have, m.
fn height_of_share(site: &Site, share: f64) -> Option<f64> {
    let mut rooms: Vec<(f64, f64)> = site.rooms.iter().map(|r| (r.plan.ceiling_height_m, r.plan.net_area_m2)).collect();
    rooms.sort_by(|a, b| b.0.total_cmp(&a.0));
    let whole: f64 = rooms.iter().map(|r| r.1).sum();
    let mut reached = 0.0;
    let highest = rooms.into_iter().find(|(_, area)| {
        reached += area;
        reached >= share * whole
    });
    highest.map(|(height, _)| height)
}
