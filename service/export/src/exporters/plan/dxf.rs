//! The plan as DXF, in meters at full size: rooms, walls, doors, windows, furniture, what robots use, and dimensions, each on
//! a layer that says so.
//!
//! Written by hand in the form of release 12, which every program reads: the `dxf` crate puts the time and random numbers
//! into what it writes. What one puts in a CAD program comes back by `d3dgen furnish plan.dxf`.

use std::collections::BTreeMap;
use std::fmt::Write;

use d3dgen_model::domain::Domain;
use d3dgen_model::floorplan::{Door, DoorKind, Floorplan};
use d3dgen_model::geometry::{Point, Polygon, Pose, Rect};
use d3dgen_model::placements::Placement;
use d3dgen_model::world::World;

use super::building::{Opening, opening_of, outer_bounds, wall_body};
use super::dimensions::Dimensions;
use super::storeys::Storey;
use super::ways;
use crate::models::snake;

/// A layer with its color by number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Layer {
    Rooms,
    Names,
    Walls,
    Doors,
    Openings,
    Windows,
    Furniture,
    Robots,
    Dimensions,
}

const LAYERS: [(Layer, &str, u8); 9] = [
    (Layer::Rooms, "ROOMS", 8),
    (Layer::Names, "NAMES", 7),
    (Layer::Walls, "WALLS", 7),
    (Layer::Doors, "DOORS", 3),
    (Layer::Openings, "OPENINGS", 3),
    (Layer::Windows, "WINDOWS", 4),
    (Layer::Furniture, "FURNITURE", 9),
    (Layer::Robots, "ROBOT_SYMBOLS", 5),
    (Layer::Dimensions, "DIMENSIONS", 2),
];

/// Height of the type of names, dimensions and titles of storeys, m.
const NAME_M: f64 = 0.2;
const DIMENSION_M: f64 = 0.14;
const TITLE_M: f64 = 0.35;
/// Drawing units of a meter and type of the dimension chains, as the picture has them at 1:50.
const SHEET: (f64, f64) = (60.0, 16.0);

/// Returns the drawing; `world` has its storeys beside each other, as the picture has them.
pub(super) fn dxf(world: &World, domain: &Domain, storeys: &[Storey]) -> String {
    let plan = &world.floorplan;
    let mut file = File::default();
    let around = outer_bounds(plan);
    file.blocks(world);
    file.section("ENTITIES");
    for room in &plan.rooms {
        file.outline(Layer::Rooms, &room.net_polygon);
    }
    for named in ways::named(plan) {
        let Some(largest) = named.rooms.iter().max_by(|a, b| a.net_area_m2.total_cmp(&b.net_area_m2)) else { continue };
        let at = inside(&largest.net_polygon);
        file.text(Layer::Names, at, NAME_M, &named.name, 0.0);
        let below = Point::new(at.x, at.y - 1.6 * NAME_M);
        if largest.net_polygon.contains(below) {
            file.text(Layer::Names, below, 0.8 * NAME_M, &format!("{:.1} m2", named.area_m2()), 0.0);
        }
    }
    for wall in &plan.walls {
        file.outline(Layer::Walls, &wall_body(wall, plan));
    }
    for door in plan.doors.iter().filter(|d| !ways::is_between_pieces(plan, d)) {
        file.door(door, plan);
    }
    for window in &plan.windows {
        let o = Opening::new(window.line, window.wall_thickness_m, |_| true);
        let corners = [(0.0, -o.half), (o.length, -o.half), (o.length, o.half), (0.0, o.half)];
        file.outline(Layer::Windows, &Polygon(corners.map(|(along, across)| o.at(along, across)).to_vec()));
    }
    for placement in &world.placements.placements {
        file.insert(Layer::Furniture, &block_of(placement), &placement.pose);
    }
    file.robots(world);
    for storey in storeys {
        let above = Point::new(storey.around.x0, storey.around.y1 + 2.0 * TITLE_M);
        file.text(Layer::Dimensions, above, TITLE_M, &storey.title, 0.0);
    }
    let floors: Vec<&Floorplan> =
        if storeys.is_empty() { vec![plan] } else { storeys.iter().map(|s| &s.plan).collect() };
    for floor in floors {
        for chain in Dimensions::of(floor, SHEET.0, SHEET.1).measured() {
            chain.windows(2).for_each(|pair| file.dimension(pair[0], pair[1]));
        }
    }
    file.end_section();
    file.finish(&around, &super::panel::title(world, domain))
}

