//! A world as simulators need it: walls as boxes with their openings cut, slabs, leaves that move, things with their mass,
//! lights and zones; each with one id that every format uses.
//!
//! Data only, in meters, radians and kilograms, x east, y north, z up from the ground floor. Nothing here assumes walls along
//! x and y. What it is not for: the words of a format, which are the business of its exporter.

mod convex;
mod doors;
mod floors;
mod ids;
mod manifest;
mod merge;
mod objects;
mod passing;
mod physics;
mod walls;
mod ways;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use d3dgen_mesh::Model3d;
use d3dgen_model::domain::{Domain, Materials, Zone};
use d3dgen_model::floorplan::{DoorKind, PlanRoom};
use d3dgen_model::geometry::{Point, Polygon};
use d3dgen_model::scenario::RoiKind;
use d3dgen_model::world::World;

use crate::error::Error;
use crate::models::KeptModels;
use ids::Ids;

pub use merge::merged;
pub use ways::{SimWay, way_radius_m};

/// Thickness of a floor, m: a hollow-core slab with screed.
pub const FLOOR_M: f64 = 0.2;
/// Thickness of a ceiling's boards, m.
pub const CEILING_M: f64 = 0.05;

/// A world for simulators.
#[derive(Debug, Clone, PartialEq)]
pub struct SimScene {
    /// Name of the world.
    pub name: String,
    /// Storeys from the lowest.
    pub storeys: Vec<SimStorey>,
    /// Rooms, with their floors and ceilings.
    pub rooms: Vec<SimRoom>,
    /// Walls, lintels, sills, columns.
    pub walls: Vec<SimWall>,
    /// Doors and open passages.
    pub doors: Vec<SimDoor>,
    /// Windows.
    pub windows: Vec<SimWindow>,
    /// Distinct models, by reference.
    pub models: Vec<SimModel>,
    /// Things that stand, hang and lie about.
    pub objects: Vec<SimObject>,
    /// Parts of things that do not meet other things.
    pub passes: Vec<SimPass>,
    /// Lamps that give light; the sun and the sky are the business of formats.
    pub lights: Vec<SimLight>,
    /// Zones of robots.
    pub zones: Vec<SimZone>,
    /// Robots and the routes that they drive.
    pub robots: Vec<SimRobot>,
    /// A way through the middle of every doorway.
    pub doorways: Vec<SimWay>,
}

/// A storey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimStorey {
    /// Its number, 0 at the ground.
    pub level: i32,
    /// Height of its floor, m.
    pub elevation_m: f64,
    /// From its floor to the floor above, m; of the highest one, to the top of its walls.
    pub height_m: f64,
}

/// A box that stands upright, turned about z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimBox {
    /// Middle, m.
    pub center_m: [f64; 3],
    /// Half its extents along its own axes, m.
    pub half_m: [f64; 3],
    /// Heading of its own x, rad.
    pub yaw_rad: f64,
}

/// A convex solid of the building.
#[derive(Debug, Clone, PartialEq)]
pub enum SimShape {
    /// An upright box.
    Box(SimBox),
    /// A convex outline, counter-clockwise, between two heights, m.
    Prism {
        /// Corners.
        outline: Vec<Point>,
        /// Underside and top, m.
        z_m: [f64; 2],
    },
}

/// A room.
#[derive(Debug, Clone, PartialEq)]
pub struct SimRoom {
    /// Id.
    pub id: String,
    /// Room id of the documents.
    pub room_id: String,
    /// Room type.
    pub class: String,
    /// Name for people.
    pub label: String,
    /// Storey.
    pub level: i32,
    /// Height of its floor, m.
    pub floor_m: f64,
    /// Height of its ceiling above its floor, m.
    pub ceiling_m: f64,
    /// Outline on wall faces.
    pub net: Polygon,
    /// Names of its surfaces.
    pub materials: Materials,
    /// Slab, in convex pieces; none in a shaft, whose floor is further down.
    pub floor: Vec<SimShape>,
    /// Boards, in convex pieces; none outdoors and in a shaft.
    pub ceiling: Vec<SimShape>,
    /// True under the sky.
    pub outdoor: bool,
}

