//! A top view in square cells: paint floor and obstacles, shrink it by a robot, count connected parts.

use d3dgen_model::{Point, Rect};

use crate::solid::Solid;

/// Edge of a cell, m: five make the robot of SceneEval exactly.
pub const CELL_M: f64 = 0.04;

/// Headings of a long body in half a turn; forward and backward are the same outline.
const HEADINGS: usize = 16;

/// A set of cells over a rectangle.
#[derive(Debug, Clone)]
pub struct Grid {
    origin: Point,
    nx: usize,
    ny: usize,
    cells: Vec<bool>,
}

impl Grid {
    /// Returns the empty grid over a rectangle and a cell around it.
    pub fn over(rect: &Rect) -> Self {
        let origin = Point::new(rect.x0 - CELL_M, rect.y0 - CELL_M);
        let count = |length: f64| (length.max(0.0) / CELL_M).ceil() as usize + 2;
        let (nx, ny) = (count(rect.width()), count(rect.height()));
        Self { origin, nx, ny, cells: vec![false; nx * ny] }
    }

    /// Returns the rows or columns `(first, end)` whose centers lie between two coordinates.
    fn span(from: f64, to: f64, origin: f64, n: usize) -> (usize, usize) {
        // 1e-6: a center exactly on an edge counts as inside whatever the rounding
        let first = ((from - origin) / CELL_M - 0.5 - 1e-6).ceil().clamp(0.0, n as f64);
        let end = (((to - origin) / CELL_M - 0.5 + 1e-6).floor() + 1.0).clamp(first, n as f64);
        (first as usize, end as usize)
    }

    /// Adds or removes the cells with centers in the rectangle.
    pub fn paint(&mut self, rect: &Rect, value: bool) {
        let (i0, i1) = Self::span(rect.x0, rect.x1, self.origin.x, self.nx);
        let (j0, j1) = Self::span(rect.y0, rect.y1, self.origin.y, self.ny);
        for j in j0..j1 {
            self.cells[j * self.nx + i0..j * self.nx + i1].fill(value);
        }
    }

    /// Removes the cells with centers in the outline of an object.
    pub fn block(&mut self, solid: &Solid<'_>) {
        let (i0, i1) = Self::span(solid.bounds.x0, solid.bounds.x1, self.origin.x, self.nx);
        let (j0, j1) = Self::span(solid.bounds.y0, solid.bounds.y1, self.origin.y, self.ny);
        for j in j0..j1 {
            for i in i0..i1 {
                if solid.covers(self.center(i, j), 1e-6) {
                    self.cells[j * self.nx + i] = false;
                }
            }
        }
    }

    fn center(&self, i: usize, j: usize) -> Point {
        Point::new(self.origin.x + (i as f64 + 0.5) * CELL_M, self.origin.y + (j as f64 + 0.5) * CELL_M)
    }

    /// Returns the number of cells in the set.
    #[cfg(test)]
    pub fn count(&self) -> usize {
        self.cells.iter().filter(|c| **c).count()
    }

    /// Returns the cells around which a square of this width (m, rounded up to an odd number of cells) is in the set.
    pub fn eroded_by_square(&self, width_m: f64) -> Self {
        let half = ((width_m / CELL_M - 1.0) / 2.0 - 1e-6).ceil().max(0.0) as usize;
        let mut rows = self.clone();
        for j in 0..self.ny {
            let row = &self.cells[j * self.nx..(j + 1) * self.nx];
            shrink(row, half, 1, &mut rows.cells[j * self.nx..(j + 1) * self.nx]);
        }
        let mut out = rows.clone();
        for i in 0..self.nx {
            shrink(&rows.cells[i..], half, self.nx, &mut out.cells[i..]);
        }
        out
    }

