//! Doors: frames, leaves, and how they move.

use std::f64::consts::FRAC_PI_2;

use d3dgen_model::floorplan::{Door, DoorKind, Slide};
use d3dgen_model::geometry::Point;

use super::ids::Ids;
use super::walls::{Line, has_pocket};
use super::{Place, SimBox, SimDoor, SimJoint, SimLeaf, SimRobot};

/// Thickness of a leaf that swings, of one that slides, and of one of two that slide behind each other, m.
const LEAF_M: f64 = 0.04;
const SLIDING_M: f64 = 0.035;
const STACKED_M: f64 = 0.028;
/// Mass of a leaf: honeycomb between hardboard, and the curtain of a gate that rolls up, kg/m^2.
const LEAF_KG_M2: f64 = 8.0;
const CURTAIN_KG_M2: f64 = 1.5;
/// Air beside, above and below a leaf, m.
const GAP_M: f64 = 0.004;
const UNDER_M: f64 = 0.01;
/// Air between a leaf and the faces and the end of its pocket, m.
const POCKET_GAP_M: f64 = 0.005;
const POCKET_END_M: f64 = 0.02;
/// Height of a handle, and its distance from the free edge, m.
const HANDLE_M: [f64; 2] = [1.05, 0.07];
/// Widest door that slides before an outer wall with one leaf, m.
const ONE_LEAF_M: f64 = 1.2;
/// Narrowest jamb, m.
const JAMB_M: f64 = 0.002;
/// How a leaf resists: ball bearings of hinges, N m and N m s/rad; rollers of a slide, N and N s/m.
const HINGE: [f64; 2] = [0.3, 0.5];
const ROLLERS: [f64; 2] = [0.3, 1.0];

/// The pockets of a sliding door: along its line, beyond the clear opening.
pub(super) struct Pocket {
    pub line: Line,
    pub along: Vec<[f64; 2]>,
    pub top_m: f64,
    /// Half the width.
    pub half_m: f64,
}

impl Pocket {
    /// Returns the pockets of a door that has any.
    pub fn of(door: &Door) -> Option<Self> {
        has_pocket(door).then(|| {
            let line = Line::of(&door.line);
            let [from, to] = clear(door, &line);
            let width = to - from;
            let (before, after) = match door.slide.unwrap_or(Slide::BeyondEnd) {
                Slide::BeyondStart => (width, 0.0),
                Slide::Apart => (width / 2.0, width / 2.0),
                Slide::StackedBeyondStart => (width / 2.0, 0.0),
                Slide::StackedBeyondEnd => (0.0, width / 2.0),
                Slide::BeyondEnd | Slide::Up => (0.0, width),
            };
            let stacked = is_stacked(door);
            let thick = if stacked { 2.0 * STACKED_M + POCKET_GAP_M } else { SLIDING_M };
            let mut along = Vec::new();
            if before > 0.0 {
                along.push([from - before - POCKET_END_M, from]);
            }
            if after > 0.0 {
                along.push([to, to + after + POCKET_END_M]);
            }
            Self { line, along, top_m: door.height_m, half_m: thick / 2.0 + POCKET_GAP_M }
        })
    }
}

fn is_stacked(door: &Door) -> bool {
    matches!(door.slide, Some(Slide::StackedBeyondStart | Slide::StackedBeyondEnd))
}

/// Returns from where to where along its line a door is clear.
fn clear(door: &Door, line: &Line) -> [f64; 2] {
    let width = door.clear_width_m.min(line.length);
    [(line.length - width) / 2.0, (line.length + width) / 2.0]
}

/// A leaf before it has a name: along the line and to the left of it, closed.
struct Panel {
    along: [f64; 2],
    left: [f64; 2],
    motion: Motion,
}

/// How a panel opens.
enum Motion {
    /// About an upright axis at this place along the line and to the left of it, counter-clockwise where true.
    Swing([f64; 2], bool),
    /// Along the line, m; less than 0 towards its start.
    Along(f64),
    /// Up by its own height.
    Up,
}

/// Returns the doors of a world, in the order of the plan.
pub(super) fn all(place: &Place<'_>, robots: &[SimRobot], ids: &mut Ids) -> Vec<SimDoor> {
    place.world.floorplan.doors.iter().map(|door| one(place, door, robots, ids)).collect()
}

