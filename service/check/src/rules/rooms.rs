//! Rules about the size and shape of rooms.

use d3dgen_knowledge::Limit;
use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::TOLERANCE_M;
use d3dgen_model::domain::Zone;
use d3dgen_model::measures::MOST_ELONGATED;

use super::Findings;
use crate::context::{Context, Room};

/// Share of an area that rounding to the wall lattice may take or add.
const AREA_SLACK: f64 = 0.01;
/// How far a building rule may push an area beyond what was asked for.
const RAISED_BY_RULE: f64 = 1.25;

/// Returns true for a room that is smaller than its type needs, by the domain and the building rules.
pub(crate) fn is_cramped(c: &Context, room: &Room) -> bool {
    let asked = c.graph().room(&room.plan.room_id).map_or(room.kind.area_m2.min, |r| r.area_range_m2[0]);
    room.plan.net_area_m2 < least_area(c, room, asked).0 * (1.0 - AREA_SLACK)
        || !room.plan.circulation && side(room) < least_side(c, room) - TOLERANCE_M
}

/// Returns the least area of a room, m^2, and the building rule that has a say in it.
fn least_area<'c>(c: &'c Context, room: &Room, asked: f64) -> (f64, Option<&'c Limit>) {
    let limit = c.retrieval.limits.rooms.get(&room.plan.room_type).and_then(|l| l.area_min.as_ref());
    (limit.map_or(asked, |l| l.value.max(asked)), limit)
}

/// Returns the least clear extent of a room, m.
fn least_side(c: &Context, room: &Room) -> f64 {
    let limit = c.retrieval.limits.rooms.get(&room.plan.room_type).and_then(|l| l.dimension_min.as_ref());
    limit.map_or(room.kind.min_dimension_m, |l| l.value.max(room.kind.min_dimension_m))
}

/// Returns the clear extent of a room with nothing in it, m.
fn side(room: &Room) -> f64 {
    FreeSpace::new(&room.plan.net_polygon, &[]).largest_square()
}

pub fn area(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        let Some(asked) = c.graph().room(&room.plan.room_id) else { continue };
        let (low, limit) = least_area(c, room, asked.area_range_m2[0]);
        let high = asked.area_range_m2[1].max(low * RAISED_BY_RULE);
        out.look();
        let area = room.plan.net_area_m2;
        if area < low * (1.0 - AREA_SLACK) {
            let why = limit.filter(|l| l.value >= low).map_or(String::new(), |l| format!(", by {}", l.constraint_id));
            out.add_figure(&room.plan.room_id, format!("has {area:.2} m2, needs {low:.2} m2{why}"), area, low, "m^2");
        }
        // circulation is as large as the way it has to go
        if area > high * (1.0 + AREA_SLACK) && !room.plan.circulation {
            let message = format!("has {area:.2} m2, at most {high:.2} m2 were asked for");
            out.add_figure(&room.plan.room_id, message, area, high, "m^2");
        }
    }
}

pub fn dimension(c: &Context, out: &mut Findings) {
    for room in c.rooms.iter().filter(|r| !r.plan.circulation) {
        out.look();
        let (side, least) = (side(room), least_side(c, room));
        if side < least - TOLERANCE_M {
            out.add_figure(&room.plan.room_id, format!("is {side:.2} m wide, needs {least:.2} m"), side, least, "m");
        }
    }
}

pub fn proportion(c: &Context, out: &mut Findings) {
    for room in c.rooms.iter().filter(|r| !r.plan.circulation && r.kind.zone != Zone::Circulation) {
        out.look();
        let ratio = FreeSpace::new(&room.plan.net_polygon, &[]).proportion();
        if ratio > MOST_ELONGATED + TOLERANCE_M {
            out.add_figure(
                &room.plan.room_id,
                format!("is {ratio:.2} times as long as wide"),
                ratio,
                MOST_ELONGATED,
                "ratio",
            );
        }
    }
}

pub fn height(c: &Context, out: &mut Findings) {
    for room in &c.rooms {
        let limit = c.retrieval.limits.rooms.get(&room.plan.room_type).and_then(|l| l.ceiling_height_min.as_ref());
        let Some(limit) = limit else { continue };
        out.look();
        let height = room.plan.ceiling_height_m;
        if height < limit.value - TOLERANCE_M {
            let message = format!("is {height:.2} m high, needs {:.2} m, by {}", limit.value, limit.constraint_id);
            out.add_figure(&room.plan.room_id, message, height, limit.value, "m");
        }
    }
}
