//! Back to a wall: at the ends and in the middle of every free stretch, beside neighbors, under windows.

use std::rc::Rc;

use d3dgen_model::domain::{Arrangement, Mount, Shape};

use super::barred::Barred;
use super::ends::BETWEEN_WINDOWS;
use super::{Find, Rule};
use crate::docks::{beside_berth, door_loss};
use crate::geom::{Box2, FLAT, turn};
use crate::seats::is_seat;
use crate::space::{DoorZone, WallSide};
use crate::state::{Placed, at_frame, takes_floor};
use crate::unit::{Part, Unit};

/// Positions nearer than this along a wall are one position, mm.
const SAME: i32 = 20;
/// Regular positions along a wall, beside the telling ones, mm.
const STEP: i32 = 450;
/// What all the free wall at one side is worth where a bed is to leave it to a wardrobe.
const ASIDE: f64 = 3.0;
/// How far from both walls of a corner something stands in it, mm.
const IN_CORNER: i32 = 50;
/// A gap narrower than this beside furniture collects dust, mm.
const SLIVER: i32 = 300;

/// Width up to which a part of a room is a neck, what furniture leaves of it for the way in, how far from it a door is that one
/// comes in by, and how wide the room is to which it leads, mm.
const NECK: i32 = 1550;
const NECK_WAY: i32 = 900;
const ALONG_NECK: i32 = 2500;
const WIDE_ROOM: i32 = 2000;
/// What hangs this near to a leaf that stands open is behind it, mm.
const BEHIND_LEAF: f64 = 350.0;
/// How far from the entrance something that belongs there may stand, mm.
const BY_ENTRANCE: i32 = 4500;

/// A chair nearer than this to a bed or desk belongs to it, mm.
const CHAIR_REACH: i32 = 1500;

/// What a seat loses from whose wall no screen is seen, from which distance a screen is far, mm, and what a meter more loses.
const NO_VIEW: f64 = 2.5;
const FAR_VIEW: i32 = 3600;
const FARTHER: f64 = 1.8;
/// How far from the screen a sofa stands that leaves its wall for it, mm, the way behind it, mm, and what that loses.
const NEAR_VIEW: i32 = 2900;
const WAY_BEHIND: i32 = 900;
const DRAWN_UP: f64 = 1.0;
/// What a meter more than a way behind it loses: nothing else uses that floor.
const EMPTY_BEHIND: f64 = 0.4;

/// Floor ahead of a door, mm, and what a place loses that takes some of it.
const AHEAD_OF_DOOR: i32 = 900;
const MET: f64 = 1.2;
/// Opening of a door within which no hob stands, the same of the floor that a leaf swings over, mm, and what a place with one there loses (ways past pots).
const FROM_STOVE: i32 = 900;
const LEAF_FROM_STOVE: i32 = 400;
const HOT: f64 = 4.0;
/// What a place loses with a leaf that sweeps the floor before a toilet or its cubicle.
const SWEPT: f64 = 4.0;
/// What it loses where a leaf opens on who uses something else.
const BY_LEAF: f64 = 0.8;
/// What a machine loses for each meter from the sink or hob it works with, and from where on it makes no difference, m.
const FROM_RUN: f64 = 1.5;
const FAR_FROM_RUN_M: f64 = 2.5;
/// Elbow room at each side of a basin, mm, and what a place without it loses.
const ELBOW: i32 = 120;
const CRAMPED: f64 = 1.5;
/// What a hand dryer loses for each meter from the basin.
const FROM_BASIN: f64 = 3.0;
/// What one of several docks is worth at the end of a wall or right beside another.
const IN_BANK: f64 = 3.0;
/// Part of a bed beside which a visitor sits, from its head, mm.
const HEAD: i32 = 700;

/// What already takes part of a wall.
struct Front {
    /// Stretches along the wall that are taken, merged and in order.
    taken: Vec<(i32, i32)>,
    /// Ends and middles of everything near the wall.
    marks: Vec<i32>,
}

impl<'a> Find<'_, 'a, '_> {
    /// Offers positions with the back to each wall.
    pub(super) fn along_walls(&mut self, unit: &Rc<Unit<'a>>) {
        let before = self.out.len();
        // what heats belongs to an outer wall with a window, or elsewhere than in this room
        let heats = self.task.arrangement == Arrangement::WindowWall && self.task.anchor.shape == Shape::Panel;
        for i in 0..self.state.space.walls.len() {
            if !heats || self.state.space.windows_of(i).next().is_some() {
                self.along_wall(unit, i, 0.0);
            }
        }
        if self.out.len() == before {
            self.none(Rule::NoPlace);
        }
    }

