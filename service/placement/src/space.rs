//! An empty room as the search sees it: net outline, wall sides with their openings, floor that doors need.

use std::cmp::Reverse;

use d3dgen_knowledge::freespace::FreeSpace;
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, PlanRoom};
use d3dgen_model::geometry::{Polygon, Rect, Segment};
use d3dgen_model::way_in::way_in;

use super::geom::{Box2, Solid, mm, turn};

/// Floor kept free in front of every door over its width, mm.
const DOOR_DEPTH: i32 = 600;
/// The same before sliding doors where the room has the space: a leaf that swings would keep as much free.
const SLIDING_DEPTH: i32 = 900;
/// Wall beside the latch of a door that people in wheelchairs open, mm (18 in, ADA 404.2.4).
const LATCH_SIDE: i32 = 457;
/// How far from a wall something counts as standing in front of its window, mm.
const WINDOW_DEPTH: i32 = 300;
/// The same where the room has the space: what measures of finished worlds look at.
const WINDOW_DEPTH_OPEN: i32 = 500;

/// One straight side of the net outline, in the frame of an object with its back to it: `u` forward into the room,
/// `v` to the object's left; both are world coordinates turned back by `q` quarters.
#[derive(Debug, Clone)]
pub(crate) struct WallSide {
    /// Heading of the normal into the room.
    pub q: u8,
    /// Position of the wall face along the normal, mm.
    pub u: i32,
    /// Extent along the wall, mm.
    pub v0: i32,
    pub v1: i32,
    /// True when the room goes around the corner at that end (an inner corner one can push things into).
    pub corner0: bool,
    pub corner1: bool,
}

impl WallSide {
    pub fn length(&self) -> i32 {
        self.v1 - self.v0
    }

    /// Returns the rectangle from `depth0` to `depth1` in front of the wall over `v0..v1`, in the world.
    pub fn strip(&self, v0: i32, v1: i32, depth0: i32, depth1: i32) -> Box2 {
        Box2::new(self.u + depth0, v0, self.u + depth1, v1).turned(self.q)
    }
}

/// A door seen from the room.
#[derive(Debug, Clone)]
pub(crate) struct DoorZone {
    pub id: String,
    pub wall: usize,
    /// Opening along the wall, mm.
    pub v0: i32,
    pub v1: i32,
    pub height: i32,
    /// Floor to keep free, with the swing when the leaf opens into the room.
    pub zone: Box2,
    /// The same as deep as a leaf is wide whichever way it opens.
    pub open_zone: Box2,
    /// The same as deep as one comes through with ease, whether the leaf swings or slides.
    deep_zone: Box2,
    /// True when its leaf opens into the room.
    pub swings_in: bool,
    /// Side of the latch along the wall: `Some(true)` at `v1`.
    pub latch_high: Option<bool>,
    /// How good it is as "the door" of the room, 0 for the entrance.
    pub rank: u8,
    /// Clear width, mm.
    pub clear_width: i32,
    /// True for openings without a leaf: the room and what lies before it are in sight of each other.
    pub open: bool,
    /// True for doors of rooms with steam.
    pub wet: bool,
}

impl DoorZone {
    /// Returns the floor that is kept free.
    pub fn kept(&self, open: Open) -> &Box2 {
        match open {
            Open { deep: true, .. } => &self.deep_zone,
            Open { doors: true, .. } => &self.open_zone,
            _ => &self.zone,
        }
    }
}

/// A window seen from the room.
#[derive(Debug, Clone)]
pub(crate) struct WindowZone {
    pub wall: usize,
    pub v0: i32,
    pub v1: i32,
    pub sill: i32,
    pub head: i32,
    /// Floor over which nothing may stand higher than the sill.
    pub zone: Box2,
    /// The same as deep as nothing should.
    pub open_zone: Box2,
}

/// How much is kept free before doors and windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Open {
    /// On both sides of a door as much as its leaf is wide; otherwise what it needs.
    pub doors: bool,
    /// Before sliding doors as much as a leaf that swings would take.
    pub deep: bool,
    /// Half a meter before windows; otherwise what takes their light.
    pub windows: bool,
}

