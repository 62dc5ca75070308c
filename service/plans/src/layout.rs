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
use crate::faces::FloorRing;
use crate::snap::{Axis, Corner};
use crate::straighten::{Chain, straighten};
use crate::{Error, Options, clean, faces, leaves, pieces, snap, upright, words};

/// Coordinates closer than this are one wall face, m.
const SNAP_M: f64 = 0.015;
/// Widest gap between two rooms that is taken for a wall, mm.
const WIDEST_WALL: i64 = 600;
/// Rooms may overlap by this much on account of rounding, mm.
const GRAZE: i64 = 30;
/// Ends of walls drawn as lines are one within this distance, m; corners of outlines within the next.
const WELD_WALL_M: f64 = 0.08;
const WELD_OUTLINE_M: f64 = 0.03;
/// A closed shape without a name is a wall when it is this thin, m, and so many times as long.
const STRIP_M: f64 = 0.4;
const STRIP_LONG: f64 = 2.5;
/// Smallest hole in an outline that is kept free, m^2; smaller ones are columns.
const COLUMN_M2: f64 = 0.5;
/// Times that rooms are cut in pieces before the rest is given up.
const ROUNDS: usize = 6;
/// Wall left at the ends of the open side between two pieces of one room, mm, and the shortest such side.
const PIECE_JAMB: i64 = 120;
const PIECE_SIDE: i64 = 600;
/// Rooms that a hub joins at least, and how many times as long as wide it is when it joins no more.
const HUB_ROOMS: usize = 3;
const HUB_LONG: f64 = 2.2;
/// Most other words that a room keeps.
const MOST_WORDS: usize = 12;
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
    /// What the file calls the building.
    pub titles: Vec<String>,
    pub(crate) stretches: Vec<Stretch>,
}

/// A room with its outlines.
#[derive(Debug, Clone, PartialEq)]
pub struct LaidRoom {
    /// Name on the plan; empty when it has none.
    pub label: String,
    /// What the file says it is, beside the name.
    pub kind: Option<String>,
    /// Other words that stand in it.
    pub also: Vec<String>,
    /// True when it has no name, and joins so many rooms that it is circulation.
    pub hub: bool,
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
    leaves::pair(&mut drawing.openings);
    strips(&mut drawing);
    let (mut drawn, cells) = rooms_and_floor(&mut drawing, options)?;
    let words = name(&mut drawn, &cells, &drawing);
    let mut walls = walls(cells, options, &mut drawing.notes)?;
    let outlines = outlines(&mut drawn, &mut walls, &mut drawing.notes)?;
    let mut rooms: Vec<LaidRoom> = Vec::with_capacity(outlines.rooms.len());
    for (room, ring, net) in outlines.rooms {
        rooms.push(LaidRoom {
            label: drawn[room].label.trim().to_owned(),
            kind: drawn[room].kind.clone(),
            also: words.get(outlines.origin[room]).cloned().unwrap_or_default(),
            hub: false,
            net_polygon: polygon(&net),
            polygon: polygon(&ring),
            height_m: drawn[room].height_m.filter(|h| h.is_finite() && (1.5..=50.0).contains(h)),
        });
    }
    let stretches = outlines.stretches;
    let mut openings = attach(&drawing.openings, &stretches, &rooms, &mut drawing.notes);
    openings.extend(open_sides(&stretches, &outlines.family, &openings));
    mark_hubs(&mut rooms, &openings);
    // rooms that were found get a name by which the user can say what they are
    for (i, (room, family)) in rooms.iter_mut().zip(&outlines.family).enumerate() {
        if room.label.is_empty() && drawn[*family].traced {
            room.label = format!("room_{}", i + 1);
        }
    }
    Ok(Layout { rooms, openings, notes: drawing.notes, titles: drawing.titles, stretches })
}