/// Returns the name of the block of an object: what it is, and its size in millimeters.
fn block_of(placement: &Placement) -> String {
    let [w, d, _] = placement.size_m.map(|m| (m * 1000.0).round() as i64);
    format!("{}_{w}x{d}", snake(&placement.object)).to_uppercase()
}

/// Returns a point well inside of a polygon: the middle of the widest stretch of it among lines across it.
fn inside(polygon: &Polygon) -> Point {
    let b = polygon.bounds();
    let stretches = (1..8).flat_map(|k| {
        let y = b.y0 + b.height() * f64::from(k) / 8.0 + 1e-6;
        let mut xs: Vec<f64> = polygon
            .edges()
            .filter(|e| (e.start.y > y) != (e.end.y > y))
            .map(|e| e.start.x + (y - e.start.y) / (e.end.y - e.start.y) * (e.end.x - e.start.x))
            .collect();
        xs.sort_by(f64::total_cmp);
        // of stretches alike the one nearest to the middle
        let aside = (y - b.center().y).abs() / b.height().max(1e-9);
        xs.chunks_exact(2).map(|x| (x[1] - x[0] - 0.01 * aside, Point::new((x[0] + x[1]) / 2.0, y))).collect::<Vec<_>>()
    });
    stretches.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(b.center(), |s| s.1)
}

/// A file under construction: pairs of a code and a value, one a line.
#[derive(Default)]
struct File {
    out: String,
    dimensions: Vec<[[Point; 2]; 2]>,
}

impl File {
    fn put(&mut self, code: i32, value: impl std::fmt::Display) {
        let _ = write!(self.out, "{code}\n{value}\n");
    }

    /// Writes a length, to a tenth of a millimeter.
    fn length(&mut self, code: i32, value: f64) {
        let tenths = (value * 1e4).round() as i64;
        let sign = if tenths < 0 { "-" } else { "" };
        let (whole, rest) = (tenths.unsigned_abs() / 10_000, tenths.unsigned_abs() % 10_000);
        self.put(code, format_args!("{sign}{whole}.{rest:04}"));
    }

    fn point(&mut self, code: i32, p: Point) {
        self.length(code, p.x);
        self.length(code + 10, p.y);
        self.length(code + 20, 0.0);
    }

    fn section(&mut self, name: &str) {
        self.put(0, "SECTION");
        self.put(2, name);
    }

    fn end_section(&mut self) {
        self.put(0, "ENDSEC");
    }

    fn entity(&mut self, kind: &str, layer: Layer) {
        self.put(0, kind);
        self.put(8, name_of(layer));
    }

    fn outline(&mut self, layer: Layer, polygon: &Polygon) {
        self.entity("POLYLINE", layer);
        self.put(66, 1);
        self.point(10, Point::new(0.0, 0.0));
        self.put(70, 1);
        for corner in polygon.corners() {
            self.entity("VERTEX", layer);
            self.point(10, *corner);
        }
        self.entity("SEQEND", layer);
    }

    fn line(&mut self, layer: Layer, a: Point, b: Point) {
        self.entity("LINE", layer);
        self.point(10, a);
        self.point(11, b);
    }

    /// Writes a line of text around its middle; what release 12 has no letters for is written by its number.
    fn text(&mut self, layer: Layer, at: Point, height_m: f64, text: &str, degrees: f64) {
        self.entity("TEXT", layer);
        self.point(10, at);
        self.length(40, height_m);
        self.put(1, encoded(text));
        self.length(50, degrees);
        self.put(7, "PLAN");
        self.put(72, 1);
        self.put(73, 2);
        self.point(11, at);
    }

    fn insert(&mut self, layer: Layer, block: &str, pose: &Pose) {
        self.entity("INSERT", layer);
        self.put(2, block);
        self.point(10, Point::new(pose.x, pose.y));
        self.length(50, pose.yaw_rad.to_degrees());
    }

