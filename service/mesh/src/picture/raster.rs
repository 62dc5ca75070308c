//! Triangles to samples: depth, normal and color where a model is hit.

use super::View;
use super::shade::Light;
use super::texture::Cloth;
use crate::affine::{Vec3, add, cross, dot, scale, sub, unit};
use crate::model3d::Model3d;

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
    /// Number of the material of the solid surface seen, counted from 1; 0 for none.
    pub material: Vec<u16>,
    /// Color of the picture that it wears there; none at all where no picture is worn.
    pub cloth: Vec<Option<[f32; 3]>>,
    /// Clear surfaces before it, nearest first to last: their light with the share they hide.
    pub veil: Vec<Veil>,
    /// The world's up in the frame of the eye.
    pub up: [f32; 3],
}

/// Light of the clear surfaces before a sample and the share of what is behind that they hide.
#[derive(Clone, Copy, Default)]
pub(super) struct Veil {
    pub color: [f32; 3],
    pub hides: f32,
}

/// A corner as the eye sees it.
#[derive(Clone, Copy)]
struct Seen {
    x: f32,
    y: f32,
    near: f32,
    normal: [f32; 3],
    uv: [f32; 2],
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
pub(super) fn draw(model: &Model3d, lights: &[Light], cloths: &[Option<Cloth>], side: usize, view: &View) -> Samples {
    let mut samples = Samples {
        side,
        near: vec![0.0; side * side],
        normal: vec![[0.0; 3]; side * side],
        material: vec![0; side * side],
        cloth: Vec::new(),
        veil: Vec::new(),
        up: [0.0, 1.0, 0.0],
    };
    let Some(eye) = Eye::new(model, view) else { return samples };
    samples.up = [0.0, eye.up[2] as f32, eye.toward[2] as f32];
    let visuals: Vec<_> = model.bodies.iter().flat_map(|b| &b.visuals).collect();
    let seen: Vec<Vec<[f64; 3]>> =
        visuals.iter().map(|v| v.mesh.positions.iter().map(|p| eye.project(p.map(f64::from))).collect()).collect();
    let Some(place) = placement(&visuals, &seen, side) else { return samples };
    let mut clear: Vec<(f32, [Seen; 3], usize)> = Vec::new();
    if cloths.iter().any(Option::is_some) {
        samples.cloth = vec![None; side * side];
    }
    for (visual, seen) in visuals.iter().zip(&seen) {
        // The last light is that of surfaces without material.
        let known = |m: &usize| *m < model.materials.len().min(usize::from(u16::MAX) - 1);
        let material = visual.material.filter(known).unwrap_or(lights.len() - 1);
        for triangle in &visual.mesh.triangles {
            let Some(corners) = corners(&eye, &visual.mesh, seen, triangle, &place) else { continue };
            if lights[material].opacity < 0.99 {
                clear.push((corners.iter().map(|c| c.near).sum(), corners, material));
            } else {
                let cloth = cloths.get(material).and_then(Option::as_ref).filter(|_| !visual.mesh.uvs.is_empty());
                fill(&corners, side, |at, near, shares| {
                    if near > samples.near[at] {
                        samples.near[at] = near;
                        samples.normal[at] = facing(mixed(&corners.map(|c| c.normal), shares));
                        samples.material[at] = material as u16 + 1;
                        if let Some(color) = samples.cloth.get_mut(at) {
                            *color = cloth.map(|c| c.at(mixed(&corners.map(|c| c.uv), shares)));
                        }
                    }
                });
            }
        }
    }
    if !clear.is_empty() {
        samples.veil = vec![Veil::default(); side * side];
    }
    clear.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, corners, material) in &clear {
        let light = &lights[*material];
        let share = light.opacity.clamp(0.05, 1.0);
        let cloth = cloths.get(*material).and_then(Option::as_ref);
        fill(corners, side, |at, near, shares| {
            if near > samples.near[at] {
                let normal = facing(mixed(&corners.map(|c| c.normal), shares));
                let worn = cloth.map(|c| c.at(mixed(&corners.map(|c| c.uv), shares)));
                let color = light.on(normal, &samples.up, worn);
                let veil = &mut samples.veil[at];
                veil.color = std::array::from_fn(|k| color[k] * share + veil.color[k] * (1.0 - share));
                veil.hides = share + veil.hides * (1.0 - share);
            }
        });
    }
    samples
}

/// Scale and shift from the picture plane to samples.
struct Place {
    scale: f64,
    x: f64,
    y: f64,
}

fn placement(visuals: &[&crate::model3d::Visual], seen: &[Vec<[f64; 3]>], side: usize) -> Option<Place> {
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
fn corners(
    eye: &Eye,
    mesh: &crate::model3d::Mesh,
    seen: &[[f64; 3]],
    triangle: &[u32; 3],
    place: &Place,
) -> Option<[Seen; 3]> {
    let ids = triangle.map(|i| i as usize);
    let mut out = [Seen { x: 0.0, y: 0.0, near: 0.0, normal: [0.0; 3], uv: [0.0; 2] }; 3];
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
            uv: mesh.uvs.get(i).copied().unwrap_or_default(),
        };
    }
    Some(out)
}

/// Visits the samples that a triangle covers, with their nearness and the shares of its corners.
fn fill([a, b, c]: &[Seen; 3], side: usize, mut visit: impl FnMut(usize, f32, [f32; 3])) {
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if area.abs() < 1e-9 || !area.is_finite() {
        return;
    }
    let range = |p: f32, q: f32, r: f32| {
        let (low, high) = (p.min(q).min(r), p.max(q).max(r));
        let end = (high + 0.5).floor().clamp(0.0, side as f32) as usize;
        ((low - 0.5).ceil().clamp(0.0, side as f32) as usize)..end
    };
    let (columns, rows) = (range(a.x, b.x, c.x), range(a.y, b.y, c.y));
    let inverse = 1.0 / area;
    // Shares of b and c change by these from sample to sample.
    let (step_b, step_c) = ((c.y - a.y) * inverse, -(b.y - a.y) * inverse);
    for y in rows {
        let (py, px) = (y as f32 + 0.5 - a.y, columns.start as f32 + 0.5 - a.x);
        let mut wb = (px * (c.y - a.y) - py * (c.x - a.x)) * inverse;
        let mut wc = ((b.x - a.x) * py - (b.y - a.y) * px) * inverse;
        for x in columns.clone() {
            let wa = 1.0 - wb - wc;
            if wa >= -1e-4 && wb >= -1e-4 && wc >= -1e-4 {
                let near = wa * a.near + wb * b.near + wc * c.near;
                visit(y * side + x, near, [wa, wb, wc]);
            }
            wb += step_b;
            wc += step_c;
        }
    }
}

/// Returns what three corners have, mixed by shares.
fn mixed<const N: usize>([a, b, c]: &[[f32; N]; 3], [wa, wb, wc]: [f32; 3]) -> [f32; N] {
    std::array::from_fn(|k| wa * a[k] + wb * b[k] + wc * c[k])
}

/// Returns the unit normal on the side of the eye.
fn facing(n: [f32; 3]) -> [f32; 3] {
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt().max(1e-12);
    let sign = if n[2] < 0.0 { -1.0 } else { 1.0 };
    n.map(|v| v * sign / length)
}