/// A piece of wall or a column.
#[derive(Debug, Clone, PartialEq)]
pub struct SimWall {
    /// Id.
    pub id: String,
    /// Storey.
    pub level: i32,
    /// Room ids on its sides.
    pub room_ids: Vec<String>,
    /// True when one side is outdoors.
    pub exterior: bool,
    /// Name of its surface.
    pub material: String,
    /// Convex pieces that overlap nowhere.
    pub pieces: Vec<SimPiece>,
}

/// A convex piece of a wall.
#[derive(Debug, Clone, PartialEq)]
pub struct SimPiece {
    /// Which part of the wall it is.
    pub part: WallPart,
    /// Its form.
    pub shape: SimShape,
}

/// A part of a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WallPart {
    /// From floor to top.
    Pier,
    /// Above an opening.
    Lintel,
    /// Below a window.
    Sill,
    /// Beside the pocket of a sliding leaf.
    Skin,
    /// A column or a wall that stands free.
    Column,
}

impl WallPart {
    /// Returns its name, lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pier => "pier",
            Self::Lintel => "lintel",
            Self::Sill => "sill",
            Self::Skin => "skin",
            Self::Column => "column",
        }
    }
}

/// A door or an open passage.
#[derive(Debug, Clone, PartialEq)]
pub struct SimDoor {
    /// Id.
    pub id: String,
    /// What fills it.
    pub kind: DoorKind,
    /// Storey.
    pub level: i32,
    /// Room ids on its sides: two, or one where it leads out.
    pub room_ids: Vec<String>,
    /// Middle of the opening on the floor, m.
    pub at_m: [f64; 3],
    /// Heading of the opening's line from start to end, rad.
    pub yaw_rad: f64,
    /// Clear width and height, m.
    pub clear_m: [f64; 2],
    /// Thickness of its wall, m.
    pub thickness_m: f64,
    /// It opens by itself.
    pub automatic: bool,
    /// The route of a robot passes it.
    pub on_route: bool,
    /// Jambs beside the clear opening.
    pub frame: Vec<SimBox>,
    /// Leaves; none in an open passage.
    pub leaves: Vec<SimLeaf>,
}

/// A leaf of a door, closed.
#[derive(Debug, Clone, PartialEq)]
pub struct SimLeaf {
    /// Id.
    pub id: String,
    /// Where it is while the door is closed.
    pub closed: SimBox,
    /// How it moves against the building.
    pub joint: SimJoint,
    /// Mass, kg.
    pub mass_kg: f64,
    /// A counterweight bears it: gravity does not pull it down.
    pub balanced: bool,
    /// Middle of the handle on each face, in the frame of the closed box, m; what is seen only.
    pub handles_m: Vec<[f64; 3]>,
}

/// A joint of the building.
#[derive(Debug, Clone, PartialEq)]
pub struct SimJoint {
    /// Id.
    pub id: String,
    /// True for a hinge, false for a slide.
    pub hinge: bool,
    /// A point of the axis, m.
    pub origin_m: [f64; 3],
    /// Direction, unit length.
    pub axis: [f64; 3],
    /// Closed and open: rad, or m of a slide; closed is 0.
    pub limits: [f64; 2],
    /// N m s/rad, or N s/m.
    pub damping: f64,
    /// N m, or N.
    pub friction: f64,
}

/// A window.
#[derive(Debug, Clone, PartialEq)]
pub struct SimWindow {
    /// Id.
    pub id: String,
    /// Storey.
    pub level: i32,
    /// Room it lights.
    pub room_id: String,
    /// Pane.
    pub glass: SimBox,
    /// Frame: two sides, sill and head.
    pub frame: Vec<SimBox>,
}

/// A model that things are instances of.
#[derive(Debug, Clone, PartialEq)]
pub struct SimModel {
    /// Reference `Domain/Name`, with the size where the world has it in several.
    pub reference: String,
    /// The same as a name of letters, digits and underscores, unique among the models.
    pub id: String,
    /// Object id of the domain.
    pub object: String,
    /// It is of a database of assets, and its licence is that of its source; models that are made are free.
    pub is_kept: bool,
    /// The model: front at -y, origin in the middle of its underside.
    pub model: Arc<Model3d>,
}

