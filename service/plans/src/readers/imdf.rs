//! IMDF (Apple's indoor mapping format): a zip or a folder with a GeoJSON file for each type of feature.
//!
//! Units are rooms, openings doors; outlines of levels and the venue are no rooms, fixtures and kiosks no building. Occupants
//! name the units that their anchors lie in.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::sync::LazyLock;

use serde::Deserialize;
use serde_json::Value;

use super::geojson::{self, Feature};
use super::source::{MOST_BYTES, Plan, Reader, Source};
use crate::drawing::{Drawing, note};
use crate::error::Error;
use crate::options::Options;
use crate::words::{Role, role};

pub(super) const READER: Reader = Reader { name: "imdf", title: "IMDF venue (zip, or its folder)", recognizes, read };

const FORMAT: &str = "imdf";
/// The file that every venue has, beside those of its features.
const MANIFEST: &str = "manifest.json";
/// The file without which there is no plan.
const UNITS: &str = "unit";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Words {
    /// What a feature type is.
    features: BTreeMap<String, String>,
    /// What the category of a unit says of its room.
    units: BTreeMap<String, String>,
}

static WORDS: LazyLock<Words> = LazyLock::new(|| {
    toml::from_str(include_str!("../../data/imdf.toml")).expect("data/imdf.toml is shipped and tested")
});

fn recognizes(source: &Source) -> bool {
    source.bytes.starts_with(b"PK\x03\x04") && !source.has_ending(&[".ifczip"]) || source.has_ending(&[MANIFEST])
}

fn read(source: &Source, options: &Options) -> Result<Plan, Error> {
    let types = WORDS.features.keys().filter(|t| t.as_str() != "relationship");
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    if source.bytes.starts_with(b"PK") {
        let broken = |e: zip::result::ZipError| Error::broken(FORMAT, source.name, e.to_string());
        let mut archive = zip::ZipArchive::new(Cursor::new(source.bytes)).map_err(broken)?;
        let names: Vec<String> = archive.file_names().map(str::to_owned).collect();
        for kind in types {
            let file = format!("{kind}.geojson");
            let Some(name) = names.iter().find(|n| n.rsplit('/').next() == Some(&file)) else { continue };
            let mut bytes = Vec::new();
            let entry = archive.by_name(name).map_err(broken)?;
            entry
                .take(MOST_BYTES as u64 + 1)
                .read_to_end(&mut bytes)
                .map_err(|e| Error::broken(FORMAT, name, e.to_string()))?;
            if bytes.len() > MOST_BYTES {
                return Err(Error::broken(FORMAT, name, format!("is larger than {} MiB", MOST_BYTES >> 20)));
            }
            files.push((kind.clone(), bytes));
        }
    } else {
        let found = types.filter_map(|kind| Some((kind.clone(), (source.companion)(&format!("{kind}.geojson"))?)));
        files.extend(found);
    }
    if !files.iter().any(|(kind, _)| kind == UNITS) {
        let message =
            "has no unit.geojson; a venue of IMDF has one file for each type of feature, with this one for its rooms";
        return Err(Error::broken(FORMAT, source.name, message));
    }
    let mut features = Vec::new();
    for (kind, bytes) in files {
        let name = format!("{kind}.geojson");
        let text = std::str::from_utf8(&bytes)
            .map_err(|e| Error::broken(FORMAT, &name, format!("byte {} is no UTF-8 text", e.valid_up_to())))?;
        let mut own = geojson::collection(text.trim_start_matches('\u{feff}')).map_err(|e| e.in_file(FORMAT, &name))?;
        own.features.iter_mut().for_each(|f| f.feature_type.get_or_insert_with(|| kind.clone()).truncate(40));
        features.append(&mut own.features);
    }
    let mut drawing = Drawing { titles: titles(&features), ..Drawing::default() };
    prepare(&mut features, &mut drawing);
    geojson::draw(&mut drawing, &features, options)?;
    geojson::project(&mut drawing, None, options);
    Ok(Plan::Drawing(drawing))
}

