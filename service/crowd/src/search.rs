//! Ways over the lattice of a storey.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use d3dgen_model::Point;

use crate::space::{STEP_M, Space};

/// Free floor beside somebody beyond its radius that is worth a way around, m, and how much dearer a way without any is.
const EASY_M: f64 = 0.3;
const TIGHT: f64 = 0.8;
/// Free floor beside ways that are pulled straight, m.
const PULL_PLAY_M: f64 = 0.1;

/// Costs of nodes from where a search began, in units of a tenth of a millimeter.
pub struct Field {
    costs: BTreeMap<usize, u32>,
    before: BTreeMap<usize, usize>,
}

/// Returns the cost of a step onto a node, in tenths of millimeters.
fn cost(space: &Space, n: usize, far: f64, radius: f64) -> u32 {
    let play = ((space.clear(n) - radius) / EASY_M).clamp(0.0, 1.0);
    (far * (1.0 + TIGHT * (1.0 - play)) * 1e4) as u32
}

/// Searches from a node over all nodes that may be entered, to one of them or to all, up to a cost (m).
pub fn search(
    space: &Space,
    from: usize,
    radius: f64,
    may: impl Fn(usize) -> bool,
    done: impl Fn(usize) -> bool,
    most_m: f64,
) -> (Field, Option<usize>) {
    let mut field = Field { costs: BTreeMap::from([(from, 0)]), before: BTreeMap::new() };
    let mut open = BinaryHeap::from([Reverse((0_u32, from))]);
    let most = (most_m * 1e4).min(f64::from(u32::MAX)) as u32;
    while let Some(Reverse((so_far, n))) = open.pop() {
        if field.costs.get(&n).is_some_and(|known| *known < so_far) {
            continue;
        }
        if done(n) {
            return (field, Some(n));
        }
        for (m, far) in space.around(n) {
            let next = so_far + cost(space, m, far, radius);
            if next <= most
                && space.clear(m) >= radius
                && may(m)
                && field.costs.get(&m).is_none_or(|known| next < *known)
            {
                field.costs.insert(m, next);
                field.before.insert(m, n);
                open.push(Reverse((next, m)));
            }
        }
    }
    (field, None)
}

impl Field {
    /// Returns the cost of a node, m.
    pub fn cost(&self, n: usize) -> Option<f64> {
        self.costs.get(&n).map(|c| f64::from(*c) / 1e4)
    }

    /// Returns all nodes that were reached, with their costs, m.
    pub fn all(&self) -> impl Iterator<Item = (f64, usize)> + '_ {
        self.costs.iter().map(|(n, c)| (f64::from(*c) / 1e4, *n))
    }

    /// Returns the nodes from one back to where the search began.
    pub fn back(&self, n: usize) -> Vec<usize> {
        let mut out = vec![n];
        while let Some(&before) = self.before.get(&out[out.len() - 1]) {
            out.push(before);
        }
        out
    }

    /// Returns the node with a cost that is nearest to a point.
    pub fn nearest(&self, space: &Space, p: Point) -> Option<usize> {
        let n = space.node(p);
        if self.costs.contains_key(&n) {
            return Some(n);
        }
        let near = self.costs.keys().filter(|m| space.point(**m).distance(p) < 12.0 * STEP_M);
        near.min_by(|a, b| space.point(**a).distance(p).total_cmp(&space.point(**b).distance(p))).copied()
    }
}

/// Returns the corners of a way over nodes, pulled straight where that leaves the play that the nodes have.
pub fn pull(space: &Space, nodes: &[usize], radius: f64) -> Vec<Point> {
    let mut out = Vec::new();
    let Some(&first) = nodes.first() else { return out };
    out.push(space.point(first));
    let mut at = 0;
    while at + 1 < nodes.len() {
        let sees = |to: usize| {
            let least = nodes[at..=to].iter().map(|n| space.clear(*n)).fold(radius + PULL_PLAY_M, f64::min);
            let (a, b) = (space.point(nodes[at]), space.point(nodes[to]));
            space.obstacles.along(a, b, least) >= least - 1e-6
        };
        // ever longer strides, then back to the last that sees
        let mut far = 1;
        while at + 2 * far < nodes.len() && sees(at + 2 * far) {
            far *= 2;
        }
        let (mut low, mut high) = (at + far, (at + 2 * far).min(nodes.len() - 1));
        if sees(high) {
            low = high;
        }
        while high > low + 1 {
            let middle = (low + high) / 2;
            if sees(middle) { low = middle } else { high = middle }
        }
        at = low.max(at + 1);
        out.push(space.point(nodes[at]));
    }
    out
}

/// Leaves out corners of a way that it does without.
pub fn shorten(space: &Space, way: &mut Vec<Point>, radius: f64) {
    let mut k = 1;
    while k + 1 < way.len() {
        let most = radius + PULL_PLAY_M;
        let now = space.obstacles.along(way[k - 1], way[k], most).min(space.obstacles.along(way[k], way[k + 1], most));
        if space.obstacles.along(way[k - 1], way[k + 1], most) >= now - 1e-6 {
            way.remove(k);
            k = k.saturating_sub(1).max(1);
        } else {
            k += 1;
        }
    }
}
