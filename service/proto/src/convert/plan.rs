//! Which key of a document is which field of a message, read from the descriptors.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorSet};

use super::forms::{self, Form};

/// The plan of the whole contract.
pub static PLAN: LazyLock<Plan> = LazyLock::new(|| {
    let files = FileDescriptorSet::decode(crate::FILE_DESCRIPTOR_SET).expect("the build wrote it");
    Plan::new(&files)
});

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Double,
    Uint,
    Int,
    Bool,
    String,
    /// Not in documents.
    Bytes,
    /// Place in [`Plan::enums`].
    Enum(usize),
    /// Place in [`Plan::messages`].
    Message(usize),
}

/// How often a field occurs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// Once; a zero says nothing.
    Once,
    /// Once or not at all.
    Optional,
    /// In order.
    Many,
    /// By string keys.
    Map,
}

/// A field.
#[derive(Debug, Clone)]
pub struct Field {
    pub name: String,
    /// Key in documents.
    pub key: String,
    pub number: u32,
    pub kind: Kind,
    pub count: Count,
    /// Most that the type holds, of [`Kind::Uint`].
    pub most: u64,
    /// Place of the `oneof` it is one of.
    pub choice: Option<i32>,
}

/// A message.
#[derive(Debug, Clone)]
pub struct Message {
    pub name: String,
    pub form: Form,
    pub fields: Vec<Field>,
    by_key: BTreeMap<String, usize>,
    by_number: BTreeMap<u32, usize>,
}

/// An enum: words of documents and numbers.
#[derive(Debug, Clone)]
pub struct Words {
    pub by_word: BTreeMap<String, i32>,
    pub by_number: BTreeMap<i32, String>,
}

/// Every message and enum of the contract.
#[derive(Debug, Default)]
pub struct Plan {
    pub messages: Vec<Message>,
    pub enums: Vec<Words>,
    by_name: BTreeMap<String, usize>,
}

impl Message {
    /// Returns the field of a key with its place.
    pub fn by_key(&self, key: &str) -> Option<(usize, &Field)> {
        self.by_key.get(key).map(|at| (*at, &self.fields[*at]))
    }

    /// Returns the field with a name.
    pub fn by_name(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|f| f.name == name)
    }

    /// Returns the field of a number with its place.
    pub fn by_number(&self, number: u32) -> Option<(usize, &Field)> {
        self.by_number.get(&number).map(|at| (*at, &self.fields[*at]))
    }
}

impl Plan {
    /// Returns the message with this full name.
    pub fn message(&self, full_name: &str) -> Option<&Message> {
        self.by_name.get(full_name).map(|at| &self.messages[*at])
    }

    fn new(files: &FileDescriptorSet) -> Self {
        let mut found: Vec<(String, &DescriptorProto)> = Vec::new();
        let mut enums: Vec<(String, &EnumDescriptorProto)> = Vec::new();
        for file in &files.file {
            enums.extend(file.enum_type.iter().map(|e| (format!("{}.{}", file.package(), e.name()), e)));
            let mut open: Vec<_> =
                file.message_type.iter().map(|m| (format!("{}.{}", file.package(), m.name()), m)).collect();
            while let Some((name, message)) = open.pop() {
                open.extend(message.nested_type.iter().map(|m| (format!("{name}.{}", m.name()), m)));
                enums.extend(message.enum_type.iter().map(|e| (format!("{name}.{}", e.name()), e)));
                found.push((name, message));
            }
        }
        let places: BTreeMap<String, usize> = found.iter().enumerate().map(|(i, (n, _))| (n.clone(), i)).collect();
        let reader = Reader {
            found: &found,
            places: &places,
            enums: enums.iter().enumerate().map(|(i, (n, _))| (n.as_str(), i)).collect(),
        };
        let messages = found.iter().map(|(_, m)| reader.message(m)).collect();
        Self { messages, enums: enums.iter().map(|(_, e)| words(e)).collect(), by_name: places }
    }
}

struct Reader<'a> {
    found: &'a [(String, &'a DescriptorProto)],
    places: &'a BTreeMap<String, usize>,
    enums: BTreeMap<&'a str, usize>,
}

impl Reader<'_> {
    fn message(&self, message: &DescriptorProto) -> Message {
        let fields: Vec<Field> = message.field.iter().map(|f| self.field(f)).collect();
        Message {
            name: message.name().to_owned(),
            form: forms::of(message.name()),
            by_key: fields.iter().enumerate().map(|(i, f)| (f.key.clone(), i)).collect(),
            by_number: fields.iter().enumerate().map(|(i, f)| (f.number, i)).collect(),
            fields,
        }
    }

    fn field(&self, field: &FieldDescriptorProto) -> Field {
        let name = field.name();
        let given = field.json_name.as_deref().filter(|j| *j != camel(name));
        let mut value = field;
        let mut count = match (field.label(), field.proto3_optional()) {
            (Label::Repeated, _) => Count::Many,
            (_, true) => Count::Optional,
            _ => Count::Once,
        };
        if let Some(entry) = self.entry(field) {
            count = Count::Map;
            value = &entry.field[1];
        }
        let choice = field.oneof_index.filter(|_| !field.proto3_optional());
        if choice.is_some() {
            count = Count::Optional;
        }
        Field {
            key: given.unwrap_or(name).to_owned(),
            name: name.to_owned(),
            number: field.number().unsigned_abs(),
            kind: self.kind(value),
            count,
            most: if value.r#type() == Type::Uint32 { u32::MAX.into() } else { u64::MAX },
            choice,
        }
    }

    /// Returns the message of a map's entries, when the field is a map.
    fn entry(&self, field: &FieldDescriptorProto) -> Option<&DescriptorProto> {
        let place = self.places.get(field.type_name().trim_start_matches('.'))?;
        let entry = self.found[*place].1;
        entry.options.as_ref().is_some_and(|o| o.map_entry()).then_some(entry)
    }

    fn kind(&self, field: &FieldDescriptorProto) -> Kind {
        let name = field.type_name().trim_start_matches('.');
        match field.r#type() {
            Type::Double => Kind::Double,
            Type::Uint32 | Type::Uint64 => Kind::Uint,
            Type::Bool => Kind::Bool,
            Type::String => Kind::String,
            Type::Enum => self.enums.get(name).map_or(Kind::Bytes, |at| Kind::Enum(*at)),
            Type::Message => self.places.get(name).map_or(Kind::Bytes, |at| Kind::Message(*at)),
            Type::Int32 | Type::Int64 => Kind::Int,
            _ => Kind::Bytes,
        }
    }
}

fn words(list: &EnumDescriptorProto) -> Words {
    let prefix = list.value.first().map_or("", |v| v.name().trim_end_matches("UNSPECIFIED"));
    let said = list.value.iter().filter(|v| v.number() != 0);
    let pairs: Vec<(String, i32)> =
        said.map(|v| (forms::word(v.name().trim_start_matches(prefix)), v.number())).collect();
    Words { by_number: pairs.iter().map(|(w, n)| (*n, w.clone())).collect(), by_word: pairs.into_iter().collect() }
}

/// Returns the JSON name that protobuf gives a field by itself.
fn camel(name: &str) -> String {
    let mut out = String::new();
    let mut upper = false;
    for c in name.chars() {
        if c == '_' {
            upper = true;
        } else {
            out.push(if upper { c.to_ascii_uppercase() } else { c });
            upper = false;
        }
    }
    out
}
