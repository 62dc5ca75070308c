//! The plan as PDF: the paths of its SVG on a page as large as the sheet, so that a print at 100 % is to scale.
//!
//! Nothing in it tells when it was made: the same plan gives the same bytes.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use resvg::tiny_skia::{PathSegment, Point, Transform};
use resvg::usvg::{FillRule, Group, LineCap, LineJoin, Node, Paint, PaintOrder, Path, Stroke, Tree};

use crate::error::Error;

/// Points of an inch, and pixels of one as SVG counts them.
const POINTS: f32 = 72.0 / 96.0;

/// Returns the PDF of an SVG of paths.
///
/// # Errors
/// `Picture` when the SVG has anything but paths in plain colors: a bug of ours.
pub(super) fn pdf(svg: &Tree, title: &str) -> Result<Vec<u8>, Error> {
    let refused = |reason: String| Error::Picture { picture: "plan.pdf", reason };
    let (width, height) = (svg.size().width() * POINTS, svg.size().height() * POINTS);
    let onto = Transform::from_row(POINTS, 0.0, 0.0, -POINTS, 0.0, height);
    let mut sheet = Sheet { content: Content::new(), onto, shades: BTreeMap::new() };
    sheet.group(svg.root()).map_err(refused)?;
    let drawn = packed(&sheet.content.finish()).map_err(|e| refused(e.to_string()))?;

    let [catalog, pages, page, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut leaf = pdf.page(page);
    leaf.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
    let mut resources = leaf.resources();
    let mut states = resources.ext_g_states();
    for (k, name) in sheet.shades.values().enumerate() {
        states.pair(Name(name.as_bytes()), Ref::new(6 + k as i32));
    }
    states.finish();
    resources.finish();
    leaf.finish();
    for (k, ([fill, stroke], _)) in sheet.shades.iter().enumerate() {
        let share = |percent: u8| f32::from(percent) / 100.0;
        pdf.ext_graphics(Ref::new(6 + k as i32)).non_stroking_alpha(share(*fill)).stroking_alpha(share(*stroke));
    }
    pdf.stream(content, &drawn).filter(Filter::FlateDecode);
    pdf.document_info(info).title(TextStr(title)).producer(TextStr("d3dgen"));
    Ok(pdf.finish())
}

fn packed(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// The page under construction.
struct Sheet {
    content: Content,
    /// From the SVG's pixels to the page's points, y up.
    onto: Transform,
    /// Opacities of fill and stroke that occur, percent, with the names of their states.
    shades: BTreeMap<[u8; 2], String>,
}

impl Sheet {
    fn group(&mut self, group: &Group) -> Result<(), String> {
        for node in group.children() {
            match node {
                Node::Group(inner) => self.group(inner)?,
                Node::Path(path) if path.is_visible() => self.path(path)?,
                Node::Path(_) => {}
                Node::Image(_) | Node::Text(_) => return Err("it holds an image or text that is no outline".into()),
            }
        }
        Ok(())
    }

    fn path(&mut self, path: &Path) -> Result<(), String> {
        let map = path.abs_transform().post_concat(self.onto);
        let (fill, stroke) = (path.fill(), path.stroke());
        let percent = |opacity: f32| (opacity * 100.0).round().clamp(0.0, 100.0) as u8;
        self.shade([
            fill.map_or(100, |f| percent(f.opacity().get())),
            stroke.map_or(100, |s| percent(s.opacity().get())),
        ]);
        if let Some(fill) = fill {
            let [r, g, b] = color(fill.paint())?;
            self.content.set_fill_rgb(r, g, b);
        }
        if let Some(stroke) = stroke {
            self.pen(stroke, map)?;
        }
        let even_odd = fill.is_some_and(|f| f.rule() == FillRule::EvenOdd);
        // a soft edge lies under the letters: PDF strokes last, so it is drawn first
        if let (Some(_), Some(_), PaintOrder::StrokeAndFill) = (fill, stroke, path.paint_order()) {
            self.outline(path, map);
            self.content.stroke();
            self.outline(path, map);
            self.filled(even_odd);
            return Ok(());
        }
        self.outline(path, map);
        match (fill, stroke) {
            (Some(_), Some(_)) if even_odd => self.content.fill_even_odd_and_stroke(),
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => {
                self.filled(even_odd);
                &mut self.content
            }
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
        Ok(())
    }

    fn filled(&mut self, even_odd: bool) {
        if even_odd {
            self.content.fill_even_odd()
        } else {
            self.content.fill_nonzero()
        };
    }

    fn shade(&mut self, opacities: [u8; 2]) {
        let [fill, stroke] = opacities;
        let name = format!("o{fill}s{stroke}");
        self.content.set_parameters(Name(name.as_bytes()));
        self.shades.insert(opacities, name);
    }

    fn pen(&mut self, stroke: &Stroke, map: Transform) -> Result<(), String> {
        let [r, g, b] = color(stroke.paint())?;
        // drawings are turned and scaled alike in all directions
        let scale = (map.sx * map.sy - map.kx * map.ky).abs().sqrt();
        self.content.set_stroke_rgb(r, g, b).set_line_width(round(stroke.width().get() * scale));
        self.content.set_line_cap(match stroke.linecap() {
            LineCap::Butt => LineCapStyle::ButtCap,
            LineCap::Round => LineCapStyle::RoundCap,
            LineCap::Square => LineCapStyle::ProjectingSquareCap,
        });
        self.content.set_line_join(match stroke.linejoin() {
            LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
            LineJoin::Round => LineJoinStyle::RoundJoin,
            LineJoin::Bevel => LineJoinStyle::BevelJoin,
        });
        let dashes = stroke.dasharray().unwrap_or_default().iter().map(|d| round(d * scale));
        self.content.set_dash_pattern(dashes, round(stroke.dashoffset() * scale));
        Ok(())
    }

    fn outline(&mut self, path: &Path, map: Transform) {
        let at = |mut p: Point| {
            map.map_point(&mut p);
            (round(p.x), round(p.y))
        };
        let mut last = Point::zero();
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(p) => {
                    let (x, y) = at(p);
                    self.content.move_to(x, y);
                    last = p;
                }
                PathSegment::LineTo(p) => {
                    let (x, y) = at(p);
                    self.content.line_to(x, y);
                    last = p;
                }
                PathSegment::QuadTo(c, p) => {
                    // the cubic that is the same curve
                    let toward = |from: Point| {
                        Point::from_xy(from.x + 2.0 / 3.0 * (c.x - from.x), from.y + 2.0 / 3.0 * (c.y - from.y))
                    };
                    let ((x1, y1), (x2, y2), (x, y)) = (at(toward(last)), at(toward(p)), at(p));
                    self.content.cubic_to(x1, y1, x2, y2, x, y);
                    last = p;
                }
                PathSegment::CubicTo(c, d, p) => {
                    let ((x1, y1), (x2, y2), (x, y)) = (at(c), at(d), at(p));
                    self.content.cubic_to(x1, y1, x2, y2, x, y);
                    last = p;
                }
                PathSegment::Close => {
                    self.content.close_path();
                }
            }
        }
    }
}

/// Hundredths of a point are finer than any printer.
fn round(v: f32) -> f32 {
    (v * 100.0).round() / 100.0
}

fn color(paint: &Paint) -> Result<[f32; 3], String> {
    match paint {
        Paint::Color(c) => Ok([c.red, c.green, c.blue].map(|v| (f32::from(v) / 255.0 * 1000.0).round() / 1000.0)),
        _ => Err("it holds a gradient or pattern".into()),
    }
}
