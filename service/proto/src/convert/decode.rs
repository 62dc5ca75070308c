//! The wire form of a message to the JSON of its document.

use std::fmt;

use d3dgen_model::Problem;
use prost::encoding::decode_varint;
use serde_json::{Map, Number, Value};

use super::forms::{EXPRESSION, Form};
use super::plan::{Count, Field, Kind, Message, Plan};
use super::wire::{self, Content};

/// Where a field stands; written only for problems: `rooms[3].polygon.corners[0].x_m`.
pub enum Place<'a> {
    Root,
    Field(&'a Place<'a>, &'a str),
    Index(&'a Place<'a>, usize),
    Key(&'a Place<'a>, &'a str),
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => Ok(()),
            Self::Field(Place::Root, name) => f.write_str(name),
            Self::Field(above, name) => write!(f, "{above}.{name}"),
            Self::Index(above, i) => write!(f, "{above}[{i}]"),
            Self::Key(above, key) => write!(f, "{above}[{key:?}]"),
        }
    }
}

type Problems = Vec<Problem>;

/// Returns a message as JSON.
pub fn message(plan: &Plan, own: &Message, bytes: &[u8], place: &Place<'_>, problems: &mut Problems) -> Value {
    let slots = slots(plan, own, bytes, place, problems);
    match own.form {
        Form::Object => {
            let mut object = Map::with_capacity(slots.len());
            for (field, slot) in own.fields.iter().zip(slots) {
                if let Some(value) = slot.or_else(|| absent(field, place, problems)) {
                    object.insert(field.key.clone(), value);
                }
            }
            Value::Object(object)
        }
        Form::Tuple => {
            let all = own.fields.iter().zip(slots);
            all.map(|(f, slot)| slot.or_else(|| absent(f, place, problems)).unwrap_or_default()).collect()
        }
        Form::List => {
            let slot = slots.into_iter().next().flatten();
            slot.or_else(|| absent(&own.fields[0], place, problems)).unwrap_or_default()
        }
        Form::Plain => match own.fields.iter().zip(slots).find_map(|(f, slot)| Some((f, slot?))) {
            Some((field, value)) if field.name == EXPRESSION.0 => {
                Value::Object(Map::from_iter([(EXPRESSION.1.to_owned(), value)]))
            }
            Some((_, value)) => value,
            None => missing(own, place, problems),
        },
        Form::Tagged(tag) => match own.fields.iter().zip(slots).find_map(|(f, slot)| Some((f, slot?))) {
            Some((field, Value::Object(inner))) => {
                let mut object = Map::from_iter([(tag.to_owned(), Value::from(field.name.as_str()))]);
                object.extend(inner);
                Value::Object(object)
            }
            _ => missing(own, place, problems),
        },
    }
}

fn missing(own: &Message, place: &Place<'_>, problems: &mut Problems) -> Value {
    let names: Vec<&str> = own.fields.iter().map(|f| f.name.as_str()).collect();
    problems.push(Problem::new(place.to_string(), format!("is empty; set one of {}", names.join(", "))));
    Value::Null
}

/// Returns what each field holds.
fn slots(
    plan: &Plan,
    own: &Message,
    mut bytes: &[u8],
    place: &Place<'_>,
    problems: &mut Problems,
) -> Vec<Option<Value>> {
    let mut slots: Vec<Option<Value>> = vec![None; own.fields.len()];
    while let Some(record) = wire::next(&mut bytes) {
        let Some((at, field)) = own.by_number(record.number) else { continue };
        let place = Place::Field(place, &field.name);
        let slot = &mut slots[at];
        match field.count {
            Count::Once | Count::Optional => *slot = Some(one(plan, field, record.content, &place, problems)),
            Count::Many => {
                let Value::Array(list) = slot.get_or_insert_with(|| Value::Array(Vec::new())) else { continue };
                match record.content {
                    // figures in a row come without a key for each
                    Content::Bytes(row) if !matches!(field.kind, Kind::String | Kind::Bytes | Kind::Message(_)) => {
                        packed(plan, field, row, &place, list, problems);
                    }
                    content => {
                        let place = Place::Index(&place, list.len());
                        list.push(one(plan, field, content, &place, problems));
                    }
                }
            }
            Count::Map => {
                let Value::Object(map) = slot.get_or_insert_with(|| Value::Object(Map::new())) else { continue };
                let Content::Bytes(entry) = record.content else { continue };
                let (key, value) = entry_of(plan, field, entry, &place, problems);
                map.insert(key, value);
            }
        }
    }
    slots
}

