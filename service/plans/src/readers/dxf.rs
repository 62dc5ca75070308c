//! DXF (text form): closed polylines are rooms, lines on a layer named for walls are walls, texts inside rooms their names.
//!
//! Blocks are drawn where they are inserted; one named for doors or windows is an opening as large as what is in it.
//!
//! Read by hand: a plan is six kinds of entities out of some fifty, as pairs of lines. The `dxf` crate builds them all,
//! with clock and random numbers for the files it writes, which this crate must not have.

use std::collections::BTreeMap;
use std::str::Lines;

use d3dgen_model::Point;

use super::source::{Plan, Reader, Source};
use crate::drawing::{
    Drawing, DrawnLabel, DrawnOpening, DrawnRoom, DrawnShape, DrawnSolid, DrawnWall, Evidence, MOST_POINTS,
    OpeningKind, SolidKind, extent, note,
};
use crate::error::Error;
use crate::options::Options;
use crate::shape::hull;
use crate::words::{Role, role, role_of};

pub(super) const READER: Reader = Reader { name: "dxf", title: "DXF drawing (text form)", recognizes, read };

const FORMAT: &str = "dxf";
/// Most levels of blocks in one another, and most blocks drawn.
const MOST_DEPTH: usize = 8;
const MOST_INSERTS: usize = 50_000;
/// Straight pieces that a bulge is made of.
const PIECES: usize = 8;
/// Meters of a unit by `$INSUNITS`.
const UNITS: [(i64, f64); 11] = [
    (1, 0.0254),
    (2, 0.3048),
    (4, 0.001),
    (5, 0.01),
    (6, 1.0),
    (7, 1000.0),
    (8, 0.0254e-6),
    (10, 0.9144),
    (13, 1e-6),
    (14, 0.1),
    (21, 1200.0 / 3937.0),
];

fn recognizes(source: &Source) -> bool {
    source.has_ending(&[".dxf"]) || source.head().trim_start().starts_with("0\nSECTION")
}

/// Group codes and values of a file, in order.
struct Pairs<'a> {
    lines: Lines<'a>,
    line: usize,
}

impl<'a> Pairs<'a> {
    fn next(&mut self) -> Result<Option<(i32, &'a str)>, Error> {
        let Some(code) = self.lines.next() else { return Ok(None) };
        self.line += 2;
        let place = || format!("line {}", self.line - 1);
        if code.trim().is_empty() && self.lines.clone().next().is_none() {
            return Ok(None);
        }
        let number = code.trim().parse().map_err(|_| {
            Error::broken(FORMAT, place(), format!("`{}` is no group code", code.chars().take(20).collect::<String>()))
        })?;
        let value = self.lines.next().ok_or_else(|| Error::broken(FORMAT, place(), "the file ends in a group"))?;
        Ok(Some((number, value.trim())))
    }
}

/// One entity: its kind, the line it begins in, its groups.
struct Entity<'a> {
    kind: &'a str,
    line: usize,
    groups: Vec<(i32, &'a str)>,
}

impl<'a> Entity<'a> {
    fn text(&self, code: i32) -> Option<&'a str> {
        self.groups.iter().find(|g| g.0 == code).map(|g| g.1)
    }

    fn number(&self, code: i32) -> Result<Option<f64>, Error> {
        self.text(code).map(|t| self.parse(code, t)).transpose()
    }

    fn parse(&self, code: i32, text: &str) -> Result<f64, Error> {
        text.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| {
            let text: String = text.chars().take(30).collect();
            Error::broken(FORMAT, self.place(), format!("group {code}: `{text}` is no number"))
        })
    }

    fn point(&self, x: i32) -> Result<Point, Error> {
        let missing = || Error::broken(FORMAT, self.place(), format!("has no coordinates (groups {x} and {})", x + 10));
        Ok(Point::new(self.number(x)?.ok_or_else(missing)?, self.number(x + 10)?.ok_or_else(missing)?))
    }

    fn place(&self) -> String {
        format!("{} in line {}", self.kind, self.line)
    }

    fn layer(&self) -> &str {
        self.text(8).unwrap_or("0")
    }
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    if source.bytes.starts_with(b"AutoCAD Binary DXF") {
        return Err(Error::broken(FORMAT, "byte 0", "is the binary form; save it as text (ASCII) DXF"));
    }
    // old files are in a code page of one byte a letter
    let text = match source.text(FORMAT) {
        Ok(text) => text.to_owned(),
        Err(_) => source.bytes.iter().map(|&b| char::from(b)).collect(),
    };
    let mut state = State { options: options.clone(), ..State::default() };
    let Contents { unit, blocks, entities } = contents(&text, &mut state)?;
    let mut drawing = Drawing::default();
    let outer = Frame::default();
    for e in &entities {
        state.add(&mut drawing, e, &outer, &blocks)?;
    }
    scale(&mut drawing, unit, options);
    Ok(Plan::Drawing(drawing))
}

