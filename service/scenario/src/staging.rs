//! Staging areas: free floor in stores and circulation where goods are put down, near a door, out of the swing of doors, off the
//! routes of robots and beside the width that people and robots pass in.

use std::cell::OnceCell;

use d3dgen_knowledge::clearance::quarter;
use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::domain::{Mount, RobotUse, Shape, Zone};
use d3dgen_model::floorplan::Door;
use d3dgen_model::geometry::to_mm;
use d3dgen_model::occupancy::{Bitmap, CELL_M, stops_robot};
use d3dgen_model::robot_kind::brings;
use d3dgen_model::scenario::{Poi, Roi, RoiKind, Scenario};
use d3dgen_model::scene_graph::{GraphRoom, Note, SceneGraph};
use d3dgen_model::way_in::way_in;
use d3dgen_model::{Point, Polygon, Rect};

use super::floor::{CHAIR_BACK_M, Floor, Room, floor_beside, floor_in_front, lane};

/// Floor for each robot, m^2 (rule `staging_zone_area_per_robot`).
const PER_ROBOT_M2: f64 = 2.5;
/// Most robots that bring goods to one area at a time.
const MOST_ROBOTS: u32 = 4;
/// Depths of an area that are tried, m.
const DEPTHS_M: [f64; 2] = [1.0, 1.6];
/// Less, m: a pallet of 1.2 m by 0.8 m (EN 13698-1).
const PALLET_M: [f64; 2] = [1.2, 0.8];
/// What is left for goods in small stores, m: a roll container of 0.72 m by 0.81 m (EN 12674-1).
const ROLL_M: [f64; 2] = [0.85, 0.75];
/// Floor from which on a room for visitors has a place for goods too, m^2.
const LARGE_ROOM_M2: f64 = 25.0;
/// Floor before a door that stays free, m.
const BEFORE_DOOR_M: f64 = 1.0;
/// Play of a robot that passes, m.
const PASSING_M: f64 = 0.1;
/// How far a place may lie from the wall that it lies along, m.
const AT_WALL_M: f64 = 0.2;
/// Width of the way to desks, m.
const ACCESS_M: f64 = 0.9;
/// Distance between the places of a route at which its floor is taken, m.
const STEP_M: f64 = 0.1;
/// Play on each side of a robot that brings goods, m.
const CARRYING_M: f64 = 0.15;
/// Cells of wall or furniture beside a place that outweigh a meter more to the nearest door.
const FAR_CELLS: f64 = 2.0;
/// Places in a room that are looked at closely for one size, and how far they lie apart, cells.
const PLACES: usize = 4;
const APART: usize = 16;
/// Cells of a room's bounds from which on fewer of them are looked at.
const LARGE: usize = 200_000;

/// Returns a staging area for each unit of the storey, or for all of it, where there is floor for one beside the routes and
/// points of its robots.
pub(crate) fn all(floor: &Floor, graph: &SceneGraph, scenario: &Scenario) -> Vec<Roi> {
    let robots = bringing(graph);
    if robots == 0 {
        return Vec::new();
    }
    let units = units(&graph.rooms.iter().collect::<Vec<_>>());
    let each = robots.div_ceil(units.len() as u32).min(MOST_ROBOTS);
    let driven = driven(floor, scenario);
    units.into_iter().filter_map(|unit| of_unit(floor, graph, (&scenario.rois, &driven), (unit, each))).collect()
}

/// Returns how many robots bring goods.
fn bringing(graph: &SceneGraph) -> u32 {
    graph.robots.iter().filter(|r| brings(&r.kind)).map(|r| r.count).sum()
}

/// Returns the units of the rooms of a storey, in their order; `None` for all of a storey without any.
fn units<'g>(rooms: &[&'g GraphRoom]) -> Vec<Option<&'g str>> {
    let mut out: Vec<Option<&str>> = Vec::new();
    for room in rooms {
        if room.unit.is_some() && !out.contains(&room.unit.as_deref()) {
            out.push(room.unit.as_deref());
        }
    }
    if out.is_empty() { vec![None] } else { out }
}

/// Code of the note that says where there is no staging area.
pub(crate) const NO_STAGING: &str = "no_staging_area";

