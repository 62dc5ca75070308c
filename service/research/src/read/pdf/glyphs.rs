//! Letters at positions to lines: the order of a PDF file is the order of its writer, not of its reader.
//!
//! What it is not for: paragraphs and tables, which need lines of many pages.

use pdf_extract::{MediaBox, OutputDev, OutputError, Transform};

use super::wire::{Page, Printed};

/// Smaller letters are not read by anybody.
const LEAST_SIZE: f32 = 2.5;
/// A gap so wide, in sizes of letters, parts columns: a space has a quarter, in justified lines up to twice that, and a
/// table made close still leaves more than one.
const COLUMN_GAP: f32 = 1.0;
/// No more letters than this are kept of a file.
const MAX_GLYPHS: usize = 4_000_000;

struct Glyph {
    x: f32,
    end: f32,
    y: f32,
    size: f32,
    text: String,
}

/// Collects the letters of pages.
#[derive(Default)]
pub struct Collector {
    pub pages: Vec<Page>,
    /// How many letters were left out because nobody sees them.
    pub hidden: usize,
    /// How many were left out because they run up or down the page.
    pub turned: usize,
    page: (u32, MediaBoxSize),
    glyphs: Vec<Glyph>,
    total: usize,
}

#[derive(Default, Clone, Copy)]
struct MediaBoxSize {
    left: f32,
    top: f32,
    width: f32,
    height: f32,
}

impl OutputDev for Collector {
    fn begin_page(
        &mut self,
        number: u32,
        media: &MediaBox,
        _: Option<(f64, f64, f64, f64)>,
    ) -> Result<(), OutputError> {
        let (left, right) = (media.llx.min(media.urx) as f32, media.llx.max(media.urx) as f32);
        let (bottom, top) = (media.lly.min(media.ury) as f32, media.lly.max(media.ury) as f32);
        self.page = (number, MediaBoxSize { left, top, width: right - left, height: top - bottom });
        self.glyphs.clear();
        Ok(())
    }

    fn end_page(&mut self) -> Result<(), OutputError> {
        self.finish();
        Ok(())
    }

    fn output_character(
        &mut self,
        at: &Transform,
        width: f64,
        _: f64,
        size: f64,
        text: &str,
    ) -> Result<(), OutputError> {
        self.total += 1;
        if self.total > MAX_GLYPHS {
            return Err(OutputError::IoError(std::io::Error::other("the file has more letters than are read")));
        }
        let scale = (at.m11.hypot(at.m12), at.m21.hypot(at.m22));
        let size = (size * scale.1) as f32;
        let page = self.page.1;
        let x = at.m31 as f32 - page.left;
        let y = page.top - at.m32 as f32;
        if at.m12.abs() > at.m11.abs() * 0.2 || at.m11 < 0.0 {
            self.turned += 1;
            return Ok(());
        }
        let inside = (-1.0..=page.width + 1.0).contains(&x) && (-1.0..=page.height + 1.0).contains(&y);
        if !inside || !size.is_finite() || size < LEAST_SIZE {
            self.hidden += usize::from(!text.trim().is_empty());
            return Ok(());
        }
        let end = x + (width * scale.0).abs() as f32 * (size / scale.1.max(1e-9) as f32);
        self.glyphs.push(Glyph { x, end: if end.is_finite() { end } else { x }, y, size, text: text.to_owned() });
        Ok(())
    }

    fn begin_word(&mut self) -> Result<(), OutputError> {
        Ok(())
    }

    fn end_word(&mut self) -> Result<(), OutputError> {
        Ok(())
    }

    fn end_line(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

impl Collector {
    /// Ends the page that is being read, also when the library failed in its middle.
    pub fn finish(&mut self) {
        let (number, size) = std::mem::take(&mut self.page);
        if number == 0 {
            return;
        }
        let lines = lines(std::mem::take(&mut self.glyphs));
        self.pages.push(Page { number, height: size.height, lines });
    }
}

/// Returns the lines of a page from top to bottom.
fn lines(mut glyphs: Vec<Glyph>) -> Vec<Printed> {
    glyphs.sort_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)));
    // Each line with where its largest letter stands, and the size of that.
    let mut groups: Vec<(f32, f32, Vec<Glyph>)> = Vec::new();
    for glyph in glyphs {
        // Raised and lowered figures belong to the line of the larger letters.
        let fits = |y: f32, size: f32| (glyph.y - y).abs() <= 0.45 * size.max(glyph.size);
        match groups.last_mut() {
            Some((y, size, line)) if fits(*y, *size) => {
                if glyph.size >= *size {
                    (*y, *size) = (glyph.y, glyph.size);
                }
                line.push(glyph);
            }
            _ => groups.push((glyph.y, glyph.size, vec![glyph])),
        }
    }
    groups.into_iter().filter_map(|(_, _, line)| printed(line)).collect()
}

fn printed(mut glyphs: Vec<Glyph>) -> Option<Printed> {
    glyphs.sort_by(|a, b| a.x.total_cmp(&b.x));
    let base = glyphs.iter().filter(|g| !g.text.trim().is_empty()).max_by(|a, b| a.size.total_cmp(&b.size))?;
    let (y, size) = (base.y, base.size);
    let mut cells: Vec<(f32, f32, String)> = Vec::new();
    let mut spaced = false;
    let mut last: Option<(f32, String)> = None;
    for glyph in glyphs {
        if glyph.text.trim().is_empty() {
            spaced = true;
            continue;
        }
        // Bold is sometimes made by printing twice.
        if last.as_ref().is_some_and(|(x, text)| *text == glyph.text && (glyph.x - x).abs() < 0.1 * size) {
            continue;
        }
        last = Some((glyph.x, glyph.text.clone()));
        let raised = glyph.size < 0.85 * size && y - glyph.y > 0.15 * size;
        match cells.last_mut() {
            Some(cell) if glyph.x - cell.1 < COLUMN_GAP * size => {
                if glyph.x - cell.1 > 0.15 * size || (spaced && glyph.x - cell.1 > 0.02 * size) {
                    cell.2.push(' ');
                }
                push(&mut cell.2, &glyph.text, raised);
                cell.1 = cell.1.max(glyph.end);
            }
            _ => cells.push((glyph.x, glyph.end, glyph.text.clone())),
        }
        spaced = false;
    }
    Some(Printed { y, size, cells })
}

/// Adds a letter; a raised 2 or 3 behind a unit of length is its square or cube, another raised figure marks a note.
fn push(text: &mut String, glyph: &str, raised: bool) {
    if !raised || !glyph.chars().all(|c| c.is_ascii_digit()) {
        return text.push_str(glyph);
    }
    let unit = text.rsplit(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
    let is_unit = matches!(unit, "m" | "cm" | "mm" | "dm" | "km" | "ft" | "in" | "yd");
    match glyph {
        "2" if is_unit => text.push('²'),
        "3" if is_unit => text.push('³'),
        _ if text.ends_with(char::is_alphabetic) || text.ends_with(['.', ',', ')']) => {}
        _ => text.push_str(glyph),
    }
}
