//! Walls that lean by a few degrees become upright: the ends that they share move together, so that nothing comes apart.

use std::collections::BTreeMap;

use d3dgen_model::Point;

/// Largest lean that is straightened, as rise over run: ten degrees.
const SLOPE: f64 = 0.176;
/// The same for doors, which have to lie in a wall: almost half a right angle.
const DOOR_SLOPE: f64 = 0.9;
/// Least lean worth a change, m, and as rise over run: `clean` takes less for upright.
const LEAN_M: f64 = 0.02;
const LEAN_SLOPE: f64 = 0.01;
/// Ends that move together lie at most this far apart, m; a wall that would need more keeps its lean.
const SPREAD_M: f64 = 0.6;
/// Most pairs of edges and ends that are compared.
const MOST_PAIRS: usize = 20_000_000;

/// A run of walls.
pub(crate) struct Chain {
    pub points: Vec<Point>,
    pub closed: bool,
    /// True for a door.
    pub door: bool,
}

/// What was done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Done {
    /// Walls that were upright before, within this angle, rad.
    pub lean_rad: f64,
    /// Farthest that an end moved, m.
    pub shift_m: f64,
}

/// Straightens chains whose ends are one when they are closer than `weld`, m; `None` when nothing leans.
pub(crate) fn straighten(chains: &mut [Chain], weld: f64) -> Option<Done> {
    let limit = |door: bool| if door { DOOR_SLOPE } else { SLOPE };
    let any = chains.iter().any(|c| edges(c).any(|(a, b)| leans(a, b).is_some_and(|s| s <= limit(c.door))));
    if !any {
        return None;
    }
    let mut nodes = Nodes::new(weld);
    let mut runs: Vec<Vec<usize>> = chains.iter().map(|c| c.points.iter().map(|p| nodes.at(*p)).collect()).collect();
    split(chains, &mut runs, &nodes.points, weld);
    // edges by their lean, so that those that are upright decide where the others go
    let mut list: Vec<(f64, usize, usize, bool)> = Vec::new();
    for (chain, run) in chains.iter().zip(&runs) {
        let n = run.len();
        for i in 0..if chain.closed { n } else { n.saturating_sub(1) } {
            let (a, b) = (run[i], run[(i + 1) % n]);
            let (p, q) = (nodes.points[a], nodes.points[b]);
            let (dx, dy) = ((p.x - q.x).abs(), (p.y - q.y).abs());
            let slope = dx.min(dy) / dx.max(dy).max(1e-9);
            if a != b && slope <= limit(chain.door) {
                list.push((if chain.door { 0.0 } else { slope }, a, b, dx < dy));
            }
        }
    }
    list.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut axes = [Groups::new(&nodes.points, |p| p.y), Groups::new(&nodes.points, |p| p.x)];
    let mut lean: f64 = 0.0;
    for (slope, a, b, vertical) in list {
        let weight = nodes.points[a].distance(nodes.points[b]);
        if axes[usize::from(vertical)].join(a, b, weight) && slope > LEAN_SLOPE {
            lean = lean.max(slope);
        }
    }
    let moved: Vec<Point> = (0..nodes.points.len()).map(|i| Point::new(axes[1].value(i), axes[0].value(i))).collect();
    let shift = nodes.points.iter().zip(&moved).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    for (chain, run) in chains.iter_mut().zip(runs) {
        chain.points = run.into_iter().map(|i| moved[i]).collect();
    }
    Some(Done { lean_rad: lean.atan(), shift_m: shift })
}

fn edges(chain: &Chain) -> impl Iterator<Item = (Point, Point)> + '_ {
    let n = chain.points.len();
    let count = if chain.closed { n } else { n.saturating_sub(1) };
    (0..count).map(move |i| (chain.points[i], chain.points[(i + 1) % n]))
}

/// Returns how much an edge leans, rise over run, when it does.
fn leans(a: Point, b: Point) -> Option<f64> {
    let (dx, dy) = ((a.x - b.x).abs(), (a.y - b.y).abs());
    let (rise, run) = (dx.min(dy), dx.max(dy));
    (rise > LEAN_M && rise > LEAN_SLOPE * run).then(|| rise / run.max(1e-9))
}

/// Ends of walls, each once.
struct Nodes {
    points: Vec<Point>,
    weld: f64,
    by_cell: BTreeMap<(i64, i64), Vec<usize>>,
}

impl Nodes {
    fn new(weld: f64) -> Self {
        Self { points: Vec::new(), weld, by_cell: BTreeMap::new() }
    }

    fn at(&mut self, p: Point) -> usize {
        let cell = ((p.x / self.weld).floor() as i64, (p.y / self.weld).floor() as i64);
        for dx in -1..=1 {
            for dy in -1..=1 {
                let list = self.by_cell.get(&(cell.0 + dx, cell.1 + dy));
                if let Some(i) = list.into_iter().flatten().find(|i| self.points[**i].distance(p) <= self.weld) {
                    return *i;
                }
            }
        }
        self.points.push(p);
        self.by_cell.entry(cell).or_default().push(self.points.len() - 1);
        self.points.len() - 1
    }
}

