//! The drawing surface: SVG text, a map from meters to sheet units, paths and lines of type.
//!
//! A sheet unit is one pixel of the picture at its natural size; y runs down. Line weights and type sizes are in sheet
//! units and do not grow with the building.

use std::fmt::Write;

use d3dgen_model::geometry::{Point, Polygon, Rect};

use crate::font::{Font, Weight, write_number};

/// Where meters land on the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    /// Sheet units per meter.
    pub scale: f64,
    /// World point that lands on `at`.
    pub origin: Point,
    /// Sheet position of `origin`.
    pub at: (f64, f64),
}

impl Frame {
    /// Returns the sheet position of a world point.
    pub fn map(&self, p: Point) -> (f64, f64) {
        (self.at.0 + (p.x - self.origin.x) * self.scale, self.at.1 - (p.y - self.origin.y) * self.scale)
    }

    /// Returns a world rectangle on the sheet; `y0` is its upper edge there.
    pub fn rect(&self, r: &Rect) -> Rect {
        let ((x0, y1), (x1, y0)) = (self.map(Point::new(r.x0, r.y0)), self.map(Point::new(r.x1, r.y1)));
        Rect { x0, y0, x1, y1 }
    }
}

/// SVG path data in sheet units.
#[derive(Debug, Clone, Default)]
pub(super) struct Path(pub String);

impl Path {
    pub fn new() -> Self {
        Self::default()
    }

    fn put(mut self, command: char, points: &[(f64, f64)]) -> Self {
        self.0.push(command);
        for (i, (x, y)) in points.iter().enumerate() {
            if i > 0 {
                self.0.push(' ');
            }
            write_number(&mut self.0, *x);
            self.0.push(' ');
            write_number(&mut self.0, *y);
        }
        self
    }

    pub fn to(self, p: (f64, f64)) -> Self {
        self.put('M', &[p])
    }

    pub fn line(self, p: (f64, f64)) -> Self {
        self.put('L', &[p])
    }

    pub fn quad(self, c: (f64, f64), p: (f64, f64)) -> Self {
        self.put('Q', &[c, p])
    }

    pub fn cubic(self, c: (f64, f64), d: (f64, f64), p: (f64, f64)) -> Self {
        self.put('C', &[c, d, p])
    }

    pub fn close(mut self) -> Self {
        self.0.push('Z');
        self
    }

    pub fn polygon(self, points: &[(f64, f64)]) -> Self {
        let mut path = self;
        for (i, p) in points.iter().enumerate() {
            path = if i == 0 { path.to(*p) } else { path.line(*p) };
        }
        path.close()
    }

    pub fn rect(self, r: &Rect) -> Self {
        self.polygon(&[(r.x0, r.y0), (r.x1, r.y0), (r.x1, r.y1), (r.x0, r.y1)])
    }

    pub fn segment(self, a: (f64, f64), b: (f64, f64)) -> Self {
        self.to(a).line(b)
    }

    pub fn circle(self, c: (f64, f64), r: f64) -> Self {
        // Four cubics: the usual constant for a quarter of a circle.
        let k = r * 0.5523;
        let (x, y) = c;
        self.to((x + r, y))
            .cubic((x + r, y + k), (x + k, y + r), (x, y + r))
            .cubic((x - k, y + r), (x - r, y + k), (x - r, y))
            .cubic((x - r, y - k), (x - k, y - r), (x, y - r))
            .cubic((x + k, y - r), (x + r, y - k), (x + r, y))
            .close()
    }
}

/// Where a line of type is anchored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The sheet under construction.
pub(super) struct Page {
    out: String,
    regular: Font,
    semi_bold: Font,
}

impl Page {
    pub fn new() -> Self {
        Self {
            out: String::with_capacity(256 * 1024),
            regular: Font::new(Weight::Regular),
            semi_bold: Font::new(Weight::SemiBold),
        }
    }

    pub fn font(&self, weight: Weight) -> &Font {
        match weight {
            Weight::Regular => &self.regular,
            Weight::SemiBold => &self.semi_bold,
        }
    }

    /// Draws a path in a class of the style sheet.
    pub fn path(&mut self, class: &str, path: Path) {
        if !path.0.is_empty() {
            let _ = writeln!(self.out, "<path class=\"{class}\" d=\"{}\"/>", path.0);
        }
    }

