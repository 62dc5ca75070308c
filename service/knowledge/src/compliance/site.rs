//! A world indexed for measuring: rooms with their doors, windows and objects, free floor worked out when asked for.

use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use d3dgen_model::domain::{Domain, Mount, ObjectType, RoomType, Shape, Zone};
use d3dgen_model::floorplan::{Door, PlanRoom, Window};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::occupancy::{Occupancy, stops_robot};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;
use d3dgen_model::{Point, Rect, Segment, TOLERANCE_M};

use crate::clearance::{HEAD_ROOM_M, is_shallow, quarter};
use crate::conditions::Guard;
use crate::freespace::FreeSpace;
use crate::retrieve::{Applicable, Retrieval, Scope};
use crate::tables::{ConditionRow, TABLES, When};
use crate::travel::Distances;

/// Space name of rooms that are no part of a dwelling's floor area.
const OUTSIDE: &str = "outside_dwelling";
/// A door stands in a wall that is at most this far from its line, m.
const IN_WALL_M: f64 = 0.3;
/// Beds at least this wide are for two, m: the narrowest that is sold so is 1.2 m, and for one the widest is 1.1 m.
const FOR_TWO_M: f64 = 1.2;
/// Beds narrower than this are cots, m.
const FOR_ONE_M: f64 = 0.75;

/// The indexed world.
pub(super) struct Site<'a> {
    pub world: &'a World,
    pub domain: &'a Domain,
    pub retrieval: &'a Retrieval,
    pub rooms: Vec<Room<'a>>,
    exits: Vec<&'a Door>,
    occupancy: OnceCell<Occupancy>,
    /// Ways by the points that they lead to, whole millimeters.
    ways: RefCell<BTreeMap<Vec<[i64; 2]>, Rc<Distances>>>,
}

/// A room with what belongs to it.
pub(super) struct Room<'a> {
    pub plan: &'a PlanRoom,
    pub kind: &'a RoomType,
    pub doors: Vec<&'a Door>,
    pub windows: Vec<&'a Window>,
    pub objects: Vec<Object<'a>>,
    /// Rectangles that cover its columns and free walls.
    pub standing: Vec<Rect>,
    space: OnceCell<FreeSpace>,
}

/// An object with its type and outline.
pub(super) struct Object<'a> {
    pub placement: &'a Placement,
    pub kind: Option<&'a ObjectType>,
    pub rect: Rect,
    /// True when it takes floor from people; handrails and signs do not.
    pub blocks: bool,
}

impl<'a> Site<'a> {
    pub fn new(world: &'a World, domain: &'a Domain, retrieval: &'a Retrieval) -> Self {
        let plan = &world.floorplan;
        let mut rooms: Vec<Room> = plan
            .rooms
            .iter()
            .map(|room| Room {
                plan: room,
                kind: domain.room_type_or_generic(&room.room_type),
                doors: plan.doors_of(&room.room_id).collect(),
                windows: plan.windows.iter().filter(|w| w.room_id == room.room_id).collect(),
                objects: Vec::new(),
                standing: plan.taken_in(&room.room_id),
                space: OnceCell::new(),
            })
            .collect();
        let kinds = domain.objects_by_id();
        let at: BTreeMap<&str, usize> = plan.rooms.iter().enumerate().map(|(i, r)| (r.room_id.as_str(), i)).collect();
        for placement in &world.placements.placements {
            let Some(room) = at.get(placement.room_id.as_str()) else { continue };
            rooms[*room].objects.push(Object {
                placement,
                kind: kinds.get(placement.object.as_str()).copied(),
                rect: placement.footprint().bounds(),
                blocks: stops_robot(placement) && !is_shallow(placement),
            });
        }
        let exits = plan.ways_out();
        Self { world, domain, retrieval, rooms, exits, occupancy: OnceCell::new(), ways: RefCell::default() }
    }

    /// Returns the rooms a constraint is about, those its conditions leave.
    pub fn rooms_of<'s>(&'s self, a: &'s Applicable) -> impl Iterator<Item = &'s Room<'a>> + 's {
        self.rooms.iter().filter(move |room| {
            let about = match &a.scope {
                Scope::Rooms(types) => types.contains(&room.plan.room_type),
                // stairwells and shafts are as wide as what they hold
                Scope::Circulation => {
                    room.plan.circulation && self.world.floorplan.link_of(&room.plan.room_id).is_none()
                }
                Scope::Objects(shapes) => room.has(shapes),
                Scope::Building | Scope::Doors | Scope::Entrance => false,
            };
            about && a.guards.iter().all(|g| room.passes(g))
        })
    }

    /// Returns the free floor of the furnished world.
    pub fn occupancy(&self) -> &Occupancy {
        self.occupancy.get_or_init(|| Occupancy::of_world(&self.world.floorplan, &self.world.placements))
    }

