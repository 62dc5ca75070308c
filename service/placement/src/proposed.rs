//! Furniture out of proposals: objects at poses that somebody proposes for a room, each where it is proposed or at the
//! nearest place that breaks no rule; the rest of the room is furnished around them.
//!
//! An object that is the anchor of one of the room's groups brings the group. What hangs from the ceiling, stands on
//! something or belongs to a group goes where the room's own furnishing puts it.

use std::f64::consts::FRAC_PI_2;
use std::rc::Rc;

use d3dgen_knowledge::Limits;
use d3dgen_model::domain::{Arrangement, Domain, Mount, ObjectType};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::offer::suits;
use d3dgen_model::placements::{Placement, Unplaced};
use d3dgen_model::scene_graph::SceneGraph;
use d3dgen_model::stage::Stop;

use super::demand::{self, Task};
use super::geom::{mm, turn};
use super::nav::Nav;
use super::search::{LEVELS, Outcome};
use super::setting::Setting;
use super::state::{Placed, Rule, State};
use super::unit::{Forms, Unit, variants};
use super::{Wanted, assemble, furnish_room, stairs};

/// Farthest that an object is moved to fit, mm.
const FARTHEST: i32 = 1500;
/// Steps in which places around the proposed one are looked at, mm.
const STEP: i32 = 100;
/// What turning an object costs, as if it were moved so far, mm.
const TURNED: i32 = 600;
/// Places whose routes are looked at for one object.
const ROUTES: usize = 12;
/// Farthest that the back of what belongs to a wall may be from it, mm.
const AT_WALL: i32 = 60;
/// Farthest place that is read, m; beyond it `mm` has no numbers.
const FARTHEST_PLACE_M: f64 = 100_000.0;

/// An object that somebody proposes for a room.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// Object id of the domain's catalog.
    pub object: String,
    /// Center, m.
    pub x: f64,
    /// Center, m.
    pub y: f64,
    /// Heading of the front, rad.
    pub yaw_rad: f64,
}

/// A room furnished as it is proposed.
#[derive(Debug, Clone)]
pub struct Proposed {
    /// What stands in it.
    pub placements: Vec<Placement>,
    /// What it should have and cannot hold.
    pub unplaced: Vec<Unplaced>,
    /// For each wish why it was not set at or near its place; `None` where it was, or where it is left to the furnishing.
    pub refused: Vec<Option<Refusal>>,
}

/// Why a wish was not set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// Snake-case id of the rule, where one decided.
    pub rule: Option<String>,
    /// One sentence for people.
    pub reason: String,
}

/// Furnishes a room as nearly as possible as it is proposed.
///
/// When a room would lack what it requires, what its type does not require is given up first, then everything proposed:
/// the room is then furnished as without a proposal.
pub fn propose_room(
    graph: &SceneGraph,
    plan: &Floorplan,
    room: &PlanRoom,
    (domain, limits): (&Domain, &Limits),
    wishes: &[Wish],
    stop: Stop<'_>,
) -> Proposed {
    let furnish = |fixed: &[Placement]| {
        let fixed: Vec<&Placement> = fixed.iter().collect();
        furnish_room(graph, plan, room, (domain, limits), &fixed, Wanted::All, stop).ok()
    };
    let own = furnish(&[]).unwrap_or_default();
    let lacking = |unplaced: &[Unplaced]| unplaced.iter().filter(|u| u.required).count();
    for only_required in [false, true] {
        let table = Table::new(graph, plan, room, (domain, limits));
        let (fixed, refused) = table.set(wishes, only_required, stop);
        if fixed.is_empty() {
            if only_required {
                break;
            }
            return Proposed { placements: own.0, unplaced: own.1, refused };
        }
        if let Some((placements, unplaced)) = furnish(&fixed)
            && lacking(&unplaced) <= lacking(&own.1)
        {
            return Proposed { placements, unplaced, refused };
        }
    }
    let refusal = Refusal {
        rule: Some("object_missing".into()),
        reason: "around what is proposed the room could not hold what it requires".into(),
    };
    Proposed { placements: own.0, unplaced: own.1, refused: vec![Some(refusal); wishes.len()] }
}

/// A room that wishes are set in.
struct Table<'a> {
    setting: Setting<'a>,
    room: &'a PlanRoom,
    blocked: bool,
}

