//! Walls as boxes: corners closed, openings and the pockets of sliding leaves really cut; at any angle.

use d3dgen_model::TOLERANCE_M;
use d3dgen_model::floorplan::{Door, DoorKind, Wall, Window};
use d3dgen_model::geometry::{Point, Segment};

use super::doors::Pocket;
use super::ids::Ids;
use super::{CEILING_M, FLOOR_M, Place, SimBox, SimDoor, SimPiece, SimShape, SimWall, SimWindow, WallPart, convex};

/// Lines with less of an angle between them than this have the same direction (sine).
const SAME_DIRECTION: f64 = 0.01;
/// Shortest piece of wall, m.
const LEAST_M: f64 = 0.001;
/// Thinnest skin beside a pocket, m.
const SKIN_M: f64 = 0.005;
/// Depth and width of a window's frame, m.
const FRAME_M: [f64; 2] = [0.07, 0.05];
/// Thickness of its pane: two of 4 mm with 16 mm between them, m.
const GLASS_M: f64 = 0.024;

/// A line on the floor with its direction and what is left of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    start: Point,
    direction: [f64; 2],
    pub length: f64,
    pub yaw_rad: f64,
}

impl Line {
    pub fn of(segment: &Segment) -> Self {
        let (dx, dy) = (segment.end.x - segment.start.x, segment.end.y - segment.start.y);
        let length = dx.hypot(dy).max(1e-9);
        Self { start: segment.start, direction: [dx / length, dy / length], length, yaw_rad: dy.atan2(dx) }
    }

    /// Returns the point so far along it and so far to its left.
    pub fn point(&self, along: f64, left: f64) -> Point {
        let [x, y] = self.direction;
        Point::new(self.start.x + x * along - y * left, self.start.y + y * along + x * left)
    }

    /// Returns how far along it and to its left a point is.
    pub fn place(&self, p: Point) -> [f64; 2] {
        let ([x, y], dx, dy) = (self.direction, p.x - self.start.x, p.y - self.start.y);
        [dx * x + dy * y, dy * x - dx * y]
    }

    /// Returns the sine of the angle to another line.
    fn sine(&self, other: &Self) -> f64 {
        self.direction[0] * other.direction[1] - self.direction[1] * other.direction[0]
    }

    /// Returns where another line lies along this one, in order; none when it lies beside it.
    fn span(&self, other: &Segment) -> Option<[f64; 2]> {
        let [[a, left], [b, right]] = [self.place(other.start), self.place(other.end)];
        (left.abs() < TOLERANCE_M && right.abs() < TOLERANCE_M).then_some([a.min(b), a.max(b)])
    }
}

/// A piece of a wall's line, or the opening in it.
struct Stretch {
    line: Line,
    segment: Segment,
    thickness: f64,
    level: i32,
}

/// What is taken out of a wall: along it, and between two heights above the floor, m.
struct Hole {
    along: [f64; 2],
    z: [f64; 2],
    /// Half the width of a pocket; none where the wall is open through and through.
    slot: Option<f64>,
}

/// Returns all walls of a world: the pieces of the plan, what is above doors, columns.
pub(super) fn all(place: &Place<'_>, doors: &[SimDoor], ids: &mut Ids) -> Vec<SimWall> {
    let plan = &place.world.floorplan;
    let stretches: Vec<Stretch> = plan
        .walls
        .iter()
        .map(|w| (w.line, w.thickness_m, &w.room_ids))
        .chain(plan.doors.iter().map(|d| (d.line, d.wall_thickness_m, &d.room_ids)))
        .map(|(segment, thickness, rooms)| Stretch {
            line: Line::of(&segment),
            segment,
            thickness,
            level: rooms.first().map_or(0, |r| place.level(r)),
        })
        .collect();
    let pockets: Vec<(i32, Pocket)> =
        plan.doors.iter().zip(doors).filter_map(|(d, own)| Some((own.level, Pocket::of(d)?))).collect();
    let mut out: Vec<SimWall> = Vec::new();
    for (i, wall) in plan.walls.iter().enumerate() {
        let level = stretches[i].level;
        let ends = [end(&stretches, i, true), end(&stretches, i, false)];
        let mut holes: Vec<Hole> =
            plan.windows.iter().filter_map(|w| window_hole(place, w, level, &stretches[i].line)).collect();
        holes.extend(pockets.iter().filter(|p| p.0 == level).flat_map(|p| p.1.holes(&stretches[i].line)));
        out.push(one(place, wall, level, ends, &holes, ids));
    }
    out.extend(plan.doors.iter().zip(doors).filter_map(|(door, own)| lintel(place, door, own, ids)));
    out.extend(plan.windows.iter().filter_map(|window| around_window(place, window, ids)));
    out.extend(columns(place, ids));
    out.retain(|wall| !wall.pieces.is_empty());
    out
}