/// Lets walls pass through the ends of other walls that lie on them.
fn split(chains: &[Chain], runs: &mut [Vec<usize>], points: &[Point], weld: f64) {
    if runs.iter().map(Vec::len).sum::<usize>().saturating_mul(points.len()) > MOST_PAIRS {
        return;
    }
    for (chain, run) in chains.iter().zip(runs) {
        let n = run.len();
        let mut out = Vec::with_capacity(n);
        for i in 0..n {
            out.push(run[i]);
            if i + 1 == n && !chain.closed {
                break;
            }
            let (from, to) = (run[i], run[(i + 1) % n]);
            let (a, b) = (points[from], points[to]);
            let length = a.distance(b);
            if length <= 2.0 * weld {
                continue;
            }
            let (ux, uy) = ((b.x - a.x) / length, (b.y - a.y) / length);
            let on = |k: &usize| {
                let (x, y) = (points[*k].x - a.x, points[*k].y - a.y);
                let (along, off) = (x * ux + y * uy, (x * uy - y * ux).abs());
                (off <= weld && along > weld && along < length - weld).then_some((along, *k))
            };
            let mut between: Vec<(f64, usize)> = (0..points.len()).filter_map(|k| on(&k)).collect();
            between.sort_by(|p, q| p.0.total_cmp(&q.0));
            out.extend(between.into_iter().map(|b| b.1));
        }
        *run = out;
    }
}

/// Ends that share one coordinate.
struct Groups {
    parent: Vec<usize>,
    /// Least and greatest coordinate, and its sum and weight by the walls between, of each group's head.
    range: Vec<[f64; 2]>,
    sum: Vec<[f64; 2]>,
    at: Vec<f64>,
}

impl Groups {
    fn new(points: &[Point], pick: fn(&Point) -> f64) -> Self {
        let at: Vec<f64> = points.iter().map(pick).collect();
        let range = at.iter().map(|v| [*v, *v]).collect();
        Self { parent: (0..at.len()).collect(), range, sum: vec![[0.0, 0.0]; at.len()], at }
    }

    fn head(&self, mut i: usize) -> usize {
        while self.parent[i] != i {
            i = self.parent[i];
        }
        i
    }

    /// Joins two ends, unless their group would spread too far; returns whether.
    fn join(&mut self, a: usize, b: usize, weight: f64) -> bool {
        let (p, q) = (self.head(a), self.head(b));
        let range = [self.range[p][0].min(self.range[q][0]), self.range[p][1].max(self.range[q][1])];
        if range[1] - range[0] > SPREAD_M {
            return false;
        }
        let (low, high) = (p.min(q), p.max(q));
        if low != high {
            self.parent[high] = low;
            self.sum[low] = [self.sum[low][0] + self.sum[high][0], self.sum[low][1] + self.sum[high][1]];
            self.range[low] = range;
        }
        let middle = (self.at[a] + self.at[b]) / 2.0;
        self.sum[low] = [self.sum[low][0] + middle * weight, self.sum[low][1] + weight];
        true
    }

    fn value(&self, i: usize) -> f64 {
        let head = self.head(i);
        let [sum, weight] = self.sum[head];
        if weight > 0.0 { sum / weight } else { self.at[i] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(points: &[(f64, f64)]) -> Chain {
        Chain { points: points.iter().map(|p| Point::new(p.0, p.1)).collect(), closed: false, door: false }
    }

    #[test]
    fn walls_that_lean_move_with_the_walls_they_meet() {
        let mut chains = vec![
            open(&[(0.0, 0.0), (6.0, 0.3)]),
            open(&[(6.0, 0.3), (6.1, 4.0)]),
            // ends on the first wall without a corner of its own there
            open(&[(3.0, 0.15), (3.0, 4.0)]),
        ];
        let done = straighten(&mut chains, 0.05).expect("they lean");
        assert!(done.shift_m < 0.2 && done.lean_rad.to_degrees() < 3.0, "{done:?}");
        let [first, second, third] = &chains[..] else { panic!() };
        assert!(first.points.iter().all(|p| (p.y - first.points[0].y).abs() < 1e-9), "{:?}", first.points);
        assert_eq!(first.points.last(), second.points.first());
        assert!((second.points[0].x - second.points[1].x).abs() < 1e-9);
        assert!((third.points[0].y - first.points[0].y).abs() < 1e-9);
    }

    #[test]
    fn upright_walls_and_slanted_ones_stay() {
        assert_eq!(straighten(&mut [open(&[(0.0, 0.0), (6.0, 0.01)])], 0.05), None);
        assert_eq!(straighten(&mut [open(&[(0.0, 0.0), (6.0, 3.0)])], 0.05), None);
    }
}
