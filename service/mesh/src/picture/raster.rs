//! Triangles to samples: depth, normal and color where a model is hit.

use super::View;
use crate::affine::{Vec3, add, cross, dot, scale, sub, unit};
use crate::{Material, Model3d};

/// Samples along each side of a pixel.
pub(super) const SAMPLES: usize = 2;
/// Share of the picture kept free at each side.
const MARGIN: f64 = 0.05;
/// Distance of the eye in radii of the model.
const DISTANCE: f64 = 6.0;

/// A square field of samples.
pub(super) struct Samples {
    pub side: usize,
    /// Nearness, 1 / distance in radii of the model; 0 where nothing is hit.
    pub near: Vec<f32>,
    /// Unit vector toward the eye's side, in the frame of the eye: right, up, toward it.
    pub normal: Vec<[f32; 3]>,
    /// Lit color, linear.
    pub color: Vec<[f32; 3]>,
    /// How much of the ground is hidden.
    pub cover: Vec<f32>,
}

/// A corner as the eye sees it.
#[derive(Clone, Copy)]
struct Seen {
    x: f32,
    y: f32,
    near: f32,
    normal: [f32; 3],
}

/// Where the eye is.
struct Eye {
    center: Vec3,
    right: Vec3,
    up: Vec3,
    toward: Vec3,
    radius: f64,
}

impl Eye {
    fn new(model: &Model3d, view: &View) -> Option<Self> {
        let [min, max] = model.bounds()?;
        let (side, above) = (view.right_deg.to_radians(), view.above_deg.to_radians());
        let toward = [side.sin() * above.cos(), -side.cos() * above.cos(), above.sin()];
        let right = [side.cos(), side.sin(), 0.0];
        let half = sub(max, min).map(|v| v / 2.0);
        Some(Self {
            center: scale(add(min, max), 0.5),
            right,
            up: cross(toward, right),
            toward,
            radius: dot(half, half).sqrt().max(1e-9),
        })
    }

    /// Returns the place on the picture plane in radii, and the nearness.
    fn project(&self, p: Vec3) -> [f64; 3] {
        let v = scale(sub(p, self.center), 1.0 / self.radius);
        let near = 1.0 / (DISTANCE - dot(v, self.toward));
        [dot(v, self.right) * DISTANCE * near, dot(v, self.up) * DISTANCE * near, near]
    }

    fn turn(&self, n: Vec3) -> [f32; 3] {
        [dot(n, self.right) as f32, dot(n, self.up) as f32, dot(n, self.toward) as f32]
    }
}

/// Draws the model, solid parts first, then clear ones from back to front.
pub(super) fn draw(model: &Model3d, side: usize, view: &View) -> Samples {
    let mut samples = Samples {
        side,
        near: vec![0.0; side * side],
        normal: vec![[0.0; 3]; side * side],
        color: vec![[0.0; 3]; side * side],
        cover: vec![0.0; side * side],
    };
    let Some(eye) = Eye::new(model, view) else { return samples };
    let plain = Material::default();
    let visuals: Vec<_> = model.bodies.iter().flat_map(|b| &b.visuals).collect();
    let seen: Vec<Vec<[f64; 3]>> =
        visuals.iter().map(|v| v.mesh.positions.iter().map(|p| eye.project(p.map(f64::from))).collect()).collect();
    let Some(place) = placement(&visuals, &seen, side) else { return samples };
    let mut clear: Vec<(f32, [Seen; 3], &Material)> = Vec::new();
    for (visual, seen) in visuals.iter().zip(&seen) {
        let material = visual.material.and_then(|m| model.materials.get(m)).unwrap_or(&plain);
        for triangle in &visual.mesh.triangles {
            let Some(corners) = corners(&eye, &visual.mesh, seen, triangle, &place) else { continue };
            if material.opacity < 0.99 {
                clear.push((corners.iter().map(|c| c.near).sum(), corners, material));
            } else {
                fill(&mut samples, &corners, material, &eye);
            }
        }
    }
    clear.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, corners, material) in &clear {
        fill(&mut samples, corners, material, &eye);
    }
    samples
}

/// Scale and shift from the picture plane to samples.
struct Place {
    scale: f64,
    x: f64,
    y: f64,
}