fn one(place: &Place<'_>, door: &Door, robots: &[SimRobot], ids: &mut Ids) -> SimDoor {
    let line = Line::of(&door.line);
    let level = door.room_ids.first().map_or(0, |r| place.level(r));
    let floor = place.storey(level).elevation_m;
    let (opening, panels) = panels(place, door, &line);
    let id = ids.new_id(&door.door_id);
    let leaves = panels.iter().enumerate().map(|(i, panel)| {
        let name = if panels.len() == 1 { format!("{id}_leaf") } else { format!("{id}_leaf_{}", i + 1) };
        leaf(door, &line, floor, panel, name, ids)
    });
    let leaves: Vec<SimLeaf> = leaves.collect();
    let middle = line.point(line.length / 2.0, 0.0);
    SimDoor {
        kind: door.kind,
        level,
        room_ids: door.room_ids.clone(),
        at_m: [middle.x, middle.y, floor],
        yaw_rad: line.yaw_rad,
        clear_m: [door.clear_width_m, door.height_m],
        thickness_m: door.wall_thickness_m,
        automatic: door.automatic,
        on_route: robots.iter().flat_map(|r| &r.routes).any(|way| way.passes(&line, floor)),
        frame: frame(door, &line, floor, opening),
        leaves,
        id,
    }
}

/// Returns from where to where along the line the frame is open, and the leaves in it.
fn panels(place: &Place<'_>, door: &Door, line: &Line) -> ([f64; 2], Vec<Panel>) {
    let [from, to] = clear(door, line);
    match door.kind {
        DoorKind::Open => ([from, to], Vec::new()),
        DoorKind::Hinged | DoorKind::DoubleHinged => swinging(place, door, line, [from, to]),
        DoorKind::Sliding => ([from, to], sliding(place, door, line, [from, to])),
    }
}

/// A leaf that stands open takes its thickness of the opening: the frame is wider by that at the hinge, so that what the plan
/// calls clear is clear. The axis runs in the face that the leaf swings out of.
fn swinging(place: &Place<'_>, door: &Door, line: &Line, [from, to]: [f64; 2]) -> ([f64; 2], Vec<Panel>) {
    let at_start = door.swing.as_ref().is_none_or(|s| s.hinge_at_start);
    let double = door.kind == DoorKind::DoubleHinged;
    let low = if at_start || double { (from - LEAF_M).max(0.0) } else { from };
    let high = if !at_start || double { (to + LEAF_M).min(line.length) } else { to };
    let to_left = side_of(place, door, line, door.swing.as_ref().and_then(|s| s.into_room_id.as_deref()));
    let face = door.wall_thickness_m / 2.0;
    let left = if to_left { [face - LEAF_M, face] } else { [-face, LEAF_M - face] };
    let leaf = |along: [f64; 2], at_start: bool| Panel {
        along,
        left,
        motion: Motion::Swing([along[usize::from(!at_start)], if to_left { face } else { -face }], at_start == to_left),
    };
    let (a, b, middle) = (low + GAP_M, high - GAP_M, (low + high) / 2.0);
    let panels = match double {
        true => vec![leaf([a, middle - GAP_M / 2.0], true), leaf([middle + GAP_M / 2.0, b], false)],
        false => vec![leaf([a, b], at_start)],
    };
    ([low, high], panels)
}

fn sliding(place: &Place<'_>, door: &Door, line: &Line, [from, to]: [f64; 2]) -> Vec<Panel> {
    let (width, middle) = (to - from, (from + to) / 2.0);
    let panel = |along: [f64; 2], left: [f64; 2], by: f64| {
        let along = [along[0] + GAP_M / 2.0, along[1] - GAP_M / 2.0];
        Panel { along, left, motion: Motion::Along(by) }
    };
    let half = SLIDING_M / 2.0;
    let inside = [-half, half];
    // before the outer face of a wall
    let outer = match side_of(place, door, line, None) {
        true => [door.wall_thickness_m / 2.0 + GAP_M, door.wall_thickness_m / 2.0 + GAP_M + SLIDING_M],
        false => [-door.wall_thickness_m / 2.0 - GAP_M - SLIDING_M, -door.wall_thickness_m / 2.0 - GAP_M],
    };
    let left = if has_pocket(door) { inside } else { outer };
    let stacked =
        [[-STACKED_M - POCKET_GAP_M / 2.0, -POCKET_GAP_M / 2.0], [POCKET_GAP_M / 2.0, STACKED_M + POCKET_GAP_M / 2.0]];
    let one_leaf = if width > ONE_LEAF_M && !has_pocket(door) { Slide::Apart } else { Slide::BeyondEnd };
    match door.slide.unwrap_or(one_leaf) {
        Slide::BeyondStart => vec![panel([from, to], left, -width)],
        Slide::BeyondEnd => vec![panel([from, to], left, width)],
        Slide::Apart => {
            vec![panel([from, middle], left, -width / 2.0), panel([middle, to], left, width / 2.0)]
        }
        Slide::StackedBeyondStart => {
            vec![panel([from, middle], stacked[0], -width / 2.0), panel([middle, to], stacked[1], -width)]
        }
        Slide::StackedBeyondEnd => {
            vec![panel([from, middle], stacked[0], width), panel([middle, to], stacked[1], width / 2.0)]
        }
        Slide::Up => vec![Panel { along: [from, to], left: outer, motion: Motion::Up }],
    }
}

