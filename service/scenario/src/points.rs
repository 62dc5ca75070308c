//! Named points: docks, service points, cleaning points, the entrance, waiting bays.

use d3dgen_model::domain::{Mount, ObjectType, RobotUse, Shape};
use d3dgen_model::placements::Placement;
use d3dgen_model::robot_kind::cleans;
use d3dgen_model::scenario::Poi;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::{Point, Rect};

use super::floor::{Floor, Room, around, floor_in_front, looking_at, swept};
use super::regions::buffers;

/// Gap between a robot's hull and what it serves, m.
const GAP_M: f64 = 0.10;
/// How much nearer a spot beside an object must be than one in front of it, and one on the side of those who sit at a desk or
/// table than others, m.
const NOT_IN_FRONT_M: f64 = 0.3;
/// How much nearer a spot must be at which a robot stands right behind or beside whoever sits there, m.
const AT_CHAIR_M: f64 = 1.5;
/// How much nearer a spot must be on the floor of a dock that is another's, m.
const AT_DOCK_M: f64 = 2.0;
/// How much nearer a spot beside a desk or table must be for each meter that it lies farther from the door, m: on the way
/// there one passes behind chairs.
const FROM_DOOR: f64 = 0.15;
/// Desks or tables of a room that are looked at for one with a stop aside of chairs.
const MOST_SERVED: usize = 8;
/// Depth of the floor before an object that one stands on to be served, m.
const FRONT_M: f64 = 0.6;
/// Most waiting bays.
const MOST_BAYS: u32 = 4;
/// Spots of a room that are looked at for a waiting bay, about.
const MOST_BAY_SPOTS: usize = 2000;
/// Least distance of a waiting bay from a door, m.
const BAY_FROM_DOOR_M: f64 = 1.0;
/// Builds of objects at which a robot serves, the telling ones first.
const SERVED: [Shape; 8] = [
    Shape::Counter,
    Shape::HospitalBed,
    Shape::Bed,
    Shape::Desk,
    Shape::Table,
    Shape::RoundTable,
    Shape::Shelf,
    Shape::Cabinet,
];

/// Returns what a robot serves in a room: of the objects of the most telling build that stand on the floor, clear of the
/// swing of doors where there is such a one, the nearest to a door.
pub(crate) fn served<'r>(floor: &Floor, room: &'r Room) -> Option<&'r (&'r Placement, &'r ObjectType)> {
    let id = &room.plan.room_id;
    let swings: Vec<Rect> = floor.plan.doors_of(id).filter_map(|d| swept(d, id)).collect();
    let standing = room.objects.iter().filter(|(_, k)| k.mount == Mount::Floor);
    let known = standing.filter_map(|o| Some((SERVED.iter().position(|shape| o.1.shape == *shape)?, o)));
    let ranked = known.map(|(rank, o)| {
        let front = floor_in_front(o.0, FRONT_M, 0.0);
        let swung = swings.iter().any(|s| s.overlaps(&front));
        ((swung, rank, door_distance(floor, room, Point::new(o.0.pose.x, o.0.pose.y))), o)
    });
    let mut ranked: Vec<_> = ranked.collect();
    ranked.sort_by(|(a, _), (b, _)| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    let &((swung, rank, _), first) = ranked.first()?;
    // at the end of a row rather than between those who sit there
    let mut alike =
        ranked.iter().take_while(|((s, r, _), _)| (*s, *r) == (swung, rank)).map(|(_, o)| *o).take(MOST_SERVED);
    let aside = |o: &&(&Placement, &ObjectType)| {
        let spot = at_object(floor, room, **o).map(|(_, pose)| Point::new(pose.x, pose.y));
        spot.is_some_and(|spot| !floor.is_at_chair(room, spot))
    };
    if is_seated(first.1) { alike.find(aside).or(Some(first)) } else { Some(first) }
}

/// Returns true for what people sit at.
fn is_seated(kind: &ObjectType) -> bool {
    matches!(kind.shape, Shape::Desk | Shape::Table | Shape::RoundTable)
}

/// Returns how far a point is from the nearest door of a room, m; 0 in rooms without one.
fn door_distance(floor: &Floor, room: &Room, p: Point) -> f64 {
    let doors = floor.plan.doors_of(&room.plan.room_id).map(|d| d.line.middle().distance(p));
    doors.reduce(f64::min).unwrap_or(0.0)
}

/// Returns all points; each can be reached.
pub(crate) fn all(floor: &Floor, graph: &SceneGraph) -> Vec<Poi> {
    let mut out: Vec<Poi> = entrance(floor).into_iter().collect();
    for room in &floor.rooms {
        let docks = room.objects.iter().filter(|(_, k)| k.shape == Shape::Dock);
        for &(dock, kind) in docks {
            let number = out.iter().filter(|p| p.kind == Poi::DOCK).count() + 1;
            out.extend(
                at_object(floor, room, (dock, kind))
                    .map(|(_, pose)| poi(format!("dock_{number}"), Poi::DOCK, room, pose)),
            );
        }
    }
    // where the prompt sends a robot it stops, whatever others do there
    let sent = |id: &String| graph.robots.iter().any(|r| r.stops.contains(id));
    let serves = |r: &&Room| (r.is_for(RobotUse::Service) || sent(&r.plan.room_id)) && !r.keep_out;
    for room in floor.rooms.iter().filter(serves) {
        let pose = match served(floor, room) {
            Some(&(object, kind)) => at_object(floor, room, (object, kind)).map(|(_, pose)| pose),
            // nobody takes anything over in the middle of a corridor
            None if room.plan.circulation => None,
            None => in_the_middle(floor, room),
        };
        let id = format!("service_point_{}", room.plan.room_id);
        out.extend(pose.map(|pose| poi(id, Poi::SERVICE_POINT, room, pose)));
    }
    if graph.robots.iter().any(|r| cleans(&r.kind)) {
        let cleaned = |r: &&Room| r.is_for(RobotUse::CleaningHigh) || r.is_for(RobotUse::CleaningLow);
        for room in floor.rooms.iter().filter(cleaned).filter(|r| !r.keep_out) {
            let id = format!("cleaning_point_{}", room.plan.room_id);
            out.extend(in_the_middle(floor, room).map(|pose| poi(id, Poi::CLEANING_POINT, room, pose)));
        }
    }
    out.extend(bays(floor, graph));
    out
}

