//! Floors, walls, doors and windows.

use d3dgen_model::TOLERANCE_M;
use d3dgen_model::courts::Court;
use d3dgen_model::domain::{Domain, Zone};
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan, Slide, Wall, Window};
use d3dgen_model::geometry::{Point, Polygon, Rect, Segment};

use super::page::{Anchor, Frame, Page, Path, on_sheet};
use super::{style, ways};

/// Thickness of a door leaf as drawn, m.
const LEAF_M: f64 = 0.045;
/// Width of the pocket in a wall that a sliding leaf goes into, as drawn, m.
const POCKET_M: f64 = 0.06;

/// Tints every room by the part of the building it belongs to.
pub(super) fn floors(page: &mut Page, frame: &Frame, plan: &Floorplan, domain: &Domain) {
    page.open_group("floors");
    for room in &plan.rooms {
        let zone = domain.room_type_or_generic(&room.room_type).zone;
        let fill = format!("fill=\"{}\"", style::tint(zone));
        page.path_with(&fill, Path::new().polygon(&on_sheet(frame, &room.polygon)));
    }
    let fill = format!("fill=\"{}\"", style::tint(Zone::Outdoor));
    for rect in courts(plan).iter().flat_map(|c| &c.rects) {
        page.path_with(&fill, Path::new().rect(&frame.rect(rect)));
    }
    page.close_group();
}

/// Least width of a court that is drawn, m: less is a gap between walls that somebody drew.
const COURT_M: f64 = 2.0;

/// Returns the courts of a plan that are drawn and named.
pub(super) fn courts(plan: &Floorplan) -> Vec<Court> {
    let is_wide = |c: &Court| c.bounds().width().min(c.bounds().height()) >= COURT_M;
    plan.courts().into_iter().filter(is_wide).collect()
}

/// Width in which the railings of balconies and terraces are drawn, m.
const RAILING_M: f64 = 0.08;

/// Returns true for a room outdoors: what encloses it there is a railing, no wall.
fn is_outdoor(room_id: &str, plan: &Floorplan, domain: &Domain) -> bool {
    plan.room(room_id).is_some_and(|r| domain.room_type_or_generic(&r.room_type).zone == Zone::Outdoor)
}

/// Draws walls as one dark body with a darker edge, and railings as what they are.
pub(super) fn walls(page: &mut Page, frame: &Frame, plan: &Floorplan, domain: &Domain) {
    page.open_group("walls");
    let railing = |w: &&Wall| w.exterior && w.room_ids.iter().all(|id| is_outdoor(id, plan, domain));
    let (railings, walls): (Vec<&Wall>, Vec<&Wall>) = plan.walls.iter().partition(railing);
    let drawn = |outlines: Vec<Polygon>, path: Path| {
        outlines.iter().fold(path, |path, outline| path.polygon(&on_sheet(frame, outline)))
    };
    let body = drawn(walls.iter().map(|w| wall_body(w, plan)).collect(), Path::new());
    let posts = drawn(railings.iter().map(|w| self::body(w, plan, RAILING_M / 2.0)).collect(), Path::new());
    let panels = plan.windows.iter().filter(|w| is_outdoor(&w.room_id, plan, domain)).fold(posts, |path, window| {
        let o = Opening::new(window.line, RAILING_M, |_| true);
        path.polygon(&o.corners([0.0, o.length], [-o.half, o.half], frame))
    });
    page.path("rl", panels);
    // The edge of every piece first, the bodies over it: what stays visible is the edge of their union.
    let standing = plan.obstacles.iter().map(|o| on_sheet(frame, &o.outline));
    let body = standing.fold(body, |path, outline| path.polygon(&outline));
    page.path("wo", body.clone());
    page.path("w", body);
    page.close_group();
}

/// Returns the outline of a wall piece, its ends drawn into the corners, but not into openings.
pub(super) fn wall_body(wall: &Wall, plan: &Floorplan) -> Polygon {
    body(wall, plan, wall.thickness_m / 2.0)
}

/// Returns what stands on the line of a wall, so wide to both sides, its ends drawn into the corners but not into openings.
fn body(wall: &Wall, plan: &Floorplan, half: f64) -> Polygon {
    let o = Opening::new(wall.line, 2.0 * half, |_| true);
    let reach = |along: f64| if is_at(plan, &wall.line, o.at(along, 0.0)) { 0.0 } else { half };
    let (from, to) = (-reach(0.0), o.length + reach(o.length));
    let corners = [(from, -half), (to, -half), (to, half), (from, half)];
    Polygon(corners.map(|(along, across)| o.at(along, across)).to_vec())
}