    /// Returns how far it is from everywhere to the nearest of these points; many rules ask for the same ones.
    pub fn distances(&self, to: &[Point]) -> Rc<Distances> {
        let mm = |m: f64| (to_mm(m) * 1000.0).round() as i64;
        let key: Vec<[i64; 2]> = to.iter().map(|p| [mm(p.x), mm(p.y)]).collect();
        let mut ways = self.ways.borrow_mut();
        ways.entry(key).or_insert_with(|| Rc::new(Distances::from(self.occupancy(), to))).clone()
    }

    /// Returns the doors and openings that lead out of the building.
    pub fn exits(&self) -> impl Iterator<Item = &'a Door> {
        self.exits.iter().copied()
    }

    /// Returns true for a door that leads out of the building.
    pub fn is_exit(&self, door: &Door) -> bool {
        self.exits.iter().any(|d| d.door_id == door.door_id)
    }

    /// Returns true when what a constraint asks of the building as a whole holds.
    pub fn admits(&self, a: &Applicable, single_exit: bool) -> bool {
        let exits = self.exits().count() as f64;
        let within = |g: &Guard| match *g {
            Guard::Exits(min, max) => (min..=max).contains(&exits),
            Guard::Whole(row) => row.holds(self.figure(row)),
            _ => true,
        };
        (!single_exit || exits == 1.0) && a.guards.iter().all(within)
    }

    /// Returns the figure of the building that a condition asks for.
    fn figure(&self, row: &ConditionRow) -> f64 {
        let objects = || self.rooms.iter().flat_map(|r| &r.objects).filter_map(|o| o.kind);
        match row.when {
            When::Bedspaces => self.rooms.iter().map(Room::bedspaces).sum::<usize>() as f64,
            When::Storeys => self.world.floorplan.levels.len().max(1) as f64,
            When::BuildingArea => self.net_area(false),
            _ => objects().filter(|k| row.counts(k)).count() as f64,
        }
    }

    /// Returns the net floor area of the building, or of its circulation alone, m^2: without what lies under the sky and what is
    /// no part of a dwelling (its garage).
    pub fn net_area(&self, circulation_only: bool) -> f64 {
        let outside = TABLES.space(OUTSIDE, &self.domain.id);
        let counts = |r: &&Room| {
            let left_out =
                r.kind.zone == Zone::Outdoor || outside.is_some_and(|row| row.room_types.contains(&r.plan.room_type));
            !left_out && (r.plan.circulation || !circulation_only)
        };
        self.rooms.iter().filter(counts).map(|r| r.plan.net_area_m2).sum()
    }

    /// Returns the gross floor area on wall center lines, m^2.
    pub fn gross_area(&self) -> f64 {
        self.rooms.iter().map(|r| r.plan.polygon.area()).sum()
    }

    /// Returns how many objects of these builds the building has.
    pub fn count(&self, shapes: &[Shape]) -> usize {
        self.rooms.iter().map(|r| r.count(shapes)).sum()
    }
}