/// What a file holds.
#[derive(Default)]
struct Contents<'a> {
    /// Code of the unit of lengths.
    unit: Option<i64>,
    blocks: Blocks<'a>,
    entities: Vec<Entity<'a>>,
}

/// Reads a file section by section; `state` counts the entities.
fn contents<'a>(text: &'a str, state: &mut State) -> Result<Contents<'a>, Error> {
    let mut pairs = Pairs { lines: text.lines(), line: 0 };
    let (mut section, mut variable) = ("", "");
    let mut out = Contents::default();
    let mut entity: Option<Entity> = None;
    // the block that is being read
    let mut block: Option<Block> = None;
    let mut found = false;
    while let Some((code, value)) = pairs.next()? {
        match (code, value) {
            (0, _) => {
                if let Some(done) = entity.take() {
                    state.count(&done)?;
                    match (&mut block, done.kind) {
                        (None, "BLOCK") => block = Some(Block::new(&done)?),
                        (Some(open), kind) if kind != "BLOCK" => open.entities.push(done),
                        (None, _) if section == "ENTITIES" => out.entities.push(done),
                        _ => {}
                    }
                }
                match value {
                    "ENDSEC" => (section, block) = ("", None),
                    "EOF" => break,
                    "SECTION" => {}
                    "ENDBLK" => {
                        if let Some(done) = block.take() {
                            out.blocks.insert(done.name, done);
                        }
                    }
                    kind if matches!(section, "ENTITIES" | "BLOCKS") => {
                        entity = Some(Entity { kind, line: pairs.line - 1, groups: Vec::new() });
                    }
                    _ => {}
                }
            }
            (2, name) if section.is_empty() && entity.is_none() => {
                section = name;
                found = true;
            }
            (9, name) if section == "HEADER" => variable = name,
            (70, value) if section == "HEADER" && variable == "$INSUNITS" => out.unit = value.parse().ok(),
            _ => {
                if let Some(e) = &mut entity {
                    e.groups.push((code, value));
                }
            }
        }
    }
    if !found {
        return Err(Error::broken(
            FORMAT,
            "line 1",
            "holds no section; a DXF begins with the groups 0 SECTION, 2 HEADER",
        ));
    }
    out.entities.extend(entity.take().filter(|_| section == "ENTITIES"));
    Ok(out)
}

/// Turns the units of the drawing into meters.
fn scale(drawing: &mut Drawing, unit: Option<i64>, options: &Options) {
    let named = UNITS.iter().find(|u| Some(u.0) == unit).map(|u| u.1);
    let scale = match (options.meters_per_unit, named) {
        (Some(scale), _) => scale,
        (None, Some(scale)) => {
            drawing.notes.push(note("scale", format!("one unit of the drawing is {scale} m, as $INSUNITS says")));
            scale
        }
        (None, None) => {
            let scale = guessed(drawing);
            let message = format!(
                "the drawing does not state its unit ($INSUNITS); {scale} m was guessed by its size, say it with --meters-per-unit"
            );
            drawing.notes.push(note("unit_assumed", message));
            scale
        }
    };
    drawing.points_mut().for_each(|p| *p = Point::new(p.x * scale, p.y * scale));
    for o in &mut drawing.openings {
        o.width_m = o.width_m.map(|w| if w <= 0.0 { w } else { w * scale }).filter(|w| (0.5..=4.0).contains(w));
    }
}

