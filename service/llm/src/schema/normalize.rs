//! Turns a schema as `schemars` makes it into the common form. What it cannot express is an error, never dropped.

use serde_json::{Map, Value, json};

/// References followed inside each other; more is taken for recursion.
const MAX_DEPTH: usize = 24;
/// Annotations without a say in what is valid, and bookkeeping.
const IGNORED: &[&str] = &["$schema", "$id", "$defs", "definitions", "$comment", "title", "examples", "default"];
/// Checked on the answer, not sent.
const CHECKED_HERE: &[&str] = &[
    "minimum",
    "maximum",
    "exclusiveMinimum",
    "exclusiveMaximum",
    "multipleOf",
    "minLength",
    "maxLength",
    "pattern",
    "format",
    "minItems",
    "maxItems",
    "uniqueItems",
];
/// Keywords that [`lowest`] turns into others.
const UNDERSTOOD: &[&str] =
    &["type", "description", "properties", "required", "additionalProperties", "items", "enum", "anyOf", "const"];

/// Returns the schema with references in place, `oneOf` as `anyOf`, and single `allOf` merged.
pub(super) fn inline(root: &Value) -> Result<Value, String> {
    resolve(root, root, "#", 0)
}

fn resolve(root: &Value, schema: &Value, place: &str, depth: usize) -> Result<Value, String> {
    if depth > MAX_DEPTH {
        return Err(format!("{place}: refers to itself or is nested too deep; use a list with ids instead"));
    }
    let Some(source) = schema.as_object() else {
        return Err(format!("{place}: accepts anything; say what it is"));
    };
    let mut merged = Map::new();
    for (key, value) in source {
        match key.as_str() {
            "$ref" => {
                let target = value.as_str().and_then(|r| r.strip_prefix('#')).and_then(|p| root.pointer(p));
                let target = target.ok_or_else(|| format!("{place}: {value} points nowhere in this schema"))?;
                merge(&mut merged, resolve(root, target, place, depth + 1)?, place)?;
            }
            "allOf" => {
                for part in value.as_array().into_iter().flatten() {
                    merge(&mut merged, resolve(root, part, place, depth + 1)?, place)?;
                }
            }
            "oneOf" | "anyOf" => {
                let choices = value.as_array().into_iter().flatten().enumerate();
                let choices = choices.map(|(i, c)| resolve(root, c, &format!("{place}/{key}/{i}"), depth + 1));
                merged.insert("anyOf".to_owned(), Value::Array(choices.collect::<Result<_, _>>()?));
            }
            "properties" => {
                let mut properties = Map::new();
                for (name, property) in value.as_object().into_iter().flatten() {
                    let place = format!("{place}/properties/{name}");
                    properties.insert(name.clone(), resolve(root, property, &place, depth + 1)?);
                }
                merged.insert(key.clone(), Value::Object(properties));
            }
            "items" => {
                merged.insert(key.clone(), resolve(root, value, &format!("{place}/items"), depth + 1)?);
            }
            "additionalProperties" if value.is_object() || *value == Value::Bool(true) => {
                return Err(format!("{place}: is a map; use a list of objects with the key as a property"));
            }
            key if IGNORED.contains(&key) => {}
            key if UNDERSTOOD.contains(&key) || CHECKED_HERE.contains(&key) => {
                merged.insert(key.to_owned(), value.clone());
            }
            other => return Err(format!("{place}: `{other}` has no counterpart in the common form")),
        }
    }
    if merged.keys().all(|k| k == "description") {
        return Err(format!("{place}: accepts anything; say what it is"));
    }
    Ok(Value::Object(merged))
}

/// Adds the keywords of `part`; what stands beside a reference (its description) wins.
fn merge(into: &mut Map<String, Value>, part: Value, place: &str) -> Result<(), String> {
    for (key, value) in part.as_object().into_iter().flatten() {
        match into.get(key) {
            None => {
                into.insert(key.clone(), value.clone());
            }
            Some(present) if present == value || key == "description" => {}
            Some(_) => return Err(format!("{place}: two parts disagree about `{key}`")),
        }
    }
    Ok(())
}

/// Returns the common form of an inlined schema.
pub(super) fn lowest(full: &Value) -> Value {
    let Some(source) = full.as_object() else { return full.clone() };
    let mut out = Map::new();
    for (key, value) in source {
        match key.as_str() {
            "const" => {
                out.insert("enum".to_owned(), json!([value]));
            }
            "anyOf" => lower_choices(value, &mut out),
            "items" => {
                out.insert(key.clone(), lowest(value));
            }
            "properties" | "required" | "additionalProperties" => {}
            key if CHECKED_HERE.contains(&key) => {}
            _ => {
                out.insert(key.clone(), value.clone());
            }
        }
    }
    if let Some(properties) = source.get("properties").and_then(Value::as_object) {
        let lower = |(name, property): (&String, &Value)| {
            let optional = !is_required(source, name) && !allows_null(property);
            let property = lowest(property);
            (name.clone(), if optional { or_null(property) } else { property })
        };
        out.insert("required".to_owned(), properties.keys().map(|k| json!(k)).collect());
        out.insert("properties".to_owned(), Value::Object(properties.iter().map(lower).collect()));
        out.insert("additionalProperties".to_owned(), json!(false));
    }
    if !out.contains_key("type")
        && let Some(values) = out.get("enum").and_then(Value::as_array)
    {
        let types = types_of(values);
        out.insert("type".to_owned(), types);
    }
    Value::Object(out)
}

