//! SVG: closed shapes are rooms; lines and shapes in a layer, class or id named for doors, windows or walls are those.
//!
//! What is drawn where is what counts: transforms and the view box are followed, looks (clips, masks, styles) are not.

use std::collections::BTreeMap;
use std::str::FromStr;

use d3dgen_model::Point;
use roxmltree::{Document, Node, ParsingOptions};
use svgtypes::{Length, LengthUnit, SimplePathSegment, SimplifyingPathParser, Transform, ViewBox};

use super::source::{Plan, Reader, Source};
use crate::drawing::{
    Drawing, DrawnLabel, DrawnOpening, DrawnRoom, DrawnShape, DrawnSolid, DrawnWall, Evidence, MOST_POINTS,
    OpeningKind, SolidKind, extent, note,
};
use crate::error::Error;
use crate::options::Options;
use crate::words::{Role, is_name, role, said_of};

pub(super) const READER: Reader = Reader { name: "svg", title: "SVG drawing", recognizes, read };

const FORMAT: &str = "svg";
const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
/// Most elements of a file.
const MOST_NODES: u32 = 500_000;
/// Straight pieces that a curve is made of.
const PIECES: usize = 8;
/// A drawing larger than this at the size it is printed in is drawn in its real size, m.
const REAL_SIZE_M: f64 = 1.5;
/// Most levels of `<use>` in one another, and most elements drawn by them.
const MOST_USES: usize = 8;
const MOST_USED: usize = 200_000;
/// Elements whose content is not drawn where it stands.
const UNSEEN: [&str; 8] = ["defs", "clipPath", "mask", "pattern", "marker", "symbol", "style", "metadata"];

fn recognizes(source: &Source) -> bool {
    source.has_ending(&[".svg"]) || source.head().contains("<svg")
}

/// A shape in the units of the drawing.
struct Shape {
    points: Vec<Point>,
    closed: bool,
    /// True for circles and ellipses.
    curved: bool,
}

/// What an element inherits.
#[derive(Clone, Copy)]
struct Scope {
    transform: Transform,
    role: Option<Role>,
    /// True when the user says what the role is.
    said: bool,
    /// How many `<use>` lie around it.
    uses: usize,
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let text = source.text(FORMAT)?;
    let limits = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, limits)
        .map_err(|e| Error::broken(FORMAT, format!("line {}", e.pos().row), e.to_string()))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(Error::broken(
            FORMAT,
            "line 1",
            format!("begins with <{}>, not with <svg>", root.tag_name().name()),
        ));
    }
    let mut drawing = Drawing::default();
    let by_id: BTreeMap<&str, Node> =
        document.descendants().filter_map(|n| n.attribute("id").map(|id| (id, n))).collect();
    let mut todo = vec![(root, Scope { transform: Transform::default(), role: None, said: false, uses: 0 }, false)];
    let (mut count, mut used) = (0_usize, 0_usize);
    while let Some((node, scope, asked)) = todo.pop() {
        // what a <use> asks for is drawn there, wherever it stands
        if !node.is_element() || !asked && UNSEEN.contains(&node.tag_name().name()) || is_hidden(&node) {
            continue;
        }
        let scope = Scope { transform: transform(&node, scope.transform)?, ..spoken(&node, scope, options) };
        count += add(&mut drawing, &node, scope)?;
        if node.tag_name().name() == "use" {
            if let Some((target, scope)) = used_by(&node, scope, &by_id).filter(|_| used < MOST_USED) {
                todo.push((target, scope, true));
            }
            continue;
        }
        used += usize::from(scope.uses > 0);
        if count > MOST_POINTS {
            return Err(Error::broken(FORMAT, place(&node), format!("the drawing has more than {MOST_POINTS} points")));
        }
        let children: Vec<Node> = node.children().filter(Node::is_element).collect();
        todo.extend(children.into_iter().rev().map(|c| (c, scope, false)));
    }
    scale(&mut drawing, &root, options)?;
    Ok(Plan::Drawing(drawing))
}

