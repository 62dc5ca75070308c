//! A domain: everything the stages know about one kind of building, as data.
//!
//! `domains/<id>/domain.toml` holds the [`Domain`] (large domains split it over more `*.toml` files, which are merged
//! table by table); `knowledge.json` beside it holds the constraints. Nothing here names a building type in code.

mod build;
mod clutter;
mod furnishing;
mod layouts;
mod lent;
mod object;
mod program;
mod role;
mod room_type;
pub mod tags;

pub use build::{
    Axis, BASE, Build, BuildJoint, BuildJointKind, Formula, Mirror, Part, Repeat, Side, Solid, Tilt, Tone,
};
pub use clutter::{ClutterLine, ClutterPattern};
pub use furnishing::{Arrangement, FacingRule, Furnishing, Group, Member, Relation};
pub use layouts::{LayoutSwap, Layouts};
pub use lent::Lent;
pub use object::{Mount, ObjectType, Shape, Stock, StockedAsset};
pub use program::{
    Adjacency, AdjacencyRelation, Circulation, Elevator, Large, LockedPart, Occupants, Program, ProgramRoom, Scheme,
    Stairs, Storeys, SupportRoom, TwoStairs, Units,
};
pub use role::{Counted, Number, Role, RoleKind, Round, RoundStep, VISITORS_NEVER, is_named};
pub use room_type::{Access, AreaRange, Daylight, Goods, Materials, Privacy, RobotUse, RoomType, Zone};

use std::collections::BTreeMap;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::document::{Document, Problem, check_unique};

/// Words by language code (`en de fr es zh ko`), lower case; matched against prompts, longest first.
pub type Words = BTreeMap<String, Vec<String>>;

/// Id of the room type that stands in for rooms a prompt names and the domain does not know ("pooja room").
pub const GENERIC_ROOM_TYPE: &str = "room";

/// One kind of building with its own vocabulary, rooms, objects and rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Domain {
    /// Format version of this document; 1.
    pub version: u32,
    /// Snake-case id, equal to the folder name.
    pub id: String,
    /// Name for people, English.
    pub title: String,
    /// One sentence for `domains list`.
    pub description: String,
    /// Words that say a prompt is about this domain ("hospital", "Klinik"); the domain with the longest match wins.
    #[serde(default)]
    pub keywords: Words,
    /// Building types inside the domain ("ward", "dental_practice") with the words that name them.
    #[serde(default)]
    pub building_types: Vec<BuildingType>,
    /// How people and robots move between rooms.
    pub circulation: Circulation,
    /// Room types, in the order a legend would list them.
    pub room_types: Vec<RoomType>,
    /// Room programs by archetype.
    pub programs: Vec<Program>,
    /// Which rooms belong together or apart.
    #[serde(default)]
    pub adjacency: Vec<Adjacency>,
    /// What an open or a cellular layout changes.
    #[serde(default, skip_serializing_if = "Layouts::is_empty")]
    pub layouts: Layouts,
    /// Object types that furnishing refers to.
    pub objects: Vec<ObjectType>,
    /// How the 3D models of its objects are made, beside the shipped builds.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub builds: Vec<Build>,
    /// Objects that stand together as one unit.
    #[serde(default)]
    pub groups: Vec<Group>,
    /// Small things on furniture where clutter is asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clutter: Vec<ClutterLine>,
    /// Scenario roles: ambient people by role.
    #[serde(default)]
    pub roles: Vec<Role>,
    /// Who has a room to work in where the prompt counts them and not their rooms: "practice for three doctors".
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub practitioners: Vec<Practitioner>,
    /// What the other domains of a registry lend it; no part of the document.
    #[serde(skip)]
    pub lent: Arc<Lent>,
}

/// Those who see people in a room of their own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Practitioner {
    /// Type of their room.
    pub room_type: String,
    /// How many of them share one.
    pub per_room: u32,
    /// Words that name them.
    pub keywords: Words,
}

