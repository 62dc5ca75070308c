//! Rooms from walls that are drawn as lines: what the lines, with the doors in their gaps, enclose; floors part them where no
//! wall is drawn.

use std::collections::BTreeMap;

use d3dgen_model::Point;
use d3dgen_model::scene_graph::Note;

use crate::cells::{Cells, Stretch, outline};
use crate::drawing::{DrawnOpening, OpeningKind, note};
use crate::shape::{Corner, point, polygon};
use crate::snap::Axis;

/// A space narrower than this in one direction is the inside of a wall drawn with two lines, mm.
const THIN: i64 = 400;
/// A door closes the gap in a wall line this close to it, mm.
const REACH: i64 = 250;
/// Gap between two wall ends that face each other, mm: an open passage where no door is drawn in it.
const PASSAGE: std::ops::RangeInclusive<i64> = 500..=2000;
/// Wall ends that face each other are this far apart across at most, mm.
const OFFSET: i64 = 150;
/// The edge of a floor this close to a wall is the wall, mm; a shorter wall (a step) only when it lies on it.
const ALONG_WALL: i64 = 600;
const LONG_WALL: i64 = 1000;
const ON_WALL: i64 = 20;
/// Shortest open side between two rooms, mm, and what is left of wall at its ends.
const OPEN_SIDE: i64 = 700;
const JAMB: i64 = 100;
/// A space with more open sides to outdoors than this share of its outline is no room.
const OPEN_SHARE: f64 = 0.4;
/// Part of a space that floor has to cover, where most spaces have floor.
const FLOORED: f64 = 0.3;
/// Shortest piece of wall that stands free, mm.
const LEAST_FREE_WALL: i64 = 300;
/// Largest closed shape of walls inside of a room that is a column and no room, mm^2.
const COLUMN: i64 = 1_000_000;
/// Most lines that are compared with one another.
const MOST_LINES: usize = 6000;

/// Lines on the lattice.
type Line = (Corner, Corner);

/// What the lines of a plan enclose.
pub(crate) struct Faces {
    /// The floor of each space, west to east and south to north.
    pub cells: Cells,
    pub count: usize,
    /// Passages that no door was drawn for: gaps between wall ends, and open sides between two floors.
    pub passages: Vec<DrawnOpening>,
    /// Lines of walls with the same room on both sides.
    pub free_walls: Vec<[Point; 2]>,
    /// Outlines of small shapes with one room all around: columns and walls drawn by their faces.
    pub standing: Vec<Vec<Point>>,
    pub notes: Vec<Note>,
}

/// A floor on the lattice: its outline, and whether it is a hole.
pub(crate) type FloorRing = (Vec<Corner>, bool);

/// Returns the enclosed spaces; `None` when there are too many lines.
pub(crate) fn faces(
    walls: &[[Point; 2]],
    openings: &[DrawnOpening],
    floors: &[FloorRing],
    xs: &Axis,
    ys: &Axis,
) -> Option<Faces> {
    let mut lines: Vec<Line> = walls.iter().filter_map(|w| on_lattice(w, xs, ys)).collect();
    if lines.len() > MOST_LINES {
        return None;
    }
    let drawn = lines.clone();
    let own = openings.iter().filter(|o| o.arc.is_none() && o.points.len() == 2).filter_map(|o| {
        let line = on_lattice(&[o.points[0], o.points[1]], xs, ys)?;
        (length(&line) >= 400).then_some(line)
    });
    let closings: Vec<Line> = openings.iter().flat_map(|o| closings(o, &lines)).chain(own).collect();
    lines.extend(closings);
    lines.extend(heal(&lines));
    let gaps = gaps(&lines);
    lines.extend(gaps.iter().flatten());
    let soft = soft(floors, &lines);
    let mut grid = Grid::new(&lines, &soft)?;
    let count = grid.flood();
    let (keep, notes) = grid.judge(count, floors);
    let mut names = vec![None; count];
    let mut next = 0;
    for (face, kept) in keep.iter().enumerate() {
        if *kept {
            names[face] = Some(next);
            next += 1;
        }
    }
    let standing = grid.standing(&mut names);
    let free_walls = grid.free_walls(&drawn, &names, &standing);
    for owner in &mut grid.cells.owner {
        *owner = owner.and_then(|face| names[face as usize]);
    }
    let standing = standing.into_values().map(|ring| polygon(&ring).0).collect();
    let mut passages: Vec<DrawnOpening> = gaps.iter().map(|g| passage(g[0], "gap between two walls")).collect();
    passages.extend(grid.open_sides().into_iter().map(|line| passage(line, "open side")));
    Some(Faces { cells: grid.cells, count: next as usize, passages, free_walls, standing, notes })
}

