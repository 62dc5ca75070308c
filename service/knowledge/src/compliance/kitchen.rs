//! Kitchens: worktop beside appliances, and what stands or passes between sink, stove and refrigerator.

use d3dgen_model::domain::Shape;
use d3dgen_model::{Point, Rect};

use super::site::{Object, Room, Site};
use crate::clearance::quarter;
use crate::compliance::reading::Reading;
use crate::compliance::site::belong_together;
use crate::freespace::FreeSpace;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Heights of tops that something can be put on while cooking, m.
const WORKTOP_M: [f64; 2] = [0.75, 1.05];
/// Gap up to which worktops are one, m.
const JOINT_M: f64 = 0.05;
/// Width of a person who passes, m.
const PASSER_M: f64 = 0.6;
/// Slices that a triangle is cut into, to block its floor.
const SLICES: usize = 16;

/// Reads a quantity of the triangle from the front of the sink to that of the stove and of the refrigerator.
pub(super) fn triangles(site: &Site, a: &Applicable, rule: &Rule) -> Vec<Reading> {
    let mut out = Vec::new();
    for room in site.rooms_of(a) {
        let first = |fits: &dyn Fn(&Object) -> bool| room.objects.iter().find(|o| fits(o));
        let sink = first(&|o| o.is(&[Shape::Sink]));
        let stove = first(&|o| o.is(&[Shape::Stove]));
        let cold = first(&|o| rule.quantity.objects.contains(&o.placement.object));
        let (Some(sink), Some(stove), Some(cold)) = (sink, stove, cold) else { continue };
        let corners = [sink, stove, cold].map(front);
        let legs = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j]));
        let id = &room.plan.room_id;
        match rule.quantity.measure {
            Measure::WorkTriangleTotal => out.push(Reading::new(id, legs.iter().map(|(p, q)| p.distance(*q)).sum())),
            Measure::WorkTriangleLeg => out.extend(legs.map(|(p, q)| Reading::new(id, p.distance(q)))),
            Measure::TriangleIntrusion => {
                let ends = |o: &&Object| [sink, stove, cold].iter().any(|e| e.placement == o.placement);
                let between = room.objects.iter().filter(|o| o.blocks && !ends(o));
                let inside = between.flat_map(|o| legs.map(|(p, q)| length_inside(p, q, &o.rect)));
                out.push(Reading::new(id, inside.fold(0.0, f64::max)));
            }
            _ => out.push(Reading::flag(id, passes_by(room, corners))),
        }
    }
    out
}

/// Returns the middle of the front edge of an object.
fn front(object: &Object) -> Point {
    let (middle, half) = (object.rect.center(), object.placement.size_m[1] / 2.0);
    let (dx, dy) =
        [(half, 0.0), (0.0, half), (-half, 0.0), (0.0, -half)][usize::from(quarter(object.placement.pose.yaw_rad) % 4)];
    Point::new(middle.x + dx, middle.y + dy)
}

/// Returns how much of a line lies in a rectangle, m.
fn length_inside(p: Point, q: Point, r: &Rect) -> f64 {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (start, step, low, high) in [(p.x, q.x - p.x, r.x0, r.x1), (p.y, q.y - p.y, r.y0, r.y1)] {
        if step.abs() < f64::EPSILON {
            if start <= low || start >= high {
                return 0.0;
            }
            continue;
        }
        let (a, b) = ((low - start) / step, (high - start) / step);
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    (to - from).max(0.0) * p.distance(q)
}

/// Returns true when one can get from door to door without crossing the triangle.
fn passes_by(room: &Room, corners: [Point; 3]) -> bool {
    if room.doors.len() < 2 {
        return true;
    }
    let furniture = room.objects.iter().filter(|o| o.blocks).map(|o| o.rect);
    let taken: Vec<Rect> = furniture.chain(slices(corners)).collect();
    FreeSpace::new(&room.plan.net_polygon, &taken).passes(&room.doors, PASSER_M)
}

/// Returns rectangles that cover a triangle from within.
fn slices(corners: [Point; 3]) -> Vec<Rect> {
    let low = corners.iter().map(|p| p.x).fold(f64::MAX, f64::min);
    let high = corners.iter().map(|p| p.x).fold(f64::MIN, f64::max);
    let step = (high - low) / SLICES as f64;
    let slice = |n: usize| {
        let x = low + (n as f64 + 0.5) * step;
        let crossings = (0..3).filter_map(|i| {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            let within = (p.x - x) * (q.x - x) < 0.0;
            within.then(|| p.y + (q.y - p.y) * (x - p.x) / (q.x - p.x))
        });
        let (y0, y1) = crossings.fold((f64::MAX, f64::MIN), |(a, b), y| (a.min(y), b.max(y)));
        (y0 < y1).then(|| Rect { x0: x - step / 2.0, x1: x + step / 2.0, y0, y1 })
    };
    (0..SLICES).filter_map(slice).collect()
}

/// Returns the worktop beside an appliance, m: the width at either side, left and right of it.
pub(super) fn landings(room: &Room, object: &Object) -> [f64; 2] {
    let heading = quarter(object.placement.pose.yaw_rad);
    let along = |r: &Rect| if heading.is_multiple_of(2) { [r.y0, r.y1] } else { [r.x0, r.x1] };
    let is_top = |o: &&Object| {
        let top = o.placement.top_m();
        o.placement != object.placement
            && o.blocks
            && quarter(o.placement.pose.yaw_rad) == heading
            && (WORKTOP_M[0]..=WORKTOP_M[1]).contains(&top)
            && !o.is(&[Shape::Stove, Shape::Sink])
            && (belong_together(o, object) || o.is(&[Shape::Counter, Shape::Appliance]))
    };
    let across = |r: &Rect| if heading.is_multiple_of(2) { [r.x0, r.x1] } else { [r.y0, r.y1] };
    let own = across(&object.rect);
    let beside = |o: &&Object| {
        let other = across(&o.rect);
        other[0] < own[1] && own[0] < other[1]
    };
    let tops: Vec<[f64; 2]> = room.objects.iter().filter(is_top).filter(beside).map(|o| along(&o.rect)).collect();
    let [mut low, mut high] = along(&object.rect);
    let [start, end] = [low, high];
    while let Some(next) = tops.iter().find(|t| t[0] < low && (t[1] - low).abs() <= JOINT_M) {
        low = next[0];
    }
    while let Some(next) = tops.iter().find(|t| t[1] > high && (t[0] - high).abs() <= JOINT_M) {
        high = next[1];
    }
    [start - low, high - end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_by_what_stands_in_them() {
        let line = |r| length_inside(Point::new(0.0, 0.0), Point::new(4.0, 0.0), &r);
        assert_eq!(line(Rect::new(1.0, -1.0, 1.5, 1.0)), 0.5);
        assert_eq!(line(Rect::new(1.0, 0.5, 1.5, 1.0)), 0.0);
        let slanted = length_inside(Point::new(0.0, 0.0), Point::new(3.0, 3.0), &Rect::new(1.0, 1.0, 2.0, 2.0));
        assert!((slanted - 2_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn slices_have_the_area_of_their_triangle() {
        let corners = [Point::new(0.0, 0.0), Point::new(4.0, 0.0), Point::new(1.0, 3.0)];
        let area: f64 = slices(corners).iter().map(Rect::area).sum();
        assert!((area - 6.0).abs() < 0.1, "{area}");
    }
}
