//! Reads the TOML files of a domain folder as one table.

use std::path::Path;

use serde_json::{Map, Value};

/// Returns `domain.toml` with every other `*.toml` of the folder merged in, in name order: lists are joined, tables
/// merged, and a plain value may be given once only.
///
/// # Errors
/// The file and what is wrong with it, as text.
pub fn domain_folder(folder: &Path) -> Result<Value, String> {
    let main = folder.join("domain.toml");
    if !main.is_file() {
        return Err(format!("{} does not exist; a domain folder holds a domain.toml", main.display()));
    }
    let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<_> = entries
        .filter_map(Result::ok)
        .map(|e| e.path())
        .filter(|p| *p != main && p.extension().is_some_and(|x| x == "toml"))
        .collect();
    files.sort();
    let mut all = Vec::new();
    for file in std::iter::once(main).chain(files) {
        let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        all.push((file.display().to_string(), text));
    }
    texts(all.iter().map(|(file, text)| (file.as_str(), text.as_str())))
        .map_err(|(file, reason)| format!("{file}: {reason}"))
}

/// Merges the texts of files, each with its name, in their order.
///
/// # Errors
/// The file and what is wrong with it.
pub fn texts<'a>(files: impl Iterator<Item = (&'a str, &'a str)>) -> Result<Value, (String, String)> {
    let mut whole = Map::new();
    for (file, text) in files {
        let failed = |reason: String| (file.to_owned(), reason);
        let table: Map<String, Value> = toml::from_str(text).map_err(|e| failed(e.to_string()))?;
        for (key, value) in table {
            join(&mut whole, key, value).map_err(|key| failed(format!("`{key}` is given twice")))?;
        }
    }
    Ok(Value::Object(whole))
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
