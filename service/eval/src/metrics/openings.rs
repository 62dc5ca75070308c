//! OC: free space at doors and windows (SceneEval v1.1, opening clearance; PhyScene's door collision rate is a kin).
//!
//! As there: a box before each side of an opening that is in a room, as wide and high as the opening and as deep as a door
//! is wide (windows 0.5 m); a side is blocked when an object reaches into the box, and the occluded share is the part of
//! the opening's area that objects in the box hide. What differs: the box is as deep as a leaf is wide, half the opening
//! where there are two; what slides or has no leaf needs no room to swing and gets the depth of a window. The share by
//! the letter, as deep as the opening is wide, stands beside it. Curtains and blinds belong before windows; rugs and mats
//! no thicker than 3 cm are floor.

use d3dgen_model::floorplan::DoorKind;
use d3dgen_model::{Point, Segment, TOLERANCE_M};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{round, share};
use crate::kinds::Kinds;
use crate::solid::Scene;

/// Depth before an opening without a leaf, m.
const NO_LEAF_M: f64 = 0.5;
/// Parts of an opening's width and height that are looked through one by one.
const PARTS: usize = 40;

/// Free space at doors and windows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Openings {
    /// Sides of doors and passages that are in a room.
    pub door_sides: u32,
    /// Share of them with an object before them.
    pub door_sides_blocked: f64,
    /// The same with boxes as deep as the opening is wide, whatever fills it: SceneEval's definition by the letter.
    pub door_sides_blocked_full_width: f64,
    /// Mean share of a door's area that is hidden.
    pub doors_occluded: f64,
    /// Windows.
    pub windows: u32,
    /// Share of windows with an object before them.
    pub windows_blocked: f64,
    /// Mean share of a window's area that is hidden.
    pub windows_occluded: f64,
    /// Opening id and placement id of what is before it; doors first.
    pub blocked: Vec<[String; 2]>,
}

/// A side of an opening.
struct Opening<'a> {
    id: &'a str,
    line: Segment,
    /// Outward direction from the wall into the room.
    out: (f64, f64),
    depth: f64,
    /// Depth when a single leaf filled it.
    full_depth: f64,
    z: (f64, f64),
    window: bool,
}

/// Measures a world.
pub(crate) fn measure(scene: &Scene<'_>) -> Openings {
    let (doors, windows) = (doors(scene), windows(scene));
    let mut blocked = Vec::new();
    let mut look = |openings: &[Opening<'_>]| {
        let (mut sides, mut hidden) = (0, 0.0);
        for opening in openings {
            let (objects, share) = before(scene, opening);
            sides += usize::from(!objects.is_empty());
            hidden += share;
            blocked.extend(objects.into_iter().map(|o| [opening.id.to_owned(), o]));
        }
        let part = if openings.is_empty() { 0.0 } else { share(sides, openings.len()) };
        (part, round(hidden / openings.len().max(1) as f64))
    };
    let full = doors.iter().filter(|d| !before(scene, &Opening { depth: d.full_depth, ..**d }).0.is_empty()).count();
    let (door_sides_blocked, doors_occluded) = look(&doors);
    let (windows_blocked, windows_occluded) = look(&windows);
    Openings {
        door_sides: doors.len() as u32,
        door_sides_blocked,
        door_sides_blocked_full_width: if doors.is_empty() { 0.0 } else { share(full, doors.len()) },
        doors_occluded,
        windows: windows.len() as u32,
        windows_blocked,
        windows_occluded,
        blocked,
    }
}

fn doors<'a>(scene: &Scene<'a>) -> Vec<Opening<'a>> {
    let mut sides = Vec::new();
    for door in &scene.world.floorplan.doors {
        let length = door.line.length();
        let depth = match door.kind {
            DoorKind::Hinged => length,
            DoorKind::DoubleHinged => length / 2.0,
            DoorKind::Sliding | DoorKind::Open => NO_LEAF_M,
        };
        for out in normals(&door.line) {
            let probe = at(&door.line.middle(), out, door.wall_thickness_m / 2.0 + 0.01);
            if scene
                .rooms
                .iter()
                .flatten()
                .any(|r| r.x0 <= probe.x && probe.x <= r.x1 && r.y0 <= probe.y && probe.y <= r.y1)
            {
                let half = door.wall_thickness_m / 2.0;
                sides.push(Opening {
                    id: &door.door_id,
                    line: door.line,
                    out,
                    depth: depth + half,
                    full_depth: length + half,
                    z: (0.0, door.height_m),
                    window: false,
                });
            }
        }
    }
    sides
}

fn windows<'a>(scene: &Scene<'a>) -> Vec<Opening<'a>> {
    let mut sides = Vec::new();
    for window in &scene.world.floorplan.windows {
        let Some(room) = scene.world.floorplan.rooms.iter().position(|r| r.room_id == window.room_id) else { continue };
        for out in normals(&window.line) {
            let probe = at(&window.line.middle(), out, window.wall_thickness_m / 2.0 + 0.01);
            if scene.rooms[room]
                .iter()
                .any(|r| r.x0 <= probe.x && probe.x <= r.x1 && r.y0 <= probe.y && probe.y <= r.y1)
            {
                let depth = NO_LEAF_M + window.wall_thickness_m / 2.0;
                let z = (window.sill_m, window.head_m);
                sides.push(Opening {
                    id: &window.window_id,
                    line: window.line,
                    out,
                    depth,
                    full_depth: depth,
                    z,
                    window: true,
                });
            }
        }
    }
    sides
}

