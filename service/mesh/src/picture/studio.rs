//! Pictures of whole worlds: rays from the eye to what they hit, and from there to sun, sky and lamps.
//!
//! The same world and camera give the same bytes, whatever the number of threads. What it is not for: measuring light; the
//! exposure is chosen for each picture, as a camera does.

mod bvh;
mod light;
mod smooth;

use crate::affine::{Vec3, cross, sub, unit};
use crate::picture::Picture;
use crate::picture::texture::Cloth;
use crate::world3d::World3d;
use crate::world3d::{LampKind, Node};
use bvh::{Bvh, Corner, Hit, Ray, Triangle};
use light::{Lamp, Surface};

/// From where a world is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Place of the eye, m.
    pub eye: Vec3,
    /// A point in the middle of the picture, m.
    pub target: Vec3,
    /// Angle of view from the lower to the upper edge, degrees.
    pub view_deg: f64,
    /// Width and height, px.
    pub size_px: [usize; 2],
}

/// What lights a world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Daylight {
    /// Direction toward the sun.
    pub sun: Vec3,
    /// Light of the sun on a surface that faces it, linear.
    pub sunlight: [f32; 3],
    /// Light of the sky.
    pub sky: [f32; 3],
    /// Light that a closed room has without any lamp, by what comes back from its walls.
    pub within: f32,
    /// Share of their light that lamps give.
    pub lamps: f32,
    /// What is seen where there is nothing.
    pub behind: [f32; 3],
}

impl Daylight {
    /// Returns a clear day.
    pub fn day() -> Self {
        Self {
            sun: [-0.45, -0.35, 0.82],
            sunlight: [2.2, 2.1, 2.0],
            sky: [0.95, 1.0, 1.08],
            within: 0.42,
            lamps: 0.22,
            behind: [0.93, 0.95, 0.97],
        }
    }

    /// Returns a night in which lamps are on.
    pub fn night() -> Self {
        Self {
            sun: [0.3, -0.5, 0.8],
            sunlight: [0.02, 0.025, 0.04],
            sky: [0.02, 0.03, 0.06],
            within: 0.06,
            lamps: 1.0,
            behind: [0.01, 0.015, 0.03],
        }
    }
}

/// How much work a picture is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Rays a pixel.
    pub samples: usize,
    /// Threads that work on it.
    pub threads: usize,
}

/// A world set up for pictures.
pub struct Studio {
    bvh: Bvh,
    surfaces: Vec<Surface>,
    lamps: Vec<Lamp>,
}

impl Studio {
    /// Sets a world up, without the nodes of hidden layers and with what moves opened by a share of its range.
    pub fn new(world: &World3d, hidden: &[&str], openness: &dyn Fn(&Node) -> f64) -> Self {
        let places = world.places(openness);
        let mut surfaces: Vec<Surface> =
            world.materials.iter().map(|m| Surface::new(m, Cloth::of(m, &world.textures))).collect();
        surfaces.push(Surface::new(&crate::model3d::Material::default(), None));
        let mut is_hidden = vec![false; world.nodes.len()];
        let (mut triangles, mut lamps) = (Vec::new(), Vec::new());
        for (i, (node, place)) in world.nodes.iter().zip(&places).enumerate() {
            is_hidden[i] =
                hidden.contains(&node.layer.as_str()) || node.parent.is_some_and(|p| is_hidden.get(p) == Some(&true));
            if is_hidden[i] {
                continue;
            }
            if let Some(lamp) = node.lamp.filter(|l| l.kind == LampKind::Point) {
                lamps.push(Lamp::new(place.origin, &lamp));
            }
            let Some(mesh) = node.mesh.and_then(|m| world.meshes.get(m)) else { continue };
            for visual in &mesh.visuals {
                let surface = visual.material.filter(|m| *m < surfaces.len() - 1).unwrap_or(surfaces.len() - 1);
                let corner = |k: u32| {
                    let k = k as usize;
                    let at = place.point(visual.mesh.positions.get(k)?.map(f64::from));
                    let normal = visual.mesh.normals.get(k).map_or([0.0; 3], |n| place.vector(n.map(f64::from)));
                    let uv = visual.mesh.uvs.get(k).copied().unwrap_or_default();
                    Some(Corner { at: at.map(|v| v as f32), normal: normal.map(|v| v as f32), uv })
                };
                let made = visual.mesh.triangles.iter().filter_map(|t| {
                    let [a, b, c] = t.map(corner);
                    Triangle::new([a?, b?, c?], surface as u32)
                });
                triangles.extend(made);
            }
        }
        Self { bvh: Bvh::new(triangles), surfaces, lamps }
    }

