//! From a drawing to rooms that meet at their walls.
//!
//! Rooms drawn with a gap between them are drawn on wall faces: the gap is the wall, its middle the line that both rooms
//! end at. Rooms that share edges are drawn on center lines and get walls of the usual thickness. Both may occur in one
//! plan; each stretch of wall knows how far its two faces are from its line.

use d3dgen_model::scene_graph::Note;
use d3dgen_model::{Point, Polygon};

use crate::attach::attach;
use crate::cells::{Cells, Stretch, outline};
use crate::drawing::{Drawing, DrawnRoom, OpeningKind, note};
use crate::snap::{Axis, Corner};
use crate::{Error, Options, clean, faces, snap, upright, words};

/// Coordinates closer than this are one wall face, m.
const SNAP_M: f64 = 0.015;
/// Widest gap between two rooms that is taken for a wall, mm.
const WIDEST_WALL: i64 = 600;
/// Rooms may overlap by this much on account of rounding, mm.
const GRAZE: i64 = 30;
/// Thickness of walls drawn as lines, m.
const INNER_WALL_M: f64 = 0.12;
const OUTER_WALL_M: f64 = 0.24;
/// A plan this far from the origin is moved to it, m.
const FAR_M: f64 = 10_000.0;
/// Largest side of a plan, m, and most rooms.
const LARGEST_M: f64 = 2000.0;
const MOST_ROOMS: usize = 1000;

/// Rooms, walls and openings, in place; not typed yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Rooms in the order of the drawing.
    pub rooms: Vec<LaidRoom>,
    /// Openings in walls.
    pub openings: Vec<LaidOpening>,
    /// What was assumed and changed.
    pub notes: Vec<Note>,
    pub(crate) stretches: Vec<Stretch>,
}

/// A room with its outlines.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidRoom {
    /// Name on the plan; empty when it has none.
    pub label: String,
    /// What the file says it is, beside the name.
    pub kind: Option<String>,
    /// Outline on wall center lines.
    pub polygon: Polygon,
    /// Outline on wall faces.
    pub net_polygon: Polygon,
    /// Clear height, m, where the file states it.
    pub height_m: Option<f64>,
}

/// An opening in its stretch of wall.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidOpening {
    /// What it is.
    pub kind: OpeningKind,
    /// Rooms it joins: two, or one for an outer wall.
    pub rooms: Vec<usize>,
    pub(crate) stretch: usize,
    /// Along the stretch, mm.
    pub(crate) from: i64,
    pub(crate) to: i64,
    pub(crate) sill_m: Option<f64>,
    pub(crate) head_m: Option<f64>,
    pub(crate) sliding: bool,
    /// Room the leaf is drawn in (`Some(None)`: outdoors) and whether it hinges at the start.
    pub(crate) swing: Option<(Option<usize>, bool)>,
}

/// Lays out a drawing.
///
/// # Errors
/// `Refused` for what is no building: no rooms, rooms on top of each other, outlines that cross themselves, slanted walls
/// (unless `rectify`), rooms that walls leave no floor of; always with the room and the place.
pub fn lay_out(mut drawing: Drawing, options: &Options) -> Result<Layout, Error> {
    drawing.check_numbers()?;
    drawing.keep_level(options.level.as_deref())?;
    if let Some(thickness) =
        [options.inner_wall_m, options.outer_wall_m].into_iter().flatten().find(|t| !(0.02..=1.0).contains(t))
    {
        return Err(Error::refused("wall thickness", format!("{thickness} m is outside 0.02-1 m")));
    }
    upright::turn(&mut drawing);
    move_near(&mut drawing)?;
    let (drawn, rings) = rings(&mut drawing, options)?;
    let cells = fill(&drawn, &rings)?;
    let (stretches, notes) = walls(cells, options)?;
    drawing.notes.extend(notes);
    let mut by_room: Vec<Vec<Stretch>> = vec![Vec::new(); drawn.len()];
    for s in &stretches {
        s.rooms().for_each(|r| by_room[r].push(*s));
    }
    let mut rooms = Vec::with_capacity(drawn.len());
    for (i, room) in drawn.iter().enumerate() {
        let ring = outline(i, &by_room[i]).ok_or_else(|| {
            Error::refused(
                &room.place,
                "is not one simple outline: it surrounds another room or a court, or touches itself at a corner; draw it \
                 as two rooms",
            )
        })?;
        rooms.push(LaidRoom {
            label: room.label.trim().to_owned(),
            kind: room.kind.clone(),
            net_polygon: polygon(&net(i, &ring, &by_room[i], &room.place)?),
            polygon: polygon(&ring),
            height_m: room.height_m.filter(|h| h.is_finite() && (1.5..=50.0).contains(h)),
        });
    }
    let openings = attach(&drawing.openings, &stretches, &rooms, &mut drawing.notes);
    Ok(Layout { rooms, openings, notes: drawing.notes, stretches })
}