fn poi(poi_id: String, kind: &str, room: &Room, pose: d3dgen_model::Pose) -> Poi {
    Poi { poi_id, kind: kind.into(), room_id: room.plan.room_id.clone(), pose }
}

/// Returns where a robot stops at an object: in front of it, or beside a desk or table whose chairs take that floor; and by
/// how many quarters it stands to the left of the front.
pub(crate) fn at_object(
    floor: &Floor,
    room: &Room,
    (object, kind): (&Placement, &ObjectType),
) -> Option<(u8, d3dgen_model::Pose)> {
    let seated = is_seated(kind);
    let wanted = around(object, floor.radius + GAP_M).into_iter().take(if seated { 4 } else { 1 });
    let spots = (0..).zip(wanted).filter_map(|(side, p)| {
        let (off, spot) = floor.best_spot(room, p)?;
        let far = if seated { FROM_DOOR * door_distance(floor, room, spot) } else { 0.0 };
        // at a desk or table somebody sits there
        let aside = if seated == (side == 0) { NOT_IN_FRONT_M } else { 0.0 };
        let crowded = if seated && floor.is_at_chair(room, spot) { AT_CHAIR_M } else { 0.0 };
        let mut docks = buffers(floor, room).filter(|(dock, _)| dock.placement_id != object.placement_id);
        let within = |b: &Rect| b.x0 < spot.x && spot.x < b.x1 && b.y0 < spot.y && spot.y < b.y1;
        let docked = if docks.any(|(_, b)| within(&b.grown(floor.radius))) { AT_DOCK_M } else { 0.0 };
        Some((off + far + aside + crowded + docked, side, spot))
    });
    let (_, side, spot) = spots.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((side, looking_at(spot, Point::new(object.pose.x, object.pose.y))))
}

fn in_the_middle(floor: &Floor, room: &Room) -> Option<d3dgen_model::Pose> {
    let pieces = room.plan.net_polygon.rects();
    let largest = pieces.iter().max_by(|a, b| a.area().total_cmp(&b.area()))?;
    let spot = floor.spot_near(room, largest.center())?;
    Some(looking_at(spot, largest.center()))
}

/// Returns the point inside the main entrance, looking in.
fn entrance(floor: &Floor) -> Option<Poi> {
    let door = floor.plan.doors.iter().find(|d| d.entrance)?;
    let room = floor.rooms.iter().find(|r| door.room_ids.contains(&r.plan.room_id))?;
    let middle = door.line.middle();
    let spot = floor.spot_near(room, middle)?;
    // looking on in the direction in which one has come in
    let on = Point::new(2.0 * spot.x - middle.x, 2.0 * spot.y - middle.y);
    Some(poi("entrance_1".into(), Poi::ENTRANCE, room, looking_at(spot, on)))
}

/// Returns places in the circulation, or in the room one enters through, where robots wait without standing before a door.
fn bays(floor: &Floor, graph: &SceneGraph) -> Vec<Poi> {
    let robots: u32 = graph.robots.iter().map(|r| r.count).sum();
    let entered = |id: &str| graph.room(id).is_some_and(|r| r.entrance);
    let room = floor.rooms.iter().find(|r| r.plan.circulation);
    let Some(room) = room.or_else(|| floor.rooms.iter().find(|r| entered(&r.plan.room_id))) else { return Vec::new() };
    let doors: Vec<Point> = floor.plan.doors_of(&room.plan.room_id).map(|d| d.line.middle()).collect();
    let mut taken: Vec<Point> = Vec::new();
    // the best of many is as good as the best of all
    let spots = floor.every(room, (floor.spots(room) / MOST_BAY_SPOTS).max(10));
    for _ in 0..robots.clamp(1, MOST_BAYS) {
        let apart = |p: &Point| {
            let others = taken.iter().all(|t| t.distance(*p) >= 2.0 * floor.radius + GAP_M);
            others && doors.iter().all(|d| d.distance(*p) >= BAY_FROM_DOOR_M)
        };
        let room_around = |p: &Point| doors.iter().chain(&taken).map(|d| d.distance(*p)).fold(f64::MAX, f64::min);
        // beside the walls rather than at them, where there is room for that
        let best = [GAP_M, 0.0].into_iter().find_map(|play| {
            let free = spots.iter().copied().filter(apart).filter(|p| floor.has_play(*p, play));
            free.max_by(|a, b| room_around(a).total_cmp(&room_around(b)))
        });
        taken.extend(best);
    }
    let middle = room.plan.net_polygon.bounds().center();
    let each = taken.iter().enumerate();
    each.map(|(i, p)| poi(format!("waiting_bay_{}", i + 1), Poi::WAITING_BAY, room, looking_at(*p, middle))).collect()
}
