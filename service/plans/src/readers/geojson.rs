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

use super::{Plan, Reader, Source};
use crate::drawing::{Drawing, DrawnLabel, DrawnOpening, DrawnRoom, DrawnWall, OpeningKind, extent, note};
use crate::words::{Role, role};
use crate::{Error, Options};

pub(super) const READER: Reader = Reader { name: "geojson", title: "GeoJSON", recognizes, read };

const FORMAT: &str = "geojson";
/// Properties that say what a feature is, and what a room is called.
const KINDS: [&str; 10] =
    ["feature_type", "room_type", "type", "class", "category", "kind", "indoor", "element", "layer", "usage"];
const NAMES: [&str; 6] = ["name", "label", "title", "alt_name", "ref", "id"];
const LEVELS: [&str; 6] = ["level", "level_id", "floor", "storey", "level:ref", "layer_level"];
/// A building is no wider than this in degrees, so smaller coordinates are longitude and latitude.
const DEGREES: f64 = 0.05;
/// Axes of the earth's ellipsoid (WGS 84): half the longer one in m, and the square of its eccentricity.
const EARTH_M: f64 = 6_378_137.0;
const EARTH_E2: f64 = 0.006_694_379_990_14;

type JsonObject = serde_json::Map<String, Value>;
type Position = Vec<f64>;

#[derive(Deserialize)]
struct Feature {
    #[serde(default)]
    geometry: Option<Shape>,
    #[serde(default)]
    properties: Option<JsonObject>,
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
    let text = source.text(FORMAT)?;
    let mut value: Value = serde_json::from_str(text).map_err(|e| {
        let (message, place) = (e.to_string(), format!("line {} column {}", e.line(), e.column()));
        Error::broken(FORMAT, &place, message.trim_end_matches(&format!(" at {place}")))
    })?;
    let crs = value.pointer("/crs/properties/name").and_then(|v| v.as_str()).map(str::to_owned);
    let value_title = value.get("name").and_then(|v| v.as_str()).map(str::to_owned);
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
            vec![Feature { geometry: Some(geometry), properties: None }]
        }
    };
    let titles = value_title.into_iter().collect();
    let mut drawing = Drawing { titles, ..Drawing::default() };
    for (i, feature) in features.iter().enumerate() {
        if let Some(geometry) = &feature.geometry {
            let place = format!("feature {i}");
            let properties = feature.properties.clone().unwrap_or_default();
            add(&mut drawing, geometry, &properties, &place)?;
        }
    }
    project(&mut drawing, crs.as_deref(), options);
    Ok(Plan::Drawing(drawing))
}

