//! What a ray sees: the light of sun, sky, lamps and neighbors on the surface that it meets.

use super::bvh::{Hit, Ray, cross, dot};
use super::{Daylight, Studio};
use crate::model3d::Material;
use crate::picture::texture::Cloth;
use crate::world3d;

/// How many clear surfaces a ray goes through.
const PANES: usize = 6;
/// How far away what is around a place gives it light or shade, m.
const AROUND_M: f32 = 6.0;
/// How far from the middle of a lamp its light starts, m: its shade and bulb hide nothing.
const BULB_M: f32 = 0.35;
/// Radius of the soft light of a lamp, m, and the sine of the sun's soft edge.
const LAMP_M: f32 = 0.12;
const SUN_EDGE: f32 = 0.02;
/// Lamps that light a place at most, and how far they shine, m.
const LAMPS: usize = 4;
const SHINES_M: f32 = 9.0;
/// Flux that is as bright as 1, lm over m^2 and sr.
const LUMENS: f32 = 260.0;

/// A surface, ready for light.
pub(super) struct Surface {
    color: [f32; 3],
    cloth: Option<Cloth>,
    /// Texture coordinates a picture.
    size: [f32; 2],
    opacity: f32,
    metal: f32,
    rough: f32,
    emits: [f32; 3],
}

impl Surface {
    pub fn new(material: &Material, cloth: Option<Cloth>) -> Self {
        let own = cloth.is_some() && material.worn().is_none();
        Self {
            color: if own {
                [1.0; 3]
            } else if cloth.is_some() {
                material.factor()
            } else {
                material.base_color
            },
            cloth,
            size: material.worn().map_or([1.0; 2], |f| f.size_m.map(|v| v as f32)),
            opacity: material.opacity.clamp(0.0, 1.0),
            metal: material.metallic.clamp(0.0, 1.0),
            rough: material.roughness.clamp(0.0, 1.0),
            emits: material.emissive,
        }
    }

    pub fn is_solid(&self) -> bool {
        self.opacity > 0.9
    }

    fn at(&self, uv: [f32; 2]) -> [f32; 3] {
        match &self.cloth {
            Some(cloth) => {
                let seen = cloth.at([uv[0] / self.size[0], uv[1] / self.size[1]]);
                std::array::from_fn(|k| seen[k] * self.color[k])
            }
            None => self.color,
        }
    }
}

/// A lamp.
pub(super) struct Lamp {
    at: [f32; 3],
    color: [f32; 3],
}

impl Lamp {
    pub fn new(at: [f64; 3], lamp: &world3d::Lamp) -> Self {
        let strength = lamp.strength as f32 / LUMENS;
        Self { at: at.map(|v| v as f32), color: lamp.color.map(|v| v * strength) }
    }
}

/// What is gathered for a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pixel {
    /// Color of the surface.
    pub color: [f32; 3],
    /// Light on it, times which its color is seen.
    pub light: [f32; 3],
    /// Light that comes as it is: glosses, lamps, panes, the sky.
    pub direct: [f32; 3],
    /// Where it is seen, for smoothing: normal and distance.
    pub normal: [f32; 3],
    pub distance: f32,
}

impl Pixel {
    pub fn add(&mut self, other: &Self) {
        for k in 0..3 {
            self.color[k] += other.color[k];
            self.light[k] += other.light[k];
            self.direct[k] += other.direct[k];
            self.normal[k] += other.normal[k];
        }
        self.distance += other.distance;
    }

    pub fn scaled(mut self, by: f32) -> Self {
        for list in [&mut self.color, &mut self.light, &mut self.direct, &mut self.normal] {
            list.iter_mut().for_each(|v| *v *= by);
        }
        self.distance *= by;
        self
    }
}

/// Even figures for a sample of a pixel: a hash of it, then steps of the R2 sequence.
pub(super) struct Dice {
    start: [u32; 2],
    sample: u32,
    turn: u32,
}

impl Dice {
    pub fn new(x: usize, y: usize, sample: usize) -> Self {
        let mix = |salt: u32| {
            let mut h = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ salt;
            h ^= h >> 16;
            h = h.wrapping_mul(0x7feb_352d);
            h ^= h >> 15;
            h = h.wrapping_mul(0x846c_a68b);
            h ^ (h >> 16)
        };
        Self { start: [mix(0x51ed_270b), mix(0xa2c2_ae3d)], sample: sample as u32, turn: 0 }
    }

    /// Returns two figures from 0 to 1.
    pub fn pair(&mut self) -> (f32, f32) {
        self.turn += 1;
        // Fractions of the plastic number: the next point is far from those before it.
        let step = |start: u32, by: u32| {
            let spread = start.wrapping_add(self.turn.wrapping_mul(0x6c8e_9cf5)).rotate_left(self.turn * 7);
            spread.wrapping_add(self.sample.wrapping_mul(by)) >> 8
        };
        let unit = |v: u32| v as f32 / 16_777_216.0;
        (unit(step(self.start[0], 0xc13f_a9a9)), unit(step(self.start[1], 0x91e1_0da5)))
    }
}

