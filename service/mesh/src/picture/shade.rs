//! Light, lines along edges, and the way from samples to pixels.

use super::raster::{SAMPLES, Samples};
use super::{Ground, Picture};
use crate::Material;

/// Direction of the light in the frame of the eye: from above left.
const KEY: [f32; 3] = [-0.42, 0.62, 0.66];
/// Steps of nearness, in shares, that draw a line.
const STEP: f32 = 0.008;

/// Returns the light that a surface sends to the eye; all vectors in the frame of the eye.
pub(super) fn light(normal: [f32; 3], material: &Material, up: &[f32; 3]) -> [f32; 3] {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let rise = dot(normal, *up);
    let key = dot(normal, KEY).max(0.0);
    let sky = 0.5 + 0.5 * rise;
    let diffuse = 0.30 + 0.28 * sky + 0.55 * key;
    // The eye is along z: the half vector is fixed, the mirrored ray is easy.
    let mirrored = [2.0 * normal[2] * normal[0], 2.0 * normal[2] * normal[1], 2.0 * normal[2] * normal[2] - 1.0];
    let half = [KEY[0] * 0.55, KEY[1] * 0.55, (KEY[2] + 1.0) * 0.55];
    let rough = material.roughness.clamp(0.05, 1.0);
    let sharpness = 2.0 / (rough * rough) - 1.0;
    let gloss = dot(normal, half).clamp(0.0, 1.0).powf(sharpness.min(200.0)) * (1.0 - rough) * (1.0 - rough) * 0.6;
    let around = 0.25 + 0.75 * (0.5 + 0.5 * dot(mirrored, *up)).clamp(0.0, 1.0).powi(2) + 0.25 * key;
    let metal = material.metallic.clamp(0.0, 1.0);
    let edge = (1.0 - normal[2]).powi(4) * (1.0 - rough) * 0.35;
    std::array::from_fn(|k| {
        let base = material.base_color[k];
        let matte = base * diffuse + edge * around;
        let shiny = base * (0.2 + 0.9 * around);
        matte * (1.0 - metal) + shiny * metal + gloss + material.emissive[k]
    })
}

/// Turns samples into pixels.
pub(super) fn develop(samples: &Samples, px: usize, ground: Ground) -> Picture {
    let mut rgba = vec![0; px * px * 4];
    let table = Table::new();
    for y in 0..px {
        for x in 0..px {
            let (mut color, mut cover) = ([0.0_f32; 3], 0.0_f32);
            for sy in 0..SAMPLES {
                for sx in 0..SAMPLES {
                    let (sx, sy) = (x * SAMPLES + sx, y * SAMPLES + sy);
                    let at = sy * samples.side + sx;
                    let share = samples.cover[at];
                    if share <= 0.0 {
                        continue;
                    }
                    let dark = line(samples, sx, sy);
                    for (sum, c) in color.iter_mut().zip(samples.color[at]) {
                        *sum += c * dark * share;
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