fn text_of(properties: &JsonObject, keys: &[&str]) -> Option<String> {
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

fn add(drawing: &mut Drawing, geometry: &Shape, properties: &JsonObject, place: &str) -> Result<(), Error> {
    let level = text_of(properties, &LEVELS);
    let name = text_of(properties, &NAMES).unwrap_or_default();
    let kinds: Vec<String> = KINDS.iter().filter_map(|k| text_of(properties, &[*k])).collect();
    let place = if name.is_empty() { place.to_owned() } else { format!("{place} `{name}`") };
    let tagged = |key: &str| properties.get(key).is_some_and(|v| v.as_str().is_none_or(|s| s != "no"));
    let said = kinds.iter().find_map(|k| role(k)).or_else(|| {
        let keys = [("door", Role::Door), ("entrance", Role::Door), ("window", Role::Window)];
        keys.iter().find(|(key, _)| tagged(key)).map(|k| k.1)
    });
    let points = |list: &[Position]| -> Result<Vec<Point>, Error> {
        let short = || Error::broken(FORMAT, &place, "has a position without two coordinates");
        list.iter().map(|p| Ok(Point::new(*p.first().ok_or_else(short)?, *p.get(1).ok_or_else(short)?))).collect()
    };
    let opening = |drawing: &mut Drawing, kind: OpeningKind, points: Vec<Point>| {
        let mut o = DrawnOpening::new(kind, points, level.clone(), place.clone());
        o.width_m = number_of(properties, &["width_m", "width"]);
        o.sill_m = number_of(properties, &["sill_m", "sill", "sill_height"]);
        o.head_m = number_of(properties, &["head_m", "head"]);
        o.sliding = kinds.iter().chain(text_of(properties, &["door", "door_type"]).iter()).any(|k| k.contains("slid"));
        drawing.openings.push(o);
    };
    let as_opening = |role: Option<Role>| match role {
        Some(Role::Door) => Some(OpeningKind::Door),
        Some(Role::Passage) => Some(OpeningKind::Passage),
        Some(Role::Window) => Some(OpeningKind::Window),
        _ => None,
    };
    let unread = || match kinds.first() {
        Some(kind) => format!("lines of the kind `{kind}`"),
        None => "lines without a kind".to_owned(),
    };
    let mut shapes: Vec<&Shape> = vec![geometry];
    while let Some(shape) = shapes.pop() {
        match shape {
            Shape::GeometryCollection { geometries } => shapes.extend(geometries.iter().rev()),
            Shape::Polygon { coordinates: rings } => {
                let holes = rings.iter().skip(1).map(|r| points(r)).collect::<Result<Vec<_>, _>>()?;
                polygon(drawing, points(rings.first().map_or(&[], Vec::as_slice))?, said, &opening, as_opening, || {
                    DrawnRoom { holes, ..room(&name, &kinds, properties, level.clone(), &place) }
                });
            }
            Shape::MultiPolygon { coordinates: parts } => {
                for (k, rings) in parts.iter().enumerate() {
                    let ring = points(rings.first().map_or(&[], Vec::as_slice))?;
                    let holes = rings.iter().skip(1).map(|r| points(r)).collect::<Result<Vec<_>, _>>()?;
                    polygon(drawing, ring, said, &opening, as_opening, || {
                        let mut room = DrawnRoom { holes, ..room(&name, &kinds, properties, level.clone(), &place) };
                        if parts.len() > 1 {
                            room.label = format!("{} {}", room.label, k + 1).trim().to_owned();
                        }
                        room
                    });
                }
            }
            Shape::LineString { coordinates: line } => {
                if !line_of(drawing, points(line)?, said, &opening, as_opening, &level, &place) {
                    drawing.leave_out(unread());
                }
            }
            Shape::MultiLineString { coordinates: lines } => {
                for line in lines {
                    if !line_of(drawing, points(line)?, said, &opening, as_opening, &level, &place) {
                        drawing.leave_out(unread());
                    }
                }
            }
            Shape::Point { coordinates: p } => {
                point(drawing, points(std::slice::from_ref(p))?, said, &opening, as_opening, &name, &level)
            }
            Shape::MultiPoint { coordinates: list } => {
                for p in points(list)? {
                    point(drawing, vec![p], said, &opening, as_opening, &name, &level);
                }
            }
        }
    }
    Ok(())
}

fn room(name: &str, kinds: &[String], properties: &JsonObject, level: Option<String>, place: &str) -> DrawnRoom {
    let generic = |k: &&String| role(k).is_none();
    let kind = text_of(properties, &["room", "room_type"]).or_else(|| kinds.iter().find(generic).cloned());
    let place = if name.is_empty() { place.to_owned() } else { format!("room `{name}`") };
    DrawnRoom {
        kind: kind.filter(|k| k != "yes"),
        level,
        height_m: number_of(properties, &["ceiling_height_m", "ceiling_height", "height_m", "height"]),
        ..DrawnRoom::new(name.to_owned(), Vec::new(), place)
    }
}

fn polygon(
    drawing: &mut Drawing,
    ring: Vec<Point>,
    said: Option<Role>,
    opening: &impl Fn(&mut Drawing, OpeningKind, Vec<Point>),
    as_opening: impl Fn(Option<Role>) -> Option<OpeningKind>,
    room: impl FnOnce() -> DrawnRoom,
) {
    match said {
        Some(Role::Skip | Role::Outline | Role::Tag | Role::Wall) => {}
        _ => match as_opening(said) {
            Some(kind) => opening(drawing, kind, ring),
            None => drawing.rooms.push(DrawnRoom { corners: ring, ..room() }),
        },
    }
}

/// Adds a line; returns false when nothing says what it is.
fn line_of(
    drawing: &mut Drawing,
    line: Vec<Point>,
    said: Option<Role>,
    opening: &impl Fn(&mut Drawing, OpeningKind, Vec<Point>),
    as_opening: impl Fn(Option<Role>) -> Option<OpeningKind>,
    level: &Option<String>,
    place: &str,
) -> bool {
    if let Some(kind) = as_opening(said) {
        opening(drawing, kind, line);
    } else if said == Some(Role::Wall) {
        drawing.walls.extend(line.windows(2).map(|p| DrawnWall {
            line: [p[0], p[1]],
            level: level.clone(),
            place: format!("wall of {place}"),
        }));
    }
    !matches!(said, None | Some(Role::Room))
}

fn point(
    drawing: &mut Drawing,
    at: Vec<Point>,
    said: Option<Role>,
    opening: &impl Fn(&mut Drawing, OpeningKind, Vec<Point>),
    as_opening: impl Fn(Option<Role>) -> Option<OpeningKind>,
    name: &str,
    level: &Option<String>,
) {
    if let Some(kind) = as_opening(said) {
        opening(drawing, kind, at);
    } else if !name.is_empty() && said != Some(Role::Skip) {
        drawing.labels.extend(at.iter().map(|p| DrawnLabel { text: name.to_owned(), at: *p, level: level.clone() }));
    }
}

/// Turns longitude and latitude into meters east and north of the plan's middle, and other units into meters.
fn project(drawing: &mut Drawing, crs: Option<&str>, options: &Options) {
    let Some([x0, y0, x1, y1]) = extent(drawing.points_mut().map(|p| *p)) else { return };
    let globe = crs.map(|c| c.contains("CRS84") || c.ends_with("4326"));
    let fits = x0 >= -180.0 && x1 <= 180.0 && y0 >= -90.0 && y1 <= 90.0;
    let small = x1 - x0 < DEGREES && y1 - y0 < DEGREES;
    if options.meters_per_unit.is_none() && fits && globe.unwrap_or(small) {
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
