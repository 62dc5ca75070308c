//! Checks that a schema is in the form that all providers take. It does not change schemas; see `normalize.rs`.

use serde_json::{Map, Value};

/// Keywords that all providers take.
const KEYWORDS: &[&str] =
    &["type", "description", "properties", "required", "additionalProperties", "items", "enum", "anyOf"];
/// Names of types.
const TYPES: &[&str] = &["object", "array", "string", "number", "integer", "boolean", "null"];
/// Levels of nesting that all providers take.
const MAX_DEPTH: usize = 10;

/// Returns every place where a schema is not in the common form, with what to do; empty when it is.
pub fn check_lowest_common(schema: &Value) -> Vec<String> {
    let mut problems = Vec::new();
    let root = schema.as_object();
    if root.and_then(|r| r.get("type")).and_then(Value::as_str) != Some("object") {
        problems.push("#: the root has to be an object (\"type\": \"object\")".to_owned());
    }
    visit(schema, "#", 0, &mut problems);
    problems
}

fn visit(schema: &Value, place: &str, depth: usize, problems: &mut Vec<String>) {
    let Some(schema) = schema.as_object() else {
        problems.push(format!("{place}: a schema has to be an object"));
        return;
    };
    if depth > MAX_DEPTH {
        problems.push(format!("{place}: nested deeper than {MAX_DEPTH} levels; flatten it"));
        return;
    }
    for key in schema.keys().filter(|k| !KEYWORDS.contains(&k.as_str())) {
        problems.push(format!("{place}: `{key}` is not understood by all providers; check it on the answer instead"));
    }
    let types = types(schema, place, problems);
    if types.contains(&"object") {
        visit_object(schema, place, depth, problems);
    }
    if types.contains(&"array") {
        match schema.get("items") {
            Some(items) => visit(items, &format!("{place}/items"), depth + 1, problems),
            None => problems.push(format!("{place}: an array needs `items`")),
        }
    }
    visit_choices(schema, &types, place, depth, problems);
}

/// Returns the names of types; at most one beside null.
fn types<'a>(schema: &'a Map<String, Value>, place: &str, problems: &mut Vec<String>) -> Vec<&'a str> {
    let types: Vec<&str> = match schema.get("type") {
        Some(Value::String(name)) => vec![name],
        Some(Value::Array(names)) => names.iter().filter_map(Value::as_str).collect(),
        Some(_) => vec![],
        None if schema.contains_key("anyOf") => return vec![],
        None => {
            problems.push(format!("{place}: needs a `type` or `anyOf`"));
            return vec![];
        }
    };
    if types.is_empty() || types.iter().any(|t| !TYPES.contains(t)) {
        problems.push(format!("{place}: `type` has to be one of {}", TYPES.join(", ")));
    }
    if types.iter().filter(|t| **t != "null").count() > 1 {
        problems.push(format!("{place}: only one type beside null; use `anyOf` for a choice"));
    }
    types
}

fn visit_object(schema: &Map<String, Value>, place: &str, depth: usize, problems: &mut Vec<String>) {
    let Some(properties) = schema.get("properties").and_then(Value::as_object).filter(|p| !p.is_empty()) else {
        problems.push(format!("{place}: an object needs `properties`"));
        return;
    };
    if schema.get("additionalProperties") != Some(&Value::Bool(false)) {
        problems.push(format!("{place}: an object needs \"additionalProperties\": false"));
    }
    let required: Vec<&str> =
        schema.get("required").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str).collect();
    for name in properties.keys().filter(|n| !required.contains(&n.as_str())) {
        problems.push(format!("{place}: `{name}` has to be required; make it a union with null if it is optional"));
    }
    for name in required.iter().filter(|n| !properties.contains_key(**n)) {
        problems.push(format!("{place}: `{name}` is required but no property"));
    }
    for (name, property) in properties {
        visit(property, &format!("{place}/properties/{name}"), depth + 1, problems);
    }
}

fn visit_choices(schema: &Map<String, Value>, types: &[&str], place: &str, depth: usize, problems: &mut Vec<String>) {
    match schema.get("anyOf") {
        Some(Value::Array(choices)) if !choices.is_empty() && place != "#" => {
            for (i, choice) in choices.iter().enumerate() {
                visit(choice, &format!("{place}/anyOf/{i}"), depth + 1, problems);
            }
        }
        Some(_) => problems.push(format!("{place}: `anyOf` has to be a list of schemas, and not at the root")),
        None => {}
    }
    match schema.get("enum") {
        Some(Value::Array(values)) if !values.is_empty() => {
            if values.iter().any(|v| v.is_object() || v.is_array()) {
                problems.push(format!("{place}: `enum` takes only texts, numbers, true, false and null"));
            }
            if types.contains(&"null") != values.contains(&Value::Null) {
                problems.push(format!("{place}: null has to be in both `type` and `enum`, or in neither"));
            }
        }
        Some(_) => problems.push(format!("{place}: `enum` has to be a list with entries")),
        None => {}
    }
}
