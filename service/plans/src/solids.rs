//! Columns and walls that stand free: each becomes an obstacle of the room it stands in.

use d3dgen_model::scene_graph::Note;
use d3dgen_model::{Polygon, Rect};

use crate::drawing::{Drawing, DrawnSolid, SolidKind, note};
use crate::layout::{LaidObstacle, LaidRoom};
use crate::shape::{area, common, share_inside};

/// Least floor that an obstacle takes, m^2; less is the rest of something that stands in a wall.
const LEAST_M2: f64 = 0.005;
/// A column larger than this is a part of the building that somebody drew on such a layer, m^2.
const LARGEST_COLUMN_M2: f64 = 9.0;
/// Two obstacles are one where so much of the smaller lies in the other: a column drawn by outline and hatch.
const SAME: f64 = 0.8;

/// Returns the obstacles of rooms, each cut off at the faces of walls; notes say how many there are, and what stands in no room.
pub(crate) fn stand(drawing: &Drawing, rooms: &[LaidRoom], notes: &mut Vec<Note>) -> Vec<LaidObstacle> {
    let mut out: Vec<LaidObstacle> = Vec::new();
    let mut outside = 0_usize;
    for solid in once(&drawing.solids) {
        let before = out.len();
        for (room, laid) in rooms.iter().enumerate() {
            if !bounds_of(solid).overlaps(&laid.net_polygon.bounds()) {
                continue;
            }
            let pieces = common(&solid.outline, laid.net_polygon.corners());
            let kept = pieces.into_iter().filter(|p| p.area() >= LEAST_M2);
            out.extend(kept.map(|outline| LaidObstacle { kind: solid.kind, outline, room }));
        }
        outside += usize::from(out.len() == before);
    }
    tell(&out, outside, notes);
    out
}

/// Returns what stands somewhere once, the larger one of what lies in each other.
fn once(solids: &[DrawnSolid]) -> Vec<&DrawnSolid> {
    let mut order: Vec<(f64, &DrawnSolid)> = solids.iter().map(|s| (area(&s.outline), s)).collect();
    order.retain(|(area, s)| *area >= LEAST_M2 && (s.kind == SolidKind::Wall || *area <= LARGEST_COLUMN_M2));
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<&DrawnSolid> = Vec::new();
    for (_, solid) in order {
        let own = bounds_of(solid);
        let is_same = |k: &&DrawnSolid| bounds_of(k).overlaps(&own) && share_inside(&solid.outline, &k.outline) >= SAME;
        if !kept.iter().any(is_same) {
            kept.push(solid);
        }
    }
    kept
}

fn bounds_of(solid: &DrawnSolid) -> Rect {
    Polygon(solid.outline.clone()).bounds()
}

fn tell(obstacles: &[LaidObstacle], outside: usize, notes: &mut Vec<Note>) {
    let count = |kind: SolidKind| obstacles.iter().filter(|o| o.kind == kind).count();
    let (columns, walls) = (count(SolidKind::Column), count(SolidKind::Wall));
    if columns + walls > 0 {
        let message = format!(
            "{columns} columns and {walls} pieces of wall that bound no room stand in rooms; nothing is put there, and ways lead \
             around them"
        );
        notes.push(note("obstacles", message));
    }
    if outside > 0 {
        let message =
            format!("{outside} columns and pieces of wall stand in walls or outside of all rooms; they were left out");
        notes.push(note("obstacles_left_out", message));
    }
}
