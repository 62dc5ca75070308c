//! A room before anything is placed: its floor, what it should hold, and what rules and robots ask of it.

use std::collections::BTreeMap;

use d3dgen_knowledge::{Aim, Limits};
use d3dgen_model::domain::{Domain, ObjectType, RoomType, Shape};
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom};
use d3dgen_model::measures::LEAST_RADIUS_M;
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::seed::Stream;
use d3dgen_model::style::Clutter;

use super::demand::{self, Task};
use super::geom::mm;
use super::space::Space;
use super::unit::BESIDE_BED_M;
use super::way::Way;
use super::{Wanted, clutter};

/// Half the width of a way for a wheelchair past furniture, m (ISO 21542: 0.8 m at the narrowest).
const WHEELCHAIR_RADIUS_M: f64 = 0.4;

/// What the circle of a wheelchair is drawn larger by, m: its place is found to the millimeter by none.
const TURNING_SPARE_M: f64 = 0.005;
/// Desks from which on the way into their room stays free.
const MANY_DESKS: u32 = 4;
/// Width of the way to each of them, mm (DIN EN 527, ASR A1.8: 0.9 m for more than five people).
const ACCESS: i32 = 900;
/// Floor of halls, m^2, and most of it that a workplace takes in rooms for a group: what is advised for each is for the aisles of
/// halls (ASR A1.2: open-plan offices of 400 m^2 and more).
const HALL_M2: f64 = 400.0;
const GROUP_M2: f64 = 8.0;
/// Area of a room from which on things of any size leave room for that circle, m^2.
const AMPLE_M2: f64 = 9.0;
/// Floor at one side of such a bed in a room of so many m^2, where one turns beside it, m (DIN 18040-2 R: 1.5 m).
const TURNING_BESIDE_BED_M: f64 = 1.5;
const TURNING_BESIDE_BED_FROM_M2: f64 = 13.0;

/// What every way to furnish a room begins with; the same room of the same graph has the same.
pub(crate) struct Setting<'a> {
    pub domain: &'a Domain,
    pub kind: &'a RoomType,
    pub space: Space,
    pub tasks: Vec<Task<'a>>,
    /// What rules ask of the object types, by id; nothing of those that are not there.
    pub aims: BTreeMap<&'a str, Aim>,
    /// Varies what is equally good, from room to room.
    pub salt: u64,
    /// Which of its sizes an object type has, by id, where that is not its first.
    sizes: BTreeMap<&'a str, usize>,
    /// Radius of the robot, mm.
    pub radius: i32,
    /// Radius of the circle that rules want free for wheelchairs, mm.
    pub turning: Option<i32>,
    /// Width of the way to each of many desks, mm.
    pub access: Option<i32>,
    /// What must stay open from door to door, or for beds.
    pub way: Option<Way>,
    /// The same with the width that is advised, where the room has it.
    pub wide_way: Option<Way>,
}