impl WindowZone {
    /// Returns true when something at this place takes light.
    pub fn is_hidden_by(&self, solid: &Solid) -> bool {
        solid.z1 > self.sill && solid.z0 < self.head && self.zone.overlaps(&solid.rect)
    }

    /// Returns the floor above which nothing stands in the light.
    pub fn kept(&self, open: Open) -> &Box2 {
        if open.windows { &self.open_zone } else { &self.zone }
    }

    /// Returns true for what reaches above the sill and begins below the head.
    pub fn is_as_high(&self, solid: &Solid) -> bool {
        solid.z1 > self.sill && solid.z0 < self.head
    }

    /// Returns true when something at this place stands in what is kept free.
    pub fn is_taken_by(&self, solid: &Solid, open: Open) -> bool {
        self.is_as_high(solid) && self.kept(open).overlaps(&solid.rect)
    }
}

/// A room without furniture.
#[derive(Debug, Clone)]
pub(crate) struct Space {
    pub bounds: Box2,
    /// Largest rectangle inside the outline.
    pub main: Box2,
    pub walls: Vec<WallSide>,
    pub doors: Vec<DoorZone>,
    pub windows: Vec<WindowZone>,
    pub ceiling: i32,
    /// Rectangles inside the bounds that are no floor: outside the outline, under columns and walls that stand free.
    holes: Vec<Box2>,
    /// Rectangles that cover the floor.
    floor: Vec<Box2>,
    /// Floor by which many come in.
    lanes: Vec<Box2>,
}

/// Returns how good a door is as "the door" of a room: entrance, other way out, to the room with the entrance, to
/// circulation, other.
fn rank(plan: &Floorplan, room: &PlanRoom, door: &Door) -> u8 {
    let other = door.room_ids.iter().find(|id| *id != &room.room_id);
    match other {
        _ if door.entrance => 0,
        None if plan.ways_out().iter().any(|d| d.door_id == door.door_id) => 1,
        Some(id) if plan.doors_of(id).any(|d| d.entrance) => 2,
        Some(id) if plan.room(id).is_some_and(|r| r.circulation) => 3,
        Some(_) | None => 4,
    }
}

impl Space {
    /// Returns the room of a plan; doors and windows that touch none of its walls are left out.
    pub fn new(plan: &Floorplan, room: &PlanRoom) -> Self {
        let corners: Vec<(i32, i32)> = room.net_polygon.corners().iter().map(|p| (mm(p.x), mm(p.y))).collect();
        let bounds = Box2::from_rect(&room.net_polygon.bounds());
        let walls = wall_sides(&corners);
        let taken = plan.taken_in(&room.room_id);
        let standing: Vec<Box2> = taken.iter().map(Box2::from_rect).collect();
        let mut holes = holes(bounds, &corners);
        holes.extend(&standing);
        let mut floor: Vec<Box2> = room.net_polygon.rects().iter().map(Box2::from_rect).collect();
        for column in &standing {
            floor = floor.iter().flat_map(|f| f.without(column)).collect();
        }
        let mut out = Self {
            bounds,
            main: largest_rectangle(&room.net_polygon, &taken).unwrap_or(bounds),
            walls,
            doors: Vec::new(),
            windows: Vec::new(),
            ceiling: mm(room.ceiling_height_m),
            holes,
            floor,
            lanes: Vec::new(),
        };
        for door in plan.doors_of(&room.room_id) {
            if let Some((wall, v0, v1)) = out.locate(&door.line, door.wall_thickness_m) {
                let swings_in =
                    door.swing.as_ref().is_some_and(|s| s.into_room_id.as_deref() == Some(room.room_id.as_str()));
                let [zone, open_zone, deep_zone] = door_zones(&out.walls[wall], v0, v1, door.kind, swings_in);
                let latch_high = latch(&out.walls[wall], door);
                let rank = rank(plan, room, door);
                out.doors.push(DoorZone {
                    id: door.door_id.clone(),
                    wall,
                    v0,
                    v1,
                    height: mm(door.height_m),
                    zone,
                    open_zone,
                    deep_zone,
                    swings_in,
                    latch_high,
                    rank,
                    clear_width: mm(door.clear_width_m),
                    open: door.kind == DoorKind::Open,
                    wet: false,
                });
            }
        }
        out.doors.sort_by_key(|d| d.rank);
        for window in plan.windows.iter().filter(|w| w.room_id == room.room_id) {
            if let Some((wall, v0, v1)) = out.locate(&window.line, window.wall_thickness_m) {
                let zone = out.walls[wall].strip(v0, v1, 0, WINDOW_DEPTH);
                let open_zone = out.walls[wall].strip(v0, v1, 0, WINDOW_DEPTH_OPEN);
                let (sill, head) = (mm(window.sill_m), mm(window.head_m));
                out.windows.push(WindowZone { wall, v0, v1, sill, head, zone, open_zone });
            }
        }
        out
    }

