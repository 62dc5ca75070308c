//! Rules about doors and passages.

use d3dgen_knowledge::clearance::DOOR_LANE_M;
use d3dgen_model::floorplan::{Door, DoorKind};
use d3dgen_model::measures::JAMB_M;
use d3dgen_model::{Rect, Segment, TOLERANCE_M};

use super::Findings;
use crate::context::{Context, ON_LINE_M, Room, shared, uncovered};
use crate::outline::Outline;

/// Narrowest opening, m.
const NARROWEST_M: f64 = 0.60;
/// Footprint that may reach into the floor a door needs, m^2.
const GRAZE_M2: f64 = 0.0025;
/// Robots pass a door with at least this much to spare on each side, m.
const ROBOT_SPARE_M: f64 = 0.0;

pub fn floating(c: &Context, out: &mut Findings) {
    for door in &c.plan().doors {
        out.look();
        let ends = door.room_ids.iter().filter_map(|id| c.room(id));
        let off = ends.map(|r| off_outline(&door.line, r)).fold(0.0, f64::max);
        if off > ON_LINE_M {
            out.add_figure(
                &door.door_id,
                format!("{off:.2} m of the door lie on no outline of its rooms"),
                off,
                0.0,
                "m",
            );
        }
        let crossed: f64 = c
            .plan()
            .walls
            .iter()
            .filter_map(|w| shared(&door.line, &w.line, ON_LINE_M))
            .map(|(from, to)| to - from)
            .sum();
        if crossed > 0.05 {
            out.add_figure(&door.door_id, format!("a wall closes {crossed:.2} m of the door"), crossed, 0.0, "m");
        }
    }
}

fn off_outline(line: &Segment, room: &Room) -> f64 {
    let edges: Vec<Segment> = room.plan.polygon.edges().collect();
    uncovered(line, edges.iter(), ON_LINE_M)
}

pub fn unlinked(c: &Context, out: &mut Findings) {
    for door in &c.plan().doors {
        out.look();
        let touches = |r: &&Room| off_outline(&door.line, r) < 0.2 * door.line.length();
        let mut touched: Vec<&str> = c.rooms.iter().filter(touches).map(|r| r.plan.room_id.as_str()).collect();
        let mut named: Vec<&str> = door.room_ids.iter().map(String::as_str).collect();
        touched.sort_unstable();
        named.sort_unstable();
        if touched.is_empty() || touched.len() > 2 || touched != named {
            let text = |ids: &[&str]| if ids.is_empty() { "nothing".to_owned() } else { ids.join(" and ") };
            out.add(&door.door_id, format!("the door touches {}, it should join {}", text(&touched), text(&named)));
        }
    }
}

pub fn narrow(c: &Context, out: &mut Findings) {
    for door in &c.plan().doors {
        out.look();
        let width = door.line.length();
        if width < NARROWEST_M - TOLERANCE_M {
            out.add_figure(&door.door_id, format!("the opening is {width:.2} m wide"), width, NARROWEST_M, "m");
        }
        if door.clear_width_m > width + TOLERANCE_M {
            out.add_figure(&door.door_id, "the clear width is more than the opening", door.clear_width_m, width, "m");
        }
    }
}

pub fn jamb(c: &Context, out: &mut Findings) {
    for door in c.plan().doors.iter().filter(|d| d.kind != DoorKind::Open) {
        out.look();
        let ends = door.room_ids.iter().filter_map(|id| c.room(id));
        let least = ends.filter_map(|r| to_corner(door, r)).reduce(f64::min);
        if let Some(least) = least
            && least < JAMB_M - TOLERANCE_M
        {
            out.add_figure(&door.door_id, format!("the door is {least:.2} m from a corner"), least, JAMB_M, "m");
        }
    }
}

/// Returns the distance of a door from the nearest end of the wall face it stands in, m.
fn to_corner(door: &Door, room: &Room) -> Option<f64> {
    let reach = door.wall_thickness_m / 2.0 + ON_LINE_M;
    let along = |s: &Segment| {
        let r = s.bounds();
        if door.line.is_vertical() { (r.y0, r.y1) } else { (r.x0, r.x1) }
    };
    let (d0, d1) = along(&door.line);
    let faces = room.plan.net_polygon.edges().filter(|e| shared(e, &door.line, reach).is_some());
    faces.map(|e| (along(&e), e)).map(|((e0, e1), _)| (d0 - e0).min(e1 - d1)).reduce(f64::max)
}

pub fn width(c: &Context, out: &mut Findings) {
    let robots = c.graph().robots.iter().map(|r| 2.0 * (r.planned_radius_m() + ROBOT_SPARE_M)).fold(0.0, f64::max);
    for door in &c.plan().doors {
        out.look();
        let (needed, why) = needed_width(c, door);
        let (needed, why) = if robots > needed { (robots, "the robots".to_owned()) } else { (needed, why) };
        if door.clear_width_m < needed - TOLERANCE_M {
            let message = format!("the door is {:.2} m wide, {why} needs {needed:.2} m", door.clear_width_m);
            out.add_figure(&door.door_id, message, door.clear_width_m, needed, "m");
        }
    }
}

