//! Triangles in a tree of boxes, so that a ray meets few of them.

/// A corner of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub at: [f32; 3],
    pub normal: [f32; 3],
    pub uv: [f32; 2],
}

/// A triangle with what is needed where it is hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    at: [f32; 3],
    edges: [[f32; 3]; 2],
    normals: [[f32; 3]; 3],
    uvs: [[f32; 2]; 3],
    /// Normal of its plane, unit length.
    pub flat: [f32; 3],
    /// Index of its surface.
    pub surface: u32,
}

impl Triangle {
    /// Returns a triangle; none where it has no area.
    pub fn new([a, b, c]: [Corner; 3], surface: u32) -> Option<Self> {
        let edges = [minus(b.at, a.at), minus(c.at, a.at)];
        let flat = cross(edges[0], edges[1]);
        let length = dot(flat, flat).sqrt();
        if length <= 1e-12 || !length.is_finite() {
            return None;
        }
        let flat = flat.map(|v| v / length);
        let normals = [a, b, c].map(|p| if dot(p.normal, p.normal) > 0.25 { p.normal } else { flat });
        Some(Self { at: a.at, edges, normals, uvs: [a, b, c].map(|p| p.uv), flat, surface })
    }

    fn bounds(&self) -> [[f32; 3]; 2] {
        let others = self.edges.map(|e| plus(self.at, e));
        others.iter().fold([self.at; 2], |[low, high], p| {
            [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
        })
    }

    /// Returns normal and texture coordinates at shares of the second and third corner.
    pub fn mixed(&self, shares: [f32; 2]) -> ([f32; 3], [f32; 2]) {
        let all = [1.0 - shares[0] - shares[1], shares[0], shares[1]];
        let normal = std::array::from_fn(|i| (0..3).map(|k| self.normals[k][i] * all[k]).sum());
        let uv = std::array::from_fn(|i| (0..3).map(|k| self.uvs[k][i] * all[k]).sum());
        (normal, uv)
    }
}

/// A half line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub from: [f32; 3],
    pub toward: [f32; 3],
    inverse: [f32; 3],
}

impl Ray {
    pub fn new(from: [f32; 3], toward: [f32; 3]) -> Self {
        let inverse = toward.map(|v| 1.0 / if v.abs() < 1e-12 { 1e-12_f32.copysign(v) } else { v });
        Self { from, toward, inverse }
    }
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub distance: f32,
    pub triangle: usize,
    pub shares: [f32; 2],
}

/// Triangles of a leaf at most, and bins that cuts are looked for in.
const LEAF: usize = 4;
const BINS: usize = 12;

/// A box of the tree: a leaf when it has triangles.
struct Branch {
    bounds: [[f32; 3]; 2],
    /// First triangle of a leaf; else the second child, the first is next in the list.
    next: u32,
    count: u32,
}

/// The tree.
pub(super) struct Bvh {
    branches: Vec<Branch>,
    pub triangles: Vec<Triangle>,
}

impl Bvh {
    pub fn new(triangles: Vec<Triangle>) -> Self {
        let boxes: Vec<[[f32; 3]; 2]> = triangles.iter().map(Triangle::bounds).collect();
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut branches = Vec::with_capacity(triangles.len());
        if !order.is_empty() {
            grow(&mut branches, &boxes, &mut order, 0);
        }
        let triangles = order.iter().map(|i| triangles[*i as usize]).collect();
        Self { branches, triangles }
    }

    /// Returns the nearest triangle that a ray meets before `far` whose surface counts.
    pub fn nearest(&self, ray: &Ray, far: f32, counts: &dyn Fn(u32) -> bool) -> Option<Hit> {
        self.walk(ray, far, counts, false)
    }

    /// Returns whether a ray meets any triangle before `far` whose surface counts.
    pub fn meets(&self, ray: &Ray, far: f32, counts: &dyn Fn(u32) -> bool) -> bool {
        self.walk(ray, far, counts, true).is_some()
    }

    fn walk(&self, ray: &Ray, far: f32, counts: &dyn Fn(u32) -> bool, any: bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let mut limit = far;
        let mut open = [0_u32; 64];
        let mut depth = usize::from(!self.branches.is_empty());
        while depth > 0 {
            depth -= 1;
            let at = open[depth] as usize;
            let branch = &self.branches[at];
            if entry(&branch.bounds, ray) > limit {
                continue;
            }
            if branch.count > 0 {
                for i in branch.next as usize..(branch.next + branch.count) as usize {
                    if let Some(hit) = self.met(ray, i, limit)
                        && counts(self.triangles[i].surface)
                    {
                        limit = hit.distance;
                        best = Some(hit);
                        if any {
                            return best;
                        }
                    }
                }
                continue;
            }
            let (first, second) = (at as u32 + 1, branch.next);
            let near = |i: u32| entry(&self.branches[i as usize].bounds, ray);
            let (later, sooner) = if near(first) <= near(second) { (second, first) } else { (first, second) };
            for child in [later, sooner] {
                if depth < open.len() {
                    open[depth] = child;
                    depth += 1;
                }
            }
        }
        best
    }

