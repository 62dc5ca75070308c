//! From gathered light to a picture: smooths it where a surface goes on, exposes it, and bends bright light as film does.

use super::bvh::dot;
use super::light::Pixel;
use crate::picture::Picture;

/// Steps between the pixels that are mixed, pass by pass.
const PASSES: [usize; 3] = [1, 2, 4];
/// Luminance that the mean of a picture is brought to, and how far exposure goes.
const MEAN: f32 = 0.34;
const EXPOSURE: [f32; 2] = [0.35, 5.0];

/// Returns the picture.
pub(super) fn developed(pixels: &mut [Pixel], width: usize, height: usize) -> Picture {
    for step in PASSES {
        let light = smoothed(pixels, width, height, step);
        pixels.iter_mut().zip(light).for_each(|(p, l)| p.light = l);
    }
    let colors: Vec<[f32; 3]> =
        pixels.iter().map(|p| std::array::from_fn(|k| p.color[k] * p.light[k] + p.direct[k])).collect();
    let exposure = exposure(pixels, &colors);
    let byte = |v: f32| {
        let v = film(v * exposure);
        let s = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (s * 255.0).round().clamp(0.0, 255.0) as u8
    };
    let rgba = colors.iter().flat_map(|c| [byte(c[0]), byte(c[1]), byte(c[2]), 255]).collect();
    Picture { width, height, rgba }
}

/// Returns the light of each pixel mixed with that of pixels of the same surface around it.
fn smoothed(pixels: &[Pixel], width: usize, height: usize, step: usize) -> Vec<[f32; 3]> {
    let weights = [0.25_f32, 0.5, 0.25];
    let mut out = Vec::with_capacity(pixels.len());
    for y in 0..height {
        for x in 0..width {
            let here = &pixels[y * width + x];
            let (mut sum, mut total) = ([0.0; 3], 0.0);
            for (j, wy) in weights.iter().enumerate() {
                for (i, wx) in weights.iter().enumerate() {
                    let (px, py) = ((x + i * step).checked_sub(step), (y + j * step).checked_sub(step));
                    let (Some(px), Some(py)) = (px, py) else { continue };
                    if px >= width || py >= height {
                        continue;
                    }
                    let other = &pixels[py * width + px];
                    let weight = wx * wy * alike(here, other, step);
                    (0..3).for_each(|k| sum[k] += other.light[k] * weight);
                    total += weight;
                }
            }
            out.push(if total > 0.0 { sum.map(|v| v / total) } else { here.light });
        }
    }
    out
}

/// Returns how much of a pixel's light is another's, 0 to 1.
fn alike(a: &Pixel, b: &Pixel, step: usize) -> f32 {
    let facing = dot(a.normal, b.normal).clamp(0.0, 1.0).powi(24);
    let far = (a.distance - b.distance).abs() / (0.02 * a.distance * step as f32 + 0.02);
    let bright = |p: &Pixel| p.light.iter().sum::<f32>();
    let differs = (bright(a) - bright(b)).abs() / (0.9 + 0.4 * bright(a));
    facing * (-far).exp() * (-differs).exp()
}

/// Returns what the light of a picture is multiplied with: of what is near, whose mean becomes middling.
fn exposure(pixels: &[Pixel], colors: &[[f32; 3]]) -> f32 {
    let (mut sum, mut count) = (0.0_f64, 0_u32);
    for (pixel, color) in pixels.iter().zip(colors) {
        if pixel.distance < 900.0 {
            let luminance = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
            sum += f64::from(luminance.max(1e-3)).ln();
            count += 1;
        }
    }
    let mean = if count > 0 { (sum / f64::from(count)).exp() as f32 } else { MEAN };
    (MEAN / mean.max(1e-3)).clamp(EXPOSURE[0], EXPOSURE[1])
}

/// Returns light as a print shows it: straight below, bent toward 1 where it is bright (extended Reinhard, white at 4).
fn film(v: f32) -> f32 {
    let v = v.max(0.0) * 1.35;
    (v * (1.0 + v / 16.0) / (1.0 + v)).clamp(0.0, 1.0)
}