/// A building type inside a domain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BuildingType {
    /// Snake-case id, for instance `dental_practice`.
    pub id: String,
    /// Words that name it.
    pub keywords: Words,
    /// The program it uses when the prompt does not list its rooms.
    pub program: String,
    /// How it stands among others; absent where it stands free.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attached: Option<Attached>,
    /// Room types that have a door to its garden on the ground floor, best first; none for buildings without one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub garden_rooms: Vec<String>,
}

/// What stands wall to wall with a building.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Attached {
    /// Other homes at both of its ends, and the stairs of the building at one: it has windows on two opposite sides at most.
    Flat,
    /// Other houses at both of its ends: windows and doors are at its front and at its back.
    Row,
}

impl Domain {
    /// Returns the domain's own room type with this id.
    pub fn room_type(&self, id: &str) -> Option<&RoomType> {
        self.room_types.iter().find(|t| t.id == id)
    }

    /// Returns the room type with this id, the domain's own or one that another lends it.
    pub fn room_type_or_lent(&self, id: &str) -> Option<&RoomType> {
        self.room_type(id).or_else(|| Some(self.lent.room_type(id)?.1))
    }

    /// Returns the room type with this id, own or lent, or the generic one that every domain has for rooms only a prompt names.
    pub fn room_type_or_generic(&self, id: &str) -> &RoomType {
        let known = self.room_type_or_lent(id);
        known.or_else(|| self.room_type(GENERIC_ROOM_TYPE)).expect("check() demands the generic room type")
    }

    /// Returns the id of the domain that lends rooms of a type; none for the domain's own types and unknown ones.
    pub fn lender_of(&self, room_type: &str) -> Option<&str> {
        self.lent.room_type(room_type).filter(|_| self.room_type(room_type).is_none()).map(|(lender, _)| lender)
    }

    /// Returns the object type with this id, the domain's own or one that is lent with a room.
    pub fn object(&self, id: &str) -> Option<&ObjectType> {
        self.objects.iter().find(|o| o.id == id).or_else(|| self.lent.object(id))
    }

    /// Returns the object types by id, for those who look up thousands of them.
    pub fn objects_by_id(&self) -> BTreeMap<&str, &ObjectType> {
        // own ones come last, and stay
        self.lent.objects().chain(&self.objects).map(|o| (o.id.as_str(), o)).collect()
    }

    /// Returns the group with this id, the domain's own or one that is lent with a room.
    pub fn group(&self, id: &str) -> Option<&Group> {
        self.groups.iter().find(|g| g.id == id).or_else(|| self.lent.group(id))
    }

    /// Returns true when things may stand on an object's top: it is a surface, or small things are put there.
    pub fn holds_things(&self, object: &ObjectType) -> bool {
        object.surface || self.clutter.iter().any(|line| line.on.contains(&object.id))
    }

    /// Returns the object a furnishing item is about: the anchor of a group, or the object itself.
    pub fn anchor(&self, item: &str) -> Option<&ObjectType> {
        self.object(self.group(item).map_or(item, |g| g.anchor.as_str()))
    }

    /// Returns the objects of a furnishing item with how many of each: the anchor of a group and its members, or the object.
    pub fn counted_objects_of<'a>(&'a self, item: &'a str) -> impl Iterator<Item = (&'a str, u32)> {
        let group = self.group(item);
        let members = group.into_iter().flat_map(|g| &g.members).map(|m| (m.object.as_str(), m.count));
        std::iter::once((group.map_or(item, |g| g.anchor.as_str()), 1)).chain(members)
    }

    /// Returns the objects of a furnishing item, its anchor first.
    pub fn objects_of<'a>(&'a self, item: &'a str) -> impl Iterator<Item = &'a str> {
        self.counted_objects_of(item).map(|(id, _)| id)
    }

    /// Returns true for the type of a room that joins the others, whatever the plan calls it.
    pub fn is_way(&self, room_type: &str) -> bool {
        let entrances = &self.circulation.entrance_room_types;
        self.circulation.room_type == room_type || entrances.iter().any(|t| t == room_type)
    }

    /// Returns true for a furnishing item that is about a dock for robots.
    pub fn is_dock(&self, item: &str) -> bool {
        self.anchor(item).is_some_and(|o| o.shape == Shape::Dock)
    }

    /// Returns the program with this id.
    pub fn program(&self, id: &str) -> Option<&Program> {
        self.programs.iter().find(|p| p.id == id)
    }

    /// Returns the kind of building with this id.
    pub fn building_type(&self, id: &str) -> Option<&BuildingType> {
        self.building_types.iter().find(|b| b.id == id)
    }
}

