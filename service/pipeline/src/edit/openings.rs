//! Doors and windows under edits: an opening slides along its wall, and the pieces of wall beside it give and take.

use d3dgen_model::floorplan::{Floorplan, Wall};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::stage::Error;
use d3dgen_model::{Point, Segment, slides};

use super::{mismatch, refused};
use crate::floorplan::highest;

/// Two points this near are one, m.
const SAME_M: f64 = 1e-3;

/// Moves a door or a window along its wall; returns the rooms at it.
///
/// # Errors
/// `Mismatch` when the plan has no such opening; `Refused` for one that is locked, that lines up with other storeys, or that would
/// leave its wall or stand in another opening.
pub(super) fn slide(plan: &mut Floorplan, opening_id: &str, by_m: f64) -> Result<Vec<String>, Error> {
    if let Some(at) = plan.doors.iter().position(|d| d.door_id == opening_id) {
        return slide_door(plan, at, by_m);
    }
    let at = plan.windows.iter().position(|w| w.window_id == opening_id);
    let at = at.ok_or_else(|| mismatch(format!("the world has no door or window `{opening_id}`")))?;
    slide_window(plan, at, by_m)
}

fn slide_window(plan: &mut Floorplan, at: usize, by_m: f64) -> Result<Vec<String>, Error> {
    let window = &plan.windows[at];
    let axis = Axis::of(&window.line);
    free(&window.window_id, window.locked, by_m)?;
    let line = axis.slid(&window.line, by_m);
    let (from, to) = axis.span(&line);
    let holds = |wall: &&Wall| {
        let (low, high) = axis.span(&wall.line);
        axis.holds(&wall.line) && wall.room_ids.contains(&window.room_id) && low - SAME_M <= from && to <= high + SAME_M
    };
    if !plan.walls.iter().any(|wall| holds(&wall)) {
        return Err(refused(format!("`{}` would leave its wall", window.window_id)));
    }
    apart(plan, &axis, &window.window_id, (from, to), window.room_id.as_str())?;
    let room_id = window.room_id.clone();
    plan.windows[at].line = line;
    Ok(vec![room_id])
}

fn slide_door(plan: &mut Floorplan, at: usize, by_m: f64) -> Result<Vec<String>, Error> {
    let door = plan.doors[at].clone();
    let axis = Axis::of(&door.line);
    free(&door.door_id, door.locked, by_m)?;
    if plan.links.iter().any(|l| l.room_ids.iter().any(|id| door.room_ids.contains(id))) {
        return Err(refused(format!("`{}` lines up with the doors of other storeys", door.door_id)));
    }
    let (from, to) = axis.span(&door.line);
    let line = axis.slid(&door.line, by_m);
    let (new_from, new_to) = axis.span(&line);
    let beside = |end: f64, high: bool| {
        plan.walls.iter().position(|w| {
            let (low_end, high_end) = axis.span(&w.line);
            let touching = if high { high_end } else { low_end };
            axis.holds(&w.line) && (touching - end).abs() < SAME_M && same_rooms(&w.room_ids, &door.room_ids)
        })
    };
    let (before, after) = (beside(from, true), beside(to, false));
    let giving = if by_m < 0.0 { before } else { after };
    // the piece of wall that it moves into, and what it leaves free
    let reach = giving.map(|i| axis.span(&plan.walls[i].line)).map(|(low, high)| (low.min(from), high.max(to)));
    let stays = |(low, high): (f64, f64)| low - SAME_M <= new_from && new_to <= high + SAME_M;
    if !reach.is_some_and(stays) {
        return Err(refused(format!("`{}` would leave its wall", door.door_id)));
    }
    for room in &door.room_ids {
        apart(plan, &axis, &door.door_id, (new_from, new_to), room)?;
    }
    if let Some(i) = giving.filter(|i| plan.walls[*i].locked) {
        return Err(refused(format!("`{}` is locked; unlock it first", plan.walls[i].wall_id)));
    }
    for (piece, old, new) in [(before, from, new_from), (after, to, new_to)] {
        match piece {
            Some(i) => move_end(&mut plan.walls[i], &axis, old, axis.at(new)),
            None if (new - old).abs() > SAME_M => {
                let wall = Wall {
                    wall_id: format!("wall_{}", 1 + highest(plan.walls.iter().map(|w| w.wall_id.as_str()))),
                    line: Segment { start: axis.at(old.min(new)), end: axis.at(old.max(new)) },
                    thickness_m: door.wall_thickness_m,
                    room_ids: door.room_ids.clone(),
                    exterior: door.room_ids.len() < 2,
                    locked: false,
                };
                plan.walls.push(wall);
            }
            None => {}
        }
    }
    plan.walls.retain(|w| w.line.length() > SAME_M);
    plan.doors[at].line = line;
    slides::aim(&mut plan.doors, &plan.walls);
    Ok(door.room_ids)
}

/// Refuses to move what is locked, and not at all.
fn free(id: &str, locked: bool, by_m: f64) -> Result<(), Error> {
    if locked {
        return Err(refused(format!("`{id}` is locked; unlock it first")));
    }
    if by_m.abs() < SAME_M {
        return Err(refused(format!("`{id}` is to move by less than 1 mm")));
    }
    Ok(())
}

