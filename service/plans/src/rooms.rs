//! The rooms of a drawing and the floor that each stands on, on the lattice of millimeters: as they are drawn, or as walls and
//! floors enclose them.

use d3dgen_model::scene_graph::Note;
use d3dgen_model::{Point, Polygon};

use crate::cells::Cells;
use crate::drawing::{Drawing, DrawnOpening, DrawnRoom, DrawnSolid, DrawnWall, OpeningKind, SolidKind, note};
use crate::error::{ENCLOSE_NONE, Error};
use crate::faces::FloorRing;
use crate::options::INNER_WALL_M;
use crate::options::Options;
use crate::shape::Corner;
use crate::shape::{area, distance, edges, extents, point, polygon, share_inside, thickened};
use crate::snap::Axis;
use crate::straighten::{Chain, Done, straighten};
use crate::{clean, faces, snap, words};

/// Coordinates closer than this are one wall face, m.
const SNAP_M: f64 = 0.015;
/// Rooms may overlap by this much on account of rounding, mm.
const GRAZE: i64 = 30;
/// Ends of walls drawn as lines are one within this distance, m; corners of outlines within the next.
const WELD_WALL_M: f64 = 0.08;
const WELD_OUTLINE_M: f64 = 0.03;
/// A closed shape without a name is a wall when it is this thin, m, and so many times as long.
const STRIP_M: f64 = 0.4;
const STRIP_LONG: f64 = 2.5;
/// Smallest hole in an outline that is a court, m^2; smaller ones are columns.
const COLUMN_M2: f64 = 0.5;
/// Share of an outline in another one that is all of it, but for rounding.
const ALL: f64 = 0.98;
/// Most other words that a room keeps.
const MOST_WORDS: usize = 12;
/// Most rooms of a plan.
const MOST_ROOMS: usize = 1000;

/// A room with its outline and its holes on the lattice.
struct Outlined {
    room: DrawnRoom,
    ring: Vec<Corner>,
    holes: Vec<Vec<Corner>>,
}