    /// Offers positions with the back to one wall; `bonus` is added to each score.
    pub(super) fn along_wall(&mut self, unit: &Rc<Unit<'a>>, index: usize, bonus: f64) {
        let space = self.state.space;
        let wall = &space.walls[index];
        let b = unit.bbox;
        if wall.length() < b.height() {
            self.none(Rule::Outside);
            return;
        }
        let front = self.front(wall, index, unit);
        let u = wall.u - b.x0;
        let at_window = self.task.arrangement == Arrangement::AtWindow;
        let barred = Barred::along(self.state, unit, wall, u, at_window);
        for v in self.stops(wall, index, unit, &front) {
            if self.is_wedged(unit, &front, v) || self.is_far_in(wall, unit, v) {
                self.none(Rule::Clearance);
                continue;
            }
            let placed = at_frame(unit, wall.q, u, v, self.index);
            let class = index as u32 * 4
                + if v + b.y0 < wall.v0 + 300 {
                    0
                } else if v + b.y1 > wall.v1 - 300 {
                    1
                } else {
                    2
                };
            if let Some((nearer, by)) = self.drawn_up(&placed, wall) {
                let less = DRAWN_UP + EMPTY_BEHIND * f64::from(by - WAY_BEHIND) / 1000.0;
                self.offer(nearer, class / 4 * 4 + 3, |find, p| bonus - less + find.wall_score(p, index, &front, v));
            }
            if self.task.required == 0 && self.pinches_neck(&placed, wall) {
                self.none(Rule::Clearance);
                continue;
            }
            match barred.rule_at(v) {
                Some(rule) => self.none(rule),
                None => self.offer(placed, class, |find, p| bonus + find.wall_score(p, index, &front, v)),
            }
        }
    }

    /// Returns a sofa moved towards what it looks at where that would be far, with a way behind it, and by how much, mm.
    fn drawn_up(&self, p: &Placed<'a>, wall: &WallSide) -> Option<(Placed<'a>, i32)> {
        let sofa = !self.at_wall && p.unit.anchor().object.shape == Shape::Sofa;
        let unit = self.across.as_ref().filter(|_| sofa)?;
        let by = self.view(p, unit).map(|(far, _)| far).filter(|&far| far > FAR_VIEW)? - NEAR_VIEW;
        let (u, v) = turn((4 - wall.q) % 4, p.at.0, p.at.1);
        (by >= WAY_BEHIND).then(|| (at_frame(&p.unit, wall.q, u + by, v, self.index), by))
    }

    /// Returns true for what would narrow the way in between two walls that are close to each other.
    fn pinches_neck(&self, p: &Placed<'a>, wall: &WallSide) -> bool {
        let space = self.state.space;
        let stands = |part: &Part| part.mount == Mount::Floor && part.solid.stops_robot();
        if space.main.width().min(space.main.height()) < WIDE_ROOM || !p.unit.parts.iter().any(stands) {
            return false;
        }
        let back = (4 - wall.q) % 4;
        let own = p.world(&p.unit.bbox).turned(back);
        let across = |w: &&WallSide| w.q == (wall.q + 2) % 4 && -w.v1 < own.y1 && own.y0 < -w.v0 && -w.u > wall.u;
        let Some(far) = space.walls.iter().filter(across).map(|w| -w.u).min() else { return false };
        if far - wall.u > NECK || far - own.x1 >= NECK_WAY {
            return false;
        }
        // nobody goes through a niche
        let neck = Box2 { x0: wall.u, x1: far, y0: own.y0 - ALONG_NECK, y1: own.y1 + ALONG_NECK }.turned(wall.q);
        space.doors.iter().any(|door| door.zone.overlaps(&neck))
    }

