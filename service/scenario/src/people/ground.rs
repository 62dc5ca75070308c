//! Rooms as people find them: what they are, what stands in them, where one can stand.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::domain::{Domain, Mount, ObjectType, Role, RoomType, is_named};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::occupancy::{Bitmap, Occupancy};
use d3dgen_model::offer::seats_across;
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::{Point, Pose, Segment};

use super::facing;

/// Radius that those who stand somewhere have at least, m: a little more than a person's.
pub(super) const STANDING_M: f64 = 0.25;
/// Free floor around those who stand somewhere for a while, where there is as much, m.
const EASY_M: f64 = 0.45;
/// Floor before a door on which nobody stays, m.
const FROM_DOOR_M: f64 = 0.9;
/// How far inside an entrance people appear, m.
const INSIDE_M: f64 = 0.7;

/// All storeys of a building.
pub(crate) struct Building<'a> {
    pub domain: &'a Domain,
    pub grounds: Vec<Ground<'a>>,
    pub rooms: Vec<Room<'a>>,
}

/// One storey.
pub(crate) struct Ground<'a> {
    pub level: i32,
    pub plan: &'a Floorplan,
    pub occupancy: Occupancy,
    /// Cells on which a person stands and gets to most others.
    pub main: Bitmap,
}

/// A room that people get to.
pub(crate) struct Room<'a> {
    pub ground: usize,
    pub plan: &'a PlanRoom,
    pub kind: &'a RoomType,
    pub tags: BTreeSet<&'a str>,
    /// Part of the building, where there are such.
    pub unit: Option<String>,
    /// What stands on its floor or hangs on its walls.
    pub objects: Vec<(&'a Placement, &'a ObjectType)>,
    /// Where one stands for a while, out of the way of doors where that is possible.
    pub spots: Vec<Point>,
}

impl Room<'_> {
    /// Returns how many people at a time do something with the objects of the room.
    pub fn count(&self, affordance: &str) -> u32 {
        let objects = self.objects.iter().filter(|(_, o)| o.affordances.iter().any(|a| a == affordance));
        let on = |(p, o): &(&Placement, &ObjectType)| {
            let sits = affordance == "sit";
            if sits { seats_across(o.shape, p.size_m[0]).max(u32::from(!is_for_lying(o))) } else { 1 }
        };
        objects.map(on).sum()
    }
}

/// Returns true for what one sits on only beside lying on it.
pub(super) fn is_for_lying(object: &ObjectType) -> bool {
    object.affordances.first().is_some_and(|a| a == "lie")
}

impl<'a> Building<'a> {
    /// Returns the building of the plans and placements of its storeys, as people on them see them.
    pub fn new(storeys: &[(i32, &'a Floorplan, &'a Placements)], graph: &SceneGraph, domain: &'a Domain) -> Self {
        let mut out = Self { domain, grounds: Vec::new(), rooms: Vec::new() };
        let kinds = domain.objects_by_id();
        for &(level, plan, placements) in storeys {
            let occupancy = Occupancy::of_world(plan, placements);
            let main = occupancy.reach(plan, STANDING_M).main;
            let mut easy = occupancy.clear(EASY_M);
            easy.intersect(&main);
            let ground = out.grounds.len();
            let mut by_room: BTreeMap<&str, Vec<(&Placement, &ObjectType)>> = BTreeMap::new();
            for p in placements.placements.iter().filter(|p| matches!(p.mount, Mount::Floor | Mount::Wall)) {
                if let Some(kind) = kinds.get(p.object.as_str()) {
                    by_room.entry(&p.room_id).or_default().push((p, *kind));
                }
            }
            for room in &plan.rooms {
                let spots = spots(plan, room, &occupancy, [&easy, &main]);
                if spots.is_empty() {
                    continue;
                }
                let kind = domain.room_type_or_generic(&room.room_type);
                let unit = graph.room(&room.room_id).and_then(|r| r.unit.clone());
                let objects = by_room.remove(room.room_id.as_str()).unwrap_or_default();
                out.rooms.push(Room { ground, plan: room, kind, tags: domain.tags_of(kind), unit, objects, spots });
            }
            out.grounds.push(Ground { level, plan, occupancy, main });
        }
        out
    }

    /// Returns the storey of a room; the ground for one that the plan does not know.
    pub fn level_of(&self, room_id: &str) -> i32 {
        self.rooms.iter().find(|r| r.plan.room_id == room_id).map_or(0, |r| self.grounds[r.ground].level)
    }

    /// Returns the number of beds in which people sleep.
    pub fn beds(&self) -> u32 {
        self.rooms.iter().filter(|r| r.tags.contains("sleep")).map(|r| r.count("lie")).sum()
    }

