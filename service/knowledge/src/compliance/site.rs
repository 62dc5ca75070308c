//! A world indexed for measuring: rooms with their doors, windows and objects, free floor worked out when asked for.

use std::cell::OnceCell;

use d3dgen_model::Rect;
use d3dgen_model::domain::{Domain, ObjectType, RoomType, Shape};
use d3dgen_model::floorplan::{Door, PlanRoom, Window};
use d3dgen_model::occupancy::{Occupancy, stops_robot};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;

use crate::clearance::is_shallow;
use crate::conditions::Guard;
use crate::freespace::FreeSpace;
use crate::retrieve::{Applicable, Retrieval, Scope};

/// The indexed world.
pub(super) struct Site<'a> {
    pub world: &'a World,
    pub domain: &'a Domain,
    pub retrieval: &'a Retrieval,
    pub rooms: Vec<Room<'a>>,
    occupancy: OnceCell<Occupancy>,
}

/// A room with what belongs to it.
pub(super) struct Room<'a> {
    pub plan: &'a PlanRoom,
    pub kind: &'a RoomType,
    pub doors: Vec<&'a Door>,
    pub windows: Vec<&'a Window>,
    pub objects: Vec<Object<'a>>,
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
                space: OnceCell::new(),
            })
            .collect();
        for placement in &world.placements.placements {
            let Some(room) = rooms.iter_mut().find(|r| r.plan.room_id == placement.room_id) else { continue };
            room.objects.push(Object {
                placement,
                kind: domain.object(&placement.object),
                rect: placement.footprint().bounds(),
                blocks: stops_robot(placement) && !is_shallow(placement),
            });
        }
        Self { world, domain, retrieval, rooms, occupancy: OnceCell::new() }
    }

    /// Returns the rooms a constraint is about, those its conditions leave.
    pub fn rooms_of<'s>(&'s self, a: &'s Applicable) -> impl Iterator<Item = &'s Room<'a>> + 's {
        self.rooms.iter().filter(move |room| {
            let about = match &a.scope {
                Scope::Rooms(types) => types.contains(&room.plan.room_type),
                Scope::Circulation => room.plan.circulation,
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

    /// Returns the doors and openings that lead out of the building.
    pub fn exits(&self) -> impl Iterator<Item = &'a Door> {
        self.world.floorplan.doors.iter().filter(|d| d.room_ids.len() == 1)
    }

    /// Returns true when what a constraint asks of the building as a whole holds.
    pub fn admits(&self, a: &Applicable, single_exit: bool) -> bool {
        let exits = self.exits().count() as f64;
        let within = |g: &Guard| !matches!(g, Guard::Exits(min, max) if exits < *min || exits > *max);
        (!single_exit || exits == 1.0) && a.guards.iter().all(within)
    }

    /// Returns how many objects of these builds the building has.
    pub fn count(&self, shapes: &[Shape]) -> usize {
        self.rooms.iter().map(|r| r.count(shapes)).sum()
    }
}

impl Room<'_> {
    /// Returns the free floor between the furniture.
    pub fn space(&self) -> &FreeSpace {
        self.space.get_or_init(|| {
            let taken: Vec<Rect> = self.objects.iter().filter(|o| o.blocks).map(|o| o.rect).collect();
            FreeSpace::new(&self.plan.net_polygon, &taken)
        })
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

    fn passes(&self, guard: &Guard) -> bool {
        let (value, min, max, open) = match *guard {
            Guard::Area(min, max) => (self.plan.net_area_m2, min, max, true),
            Guard::Beds(min, max) => (self.beds() as f64, min, max, false),
            Guard::Seats(min, max) => (self.persons() as f64, min, max, false),
            Guard::Objects(row, min, max) => {
                let kinds = self.objects.iter().filter_map(|o| o.kind);
                let counted = kinds.filter(|k| row.shapes.contains(&k.shape) || row.objects.contains(&k.id));
                (counted.count() as f64, min, max, false)
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
            // asked of the building once
            Guard::Exits(..) => return true,
        };
        (if open { value > min } else { value >= min }) && value <= max
    }
}

impl Object<'_> {
    pub fn is(&self, shapes: &[Shape]) -> bool {
        self.kind.is_some_and(|k| shapes.contains(&k.shape))
    }
}