/// Returns how far a wall goes beyond one of its ends (less than 0: ends before it), so that corners are closed and nothing
/// lies in two walls at once.
fn end(stretches: &[Stretch], i: usize, at_start: bool) -> f64 {
    let own = &stretches[i];
    let p = if at_start { own.segment.start } else { own.segment.end };
    let mut goes_on = false;
    let mut meeting: Vec<(usize, bool)> = Vec::new(); // another wall, and whether it passes
    for (j, other) in stretches.iter().enumerate().filter(|(j, s)| *j != i && s.level == own.level) {
        let [along, left] = other.line.place(p);
        if left.abs() > TOLERANCE_M || along < -TOLERANCE_M || along > other.line.length + TOLERANCE_M {
            continue;
        }
        let inside = along > TOLERANCE_M && along < other.line.length - TOLERANCE_M;
        if own.line.sine(&other.line).abs() < SAME_DIRECTION {
            goes_on |= !inside;
        } else {
            meeting.push((j, inside));
        }
    }
    let passes = |&(j, inside): &(usize, bool)| {
        inside
            || meeting.iter().any(|&(k, _)| k != j && stretches[j].line.sine(&stretches[k].line).abs() < SAME_DIRECTION)
    };
    let widest = |list: &[(usize, bool)]| list.iter().map(|m| stretches[m.0].thickness).fold(0.0, f64::max) / 2.0;
    let square = |j: usize| own.line.sine(&stretches[j].line).abs() > 1.0 - SAME_DIRECTION;
    let passing: Vec<(usize, bool)> = meeting.iter().copied().filter(passes).collect();
    match (passing.is_empty(), goes_on, meeting.as_slice()) {
        // A crossing: the wall of the least number goes through, the pieces of the other end at its faces.
        (false, true, _) if passing.iter().all(|m| m.0 > i) => 0.0,
        (false, ..) => -widest(&passing),
        (true, true, _) | (true, false, []) => 0.0,
        // A corner: one wall has it, the other ends at its face.
        (true, false, [(j, _)]) if square(*j) => {
            let half = stretches[*j].thickness / 2.0;
            if i < *j { half } else { -half }
        }
        (true, false, list) => widest(list),
    }
}

fn window_hole(place: &Place<'_>, window: &Window, level: i32, line: &Line) -> Option<Hole> {
    let along = line.span(&window.line).filter(|_| place.level(&window.room_id) == level)?;
    Some(Hole { along, z: [window.sill_m, window.head_m], slot: None })
}

fn one(
    place: &Place<'_>,
    wall: &Wall,
    level: i32,
    [before, after]: [f64; 2],
    holes: &[Hole],
    ids: &mut Ids,
) -> SimWall {
    let line = Line::of(&wall.line);
    let whole = [-before, line.length + after];
    let (floor, top) = (place.storey(level).elevation_m, top(place, &wall.room_ids, level));
    // The face of an outer wall goes down to the underside of the slab.
    let low = if wall.exterior { -FLOOR_M } else { 0.0 };
    let shape = |along: [f64; 2], left: [f64; 2], z: [f64; 2]| {
        SimShape::Box(SimBox::on(&line, along, left, z.map(|z| floor + z)))
    };
    let half = wall.thickness_m / 2.0;
    let mut pieces = Vec::new();
    let mut add = |part: WallPart, along: [f64; 2], left: [f64; 2], z: [f64; 2]| {
        if along[1] - along[0] > LEAST_M && z[1] - z[0] > LEAST_M {
            pieces.push(SimPiece { part, shape: shape(along, left, z) });
        }
    };
    for (along, open) in cut(whole, holes) {
        let mut z = low;
        for hole in &open {
            add(if z == low { WallPart::Sill } else { WallPart::Lintel }, along, [-half, half], [z, hole.z[0]]);
            let skin = hole.slot.filter(|slot| half - slot > SKIN_M);
            let between = [hole.z[0].max(low), hole.z[1].min(top)];
            for sides in skin.map(|slot| [[-half, -slot], [slot, half]]).into_iter().flatten() {
                add(WallPart::Skin, along, sides, between);
            }
            z = z.max(hole.z[1]);
        }
        add(if open.is_empty() { WallPart::Pier } else { WallPart::Lintel }, along, [-half, half], [z, top]);
    }
    SimWall {
        id: ids.new_id(&wall.wall_id),
        level,
        room_ids: wall.room_ids.clone(),
        exterior: wall.exterior,
        material: material(place, &wall.room_ids),
        pieces,
    }
}