    /// Keeps the way in from the doors free, to where the room is wide.
    pub fn keep_way_in(&mut self, plan: &Floorplan, room: &PlanRoom) {
        let ways = plan.doors_of(&room.room_id).flat_map(|door| way_in(&room.net_polygon, door));
        self.lanes = ways.map(|r| Box2::from_rect(&r)).collect();
    }

    /// Returns the floor by which many come in.
    pub fn lanes(&self, open: Open) -> &[Box2] {
        if open.doors { &self.lanes } else { &[] }
    }

    /// Widens what doors should have by the wall beside their latches, for people in wheelchairs.
    pub fn keep_latch_sides(&mut self) {
        for door in &mut self.doors {
            let (Some(high), wall) = (door.latch_high, &self.walls[door.wall]) else { continue };
            let back = (4 - wall.q) % 4;
            for kept in [&mut door.open_zone, &mut door.deep_zone] {
                let mut zone = kept.turned(back);
                if high {
                    zone.y1 = (zone.y1 + LATCH_SIDE).min(wall.v1).max(zone.y1);
                } else {
                    zone.y0 = (zone.y0 - LATCH_SIDE).max(wall.v0).min(zone.y0);
                }
                *kept = zone.turned(wall.q);
            }
        }
    }

    /// Returns true when the rectangle lies on the net floor.
    pub fn contains(&self, r: &Box2) -> bool {
        self.bounds.contains(r) && !self.holes.iter().any(|h| h.overlaps(r))
    }

    /// Returns rectangles that together cover the net floor.
    pub fn floor_rects(&self) -> &[Box2] {
        &self.floor
    }

    /// Returns rectangles inside the bounds that are no floor.
    pub fn holes(&self) -> &[Box2] {
        &self.holes
    }

    /// Returns the windows of one wall.
    pub fn windows_of(&self, wall: usize) -> impl Iterator<Item = &WindowZone> {
        self.windows.iter().filter(move |w| w.wall == wall)
    }

    /// Finds the wall side that carries an opening, and the opening's extent along it.
    fn locate(&self, line: &Segment, thickness_m: f64) -> Option<(usize, i32, i32)> {
        let (a, b) = ((mm(line.start.x), mm(line.start.y)), (mm(line.end.x), mm(line.end.y)));
        let reach = mm(thickness_m / 2.0) + 60;
        let mut best: Option<(i32, usize, i32, i32)> = None;
        for (i, wall) in self.walls.iter().enumerate() {
            let (ua, va) = turn(4 - wall.q, a.0, a.1);
            let (ub, vb) = turn(4 - wall.q, b.0, b.1);
            let (v0, v1) = (va.min(vb), va.max(vb));
            let shared = v1.min(wall.v1) - v0.max(wall.v0);
            let off = wall.u - ua; // the center line lies behind the face
            let better = best.is_none_or(|(s, ..)| shared > s);
            if ua == ub && (-20..=reach).contains(&off) && 2 * shared > v1 - v0 && better {
                best = Some((shared, i, v0, v1));
            }
        }
        best.map(|(_, i, v0, v1)| (i, v0, v1))
    }
}