    /// Looks along a wall for what is in the way of a unit.
    fn front(&self, wall: &WallSide, index: usize, unit: &Unit) -> Front {
        let space = self.state.space;
        let b = unit.bbox;
        let (z0, z1) = unit
            .parts
            .iter()
            .filter(|p| p.mount != Mount::Ceiling && p.mount != Mount::Surface)
            .fold((i32::MAX, FLAT + 1), |(lo, hi), p| (lo.min(p.solid.z0), hi.max(p.solid.z1)));
        let strip = wall.strip(wall.v0, wall.v1, 0, b.width());
        let near = |r: &Box2| {
            r.overlaps(&strip).then(|| {
                let r = r.turned((4 - wall.q) % 4);
                (r.y0, r.y1)
            })
        };
        let mut taken: Vec<(i32, i32)> = Vec::new();
        taken.extend(space.doors.iter().filter(|d| z0 < d.height).filter_map(|d| near(d.kept(self.state.open))));
        let solids = self.state.solids.iter();
        taken.extend(solids.clone().filter(|s| !s.is_flat() && s.z0 < z1 && z0 < s.z1).filter_map(|s| near(&s.rect)));
        let mut marks: Vec<i32> = taken.iter().flat_map(|t| [t.0, t.1]).collect();
        for w in space.windows_of(index) {
            if z1 > w.sill && z0 < w.head {
                taken.push((w.v0, w.v1));
            }
            marks.extend([w.v0, w.v1]);
        }
        marks.extend(self.state.clears.iter().filter_map(near).flat_map(|t| [t.0, t.1]));
        taken.sort_unstable();
        taken.dedup_by(|next, last| {
            let joined = next.0 <= last.1;
            if joined {
                last.1 = last.1.max(next.1);
            }
            joined
        });
        Front { taken, marks }
    }

    /// Returns true for seats nobody gets to: furniture close by on both sides.
    fn is_wedged(&self, unit: &Unit, front: &Front, v: i32) -> bool {
        if self.task.required > 0 || unit.seats() < 2 || unit.parts.len() < 3 {
            return false;
        }
        let (a, z) = (v + unit.bbox.y0, v + unit.bbox.y1);
        let near = |gap: i32| (0..SLIVER).contains(&gap);
        front.taken.iter().any(|t| near(a - t.1)) && front.taken.iter().any(|t| near(t.0 - z))
    }

    /// Returns true for what belongs to the entrance and would stand deep inside.
    fn is_far_in(&self, wall: &WallSide, unit: &Unit, v: i32) -> bool {
        let entrance = self.state.space.doors.first().filter(|door| door.rank == 0);
        let own = wall.strip(v + unit.bbox.y0, v + unit.bbox.y1, 0, unit.bbox.width());
        self.task.arrangement == Arrangement::BesideDoor
            && self.task.required == 0
            && entrance.is_some_and(|door| own.gap(&door.zone) > BY_ENTRANCE)
    }

    /// Returns positions of the unit's origin along the wall.
    fn stops(&self, wall: &WallSide, index: usize, unit: &Unit, front: &Front) -> Vec<i32> {
        let (b, r) = (unit.bbox, unit.reach);
        let mut out = Vec::with_capacity(4 * front.marks.len() + 32);
        let marks = [wall.v0, wall.v1].into_iter().chain(front.marks.iter().copied());
        for m in marks {
            out.extend([m - b.y0, m - b.y1, m - r.y0, m - r.y1]);
        }
        if self.task.arrangement != Arrangement::Corner {
            let middle = (b.y0 + b.y1) / 2;
            let mut from = wall.v0;
            for &(t0, t1) in front.taken.iter().chain(&[(wall.v1, wall.v1)]) {
                out.push((from + t0) / 2 - middle);
                from = from.max(t1);
            }
            out.extend(self.state.space.windows_of(index).map(|w| (w.v0 + w.v1) / 2 - middle));
            if self.task.anchor.mount == Mount::Wall {
                // over the middle of what stands below
                out.extend(self.state.placed.iter().filter(|p| p.q == wall.q && p.on_floor()).map(|p| {
                    let r = p.world(&p.unit.parts[0].solid.rect).turned((4 - wall.q) % 4);
                    (r.y0 + r.y1) / 2 - middle
                }));
            }
            for p in self.siblings().filter(|p| p.q % 2 == wall.q % 2) {
                // in line with one of its kind across the room
                out.push(turn((4 - wall.q) % 4, p.at.0, p.at.1).1);
            }
            let mut v = wall.v0 - b.y0 + STEP / 2;
            while v + b.y1 < wall.v1 {
                out.push(v);
                v += STEP;
            }
        }
        if self.task.anchor.shape == Shape::Basin {
            let own = unit.anchor().solid.rect;
            out.extend([wall.v0 + ELBOW - own.y0, wall.v1 - ELBOW - own.y1]);
        }
        out.sort_unstable();
        out.dedup_by(|a, b| *a - *b < SAME && *a != wall.v1 - unit.bbox.y1);
        if self.banked {
            out.extend(self.berth_stops(wall, unit));
        }
        out.retain(|v| v + b.y0 >= wall.v0 && v + b.y1 <= wall.v1);
        out
    }

