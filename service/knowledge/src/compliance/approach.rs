//! Room to open a door: free floor before it and wall beside its latch, on both sides.

use d3dgen_model::Rect;
use d3dgen_model::floorplan::{Door, DoorKind};

use super::site::{Room, Site};
use crate::clearance::depth_beside;
use crate::compliance::reading::Reading;
use crate::measure::Measure;

/// Depth of the wall strip beside a latch that must be free to reach the handle, m.
const REACH_M: f64 = 0.30;
/// Depth that is left out of the look ahead, m.
const STEP_M: f64 = 0.05;

/// Reads the room to open each hinged door of one leaf.
pub(super) fn read(site: &Site, measure: Measure, concerns: impl Fn(&Door) -> bool) -> Vec<Reading> {
    let pull = matches!(measure, Measure::DoorPullDepth | Measure::LatchPullSide);
    let beside_latch = matches!(measure, Measure::LatchPullSide | Measure::LatchPushSide);
    let mut out = Vec::new();
    for room in &site.rooms {
        for door in room.doors.iter().filter(|d| d.kind == DoorKind::Hinged && concerns(d)) {
            let Some(swing) = &door.swing else { continue };
            let opens_here = swing.into_room_id.as_ref() == Some(&room.plan.room_id);
            if measure != Measure::DoorLanding && opens_here != pull {
                continue;
            }
            let Some((face, ahead)) = face(room, door) else { continue };
            // a step beyond the wall face, which would else stand in its own way
            let ahead_of = stepped(&face, ahead);
            let value = if beside_latch {
                beside(room, door, &face, ahead, swing.hinge_at_start)
            } else {
                depth_beside(&ahead_of, ahead, &room.plan.net_polygon, room.taken()) + STEP_M
            };
            out.push(Reading::new(&door.door_id, value));
        }
    }
    out
}

/// Returns a rectangle grown by a step towards a quarter turn.
fn stepped(r: &Rect, ahead: u8) -> Rect {
    match ahead {
        0 => Rect { x1: r.x1 + STEP_M, ..*r },
        1 => Rect { y1: r.y1 + STEP_M, ..*r },
        2 => Rect { x0: r.x0 - STEP_M, ..*r },
        _ => Rect { y0: r.y0 - STEP_M, ..*r },
    }
}

/// Returns the opening through its wall, and the quarter turn that leads from it into the room.
fn face(room: &Room, door: &Door) -> Option<(Rect, u8)> {
    let (a, b, half) = (door.line.start, door.line.end, door.wall_thickness_m / 2.0);
    let line = Rect::new(a.x, a.y, b.x, b.y);
    let opening = if door.line.is_vertical() {
        Rect { x0: line.x0 - half, x1: line.x1 + half, ..line }
    } else {
        Rect { y0: line.y0 - half, y1: line.y1 + half, ..line }
    };
    let middle = opening.center();
    let turns: [u8; 2] = if door.line.is_vertical() { [0, 2] } else { [1, 3] };
    let inside = |turn: &u8| {
        let step = half + REACH_M / 2.0;
        let (dx, dy) = [(step, 0.0), (0.0, step), (-step, 0.0), (0.0, -step)][usize::from(turn % 4)];
        let holds =
            |r: &Rect| r.x0 < middle.x + dx && middle.x + dx < r.x1 && r.y0 < middle.y + dy && middle.y + dy < r.y1;
        room.plan.net_polygon.rects().iter().any(holds)
    };
    turns.into_iter().find(inside).map(|turn| (opening, turn))
}

/// Returns the free wall beyond the latch, m.
fn beside(room: &Room, door: &Door, face: &Rect, ahead: u8, hinge_at_start: bool) -> f64 {
    // a strip on the room's floor along the opening
    let strip = match ahead {
        0 => Rect { x0: face.x1, x1: face.x1 + REACH_M, ..*face },
        2 => Rect { x0: face.x0 - REACH_M, x1: face.x0, ..*face },
        1 => Rect { y0: face.y1, y1: face.y1 + REACH_M, ..*face },
        _ => Rect { y0: face.y0 - REACH_M, y1: face.y0, ..*face },
    };
    let (hinge, latch) =
        if hinge_at_start { (door.line.start, door.line.end) } else { (door.line.end, door.line.start) };
    let towards = match (door.line.is_vertical(), latch.x > hinge.x, latch.y > hinge.y) {
        (true, _, true) => 1,
        (true, _, false) => 3,
        (false, true, _) => 0,
        (false, false, _) => 2,
    };
    depth_beside(&strip, towards, &room.plan.net_polygon, room.taken())
}