fn passage((a, b): Line, what: &str) -> DrawnOpening {
    let (a, b) = (point(a), point(b));
    DrawnOpening::new(OpeningKind::Passage, vec![a, b], None, what.into())
}

fn length((a, b): &Line) -> i64 {
    (a.0 - b.0).abs() + (a.1 - b.1).abs()
}

fn is_vertical((a, b): &Line) -> bool {
    a.0 == b.0
}

/// Returns where a line lies across its direction, and its two ends along it, ascending.
fn span(line: &Line) -> (i64, i64, i64) {
    let (a, b) = line;
    if is_vertical(line) { (a.0, a.1.min(b.1), a.1.max(b.1)) } else { (a.1, a.0.min(b.0), a.0.max(b.0)) }
}

fn line_of(vertical: bool, at: i64, from: i64, to: i64) -> Line {
    if vertical { ((at, from), (at, to)) } else { ((from, at), (to, at)) }
}

/// Returns a wall exactly along x or y, or `None` when nothing of it is left.
fn on_lattice([a, b]: &[Point; 2], xs: &Axis, ys: &Axis) -> Option<Line> {
    let (mut p, mut q) = ((xs.at(a.x), ys.at(a.y)), (xs.at(b.x), ys.at(b.y)));
    if (p.0 - q.0).abs() < (p.1 - q.1).abs() {
        let x = xs.at((a.x + b.x) / 2.0);
        (p.0, q.0) = (x, x);
    } else {
        let y = ys.at((a.y + b.y) / 2.0);
        (p.1, q.1) = (y, y);
    }
    (p != q).then_some((p, q))
}

/// Returns the ends of lines that no other line touches: the end, whether its line is vertical, and where it points.
fn loose_ends(lines: &[Line]) -> Vec<(Corner, bool, i64)> {
    let mut out = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        let vertical = is_vertical(line);
        let (at, from, to) = span(line);
        for (along, way) in [(from, -1), (to, 1)] {
            let end = line_of(vertical, at, along, along).0;
            let touched = lines.iter().enumerate().any(|(n, other)| {
                let (oat, ofrom, oto) = span(other);
                let (across, position) = if is_vertical(other) { (end.0, end.1) } else { (end.1, end.0) };
                n != k && across == oat && (ofrom..=oto).contains(&position)
            });
            if !touched {
                out.push((end, vertical, way));
            }
        }
    }
    out
}

/// Returns pieces that join loose ends to the wall that they just fail to reach.
fn heal(lines: &[Line]) -> Vec<Line> {
    let mut out = Vec::new();
    for (end, vertical, way) in loose_ends(lines) {
        let (across, along) = if vertical { end } else { (end.1, end.0) };
        let ahead = lines.iter().filter(|l| is_vertical(l) != vertical).filter_map(|l| {
            let (at, from, to) = span(l);
            let gap = (at - along) * way;
            ((from..=to).contains(&across) && gap > 0 && gap <= REACH).then_some((gap, at))
        });
        if let Some((_, at)) = ahead.min() {
            out.push(line_of(vertical, across, along, at));
        }
    }
    out
}

/// Returns the gaps between loose ends that face each other, each with the jog that joins them where they are a bit apart.
fn gaps(lines: &[Line]) -> Vec<Vec<Line>> {
    let ends = loose_ends(lines);
    let mut out = Vec::new();
    for (end, vertical, way) in ends.iter().filter(|e| e.2 > 0) {
        let turned = |c: &Corner| if *vertical { (c.0, c.1) } else { (c.1, c.0) };
        let (across, along) = turned(end);
        let facing = ends.iter().filter(|e| e.1 == *vertical && e.2 == -way).map(|e| turned(&e.0));
        let found = facing.filter(|(x, y)| (x - across).abs() <= OFFSET && PASSAGE.contains(&(y - along)));
        let Some((other, to)) = found.min_by_key(|(_, y)| *y) else { continue };
        let crossed = lines.iter().filter(|l| is_vertical(l) != *vertical).any(|l| {
            let (at, from, upto) = span(l);
            at > along && at < to && from <= across && upto >= across
        });
        if !crossed {
            let mut pieces = vec![line_of(*vertical, across, along, to)];
            if other != across {
                pieces.push(line_of(!vertical, to, across, other));
            }
            out.push(pieces);
        }
    }
    out
}