impl<'a> Setting<'a> {
    pub fn new(
        graph: &'a SceneGraph,
        plan: &Floorplan,
        room: &PlanRoom,
        (domain, limits): (&'a Domain, &Limits),
        wanted: Wanted<'a>,
    ) -> Self {
        let mut space = Space::new(plan, room);
        if graph.accessible {
            space.keep_latch_sides();
        }
        note_wet_doors(&mut space, plan, room, domain);
        let kind = domain.room_type_or_generic(&room.room_type);
        let per_person_m2 = limits.rooms.get(&room.room_type).and_then(|l| l.area_per_person_advised);
        let per_person_m2 = per_person_m2.or_else(|| workroom_area(plan, domain, limits));
        let per_person_m2 =
            per_person_m2.map(|each| if room.net_area_m2 < HALL_M2 { each.min(GROUP_M2) } else { each });
        let windows = space.windows.len() as u32;
        let household = demand::Household::new(domain, graph);
        let (own, area_m2) = (graph.room(&room.room_id), room.net_area_m2);
        let usual = || demand::tasks(domain, kind, own, area_m2, per_person_m2, windows, &household);
        let mut tasks = match wanted {
            Wanted::All => usual(),
            Wanted::Without(objects) => usual().into_iter().filter(|t| !objects.contains(&t.anchor.id)).collect(),
            Wanted::Only(object) | Wanted::IfFree(object) => vec![demand::one_more(object)],
        };
        let mut aims = limits.objects.in_room(domain, &room.room_type, room.circulation);
        if graph.accessible {
            let turns = area_m2 >= TURNING_BESIDE_BED_FROM_M2;
            beside_beds(domain, &mut aims, if turns { TURNING_BESIDE_BED_M } else { BESIDE_BED_M });
        }
        let many = |t: &Task| t.anchor.shape == Shape::Desk && t.is_batch() && t.count >= MANY_DESKS;
        let many_desks = if wanted.is_one_more() { usual().iter().any(many) } else { tasks.iter().any(many) };
        if many_desks {
            space.keep_way_in(plan, room);
        }
        // what rules advise against goes where the room can do without
        tasks.retain(|t| t.required > 0 || !aims.get(t.anchor.id.as_str()).is_some_and(|a| a.unwanted));
        if closes_ring(plan, room) {
            tasks.retain(|task| !kind.furnishing.get(task.line).is_some_and(|line| line.by_exit));
        }
        if graph.style.clutter == Some(Clutter::Low) && !wanted.is_one_more() {
            tasks.retain(|task| !clutter::is_spare(task, kind));
        }
        let mut stream = Stream::new(graph.seed, &format!("placement/{}", room.room_id));
        let salt = (stream.unit() * (1_u64 << 52) as f64) as u64;
        let circle = limits.rooms.get(&room.room_type).and_then(|l| l.turning_circle.as_ref());
        let turning = circle.map(|limit| mm(limit.value / 2.0 + TURNING_SPARE_M));
        let usual = turning.is_some() && room.net_area_m2 < AMPLE_M2;
        let sizes = pick_sizes(domain, &aims, usual, &mut stream);
        let width_m = way_width(graph, domain, limits);
        let wide_m = limits.corridor_width_advised.unwrap_or(0.0).max(width_m);
        let beds = tasks.iter().any(|t| t.anchor.shape == Shape::HospitalBed);
        let [way, wide_way] = Way::of_room(plan, room, [width_m, wide_m], beds);
        let (radius, access) = (radius(graph, &space), many_desks.then_some(ACCESS));
        Self { domain, kind, radius, space, tasks, aims, salt, sizes, turning, access, way, wide_way }
    }

    /// Returns which of its sizes an object has in this room.
    pub fn size(&self, object: &ObjectType) -> usize {
        self.sizes.get(object.id.as_str()).copied().unwrap_or(0)
    }
}

/// Returns true for a piece of corridor that goes on in another, with no way out of its own.
fn closes_ring(plan: &Floorplan, room: &PlanRoom) -> bool {
    let goes_on = |d: &Door| {
        let others = d.room_ids.iter().filter(|id| **id != room.room_id);
        d.kind == DoorKind::Open
            && d.room_ids.contains(&room.room_id)
            && others.into_iter().any(|id| plan.room(id).is_some_and(|r| r.circulation))
    };
    let leaves = |d: &&Door| d.room_ids == [room.room_id.clone()];
    let is_main = plan.rooms.iter().find(|r| r.circulation && r.level == room.level) == Some(room);
    room.circulation && !is_main && plan.doors.iter().any(goes_on) && !plan.ways_out().iter().any(leaves)
}

/// Returns the floor area of the rooms with desks that each workplace has where the whole building has what is advised, m^2.
fn workroom_area(plan: &Floorplan, domain: &Domain, limits: &Limits) -> Option<f64> {
    let advised = limits.area_per_workplace_advised?;
    let area = |wanted: &dyn Fn(&PlanRoom) -> bool| -> f64 {
        plan.rooms.iter().filter(|r| wanted(r)).map(|r| r.net_area_m2).sum()
    };
    let work = area(&|r| demand::has_desks(domain, domain.room_type_or_generic(&r.room_type)));
    (work > 0.0).then(|| advised * work / area(&|_| true))
}

/// Returns the width that ways through circulation keep, m.
fn way_width(graph: &SceneGraph, domain: &Domain, limits: &Limits) -> f64 {
    let robot_m = graph.robots.iter().map(|r| r.planned_radius_m()).fold(LEAST_RADIUS_M, f64::max);
    limits.corridor_m(&domain.circulation).max(2.0 * robot_m).max(limits.two_way_m(graph))
}

/// Notes which doors lead to rooms with steam.
fn note_wet_doors(space: &mut Space, plan: &Floorplan, room: &PlanRoom, domain: &Domain) {
    let is_wet = |id: &String| {
        let other = plan.rooms.iter().find(|r| r.room_id == *id && r.room_id != room.room_id);
        other.is_some_and(|r| domain.room_type_or_generic(&r.room_type).wet)
    };
    let wet: Vec<&str> =
        (plan.doors_of(&room.room_id).filter(|d| d.room_ids.iter().any(is_wet))).map(|d| d.door_id.as_str()).collect();
    space.doors.iter_mut().for_each(|door| door.wet = wet.contains(&door.id.as_str()));
}

/// Asks for floor at one side of each bed where a wheelchair is to get there, if nobody asks for more.
fn beside_beds<'a>(domain: &'a Domain, aims: &mut BTreeMap<&'a str, Aim>, floor_m: f64) {
    for bed in domain.objects.iter().filter(|o| o.shape == Shape::Bed) {
        let clear = &mut aims.entry(&bed.id).or_default().clear;
        clear.wide_side = clear.wide_side.max(floor_m);
    }
}

