//! Text as outlines of an embedded font, so that pictures need no font on the reader's machine and never differ.
//!
//! Barlow under the SIL Open Font License (`fonts/OFL.txt`), cut down to Latin letters, figures and signs.

use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::opentype_layout::LayoutTable;
use ttf_parser::{Face, GlyphId, OutlineBuilder, Tag};

/// Weight of the type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// For running text and figures.
    Regular,
    /// For names and headings.
    SemiBold,
}

/// The font in one weight.
pub struct Font {
    face: Face<'static>,
    /// Pair positioning of the `kern` feature.
    kerning: Vec<PairAdjustment<'static>>,
}

impl Font {
    /// Returns the embedded font.
    pub fn new(weight: Weight) -> Self {
        let bytes: &'static [u8] = match weight {
            Weight::Regular => include_bytes!("../fonts/Barlow-Regular.ttf"),
            Weight::SemiBold => include_bytes!("../fonts/Barlow-SemiBold.ttf"),
        };
        let face = Face::parse(bytes, 0).expect("the embedded font is whole; a test draws with it");
        let kerning = face.tables().gpos.map(kerning).unwrap_or_default();
        Self { face, kerning }
    }

    /// Returns true when the font has a glyph for every character.
    pub fn covers(&self, text: &str) -> bool {
        text.chars().all(|c| self.face.glyph_index(c).is_some())
    }

    /// Returns the width of a line at a font size.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        self.glyphs(text).last().map_or(0.0, |(_, at, advance)| at + advance) * self.scale(size)
    }

    /// Appends the outline of a line as SVG path data, its baseline starting at (x, y).
    pub fn outline(&self, text: &str, x: f64, y: f64, size: f64, out: &mut String) {
        let scale = self.scale(size);
        for (glyph, at, _) in self.glyphs(text) {
            let mut pen = Pen { x: x + at * scale, y, scale, out };
            self.face.outline_glyph(glyph, &mut pen);
        }
    }

    /// Glyphs with their offset and advance in font units; characters without a glyph are left out.
    fn glyphs(&self, text: &str) -> Vec<(GlyphId, f64, f64)> {
        let mut at = 0.0;
        let mut last = None;
        let mut glyphs = Vec::with_capacity(text.len());
        for glyph in text.chars().filter_map(|c| self.face.glyph_index(c)) {
            at += last.map_or(0.0, |l| self.kern(l, glyph));
            let advance = f64::from(self.face.glyph_hor_advance(glyph).unwrap_or(0));
            glyphs.push((glyph, at, advance));
            at += advance;
            last = Some(glyph);
        }
        glyphs
    }

    /// Kerning between two glyphs in font units.
    fn kern(&self, left: GlyphId, right: GlyphId) -> f64 {
        for pair in &self.kerning {
            let Some(index) = pair.coverage().get(left) else { continue };
            let found = match pair {
                PairAdjustment::Format1 { sets, .. } => sets.get(index).and_then(|set| set.get(right)),
                PairAdjustment::Format2 { classes, matrix, .. } => {
                    matrix.get((classes.0.get(left), classes.1.get(right)))
                }
            };
            if let Some((first, _)) = found {
                return f64::from(first.x_advance);
            }
        }
        0.0
    }

    fn scale(&self, size: f64) -> f64 {
        size / f64::from(self.face.units_per_em())
    }
}

/// Returns the pair adjustments of the `kern` feature in order.
fn kerning(gpos: LayoutTable<'static>) -> Vec<PairAdjustment<'static>> {
    let feature = gpos.features.into_iter().find(|f| f.tag == Tag::from_bytes(b"kern"));
    let lookups = feature.into_iter().flat_map(|f| f.lookup_indices).filter_map(|i| gpos.lookups.get(i));
    lookups
        .flat_map(|lookup| lookup.subtables.into_iter::<PositioningSubtable<'_>>())
        .filter_map(|subtable| if let PositioningSubtable::Pair(pair) = subtable { Some(pair) } else { None })
        .collect()
}

/// Writes outlines with y down.
struct Pen<'a> {
    x: f64,
    y: f64,
    scale: f64,
    out: &'a mut String,
}

impl Pen<'_> {
    fn put(&mut self, command: char, points: &[(f32, f32)]) {
        self.out.push(command);
        for (i, (x, y)) in points.iter().enumerate() {
            if i > 0 {
                self.out.push(' ');
            }
            write_number(self.out, self.x + f64::from(*x) * self.scale);
            self.out.push(' ');
            write_number(self.out, self.y - f64::from(*y) * self.scale);
        }
    }
}

/// Writes a sheet coordinate in at most two decimals, by whole numbers: outlines are most of a picture's bytes and time.
pub fn write_number(out: &mut String, value: f64) {
    let hundredths = (value * 100.0).round() as i64;
    if hundredths < 0 {
        out.push('-');
    }
    let (whole, rest) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
    let mut digits = [0_u8; 20];
    let mut at = digits.len();
    let mut left = whole;
    loop {
        at -= 1;
        digits[at] = b'0' + (left % 10) as u8;
        left /= 10;
        if left == 0 {
            break;
        }
    }
    out.extend(digits[at..].iter().map(|d| char::from(*d)));
    if rest > 0 {
        out.push('.');
        out.push(char::from(b'0' + (rest / 10) as u8));
        if rest % 10 > 0 {
            out.push(char::from(b'0' + (rest % 10) as u8));
        }
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.put('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.put('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.put('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.put('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.out.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_weights_draw_and_measure_text() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            let font = Font::new(weight);
            let mut path = String::new();
            font.outline("Küche 12.5 m²", 0.0, 0.0, 20.0, &mut path);
            assert!(path.starts_with('M') && path.ends_with('Z') && path.len() > 500);
            let width = font.width("Küche 12.5 m²", 20.0);
            assert!((90.0..150.0).contains(&width), "{width}");
            assert!((font.width("Küche 12.5 m²", 40.0) - 2.0 * width).abs() < 1e-9);
        }
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in
            [(0.0, "0"), (-0.001, "0"), (12.5, "12.5"), (-3.047, "-3.05"), (100.0, "100"), (0.999, "1")]
        {
            let mut out = String::new();
            write_number(&mut out, value);
            assert_eq!(out, text);
        }
    }

    #[test]
    fn pairs_are_kerned() {
        let font = Font::new(Weight::Regular);
        let apart = font.width("A", 100.0) + font.width("V", 100.0);
        assert!(font.width("AV", 100.0) < apart - 1.0);
    }

    #[test]
    fn scripts_without_glyphs_are_known() {
        let font = Font::new(Weight::Regular);
        assert!(font.covers("Größe – São Łódź, “robot” × 2"));
        assert!(!font.covers("医院 8"));
    }
}
