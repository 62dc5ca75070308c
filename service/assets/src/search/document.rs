//! What the index holds of an asset.

use d3dgen_store::index::{Document, IndexSpec};

use crate::annotation::asa::mount_name;
use crate::annotation::{Annotation, Basis, Origin};
use crate::catalog::{Catalog, CatalogObject};

/// Facets to filter by.
pub const FACETS: [&str; 12] = [
    "domain",
    "room",
    "kind",
    "mount",
    "affordance",
    "color",
    "material",
    "tag",
    "object",
    "articulated",
    "origin",
    "id",
];
/// Numbers to filter by.
pub const NUMBERS: [&str; 6] = ["width", "depth", "height", "triangles", "mass", "volume"];

/// Returns the fields of the index.
pub(super) fn spec() -> IndexSpec {
    IndexSpec::default().field("name", 3.5).field("text", 1.5).facets(&FACETS).numbers(&NUMBERS)
}

/// Returns the entry of an asset.
pub fn document(key: &str, a: &Annotation, catalog: &Catalog) -> Document {
    let object = a.object.as_deref().and_then(|o| catalog.object(o));
    let join = |list: &[String]| list.join(", ").replace('_', " ");
    let name = a.asset_id.rsplit('/').next().unwrap_or_default();
    let names = object.map(|o| format!("{}, {}, {}", o.label, join(&o.names), join(&o.foreign_names)));
    let colors: Vec<String> = a.palette.iter().map(|s| s.name.clone()).collect();
    let tags = [join(&a.tags), a.kind.clone(), join(&a.affordances), join(&a.materials), join(&colors)];
    // What a description says beside a person's own words stands in the other fields; rooms are compared afterwards.
    let given = matches!(a.basis.get("description"), Some(Basis::Given)) || object.is_none();
    let description = if given { a.description.as_str() } else { "" };
    let purpose = object.map(|o| o.purpose.as_str()).unwrap_or_default();
    let [width, depth, height] = a.width_depth_height();
    let origin = match a.origin {
        Origin::Ingested { .. } => "ingested",
        Origin::Generated { .. } => "generated",
        Origin::Library { .. } => "library",
    };
    let own_name = crate::words::split(name).join(" ");
    let texts = [
        ("name", format!("{} {own_name}, {}", a.name, names.unwrap_or_default())),
        ("text", format!("{purpose}. {}. {description}", tags.join(" "))),
    ];
    let facets = [
        ("domain", a.domains.clone()),
        ("room", a.room_types.clone()),
        ("kind", vec![a.kind.clone()]),
        ("mount", vec![mount_name(a.mount).to_owned()]),
        ("affordance", a.affordances.clone()),
        ("color", colors),
        ("material", a.materials.clone()),
        (
            "tag",
            a.tags.iter().flat_map(|t| [t.clone(), t.rsplit("::").next().unwrap_or_default().to_owned()]).collect(),
        ),
        ("object", a.object.iter().cloned().collect()),
        ("articulated", vec![a.is_articulated().to_string()]),
        ("origin", vec![origin.to_owned()]),
        ("id", vec![a.asset_id.clone()]),
    ];
    let numbers = [
        ("width", width),
        ("depth", depth),
        ("height", height),
        ("triangles", a.triangle_count as f64),
        ("mass", a.mass.as_ref().map_or(f64::NAN, |m| m.mass_kg)),
        ("volume", width * depth * height),
    ];
    Document {
        key: key.to_owned(),
        texts: texts.map(|(n, t)| (n.to_owned(), t)).into(),
        facets: facets.map(|(n, v)| (n.to_owned(), v)).into(),
        numbers: numbers.map(|(n, v)| (n.to_owned(), v)).into(),
        embed_text: embed_text(a, object),
    }
}

/// Returns what the embedder reads of an asset.
pub(super) fn embed_text(a: &Annotation, object: Option<&CatalogObject>) -> String {
    match object {
        Some(o) => {
            let names: Vec<&str> = o.names.iter().take(4).map(String::as_str).collect();
            let own = if a.name == o.label { String::new() } else { format!("{}, ", a.name) };
            format!("{own}{}, {}. {}", o.label, names.join(", "), o.purpose)
        }
        None => format!("{}. {}. {}", a.name, a.tags.join(" ").replace("::", " ").replace('_', " "), a.description),
    }
}