impl<'a> Table<'a> {
    fn new(graph: &'a SceneGraph, plan: &Floorplan, room: &'a PlanRoom, knowledge: (&'a Domain, &Limits)) -> Self {
        let setting = Setting::new(graph, plan, room, knowledge, Wanted::All);
        Self { setting, room, blocked: stairs::flights(plan, room, knowledge.0).is_some() }
    }

    /// Sets what fits, most constrained first; returns the placements and why the others were not set.
    fn set(&self, wishes: &[Wish], only_required: bool, stop: Stop<'_>) -> (Vec<Placement>, Vec<Option<Refusal>>) {
        let mut refused: Vec<Option<Refusal>> = vec![None; wishes.len()];
        let mut left: Vec<u32> = self.setting.tasks.iter().map(|t| t.count).collect();
        let mut order: Vec<(usize, usize)> = Vec::new();
        let mut lone: Vec<(usize, &'a ObjectType)> = Vec::new();
        for (n, wish) in wishes.iter().enumerate() {
            match self.place_of(wish, &left) {
                Ok(Spot::Task(task)) if !only_required || self.setting.tasks[task].required > 0 => {
                    left[task] -= 1;
                    order.push((task, n));
                }
                Ok(Spot::Lone(object)) if !only_required => lone.push((n, object)),
                Ok(Spot::Task(_) | Spot::Lone(_)) => {
                    let reason = "it left too little room for what the room requires".into();
                    refused[n] = Some(Refusal { rule: Some("object_missing".into()), reason });
                }
                Ok(Spot::Left) => {}
                Err(refusal) => refused[n] = Some(refusal),
            }
        }
        order.sort_unstable();
        let more: Vec<Task<'a>> = lone.iter().map(|(_, object)| self.extra(object)).collect();
        let tasks: Vec<Task<'a>> = self.setting.tasks.iter().chain(&more).cloned().collect();
        order.extend(lone.iter().enumerate().map(|(k, (n, _))| (self.setting.tasks.len() + k, *n)));
        let margin = LEVELS[0].margin;
        let mut state = State::new(
            &self.setting.space,
            Nav::new(&self.setting.space, self.setting.radius + margin),
            self.setting.way.as_ref(),
            LEVELS[LEVELS.len() - 1].open,
        );
        for (task, n) in order {
            if stop.is_set() {
                break;
            }
            match self.nearest(&state, &tasks[task], task, &wishes[n]) {
                Ok(placed) => state.add(vec![placed]),
                Err(rule) => {
                    let reason = format!("no place within {} m: {}", f64::from(FARTHEST) / 1000.0, rule.text());
                    refused[n] = Some(Refusal { rule: Some(rule.id().into()), reason });
                }
            }
        }
        let placed = std::mem::take(&mut state.placed);
        let outcome = Outcome { placed, missing: Vec::new(), required_missing: 0, closed: 0, score: 0.0, level: 0 };
        (assemble::placements(self.setting.domain, &self.room.room_id, &tasks, &outcome, &[]), refused)
    }

    fn extra(&self, object: &'a ObjectType) -> Task<'a> {
        let rule = format!("proposed ({})", object.id);
        Task { rule, required: 0, line: self.setting.kind.furnishing.len(), ..demand::one_more(object) }
    }

    /// Returns what a wish is in this room.
    fn place_of(&self, wish: &Wish, left: &[u32]) -> Result<Spot<'a>, Refusal> {
        let refuse = |rule: Option<&str>, reason: String| Refusal { rule: rule.map(str::to_owned), reason };
        let Some(object) = self.setting.domain.object(&wish.object) else {
            return Err(refuse(None, format!("domain {} knows no such object", self.setting.domain.id)));
        };
        let numbers = [wish.x, wish.y, wish.yaw_rad];
        if numbers.iter().any(|n| !n.is_finite() || n.abs() > FARTHEST_PLACE_M) {
            return Err(refuse(Some("not_finite"), "its place is no place".into()));
        }
        if self.blocked {
            return Err(refuse(None, "the stairs fill the room".into()));
        }
        let hung = matches!(object.mount, Mount::Surface | Mount::Ceiling);
        let elsewhere =
            |t: &Task| matches!(t.arrangement, Arrangement::OnSurface | Arrangement::Overhead | Arrangement::AtWindow);
        let mut own = self.setting.tasks.iter().enumerate().filter(|(_, t)| t.anchor.id == object.id).peekable();
        if own.peek().is_some() {
            if hung || own.clone().all(|(_, t)| elsewhere(t)) {
                return Ok(Spot::Left);
            }
            let free = own.find(|(i, t)| left[*i] > 0 && !elsewhere(t));
            return free.map(|(i, _)| Spot::Task(i)).ok_or_else(|| refuse(None, "the room has as many already".into()));
        }
        let in_group = self.setting.tasks.iter().any(|t| {
            self.setting.domain.group(t.item).is_some_and(|g| g.members.iter().any(|m| m.object == object.id))
        });
        if in_group || hung {
            return Ok(Spot::Left);
        }
        if !suits(self.setting.domain, self.setting.kind, &object.id) {
            return Err(refuse(None, "it stands in no room like this one".into()));
        }
        Ok(Spot::Lone(object))
    }

    /// Returns the unit of a task at the nearest place that breaks no rule, or the rule that most places break.
    fn nearest(&self, state: &State<'a, '_>, task: &Task<'a>, index: usize, wish: &Wish) -> Result<Placed<'a>, Rule> {
        let center = (mm(wish.x), mm(wish.y));
        let heading = (wish.yaw_rad / FRAC_PI_2).round().rem_euclid(4.0) as u8 % 4;
        let sizes = |o: &ObjectType| self.setting.size(o);
        let mut first = None;
        let (aims, ceiling) = (&self.setting.aims, self.setting.space.ceiling);
        // what is proposed need not have the free floor that is only advised
        let forms = Forms {
            sizes: &sizes,
            aims,
            tightness: 1.0,
            advised: false,
            lawful: false,
            ceiling,
            robot: 2 * self.setting.radius,
        };
        for unit in variants(self.setting.domain, task.item, &forms) {
            let walled = unit.needs_wall || backs_to_wall(task);
            let unit = Rc::new(unit);
            let mut places = self.places(&unit, center, heading, walled);
            places.sort_unstable();
            let mut routes = 0;
            for (_, q, at) in places {
                let placed =
                    Placed { unit: Rc::clone(&unit), q, at, first_line: task.leads, task: index, support: None, z: 0 };
                let fits = state.fit(placed, false).and_then(|placed| {
                    routes += 1;
                    state.route(std::slice::from_ref(&placed)).map(|_| placed)
                });
                match fits {
                    Ok(placed) => return Ok(placed),
                    Err(rule) => first = first.or(Some(rule)),
                }
                if routes >= ROUTES {
                    break;
                }
            }
        }
        Err(first.unwrap_or(Rule::NoPlace))
    }

    /// Returns the places of a unit around a point, each with how far it is from what was proposed: cost, heading, origin.
    fn places(&self, unit: &Unit, center: (i32, i32), heading: u8, walled: bool) -> Vec<(i32, u8, (i32, i32))> {
        let own = unit.anchor().solid.rect.center();
        let origin = |q: u8, (x, y): (i32, i32)| {
            let (dx, dy) = turn(q, own.0, own.1);
            (x - dx, y - dy)
        };
        let mut out = Vec::new();
        let mut offer = |q: u8, at: (i32, i32)| {
            let (dx, dy) = turn(q, own.0, own.1);
            let (ox, oy) = (at.0 + dx - center.0, at.1 + dy - center.1);
            let far = ox.abs().max(oy.abs());
            let cost = far + if q == heading { 0 } else { TURNED };
            if far <= FARTHEST {
                out.push((cost, q, at));
            }
        };
        for wall in &self.setting.space.walls {
            // along a wall the unit's back is the rearmost of its parts
            let u = wall.u - unit.bbox.x0.min(0);
            let (_, along) = turn((4 - wall.q) % 4, center.0, center.1);
            let near = |v: i32| v.clamp(wall.v0 - unit.bbox.y0, (wall.v1 - unit.bbox.y1).max(wall.v0 - unit.bbox.y0));
            for step in -(FARTHEST / STEP)..=(FARTHEST / STEP) {
                offer(wall.q, turn(wall.q, u, near(along - own.1 + step * STEP)));
            }
        }
        let (exact, backed) = (origin(heading, center), |at: (i32, i32)| self.is_backed(unit, heading, at));
        if !walled || backed(exact) {
            offer(heading, exact);
        }
        if !walled {
            for dx in -(FARTHEST / STEP)..=(FARTHEST / STEP) {
                for dy in -(FARTHEST / STEP)..=(FARTHEST / STEP) {
                    offer(heading, origin(heading, (center.0 + dx * STEP, center.1 + dy * STEP)));
                }
            }
        }
        out
    }

    /// Returns true when a unit has its back to a wall.
    fn is_backed(&self, unit: &Unit, q: u8, at: (i32, i32)) -> bool {
        let (u, v) = turn((4 - q) % 4, at.0, at.1);
        let back = u + unit.bbox.x0.min(0);
        self.setting.space.walls.iter().any(|w| {
            w.q == q && (0..=AT_WALL).contains(&(back - w.u)) && v + unit.bbox.y0 >= w.v0 && v + unit.bbox.y1 <= w.v1
        })
    }
}

/// What a wish is in a room.
enum Spot<'a> {
    /// A unit of a task.
    Task(usize),
    /// Something beside what the room should hold.
    Lone(&'a ObjectType),
    /// Left to the room's own furnishing.
    Left,
}

/// Returns true for what stands with its back to a wall.
fn backs_to_wall(task: &Task) -> bool {
    use Arrangement::{BesideDoor, Center, Facing, FacingDoor, Overhead, Rows};
    task.anchor.mount == Mount::Wall
        || !matches!(task.arrangement, Center | Rows | Facing | FacingDoor | Overhead | BesideDoor)
}