pub(crate) fn polygon(ring: &[Corner]) -> Polygon {
    Polygon(ring.iter().map(|&c| point(c)).collect())
}

pub(crate) fn point(c: Corner) -> Point {
    Point::new(c.0 as f64 / 1000.0, c.1 as f64 / 1000.0)
}

/// Refuses what is too large for a building and moves what is drawn far away to the origin.
fn move_near(drawing: &mut Drawing) -> Result<(), Error> {
    let corners: Vec<Point> = drawing.rooms.iter().flat_map(|r| r.corners.iter().copied()).collect();
    let lines = drawing.walls.iter().flat_map(|w| w.line);
    let all: Vec<Point> = if corners.is_empty() { lines.collect() } else { corners };
    if all.is_empty() {
        return Err(Error::refused("plan", "holds no rooms: no closed outlines and no walls that could enclose any"));
    }
    let around = Polygon(all).bounds();
    if around.width().max(around.height()) > LARGEST_M {
        let message = format!(
            "is {:.0} m by {:.0} m, a building has {LARGEST_M} m at most; is the unit right? say it with --meters-per-unit",
            around.width(),
            around.height()
        );
        return Err(Error::refused("plan", message));
    }
    if around.width().min(around.height()) < 0.5 {
        let message = format!(
            "is only {:.3} m by {:.3} m; is the unit right? say it with --meters-per-unit",
            around.width(),
            around.height()
        );
        return Err(Error::refused("plan", message));
    }
    if around.x0.abs().max(around.y0.abs()) > FAR_M {
        for p in drawing.points_mut() {
            *p = Point::new(p.x - around.x0, p.y - around.y0);
        }
        let message = format!("the plan was moved by ({:.3}, {:.3}) m, to the origin", -around.x0, -around.y0);
        drawing.notes.push(note("moved", message));
    }
    Ok(())
}

/// Returns the rooms with their outlines on the lattice; labels that lie in a room without a name are its name.
fn rings(drawing: &mut Drawing, options: &Options) -> Result<(Vec<DrawnRoom>, Vec<Vec<Corner>>), Error> {
    let mut stray = 0.0_f64;
    let mut upright_rooms: Vec<(DrawnRoom, Vec<Point>)> = Vec::new();
    for room in std::mem::take(&mut drawing.rooms) {
        let ring = clean::ring(&room.corners, &room.place)?;
        let (ring, off) = clean::upright_ring(&ring, options.rectify, &room.place)?;
        stray = stray.max(off);
        upright_rooms.push((room, ring));
    }
    let mut lines: Vec<[Point; 2]> = Vec::new();
    if upright_rooms.is_empty() {
        for wall in &drawing.walls {
            let [a, b] = wall.line;
            if a.distance(b) < 0.01 {
                continue;
            }
            let (mut points, off) = clean::upright_line(a, b, options.rectify, &wall.place)?;
            stray = stray.max(off);
            points.push(b);
            lines.extend(points.windows(2).map(|p| [p[0], p[1]]));
        }
    }
    if stray > 0.0 {
        let message = format!("slanted walls were made of steps; the largest deviation is {stray:.3} m");
        drawing.notes.push(note("rectified", message));
    }
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    snap::collect(upright_rooms.iter().flat_map(|(_, ring)| upright::edges(ring)), &mut xs, &mut ys);
    snap::collect(lines.iter().map(|l| (l[0], l[1])), &mut xs, &mut ys);
    let (xs, ys) = (Axis::new(xs, SNAP_M), Axis::new(ys, SNAP_M));
    let mut rooms: Vec<(DrawnRoom, Vec<Corner>)> =
        upright_rooms.into_iter().map(|(room, ring)| (room, snap::ring(&ring, &xs, &ys))).collect();
    if rooms.is_empty() {
        let too_many = || Error::refused("walls", "are too many for one plan; leave out what is not a wall");
        let found = faces::faces(&lines, &drawing.openings, &xs, &ys).ok_or_else(too_many)?;
        if found.is_empty() {
            return Err(Error::refused(
                "walls",
                "enclose no room; every room needs a closed run of walls, with doors drawn in the gaps",
            ));
        }
        for (i, ring) in found.into_iter().enumerate() {
            let place = format!("space {} at ({:.2}, {:.2}) m", i + 1, point(ring[0]).x, point(ring[0]).y);
            let (label, kind, level, height_m) = (String::new(), None, None, None);
            rooms.push((DrawnRoom { label, kind, corners: Vec::new(), level, height_m, place }, ring));
        }
    }
    drop_outlines(&mut rooms, &mut drawing.notes);
    if rooms.len() > MOST_ROOMS {
        return Err(Error::refused("plan", format!("has {} rooms, at most {MOST_ROOMS} are read", rooms.len())));
    }
    for (room, ring) in rooms.iter_mut().filter(|(room, _)| room.label.trim().is_empty()) {
        let outline = polygon(ring);
        let inside = drawing.labels.iter().filter(|l| outline.contains(l.at) && words::is_name(&l.text));
        if let Some(label) = inside.map(|l| l.text.trim()).next() {
            room.label = label.to_owned();
            room.place = format!("room `{label}`");
        }
    }
    Ok(rooms.into_iter().unzip())
}