/// Returns the edges of floors where no wall runs along them, drawn out to the walls that they end at.
fn soft(floors: &[FloorRing], hard: &[Line]) -> Vec<Line> {
    let mut out = Vec::new();
    for (ring, _) in floors {
        let n = ring.len();
        for k in 0..n {
            let edge = (ring[k], ring[(k + 1) % n]);
            if edge.0 == edge.1 || edge.0.0 != edge.1.0 && edge.0.1 != edge.1.1 {
                continue;
            }
            let vertical = is_vertical(&edge);
            let (at, from, to) = span(&edge);
            let mut walls: Vec<(i64, i64)> = hard
                .iter()
                .filter(|l| is_vertical(l) == vertical)
                .map(span)
                .filter(|s| (s.0 - at).abs() <= if s.2 - s.1 >= LONG_WALL { ALONG_WALL } else { ON_WALL })
                .filter(|s| s.1 < to && s.2 > from)
                .map(|s| (s.1, s.2))
                .collect();
            walls.sort_unstable();
            walls.push((to, to));
            let mut start = from;
            for (a, b) in walls {
                if a > start {
                    out.push(drawn_out(vertical, at, start, a.min(to), hard));
                }
                start = start.max(b);
            }
        }
    }
    out.truncate(MOST_LINES);
    out
}

/// Returns a line whose ends reach the next wall across, where one is near.
fn drawn_out(vertical: bool, at: i64, from: i64, to: i64, hard: &[Line]) -> Line {
    let crossing =
        hard.iter().filter(|l| is_vertical(l) != vertical).map(span).filter(|s| s.1 - 50 <= at && at <= s.2 + 50);
    let near = |end: i64, low: i64, high: i64| {
        crossing
            .clone()
            .map(|s| s.0)
            .filter(|v| (low..=high).contains(v))
            .min_by_key(|v| (v - end).abs())
            .unwrap_or(end)
    };
    line_of(vertical, at, near(from, from - ALONG_WALL, from), near(to, to, to + ALONG_WALL))
}

/// The plane between the lines.
struct Grid {
    cells: Cells,
    /// Whether a wall stands west, or south, of a cell.
    west: Vec<bool>,
    south: Vec<bool>,
    /// The same for the edges of floors.
    soft_west: Vec<bool>,
    soft_south: Vec<bool>,
}

impl Grid {
    fn new(hard: &[Line], soft: &[Line]) -> Option<Self> {
        let coordinates = |pick: fn(&Corner) -> i64| {
            let mut list: Vec<i64> = hard.iter().chain(soft).flat_map(|(a, b)| [pick(a), pick(b)]).collect();
            let (least, most) = (list.iter().min().copied().unwrap_or(0), list.iter().max().copied().unwrap_or(0));
            list.extend([least - 1000, most + 1000]); // outdoors all around
            list
        };
        let cells = Cells::new(coordinates(|c| c.0), coordinates(|c| c.1))?;
        let empty = vec![false; cells.owner.len()];
        let (west, south) = marked(&cells, hard, &empty);
        let (soft_west, soft_south) = marked(&cells, soft, &empty);
        Some(Self { cells, west, south, soft_west, soft_south })
    }

    /// Numbers the spaces that lines enclose, outdoors first; returns how many.
    fn flood(&mut self) -> usize {
        let (columns, rows) = (self.cells.columns(), self.cells.rows());
        let blocked = |k: usize, west: bool| {
            if west { self.west[k] || self.soft_west[k] } else { self.south[k] || self.soft_south[k] }
        };
        let mut count = 0_u32;
        for start in 0..columns * rows {
            if self.cells.owner[start].is_some() {
                continue;
            }
            let mut todo = vec![start];
            self.cells.owner[start] = Some(count);
            while let Some(k) = todo.pop() {
                let (i, j) = (k % columns, k / columns);
                let ways = [
                    (i > 0 && !blocked(k, true), k.wrapping_sub(1)),
                    (i + 1 < columns && !blocked((k + 1).min(columns * rows - 1), true), k + 1),
                    (j > 0 && !blocked(k, false), k.wrapping_sub(columns)),
                    (j + 1 < rows && !blocked((k + columns).min(columns * rows - 1), false), k + columns),
                ];
                for (_, to) in ways.into_iter().filter(|w| w.0) {
                    if self.cells.owner[to].is_none() {
                        self.cells.owner[to] = Some(count);
                        todo.push(to);
                    }
                }
            }
            count += 1;
        }
        count as usize
    }