impl Studio {
    /// Returns what a ray sees, through clear surfaces.
    pub(super) fn seen(&self, mut ray: Ray, daylight: &Daylight, dice: &mut Dice) -> Pixel {
        let mut pixel = Pixel::default();
        let mut left = 1.0;
        let mut gone = 0.0;
        for _ in 0..PANES {
            let Some(hit) = self.hit(&ray) else { break };
            let place = self.place(&ray, &hit);
            gone += hit.distance;
            let surface = &self.surfaces[place.surface];
            if surface.is_solid() {
                self.solid(&place, &ray, daylight, dice, left, &mut pixel);
                pixel.distance = gone;
                return pixel;
            }
            // A pane: a tint of its own light and a reflection of the sky, the rest comes from behind it.
            let facing = dot(place.normal, ray.toward).abs();
            let mirrored = fresnel(facing, 0.04) * 0.6;
            let share = (surface.opacity * 0.6 + mirrored).min(0.9);
            let color = surface.at(place.uv);
            let glow: [f32; 3] = std::array::from_fn(|k| color[k] * daylight.sky[k] * 0.5 + surface.emits[k]);
            (0..3).for_each(|k| pixel.direct[k] += left * share * glow[k]);
            left *= 1.0 - share;
            ray = Ray::new(place.at, ray.toward);
        }
        (0..3).for_each(|k| pixel.direct[k] += left * daylight.behind[k]);
        pixel.distance = 1e3;
        pixel
    }

    /// Adds the light of a solid surface, of which a share is seen.
    fn solid(&self, place: &Spot, ray: &Ray, daylight: &Daylight, dice: &mut Dice, share: f32, pixel: &mut Pixel) {
        let surface = &self.surfaces[place.surface];
        let color = surface.at(place.uv);
        let light = self.light(place, daylight, dice);
        let facing = dot(place.normal, ray.toward).abs();
        let polished = (1.0 - surface.rough) * (1.0 - surface.rough);
        let gloss = fresnel(facing, 0.04) * polished * (1.0 - surface.metal);
        let mut shine = [0.0; 3];
        if surface.metal > 0.5 || gloss > 0.02 {
            let seen = self.mirrored(place, ray, surface.rough, daylight, dice);
            // Half of what rough metal shows is the light around it.
            let sharp = if surface.metal > 0.5 { 1.0 - 0.6 * surface.rough } else { 1.0 };
            shine = std::array::from_fn(|k| {
                let metal = color[k] * (seen[k] * sharp + light[k] * (1.0 - sharp)) * surface.metal;
                metal + gloss * seen[k]
            });
        }
        for k in 0..3 {
            pixel.color[k] = color[k] * (1.0 - surface.metal) * share;
            pixel.light[k] = light[k];
            pixel.direct[k] += (shine[k] + surface.emits[k] * 1.6) * share;
        }
        pixel.normal = place.normal;
    }

    /// Returns the light on a place: sun, lamps, and what comes from around it.
    fn light(&self, place: &Spot, daylight: &Daylight, dice: &mut Dice) -> [f32; 3] {
        let mut light = self.around(place, daylight, dice);
        let sun = daylight.sun.map(|v| v as f32);
        let (a, b) = dice.pair();
        let toward = unit(std::array::from_fn(|k| sun[k] + SUN_EDGE * [a - 0.5, b - 0.5, 0.0][k]));
        let facing = dot(place.normal, toward);
        if facing > 0.0 && !self.is_shaded(place, toward, f32::MAX) {
            (0..3).for_each(|k| light[k] += daylight.sunlight[k] * facing);
        }
        if daylight.lamps > 0.0 {
            self.lamps(place, daylight.lamps, dice, &mut light);
        }
        light
    }