/// Returns the clear width a door needs and who asks for it.
///
/// A door serves the room that hangs on the other one (an en suite, any room off the corridor); between two equal rooms
/// the lesser need counts.
fn needed_width(c: &Context, door: &Door) -> (f64, String) {
    let given = c.plan().is_given();
    let own = |room: &Room| -> (f64, String) {
        let limit = c.retrieval.limits.rooms.get(&room.plan.room_type).and_then(|l| l.door_width.as_ref());
        match limit {
            Some(l) if given || l.value > room.kind.door_width_m => (l.value, l.constraint_id.clone()),
            // what is usual here is no rule for doors that somebody else drew
            None if given => (NARROWEST_M, "a door".into()),
            _ => (room.kind.door_width_m, room.plan.room_type.clone()),
        }
    };
    let ends: Vec<&Room> = door.room_ids.iter().filter_map(|id| c.room(id)).collect();
    let hub = |r: &Room| r.plan.circulation || c.domain.circulation.hub_room_types.contains(&r.plan.room_type);
    let hangs_on = |a: &Room, b: &Room| a.kind.hosts.contains(&b.plan.room_type);
    match ends[..] {
        [_] if door.entrance => {
            let usual = c.domain.circulation.entrance_width_m(!c.retrieval.limits.no_beds);
            match &c.retrieval.limits.entrance_width {
                Some(l) if l.value > usual => (l.value, l.constraint_id.clone()),
                _ => (usual.min(door.line.length()), "the entrance".into()),
            }
        }
        [a, b] if hangs_on(a, b) => own(a),
        [a, b] if hangs_on(b, a) => own(b),
        [a, b] if hub(a) && !hub(b) => own(b),
        [a, b] if hub(b) && !hub(a) => own(a),
        [a, b] => {
            let (x, y) = (own(a), own(b));
            if x.0 <= y.0 { x } else { y }
        }
        _ => (NARROWEST_M, "a door".into()),
    }
}

pub fn blocked(c: &Context, out: &mut Findings) {
    for door in &c.plan().doors {
        out.look();
        let lane = sides(door, DOOR_LANE_M, 0.0);
        for object in c.objects.iter().filter(|o| o.blocks) {
            if lane.iter().map(|l| within_rooms(c, door, l, &object.outline)).sum::<f64>() > GRAZE_M2 {
                let id = &object.placement.placement_id;
                out.add(format!("{}|{id}", door.door_id), format!("`{id}` stands in front of the door"));
            }
        }
    }
}

/// Returns the area that an obstacle takes from a lane, counted within the rooms the door joins, m^2.
fn within_rooms(c: &Context, door: &Door, lane: &Rect, obstacle: &Outline) -> f64 {
    if lane.common_area(&obstacle.bounds) <= 0.0 {
        return 0.0;
    }
    let cut = |room: &Rect| Rect {
        x0: lane.x0.max(room.x0),
        y0: lane.y0.max(room.y0),
        x1: lane.x1.min(room.x1),
        y1: lane.y1.min(room.y1),
    };
    let rooms = door.room_ids.iter().filter_map(|id| c.room(id));
    let pieces = rooms.flat_map(|r| &r.rects).filter(|r| lane.overlaps(r)).map(cut);
    pieces.map(|piece| obstacle.area_in(&piece)).sum()
}

/// Returns the rectangles before and behind a door: from `skip` beside its center line, `depth` deep.
fn sides(door: &Door, depth: f64, skip: f64) -> [Rect; 2] {
    let r = door.line.bounds();
    if door.line.is_vertical() {
        [Rect { x0: r.x0 - skip - depth, x1: r.x0 - skip, ..r }, Rect { x0: r.x1 + skip, x1: r.x1 + skip + depth, ..r }]
    } else {
        [Rect { y0: r.y0 - skip - depth, y1: r.y0 - skip, ..r }, Rect { y0: r.y1 + skip, y1: r.y1 + skip + depth, ..r }]
    }
}

pub fn swing(c: &Context, out: &mut Findings) {
    for door in &c.plan().doors {
        let Some(swing) = &door.swing else { continue };
        out.look();
        let Some(into) = &swing.into_room_id else { continue };
        let Some(room) = c.room(into).filter(|_| door.room_ids.contains(into)) else {
            out.add(&door.door_id, format!("the leaf opens into `{into}`, which the door does not join"));
            continue;
        };
        let leaves = if door.kind == DoorKind::DoubleHinged { 2.0 } else { 1.0 };
        let squares = sides(door, door.line.length() / leaves, door.wall_thickness_m / 2.0);
        let inside = |s: &Rect| room.net.iter().map(|n| n.common_area(s)).sum::<f64>();
        let [a, b] = squares;
        let square = if inside(&a) >= inside(&b) { a } else { b };
        for object in c.objects_in(into).filter(|o| o.blocks) {
            if object.outline.area_in(&square) > GRAZE_M2 {
                let id = &object.placement.placement_id;
                out.add(format!("{}|{id}", door.door_id), format!("the leaf hits `{id}`"));
            }
        }
    }
}

pub fn entrance(c: &Context, out: &mut Findings) {
    out.look();
    let ways_out = c.plan().ways_out();
    if !ways_out.iter().any(|d| d.entrance) {
        out.add("building", "no door leads outdoors as the entrance");
    }
    for room in c.graph().rooms.iter().filter(|r| r.entrance) {
        out.look();
        if !ways_out.iter().any(|d| d.room_ids.contains(&room.id)) {
            out.add(&room.id, "one enters the building here, and the room has no door to the outside");
        }
    }
}
