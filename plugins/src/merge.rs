//! Reads the TOML files of a domain folder as one table, with what it uses of the common objects and groups.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Map, Value};

/// Key under which a domain names its objects and groups in the order in which they are considered: those that it takes of
/// the common ones, and its own.
const USE: &str = "use";

/// Key under which a domain says what rooms of one trade are in buildings of another: a checkout is a cash desk where nobody sells.
const ELSEWHERE: &str = "elsewhere";

/// Lists whose entries may be taken from the common ones.
const SHARED: [&str; 2] = ["objects", "groups"];

/// Where entries of the common lists come from, in messages.
const COMMON: &str = "domains/common";

/// The tables of a domain as one.
#[derive(Debug)]
pub struct Merged {
    /// The whole document.
    pub table: Value,
    /// The file of each entry of a list, by the key of the list.
    files: BTreeMap<String, Vec<String>>,
}

impl Merged {
    /// Returns the entry that a JSON pointer into the table leads into, as people find it: its id, and its file.
    #[allow(dead_code)] // the build script reports by panics
    pub fn place(&self, pointer: &str) -> Option<String> {
        let mut steps = pointer.split('/').skip(1);
        let (key, at) = (steps.next()?, steps.next()?.parse::<usize>().ok()?);
        let file = self.files.get(key)?.get(at)?;
        let file = file.rsplit(['/', '\\']).next().filter(|_| file != COMMON).unwrap_or(file);
        let id = self.table.get(key)?.get(at)?.get("id").and_then(Value::as_str);
        Some(id.map_or_else(|| file.to_owned(), |id| format!("`{id}` of {file}")))
    }
}

/// Returns true for a file of one kind of building, `kind_airport.toml`. Such files are merged after all others, so that a
/// domain's first program, which is that of a building of no named kind, is never one of theirs.
pub fn is_of_a_kind(file: &Path) -> bool {
    file.file_name().is_some_and(|name| name.to_string_lossy().starts_with("kind_"))
}

/// Returns `domain.toml` with every other `*.toml` of the folder merged in, in name order, those of kinds last, as [`texts`] does.
///
/// # Errors
/// The file and what is wrong with it, as text.
pub fn domain_folder(folder: &Path, common: &Value) -> Result<Merged, String> {
    let main = folder.join("domain.toml");
    if !main.is_file() {
        return Err(format!("{} does not exist; a domain folder holds a domain.toml", main.display()));
    }
    let mut all = files(folder)?;
    all.sort_by_key(|(file, _)| file != &main.display().to_string());
    let texts = texts(all.iter().map(|(file, text)| (file.as_str(), text.as_str())), common);
    texts.map_err(|(file, reason)| format!("{file}: {reason}"))
}

/// Returns the objects and groups of a folder that several domains share.
///
/// # Errors
/// The file and what is wrong with it, as text.
#[allow(dead_code)] // of the build script only
pub fn common_folder(folder: &Path) -> Result<Value, String> {
    let all = files(folder)?;
    let none = Value::Object(Map::new());
    let merged = texts(all.iter().map(|(file, text)| (file.as_str(), text.as_str())), &none);
    merged.map(|m| m.table).map_err(|(file, reason)| format!("{file}: {reason}"))
}

/// Returns the TOML files of a folder with their texts, in name order, those of kinds last.
fn files(folder: &Path) -> Result<Vec<(String, String)>, String> {
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths = entries.filter_map(Result::ok).map(|e| e.path());
    let mut files: Vec<_> = paths.filter(|p| p.extension().is_some_and(|x| x == "toml")).collect();
    files.sort_by_key(|file| (is_of_a_kind(file), file.clone()));
    let read = |file: std::path::PathBuf| {
        let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        Ok((file.display().to_string(), text))
    };
    files.into_iter().map(read).collect()
}