    /// Returns the room that one of several people of a role has as home: they are dealt over such rooms in their order.
    pub fn home_of(&self, role: &Role, number: usize, count: usize) -> Option<&'a str> {
        let names = if role.home.is_empty() { &role.visits } else { &role.home };
        let is_home = |r: &&Room<'a>| names.iter().any(|name| is_named(name, r.kind, &r.tags));
        let all: Vec<&Room> = self.rooms.iter().filter(is_home).collect();
        all.get(number * all.len() / count.max(1)).map(|r| r.plan.room_id.as_str())
    }

    /// Returns the main entrance: its door, the room behind it, and where people appear.
    pub fn entrance(&self) -> Option<(&'a str, &'a str, Pose)> {
        let ground = self.grounds.iter().find(|g| g.level == 0).or(self.grounds.first())?;
        let doors = || ground.plan.doors.iter().filter(|d| d.room_ids.len() == 1);
        let door = doors().find(|d| d.entrance).or_else(|| doors().next())?;
        let room = self.rooms.iter().find(|r| door.room_ids.contains(&r.plan.room_id))?;
        let middle = door.line.middle();
        let inside = inside(&door.line, room.plan)?;
        let inside = ground.near(room.plan, inside, INSIDE_M)?;
        let on = Point::new(2.0 * inside.x - middle.x, 2.0 * inside.y - middle.y);
        Some((door.door_id.as_str(), room.plan.room_id.as_str(), facing(inside, on)))
    }
}

impl Ground<'_> {
    /// Returns the cell of a room that a person stands on nearest to a point, within some distance, m; ties go to the south-west.
    pub fn near(&self, room: &PlanRoom, p: Point, within: f64) -> Option<Point> {
        let around = d3dgen_model::Rect { x0: p.x - within, y0: p.y - within, x1: p.x + within, y1: p.y + within };
        let (i0, i1, j0, j1) = self.occupancy.frame.span(&around);
        let mut best: Option<(f64, Point)> = None;
        for j in j0.max(0)..j1.min(self.occupancy.frame.ny as i64) {
            for i in i0.max(0)..i1.min(self.occupancy.frame.nx as i64) {
                if !self.main.get(i as usize, j as usize) {
                    continue;
                }
                let at = self.occupancy.frame.center(i as usize, j as usize);
                let off = at.distance(p);
                let fits = off <= within && best.is_none_or(|(known, _)| off < known - 1e-9);
                if fits && room.net_polygon.contains(at) {
                    best = Some((off, at));
                }
            }
        }
        best.map(|(_, at)| at)
    }
}

/// Returns the point straight inside a door of a room.
fn inside(line: &Segment, room: &PlanRoom) -> Option<Point> {
    let (middle, length) = (line.middle(), line.length().max(1e-6));
    let (nx, ny) = (-(line.end.y - line.start.y) / length * INSIDE_M, (line.end.x - line.start.x) / length * INSIDE_M);
    let both = [Point::new(middle.x + nx, middle.y + ny), Point::new(middle.x - nx, middle.y - ny)];
    both.into_iter().find(|p| room.net_polygon.contains(*p))
}

/// Returns where one stands in a room for a while: with ease and away from doors, else with ease, else at all.
fn spots(plan: &Floorplan, room: &PlanRoom, occupancy: &Occupancy, [easy, main]: [&Bitmap; 2]) -> Vec<Point> {
    let (i0, i1, j0, j1) = occupancy.frame.span(&room.net_polygon.bounds());
    let doors: Vec<Point> = plan.doors_of(&room.room_id).map(|d| d.line.middle()).collect();
    let cells = |map: &Bitmap, from_door: f64| -> Vec<Point> {
        let rows = j0.max(0)..j1.min(occupancy.frame.ny as i64);
        let all =
            rows.flat_map(|j| (i0.max(0)..i1.min(occupancy.frame.nx as i64)).map(move |i| (i as usize, j as usize)));
        // every other cell is enough
        let all =
            all.filter(|(i, j)| i % 2 == 0 && j % 2 == 0 && map.get(*i, *j)).map(|(i, j)| occupancy.frame.center(i, j));
        all.filter(|p| room.net_polygon.contains(*p) && doors.iter().all(|d| d.distance(*p) >= from_door)).collect()
    };
    let tries = [(easy, FROM_DOOR_M), (easy, 0.0), (main, FROM_DOOR_M), (main, 0.0)];
    tries.into_iter().map(|(map, from_door)| cells(map, from_door)).find(|spots| !spots.is_empty()).unwrap_or_default()
}