/// Inserts a choice: constants become one `enum`, anything else an `anyOf`.
fn lower_choices(choices: &Value, out: &mut Map<String, Value>) {
    let choices: Vec<Value> = choices.as_array().into_iter().flatten().map(lowest).collect();
    let mut values = Vec::new();
    let mut hints = Vec::new();
    for choice in &choices {
        let null = (choice.get("type") == Some(&json!("null"))).then(|| vec![Value::Null]);
        let Some(listed) = choice.get("enum").and_then(Value::as_array).cloned().or(null) else {
            // A choice of one is no choice.
            match <[Value; 1]>::try_from(choices.clone()) {
                Ok([Value::Object(only)]) => out.extend(only),
                _ => {
                    out.insert("anyOf".to_owned(), Value::Array(choices));
                }
            }
            return;
        };
        if let Some(about) = choice.get("description").and_then(Value::as_str) {
            let names: Vec<String> = listed.iter().map(|v| v.as_str().map_or(v.to_string(), str::to_owned)).collect();
            hints.push(format!("{}: {about}", names.join(", ")));
        }
        values.extend(listed);
    }
    out.insert("type".to_owned(), types_of(&values));
    out.insert("enum".to_owned(), Value::Array(values));
    if !hints.is_empty() {
        let about = out.get("description").and_then(Value::as_str).map(|d| format!("{d}\n")).unwrap_or_default();
        out.insert("description".to_owned(), json!(format!("{about}{}", hints.join("\n"))));
    }
}

/// Returns the `type` of listed values.
fn types_of(values: &[Value]) -> Value {
    let name = |v: &Value| match v {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(n) if n.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let mut names: Vec<&str> = Vec::new();
    for value in values {
        if !names.contains(&name(value)) {
            names.push(name(value));
        }
    }
    match names.as_slice() {
        [one] => json!(one),
        _ => json!(names),
    }
}

/// Returns the schema that also takes null.
fn or_null(schema: Value) -> Value {
    let Value::Object(mut schema) = schema else { return schema };
    if let Some(Value::Array(values)) = schema.get_mut("enum") {
        values.push(Value::Null);
    }
    match schema.get_mut("type") {
        Some(Value::String(name)) => {
            let union = json!([name, "null"]);
            schema.insert("type".to_owned(), union);
        }
        Some(Value::Array(names)) => names.push(json!("null")),
        _ => {}
    }
    if let Some(Value::Array(choices)) = schema.get_mut("anyOf") {
        choices.push(json!({"type": "null"}));
    }
    Value::Object(schema)
}

/// Returns whether an inlined schema takes null.
fn allows_null(schema: &Value) -> bool {
    let listed = |key: &str, value: &Value| match schema.get(key) {
        Some(Value::Array(values)) => values.contains(value),
        Some(only) => only == value,
        None => false,
    };
    listed("type", &json!("null"))
        || listed("enum", &Value::Null)
        || schema.get("const") == Some(&Value::Null)
        || schema.get("anyOf").and_then(Value::as_array).is_some_and(|c| c.iter().any(allows_null))
}

fn is_required(object: &Map<String, Value>, name: &str) -> bool {
    object.get("required").and_then(Value::as_array).is_some_and(|r| r.iter().any(|n| n.as_str() == Some(name)))
}

/// Returns the answer without nulls that only [`lowest`] allowed.
pub(super) fn without_added_nulls(full: &Value, mut answer: Value) -> Value {
    if let Value::Array(items) = &mut answer
        && let Some(schema) = full.get("items")
    {
        items.iter_mut().for_each(|item| *item = without_added_nulls(schema, item.take()));
    }
    if let (Value::Object(object), Some(source)) = (&mut answer, full.as_object()) {
        for (name, property) in source.get("properties").and_then(Value::as_object).into_iter().flatten() {
            let optional = !is_required(source, name) && !allows_null(property);
            if optional && object.get(name).is_some_and(Value::is_null) {
                object.shift_remove(name);
            } else if let Some(value) = object.get_mut(name) {
                *value = without_added_nulls(property, value.take());
            }
        }
    }
    for choice in full.get("anyOf").and_then(Value::as_array).into_iter().flatten() {
        answer = without_added_nulls(choice, answer);
    }
    answer
}