/// Returns the largest free rectangle of an outline, of equal ones the westernmost; `None` without floor.
fn largest_rectangle(outline: &Polygon, taken: &[Rect]) -> Option<Box2> {
    let rects = FreeSpace::new(outline, taken).rects;
    rects.iter().map(Box2::from_rect).max_by_key(|r| (r.area(), Reverse((r.x0, r.x1, r.y0, r.y1))))
}

fn wall_sides(corners: &[(i32, i32)]) -> Vec<WallSide> {
    let n = corners.len();
    let heading = |i: usize| -> u8 {
        let (a, b) = (corners[i % n], corners[(i + 1) % n]);
        match ((b.0 - a.0).signum(), (b.1 - a.1).signum()) {
            (1, _) => 0,
            (-1, _) => 2,
            (_, 1) => 1,
            _ => 3,
        }
    };
    (0..n)
        .map(|i| {
            let (along, before, after) = (heading(i), heading(i + n - 1), heading(i + 1));
            // counter-clockwise outline: the room lies to the left of each edge
            let q = (along + 1) % 4;
            let (ua, va) = turn(4 - q, corners[i].0, corners[i].1);
            let (_, vb) = turn(4 - q, corners[(i + 1) % n].0, corners[(i + 1) % n].1);
            // `v` runs against the edge, so the edge's end is the low end; a left turn is an inner corner
            let (corner0, corner1) = (after == (along + 1) % 4, along == (before + 1) % 4);
            WallSide { q, u: ua, v0: vb.min(va), v1: vb.max(va), corner0, corner1 }
        })
        .collect()
}

fn holes(bounds: Box2, corners: &[(i32, i32)]) -> Vec<Box2> {
    let mut ys: Vec<i32> = corners.iter().map(|c| c.1).collect();
    ys.sort_unstable();
    ys.dedup();
    let mut out = Vec::new();
    for pair in ys.windows(2) {
        let mut xs: Vec<i32> = (0..corners.len())
            .filter_map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                let crosses = a.1.min(b.1) <= pair[0] && a.1.max(b.1) >= pair[1];
                (a.0 == b.0 && crosses).then_some(a.0)
            })
            .collect();
        xs.sort_unstable();
        let mut from = bounds.x0;
        for span in xs.chunks_exact(2) {
            if span[0] > from {
                out.push(Box2 { x0: from, y0: pair[0], x1: span[0], y1: pair[1] });
            }
            from = span[1];
        }
        if from < bounds.x1 {
            out.push(Box2 { x0: from, y0: pair[0], x1: bounds.x1, y1: pair[1] });
        }
    }
    out
}

/// Returns the floor a door needs, that as deep as its leaf is wide, and that which lets one in with ease.
fn door_zones(wall: &WallSide, v0: i32, v1: i32, kind: DoorKind, swings_in: bool) -> [Box2; 3] {
    let leaf = match kind {
        DoorKind::Hinged => v1 - v0,
        DoorKind::DoubleHinged => (v1 - v0 + 1) / 2,
        DoorKind::Sliding | DoorKind::Open => 0,
    };
    let deep = |depth: i32| wall.strip(v0, v1, 0, depth);
    let open = deep(leaf.max(DOOR_DEPTH));
    let needed = if swings_in { open } else { deep(DOOR_DEPTH) };
    [needed, open, if kind == DoorKind::Sliding { deep(SLIDING_DEPTH) } else { open }]
}

fn latch(wall: &WallSide, door: &Door) -> Option<bool> {
    let swing = door.swing.as_ref()?;
    if door.kind == DoorKind::DoubleHinged {
        return None;
    }
    let latch = if swing.hinge_at_start { door.line.end } else { door.line.start };
    let hinge = if swing.hinge_at_start { door.line.start } else { door.line.end };
    let along = |p: d3dgen_model::Point| turn(4 - wall.q, mm(p.x), mm(p.y)).1;
    Some(along(latch) > along(hinge))
}