fn normals(line: &Segment) -> [(f64, f64); 2] {
    if line.is_vertical() { [(1.0, 0.0), (-1.0, 0.0)] } else { [(0.0, 1.0), (0.0, -1.0)] }
}

fn at(p: &Point, out: (f64, f64), distance: f64) -> Point {
    Point::new(p.x + out.0 * distance, p.y + out.1 * distance)
}

/// Returns what stands before an opening, and the share of its area that is hidden.
fn before(scene: &Scene<'_>, opening: &Opening<'_>) -> (Vec<String>, f64) {
    let (a, b) = (opening.line.start, opening.line.end);
    let far = at(&b, opening.out, opening.depth);
    let zone = d3dgen_model::Rect::new(a.x, a.y, far.x, far.y).grown(-TOLERANCE_M);
    let (mut objects, mut shadows) = (Vec::new(), Vec::new());
    for s in &scene.solids {
        let z = (s.z0.max(opening.z.0), s.z1.min(opening.z.1));
        let belongs = s.is_covering() || opening.window && Kinds::builtin().covers_windows(&s.placement.object);
        if belongs || z.1 - z.0 <= TOLERANCE_M || !s.bounds.overlaps(&zone) || s.area_inside(&zone) <= 1e-6 {
            continue;
        }
        objects.push(s.placement.placement_id.clone());
        let along = |r: &d3dgen_model::Rect| if opening.line.is_vertical() { (r.y0, r.y1) } else { (r.x0, r.x1) };
        shadows.push((along(&s.bounds), z));
    }
    if shadows.is_empty() {
        return (objects, 0.0);
    }
    let vertical = opening.line.is_vertical();
    let (from, to) = if vertical { (a.y.min(b.y), a.y.max(b.y)) } else { (a.x.min(b.x), a.x.max(b.x)) };
    let part = |i: usize, (lo, hi): (f64, f64)| lo + (hi - lo) * (i as f64 + 0.5) / PARTS as f64;
    let hidden = (0..PARTS * PARTS).filter(|k| {
        let (u, v) = (part(k % PARTS, (from, to)), part(k / PARTS, opening.z));
        shadows.iter().any(|((u0, u1), (v0, v1))| *u0 <= u && u <= *u1 && *v0 <= v && v <= *v1)
    });
    (objects, hidden.count() as f64 / (PARTS * PARTS) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn a_sound_world_has_free_openings() {
        let world = sample::world();
        let found = measure(&Scene::new(&world));
        // the door between the rooms has two sides, the entrance one
        assert_eq!((found.door_sides, found.door_sides_blocked, found.windows), (3, 0.0, 1));
        assert_eq!((found.windows_blocked, found.blocked.len()), (0.0, 0));
    }

    #[test]
    fn what_stands_before_a_door_blocks_one_side_of_it() {
        let mut world = sample::world();
        // the door runs from y = 1 to 2 at x = 4, 2 m high; the crate hides half its width and half its height
        world.placements.placements.push(sample::thing("crate", (4.6, 1.25), [0.5, 0.5, 1.0]));
        let found = measure(&Scene::new(&world));
        assert_eq!(found.blocked, [["door_1".to_owned(), "crate_1".to_owned()]]);
        assert!((found.door_sides_blocked - 1.0 / 3.0).abs() < 1e-6);
        assert!((found.doors_occluded - 0.25 / 3.0).abs() < 1e-6, "{found:?}");
        // two leaves are half as wide: at x from 4.65 the crate is clear of them, and still before a full leaf
        world.placements.placements.last_mut().unwrap().pose.x = 4.9;
        world.floorplan.doors[0].kind = DoorKind::DoubleHinged;
        let found = measure(&Scene::new(&world));
        assert_eq!(found.door_sides_blocked, 0.0);
        assert!((found.door_sides_blocked_full_width - 1.0 / 3.0).abs() < 1e-6);
        world.placements.placements.last_mut().unwrap().pose.x = 4.6;
        // a passage without a leaf needs 0.5 m from its wall only
        world.floorplan.doors[0].kind = DoorKind::Open;
        assert!(!measure(&Scene::new(&world)).blocked.is_empty());
        world.placements.placements.last_mut().unwrap().pose.x = 4.9;
        assert!(measure(&Scene::new(&world)).blocked.is_empty());
    }

    #[test]
    fn windows_are_blocked_above_the_sill_but_not_by_curtains() {
        let mut world = sample::world();
        // the window runs from x = 5 to 7 at y = 3, sill at 0.9 m, head at 2.1 m; wall's face at y = 2.9
        world.placements.placements.push(sample::thing("sideboard", (6.0, 2.7), [0.4, 0.4, 0.9]));
        world.placements.placements.push(sample::thing("curtain", (6.0, 2.85), [0.1, 2.0, 2.2]));
        assert_eq!(measure(&Scene::new(&world)).windows_blocked, 0.0);
        world.placements.placements.push(sample::thing("cupboard", (6.0, 2.7), [0.4, 0.4, 1.5]));
        let found = measure(&Scene::new(&world));
        assert_eq!((found.windows_blocked, found.blocked[0][1].as_str()), (1.0, "cupboard_1"));
        assert!((found.windows_occluded - 0.2 * 0.5).abs() < 0.01, "{found:?}");
    }
}