    /// Returns which spaces are rooms: not outdoors, not the inside of a wall, not open to outdoors, not without floor.
    fn judge(&self, count: usize, floors: &[FloorRing]) -> (Vec<bool>, Vec<Note>) {
        let mut by_face: Vec<Vec<_>> = vec![Vec::new(); count];
        for s in self.cells.stretches(|_, _, _| [0, 0]) {
            s.rooms().for_each(|r| by_face[r].push(s));
        }
        let (areas, floored) = self.floored(count, floors);
        let around = self.open_to_outdoors(count);
        let mut keep: Vec<bool> = (0..count)
            .map(|face| face > 0 && !outline(face, &by_face[face]).is_some_and(|ring| is_thin(&ring)))
            .collect();
        // where it is no simple outline it may be the inside of all walls together
        for face in 1..count {
            keep[face] &= areas[face] >= THIN * (around[face].0 / 2 - THIN).max(THIN);
        }
        let mut notes = Vec::new();
        let place = |face: usize| {
            let at = by_face[face].first().map_or((0, 0), |s| s.point(s.from));
            format!("({:.2}, {:.2}) m", at.0 as f64 / 1000.0, at.1 as f64 / 1000.0)
        };
        let kept = |keep: &[bool]| (1..count).filter(|f| keep[*f]).collect::<Vec<_>>();
        let total: i64 = kept(&keep).iter().map(|f| areas[*f]).sum();
        let covered: i64 = kept(&keep).iter().map(|f| floored[*f]).sum();
        for face in kept(&keep) {
            let bare = 2 * covered > total && (floored[face] as f64) < FLOORED * areas[face] as f64;
            if bare {
                keep[face] = false;
                let message =
                    format!("the space at {} is enclosed by walls and has no floor; it was left out", place(face));
                notes.push(note("no_floor", message));
            } else if around[face].1 as f64 > OPEN_SHARE * around[face].0 as f64 {
                keep[face] = false;
                let message = format!("the floor at {} is open to outdoors; it was left out", place(face));
                notes.push(note("open_floor", message));
            }
        }
        (keep, notes)
    }

    /// Returns area and area with floor of each space, mm^2.
    fn floored(&self, count: usize, floors: &[FloorRing]) -> (Vec<i64>, Vec<i64>) {
        let columns = self.cells.columns();
        let mut covered = vec![false; self.cells.owner.len()];
        for hole in [false, true] {
            for (ring, _) in floors.iter().filter(|f| f.1 == hole) {
                // floors have corners beyond the lines that were kept of their edges
                for (j, from, to) in self.cells.inside(ring) {
                    covered[j * columns + from.min(columns)..j * columns + to.min(columns)].fill(!hole);
                }
            }
        }
        let (mut areas, mut floored) = (vec![0; count], vec![0; count]);
        for (k, owner) in self.cells.owner.iter().enumerate() {
            let (i, j) = (k % columns, k / columns);
            let area = (self.cells.xs[i + 1] - self.cells.xs[i]) * (self.cells.ys[j + 1] - self.cells.ys[j]);
            if let Some(face) = owner.map(|f| f as usize) {
                areas[face] += area;
                floored[face] += if covered[k] { area } else { 0 };
            }
        }
        (areas, floored)
    }

    /// Returns the length of each space's outline, and of its part that only the edge of a floor parts from outdoors, mm.
    fn open_to_outdoors(&self, count: usize) -> Vec<(i64, i64)> {
        let mut out = vec![(0, 0); count];
        self.borders(|low, high, is_soft, _, length| {
            for (face, other) in [(low, high), (high, low)] {
                if let Some(face) = face {
                    out[face as usize].0 += length;
                    out[face as usize].1 += if is_soft && other == Some(0) { length } else { 0 };
                }
            }
        });
        out
    }

    /// Returns the cells behind and before a piece of a line: the `b`th along the `a`th line of a direction.
    fn sides(&self, vertical: bool, a: usize, b: usize) -> (usize, usize) {
        let columns = self.cells.columns();
        if vertical { (b * columns + a, b * columns + a - 1) } else { (a * columns + b, (a - 1) * columns + b) }
    }

