//! JSON of a document to the wire form of its message.

use std::fmt;

use d3dgen_model::Problem;
use prost::encoding::{WireType, encode_key, encode_varint};
use serde_json::Value;

use super::forms::{self, EXPRESSION, Form};
use super::plan::{Count, Field, Kind, Message, Plan};

/// Where a value stands; written only for problems.
pub enum Place<'a> {
    Root,
    Key(&'a Place<'a>, &'a str),
    Index(&'a Place<'a>, usize),
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => Ok(()),
            Self::Key(above, key) => write!(f, "{above}/{}", key.replace('~', "~0").replace('/', "~1")),
            Self::Index(above, i) => write!(f, "{above}/{i}"),
        }
    }
}

type Problems = Vec<Problem>;

/// Appends a message.
pub fn message(
    plan: &Plan,
    own: &Message,
    value: &Value,
    place: &Place<'_>,
    out: &mut Vec<u8>,
    problems: &mut Problems,
) {
    let wrong = |problems: &mut Problems, wanted: &str| {
        problems.push(Problem::new(place.to_string(), format!("is no {wanted}, as {} is one", own.name)));
    };
    match (own.form, value) {
        (Form::Object, Value::Object(_)) => object(plan, own, value, None, place, out, problems),
        (Form::Tagged(tag), Value::Object(entries)) => {
            let word = entries.get(tag).and_then(Value::as_str).unwrap_or_default();
            match (own.by_name(word).map(|f| (f, f.kind)), word) {
                (Some((field, Kind::Message(arm))), _) => {
                    let mut inner = Vec::new();
                    object(plan, &plan.messages[arm], value, Some(tag), place, &mut inner, problems);
                    bytes(field.number, &inner, out);
                }
                (_, word) => {
                    problems.push(Problem::new(format!("{place}/{tag}"), format!("`{word}` is no {}", own.name)));
                }
            }
        }
        (Form::Tuple, Value::Array(items)) if items.len() == own.fields.len() => {
            for (i, (item, field)) in items.iter().zip(&own.fields).enumerate() {
                one(plan, field, item, &Place::Index(place, i), out, problems);
            }
        }
        (Form::List, _) => any(plan, &own.fields[0], value, place, out, problems),
        (Form::Plain, _) => match forms::plain(&own.name, value).and_then(|name| own.by_name(name)) {
            Some(field) if field.name == EXPRESSION.0 => {
                one(plan, field, &value[EXPRESSION.1], &Place::Key(place, EXPRESSION.1), out, problems);
            }
            Some(field) => one(plan, field, value, place, out, problems),
            None => wrong(problems, "figure, word, list or table"),
        },
        (Form::Tuple, _) => wrong(problems, &format!("array of {}", own.fields.len())),
        (Form::Object | Form::Tagged(_), _) => wrong(problems, "object"),
    }
}

/// Appends the fields of an object, one key left out.
fn object(
    plan: &Plan,
    own: &Message,
    value: &Value,
    without: Option<&str>,
    place: &Place<'_>,
    out: &mut Vec<u8>,
    problems: &mut Problems,
) {
    let entries = value.as_object().into_iter().flatten();
    let mut seen = vec![false; own.fields.len()];
    for (key, entry) in entries.filter(|(key, _)| without != Some(key)) {
        let place = Place::Key(place, key);
        match own.by_key(key) {
            Some((at, field)) => {
                seen[at] = true;
                any(plan, field, entry, &place, out, problems);
            }
            None => problems.push(Problem::new(place.to_string(), format!("is no field of {}", own.name))),
        }
    }
    for (field, seen) in own.fields.iter().zip(seen) {
        if !seen && field.count == Count::Once && matches!(field.kind, Kind::Message(_) | Kind::Enum(_)) {
            problems.push(Problem::new(Place::Key(place, &field.key).to_string(), "is missing"));
        }
    }
}

/// Appends a field however often it occurs; `null` is absence.
fn any(plan: &Plan, field: &Field, value: &Value, place: &Place<'_>, out: &mut Vec<u8>, problems: &mut Problems) {
    match (field.count, value) {
        (Count::Optional | Count::Once, Value::Null) => {}
        (Count::Many, Value::Array(items)) => {
            for (i, item) in items.iter().enumerate() {
                one(plan, field, item, &Place::Index(place, i), out, problems);
            }
        }
        (Count::Map, Value::Object(entries)) => {
            for (key, entry) in entries {
                let mut inner = Vec::new();
                bytes(1, key.as_bytes(), &mut inner);
                let value = Field { number: 2, ..field.clone() };
                one(plan, &value, entry, &Place::Key(place, key), &mut inner, problems);
                bytes(field.number, &inner, out);
            }
        }
        (Count::Many, _) => problems.push(Problem::new(place.to_string(), "is no array")),
        (Count::Map, _) => problems.push(Problem::new(place.to_string(), "is no object")),
        _ => one(plan, field, value, place, out, problems),
    }
}

/// Appends one occurrence of a field.
fn one(plan: &Plan, field: &Field, value: &Value, place: &Place<'_>, out: &mut Vec<u8>, problems: &mut Problems) {
    let mut wrong = |wanted: String| problems.push(Problem::new(place.to_string(), format!("{value} is {wanted}")));
    match (field.kind, value) {
        (Kind::Double, Value::Number(n)) => match n.as_f64() {
            Some(figure) => {
                encode_key(field.number, WireType::SixtyFourBit, out);
                out.extend_from_slice(&figure.to_le_bytes());
            }
            None => wrong("no figure".into()),
        },
        (Kind::Uint, Value::Number(n)) => match n.as_u64().filter(|n| *n <= field.most) {
            Some(n) => varint(field.number, n, out),
            None => wrong(format!("no whole number from 0 to {}", field.most)),
        },
        (Kind::Int, Value::Number(n)) => match n.as_i64() {
            Some(n) => varint(field.number, n.cast_unsigned(), out),
            None => wrong("no whole number".into()),
        },
        (Kind::Bool, Value::Bool(flag)) => varint(field.number, u64::from(*flag), out),
        (Kind::String, Value::String(text)) => bytes(field.number, text.as_bytes(), out),
        (Kind::Enum(at), Value::String(word)) => match plan.enums[at].by_word.get(word) {
            Some(number) => varint(field.number, i64::from(*number).cast_unsigned(), out),
            None => wrong(format!("none of {:?}", plan.enums[at].by_word.keys().collect::<Vec<_>>())),
        },
        (Kind::Message(at), _) => {
            let mut inner = Vec::new();
            message(plan, &plan.messages[at], value, place, &mut inner, problems);
            bytes(field.number, &inner, out);
        }
        (kind, _) => wrong(format!("no {}", format!("{kind:?}").to_lowercase())),
    }
}

fn varint(number: u32, value: u64, out: &mut Vec<u8>) {
    encode_key(number, WireType::Varint, out);
    encode_varint(value, out);
}

fn bytes(number: u32, content: &[u8], out: &mut Vec<u8>) {
    encode_key(number, WireType::LengthDelimited, out);
    encode_varint(content.len() as u64, out);
    out.extend_from_slice(content);
}