/// Returns true where the end of a wall is that of a door or window in it.
pub(super) fn is_at(plan: &Floorplan, wall: &Segment, end: Point) -> bool {
    let openings = plan.doors.iter().map(|d| &d.line).chain(plan.windows.iter().map(|w| &w.line));
    let along = |line: &Segment| {
        let (dx, dy) = (line.end.x - line.start.x, line.end.y - line.start.y);
        let (wx, wy) = (wall.end.x - wall.start.x, wall.end.y - wall.start.y);
        (dx * wy - dy * wx).abs() < 0.01 * line.length() * wall.length()
    };
    openings.into_iter().any(|o| (o.start.distance(end) < TOLERANCE_M || o.end.distance(end) < TOLERANCE_M) && along(o))
}

/// A straight opening with its own axes: `t` along the wall, `n` across it.
pub(super) struct Opening {
    line: Segment,
    t: (f64, f64),
    pub n: (f64, f64),
    /// Along the wall, m.
    pub length: f64,
    /// Half the thickness of the wall, m.
    pub half: f64,
}

impl Opening {
    /// `into` tells the side that `n` points to.
    pub fn new(line: Segment, thickness: f64, into: impl Fn(Point) -> bool) -> Self {
        let length = line.length().max(TOLERANCE_M);
        let t = ((line.end.x - line.start.x) / length, (line.end.y - line.start.y) / length);
        let (m, probe) = (line.middle(), thickness / 2.0 + 0.05);
        let n = (-t.1, t.0);
        let n = if into(Point::new(m.x + n.0 * probe, m.y + n.1 * probe)) { n } else { (-n.0, -n.1) };
        Self { line, t, n, length, half: thickness / 2.0 }
    }

    /// Returns the point `along` from the start and `across` from the center line.
    pub fn at(&self, along: f64, across: f64) -> Point {
        let s = self.line.start;
        Point::new(s.x + self.t.0 * along + self.n.0 * across, s.y + self.t.1 * along + self.n.1 * across)
    }

    fn corners(&self, along: [f64; 2], across: [f64; 2], frame: &Frame) -> [(f64, f64); 4] {
        let [a, b] = along;
        let [c, d] = across;
        [(a, c), (b, c), (b, d), (a, d)].map(|(x, y)| frame.map(self.at(x, y)))
    }

    fn quad(&self, along: [f64; 2], across: [f64; 2], frame: &Frame) -> Path {
        Path::new().polygon(&self.corners(along, across, frame))
    }
}

/// Draws windows: the faces of the wall and the pane between them.
pub(super) fn windows(page: &mut Page, frame: &Frame, plan: &Floorplan, domain: &Domain) {
    page.open_group("windows");
    for window in plan.windows.iter().filter(|w| !is_outdoor(&w.room_id, plan, domain)) {
        draw_window(page, frame, window);
    }
    page.close_group();
}

fn draw_window(page: &mut Page, frame: &Frame, window: &Window) {
    let o = Opening::new(window.line, window.wall_thickness_m, |_| true);
    page.path("n", o.quad([0.0, o.length], [-o.half, o.half], frame));
    for across in [-0.18, 0.18] {
        let ends = [0.0, o.length].map(|along| frame.map(o.at(along, across * o.half)));
        page.path("nf", Path::new().segment(ends[0], ends[1]));
    }
}

/// Draws doors with leaves and swings, sliding panels and open passages.
pub(super) fn doors(page: &mut Page, frame: &Frame, plan: &Floorplan) {
    page.open_group("doors");
    for door in plan.doors.iter().filter(|d| !ways::is_between_pieces(plan, d)) {
        draw_door(page, frame, plan, door);
    }
    page.close_group();
}

pub(super) fn opening_of(door: &Door, plan: &Floorplan) -> Opening {
    let into = door.swing.as_ref().and_then(|s| s.into_room_id.as_deref());
    let inside = |p: Point| plan.rooms.iter().any(|r| r.polygon.contains(p));
    Opening::new(door.line, door.wall_thickness_m, |p| match (into, door.swing.is_some()) {
        (Some(id), _) => plan.room(id).is_some_and(|r| r.polygon.contains(p)),
        (None, true) => !inside(p),
        (None, false) => inside(p),
    })
}

