//! Free floor around objects, and distances between objects, walls and windows.

use d3dgen_model::domain::{Mount, Shape};
use d3dgen_model::{Point, Rect};

use super::site::{Object, Room, Site};
use crate::clearance::{HEAD_ROOM_M, Side, depth_beside, free_depth, quarter, turned};
use crate::compliance::reading::Reading;
use crate::compliance::site::belong_together;
use crate::measure::Measure;
use crate::retrieve::{Applicable, Rule};

/// Objects nearer to a wall than this stand against it, m.
const AGAINST_M: f64 = 0.10;
/// What reaches less far beyond the front of an object stands beside it, m.
const BESIDE_M: f64 = 0.02;
/// Heights between which a thing on a wall stands out into the way of people, m.
const IN_THE_WAY_M: [f64; 2] = [0.685, HEAD_ROOM_M];
/// Seats belong to a table at most this far from its edge, m.
const AT_TABLE_M: f64 = 0.5;
/// Thickness of the panels that a desk stands on, m.
const DESK_PANEL_M: f64 = 0.03;
const SEATS: [Shape; 3] = [Shape::Chair, Shape::SwivelChair, Shape::Stool];

/// Returns a distance of an object, m; `None` when the quantity is none or the room lacks the other end.
pub(super) fn figure(room: &Room, object: &Object, rule: &Rule) -> Option<f64> {
    let alike = |o: &&Object| o.placement != object.placement && o.kind.is_some_and(|k| rule.quantity.picks(k));
    let (own, own_middle) = (&object.rect, object.rect.center());
    match rule.quantity.measure {
        Measure::FreeHalfCircle => Some(half_circle(room, object)),
        Measure::ObjectAround => (0..4).map(|turn| depth(room, object, turn)).reduce(f64::min),
        Measure::ObjectThreeSides => {
            let sides = [Side::Front, Side::Left, Side::Right];
            sides
                .map(|side| free_depth(object.placement, side, &room.plan.net_polygon, room.others(object)))
                .into_iter()
                .reduce(f64::min)
        }
        Measure::ObjectToWall => {
            let to_wall = |turn| depth_beside(own, turn, &room.plan.net_polygon, std::iter::empty());
            (0..4).map(to_wall).filter(|d| *d > AGAINST_M).reduce(f64::min)
        }
        Measure::ObjectToObject => {
            let ends = room.objects.iter().filter(|o| o.is(&rule.quantity.to_shapes));
            ends.map(|o| o.rect.gap(own)).reduce(f64::min)
        }
        Measure::CentreToSide => {
            let ahead = quarter(object.placement.pose.yaw_rad);
            let side = |turn| depth(room, object, (ahead + turn) % 4);
            Some(side(1).min(side(3)) + object.placement.size_m[0] / 2.0)
        }
        Measure::CentreSpacing => {
            room.objects.iter().filter(alike).map(|o| o.rect.center().distance(own_middle)).reduce(f64::min)
        }
        Measure::FacingGap => facing_gap(room, object, rule),
        Measure::LegRoom => {
            let under = |o: &&Object| o.is(&[Shape::Cabinet]) && o.rect.overlaps(own);
            let taken: f64 = room.objects.iter().filter(under).map(|o| o.placement.size_m[0]).sum();
            Some(object.placement.size_m[0] - taken - 2.0 * DESK_PANEL_M)
        }
        Measure::TableEdgePerSeat => {
            let seats = room.objects.iter().filter(|o| o.is(&SEATS) && belong_together(o, object));
            let seats = seats.filter(|o| o.rect.gap(own) <= AT_TABLE_M).count();
            (seats > 0).then(|| 2.0 * (own.width() + own.height()) / seats as f64)
        }
        Measure::WindowDistance => room.windows.iter().map(|w| w.line.middle().distance(own_middle)).reduce(f64::min),
        _ => None,
    }
}

/// Returns the radius of the free half circle before the middle of an object's front, m: walls beside it bound it too.
fn half_circle(room: &Room, object: &Object) -> f64 {
    let ahead = quarter(object.placement.pose.yaw_rad);
    let own = turned(&object.rect, ahead);
    let middle = Point::new(own.x1, own.center().y);
    let walls = room.plan.net_polygon.edges().map(|wall| wall.bounds());
    let bounds = walls.chain(room.others(object)).map(|r| turned(&r, ahead)).filter(|r| r.x1 > own.x1 + BESIDE_M);
    let in_front = bounds.map(|r| Rect { x0: r.x0.max(own.x1), ..r });
    in_front.map(|r| r.distance_to(middle)).reduce(f64::min).unwrap_or(0.0)
}

/// Returns true when the back of an object stands against a wall.
pub(super) fn back_is_at_wall(room: &Room, object: &Object) -> bool {
    let back = (quarter(object.placement.pose.yaw_rad) + 2) % 4;
    depth_beside(&object.rect, back, &room.plan.net_polygon, std::iter::empty()) <= AGAINST_M
}

/// Reads how far each thing on a wall of circulation stands out, at the height of people.
pub(super) fn projections(site: &Site, a: &Applicable) -> Vec<Reading> {
    let in_the_way = |o: &&Object| {
        let z = o.placement.pose.z;
        o.placement.mount == Mount::Wall && z > IN_THE_WAY_M[0] && z < IN_THE_WAY_M[1]
    };
    let rooms = site.rooms_of(a).filter(|r| r.plan.circulation);
    let objects = rooms.flat_map(|r| r.objects.iter().filter(in_the_way));
    objects.map(|o| Reading::new(&o.placement.placement_id, o.placement.size_m[1])).collect()
}

/// Returns the free depth towards a quarter turn up to the next wall or thing that does not belong to the object, m.
fn depth(room: &Room, object: &Object, turn: u8) -> f64 {
    depth_beside(&object.rect, turn, &room.plan.net_polygon, room.others(object))
}

/// Returns the aisle between the front of this desk or shelf and the next one that faces it, m.
fn facing_gap(room: &Room, object: &Object, rule: &Rule) -> Option<f64> {
    let ahead = quarter(object.placement.pose.yaw_rad);
    let outline = &room.plan.net_polygon;
    let faces = |o: &&Object| {
        quarter(o.placement.pose.yaw_rad) == (ahead + 2) % 4 && o.kind.is_some_and(|k| rule.quantity.picks(k))
    };
    let desks = room.objects.iter().filter(faces).map(|o| o.rect);
    let things =
        room.objects.iter().filter(|o| o.blocks && !o.is(&SEATS) && !belong_together(o, object)).map(|o| o.rect);
    let to_desk = depth_beside(&object.rect, ahead, outline, desks);
    let to_wall = depth_beside(&object.rect, ahead, outline, std::iter::empty());
    let to_thing = depth_beside(&object.rect, ahead, outline, things);
    (to_desk < to_wall - AGAINST_M && to_desk <= to_thing + crate::compliance::SLACK).then_some(to_desk)
}