/// Returns the stretches of a wall with the holes in each, from the floor up; where two overlap, what is open through and
/// through counts.
fn cut(whole: [f64; 2], holes: &[Hole]) -> Vec<([f64; 2], Vec<&Hole>)> {
    let inside = |at: &f64| *at > whole[0] + LEAST_M && *at < whole[1] - LEAST_M;
    let mut ends: Vec<f64> = holes.iter().flat_map(|h| h.along).filter(inside).chain(whole).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < LEAST_M);
    let open = |middle: f64| {
        let mut open: Vec<&Hole> = holes.iter().filter(|h| h.along[0] < middle && middle < h.along[1]).collect();
        open.sort_by(|a, b| a.slot.is_some().cmp(&b.slot.is_some()));
        let mut kept: Vec<&Hole> = Vec::new();
        for hole in open {
            if kept.iter().all(|k| k.z[1] <= hole.z[0] || hole.z[1] <= k.z[0]) {
                kept.push(hole);
            }
        }
        kept.sort_by(|a, b| a.z[0].total_cmp(&b.z[0]));
        kept
    };
    ends.windows(2).map(|e| ([e[0], e[1]], open((e[0] + e[1]) / 2.0))).collect()
}

/// Returns the height of a wall between rooms above their floor, m: to the ceiling of the higher one, and up to the slab of
/// the storey above where there is one.
fn top(place: &Place<'_>, room_ids: &[String], level: i32) -> f64 {
    let rooms = room_ids.iter().filter_map(|id| place.world.floorplan.room(id));
    let ceiling = rooms.map(|r| r.ceiling_height_m).fold(0.0, f64::max) + CEILING_M;
    let highest = place.storeys.iter().all(|s| s.level <= level);
    if highest { ceiling } else { ceiling.max(place.storey(level).height_m - FLOOR_M) }
}

fn material(place: &Place<'_>, room_ids: &[String]) -> String {
    let rooms = room_ids.iter().filter_map(|id| place.world.floorplan.room(id));
    rooms.map(|r| r.materials.wall.clone()).next().unwrap_or_default()
}

/// Returns the wall above a door.
fn lintel(place: &Place<'_>, door: &Door, own: &SimDoor, ids: &mut Ids) -> Option<SimWall> {
    let (floor, top) = (place.storey(own.level).elevation_m, top(place, &door.room_ids, own.level));
    let line = Line::of(&door.line);
    let half = door.wall_thickness_m / 2.0;
    let exterior = door.room_ids.len() == 1;
    let mut pieces = Vec::new();
    let mut add = |part, z: [f64; 2]| {
        let shape = SimShape::Box(SimBox::on(&line, [0.0, line.length], [-half, half], z.map(|z| floor + z)));
        pieces.push(SimPiece { part, shape });
    };
    if top - door.height_m > LEAST_M {
        add(WallPart::Lintel, [door.height_m, top]);
    }
    if exterior {
        add(WallPart::Sill, [-FLOOR_M, 0.0]);
    }
    (!pieces.is_empty()).then(|| SimWall {
        id: ids.new_id(&format!("{}_lintel", door.door_id)),
        level: own.level,
        room_ids: door.room_ids.clone(),
        exterior,
        material: material(place, &door.room_ids),
        pieces,
    })
}

