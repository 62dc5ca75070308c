//! What the tests of this crate share: the catalog of the shipped domains, read from their folders.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use d3dgen_model::domain::Domain;

use crate::catalog::Catalog;

/// Names of the shipped domains, in their order.
const SHIPPED: [&str; 6] = ["residential", "office", "hospital", "school", "warehouse", "general"];

/// Returns the shipped domains.
pub fn domains() -> &'static [Domain] {
    static DOMAINS: OnceLock<Vec<Domain>> = OnceLock::new();
    DOMAINS.get_or_init(|| SHIPPED.iter().map(|id| read(id)).collect())
}

/// Returns the catalog of the shipped domains.
pub fn catalog() -> &'static Catalog {
    static CATALOG: OnceLock<Catalog> = OnceLock::new();
    CATALOG.get_or_init(|| Catalog::new(domains()))
}

fn read(id: &str) -> Domain {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../domains").join(id);
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder).expect("shipped").flatten().map(|e| e.path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    files.sort();
    let mut whole = serde_json::Map::new();
    for file in files {
        let text = std::fs::read_to_string(&file).expect("readable");
        let table: serde_json::Map<String, serde_json::Value> = toml::from_str(&text).expect("TOML");
        for (key, value) in table {
            match (whole.get_mut(&key), value) {
                (Some(serde_json::Value::Array(list)), serde_json::Value::Array(more)) => list.extend(more),
                (_, value) => drop(whole.insert(key, value)),
            }
        }
    }
    whole.remove("builds");
    serde_json::from_value(whole.into()).unwrap_or_else(|e| panic!("{id}: {e}"))
}