impl Document for Domain {
    const KIND: &'static str = "domain";

    fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new("/version", format!("is {}, this release reads version 1", self.version)));
        }
        check_unique("/room_types", self.room_types.iter().map(|t| t.id.as_str()), &mut problems);
        check_unique("/objects", self.objects.iter().map(|o| o.id.as_str()), &mut problems);
        check_unique("/builds", self.builds.iter().map(|b| b.id.as_str()), &mut problems);
        check_unique("/groups", self.groups.iter().map(|g| g.id.as_str()), &mut problems);
        check_unique("/programs", self.programs.iter().map(|p| p.id.as_str()), &mut problems);
        let room = |path: String, id: &str, problems: &mut Vec<Problem>| {
            if self.room_type(id).is_none() {
                problems.push(Problem::new(path, format!("room type `{id}` is not in room_types")));
            }
        };
        room("/room_types".into(), GENERIC_ROOM_TYPE, &mut problems);
        room("/circulation/room_type".into(), &self.circulation.room_type, &mut problems);
        for (i, building) in self.building_types.iter().enumerate() {
            for (j, id) in building.garden_rooms.iter().enumerate() {
                room(format!("/building_types/{i}/garden_rooms/{j}"), id, &mut problems);
            }
        }
        for (i, id) in self.circulation.hub_room_types.iter().enumerate() {
            room(format!("/circulation/hub_room_types/{i}"), id, &mut problems);
        }
        for (i, id) in self.circulation.entrance_room_types.iter().enumerate() {
            room(format!("/circulation/entrance_room_types/{i}"), id, &mut problems);
        }
        for (i, part) in self.circulation.locked.iter().enumerate() {
            for (name, ids) in [("because", &part.because), ("rooms", &part.rooms), ("locks", &part.locks)] {
                for (j, id) in ids.iter().enumerate() {
                    room(format!("/circulation/locked/{i}/{name}/{j}"), id, &mut problems);
                }
            }
        }
        if let Some(storeys) = &self.circulation.storeys {
            let at = "/circulation/storeys";
            room(format!("{at}/stairs/room_type"), &storeys.stairs.room_type, &mut problems);
            if let Some(elevator) = &storeys.elevator {
                room(format!("{at}/elevator/room_type"), &elevator.room_type, &mut problems);
            }
            if self.object(&storeys.stairs.object).is_none() {
                let message = format!("object `{}` is not in objects", storeys.stairs.object);
                problems.push(Problem::new(format!("{at}/stairs/object"), message));
            }
            for (key, list) in [
                ("ground_room_types", &storeys.ground_room_types),
                ("upper_room_types", &storeys.upper_room_types),
                ("each_level_room_types", &storeys.each_level_room_types),
                ("carrying_room_types", &storeys.carrying_room_types),
            ] {
                for (i, id) in list.iter().enumerate() {
                    room(format!("{at}/{key}/{i}"), id, &mut problems);
                }
            }
            if !(0.1..=0.3).contains(&storeys.stairs.rise_m) || !(0.15..=0.6).contains(&storeys.stairs.going_m) {
                let message = "a rise is 0.1-0.3 m and a going 0.15-0.6 m";
                problems.push(Problem::new(format!("{at}/stairs"), message));
            }
        }
        if self.programs.is_empty() {
            problems.push(Problem::new("/programs", "is empty; a domain needs at least one program"));
        }
        for (i, program) in self.programs.iter().enumerate() {
            for (j, entry) in program.rooms.iter().enumerate() {
                room(format!("/programs/{i}/rooms/{j}/room_type"), &entry.room_type, &mut problems);
                for (k, id) in entry.with.iter().enumerate() {
                    room(format!("/programs/{i}/rooms/{j}/with/{k}"), id, &mut problems);
                }
            }
            for (j, id) in program.vital.iter().enumerate() {
                room(format!("/programs/{i}/vital/{j}"), id, &mut problems);
            }
            let large = program.large.iter().enumerate().map(|(j, l)| (format!("large/{j}/rooms"), &l.rooms));
            for (list, entries) in std::iter::once(("support".to_owned(), &program.support)).chain(large) {
                for (j, entry) in entries.iter().enumerate() {
                    room(format!("/programs/{i}/{list}/{j}/room_type"), &entry.room_type, &mut problems);
                    for (k, id) in entry.or.iter().enumerate() {
                        room(format!("/programs/{i}/{list}/{j}/or/{k}"), id, &mut problems);
                    }
                }
            }
            for (name, id) in &program.means {
                room(format!("/programs/{i}/means/{name}"), id, &mut problems);
            }
            for (j, id) in program.robot_rooms.iter().enumerate() {
                room(format!("/programs/{i}/robot_rooms/{j}"), id, &mut problems);
            }
            let Some(units) = &program.units else { continue };
            let at = format!("/programs/{i}/units");
            if units.programs.is_empty() || units.rooms < 2 || units.from_rooms <= units.rooms {
                let message = "needs a program, 2 rooms a unit, and from_rooms above that";
                problems.push(Problem::new(at.as_str(), message));
            }
            for (j, id) in units.programs.iter().enumerate().filter(|(_, id)| self.program(id).is_none()) {
                let message = format!("program `{id}` is not in programs");
                problems.push(Problem::new(format!("{at}/programs/{j}"), message));
            }
        }
        for (i, building) in self.building_types.iter().enumerate() {
            if self.program(&building.program).is_none() {
                problems.push(Problem::new(
                    format!("/building_types/{i}/program"),
                    format!("program `{}` is not in programs", building.program),
                ));
            }
        }
        for (i, pair) in self.adjacency.iter().enumerate() {
            room(format!("/adjacency/{i}/a"), &pair.a, &mut problems);
            room(format!("/adjacency/{i}/b"), &pair.b, &mut problems);
        }
        for (i, room_type) in self.room_types.iter().enumerate() {
            room_type.check(&format!("/room_types/{i}"), self, &mut problems);
        }
        for (i, object) in self.objects.iter().enumerate() {
            object.check(&format!("/objects/{i}"), &mut problems);
        }
        for (i, build) in self.builds.iter().enumerate() {
            build.check(&format!("/builds/{i}"), &mut problems);
        }
        for (i, group) in self.groups.iter().enumerate() {
            group.check(&format!("/groups/{i}"), self, &mut problems);
        }
        self.layouts.check(self, &mut problems);
        for (i, line) in self.clutter.iter().enumerate() {
            line.check(&format!("/clutter/{i}"), self, &mut problems);
        }
        for (i, who) in self.practitioners.iter().enumerate() {
            room(format!("/practitioners/{i}/room_type"), &who.room_type, &mut problems);
            if who.per_room == 0 {
                problems.push(Problem::new(format!("/practitioners/{i}/per_room"), "needs 1 at least"));
            }
        }
        check_unique("/roles", self.roles.iter().map(|r| r.id.as_str()), &mut problems);
        for (i, role) in self.roles.iter().enumerate() {
            role.check(&format!("/roles/{i}"), self, &mut problems);
        }
        problems
    }
}
