//! Upright boxes around the parts of any mesh: what collides of a model that brings no shapes of its own.
//!
//! The space around the mesh is cut into cells; those that its surface passes through, or encloses, are full. The box
//! around all of them is cut in two where that saves most empty space, and so on, until little is saved: a table becomes
//! its top and its legs, and a robot passes between them.

use crate::affine::{Vec3, add, cross, length, scale, sub};
use crate::model3d::Collision;
use crate::model3d::Mesh;

/// Most boxes of one body.
pub const MOST: usize = 24;
/// Most cells along an axis.
const CELLS: usize = 32;
/// A cut that saves less than this share of the first box is not made.
const SAVES: f64 = 0.01;
/// Thinnest box, m: sheets and panes collide too.
const THIN_M: f64 = 0.002;
/// Most points that one triangle is looked at in, along each of its sides.
const STEPS: f64 = 256.0;

/// Returns boxes around the parts of meshes, at most [`MOST`]; none without a triangle.
pub fn boxes(meshes: &[&Mesh]) -> Vec<Collision> {
    let Some(grid) = Grid::new(meshes) else { return Vec::new() };
    let Some(whole) = grid.part([0; 3], grid.count) else { return Vec::new() };
    let least = SAVES * whole.volume;
    let mut done: Vec<Part> = Vec::new();
    let mut open = vec![grid.cut(whole, least)];
    while let Some(at) = (0..open.len()).max_by(|&a, &b| open[a].1.total_cmp(&open[b].1)) {
        let (part, saved, halves) = open.swap_remove(at);
        match halves {
            Some([a, b]) if saved > least && done.len() + open.len() + 2 <= MOST => {
                open.push(grid.cut(a, least));
                open.push(grid.cut(b, least));
            }
            _ => done.push(part),
        }
    }
    done.sort_by_key(|part| part.low);
    done.into_iter().map(|part| part.shape()).collect()
}

/// The cells around a mesh.
struct Grid {
    count: [usize; 3],
    /// Size of a cell, m.
    widths: Vec3,
    cells: Vec<Cell>,
}

/// What is in a cell: nothing, or a box.
type Cell = Option<[Vec3; 2]>;

/// Some cells, and the box around what is in them.
#[derive(Clone, Copy)]
struct Part {
    low: [usize; 3],
    bounds: [Vec3; 2],
    high: [usize; 3],
    volume: f64,
}

impl Part {
    fn shape(&self) -> Collision {
        let [min, max] = self.bounds;
        let thin = |i: usize| ((THIN_M - (max[i] - min[i])) / 2.0).max(0.0);
        Collision::Box {
            min: std::array::from_fn(|i| min[i] - thin(i)),
            max: std::array::from_fn(|i| max[i] + thin(i)),
        }
    }
}

