//! GeoJSON: polygons are rooms, lines and points doors, windows and walls, by what their properties say.
//!
//! Read by hand: the format is seven shapes, and the `geojson` crate changes features of crates that everything else is
//! built on.
//!
//! Properties are those of indoor maps in use: `name`, `type`/`room_type`/`class`/`category`/`kind`/`feature_type`,
//! OpenStreetMap's `indoor`, `room`, `door`; `level`; `height`, `width` in meters.

use d3dgen_model::Point;
use serde::Deserialize;
use serde_json::Value;

use super::imdf;
use super::source::{Plan, Reader, Source};
use crate::drawing::{
    Drawing, DrawnLabel, DrawnOpening, DrawnRoom, DrawnSolid, DrawnWall, OpeningKind, SolidKind, extent, note,
};
use crate::error::Error;
use crate::options::Options;
use crate::shape::extents;
use crate::words::{Role, role, said_of};

pub(super) const READER: Reader = Reader { name: "geojson", title: "GeoJSON", recognizes, read };

const FORMAT: &str = "geojson";
/// Properties that say what a feature is, and what a room is called.
const KINDS: [&str; 10] =
    ["feature_type", "room_type", "type", "class", "category", "kind", "indoor", "element", "layer", "usage"];
const NAMES: [&str; 6] = ["name", "label", "title", "alt_name", "ref", "id"];
const LEVELS: [&str; 6] = ["level", "level_id", "floor", "storey", "level:ref", "layer_level"];
/// A solid so many times as long as wide is a wall, not a column.
const STRIP_LONG: f64 = 2.5;
/// A building is no wider than this in degrees, so smaller coordinates are longitude and latitude.
const DEGREES: f64 = 0.05;
/// Axes of the earth's ellipsoid (WGS 84): half the longer one in m, and the square of its eccentricity.
const EARTH_M: f64 = 6_378_137.0;
const EARTH_E2: f64 = 0.006_694_379_990_14;

type JsonObject = serde_json::Map<String, Value>;
type Position = Vec<f64>;

#[derive(Deserialize)]
pub(super) struct Feature {
    #[serde(default)]
    id: Option<Value>,
    /// What it is, where the file says so beside the properties, as IMDF does.
    #[serde(default)]
    pub feature_type: Option<String>,
    #[serde(default)]
    geometry: Option<Shape>,
    #[serde(default)]
    pub properties: Option<JsonObject>,
}

impl Feature {
    /// Returns the id as text.
    pub fn id(&self) -> Option<String> {
        self.id.as_ref().and_then(Value::as_str).map(str::to_owned)
    }
}

/// What a file holds.
pub(super) struct Collection {
    pub features: Vec<Feature>,
    title: Option<String>,
    crs: Option<String>,
}

#[derive(Deserialize)]
#[serde(tag = "type")]
enum Shape {
    Point { coordinates: Position },
    MultiPoint { coordinates: Vec<Position> },
    LineString { coordinates: Vec<Position> },
    MultiLineString { coordinates: Vec<Vec<Position>> },
    Polygon { coordinates: Vec<Vec<Position>> },
    MultiPolygon { coordinates: Vec<Vec<Vec<Position>>> },
    GeometryCollection { geometries: Vec<Shape> },
}

fn recognizes(source: &Source) -> bool {
    let head = source.head();
    let says = ["\"FeatureCollection\"", "\"Feature\"", "\"GeometryCollection\""].iter().any(|t| head.contains(t));
    source.has_ending(&[".geojson"]) || source.has_ending(&[".json"]) && says
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let Collection { mut features, title, crs } = collection(source.text(FORMAT)?)?;
    let mut drawing = Drawing { titles: title.into_iter().collect(), ..Drawing::default() };
    if features.iter().any(|f| f.feature_type.is_some()) {
        imdf::prepare(&mut features, &mut drawing);
    }
    draw(&mut drawing, &features, options)?;
    project(&mut drawing, crs.as_deref(), options);
    Ok(Plan::Drawing(drawing))
}

