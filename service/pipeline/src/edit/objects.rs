//! Furniture under edits: what still fits stays, what an edit names goes where it says, the rest is furnished anew.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_2;

use d3dgen_model::domain::{Domain, Mount, ObjectType};
use d3dgen_model::floorplan::{Floorplan, PlanRoom};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::placements::Placement;
use d3dgen_model::stage::Error;
use d3dgen_model::{Point, Rect};

use super::{Desk, infeasible, mismatch, refused};
use crate::placement::assemble::stocked;
use crate::placement::{Wanted, furnish_room, misfits};

/// What touches a wall is at most this far from it, m.
const AT_WALL_M: f64 = 0.03;

impl Desk<'_> {
    /// Furnishes a room whose walls or openings changed: what fits as it stands stays.
    pub(super) fn settle(&mut self, before: &Floorplan, room_id: &str) -> Result<(), Error> {
        let room = self.room(room_id)?.clone();
        let old = before.room(room_id);
        self.follow(old, &room);
        let old = old.filter(|old| moved_by(old, &room).is_none());
        let plan = self.plan.storey_at(room.level);
        let mut gone: BTreeSet<String> = BTreeSet::new();
        for p in self.placements.placements.iter().filter(|p| p.room_id == room_id) {
            let at_wall = old.is_none_or(|old| {
                let (then, now) = (touches(p, old), touches(p, &room));
                (0..4).all(|side| now[side] || !then[side])
            });
            let problems = misfits(&plan, &room, self.plugin.domain(), &[p]);
            if at_wall && problems.is_empty() {
                continue;
            }
            if p.locked {
                let reason = problems.into_iter().next();
                let reason = reason.unwrap_or_else(|| format!("`{}` would lose its wall", p.placement_id));
                return Err(infeasible(format!("locked {reason}")));
            }
            gone.insert(p.placement_id.clone());
        }
        self.drop_with_company(gone);
        self.furnish(room_id, None)
    }

    /// Moves the furniture of a room that moved as it is.
    fn follow(&mut self, old: Option<&PlanRoom>, room: &PlanRoom) {
        let Some((dx, dy)) = old.and_then(|old| moved_by(old, room)) else { return };
        for p in self.placements.placements.iter_mut().filter(|p| p.room_id == room.room_id) {
            (p.pose.x, p.pose.y) = (to_mm(p.pose.x + dx), to_mm(p.pose.y + dy));
        }
    }

    /// Furnishes a room anew around what is locked in it or was put there by an edit.
    pub(super) fn refurnish(&mut self, room_id: &str) -> Result<(), Error> {
        self.room(room_id)?;
        let stays = |p: &Placement, held: &BTreeSet<String>| p.locked || held.contains(&p.placement_id);
        let all = &self.placements.placements;
        let kept: BTreeSet<String> = all
            .iter()
            .filter(|p| p.room_id == room_id && stays(p, &self.held))
            .flat_map(|p| [Some(p.placement_id.clone()), p.support.clone()])
            .flatten()
            .collect();
        self.placements.placements.retain(|p| p.room_id != room_id || kept.contains(&p.placement_id));
        self.furnish(room_id, None)
    }

    /// Adds an object at the best free place of a room.
    pub(super) fn add(&mut self, room_id: &str, object: &str) -> Result<(), Error> {
        let before: BTreeSet<String> = self.placements.placements.iter().map(|p| p.placement_id.clone()).collect();
        let domain = self.plugin.domain();
        let object = known(domain, object)?;
        self.room(room_id)?;
        self.furnish(room_id, Some(object))?;
        self.left.remove(&[room_id.to_owned(), object.id.clone()]);
        let new: Vec<String> = self.placements.placements.iter().map(|p| p.placement_id.clone()).collect();
        self.held.extend(new.into_iter().filter(|id| !before.contains(id)));
        Ok(())
    }

    /// Takes an object away with what stands on it.
    pub(super) fn remove(&mut self, placement_id: &str) -> Result<(), Error> {
        let p = self.placement(placement_id)?;
        if p.locked {
            return Err(refused(format!("`{placement_id}` is locked; unlock it first")));
        }
        let (room_id, object) = (p.room_id.clone(), p.object.clone());
        let mut gone = BTreeSet::from([placement_id.to_owned()]);
        self.add_what_stands_on(&mut gone);
        self.placements.placements.retain(|p| !gone.contains(&p.placement_id));
        let left = self.count(&room_id, &object);
        self.changed.insert(room_id.clone());
        self.unwanted.insert(object.clone());
        self.left.insert([room_id, object], left);
        Ok(())
    }

    /// Moves an object, and what stands on it; what is in its way is placed anew.
    pub(super) fn shift(&mut self, placement_id: &str, x: f64, y: f64, yaw_rad: Option<f64>) -> Result<(), Error> {
        let p = self.placement(placement_id)?.clone();
        let turn = yaw_rad.map_or(0.0, |yaw| yaw - p.pose.yaw_rad);
        let quarters = (turn / FRAC_PI_2).round();
        let mut moved = p.clone();
        (moved.pose.x, moved.pose.y) = (to_mm(x), to_mm(y));
        moved.pose.yaw_rad = heading(p.pose.yaw_rad, quarters);
        let mut riders = BTreeSet::from([placement_id.to_owned()]);
        self.add_what_stands_on(&mut riders);
        for q in self.placements.placements.iter_mut().filter(|q| riders.contains(&q.placement_id)) {
            let (dx, dy) = (q.pose.x - p.pose.x, q.pose.y - p.pose.y);
            let (dx, dy) = match quarters as i64 & 3 {
                0 => (dx, dy),
                1 => (-dy, dx),
                2 => (-dx, -dy),
                _ => (dy, -dx),
            };
            (q.pose.x, q.pose.y) = (to_mm(moved.pose.x + dx), to_mm(moved.pose.y + dy));
            q.pose.yaw_rad = heading(q.pose.yaw_rad, quarters);
        }
        self.make_way(&moved, &riders)
    }

    /// Puts another object, or another model of the same, where one stands.
    pub(super) fn swap(&mut self, placement_id: &str, object: Option<&str>, asset: Option<&str>) -> Result<(), Error> {
        let domain = self.plugin.domain();
        let old = self.placement(placement_id)?.clone();
        if old.locked {
            return Err(refused(format!("`{placement_id}` is locked; unlock it first")));
        }
        let kind = known(domain, object.unwrap_or(&old.object))?;
        let models = models(domain, kind, &old, asset)?;
        let mut reason = format!("no other model of `{}` is known", kind.id);
        for (size_m, asset, choice) in models {
            let mut new = Placement { size_m, asset, asset_choice: choice, ..old.clone() };
            self.fit_back(&mut new, &old, kind);
            let mut trial = self.clone();
            match trial.replace(&old, new, kind) {
                Ok(()) => {
                    *self = trial;
                    return Ok(());
                }
                Err(Error::Infeasible { message, .. }) => reason = message,
                Err(error) => return Err(error),
            }
        }
        Err(infeasible(reason))
    }

    /// Sets a new object against what the old one had its back to, or on what it stood.
    fn fit_back(&self, new: &mut Placement, old: &Placement, kind: &ObjectType) {
        let (sin, cos) = old.pose.yaw_rad.sin_cos();
        let by = (new.size_m[1] - old.size_m[1]) / 2.0;
        if new.mount != Mount::Ceiling && old.mount != Mount::Surface {
            (new.pose.x, new.pose.y) = (to_mm(old.pose.x + cos * by), to_mm(old.pose.y + sin * by));
        }
        if kind.id != old.object {
            let taken = |id: &String| self.placements.placements.iter().any(|p| &p.placement_id == id);
            let names = (1..).map(|n| format!("{}_{}_{n}", old.room_id, kind.id));
            new.placement_id = names.into_iter().find(|id| !taken(id)).unwrap_or_default();
            new.object.clone_from(&kind.id);
            new.group = None;
            if old.mount != Mount::Surface {
                new.mount = kind.mount;
                new.pose.z = if kind.mount == Mount::Floor { 0.0 } else { kind.mount_height_m.unwrap_or(old.pose.z) };
            }
        }
        new.rule = format!("put there by an edit ({})", kind.id);
    }

    fn replace(&mut self, old: &Placement, new: Placement, kind: &ObjectType) -> Result<(), Error> {
        let top = new.pose.z + new.size_m[2];
        let footprint = new.footprint().bounds();
        let mut riders = BTreeSet::from([new.placement_id.clone()]);
        let mut fallen = BTreeSet::new();
        for q in &mut self.placements.placements {
            if q.support.as_deref() != Some(&old.placement_id) {
                continue;
            }
            if kind.surface && footprint.grown(0.001).contains(&q.footprint().bounds()) {
                q.support = Some(new.placement_id.clone());
                q.pose.z = to_mm(top);
                riders.insert(q.placement_id.clone());
            } else {
                fallen.insert(q.placement_id.clone());
            }
        }
        self.drop_with_company(fallen);
        match self.placements.placements.iter_mut().find(|p| p.placement_id == old.placement_id) {
            Some(place) => *place = new.clone(),
            None => self.placements.placements.push(new.clone()),
        }
        if new.object != old.object {
            self.unwanted.insert(old.object.clone());
            self.left.remove(&[new.room_id.clone(), new.object.clone()]);
        }
        self.make_way(&new, &riders)
    }

    /// Takes away what is in the way of an object that an edit put somewhere, and furnishes the room around it.
    fn make_way(&mut self, new: &Placement, riders: &BTreeSet<String>) -> Result<(), Error> {
        let room = self.room(&new.room_id)?.clone();
        let domain = self.plugin.domain();
        let plan = self.plan.storey_at(room.level);
        let of_room = |p: &&Placement| p.room_id == room.room_id;
        if new.support.is_none()
            && let Some(problem) = misfits(&plan, &room, domain, &[new]).into_iter().next()
        {
            return Err(infeasible(problem));
        }
        let mut gone = BTreeSet::new();
        for p in self.placements.placements.iter().filter(of_room).filter(|p| !riders.contains(&p.placement_id)) {
            if new.support.as_deref() != Some(&p.placement_id) && overlap(p, new) {
                if p.locked {
                    return Err(infeasible(format!("locked `{}` is in the way", p.placement_id)));
                }
                gone.insert(p.placement_id.clone());
            }
        }
        gone.retain(|id| !riders.contains(id));
        self.held.extend(riders.iter().cloned());
        if gone.is_empty() {
            self.changed.insert(room.room_id);
            return Ok(());
        }
        self.drop_with_company(gone);
        self.furnish(&room.room_id, None)
    }

    /// Removes objects with the rest of their groups and what stands on them; what is locked or held stays.
    fn drop_with_company(&mut self, mut gone: BTreeSet<String>) {
        let groups: BTreeSet<String> = self
            .placements
            .placements
            .iter()
            .filter(|p| gone.contains(&p.placement_id))
            .filter_map(|p| p.group.clone())
            .collect();
        let held = &self.held;
        let company = |p: &&Placement| p.group.as_ref().is_some_and(|g| groups.contains(g));
        gone.extend(self.placements.placements.iter().filter(company).map(|p| p.placement_id.clone()));
        self.add_what_stands_on(&mut gone);
        self.placements.placements.retain(|p| {
            !gone.contains(&p.placement_id) || p.locked || (held.contains(&p.placement_id) && p.support.is_none())
        });
        // what lost its support falls with it
        loop {
            let all: BTreeSet<String> = self.placements.placements.iter().map(|p| p.placement_id.clone()).collect();
            let before = self.placements.placements.len();
            self.placements.placements.retain(|p| p.support.as_ref().is_none_or(|s| all.contains(s)));
            if self.placements.placements.len() == before {
                return;
            }
        }
    }

    fn add_what_stands_on(&self, ids: &mut BTreeSet<String>) {
        loop {
            let before = ids.len();
            let on = |p: &&Placement| p.support.as_ref().is_some_and(|s| ids.contains(s));
            let more: Vec<String> =
                self.placements.placements.iter().filter(on).map(|p| p.placement_id.clone()).collect();
            ids.extend(more);
            if ids.len() == before {
                return;
            }
        }
    }

    /// Furnishes one room around everything that stands in it: with what it should have, or with one object more.
    fn furnish(&mut self, room_id: &str, more: Option<&ObjectType>) -> Result<(), Error> {
        let wanted = more.map_or(Wanted::Without(&self.unwanted), Wanted::Only);
        let room = self.room(room_id)?;
        let fixed: Vec<&Placement> = self.placements.placements.iter().filter(|p| p.room_id == room_id).collect();
        let limits = &self.retrieved.limits;
        let made = furnish_room(
            &self.graph,
            &self.plan.storey_at(room.level),
            room,
            (self.plugin.domain(), limits),
            &fixed,
            wanted,
            self.stop,
        );
        self.stop.check()?;
        let (placements, unplaced) = made.map_err(|problems| infeasible(problems.join("; ")))?;
        if let Some(object) = more
            && let Some(missing) = unplaced.first()
        {
            return Err(infeasible(format!("`{}` finds no place in `{room_id}`: {}", object.id, missing.reason)));
        }
        // in the order of the plan's rooms, as in a world that was made
        let order: BTreeMap<&str, usize> =
            self.plan.rooms.iter().enumerate().map(|(i, r)| (r.room_id.as_str(), i)).collect();
        let all = &mut self.placements.placements;
        all.retain(|p| p.room_id != room_id && order.contains_key(p.room_id.as_str()));
        all.extend(placements);
        all.sort_by_key(|p| order[p.room_id.as_str()]);
        if more.is_none() {
            self.placements.unplaced.retain(|u| u.room_id != room_id);
            self.placements.unplaced.extend(unplaced);
        }
        self.changed.insert(room_id.to_owned());
        Ok(())
    }

    fn room(&self, room_id: &str) -> Result<&PlanRoom, Error> {
        self.plan.room(room_id).ok_or_else(|| mismatch(format!("the world has no room `{room_id}`")))
    }

    fn placement(&self, id: &str) -> Result<&Placement, Error> {
        let found = self.placements.placements.iter().find(|p| p.placement_id == id);
        found.ok_or_else(|| mismatch(format!("the world has no object `{id}`")))
    }
}

