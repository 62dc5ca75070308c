//! Open-RMF `building.yaml` of the traffic editor: rooms are what the walls, doors and floors of a level enclose.
//!
//! Values are pairs of a type and a value; drawings are in pixels with y downwards, unless the coordinate system says
//! meters; the measurements of a level give its scale, and the fiducials that it shares with the level of reference line it
//! up with that one. The cars of lifts are drawn on every level where they have a door. Names of waypoints inside a room are its name, but not those of
//! chargers, docks, doors, lifts and places where robots start: they name a thing for robots.

use std::collections::{BTreeMap, BTreeSet};

use d3dgen_model::Point;
use serde::Deserialize;
use serde_json::Value;

mod align;
mod lifts;

use self::align::Shift;
use self::lifts::Lift;
use super::source::{Plan, Reader, Source};
use crate::drawing::{Drawing, DrawnFloor, DrawnLabel, DrawnOpening, DrawnWall, OpeningKind, note};
use crate::error::Error;
use crate::options::Options;
use crate::words::is_waypoint;

pub(super) const READER: Reader = Reader { name: "rmf", title: "Open-RMF building.yaml", recognizes, read };

const FORMAT: &str = "rmf";
/// Meters a pixel of a level that has no measurement, as the traffic editor takes it.
const DEFAULT_SCALE: f64 = 0.05;
/// Parameters of a vertex that is a place for robots: any value but false and empty.
const FOR_ROBOTS: [&str; 5] = ["is_charger", "dock_name", "spawn_robot_name", "spawn_robot_type", "lift_cabin"];

fn recognizes(source: &Source) -> bool {
    let head = source.head();
    source.has_ending(&[".building.yaml", ".building.yml"])
        || source.has_ending(&[".yaml", ".yml"]) && (head.contains("\nlevels:") || head.starts_with("levels:"))
}

#[derive(Deserialize)]
struct Building {
    #[serde(default)]
    name: Option<Value>,
    #[serde(default)]
    coordinate_system: Option<String>,
    #[serde(default)]
    reference_level_name: Option<String>,
    #[serde(default)]
    levels: BTreeMap<String, Level>,
    #[serde(default)]
    lifts: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
struct Level {
    #[serde(default)]
    elevation: Option<f64>,
    /// Points that levels have in common: x, y and a name.
    #[serde(default)]
    fiducials: Vec<Vec<Value>>,
    #[serde(default)]
    vertices: Vec<Vec<Value>>,
    #[serde(default)]
    walls: Vec<Vec<Value>>,
    #[serde(default)]
    doors: Vec<Vec<Value>>,
    #[serde(default)]
    measurements: Vec<Vec<Value>>,
    #[serde(default)]
    floors: Vec<Floor>,
    #[serde(default)]
    holes: Vec<Floor>,
    /// Things that stand about: model, name, place.
    #[serde(default)]
    models: Vec<Value>,
}

#[derive(Deserialize)]
struct Floor {
    #[serde(default)]
    vertices: Vec<usize>,
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let building: Building = source.yaml(FORMAT)?;
    let meters = building.coordinate_system.as_deref() == Some("cartesian_meters");
    let titles = building.name.as_ref().and_then(Value::as_str).map(str::to_owned).into_iter().collect();
    let mut drawing = Drawing { titles, ..Drawing::default() };
    let lifts: BTreeMap<String, Lift> = building.lifts.iter().map(lifts::read).collect::<Result<_, _>>()?;
    let names: BTreeSet<String> = lifts.keys().map(|n| n.to_lowercase()).collect();
    let mut frames: BTreeMap<&str, Frame> = BTreeMap::new();
    for (name, level) in &building.levels {
        let frame = add_level(&mut drawing, name, level, meters, &names, options)?;
        frames.insert(name, frame);
        drawing.elevations_m.extend(level.elevation.map(|e| (name.clone(), e)));
    }
    if !meters {
        line_up(&mut drawing, &building, &mut frames);
    }
    for (name, lift) in &lifts {
        lifts::draw(&mut drawing, name, lift, &frames);
    }
    Ok(Plan::Drawing(drawing))
}

/// How the numbers of a level become meters of the building.
#[derive(Clone, Copy)]
struct Frame {
    /// Meters a unit, and whether y runs upwards.
    scale: f64,
    up: bool,
    /// From the meters of the level to those of the level of reference.
    shift: Shift,
}

impl Frame {
    /// Returns where a point of the file is on its own level, m.
    fn own(&self, x: f64, y: f64) -> Point {
        Point::new(x * self.scale, if self.up { y } else { -y } * self.scale)
    }