/// Returns the wall below and above a window that no wall of the plan runs through.
fn around_window(place: &Place<'_>, window: &Window, ids: &mut Ids) -> Option<SimWall> {
    let level = place.level(&window.room_id);
    let line = Line::of(&window.line);
    let covers = |wall: &&Wall| {
        let here = wall.room_ids.first().is_some_and(|r| place.level(r) == level);
        let span = line.span(&wall.line).filter(|_| here);
        span.is_some_and(|[a, b]| a < line.length / 2.0 && line.length / 2.0 < b)
    };
    if place.world.floorplan.walls.iter().any(|w| covers(&w)) {
        return None;
    }
    let room_ids = vec![window.room_id.clone()];
    let (floor, top) = (place.storey(level).elevation_m, top(place, &room_ids, level));
    let half = window.wall_thickness_m / 2.0;
    let piece = |part, z: [f64; 2]| {
        let shape = SimShape::Box(SimBox::on(&line, [0.0, line.length], [-half, half], z.map(|z| floor + z)));
        (z[1] - z[0] > LEAST_M).then_some(SimPiece { part, shape })
    };
    let below = piece(WallPart::Sill, [-FLOOR_M, window.sill_m]);
    let above = piece(WallPart::Lintel, [window.head_m, top]);
    Some(SimWall {
        id: ids.new_id(&format!("{}_wall", window.window_id)),
        level,
        exterior: true,
        material: material(place, &room_ids),
        room_ids,
        pieces: below.into_iter().chain(above).collect(),
    })
}

/// Returns columns and walls that stand free.
fn columns(place: &Place<'_>, ids: &mut Ids) -> Vec<SimWall> {
    let column = |o: &d3dgen_model::floorplan::FixedObstacle, id: String| {
        let (level, room_ids) = (place.level(&o.room_id), vec![o.room_id.clone()]);
        let floor = place.storey(level).elevation_m;
        let z_m = [floor, floor + top(place, &room_ids, level)];
        let pieces = convex::pieces(&o.outline).into_iter();
        let pieces =
            pieces.map(|outline| SimPiece { part: WallPart::Column, shape: super::floors::solid(outline, z_m) });
        SimWall { id, level, exterior: false, material: material(place, &room_ids), pieces: pieces.collect(), room_ids }
    };
    place.world.floorplan.obstacles.iter().map(|o| column(o, ids.new_id(&o.obstacle_id))).collect()
}

/// Returns the windows with their panes and frames.
pub(super) fn windows(place: &Place<'_>, ids: &mut Ids) -> Vec<SimWindow> {
    let one = |window: &Window, id: String| {
        let level = place.level(&window.room_id);
        let line = Line::of(&window.line);
        let floor = place.storey(level).elevation_m;
        let [depth, wide] = FRAME_M;
        let (low, high, length) = (floor + window.sill_m, floor + window.head_m, line.length);
        let bar = |along, z| SimBox::on(&line, along, [-depth / 2.0, depth / 2.0], z);
        SimWindow {
            id,
            level,
            room_id: window.room_id.clone(),
            glass: SimBox::on(&line, [wide, length - wide], [-GLASS_M / 2.0, GLASS_M / 2.0], [low + wide, high - wide]),
            frame: vec![
                bar([0.0, wide], [low, high]),
                bar([length - wide, length], [low, high]),
                bar([wide, length - wide], [low, low + wide]),
                bar([wide, length - wide], [high - wide, high]),
            ],
        }
    };
    place.world.floorplan.windows.iter().map(|w| one(w, ids.new_id(&w.window_id))).collect()
}

impl Pocket {
    /// Returns what is taken out of a wall on this line for the leaves of a sliding door.
    fn holes(&self, wall: &Line) -> Vec<Hole> {
        let hole = |along: &[f64; 2]| {
            let [a, b] = along.map(|at| self.line.point(at, 0.0));
            let along = wall.span(&Segment { start: a, end: b })?;
            Some(Hole { along, z: [0.0, self.top_m], slot: Some(self.half_m) })
        };
        self.along.iter().filter_map(hole).collect()
    }
}

/// Returns true for a door whose leaf goes into the wall beside it.
pub(super) fn has_pocket(door: &Door) -> bool {
    door.kind == DoorKind::Sliding && door.room_ids.len() > 1 && door.slide != Some(d3dgen_model::floorplan::Slide::Up)
}
