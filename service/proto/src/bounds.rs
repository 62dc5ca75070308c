//! How large what a client sends may be: `data/bounds.toml`, held against a message as it comes over the wire, before it
//! takes memory.
//!
//! Every string, list and bytes field has a bound, those that nobody thought of too: the contract's descriptors are walked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use prost::Message as _;
use prost::encoding::decode_varint;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorSet};
use serde::Deserialize;

use crate::FILE_DESCRIPTOR_SET;
use crate::convert::wire::{self, Content};

const TABLE: &str = include_str!("../data/bounds.toml");
/// How deep messages stand in messages at most.
const DEPTH: usize = 64;

static PLAN: LazyLock<Plan> = LazyLock::new(|| plan().0);

fn plan() -> (Plan, Vec<String>) {
    let table: Table = toml::from_str(TABLE).expect("a test reads the table");
    let contract = FileDescriptorSet::decode(FILE_DESCRIPTOR_SET).expect("the build script has written it");
    Plan::new(&table, &contract)
}

/// What is too large, or no message at all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excess {
    /// Path of the field in the request: `edits[3].lock.ids`; empty for the request itself.
    pub path: String,
    /// Size and bound.
    pub reason: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    default: Defaults,
    string: BTreeMap<String, usize>,
    bytes: BTreeMap<String, usize>,
    list: BTreeMap<String, usize>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Defaults {
    string: usize,
    bytes: usize,
    list: usize,
    entries: usize,
}

#[derive(Debug)]
struct Plan {
    entries: usize,
    /// Types that clients send.
    requests: BTreeSet<String>,
    messages: BTreeMap<String, Vec<Field>>,
}

/// A field with what bounds it.
#[derive(Debug)]
struct Field {
    number: u32,
    name: String,
    kind: Kind,
    /// Entries at most; none for one that is no list.
    list: Option<usize>,
}

#[derive(Debug)]
enum Kind {
    /// Bytes at most.
    String(usize),
    /// Bytes at most.
    Bytes(usize),
    /// Name of the type.
    Message(String),
    /// Bytes of one, when packed; none for those of varying length.
    Number(Option<usize>),
}

/// Checks a message that a client sends; types that only the server sends are not looked at.
///
/// # Errors
/// [`Excess`] for the first field beyond its bound, and for bytes that are no message.
pub fn check(full_name: &str, bytes: &[u8]) -> Result<(), Excess> {
    if !PLAN.requests.contains(full_name) {
        return Ok(());
    }
    let mut entries = 0;
    PLAN.walk(full_name, bytes, &Path::Root, 0, &mut entries)
}

/// Returns the bound of each string, bytes field and list of a message, by the field's name: bytes, or entries of a list.
pub fn of(full_name: &str) -> BTreeMap<&'static str, usize> {
    let fields = PLAN.messages.get(full_name).into_iter().flatten();
    let bound = |field: &'static Field| match (&field.kind, field.list) {
        (_, Some(list)) => Some((field.name.as_str(), list)),
        (Kind::String(most) | Kind::Bytes(most), None) => Some((field.name.as_str(), *most)),
        _ => None,
    };
    fields.filter_map(bound).collect()
}

/// Where the walk stands.
enum Path<'a> {
    Root,
    Field(&'a Path<'a>, &'a str, Option<usize>),
}

impl Path<'_> {
    fn text(&self) -> String {
        match self {
            Self::Root => String::new(),
            Self::Field(above, name, place) => {
                let mut text = above.text();
                if !text.is_empty() {
                    text.push('.');
                }
                text.push_str(name);
                if let Some(place) = place {
                    text.push_str(&format!("[{place}]"));
                }
                text
            }
        }
    }

    fn excess(&self, reason: String) -> Excess {
        Excess { path: self.text(), reason }
    }
}