/// Returns the rooms with the floor that each is drawn on, or that walls enclose where no rooms are drawn.
pub(crate) fn rooms_and_floor(drawing: &mut Drawing, options: &Options) -> Result<(Vec<DrawnRoom>, Cells), Error> {
    if drawing.rooms.is_empty()
        && let Some(found) = enclosed_or_drawn(drawing, options)?
    {
        return Ok(found);
    }
    walls_in_rooms(drawing, options);
    let shift = straighten_rooms(drawing);
    let mut stray = 0.0_f64;
    let mut upright_rooms: Vec<(DrawnRoom, Vec<Point>, Vec<Vec<Point>>)> = Vec::new();
    for mut room in std::mem::take(&mut drawing.rooms) {
        let ring = clean::ring(&room.corners, &room.place)?;
        let (ring, off) = clean::upright_ring(&ring, options.rectify || room.traced, &room.place)?;
        stray = stray.max(off);
        let mut holes = Vec::new();
        for hole in std::mem::take(&mut room.holes) {
            if area(&hole) < COLUMN_M2 {
                let (kind, level, place) = (SolidKind::Column, room.level.clone(), format!("hole in {}", room.place));
                drawing.solids.push(DrawnSolid { kind, outline: hole, level, place });
                continue;
            }
            let place = format!("hole in {}", room.place);
            let (hole, off) =
                clean::upright_ring(&clean::ring(&hole, &place)?, options.rectify || room.traced, &place)?;
            stray = stray.max(off);
            holes.push(hole);
        }
        upright_rooms.push((room, ring, holes));
    }
    tell_of_steps(drawing, stray);
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    let rings = || upright_rooms.iter().flat_map(|(_, ring, holes)| std::iter::once(ring).chain(holes));
    snap::collect(rings().flat_map(|ring| edges(ring)), &mut xs, &mut ys);
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

/// Returns what walls enclose; where that is nothing, makes rooms of shapes and floors.
///
/// # Errors
/// `Refused` where there are none either.
fn enclosed_or_drawn(drawing: &mut Drawing, options: &Options) -> Result<Option<(Vec<DrawnRoom>, Cells)>, Error> {
    let found = enclosed(drawing, options)?;
    let unclear = std::mem::take(&mut drawing.unclear);
    if found.is_some() {
        unclear.iter().for_each(|s| drawing.leave_out(s.told()));
        drawing.tell_of_unread();
        return Ok(found);
    }
    drawing.rooms = unclear.into_iter().map(|s| s.room).collect();
    if drawing.rooms.is_empty() {
        drawing.rooms = floors_as_rooms(drawing);
    }
    if drawing.rooms.is_empty() {
        let message = format!("{ENCLOSE_NONE}; every room needs a closed run of walls, with doors drawn in the gaps");
        return Err(Error::refused("walls", message));
    }
    Ok(None)
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

fn tell_of_straight(notes: &mut Vec<Note>, done: Option<Done>) -> f64 {
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
    let rings =
        |d: &Drawing| d.rooms.iter().flat_map(|r| std::iter::once(&r.corners).chain(&r.holes)).map(closed).collect();
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
    let is_line = |o: &DrawnOpening| o.arc.is_none() && o.points.len() == 2;
    let walls = drawing.walls.iter().map(|w| open(w.line.to_vec(), false));
    let doors =
        drawing.openings.iter().filter(|o| is_line(o)).map(|o| open(o.points.clone(), o.kind != OpeningKind::Window));
    let floors = drawing.floors.iter().map(|f| Chain { points: f.corners.clone(), closed: true, door: false });
    let mut chains: Vec<Chain> = walls.chain(doors).chain(floors).collect();
    let done = straighten(&mut chains, WELD_WALL_M);
    if done.is_some() {
        let mut chains = chains.into_iter();
        let mut walls = Vec::with_capacity(drawing.walls.len());
        // walls have got further ends where others meet them
        for (wall, chain) in drawing.walls.iter().zip(chains.by_ref()) {
            walls.extend(chain.points.windows(2).map(|p| DrawnWall { line: [p[0], p[1]], ..wall.clone() }));
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
fn enclosed(drawing: &mut Drawing, options: &Options) -> Result<Option<(Vec<DrawnRoom>, Cells)>, Error> {
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
    snap::collect(floors.iter().flat_map(|f| edges(&f.0)), &mut xs, &mut ys);
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
    stand_free(drawing, options, &found.free_walls, found.standing);
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

/// Adds what walls show to stand in rooms: their free ends and pieces as thick as inner walls, and small closed shapes.
fn stand_free(drawing: &mut Drawing, options: &Options, walls: &[[Point; 2]], standing: Vec<Vec<Point>>) {
    let solid = |kind: SolidKind, outline: Vec<Point>| {
        let at = outline.first().copied().unwrap_or(Point::new(0.0, 0.0));
        DrawnSolid { kind, outline, level: None, place: format!("wall at ({:.2}, {:.2}) m", at.x, at.y) }
    };
    let thickness = options.inner_wall_m.unwrap_or(INNER_WALL_M);
    drawing.solids.extend(walls.iter().map(|line| solid(SolidKind::Wall, thickened(*line, thickness))));
    drawing.solids.extend(standing.into_iter().map(|outline| {
        let (long, short) = extents(&outline);
        let kind = if long >= STRIP_LONG * short { SolidKind::Wall } else { SolidKind::Column };
        solid(kind, outline)
    }));
}

/// Adds the walls drawn inside of rooms whose outlines are drawn: those that keep off their outlines.
fn walls_in_rooms(drawing: &mut Drawing, options: &Options) {
    let inside = |wall: &DrawnWall| {
        let [a, b] = wall.line;
        let middle = Point::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0);
        let holds = |room: &DrawnRoom| {
            let outline = Polygon(room.corners.clone());
            room.level == wall.level && [a, b, middle].iter().all(|p| outline.contains(*p)) && {
                let ring: Vec<Point> = room.corners.iter().chain(room.corners.first()).copied().collect();
                [a, b, middle].iter().any(|p| distance(&ring, *p) > STRIP_M)
            }
        };
        a.distance(b) > STRIP_M && drawing.rooms.iter().any(holds)
    };
    let free: Vec<[Point; 2]> = drawing.walls.iter().filter(|w| inside(w)).map(|w| w.line).collect();
    stand_free(drawing, options, &free, Vec::new());
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
pub(crate) fn name(rooms: &mut [DrawnRoom], cells: &Cells, drawing: &mut Drawing) -> Vec<Vec<String>> {
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
        list.dedup();
        if room.traced && !list.is_empty() {
            let message = format!("{} also has the names {}", room.place, list.join(", "));
            drawing.notes.push(note("several_names", message));
        }
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
        let larger = outlines[i].area() > outlines[j].area() + 0.5;
        let in_hole = |h: &Polygon| share_inside(outlines[j].corners(), h.corners()) > 0.5;
        within
            && larger
            && share_inside(outlines[j].corners(), outlines[i].corners()) > ALL
            && !holes[i].iter().any(in_hole)
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

/// Takes closed shapes that are as thin as walls, and have no name, for walls.
pub(crate) fn strips(drawing: &mut Drawing) {
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
        drawing.walls.extend(edges(&strip.corners).map(|(a, b)| DrawnWall {
            line: [a, b],
            level: strip.level.clone(),
            place: strip.place.clone(),
        }));
    }
}