/// Returns the unit by the size of the drawing: a building has some tens of meters.
fn guessed(drawing: &mut Drawing) -> f64 {
    match extent(drawing.points_mut().map(|p| *p)).map_or(0.0, |b| (b[2] - b[0]).max(b[3] - b[1])) {
        side if side > 2000.0 => 0.001,
        side if side > 250.0 => 0.01,
        _ => 1.0,
    }
}

/// A POLYLINE whose vertices are still to come: points with bulges, whether it is closed, its layer and line.
type Open = (Vec<(Point, f64)>, bool, String, usize);

/// A group of entities with a name, drawn wherever it is inserted.
struct Block<'a> {
    name: &'a str,
    base: Point,
    entities: Vec<Entity<'a>>,
}

type Blocks<'a> = BTreeMap<&'a str, Block<'a>>;

impl<'a> Block<'a> {
    fn new(head: &Entity<'a>) -> Result<Self, Error> {
        let base = Point::new(head.number(10)?.unwrap_or(0.0), head.number(20)?.unwrap_or(0.0));
        Ok(Self { name: head.text(2).unwrap_or_default(), base, entities: Vec::new() })
    }

    /// Returns true for a block with anything in it that makes rooms or walls: doors and windows are blocks of lines too.
    fn is_plan(&self, blocks: &Blocks, depth: usize) -> bool {
        let rooms = |e: &Entity| match e.kind {
            "INSERT" => {
                e.text(2).and_then(|n| blocks.get(n)).is_some_and(|b| depth > 0 && b.is_plan(blocks, depth - 1))
            }
            "LWPOLYLINE" | "POLYLINE" | "LINE" => matches!(role(e.layer()), Some(Role::Wall | Role::Room)),
            _ => false,
        };
        self.entities.iter().any(rooms)
    }

    /// Returns the points of all that is drawn in the block.
    fn points(&self, frame: &Frame, blocks: &Blocks) -> Result<Vec<Point>, Error> {
        let mut out = Vec::new();
        for e in &self.entities {
            match e.kind {
                "LINE" => out.extend([frame.at(e.point(10)?), frame.at(e.point(11)?)]),
                "LWPOLYLINE" => out.extend(placed(&light_corners(e)?, frame).iter().map(|c| c.0)),
                "VERTEX" => out.push(frame.at(e.point(10)?)),
                "CIRCLE" => out.extend(circle(e, frame)?),
                "SOLID" | "TRACE" => out.extend(solid_corners(e, frame)?.iter().map(|c| c.0)),
                "HATCH" => out.extend(hatch_loops(e, frame)?.into_iter().flatten()),
                "INSERT" if frame.depth < MOST_DEPTH => {
                    if let Some(inner) = e.text(2).and_then(|n| blocks.get(n)) {
                        out.extend(inner.points(&frame.inside(e, inner)?, blocks)?);
                    }
                }
                _ => {}
            }
            if out.len() > MOST_POINTS {
                break;
            }
        }
        Ok(out)
    }
}

/// Where entities are drawn: inside of the inserts around them.
#[derive(Clone)]
struct Frame {
    /// x' = a x + c y + e, y' = b x + d y + f.
    map: [f64; 6],
    /// Layer of the insert, which entities on layer 0 of a block get.
    layer: Option<String>,
    depth: usize,
}

impl Default for Frame {
    fn default() -> Self {
        Self { map: [1.0, 0.0, 0.0, 1.0, 0.0, 0.0], layer: None, depth: 0 }
    }
}

impl Frame {
    fn at(&self, p: Point) -> Point {
        let [a, b, c, d, e, f] = self.map;
        Point::new(a * p.x + c * p.y + e, b * p.x + d * p.y + f)
    }

    /// True when the drawing is turned over, which turns arcs round.
    fn mirrors(&self) -> bool {
        self.map[0] * self.map[3] - self.map[1] * self.map[2] < 0.0
    }

