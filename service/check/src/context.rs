//! A world indexed for the rules: rooms with their types, doors, objects with outlines, free floor when asked for.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

use d3dgen_knowledge::Retrieval;
use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::domain::{Domain, ObjectType, RoomType};
use d3dgen_model::floorplan::{Door, Floorplan, PlanRoom};
use d3dgen_model::measures::LEAST_RADIUS_M;
use d3dgen_model::occupancy::{Bitmap, FLAT_M, Occupancy, Reach, stops_robot};
use d3dgen_model::placements::Placement;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect, Segment};

use crate::outline::Outline;

/// How far a line may lie from the boundary it stands for, m.
pub const ON_LINE_M: f64 = 0.02;

/// The indexed world.
pub struct Context<'a> {
    pub world: &'a World,
    pub domain: &'a Domain,
    pub retrieval: &'a Retrieval,
    pub rooms: Vec<Room<'a>>,
    pub objects: Vec<Object<'a>>,
    /// Where a room is in `rooms`, and what stands in it in `objects`, by its id.
    index: BTreeMap<&'a str, (usize, Vec<usize>)>,
    /// Radius of the disc that must find its way, m.
    pub radius: f64,
    occupancy: OnceCell<Occupancy>,
    reach: OnceCell<Reach>,
    /// Where a disc can stand, by its radius in mm.
    clear: RefCell<BTreeMap<u64, Rc<Bitmap>>>,
}

/// A room of the plan.
pub struct Room<'a> {
    pub plan: &'a PlanRoom,
    pub kind: &'a RoomType,
    /// Rectangles that make up its zone, on wall center lines.
    pub rects: Vec<Rect>,
    /// Rectangles that make up its net floor, without what columns and free walls take of it.
    pub net: Vec<Rect>,
    /// Rectangles that cover its columns and free walls.
    pub standing: Vec<Rect>,
    pub doors: Vec<&'a Door>,
}

/// An object with its outline.
pub struct Object<'a> {
    pub placement: &'a Placement,
    pub kind: Option<&'a ObjectType>,
    /// Rectangle along the walls around its outline.
    pub rect: Rect,
    /// Its outline, at the angle it stands.
    pub outline: Outline,
    /// Higher than floor covering.
    pub solid: bool,
    /// In the way of a robot or a person's legs.
    pub blocks: bool,
}

