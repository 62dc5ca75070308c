//! Pictures of models: a software rasterizer for thumbnails and contact sheets.
//!
//! One view for all: from the front, a little from the right and above. Whole worlds are drawn in a [`studio`].

mod raster;
mod shade;
pub mod studio;
mod texture;

use crate::error::Error;
use crate::model3d::{Material, Model3d};
use shade::Light;

/// A picture in memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Red, green, blue and opacity, sRGB, row by row from the top, four bytes a pixel.
    pub rgba: Vec<u8>,
}

/// What lies behind a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ground {
    /// Nothing.
    Transparent,
    /// White paper.
    White,
}

/// From where a model is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Turn of the eye from the front to the right, degrees.
    pub right_deg: f64,
    /// Height of the eye over the horizon, degrees.
    pub above_deg: f64,
    /// What lies behind.
    pub ground: Ground,
}

impl Default for View {
    fn default() -> Self {
        Self { right_deg: 33.0, above_deg: 24.0, ground: Ground::White }
    }
}

/// Returns a square picture of a model with a transparent ground.
pub fn thumbnail(model: &Model3d, px: usize) -> Picture {
    render(model, px, &View { ground: Ground::Transparent, ..View::default() })
}

/// Returns a square picture of a model.
pub fn render(model: &Model3d, px: usize, view: &View) -> Picture {
    let px = px.clamp(1, 4096);
    let plain = Material::default();
    let lights: Vec<Light> = model.materials.iter().chain([&plain]).map(Light::new).collect();
    let samples = raster::draw(model, &lights, &texture::worn(model), px * raster::SAMPLES, view);
    shade::develop(&samples, &lights, px, view.ground)
}

/// Returns pictures of one size in rows on white; a `gap` in px lies around each.
pub fn sheet(tiles: &[Picture], columns: usize, gap: usize) -> Picture {
    let columns = columns.clamp(1, tiles.len().max(1));
    let rows = tiles.len().div_ceil(columns);
    let cell = |side: fn(&Picture) -> usize| tiles.iter().map(side).max().unwrap_or(1) + gap;
    let (cell_w, cell_h) = (cell(|t| t.width), cell(|t| t.height));
    let (width, height) = (columns * cell_w + gap, rows * cell_h + gap);
    let mut sheet = Picture { width, height, rgba: vec![255; width * height * 4] };
    for (i, tile) in tiles.iter().enumerate() {
        sheet.paste(tile, gap + i % columns * cell_w, gap + i / columns * cell_h);
    }
    sheet
}

impl Picture {
    /// Lays another picture over this one with its upper left corner at a pixel.
    pub fn paste(&mut self, other: &Self, left: usize, top: usize) {
        for y in 0..other.height.min(self.height.saturating_sub(top)) {
            for x in 0..other.width.min(self.width.saturating_sub(left)) {
                let from = (y * other.width + x) * 4;
                let to = ((top + y) * self.width + left + x) * 4;
                let alpha = u32::from(other.rgba[from + 3]);
                for k in 0..3 {
                    let (under, over) = (u32::from(self.rgba[to + k]), u32::from(other.rgba[from + k]));
                    self.rgba[to + k] = ((under * (255 - alpha) + over * alpha + 127) / 255) as u8;
                }
                self.rgba[to + 3] = self.rgba[to + 3].max(other.rgba[from + 3]);
            }
        }
    }

    /// Returns the picture as a PNG file.
    ///
    /// # Errors
    /// `Picture` when the library refuses, which would be a bug.
    pub fn png(&self) -> Result<Vec<u8>, Error> {
        let refused = |e: png::EncodingError| Error::Picture { reason: e.to_string() };
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(refused)?;
        writer.write_image_data(&self.rgba).map_err(refused)?;
        writer.finish().map_err(refused)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests;