/// Marks rooms without a name that join many others: long ones, or those that join more.
fn mark_hubs(rooms: &mut [LaidRoom], openings: &[LaidOpening]) {
    for room in 0..rooms.len() {
        if !rooms[room].label.is_empty() || rooms[room].kind.is_some() {
            continue;
        }
        let walkable = openings.iter().filter(|o| o.kind != OpeningKind::Window && o.rooms.contains(&room));
        let mut joined: Vec<usize> = walkable.flat_map(|o| o.rooms.iter().copied()).filter(|r| *r != room).collect();
        joined.sort_unstable();
        joined.dedup();
        let bounds = rooms[room].net_polygon.bounds();
        let (long, short) = (bounds.width().max(bounds.height()), bounds.width().min(bounds.height()));
        // an angled corridor fills little of the box around it
        let bent = rooms[room].net_polygon.area() < 0.5 * bounds.width() * bounds.height();
        let slender = long >= HUB_LONG * short || bent;
        rooms[room].hub = joined.len() > HUB_ROOMS || joined.len() == HUB_ROOMS && slender;
    }
    // where one comes in through another room, that one is circulation too
    let leads_out = |room: usize| openings.iter().any(|o| o.kind != OpeningKind::Window && o.rooms == [room]);
    let hubs: Vec<bool> = rooms.iter().map(|r| r.hub).collect();
    if (0..rooms.len()).any(|r| hubs[r] && leads_out(r)) {
        return;
    }
    for room in 0..rooms.len() {
        let unnamed = rooms[room].label.is_empty() && rooms[room].kind.is_none();
        let at_hub = openings.iter().any(|o| {
            o.kind != OpeningKind::Window && o.rooms.contains(&room) && o.rooms.iter().any(|r| *r != room && hubs[*r])
        });
        rooms[room].hub |= unnamed && at_hub && leads_out(room);
    }
}

/// Returns passages on the sides that the pieces of one room share.
fn open_sides(stretches: &[Stretch], family: &[usize], openings: &[LaidOpening]) -> Vec<LaidOpening> {
    let mut out = Vec::new();
    for (k, s) in stretches.iter().enumerate() {
        let (Some(a), Some(b)) = (s.low, s.high) else { continue };
        let (from, to) = (s.from + PIECE_JAMB, s.to - PIECE_JAMB);
        let taken = openings.iter().any(|o| o.stretch == k && o.from < to && from < o.to);
        if family[a] == family[b] && to - from >= PIECE_SIDE && !taken {
            out.push(LaidOpening {
                kind: OpeningKind::Passage,
                rooms: vec![a, b],
                stretch: k,
                from,
                to,
                sill_m: None,
                head_m: None,
                sliding: false,
                swing: None,
            });
        }
    }
    out
}

