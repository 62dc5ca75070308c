//! The floorplan document of a layout whose rooms have types.

use std::collections::BTreeMap;

use d3dgen_model::Segment;
use d3dgen_model::courts;
use d3dgen_model::domain::{Domain, Zone};
use d3dgen_model::floorplan::{Door, DoorKind, FixedObstacle, Floorplan, ObstacleKind, PlanRoom, Swing, Wall, Window};
use d3dgen_model::geometry::to_mm;
use d3dgen_model::measures::DOOR_HEIGHT_M;
use d3dgen_model::scene_graph::Note;
use d3dgen_model::slides;
use d3dgen_model::storeys::{Level, LinkKind, VerticalLink};

use crate::drawing::{OpeningKind, SolidKind, note};
use crate::layout::{LaidObstacle, LaidOpening, Layout};
use crate::options::Options;
use crate::shape::point;
use crate::{add, links};

/// Wall left above openings, m.
const LINTEL_M: f64 = 0.2;
/// Sill and head of windows that do not say theirs, m.
const SILL_M: f64 = 0.9;
const HEAD_M: f64 = 2.1;
/// Frame of a door, both sides together, m.
const FRAME_M: f64 = 0.06;
/// Floor structure below a storey where the domain says nothing of storeys, and the thinnest there is, m.
const SLAB_M: f64 = 0.4;
const THINNEST_SLAB_M: f64 = 0.1;
/// Clear width from which a door gets two leaves, m.
const DOUBLE_FROM_M: f64 = 1.25;
/// A leaf whose square takes more than this share of the room slides instead.
const SLIDING_SHARE: f64 = 0.22;

/// Returns the floorplan, all of it locked, with the notes of the layout and of this step; `types` has a room type of the
/// domain for each room.
pub fn assemble(
    mut layout: Layout,
    types: &[String],
    domain: &Domain,
    seed: u64,
    options: &Options,
) -> (Floorplan, Vec<Note>) {
    if options.add_doors {
        add::doors(&mut layout, types, domain);
    }
    if options.add_windows {
        add::windows(&mut layout, types, domain);
    }
    let links = if layout.levels.is_empty() { Vec::new() } else { links::links(&mut layout, types, domain) };
    let mut types = types.to_vec();
    links.iter().for_each(|l| l.rooms.iter().for_each(|&r| types[r].clone_from(&l.room_type)));
    let mut rooms = rooms(&layout, &types, domain);
    let levels = levels(&layout, &mut rooms, domain);
    let links = vertical(&links, &mut rooms, &levels);
    tell_of_missing(&mut layout, &rooms);
    let mut doors = doors(&layout, &rooms);
    guess_entrance(&mut doors, &rooms, domain, &mut layout.notes);
    let windows = windows(&layout, &rooms);
    let obstacles = obstacles(&layout, &rooms);
    let walls = walls(&layout, &rooms);
    slides::aim(&mut doors, &walls);
    let plan = Floorplan {
        version: 1,
        seed,
        scheme: Floorplan::GIVEN.into(),
        rooms,
        walls,
        doors,
        windows,
        obstacles,
        cost: Vec::new(),
        conflicts: Vec::new(),
        levels,
        links,
    };
    (plan, layout.notes)
}

fn rooms(layout: &Layout, types: &[String], domain: &Domain) -> Vec<PlanRoom> {
    let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
    let list = layout.rooms.iter().zip(types).enumerate().map(|(i, (room, room_type))| {
        let kind = domain.room_type_or_generic(room_type);
        let number = seen.entry(&kind.id).or_default();
        *number += 1;
        let name = if room.label.is_empty() { format!("{} {number}", kind.label) } else { room.label.clone() };
        PlanRoom {
            room_id: format!("{}_{number}", kind.id),
            room_type: kind.id.clone(),
            name: name.chars().filter(|c| !c.is_control()).take(80).collect(),
            circulation: kind.zone == Zone::Circulation,
            polygon: room.polygon.clone(),
            net_area_m2: to_mm(room.net_polygon.signed_area()),
            net_polygon: room.net_polygon.clone(),
            ceiling_height_m: room.height_m.unwrap_or(kind.ceiling_height_m),
            materials: kind.materials.clone(),
            locked: true,
            level: layout.number_of(i),
        }
    });
    list.collect()
}

