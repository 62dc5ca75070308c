//! Rules about walls.

use d3dgen_model::Segment;

use super::Findings;
use crate::context::{Context, ON_LINE_M, uncovered};

/// Gap in a wall that is no passage, m.
const GAP_M: f64 = 0.10;
/// Length of a wall that may lie off every outline, m.
const STRAY_M: f64 = 0.05;

pub fn gap(c: &Context, out: &mut Findings) {
    let plan = c.plan();
    for room in &c.rooms {
        let bare: f64 = room
            .plan
            .polygon
            .edges()
            .map(|edge| {
                let walls = plan.walls.iter().map(|w| &w.line);
                let doors = plan.doors.iter().map(|d| &d.line);
                uncovered(&edge, walls.chain(doors), ON_LINE_M)
            })
            .filter(|length| *length > ON_LINE_M)
            .sum();
        out.look();
        if bare > GAP_M {
            out.add_figure(&room.plan.room_id, format!("{bare:.2} m of the outline have no wall"), bare, GAP_M, "m");
        }
    }
}

pub fn stray(c: &Context, out: &mut Findings) {
    for wall in &c.plan().walls {
        out.look();
        let off = |edges: &[Segment]| uncovered(&wall.line, edges.iter(), ON_LINE_M);
        let mut far = off(&c.rooms.iter().flat_map(|r| r.plan.polygon.edges()).collect::<Vec<_>>());
        for room in wall.room_ids.iter().filter_map(|id| c.room(id)) {
            far = far.max(off(&room.plan.polygon.edges().collect::<Vec<_>>()));
        }
        if far > STRAY_M {
            out.add_figure(
                &wall.wall_id,
                format!("{far:.2} m of the wall lie on no outline of its rooms"),
                far,
                STRAY_M,
                "m",
            );
        }
        if wall.exterior != (wall.room_ids.len() == 1) {
            out.add(&wall.wall_id, "an outer wall has one room, an inner wall two");
        }
    }
}