fn known<'a>(domain: &'a Domain, object: &str) -> Result<&'a ObjectType, Error> {
    domain.object(object).ok_or_else(|| mismatch(format!("domain `{}` has no object `{object}`", domain.id)))
}

type Model = ([f64; 3], String, Option<d3dgen_model::placements::AssetChoice>);

/// Returns the models that may take an object's place, the most usual first, without the one that stands there.
fn models(domain: &Domain, kind: &ObjectType, old: &Placement, asset: Option<&str>) -> Result<Vec<Model>, Error> {
    let size_mm = |s: &[f64; 3]| s.map(|m| (m * 1000.0).round() as i32);
    let all = kind.sizes_m.iter().map(|size| {
        let (name, choice) = stocked(domain, kind, size_mm(size));
        (*size, name, choice)
    });
    let all: Vec<Model> = all.collect();
    if let Some(asset) = asset {
        let named: Vec<Model> = all.iter().filter(|m| m.1 == asset).cloned().collect();
        if named.is_empty() {
            let known: BTreeSet<&str> = all.iter().map(|m| m.1.as_str()).collect();
            let known: Vec<&str> = known.into_iter().collect();
            return Err(mismatch(format!(
                "no model `{asset}` of `{}` is known; there is {}",
                kind.id,
                known.join(", ")
            )));
        }
        return Ok(named);
    }
    let same = |m: &Model| m.1 == old.asset && size_mm(&m.0) == size_mm(&old.size_m);
    Ok(all.into_iter().filter(|m| !same(m)).collect())
}

