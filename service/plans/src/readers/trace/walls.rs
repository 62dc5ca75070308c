//! Walls and the gaps in them: the direction they run in, what stands about and is none, where two of their ends face each
//! other.

use super::{At, DOOR_M, LEAST_ROOM_M2, Map, Opening, Turn, WALL_M, standing};

/// Narrowest gap between two wall ends that is a door, m; the widest opening at all.
const NARROWEST_M: f64 = 0.65;
const WIDEST_M: f64 = 4.5;
/// Shortest wall that ends at a gap, m; one of the two at a door may be shorter.
const STUB_M: f64 = 0.1;
/// Longest side of something that stands free and is no part of the walls, m.
const FURNITURE_M: f64 = 2.5;
/// The same for solid blocks; and the widest solid block of any length (a row of shelves).
const BLOCK_M: f64 = 4.5;
const ROW_M: f64 = 1.6;
/// Most cells by which the direction of walls is found; the least turn, degrees; and how much clearer walls have to be by it.
const MOST_POINTS: usize = 20_000;
const LEAST_TURN: f64 = 0.3;
const SHARPER: f64 = 1.1;

/// Returns a map whose walls run along its rows and columns, and how it was turned for that.
pub(super) fn upright(map: Map) -> (Map, Option<Turn>) {
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
    // what lies beyond the picture was not seen either
    let unseen = |k: usize| {
        let (x, y) = turn.back(((k % width) as f64 + 0.5, (k / width) as f64 + 0.5));
        let (i, j) = (x.floor(), y.floor());
        let within = i >= 0.0 && j >= 0.0 && i < w && j < h;
        !within || map.unknown[j as usize * map.width + i as usize]
    };
    let unknown = (0..width * height).map(unseen).collect();
    (Map { width, height, free, unknown, per_meter: map.per_meter }, Some(turn))
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

/// Frees what stands about: groups of blocked cells that part no rooms. Returns how many there are, without what was only never
/// seen, and the outlines of those that are walls.
pub(super) fn take_away(map: &mut Map) -> (usize, Vec<Vec<At>>) {
    let (short, block) = (map.cells_of(FURNITURE_M), map.cells_of(BLOCK_M));
    let (thin, row) = (map.cells_of(0.35), map.cells_of(ROW_M));
    let (mut count, mut free_walls) = (0, Vec::new());
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
            if standing::is_wall(map, &group) {
                free_walls.extend(standing::outline(map, &group));
            } else {
                let seen = group.iter().any(|k| !map.unknown[*k]);
                count += usize::from(seen && group.len() >= map.area_of(0.04));
            }
            group.into_iter().for_each(|k| map.free[k] = true);
        }
    }
    let least = map.area_of(LEAST_ROOM_M2);
    for group in map.groups(false, |k| map.free[k]) {
        if group.len() < least {
            group.into_iter().for_each(|k| map.free[k] = false);
        }
    }
    (count, free_walls)
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
pub(super) fn openings(map: &Map) -> Vec<Opening> {
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
