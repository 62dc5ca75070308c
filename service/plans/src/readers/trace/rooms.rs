//! Rooms between walls: what gaps part, with the floor under furniture along walls, and their outlines.

use std::collections::BTreeMap;

use super::{At, LEAST_ROOM_M2, Map, Opening, WALL_M, sides};

/// Longest and largest recess that is taken for furniture along a wall, m and m^2.
const RECESS_M: f64 = 4.0;
const RECESS_M2: f64 = 3.0;
/// Parts of a room narrower than this are no floor, m.
const NOISE_M: f64 = 0.3;
/// Shallowest and deepest notch in an outer wall that is the place of a door, m.
const SHALLOW_M: f64 = 0.1;
const NOTCH_M: f64 = 0.4;
/// Most of a wall that is notches; more are the gaps between things that stand there.
const NOTCHED: f64 = 0.4;
/// An unparted hole in a room up to this size is something that stands there, m^2.
const HOLE_M2: f64 = 1.0;

/// Returns the room of each free cell, with the gaps that part two rooms; the others are floor again.
pub(super) fn part(map: &Map, mut openings: Vec<Opening>) -> (Vec<Option<usize>>, Vec<Opening>) {
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

/// Returns the space that is the world around the building: it reaches the edge of the picture, and is not all there is.
pub(super) fn outdoors(map: &Map, labels: &[Option<usize>], count: usize) -> Option<usize> {
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
pub(super) fn fill(map: &Map, labels: &[Option<usize>], count: usize) -> Vec<Option<usize>> {
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
            let at = |i: usize| if along_x { line * map.width + i } else { i * map.width + line };
            let floor: Vec<(usize, usize)> = (0..along).filter_map(|i| Some((i, labels[at(i)]?))).collect();
            let gaps = floor.windows(2).filter(|w| w[0].1 != w[1].1).map(|w| w[1].0 - w[0].0 - 1);
            gaps.filter(|gap| (1..=thickest).contains(gap)).for_each(|gap| *found.entry(gap).or_default() += 1);
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
pub(super) fn smooth(map: &Map, filled: &[Option<usize>]) -> Vec<Option<usize>> {
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
pub(super) fn notches(
    map: &Map,
    shapes: &[Option<usize>],
    count: usize,
    outdoors: Option<usize>,
) -> Vec<(usize, Opening)> {
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
pub(super) fn loops(map: &Map, shapes: &[Option<usize>], count: usize) -> Vec<Vec<Vec<At>>> {
    let least = map.area_of(LEAST_ROOM_M2);
    let mut parts: Vec<Vec<usize>> = vec![Vec::new(); count];
    for group in map.alike(false, |k| shapes[k]) {
        if let Some(room) = shapes[group[0]].filter(|&room| group.len() > parts[room].len()) {
            parts[room] = group;
        }
    }
    parts.into_iter().map(|cells| if cells.len() < least { Vec::new() } else { around(map, &cells) }).collect()
}

/// Returns the outlines of a group of cells.
pub(super) fn around(map: &Map, cells: &[usize]) -> Vec<Vec<At>> {
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