/// Returns the names of the venue and its buildings.
fn titles(features: &[Feature]) -> Vec<String> {
    let of = |f: &&Feature| matches!(f.feature_type.as_deref(), Some("venue" | "building"));
    features.iter().filter(of).filter_map(|f| geojson::text_of(f.properties.as_ref()?, &["name"])).collect()
}

/// Says in the properties of features what their types and categories mean, on which storey they are, and who is in them.
pub(super) fn prepare(features: &mut [Feature], drawing: &mut Drawing) {
    let levels = levels(features);
    let names = names_by_unit(features);
    if levels.len() > 1 {
        let list: Vec<String> = levels.values().map(|(ordinal, name)| format!("{ordinal} is `{name}`")).collect();
        drawing.notes.push(note("level_names", format!("levels go by their ordinals: {}", list.join(", "))));
    }
    for feature in features {
        let Some(kind) = feature.feature_type.clone() else { continue };
        let id = feature.id();
        let properties = feature.properties.get_or_insert_default();
        let category = properties.remove("category").and_then(|c| c.as_str().map(str::to_owned)).unwrap_or_default();
        let mut word = WORDS.features.get(&kind).cloned().unwrap_or_else(|| kind.clone());
        if kind == UNITS {
            let room = room_of(&category);
            // a unit may be no room: a column, or open to the floor below
            word = if role(&room).is_some_and(|r| r != Role::Room) { room.clone() } else { word };
            properties.insert("room".into(), room.into());
            let own = properties.get("name").is_some_and(|n| !n.is_null());
            let name = id.as_ref().and_then(|id| names.get(id)).filter(|_| !own);
            properties.extend(name.map(|n| ("name".to_owned(), n.clone())));
        }
        properties.insert("feature_type".into(), word.into());
        let level = properties.get("level_id").and_then(Value::as_str).and_then(|id| levels.get(id));
        match level.filter(|_| levels.len() > 1) {
            Some((ordinal, _)) => properties.insert("level".into(), ordinal.to_string().into()),
            None => properties.remove("level_id"),
        };
    }
}

/// Returns what the category of a unit says of its room.
fn room_of(category: &str) -> String {
    let first = category.split('.').next().unwrap_or_default();
    let known = WORDS.units.get(category).or_else(|| WORDS.units.get(first));
    known.cloned().unwrap_or_else(|| first.to_owned())
}

/// Returns ordinals and names of levels by their ids.
fn levels(features: &[Feature]) -> BTreeMap<String, (i64, String)> {
    let level = |f: &Feature| {
        let properties = f.properties.as_ref()?;
        let ordinal = properties.get("ordinal").and_then(Value::as_f64)?;
        let name = geojson::text_of(properties, &["name", "short_name"]).unwrap_or_default();
        Some((f.id()?, (ordinal as i64, name)))
    };
    features.iter().filter(|f| f.feature_type.as_deref() == Some("level")).filter_map(level).collect()
}

/// Returns the names of occupants by the units that their anchors lie in.
fn names_by_unit(features: &[Feature]) -> BTreeMap<String, Value> {
    let text = |f: &Feature, key: &str| f.properties.as_ref()?.get(key)?.as_str().map(str::to_owned);
    let of = |kind: &'static str| features.iter().filter(move |f| f.feature_type.as_deref() == Some(kind));
    let anchors: BTreeMap<String, String> = of("anchor").filter_map(|f| Some((f.id()?, text(f, "unit_id")?))).collect();
    let named = |f: &Feature| {
        let unit = anchors.get(&text(f, "anchor_id")?)?.clone();
        Some((unit, f.properties.as_ref()?.get("name").filter(|n| !n.is_null())?.clone()))
    };
    of("occupant").filter_map(named).collect()
}
