//! Walls that stand free in a room, and floor that the scanner never saw.

use super::{At, Map, rooms::around};

/// Thickest thing that is a wall, m, and the shortest.
const THIN_M: f64 = 0.35;
const LONG_M: f64 = 1.5;

/// Returns true for a group of blocked cells as thin as a wall and as long as one.
pub(super) fn is_wall(map: &Map, cells: &[usize]) -> bool {
    let (x0, x1, y0, y1) = map.bounds(cells);
    let (w, h) = (x1 - x0 + 1, y1 - y0 + 1);
    let thin = map.cells_of(THIN_M);
    if w.max(h) < map.cells_of(LONG_M) || cells.iter().all(|k| map.unknown[*k]) {
        return false;
    }
    // side of the largest square of cells by its upper right cell
    let mut inside = vec![0_usize; w * h];
    cells.iter().for_each(|k| inside[(k / map.width - y0) * w + k % map.width - x0] = 1);
    for j in 1..h {
        for i in 1..w {
            if inside[j * w + i] > 0 {
                let beside = inside[j * w + i - 1].min(inside[(j - 1) * w + i]).min(inside[(j - 1) * w + i - 1]);
                inside[j * w + i] = 1 + beside;
            }
        }
    }
    inside.iter().all(|side| *side <= thin)
}

/// Frees the walls that have one room all around, and returns their outlines; their cells become floor of that room.
pub(super) fn take(map: &mut Map, labels: &mut [Option<usize>]) -> Vec<Vec<At>> {
    let mut out = Vec::new();
    for group in map.groups(true, |k| !map.free[k]) {
        let (x0, x1, y0, y1) = map.bounds(&group);
        if x0 == 0 || y0 == 0 || x1 + 1 == map.width || y1 + 1 == map.height {
            continue;
        }
        let mut around_it =
            group.iter().flat_map(|k| map.around(*k, false)).filter(|n| map.free[*n]).map(|n| labels[n]);
        let Some(Some(room)) = around_it.next() else { continue };
        if around_it.all(|other| other == Some(room)) && is_wall(map, &group) {
            out.extend(outline(map, &group));
            for k in group {
                (map.free[k], labels[k]) = (true, Some(room));
            }
        }
    }
    out
}

/// Returns the outer outline of cells.
pub(super) fn outline(map: &Map, cells: &[usize]) -> Option<Vec<At>> {
    around(map, cells).into_iter().next()
}

/// Returns the floor within the map that was never scanned, m^2: cells that nobody has seen, off the edge of the map.
pub(super) fn unscanned_m2(map: &Map) -> f64 {
    let within = |group: &Vec<usize>| {
        let (x0, x1, y0, y1) = map.bounds(group);
        x0 > 0 && y0 > 0 && x1 + 1 < map.width && y1 + 1 < map.height
    };
    let cells: usize = map.groups(false, |k| map.unknown[k]).iter().filter(|g| within(g)).map(Vec::len).sum();
    cells as f64 / (map.per_meter * map.per_meter)
}
