//! Rooms and doors out of the free cells of an occupancy map: what stands about is taken away, gaps between wall ends are
//! doors, what they part are rooms, and furniture against walls is filled up to the line of the wall.
//!
//! Everything is counted in cells, row 0 in the south; what a cell measures is only known by `cells_of`.

use std::collections::BTreeMap;

/// Narrowest gap between two wall ends that is a door, m; the widest door; the widest opening at all.
const NARROWEST_M: f64 = 0.65;
pub(super) const DOOR_M: f64 = 1.75;
const WIDEST_M: f64 = 4.5;
/// Thickest wall, m; ends of walls beside doors are up to twice as thick as most walls of the map.
const WALL_M: f64 = 0.45;
/// Shortest wall that ends at a gap, m; one of the two at a door may be shorter.
const STUB_M: f64 = 0.1;
/// Longest side of something that stands free and is no part of the walls, m.
const FURNITURE_M: f64 = 2.5;
/// The same for solid blocks; and the widest solid block of any length (a row of shelves).
const BLOCK_M: f64 = 4.5;
const ROW_M: f64 = 1.6;
/// Longest and largest recess that is taken for furniture along a wall, m and m^2.
const RECESS_M: f64 = 4.0;
const RECESS_M2: f64 = 3.0;
/// Least floor of a room, m^2.
const LEAST_ROOM_M2: f64 = 1.0;
/// Parts of a room narrower than this are no floor, m.
const NOISE_M: f64 = 0.3;
/// Shallowest and deepest notch in an outer wall that is the place of a door, m.
const SHALLOW_M: f64 = 0.1;
const NOTCH_M: f64 = 0.4;
/// Most of a wall that is notches; more are the gaps between things that stand there.
const NOTCHED: f64 = 0.4;
/// An unparted hole in a room up to this size is something that stands there, m^2.
const HOLE_M2: f64 = 1.0;

/// Most cells by which the direction of walls is found; the least turn, degrees; and how much clearer walls have to be by it.
const MOST_POINTS: usize = 20_000;
const LEAST_TURN: f64 = 0.3;
const SHARPER: f64 = 1.1;

/// A corner in cells.
pub(super) type At = (i64, i64);

/// How a map was turned before rooms were looked for: about one point, onto another, in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
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
pub(super) struct Found {
    /// Outlines of each room, the outer one first and counter-clockwise, then its holes.
    pub rooms: Vec<Vec<Vec<At>>>,
    /// Gaps in walls.
    pub gaps: Vec<Gap>,
    /// Things that were taken away.
    pub things: usize,
    /// How the map was turned, when its walls do not run along its rows and columns; everything is on the turned map.
    pub turn: Option<Turn>,
}

/// A door or open passage.
#[derive(Debug, Clone)]
pub(super) struct Gap {
    /// Ends in cells.
    pub ends: [(f64, f64); 2],
    /// Rooms it joins, or `None` for outdoors.
    pub rooms: [Option<usize>; 2],
}