/// Reads the features of a text.
pub(super) fn collection(text: &str) -> Result<Collection, Error> {
    let mut value: Value = serde_json::from_str(text).map_err(|e| {
        let (message, place) = (e.to_string(), format!("line {} column {}", e.line(), e.column()));
        Error::broken(FORMAT, &place, message.trim_end_matches(&format!(" at {place}")))
    })?;
    let crs = value.pointer("/crs/properties/name").and_then(|v| v.as_str()).map(str::to_owned);
    let title = value.get("name").and_then(|v| v.as_str()).map(str::to_owned);
    let wrong = |place: &str, e: serde_json::Error| Error::broken(FORMAT, place, e.to_string());
    let features: Vec<Feature> = match value.get("type").and_then(Value::as_str) {
        Some("FeatureCollection") => {
            let list = value.get_mut("features").map(Value::take);
            let Some(Value::Array(list)) = list else {
                return Err(Error::broken(FORMAT, "FeatureCollection", "needs a list of features"));
            };
            let feature = |(i, f): (usize, Value)| {
                let name = f.pointer("/properties/name").and_then(Value::as_str).map(|n| format!(" `{n}`"));
                let place = format!("feature {i}{}", name.unwrap_or_default());
                serde_json::from_value(f).map_err(|e| wrong(&place, e))
            };
            list.into_iter().enumerate().map(feature).collect::<Result<_, _>>()?
        }
        Some("Feature") => vec![serde_json::from_value(value).map_err(|e| wrong("feature", e))?],
        _ => {
            let geometry = serde_json::from_value(value).map_err(|e| wrong("geometry", e))?;
            vec![Feature { id: None, feature_type: None, geometry: Some(geometry), properties: None }]
        }
    };
    Ok(Collection { features, title, crs })
}

/// Draws features in the units of the file.
pub(super) fn draw(drawing: &mut Drawing, features: &[Feature], options: &Options) -> Result<(), Error> {
    for (i, feature) in features.iter().enumerate() {
        if let Some(geometry) = &feature.geometry {
            let properties = feature.properties.clone().unwrap_or_default();
            add(drawing, geometry, &properties, &format!("feature {i}"), options)?;
        }
    }
    Ok(())
}

pub(super) fn text_of(properties: &JsonObject, keys: &[&str]) -> Option<String> {
    keys.iter().find_map(|k| match properties.get(*k)? {
        Value::String(s) if !s.trim().is_empty() => Some(s.trim().to_owned()),
        Value::Number(n) => Some(n.to_string()),
        // names by language, as IMDF has them
        Value::Object(o) => o.get("en").or_else(|| o.values().next()).and_then(|v| v.as_str()).map(str::to_owned),
        _ => None,
    })
}

fn number_of(properties: &JsonObject, keys: &[&str]) -> Option<f64> {
    keys.iter().find_map(|k| match properties.get(*k)? {
        Value::Number(n) => n.as_f64(),
        Value::String(s) => s.trim().trim_end_matches(['m', ' ']).parse().ok(),
        _ => None,
    })
}

/// What the properties of a feature say of all that it draws.
struct Said<'a> {
    properties: &'a JsonObject,
    role: Option<Role>,
    name: String,
    kinds: Vec<String>,
    level: Option<String>,
    place: String,
}

fn add(
    drawing: &mut Drawing,
    geometry: &Shape,
    properties: &JsonObject,
    place: &str,
    options: &Options,
) -> Result<(), Error> {
    let said = Said::of(properties, place, options);
    let mut shapes: Vec<&Shape> = vec![geometry];
    while let Some(shape) = shapes.pop() {
        match shape {
            Shape::GeometryCollection { geometries } => shapes.extend(geometries.iter().rev()),
            Shape::Polygon { coordinates: rings } => said.polygon(drawing, rings, None)?,
            Shape::MultiPolygon { coordinates: parts } => parts
                .iter()
                .enumerate()
                .try_for_each(|(k, rings)| said.polygon(drawing, rings, (parts.len() > 1).then_some(k + 1)))?,
            Shape::LineString { coordinates: line } => said.line(drawing, line)?,
            Shape::MultiLineString { coordinates: lines } => lines.iter().try_for_each(|l| said.line(drawing, l))?,
            Shape::Point { coordinates: p } => said.points(drawing, std::slice::from_ref(p))?,
            Shape::MultiPoint { coordinates: list } => said.points(drawing, list)?,
        }
    }
    Ok(())
}