fn draw_door(page: &mut Page, frame: &Frame, plan: &Floorplan, door: &Door) {
    let o = opening_of(door, plan);
    let hinge_at_start = door.swing.as_ref().is_none_or(|s| s.hinge_at_start);
    match door.kind {
        DoorKind::Hinged if hinge_at_start => leaf(page, frame, &o, 0.0, 1.0, o.length),
        DoorKind::Hinged => leaf(page, frame, &o, o.length, -1.0, o.length),
        DoorKind::DoubleHinged => {
            leaf(page, frame, &o, 0.0, 1.0, o.length / 2.0);
            leaf(page, frame, &o, o.length, -1.0, o.length / 2.0);
        }
        DoorKind::Sliding => sliding(page, frame, &o, door),
        DoorKind::Open => {
            for across in [-o.half, o.half] {
                let ends = [0.0, o.length].map(|along| frame.map(o.at(along, across)));
                page.path("do", Path::new().segment(ends[0], ends[1]));
            }
        }
    }
}

/// One leaf, open at a right angle, hinged `along` the wall and closing in direction `sign`.
fn leaf(page: &mut Page, frame: &Frame, o: &Opening, along: f64, sign: f64, length: f64) {
    let at = |along_by: f64, out: f64| frame.map(o.at(along + sign * along_by, o.half + out));
    let k = 0.5523 * length;
    page.path("da", Path::new().to(at(0.0, length)).cubic(at(k, length), at(length, k), at(length, 0.0)));
    page.path("dl", Path::new().polygon(&[at(0.0, 0.0), at(0.0, length), at(LEAF_M, length), at(LEAF_M, 0.0)]));
}

/// A sliding door half open, along the wall as shares of the opening.
struct Panels {
    /// Where its pockets run.
    pockets: &'static [[f64; 2]],
    /// Where its leaves are, and how far off the middle of the wall, in their thickness.
    leaves: &'static [([f64; 2], f64)],
}

impl Panels {
    fn of(slide: Option<Slide>) -> Self {
        match slide {
            Some(Slide::BeyondStart) => Self { pockets: &[[-1.0, 0.0]], leaves: &[([-0.4, 0.6], 0.0)] },
            Some(Slide::BeyondEnd) => Self { pockets: &[[1.0, 2.0]], leaves: &[([0.4, 1.4], 0.0)] },
            Some(Slide::Apart) => {
                Self { pockets: &[[-0.5, 0.0], [1.0, 1.5]], leaves: &[([-0.2, 0.3], 0.0), ([0.7, 1.2], 0.0)] }
            }
            Some(Slide::StackedBeyondStart) => {
                Self { pockets: &[[-0.5, 0.0]], leaves: &[([-0.1, 0.4], -0.5), ([0.2, 0.7], 0.5)] }
            }
            Some(Slide::StackedBeyondEnd) => {
                Self { pockets: &[[1.0, 1.5]], leaves: &[([0.3, 0.8], -0.5), ([0.6, 1.1], 0.5)] }
            }
            Some(Slide::Up) | None => Self { pockets: &[], leaves: &[([0.0, 1.0], 0.0)] },
        }
    }
}

/// Leaves half drawn back, and the pockets in the wall that they go into; doors that open by themselves have dark leaves.
fn sliding(page: &mut Page, frame: &Frame, o: &Opening, door: &Door) {
    for across in [-o.half, o.half] {
        let ends = [0.0, o.length].map(|along| frame.map(o.at(along, across)));
        page.path("da", Path::new().segment(ends[0], ends[1]));
    }
    let Panels { pockets, leaves } = Panels::of(door.slide);
    let pocket = o.half.min(POCKET_M / 2.0);
    // beyond the opening, what is clear of it counts: the frame stays in front of the leaf
    let along = |share: f64| match share {
        s if s < 0.0 => s * door.clear_width_m,
        s if s > 1.0 => o.length + (s - 1.0) * door.clear_width_m,
        s => s * o.length,
    };
    for ends in pockets {
        page.path("dp", o.quad(ends.map(along), [-pocket, pocket], frame));
    }
    let class = if door.automatic { "dx" } else { "dl" };
    for (ends, off) in leaves {
        let middle = off * LEAF_M;
        let across = [middle - LEAF_M / 2.0, middle + LEAF_M / 2.0];
        page.path(class, o.quad(ends.map(along), across, frame));
    }
}