/// A map of cells that are free or not.
#[derive(Debug, Clone)]
pub(super) struct Map {
    pub width: usize,
    pub height: usize,
    pub free: Vec<bool>,
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
        let mut seen = vec![false; self.width * self.height];
        let mut out = Vec::new();
        for start in 0..seen.len() {
            if seen[start] || !takes(start) {
                continue;
            }
            seen[start] = true;
            let mut group = vec![start];
            let mut next = 0;
            while next < group.len() {
                let k = group[next];
                next += 1;
                for n in self.around(k, diagonal) {
                    if !seen[n] && takes(n) {
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
pub(super) fn trace(map: Map) -> Found {
    let (mut map, turn) = upright(map);
    let things = take_away(&mut map);
    let openings = openings(&map);
    let (labels, openings) = part(&map, openings);
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
    let mut found = Found { things, turn, ..Found::default() };
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
    for (room, opening) in notches {
        if let Some(room) = number[room] {
            found.gaps.push(Gap { ends: ends(&map, &opening), rooms: [Some(room), None] });
        }
    }
    found
}

/// Returns a map whose walls run along its rows and columns, and how it was turned for that.
fn upright(map: Map) -> (Map, Option<Turn>) {
    let Some(angle_rad) = main_angle(&map) else { return (map, None) };
    let (w, h) = (map.width as f64, map.height as f64);
    let (sin, cos) = angle_rad.sin_cos();
    let (width, height) = (w * cos.abs() + h * sin.abs(), w * sin.abs() + h * cos.abs());
    let turn = Turn { angle_rad, from: (w / 2.0, h / 2.0), to: (width.ceil() / 2.0, height.ceil() / 2.0) };
    let (width, height) = (width.ceil() as usize, height.ceil() as usize);
    let is_free = |x: f64, y: f64| {
        let (i, j) = (x.floor(), y.floor());
        i >= 0.0 && j >= 0.0 && i < w && j < h && map.free[j as usize * map.width + i as usize]
    };
    // a wall one cell thick has to stay whole: a cell is free when it is so all around its middle
    let sure = |i: usize, j: usize| {
        [(0.3, 0.3), (0.7, 0.3), (0.3, 0.7), (0.7, 0.7)].into_iter().all(|(dx, dy)| {
            let (x, y) = turn.back((i as f64 + dx, j as f64 + dy));
            is_free(x, y)
        })
    };
    let free = (0..width * height).map(|k| sure(k % width, k / width)).collect();
    (Map { width, height, free, per_meter: map.per_meter }, Some(turn))
}

/// Returns the direction of most walls, rad, when it is not that of rows and columns: the one in which their cells fall
/// into the fewest lines.
fn main_angle(map: &Map) -> Option<f64> {
    let edge = |k: &usize| !map.free[*k] && map.around(*k, false).any(|n| map.free[n]);
    let edges: Vec<usize> = (0..map.free.len()).filter(edge).collect();
    let step = edges.len() / MOST_POINTS + 1;
    let points: Vec<(f64, f64)> =
        edges.iter().step_by(step).map(|k| ((k % map.width) as f64, (k / map.width) as f64)).collect();
    let reach = map.width + map.height + 2;
    let mut counts = vec![0_u32; 2 * reach];
    let mut sharp = |degrees: f64| -> u64 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut sum = 0;
        for across in [false, true] {
            counts.fill(0);
            for (x, y) in &points {
                let v = if across { y * cos - x * sin } else { x * cos + y * sin };
                counts[(v.round() + reach as f64).clamp(0.0, (2 * reach - 1) as f64) as usize] += 1;
            }
            sum += counts.iter().map(|n| u64::from(*n) * u64::from(*n)).sum::<u64>();
        }
        sum
    };
    let flat = sharp(0.0);
    let mut best = (flat, 0.0);
    let mut hear = |degrees: f64, best: &mut (u64, f64)| {
        let found = sharp(degrees);
        if found > best.0 {
            *best = (found, degrees);
        }
    };
    (-44..=45).for_each(|d| hear(f64::from(d), &mut best));
    let middle = best.1;
    (-20..=20).for_each(|d| hear(middle + f64::from(d) / 20.0, &mut best));
    (best.1.abs() >= LEAST_TURN && best.0 as f64 > SHARPER * flat as f64).then(|| best.1.to_radians())
}

/// Frees what stands about: groups of blocked cells that are no walls; returns how many.
fn take_away(map: &mut Map) -> usize {
    let (short, block) = (map.cells_of(FURNITURE_M), map.cells_of(BLOCK_M));
    let (thin, row) = (map.cells_of(0.35), map.cells_of(ROW_M));
    let mut count = 0;
    let groups = map.groups(true, |k| !map.free[k]);
    for group in groups {
        let (x0, x1, y0, y1) = map.bounds(&group);
        if x0 == 0 || y0 == 0 || x1 + 1 == map.width || y1 + 1 == map.height {
            continue;
        }
        let (w, h) = (x1 - x0 + 1, y1 - y0 + 1);
        let solid = group.len() as f64 > 0.6 * (w * h) as f64;
        let (long, narrow) = (w.max(h), w.min(h));
        let small =
            long <= short && !(narrow <= thin && long >= map.cells_of(0.6) && between_walls(map, (x0, x1, y0, y1)));
        let standing = solid && narrow > thin && (long <= block || narrow <= row);
        if small || standing {
            count += usize::from(group.len() >= map.area_of(0.04));
            group.into_iter().for_each(|k| map.free[k] = true);
        }
    }
    let least = map.area_of(LEAST_ROOM_M2);
    for group in map.groups(false, |k| map.free[k]) {
        if group.len() < least {
            group.into_iter().for_each(|k| map.free[k] = false);
        }
    }
    count
}

/// Returns true for a thin piece that goes on as a wall after a door at both of its ends.
fn between_walls(map: &Map, (x0, x1, y0, y1): (usize, usize, usize, usize)) -> bool {
    let reach = map.cells_of(DOOR_M);
    let at = |i: usize, j: usize| j * map.width + i;
    let (mx, my) = ((x0 + x1) / 2, (y0 + y1) / 2);
    // the first cell beyond each end is free; a wall stops the run of free cells within a door's width
    let ends = if x1 - x0 >= y1 - y0 {
        [(at(x0 - 1, my), (-1, 0)), (at(x1 + 1, my), (1, 0))]
    } else {
        [(at(mx, y0 - 1), (0, -1)), (at(mx, y1 + 1), (0, 1))]
    };
    ends.into_iter().all(|(k, step)| map.free[k] && map.run(k, step, reach + 1) <= reach)
}

/// Returns the thickness of most walls, cells: blocked runs are longer in furniture, and of many lengths.
fn usual_wall(map: &Map) -> usize {
    let thickest = map.cells_of(WALL_M);
    let mut found = vec![0_usize; thickest + 1];
    for k in 0..map.free.len() {
        for (step, before) in [((1, 0), k.checked_sub(1)), ((0, 1), k.checked_sub(map.width))] {
            if !map.free[k] && before.is_some_and(|b| map.free[b]) {
                let run = map.run(k, step, thickest + 1);
                if run <= thickest {
                    found[run] += 1;
                }
            }
        }
    }
    (1..=thickest).max_by_key(|n| (found[*n], usize::MAX - n)).unwrap_or(1)
}

/// Returns the gaps between wall ends along x and along y.
fn openings(map: &Map) -> Vec<Opening> {
    let mut out = Vec::new();
    let thickest = (2 * usual_wall(map) + 1).min(map.cells_of(WALL_M));
    for along_x in [true, false] {
        let mut marked = vec![false; map.free.len()];
        let (across, along) = if along_x { (map.height, map.width) } else { (map.width, map.height) };
        let at = |line: usize, i: usize| if along_x { line * map.width + i } else { i * map.width + line };
        for line in 0..across {
            let mut i = 0;
            while i < along {
                if !map.free[at(line, i)] {
                    i += 1;
                    continue;
                }
                let start = i;
                while i < along && map.free[at(line, i)] {
                    i += 1;
                }
                if start > 0
                    && i < along
                    && is_gap(map, along_x, [at(line, start - 1), at(line, i)], i - start, thickest)
                {
                    (start..i).for_each(|k| marked[at(line, k)] = true);
                }
            }
        }
        let deepest = map.cells_of(WALL_M) + 1;
        for cells in map.groups(false, |k| marked[k]) {
            let (x0, x1, y0, y1) = map.bounds(&cells);
            if (if along_x { y1 - y0 } else { x1 - x0 }) < deepest {
                out.push(Opening { along_x, cells });
            }
        }
    }
    out
}

/// Returns true for a run of free cells between two blocked ones that is a gap in a wall.
fn is_gap(map: &Map, along_x: bool, [low, high]: [usize; 2], length: usize, thickest: usize) -> bool {
    if length < map.cells_of(NARROWEST_M) || length > map.cells_of(WIDEST_M) {
        return false;
    }
    let wide = length > map.cells_of(DOOR_M);
    let (forward, up) = if along_x { ((1, 0), (0, 1)) } else { ((0, 1), (1, 0)) };
    let back = |s: (i64, i64)| (-s.0, -s.1);
    let thick_at = |k: usize| map.run(k, up, thickest + 2) + map.run(k, back(up), thickest + 2) - 1;
    let shortest = map.cells_of(STUB_M);
    let is_end = |k: usize, outward: (i64, i64)| {
        let thick = thick_at(k);
        let step = if along_x { outward.0 } else { outward.1 * map.width as i64 } as isize;
        let behind =
            |n: usize| k.checked_add_signed(step * n as isize).filter(|b| *b < map.free.len() && !map.free[*b]);
        // noise on a wall is no end of one; a stub between two doors of a corridor is longer than thick, and no end of a wall
        // across it, even where such a wall begins behind it: it is thinner
        thick <= thickest
            && map.run(k, outward, thick + 1) > thick
            && (1..shortest).all(|n| behind(n).is_some_and(|b| thick_at(b) <= thickest))
            && behind(thick).is_none_or(|b| thick_at(b) >= thick)
    };
    let ends = [is_end(low, back(forward)), is_end(high, forward)];
    if wide { ends[0] && ends[1] } else { ends[0] || ends[1] }
}

/// Returns the room of each free cell, with the gaps that part two rooms; the others are floor again.
fn part(map: &Map, mut openings: Vec<Opening>) -> (Vec<Option<usize>>, Vec<Opening>) {
    let least = map.area_of(LEAST_ROOM_M2);
    loop {
        let mut closed = vec![false; map.free.len()];
        openings.iter().flat_map(|o| &o.cells).for_each(|k| closed[*k] = true);
        let mut labels: Vec<Option<usize>> = vec![None; map.free.len()];
        let groups = map.groups(false, |k| map.free[k] && !closed[k]);
        let sizes: Vec<usize> = groups.iter().map(Vec::len).collect();
        for (room, cells) in groups.iter().enumerate() {
            cells.iter().for_each(|k| labels[*k] = Some(room));
        }
        // one gap is given up at a time where a space is too small for a room, so that it joins one neighbor only
        let mut joined: Vec<usize> = Vec::new();
        let before = openings.len();
        openings.retain(|o| match sides(map, &labels, o) {
            [Some(a), Some(b)] if a != b => {
                let small = if sizes[a] < least { Some(a) } else { (sizes[b] < least).then_some(b) };
                match small {
                    Some(room) if !joined.contains(&room) => {
                        joined.extend([a, b]);
                        false
                    }
                    _ => true,
                }
            }
            _ => false,
        });
        if openings.len() == before {
            return (labels, openings);
        }
    }
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

/// Returns the space that is the world around the building: it reaches the edge of the picture, and is not all there is.
fn outdoors(map: &Map, labels: &[Option<usize>], count: usize) -> Option<usize> {
    if count < 2 {
        return None;
    }
    let (w, h) = (map.width, map.height);
    let mut edge = vec![0_usize; count];
    let rim = (0..w).flat_map(|i| [i, (h - 1) * w + i]).chain((0..h).flat_map(|j| [j * w, j * w + w - 1]));
    rim.filter_map(|k| labels[k]).for_each(|room| edge[room] += 1);
    let most = (0..count).max_by_key(|r| (edge[*r], usize::MAX - r))?;
    (edge[most] * 4 > w + h).then_some(most)
}

/// Lets rooms take the recesses in their outlines that are furniture: blocked cells between their own, off other rooms.
fn fill(map: &Map, labels: &[Option<usize>], count: usize) -> Vec<Option<usize>> {
    let mut out = labels.to_vec();
    let wall = wall_between(map, labels);
    let (w, h) = (map.width, map.height);
    // in rows and in columns: a blocked run between two runs of one room
    let longest = map.cells_of(RECESS_M);
    for along_x in [true, false] {
        let (across, along) = if along_x { (h, w) } else { (w, h) };
        let at = |line: usize, i: usize| if along_x { line * w + i } else { i * w + line };
        for line in 0..across {
            let mut last: Option<(usize, usize)> = None;
            for i in 0..along {
                let Some(room) = labels[at(line, i)] else {
                    // a gap to another room ends a recess
                    last = last.filter(|_| !map.free[at(line, i)]);
                    continue;
                };
                if let Some((k, before)) = last
                    && before == room
                    && i - k > 1
                    && i - k - 1 <= longest
                {
                    (k + 1..i)
                        .filter(|m| far(map, labels, at(line, *m), room, wall))
                        .for_each(|m| out[at(line, m)] = Some(room));
                }
                last = Some((i, room));
            }
        }
    }
    corners(map, labels, &mut out, count, wall);
    out
}

/// Returns the usual thickness of walls between rooms, cells.
fn wall_between(map: &Map, labels: &[Option<usize>]) -> usize {
    let thickest = map.cells_of(WALL_M);
    let mut found: BTreeMap<usize, usize> = BTreeMap::new();
    for along_x in [true, false] {
        let (across, along) = if along_x { (map.height, map.width) } else { (map.width, map.height) };
        for line in 0..across {
            let mut last: Option<(usize, usize)> = None;
            for i in 0..along {
                let k = if along_x { line * map.width + i } else { i * map.width + line };
                if let Some(room) = labels[k] {
                    if let Some((j, before)) = last
                        && before != room
                        && i - j - 1 <= thickest
                        && i - j > 1
                    {
                        *found.entry(i - j - 1).or_default() += 1;
                    }
                    last = Some((i, room));
                }
            }
        }
    }
    found.into_iter().max_by_key(|(thick, n)| (*n, usize::MAX - thick)).map_or(map.cells_of(0.1), |f| f.0)
}

/// Returns true for a cell with no other room's floor within the thickness of a wall.
fn far(map: &Map, labels: &[Option<usize>], k: usize, room: usize, wall: usize) -> bool {
    let (i, j) = (k % map.width, k / map.width);
    let reach = |v: usize, most: usize| v.saturating_sub(wall)..=(v + wall).min(most - 1);
    reach(j, map.height)
        .all(|y| reach(i, map.width).all(|x| labels[y * map.width + x].is_none_or(|other| other == room)))
}

/// Fills corners of rooms where something small stands: blocked cells with floor of the room in their row and in their column.
fn corners(map: &Map, labels: &[Option<usize>], out: &mut [Option<usize>], count: usize, wall: usize) {
    let (w, h) = (map.width, map.height);
    let most = map.area_of(RECESS_M2);
    let mut cells: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (k, room) in labels.iter().enumerate() {
        if let Some(room) = room {
            cells[*room].push(k);
        }
    }
    for (room, cells) in cells.iter().enumerate().filter(|(_, c)| !c.is_empty()) {
        let (x0, x1, y0, y1) = map.bounds(cells);
        let (mut in_row, mut in_column) = (vec![false; h], vec![false; w]);
        for k in cells {
            (in_row[k / w], in_column[k % w]) = (true, true);
        }
        // of the box around the room only: what is blocked, in one group
        let inside = |k: usize| {
            let (i, j) = (k % w, k / w);
            let boxed = (x0..=x1).contains(&i) && (y0..=y1).contains(&j);
            boxed && out[k].is_none() && !map.free[k] && in_row[j] && in_column[i]
        };
        let mut seen = vec![false; (x1 - x0 + 1) * (y1 - y0 + 1)];
        let mut found: Vec<usize> = Vec::new();
        for j in y0..=y1 {
            for i in x0..=x1 {
                let start = j * w + i;
                if seen[(j - y0) * (x1 - x0 + 1) + i - x0] || !inside(start) {
                    continue;
                }
                seen[(j - y0) * (x1 - x0 + 1) + i - x0] = true;
                let mut group = vec![start];
                let mut next = 0;
                while next < group.len() {
                    let k = group[next];
                    next += 1;
                    for n in map.around(k, false) {
                        let (i, j) = (n % w, n / w);
                        if (x0..=x1).contains(&i) && (y0..=y1).contains(&j) && inside(n) {
                            let mark = &mut seen[(j - y0) * (x1 - x0 + 1) + i - x0];
                            if !*mark {
                                *mark = true;
                                group.push(n);
                            }
                        }
                    }
                }
                if group.len() <= most {
                    found.extend(group);
                }
            }
        }
        found.into_iter().filter(|k| far(map, labels, *k, room, wall)).for_each(|k| out[k] = Some(room));
    }
}

/// Cells of rooms without what is too narrow to be floor.
fn smooth(map: &Map, filled: &[Option<usize>]) -> Vec<Option<usize>> {
    let side = map.cells_of(NOISE_M) + 1;
    let (w, h) = (map.width, map.height);
    let mut out: Vec<Option<usize>> = vec![None; filled.len()];
    // the largest square of one room by its lower left cell: one of this side is floor
    let mut low: Vec<usize> = vec![0; filled.len()];
    for j in (0..h).rev() {
        for i in (0..w).rev() {
            let k = j * w + i;
            let Some(room) = filled[k] else { continue };
            let next = |n: usize| if filled[n] == Some(room) { low[n] } else { 0 };
            low[k] = if i + 1 < w && j + 1 < h { 1 + next(k + 1).min(next(k + w)).min(next(k + w + 1)) } else { 1 };
            if low[k] >= side {
                for y in j..j + side {
                    out[y * w + i..y * w + i + side].fill(filled[k]);
                }
            }
        }
    }
    out
}

/// Returns the shallow notches in the outlines of rooms that lead out of the building, with their rooms: its doors.
fn notches(map: &Map, shapes: &[Option<usize>], count: usize, outdoors: Option<usize>) -> Vec<(usize, Opening)> {
    let lengths = (map.cells_of(0.7) as i64)..=(map.cells_of(3.0) as i64);
    let depths = (map.cells_of(SHALLOW_M) as i64)..=(map.cells_of(NOTCH_M) as i64);
    let mut out = Vec::new();
    for (room, outlines) in loops(map, shapes, count).iter().enumerate().filter(|(room, _)| Some(*room) != outdoors) {
        let Some(ring) = outlines.first() else { continue };
        let n = ring.len();
        let at = |i: usize| ring[i % n];
        let length = |i: usize| (at(i).0 - at(i + 1).0).abs() + (at(i).1 - at(i + 1).1).abs();
        let left = |i: usize| {
            let (a, b, c) = (at(i + n - 1), at(i), at(i + 1));
            (b.0 - a.0) * (c.1 - b.1) - (b.1 - a.1) * (c.0 - b.0) > 0
        };
        for i in 0..n {
            let depth = length(i + n - 1).min(length(i + 1));
            let tab = left(i) && left(i + 1) && !left(i + n - 1) && !left(i + 2);
            if !tab || !depths.contains(&depth) || !lengths.contains(&length(i)) {
                continue;
            }
            let (a, b) = (at(i), at(i + 1));
            // the floor lies to the left of the end of the notch
            let inward = ((a.1 - b.1).signum() * depth, (b.0 - a.0).signum() * depth);
            let far = (b.0 + inward.0, b.1 + inward.1);
            let range = |p: i64, q: i64, r: i64| p.min(q).min(r) as usize..p.max(q).max(r) as usize;
            let (xs, ys) = (range(a.0, b.0, far.0), range(a.1, b.1, far.1));
            let cells = ys.flat_map(|j| xs.clone().map(move |i| j * map.width + i)).collect();
            let opening = Opening { along_x: a.1 == b.1, cells };
            if leads_out(map, shapes, &opening, room) && is_outermost(ring, (a, b), lengths.end()) {
                out.push((room, opening));
            }
        }
    }
    out
}

/// Returns true when an edge, with others like it on its line, is a small part of its side and the room ends there.
fn is_outermost(ring: &[At], (a, b): (At, At), longest: &i64) -> bool {
    let flat = a.1 == b.1;
    let (along, across) = (|p: At| if flat { p.0 } else { p.1 }, |p: At| if flat { p.1 } else { p.0 });
    let (least, most) = ring.iter().fold((i64::MAX, i64::MIN), |s, p| (s.0.min(across(*p)), s.1.max(across(*p))));
    let side = ring.iter().map(|p| along(*p)).max().unwrap_or(0) - ring.iter().map(|p| along(*p)).min().unwrap_or(0);
    let n = ring.len();
    let on_line = (0..n)
        .map(|i| (ring[i], ring[(i + 1) % n]))
        .filter(|(p, q)| across(*p) == across(a) && across(*q) == across(a));
    let total: i64 =
        on_line.map(|(p, q)| (along(p) - along(q)).abs()).map(|l| if l > *longest { side } else { l }).sum();
    let single = total == (along(a) - along(b)).abs();
    (across(a) == least || across(a) == most) && (single || (total as f64) < NOTCHED * side as f64)
}

/// Returns true for a notch with no other room's floor behind it.
fn leads_out(map: &Map, filled: &[Option<usize>], opening: &Opening, room: usize) -> bool {
    let (x0, x1, y0, y1) = map.bounds(&opening.cells);
    let reach = map.cells_of(1.0);
    let grow = |a: usize, b: usize, most: usize| a.saturating_sub(reach)..(b + 1 + reach).min(most);
    let (xs, ys) =
        if opening.along_x { (x0..x1 + 1, grow(y0, y1, map.height)) } else { (grow(x0, x1, map.width), y0..y1 + 1) };
    ys.into_iter().all(|j| xs.clone().all(|i| filled[j * map.width + i].is_none_or(|other| other == room)))
}

/// Returns the outlines of each room's largest part: the outer one, then the holes that are no furniture.
fn loops(map: &Map, shapes: &[Option<usize>], count: usize) -> Vec<Vec<Vec<At>>> {
    let least = map.area_of(LEAST_ROOM_M2);
    let mut parts: Vec<Vec<usize>> = vec![Vec::new(); count];
    let marked = |room: usize| move |k: usize| shapes[k] == Some(room);
    // all parts at once: neighbors of one room only are connected
    let mut seen = vec![false; shapes.len()];
    for start in 0..shapes.len() {
        let Some(room) = shapes[start].filter(|_| !seen[start]) else { continue };
        seen[start] = true;
        let mut group = vec![start];
        let mut next = 0;
        while next < group.len() {
            let k = group[next];
            next += 1;
            for n in map.around(k, false).filter(|n| marked(room)(*n)) {
                if !seen[n] {
                    seen[n] = true;
                    group.push(n);
                }
            }
        }
        if group.len() > parts[room].len() {
            parts[room] = group;
        }
    }
    parts.into_iter().map(|cells| if cells.len() < least { Vec::new() } else { around(map, &cells) }).collect()
}

/// Returns the outlines of a group of cells.
fn around(map: &Map, cells: &[usize]) -> Vec<Vec<At>> {
    let mut inside = vec![false; map.free.len()];
    cells.iter().for_each(|k| inside[*k] = true);
    let (w, h) = (map.width as i64, map.height as i64);
    let at = |i: i64, j: i64| i >= 0 && j >= 0 && i < w && j < h && inside[(j * w + i) as usize];
    // edges with the floor on their left, by their start
    let mut next: BTreeMap<At, Vec<At>> = BTreeMap::new();
    for &k in cells {
        let (i, j) = (k as i64 % w, k as i64 / w);
        for (free, a, b) in [
            (at(i, j - 1), (i, j), (i + 1, j)),
            (at(i + 1, j), (i + 1, j), (i + 1, j + 1)),
            (at(i, j + 1), (i + 1, j + 1), (i, j + 1)),
            (at(i - 1, j), (i, j + 1), (i, j)),
        ] {
            if !free {
                next.entry(a).or_default().push(b);
            }
        }
    }
    let mut out: Vec<Vec<At>> = Vec::new();
    while let Some((&start, _)) = next.iter().next() {
        let (mut ring, mut here, mut from) = (Vec::new(), start, None::<At>);
        while let Some(ways) = next.get_mut(&here) {
            // where two outlines touch, the left turn keeps them apart
            let pick = match from {
                Some(f) if ways.len() > 1 => {
                    let (dx, dy) = (here.0 - f.0, here.1 - f.1);
                    ways.iter().position(|b| (b.0 - here.0, b.1 - here.1) == (-dy, dx)).unwrap_or(0)
                }
                _ => 0,
            };
            let to = ways.remove(pick);
            if ways.is_empty() {
                next.remove(&here);
            }
            ring.push(here);
            (from, here) = (Some(here), to);
            if here == start {
                break;
            }
        }
        let n = ring.len();
        let turns = |m: &usize| {
            let (a, b, c) = (ring[(m + n - 1) % n], ring[*m], ring[(m + 1) % n]);
            (a.0 == b.0) != (b.0 == c.0)
        };
        out.push((0..n).filter(turns).map(|m| ring[m]).collect());
    }
    let area = |ring: &[At]| -> i64 {
        let n = ring.len();
        (0..n).map(|m| ring[m].0 * ring[(m + 1) % n].1 - ring[(m + 1) % n].0 * ring[m].1).sum::<i64>() / 2
    };
    let least = map.area_of(HOLE_M2) as i64;
    let mut outer: Vec<Vec<At>> = out.iter().filter(|r| area(r) > 0).cloned().collect();
    outer.sort_by_key(|r| -area(r));
    outer.truncate(1);
    outer.extend(out.into_iter().filter(|r| -area(r) >= least));
    outer
}
