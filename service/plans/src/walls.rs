//! From the floor of rooms to walls: gaps between rooms close, and every room becomes one simple outline or several.

use d3dgen_model::scene_graph::Note;

use crate::cells::{Cells, Stretch, outline};
use crate::drawing::{DrawnRoom, note};
use crate::error::Error;
use crate::options::{INNER_WALL_M, OUTER_WALL_M, Options};
use crate::pieces;
use crate::shape::Corner;
use crate::shape::polygon;

/// Widest gap between two rooms that is taken for a wall, mm.
const WIDEST_WALL: i64 = 600;
/// Times that rooms are cut in pieces before the rest is given up.
const ROUNDS: usize = 6;
/// Share of a room's floor that is the room where its walls cut off the rest.
const MOST_OF_ROOM: f64 = 0.85;
/// Gaps and overlaps up to this are rounding, mm.
const GRAZE: i64 = 30;

/// The floor of the rooms on wall center lines, and as drawn, on the same grid.
pub(crate) struct Walls {
    cells: Cells,
    floor: Cells,
    /// Usual thickness of inner and outer walls, mm.
    inner: i64,
    outer: i64,
    /// True when the plan draws no faces of walls.
    assumed: bool,
}

/// Outlines of rooms that are each one simple outline.
pub(crate) struct Outlines {
    /// Which drawn room it is, its outline on center lines, its outline on wall faces.
    pub rooms: Vec<(usize, Vec<Corner>, Vec<Corner>)>,
    /// The drawn room that each drawn room or piece was part of at first.
    pub origin: Vec<usize>,
    /// The same by the rooms that are left.
    pub family: Vec<usize>,
    pub stretches: Vec<Stretch>,
}

/// Cuts rooms in pieces until each is one simple outline with floor between its walls; leaves out what cannot be.
///
/// # Errors
/// `Refused` for a drawn room that its walls leave no floor of.
pub(crate) fn outlines(
    drawn: &mut Vec<DrawnRoom>,
    walls: &mut Walls,
    notes: &mut Vec<Note>,
) -> Result<Outlines, Error> {
    let mut origin: Vec<usize> = (0..drawn.len()).collect();
    for round in 0..=ROUNDS {
        let stretches = walls.stretches();
        let mut by_room: Vec<Vec<Stretch>> = vec![Vec::new(); drawn.len()];
        for s in &stretches {
            s.rooms().for_each(|r| by_room[r].push(*s));
        }
        let mut rooms = Vec::with_capacity(drawn.len());
        let mut changed = false;
        for i in 0..drawn.len() {
            if by_room[i].is_empty() {
                continue;
            }
            let found =
                outline(i, &by_room[i]).ok_or(Fault::NoRing).and_then(|r| net(i, &r, &by_room[i]).map(|n| (r, n)));
            let fault = match found {
                Ok((ring, net)) => {
                    rooms.push((i, ring, net));
                    continue;
                }
                Err(fault) => fault,
            };
            changed = true;
            let last = round == ROUNDS;
            match fault {
                Fault::NoRing if !last => walls.cut(i, drawn, &mut origin, notes),
                Fault::Parts if !last && walls.close_necks(i) => walls.cut(i, drawn, &mut origin, notes),
                _ if drawn[i].traced || origin[i] != i => {
                    let message = format!("{} has no floor between its walls and was left out", drawn[i].place);
                    notes.push(note("room_left_out", message));
                    walls.take(i);
                }
                fault => return Err(fault.of(&drawn[i].place, &by_room[i])),
            }
        }
        if !changed {
            return finished(rooms, origin, stretches);
        }
    }
    Err(Error::refused("plan", "holds rooms whose outlines cannot be made simple; draw them as several rooms"))
}

/// Numbers the rooms that are left.
fn finished(
    rooms: Vec<(usize, Vec<Corner>, Vec<Corner>)>,
    origin: Vec<usize>,
    mut stretches: Vec<Stretch>,
) -> Result<Outlines, Error> {
    if rooms.is_empty() {
        return Err(Error::refused("plan", "holds no room that walls leave floor of"));
    }
    let mut number: Vec<Option<usize>> = vec![None; origin.len()];
    rooms.iter().enumerate().for_each(|(k, r)| number[r.0] = Some(k));
    for s in &mut stretches {
        (s.low, s.high) = (s.low.and_then(|r| number[r]), s.high.and_then(|r| number[r]));
    }
    let family = rooms.iter().map(|r| origin[r.0]).collect();
    Ok(Outlines { rooms, origin, family, stretches })
}