/// Returns the element that a `<use>` draws, with where it draws it.
fn used_by<'a, 'i>(
    node: &Node<'a, 'i>,
    scope: Scope,
    by_id: &BTreeMap<&str, Node<'a, 'i>>,
) -> Option<(Node<'a, 'i>, Scope)> {
    let href = node.attribute("href").or_else(|| node.attribute((XLINK, "href")))?;
    let target = *by_id.get(href.strip_prefix('#')?)?;
    let number = |n: &Node, name: &str| n.attribute(name).and_then(|t| Length::from_str(t).ok()).map(|l| l.number);
    let (x, y) = (number(node, "x").unwrap_or(0.0), number(node, "y").unwrap_or(0.0));
    let mut t = move_by(scope.transform, x, y, 1.0);
    // a symbol is fitted into the size asked for
    let view = target.attribute("viewBox").filter(|_| target.tag_name().name() == "symbol");
    if let Some(view) = view.and_then(|v| ViewBox::from_str(v).ok()).filter(|v| v.w > 0.0 && v.h > 0.0) {
        let size = |name: &str, whole: f64| number(node, name).map(|l| l / whole);
        let fit = [size("width", view.w), size("height", view.h)].into_iter().flatten().fold(f64::MAX, f64::min);
        let fit = if fit == f64::MAX { 1.0 } else { fit };
        t = move_by(t, -view.x * fit, -view.y * fit, fit);
    }
    (scope.uses < MOST_USES).then_some((target, Scope { transform: t, uses: scope.uses + 1, ..scope }))
}

/// Returns a transform after a shift and a scale inside of it.
fn move_by(t: Transform, x: f64, y: f64, scale: f64) -> Transform {
    Transform {
        a: t.a * scale,
        b: t.b * scale,
        c: t.c * scale,
        d: t.d * scale,
        e: t.a * x + t.c * y + t.e,
        f: t.b * x + t.d * y + t.f,
    }
}

fn is_hidden(node: &Node) -> bool {
    let style = node.attribute("style").unwrap_or_default().replace(' ', "");
    node.attribute("display") == Some("none") || style.contains("display:none")
}

/// Returns the name of an element for messages.
fn place(node: &Node) -> String {
    let row = node.document().text_pos_at(node.range().start).row;
    format!("line {row}: <{}>", node.tag_name().name())
}

fn transform(node: &Node, outer: Transform) -> Result<Transform, Error> {
    let Some(text) = node.attribute("transform") else { return Ok(outer) };
    let t = Transform::from_str(text)
        .map_err(|e| Error::broken(FORMAT, place(node), format!("transform `{text}`: {e}")))?;
    Ok(Transform {
        a: outer.a * t.a + outer.c * t.b,
        b: outer.b * t.a + outer.d * t.b,
        c: outer.a * t.c + outer.c * t.d,
        d: outer.b * t.c + outer.d * t.d,
        e: outer.a * t.e + outer.c * t.f + outer.e,
        f: outer.b * t.e + outer.d * t.f + outer.f,
    })
}

/// Returns the scope with what the user says of an element, or its class, layer name, type or id.
fn spoken(node: &Node, scope: Scope, options: &Options) -> Scope {
    match names(node).find_map(|n| said_of(n, options)) {
        Some(role) => Scope { role: Some(role), said: true, ..scope },
        None if scope.said => scope,
        None => Scope { role: names(node).find_map(role).or(scope.role), ..scope },
    }
}

/// Returns the names of an element that say what it is, if they say it.
fn names<'a>(node: &Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    let label = node.attribute((INKSCAPE, "label"));
    let names = [node.attribute("class"), node.attribute("data-type"), label, node.attribute("id")];
    names.into_iter().flatten().filter(|t| !is_automatic(t))
}

/// Returns the nearest name around an element, by which the user can say what is drawn there.
fn layer<'a>(node: &Node<'a, '_>) -> Option<&'a str> {
    node.ancestors().skip(1).find_map(|n| names(&n).next())
}

/// Returns true for names that drawing programs give by themselves.
fn is_automatic(id: &str) -> bool {
    const STEMS: [&str; 12] =
        ["rect", "path", "polygon", "polyline", "line", "g", "group", "text", "tspan", "svg", "layer", "shape"];
    let stem = id.trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, '-' | '_'));
    let counted = id.len() > stem.len() && !stem.eq_ignore_ascii_case("line")
        || STEMS.contains(&stem.to_ascii_lowercase().as_str());
    counted && STEMS.contains(&stem.to_ascii_lowercase().as_str())
}

