//! Pictures that surfaces wear, small enough for a thumbnail.

use std::io::Cursor;

use image::imageops::FilterType;
use image::{ImageReader, Limits};

use crate::model3d::{Material, Model3d, Texture};

/// Longest side of a picture that is drawn with, px.
const SIDE: u32 = 256;
/// Longest side of a picture that is decoded, px, and the most memory for that, bytes.
const MOST_SIDE: u32 = 16_384;
const MOST_BYTES: u64 = 512 << 20;

/// A picture, ready to be looked up.
pub(super) struct Cloth {
    width: usize,
    height: usize,
    /// Linear red, green, blue, from above.
    texels: Vec<[f32; 3]>,
}

/// Returns the picture that each material wears, and one none more for surfaces without material. What cannot be decoded is
/// not worn: its material has its plain color.
pub(super) fn worn(model: &Model3d) -> Vec<Option<Cloth>> {
    let used: std::collections::BTreeSet<usize> = model
        .bodies
        .iter()
        .flat_map(|b| &b.visuals)
        .filter(|v| !v.mesh.uvs.is_empty())
        .filter_map(|v| v.material)
        .collect();
    let of = |(i, material): (usize, &Material)| {
        let texture = material.texture.filter(|_| used.contains(&i)).and_then(|t| model.textures.get(t));
        texture.and_then(|t| Cloth::new(t.bytes.as_deref()?))
    };
    model.materials.iter().enumerate().map(of).chain([None]).collect()
}

impl Cloth {
    /// Returns the picture that a material wears: its own, or that of its finish.
    pub fn of(material: &Material, textures: &[Texture]) -> Option<Self> {
        match material.worn() {
            Some(finish) => Self::new(&finish.pictures().color),
            None => Self::new(textures.get(material.texture?)?.bytes.as_deref()?),
        }
    }

    fn new(bytes: &[u8]) -> Option<Self> {
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
        let mut limits = Limits::default();
        limits.max_image_width = Some(MOST_SIDE);
        limits.max_image_height = Some(MOST_SIDE);
        limits.max_alloc = Some(MOST_BYTES);
        reader.limits(limits);
        let picture = reader.decode().ok()?;
        let small = match picture.width().max(picture.height()) > SIDE {
            true => picture.resize(SIDE, SIDE, FilterType::Triangle),
            false => picture,
        };
        let small = small.to_rgb8();
        let linear: Vec<f32> = (0..=255_u8).map(linear).collect();
        let texels = small.pixels().map(|p| p.0.map(|v| linear[usize::from(v)])).collect();
        Some(Self { width: small.width() as usize, height: small.height() as usize, texels })
    }

    /// Returns the color at a place, v up; pictures repeat.
    pub fn at(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        let place = |t: f32, count: usize| {
            let share = t - t.floor();
            if share.is_finite() { ((share * count as f32) as usize).min(count.saturating_sub(1)) } else { 0 }
        };
        let index = place(1.0 - v, self.height) * self.width + place(u, self.width);
        self.texels.get(index).copied().unwrap_or([0.5; 3])
    }
}

fn linear(byte: u8) -> f32 {
    let s = f32::from(byte) / 255.0;
    if s <= 0.040_45 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}
