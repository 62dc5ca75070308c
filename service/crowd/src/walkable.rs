//! The floor as GeoJSON.

use d3dgen_model::Polygon;
use d3dgen_model::geometry::to_mm;
use serde_json::{Value, json};

use crate::space::Space;

/// Returns the rooms and doorways of all storeys, and what stands there.
pub fn geojson(spaces: &[Space]) -> Value {
    let features = spaces.iter().flat_map(|space| {
        let level = space.level;
        let rooms = space.rooms.iter().zip(&space.outlines).map(move |(id, o)| feature("walkable", level, id, o));
        let doors = space.doors.iter().map(move |d| feature("walkable", level, "doorway", &d.outline));
        let things = space.things.iter().map(move |o| feature("obstacle", level, "", o));
        rooms.chain(doors).chain(things)
    });
    json!({"type": "FeatureCollection", "features": features.collect::<Vec<_>>()})
}

fn feature(kind: &str, level: i32, name: &str, outline: &Polygon) -> Value {
    let corners = outline.corners();
    let ring: Vec<[f64; 2]> = corners.iter().chain(corners.first()).map(|p| [to_mm(p.x), to_mm(p.y)]).collect();
    let mut properties = json!({"kind": kind, "level": level.to_string()});
    if !name.is_empty() {
        properties["name"] = json!(name);
    }
    json!({"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates": [ring]}})
}