impl Plan {
    /// Returns the bounds of a contract, and the entries of the table that name no field of it.
    fn new(table: &Table, contract: &FileDescriptorSet) -> (Self, Vec<String>) {
        let mut messages = BTreeMap::new();
        let mut requests = BTreeSet::new();
        let mut used = BTreeSet::new();
        for file in &contract.file {
            for message in &file.message_type {
                add(table, file.package(), message, &mut messages, &mut used);
            }
            let methods = file.service.iter().flat_map(|s| &s.method);
            requests.extend(methods.map(|m| m.input_type().trim_start_matches('.').to_owned()));
        }
        let listed = [&table.string, &table.bytes, &table.list].into_iter().flat_map(BTreeMap::keys);
        let strangers = listed.filter(|name| !used.contains(name.as_str())).cloned().collect();
        (Self { entries: table.default.entries, requests, messages }, strangers)
    }

    fn walk(
        &self,
        name: &str,
        mut bytes: &[u8],
        at: &Path<'_>,
        depth: usize,
        entries: &mut usize,
    ) -> Result<(), Excess> {
        let unreadable = || at.excess("cannot be read as the message that it should be".to_owned());
        let fields = self.messages.get(name).ok_or_else(unreadable)?;
        if depth > DEPTH {
            return Err(at.excess(format!("has messages in messages more than {DEPTH} deep")));
        }
        let mut counts = vec![0_usize; fields.len()];
        while !bytes.is_empty() {
            let record = wire::next(&mut bytes).ok_or_else(unreadable)?;
            let Ok(place) = fields.binary_search_by_key(&record.number, |f| f.number) else { continue };
            let (Some(field), Some(count)) = (fields.get(place), counts.get_mut(place)) else { continue };
            let before = *count;
            let here = Path::Field(at, &field.name, field.list.map(|_| before));
            *count += match (&field.kind, record.content) {
                (Kind::Number(width), Content::Bytes(packed)) => numbers(*width, packed).ok_or_else(unreadable)?,
                _ => 1,
            };
            match field.list {
                Some(most) => {
                    let list = Path::Field(at, &field.name, None);
                    if *count > most {
                        return Err(list.excess(format!("has more than {most} entries")));
                    }
                    *entries += *count - before;
                    if *entries > self.entries {
                        return Err(list.excess(format!("is beyond {} entries of all lists together", self.entries)));
                    }
                }
                // twice the same message would be one of both, and its lists longer than either
                None if *count > 1 && matches!(field.kind, Kind::Message(_)) => {
                    return Err(here.excess("is given twice".to_owned()));
                }
                None => {}
            }
            match (&field.kind, record.content) {
                (Kind::String(most) | Kind::Bytes(most), Content::Bytes(text)) if text.len() > *most => {
                    return Err(here.excess(format!("has {} bytes, at most {most}", text.len())));
                }
                (Kind::Message(inner), Content::Bytes(text)) => self.walk(inner, text, &here, depth + 1, entries)?,
                _ => {}
            }
        }
        Ok(())
    }
}

/// Returns how many numbers a packed field holds.
fn numbers(width: Option<usize>, mut packed: &[u8]) -> Option<usize> {
    if let Some(width) = width {
        return Some(packed.len() / width);
    }
    let mut count = 0;
    while !packed.is_empty() {
        decode_varint(&mut packed).ok()?;
        count += 1;
    }
    Some(count)
}

fn add(
    table: &Table,
    above: &str,
    message: &DescriptorProto,
    messages: &mut BTreeMap<String, Vec<Field>>,
    used: &mut BTreeSet<String>,
) {
    let full_name = format!("{above}.{}", message.name());
    let mut fields: Vec<Field> = message.field.iter().map(|f| field(table, message.name(), f, used)).collect();
    fields.sort_by_key(|f| f.number);
    for inner in &message.nested_type {
        add(table, &full_name, inner, messages, used);
    }
    messages.insert(full_name, fields);
}