/// Returns true when two objects share space.
fn overlap(a: &Placement, b: &Placement) -> bool {
    const FLAT_M: f64 = 0.03;
    let (x, y): (Rect, Rect) = (a.footprint().bounds().grown(-0.002), b.footprint().bounds().grown(-0.002));
    let high = a.pose.z < b.top_m() - 0.002 && b.pose.z < a.top_m() - 0.002;
    x.overlaps(&y) && high && a.size_m[2] > FLAT_M && b.size_m[2] > FLAT_M
}

/// Returns how far a room moved to the east and north, m, when nothing but its place changed.
fn moved_by(old: &PlanRoom, new: &PlanRoom) -> Option<(f64, f64)> {
    let (a, b) = (old.net_polygon.corners(), new.net_polygon.corners());
    let (dx, dy) = (to_mm(b[0].x - a[0].x), to_mm(b[0].y - a[0].y));
    let follows = |(p, q): (&Point, &Point)| (q.x - p.x - dx).abs() < 1e-6 && (q.y - p.y - dy).abs() < 1e-6;
    ((dx, dy) != (0.0, 0.0) && a.len() == b.len() && a.iter().zip(b).all(follows)).then_some((dx, dy))
}

/// Returns which sides of an object's footprint (west, east, south, north) lie at a wall of a room.
fn touches(p: &Placement, room: &PlanRoom) -> [bool; 4] {
    let b = p.footprint().bounds();
    let c = b.center();
    let sides = [Point::new(b.x0, c.y), Point::new(b.x1, c.y), Point::new(c.x, b.y0), Point::new(c.x, b.y1)];
    let mut out = [false; 4];
    for (side, at) in sides.into_iter().enumerate() {
        out[side] = room.net_polygon.edges().any(|e| {
            let (line, low, high) = e.span();
            let (along, across) = if e.is_vertical() { (at.y, at.x) } else { (at.x, at.y) };
            e.is_vertical() == (side < 2) && (across - line).abs() <= AT_WALL_M && (low..=high).contains(&along)
        });
    }
    out
}

/// Returns a heading turned by quarters, in (-pi, pi] and exact for whole quarters.
fn heading(yaw_rad: f64, quarters: f64) -> f64 {
    let q = ((yaw_rad / FRAC_PI_2).round() + quarters).rem_euclid(4.0);
    [0.0, FRAC_PI_2, std::f64::consts::PI, -FRAC_PI_2][q as usize % 4]
}