/// A thing.
#[derive(Debug, Clone, PartialEq)]
pub struct SimObject {
    /// Id.
    pub id: String,
    /// Object id of the domain: the class of its label.
    pub class: String,
    /// Name for people.
    pub label: String,
    /// Room it is in.
    pub room_id: String,
    /// Storey.
    pub level: i32,
    /// Index into the models.
    pub model: usize,
    /// Origin of the model, m.
    pub at_m: [f64; 3],
    /// Heading of the model's x, rad.
    pub yaw_rad: f64,
    /// Id of the thing it stands on.
    pub support: Option<String>,
    /// Whether it can be moved.
    pub mobility: Mobility,
    /// False for what lies flat on the floor: rugs and mats, which wheels and legs stand on.
    pub collides: bool,
    /// Mass of all its bodies, kg.
    pub mass_kg: f64,
    /// Coefficient of sliding friction.
    pub friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
}

/// A door or a drawer of a thing that does not meet another thing: one that can be moved and stands in its way, a chair drawn
/// up to a desk, would jam it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SimPass {
    /// Index of the thing.
    pub object: usize,
    /// Name of the body of its model.
    pub body: String,
    /// Index of the thing in the way.
    pub other: usize,
}

/// Whether a thing can be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mobility {
    /// Part of the building, or too heavy.
    Fixed,
    /// It can be pushed.
    Movable,
    /// It can be lifted with one hand.
    Graspable,
}

impl Mobility {
    /// Returns its name, lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Movable => "movable",
            Self::Graspable => "graspable",
        }
    }
}

/// A lamp that gives light.
#[derive(Debug, Clone, PartialEq)]
pub struct SimLight {
    /// Id.
    pub id: String,
    /// Id of the thing that gives it.
    pub object: String,
    /// Room it is in.
    pub room_id: String,
    /// Where, m.
    pub at_m: [f64; 3],
    /// Luminous flux, lm.
    pub lumens: f64,
    /// Color temperature, K.
    pub kelvin: f64,
    /// It hangs from the ceiling, and shines down.
    pub down: bool,
}

/// A zone of robots.
#[derive(Debug, Clone, PartialEq)]
pub struct SimZone {
    /// Id.
    pub id: String,
    /// What it is.
    pub kind: RoiKind,
    /// Room it lies in.
    pub room_id: String,
    /// Height of the floor, m.
    pub floor_m: f64,
    /// Outline.
    pub outline: Polygon,
}

/// A robot and the way that it drives.
#[derive(Debug, Clone, PartialEq)]
pub struct SimRobot {
    /// Id.
    pub id: String,
    /// Kind of robot.
    pub kind: String,
    /// Radius of the disc that its ways are planned for, m.
    pub radius_m: f64,
    /// Height, m.
    pub height_m: f64,
    /// Where it starts, on the floor, m.
    pub start_m: [f64; 3],
    /// Heading at the start, rad.
    pub yaw_rad: f64,
    /// The legs of its round.
    pub routes: Vec<SimWay>,
}

impl SimScene {
    /// Returns the world as simulators need it.
    ///
    /// # Errors
    /// `Unsupported` when an asset reference is no name; `Model`, `Kept` or `Asset` when a model cannot be had or is broken.
    pub fn of(world: &World, domain: &Domain, kept: &dyn KeptModels) -> Result<Self, Error> {
        let mut ids = Ids::default();
        let storeys = storeys(world);
        let elevation = |level: i32| storeys.iter().find(|s| s.level == level).map_or(0.0, |s| s.elevation_m);
        let level_of: BTreeMap<&str, i32> =
            world.floorplan.rooms.iter().map(|r| (r.room_id.as_str(), r.level)).collect();
        let place = Place { world, domain, storeys: &storeys, level_of: &level_of };
        let rooms = place.rooms(&mut ids);
        let robots = place.robots(&mut ids);
        let doors = doors::all(&place, &robots, &mut ids);
        let walls = walls::all(&place, &doors, &mut ids);
        let windows = walls::windows(&place, &mut ids);
        let things = objects::all(&place, kept, &mut ids)?;
        let zones = world.scenario.rois.iter().map(|roi| SimZone {
            id: ids.new_id(&roi.roi_id),
            kind: roi.kind,
            room_id: roi.room_id.clone(),
            floor_m: elevation(place.level(&roi.room_id)),
            outline: roi.polygon.clone(),
        });
        Ok(Self {
            name: world.name.clone(),
            zones: zones.collect(),
            doorways: ways::doorways(&place, &robots),
            rooms,
            walls,
            doors,
            windows,
            passes: passing::all(&things.models, &things.objects),
            models: things.models,
            objects: things.objects,
            lights: things.lights,
            robots,
            storeys,
        })
    }