    /// A leaf open at a right angle and the quarter circle it sweeps; what slides or has no leaf is a line in the wall.
    fn door(&mut self, door: &Door, plan: &Floorplan) {
        let o = opening_of(door, plan);
        let mut leaf = |hinge: f64, sign: f64, length: f64| {
            let (center, shut, open) = (o.at(hinge, 0.0), o.at(hinge + sign * length, 0.0), o.at(hinge, length));
            let angle = |p: Point| (p.y - center.y).atan2(p.x - center.x).to_degrees().rem_euclid(360.0);
            // arcs run counter-clockwise
            let (from, to) = (angle(shut), angle(open));
            let (from, to) = if (to - from).rem_euclid(360.0) < 180.0 { (from, to) } else { (to, from) };
            self.line(Layer::Doors, center, open);
            self.entity("ARC", Layer::Doors);
            self.point(10, center);
            self.length(40, length);
            self.length(50, from);
            self.length(51, to);
        };
        let at_start = door.swing.as_ref().is_none_or(|s| s.hinge_at_start);
        match door.kind {
            DoorKind::Hinged if at_start => leaf(0.0, 1.0, o.length),
            DoorKind::Hinged => leaf(o.length, -1.0, o.length),
            DoorKind::DoubleHinged => {
                leaf(0.0, 1.0, o.length / 2.0);
                leaf(o.length, -1.0, o.length / 2.0);
            }
            DoorKind::Sliding => self.line(Layer::Doors, door.line.start, door.line.end),
            DoorKind::Open => self.line(Layer::Openings, door.line.start, door.line.end),
        }
    }

    /// Zones, places and starts of robots.
    fn robots(&mut self, world: &World) {
        if !world.scenario.robots.is_empty() {
            world.scenario.rois.iter().for_each(|roi| self.outline(Layer::Robots, &roi.polygon));
        }
        for poi in &world.scenario.pois {
            self.insert(Layer::Robots, "PLACE", &poi.pose);
            let above = Point::new(poi.pose.x, poi.pose.y + NAME_M);
            self.text(Layer::Robots, above, 0.5 * NAME_M, &poi.poi_id, 0.0);
        }
        for robot in &world.scenario.robots {
            self.entity("CIRCLE", Layer::Robots);
            self.point(10, Point::new(robot.start.x, robot.start.y));
            self.length(40, robot.robot.radius_m);
            self.insert(Layer::Robots, "PLACE", &robot.start);
        }
    }

    /// Writes an aligned dimension between two points on its line, each with the point that it measures.
    fn dimension(&mut self, a: [Point; 2], b: [Point; 2]) {
        self.dimensions.push([a, b]);
        let middle = Point::new((a[0].x + b[0].x) / 2.0, (a[0].y + b[0].y) / 2.0);
        self.entity("DIMENSION", Layer::Dimensions);
        self.put(2, format_args!("*D{}", self.dimensions.len()));
        self.point(10, b[0]);
        self.point(11, middle);
        self.put(70, 1);
        self.point(13, a[1]);
        self.point(14, b[1]);
    }

    /// Blocks of objects, and the arrow that stands for a place.
    fn blocks(&mut self, world: &World) {
        let sizes: BTreeMap<String, [f64; 3]> =
            world.placements.placements.iter().map(|p| (block_of(p), p.size_m)).collect();
        for (name, [width, depth, _]) in sizes {
            self.begin_block(&name);
            let r = Rect { x0: -depth / 2.0, y0: -width / 2.0, x1: depth / 2.0, y1: width / 2.0 };
            self.outline(Layer::Furniture, &Polygon(r.corners().to_vec()));
            // its front
            let inset = r.x1 - 0.15 * depth.min(width);
            self.line(Layer::Furniture, Point::new(inset, r.y0), Point::new(inset, r.y1));
            self.end_block();
        }
        self.begin_block("PLACE");
        let arrow = [(0.15, 0.0), (-0.1, 0.1), (-0.05, 0.0), (-0.1, -0.1)].map(|(x, y)| Point::new(x, y));
        self.outline(Layer::Robots, &Polygon(arrow.to_vec()));
        self.end_block();
    }

