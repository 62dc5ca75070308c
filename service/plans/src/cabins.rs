//! Cars of lifts that a file names beside its walls: each becomes a room on every storey where it stops.
//!
//! Most plans draw the shaft around a car, or some of its walls; where one is missing, the side of the car is a wall.

use d3dgen_model::{Point, Polygon, Rect};

use crate::drawing::{Drawing, DrawnFloor, DrawnOpening, DrawnWall, OpeningKind, note};
use crate::layout::LaidRoom;
use crate::words;

/// Farthest that a wall of the shaft stands outside of a side of the car, and inside of it, m.
const OUTSIDE_M: f64 = 0.5;
const INSIDE_M: f64 = 0.2;
/// A car whose sides lean by more than this, rise over run, stands at an angle.
const LEAN: f64 = 0.1;
/// Share of a side that the wall before it has at least.
const COVERED: f64 = 0.6;
/// A room is the shaft of a car when it is at most so many times as large.
const LARGEST: f64 = 3.0;

/// Puts floor under the cars of a storey, walls where their shafts lack some, and their doors; leaves out cars that stand at an
/// angle.
pub(crate) fn enclose(drawing: &mut Drawing) {
    for cabin in std::mem::take(&mut drawing.cabins) {
        let [a, b, ..] = cabin.corners;
        let (dx, dy) = ((a.x - b.x).abs(), (a.y - b.y).abs());
        if dx.min(dy) > LEAN * dx.max(dy) {
            let message = format!("lift {} stands at an angle to the walls; it was left out", cabin.name);
            drawing.notes.push(note("lift_left_out", message));
            continue;
        }
        let place = format!("lift {}", cabin.name);
        let (shaft, missing) = shaft(Polygon(cabin.corners.to_vec()).bounds(), &drawing.walls);
        for line in missing {
            drawing.walls.push(DrawnWall { line, level: cabin.level.clone(), place: place.clone() });
        }
        if !drawing.floors.is_empty() {
            let corners = shaft.corners().to_vec();
            drawing.floors.push(DrawnFloor { corners, hole: false, level: cabin.level.clone() });
        }
        for door in &cabin.doors {
            let kind = OpeningKind::Door;
            let door = DrawnOpening::new(kind, door.to_vec(), cabin.level.clone(), format!("door of {place}"));
            drawing.openings.push(DrawnOpening { sliding: true, ..door });
        }
        drawing.cabins.push(cabin);
    }
}

/// Marks the rooms that cars stand in, and notes the cars that have none to themselves.
pub(crate) fn mark(rooms: &mut [LaidRoom], drawing: &mut Drawing) {
    for cabin in &drawing.cabins {
        let car = Polygon(cabin.corners.to_vec());
        let middle = car.bounds().center();
        let around = rooms.iter_mut().find(|r| r.polygon.contains(middle));
        match around.filter(|r| r.polygon.area() <= LARGEST * car.area()) {
            Some(room) => {
                room.kind = Some(words::car().to_owned());
                room.label.clone_from(&cabin.name);
            }
            None => {
                let message = format!("lift {} has no shaft to itself; it was left out", cabin.name);
                drawing.notes.push(note("lift_left_out", message));
            }
        }
    }
}

/// Returns a car grown to the walls that stand beside its sides, and its sides without one.
fn shaft(car: Rect, walls: &[DrawnWall]) -> (Rect, Vec<[Point; 2]>) {
    let x = |p: &Point| p.x;
    let y = |p: &Point| p.y;
    let west = wall_beside(walls, (x, -car.x0, -1.0), (y, car.y0, car.y1));
    let east = wall_beside(walls, (x, car.x1, 1.0), (y, car.y0, car.y1));
    let south = wall_beside(walls, (y, -car.y0, -1.0), (x, car.x0, car.x1));
    let north = wall_beside(walls, (y, car.y1, 1.0), (x, car.x0, car.x1));
    let shaft = Rect {
        x0: west.unwrap_or(car.x0),
        x1: east.unwrap_or(car.x1),
        y0: south.unwrap_or(car.y0),
        y1: north.unwrap_or(car.y1),
    };
    let [sw, se, ne, nw] = shaft.corners();
    let sides = [(south, [sw, se]), (east, [se, ne]), (north, [ne, nw]), (west, [nw, sw])];
    (shaft, sides.into_iter().filter(|(wall, _)| wall.is_none()).map(|(_, side)| side).collect())
}

/// Returns where the walls are that run along most of a side: across it by `(coordinate, side, outwards)`, along it by
/// `(coordinate, from, to)`; the side is counted outwards too.
fn wall_beside(
    walls: &[DrawnWall],
    (across, side, outwards): (fn(&Point) -> f64, f64, f64),
    (along, from, to): (fn(&Point) -> f64, f64, f64),
) -> Option<f64> {
    let near = |p: &Point| (-INSIDE_M..=OUTSIDE_M).contains(&(across(p) * outwards - side));
    let (mut length, mut sum) = (0.0, 0.0);
    for [a, b] in walls.iter().map(|w| &w.line).filter(|line| line.iter().all(near)) {
        let common = along(a).max(along(b)).min(to) - along(a).min(along(b)).max(from);
        if common > 0.0 {
            length += common;
            sum += common * (across(a) + across(b)) / 2.0;
        }
    }
    (length >= COVERED * (to - from)).then(|| sum / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_car_grows_to_its_shaft_and_gets_the_walls_that_are_missing() {
        let wall = |x0: f64, y0: f64, x1: f64, y1: f64| DrawnWall {
            line: [Point::new(x0, y0), Point::new(x1, y1)],
            level: None,
            place: String::new(),
        };
        let car = Rect::new(1.0, 1.0, 3.0, 3.0);
        let around = [wall(0.8, 0.0, 0.8, 4.0), wall(0.0, 0.7, 9.0, 0.7), wall(3.3, 4.0, 3.3, 0.0)];
        let (grown, missing) = shaft(car, &around);
        assert_eq!((grown.x0, grown.y0, grown.x1, grown.y1), (0.8, 0.7, 3.3, 3.0));
        assert_eq!(missing, [[Point::new(3.3, 3.0), Point::new(0.8, 3.0)]]);
        // a wall that passes by elsewhere, and one too far off, are none of its
        let (grown, missing) = shaft(car, &[wall(0.0, 0.9, 1.5, 0.9), wall(0.2, 0.0, 0.2, 4.0)]);
        assert_eq!((grown, missing.len()), (car, 4));
    }
}