/// Returns the name that a drawn room carries itself.
fn label(node: &Node) -> String {
    let child = |name: &str| {
        node.children().find(|c| c.has_tag_name((SVG, name)) || c.has_tag_name(name)).and_then(|c| c.text())
    };
    let id = node.attribute("id").filter(|id| !is_automatic(id));
    let found = [
        child("title"),
        node.attribute((INKSCAPE, "label")).filter(|l| !is_automatic(l)),
        node.attribute("aria-label"),
        node.attribute("data-name"),
        child("desc"),
        id,
    ];
    let named = found.into_iter().flatten().map(str::trim).find(|t| !t.is_empty());
    named.map(|t| t.replace('_', " ")).unwrap_or_default()
}

/// Adds what an element draws; returns how many points.
fn add(drawing: &mut Drawing, node: &Node, scope: Scope) -> Result<usize, Error> {
    if node.tag_name().name() == "text" {
        return Ok(add_text(drawing, node, scope));
    }
    let mut count = 0;
    for shape in shapes(node)? {
        let t = scope.transform;
        let at = |p: &Point| Point::new(t.a * p.x + t.c * p.y + t.e, t.b * p.x + t.d * p.y + t.f);
        let points: Vec<Point> = shape.points.iter().map(at).collect();
        count += points.len();
        add_shape(drawing, node, scope, Shape { points, ..shape });
    }
    Ok(count)
}

/// Adds a shape in the units of the drawing by what is said of its element.
fn add_shape(drawing: &mut Drawing, node: &Node, scope: Scope, Shape { points, closed, curved }: Shape) {
    let tag = node.tag_name().name();
    let layer = layer(node);
    drawing.saw(layer.or(names(node).next()).unwrap_or(tag), tag);
    let told = layer.map_or_else(|| "no layer".to_owned(), |l| format!("layer `{l}`"));
    let opening = match scope.role {
        Some(Role::Door) => Some(OpeningKind::Door),
        Some(Role::Passage) => Some(OpeningKind::Passage),
        Some(Role::Window) => Some(OpeningKind::Window),
        _ => None,
    };
    match (scope.role, opening) {
        (_, Some(kind)) => {
            let mut o = DrawnOpening::new(kind, points, None, place(node));
            o.sliding = node.attribute("class").is_some_and(|c| c.contains("sliding"));
            drawing.openings.push(o);
        }
        (Some(Role::Skip), _) => drawing.skip(format!("{told} as <{tag}>")),
        (Some(Role::Outline | Role::Tag), _) => {}
        (Some(Role::Column), _) if closed => {
            let (kind, place) = (SolidKind::Column, place(node));
            drawing.solids.push(DrawnSolid { kind, outline: points, level: None, place });
        }
        _ if closed => drawing.shapes.push(closed_shape(node, scope, told, points, curved)),
        (Some(Role::Wall), _) => drawing.walls.extend(points.windows(2).map(|p| DrawnWall {
            line: [p[0], p[1]],
            level: None,
            place: place(node),
        })),
        _ => drawing.leave_out(format!("{told} as <{tag}>")),
    }
}

/// Returns a closed shape with what its element says of it; a filled wall is drawn by its faces.
fn closed_shape(node: &Node, scope: Scope, layer: String, corners: Vec<Point>, curved: bool) -> DrawnShape {
    let label = label(node);
    let place = if label.is_empty() { place(node) } else { format!("room `{label}` ({})", place(node)) };
    let kind = node.attribute("data-room-type").map(str::to_owned);
    let evidence = match scope.role {
        Some(Role::Wall) => Evidence::Wall,
        Some(Role::Room) => Evidence::Room,
        _ if kind.is_some() || !label.is_empty() => Evidence::Named,
        _ => Evidence::None,
    };
    let room = DrawnRoom { kind, ..DrawnRoom::new(label, corners, place) };
    DrawnShape { room, evidence, layer, kind: format!("<{}>", node.tag_name().name()), curved }
}

