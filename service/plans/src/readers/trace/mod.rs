//! Rooms and doors out of the free cells of an occupancy map: what stands about is taken away, gaps between wall ends are
//! doors, what they part are rooms, and furniture against walls is filled up to the line of the wall.
//!
//! Everything is counted in cells, row 0 in the south; what a cell measures is only known by `cells_of`.

mod rooms;
mod standing;
mod walls;

use std::collections::BTreeMap;

use rooms::{fill, loops, notches, outdoors, part, smooth};
use walls::{openings, take_away, upright};

/// Widest door, m.
pub(in crate::readers) const DOOR_M: f64 = 1.75;
/// Thickest wall, m; ends of walls beside doors are up to twice as thick as most walls of the map.
const WALL_M: f64 = 0.45;
/// Least floor of a room, m^2.
const LEAST_ROOM_M2: f64 = 1.0;

/// A corner in cells.
pub(in crate::readers) type At = (i64, i64);

/// How a map was turned before rooms were looked for: about one point, onto another, in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::readers) struct Turn {
    pub angle_rad: f64,
    from: (f64, f64),
    to: (f64, f64),
}

impl Turn {
    /// Returns where a place of the turned map lies on the map as it was.
    pub fn back(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (sin, cos) = self.angle_rad.sin_cos();
        let (x, y) = (x - self.to.0, y - self.to.1);
        (self.from.0 + x * cos - y * sin, self.from.1 + x * sin + y * cos)
    }
}

/// What was found.
#[derive(Debug, Default)]
pub(in crate::readers) struct Found {
    /// Outlines of each room, the outer one first and counter-clockwise, then its holes.
    pub rooms: Vec<Vec<Vec<At>>>,
    /// Gaps in walls.
    pub gaps: Vec<Gap>,
    /// Things that were taken away.
    pub things: usize,
    /// Outlines of walls that stand free in a room.
    pub standing: Vec<Vec<At>>,
    /// Floor between what was seen that was never scanned, m^2.
    pub unscanned_m2: f64,
    /// How the map was turned, when its walls do not run along its rows and columns; everything is on the turned map.
    pub turn: Option<Turn>,
}

/// A door or open passage.
#[derive(Debug, Clone)]
pub(in crate::readers) struct Gap {
    /// Ends in cells.
    pub ends: [(f64, f64); 2],
    /// Rooms it joins, or `None` for outdoors.
    pub rooms: [Option<usize>; 2],
}

/// A map of cells that are free or not.
#[derive(Debug, Clone)]
pub(in crate::readers) struct Map {
    pub width: usize,
    pub height: usize,
    pub free: Vec<bool>,
    /// Cells that nobody has seen; none of them is free.
    pub unknown: Vec<bool>,
    /// Cells of one meter.
    pub per_meter: f64,
}

/// A gap in a wall while rooms are looked for.
struct Opening {
    /// True when the wall runs along x.
    along_x: bool,
    cells: Vec<usize>,
}

impl Map {
    fn cells_of(&self, meters: f64) -> usize {
        (meters * self.per_meter).round().max(1.0) as usize
    }

    fn area_of(&self, m2: f64) -> usize {
        (m2 * self.per_meter * self.per_meter).round().max(1.0) as usize
    }

    /// Returns the cells beside a cell, with the diagonal ones when asked.
    fn around(&self, k: usize, diagonal: bool) -> impl Iterator<Item = usize> + use<> {
        const WAYS: [(i64, i64); 8] = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
        let (w, h) = (self.width as i64, self.height as i64);
        let (i, j) = ((k % self.width) as i64, (k / self.width) as i64);
        WAYS.into_iter().take(if diagonal { 8 } else { 4 }).filter_map(move |(di, dj)| {
            let (x, y) = (i + di, j + dj);
            (x >= 0 && y >= 0 && x < w && y < h).then_some((y * w + x) as usize)
        })
    }

    /// Returns the connected groups of cells that a test takes.
    fn groups(&self, diagonal: bool, takes: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
        self.alike(diagonal, |k| takes(k).then_some(()))
    }