/// Why a room is no simple outline.
enum Fault {
    NoRing,
    NoFloor,
    Parts,
    Corners,
}

impl Fault {
    fn of(self, place: &str, stretches: &[Stretch]) -> Error {
        let message = match self {
            Self::NoRing => {
                "is not one simple outline: it surrounds another room or a court, or touches itself at a corner; draw it as \
                 two rooms"
                    .to_owned()
            }
            Self::NoFloor => {
                let ends = stretches.iter().flat_map(|s| [s.point(s.from), s.point(s.to)]).collect::<Vec<_>>();
                let b = polygon(&ends).bounds();
                format!("is {:.2} m by {:.2} m, of which its walls leave no floor", b.width(), b.height())
            }
            Self::Parts => "is cut in parts by its walls: somewhere it is narrower than they are thick; draw two rooms".to_owned(),
            Self::Corners => "has too many corners".to_owned(),
        };
        Error::refused(place, message)
    }
}

impl Walls {
    /// Returns true when the plan draws walls as lines: how thick they are is not said by it.
    pub(crate) fn are_assumed(&self) -> bool {
        self.assumed
    }

    /// Takes a room out of the plan.
    fn take(&mut self, room: usize) {
        for owner in self.cells.owner.iter_mut().chain(&mut self.floor.owner) {
            *owner = owner.filter(|o| *o as usize != room);
        }
    }

    /// Makes the places where a room is narrower than its walls part of the walls; returns whether there were any.
    fn close_necks(&mut self, room: usize) -> bool {
        let necks = pieces::necks(&self.cells, room as u32, self.inner.max(self.outer));
        for &(i, j) in &necks {
            self.cells.set(i, j, None);
            self.floor.set(i, j, None);
        }
        !necks.is_empty()
    }

    /// Parts a room in pieces with simple outlines; the first piece keeps its number.
    fn cut(&mut self, room: usize, drawn: &mut Vec<DrawnRoom>, origin: &mut Vec<usize>, notes: &mut Vec<Note>) {
        let parts = pieces::pieces(&self.cells, room as u32);
        let mut owner = vec![None; self.cells.owner.len()];
        let columns = self.cells.columns();
        let count = parts.len();
        for (k, part) in parts.into_iter().enumerate() {
            let number = if k == 0 { room } else { drawn.len() };
            if k > 0 {
                let mut piece = drawn[room].clone();
                if !piece.label.trim().is_empty() {
                    piece.label = format!("{} {}", piece.label.trim(), k + 1);
                }
                drawn.push(piece);
                origin.push(origin[room]);
            }
            part.into_iter().for_each(|(i, j)| owner[j * columns + i] = Some(number as u32));
        }
        for (k, piece) in owner.into_iter().enumerate() {
            for cells in [&mut self.cells, &mut self.floor] {
                if cells.owner[k] == Some(room as u32) {
                    cells.owner[k] = piece;
                }
            }
        }
        if count > 1 {
            let message = format!(
                "{} is no simple outline (it surrounds something, or is cut in parts); it became {count} rooms, open to one \
                 another where they meet",
                drawn[room].place
            );
            notes.push(note("room_in_pieces", message));
        }
    }

    /// Returns all stretches of wall with their faces.
    fn stretches(&self) -> Vec<Stretch> {
        let (cells, floor) = (&self.cells, &self.floor);
        let halves = |vertical: bool, i: usize, j: usize| {
            let at = |k: usize| if vertical { floor.at(k, j) } else { floor.at(j, k) };
            let whose = |k: usize| if vertical { cells.at(k, j) } else { cells.at(j, k) };
            let lines = if vertical { &floor.xs } else { &floor.ys };
            let (low, high) = (whose(i.wrapping_sub(1)), whose(i));
            let down = low.and_then(|room| {
                (0..i).rev().find(|&k| at(k) == Some(room) || whose(k) != Some(room)).map(|k| lines[i] - lines[k + 1])
            });
            let up = high.and_then(|room| {
                (i..lines.len().saturating_sub(1))
                    .find(|&k| at(k) == Some(room) || whose(k) != Some(room))
                    .map(|k| lines[k] - lines[i])
            });
            let usual = if low.is_some() && high.is_some() { self.inner / 2 } else { self.outer / 2 };
            let known = |found: Option<i64>| found.filter(|d| *d > 0 && *d <= WIDEST_WALL);
            match (known(down), known(up)) {
                (None, None) => [usual, usual],
                (Some(d), None) => [d, if high.is_some() { 0 } else { d }],
                (None, Some(u)) => [if low.is_some() { 0 } else { u }, u],
                (Some(d), Some(u)) => [d, u],
            }
        };
        cells.stretches(halves)
    }
}