impl<'a> Said<'a> {
    fn of(properties: &'a JsonObject, place: &str, options: &Options) -> Self {
        let name = text_of(properties, &NAMES).unwrap_or_default();
        let kinds: Vec<String> = KINDS.iter().filter_map(|k| text_of(properties, &[*k])).collect();
        let tagged = |key: &str| properties.get(key).is_some_and(|v| v.as_str().is_none_or(|s| s != "no"));
        let by_kind = kinds.iter().find_map(|k| said_of(k, options)).or_else(|| kinds.iter().find_map(|k| role(k)));
        let role = by_kind.or_else(|| {
            let keys = [("door", Role::Door), ("entrance", Role::Door), ("window", Role::Window)];
            keys.iter().find(|(key, _)| tagged(key)).map(|k| k.1)
        });
        let place = if name.is_empty() { place.to_owned() } else { format!("{place} `{name}`") };
        Said { properties, role, name, kinds, level: text_of(properties, &LEVELS), place }
    }

    fn corners(&self, list: &[Position]) -> Result<Vec<Point>, Error> {
        let short = || Error::broken(FORMAT, &self.place, "has a position without two coordinates");
        list.iter().map(|p| Ok(Point::new(*p.first().ok_or_else(short)?, *p.get(1).ok_or_else(short)?))).collect()
    }

    /// Returns the kind of opening, if the feature is one.
    fn opening(&self) -> Option<OpeningKind> {
        match self.role {
            Some(Role::Door) => Some(OpeningKind::Door),
            Some(Role::Passage) => Some(OpeningKind::Passage),
            Some(Role::Window) => Some(OpeningKind::Window),
            _ => None,
        }
    }

    fn add_opening(&self, drawing: &mut Drawing, kind: OpeningKind, points: Vec<Point>) {
        let mut o = DrawnOpening::new(kind, points, self.level.clone(), self.place.clone());
        o.width_m = number_of(self.properties, &["width_m", "width"]);
        o.sill_m = number_of(self.properties, &["sill_m", "sill", "sill_height"]);
        o.head_m = number_of(self.properties, &["head_m", "head"]);
        let door = text_of(self.properties, &["door", "door_type"]);
        o.sliding = self.kinds.iter().chain(door.iter()).any(|k| k.contains("slid"));
        drawing.openings.push(o);
    }

    /// Returns what is said of the feature where it is left out.
    fn told(&self, shape: &str) -> String {
        match self.kinds.first() {
            Some(kind) => format!("{shape} of the kind `{kind}`"),
            None => format!("{shape} without a kind"),
        }
    }

    /// Adds a polygon; `part` counts those of one feature.
    fn polygon(&self, drawing: &mut Drawing, rings: &[Vec<Position>], part: Option<usize>) -> Result<(), Error> {
        let ring = self.corners(rings.first().map_or(&[], Vec::as_slice))?;
        match (self.role, self.opening()) {
            (_, Some(kind)) => self.add_opening(drawing, kind, ring),
            (Some(Role::Skip), _) => drawing.skip(self.told("polygons")),
            (Some(Role::Outline | Role::Tag), _) => {}
            (Some(Role::Column | Role::Wall), _) => {
                let (long, short) = extents(&ring);
                let is_wall = self.role == Some(Role::Wall) || long > STRIP_LONG * short;
                let kind = if is_wall { SolidKind::Wall } else { SolidKind::Column };
                let (level, place) = (self.level.clone(), self.place.clone());
                drawing.solids.push(DrawnSolid { kind, outline: ring, level, place });
            }
            _ => {
                let holes = rings.iter().skip(1).map(|r| self.corners(r)).collect::<Result<Vec<_>, _>>()?;
                let mut room = DrawnRoom { corners: ring, holes, ..self.room() };
                if let Some(part) = part {
                    room.label = format!("{} {part}", room.label).trim().to_owned();
                }
                drawing.rooms.push(room);
            }
        }
        Ok(())
    }

