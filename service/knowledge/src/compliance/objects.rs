//! Free floor around objects, and where docks stand.

use d3dgen_model::domain::Shape;
use d3dgen_model::floorplan::Door;

use super::site::{Object, Room, Site};
use super::{fixtures, kitchen, sizes, spacing, stairs};
use crate::clearance::{Side, door_zones, free_depth};
use crate::compliance::reading::Reading;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule, Scope};

/// Reads a quantity of every object the constraint is about.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    match rule.quantity.measure {
        Measure::WorkTriangleLeg
        | Measure::WorkTriangleTotal
        | Measure::TriangleIntrusion
        | Measure::TriangleClearOfTraffic => return kitchen::triangles(site, a, rule),
        Measure::WallProjection => return spacing::projections(site, a),
        Measure::DockKeepsEgress => return docks_keep_egress(site),
        _ => {}
    }
    let concerns = |o: &Object| match &a.scope {
        Scope::Objects(of_scope) if !rule.quantity.names_objects() => o.is(of_scope),
        _ => o.kind.is_some_and(|k| rule.quantity.picks(k)),
    };
    let mut out = Vec::new();
    for room in site.rooms_of(a) {
        for object in room.objects.iter().filter(|o| concerns(o)) {
            let value = figure(site, room, object, a, rule)
                .or_else(|| sizes::figure(object, a, rule))
                .or_else(|| spacing::figure(room, object, rule))
                .or_else(|| stairs::figure(site, object, rule))
                .or_else(|| fixtures::figure(site, room, object, a, rule));
            out.extend(value.map(|v| Reading::new(&object.placement.placement_id, v)));
        }
    }
    out
}

/// Reads, for each piece of circulation with a dock, whether what is left is as wide as circulation must be.
fn docks_keep_egress(site: &Site) -> Vec<Reading> {
    let least = site.retrieval.limits.corridor_width.as_ref().map_or(0.0, |l| l.value);
    let docks = |r: &&Room| r.plan.circulation && r.has(&[Shape::Dock]);
    let kept = |r: &Room| r.space().passes(&r.doors, least);
    let narrowed: Vec<Reading> =
        site.rooms.iter().filter(docks).map(|r| Reading::flag(&r.plan.room_id, kept(r))).collect();
    let none = narrowed.is_empty() && site.count(&[Shape::Dock]) > 0;
    if none { vec![Reading::flag("building", true)] } else { narrowed }
}

fn figure(site: &Site, room: &Room, object: &Object, a: &Applicable, rule: &Rule) -> Option<f64> {
    let depth = |side: Side| free_depth(object.placement, side, &room.plan.net_polygon, room.others(object));
    match rule.quantity.measure {
        Measure::ObjectFront => Some(depth(Side::Front)),
        Measure::ObjectSides => {
            let (left, right) = (depth(Side::Left), depth(Side::Right));
            Some(if a.is_one_sided() { left.max(right) } else { left.min(right) })
        }
        Measure::GapBetweenObjects => {
            let alike = |o: &&Object| o.kind.is_some_and(|k| rule.quantity.picks(k)) && o.placement != object.placement;
            let others = room.objects.iter().filter(alike);
            others.map(|o| o.rect.gap(&object.rect)).reduce(f64::min)
        }
        Measure::DockClearOfDoors => {
            let free = |d: &&Door| door_zones(d).iter().all(|zone| !zone.overlaps(&object.rect));
            Some(if room.doors.iter().all(free) { 1.0 } else { 0.0 })
        }
        Measure::DockNearEntrance => {
            let plan = &site.world.floorplan;
            let entered = |id: &String| plan.doors_of(id).any(|d| d.entrance);
            let next = room.doors.iter().flat_map(|d| &d.room_ids).any(entered);
            Some(if next { 1.0 } else { 0.0 })
        }
        Measure::DockAgainstWall => Some(if spacing::back_is_at_wall(room, object) { 1.0 } else { 0.0 }),
        Measure::DockInDryRoom => Some(if room.kind.wet { 0.0 } else { 1.0 }),
        _ => None,
    }
    .filter(|_| site.domain.object(&object.placement.object).is_some())
}