/// Returns what to say of units and storeys without floor for goods, where robots bring some.
pub(crate) fn staging_shortage(graph: &SceneGraph, rois: &[Roi]) -> Option<Note> {
    let staged: Vec<&GraphRoom> =
        rois.iter().filter(|r| r.kind == RoiKind::StagingArea).filter_map(|r| graph.room(&r.room_id)).collect();
    let levels = graph.level_numbers();
    let lacking = levels.iter().flat_map(|&level| {
        let here: Vec<&GraphRoom> = graph.rooms.iter().filter(|r| r.level == level).collect();
        let has = |unit: Option<&str>| {
            staged.iter().any(|r| r.level == level && (unit.is_none() || r.unit.as_deref() == unit))
        };
        let name = |unit: Option<&str>| match unit {
            Some(unit) => unit.to_owned(),
            None if levels.len() > 1 => format!("storey {level}"),
            None => "the building".into(),
        };
        units(&here).into_iter().filter(|unit| !has(*unit)).map(name).collect::<Vec<_>>()
    });
    let lacking: Vec<String> = lacking.filter(|_| bringing(graph) > 0).collect();
    let message =
        || format!("beside the ways of people and robots no floor is left to put goods down in {}", lacking.join(", "));
    (!lacking.is_empty()).then(|| Note { code: NO_STAGING.into(), message: message() })
}

/// Returns the floor that robots drive over and wait on.
fn driven(floor: &Floor, scenario: &Scenario) -> Vec<Rect> {
    let around = |p: Point, r: f64| Rect { x0: p.x - r, y0: p.y - r, x1: p.x + r, y1: p.y + r };
    let reach = |radius: f64| radius + PASSING_M / 2.0;
    let steps = |a: Point, b: Point, radius: f64| {
        let count = (a.distance(b) / STEP_M).ceil().max(1.0) as u32;
        let at = move |k: u32| f64::from(k) / f64::from(count);
        (0..=count)
            .map(move |k| around(Point::new(a.x + at(k) * (b.x - a.x), a.y + at(k) * (b.y - a.y)), reach(radius)))
    };
    let legs = scenario.robots.iter().flat_map(|task| task.routes.iter().map(|leg| (&leg.path, task.robot.radius_m)));
    let routes = legs.flat_map(|(path, radius)| path.windows(2).flat_map(move |w| steps(w[0], w[1], radius)));
    let points = scenario.pois.iter().filter(|p| matches!(p.kind.as_str(), Poi::WAITING_BAY | Poi::SERVICE_POINT));
    let points = points.map(|p| around(Point::new(p.pose.x, p.pose.y), reach(floor.radius)));
    routes.chain(points).collect()
}

fn of_unit(
    floor: &Floor,
    graph: &SceneGraph,
    (rois, driven): (&[Roi], &[Rect]),
    (unit, robots): (Option<&str>, u32),
) -> Option<Roi> {
    let here = |id: &str| graph.room(id).is_some_and(|r| unit.is_none() || r.unit.as_deref() == unit);
    let mut rooms: Vec<(u8, &Room)> =
        floor.rooms.iter().filter(|r| here(&r.plan.room_id)).filter_map(|r| Some((rank(floor, r)?, r))).collect();
    rooms.sort_by_key(|r| r.0);
    let yards: Vec<(&Room, Yard)> = rooms.into_iter().map(|(_, r)| (r, Yard::new(floor, r, rois, driven))).collect();
    let whole = [robots, 1].into_iter().flat_map(|n| {
        let area = f64::from(n) * PER_ROBOT_M2;
        DEPTHS_M.map(|depth| ([area / depth, depth], format!("{area} m2 for {n} robot(s)")))
    });
    let pallet = (PALLET_M, format!("a pallet of {} m x {} m", PALLET_M[0], PALLET_M[1]));
    let roll = (ROLL_M, format!("a roll container on {} m x {} m", ROLL_M[0], ROLL_M[1]));
    for (size, what) in whole.chain([pallet, roll]) {
        for (room, yard) in &yards {
            let Some(rect) = yard.place(floor, room, size) else { continue };
            let id = &room.plan.room_id;
            let note = format!("goods are put down here: {what}");
            let polygon = Polygon(rect.corners().to_vec());
            return Some(Roi::new(format!("staging_area_{id}"), RoiKind::StagingArea, id, polygon, note));
        }
    }
    None
}

/// Returns how well a room suits, 0 best: rooms of the staff that have floor for goods, then circulation, last rooms that
/// others use, as their types say; `None` for rooms that one gets to through others only, and for small ones of visitors.
fn rank(floor: &Floor, room: &Room) -> Option<u8> {
    if !room.is_for(RobotUse::Staging) || floor.plan.link_of(&room.plan.room_id).is_some() {
        return None;
    }
    let circulation = |id: &String| floor.plan.room(id).is_some_and(|r| r.circulation);
    let mut doors = floor.plan.doors_of(&room.plan.room_id);
    let beside = room.plan.circulation || doors.any(|d| d.entrance || d.room_ids.iter().any(circulation));
    match room.kind.zone {
        _ if !beside => None,
        _ if room.plan.circulation => Some(1),
        Zone::Service | Zone::Staff | Zone::Outdoor => Some(0),
        Zone::Circulation => Some(1),
        Zone::Public if room.plan.net_area_m2 < LARGE_ROOM_M2 => None,
        Zone::Day | Zone::Public | Zone::Night => Some(2),
    }
}