    fn room(&self) -> DrawnRoom {
        let generic = |k: &&String| role(k).is_none();
        let kind =
            text_of(self.properties, &["room", "room_type"]).or_else(|| self.kinds.iter().find(generic).cloned());
        let place = if self.name.is_empty() { self.place.clone() } else { format!("room `{}`", self.name) };
        DrawnRoom {
            kind: kind.filter(|k| k != "yes"),
            level: self.level.clone(),
            height_m: number_of(self.properties, &["ceiling_height_m", "ceiling_height", "height_m", "height"]),
            ..DrawnRoom::new(self.name.clone(), Vec::new(), place)
        }
    }

    fn line(&self, drawing: &mut Drawing, line: &[Position]) -> Result<(), Error> {
        let points = self.corners(line)?;
        match (self.role, self.opening()) {
            (_, Some(kind)) => self.add_opening(drawing, kind, points),
            (Some(Role::Wall), _) => drawing.walls.extend(points.windows(2).map(|p| DrawnWall {
                line: [p[0], p[1]],
                level: self.level.clone(),
                place: format!("wall of {}", self.place),
            })),
            (Some(Role::Skip), _) => drawing.skip(self.told("lines")),
            (None | Some(Role::Room | Role::Column), _) => drawing.leave_out(self.told("lines")),
            _ => {}
        }
        Ok(())
    }

    fn points(&self, drawing: &mut Drawing, list: &[Position]) -> Result<(), Error> {
        let points = self.corners(list)?;
        if let Some(kind) = self.opening() {
            points.into_iter().for_each(|p| self.add_opening(drawing, kind, vec![p]));
        } else if !self.name.is_empty() && self.role != Some(Role::Skip) {
            let label = |at| DrawnLabel { text: self.name.clone(), at, level: self.level.clone() };
            drawing.labels.extend(points.into_iter().map(label));
        }
        Ok(())
    }
}

/// Turns longitude and latitude into meters east and north of the plan's middle, and other units into meters.
pub(super) fn project(drawing: &mut Drawing, crs: Option<&str>, options: &Options) {
    let Some(around) = extent(drawing.points_mut().map(|p| *p)) else { return };
    if options.meters_per_unit.is_none() && is_on_globe(around, crs) {
        let [x0, y0, x1, y1] = around;
        let (lon, lat) = ((x0 + x1) / 2.0, (y0 + y1) / 2.0);
        let (sin, cos) = lat.to_radians().sin_cos();
        let w = 1.0 - EARTH_E2 * sin * sin;
        let (north, east) = (EARTH_M * (1.0 - EARTH_E2) / w.powf(1.5), EARTH_M / w.sqrt() * cos);
        for p in drawing.points_mut() {
            *p = Point::new((p.x - lon).to_radians() * east, (p.y - lat).to_radians() * north);
        }
        let message = format!(
            "coordinates are longitude and latitude; they became meters east and north of ({lon:.7}, {lat:.7})"
        );
        drawing.notes.push(note("projected", message));
        return;
    }
    let scale = options.meters_per_unit.unwrap_or(1.0);
    drawing.points_mut().for_each(|p| *p = Point::new(p.x * scale, p.y * scale));
    if options.meters_per_unit.is_none() {
        drawing.notes.push(note("unit_assumed", "coordinates were taken for meters"));
    }
}

/// Returns true for coordinates that are longitude and latitude: the file says so, or they are no wider than a building.
fn is_on_globe([x0, y0, x1, y1]: [f64; 4], crs: Option<&str>) -> bool {
    let globe = crs.map(|c| c.contains("CRS84") || c.ends_with("4326"));
    let fits = x0 >= -180.0 && x1 <= 180.0 && y0 >= -90.0 && y1 <= 90.0;
    let small = x1 - x0 < DEGREES && y1 - y0 < DEGREES;
    fits && globe.unwrap_or(small)
}