/// Closes the gaps between rooms: what is left of them are the walls.
pub(crate) fn walls(drawn: Cells, options: &Options, notes: &mut Vec<Note>) -> Result<Walls, Error> {
    let too_many = || Error::refused("plan", "has too many different wall lines; draw rooms with fewer corners");
    let mut cells = drawn.clone();
    let mut gaps: Vec<i64> = Vec::new();
    for pass in 0..4 {
        let sideways = pass % 2 == 1;
        let turned = if sideways { cells.transposed() } else { cells };
        let closed = close(&turned, &mut gaps).ok_or_else(too_many)?;
        cells = if sideways { closed.transposed() } else { closed };
    }
    gaps.sort_unstable();
    let usual = |given: Option<f64>, or: f64| (given.unwrap_or(or) * 1000.0).round() as i64;
    let inner = usual(options.inner_wall_m, INNER_WALL_M);
    let outer = usual(options.outer_wall_m, OUTER_WALL_M);
    if let Some(&median) = gaps.get(gaps.len() / 2) {
        let outer = options.outer_wall_m.map_or(median, |_| outer);
        let grown = grow(&cells, outer / 2).ok_or_else(too_many)?;
        cells = grow(&grown.transposed(), outer / 2).ok_or_else(too_many)?.transposed();
        notes.push(note(
            "wall_faces",
            format!(
                "rooms are drawn on wall faces; the gaps between them became walls, and outer walls are {:.3} m thick",
                outer as f64 / 1000.0
            ),
        ));
    } else {
        notes.push(note(
            "center_lines",
            format!(
                "rooms share their edges, which were taken for the middle of walls {:.2} m (outer ones {:.2} m) thick",
                inner as f64 / 1000.0,
                outer as f64 / 1000.0
            ),
        ));
    }
    // the drawn floor on the same lines tells how far the faces are
    let floor = drawn.refined(&cells.xs, &cells.ys).ok_or_else(too_many)?;
    let cells = cells.refined(&floor.xs, &floor.ys).ok_or_else(too_many)?;
    Ok(Walls { cells, floor, inner, outer, assumed: gaps.is_empty() })
}

/// Closes gaps between cells of different owners in the rows of a grid, each at its middle.
fn close(cells: &Cells, gaps: &mut Vec<i64>) -> Option<Cells> {
    let runs = |cells: &Cells, j: usize| {
        let mut found: Vec<(usize, usize, u32, u32)> = Vec::new();
        let mut last: Option<(usize, u32)> = None;
        for i in 0..cells.columns() {
            let Some(owner) = cells.at(i, j) else { continue };
            if let Some((k, before)) = last
                && k + 1 < i
                && before != owner
                && cells.xs[i] - cells.xs[k + 1] <= WIDEST_WALL
            {
                found.push((k + 1, i, before, owner));
            }
            last = Some((i, owner));
        }
        found
    };
    let middle = |cells: &Cells, from: usize, to: usize| (cells.xs[from] + cells.xs[to]).div_euclid(2);
    let mut middles: Vec<i64> = Vec::new();
    for j in 0..cells.rows() {
        middles.extend(runs(cells, j).into_iter().map(|(from, to, ..)| middle(cells, from, to)));
    }
    middles.sort_unstable();
    middles.dedup();
    let mut out = cells.refined(&middles, &[])?;
    for j in 0..out.rows() {
        for (from, to, before, after) in runs(&out, j) {
            let at = middle(&out, from, to);
            let gap = out.xs[to] - out.xs[from];
            if gap > GRAZE {
                gaps.push(gap);
            }
            for i in from..to {
                let owner = if out.xs[i] < at { before } else { after };
                out.set(i, j, Some(owner));
            }
        }
    }
    Some(out)
}