    fn begin_block(&mut self, name: &str) {
        self.put(0, "BLOCK");
        self.put(8, "0");
        self.put(2, name);
        self.put(70, i32::from(name.starts_with('*')));
        self.point(10, Point::new(0.0, 0.0));
        self.put(3, name);
    }

    fn end_block(&mut self) {
        self.put(0, "ENDBLK");
        self.put(8, "0");
    }

    /// Returns the whole file: what was written stands behind header, tables and the blocks of the dimensions.
    fn finish(mut self, around: &Rect, title: &str) -> String {
        let drawn = std::mem::take(&mut self.out);
        let (blocks, entities) = drawn.split_once("0\nSECTION\n2\nENTITIES\n").unwrap_or(("", &drawn));
        self.put(999, encoded(title));
        self.section("HEADER");
        self.put(9, "$ACADVER");
        self.put(1, "AC1009");
        // meters
        self.put(9, "$INSUNITS");
        self.put(70, 6);
        self.put(9, "$EXTMIN");
        self.point(10, Point::new(around.x0, around.y0));
        self.put(9, "$EXTMAX");
        self.point(10, Point::new(around.x1, around.y1));
        self.end_section();
        self.tables();
        self.section("BLOCKS");
        self.out.push_str(blocks);
        for (k, dimension) in std::mem::take(&mut self.dimensions).into_iter().enumerate() {
            self.begin_block(&format!("*D{}", k + 1));
            self.drawn_dimension(dimension);
            self.end_block();
        }
        self.end_section();
        self.section("ENTITIES");
        self.out.push_str(entities);
        self.put(0, "EOF");
        self.out
    }

    fn tables(&mut self) {
        self.section("TABLES");
        self.table("LTYPE", 1);
        self.put(0, "LTYPE");
        self.put(2, "CONTINUOUS");
        self.put(70, 0);
        self.put(3, "Solid line");
        self.put(72, 65);
        self.put(73, 0);
        self.length(40, 0.0);
        self.put(0, "ENDTAB");
        self.table("LAYER", LAYERS.len());
        for (_, name, color) in LAYERS {
            self.put(0, "LAYER");
            self.put(2, name);
            self.put(70, 0);
            self.put(62, color);
            self.put(6, "CONTINUOUS");
        }
        self.put(0, "ENDTAB");
        self.table("STYLE", 1);
        self.put(0, "STYLE");
        self.put(2, "PLAN");
        self.put(70, 0);
        self.length(40, 0.0);
        self.length(41, 1.0);
        self.length(50, 0.0);
        self.put(71, 0);
        self.length(42, NAME_M);
        self.put(3, "arial.ttf");
        self.put(4, "");
        self.put(0, "ENDTAB");
        self.end_section();
    }

    fn table(&mut self, name: &str, entries: usize) {
        self.put(0, "TABLE");
        self.put(2, name);
        self.put(70, entries);
    }

    /// Draws a dimension for programs that make none of their own: its line, the lines that lead to it, its figure.
    fn drawn_dimension(&mut self, [[a, from], [b, to]]: [[Point; 2]; 2]) {
        self.line(Layer::Dimensions, a, b);
        self.line(Layer::Dimensions, from, a);
        self.line(Layer::Dimensions, to, b);
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let length = dx.hypot(dy).max(1e-9);
        let lift = 0.8 * DIMENSION_M / length;
        let at = Point::new((a.x + b.x) / 2.0 - dy * lift, (a.y + b.y) / 2.0 + dx * lift);
        self.text(Layer::Dimensions, at, DIMENSION_M, &format!("{length:.2}"), dy.atan2(dx).to_degrees());
    }
}

fn name_of(layer: Layer) -> &'static str {
    LAYERS.iter().find(|(of, ..)| *of == layer).map_or("0", |(_, name, _)| name)
}

/// Returns a text in ASCII, other letters by their number (`\U+00FC`), as release 12 has it.
fn encoded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars().filter(|c| !c.is_control()) {
        if c.is_ascii() {
            out.push(c);
        } else {
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                let _ = write!(out, "\\U+{unit:04X}");
            }
        }
    }
    out
}

#[cfg(test)]
mod tests;
