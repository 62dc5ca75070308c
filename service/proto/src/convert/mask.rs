//! Field masks: some fields of one message put into another.

use std::collections::BTreeSet;

use d3dgen_model::Problem;
use prost::Name;
use prost::encoding::{WireType, encode_key, encode_varint};

use super::Error;
use super::plan::{Count, Field, Kind, Message, PLAN, Plan};
use super::wire::{self, Content};

/// Puts the fields named by `paths` (`pose.x_m`, `locked`) of one message into another; what the source does not have is
/// cleared.
///
/// # Errors
/// `Invalid` for a path that names no field, goes through a list, or names a field of `fixed`; for no path at all. Then
/// `target` is as before.
pub fn apply_mask<M: prost::Message + Name + Default>(
    target: &mut M,
    source: &M,
    paths: &[String],
    fixed: &[&str],
) -> Result<(), Error> {
    let invalid = |problems| Error::Invalid { message: M::NAME.to_owned(), problems };
    let mut problems = Vec::new();
    if paths.is_empty() {
        problems.push(Problem::new("update_mask", "is empty; name the fields to change"));
    }
    let mut bytes = target.encode_to_vec();
    let from = source.encode_to_vec();
    for path in paths.iter().collect::<BTreeSet<_>>() {
        let own = PLAN.message(&M::full_name());
        let steps: Vec<&str> = path.split('.').collect();
        let changed = match own {
            _ if fixed.contains(&steps[0]) => Err("cannot be changed".to_owned()),
            Some(own) => put(&PLAN, own, &bytes, &from, &steps),
            None => Err("is of no message of the contract".to_owned()),
        };
        match changed {
            Ok(changed) => bytes = changed,
            Err(reason) => problems.push(Problem::new("update_mask", format!("`{path}` {reason}"))),
        }
    }
    if !problems.is_empty() {
        return Err(invalid(problems));
    }
    *target = M::decode(bytes.as_slice()).map_err(|e| invalid(vec![Problem::new("", e.to_string())]))?;
    Ok(())
}

/// Returns the target with one field taken from the source.
fn put(plan: &Plan, own: &Message, target: &[u8], source: &[u8], steps: &[&str]) -> Result<Vec<u8>, String> {
    let field = own.by_name(steps[0]).ok_or_else(|| {
        let names: Vec<&str> = own.fields.iter().map(|f| f.name.as_str()).collect();
        format!("is no field of {}, which has {}", own.name, names.join(", "))
    })?;
    let rivals = |f: &Field| f.number != field.number && f.choice.is_some() && f.choice == field.choice;
    let mut out = Vec::new();
    let mut rest = target;
    while let Some(record) = wire::next(&mut rest) {
        let rival = own.by_number(record.number).is_some_and(|(_, f)| rivals(f));
        if record.number != field.number && !rival {
            out.extend_from_slice(record.raw);
        }
    }
    if steps.len() == 1 {
        let mut rest = source;
        while let Some(record) = wire::next(&mut rest) {
            if record.number == field.number {
                out.extend_from_slice(record.raw);
            }
        }
        return Ok(out);
    }
    let Kind::Message(at) = field.kind else { return Err(format!("goes into `{}`, which has no fields", field.name)) };
    if matches!(field.count, Count::Many | Count::Map) {
        return Err(format!("goes through the list `{}`; name the list itself", field.name));
    }
    let inner = put(plan, &plan.messages[at], &inside(target, field), &inside(source, field), &steps[1..])?;
    encode_key(field.number, WireType::LengthDelimited, &mut out);
    encode_varint(inner.len() as u64, &mut out);
    out.extend(inner);
    Ok(out)
}

/// Returns the message in a field, empty when it is not there.
fn inside(mut bytes: &[u8], field: &Field) -> Vec<u8> {
    let mut found = Vec::new();
    while let Some(record) = wire::next(&mut bytes) {
        if let (true, Content::Bytes(content)) = (record.number == field.number, record.content) {
            found.extend_from_slice(content); // messages in pieces are the pieces one after the other
        }
    }
    found
}
