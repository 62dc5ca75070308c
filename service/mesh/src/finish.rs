//! Finishes: what floors, walls, ceilings and parts of things are covered with, and the pictures of that.
//!
//! Finishes are data (`domains/finishes/`); `pattern` makes their pictures. What it is not for: which room has which
//! finish (domains say that), and which tone of a part wears one (`builds::tones`).

mod noise;
mod pattern;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

use crate::builds::tones::{linear, srgb};
use crate::model3d::Material;

/// Width and height of the pictures, px.
pub const SIDE: usize = 256;
/// Steps between the darkest and the lightest color: fewer make smaller files, more are seen by nobody.
const STEPS: usize = 24;
/// Steps of each direction of a normal map.
const NORMAL_STEPS: f64 = 32.0;

/// A finish.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Finish {
    /// Its name: `Oak_Planks`.
    pub id: String,
    /// Words of other names that it stands for, lower case.
    #[serde(default)]
    pub words: Vec<String>,
    /// What is repeated.
    pub pattern: Pattern,
    /// Width and height of what one picture shows, m.
    pub size_m: [f64; 2],
    /// Width and height of what is repeated in it, m.
    pub unit_m: [f64; 2],
    /// Width of the gaps between units, m.
    #[serde(default)]
    pub joint_m: f64,
    /// Darkest and lightest color, `#rrggbb`.
    pub colors: [String; 2],
    /// Color of the gaps; the darkest where it is not said.
    #[serde(default)]
    pub joint: Option<String>,
    /// Share of the way between the colors that is used.
    pub contrast: f64,
    /// Height of its relief, m; 0 for none.
    pub relief_m: f64,
    /// 0 is a mirror.
    pub roughness: f32,
    /// 0 or 1.
    #[serde(default)]
    pub metallic: f32,
    /// 1 is solid.
    #[serde(default = "solid")]
    pub opacity: f32,
    /// True when it multiplies the color of what wears it.
    #[serde(default)]
    pub tints: bool,
}

/// What a finish repeats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pattern {
    /// Boards with joints, each of its own shade, grained along them.
    Planks,
    /// Tiles with joints.
    Tiles,
    /// Grain of wood without joints.
    Grain,
    /// Threads over and under each other.
    Weave,
    /// Loops of a carpet.
    Pile,
    /// Grain of leather.
    Pebbles,
    /// Chips of stone in cement.
    Chips,
    /// Veins of marble.
    Veins,
    /// Soft clouds of concrete.
    Clouds,
    /// Fine bumps of plaster and paint.
    Stipple,
    /// Fine lines of brushed metal.
    Brushed,
    /// Nothing.
    Plain,
}

impl Pattern {
    /// Returns whether it runs along things: boards, wood, brushed metal.
    pub fn has_grain(self) -> bool {
        matches!(self, Self::Planks | Self::Grain | Self::Brushed)
    }
}

/// The pictures of a finish as PNG files, row 0 at the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pictures {
    /// Color, sRGB.
    pub color: Vec<u8>,
    /// Normal map of glTF and UsdPreviewSurface: linear, y up.
    pub normal: Option<Vec<u8>>,
    /// Mean of the color picture, linear: a surface whose color it multiplies is divided by it to keep its shade.
    mean: [u32; 3],
}

fn solid() -> f32 {
    1.0
}

/// Returns every finish, in the order of the file.
pub fn all() -> &'static [Finish] {
    static ALL: OnceLock<Vec<Finish>> = OnceLock::new();
    ALL.get_or_init(|| {
        let text = include_str!(concat!(env!("OUT_DIR"), "/finishes.json"));
        serde_json::from_str(text).expect("a test reads every finish")
    })
}

/// Returns the finish of this name exactly.
pub fn get(id: &str) -> Option<&'static Finish> {
    all().iter().find(|f| f.id == id)
}

/// Returns the finish that a name of a surface stands for: its own, else one with a word of it, else plaster.
pub fn named(name: &str) -> &'static Finish {
    let words: Vec<String> = name.split(|c: char| !c.is_ascii_alphanumeric()).map(str::to_ascii_lowercase).collect();
    let by_word = || all().iter().find(|f| f.words.iter().any(|w| words.contains(w)));
    let plain = || all().iter().find(|f| f.id == "Plaster_Wall").unwrap_or(&all()[0]);
    get(name).or_else(by_word).unwrap_or_else(plain)
}