fn packed(
    plan: &Plan,
    field: &Field,
    mut row: &[u8],
    place: &Place<'_>,
    list: &mut Vec<Value>,
    problems: &mut Problems,
) {
    while !row.is_empty() {
        let content = if field.kind == Kind::Double {
            wire::take(&mut row, 8).and_then(|b| b.try_into().ok()).map(Content::Fixed64)
        } else {
            decode_varint(&mut row).ok().map(Content::Varint)
        };
        let Some(content) = content else { break };
        let place = Place::Index(place, list.len());
        list.push(one(plan, field, content, &place, problems));
    }
}

fn entry_of(
    plan: &Plan,
    field: &Field,
    mut entry: &[u8],
    place: &Place<'_>,
    problems: &mut Problems,
) -> (String, Value) {
    let (mut key, mut content) = (String::new(), None);
    while let Some(record) = wire::next(&mut entry) {
        match (record.number, record.content) {
            (1, Content::Bytes(bytes)) => key = String::from_utf8_lossy(bytes).into_owned(),
            (2, found) => content = Some(found),
            _ => {}
        }
    }
    let place = Place::Key(place, &key);
    let value = match content {
        Some(content) => one(plan, field, content, &place, problems),
        // an entry whose value is zero or empty
        None => match field.kind {
            Kind::Message(at) => message(plan, &plan.messages[at], &[], &place, problems),
            _ => absent(&Field { count: Count::Once, ..field.clone() }, &place, problems).unwrap_or_default(),
        },
    };
    (key, value)
}

fn one(plan: &Plan, field: &Field, content: Content<'_>, place: &Place<'_>, problems: &mut Problems) -> Value {
    match (field.kind, content) {
        (Kind::Double, Content::Fixed64(bytes)) => {
            let figure = f64::from_le_bytes(bytes);
            Number::from_f64(figure).map_or_else(
                || {
                    problems.push(Problem::new(place.to_string(), format!("is {figure}; figures are finite")));
                    Value::Null
                },
                Value::Number,
            )
        }
        (Kind::Uint, Content::Varint(n)) => n.into(),
        (Kind::Int, Content::Varint(n)) => n.cast_signed().into(),
        (Kind::Bool, Content::Varint(n)) => (n != 0).into(),
        (Kind::String, Content::Bytes(bytes)) => String::from_utf8_lossy(bytes).into_owned().into(),
        (Kind::Enum(at), Content::Varint(n)) => {
            let words = &plan.enums[at];
            let number = i32::try_from(n.cast_signed()).unwrap_or(-1);
            words.by_number.get(&number).map_or_else(
                || {
                    let known: Vec<&str> = words.by_number.values().map(String::as_str).collect();
                    let said = if number == 0 { "is not said".to_owned() } else { format!("{number} is not known") };
                    problems.push(Problem::new(place.to_string(), format!("{said}; one of {}", known.join(", "))));
                    Value::Null
                },
                |word| word.as_str().into(),
            )
        }
        (Kind::Message(at), Content::Bytes(bytes)) => message(plan, &plan.messages[at], bytes, place, problems),
        _ => {
            problems.push(Problem::new(place.to_string(), "is of another type than the contract says"));
            Value::Null
        }
    }
}

/// Returns what stands for a field that was not sent; none where its absence means something.
fn absent(field: &Field, place: &Place<'_>, problems: &mut Problems) -> Option<Value> {
    match (field.count, field.kind) {
        (Count::Optional, _) => None,
        (Count::Many, _) => Some(Value::Array(Vec::new())),
        (Count::Map, _) => Some(Value::Object(Map::new())),
        (Count::Once, Kind::Double) => Some(0.0.into()),
        (Count::Once, Kind::Uint | Kind::Int) => Some(0.into()),
        (Count::Once, Kind::Bool) => Some(false.into()),
        (Count::Once, Kind::String) => Some("".into()),
        (Count::Once, Kind::Enum(_) | Kind::Message(_) | Kind::Bytes) => {
            problems.push(Problem::new(Place::Field(place, &field.name).to_string(), "is missing"));
            None
        }
    }
}