fn add_text(drawing: &mut Drawing, node: &Node, scope: Scope) -> usize {
    let words: Vec<&str> = node.descendants().filter(Node::is_text).filter_map(|t| t.text()).map(str::trim).collect();
    let text = words.into_iter().filter(|t| is_name(t)).take(4).collect::<Vec<_>>().join(" ");
    let first = |name: &str| {
        let of = |n: Node| n.attribute(name)?.split([' ', ',']).next()?.trim_end_matches("px").parse::<f64>().ok();
        of(*node).or_else(|| node.children().filter(Node::is_element).find_map(of)).unwrap_or(0.0)
    };
    if text.is_empty() || matches!(scope.role, Some(Role::Skip)) {
        return 0;
    }
    let (x, y, t) = (first("x"), first("y"), scope.transform);
    let at = Point::new(t.a * x + t.c * y + t.e, t.b * x + t.d * y + t.f);
    drawing.labels.push(DrawnLabel { text, at, level: None });
    1
}

fn shapes(node: &Node) -> Result<Vec<Shape>, Error> {
    let number = |name: &str| -> Result<f64, Error> {
        let Some(text) = node.attribute(name) else { return Ok(0.0) };
        let length = Length::from_str(text)
            .map_err(|e| Error::broken(FORMAT, place(node), format!("{name}=\"{text}\": {e}")))?;
        // lengths inside the drawing in CSS pixels, as browsers have them
        Ok(millimeters(length).map_or(length.number, |mm| mm * 96.0 / 25.4))
    };
    let list =
        |text: &str| svgtypes::PointsParser::from(text).map(|(x, y)| Point::new(x, y)).take(MOST_POINTS).collect();
    let one = |points: Vec<Point>, closed: bool| Ok(vec![Shape { points, closed, curved: false }]);
    match node.tag_name().name() {
        "rect" => {
            let (x, y, w, h) = (number("x")?, number("y")?, number("width")?, number("height")?);
            if w <= 0.0 || h <= 0.0 {
                return Ok(Vec::new());
            }
            one([(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| Point::new(x, y)).to_vec(), true)
        }
        "line" => {
            let (a, b) = (Point::new(number("x1")?, number("y1")?), Point::new(number("x2")?, number("y2")?));
            one(vec![a, b], false)
        }
        "polygon" => one(list(node.attribute("points").unwrap_or_default()), true),
        "polyline" => {
            let points: Vec<Point> = list(node.attribute("points").unwrap_or_default());
            let closed = points.len() > 3 && points.first() == points.last();
            one(points, closed)
        }
        "path" => path(node),
        "circle" | "ellipse" => {
            let (x, y, r) = (number("cx")?, number("cy")?, number("r")?);
            let (rx, ry) = (number("rx")?.max(r), number("ry")?.max(r));
            let at = |k: usize| {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / (2 * PIECES) as f64).sin_cos();
                Point::new(x + rx * cos, y + ry * sin)
            };
            let points = (0..2 * PIECES).map(at).collect();
            Ok(if rx > 0.0 && ry > 0.0 { vec![Shape { points, closed: true, curved: true }] } else { Vec::new() })
        }
        _ => Ok(Vec::new()),
    }
}

fn path(node: &Node) -> Result<Vec<Shape>, Error> {
    let mut out: Vec<Shape> = Vec::new();
    let mut total = 0_usize;
    for segment in SimplifyingPathParser::from(node.attribute("d").unwrap_or_default()) {
        let segment = segment.map_err(|e| Error::broken(FORMAT, place(node), format!("path: {e}")))?;
        let here = out.last().and_then(|s| s.points.last().copied()).unwrap_or(Point::new(0.0, 0.0));
        let mut line = |points: &mut dyn Iterator<Item = Point>| {
            if out.last().is_none_or(|s| s.closed) {
                let start = out.last().and_then(|s| s.points.first().copied()).unwrap_or(here);
                out.push(Shape { points: vec![start], closed: false, curved: false });
            }
            if let Some(shape) = out.last_mut() {
                shape.points.extend(points);
            }
        };
        let steps = || (1..=PIECES).map(|k| k as f64 / PIECES as f64);
        match segment {
            SimplePathSegment::MoveTo { x, y } => {
                out.push(Shape { points: vec![Point::new(x, y)], closed: false, curved: false })
            }
            SimplePathSegment::LineTo { x, y } => line(&mut std::iter::once(Point::new(x, y))),
            SimplePathSegment::CurveTo { x1, y1, x2, y2, x, y } => line(&mut steps().map(|t| {
                let u = 1.0 - t;
                let (a, b, c, d) = (u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t);
                Point::new(a * here.x + b * x1 + c * x2 + d * x, a * here.y + b * y1 + c * y2 + d * y)
            })),
            SimplePathSegment::Quadratic { x1, y1, x, y } => line(&mut steps().map(|t| {
                let u = 1.0 - t;
                let (a, b, c) = (u * u, 2.0 * u * t, t * t);
                Point::new(a * here.x + b * x1 + c * x, a * here.y + b * y1 + c * y)
            })),
            SimplePathSegment::ClosePath => {
                if let Some(shape) = out.last_mut() {
                    shape.closed = true;
                }
            }
        }
        total += PIECES;
        if total > 2 * MOST_POINTS {
            return Err(Error::broken(FORMAT, place(node), format!("the path has more than {MOST_POINTS} points")));
        }
    }
    for shape in &mut out {
        let back = shape.points.len() > 3 && shape.points.first() == shape.points.last();
        shape.closed |= back;
    }
    out.retain(|s| s.points.len() > 1);
    Ok(out)
}