    /// Möller and Trumbore, both sides.
    fn met(&self, ray: &Ray, index: usize, limit: f32) -> Option<Hit> {
        let t = &self.triangles[index];
        let p = cross(ray.toward, t.edges[1]);
        let det = dot(t.edges[0], p);
        if det.abs() < 1e-12 {
            return None;
        }
        let inverse = 1.0 / det;
        let way = minus(ray.from, t.at);
        let u = dot(way, p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = cross(way, t.edges[0]);
        let v = dot(ray.toward, q) * inverse;
        if v < 0.0 || u + v > 1.0 {
            return None;
        }
        let distance = dot(t.edges[1], q) * inverse;
        (distance > 1e-4 && distance < limit).then_some(Hit { distance, triangle: index, shares: [u, v] })
    }
}

/// Returns the distance at which a ray enters a box; infinite where it misses.
fn entry(bounds: &[[f32; 3]; 2], ray: &Ray) -> f32 {
    let (mut near, mut far) = (0.0_f32, f32::MAX);
    for (i, (low, high)) in bounds[0].iter().zip(&bounds[1]).enumerate() {
        let a = (low - ray.from[i]) * ray.inverse[i];
        let b = (high - ray.from[i]) * ray.inverse[i];
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    if near <= far { near } else { f32::INFINITY }
}

/// Adds the branch of these triangles and all below it; `order` is a piece of the list that begins at `first`.
fn grow(branches: &mut Vec<Branch>, boxes: &[[[f32; 3]; 2]], order: &mut [u32], first: u32) {
    let around = |list: &[u32]| {
        list.iter().fold([[f32::MAX; 3], [f32::MIN; 3]], |[low, high], i| {
            let [a, b] = &boxes[*i as usize];
            [std::array::from_fn(|k| low[k].min(a[k])), std::array::from_fn(|k| high[k].max(b[k]))]
        })
    };
    let at = branches.len();
    branches.push(Branch { bounds: around(order), next: first, count: order.len() as u32 });
    if order.len() <= LEAF {
        return;
    }
    let middle = cut(boxes, order);
    let (low, high) = order.split_at_mut(middle);
    branches[at].count = 0;
    grow(branches, boxes, low, first);
    branches[at].next = branches.len() as u32;
    grow(branches, boxes, high, first + middle as u32);
}

/// Sorts triangles into two parts by the cheapest of a few cuts along their longest side, and returns how many are in the first.
fn cut(boxes: &[[[f32; 3]; 2]], order: &mut [u32]) -> usize {
    let center = |i: u32, k: usize| boxes[i as usize][0][k] + boxes[i as usize][1][k];
    let range = |k: usize| {
        order.iter().fold((f32::MAX, f32::MIN), |(low, high), i| (low.min(center(*i, k)), high.max(center(*i, k))))
    };
    let ranges: [(f32, f32); 3] = std::array::from_fn(range);
    let axis =
        (0..3).max_by(|a, b| (ranges[*a].1 - ranges[*a].0).total_cmp(&(ranges[*b].1 - ranges[*b].0))).unwrap_or(0);
    let (low, high) = ranges[axis];
    let half = order.len() / 2;
    if high - low <= 1e-9 {
        return half;
    }
    let bin = |i: u32| (((center(i, axis) - low) / (high - low) * BINS as f32) as usize).min(BINS - 1);
    let mut bins = [([[f32::MAX; 3], [f32::MIN; 3]], 0_usize); BINS];
    for i in order.iter() {
        let (bounds, count) = &mut bins[bin(*i)];
        let [a, b] = &boxes[*i as usize];
        (0..3).for_each(|k| {
            bounds[0][k] = bounds[0][k].min(a[k]);
            bounds[1][k] = bounds[1][k].max(b[k]);
        });
        *count += 1;
    }
    let cost = |part: &[([[f32; 3]; 2], usize)]| {
        let (mut low, mut high, mut count) = ([f32::MAX; 3], [f32::MIN; 3], 0);
        for (bounds, n) in part.iter().filter(|p| p.1 > 0) {
            (0..3).for_each(|k| {
                low[k] = low[k].min(bounds[0][k]);
                high[k] = high[k].max(bounds[1][k]);
            });
            count += n;
        }
        let side = |k: usize| (high[k] - low[k]).max(0.0);
        if count == 0 { 0.0 } else { (side(0) * side(1) + side(1) * side(2) + side(2) * side(0)) * count as f32 }
    };
    let best = (1..BINS).min_by(|a, b| {
        let whole = |n: usize| cost(&bins[..n]) + cost(&bins[n..]);
        whole(*a).total_cmp(&whole(*b))
    });
    let best = best.unwrap_or(BINS / 2);
    // Stable: the order of what lies in one part is that of the list.
    order.sort_by_key(|i| bin(*i) >= best);
    let middle = order.iter().take_while(|i| bin(**i) < best).count();
    if middle == 0 || middle == order.len() { half } else { middle }
}

pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn plus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}