impl Room<'_> {
    /// Returns the free floor between the furniture.
    pub fn space(&self) -> &FreeSpace {
        self.space.get_or_init(|| FreeSpace::new(&self.plan.net_polygon, &self.taken().collect::<Vec<_>>()))
    }

    /// Returns the floor of all that blocks the way.
    pub fn taken(&self) -> impl Iterator<Item = Rect> {
        let objects = self.objects.iter().filter(|o| o.blocks).map(|o| o.rect);
        objects.chain(self.standing.iter().copied())
    }

    /// Returns the floor of all that blocks the way but one object and what was placed with it.
    pub fn others(&self, object: &Object) -> impl Iterator<Item = Rect> {
        let objects = self.objects.iter().filter(move |o| o.blocks && !belong_together(o, object)).map(|o| o.rect);
        objects.chain(self.standing.iter().copied())
    }

    /// Returns the free floor for people upright: what stands out from walls above a robot's head takes some of it too.
    pub fn space_upright(&self) -> FreeSpace {
        let stands_out = |o: &Object| {
            o.placement.mount == Mount::Wall && !is_shallow(o.placement) && o.placement.pose.z < HEAD_ROOM_M
        };
        let objects = self.objects.iter().filter(|o| o.blocks || stands_out(o)).map(|o| o.rect);
        let taken: Vec<Rect> = objects.chain(self.standing.iter().copied()).collect();
        FreeSpace::new(&self.plan.net_polygon, &taken)
    }

    pub fn count(&self, shapes: &[Shape]) -> usize {
        self.objects.iter().filter(|o| o.is(shapes)).count()
    }

    pub fn has(&self, shapes: &[Shape]) -> bool {
        self.objects.iter().any(|o| o.is(shapes))
    }

    pub fn beds(&self) -> usize {
        self.count(&[Shape::Bed, Shape::HospitalBed])
    }

    /// Returns how many people work or sit in the room: its desks, or its seats when it has none.
    pub fn persons(&self) -> usize {
        let desks = self.count(&[Shape::Desk]);
        if desks > 0 { desks } else { self.count(&[Shape::Chair, Shape::SwivelChair, Shape::Stool]) }
    }

    /// Returns how many people the beds are for: two where one is wide enough.
    pub fn bedspaces(&self) -> usize {
        let beds = self.objects.iter().filter(|o| o.is(&[Shape::Bed]) && o.placement.size_m[0] >= FOR_ONE_M);
        let sleep: usize = beds.map(|o| if o.placement.size_m[0] >= FOR_TWO_M { 2 } else { 1 }).sum();
        sleep + self.count(&[Shape::HospitalBed])
    }

    /// Returns the figure of the room that a condition asks for.
    fn figure(&self, row: &ConditionRow) -> f64 {
        let bounds = self.plan.net_polygon.bounds();
        match row.when {
            When::BedspacesInRoom => self.bedspaces() as f64,
            // a millimeter, so that a height given in centimeters is itself
            When::Ceiling => (self.plan.ceiling_height_m * 1000.0).round() / 1000.0,
            When::DoorsOfRoom => self.doors.len() as f64,
            When::RoomLength => bounds.width().max(bounds.height()),
            When::BothSides => self.sides_with_doors() as f64,
            _ => {
                let counted = self.objects.iter().filter(|o| o.kind.is_some_and(|k| row.counts(k)));
                counted.map(|o| quarter(o.placement.pose.yaw_rad)).collect::<BTreeSet<_>>().len() as f64
            }
        }
    }

    /// Returns at how many of its sides a corridor has doors to rooms: two where somewhere along it doors stand in walls that
    /// face each other, however often it bends.
    fn sides_with_doors(&self) -> usize {
        let walls: Vec<Segment> = self.plan.net_polygon.edges().collect();
        let has_door = |wall: &Segment| {
            let bounds = wall.bounds().grown(IN_WALL_M);
            let in_it = |d: &&Door| {
                let middle = d.line.middle();
                d.room_ids.len() == 2
                    && d.line.is_vertical() == wall.is_vertical()
                    && bounds.contains(&Rect::new(middle.x, middle.y, middle.x, middle.y))
            };
            self.doors.iter().any(in_it)
        };
        let with_doors: Vec<&Segment> = walls.iter().filter(|w| has_door(w)).collect();
        let facing = |a: &Segment, b: &Segment| faces(a, b, &walls);
        let both = with_doors.iter().any(|a| with_doors.iter().any(|b| facing(a, b)));
        if both { 2 } else { with_doors.len().min(1) }
    }

    /// Returns true when the room meets a condition.
    pub fn passes(&self, guard: &Guard) -> bool {
        let (value, min, max, open) = match *guard {
            Guard::Area(min, max) => (self.plan.net_area_m2, min, max, true),
            Guard::Beds(min, max) => (self.beds() as f64, min, max, false),
            Guard::Seats(min, max) => (self.persons() as f64, min, max, false),
            Guard::Objects(row, min, max) => {
                let counted = self.objects.iter().filter_map(|o| o.kind).filter(|k| row.counts(k)).count();
                (counted as f64, min, max, false)
            }
            Guard::Named(row) => {
                let name = self.plan.name.to_lowercase();
                return row.words.iter().any(|w| name.contains(w.as_str()));
            }
            // the door that leads out of it: doors of rooms that hang on it have their leaf where they will
            Guard::OpensInto(inward) => {
                let into =
                    |d: &&&Door| d.swing.as_ref().is_some_and(|s| s.into_room_id.as_ref() == Some(&self.plan.room_id));
                return self.doors.len() == 1 && (self.doors.iter().filter(into).count() == 1) == inward;
            }
            Guard::Room(row) => return row.holds(self.figure(row)),
            // asked of the building once
            Guard::Exits(..) | Guard::Whole(_) => return true,
        };
        (if open { value > min } else { value >= min }) && value <= max
    }
}

/// Returns true for walls of an outline that face each other over a piece of it that is longer than wide, with no wall
/// between them.
fn faces(a: &Segment, b: &Segment, walls: &[Segment]) -> bool {
    if a.is_vertical() != b.is_vertical() {
        return false;
    }
    let ((p, a0, a1), (q, b0, b1)) = (a.span(), b.span());
    let (low, high) = (a0.max(b0), a1.min(b1));
    let (near, far) = (p.min(q), p.max(q));
    let opposite = (a.end.x - a.start.x) * (b.end.x - b.start.x) + (a.end.y - a.start.y) * (b.end.y - b.start.y) < 0.0;
    let between = walls.iter().any(|w| {
        let (at, from, to) = w.span();
        w.is_vertical() == a.is_vertical()
            && at > near + TOLERANCE_M
            && at < far - TOLERANCE_M
            && from < high
            && to > low
    });
    opposite && high - low >= far - near && far > near && !between
}

impl Object<'_> {
    pub fn is(&self, shapes: &[Shape]) -> bool {
        self.kind.is_some_and(|k| shapes.contains(&k.shape))
    }
}

/// Returns true for an object and what was placed with it (a desk and its chair): they share their clearance.
pub(super) fn belong_together(a: &Object, b: &Object) -> bool {
    a.placement.placement_id == b.placement.placement_id
        || (a.placement.group.is_some() && a.placement.group == b.placement.group)
}
