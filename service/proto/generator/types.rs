//! From a definition of a schema to messages and enums.

use std::collections::BTreeSet;
use std::error::Error;

use serde_json::Value;

use super::Names;

/// A message or an enum.
#[derive(Debug)]
pub struct Item {
    pub name: String,
    pub about: String,
    pub body: Body,
}

#[derive(Debug)]
pub enum Body {
    /// Fields; with the name of a `oneof` when only one of them is set.
    Message(Vec<Field>, Option<String>),
    /// Values with what they mean.
    Enum(Vec<(String, String)>),
}

#[derive(Debug)]
pub struct Field {
    pub name: String,
    /// Key of the document.
    pub key: String,
    pub about: String,
    /// `repeated `, `optional ` or empty.
    pub label: &'static str,
    pub kind: String,
}

/// Reads definitions and notes which types they use, as the schema calls them or as `values.proto` does.
pub struct Reader<'a> {
    pub names: &'a Names,
    pub used: BTreeSet<String>,
}

type Outcome<T> = Result<T, Box<dyn Error>>;

impl Reader<'_> {
    /// Returns what a definition becomes: one message or enum, or a message for each alternative.
    pub fn items(&mut self, name: &str, definition: &Value) -> Outcome<Vec<Item>> {
        let about = text(definition, "description");
        let proto = self.type_name(name);
        if let Some(alternatives) = definition["oneOf"].as_array() {
            if alternatives.iter().all(|a| a["const"].is_string()) {
                let value = |a: &Value| (constant(&proto, &text(a, "const")), text(a, "description"));
                let values = alternatives.iter().map(value).collect();
                return Ok(vec![Item { name: proto, about, body: Body::Enum(values) }]);
            }
            if let Some(arms) = self.wrapped(alternatives) {
                return Ok(vec![Item { name: proto, about, body: Body::Message(arms, Some("kind".into())) }]);
            }
            return self.tagged(name, &proto, about, alternatives);
        }
        if definition["type"] == "array" {
            let key = format!("{name}.[]");
            let field = self.names.fields.get(&key).ok_or_else(|| format!("`{key}` has no name in fields"))?.clone();
            let kind = self.kind(&key, &definition["items"])?.0;
            let field = Field { name: field, key: "[]".into(), about: "In order.".into(), label: "repeated ", kind };
            return Ok(vec![Item { name: proto, about, body: Body::Message(vec![field], None) }]);
        }
        let fields = self.fields(name, definition, None)?;
        Ok(vec![Item { name: proto, about, body: Body::Message(fields, None) }])
    }

    /// Returns the fields of alternatives each of which is an object with one key, that of a type of its own; none where they
    /// are told apart otherwise.
    fn wrapped(&mut self, alternatives: &[Value]) -> Option<Vec<Field>> {
        let arm = |alternative: &Value| {
            let mut properties = alternative["properties"].as_object()?.iter();
            let ((key, property), None) = (properties.next()?, properties.next()) else { return None };
            let reference = property["$ref"].as_str()?.rsplit('/').next()?.to_owned();
            Some((key.clone(), text(alternative, "description"), reference))
        };
        let found: Vec<_> = alternatives.iter().map(arm).collect::<Option<_>>()?;
        let field = |(key, about, reference): (String, String, String)| {
            let kind = self.type_name(&reference);
            self.used.insert(reference);
            Field { name: key.clone(), key, about, label: "", kind }
        };
        Some(found.into_iter().map(field).collect())
    }

    /// Returns the messages of alternatives that a key tells apart.
    fn tagged(&mut self, name: &str, proto: &str, about: String, alternatives: &[Value]) -> Outcome<Vec<Item>> {
        let mut arms = Vec::new();
        let mut items = Vec::new();
        for alternative in alternatives {
            let properties = alternative["properties"].as_object().ok_or_else(|| format!("`{name}` is no choice"))?;
            let (tag, word) = properties
                .iter()
                .find_map(|(key, p)| Some((key.clone(), p["const"].as_str()?)))
                .ok_or_else(|| format!("an alternative of `{name}` has no tag"))?;
            let own = format!("{}{proto}", camel(word));
            let about = text(alternative, "description");
            arms.push(Field {
                name: word.to_owned(),
                key: word.to_owned(),
                about: about.clone(),
                label: "",
                kind: own.clone(),
            });
            let fields = self.fields(name, alternative, Some(&tag))?;
            items.push(Item { name: own, about, body: Body::Message(fields, None) });
        }
        items.insert(0, Item { name: proto.to_owned(), about, body: Body::Message(arms, Some("kind".into())) });
        Ok(items)
    }

    fn fields(&mut self, owner: &str, definition: &Value, without: Option<&str>) -> Outcome<Vec<Field>> {
        let properties = definition["properties"].as_object().ok_or_else(|| format!("`{owner}` has no properties"))?;
        let required: Vec<&str> =
            definition["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let mut fields = Vec::new();
        for (key, property) in properties.iter().filter(|(key, _)| without != Some(key)) {
            let path = format!("{owner}.{key}");
            let (kind, mut label) = self.kind(&path, property)?;
            // what a document may leave out without a zero of its own: absence means the default
            if label.is_empty() && property["$ref"].is_string() && !required.contains(&key.as_str()) {
                label = "optional ";
            }
            let name = self.names.fields.get(&path).unwrap_or(key).clone();
            fields.push(Field { name, key: key.clone(), about: text(property, "description"), label, kind });
        }
        Ok(fields)
    }

    /// Returns the type and label of a property.
    fn kind(&mut self, path: &str, property: &Value) -> Outcome<(String, &'static str)> {
        if let Some(alternatives) = property["anyOf"].as_array() {
            let other =
                alternatives.iter().find(|a| a["type"] != "null").ok_or_else(|| format!("{path}: only null"))?;
            let (kind, _) = self.kind(path, other)?;
            return Ok((kind, "optional "));
        }
        if let Some(reference) = property["$ref"].as_str() {
            let name = reference.rsplit('/').next().unwrap_or_default();
            self.used.insert(name.to_owned());
            return Ok((self.type_name(name), ""));
        }
        let nullable = property["type"].as_array().is_some_and(|t| t.iter().any(|t| t == "null"));
        let word = match &property["type"] {
            Value::Array(types) => types.iter().find(|t| **t != "null").and_then(Value::as_str),
            one => one.as_str(),
        };
        let format = property["format"].as_str().unwrap_or_default();
        let scalar = match (word.unwrap_or_default(), format) {
            ("string", _) => "string",
            ("boolean", _) => "bool",
            ("number", _) => "double",
            ("integer", "uint64" | "uint") => "uint64",
            ("integer", "int64") => "int64",
            ("integer", "int32") => "int32",
            ("integer", _) => "uint32",
            ("array", _) => return self.array(path, property, nullable),
            ("object", _) => return self.map(path, property),
            _ => return Err(format!("{path}: no counterpart of {property}").into()),
        };
        let zero = ["\"\"", "false", "0", "0.0", "null"];
        let other_default = property.get("default").is_some_and(|d| !zero.contains(&d.to_string().as_str()));
        Ok((scalar.to_owned(), if nullable || other_default { "optional " } else { "" }))
    }

    fn array(&mut self, path: &str, property: &Value, nullable: bool) -> Outcome<(String, &'static str)> {
        if fixed(property) {
            return Ok((self.tuple(path)?, if nullable { "optional " } else { "" }));
        }
        let items = &property["items"];
        let kind = if fixed(items) { self.tuple(path)? } else { self.kind(path, items)?.0 };
        Ok((kind, "repeated "))
    }

    fn tuple(&mut self, path: &str) -> Outcome<String> {
        let name = self.names.tuples.get(path).ok_or_else(|| format!("`{path}` has no message in tuples"))?.clone();
        self.used.insert(name.clone());
        Ok(name)
    }

    fn map(&mut self, path: &str, property: &Value) -> Outcome<(String, &'static str)> {
        let values = &property["additionalProperties"];
        let kind = if values["type"] == "array" {
            let list = match values["items"]["type"].as_str() {
                Some("string") => "StringList",
                Some("number") => "NumberList",
                _ => return Err(format!("{path}: no counterpart of {property}").into()),
            };
            self.used.insert(list.to_owned());
            list.to_owned()
        } else {
            self.kind(path, values)?.0
        };
        Ok((format!("map<string, {kind}>"), ""))
    }

    fn type_name(&self, name: &str) -> String {
        let own = self.names.types.get(name).or_else(|| self.names.by_hand.get(name));
        own.cloned().unwrap_or_else(|| name.to_owned())
    }
}

fn fixed(property: &Value) -> bool {
    property["minItems"].is_u64() && property["minItems"] == property["maxItems"]
}

fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_default().to_owned()
}

fn camel(word: &str) -> String {
    let upper = |part: &str| part[..1].to_uppercase() + &part[1..];
    word.split('_').filter(|p| !p.is_empty()).map(upper).collect()
}

/// Returns the name of an enum value: the enum's own in front, signs in words.
fn constant(owner: &str, word: &str) -> String {
    let spoken = word.replace('-', "minus_").replace('+', "plus_");
    format!("{}_{}", super::numbers::screaming(owner), spoken.to_uppercase())
}