/// Lets every owner grow into outdoors along its rows.
fn grow(cells: &Cells, by: i64) -> Option<Cells> {
    let mut lines = Vec::new();
    for j in 0..cells.rows() {
        for i in 0..=cells.columns() {
            match (cells.at(i.wrapping_sub(1), j), cells.at(i, j)) {
                (Some(_), None) => lines.push(cells.xs[i] + by),
                (None, Some(_)) => lines.push(cells.xs[i] - by),
                _ => {}
            }
        }
    }
    lines.sort_unstable();
    lines.dedup();
    let mut out = cells.refined(&lines, &[])?;
    let before = out.clone();
    for j in 0..out.rows() {
        for i in 0..=out.columns() {
            match (before.at(i.wrapping_sub(1), j), before.at(i, j)) {
                (Some(owner), None) => {
                    let end = before.xs[i] + by;
                    (i..out.columns())
                        .take_while(|&k| before.at(k, j).is_none() && before.xs[k] < end)
                        .for_each(|k| out.set(k, j, Some(owner)));
                }
                (None, Some(owner)) => {
                    let end = before.xs[i] - by;
                    (0..i)
                        .rev()
                        .take_while(|&k| before.at(k, j).is_none() && before.xs[k + 1] > end)
                        .for_each(|k| out.set(k, j, Some(owner)));
                }
                _ => {}
            }
        }
    }
    Some(out)
}

/// Returns the outline on wall faces: the room without the halves of its walls.
fn net(room: usize, ring: &[Corner], stretches: &[Stretch]) -> Result<Vec<Corner>, Fault> {
    let mut taken: Vec<(Corner, Corner)> = Vec::new();
    for s in stretches {
        let half = s.half_of(room);
        let (low, high) = if s.low == Some(room) { (s.at - half, s.at) } else { (s.at, s.at + half) };
        taken.push(if s.vertical { ((low, s.from), (high, s.to)) } else { ((s.from, low), (s.to, high)) });
    }
    // the inner corners of an L stand between two such strips
    let n = ring.len();
    for i in 0..n {
        let (a, b, c) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
        let (u, v) = ((b.0 - a.0, b.1 - a.1), (c.0 - b.0, c.1 - b.1));
        if u.0 * v.1 - u.1 * v.0 >= 0 {
            continue;
        }
        let half = |vertical: bool| {
            let touches = |s: &&Stretch| s.vertical == vertical && (s.point(s.from) == b || s.point(s.to) == b);
            stretches.iter().find(touches).map_or(0, |s| s.half_of(room))
        };
        // the room lies to the left of both edges
        let left = |d: Corner, half: i64| (-d.1.signum() * half, d.0.signum() * half);
        let (p, q) = (left(u, half(u.0 == 0)), left(v, half(v.0 == 0)));
        let far = (b.0 + p.0 + q.0, b.1 + p.1 + q.1);
        taken.push(((b.0.min(far.0), b.1.min(far.1)), (b.0.max(far.0), b.1.max(far.1))));
    }
    let xs = ring.iter().map(|c| c.0).chain(taken.iter().flat_map(|t| [t.0.0, t.1.0])).collect();
    let ys = ring.iter().map(|c| c.1).chain(taken.iter().flat_map(|t| [t.0.1, t.1.1])).collect();
    let mut cells = Cells::new(xs, ys).ok_or(Fault::Corners)?;
    for (j, from, to) in cells.inside(ring) {
        (from..to).for_each(|i| cells.set(i, j, Some(0)));
    }
    for (low, high) in taken {
        let index = |list: &[i64], v: i64| list.partition_point(|o| *o < v);
        for j in index(&cells.ys, low.1)..index(&cells.ys, high.1) {
            for i in index(&cells.xs, low.0)..index(&cells.xs, high.0) {
                cells.set(i, j, None);
            }
        }
    }
    if cells.owner.iter().all(Option::is_none) {
        return Err(Fault::NoFloor);
    }
    if let Some(ring) = cells.outline(0) {
        return Ok(ring);
    }
    // slivers between steps of a wall are lost, as long as one part is most of the room
    let size = |list: &mut dyn Iterator<Item = (usize, usize)>| -> i64 {
        list.map(|(i, j)| (cells.xs[i + 1] - cells.xs[i]) * (cells.ys[j + 1] - cells.ys[j])).sum()
    };
    let columns = cells.columns();
    let taken = (0..cells.owner.len()).filter(|k| cells.owner[*k].is_some());
    let total = size(&mut taken.map(|k| (k % columns, k / columns)));
    let part = pieces::pieces(&cells, 0).into_iter().next().ok_or(Fault::Parts)?;
    if (size(&mut part.iter().copied()) as f64) < MOST_OF_ROOM * total as f64 {
        return Err(Fault::Parts);
    }
    for (k, owner) in cells.owner.iter_mut().enumerate() {
        *owner = owner.filter(|_| part.contains(&(k % columns, k / columns)));
    }
    cells.outline(0).ok_or(Fault::Parts)
}