    /// Returns the cells around which a disc of this radius (m) is in the set: no other cell has its center nearer.
    pub fn eroded_by_disc(&self, radius_m: f64) -> Self {
        let radius = radius_m / CELL_M;
        let reach = radius.ceil() as i64;
        let near = |dx: i64, dy: i64| ((dx * dx + dy * dy) as f64) < radius * radius - 1e-9;
        let disc: Vec<(i64, i64)> = (-reach..=reach)
            .flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)))
            .filter(|(dx, dy)| near(*dx, *dy))
            .collect();
        let (nx, ny) = (self.nx as i64, self.ny as i64);
        let at = |i: i64, j: i64| (0..nx).contains(&i) && (0..ny).contains(&j) && self.cells[(j * nx + i) as usize];
        let mut out = self.clone();
        for j in 0..ny {
            for i in 0..nx {
                let edge = !at(i, j) && [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().any(|(x, y)| at(i + x, j + y));
                if !edge {
                    continue;
                }
                for (x, y) in disc.iter().map(|(x, y)| (i + x, j + y)) {
                    if (0..nx).contains(&x) && (0..ny).contains(&y) {
                        out.cells[(y * nx + x) as usize] = false;
                    }
                }
            }
        }
        out
    }

    /// Returns where the middle of a long body (width and length, m) can be in some heading, and where it gets to from within
    /// `near` (m) of a point: along itself, and turning about its middle. Its outline is a row of discs as wide as it is.
    pub fn driven(&self, [width, length]: [f64; 2], start: Point, near: f64) -> (Self, Self) {
        let disc = self.eroded_by_disc(width / 2.0);
        let (nx, ny) = (self.nx as i64, self.ny as i64);
        let at = |i: i64, j: i64| (0..nx).contains(&i) && (0..ny).contains(&j) && disc.cells[(j * nx + i) as usize];
        let reach = ((length - width).max(0.0) / 2.0 / CELL_M).ceil();
        let row = |h: usize| -> Vec<(i64, i64)> {
            let (sin, cos) = (std::f64::consts::PI * h as f64 / HEADINGS as f64).sin_cos();
            let far = |k: i64| ((k as f64 * cos).round() as i64, (k as f64 * sin).round() as i64);
            (-(reach as i64)..=reach as i64).map(far).collect()
        };
        let rows: Vec<Vec<(i64, i64)>> = (0..HEADINGS).map(row).collect();
        let stands = |i: i64, j: i64, h: usize| at(i, j) && rows[h].iter().all(|(x, y)| at(i + x, j + y));
        let empty = Self { cells: vec![false; self.cells.len()], ..*self };
        let (mut all, mut driven) = (empty.clone(), empty);
        // by cell: headings in which it can be there, and in which it has been
        let mut can = vec![0_u16; self.cells.len()];
        for k in (0..self.cells.len()).filter(|k| disc.cells[*k]) {
            let (i, j) = (k as i64 % nx, k as i64 / nx);
            can[k] = (0..HEADINGS).filter(|h| stands(i, j, *h)).map(|h| 1 << h).sum();
            all.cells[k] = can[k] != 0;
        }
        let mut seen = vec![0_u16; self.cells.len()];
        let begins = |k: &usize| self.center(k % self.nx, k / self.nx).distance(start) <= near;
        let mut open: Vec<(usize, usize)> =
            (0..self.cells.len()).filter(begins).flat_map(|k| (0..HEADINGS).map(move |h| (k, h))).collect();
        while let Some((k, h)) = open.pop() {
            if can[k] & !seen[k] & (1 << h) == 0 {
                continue;
            }
            seen[k] |= 1 << h;
            driven.cells[k] = true;
            open.extend([(k, (h + 1) % HEADINGS), (k, (h + HEADINGS - 1) % HEADINGS)]);
            let (i, j) = (k as i64 % nx, k as i64 / nx);
            let (sin, cos) = (std::f64::consts::PI * h as f64 / HEADINGS as f64).sin_cos();
            for far in [-2.0, -1.0, 1.0, 2.0] {
                let (x, y) = (i + (far * cos).round() as i64, j + (far * sin).round() as i64);
                if (0..nx).contains(&x) && (0..ny).contains(&y) {
                    open.push(((y * nx + x) as usize, h));
                }
            }
        }
        (all, driven)
    }

    /// Returns the share of the set in its largest part connected by edges and corners; 0 for the empty set.
    pub fn largest_share(&self) -> f64 {
        let (largest, all) = self.largest_and_all();
        if all == 0 { 0.0 } else { largest as f64 / all as f64 }
    }

    /// Returns the size of the largest part connected by edges and corners, and of the set.
    pub fn largest_and_all(&self) -> (usize, usize) {
        let mut left = self.clone();
        let (mut largest, mut all) = (0, 0);
        for k in 0..left.cells.len() {
            if left.cells[k] {
                let size = left.take(k, None);
                largest = largest.max(size);
                all += size;
            }
        }
        (largest, all)
    }

    /// Returns the part that is connected with the cell of the set nearest to a point, and how far that is, m.
    pub fn part_at(&self, p: Point) -> Option<(Self, f64)> {
        let (_, k, distance) = self.nearest(p)?;
        let mut part = Self { cells: vec![false; self.cells.len()], ..*self };
        self.clone().take(k, Some(&mut part));
        Some((part, distance))
    }

    /// Returns the distance from a point to the nearest cell of the set, m.
    pub fn distance_to(&self, p: Point) -> Option<f64> {
        self.nearest(p).map(|(_, _, d)| d)
    }

    /// Returns how many cells with centers in the rectangles are in the set.
    pub fn count_in(&self, rects: &[Rect]) -> usize {
        let mut count = 0;
        for rect in rects {
            let (i0, i1) = Self::span(rect.x0, rect.x1, self.origin.x, self.nx);
            let (j0, j1) = Self::span(rect.y0, rect.y1, self.origin.y, self.ny);
            for j in j0..j1 {
                count += self.cells[j * self.nx + i0..j * self.nx + i1].iter().filter(|c| **c).count();
            }
        }
        count
    }

    fn nearest(&self, p: Point) -> Option<(Point, usize, f64)> {
        let mut best: Option<(Point, usize, f64)> = None;
        // rows from the nearest outwards, until none can hold a nearer cell
        let mut rows: Vec<(f64, usize)> = (0..self.ny).map(|j| ((self.center(0, j).y - p.y).abs(), j)).collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (away, j) in rows {
            if best.is_some_and(|(_, _, least)| away > least) {
                break;
            }
            let row = &self.cells[j * self.nx..(j + 1) * self.nx];
            for (i, _) in row.iter().enumerate().filter(|(_, set)| **set) {
                let (c, k) = (self.center(i, j), j * self.nx + i);
                let far = c.distance(p);
                if best.is_none_or(|(_, least_k, least)| (far, k) < (least, least_k)) {
                    best = Some((c, k, far));
                }
            }
        }
        best
    }

    /// Removes the connected part of cell `k` (by edges and corners), adds it to `into`; returns its size.
    fn take(&mut self, k: usize, mut into: Option<&mut Self>) -> usize {
        let (nx, ny) = (self.nx as i64, self.ny as i64);
        let mut stack = vec![k];
        self.cells[k] = false;
        let mut size = 0;
        while let Some(k) = stack.pop() {
            size += 1;
            if let Some(into) = into.as_deref_mut() {
                into.cells[k] = true;
            }
            let (i, j) = (k as i64 % nx, k as i64 / nx);
            for y in (j - 1).max(0)..=(j + 1).min(ny - 1) {
                for x in (i - 1).max(0)..=(i + 1).min(nx - 1) {
                    let n = (y * nx + x) as usize;
                    if self.cells[n] {
                        self.cells[n] = false;
                        stack.push(n);
                    }
                }
            }
        }
        size
    }
}