    fn layer_of<'e>(&'e self, e: &'e Entity) -> &'e str {
        match &self.layer {
            Some(layer) if e.layer() == "0" => layer,
            _ => e.layer(),
        }
    }

    /// Returns the frame of a block inserted in this one.
    fn inside(&self, insert: &Entity, block: &Block) -> Result<Self, Error> {
        let (x, y) = (insert.number(41)?.unwrap_or(1.0), insert.number(42)?.unwrap_or(1.0));
        let (sin, cos) = insert.number(50)?.unwrap_or(0.0).to_radians().sin_cos();
        let at = insert.point(10)?;
        let [a, b, c, d] = [cos * x, sin * x, -sin * y, cos * y];
        let (e, f) = (at.x - a * block.base.x - c * block.base.y, at.y - b * block.base.x - d * block.base.y);
        let [oa, ob, oc, od, oe, of] = self.map;
        let map = [
            oa * a + oc * b,
            ob * a + od * b,
            oa * c + oc * d,
            ob * c + od * d,
            oa * e + oc * f + oe,
            ob * e + od * f + of,
        ];
        Ok(Self { map, layer: Some(self.layer_of(insert).to_owned()), depth: self.depth + 1 })
    }
}

/// What goes over several entities.
#[derive(Default)]
struct State {
    options: Options,
    /// Corners of a POLYLINE that is still open: points, bulges, whether it is closed, its layer and line.
    polyline: Option<Open>,
    points: usize,
    inserted: usize,
}

impl State {
    fn count(&mut self, e: &Entity) -> Result<(), Error> {
        self.points += e.groups.len();
        if self.points > 40 * MOST_POINTS {
            return Err(Error::broken(FORMAT, e.place(), "the drawing is too large for a floor plan"));
        }
        Ok(())
    }

    fn add(&mut self, drawing: &mut Drawing, e: &Entity, frame: &Frame, blocks: &Blocks) -> Result<(), Error> {
        let layer = frame.layer_of(e);
        let role = role_of(layer, &self.options);
        if !matches!(e.kind, "VERTEX" | "SEQEND" | "ATTRIB" | "VIEWPORT") {
            drawing.saw(layer, e.kind);
        }
        let draw = Draw { layer, role, kind: e.kind, place: e.place(), inside: frame.depth > 0 };
        match e.kind {
            "LWPOLYLINE" => draw.polyline(drawing, &placed(&light_corners(e)?, frame), is_closed(e)?),
            "POLYLINE" => self.polyline = Some((Vec::new(), is_closed(e)?, layer.to_owned(), e.line)),
            "VERTEX" => {
                let (at, bulge) = (e.point(10)?, e.number(42)?.unwrap_or(0.0));
                if let Some(p) = &mut self.polyline {
                    p.0.push((at, bulge));
                }
            }
            "SEQEND" => {
                if let Some((corners, closed, layer, line)) = self.polyline.take() {
                    let (role, place) = (role_of(&layer, &self.options), format!("POLYLINE in line {line}"));
                    let draw = Draw { layer: &layer, role, kind: "POLYLINE", place, inside: frame.depth > 0 };
                    draw.polyline(drawing, &placed(&corners, frame), closed);
                }
            }
            "LINE" => {
                let line = [(frame.at(e.point(10)?), 0.0), (frame.at(e.point(11)?), 0.0)];
                draw.polyline(drawing, &line, false);
            }
            "ARC" if matches!(role, None | Some(Role::Door)) && arc(drawing, e, frame)? => {}
            "CIRCLE" => draw.curve(drawing, circle(e, frame)?),
            "SOLID" | "TRACE" => draw.polyline(drawing, &solid_corners(e, frame)?, true),
            "HATCH" => draw.hatch(drawing, hatch_loops(e, frame)?),
            "INSERT" => self.insert(drawing, e, role, frame, blocks)?,
            "TEXT" | "MTEXT" | "ATTRIB" => text(drawing, e, role, frame)?,
            // what measures and explains a drawing is no part of the building
            "DIMENSION" | "LEADER" | "MULTILEADER" | "ATTDEF" | "POINT" | "VIEWPORT" | "TOLERANCE" | "XLINE"
            | "RAY" => {}
            _ => draw.leave_out(drawing),
        }
        Ok(())
    }