    /// Returns where one of several docks leaves the others most of a wall: at the ends of it and beside one that stands there,
    /// as near as the robots before them can be.
    fn berth_stops(&self, wall: &WallSide, unit: &Unit) -> Vec<i32> {
        let own = unit.anchor().solid.rect;
        let middle = (own.y0 + own.y1) / 2;
        let beside = |p: &Placed<'a>| {
            let dock = p.world(&p.unit.anchor().solid.rect).turned((4 - wall.q) % 4);
            let (at, step) = ((dock.y0 + dock.y1) / 2, beside_berth(self.aisle));
            (p.q == wall.q && (dock.x0 - wall.u).abs() < SAME).then_some([at - step, at + step])
        };
        let docks = self.state.placed.iter().filter(|p| p.unit.anchor().object.shape == Shape::Dock);
        let ends = [wall.v0 + (self.aisle + 1) / 2, wall.v1 - (self.aisle + 1) / 2];
        docks.filter_map(beside).flatten().chain(ends).map(|at| at - middle).collect()
    }

    fn wall_score(&self, p: &Placed<'a>, index: usize, front: &Front, v: i32) -> f64 {
        let (space, style) = (self.state.space, self.style);
        let wall = &space.walls[index];
        let b = p.unit.bbox;
        let (a, z) = (v + b.y0, v + b.y1);
        let low = front.taken.iter().filter(|t| t.1 <= a + 5).map(|t| t.1).max().unwrap_or(wall.v0).max(wall.v0);
        let high = front.taken.iter().filter(|t| t.0 >= z - 5).map(|t| t.0).min().unwrap_or(wall.v1).min(wall.v1);
        let (gl, gr) = ((a - low).max(0), (high - z).max(0));
        let floor = self.task.anchor.mount == Mount::Floor;
        let mut s = 0.0;
        for (gap, at_door) in [(gl, self.is_door_edge(index, low)), (gr, self.is_door_edge(index, high))] {
            if gap <= 5 {
                s += if at_door { 0.0 } else { style.flush };
            } else if floor && gap < SLIVER && !at_door {
                s -= 0.9;
            } else if floor && gap < self.aisle && !at_door {
                s -= 0.35;
            }
        }
        if self.task.anchor.shape == Shape::Basin {
            let own = p.unit.anchor().solid.rect;
            let sides = [v + own.y0 - low, high - v - own.y1];
            s -= CRAMPED * sides.iter().filter(|gap| **gap < ELBOW).count() as f64;
        }
        let spare = f64::from(gl + gr);
        let aside = f64::from((gl - gr).abs()) / (spare + 1.0) * (spare / 2000.0).min(1.0);
        // the first of several beds leaves the rest of the wall to the others
        let more = self.task.required as usize > self.siblings().count() + 1;
        s += match self.aside {
            0 if more => 0.8 * aside,
            0 => -style.centered * aside,
            end => ASIDE * f64::from(end) * f64::from(gl - gr) / (spare + 1.0) * (spare / 2000.0).min(1.0),
        };
        s -= style.tight * (spare / 3000.0).min(1.0);
        s += self.window_score(index, a, z) + self.door_score(p) + self.sibling_score(p, a, z, index);
        s -= door_loss(space, p, self.aisle);
        if self.banked && self.berth_stops(wall, &p.unit).contains(&v) {
            s += IN_BANK;
        }
        s += self.company_score(p) - self.at_doors(p) - self.apart_from_run(p) - self.apart_from_basin(p);
        s -= self.across.as_ref().map_or(0.0, |unit| far_view(self.view(p, unit)));
        s + self.arrangement_score(p, index, a, z)
    }

    /// Returns true for what has its back and a side at the walls of a corner.
    pub(super) fn is_in_corner(&self, p: &Placed<'a>) -> bool {
        let own = p.world(&p.unit.bbox).turned((4 - p.q) % 4);
        let near = |a: i32, b: i32| (a - b).abs() < IN_CORNER;
        let mut behind = self.state.space.walls.iter().filter(|w| w.q == p.q && near(own.x0, w.u));
        behind.any(|w| w.corner0 && near(own.y0, w.v0) || w.corner1 && near(own.y1, w.v1))
    }

    fn is_door_edge(&self, wall: usize, v: i32) -> bool {
        self.state.space.doors.iter().any(|d| d.wall == wall && ((d.v0 - v).abs() < 10 || (d.v1 - v).abs() < 10))
    }

    /// Light and views: windows behind it, a window at its side.
    fn window_score(&self, index: usize, a: i32, z: i32) -> f64 {
        let space = self.state.space;
        let solid = if self.task.arrangement == Arrangement::SolidWall { 1.5 } else { 0.0 };
        let behind: i32 = space.windows_of(index).map(|w| (z.min(w.v1) - a.max(w.v0)).max(0)).sum();
        let mut s = -(self.style.solid_behind + solid) * f64::from(behind) / f64::from((z - a).max(1));
        if self.style.side_light > 0.0 {
            let q = space.walls[index].q;
            let beside = space.windows.iter().any(|w| space.walls[w.wall].q % 2 != q % 2);
            s += if beside { self.style.side_light } else { 0.0 };
            // the screen would mirror it
            let across = space.windows.iter().any(|w| space.walls[w.wall].q == (q + 2) % 4);
            s -= if across { 1.2 * self.style.side_light } else { 0.0 };
        }
        s
    }

    /// Returns what a place loses with a hob right beside a door, with a leaf that sweeps the floor before what is used, or with a
    /// level shower that one comes in through.
    fn at_doors(&self, p: &Placed<'a>) -> f64 {
        let space = self.state.space;
        let opening = |d: &DoorZone| space.walls[d.wall].strip(d.v0, d.v1, 0, 0);
        let by_leaf = |d: &DoorZone, rect: &Box2| d.swings_in && d.zone.gap(rect) < LEAF_FROM_STOVE;
        let hot = |rect: Box2| space.doors.iter().any(|d| opening(d).gap(&rect) < FROM_STOVE || by_leaf(d, &rect));
        let stoves = p.unit.parts.iter().filter(|part| part.object.shape == Shape::Stove);
        let hobs = stoves.filter(|part| hot(p.solid(part).rect)).count();
        let closet = matches!(p.unit.anchor().object.shape, Shape::Cubicle | Shape::Toilet);
        let leaves = || space.doors.iter().filter(|d| d.swings_in);
        let swept = p.unit.clears.iter().map(|c| p.world(c)).any(|c| leaves().any(|d| d.zone.overlaps(&c)));
        // nobody walks in through a shower
        let shower = |part: &Part| part.object.shape == Shape::Shower && part.mount == Mount::Floor;
        let showers = p.unit.parts.iter().filter(|part| shower(part)).map(|part| p.solid(part).rect);
        let wet = showers.filter(|shower| space.doors.iter().any(|d| d.zone.overlaps(shower))).count();
        let ahead = |d: &DoorZone| space.walls[d.wall].strip(d.v0, d.v1, 0, AHEAD_OF_DOOR);
        let bodies = || p.unit.parts.iter().map(|part| (part, p.solid(part))).filter(|(part, s)| takes_floor(part, s));
        let met = space.doors.iter().filter(|d| bodies().any(|(_, s)| s.rect.overlaps(&ahead(d)))).count();
        MET * met as f64
            + HOT * hobs as f64
            + if closet { SWEPT } else { BY_LEAF } * f64::from(swept)
            + SWEPT * wet as f64
    }

    /// Returns what a machine loses away from the sink or hob it works with: a refrigerator belongs to the kitchen's run.
    fn apart_from_run(&self, p: &Placed<'a>) -> f64 {
        let anchor = p.unit.anchor();
        if anchor.object.shape != Shape::Appliance || anchor.mount != Mount::Floor {
            return 0.0;
        }
        let works = |part: &Part| part.mount == Mount::Floor && matches!(part.object.shape, Shape::Sink | Shape::Stove);
        let runs = self.state.placed.iter().filter(|o| o.support.is_none() && o.unit.parts.iter().any(works));
        let own = p.world(&p.unit.bbox);
        let gap = runs.map(|o| o.world(&o.unit.bbox).gap(&own)).min().unwrap_or(0);
        FROM_RUN * (f64::from(gap) / 1000.0).min(FAR_FROM_RUN_M)
    }

    /// Returns what a machine on the wall loses away from the basin: hands are dried where they were washed.
    fn apart_from_basin(&self, p: &Placed<'a>) -> f64 {
        let anchor = p.unit.anchor();
        if anchor.object.shape != Shape::Appliance || anchor.mount != Mount::Wall {
            return 0.0;
        }
        let parts = self.state.placed.iter().flat_map(|o| o.unit.parts.iter().map(move |part| (o, part)));
        let basins = parts.filter(|(_, part)| part.object.shape == Shape::Basin).map(|(o, part)| o.solid(part).rect);
        let own = p.world(&p.unit.bbox);
        let gap = basins.map(|basin| basin.gap(&own)).min().unwrap_or(0);
        FROM_BASIN * (f64::from(gap) / 1000.0)
    }

    /// Distance to the door of the room, and not having it in one's back.
    fn door_score(&self, p: &Placed<'a>) -> f64 {
        let space = self.state.space;
        let Some(door) = space.doors.first() else { return 0.0 };
        let rect = p.world(&p.unit.bbox);
        let gap = f64::from(rect.gap(&door.zone)) / 1000.0;
        let size = f64::from(space.bounds.width().max(space.bounds.height())) / 1000.0;
        let mut s = self.style.far_from_door * (gap / size.max(1.0)).min(1.0);
        if self.style.far_from_door > 1.0 && gap < 0.5 {
            s -= 0.8;
        }
        if self.style.door_in_view > 0.0 {
            // its user stands in front and looks at it: a door further in front is behind the user
            let (dx, dy) = super::super::geom::DIR[usize::from(p.q)];
            let (c, d) = (rect.center(), door.zone.center());
            if (d.0 - c.0) * dx + (d.1 - c.1) * dy > 1200 {
                s -= self.style.door_in_view;
            }
        }
        s
    }

    /// Equal things in one line on one wall as close as they may be, or opposite each other.
    fn sibling_score(&self, p: &Placed<'a>, a: i32, z: i32, index: usize) -> f64 {
        let wall = &self.state.space.walls[index];
        let mut s: f64 = 0.0;
        if self.style.spread > 0.0 {
            let rect = p.world(&p.unit.bbox);
            let nearest = self.siblings().map(|o| rect.gap(&o.world(&o.unit.bbox))).min();
            return nearest.map_or(0.0, |gap| self.style.spread * (f64::from(gap) / 2500.0).min(1.0));
        }
        for other in self.siblings() {
            let turned = |b: &Box2| other.world(b).turned((4 - wall.q) % 4);
            let (r, reach) = (turned(&other.unit.bbox), turned(&other.unit.reach));
            let same_wall = other.q == p.q && (r.x0 - wall.u).abs() < 60;
            let aligned = (r.y0 - a).abs() < 30 && (r.y1 - z).abs() < 30;
            if same_wall {
                let (gap, theirs, own) = if a >= r.y1 {
                    (a - r.y1, reach.y1 - r.y1, p.unit.bbox.y0 - p.unit.reach.y0)
                } else {
                    (r.y0 - z, r.y0 - reach.y0, p.unit.reach.y1 - p.unit.bbox.y1)
                };
                s = s.max(if (gap - theirs.max(own)).abs() <= 30 { 1.5 } else { 0.7 });
            } else if other.q == (p.q + 2) % 4 && aligned {
                s = s.max(0.5);
            }
        }
        s
    }

    /// A lone chair belongs beside the bed or desk the room is about, each to its own, and not before the basin.
    fn company_score(&self, p: &Placed<'a>) -> f64 {
        if p.unit.parts.len() > 1 || !is_seat(self.task.anchor.shape) {
            return 0.0;
        }
        let rect = p.world(&p.unit.bbox);
        let standing = |shapes: &'static [Shape]| {
            let of = move |o: &&Placed<'a>| shapes.contains(&o.unit.anchor().object.shape);
            self.state.placed.iter().filter(of).map(|o| o.world(&o.unit.anchor().solid.rect))
        };
        let has_chair = |host: &Box2| self.siblings().any(|o| o.world(&o.unit.bbox).gap(host) < CHAIR_REACH);
        let beds = self.state.placed.iter().filter(|o| o.unit.anchor().object.shape == Shape::HospitalBed);
        let heads = beds.map(|o| {
            let own = o.unit.anchor().solid.rect;
            o.world(&Box2 { x1: own.x1.min(own.x0 + HEAD), ..own })
        });
        let mut hosts: Vec<Box2> = standing(&[Shape::Bed, Shape::Desk]).chain(heads).collect();
        if !hosts.iter().all(has_chair) {
            hosts.retain(|host| !has_chair(host));
        }
        let away = hosts.iter().map(|host| rect.gap(host)).min().unwrap_or(0);
        // visitors sit across the desk or at its ends, not beside who works there
        let behind = |o: &&Placed<'a>| {
            let back = (8 - o.q - o.unit.look()) % 4;
            let desk = o.world(&o.unit.anchor().solid.rect).turned(back);
            o.unit.anchor().object.shape == Shape::Desk && o.unit.look() != 0 && rect.turned(back).center().0 < desk.x0
        };
        let among_staff =
            self.state.placed.iter().filter(behind).any(|o| o.world(&o.unit.bbox).gap(&rect) < CHAIR_REACH);
        let wet = standing(&[Shape::Basin, Shape::Sink, Shape::Toilet]).any(|o| o.gap(&rect) < SLIVER);
        -1.2 * (f64::from(away) / 1000.0).min(3.0) - if wet { 1.2 } else { 0.0 } - if among_staff { 1.5 } else { 0.0 }
    }

    fn arrangement_score(&self, p: &Placed<'a>, index: usize, a: i32, z: i32) -> f64 {
        let space = self.state.space;
        let wall = &space.walls[index];
        match self.task.arrangement {
            Arrangement::Corner => {
                let near = |end: i32, inner: bool, at: i32| inner && (end - at).abs() < 120;
                if near(wall.v0, wall.corner0, a) || near(wall.v1, wall.corner1, z) { 2.0 } else { -1.0 }
            }
            Arrangement::WindowWall => {
                let mid = (a + z) / 2;
                let off = space.windows_of(index).map(|w| ((w.v0 + w.v1) / 2 - mid).abs()).min();
                off.map_or(-1.5, |off| 1.5 - f64::from(off) / 1000.0)
            }
            Arrangement::BesideDoor => self.beside_door(p, index, a, z),
            _ => 0.0,
        }
    }

    /// Next to a door on its wall, the latch side first; on the wall around the corner next. The first of its kind belongs
    /// to the door one comes in by, the others to the other doors.
    fn beside_door(&self, p: &Placed<'a>, index: usize, a: i32, z: i32) -> f64 {
        let doors = &self.state.space.doors;
        let Some(d) = doors.get(self.siblings().count() % doors.len().max(1)) else { return 0.0 };
        let away = f64::from(p.world(&p.unit.bbox).gap(&d.zone));
        if d.wall != index {
            let wall = &self.state.space.walls[d.wall];
            let (_, along) = p.world(&p.unit.bbox).turned((4 - wall.q) % 4).center();
            // on the wall that the open leaf stands before
            let hinge_side = d.latch_high.is_some_and(|high| if high { along < d.v0 } else { along > d.v1 });
            let behind = d.swings_in && hinge_side && away < BEHIND_LEAF;
            return 0.5 - away / 800.0 - if behind { 1.5 } else { 0.0 };
        }
        let above = z >= d.v1;
        let gap = if above { a - d.v1 } else { d.v0 - z };
        let latch = d.latch_high.map_or(0.3, |high| if high == above { 0.8 } else { 0.0 });
        2.0 + latch - f64::from((gap - 100).abs()) / 300.0
    }
}

/// Returns what a seat loses with what it looks at so far away, mm, or between two windows.
fn far_view(view: Option<(i32, bool)>) -> f64 {
    let loss = |(far, dazzled): (i32, bool)| {
        let away = FARTHER * (f64::from(far - FAR_VIEW) / 1000.0).max(0.0);
        away + if dazzled { BETWEEN_WINDOWS } else { 0.0 }
    };
    view.map_or(NO_VIEW, loss)
}