    /// Returns the connected groups of cells of one kind; those of no kind are in none.
    fn alike<T: PartialEq>(&self, diagonal: bool, kind: impl Fn(usize) -> Option<T>) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.width * self.height];
        let mut out = Vec::new();
        for start in 0..seen.len() {
            let Some(own) = kind(start).filter(|_| !seen[start]) else { continue };
            seen[start] = true;
            let mut group = vec![start];
            let mut next = 0;
            while next < group.len() {
                let k = group[next];
                next += 1;
                for n in self.around(k, diagonal) {
                    if !seen[n] && kind(n).as_ref() == Some(&own) {
                        seen[n] = true;
                        group.push(n);
                    }
                }
            }
            out.push(group);
        }
        out
    }

    /// Returns least and greatest column and row of cells.
    fn bounds(&self, cells: &[usize]) -> (usize, usize, usize, usize) {
        cells.iter().fold((usize::MAX, 0, usize::MAX, 0), |b, k| {
            let (i, j) = (k % self.width, k / self.width);
            (b.0.min(i), b.1.max(i), b.2.min(j), b.3.max(j))
        })
    }

    /// Returns how many cells in a direction, this one included, are alike (free or not).
    fn run(&self, k: usize, step: (i64, i64), most: usize) -> usize {
        let (mut i, mut j) = ((k % self.width) as i64, (k / self.width) as i64);
        let what = self.free[k];
        let mut count = 0;
        while i >= 0 && j >= 0 && i < self.width as i64 && j < self.height as i64 && count < most {
            if self.free[j as usize * self.width + i as usize] != what {
                break;
            }
            count += 1;
            (i, j) = (i + step.0, j + step.1);
        }
        count
    }
}

/// Finds the rooms of a map.
pub(in crate::readers) fn trace(map: Map) -> Found {
    let (mut map, turn) = upright(map);
    let unscanned_m2 = standing::unscanned_m2(&map);
    let (things, mut walls) = take_away(&mut map);
    let openings = openings(&map);
    let (mut labels, openings) = part(&map, openings);
    walls.extend(standing::take(&mut map, &mut labels));
    let count = labels.iter().flatten().max().map_or(0, |m| m + 1);
    let outdoors = outdoors(&map, &labels, count);
    let mut wide = smooth(&map, &labels);
    let notches = notches(&map, &wide, count, outdoors);
    notches.iter().flat_map(|(_, o)| &o.cells).for_each(|k| wide[*k] = None);
    // what is too narrow to walk in is no floor when recesses are filled, or a notch would make its room larger
    for (free, (was, is)) in map.free.iter_mut().zip(labels.iter().zip(&wide)) {
        *free &= was.is_none() || is.is_some();
    }
    let shapes = smooth(&map, &fill(&map, &wide, count));
    let mut found = Found { things, standing: walls, unscanned_m2, turn, ..Found::default() };
    let mut number: Vec<Option<usize>> = vec![None; count];
    for (room, loops) in loops(&map, &shapes, count).into_iter().enumerate() {
        if Some(room) != outdoors && !loops.is_empty() {
            number[room] = Some(found.rooms.len());
            found.rooms.push(loops);
        }
    }
    for opening in &openings {
        let [a, b] = sides(&map, &labels, opening);
        let rooms = [a, b].map(|side| side.and_then(|room| number[room]));
        if rooms.iter().any(Option::is_some) {
            found.gaps.push(Gap { ends: ends(&map, opening), rooms });
        }
    }
    let notch = |(room, o): (usize, Opening)| Some(Gap { ends: ends(&map, &o), rooms: [Some(number[room]?), None] });
    found.gaps.extend(notches.into_iter().filter_map(notch));
    found
}

/// Returns the rooms on the two sides of a gap.
fn sides(map: &Map, labels: &[Option<usize>], opening: &Opening) -> [Option<usize>; 2] {
    let step = if opening.along_x { map.width } else { 1 };
    let mut counts: [BTreeMap<usize, usize>; 2] = [BTreeMap::new(), BTreeMap::new()];
    for &k in &opening.cells {
        for (side, n) in [k.checked_sub(step), k.checked_add(step)].into_iter().enumerate() {
            if let Some(room) = n.and_then(|n| labels.get(n).copied()).flatten() {
                *counts[side].entry(room).or_default() += 1;
            }
        }
    }
    counts.map(|c| c.into_iter().max_by_key(|(room, n)| (*n, usize::MAX - room)).map(|c| c.0))
}

/// Returns the line of a gap through the middle of its wall.
fn ends(map: &Map, opening: &Opening) -> [(f64, f64); 2] {
    let (x0, x1, y0, y1) = map.bounds(&opening.cells);
    let middle = |a: usize, b: usize| (a + b + 1) as f64 / 2.0;
    if opening.along_x {
        [(x0 as f64, middle(y0, y1)), ((x1 + 1) as f64, middle(y0, y1))]
    } else {
        [(middle(x0, x1), y0 as f64), (middle(x0, x1), (y1 + 1) as f64)]
    }
}
