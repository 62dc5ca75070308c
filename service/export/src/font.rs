//! Text as outlines of embedded fonts, so that pictures need no font on the reader's machine and never differ.
//!
//! Barlow, cut down to Latin letters, figures and signs; for what it lacks Noto Sans (Vietnamese, Greek, Cyrillic) and Noto
//! Sans CJK (Chinese, Japanese, Korean). All are under the SIL Open Font License (`fonts/OFL-*.txt`).

use std::io::Read;
use std::sync::LazyLock;

use flate2::read::GzDecoder;
use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::opentype_layout::LayoutTable;
use ttf_parser::{Face, GlyphId, OutlineBuilder, Tag};
use unicode_normalization::UnicodeNormalization;

/// Weight of the type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// For running text and figures.
    Regular,
    /// For names and headings.
    SemiBold,
}

/// Advance of the box that stands for a character no font has, and its edge to all sides, in units of the type's size.
const BOX: (f64, f64) = (0.62, 0.06);
/// Height of that box, and how thick its line is.
const BOX_HEIGHT: f64 = 0.7;
const BOX_LINE: f64 = 0.05;

/// Unpacked by the first text that needs it.
static EASTERN: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut font = Vec::new();
    let packed: &[u8] = include_bytes!("../fonts/NotoSansCJK-Regular.otf.gz");
    GzDecoder::new(packed).read_to_end(&mut font).expect("the embedded font is whole; a test draws with it");
    font
});

/// One font with its kerning.
struct Cut {
    face: Face<'static>,
    /// Pair positioning of the `kern` feature.
    kerning: Vec<PairAdjustment<'static>>,
}

impl Cut {
    fn new(bytes: &'static [u8]) -> Self {
        let face = Face::parse(bytes, 0).expect("the embedded font is whole; a test draws with it");
        let kerning = face.tables().gpos.map(kerning).unwrap_or_default();
        Self { face, kerning }
    }

    fn covers(&self, text: &str) -> bool {
        text.chars().all(|c| self.face.glyph_index(c).is_some())
    }

    /// Kerning between two glyphs, in units of the type's size.
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
                return f64::from(first.x_advance) / self.units();
            }
        }
        0.0
    }

    fn units(&self) -> f64 {
        f64::from(self.face.units_per_em())
    }
}

/// A glyph in a line of type; what no font has is a box.
struct Glyph {
    /// Which font of the list it is of, and its number there.
    of: Option<(usize, GlyphId)>,
    /// Where it begins, and how far the next one is, in units of the type's size.
    at: f64,
    advance: f64,
}

/// The fonts of one weight, the first that has a text first.
pub struct Font {
    cuts: Vec<Cut>,
    eastern: LazyLock<Cut>,
}

impl Font {
    /// Returns the embedded fonts.
    pub fn new(weight: Weight) -> Self {
        let [barlow, noto]: [&'static [u8]; 2] = match weight {
            Weight::Regular => {
                [include_bytes!("../fonts/Barlow-Regular.ttf"), include_bytes!("../fonts/NotoSans-Regular.ttf")]
            }
            Weight::SemiBold => {
                [include_bytes!("../fonts/Barlow-SemiBold.ttf"), include_bytes!("../fonts/NotoSans-Bold.ttf")]
            }
        };
        Self { cuts: vec![Cut::new(barlow), Cut::new(noto)], eastern: LazyLock::new(|| Cut::new(&EASTERN)) }
    }

    /// Returns true when the fonts have a glyph for every character.
    #[cfg(test)]
    pub fn covers(&self, text: &str) -> bool {
        text.chars().all(|c| self.font_of(c).is_some())
    }

    /// Returns the width of a line at a font size.
    pub fn width(&self, text: &str, size: f64) -> f64 {
        self.glyphs(text).last().map_or(0.0, |glyph| glyph.at + glyph.advance) * size
    }

    /// Appends the outline of a line as SVG path data, its baseline starting at (x, y).
    pub fn outline(&self, text: &str, x: f64, y: f64, size: f64, out: &mut String) {
        for glyph in self.glyphs(text) {
            let x = x + glyph.at * size;
            match glyph.of {
                Some((n, id)) => {
                    let cut = self.cut(n);
                    let mut pen = Pen { x, y, scale: size / cut.units(), out };
                    cut.face.outline_glyph(id, &mut pen);
                }
                None => empty_box(&mut Pen { x, y, scale: size, out }),
            }
        }
    }

    fn cut(&self, n: usize) -> &Cut {
        self.cuts.get(n).unwrap_or_else(|| &self.eastern)
    }

    /// Returns the first font that has a character.
    fn font_of(&self, c: char) -> Option<usize> {
        (0..=self.cuts.len()).find(|n| self.cut(*n).face.glyph_index(c).is_some())
    }