    /// Adds a block: a door or window by its layer or name, otherwise what is in it.
    fn insert(
        &mut self,
        drawing: &mut Drawing,
        e: &Entity,
        layer_role: Option<Role>,
        frame: &Frame,
        blocks: &Blocks,
    ) -> Result<(), Error> {
        let name = e.text(2).unwrap_or_default();
        let block = blocks.get(name);
        let plan = block.is_some_and(|b| b.is_plan(blocks, MOST_DEPTH));
        let said = layer_role.filter(|r| *r != Role::Wall).or_else(|| role(name));
        let layer = frame.layer_of(e);
        if said == Some(Role::Column) && !plan {
            return column_of_block(drawing, e, block, frame, blocks);
        }
        if let Some(kind) = opening_of(said).filter(|_| !plan) {
            drawing.openings.extend(openings_of_block(kind, e, block, frame, blocks)?);
            return Ok(());
        }
        self.inserted += 1;
        if said == Some(Role::Skip) {
            drawing.skip(format!("layer `{layer}` as block `{name}`"));
            return Ok(());
        }
        if frame.depth >= MOST_DEPTH || self.inserted > MOST_INSERTS {
            return Ok(());
        }
        if let Some(block) = block {
            let inside = frame.inside(e, block)?;
            // a polyline that the block leaves open ends with it
            let open = self.polyline.take();
            for entity in &block.entities {
                self.count(entity)?;
                self.add(drawing, entity, &inside, blocks)?;
            }
            self.polyline = open;
        }
        Ok(())
    }
}

/// Adds the column that a block is: what is drawn in it, without dents.
fn column_of_block(
    drawing: &mut Drawing,
    e: &Entity,
    block: Option<&Block>,
    frame: &Frame,
    blocks: &Blocks,
) -> Result<(), Error> {
    let points = block.map(|b| b.points(&frame.inside(e, b)?, blocks)).transpose()?;
    let outline = hull(&points.unwrap_or_default());
    if outline.len() > 2 {
        drawing.solids.push(DrawnSolid { kind: SolidKind::Column, outline, level: None, place: e.place() });
    } else {
        let name = e.text(2).unwrap_or_default();
        drawing.leave_out(format!("layer `{}` as block `{name}`", frame.layer_of(e)));
    }
    Ok(())
}

/// Returns the openings that a block is: one for each swing in it, otherwise one as large as what is in it.
fn openings_of_block(
    kind: OpeningKind,
    e: &Entity,
    block: Option<&Block>,
    frame: &Frame,
    blocks: &Blocks,
) -> Result<Vec<DrawnOpening>, Error> {
    let mut inner = Drawing::default();
    if let Some(block) = block {
        let layered = Frame { layer: None, ..frame.inside(e, block)? };
        shape_of(&mut inner, block, &layered, blocks)?;
    }
    let plain = |points: Vec<Point>| DrawnOpening::new(kind, points, None, e.place());
    let arcs = inner.openings.iter().filter_map(|o| o.arc);
    let found: Vec<DrawnOpening> = arcs.map(|arc| DrawnOpening { arc: Some(arc), ..plain(Vec::new()) }).collect();
    if !found.is_empty() && kind == OpeningKind::Door {
        return Ok(found);
    }
    let points: Vec<Point> = inner.openings.iter().flat_map(|o| o.points.iter().copied()).collect();
    let own = if points.len() > 1 { points } else { vec![frame.at(e.point(10)?)] };
    Ok(vec![DrawnOpening { width_m: e.number(41)?.map(f64::abs), ..plain(own) }])
}