/// Returns the storeys with their heights: by the elevations that the file states, otherwise as high as their rooms. A ceiling
/// that was assumed gives way to the floor above.
fn levels(layout: &Layout, rooms: &mut [PlanRoom], domain: &Domain) -> Vec<Level> {
    let slab = domain.circulation.storeys.as_ref().map_or(SLAB_M, |s| s.slab_m);
    let mut levels: Vec<Level> = Vec::with_capacity(layout.levels.len());
    let mut elevation = 0.0;
    for (k, laid) in layout.levels.iter().enumerate() {
        let next = layout.levels.get(k + 1).and_then(|l| l.elevation_m);
        let stated = laid.elevation_m.zip(next).map(|(from, to)| to - from);
        let tallest = rooms.iter().filter(|r| r.level == laid.number).map(|r| r.ceiling_height_m).fold(0.0, f64::max);
        let height_m = to_mm(stated.unwrap_or(tallest + slab));
        levels.push(Level { level: laid.number, elevation_m: to_mm(laid.elevation_m.unwrap_or(elevation)), height_m });
        elevation += height_m;
        for (room, laid_room) in rooms.iter_mut().zip(&layout.rooms) {
            if laid_room.storey == k && laid_room.height_m.is_none() {
                room.ceiling_height_m = room.ceiling_height_m.min(to_mm(height_m - THINNEST_SLAB_M));
            }
        }
    }
    let ground = levels.iter().find(|l| l.level == 0).map_or(0.0, |l| l.elevation_m);
    levels.iter_mut().for_each(|l| l.elevation_m = to_mm(l.elevation_m - ground));
    levels
}

/// Returns links with the ids of their rooms. Flights go up through the ceiling; over those of the highest storey it is a usual
/// one.
fn vertical(links: &[links::Link], rooms: &mut [PlanRoom], levels: &[Level]) -> Vec<VerticalLink> {
    let mut counts: BTreeMap<LinkKind, u32> = BTreeMap::new();
    let link = |link: &links::Link| {
        if let (LinkKind::Stairs, Some((_, below))) = (link.kind, link.rooms.split_last()) {
            for &room in below {
                let height = levels.iter().find(|l| l.level == rooms[room].level).map(|l| l.height_m);
                rooms[room].ceiling_height_m = height.unwrap_or(rooms[room].ceiling_height_m);
            }
        }
        let count = counts.entry(link.kind).or_default();
        *count += 1;
        let name = if link.kind == LinkKind::Stairs { "stairs" } else { "elevator" };
        let room_ids = link.rooms.iter().map(|&r| rooms[r].room_id.clone()).collect();
        VerticalLink { link_id: format!("{name}_{count}"), kind: link.kind, room_ids }
    };
    links.iter().map(link).collect()
}

/// Notes the rooms that no door leads to.
fn tell_of_missing(layout: &mut Layout, rooms: &[PlanRoom]) {
    let walkable = |o: &&LaidOpening| o.kind != OpeningKind::Window;
    let without: Vec<&str> = (0..rooms.len())
        .filter(|r| !layout.openings.iter().filter(walkable).any(|o| o.rooms.contains(r)))
        .map(|r| rooms[r].name.as_str())
        .collect();
    if !without.is_empty() {
        let message = format!("no door leads to {}; --add-doors would add some", without.join(", "));
        layout.notes.push(note("no_door", message));
    }
}

fn segment(layout: &Layout, o: &LaidOpening) -> Segment {
    let s = &layout.stretches[o.stretch];
    Segment { start: point(s.point(o.from)), end: point(s.point(o.to)) }
}

fn doors(layout: &Layout, rooms: &[PlanRoom]) -> Vec<Door> {
    let mut doors = Vec::new();
    for o in layout.openings.iter().filter(|o| o.kind != OpeningKind::Window) {
        let s = &layout.stretches[o.stretch];
        let line = segment(layout, o);
        let opening = line.length();
        let clear = if o.kind == OpeningKind::Passage { opening } else { opening - FRAME_M };
        // a leaf opens into the smaller room, never into circulation; out of the building on the way out
        let into = match o.rooms[..] {
            [a, b] if rooms[a].circulation != rooms[b].circulation => Some(if rooms[a].circulation { b } else { a }),
            [a, b] => Some(if rooms[a].net_area_m2 <= rooms[b].net_area_m2 { a } else { b }),
            _ => None,
        };
        let (into, hinge_at_start) = o.swing.unwrap_or((into, true));
        let double = clear >= DOUBLE_FROM_M;
        let leaf = if double { opening / 2.0 } else { opening };
        let slides =
            o.sliding || o.swing.is_none() && into.is_some_and(|r| leaf * leaf > SLIDING_SHARE * rooms[r].net_area_m2);
        let kind = match o.kind {
            OpeningKind::Passage => DoorKind::Open,
            _ if slides => DoorKind::Sliding,
            _ if double => DoorKind::DoubleHinged,
            _ => DoorKind::Hinged,
        };
        let leafless = matches!(kind, DoorKind::Open | DoorKind::Sliding);
        let least = o.rooms.iter().map(|&r| rooms[r].ceiling_height_m).fold(f64::MAX, f64::min);
        doors.push(Door {
            door_id: format!("door_{}", doors.len() + 1),
            kind,
            line,
            clear_width_m: to_mm(clear),
            height_m: to_mm(o.head_m.filter(|h| *h >= 1.5).unwrap_or(DOOR_HEIGHT_M).min(least)),
            wall_thickness_m: to_mm(s.thickness() as f64 / 1000.0),
            room_ids: o.rooms.iter().map(|&r| rooms[r].room_id.clone()).collect(),
            entrance: false,
            swing: (!leafless).then(|| Swing { into_room_id: into.map(|r| rooms[r].room_id.clone()), hinge_at_start }),
            slide: None,
            automatic: false,
            locked: true,
        });
    }
    doors
}