/// Merges the texts of files, each with its name, in their order: lists are joined, tables merged, and a plain value may be
/// given once only. What `use` names comes first in its list, in the order it is named in: as `common` has it, with the fields
/// that an entry of the domain with the same id gives, or that entry alone.
///
/// # Errors
/// The file and what is wrong with it.
pub fn texts<'a>(texts: impl Iterator<Item = (&'a str, &'a str)>, common: &Value) -> Result<Merged, (String, String)> {
    let mut whole = Map::new();
    let mut files: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut used: Vec<(String, String)> = Vec::new();
    for (file, text) in texts {
        let failed = |reason: String| (file.to_owned(), reason);
        let table: Map<String, Value> = toml::from_str(text).map_err(|e| failed(e.to_string()))?;
        for (key, value) in table {
            if key == USE {
                name_used(&value, file, &mut used).map_err(failed)?;
                continue;
            }
            if let Value::Array(entries) = &value {
                files.entry(key.clone()).or_default().extend(entries.iter().map(|_| file.to_owned()));
            }
            join(&mut whole, key, value).map_err(|key| failed(format!("`{key}` is given twice")))?;
        }
    }
    let table = Value::Object(whole);
    let is_known = |id: &str| SHARED.iter().any(|key| entry(common, key, id).or(entry(&table, key, id)).is_some());
    if let Some((id, file)) = used.iter().find(|(id, _)| !is_known(id)) {
        let reason =
            format!("`{USE}` names `{id}`, which is no object and no group, neither of {COMMON} nor of the domain");
        return Err((file.clone(), reason));
    }
    let Value::Object(mut whole) = table else { unreachable!("made above") };
    for key in SHARED {
        take(key, &used, common, &mut whole, &mut files);
    }
    if let Some(elsewhere) = whole.remove(ELSEWHERE) {
        mean_elsewhere(&elsewhere, &mut whole);
    }
    Ok(Merged { table: Value::Object(whole), files })
}

/// Adds the ids that a `use` names, with its file.
fn name_used(value: &Value, file: &str, used: &mut Vec<(String, String)>) -> Result<(), String> {
    let ids = value.as_array().ok_or_else(|| format!("`{USE}` is a list of ids of objects and groups"))?;
    for id in ids {
        let id =
            id.as_str().ok_or_else(|| format!("`{USE}` is a list of ids of objects and groups, and {id} is none"))?;
        if used.iter().any(|(known, _)| known == id) {
            return Err(format!("`{USE}` names `{id}` twice"));
        }
        used.push((id.to_owned(), file.to_owned()));
    }
    Ok(())
}

/// Returns the entry of a list with an id.
fn entry<'v>(table: &'v Value, key: &str, id: &str) -> Option<&'v Value> {
    table.get(key)?.as_array()?.iter().find(|e| has_id(e, id))
}

fn has_id(entry: &Value, id: &str) -> bool {
    entry.get("id").and_then(Value::as_str) == Some(id)
}

/// Puts the used entries of a list before the others, in their order.
fn take(
    key: &str,
    used: &[(String, String)],
    common: &Value,
    whole: &mut Map<String, Value>,
    files: &mut BTreeMap<String, Vec<String>>,
) {
    let own = whole.remove(key).unwrap_or(Value::Array(Vec::new()));
    let Value::Array(own) = own else {
        whole.insert(key.to_owned(), own);
        return;
    };
    let from = files.remove(key).unwrap_or_default();
    let mut left: Vec<(Value, String)> = own.into_iter().zip(from).collect();
    let mut all: Vec<(Value, String)> = Vec::with_capacity(left.len());
    for (id, _) in used {
        // a second one with this id stays behind, and is reported as a second one
        let told = left.iter().position(|(e, _)| has_id(e, id)).map(|at| left.remove(at));
        match (entry(common, key, id).cloned(), told) {
            (Some(Value::Object(mut base)), Some((Value::Object(fields), file))) => {
                base.extend(fields);
                all.push((Value::Object(base), file));
            }
            (_, Some(own)) => all.push(own),
            (Some(base), None) => all.push((base, COMMON.to_owned())),
            (None, None) => {}
        }
    }
    all.extend(left);
    if !all.is_empty() {
        let (entries, from): (Vec<Value>, Vec<String>) = all.into_iter().unzip();
        whole.insert(key.to_owned(), Value::Array(entries));
        files.insert(key.to_owned(), from);
    }
}