/// Adds the lines and arcs of a block of a door or window, whatever layers they are on.
fn shape_of(drawing: &mut Drawing, block: &Block, frame: &Frame, blocks: &Blocks) -> Result<(), Error> {
    let mut lines = |points: Vec<Point>| {
        drawing.openings.push(DrawnOpening::new(OpeningKind::Passage, points, None, String::new()));
    };
    for e in &block.entities {
        match e.kind {
            "LINE" => lines(vec![frame.at(e.point(10)?), frame.at(e.point(11)?)]),
            "LWPOLYLINE" => lines(placed(&light_corners(e)?, frame).into_iter().map(|c| c.0).collect()),
            _ => {}
        }
    }
    for e in &block.entities {
        match e.kind {
            "ARC" => {
                arc(drawing, e, frame)?;
            }
            "INSERT" if frame.depth < MOST_DEPTH => {
                if let Some(inner) = e.text(2).and_then(|n| blocks.get(n)) {
                    shape_of(drawing, inner, &frame.inside(e, inner)?, blocks)?;
                }
            }
            _ => {}
        }
        if drawing.openings.len() > MOST_INSERTS {
            break;
        }
    }
    Ok(())
}

/// Returns corners where a frame draws them.
fn placed(corners: &[(Point, f64)], frame: &Frame) -> Vec<(Point, f64)> {
    let turn = if frame.mirrors() { -1.0 } else { 1.0 };
    corners.iter().map(|(p, bulge)| (frame.at(*p), bulge * turn)).collect()
}

fn is_closed(e: &Entity) -> Result<bool, Error> {
    Ok(e.number(70)?.unwrap_or(0.0) as i64 & 1 == 1)
}

/// Returns the corners of an LWPOLYLINE with their bulges.
fn light_corners(e: &Entity) -> Result<Vec<(Point, f64)>, Error> {
    let mut corners: Vec<(Point, f64)> = Vec::new();
    for (code, value) in &e.groups {
        match code {
            10 => corners.push((Point::new(e.parse(10, value)?, 0.0), 0.0)),
            20 => corners.last_mut().map_or(Ok(()), |c| e.parse(20, value).map(|y| c.0.y = y))?,
            42 => corners.last_mut().map_or(Ok(()), |c| e.parse(42, value).map(|b| c.1 = b))?,
            _ => {}
        }
    }
    Ok(corners)
}

/// Returns the corners of a SOLID in order around it: the file has the last two the other way round.
fn solid_corners(e: &Entity, frame: &Frame) -> Result<Vec<(Point, f64)>, Error> {
    let fourth = if e.text(13).is_some() { 13 } else { 12 };
    [10, 11, fourth, 12].into_iter().map(|code| Ok((frame.at(e.point(code)?), 0.0))).collect()
}

/// Returns a circle in straight pieces.
fn circle(e: &Entity, frame: &Frame) -> Result<Vec<Point>, Error> {
    let (center, radius) = (e.point(10)?, e.number(40)?.unwrap_or(0.0).abs());
    let at = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / (2 * PIECES) as f64).sin_cos();
        frame.at(Point::new(center.x + radius * cos, center.y + radius * sin))
    };
    Ok((0..2 * PIECES).map(at).collect())
}

/// Returns the outlines of a HATCH: polylines as they are, edges by their ends.
fn hatch_loops(e: &Entity, frame: &Frame) -> Result<Vec<Vec<Point>>, Error> {
    let begin = e.groups.iter().position(|g| g.0 == 91).map_or(e.groups.len(), |k| k + 1);
    let mut loops: Vec<Vec<Point>> = Vec::new();
    let mut x: Option<f64> = None;
    for (code, value) in &e.groups[begin..] {
        match code {
            92 => loops.push(Vec::new()),
            // pattern lines and seed points come after the outlines
            75 | 98 => break,
            10 | 11 => x = Some(e.parse(*code, value)?),
            20 | 21 => {
                let at = x.take().map(|x| Ok::<_, Error>(Point::new(x, e.parse(*code, value)?))).transpose()?;
                if let (Some(p), Some(last)) = (at, loops.last_mut()) {
                    last.push(frame.at(p));
                }
            }
            _ => {}
        }
    }
    loops.iter_mut().for_each(|l| l.dedup_by(|a, b| a.distance(*b) < 1e-9));
    loops.retain(|l| l.len() > 2);
    Ok(loops)
}

