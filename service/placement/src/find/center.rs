//! Free-standing in the largest free area of the room.

use std::rc::Rc;

use d3dgen_model::domain::Shape;

use super::{Find, Focus, Rule};
use crate::geom::{Box2, Solid, turn};
use crate::seats::is_seat;
use crate::space::DoorZone;
use crate::state::{Placed, at_frame};
use crate::unit::Unit;

/// Grain of the search for free floor, mm.
const GRAIN: i32 = 150;
/// Floor between the swing of a door and what stands free, mm, and what less of it loses.
const PAST_LEAF: i32 = 600;
const AT_SWING: f64 = 1.0;
/// Free floor around tables with seats, mm.
const BESIDE: i32 = 300;
/// Floor beside a table with its chairs on which robots pass while somebody pushes a chair back, mm, and what it is worth.
const WAY_BEHIND_SEATS: i32 = 1050;
const BEHIND_SEATS: f64 = 1.6;
/// Height up to which a table is one for those on sofas, mm.
const LOW_TABLE: i32 = 550;
/// Floor between a gate and the vehicle behind it, mm.
const TO_GATE: [i32; 6] = [700, 620, 900, 1200, 1600, 2000];
/// Floor between such a table and an armchair at its end, and how far from its middle that stands, mm.
const TO_TABLE: [i32; 4] = [450, 600, 800, 1000];
const ALONG_TABLE: [i32; 5] = [0, 200, -200, 350, -350];

impl<'a> Find<'_, 'a, '_> {
    /// Offers free-standing positions around the middle of the largest free rectangle.
    pub(super) fn center(&mut self, unit: &Rc<Unit<'a>>) {
        if self.task.required == 0
            && unit.anchor().object.shape == Shape::Sofa
            && let Some((q, table)) = self.low_table()
        {
            return self.at_low_table(unit, q, &table);
        }
        if unit.anchor().object.shape == Shape::Vehicle && self.at_gate(unit) {
            return;
        }
        let free = self.largest_free();
        let space = self.state.space;
        let flat = unit.parts[0].solid.is_flat();
        // seats that nobody asked for stand where one gets at them, or not at all
        let sits = self.task.required == 0 && unit.parts.iter().any(|p| is_seat(p.object.shape));
        let grid = |lo: i32, hi: i32| {
            let step = ((hi - lo) / 14).max(250);
            (0..).map(move |k| lo + k * step).take_while(move |v| *v < hi)
        };
        let (fx, fy) = free.center();
        let (mx, my) = space.main.center();
        let mut centers = vec![(fx, fy), (mx, my), (fx, my), (mx, fy)];
        centers.extend(grid(free.x0, free.x1).flat_map(|x| grid(free.y0, free.y1).map(move |y| (x, y))));
        // where one way there is little to spare the middle is the only place
        centers.extend(grid(free.x0, free.x1).flat_map(|x| [(x, my), (x, fy)]));
        centers.extend(grid(free.y0, free.y1).flat_map(|y| [(mx, y), (fx, y)]));
        centers.extend(self.beside_siblings(unit));
        let before = self.out.len();
        for q in 0..4_u8 {
            let (bu, bv) = unit.bbox.center();
            let (du, dv) = turn(q, bu, bv);
            // with all the floor it needs right up to a wall, in the middle the other way
            let reach = unit.reach.turned(q);
            let xs = [space.main.x0 - reach.x0, space.main.x1 - reach.x1].map(|x| x + du);
            let ys = [space.main.y0 - reach.y0, space.main.y1 - reach.y1].map(|y| y + dv);
            let flush = (xs.into_iter().flat_map(|x| [my, fy].map(|y| (x, y))))
                .chain(ys.into_iter().flat_map(|y| [mx, fx].map(|x| (x, y))));
            for (x, y) in centers.iter().copied().chain(flush) {
                let (u, v) = turn(4 - q, x - du, y - dv);
                let placed = at_frame(unit, q, u, v, self.index);
                if sits && !self.is_open_around(&placed, BESIDE) {
                    self.none(Rule::Clearance);
                    continue;
                }
                self.offer(placed, u32::from(q % 2), |find, p| find.center_score(p, &free, flat));
            }
        }
        if self.out.len() == before {
            self.none(Rule::NoPlace);
        }
    }

    /// Offers positions in line with the gate that a vehicle comes through; returns false where none will do.
    fn at_gate(&mut self, unit: &Rc<Unit<'a>>) -> bool {
        let own = unit.anchor().solid.rect;
        let space = self.state.space;
        let wide = space.doors.iter().filter(|d| d.clear_width > own.height() + BESIDE);
        let Some(gate) = wide.max_by_key(|d| d.clear_width) else { return false };
        let wall = &space.walls[gate.wall];
        let (bu, bv) = own.center();
        for (turns, gap, along) in
            [0, 2].into_iter().flat_map(|t| TO_GATE.into_iter().flat_map(move |g| ALONG_TABLE.map(|a| (t, g, a))))
        {
            let q = (wall.q + turns) % 4;
            let (du, dv) = turn(q, bu, bv);
            let (x, y) = turn(wall.q, wall.u + gap + own.width() / 2, (gate.v0 + gate.v1) / 2 + along);
            let (u, v) = turn(4 - q, x - du, y - dv);
            let off = f64::from((gap - TO_GATE[0]).abs() + 2 * along.abs()) / 1000.0;
            self.offer(at_frame(unit, q, u, v, self.index), u32::from(turns), |_, _| 2.0 - off);
        }
        !self.out.is_empty()
    }