/// Floor of a room on which goods may stand.
struct Yard {
    /// By corner of cells: how many free cells lie south-west of it.
    sums: Vec<u32>,
    nx: usize,
    ny: usize,
    /// Clear width that must be left between the doors, and from them to where robots go, m.
    passage: f64,
    goals: Vec<Rect>,
    /// Floor under what stands there.
    taken: Vec<Rect>,
    /// Floor on which people get up from their desks.
    seats: Vec<Rect>,
    /// Free floor around it, once somebody asks.
    space: OnceCell<FreeSpace>,
}

impl Yard {
    fn new(floor: &Floor, room: &Room, rois: &[Roi], driven: &[Rect]) -> Self {
        let mut map = room.quiet.clone();
        let id = &room.plan.room_id;
        let lanes = floor.plan.doors_of(id).map(|d| lane(d, BEFORE_DOOR_M));
        let into = floor.plan.doors_of(id).filter(|_| !room.plan.circulation);
        let into: Vec<Rect> = into.flat_map(|door| way_in(&room.plan.net_polygon, door)).collect();
        let fronts = room.objects.iter().filter(|(p, _)| p.support.is_none() && stops_robot(p));
        let fronts = fronts.map(|(p, kind)| floor_in_front(p, kind.clearance_front_m, 0.0));
        let rugs = room.objects.iter().map(|(p, _)| *p).filter(|p| p.mount == Mount::Floor && !stops_robot(p));
        let rugs = rugs.map(|p| p.footprint().bounds());
        let used = |r: &&Roi| {
            &r.room_id == id && matches!(r.kind, RoiKind::ServiceZone | RoiKind::ChargingBuffer | RoiKind::StagingArea)
        };
        let goals: Vec<Rect> = rois.iter().filter(used).map(|r| r.polygon.bounds()).collect();
        let (i, j) = room.corner;
        for r in lanes.chain(into).chain(fronts).chain(rugs).chain(goals.iter().chain(driven).copied()) {
            let (i0, i1, j0, j1) = floor.occupancy.frame.span(&r);
            map.fill(i0 - i, i1 - i, j0 - j, j1 - j, false);
        }
        let width = if room.plan.circulation { floor.domain.circulation.width_m } else { 0.0 };
        let passage = width.max(2.0 * floor.radius + PASSING_M);
        let standing = room.objects.iter().map(|(p, _)| *p).filter(|p| stops_robot(p));
        let taken = standing.map(|p| p.footprint().bounds()).collect();
        let chairs = room.objects.iter().filter(|(_, o)| o.shape == Shape::SwivelChair);
        let seats = chairs.map(|(p, _)| floor_beside(p, quarter(p.pose.yaw_rad) + 2, CHAIR_BACK_M, 0.0)).collect();
        Self { sums: sums(&map), nx: map.nx(), ny: map.ny(), passage, goals, taken, seats, space: OnceCell::new() }
    }

    /// Returns the place in a room for an area of this size, m, that is tucked away most.
    fn place(&self, floor: &Floor, room: &Room, [length, depth]: [f64; 2]) -> Option<Rect> {
        let cells = |m: f64| (m / CELL_M - 1e-6).ceil() as usize + 1;
        let mut found = self.places(cells(length), cells(depth));
        found.extend(self.places(cells(depth), cells(length)));
        // what touches walls and furniture most comes first, but near a door; ties go to the south-west
        let doors: Vec<Point> = floor.plan.doors_of(&room.plan.room_id).map(|d| d.line.middle()).collect();
        let loss = |touched: u32, place: &[usize; 4]| {
            let middle = on_floor(floor, room, *place).center();
            let far = doors.iter().map(|d| d.distance(middle)).fold(f64::INFINITY, f64::min);
            let far = if far.is_finite() { far } else { 0.0 };
            (FAR_CELLS * far) as i64 - i64::from(touched)
        };
        found.sort_by_cached_key(|(touched, place)| (loss(*touched, place), place[1], place[0], place[2]));
        let mut looked: Vec<[usize; 4]> = Vec::new();
        for (_, place) in found {
            let near = |o: &[usize; 4]| o[0].abs_diff(place[0]) < APART && o[1].abs_diff(place[1]) < APART;
            if looked.iter().any(near) {
                continue;
            }
            let rect = on_floor(floor, room, place);
            if !is_at_wall(&room.plan.net_polygon, &rect) {
                continue;
            }
            if looked.len() == PLACES {
                return None;
            }
            looked.push(place);
            if floor.is_reached(room, &rect) && self.is_near(floor, room, &rect) && self.leaves_way(floor, room, &rect)
            {
                return Some(rect);
            }
        }
        None
    }