/// Gives each program that has no rooms of a trade, and does not say what it means by them, what they are elsewhere.
fn mean_elsewhere(elsewhere: &Value, whole: &mut Map<String, Value>) {
    let pairs: Vec<(&String, &Value)> = elsewhere.as_object().into_iter().flatten().collect();
    let programs = whole.get_mut("programs").and_then(Value::as_array_mut);
    for program in programs.into_iter().flatten().filter_map(Value::as_object_mut) {
        let rooms = program.get("rooms").and_then(Value::as_array).into_iter().flatten();
        let listed: Vec<String> =
            rooms.filter_map(|r| r.get("room_type").and_then(Value::as_str)).map(str::to_owned).collect();
        let means = program.entry("means").or_insert_with(|| Value::Object(Map::new()));
        let Some(means) = means.as_object_mut() else { continue };
        for (trade, own) in pairs.iter().filter(|(trade, _)| !listed.contains(trade)) {
            means.entry(trade.as_str()).or_insert_with(|| (*own).clone());
        }
    }
}

fn join(into: &mut Map<String, Value>, key: String, value: Value) -> Result<(), String> {
    match (into.get_mut(&key), value) {
        (None, value) => {
            into.insert(key, value);
        }
        (Some(Value::Array(old)), Value::Array(new)) => old.extend(new),
        (Some(Value::Object(old)), Value::Object(new)) => {
            for (key, value) in new {
                join(old, key, value)?;
            }
        }
        _ => return Err(key),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn merged(files: &[(&str, &str)]) -> Result<Merged, (String, String)> {
        let common = json!({
            "objects": [{ "id": "desk", "label": "Desk", "color": "#fff" }, { "id": "lamp", "label": "Lamp" }],
            "groups": [{ "id": "desk_place", "anchor": "desk" }],
        });
        texts(files.iter().copied(), &common)
    }

    #[test]
    fn what_is_used_comes_first_with_the_fields_that_the_domain_gives_it() {
        let main = "use = [\"lamp\", \"own\", \"desk_place\", \"desk\"]\n[[objects]]\nid = \"last\"\n[[objects]]\nid = \"own\"\n";
        let more = "[[objects]]\nid = \"desk\"\ncolor = \"#000\"\n";
        let found = merged(&[("domain.toml", main), ("a/desks.toml", more)]).unwrap();
        let objects = json!([
            { "id": "lamp", "label": "Lamp" },
            { "id": "own" },
            { "id": "desk", "label": "Desk", "color": "#000" },
            { "id": "last" },
        ]);
        assert_eq!(found.table["objects"], objects);
        assert_eq!(found.table["groups"], json!([{ "id": "desk_place", "anchor": "desk" }]));
        assert!(found.table.get(USE).is_none());
        let places = ["/objects/0", "/objects/2/color", "/objects/1", "/groups/0/anchor", "/objects/9", ""];
        let expected = [
            Some("`lamp` of domains/common"),
            Some("`desk` of desks.toml"),
            Some("`own` of domain.toml"),
            Some("`desk_place` of domains/common"),
            None,
            None,
        ];
        assert_eq!(places.map(|p| found.place(p)), expected.map(|p| p.map(str::to_owned)));
    }

    #[test]
    fn rooms_of_a_trade_are_others_where_a_program_has_none_of_them() {
        let text = "[elsewhere]\ncheckout = \"cash_desk\"\n\
            [[programs]]\nid = \"shop\"\nrooms = [{ room_type = \"checkout\" }]\n\
            [[programs]]\nid = \"bakery\"\nmeans = { checkout = \"bakery_shop\" }\nrooms = []\n\
            [[programs]]\nid = \"restaurant\"\nrooms = []\n";
        let found = merged(&[("domain.toml", text)]).unwrap();
        let means = |i: usize| found.table["programs"][i]["means"]["checkout"].clone();
        assert_eq!([means(0), means(1), means(2)], [Value::Null, json!("bakery_shop"), json!("cash_desk")]);
        assert!(found.table.get(ELSEWHERE).is_none());
    }

    #[test]
    fn a_use_of_what_is_not_there_names_the_file() {
        for (text, words) in [
            ("use = [\"sofa\"]", "`sofa`, which is no object"),
            ("use = [\"desk\", \"desk\"]", "`desk` twice"),
            ("use = \"desk\"", "is a list of ids"),
            ("use = [1]", "and 1 is none"),
        ] {
            let (file, reason) = merged(&[("domain.toml", ""), ("more.toml", text)]).unwrap_err();
            assert!(file == "more.toml" && reason.contains(words), "{file}: {reason}");
        }
    }
}