    /// Returns where it is in the building, m.
    fn at(&self, x: f64, y: f64) -> Point {
        self.shift.of(self.own(x, y))
    }
}

/// Lines levels up with the level of reference, the first one where none is named, by the fiducials that both have.
fn line_up<'a>(drawing: &mut Drawing, building: &'a Building, frames: &mut BTreeMap<&'a str, Frame>) {
    let named = building.reference_level_name.as_deref().filter(|n| building.levels.contains_key(*n));
    let Some(reference) = named.or_else(|| building.levels.keys().next().map(String::as_str)) else { return };
    let points = |name: &str, frames: &BTreeMap<&str, Frame>| -> BTreeMap<String, Point> {
        let point = |f: &Vec<Value>| {
            let (x, y) = (f.first()?.as_f64()?, f.get(1)?.as_f64()?);
            let id = f.get(2).map(|id| id.as_str().map_or_else(|| id.to_string(), str::to_owned))?;
            Some((id, frames.get(name)?.own(x, y)))
        };
        building.levels.get(name).into_iter().flat_map(|l| &l.fiducials).filter_map(point).collect()
    };
    let fixed = points(reference, frames);
    for name in building.levels.keys().filter(|n| *n != reference) {
        let own = points(name, frames);
        let pairs: Vec<(Point, Point)> = own.iter().filter_map(|(id, p)| Some((*p, *fixed.get(id)?))).collect();
        match align::shift(&pairs) {
            Some((shift, off)) => {
                drawing.on_level_mut(name).for_each(|p| *p = shift.of(*p));
                frames.entry(name).and_modify(|f| f.shift = shift);
                let count = pairs.len();
                let message =
                    format!("level {name} was lined up with {reference} by {count} fiducials, to within {off:.2} m");
                drawing.notes.push(note("lined_up", message));
            }
            None => {
                let message = format!(
                    "level {name} has no fiducials that agree with those of {reference}; it stands where its own coordinates are"
                );
                drawing.notes.push(note("not_lined_up", message));
            }
        }
    }
}

/// Returns the value of a typed pair `[3, 0.9]` under a name.
fn parameter<'a>(item: &'a [Value], name: &str) -> Option<&'a Value> {
    item.iter().find_map(Value::as_object)?.get(name)?.as_array()?.get(1)
}