    /// Calls with each piece of border: the owners on its sides, whether no wall stands on it, where it is and how long.
    fn borders(&self, mut each: impl FnMut(Option<u32>, Option<u32>, bool, (bool, i64, i64, i64), i64)) {
        let columns = self.cells.columns();
        for vertical in [true, false] {
            let (across, along) = if vertical { (columns, self.cells.rows()) } else { (self.cells.rows(), columns) };
            let (lines, marks) =
                if vertical { (&self.cells.xs, &self.cells.ys) } else { (&self.cells.ys, &self.cells.xs) };
            for (a, at) in lines.iter().copied().enumerate().take(across).skip(1) {
                for b in 0..along {
                    let (k, before) = self.sides(vertical, a, b);
                    let (low, high) = (self.cells.owner[before], self.cells.owner[k]);
                    if low != high {
                        let wall = if vertical { self.west[k] } else { self.south[k] };
                        each(low, high, !wall, (vertical, at, marks[b], marks[b + 1]), marks[b + 1] - marks[b]);
                    }
                }
            }
        }
    }

    /// Gives small spaces that are no rooms and have one room all around to that room; returns their outlines.
    fn standing(&self, names: &mut [Option<u32>]) -> BTreeMap<u32, Vec<Corner>> {
        let mut by_face: BTreeMap<u32, Vec<Stretch>> = BTreeMap::new();
        for s in self.cells.stretches(|_, _, _| [0, 0]) {
            s.rooms().filter(|face| *face > 0 && names[*face].is_none()).for_each(|face| {
                by_face.entry(face as u32).or_default().push(s);
            });
        }
        let mut out = BTreeMap::new();
        for (face, stretches) in by_face {
            let own = Some(face as usize);
            let mut around = stretches.iter().map(|s| if s.low == own { s.high } else { s.low });
            let Some(Some(room)) = around.next() else { continue };
            let (Some(name), true) = (names[room], around.all(|other| other == Some(room))) else { continue };
            if let Some(ring) = outline(face as usize, &stretches).filter(|ring| is_thin(ring) || is_small(ring)) {
                names[face as usize] = Some(name);
                out.insert(face, ring);
            }
        }
        out
    }

    /// Returns the drawn walls that have the same room on both sides and are no faces of what stands there.
    fn free_walls(
        &self,
        drawn: &[Line],
        names: &[Option<u32>],
        standing: &BTreeMap<u32, Vec<Corner>>,
    ) -> Vec<[Point; 2]> {
        let (west, south) = marked(&self.cells, drawn, &vec![false; self.cells.owner.len()]);
        let is_same_room = |k: usize, before: usize| {
            let owner = self.cells.owner[k].filter(|f| !standing.contains_key(f));
            owner == self.cells.owner[before] && owner.is_some_and(|f| names[f as usize].is_some())
        };
        let columns = self.cells.columns();
        let mut out = Vec::new();
        for vertical in [true, false] {
            let (across, along) = if vertical { (columns, self.cells.rows()) } else { (self.cells.rows(), columns) };
            let (lines, marks) =
                if vertical { (&self.cells.xs, &self.cells.ys) } else { (&self.cells.ys, &self.cells.xs) };
            for (a, at) in lines.iter().copied().enumerate().take(across).skip(1) {
                let mut run: Option<(i64, i64)> = None;
                for b in 0..=along {
                    let (k, before) = self.sides(vertical, a, b.min(along - 1));
                    let wall = if vertical { west[k] } else { south[k] };
                    let is_free = b < along && wall && is_same_room(k, before);
                    match &mut run {
                        Some(run) if is_free => run.1 = marks[b + 1],
                        _ if is_free => run = Some((marks[b], marks[b + 1])),
                        _ => {
                            let done = run.take().filter(|(from, to)| to - from >= LEAST_FREE_WALL);
                            out.extend(done.map(|(from, to)| {
                                let (p, q) = line_of(vertical, at, from, to);
                                [point(p), point(q)]
                            }));
                        }
                    }
                }
            }
        }
        out
    }

    /// Returns the sides between two rooms on which no wall stands.
    fn open_sides(&self) -> Vec<Line> {
        let mut runs: BTreeMap<_, Vec<(i64, i64)>> = BTreeMap::new();
        self.borders(|low, high, is_soft, (vertical, at, from, to), _| {
            if let (Some(a), Some(b), true) = (low, high, is_soft) {
                let list = runs.entry((a.min(b), a.max(b), vertical, at)).or_default();
                match list.last_mut().filter(|r| r.1 == from) {
                    Some(run) => run.1 = to,
                    None => list.push((from, to)),
                }
            }
        });
        let sides = runs.into_iter().flat_map(|((_, _, vertical, at), list)| {
            let long = list.into_iter().filter(|r| r.1 - r.0 >= OPEN_SIDE);
            long.map(move |(from, to)| line_of(vertical, at, from + JAMB, to - JAMB))
        });
        sides.collect()
    }
}

