//! The main colors of a model: of plain materials, and of the pictures on them.

use std::collections::BTreeMap;
use std::io::Cursor;

use d3dgen_mesh::{Material, Model3d, Texture};
use image::{ImageFormat, ImageReader, Limits};

use crate::annotation::Swatch;
use crate::measure::Measured;

/// Colors of an asset at most.
const MOST: usize = 5;
/// Shares below are noise.
const LEAST_SHARE: f64 = 0.03;
/// Pictures larger than this are not looked into, pixels along a side and bytes of memory.
const PICTURE_SIDE: u32 = 8192;
const PICTURE_BYTES: u64 = 160 << 20;
/// Samples taken along each side of a picture.
const SAMPLES: u32 = 48;

/// Returns the main colors, largest share of the surface first.
pub fn palette(model: &Model3d, measured: &Measured) -> Vec<Swatch> {
    let mut named: BTreeMap<&'static str, Sum> = BTreeMap::new();
    let mut pictures: BTreeMap<usize, Option<Vec<[f64; 3]>>> = BTreeMap::new();
    for (material, area) in &measured.material_area_m2 {
        let material = material.and_then(|i| model.materials.get(i));
        let plain = Material::default();
        let material = material.unwrap_or(&plain);
        let picture = material.texture.and_then(|t| {
            let samples = pictures.entry(t).or_insert_with(|| model.textures.get(t).and_then(samples));
            samples.as_ref()
        });
        let own = [material.base_color.map(|c| srgb(f64::from(c)))];
        let colors: &[[f64; 3]] = picture.map_or(&own, Vec::as_slice);
        for color in colors {
            let sum = named.entry(name(*color, material.opacity)).or_default();
            let weight = area / colors.len() as f64;
            sum.weight += weight;
            (0..3).for_each(|i| sum.color[i] += weight * color[i]);
        }
    }
    let total: f64 = named.values().map(|s| s.weight).sum();
    if total <= 0.0 {
        return Vec::new();
    }
    let mut found: Vec<Swatch> = named
        .into_iter()
        .map(|(name, sum)| {
            let [r, g, b] = sum.color.map(|c| (c / sum.weight * 255.0).round().clamp(0.0, 255.0) as u8);
            let share = (sum.weight / total * 1000.0).round() / 1000.0;
            Swatch { name: name.to_owned(), hex: format!("#{r:02x}{g:02x}{b:02x}"), share }
        })
        .filter(|s| s.share >= LEAST_SHARE)
        .collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.name.cmp(&b.name)));
    found.truncate(MOST);
    found
}

#[derive(Default)]
struct Sum {
    weight: f64,
    color: [f64; 3],
}

/// Returns colors all over a picture, sRGB 0 to 1; none when it cannot be read or is too large.
fn samples(texture: &Texture) -> Option<Vec<[f64; 3]>> {
    let bytes = texture.bytes.as_deref()?;
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return None;
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(PICTURE_SIDE);
    limits.max_image_height = Some(PICTURE_SIDE);
    limits.max_alloc = Some(PICTURE_BYTES);
    reader.limits(limits);
    let picture = reader.decode().ok()?;
    let (width, height) = (picture.width(), picture.height());
    let (across, down) = (width.min(SAMPLES), height.min(SAMPLES));
    let rgba = picture.into_rgba8();
    let mut found = Vec::with_capacity((across * down) as usize);
    for row in 0..down {
        for column in 0..across {
            let pixel = rgba.get_pixel((2 * column + 1) * width / (2 * across), (2 * row + 1) * height / (2 * down));
            let [r, g, b, a] = pixel.0;
            if a >= 128 {
                found.push([r, g, b].map(|v| f64::from(v) / 255.0));
            }
        }
    }
    (!found.is_empty()).then_some(found)
}