fn placement(visuals: &[&crate::Visual], seen: &[Vec<[f64; 3]>], side: usize) -> Option<Place> {
    let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
    for (visual, seen) in visuals.iter().zip(seen) {
        for p in visual.mesh.triangles.iter().flatten().filter_map(|i| seen.get(*i as usize)) {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
    }
    let extent = (high[0] - low[0]).max(high[1] - low[1]);
    if !extent.is_finite() || extent <= 0.0 {
        return None;
    }
    let side = side as f64;
    let scale = side * (1.0 - 2.0 * MARGIN) / extent;
    Some(Place {
        scale,
        x: side / 2.0 - scale * (low[0] + high[0]) / 2.0,
        y: side / 2.0 + scale * (low[1] + high[1]) / 2.0,
    })
}

/// Returns the corners of a triangle; none when an index is out of range.
fn corners(eye: &Eye, mesh: &crate::Mesh, seen: &[[f64; 3]], triangle: &[u32; 3], place: &Place) -> Option<[Seen; 3]> {
    let ids = triangle.map(|i| i as usize);
    let mut out = [Seen { x: 0.0, y: 0.0, near: 0.0, normal: [0.0; 3] }; 3];
    let mut flat = None;
    for (corner, i) in out.iter_mut().zip(ids) {
        let p = seen.get(i)?;
        let normal = match mesh.normals.get(i) {
            Some(n) => n.map(f64::from),
            None => *flat.get_or_insert_with(|| {
                let at = |i: usize| mesh.positions.get(i).map_or([0.0; 3], |p| p.map(f64::from));
                let [a, b, c] = ids.map(at);
                unit(cross(sub(b, a), sub(c, a)))
            }),
        };
        *corner = Seen {
            x: (place.x + place.scale * p[0]) as f32,
            y: (place.y - place.scale * p[1]) as f32,
            near: p[2] as f32,
            normal: eye.turn(normal),
        };
    }
    Some(out)
}

/// Fills the samples of a triangle that lie before what is there.
fn fill(samples: &mut Samples, [a, b, c]: &[Seen; 3], material: &Material, eye: &Eye) {
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if area.abs() < 1e-9 || !area.is_finite() {
        return;
    }
    let last = samples.side as f32 - 1.0;
    let range = |v: [f32; 3]| {
        let low = v[0].min(v[1]).min(v[2]);
        let high = v[0].max(v[1]).max(v[2]);
        ((low - 0.5).ceil().clamp(0.0, last) as usize, (high - 0.5).floor().clamp(-1.0, last) as isize)
    };
    let ((x0, x1), (y0, y1)) = (range([a.x, b.x, c.x]), range([a.y, b.y, c.y]));
    let inverse = 1.0 / area;
    let solid = material.opacity >= 0.99;
    for y in y0..=(y1.max(-1) + 1) as usize {
        if y as isize > y1 {
            break;
        }
        let py = y as f32 + 0.5;
        for x in x0..=(x1.max(-1) + 1) as usize {
            if x as isize > x1 {
                break;
            }
            let px = x as f32 + 0.5;
            let wb = ((px - a.x) * (c.y - a.y) - (py - a.y) * (c.x - a.x)) * inverse;
            let wc = ((b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x)) * inverse;
            let wa = 1.0 - wb - wc;
            if wa < -1e-5 || wb < -1e-5 || wc < -1e-5 {
                continue;
            }
            let near = wa * a.near + wb * b.near + wc * c.near;
            let at = y * samples.side + x;
            if near <= samples.near[at] {
                continue;
            }
            let mixed: [f32; 3] = std::array::from_fn(|k| wa * a.normal[k] + wb * b.normal[k] + wc * c.normal[k]);
            let normal = facing(mixed);
            let color = super::shade::light(normal, material, &eye_up(eye));
            if solid {
                samples.near[at] = near;
                samples.normal[at] = normal;
                samples.color[at] = color;
                samples.cover[at] = 1.0;
            } else {
                let share = material.opacity.clamp(0.05, 1.0);
                let (under, cover) = (samples.color[at], samples.cover[at]);
                let total = share + cover * (1.0 - share);
                samples.color[at] =
                    std::array::from_fn(|k| (color[k] * share + under[k] * cover * (1.0 - share)) / total);
                samples.cover[at] = total;
            }
        }
    }
}

/// Returns the unit normal on the side of the eye.
fn facing(n: [f32; 3]) -> [f32; 3] {
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt().max(1e-12);
    let sign = if n[2] < 0.0 { -1.0 } else { 1.0 };
    n.map(|v| v * sign / length)
}

/// Returns the world's up in the frame of the eye.
fn eye_up(eye: &Eye) -> [f32; 3] {
    [0.0, eye.up[2] as f32, eye.toward[2] as f32]
}
