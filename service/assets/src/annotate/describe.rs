//! Words about an asset: what it is, how large, of what, what for and where.

use crate::annotation::Annotation;
use crate::catalog::{Catalog, CatalogObject};
use crate::words;

/// Room types named in a description at most.
const ROOMS: usize = 4;

/// Returns a few sentences; `given` comes first when somebody wrote one.
pub fn description(a: &Annotation, object: Option<&CatalogObject>, given: Option<&str>, catalog: &Catalog) -> String {
    let [width, depth, height] = a.width_depth_height();
    let mut sentences = Vec::new();
    if let Some(given) = given {
        sentences.push(given.trim().trim_end_matches('.').to_owned());
    }
    let colors: Vec<&str> = a.palette.iter().take(2).map(|s| s.name.as_str()).collect();
    let label = object.map_or_else(|| a.name.clone(), |o| o.label.clone());
    let mut look = colors.join(" and ");
    if let Some(material) = a.materials.first() {
        look = format!("{look}{}of {material}", if look.is_empty() { "" } else { ", " });
    }
    let look = if look.is_empty() { String::new() } else { format!(", {look}") };
    sentences.push(format!("{label}{look}: {} wide, {} deep, {} high", meters(width), meters(depth), meters(height)));
    if let Some(object) = object.filter(|o| !o.purpose.is_empty()) {
        sentences.push(format!("Purpose: {}", object.purpose));
    }
    if a.is_articulated() {
        let names: Vec<String> = a.joints.iter().take(4).map(|j| j.name.replace('_', " ")).collect();
        sentences.push(format!("Moving parts: {}", names.join(", ")));
    }
    let rooms: Vec<String> = a.room_types.iter().filter_map(|r| catalog.room_label(r)).map(str::to_lowercase).collect();
    if !rooms.is_empty() {
        sentences.push(format!("Belongs in: {}", rooms[..rooms.len().min(ROOMS)].join(", ")));
    }
    sentences.join(". ") + "."
}

fn meters(v: f64) -> String {
    if v < 0.1 { format!("{:.1} cm", v * 100.0) } else { format!("{v:.2} m") }
}

/// Returns a name for people: `SM_OfficeChair_01a` is `Office chair`.
pub fn title(name: &str) -> String {
    let kept: Vec<String> = words::split(name)
        .into_iter()
        .filter(|w| w.chars().count() > 1 && !w.starts_with(|c: char| c.is_ascii_digit()))
        .collect();
    let kept: Vec<&str> =
        kept.iter().map(String::as_str).filter(|w| !matches!(*w, "sm" | "sk" | "glb" | "usd")).collect();
    let text = if kept.is_empty() { name.trim().to_owned() } else { kept.join(" ") };
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
}

/// Returns an id as references write it: `hospital_bed` is `HospitalBed`.
pub fn camel(id: &str) -> String {
    let capital = |word: &str| {
        let mut chars = word.chars();
        chars.next().map_or(String::new(), |c| c.to_uppercase().chain(chars).collect())
    };
    id.split('_').map(capital).collect()
}