    /// Draws a path with presentation attributes of its own.
    pub fn path_with(&mut self, attributes: &str, path: Path) {
        if !path.0.is_empty() {
            let _ = writeln!(self.out, "<path {attributes} d=\"{}\"/>", path.0);
        }
    }

    pub fn open_group(&mut self, id: &str) {
        let _ = writeln!(self.out, "<g id=\"{id}\">");
    }

    pub fn close_group(&mut self) {
        self.out.push_str("</g>\n");
    }

    /// Draws a line of type with its baseline at `y`; returns its width.
    pub fn text(&mut self, text: &str, at: (f64, f64), size: f64, style: Type, anchor: Anchor) -> f64 {
        let font = match style.weight {
            Weight::Regular => &self.regular,
            Weight::SemiBold => &self.semi_bold,
        };
        let width = font.width(text, size);
        let x = match anchor {
            Anchor::Start => at.0,
            Anchor::Middle => at.0 - width / 2.0,
            Anchor::End => at.0 - width,
        };
        let mut outline = String::new();
        font.outline(text, x, at.1, size, &mut outline);
        if outline.is_empty() {
            return width;
        }
        // The stroke lies under the fill: a soft edge that keeps type legible on lines.
        let halo = style.halo.map_or(String::new(), |halo| {
            format!(
                " stroke=\"{halo}\" stroke-width=\"{:.1}\" stroke-opacity=\".85\" paint-order=\"stroke\"",
                size * 0.28
            )
        });
        let _ = writeln!(
            self.out,
            "<path fill=\"{}\"{halo} aria-label=\"{}\" d=\"{outline}\"/>",
            style.fill,
            escaped(text)
        );
        width
    }

    /// Draws turned so that type reads from below upwards, around a point.
    pub fn upright(&mut self, at: (f64, f64), draw: impl FnOnce(&mut Self)) {
        self.turned(-90.0, at, draw);
    }

    /// Draws turned clockwise around a point.
    pub fn turned(&mut self, degrees: f64, (x, y): (f64, f64), draw: impl FnOnce(&mut Self)) {
        if degrees.abs() < 0.005 {
            return draw(self);
        }
        let degrees = (degrees * 100.0).round() / 100.0;
        let _ = writeln!(self.out, "<g transform=\"rotate({degrees} {x:.2} {y:.2})\">");
        draw(self);
        self.close_group();
    }

    /// Draws a block with its own origin at (0, 0) and keeps it for [`Page::place`]; the drawing returns its height.
    pub fn block(&mut self, draw: impl FnOnce(&mut Self) -> f64) -> Block {
        let before = std::mem::take(&mut self.out);
        let height = draw(self);
        Block { content: std::mem::replace(&mut self.out, before), height }
    }

    /// Puts a block with its upper left corner at a point.
    pub fn place(&mut self, block: &Block, (x, y): (f64, f64)) {
        let _ = writeln!(self.out, "<g transform=\"translate({x:.2} {y:.2})\">\n{}</g>", block.content);
    }

    /// Returns the finished document.
    pub fn finish(self, size: (f64, f64), paper_mm: (f64, f64), title: &str, style: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.1}mm\" height=\"{:.1}mm\" viewBox=\"0 0 {:.0} \
             {:.0}\">\n<title>{}</title>\n<style>{style}</style>\n<rect width=\"{:.0}\" height=\"{:.0}\" \
             fill=\"#ffffff\"/>\n{}</svg>\n",
            paper_mm.0,
            paper_mm.1,
            size.0,
            size.1,
            escaped(title),
            size.0,
            size.1,
            self.out
        )
    }
}

/// A drawing that has not found its place yet.
pub(super) struct Block {
    content: String,
    pub height: f64,
}

/// Look of a line of type.
#[derive(Debug, Clone, Copy)]
pub(super) struct Type {
    pub weight: Weight,
    pub fill: &'static str,
    /// Color of a soft edge that keeps the type legible on lines.
    pub halo: Option<&'static str>,
}

/// Returns the points of a polygon on the sheet.
pub(super) fn on_sheet(frame: &Frame, polygon: &Polygon) -> Vec<(f64, f64)> {
    polygon.corners().iter().map(|p| frame.map(*p)).collect()
}

fn escaped(text: &str) -> String {
    // Control characters other than white space are not allowed in XML at all.
    text.chars()
        .filter(|c| !c.is_control())
        .map(|c| match c {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            c => c.to_string(),
        })
        .collect()
}