/// Picks one size for each object type of a room, of those that keep most rules the most common one most often. What things
/// are stored in is at least as wide as it usually comes; narrower ones are for walls that hold no other. With
/// `usual_only` all things have their most common size; the first where none is said.
fn pick_sizes<'a>(
    domain: &'a Domain,
    aims: &BTreeMap<&str, Aim>,
    usual_only: bool,
    stream: &mut Stream,
) -> BTreeMap<&'a str, usize> {
    let mut pick = |o: &ObjectType| {
        let breaches = aims.get(o.id.as_str()).map_or(&[][..], |a| &a.breaches);
        let least = breaches.iter().min().copied().unwrap_or(0);
        let usual = demand::storage_width_m(o).unwrap_or(0.0);
        let lawful = |i: &usize| breaches.get(*i).is_none_or(|b| *b == least);
        let mut best: Vec<usize> = (0..o.sizes_m.len()).filter(lawful).collect();
        if best.iter().any(|i| o.sizes_m[*i][0] >= usual) {
            best.retain(|i| o.sizes_m[*i][0] >= usual);
        }
        let at = if stream.chance(0.5) { 0 } else { stream.below(best.len()) } * usize::from(!usual_only);
        best.get(at).copied().unwrap_or(0)
    };
    let picked = domain.objects.iter().map(|o| (o.id.as_str(), pick(o)));
    picked.filter(|(_, size)| *size > 0).collect()
}

/// Returns the radius of the disc that must reach everything, mm: the largest robot's where the doors let it in, and a
/// wheelchair's where one is to get about.
fn radius(graph: &SceneGraph, space: &Space) -> i32 {
    let least = mm(if graph.accessible { WHEELCHAIR_RADIUS_M } else { LEAST_RADIUS_M });
    let robot = graph.robots.iter().map(|r| mm(r.planned_radius_m())).fold(least, i32::max);
    let doors = space.doors.iter().map(|d| d.clear_width / 2).max().unwrap_or(robot);
    robot.min(doors).max(least)
}