fn millimeters(length: Length) -> Option<f64> {
    let factor = match length.unit {
        LengthUnit::Mm => 1.0,
        LengthUnit::Cm => 10.0,
        LengthUnit::In => 25.4,
        LengthUnit::Pt => 25.4 / 72.0,
        LengthUnit::Pc => 25.4 / 6.0,
        _ => return None,
    };
    Some(length.number * factor)
}

/// Turns the units of the drawing into meters, and y upwards.
fn scale(drawing: &mut Drawing, root: &Node, options: &Options) -> Result<(), Error> {
    let shapes = drawing.shapes.iter().filter(|s| !s.curved).flat_map(|s| &s.room.corners);
    let corners = shapes.chain(drawing.walls.iter().flat_map(|w| &w.line));
    let Some([x0, y0, x1, y1]) = extent(corners.copied()) else {
        let layers = drawing.tell_of_layers();
        let message = format!("holds no closed shapes and no walls; rooms are rect, polygon or closed path{layers}");
        return Err(Error::refused("drawing", message));
    };
    let (width, height) = (x1 - x0, y1 - y0);
    let unit = match options.meters_per_unit {
        Some(unit) => unit,
        None => {
            let hint = |printed| hint(printed, width, height);
            let printed = printed(root);
            match printed {
                Some(unit) if width.max(height) * unit >= REAL_SIZE_M => unit,
                Some(unit) => {
                    let message = format!(
                        "the rooms are {:.0} mm by {:.0} mm as printed, too small to be their real size; {}",
                        width * unit * 1000.0,
                        height * unit * 1000.0,
                        hint(Some(unit))
                    );
                    return Err(Error::refused("scale", message));
                }
                None => return Err(Error::refused("scale", format!("the drawing has no unit; {}", hint(None)))),
            }
        }
    };
    drawing.points_mut().for_each(|p| *p = Point::new((p.x - x0) * unit, (y1 - p.y) * unit));
    drawing.notes.push(note("scale", format!("one unit of the drawing is {unit} m")));
    Ok(())
}

/// Returns the length of a unit as the drawing is printed, m, where the file states its size.
fn printed(root: &Node) -> Option<f64> {
    let length = |name: &str| root.attribute(name).and_then(|t| Length::from_str(t).ok()).and_then(millimeters);
    let view = root.attribute("viewBox").and_then(|v| ViewBox::from_str(v).ok());
    match (length("width"), length("height"), view) {
        (Some(mm), _, Some(v)) if v.w > 0.0 => Some(mm / v.w / 1000.0),
        (None, Some(mm), Some(v)) if v.h > 0.0 => Some(mm / v.h / 1000.0),
        (Some(_), _, None) | (_, Some(_), None) => Some(0.0254 / 96.0),
        _ => None,
    }
}

/// Returns what to say of the unit, for a drawing so many units wide and high.
fn hint(printed: Option<f64>, width: f64, height: f64) -> String {
    let guess = 10.0_f64.powf((10.0 / width.max(height).max(1e-12)).log10().round());
    // a plan is printed a hundred times smaller than it is, or more
    let large = |unit: &f64| (0.1..10.0).contains(&(guess / unit));
    let guess = printed.filter(large).map_or(guess, |unit| unit * 100.0);
    format!(
        "say how long one unit is: --meters-per-unit {guess} would make the plan {:.2} m by {:.2} m",
        width * guess,
        height * guess
    )
}