    /// Returns free places (first column and row, columns, rows) of a size with how many cells around are not free.
    fn places(&self, w: usize, h: usize) -> Vec<(u32, [usize; 4])> {
        let step = if self.nx * self.ny > LARGE { 4 } else { 2 };
        let mut out = Vec::new();
        if w > self.nx || h > self.ny || self.count([0, 0, self.nx, self.ny]) < (w * h) as u32 {
            return out;
        }
        let ring = (2 * (w + h) + 4) as u32;
        for j in (0..=self.ny - h).step_by(step) {
            for i in (0..=self.nx - w).step_by(step) {
                let inside = self.count([i, j, i + w, j + h]);
                if inside < (w * h) as u32 {
                    continue;
                }
                let around =
                    [i.saturating_sub(1), j.saturating_sub(1), (i + w + 1).min(self.nx), (j + h + 1).min(self.ny)];
                out.push((ring - (self.count(around) - inside), [i, j, w, h]));
            }
        }
        out
    }

    fn count(&self, [i0, j0, i1, j1]: [usize; 4]) -> u32 {
        let at = |i: usize, j: usize| self.sums[j * (self.nx + 1) + i];
        at(i1, j1) + at(i0, j0) - at(i0, j1) - at(i1, j0)
    }

    /// Returns true when a robot that carries something gets to a place with ease from one of the doors.
    fn is_near(&self, floor: &Floor, room: &Room, rect: &Rect) -> bool {
        let space = self.space.get_or_init(|| FreeSpace::new(&room.plan.net_polygon, &self.taken));
        let width = 2.0 * (floor.radius + CARRYING_M);
        floor.plan.doors_of(&room.plan.room_id).any(|door| space.leads(door, rect, width.min(door.clear_width_m)))
    }

    /// Returns true when people and robots still pass between the doors of the room, and to docks and service zones in it.
    fn leaves_way(&self, floor: &Floor, room: &Room, rect: &Rect) -> bool {
        let doors: Vec<&Door> = floor.plan.doors_of(&room.plan.room_id).collect();
        let taken: Vec<Rect> = self.taken.iter().chain([rect]).copied().collect();
        let space = FreeSpace::new(&room.plan.net_polygon, &taken);
        let leads = |door: &&Door| self.goals.iter().all(|goal| space.leads(door, goal, self.passage));
        let before = self.space.get_or_init(|| FreeSpace::new(&room.plan.net_polygon, &self.taken));
        let to = |space: &FreeSpace, seat: &Rect| doors.iter().any(|door| space.leads(door, seat, ACCESS_M));
        if self.seats.iter().any(|seat| !to(&space, seat) && to(before, seat)) {
            return false;
        }
        // the floor before a single door is free
        (doors.len() < 2 || space.passes(&doors, self.passage)) && doors.first().is_none_or(leads)
    }
}

/// Returns true for a place with a long side at a wall: goods in the middle of a room are in everybody's way.
fn is_at_wall(outline: &Polygon, r: &Rect) -> bool {
    let long = r.width() >= r.height();
    let side = |beyond: f64, high: bool| {
        [0.1, 0.5, 0.9].into_iter().all(|t| {
            let (along, across) = match long {
                true => (r.x0 + t * r.width(), if high { r.y1 + beyond } else { r.y0 - beyond }),
                false => (r.y0 + t * r.height(), if high { r.x1 + beyond } else { r.x0 - beyond }),
            };
            !outline.contains(if long { Point::new(along, across) } else { Point::new(across, along) })
        })
    };
    side(AT_WALL_M, true) || side(AT_WALL_M, false)
}

/// Returns how many cells of a set lie south-west of each corner of cells.
fn sums(map: &Bitmap) -> Vec<u32> {
    let (nx, ny) = (map.nx(), map.ny());
    let mut out = vec![0; (nx + 1) * (ny + 1)];
    for j in 0..ny {
        let mut row = 0;
        for i in 0..nx {
            row += u32::from(map.get(i, j));
            out[(j + 1) * (nx + 1) + i + 1] = out[j * (nx + 1) + i + 1] + row;
        }
    }
    out
}

/// Returns the rectangle between the centers of the outer cells of a place.
fn on_floor(floor: &Floor, room: &Room, [i, j, w, h]: [usize; 4]) -> Rect {
    let (i, j) = (i + room.corner.0 as usize, j + room.corner.1 as usize);
    let (a, b) = (floor.occupancy.frame.center(i, j), floor.occupancy.frame.center(i + w - 1, j + h - 1));
    Rect { x0: to_mm(a.x), y0: to_mm(a.y), x1: to_mm(b.x), y1: to_mm(b.y) }
}
