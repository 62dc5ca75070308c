//! Light, lines along edges, and the way from samples to pixels.

use super::raster::{SAMPLES, Samples};
use super::{Ground, Picture};
use crate::model3d::Material;

/// Direction of the light in the frame of the eye: from above left.
const KEY: [f32; 3] = [-0.42, 0.62, 0.66];
/// Cosine of the angle below which two normals are one.
const SAME: f32 = 0.9996;
/// Steps of nearness, in shares, that draw a line.
const STEP: f32 = 0.008;

/// Steps of the table of highlights.
const GLOSS_STEPS: usize = 128;

/// What a material does with light.
pub(super) struct Light {
    pub opacity: f32,
    base: [f32; 3],
    emissive: [f32; 3],
    metal: f32,
    smooth: f32,
    /// Strength of the highlight by the cosine to it.
    gloss: [f32; GLOSS_STEPS + 1],
}

impl Light {
    pub fn new(material: &Material) -> Self {
        let rough = material.roughness.clamp(0.05, 1.0);
        let sharpness = (2.0 / (rough * rough) - 1.0).min(200.0);
        let strength = (1.0 - rough) * (1.0 - rough) * 0.6;
        Self {
            opacity: material.opacity,
            base: material.base_color,
            emissive: material.emissive,
            metal: material.metallic.clamp(0.0, 1.0),
            smooth: 1.0 - rough,
            gloss: std::array::from_fn(|i| (i as f32 / GLOSS_STEPS as f32).powf(sharpness) * strength),
        }
    }

    /// Returns the light that a surface sends to the eye, of its own color or that of the picture it wears; all vectors in
    /// the frame of the eye.
    pub fn on(&self, normal: [f32; 3], up: &[f32; 3], worn: Option<[f32; 3]>) -> [f32; 3] {
        let base = worn.unwrap_or(self.base);
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let key = dot(normal, KEY).max(0.0);
        let sky = 0.5 + 0.5 * dot(normal, *up);
        let diffuse = 0.30 + 0.28 * sky + 0.55 * key;
        // The eye is along z: the half vector is fixed, the mirrored ray is easy.
        let mirrored = [2.0 * normal[2] * normal[0], 2.0 * normal[2] * normal[1], 2.0 * normal[2] * normal[2] - 1.0];
        let half = [KEY[0] * 0.55, KEY[1] * 0.55, (KEY[2] + 1.0) * 0.55];
        let gloss = self.gloss[(dot(normal, half).clamp(0.0, 1.0) * GLOSS_STEPS as f32) as usize];
        let rise = (0.5 + 0.5 * dot(mirrored, *up)).clamp(0.0, 1.0);
        let around = 0.25 + 0.75 * rise * rise + 0.25 * key;
        let grazing = (1.0 - normal[2]) * (1.0 - normal[2]);
        let edge = grazing * grazing * self.smooth * 0.35;
        std::array::from_fn(|k| {
            let matte = base[k] * diffuse + edge * around;
            let shiny = base[k] * (0.2 + 0.9 * around);
            matte * (1.0 - self.metal) + shiny * self.metal + gloss + self.emissive[k]
        })
    }
}

/// Turns samples into pixels.
pub(super) fn develop(samples: &Samples, lights: &[Light], px: usize, ground: Ground) -> Picture {
    let mut rgba = vec![0; px * px * 4];
    let table = Table::new();
    // Samples side by side mostly belong to one flat face: the light of the last one is theirs too.
    let mut last = (0_u16, [0.0_f32; 3], [0.0_f32; 3], None);
    for y in 0..px {
        for x in 0..px {
            let (mut color, mut cover) = ([0.0_f32; 3], 0.0_f32);
            for sy in 0..SAMPLES {
                for sx in 0..SAMPLES {
                    let (sx, sy) = (x * SAMPLES + sx, y * SAMPLES + sy);
                    let at = sy * samples.side + sx;
                    let material = samples.material[at];
                    let veil = samples.veil.get(at).copied().unwrap_or_default();
                    let solid = if material > 0 { 1.0 } else { 0.0 };
                    let share = veil.hides + solid * (1.0 - veil.hides);
                    if share <= 0.0 {
                        continue;
                    }
                    let behind = match material.checked_sub(1) {
                        Some(index) => {
                            let normal = samples.normal[at];
                            let same = (0..3).map(|k| normal[k] * last.1[k]).sum::<f32>();
                            let worn = samples.cloth.get(at).copied().flatten();
                            if material != last.0 || same < SAME || worn != last.3 {
                                let light = lights[usize::from(index)].on(normal, &samples.up, worn);
                                last = (material, normal, light, worn);
                            }
                            let dark = line(samples, sx, sy);
                            last.2.map(|c| c * dark)
                        }
                        None => [0.0; 3],
                    };
                    for k in 0..3 {
                        color[k] += veil.color[k] + behind[k] * (1.0 - veil.hides);
                    }
                    cover += share;
                }
            }
            let count = (SAMPLES * SAMPLES) as f32;
            let to = (y * px + x) * 4;
            match ground {
                Ground::Transparent => {
                    if cover > 0.0 {
                        for k in 0..3 {
                            rgba[to + k] = table.srgb(color[k] / cover);
                        }
                        rgba[to + 3] = (255.0 * cover / count).round().clamp(0.0, 255.0) as u8;
                    }
                }
                Ground::White => {
                    for k in 0..3 {
                        rgba[to + k] = table.srgb((color[k].min(cover) + count - cover) / count);
                    }
                    rgba[to + 3] = 255;
                }
            }
        }
    }
    Picture { width: px, height: px, rgba }
}

/// Returns how much of its light a sample keeps: less beside a step or a crease.
fn line(samples: &Samples, x: usize, y: usize) -> f32 {
    let side = samples.side;
    let at = y * side + x;
    let near = samples.near[at];
    if near <= 0.0 {
        return 1.0;
    }
    let mut keep = 1.0_f32;
    for other in [
        (x > 0).then(|| at - 1),
        (x + 1 < side).then(|| at + 1),
        (y > 0).then(|| at - side),
        (y + 1 < side).then(|| at + side),
    ]
    .into_iter()
    .flatten()
    {
        let beside = samples.near[other];
        if beside <= 0.0 {
            keep = keep.min(0.62);
        } else if (near - beside) > near * STEP {
            keep = keep.min(0.68);
        } else {
            let (a, b) = (samples.normal[at], samples.normal[other]);
            let same = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            if same < 0.75 {
                keep = keep.min(0.84);
            }
        }
    }
    keep
}

/// Linear light to sRGB bytes.
struct Table(Vec<u8>);

impl Table {
    fn new() -> Self {
        let byte = |i: usize| {
            let v = i as f32 / 4095.0;
            let s = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            (s * 255.0).round() as u8
        };
        Self((0..4096).map(byte).collect())
    }

    fn srgb(&self, v: f32) -> u8 {
        self.0[(v.clamp(0.0, 1.0) * 4095.0) as usize]
    }
}