    /// Returns the glyphs of a line: of one font where one has all of it, else word by word, and letter by letter in words
    /// that no font has whole.
    fn glyphs(&self, text: &str) -> Vec<Glyph> {
        // "ü" may come as two characters; what has no shape of its own is left out
        let text: String = text.nfc().filter(|c| !is_invisible(*c)).collect();
        let with_all = |part: &str| (0..=self.cuts.len()).find(|n| self.cut(*n).covers(part));
        let mut line = Line { font: self, at: 0.0, last: None, glyphs: Vec::with_capacity(text.len()) };
        if let Some(n) = with_all(&text) {
            text.chars().for_each(|c| line.put(c, Some(n)));
            return line.glyphs;
        }
        for word in text.split_inclusive(' ') {
            let whole = with_all(word);
            word.chars().for_each(|c| line.put(c, whole.or_else(|| self.font_of(c))));
        }
        line.glyphs
    }
}

/// A line of type as it is set.
struct Line<'f> {
    font: &'f Font,
    at: f64,
    last: Option<(usize, GlyphId)>,
    glyphs: Vec<Glyph>,
}

impl Line<'_> {
    fn put(&mut self, c: char, n: Option<usize>) {
        let of = n.and_then(|n| Some((n, self.font.cut(n).face.glyph_index(c)?)));
        let advance = match of {
            Some((n, id)) => {
                let cut = self.font.cut(n);
                if let Some((_, last)) = self.last.filter(|(before, _)| *before == n) {
                    self.at += cut.kern(last, id);
                }
                f64::from(cut.face.glyph_hor_advance(id).unwrap_or(0)) / cut.units()
            }
            None => BOX.0,
        };
        self.glyphs.push(Glyph { of, at: self.at, advance });
        self.at += advance;
        self.last = of;
    }
}

/// Returns true for characters that are not drawn: control characters, joiners, selectors of a form.
fn is_invisible(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2060}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}')
}

/// Draws the outline of a box, its hole the other way round.
fn empty_box(pen: &mut Pen<'_>) {
    let (advance, edge) = BOX;
    let mut frame = |inset: f64, turned: bool| {
        let (x0, x1, y0, y1) = (edge + inset, advance - edge - inset, inset, BOX_HEIGHT - inset);
        let mut corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| (x as f32, y as f32));
        if turned {
            corners.reverse();
        }
        for (i, corner) in corners.iter().enumerate() {
            pen.put(if i == 0 { 'M' } else { 'L' }, &[*corner]);
        }
        pen.out.push('Z');
    };
    frame(0.0, false);
    frame(BOX_LINE, true);
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
    fn prompts_of_twelve_languages_have_all_their_glyphs() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            let font = Font::new(weight);
            for text in [
                "Größe – São Łódź, “robot” × 2",
                "Deux chambres, une salle à manger et un bureau près de l'entrée",
                "Piso de dos habitaciones con baño, año 1999 ¿y cocina?",
                "Zwei Zimmer, Küche, Bad; Fläche 65 m²",
                "Twee slaapkamers, één badkamer en een keuken",
                "Due camere da letto, perché no, più il bagno",
                "Três quartos, cozinha, casa de banho e varanda",
                "Mieszkanie: łazienka, trzy pokoje, źródło światła, książki, gęś",
                "Двухкомнатная квартира с кухней-гостиной, этаж №3; їжа, ґанок",
                "Διαμέρισμα με δύο υπνοδωμάτια και κουζίνα",
                "Căn hộ hai phòng ngủ, một phòng tắm, bếp mở ở Đà Nẵng, phường Thạch Thang",
                "深圳市宝安区三室两厅两卫的住宅,带独立卫生间、衣帽间,面积120㎡。",
                "臺灣高雄的醫院病房,護理站與復健治療室",
                "東京都世田谷区の2LDKマンション、キッチンと浴室、バリアフリー対応。",
                "서울 강남구 방 세 개, 욕실 두 개, 부엌과 거실이 있는 아파트",
            ] {
                assert!(font.covers(text), "{weight:?}: {text}");
                let mut path = String::new();
                font.outline(text, 0.0, 0.0, 20.0, &mut path);
                let drawn = path.matches('M').count();
                let letters = text.chars().filter(|c| !c.is_whitespace()).count();
                assert!(drawn >= letters, "{weight:?}: {drawn} outlines of {letters} letters: {text}");
            }
        }
    }

    #[test]
    fn what_no_font_has_is_a_box() {
        let font = Font::new(Weight::Regular);
        assert!(!font.covers("🛏"));
        let mut path = String::new();
        font.outline("🛏\u{fe0f}", 0.0, 0.0, 20.0, &mut path);
        assert_eq!(path.matches('M').count(), 2, "{path}");
        assert!((font.width("🛏", 20.0) - 12.4).abs() < 1e-9);
    }

    #[test]
    fn letters_in_two_characters_are_drawn_as_one() {
        let font = Font::new(Weight::Regular);
        for (apart, whole) in [("u\u{308}", "ü"), ("e\u{302}\u{323}", "ệ"), ("\u{1112}\u{1161}\u{11ab}", "한")] {
            let (mut a, mut b) = (String::new(), String::new());
            font.outline(apart, 0.0, 0.0, 20.0, &mut a);
            font.outline(whole, 0.0, 0.0, 20.0, &mut b);
            assert_eq!(a, b, "{whole}");
        }
    }
}