/// Returns whether a room of a door, or what is outdoors, lies to the left of its line.
fn side_of(place: &Place<'_>, door: &Door, line: &Line, room_id: Option<&str>) -> bool {
    let beyond = line.point(line.length / 2.0, door.wall_thickness_m / 2.0 + 0.05);
    let holds = |id: &str, p: Point| place.world.floorplan.room(id).is_some_and(|r| r.polygon.contains(p));
    match room_id {
        Some(id) => holds(id, beyond),
        None => !door.room_ids.iter().any(|id| holds(id, beyond)),
    }
}

fn leaf(door: &Door, line: &Line, floor: f64, panel: &Panel, name: String, ids: &mut Ids) -> SimLeaf {
    let z = [floor + UNDER_M, floor + door.height_m - GAP_M];
    let closed = SimBox::on(line, panel.along, panel.left, z);
    let area = 4.0 * closed.half_m[0] * closed.half_m[2];
    let [long, thick, _] = closed.half_m;
    let handle_z = floor + HANDLE_M[0] - closed.center_m[2];
    let handles = |u: f64| [-1.0, 1.0].map(|side| [u, side * thick, handle_z]).to_vec();
    let free = long - HANDLE_M[1];
    let (joint, u) = match panel.motion {
        Motion::Swing([along, left], counter) => {
            let p = line.point(along, left);
            let axis = [0.0, 0.0, if counter { 1.0 } else { -1.0 }];
            let hinge_low = (along - panel.along[0]).abs() < GAP_M;
            ((true, [p.x, p.y, z[0]], axis, FRAC_PI_2), if hinge_low { free } else { -free })
        }
        Motion::Along(by) => {
            let sign = by.signum();
            let axis = [sign * line.yaw_rad.cos(), sign * line.yaw_rad.sin(), 0.0];
            ((false, closed.center_m, axis.map(exact), by.abs()), -sign * free)
        }
        Motion::Up => ((false, closed.center_m, [0.0, 0.0, 1.0], 2.0 * closed.half_m[2]), 0.0),
    };
    let (hinge, origin_m, axis, open) = joint;
    let [friction, damping] = if hinge { HINGE } else { ROLLERS };
    let id = ids.new_id(&name);
    SimLeaf {
        joint: SimJoint {
            id: ids.new_id(&format!("{id}_joint")),
            hinge,
            origin_m,
            axis,
            limits: [0.0, open],
            damping,
            friction,
        },
        id,
        closed,
        mass_kg: area * if matches!(panel.motion, Motion::Up) { CURTAIN_KG_M2 } else { LEAF_KG_M2 },
        balanced: matches!(panel.motion, Motion::Up),
        handles_m: handles(u),
    }
}

/// Returns 0, 1 or -1 for what the platform's sine nearly makes of it.
fn exact(v: f64) -> f64 {
    if (v - v.round()).abs() < 1e-12 { v.round() } else { v }
}

/// Returns the jambs beside the clear opening; those at a pocket leave the leaf through.
fn frame(door: &Door, line: &Line, floor: f64, [from, to]: [f64; 2]) -> Vec<SimBox> {
    if door.kind == DoorKind::Open {
        return Vec::new();
    }
    let half = door.wall_thickness_m / 2.0;
    let pocket = Pocket::of(door);
    let jamb = |along: [f64; 2]| -> Vec<SimBox> {
        let middle = (along[0] + along[1]) / 2.0;
        let slot = pocket.as_ref().filter(|p| p.along.iter().any(|a| a[0] < middle && middle < a[1]));
        let sides = match slot {
            Some(p) => vec![[-half, -p.half_m], [p.half_m, half]],
            None => vec![[-half, half]],
        };
        let z = [floor, floor + door.height_m];
        let sides = sides.into_iter().filter(|s| s[1] - s[0] > JAMB_M);
        sides.map(|left| SimBox::on(line, along, left, z)).collect()
    };
    let jambs = [[0.0, from], [to, line.length]];
    jambs.into_iter().filter(|j| j[1] - j[0] > JAMB_M).flat_map(jamb).collect()
}