/// Returns which cells have one of the lines on their west, and on their south.
fn marked(cells: &Cells, lines: &[Line], empty: &[bool]) -> (Vec<bool>, Vec<bool>) {
    let columns = cells.columns();
    let (mut west, mut south) = (empty.to_vec(), empty.to_vec());
    let index = |list: &[i64], v: i64| list.partition_point(|o| *o < v);
    for (a, b) in lines {
        if a.0 == b.0 {
            let i = index(&cells.xs, a.0);
            for j in index(&cells.ys, a.1.min(b.1))..index(&cells.ys, a.1.max(b.1)) {
                west[j * columns + i] = true;
            }
        } else {
            let j = index(&cells.ys, a.1);
            for i in index(&cells.xs, a.0.min(b.0))..index(&cells.xs, a.0.max(b.0)) {
                south[j * columns + i] = true;
            }
        }
    }
    (west, south)
}

/// Returns true for a shape as small as a column.
fn is_small(ring: &[Corner]) -> bool {
    twice_area(ring) / 2 <= COLUMN
}

/// Returns twice the area of an outline, mm^2.
fn twice_area(ring: &[Corner]) -> i64 {
    let n = ring.len();
    (0..n).map(|k| (ring[k].0 * ring[(k + 1) % n].1) - (ring[k].1 * ring[(k + 1) % n].0)).sum::<i64>().abs()
}

/// Returns true for the inside of a wall: a long thin box, or one whose area a strip of that width would have.
fn is_thin(ring: &[Corner]) -> bool {
    let n = ring.len();
    let edge = |k: usize| (ring[k], ring[(k + 1) % n]);
    let area = twice_area(ring) / 2;
    let around: i64 = (0..n).map(|k| (edge(k).0.0 - edge(k).1.0).abs() + (edge(k).0.1 - edge(k).1.1).abs()).sum();
    area < THIN * (around / 2 - THIN).max(THIN)
}

/// Returns the lines with which an opening closes the gap in the wall it is drawn in: one for each face of a wall of two lines.
fn closings(opening: &DrawnOpening, lines: &[Line]) -> Vec<Line> {
    let points: Vec<Point> = if let Some([hinge, ..]) = opening.arc { vec![hinge] } else { opening.points.clone() };
    let mm = |v: f64| (v * 1000.0).round() as i64;
    let range = |pick: fn(&Point) -> f64| {
        let list = points.iter().map(|p| mm(pick(p)));
        list.clone().min().zip(list.max())
    };
    let (Some((x0, x1)), Some((y0, y1))) = (range(|p| p.x), range(|p| p.y)) else { return Vec::new() };
    let (mx, my) = ((x0 + x1) / 2, (y0 + y1) / 2);
    // the nearest ends of two collinear walls with the opening's middle between them
    let gap = |vertical: bool| -> Vec<Line> {
        let (middle, across) = if vertical { (my, mx) } else { (mx, my) };
        let near: Vec<(i64, i64, i64)> = lines
            .iter()
            .filter(|l| is_vertical(l) == vertical)
            .map(span)
            .filter(|p| (p.0 - across).abs() <= REACH)
            .collect();
        let mut faces: Vec<i64> = near.iter().map(|p| p.0).collect();
        faces.sort_by_key(|at| ((at - across).abs(), *at));
        faces.dedup();
        let slack = 50;
        let close = |at: i64| {
            let on = near.iter().filter(|p| p.0 == at);
            let before = on.clone().filter(|p| p.2 <= middle + slack).map(|p| p.2).max()?;
            let after = on.filter(|p| p.1 >= middle - slack).map(|p| p.1).min()?;
            (after > before && after - before <= 4000).then(|| line_of(vertical, at, before, after))
        };
        let Some(first) = faces.first().copied().and_then(close) else { return Vec::new() };
        // the other face of the same wall has a gap of the same width
        let same = |l: &Line| (length(l) - length(&first)).abs() <= REACH;
        faces.iter().skip(1).filter_map(|at| close(*at)).filter(same).chain([first]).collect()
    };
    let wide = x1 - x0 >= y1 - y0;
    let found = gap(!wide);
    if found.is_empty() { gap(wide) } else { found }
}