fn text(drawing: &mut Drawing, e: &Entity, role: Option<Role>, frame: &Frame) -> Result<(), Error> {
    let at = frame.at(e.point(10)?);
    // long texts come in pieces; names and areas stand on lines of their own
    let parts = e.groups.iter().filter(|g| g.0 == 1 || g.0 == 3 && e.kind == "MTEXT").map(|g| g.1);
    let text = plain(&parts.collect::<String>());
    if role != Some(Role::Skip) {
        let lines = text.lines().map(str::trim).filter(|l| !l.is_empty());
        drawing.labels.extend(lines.map(|l| DrawnLabel { text: l.to_owned(), at, level: None }));
    }
    Ok(())
}

fn opening_of(role: Option<Role>) -> Option<OpeningKind> {
    match role {
        Some(Role::Door) => Some(OpeningKind::Door),
        Some(Role::Passage) => Some(OpeningKind::Passage),
        Some(Role::Window) => Some(OpeningKind::Window),
        _ => None,
    }
}

/// How an entity is drawn: where, and what its layer says it is.
struct Draw<'a> {
    layer: &'a str,
    role: Option<Role>,
    kind: &'a str,
    place: String,
    /// True inside of a block.
    inside: bool,
}

impl Draw<'_> {
    /// Counts what is drawn and not read.
    fn leave_out(&self, drawing: &mut Drawing) {
        let what = format!("layer `{}` as {}", self.layer, self.kind);
        match self.role {
            Some(Role::Skip) => drawing.skip(what),
            Some(Role::Tag | Role::Outline) => {}
            _ => drawing.leave_out(what),
        }
    }

    fn is_no_building(&self) -> bool {
        matches!(self.role, Some(Role::Skip | Role::Outline | Role::Tag))
    }

    fn polyline(self, drawing: &mut Drawing, corners: &[(Point, f64)], closed: bool) {
        let closed = closed || corners.len() > 3 && corners.first().map(|c| c.0) == corners.last().map(|c| c.0);
        let mut points: Vec<Point> = Vec::new();
        for (i, &(a, bulge)) in corners.iter().enumerate() {
            points.push(a);
            let next = corners.get(i + 1).or(closed.then(|| &corners[0]));
            if let (Some(&(b, _)), true) = (next, bulge.abs() > 1e-6) {
                points.extend(bulged(a, b, bulge));
            }
        }
        if points.len() < 2 || self.is_no_building() {
            return self.leave_out(drawing);
        }
        let place = format!("{} on layer `{}`", self.place, self.layer);
        if let Some(kind) = opening_of(self.role) {
            drawing.openings.push(DrawnOpening::new(kind, points, None, place));
        } else if closed && points.len() > 2 {
            self.shape(drawing, points, false);
        } else if self.role == Some(Role::Wall) {
            drawing.walls.extend(points.windows(2).map(|p| wall(p, &place)));
        } else if self.role.is_none() && self.layer == "0" && !self.inside {
            let told = format!("layer `0` as {}", self.kind);
            drawing.perhaps_walls.extend(points.windows(2).map(|p| (told.clone(), wall(p, &place))));
        } else {
            self.leave_out(drawing);
        }
    }

    /// Adds a circle, which is a column or nothing of the building.
    fn curve(self, drawing: &mut Drawing, outline: Vec<Point>) {
        match self.role {
            Some(Role::Column | Role::Wall) => self.shape(drawing, outline, true),
            _ => self.leave_out(drawing),
        }
    }

    /// Adds the outlines of a hatch, which are columns; a hatch fills walls and rooms that are drawn beside it.
    fn hatch(self, drawing: &mut Drawing, loops: Vec<Vec<Point>>) {
        if self.role != Some(Role::Column) {
            if !matches!(self.role, Some(Role::Wall | Role::Room)) {
                self.leave_out(drawing);
            }
            return;
        }
        for outline in loops {
            drawing.solids.push(DrawnSolid {
                kind: SolidKind::Column,
                outline,
                level: None,
                place: self.place.clone(),
            });
        }
    }

    /// Adds a closed shape with what its layer says of it.
    fn shape(self, drawing: &mut Drawing, corners: Vec<Point>, curved: bool) {
        let place = format!("{} on layer `{}`", self.place, self.layer);
        let evidence = match self.role {
            Some(Role::Column) => {
                drawing.solids.push(DrawnSolid { kind: SolidKind::Column, outline: corners, level: None, place });
                return;
            }
            Some(Role::Room) => Evidence::Room,
            Some(Role::Wall) => Evidence::Wall,
            _ => Evidence::None,
        };
        drawing.shapes.push(DrawnShape {
            room: DrawnRoom::new(String::new(), corners, place),
            evidence,
            layer: format!("layer `{}`", self.layer),
            kind: self.kind.to_owned(),
            curved,
        });
    }
}

