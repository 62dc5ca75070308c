//! Noise that repeats: values of an integer hash on a lattice, smoothly between them.

/// Returns a figure from 0 to 1 of a place of the lattice.
pub(super) fn hash(x: i64, y: i64, salt: u32) -> f64 {
    let mut h =
        (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ salt.wrapping_mul(0xc2b2_ae3d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2c1b_3c6d);
    h ^= h >> 12;
    h = h.wrapping_mul(0x297a_2d39);
    h ^= h >> 15;
    f64::from(h) / f64::from(u32::MAX)
}

/// Returns smooth noise from 0 to 1 at `x`, `y` in 0 to 1, with `cells` of the lattice along each.
pub(super) fn value(x: f64, y: f64, cells: [usize; 2], salt: u32) -> f64 {
    let [cx, cy] = cells.map(|c| c.max(1) as i64);
    let (px, py) = (x * cx as f64, y * cy as f64);
    let (ix, iy) = (px.floor(), py.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease(px - ix), ease(py - iy));
    let at = |dx: i64, dy: i64| hash((ix as i64 + dx).rem_euclid(cx), (iy as i64 + dy).rem_euclid(cy), salt);
    let (low, high) = (at(0, 0) + (at(1, 0) - at(0, 0)) * u, at(0, 1) + (at(1, 1) - at(0, 1)) * u);
    low + (high - low) * v
}

/// Returns noise of several sizes, each half of the one before, from 0 to 1.
pub(super) fn layers(x: f64, y: f64, cells: [usize; 2], count: u32, salt: u32) -> f64 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for layer in 0..count {
        sum += weight * value(x, y, cells.map(|c| c << layer), salt + layer);
        total += weight;
        weight *= 0.5;
    }
    sum / total
}

/// Returns the distances to the nearest and second nearest of points strewn one a cell, in cells, and a figure of the
/// nearest.
pub(super) fn points(x: f64, y: f64, cells: [usize; 2], salt: u32) -> (f64, f64, f64) {
    let [cx, cy] = cells.map(|c| c.max(1) as i64);
    let (px, py) = (x * cx as f64, y * cy as f64);
    let (ix, iy) = (px.floor() as i64, py.floor() as i64);
    let (mut first, mut second, mut figure) = (f64::MAX, f64::MAX, 0.0);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (cell_x, cell_y) = ((ix + dx).rem_euclid(cx), (iy + dy).rem_euclid(cy));
            let (ox, oy) = (hash(cell_x, cell_y, salt), hash(cell_x, cell_y, salt + 1));
            let (wx, wy) = ((ix + dx) as f64 + ox - px, (iy + dy) as f64 + oy - py);
            let distance = (wx * wx + wy * wy).sqrt();
            if distance < first {
                (second, first, figure) = (first, distance, hash(cell_x, cell_y, salt + 2));
            } else if distance < second {
                second = distance;
            }
        }
    }
    (first, second, figure)
}