/// Takes closed shapes that are as thin as walls, and have no name, for walls.
fn strips(drawing: &mut Drawing) {
    let is_strip = |r: &DrawnRoom| {
        let b = Polygon(r.corners.clone()).bounds();
        let (long, short) = (b.width().max(b.height()), b.width().min(b.height()));
        r.label.trim().is_empty() && r.kind.is_none() && short <= STRIP_M && long >= STRIP_LONG * short.max(0.02)
    };
    let (strips, rooms): (Vec<DrawnRoom>, Vec<DrawnRoom>) =
        std::mem::take(&mut drawing.rooms).into_iter().partition(|r| !r.traced && is_strip(r));
    drawing.rooms = rooms;
    if strips.is_empty() {
        return;
    }
    let message = format!("{} closed shapes are as thin as walls and were taken for walls", strips.len());
    drawing.notes.push(note("thin_shapes", message));
    for strip in strips {
        drawing.walls.extend(upright::edges(&strip.corners).map(|(a, b)| crate::DrawnWall {
            line: [a, b],
            level: strip.level.clone(),
            place: strip.place.clone(),
        }));
    }
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

/// A room with its outline and its holes on the lattice.
struct Outlined {
    room: DrawnRoom,
    ring: Vec<Corner>,
    holes: Vec<Vec<Corner>>,
}

/// Returns the rooms with the floor that each is drawn on, or that walls enclose where no rooms are drawn.
fn rooms_and_floor(drawing: &mut Drawing, options: &Options) -> Result<(Vec<DrawnRoom>, Cells), Error> {
    if drawing.rooms.is_empty() {
        if let Some(found) = enclosed(drawing)? {
            return Ok(found);
        }
        drawing.rooms = floors_as_rooms(drawing);
        if drawing.rooms.is_empty() {
            return Err(Error::refused(
                "walls",
                "enclose no room; every room needs a closed run of walls, with doors drawn in the gaps",
            ));
        }
    }
    let shift = straighten_rooms(drawing);
    let mut stray = 0.0_f64;
    let mut columns = 0;
    let mut upright_rooms: Vec<(DrawnRoom, Vec<Point>, Vec<Vec<Point>>)> = Vec::new();
    for mut room in std::mem::take(&mut drawing.rooms) {
        let ring = clean::ring(&room.corners, &room.place)?;
        let (ring, off) = clean::upright_ring(&ring, options.rectify || room.traced, &room.place)?;
        stray = stray.max(off);
        let mut holes = Vec::new();
        for hole in std::mem::take(&mut room.holes) {
            if Polygon(hole.clone()).area() < COLUMN_M2 {
                columns += 1;
                continue;
            }
            let place = format!("hole in {}", room.place);
            let (hole, off) = clean::upright_ring(&clean::ring(&hole, &place)?, options.rectify || room.traced, &place)?;
            stray = stray.max(off);
            holes.push(hole);
        }
        upright_rooms.push((room, ring, holes));
    }
    if columns > 0 {
        let message = format!("{columns} holes in rooms are smaller than {COLUMN_M2} m2; they were taken for columns and left out");
        drawing.notes.push(note("columns_left_out", message));
    }
    tell_of_steps(drawing, stray);
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    let rings = || upright_rooms.iter().flat_map(|(_, ring, holes)| std::iter::once(ring).chain(holes));
    snap::collect(rings().flat_map(|ring| upright::edges(ring)), &mut xs, &mut ys);
    let (xs, ys) = (Axis::new(xs, SNAP_M), Axis::new(ys, SNAP_M));
    let lattice = |ring: &Vec<Point>| snap::ring(ring, &xs, &ys);
    let mut rooms: Vec<Outlined> = upright_rooms
        .into_iter()
        .map(|(room, ring, holes)| Outlined { room, ring: lattice(&ring), holes: holes.iter().map(lattice).collect() })
        .collect();
    drop_outlines(&mut rooms, &mut drawing.notes);
    check_count(rooms.len())?;
    let cells = fill(&rooms, GRAZE.max((2000.0 * shift) as i64))?;
    Ok((rooms.into_iter().map(|r| r.room).collect(), cells))
}

fn check_count(rooms: usize) -> Result<(), Error> {
    if rooms > MOST_ROOMS {
        return Err(Error::refused("plan", format!("has {rooms} rooms, at most {MOST_ROOMS} are read")));
    }
    Ok(())
}

fn tell_of_steps(drawing: &mut Drawing, stray: f64) {
    if stray > 0.0 {
        let message = format!("slanted walls were made of steps; the largest deviation is {stray:.3} m");
        drawing.notes.push(note("rectified", message));
    }
}

fn tell_of_straight(notes: &mut Vec<Note>, done: Option<crate::straighten::Done>) -> f64 {
    let Some(done) = done else { return 0.0 };
    let message = format!(
        "walls that lean by up to {:.1} degrees were made upright; the largest shift is {:.3} m",
        done.lean_rad.to_degrees(),
        done.shift_m
    );
    notes.push(note("straightened", message));
    done.shift_m
}

/// Straightens outlines that lean a little; returns the farthest that a corner moved, m.
fn straighten_rooms(drawing: &mut Drawing) -> f64 {
    let closed = |points: &Vec<Point>| Chain { points: points.clone(), closed: true, door: false };
    let rings = |d: &Drawing| d.rooms.iter().flat_map(|r| std::iter::once(&r.corners).chain(&r.holes)).map(closed).collect();
    let mut chains: Vec<Chain> = rings(drawing);
    let done = straighten(&mut chains, WELD_OUTLINE_M);
    if done.is_some() {
        let all = drawing.rooms.iter_mut().flat_map(|r| std::iter::once(&mut r.corners).chain(&mut r.holes));
        all.zip(chains).for_each(|(points, chain)| *points = chain.points);
    }
    tell_of_straight(&mut drawing.notes, done)
}

/// Straightens walls with their doors and floors, which hang together.
fn straighten_walls(drawing: &mut Drawing) {
    let open = |points: Vec<Point>, door: bool| Chain { points, closed: false, door };
    let is_line = |o: &crate::DrawnOpening| o.arc.is_none() && o.points.len() == 2;
    let walls = drawing.walls.iter().map(|w| open(w.line.to_vec(), false));
    let doors = drawing.openings.iter().filter(|o| is_line(o)).map(|o| open(o.points.clone(), o.kind != OpeningKind::Window));
    let floors = drawing.floors.iter().map(|f| Chain { points: f.corners.clone(), closed: true, door: false });
    let mut chains: Vec<Chain> = walls.chain(doors).chain(floors).collect();
    let done = straighten(&mut chains, WELD_WALL_M);
    if done.is_some() {
        let mut chains = chains.into_iter();
        let mut walls = Vec::with_capacity(drawing.walls.len());
        // walls have got further ends where others meet them
        for (wall, chain) in drawing.walls.iter().zip(chains.by_ref()) {
            walls.extend(chain.points.windows(2).map(|p| crate::DrawnWall { line: [p[0], p[1]], ..wall.clone() }));
        }
        drawing.walls = walls;
        for (o, chain) in drawing.openings.iter_mut().filter(|o| is_line(o)).zip(chains.by_ref()) {
            if let (Some(a), Some(b)) = (chain.points.first(), chain.points.last()) {
                o.points = vec![*a, *b];
            }
        }
        drawing.floors.iter_mut().zip(chains).for_each(|(f, chain)| f.corners = chain.points);
    }
    tell_of_straight(&mut drawing.notes, done);
}

/// Returns what walls, doors and floors enclose, or `None` when they enclose nothing.
///
/// Slanted walls are made of steps here, asked or not: no outline of a room was drawn that had to be kept.
fn enclosed(drawing: &mut Drawing) -> Result<Option<(Vec<DrawnRoom>, Cells)>, Error> {
    straighten_walls(drawing);
    let mut lines: Vec<[Point; 2]> = Vec::new();
    let mut stray = 0.0_f64;
    for wall in &drawing.walls {
        let [a, b] = wall.line;
        if a.distance(b) < 0.01 {
            continue;
        }
        let (mut points, off) = clean::upright_line(a, b, true, &wall.place)?;
        stray = stray.max(off);
        points.push(b);
        lines.extend(points.windows(2).map(|p| [p[0], p[1]]));
    }
    let mut floors: Vec<(Vec<Point>, bool)> = Vec::new();
    for floor in &drawing.floors {
        if let Ok(ring) = clean::ring(&floor.corners, "floor") {
            floors.push((clean::upright_ring(&ring, true, "floor")?.0, floor.hole));
        }
    }
    tell_of_steps(drawing, stray);
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    snap::collect(lines.iter().map(|l| (l[0], l[1])), &mut xs, &mut ys);
    // floors go by the walls, so their edges have next to no weight
    let before = (xs.len(), ys.len());
    snap::collect(floors.iter().flat_map(|f| upright::edges(&f.0)), &mut xs, &mut ys);
    xs[before.0..].iter_mut().chain(&mut ys[before.1..]).for_each(|c| c.1 *= 1e-6);
    let (xs, ys) = (Axis::new(xs, SNAP_M), Axis::new(ys, SNAP_M));
    let floors: Vec<FloorRing> = floors.iter().map(|(ring, hole)| (snap::ring(ring, &xs, &ys), *hole)).collect();
    let too_many = || Error::refused("walls", "are too many for one plan; leave out what is not a wall");
    let found = faces::faces(&lines, &drawing.openings, &floors, &xs, &ys).ok_or_else(too_many)?;
    check_count(found.count)?;
    drawing.notes.extend(found.notes);
    if found.count == 0 {
        return Ok(None);
    }
    drawing.openings.extend(found.passages);
    let mut rooms = Vec::with_capacity(found.count);
    for i in 0..found.count {
        let at = found.cells.owner.iter().position(|o| *o == Some(i as u32)).unwrap_or(0);
        let columns = found.cells.columns().max(1);
        let corner = point((found.cells.xs[at % columns], found.cells.ys[at / columns]));
        let place = format!("space {} at ({:.2}, {:.2}) m", i + 1, corner.x, corner.y);
        rooms.push(DrawnRoom { traced: true, ..DrawnRoom::new(String::new(), Vec::new(), place) });
    }
    Ok(Some((rooms, found.cells)))
}

/// Returns floors as rooms, where walls enclose none.
fn floors_as_rooms(drawing: &mut Drawing) -> Vec<DrawnRoom> {
    let holes: Vec<Vec<Point>> = drawing.floors.iter().filter(|f| f.hole).map(|f| f.corners.clone()).collect();
    let floors = drawing.floors.iter().filter(|f| !f.hole).enumerate().map(|(i, floor)| {
        let outline = Polygon(floor.corners.clone());
        let inside = |h: &&Vec<Point>| h.iter().all(|p| outline.contains(*p));
        let holes = holes.iter().filter(inside).cloned().collect();
        let room = DrawnRoom::new(String::new(), floor.corners.clone(), format!("floor {}", i + 1));
        DrawnRoom { holes, traced: true, ..room }
    });
    floors.collect()
}

/// Gives rooms without a name the first of the words that stand in them; returns the other words in each room.
fn name(rooms: &mut [DrawnRoom], cells: &Cells, drawing: &Drawing) -> Vec<Vec<String>> {
    let mm = |v: f64| (v * 1000.0).round() as i64;
    let mut words: Vec<Vec<String>> = vec![Vec::new(); rooms.len()];
    for label in drawing.labels.iter().filter(|l| words::is_name(&l.text)) {
        if let Some(list) = cells.owner_at((mm(label.at.x), mm(label.at.y))).and_then(|room| words.get_mut(room)) {
            list.push(label.text.trim().to_owned());
        }
    }
    for (room, list) in rooms.iter_mut().zip(&mut words) {
        if room.label.trim().is_empty() && !list.is_empty() {
            let label = list.remove(0);
            room.place = format!("room `{label}`");
            room.label = label;
        }
        list.truncate(MOST_WORDS);
    }
    words
}

/// Drops outlines of the whole building: those that hold two rooms or more.
fn drop_outlines(rooms: &mut Vec<Outlined>, notes: &mut Vec<Note>) {
    let outlines: Vec<Polygon> = rooms.iter().map(|r| polygon(&r.ring)).collect();
    let holes: Vec<Vec<Polygon>> = rooms.iter().map(|r| r.holes.iter().map(|h| polygon(h)).collect()).collect();
    let bounds: Vec<_> = outlines.iter().map(Polygon::bounds).collect();
    let holds = |i: usize, j: usize| {
        let (a, b) = (bounds[i], bounds[j]);
        let within = a.x0 <= b.x0 + 0.05 && a.y0 <= b.y0 + 0.05 && a.x1 >= b.x1 - 0.05 && a.y1 >= b.y1 - 0.05;
        within && outlines[i].area() > outlines[j].area() + 0.5 && {
            let inner = outlines[j].rects();
            let within = |p: Point| outlines[i].contains(p) && !holes[i].iter().any(|h| h.contains(p));
            !inner.is_empty() && inner.iter().all(|r| within(r.center()))
        }
    };
    let two = |i: usize| (0..rooms.len()).filter(|&j| j != i && holds(i, j)).take(2).count() == 2;
    let drop: Vec<bool> = (0..rooms.len()).map(two).collect();
    for (_, outlined) in rooms.iter().enumerate().filter(|(i, _)| drop[*i]) {
        let place = &outlined.room.place;
        let message = format!("{place} holds other rooms and was taken for the outline of the building");
        notes.push(note("building_outline", message));
    }
    let mut at = 0;
    rooms.retain(|_| {
        at += 1;
        !drop[at - 1]
    });
}

/// Returns the grid with the floor that each room is drawn on; rooms may overlap by `graze`, mm, and found ones give way.
fn fill(rooms: &[Outlined], graze: i64) -> Result<Cells, Error> {
    let rings = || rooms.iter().flat_map(|r| std::iter::once(&r.ring).chain(&r.holes)).flatten();
    let mut cells = Cells::new(rings().map(|c| c.0).collect(), rings().map(|c| c.1).collect())
        .ok_or_else(|| Error::refused("plan", "has too many different wall lines; draw rooms with fewer corners"))?;
    let mut hole_of: Vec<usize> = vec![usize::MAX; cells.owner.len()];
    for (room, outlined) in rooms.iter().enumerate() {
        for hole in &outlined.holes {
            for (j, from, to) in cells.inside(hole) {
                (from..to).for_each(|i| hole_of[j * cells.columns() + i] = room);
            }
        }
        for (j, from, to) in cells.inside(&outlined.ring) {
            for i in from..to {
                if hole_of[j * cells.columns() + i] == room {
                    continue;
                }
                let (width, height) = (cells.xs[i + 1] - cells.xs[i], cells.ys[j + 1] - cells.ys[j]);
                match cells.at(i, j).map(|o| o as usize) {
                    Some(other) if width > graze && height > graze && !outlined.room.traced => {
                        let message = format!(
                            "lies on top of {} around ({:.3}, {:.3}) m; two rooms share no floor",
                            rooms[other].room.place,
                            (cells.xs[i] + width / 2) as f64 / 1000.0,
                            (cells.ys[j] + height / 2) as f64 / 1000.0
                        );
                        return Err(Error::refused(&outlined.room.place, message));
                    }
                    Some(_) => {}
                    None => cells.set(i, j, Some(room as u32)),
                }
            }
        }
    }
    Ok(cells)
}

/// The floor of the rooms on wall center lines, and as drawn, on the same grid.
struct Walls {
    cells: Cells,
    floor: Cells,
    /// Usual thickness of inner and outer walls, mm.
    inner: i64,
    outer: i64,
}

/// Outlines of rooms that are each one simple outline.
struct Outlines {
    /// Which drawn room it is, its outline on center lines, its outline on wall faces.
    rooms: Vec<(usize, Vec<Corner>, Vec<Corner>)>,
    /// The drawn room that each drawn room or piece was part of at first.
    origin: Vec<usize>,
    /// The same by the rooms that are left.
    family: Vec<usize>,
    stretches: Vec<Stretch>,
}

/// Cuts rooms in pieces until each is one simple outline with floor between its walls; leaves out what cannot be.
///
/// # Errors
/// `Refused` for a drawn room that its walls leave no floor of.
fn outlines(drawn: &mut Vec<DrawnRoom>, walls: &mut Walls, notes: &mut Vec<Note>) -> Result<Outlines, Error> {
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
            let found = outline(i, &by_room[i]).ok_or(Fault::NoRing).and_then(|r| net(i, &r, &by_room[i]).map(|n| (r, n)));
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
fn walls(drawn: Cells, options: &Options, notes: &mut Vec<Note>) -> Result<Walls, Error> {
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
    Ok(Walls { cells, floor, inner, outer })
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
    cells.outline(0).ok_or(Fault::Parts)
}
