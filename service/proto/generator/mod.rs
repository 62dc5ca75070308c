//! Writes the proto files of documents from their schemas, so that nothing is written by hand twice.
//!
//! Names and order come from `schemas/` and `proto/documents.toml`; the numbers of fields and values stay those of the
//! proto files there are, new ones are added behind, and those of fields that are gone are reserved.

mod numbers;
mod print;
mod types;

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use numbers::Numbers;
use types::Reader;

/// `proto/documents.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Names {
    documents: Vec<Document>,
    by_hand: BTreeMap<String, String>,
    types: BTreeMap<String, String>,
    fields: BTreeMap<String, String>,
    tuples: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    schema: String,
    file: String,
    about: String,
}

/// File of types that several documents share.
const SHARED: &str = "common";
const SHARED_ABOUT: &str = "What several documents share: geometry, materials, notes, robots.\n\nMeters, radians, seconds; x \
east, y north, z up; yaw counter-clockwise from +x.";

/// Returns the text of every proto file that belongs to documents, by file name.
///
/// # Errors
/// What cannot be read; a shape of schema that has no counterpart, with its place.
pub fn contract(workspace: &Path) -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let root = workspace.join("proto");
    let names: Names = toml::from_str(&std::fs::read_to_string(root.join("documents.toml"))?)?;
    let mut numbers = Numbers::read(&root)?;
    let mut schemas = Vec::new();
    for document in &names.documents {
        let path = workspace.join("schemas").join(format!("{}.schema.json", document.schema));
        let schema: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
        schemas.push((document, schema));
    }
    let homes = homes(&schemas);
    let mut reader = Reader { names: &names, used: BTreeSet::new() };
    let mut bodies: BTreeMap<String, (String, BTreeSet<String>)> = BTreeMap::new();
    let mut written = BTreeSet::new();
    for (_, schema) in &schemas {
        for (name, definition) in definitions(schema) {
            if names.by_hand.contains_key(name) || !written.insert(name.to_owned()) {
                continue;
            }
            let (body, imports) = bodies.entry(homes[name].clone()).or_default();
            reader.used.clear();
            let items = reader.items(name, definition)?;
            for used in &reader.used {
                // what no document defines, or is written by hand, is in the file of values
                let home = homes.get(used).filter(|_| !names.by_hand.contains_key(used));
                imports.insert(home.map_or("values", String::as_str).to_owned());
            }
            for item in items {
                body.push('\n');
                body.push_str(&print::item(&item, &mut numbers));
            }
        }
    }
    let about = |file: &str| {
        let own = names.documents.iter().find(|d| d.file == file);
        own.map_or(SHARED_ABOUT, |d| d.about.as_str())
    };
    let text = |(file, (body, imports)): (&String, &(String, BTreeSet<String>))| {
        (format!("{file}.proto"), print::file(file, about(file), imports, body))
    };
    Ok(bodies.iter().map(text).collect())
}

/// Returns the definitions of a schema, the document itself first.
fn definitions(schema: &Value) -> Vec<(&str, &Value)> {
    let title = schema["title"].as_str().unwrap_or_default();
    let parts = schema["$defs"].as_object().into_iter().flatten().map(|(name, d)| (name.as_str(), d));
    std::iter::once((title, schema)).chain(parts).collect()
}

/// Returns the file of each type: its document's own, or the shared one when several documents have it.
fn homes(schemas: &[(&Document, Value)]) -> BTreeMap<String, String> {
    let mut homes: BTreeMap<String, String> = BTreeMap::new();
    for (document, schema) in schemas {
        homes.insert(definitions(schema)[0].0.to_owned(), document.file.clone());
    }
    let roots: BTreeSet<String> = homes.keys().cloned().collect();
    for (document, schema) in schemas {
        // a document made of documents only repeats their types
        if definitions(schema)[1..].iter().any(|(name, _)| roots.contains(*name)) {
            continue;
        }
        for (name, _) in &definitions(schema)[1..] {
            let home = homes.entry((*name).to_owned()).or_insert_with(|| document.file.clone());
            if *home != document.file {
                SHARED.clone_into(home);
            }
        }
    }
    // what only a document made of documents has
    for (document, schema) in schemas {
        for (name, _) in &definitions(schema)[1..] {
            homes.entry((*name).to_owned()).or_insert_with(|| document.file.clone());
        }
    }
    homes
}