    /// Returns where the sofa looks that has a low table before it, and the table.
    fn low_table(&self) -> Option<(u8, Box2)> {
        let sofas = self.state.placed.iter().filter(|p| p.unit.anchor().object.shape == Shape::Sofa);
        sofas.filter(|p| p.unit.item != self.task.item).find_map(|p| {
            let mut low = p.unit.parts.iter().filter(|part| part.solid.stops_robot() && part.solid.z1 <= LOW_TABLE);
            let table = low.find(|part| matches!(part.object.shape, Shape::Table | Shape::RoundTable))?;
            Some((p.q, p.solid(table).rect))
        })
    }

    /// Offers positions at the ends of the low table before a sofa, facing it: an armchair belongs to those who talk there, or
    /// is left out.
    fn at_low_table(&mut self, unit: &Rc<Unit<'a>>, sofa: u8, table: &Box2) {
        let own = unit.anchor().solid.rect;
        let (bu, bv) = own.center();
        let table = table.turned((4 - sofa) % 4);
        let (tx, ty) = table.center();
        for (turns, side) in [(3, 1), (1, -1)] {
            let q = (sofa + turns) % 4;
            let (du, dv) = turn(q, bu, bv);
            for (gap, along) in TO_TABLE.into_iter().flat_map(|gap| ALONG_TABLE.map(|along| (gap, along))) {
                let away = ty + side * (table.height() / 2 + gap + own.width() / 2);
                let (x, y) = turn(sofa, tx + along, away);
                let (u, v) = turn(4 - q, x - du, y - dv);
                let off = f64::from((gap - TO_TABLE[1]).abs() + along.abs()) / 1000.0;
                self.offer(at_frame(unit, q, u, v, self.index), u32::from(turns), |_, _| 2.0 - off);
            }
        }
        if self.out.is_empty() {
            self.none(Rule::NoPlace);
        }
    }

    fn center_score(&self, p: &Placed<'a>, free: &Box2, flat: bool) -> f64 {
        let rect = p.world(&p.unit.bbox);
        let ((cx, cy), (fx, fy)) = (rect.center(), free.center());
        let off = f64::from((cx - fx).abs() + (cy - fy).abs()) / 1000.0;
        let mut s = -0.6 * off;
        let along = (rect.width() >= rect.height()) == (free.width() >= free.height());
        s += if along { 0.8 } else { 0.0 };
        if !flat {
            for margin in [BESIDE, 600, 900] {
                s += if self.is_open_around(p, margin) { 0.5 } else { 0.0 };
            }
        }
        s += if self.state.has_robots && unit_seats(p) && self.has_way_behind_seats(p) { BEHIND_SEATS } else { 0.0 };
        // one gets past a leaf that stands open
        let near_swing = |d: &DoorZone| d.swings_in && d.zone.gap(&rect) < PAST_LEAF;
        s -= if !flat && self.state.space.doors.iter().any(near_swing) { AT_SWING } else { 0.0 };
        // equal things in one line, turned alike
        let in_line = self.siblings().any(|o| {
            let (x, y) = o.world(&o.unit.bbox).center();
            o.q % 2 == p.q % 2 && ((x - cx).abs() < 30 || (y - cy).abs() < 30)
        });
        let turned_alike = self.siblings().next().is_none_or(|o| o.q % 2 == p.q % 2);
        s += if in_line { 0.9 } else { 0.0 } - if turned_alike { 0.0 } else { 1.6 };
        if let Some(Focus { q, seat: middle, .. }) = self.focus() {
            // turned to what the room is about, in line with it
            let (_, v) = turn((4 - q) % 4, cx, cy);
            let (_, w) = turn((4 - q) % 4, middle.0, middle.1);
            s += if (v - w).abs() < 150 { 0.3 } else { 0.0 };
            s += if p.q == (q + 2) % 4 { 0.15 } else { 0.0 };
        }
        s
    }

    /// Returns true when a robot gets past a table on one side at least while chairs there are pushed back.
    fn has_way_behind_seats(&self, p: &Placed<'a>) -> bool {
        let r = p.world(&p.unit.bbox);
        let sides = [
            Box2 { x0: r.x0 - WAY_BEHIND_SEATS, x1: r.x0, ..r },
            Box2 { x0: r.x1, x1: r.x1 + WAY_BEHIND_SEATS, ..r },
            Box2 { y0: r.y0 - WAY_BEHIND_SEATS, y1: r.y0, ..r },
            Box2 { y0: r.y1, y1: r.y1 + WAY_BEHIND_SEATS, ..r },
        ];
        let wide = r.width() >= r.height();
        let long = if wide { &sides[2..] } else { &sides[..2] };
        let free = |side: &Box2| {
            let taken = |s: &Solid| s.stops_robot() && s.rect.overlaps(side);
            self.state.space.contains(side) && !self.state.solids.iter().any(taken)
        };
        long.iter().any(free)
    }