/// Returns the sRGB value of a linear one.
pub fn srgb(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the word for a color, sRGB 0 to 1.
pub fn name(color: [f64; 3], opacity: f32) -> &'static str {
    if opacity < 0.5 {
        return "transparent";
    }
    let [r, g, b] = color;
    let (max, min) = (r.max(g).max(b), r.min(g).min(b));
    let (chroma, light) = (max - min, (max + min) / 2.0);
    if light < 0.14 {
        return "black";
    }
    let saturation = if light <= 0.5 { chroma / (max + min) } else { chroma / (2.0 - max - min).max(1e-9) };
    if saturation < 0.12 || chroma < 0.05 {
        return match light {
            l if l > 0.86 => "white",
            l if l > 0.2 => "gray",
            _ => "black",
        };
    }
    let hue = match max {
        m if m == r => ((g - b) / chroma).rem_euclid(6.0),
        m if m == g => (b - r) / chroma + 2.0,
        _ => (r - g) / chroma + 4.0,
    } * 60.0;
    let warm = (15.0..60.0).contains(&hue);
    match hue {
        _ if warm && light > 0.86 => "cream",
        _ if warm && light > 0.68 && saturation < 0.62 => "beige",
        _ if warm && light > 0.5 && saturation < 0.5 => "tan",
        _ if warm && hue < 45.0 && (light < 0.42 || saturation < 0.45) => "brown",
        h if !(12.0..345.0).contains(&h) => {
            if light < 0.22 {
                "brown"
            } else if light > 0.72 {
                "pink"
            } else {
                "red"
            }
        }
        h if h < 40.0 => {
            if light < 0.3 {
                "brown"
            } else {
                "orange"
            }
        }
        h if h < 70.0 => "yellow",
        h if h < 165.0 => "green",
        h if h < 260.0 => "blue",
        h if h < 305.0 => "purple",
        _ => "pink",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::tests::boxes;
    use crate::measure::{Map, measure};

    #[test]
    fn colors_have_the_names_people_use() {
        for (hex, expected) in [
            (0xffffff, "white"),
            (0x000000, "black"),
            (0x808080, "gray"),
            (0xd02020, "red"),
            (0x2040c0, "blue"),
            (0x208030, "green"),
            (0xf0d020, "yellow"),
            (0xe88020, "orange"),
            (0x6b4423, "brown"),
            (0xd9c7a7, "beige"),
            (0xc9a77a, "tan"),
            (0x8030a0, "purple"),
            (0xf4a0b8, "pink"),
            (0x44606f, "blue"),
            (0x20252a, "black"),
        ] {
            let channel = |shift: u32| f64::from((hex >> shift) & 0xff) / 255.0;
            assert_eq!(name([channel(16), channel(8), channel(0)], 1.0), expected, "{hex:06x}");
        }
        assert_eq!(name([1.0; 3], 0.2), "transparent");
    }

    #[test]
    fn pictures_and_plain_colors_share_the_surface() {
        let mut picture = image::RgbaImage::from_pixel(8, 8, image::Rgba([208, 32, 32, 255]));
        (0..8).for_each(|y| (0..2).for_each(|x| picture.put_pixel(x, y, image::Rgba([255, 255, 255, 255]))));
        let mut bytes = Vec::new();
        picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).expect("written");
        let mut model = boxes(&[[[0.0; 3], [1.0; 3]]]);
        model.materials = vec![Material { texture: Some(0), ..Material::default() }];
        model.textures = vec![Texture { path: "a.png".into(), bytes: Some(bytes) }];
        let measured = measure(&model, &Map::new(|p| p, [1.0; 3]));
        let found = palette(&model, &measured);
        let shares: Vec<(&str, f64)> = found.iter().map(|s| (s.name.as_str(), s.share)).collect();
        assert_eq!(shares, [("red", 0.75), ("white", 0.25)]);
        assert_eq!(found[0].hex, "#d02020");
        model.textures[0].bytes = Some(b"\x89PNG\r\n\x1a\n broken".to_vec());
        assert_eq!(palette(&model, &measured).len(), 1);
    }
}
