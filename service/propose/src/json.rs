//! The forms of answers: what a model is to fill in, and the types that checked answers become.

use d3dgen_llm::Schema;
use d3dgen_model::scene_graph::Connector;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Longest text of a model that is quoted, in characters.
const MOST_CHARS: usize = 60;

/// A proposed scene graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GraphAnswer {
    /// Rooms, circulation aside.
    pub rooms: Vec<RoomAnswer>,
    /// Connections.
    pub edges: Vec<EdgeAnswer>,
}

/// A proposed room.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoomAnswer {
    /// The answer's own name of the room.
    pub id: String,
    /// Room type id, or words for it.
    pub room_type: String,
    /// Name for people.
    pub name: String,
    /// Net floor area, m^2.
    pub area_m2: Option<f64>,
    /// Objects, the most important first.
    pub objects: Vec<String>,
}

/// A proposed connection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EdgeAnswer {
    /// Id of a room of the answer.
    pub a: String,
    /// Id of a room of the answer.
    pub b: String,
    /// How they meet.
    pub connector: Connector,
}

/// A proposed floorplan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanAnswer {
    /// Outlines.
    pub rooms: Vec<OutlineAnswer>,
}

/// A proposed outline of a room.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutlineAnswer {
    /// Room of the scene graph.
    pub room_id: String,
    /// Parts of its outline, on the center lines of walls.
    pub rectangles: Vec<RectAnswer>,
}

/// A proposed rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RectAnswer {
    /// To the east, m: the west side of a rectangle, the center of an object.
    pub x_m: f64,
    /// To the north, m: the south side of a rectangle, the center of an object.
    pub y_m: f64,
    /// Extent to the east, m.
    pub width_m: f64,
    /// Extent to the north, m.
    pub depth_m: f64,
}

/// Proposed furniture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FurnitureAnswer {
    /// Objects.
    pub objects: Vec<ObjectAnswer>,
}

/// A proposed object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectAnswer {
    /// Room of the scene graph.
    pub room_id: String,
    /// Object id of the domain.
    pub object: String,
    /// To the east, m: the west side of a rectangle, the center of an object.
    pub x_m: f64,
    /// To the north, m: the south side of a rectangle, the center of an object.
    pub y_m: f64,
    /// Heading of the front, degrees counter-clockwise from east.
    pub yaw_deg: f64,
}

fn object(properties: Value) -> Value {
    let names: Vec<String> = properties.as_object().map(|p| p.keys().cloned().collect()).unwrap_or_default();
    json!({"type": "object", "properties": properties, "required": names, "additionalProperties": false})
}

fn list(items: Value) -> Value {
    json!({"type": "array", "items": items})
}

fn schema(name: &str, form: Value) -> Schema {
    Schema::new(name, form).expect("the forms are in the lowest common form, as a test shows")
}

/// Returns the form of a scene graph.
pub fn graph_schema() -> Schema {
    let room = object(json!({
        "id": {"type": "string"}, "room_type": {"type": "string"}, "name": {"type": "string"},
        "area_m2": {"type": ["number", "null"]}, "objects": list(json!({"type": "string"})),
    }));
    let edge = object(json!({
        "a": {"type": "string"}, "b": {"type": "string"},
        "connector": {"type": "string", "enum": ["door", "open", "wall", "near"]},
    }));
    schema("scene_graph", object(json!({"rooms": list(room), "edges": list(edge)})))
}

/// Returns the form of a floorplan.
pub fn plan_schema() -> Schema {
    let number = || json!({"type": "number"});
    let rect = object(json!({"x_m": number(), "y_m": number(), "width_m": number(), "depth_m": number()}));
    let room = object(json!({"room_id": {"type": "string"}, "rectangles": list(rect)}));
    schema("floorplan", object(json!({"rooms": list(room)})))
}

/// Returns the form of furniture.
pub fn furniture_schema() -> Schema {
    let number = || json!({"type": "number"});
    let thing = object(json!({
        "room_id": {"type": "string"}, "object": {"type": "string"},
        "x_m": number(), "y_m": number(), "yaw_deg": number(),
    }));
    schema("placement", object(json!({"objects": list(thing)})))
}

/// Returns a text of a model as it may be quoted: short, in one line.
pub fn quoted(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).take(MOST_CHARS + 1).collect();
    if plain.chars().count() <= MOST_CHARS {
        return plain;
    }
    plain.chars().take(MOST_CHARS).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use d3dgen_llm::check_lowest_common;

    #[test]
    fn every_provider_takes_the_forms() {
        for schema in [graph_schema(), plan_schema(), furniture_schema()] {
            assert_eq!(check_lowest_common(schema.wire()), Vec::<String>::new(), "{}", schema.name());
        }
    }

    #[test]
    fn what_a_model_says_is_quoted_in_one_short_line() {
        assert_eq!(quoted("bed\nroom"), "bed room");
        assert_eq!(quoted(&"x".repeat(500)).chars().count(), MOST_CHARS + 1);
    }
}