impl Finish {
    /// Returns the surface that wears it and has no color of its own.
    pub fn material(&self, name: &str) -> Material {
        let base_color = if self.pattern == Pattern::Plain { self.shade(0.5) } else { [1.0; 3] };
        Material {
            name: name.to_owned(),
            base_color,
            opacity: self.opacity,
            metallic: self.metallic,
            roughness: self.roughness,
            finish: self.is_drawn().then(|| self.id.clone()),
            ..Material::default()
        }
    }

    /// Returns true when it has a picture.
    pub fn is_drawn(&self) -> bool {
        self.pattern != Pattern::Plain
    }

    /// Returns its mean color, linear.
    pub fn mean(&self) -> [f32; 3] {
        if self.is_drawn() { self.pictures().mean.map(|v| v as f32 / 65_535.0) } else { self.shade(0.5) }
    }

    /// Returns its pictures, made once.
    pub fn pictures(&self) -> &'static Pictures {
        static MADE: OnceLock<BTreeMap<&'static str, OnceLock<Pictures>>> = OnceLock::new();
        let made = MADE.get_or_init(|| all().iter().map(|f| (f.id.as_str(), OnceLock::new())).collect());
        let slot = made.get(self.id.as_str()).expect("finishes are those of the file");
        slot.get_or_init(|| self.draw())
    }

    fn shade(&self, at: f64) -> [f32; 3] {
        self.srgb(at).map(|v| linear(v) as f32)
    }

    fn srgb(&self, at: f64) -> [f64; 3] {
        let [dark, light] = [&self.colors[0], &self.colors[1]].map(|c| srgb(c).unwrap_or([0.5; 3]));
        std::array::from_fn(|k| dark[k] + (light[k] - dark[k]) * at)
    }

    fn draw(&self) -> Pictures {
        let texels = pattern::texels(self, SIDE);
        let joint = self.joint.as_deref().and_then(srgb).unwrap_or_else(|| self.srgb(0.0));
        let bytes = |c: [f64; 3]| c.map(|v| (v * 255.0).round() as u8);
        let palette: Vec<[u8; 3]> =
            (0..STEPS).map(|i| bytes(self.srgb(i as f64 / (STEPS - 1) as f64))).chain([bytes(joint)]).collect();
        let index = |t: &pattern::Texel| {
            // About the middle of the two colors, so that contrast changes no mean.
            let tone = 0.5 + (t.tone - 0.5) * self.contrast;
            if t.joint { STEPS as u8 } else { (tone.clamp(0.0, 1.0) * (STEPS - 1) as f64).round() as u8 }
        };
        let indices: Vec<u8> = texels.iter().map(index).collect();
        let mut sum = [0.0; 3];
        for i in &indices {
            let color = palette[usize::from(*i)].map(|v| linear(f64::from(v) / 255.0));
            (0..3).for_each(|k| sum[k] += color[k]);
        }
        Pictures {
            color: indexed(&palette, &indices),
            normal: (self.relief_m > 0.0).then(|| normals(self, &texels)),
            mean: sum.map(|v| (v / indices.len() as f64 * 65_535.0).round() as u32),
        }
    }
}

/// Returns a PNG whose pixels are indices into a list of colors.
fn indexed(palette: &[[u8; 3]], indices: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.concat());
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    write(encoder, indices);
    bytes
}

/// Returns the normal map of a relief; heights repeat beyond the edges as the picture does.
fn normals(finish: &Finish, texels: &[pattern::Texel]) -> Vec<u8> {
    let height = |x: usize, y: usize| texels[(y % SIDE) * SIDE + x % SIDE].height * finish.relief_m;
    let [dx, dy] = finish.size_m.map(|s| 2.0 * s / SIDE as f64);
    let mut pixels = Vec::with_capacity(SIDE * SIDE * 3);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let rise = (height(x + 1, y) - height(x + SIDE - 1, y)) / dx;
            // Rows run down, the map's y up.
            let climb = (height(x, y + SIDE - 1) - height(x, y + 1)) / dy;
            let length = (rise * rise + climb * climb + 1.0).sqrt();
            for v in [-rise / length, -climb / length, 1.0 / length] {
                let step = (v * NORMAL_STEPS).round() / NORMAL_STEPS;
                pixels.push(((step * 0.5 + 0.5) * 255.0).round() as u8);
            }
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    write(encoder, &pixels);
    bytes
}

fn write(encoder: png::Encoder<'_, &mut Vec<u8>>, pixels: &[u8]) {
    let mut writer = encoder.write_header().expect("the size is neither 0 nor too large");
    writer.write_image_data(pixels).expect("a vector takes every byte");
    writer.finish().expect("a vector takes every byte");
}

#[cfg(test)]
mod tests;