/// Refuses a place in which another opening of the same wall is.
fn apart(plan: &Floorplan, axis: &Axis, id: &str, (from, to): (f64, f64), room: &str) -> Result<(), Error> {
    let doors = plan.doors.iter().filter(|d| d.room_ids.iter().any(|r| r == room)).map(|d| (&d.door_id, &d.line));
    let windows = plan.windows.iter().filter(|w| w.room_id == room).map(|w| (&w.window_id, &w.line));
    let meets = |line: &Segment| {
        let (low, high) = axis.span(line);
        axis.holds(line) && low < to - SAME_M && from + SAME_M < high
    };
    match doors.chain(windows).find(|(other, line)| *other != id && meets(line)) {
        Some((other, _)) => Err(refused(format!("`{id}` would stand in `{other}`"))),
        None => Ok(()),
    }
}

fn same_rooms(a: &[String], b: &[String]) -> bool {
    a.len() == b.len() && a.iter().all(|id| b.contains(id))
}

/// Moves the end of a wall that is at `old` along its line.
fn move_end(wall: &mut Wall, axis: &Axis, old: f64, new: Point) {
    let off = |p: Point| (axis.along(p) - old).abs();
    if off(wall.line.start) < off(wall.line.end) {
        wall.line.start = new;
    } else {
        wall.line.end = new;
    }
}

/// The line that a wall runs on, pointing to the east, or to the north where it runs north-south.
struct Axis {
    origin: Point,
    east: f64,
    north: f64,
}

impl Axis {
    fn of(line: &Segment) -> Self {
        let length = line.length().max(f64::MIN_POSITIVE);
        let (dx, dy) = ((line.end.x - line.start.x) / length, (line.end.y - line.start.y) / length);
        let sign = if dx > SAME_M || dx.abs() <= SAME_M && dy > 0.0 { 1.0 } else { -1.0 };
        Self { origin: line.start, east: sign * dx, north: sign * dy }
    }

    /// Distance of a point from the origin along the line, m.
    fn along(&self, p: Point) -> f64 {
        (p.x - self.origin.x) * self.east + (p.y - self.origin.y) * self.north
    }

    /// Point of the line at a distance from the origin.
    fn at(&self, along: f64) -> Point {
        Point::new(to_mm(self.origin.x + along * self.east), to_mm(self.origin.y + along * self.north))
    }

    /// Ends of a piece of the line in order, m from the origin.
    fn span(&self, line: &Segment) -> (f64, f64) {
        let (a, b) = (self.along(line.start), self.along(line.end));
        (a.min(b), a.max(b))
    }

    /// True for a piece of this line.
    fn holds(&self, line: &Segment) -> bool {
        let off = |p: Point| ((p.x - self.origin.x) * self.north - (p.y - self.origin.y) * self.east).abs();
        off(line.start) < 2.0 * SAME_M && off(line.end) < 2.0 * SAME_M
    }

    fn slid(&self, line: &Segment, by_m: f64) -> Segment {
        let by = |p: Point| self.at(self.along(p) + by_m);
        Segment { start: by(line.start), end: by(line.end) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(a: (f64, f64), b: (f64, f64)) -> Segment {
        Segment { start: Point::new(a.0, a.1), end: Point::new(b.0, b.1) }
    }

    /// Two rooms with a slanted wall of 5 m between them, its door from 1 to 2 m, a second piece after it.
    fn slanted() -> Floorplan {
        let at = |t: f64| (0.6 * t, 0.8 * t);
        let wall = |id: &str, a: f64, b: f64| serde_json::json!({"wall_id": id, "line": line(at(a), at(b)), "thickness_m": 0.1, "room_ids": ["a_1", "b_1"], "exterior": false});
        let door = serde_json::json!({"door_id": "door_1", "kind": "hinged", "line": line(at(1.0), at(2.0)), "clear_width_m": 0.9,
            "height_m": 2.0, "wall_thickness_m": 0.1, "room_ids": ["a_1", "b_1"], "swing": {"into_room_id": "a_1", "hinge_at_start": true}});
        serde_json::from_value(
            serde_json::json!({"version": 1, "seed": 0, "scheme": "", "rooms": [], "doors": [door], "windows": [],
            "walls": [wall("wall_1", 0.0, 1.0), wall("wall_2", 2.0, 5.0)], "cost": []}),
        )
        .expect("a plan")
    }

    #[test]
    fn a_door_slides_as_far_as_its_wall_and_leaves_wall_behind() {
        let mut plan = slanted();
        assert_eq!(slide(&mut plan, "door_1", 2.0).unwrap(), ["a_1", "b_1"]);
        let lengths = |plan: &Floorplan| plan.walls.iter().map(|w| to_mm(w.line.length())).collect::<Vec<_>>();
        assert_eq!(lengths(&plan), [3.0, 1.0]);
        assert_eq!(plan.doors[0].line, line((1.8, 2.4), (2.4, 3.2)));
        // to the very end and back: the piece that was used up comes again
        slide(&mut plan, "door_1", 1.0).unwrap();
        assert_eq!(lengths(&plan), [4.0]);
        slide(&mut plan, "door_1", -0.5).unwrap();
        assert_eq!(lengths(&plan), [3.5, 0.5]);
        assert!(slide(&mut plan, "door_1", 1.0).unwrap_err().to_string().contains("would leave its wall"));
        assert!(slide(&mut plan, "door_1", -4.0).unwrap_err().to_string().contains("would leave its wall"));
        assert!(slide(&mut plan, "door_9", 1.0).unwrap_err().to_string().contains("no door or window `door_9`"));
    }
}