fn field(table: &Table, message: &str, field: &FieldDescriptorProto, used: &mut BTreeSet<String>) -> Field {
    let mut bound = |listed: &BTreeMap<String, usize>, usual: usize| {
        let names = [format!("{message}.{}", field.name()), field.name().to_owned()];
        let found = names.into_iter().find_map(|name| Some((*listed.get(&name)?, name)));
        found.map_or(usual, |(most, name)| {
            used.insert(name);
            most
        })
    };
    let kind = match field.r#type() {
        Type::String => Kind::String(bound(&table.string, table.default.string)),
        Type::Bytes => Kind::Bytes(bound(&table.bytes, table.default.bytes)),
        Type::Message | Type::Group => Kind::Message(field.type_name().trim_start_matches('.').to_owned()),
        Type::Double | Type::Fixed64 | Type::Sfixed64 => Kind::Number(Some(8)),
        Type::Float | Type::Fixed32 | Type::Sfixed32 => Kind::Number(Some(4)),
        _ => Kind::Number(None),
    };
    let list = (field.label() == Label::Repeated).then(|| bound(&table.list, table.default.list));
    Field { number: u32::try_from(field.number()).unwrap_or_default(), name: field.name().to_owned(), kind, list }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::v1;

    fn refused(message: &impl prost::Name) -> Excess {
        let name = full_name(message);
        check(&name, &message.encode_to_vec()).expect_err("too large")
    }

    fn full_name<M: prost::Name>(_: &M) -> String {
        M::full_name()
    }

    #[test]
    fn the_table_names_fields_of_the_contract() {
        assert_eq!(plan().1, Vec::<String>::new());
        assert!(PLAN.requests.len() > 40 && PLAN.requests.contains("d3dgen.v1.AmendKnowledgeRequest"));
    }

    #[test]
    fn what_is_too_large_is_named_with_its_path() {
        use v1::world_edit::Edit;
        let ids = vec!["a".to_owned(); 10_001];
        let lock = v1::LockUpdate { ids, ..Default::default() };
        let edits = vec![v1::WorldEdit::default(), v1::WorldEdit { edit: Some(Edit::Lock(lock)) }];
        let asked = v1::EditWorldRequest { edits, ..Default::default() };
        let excess = refused(&asked);
        assert_eq!(
            (excess.path.as_str(), excess.reason.as_str()),
            ("edits[1].lock.ids", "has more than 10000 entries")
        );
        let asked = v1::ClassifyDomainRequest { room_labels: vec!["x".repeat(5 << 20)], ..Default::default() };
        assert_eq!(refused(&asked).path, "room_labels[0]");
        let companions = [("x".repeat(5 << 20), Vec::new())].into();
        assert_eq!(refused(&v1::ImportFloorplanRequest { companions, ..Default::default() }).path, "companions[0].key");
        let states = vec![1; 5 << 20];
        assert_eq!(refused(&v1::ListJobsRequest { states, ..Default::default() }).path, "states");
        // in two parts, each within its bound
        let half = |n: u32| {
            let ids = vec!["a".to_owned(); 6_000];
            let asked = v1::ConstraintRemoval { constraint_ids: ids };
            let change = Some(v1::amend_knowledge_request::Change::Removal(asked));
            v1::AmendKnowledgeRequest { domain_id: n.to_string(), change, ..Default::default() }.encode_to_vec()
        };
        let both = [half(1), half(2)].concat();
        assert_eq!(check("d3dgen.v1.AmendKnowledgeRequest", &both).expect_err("twice").path, "removal");
        assert!(check("d3dgen.v1.AmendKnowledgeRequest", &[0xff, 0xff]).is_err(), "no message");
        assert_eq!(check("d3dgen.v1.SearchConstraintsResponse", &[0xff]), Ok(()), "nothing that a client sends");
    }

    #[test]
    fn what_is_shipped_is_within_the_bounds() {
        for plugin in d3dgen_plugins::Registry::builtin().iter() {
            let asked = v1::RegisterDomainRequest {
                manifest: Some(crate::convert::to_message(plugin.domain()).expect("a message")),
                knowledge_base: Some(crate::convert::to_message(plugin.knowledge()).expect("a message")),
                ..Default::default()
            };
            let found = check("d3dgen.v1.RegisterDomainRequest", &asked.encode_to_vec());
            assert_eq!(found, Ok(()), "{}", plugin.id());
        }
    }
}