impl<'a> Context<'a> {
    pub fn new(world: &'a World, domain: &'a Domain, retrieval: &'a Retrieval) -> Self {
        let plan = &world.floorplan;
        let room = |room: &'a PlanRoom| Room {
            plan: room,
            kind: domain.room_type_or_generic(&room.room_type),
            rects: room.polygon.rects(),
            net: net_floor(plan, room),
            standing: plan.taken_in(&room.room_id),
            doors: plan.doors_of(&room.room_id).collect(),
        };
        let kinds = domain.objects_by_id();
        let object = |p: &'a Placement| {
            let outline = Outline::of(p);
            Object {
                placement: p,
                kind: kinds.get(p.object.as_str()).copied(),
                rect: outline.bounds,
                outline,
                solid: p.size_m[2] > FLAT_M,
                blocks: stops_robot(p),
            }
        };
        let mut index: BTreeMap<&str, (usize, Vec<usize>)> = BTreeMap::new();
        for (i, room) in plan.rooms.iter().enumerate() {
            index.entry(&room.room_id).or_insert((i, Vec::new()));
        }
        for (i, p) in world.placements.placements.iter().enumerate() {
            if let Some((_, here)) = index.get_mut(p.room_id.as_str()) {
                here.push(i);
            }
        }
        Self {
            index,
            rooms: plan.rooms.iter().map(room).collect(),
            objects: world.placements.placements.iter().map(object).collect(),
            radius: world.scene_graph.robots.iter().map(|r| r.planned_radius_m()).fold(LEAST_RADIUS_M, f64::max),
            world,
            domain,
            retrieval,
            occupancy: OnceCell::new(),
            reach: OnceCell::new(),
            clear: RefCell::default(),
        }
    }

    pub fn graph(&self) -> &'a SceneGraph {
        &self.world.scene_graph
    }

    pub fn plan(&self) -> &'a Floorplan {
        &self.world.floorplan
    }

    pub fn room(&self, id: &str) -> Option<&Room<'a>> {
        self.index.get(id).map(|(at, _)| &self.rooms[*at])
    }

    pub fn objects_in<'s>(&'s self, room_id: &str) -> impl Iterator<Item = &'s Object<'a>> + 's {
        self.index.get(room_id).into_iter().flat_map(|(_, here)| here).map(|i| &self.objects[*i])
    }

    /// Returns the free floor of the furnished building.
    pub fn occupancy(&self) -> &Occupancy {
        self.occupancy.get_or_init(|| Occupancy::of_world(self.plan(), &self.world.placements))
    }

    /// Returns what the disc can reach.
    pub fn reach(&self) -> &Reach {
        self.reach.get_or_init(|| self.occupancy().reach(self.plan(), self.radius))
    }

    /// Judges from the part of the floor that another world of the same plan was judged from: where a plan is cut in two,
    /// its furniture decides which part is the larger one.
    pub fn judge_from(&self, other: &Self) {
        if let Some(other) = other.reach.get() {
            self.reach.get_or_init(|| self.occupancy().reach_around(self.plan(), self.radius, &other.main));
        }
    }

    /// Returns where the center of a disc of this radius (m) can be; several rules ask for the same one.
    pub fn clear(&self, radius: f64) -> Rc<Bitmap> {
        let key = (radius * 1000.0) as u64;
        self.clear.borrow_mut().entry(key).or_insert_with(|| Rc::new(self.occupancy().clear(radius))).clone()
    }

    /// Returns true when a cell of the map lies within `distance` of the line.
    pub fn near(&self, map: &Bitmap, line: &Segment, distance: f64) -> bool {
        let frame = &self.occupancy().frame;
        let (i0, i1, j0, j1) = frame.span(&line.bounds().grown(distance));
        map.any_in(i0, i1, j0, j1)
    }

    /// Returns true when a disc of this radius standing at the point keeps clear of walls and things, to a grid cell.
    pub fn is_clear(&self, map: &Bitmap, p: Point) -> bool {
        self.occupancy().frame.cell(p).is_some_and(|(i, j)| map.get(i, j))
    }
}

impl Room<'_> {
    /// Returns the free floor between these objects, m.
    pub fn space<'s>(&self, objects: impl Iterator<Item = &'s Object<'s>>) -> FreeSpace {
        let objects = objects.filter(|o| o.blocks).map(|o| o.rect);
        let taken: Vec<Rect> = objects.chain(self.standing.iter().copied()).collect();
        FreeSpace::new(&self.plan.net_polygon, &taken)
    }
}

/// Returns rectangles that make up the net floor of a room.
fn net_floor(plan: &Floorplan, room: &PlanRoom) -> Vec<Rect> {
    plan.taken_in(&room.room_id)
        .iter()
        .fold(room.net_polygon.rects(), |floor, taken| floor.iter().flat_map(|r| r.without(taken)).collect())
}

/// Returns the interval (along the first line) that a line parallel to it and within `distance` shares with it, m.
pub fn shared(first: &Segment, other: &Segment, distance: f64) -> Option<(f64, f64)> {
    if first.is_vertical() != other.is_vertical() {
        return None;
    }
    let (a, b) = (first.bounds(), other.bounds());
    let (apart, from, to) = if first.is_vertical() {
        ((first.start.x - other.start.x).abs(), a.y0.max(b.y0), a.y1.min(b.y1))
    } else {
        ((first.start.y - other.start.y).abs(), a.x0.max(b.x0), a.x1.min(b.x1))
    };
    (apart <= distance && to > from).then_some((from, to))
}

/// Returns the length of a line that the others (parallel, within `distance`) leave uncovered, m.
pub fn uncovered<'s>(line: &Segment, others: impl Iterator<Item = &'s Segment>, distance: f64) -> f64 {
    let mut parts: Vec<(f64, f64)> = others.filter_map(|o| shared(line, o, distance)).collect();
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut covered = 0.0;
    let mut end = f64::MIN;
    for (from, to) in parts {
        covered += (to - from.max(end)).max(0.0);
        end = end.max(to);
    }
    line.length() - covered
}