    /// Returns how far a ray goes before it meets something that is not clear, m; none when it meets nothing.
    pub fn reach(&self, from: Vec3, toward: Vec3) -> Option<f64> {
        let ray = Ray::new(from.map(|v| v as f32), unit(sub(toward, from)).map(|v| v as f32));
        self.bvh.nearest(&ray, f32::MAX, &|t| self.surfaces[t as usize].is_solid()).map(|h| f64::from(h.distance))
    }

    /// Draws a picture.
    pub fn picture(&self, camera: &Camera, daylight: &Daylight, effort: Effort) -> Picture {
        let [width, height] = camera.size_px.map(|v| v.clamp(1, 8192));
        let view = View::new(camera, width, height);
        let mut pixels = vec![light::Pixel::default(); width * height];
        let threads = effort.threads.clamp(1, 64);
        // Rows are dealt out in turn, so that threads have equally much to do.
        let rows: Vec<(usize, &mut [light::Pixel])> = pixels.chunks_mut(width).enumerate().collect();
        let mut shares: Vec<Vec<(usize, &mut [light::Pixel])>> = (0..threads).map(|_| Vec::new()).collect();
        rows.into_iter().for_each(|row| shares[row.0 % threads].push(row));
        std::thread::scope(|scope| {
            for share in shares {
                let view = &view;
                scope.spawn(move || {
                    for (y, row) in share {
                        for (x, pixel) in row.iter_mut().enumerate() {
                            *pixel = self.pixel(view, daylight, effort.samples.max(1), x, y);
                        }
                    }
                });
            }
        });
        smooth::developed(&mut pixels, width, height)
    }

    fn pixel(&self, view: &View, daylight: &Daylight, samples: usize, x: usize, y: usize) -> light::Pixel {
        let mut sum = light::Pixel::default();
        for sample in 0..samples {
            let mut dice = light::Dice::new(x, y, sample);
            let (dx, dy) = if samples == 1 { (0.5, 0.5) } else { dice.pair() };
            let ray = view.ray(x as f32 + dx, y as f32 + dy);
            sum.add(&self.seen(ray, daylight, &mut dice));
        }
        sum.scaled(1.0 / samples as f32)
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        self.bvh.nearest(ray, f32::MAX, &|_| true)
    }
}

/// A camera ready to send rays.
struct View {
    eye: [f32; 3],
    corner: [f32; 3],
    right: [f32; 3],
    down: [f32; 3],
}

impl View {
    fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let forward = unit(sub(camera.target, camera.eye));
        let up = if forward[2].abs() > 0.999 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let right = unit(cross(forward, up));
        let upward = cross(right, forward);
        let tall = 2.0 * (camera.view_deg.clamp(1.0, 150.0).to_radians() / 2.0).tan();
        let step = tall / height as f64;
        let wide = step * width as f64;
        let single = |v: Vec3| v.map(|v| v as f32);
        Self {
            eye: single(camera.eye),
            corner: single(std::array::from_fn(|i| forward[i] - right[i] * wide / 2.0 + upward[i] * tall / 2.0)),
            right: single(right.map(|v| v * step)),
            down: single(upward.map(|v| -v * step)),
        }
    }

    fn ray(&self, x: f32, y: f32) -> Ray {
        let toward: [f32; 3] = std::array::from_fn(|i| self.corner[i] + self.right[i] * x + self.down[i] * y);
        Ray::new(self.eye, light::unit(toward))
    }
}

#[cfg(test)]
mod tests;