/// Writes for each `stride`-th cell whether all cells within `half` of it along the line are set; outside counts as not.
fn shrink(from: &[bool], half: usize, stride: usize, to: &mut [bool]) {
    let count = from.len().div_ceil(stride);
    let mut run = 0; // set cells in a row up to here
    for n in 0..count + half {
        let set = n < count && from[n * stride];
        run = if set { run + 1 } else { 0 };
        if n >= half {
            to[(n - half) * stride] = run > 2 * half;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_shrinks_by_the_robot_on_each_side() {
        let mut grid = Grid::over(&Rect::new(0.0, 0.0, 1.0, 1.0));
        grid.paint(&Rect::new(0.0, 0.0, 1.0, 1.0), true);
        assert_eq!(grid.count(), 25 * 25);
        assert_eq!(grid.eroded_by_square(0.2).count(), 21 * 21, "its center stays 0.1 m from each edge");
        assert_eq!(grid.eroded_by_square(0.0).count(), 25 * 25);
        assert_eq!(grid.eroded_by_disc(0.041).count(), 23 * 23);
        assert_eq!(grid.largest_share(), 1.0);
    }

    #[test]
    fn parts_meet_at_corners() {
        let mut grid = Grid::over(&Rect::new(0.0, 0.0, 2.0, 2.0));
        grid.paint(&Rect::new(0.0, 0.0, 1.0, 1.0), true);
        grid.paint(&Rect::new(1.0, 1.0, 2.0, 2.0), true);
        assert_eq!(grid.largest_share(), 1.0);
        grid.paint(&Rect::new(0.88, 0.88, 1.0, 1.0), false);
        assert!((grid.largest_share() - 625.0 / (1250.0 - 9.0)).abs() < 1e-9);
        let (part, distance) = grid.part_at(Point::new(1.5, 1.5)).unwrap();
        assert!(part.count() == 625 && distance < CELL_M);
        assert_eq!(part.count_in(&[Rect::new(0.0, 0.0, 1.0, 1.0)]), 0);
    }
}