impl Grid {
    fn new(meshes: &[&Mesh]) -> Option<Self> {
        let [min, max] = meshes.iter().filter_map(|m| m.bounds()).reduce(|a, b| join(&a, &b))?;
        let size = sub(max, min);
        let largest = size.iter().copied().fold(0.0, f64::max);
        if !largest.is_finite() || largest <= 0.0 {
            return None;
        }
        let cell = largest / CELLS as f64;
        let count = size.map(|s| ((s / cell).ceil() as usize).clamp(1, CELLS));
        let widths: Vec3 = std::array::from_fn(|i| (size[i] / count[i] as f64).max(1e-12));
        let mut grid = Self { count, widths, cells: vec![None; count.iter().product()] };
        for mesh in meshes {
            for triangle in &mesh.triangles {
                let corner = |i: u32| mesh.positions.get(i as usize).map(|p| p.map(f64::from));
                let [Some(a), Some(b), Some(c)] = triangle.map(corner) else { continue };
                if [a, b, c].iter().flatten().all(|v| v.is_finite()) {
                    each_point([a, b, c], cell * 0.5, |p| {
                        let place = std::array::from_fn(|i| {
                            (((p[i] - min[i]) / widths[i]).max(0.0) as usize).min(count[i] - 1)
                        });
                        let index = grid.index(place);
                        let cell = &mut grid.cells[index];
                        *cell = Some(cell.map_or([p, p], |b| join(&b, &[p, p])));
                    });
                }
            }
        }
        grid.fill(min);
        Some(grid)
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.count[1] + y) * self.count[0] + x
    }

    /// Fills the cells that cannot be reached from outside.
    fn fill(&mut self, min: Vec3) {
        let widths = self.widths;
        let is_edge = |p: [usize; 3]| (0..3).any(|i| p[i] == 0 || p[i] + 1 == self.count[i]);
        let mut outside = vec![false; self.cells.len()];
        let mut open: Vec<[usize; 3]> = self.places([0; 3], self.count).filter(|p| is_edge(*p)).collect();
        open.retain(|p| self.cells[self.index(*p)].is_none());
        open.iter().for_each(|p| outside[self.index(*p)] = true);
        while let Some(at) = open.pop() {
            for i in 0..3 {
                for next in [at[i].checked_sub(1), Some(at[i] + 1).filter(|n| *n < self.count[i])].into_iter().flatten()
                {
                    let mut beside = at;
                    beside[i] = next;
                    let index = self.index(beside);
                    if !outside[index] && self.cells[index].is_none() {
                        outside[index] = true;
                        open.push(beside);
                    }
                }
            }
        }
        let all: Vec<[usize; 3]> = self.places([0; 3], self.count).collect();
        for place in all {
            let index = self.index(place);
            if self.cells[index].is_none() && !outside[index] {
                let low: Vec3 = std::array::from_fn(|i| min[i] + place[i] as f64 * widths[i]);
                self.cells[index] = Some([low, add(low, widths)]);
            }
        }
    }

    fn places(&self, low: [usize; 3], high: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [x, y, z] = [0, 1, 2].map(|i| low[i]..high[i]);
        z.flat_map(move |z| {
            let x = x.clone();
            y.clone().flat_map(move |y| x.clone().map(move |x| [x, y, z]))
        })
    }

    /// Returns the box around what is in some cells; none when they are empty.
    fn part(&self, low: [usize; 3], high: [usize; 3]) -> Option<Part> {
        let full = self.places(low, high).filter_map(|p| self.cells[self.index(p)]);
        let bounds = full.reduce(|a, b| join(&a, &b))?;
        Some(Part { low, high, bounds, volume: volume(&bounds) })
    }

    /// Returns a part with the cut that saves most, how much, and its halves. Where no cut saves much by itself, as between
    /// the top of a table and its legs, the halves are thought cut again.
    fn cut(&self, part: Part, least: f64) -> (Part, f64, Option<[Part; 2]>) {
        let saves = |halves: &[Part; 2]| part.volume - halves[0].volume - halves[1].volume;
        let best = self.best(&part, saves);
        if best.0 > least || self.is_full(&part) {
            return (part, best.0, best.1);
        }
        let again = |half: &Part| half.volume - self.best(half, |h| half.volume - h[0].volume - h[1].volume).0;
        let (saved, halves) = self.best(&part, |halves| part.volume - again(&halves[0]) - again(&halves[1]));
        (part, saved, halves)
    }

    fn is_full(&self, part: &Part) -> bool {
        self.places(part.low, part.high).all(|p| self.cells[self.index(p)].is_some())
    }

    /// Returns the halves of the best cut with what a function says they save.
    fn best(&self, part: &Part, saves: impl Fn(&[Part; 2]) -> f64) -> (f64, Option<[Part; 2]>) {
        let mut best: (f64, Option<[Part; 2]>) = (0.0, None);
        for axis in 0..3 {
            let layers: Vec<Cell> = (part.low[axis]..part.high[axis])
                .map(|layer| {
                    let (mut low, mut high) = (part.low, part.high);
                    (low[axis], high[axis]) = (layer, layer + 1);
                    self.part(low, high).map(|p| p.bounds)
                })
                .collect();
            let mut before: Vec<Cell> = Vec::with_capacity(layers.len());
            let mut after = before.clone();
            for (layer, back) in layers.iter().zip(layers.iter().rev()) {
                before.push(both(before.last().copied().flatten(), *layer));
                after.push(both(after.last().copied().flatten(), *back));
            }
            for cut in 1..layers.len() {
                let (Some(mut a), Some(mut b)) = (before[cut - 1], after[layers.len() - cut - 1]) else { continue };
                // Less than a cell between two halves is between the points looked at, not between parts.
                if b[0][axis] - a[1][axis] < self.widths[axis] {
                    let middle = (a[1][axis] + b[0][axis]) / 2.0;
                    (a[1][axis], b[0][axis]) = (middle, middle);
                }
                let (mut low, mut high) = (part.low, part.high);
                (low[axis], high[axis]) = (part.low[axis] + cut, part.low[axis] + cut);
                let halves = [
                    Part { low: part.low, high, bounds: a, volume: volume(&a) },
                    Part { low, high: part.high, bounds: b, volume: volume(&b) },
                ];
                let saved = saves(&halves);
                if saved > best.0 {
                    best = (saved, Some(halves));
                }
            }
        }
        best
    }
}