    /// Returns the height of the ground around the building, m: a step below its lowest floor.
    pub fn ground_m(&self) -> f64 {
        self.storeys.iter().map(|s| s.elevation_m).fold(0.0, f64::min) - 0.02
    }
}

/// What the parts of a scene are made from.
struct Place<'a> {
    world: &'a World,
    domain: &'a Domain,
    storeys: &'a [SimStorey],
    level_of: &'a BTreeMap<&'a str, i32>,
}

impl Place<'_> {
    fn level(&self, room_id: &str) -> i32 {
        self.level_of.get(room_id).copied().unwrap_or(0)
    }

    fn storey(&self, level: i32) -> SimStorey {
        let found = self.storeys.iter().find(|s| s.level == level).copied();
        found.unwrap_or(SimStorey { level, elevation_m: 0.0, height_m: 3.0 })
    }

    fn is_outdoor(&self, room: &PlanRoom) -> bool {
        self.domain.room_type_or_generic(&room.room_type).zone == Zone::Outdoor
    }

    fn rooms(&self, ids: &mut Ids) -> Vec<SimRoom> {
        let plan = &self.world.floorplan;
        // A shaft has its floor on its lowest storey, and its ceiling on its highest.
        let above: BTreeSet<&str> =
            plan.links.iter().flat_map(|l| l.room_ids.iter().skip(1)).map(String::as_str).collect();
        let below: BTreeSet<&str> =
            plan.links.iter().flat_map(|l| l.room_ids.iter().rev().skip(1)).map(String::as_str).collect();
        let one = |room: &PlanRoom, id: String| {
            let (storey, outdoor) = (self.storey(room.level), self.is_outdoor(room));
            let floor = storey.elevation_m;
            let top = floor + room.ceiling_height_m;
            let slab = |is_there: bool, z_m| if is_there { floors::slab(&room.polygon, z_m) } else { Vec::new() };
            SimRoom {
                id,
                room_id: room.room_id.clone(),
                class: room.room_type.clone(),
                label: room.name.clone(),
                level: room.level,
                floor_m: floor,
                ceiling_m: room.ceiling_height_m,
                net: room.net_polygon.clone(),
                materials: room.materials.clone(),
                floor: slab(!above.contains(room.room_id.as_str()), [floor - FLOOR_M, floor]),
                ceiling: slab(!outdoor && !below.contains(room.room_id.as_str()), [top, top + CEILING_M]),
                outdoor,
            }
        };
        plan.rooms.iter().map(|room| one(room, ids.new_id(&room.room_id))).collect()
    }

    fn robots(&self, ids: &mut Ids) -> Vec<SimRobot> {
        let at = |p: Point, level: i32| [p.x, p.y, self.storey(level).elevation_m];
        let tasks = self.world.scenario.robots.iter();
        tasks
            .map(|task| {
                let id = ids.new_id(&task.robot_id);
                let leg = |(i, route): (usize, &d3dgen_model::scenario::Route)| SimWay {
                    name: format!("{id}_{}", i + 1),
                    points_m: route.path.iter().map(|p| at(*p, task.level)).collect(),
                    clear_width_m: route.clear_width_m,
                };
                SimRobot {
                    kind: task.robot.kind.clone(),
                    radius_m: task.robot.planned_radius_m(),
                    height_m: task.robot.height_m,
                    start_m: at(Point::new(task.start.x, task.start.y), task.level),
                    yaw_rad: task.start.yaw_rad,
                    routes: task.routes.iter().enumerate().map(leg).filter(|w| w.points_m.len() > 1).collect(),
                    id,
                }
            })
            .collect()
    }
}