/// Drops outlines of the whole building: those that hold two rooms or more.
fn drop_outlines(rooms: &mut Vec<(DrawnRoom, Vec<Corner>)>, notes: &mut Vec<Note>) {
    let outlines: Vec<Polygon> = rooms.iter().map(|(_, ring)| polygon(ring)).collect();
    let bounds: Vec<_> = outlines.iter().map(Polygon::bounds).collect();
    let holds = |i: usize, j: usize| {
        let (a, b) = (bounds[i], bounds[j]);
        let within = a.x0 <= b.x0 + 0.05 && a.y0 <= b.y0 + 0.05 && a.x1 >= b.x1 - 0.05 && a.y1 >= b.y1 - 0.05;
        within && outlines[i].area() > outlines[j].area() + 0.5 && {
            let inner = outlines[j].rects();
            !inner.is_empty() && inner.iter().all(|r| outlines[i].contains(r.center()))
        }
    };
    let two = |i: usize| (0..rooms.len()).filter(|&j| j != i && holds(i, j)).take(2).count() == 2;
    let drop: Vec<bool> = (0..rooms.len()).map(two).collect();
    for (_, (room, _)) in rooms.iter().enumerate().filter(|(i, _)| drop[*i]) {
        let message = format!("{} holds other rooms and was taken for the outline of the building", room.place);
        notes.push(note("building_outline", message));
    }
    let mut at = 0;
    rooms.retain(|_| {
        at += 1;
        !drop[at - 1]
    });
}

/// Returns the grid with the floor that each room is drawn on.
fn fill(drawn: &[DrawnRoom], rings: &[Vec<Corner>]) -> Result<Cells, Error> {
    let xs = rings.iter().flatten().map(|c| c.0).collect();
    let ys = rings.iter().flatten().map(|c| c.1).collect();
    let mut cells = Cells::new(xs, ys)
        .ok_or_else(|| Error::refused("plan", "has too many different wall lines; draw rooms with fewer corners"))?;
    for (room, ring) in rings.iter().enumerate() {
        for (j, from, to) in cells.inside(ring) {
            for i in from..to {
                let (width, height) = (cells.xs[i + 1] - cells.xs[i], cells.ys[j + 1] - cells.ys[j]);
                match cells.at(i, j).map(|o| o as usize) {
                    Some(other) if width > GRAZE && height > GRAZE => {
                        let message = format!(
                            "lies on top of {} around ({:.3}, {:.3}) m; two rooms share no floor",
                            drawn[other].place,
                            (cells.xs[i] + width / 2) as f64 / 1000.0,
                            (cells.ys[j] + height / 2) as f64 / 1000.0
                        );
                        return Err(Error::refused(&drawn[room].place, message));
                    }
                    Some(_) => {}
                    None => cells.set(i, j, Some(room as u32)),
                }
            }
        }
    }
    Ok(cells)
}

/// Closes the gaps between rooms and returns all stretches of wall with their faces.
fn walls(drawn: Cells, options: &Options) -> Result<(Vec<Stretch>, Vec<Note>), Error> {
    let too_many = || Error::refused("plan", "has too many different wall lines; draw rooms with fewer corners");
    let mut notes = Vec::new();
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
        let usual = if low.is_some() && high.is_some() { inner / 2 } else { outer / 2 };
        let known = |found: Option<i64>| found.filter(|d| *d > 0 && *d <= WIDEST_WALL);
        match (known(down), known(up)) {
            (None, None) => [usual, usual],
            (Some(d), None) => [d, if high.is_some() { 0 } else { d }],
            (None, Some(u)) => [if low.is_some() { 0 } else { u }, u],
            (Some(d), Some(u)) => [d, u],
        }
    };
    Ok((cells.stretches(halves), notes))
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
fn net(room: usize, ring: &[Corner], stretches: &[Stretch], place: &str) -> Result<Vec<Corner>, Error> {
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
    let complex = || Error::refused(place, "has too many corners");
    let mut cells = Cells::new(xs, ys).ok_or_else(complex)?;
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
        let b = polygon(ring).bounds();
        let message = format!("is {:.2} m by {:.2} m, of which its walls leave no floor", b.width(), b.height());
        return Err(Error::refused(place, message));
    }
    cells.outline(0).ok_or_else(|| {
        Error::refused(
            place,
            "is cut in parts by its walls: somewhere it is narrower than they are thick; draw two rooms",
        )
    })
}