/// Visits points of a triangle that are no further than `step` apart, its corners among them.
fn each_point([a, b, c]: [Vec3; 3], step: f64, mut visit: impl FnMut(Vec3)) {
    let longest = [sub(b, a), sub(c, b), sub(a, c)].map(length).into_iter().fold(0.0, f64::max);
    let flat = length(cross(sub(b, a), sub(c, a))) <= 0.0;
    let steps = (longest / step).ceil().clamp(1.0, STEPS) as usize;
    for i in 0..=steps {
        for j in 0..=steps - i {
            let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
            visit(add(a, add(scale(sub(b, a), u), scale(sub(c, a), v))));
        }
        if flat && i == steps {
            break;
        }
    }
}

fn both(a: Option<[Vec3; 2]>, b: Option<[Vec3; 2]>) -> Option<[Vec3; 2]> {
    match (a, b) {
        (Some(a), Some(b)) => Some(join(&a, &b)),
        (one, other) => one.or(other),
    }
}

fn join(a: &[Vec3; 2], b: &[Vec3; 2]) -> [Vec3; 2] {
    [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]
}

/// Returns the volume of a box, whose thin sides count as thick as they collide, m^3.
fn volume([min, max]: &[Vec3; 2]) -> f64 {
    (0..3).map(|i| (max[i] - min[i]).max(THIN_M)).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cuboid([min, max]: [[f32; 3]; 2]) -> Mesh {
        let positions =
            (0..8).map(|k| std::array::from_fn(|i| if k >> i & 1 == 0 { min[i] } else { max[i] })).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh { positions, triangles, ..Mesh::default() }
    }

    #[test]
    fn a_table_becomes_its_top_and_its_legs() {
        let leg = |x: f32, y: f32| cuboid([[x, y, 0.0], [x + 0.05, y + 0.05, 0.72]]);
        let top = cuboid([[0.0, 0.0, 0.72], [1.6, 0.8, 0.75]]);
        let table = [top, leg(0.0, 0.0), leg(1.55, 0.0), leg(0.0, 0.75), leg(1.55, 0.75)];
        let found = boxes(&table.each_ref());
        assert!((5..=MOST).contains(&found.len()), "{found:?}");
        let inside = |p: Vec3| {
            found.iter().any(|s| {
                let [min, max] = s.bounds();
                (0..3).all(|i| p[i] > min[i] - 1e-9 && p[i] < max[i] + 1e-9)
            })
        };
        assert!(inside([0.8, 0.4, 0.74]) && inside([0.02, 0.02, 0.1]) && inside([1.58, 0.78, 0.5]));
        for free in [[0.8, 0.4, 0.3], [0.8, 0.02, 0.3], [0.02, 0.4, 0.3], [0.8, 0.4, 0.6]] {
            assert!(!inside(free), "{free:?} is between the legs: {found:?}");
        }
    }

    #[test]
    fn what_is_closed_is_solid_and_what_is_flat_has_a_box() {
        assert_eq!(boxes(&[&cuboid([[0.0; 3], [1.0, 0.5, 2.0]])]).len(), 1);
        let sheet = boxes(&[&cuboid([[0.0; 3], [1.0, 0.5, 0.0]])]);
        assert_eq!(sheet.len(), 1);
        assert!(sheet[0].bounds()[1][2] - sheet[0].bounds()[0][2] >= THIN_M - 1e-12);
        assert_eq!(boxes(&[&Mesh::default()]), []);
        assert_eq!(boxes(&[]), []);
    }
}