/// Returns the storeys of a world; one of the height of its highest room where the plan lists none.
fn storeys(world: &World) -> Vec<SimStorey> {
    let plan = &world.floorplan;
    let highest = |level: i32| {
        let heights = plan.rooms.iter().filter(|r| r.level == level).map(|r| r.ceiling_height_m);
        heights.fold(0.0, f64::max) + CEILING_M
    };
    let listed = |l: &d3dgen_model::storeys::Level| SimStorey {
        level: l.level,
        elevation_m: l.elevation_m,
        height_m: l.height_m.max(highest(l.level)),
    };
    match plan.levels.as_slice() {
        [] => vec![SimStorey { level: 0, elevation_m: 0.0, height_m: highest(0) }],
        levels => levels.iter().map(listed).collect(),
    }
}

impl SimLeaf {
    /// Returns where the leaf is at a position of its joint: rad, or m.
    pub fn at(&self, position: f64) -> SimBox {
        let (joint, mut moved) = (&self.joint, self.closed);
        if !joint.hinge {
            moved.center_m = std::array::from_fn(|i| moved.center_m[i] + joint.axis[i] * position);
            return moved;
        }
        let turn = position * joint.axis[2];
        let (sin, cos) = turn.sin_cos();
        let [dx, dy] = [0, 1].map(|i| self.closed.center_m[i] - joint.origin_m[i]);
        moved.center_m[0] = joint.origin_m[0] + cos * dx - sin * dy;
        moved.center_m[1] = joint.origin_m[1] + sin * dx + cos * dy;
        moved.yaw_rad += turn;
        moved
    }
}

impl SimLight {
    /// Returns its color, 1 in the strongest part: Tanner Helland's fit to the locus of black bodies.
    pub fn white(&self) -> [f64; 3] {
        let t = (self.kelvin / 100.0).clamp(10.0, 66.0);
        let green = (99.470_802_586_1 * t.ln() - 161.119_568_166_1) / 255.0;
        let blue = if t <= 19.0 { 0.0 } else { (138.517_731_223_1 * (t - 10.0).ln() - 305.044_792_730_7) / 255.0 };
        [1.0, green, blue].map(|v| (v.clamp(0.0, 1.0) * 1e4).round() / 1e4)
    }
}

impl SimWindow {
    /// Returns the box of its pane and its frame.
    pub fn whole(&self) -> SimBox {
        let glass = self.glass;
        let (sin, cos) = glass.yaw_rad.sin_cos();
        let reach = |b: &SimBox| -> [f64; 3] {
            let [dx, dy, dz]: [f64; 3] = std::array::from_fn(|i| b.center_m[i] - glass.center_m[i]);
            let way = [cos * dx + sin * dy, cos * dy - sin * dx, dz];
            std::array::from_fn(|i| way[i].abs() + b.half_m[i])
        };
        let half_m = self.frame.iter().map(reach).fold(glass.half_m, |a, b| std::array::from_fn(|i| a[i].max(b[i])));
        SimBox { half_m, ..glass }
    }
}

impl SimDoor {
    /// Returns true for a door that leads out of the building.
    pub fn leads_out(&self) -> bool {
        self.room_ids.len() < 2
    }
}

impl SimBox {
    /// Returns a box that stands on a line, from one distance along it to another, with its faces at two distances to the left
    /// of it, between two heights.
    fn on(line: &walls::Line, along: [f64; 2], left: [f64; 2], z: [f64; 2]) -> Self {
        let middle = |[a, b]: [f64; 2]| (a + b) / 2.0;
        let half = |[a, b]: [f64; 2]| (b - a).abs() / 2.0;
        let at = line.point(middle(along), middle(left));
        Self { center_m: [at.x, at.y, middle(z)], half_m: [half(along), half(left), half(z)], yaw_rad: line.yaw_rad }
    }

    /// Returns its outline on the floor, counter-clockwise.
    pub fn outline(&self) -> [Point; 4] {
        let (sin, cos) = self.yaw_rad.sin_cos();
        let [x, y, _] = self.center_m;
        let [a, b, _] = self.half_m;
        [(-a, -b), (a, -b), (a, b), (-a, b)].map(|(u, v)| Point::new(x + cos * u - sin * v, y + sin * u + cos * v))
    }
}

#[cfg(test)]
mod tests;