fn wall(ends: &[Point], place: &str) -> DrawnWall {
    DrawnWall { line: [ends[0], ends[1]], level: None, place: place.to_owned() }
}

/// Returns points on the arc between two corners, the ends left out; a bulge is the tangent of a quarter of its angle.
fn bulged(a: Point, b: Point, bulge: f64) -> Vec<Point> {
    let angle = 4.0 * bulge.clamp(-1e3, 1e3).atan();
    let half = angle / 2.0;
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let lift = 1.0 / (2.0 * half.tan());
    let center = Point::new((a.x + b.x) / 2.0 - dy * lift, (a.y + b.y) / 2.0 + dx * lift);
    (1..PIECES)
        .map(|k| {
            let (sin, cos) = (angle * k as f64 / PIECES as f64).sin_cos();
            let (x, y) = (a.x - center.x, a.y - center.y);
            Point::new(center.x + x * cos - y * sin, center.y + x * sin + y * cos)
        })
        .collect()
}

/// Adds a quarter circle, the swing of a door; returns false for other arcs.
fn arc(drawing: &mut Drawing, e: &Entity, frame: &Frame) -> Result<bool, Error> {
    let (center, radius) = (e.point(10)?, e.number(40)?.unwrap_or(0.0));
    let (from, to) = (e.number(50)?.unwrap_or(0.0), e.number(51)?.unwrap_or(360.0));
    let sweep = (to - from).rem_euclid(360.0);
    if !(60.0..=120.0).contains(&sweep) || radius <= 0.0 {
        return Ok(false);
    }
    let end = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        frame.at(Point::new(center.x + radius * cos, center.y + radius * sin))
    };
    let mut o = DrawnOpening::new(OpeningKind::Door, Vec::new(), None, e.place());
    o.arc = Some([frame.at(center), end(from), end(to)]);
    drawing.openings.push(o);
    Ok(true)
}

/// Returns a text without its formatting codes: `{\fArial|b0;Bath}\P4 m2` is `Bath 4 m2`.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match (c, chars.peek().copied()) {
            ('\\', Some(code @ ('P' | '~'))) => {
                chars.next();
                out.push(if code == 'P' { '\n' } else { ' ' });
            }
            ('\\', Some('L' | 'l' | 'O' | 'o' | 'K' | 'k' | '\\' | '{' | '}')) => {
                chars.next();
            }
            ('\\', Some('U')) => {
                let code: String = chars.by_ref().skip(2).take(4).collect();
                out.extend(u32::from_str_radix(&code, 16).ok().and_then(char::from_u32));
            }
            ('\\', Some(_)) => {
                chars.by_ref().take_while(|c| *c != ';').for_each(drop);
            }
            ('{' | '}', _) => {}
            ('%', Some('%')) => {
                chars.next();
                chars.next();
            }
            (c, _) => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn formatting_codes_are_no_part_of_a_name() {
        assert_eq!(plain("{\\fArial|b0|i0;Bath}\\P4.2 m2"), "Bath\n4.2 m2");
        assert_eq!(plain("K\\U+00FCche"), "Küche");
        assert_eq!(plain("%%uHall"), "Hall");
    }
}