    /// Returns true when no wall and no furniture is nearer than a margin, mm.
    fn is_open_around(&self, p: &Placed<'a>, margin: i32) -> bool {
        let around = p.world(&p.unit.bbox).grown(margin);
        let taken = |s: &Solid| s.stops_robot() && s.rect.overlaps(&around);
        self.state.space.contains(&around) && !self.state.solids.iter().any(taken)
    }

    /// Returns places in line with units of the same kind: end to end, and with an aisle between.
    fn beside_siblings(&self, unit: &Unit<'a>) -> Vec<(i32, i32)> {
        let mut out = Vec::new();
        for o in self.siblings() {
            let r = o.world(&o.unit.bbox);
            let (x, y) = r.center();
            let (w, d) = if o.q.is_multiple_of(2) {
                (unit.bbox.width(), unit.bbox.height())
            } else {
                (unit.bbox.height(), unit.bbox.width())
            };
            for gap in [self.aisle, self.aisle + 300, self.aisle + 900] {
                let (dx, dy) = (r.width() / 2 + w / 2 + gap, r.height() / 2 + d / 2 + gap);
                out.extend([(x + dx, y), (x - dx, y), (x, y + dy), (x, y - dy)]);
            }
        }
        out
    }

    /// Returns the largest rectangle of floor without furniture and door zones, to the grain of the search.
    pub(super) fn largest_free(&self) -> Box2 {
        let space = self.state.space;
        let b = space.bounds;
        let grain = GRAIN.max(b.width().max(b.height()) / 80);
        let (nx, ny) = ((b.width() / grain).max(1) as usize, (b.height() / grain).max(1) as usize);
        let blocked: Vec<Box2> = (self.state.solids.iter().filter(|s| s.stops_robot()).map(|s| s.rect))
            .chain(space.doors.iter().map(|d| *d.kept(self.state.open)))
            .collect();
        let cell = |i: usize, j: usize| {
            let (x, y) = (b.x0 + i as i32 * grain, b.y0 + j as i32 * grain);
            Box2 { x0: x, y0: y, x1: x + grain, y1: y + grain }
        };
        let mut taken = vec![false; nx * ny];
        for (k, t) in taken.iter_mut().enumerate() {
            *t = !space.contains(&cell(k % nx, k / nx));
        }
        for r in &blocked {
            let lo = |v: i32, o: i32| ((v - o).max(0) / grain) as usize;
            let hi = |v: i32, o: i32, n: usize| (((v - o).max(0) + grain - 1) / grain).min(n as i32) as usize;
            for j in lo(r.y0, b.y0)..hi(r.y1, b.y0, ny) {
                for i in lo(r.x0, b.x0)..hi(r.x1, b.x0, nx) {
                    taken[j * nx + i] = true;
                }
            }
        }
        largest(&taken, nx, ny).map_or(space.main, |(i0, i1, j0, j1)| cell(i0, j0).union(&cell(i1 - 1, j1 - 1)))
    }
}

/// Returns true for a table that comes with seats.
fn unit_seats(p: &Placed) -> bool {
    let table = matches!(p.unit.anchor().object.shape, Shape::Table | Shape::RoundTable);
    table && p.unit.parts[1..].iter().any(|part| is_seat(part.object.shape))
}

/// Returns the largest rectangle of cells that are not taken, as columns `i0..i1` and rows `j0..j1` (heights of
/// columns of free cells, row after row).
fn largest(taken: &[bool], nx: usize, ny: usize) -> Option<(usize, usize, usize, usize)> {
    let mut heights = vec![0_usize; nx + 1];
    let mut best: Option<(usize, (usize, usize, usize, usize))> = None;
    for j in 0..ny {
        for i in 0..nx {
            heights[i] = if taken[j * nx + i] { 0 } else { heights[i] + 1 };
        }
        let mut open: Vec<(usize, usize)> = Vec::new(); // start column, height; heights increase
        for (i, &here) in heights.iter().enumerate() {
            let mut start = i;
            while let Some(&(from, height)) = open.last().filter(|o| o.1 >= here) {
                open.pop();
                start = from;
                let area = height * (i - from);
                if area > best.as_ref().map_or(0, |b| b.0) {
                    best = Some((area, (from, i, j + 1 - height, j + 1)));
                }
            }
            open.push((start, here));
        }
    }
    best.map(|b| b.1)
}

#[cfg(test)]
mod tests {
    use super::largest;

    #[test]
    fn finds_the_largest_free_rectangle() {
        let map = "#...\
                   ....\
                   ..##";
        let taken: Vec<bool> = map.chars().map(|c| c == '#').collect();
        assert_eq!(largest(&taken, 4, 3), Some((1, 4, 0, 2)));
        assert_eq!(largest(&[true; 4], 2, 2), None);
    }
}