/// Returns the floor that leaves sweep, on the sheet, for the labels to avoid.
pub(super) fn swings(frame: &Frame, plan: &Floorplan) -> Vec<Rect> {
    plan.doors
        .iter()
        .filter(|d| d.swing.is_some())
        .map(|d| {
            let o = opening_of(d, plan);
            let reach = if d.kind == DoorKind::DoubleHinged { o.length / 2.0 } else { o.length };
            let (a, b) = (o.at(0.0, o.half), o.at(o.length, o.half + reach));
            frame.rect(&Rect::new(a.x, a.y, b.x, b.y))
        })
        .collect()
}

/// Returns how far the widest leaf opens to the outside, m.
pub(super) fn outward_reach(plan: &Floorplan) -> f64 {
    plan.doors
        .iter()
        .filter(|d| d.swing.as_ref().is_some_and(|s| s.into_room_id.is_none()))
        .map(|d| if d.kind == DoorKind::DoubleHinged { d.line.length() / 2.0 } else { d.line.length() })
        .fold(0.0, f64::max)
}

/// Marks the ways in and out with an arrow; the main entrance is filled and named.
pub(super) fn entrances(page: &mut Page, frame: &Frame, plan: &Floorplan, size: f64) {
    page.open_group("entrances");
    for door in plan.ways_out() {
        let Some(room) = door.room_ids.first().and_then(|id| plan.room(id)) else { continue };
        let o = Opening::new(door.line, door.wall_thickness_m, |p| !room.polygon.contains(p));
        let outward = door.swing.as_ref().is_some_and(|s| s.into_room_id.is_none());
        let reach = if !outward {
            0.0
        } else if door.kind == DoorKind::DoubleHinged {
            o.length / 2.0
        } else {
            o.length
        };
        let unit = size / frame.scale;
        let (tip, tail, middle) = (o.half + reach + 0.45 * unit, o.half + reach + 1.35 * unit, o.length / 2.0);
        let at = |along: f64, across: f64| frame.map(o.at(along, across));
        let arrow = [at(middle, tip), at(middle - 0.55 * unit, tail), at(middle + 0.55 * unit, tail)];
        page.path(if door.entrance { "ea" } else { "ex" }, Path::new().polygon(&arrow));
        // ambulances and trucks come in by gates, which slide; they are called after their room
        let label = match door.kind {
            _ if door.entrance => "Entrance",
            DoorKind::Sliding => room.name.as_str(),
            _ => "Exit",
        };
        let (x, y) = at(middle, tail + 0.35 * unit);
        let (nx, ny) = (o.n.0, -o.n.1);
        let (anchor, y) = if nx > 0.5 {
            (Anchor::Start, y + 0.35 * size)
        } else if nx < -0.5 {
            (Anchor::End, y + 0.35 * size)
        } else {
            (Anchor::Middle, if ny > 0.0 { y + 0.75 * size } else { y })
        };
        page.text(label, (x, y), size * 0.9, style::SMALL, anchor);
    }
    page.close_group();
}

/// Returns the rectangle around the outer faces of all walls, m.
pub(super) fn outer_bounds(plan: &Floorplan) -> Rect {
    plan.walls
        .iter()
        .map(|w| wall_body(w, plan).bounds())
        .chain(plan.rooms.iter().map(|r| r.polygon.bounds()))
        .reduce(|a, b| a.union(&b))
        .unwrap_or(Rect::new(0.0, 0.0, 1.0, 1.0))
}

/// Sides of the building, as seen on the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sides<T> {
    pub west: T,
    pub east: T,
    pub north: T,
    pub south: T,
}

impl Sides<f64> {
    /// Returns the larger of both on each side.
    pub fn max(self, other: Self) -> Self {
        Self {
            west: self.west.max(other.west),
            east: self.east.max(other.east),
            north: self.north.max(other.north),
            south: self.south.max(other.south),
        }
    }
}

/// Returns on which sides of the building there are ways in or out.
pub(super) fn entrance_sides(plan: &Floorplan, around: &Rect) -> Sides<bool> {
    let mut sides = Sides { west: false, east: false, north: false, south: false };
    for line in plan.ways_out().into_iter().map(|d| d.line) {
        let (m, c) = (line.middle(), around.center());
        match (line.is_vertical(), m.x < c.x, m.y < c.y) {
            (true, true, _) => sides.west = true,
            (true, false, _) => sides.east = true,
            (false, _, true) => sides.south = true,
            (false, _, false) => sides.north = true,
        }
    }
    sides
}
