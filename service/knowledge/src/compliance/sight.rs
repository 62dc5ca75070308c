//! What is seen from where somebody works: straight lines past walls and closed doors, through openings.

use d3dgen_model::domain::Shape;
use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::{Point, Segment};

use super::site::{Room, Site};
use crate::compliance::reading::Reading;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Farthest that a station watches, m (practice: 20 m from a nurse station to the last bed).
const FARTHEST_M: f64 = 20.0;
/// How far before a door stands what one sees of it, m: beside the thickest inner wall.
const BEFORE_DOOR_M: f64 = 0.15;
/// How far from the middle of a counter those at it stand or sit, m.
const AT_COUNTER_M: f64 = 0.7;

/// Reads for each room the constraint is about whether somebody at work there sees a bed, or the door of a room with one.
pub(super) fn read(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    if rule.quantity.measure != Measure::SeesBeds {
        return Vec::new();
    }
    let marks: Vec<Point> = site.rooms.iter().filter(|r| r.beds() > 0).flat_map(marks).collect();
    if marks.is_empty() {
        return Vec::new();
    }
    let plan = &site.world.floorplan;
    let closed = plan.doors.iter().filter(|d| d.kind != DoorKind::Open).map(|d| d.line);
    let lines: Vec<Segment> = plan.walls.iter().map(|w| w.line).chain(closed).collect();
    let watches = |room: &Room| {
        eyes(room)
            .into_iter()
            .any(|eye| marks.iter().any(|mark| eye.distance(*mark) <= FARTHEST_M && sees(&lines, eye, *mark)))
    };
    site.rooms_of(a).map(|room| Reading::flag(&room.plan.room_id, watches(room))).collect()
}

/// Returns what one looks for of a room with beds: these, and both sides of its doors.
fn marks(room: &Room) -> Vec<Point> {
    let beds = room.objects.iter().filter(|o| o.is(&[Shape::Bed, Shape::HospitalBed])).map(|o| o.rect.center());
    let doors = room.doors.iter().flat_map(|d| {
        let (at, off) = (d.line.middle(), BEFORE_DOOR_M);
        let (dx, dy) = if d.line.is_vertical() { (off, 0.0) } else { (0.0, off) };
        [Point::new(at.x - dx, at.y - dy), Point::new(at.x + dx, at.y + dy)]
    });
    beds.chain(doors).collect()
}

/// Returns where people at work in a room have their eyes: at its seats, and before and behind its counters.
fn eyes(room: &Room) -> Vec<Point> {
    let seats = room.objects.iter().filter(|o| o.is(&[Shape::SwivelChair, Shape::Stool])).map(|o| o.rect.center());
    let counters = room.objects.iter().filter(|o| o.is(&[Shape::Counter])).flat_map(|o| {
        let (at, (sin, cos)) = (o.rect.center(), o.placement.pose.yaw_rad.sin_cos());
        [AT_COUNTER_M, -AT_COUNTER_M].map(|d| Point::new(at.x + d * cos, at.y + d * sin))
    });
    let inside = |p: &Point| room.plan.polygon.contains(*p);
    seats.chain(counters).filter(inside).collect()
}

/// Returns true when none of the lines, which run along x or y, is between two points.
fn sees(lines: &[Segment], from: Point, to: Point) -> bool {
    !lines.iter().any(|line| {
        let (at, low, high) = line.span();
        let turned = |p: Point| if line.is_vertical() { (p.x, p.y) } else { (p.y, p.x) };
        let ((a, s), (b, t)) = (turned(from), turned(to));
        let share = (at - a) / (b - a);
        let crossing = s + share * (t - s);
        (a - at) * (b - at) < 0.0 && low < crossing && crossing < high
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sees_past_a_wall_but_not_through_it() {
        let wall = [Segment { start: Point::new(2.0, 0.0), end: Point::new(2.0, 3.0) }];
        let eye = Point::new(0.0, 1.0);
        assert!(!sees(&wall, eye, Point::new(4.0, 1.0)));
        // past its end, and on this side of it
        assert!(sees(&wall, eye, Point::new(4.0, 6.0)));
        assert!(sees(&wall, eye, Point::new(1.9, 2.9)));
        // an opening in it
        let parts =
            [(0.0, 0.5), (1.5, 3.0)].map(|(a, b)| Segment { start: Point::new(2.0, a), end: Point::new(2.0, b) });
        assert!(sees(&parts, eye, Point::new(4.0, 1.0)));
        assert!(!sees(&parts, eye, Point::new(4.0, 3.0)));
    }
}