fn add_level(
    drawing: &mut Drawing,
    name: &str,
    level: &Level,
    meters: bool,
    lifts: &BTreeSet<String>,
    options: &Options,
) -> Result<Frame, Error> {
    let broken = |place: String, message: &str| Error::broken(FORMAT, format!("levels/{name}/{place}"), message);
    let mut points = Vec::with_capacity(level.vertices.len());
    for (i, v) in level.vertices.iter().enumerate() {
        match (v.first().and_then(Value::as_f64), v.get(1).and_then(Value::as_f64)) {
            (Some(x), Some(y)) => points.push(Point::new(x, if meters { y } else { -y })),
            _ => return Err(broken(format!("vertices/{i}"), "needs two numbers, [x, y, z, name]")),
        }
    }
    let ends = |list: &str, i: usize, item: &[Value]| -> Result<[Point; 2], Error> {
        let end = |k: usize| {
            let index = item.get(k).and_then(Value::as_u64).and_then(|v| usize::try_from(v).ok());
            index.and_then(|v| points.get(v)).copied()
        };
        match (end(0), end(1)) {
            (Some(a), Some(b)) => Ok([a, b]),
            _ => Err(broken(format!("{list}/{i}"), "begins with the indices of two vertices")),
        }
    };
    let scale = scale(drawing, name, level, meters, options, &ends)?;
    let at = |p: Point| Point::new(p.x * scale, p.y * scale);
    let here = Some(name.to_owned());
    for (i, wall) in level.walls.iter().enumerate() {
        let [a, b] = ends("walls", i, wall)?;
        let place = format!("levels/{name}/walls/{i}");
        drawing.walls.push(DrawnWall { line: [at(a), at(b)], level: here.clone(), place });
    }
    for (i, door) in level.doors.iter().enumerate() {
        let [a, b] = ends("doors", i, door)?;
        let title = parameter(door, "name").and_then(Value::as_str).unwrap_or_default();
        let mut o = DrawnOpening::new(
            OpeningKind::Door,
            vec![at(a), at(b)],
            here.clone(),
            format!("levels/{name}/doors/{i} `{title}`"),
        );
        o.sliding = parameter(door, "type").and_then(Value::as_str).is_some_and(|t| t.contains("sliding"));
        drawing.openings.push(o);
    }
    let title = |door: &Vec<Value>| parameter(door, "name").and_then(Value::as_str).map(str::to_lowercase);
    let things: BTreeSet<String> = level.doors.iter().filter_map(title).chain(lifts.iter().cloned()).collect();
    for (v, p) in level.vertices.iter().zip(&points) {
        let Some(text) = v.get(3).and_then(Value::as_str).map(str::trim).filter(|t| !t.is_empty()) else { continue };
        let set = |key: &str| match parameter(v, key) {
            Some(Value::Bool(on)) => *on,
            Some(Value::String(s)) => !s.is_empty(),
            _ => false,
        };
        if !FOR_ROBOTS.iter().any(|key| set(key)) && !things.contains(&text.to_lowercase()) && !is_waypoint(text) {
            drawing.labels.push(DrawnLabel { text: text.replace('_', " "), at: at(*p), level: here.clone() });
        }
    }
    for (list, hole, floors) in [("floors", false, &level.floors), ("holes", true, &level.holes)] {
        for (i, floor) in floors.iter().enumerate() {
            let corner = |k: &usize| points.get(*k).map(|p| at(*p));
            let corners: Option<Vec<Point>> = floor.vertices.iter().map(corner).collect();
            let corners = corners.ok_or_else(|| broken(format!("{list}/{i}"), "names a vertex that is not there"))?;
            drawing.floors.push(DrawnFloor { corners, hole, level: here.clone() });
        }
    }
    for model in &level.models {
        let name = model.get("model_name").or_else(|| model.get("name")).and_then(Value::as_str).unwrap_or("a model");
        drawing.skip(format!("model `{}`", name.rsplit('/').next().unwrap_or(name)));
    }
    Ok(Frame { scale, up: meters, shift: Shift::default() })
}

/// Returns meters a unit: as asked, 1 for meters, else by the measurements of the level.
fn scale(
    drawing: &mut Drawing,
    name: &str,
    level: &Level,
    meters: bool,
    options: &Options,
    ends: &impl Fn(&str, usize, &[Value]) -> Result<[Point; 2], Error>,
) -> Result<f64, Error> {
    if let Some(scale) = options.meters_per_unit {
        return Ok(scale);
    }
    if meters {
        return Ok(1.0);
    }
    let (mut sum, mut count) = (0.0, 0);
    for (i, m) in level.measurements.iter().enumerate() {
        let [a, b] = ends("measurements", i, m)?;
        let pixels = a.distance(b);
        if let Some(meters) = parameter(m, "distance").and_then(Value::as_f64).filter(|d| *d > 0.0 && pixels > 0.0) {
            sum += meters / pixels;
            count += 1;
        }
    }
    if count == 0 {
        let message = format!(
            "level {name} has no measurement; one pixel was taken for {DEFAULT_SCALE} m, as the traffic editor does"
        );
        drawing.notes.push(note("unit_assumed", message));
        return Ok(DEFAULT_SCALE);
    }
    let scale = sum / f64::from(count);
    drawing.notes.push(note("scale", format!("level {name}: one pixel is {scale:.6} m, by {count} measurements")));
    Ok(scale)
}