/// Takes one door to outdoors for the entrance: into the room meant for it, the widest one.
fn guess_entrance(doors: &mut [Door], rooms: &[PlanRoom], domain: &Domain, notes: &mut Vec<Note>) {
    let rank = |door: &Door| {
        let room = rooms.iter().find(|r| r.room_id == door.room_ids[0]);
        let listed = room.and_then(|r| domain.circulation.entrance_room_types.iter().position(|t| *t == r.room_type));
        (listed.unwrap_or(usize::MAX), !room.is_some_and(|r| r.circulation), -(door.clear_width_m * 1000.0) as i64)
    };
    let courts = courts::between(rooms);
    let at_ground = |door: &Door| rooms.iter().any(|r| r.level == 0 && door.room_ids == [r.room_id.as_str()]);
    let leads_out = |door: &Door| at_ground(door) && courts::leads_out(door, rooms, &courts);
    let outer: Vec<usize> = (0..doors.len()).filter(|&i| leads_out(&doors[i])).collect();
    match outer.iter().copied().min_by_key(|&i| rank(&doors[i])) {
        Some(best) => {
            doors[best].entrance = true;
            if outer.len() > 1 {
                let message =
                    format!("{} of {} doors to outdoors was taken for the entrance", doors[best].door_id, outer.len());
                notes.push(note("entrance_guessed", message));
            }
        }
        None => notes.push(note("no_entrance", "no door leads outdoors; --add-doors would add an entrance")),
    }
}

fn windows(layout: &Layout, rooms: &[PlanRoom]) -> Vec<Window> {
    let mut windows = Vec::new();
    for o in layout.openings.iter().filter(|o| o.kind == OpeningKind::Window) {
        let Some(room) = o.rooms.first().map(|&r| &rooms[r]) else { continue };
        let top = room.ceiling_height_m - LINTEL_M;
        // compared as they are written, to the millimeter
        let head = o.head_m.map(to_mm).filter(|h| *h > 0.0).unwrap_or_else(|| to_mm(HEAD_M.min(top)));
        let sill = o.sill_m.map(to_mm).filter(|s| *s < head).unwrap_or(SILL_M.min((head * 500.0).floor() / 1000.0));
        windows.push(Window {
            window_id: format!("window_{}", windows.len() + 1),
            line: segment(layout, o),
            sill_m: sill,
            head_m: head,
            wall_thickness_m: to_mm(layout.stretches[o.stretch].thickness() as f64 / 1000.0),
            room_id: room.room_id.clone(),
            locked: true,
        });
    }
    windows
}

fn obstacles(layout: &Layout, rooms: &[PlanRoom]) -> Vec<FixedObstacle> {
    let obstacle = |(i, o): (usize, &LaidObstacle)| FixedObstacle {
        obstacle_id: format!("obstacle_{}", i + 1),
        kind: match o.kind {
            SolidKind::Column => ObstacleKind::Column,
            SolidKind::Wall => ObstacleKind::Wall,
        },
        outline: o.outline.clone(),
        room_id: rooms[o.room].room_id.clone(),
        locked: true,
    };
    layout.obstacles.iter().enumerate().map(obstacle).collect()
}

/// Returns wall pieces with the doors cut out; windows stay part of their wall.
fn walls(layout: &Layout, rooms: &[PlanRoom]) -> Vec<Wall> {
    let mut walls = Vec::new();
    for (k, s) in layout.stretches.iter().enumerate() {
        let cut = |o: &&LaidOpening| o.stretch == k && o.kind != OpeningKind::Window;
        let mut cuts: Vec<(i64, i64)> = layout.openings.iter().filter(cut).map(|o| (o.from, o.to)).collect();
        cuts.sort_unstable();
        cuts.push((s.to, s.to));
        let mut from = s.from;
        for (a, b) in cuts {
            if a > from {
                walls.push(Wall {
                    wall_id: format!("wall_{}", walls.len() + 1),
                    line: Segment { start: point(s.point(from)), end: point(s.point(a)) },
                    thickness_m: to_mm(s.thickness() as f64 / 1000.0),
                    room_ids: s.rooms().map(|r| rooms[r].room_id.clone()).collect(),
                    exterior: s.is_outer(),
                    locked: true,
                });
            }
            from = b;
        }
    }
    walls
}