    fn lamps(&self, place: &Spot, share: f32, dice: &mut Dice, light: &mut [f32; 3]) {
        let mut near: Vec<(f32, usize)> = Vec::new();
        for (i, lamp) in self.lamps.iter().enumerate() {
            let way: [f32; 3] = std::array::from_fn(|k| lamp.at[k] - place.at[k]);
            let square = dot(way, way);
            if square < SHINES_M * SHINES_M && dot(way, place.normal) > 0.0 {
                near.push((square, i));
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, i) in near.into_iter().take(LAMPS) {
            let lamp = &self.lamps[i];
            let (a, b) = dice.pair();
            let shift = [a - 0.5, b - 0.5, a * b - 0.25].map(|v| v * 2.0 * LAMP_M);
            let way: [f32; 3] = std::array::from_fn(|k| lamp.at[k] + shift[k] - place.at[k]);
            let length = dot(way, way).sqrt().max(0.05);
            let toward = way.map(|v| v / length);
            let facing = dot(place.normal, toward);
            if facing <= 0.0 || (length > BULB_M && self.is_shaded(place, toward, length - BULB_M)) {
                continue;
            }
            // Softened near the lamp and faded out where its light ends.
            let end = (1.0 - length / SHINES_M).max(0.0);
            let falls = end * end * facing * share / (length * length + 0.3);
            (0..3).for_each(|k| light[k] += lamp.color[k] * falls);
        }
    }

    /// Returns the light from a direction around a place: of the sky, or of what is there.
    fn around(&self, place: &Spot, daylight: &Daylight, dice: &mut Dice) -> [f32; 3] {
        let mut sum = [0.0; 3];
        const RAYS: usize = 2;
        for _ in 0..RAYS {
            let (a, b) = dice.pair();
            let toward = upward(place.normal, a, b);
            let got = self.glimpse(&Ray::new(place.lifted(), toward), AROUND_M, daylight);
            (0..3).for_each(|k| sum[k] += got[k] / RAYS as f32);
        }
        sum
    }

    /// Returns what comes along a ray, roughly.
    fn glimpse(&self, ray: &Ray, far: f32, daylight: &Daylight) -> [f32; 3] {
        match self.bvh.nearest(ray, far, &|s| self.surfaces[s as usize].is_solid()) {
            Some(hit) => {
                let place = self.place(ray, &hit);
                let surface = &self.surfaces[place.surface];
                let color = surface.at(place.uv);
                let open = 0.55 + 0.45 * (hit.distance / far).min(1.0);
                std::array::from_fn(|k| {
                    color[k] * daylight.within * open * 1.3 + surface.emits[k] * daylight.lamps * 2.0
                })
            }
            // Below the horizon there is ground.
            None if ray.toward[2] < 0.0 && far > AROUND_M => daylight.behind.map(|v| v * 0.8),
            None => {
                let lies_within = self.bvh.meets(ray, 60.0, &|s| self.surfaces[s as usize].is_solid());
                if lies_within { [daylight.within; 3] } else { daylight.sky }
            }
        }
    }

    /// Returns what a surface mirrors.
    fn mirrored(&self, place: &Spot, ray: &Ray, rough: f32, daylight: &Daylight, dice: &mut Dice) -> [f32; 3] {
        let along = 2.0 * dot(ray.toward, place.normal);
        let (a, b) = dice.pair();
        let spread = upward(place.normal, a, b);
        let blur = rough * rough;
        let toward =
            unit(std::array::from_fn(|k| (ray.toward[k] - along * place.normal[k]) * (1.0 - blur) + spread[k] * blur));
        self.glimpse(&Ray::new(place.lifted(), toward), 40.0, daylight)
    }

    fn is_shaded(&self, place: &Spot, toward: [f32; 3], far: f32) -> bool {
        self.bvh.meets(&Ray::new(place.lifted(), toward), far, &|s| self.surfaces[s as usize].is_solid())
    }

    fn place(&self, ray: &Ray, hit: &Hit) -> Spot {
        let triangle = &self.bvh.triangles[hit.triangle];
        let (normal, uv) = triangle.mixed(hit.shares);
        let side = if dot(triangle.flat, ray.toward) > 0.0 { -1.0 } else { 1.0 };
        let flat = triangle.flat.map(|v| v * side);
        let normal = unit(normal);
        let normal = if dot(normal, flat) < 0.0 { normal.map(|v| -v) } else { normal };
        Spot {
            at: std::array::from_fn(|i| ray.from[i] + ray.toward[i] * hit.distance),
            normal,
            flat,
            uv,
            surface: triangle.surface as usize,
        }
    }
}

/// A place on a surface.
struct Spot {
    at: [f32; 3],
    normal: [f32; 3],
    flat: [f32; 3],
    uv: [f32; 2],
    surface: usize,
}

impl Spot {
    /// Returns it a little above its surface, where rays may start.
    fn lifted(&self) -> [f32; 3] {
        std::array::from_fn(|i| self.at[i] + self.flat[i] * 1e-3)
    }
}

/// Returns a direction on the side of a normal, more of them near it, as a matt surface looks around.
fn upward(normal: [f32; 3], a: f32, b: f32) -> [f32; 3] {
    let least = (0..3).min_by(|i, j| normal[*i].abs().total_cmp(&normal[*j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let side = unit(cross(normal, other));
    let third = cross(normal, side);
    let (radius, angle) = (a.sqrt(), b * std::f32::consts::TAU);
    let (x, y, z) = (radius * angle.cos(), radius * angle.sin(), (1.0 - a).max(0.0).sqrt());
    std::array::from_fn(|k| side[k] * x + third[k] * y + normal[k] * z)
}

fn fresnel(facing: f32, straight: f32) -> f32 {
    let grazing = (1.0 - facing.clamp(0.0, 1.0)).powi(5);
    straight + (1.0 - straight) * grazing
}

pub(super) fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = dot(v, v).sqrt();
    if length > 1e-20 { v.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}
