//! Placements handed in as locked: kept as they are, checked against the plan, counted towards what a room needs.

use std::f64::consts::FRAC_PI_2;
use std::rc::Rc;

use d3dgen_model::domain::{Domain, Mount, Shape};
use d3dgen_model::floorplan::Floorplan;
use d3dgen_model::placements::{Placement, Placements};
use d3dgen_model::stage::Error;

use super::demand::Task;
use super::geom::{Box2, Solid, mm};
use super::space::{DoorZone, Open, Space};
use super::state::Placed;
use super::unit::{Part, Unit, clears_of};

/// Share of its clearance that what stands already keeps from what comes after it.
const LEAST_CLEARANCE: f64 = 0.5;

/// Returns the locked placements of one room.
pub(crate) fn of_room<'p>(pinned: Option<&'p Placements>, room_id: &str) -> Vec<&'p Placement> {
    pinned.map_or(Vec::new(), |p| p.placements.iter().filter(|p| p.locked && p.room_id == room_id).collect())
}

/// Returns what is wrong with locked placements whose room the plan does not have.
pub(crate) fn strays(pinned: Option<&Placements>, plan: &Floorplan) -> Vec<String> {
    let all = pinned.map_or(&[][..], |p| &p.placements);
    let stray = all.iter().filter(|p| p.locked && plan.room(&p.room_id).is_none());
    stray.map(|p| format!("`{}` stands in room `{}`, which the floorplan lacks", p.placement_id, p.room_id)).collect()
}

/// Returns placements that stand already as placed units, and everything that keeps them from standing where they are.
pub(crate) fn placed<'a>(locked: &[&Placement], domain: &'a Domain, space: &Space) -> (Vec<Placed<'a>>, Vec<String>) {
    let mut problems = Vec::new();
    let mut units: Vec<Placed> = Vec::new();
    for p in locked {
        let solid = solid_of(p);
        let id = &p.placement_id;
        let Some(object) = domain.object(&p.object) else {
            problems.push(format!("`{id}` is a `{}`, which domain `{}` does not know", p.object, domain.id));
            continue;
        };
        if !space.contains(&solid.rect.grown(-1)) {
            problems.push(format!("`{id}` does not stand inside room `{}`", p.room_id));
        }
        if let Some(d) = space.doors.iter().find(|d| {
            p.mount != Mount::Surface
                && !solid.is_flat()
                && solid.z0 < d.height
                && d.zone.overlaps(&solid.rect.grown(-1))
        }) {
            problems.push(format!("`{id}` stands in the floor that door `{}` needs", d.id));
        }
        for (other, q) in units.iter().zip(locked) {
            let theirs = other.solid(other.unit.anchor());
            let inner = Solid { rect: solid.rect.grown(-1), ..solid };
            if !solid.is_flat() && !theirs.is_flat() && inner.overlaps(&theirs) {
                problems.push(format!("`{id}` and `{}` share space", q.placement_id));
            }
        }
        let mount = p.mount;
        let quarter = (p.pose.yaw_rad / FRAC_PI_2).round().rem_euclid(4.0) as u8;
        let part = Part { object, quarter, solid, mount, support: None, optional: false };
        let mut clears = Vec::new();
        clears_of(&part, LEAST_CLEARANCE, &mut clears);
        let unit = Unit {
            item: &object.id,
            group: false,
            parts: vec![part],
            clears,
            bbox: solid.rect,
            reach: solid.rect,
            extent: solid.rect,
            needs_wall: mount == Mount::Wall,
            parked: Vec::new(),
        };
        units.push(Placed {
            unit: Rc::new(unit),
            q: 0,
            at: (0, 0),
            first_line: false,
            task: usize::MAX,
            support: None,
            z: 0,
        });
    }
    (units, problems)
}

/// Returns the things that stand in the light of a window of the room.
pub(crate) fn shading(fixed: &[&Placement], domain: &Domain, space: &Space) -> Vec<String> {
    let curtain = |p: &Placement| domain.object(&p.object).is_some_and(|o| o.shape == Shape::Curtain);
    let dark = |p: &&&Placement| !curtain(p) && space.windows.iter().any(|w| w.is_hidden_by(&solid_of(p)));
    fixed.iter().filter(dark).map(|p| format!("`{}` stands in front of a window", p.placement_id)).collect()
}

/// Returns how many things stand before a door or a window of the room where one would rather have none: as deep as the
/// leaf is wide, and what [`Open`] keeps of windows.
pub(crate) fn before_openings(things: &[&Placement], domain: &Domain, space: &Space) -> usize {
    let open = Open { doors: true, deep: false, windows: true };
    let curtain = |p: &Placement| domain.object(&p.object).is_some_and(|o| o.shape == Shape::Curtain);
    let solids = things.iter().filter(|p| !curtain(p)).map(|p| (p.mount, solid_of(p))).filter(|(_, s)| !s.is_flat());
    let before = |(mount, solid): &(Mount, Solid)| {
        let door = |d: &DoorZone| solid.z0 < d.height && d.kept(open).overlaps(&solid.rect);
        *mount != Mount::Surface && space.doors.iter().any(door)
            || space.windows.iter().any(|w| w.is_taken_by(solid, open))
    };
    solids.filter(before).count()
}

fn solid_of(p: &Placement) -> Solid {
    let b = p.footprint().bounds();
    let rect = Box2 { x0: mm(b.x0), y0: mm(b.y0), x1: mm(b.x1), y1: mm(b.y1) };
    Solid { rect, z0: mm(p.pose.z), z1: mm(p.top_m()) }
}

/// Returns how many units of each task stand there already: groups by their anchor.
pub(crate) fn present(locked: &[&Placement], tasks: &[Task], domain: &Domain) -> Vec<u32> {
    let mut used = vec![false; locked.len()];
    tasks
        .iter()
        .map(|task| {
            let group = domain.group(task.item).is_some();
            let mut n = 0;
            for (k, p) in locked.iter().enumerate() {
                let in_group =
                    p.group.as_deref().is_some_and(|g| g.starts_with(&format!("{}_{}_", p.room_id, task.item)));
                let counts = if group {
                    in_group && p.object == task.anchor.id
                } else {
                    p.group.is_none() && p.object == task.item
                };
                if counts && !used[k] && n < task.count {
                    used[k] = true;
                    n += 1;
                }
            }
            n
        })
        .collect()
}

/// Returns an error that names every problem, when there is one.
///
/// # Errors
/// `Mismatch` with all problems.
pub(crate) fn settle(problems: Vec<String>) -> Result<(), Error> {
    if problems.is_empty() { Ok(()) } else { Err(Error::Mismatch { stage: "placement", message: problems.join("; ") }) }
}
