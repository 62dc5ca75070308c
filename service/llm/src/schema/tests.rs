//! Tests of the schema form.

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::json;

use super::*;

#[test]
fn the_common_form_is_checked() {
    let object = |properties: Value, required: Value| json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false});
    let check = |schema: Value, says: &[&str]| {
        let problems = check_lowest_common(&schema);
        assert_eq!(problems.len(), says.len(), "{problems:?}");
        for (problem, says) in problems.iter().zip(says) {
            assert!(problem.contains(says), "{problem} / {says}");
        }
    };
    let word = || json!({"type": ["string", "null"], "description": "x"});
    check(object(json!({"a": word()}), json!(["a"])), &[]);
    check(object(json!({"a": {"type": ["string", "null"], "enum": ["x", null]}}), json!(["a"])), &[]);
    check(object(json!({"a": {"anyOf": [word(), {"type": "number"}]}}), json!(["a"])), &[]);
    check(object(json!({"a": word(), "b": word()}), json!(["a"])), &["`b` has to be required"]);
    check(object(json!({"a": {"type": "string", "pattern": "x"}}), json!(["a"])), &["`pattern` is not understood"]);
    check(object(json!({"a": {"type": "array"}}), json!(["a"])), &["needs `items`"]);
    check(object(json!({"a": {}}), json!(["a"])), &["needs a `type`"]);
    check(object(json!({"a": {"type": ["string", "number"]}}), json!(["a"])), &["only one type"]);
    check(object(json!({"a": {"type": ["string", "null"], "enum": ["x"]}}), json!(["a"])), &["null has to be in both"]);
    check(json!({"type": "array", "items": word()}), &["the root has to be an object"]);
    check(json!({"type": "object", "properties": {"a": word()}, "required": ["a"]}), &["additionalProperties"]);
    check(json!(true), &["the root has to be", "has to be an object"]);
}

/// What is found in a text.
#[derive(Debug, PartialEq, Deserialize, JsonSchema)]
struct Found {
    /// Name of the rule.
    name: String,
    #[schemars(range(min = 0.0))]
    value: f64,
    #[serde(default)]
    places: Vec<Place>,
    unit: Option<Unit>,
    #[serde(default = "three")]
    weight: u32,
}

#[derive(Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Unit {
    /// Meters.
    M,
    /// Square meters.
    M2,
}

#[derive(Debug, PartialEq, Deserialize, JsonSchema)]
struct Place {
    room: String,
}

fn three() -> u32 {
    3
}

#[test]
fn a_type_becomes_a_schema_and_an_answer_becomes_the_type() {
    let schema = Schema::from_schemars("found", schemars::schema_for!(Found).as_value()).unwrap();
    assert_eq!(check_lowest_common(schema.wire()), Vec::<String>::new());
    let text = schema.wire().to_string();
    assert!(!text.contains("$ref") && !text.contains("minimum") && !text.contains("format"), "{text}");

    let answer = json!({"name": "width", "value": 1.5, "places": null, "unit": null, "weight": null});
    let found: Found = serde_json::from_value(schema.check(answer).unwrap()).unwrap();
    assert_eq!(found, Found { name: "width".into(), value: 1.5, places: vec![], unit: None, weight: 3 });

    let answer = json!({"name": "width", "value": 1.5, "places": [{"room": "hall"}], "unit": "m2", "weight": 1});
    let found: Found = serde_json::from_value(schema.check(answer).unwrap()).unwrap();
    assert_eq!((found.unit, found.weight), (Some(Unit::M2), 1));

    let check = |answer: Value, says: &str| {
        let problems = schema.check(answer).unwrap_err();
        assert!(problems.iter().any(|p| p.contains(says)), "{problems:?}");
    };
    check(json!({"name": "w", "value": -1.0, "places": null, "unit": null, "weight": null}), "/value");
    check(json!({"name": "w", "value": 1.0, "places": [], "unit": "ft", "weight": null}), "/unit");
    check(json!({"name": "w"}), "required");
    check(json!({"name": "w", "value": "1.5", "places": null, "unit": null, "weight": null}), "/value");
}

#[test]
fn what_the_form_cannot_say_is_an_error() {
    let check = |schema: Value, says: &str| {
        let error = Schema::from_schemars("x", &schema).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    };
    let with = |property: Value| json!({"type": "object", "properties": {"a": property}});
    check(with(json!({"type": "object", "additionalProperties": {"type": "string"}})), "is a map");
    check(with(json!(true)), "accepts anything");
    check(with(json!({"description": "any"})), "accepts anything");
    check(with(json!({"$ref": "#/$defs/none"})), "points nowhere");
    check(with(json!({"$ref": "#"})), "refers to itself");
    check(with(json!({"type": "array", "prefixItems": [{"type": "string"}]})), "prefixItems");
    assert!(Schema::new("bad name", with(json!({"type": "string"}))).is_err());
}
