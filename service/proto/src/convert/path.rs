//! From a place in a document to the place in its message.

use prost::Name;

use super::forms::Form;
use super::plan::{Count, Field, Kind, Message, PLAN};

/// Returns the path of a field for a JSON pointer into the document: `/rooms/3/area_range_m2/0` is
/// `rooms[3].area_range_m2.min_m2` in a `SceneGraph`. Steps that the message does not know stay as they are.
pub fn field_path<M: Name>(pointer: &str) -> String {
    let mut path = String::new();
    let mut at = PLAN.message(&M::full_name()).map_or(Here::Lost, Here::In);
    for step in pointer.split('/').skip(1) {
        let step = step.replace("~1", "/").replace("~0", "~");
        at = at.step(&step, &mut path);
    }
    path
}

#[derive(Clone, Copy)]
enum Here<'a> {
    In(&'a Message),
    /// In a list or map of a field.
    Among(&'a Field),
    Lost,
}

impl<'a> Here<'a> {
    fn step(self, step: &str, path: &mut String) -> Self {
        match self {
            Self::In(message) => Self::field(message, step, path),
            Self::Among(field) => {
                match field.count {
                    Count::Map => path.push_str(&format!("[{step:?}]")),
                    _ => path.push_str(&format!("[{step}]")),
                }
                Self::inside(field)
            }
            Self::Lost => {
                name(step, path);
                Self::Lost
            }
        }
    }

    fn field(message: &'a Message, step: &str, path: &mut String) -> Self {
        let place = step.parse::<usize>().ok();
        let field = match message.form {
            Form::Object => message.by_key(step).map(|(_, f)| f),
            Form::Tuple => place.and_then(|i| message.fields.get(i)),
            Form::List => {
                name(&message.fields[0].name, path);
                return Self::Among(&message.fields[0]).step(step, path);
            }
            Form::Plain => {
                let arm = match (step, place) {
                    ("expr", _) => {
                        name("expression", path);
                        return Self::Lost;
                    }
                    ("min" | "max", _) => "range",
                    (_, Some(_)) => "list",
                    _ => "table",
                };
                let Some(arm) = message.by_name(arm) else { return Self::Lost };
                name(&arm.name, path);
                return Self::inside(arm).step(step, path);
            }
            Form::Tagged(_) => None,
        };
        let Some(field) = field else {
            name(step, path);
            return Self::Lost;
        };
        name(&field.name, path);
        match field.count {
            Count::Many | Count::Map => Self::Among(field),
            _ => Self::inside(field),
        }
    }

    fn inside(field: &Field) -> Self {
        if let Kind::Message(at) = field.kind { Self::In(&PLAN.messages[at]) } else { Self::Lost }
    }
}

fn name(name: &str, path: &mut String) {
    if !path.is_empty() {
        path.push('.');
    }
    path.push_str(name);
}
