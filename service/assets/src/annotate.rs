//! What a model is, from its geometry, its names and what lies beside it: rules, no model of language or vision.
//!
//! What it is not for: reading files, and keeping what was found.

pub mod color;
mod describe;
mod front;
mod surroundings;

use std::collections::BTreeMap;

use d3dgen_mesh::{Joint, JointKind, Model3d};
use d3dgen_model::domain::Mount;

use crate::annotation::asa::{Asa, mount_from_name};
use crate::annotation::{Annotation, Basis, Front, JointNote, Mass, Origin};
use crate::catalog::{Catalog, CatalogObject, kind_affordances, kind_density};
use crate::measure::{Map, Measured, bounds, measure};
use crate::plausibility::{Declared, Verdict, judge};
use crate::words;
pub use describe::{camel, description, title};
pub use surroundings::{Surroundings, look_around};

/// A model to annotate.
#[derive(Debug, Clone)]
pub struct Subject<'a> {
    /// Geometry, z up and in meters as the file declares.
    pub model: &'a Model3d,
    /// What the file says about itself.
    pub declared: Declared,
    /// Name of the file without its ending.
    pub stem: &'a str,
    /// What lies beside it.
    pub around: &'a Surroundings,
    /// Domain under which it is kept when nothing else tells: `Office`; none for the one it belongs in.
    pub domain: Option<&'a str>,
    /// Where it comes from.
    pub origin: Origin,
}

/// Confidence from which the name and size tell the object.
const SURE: f64 = 0.2;
/// Words of materials, in names of materials and in tags, and the word that is kept.
const MATERIALS: &[(&str, &str)] = &[
    ("wood", "wood"),
    ("wooden", "wood"),
    ("oak", "wood"),
    ("pine", "wood"),
    ("walnut", "wood"),
    ("holz", "wood"),
    ("bamboo", "wood"),
    ("metal", "metal"),
    ("steel", "metal"),
    ("iron", "metal"),
    ("aluminum", "metal"),
    ("aluminium", "metal"),
    ("chrome", "metal"),
    ("brass", "metal"),
    ("copper", "metal"),
    ("fabric", "fabric"),
    ("cloth", "fabric"),
    ("textile", "fabric"),
    ("cotton", "fabric"),
    ("carpet", "fabric"),
    ("leather", "leather"),
    ("glass", "glass"),
    ("plastic", "plastic"),
    ("ceramic", "ceramic"),
    ("porcelain", "ceramic"),
    ("stone", "stone"),
    ("marble", "stone"),
    ("granite", "stone"),
    ("paper", "paper"),
    ("cardboard", "paper"),
    ("rubber", "rubber"),
];

/// Returns what can be said about a model; none when it has no triangle.
pub fn annotate(subject: &Subject<'_>, catalog: &Catalog) -> Option<Annotation> {
    let names = names(subject);
    let as_declared = bounds(subject.model, &Map::new(|p| p, [1.0; 3]))?;
    let verdict = judge(as_declared, &subject.declared, &names, catalog);
    let map = map(subject.model, &verdict)?;
    let measured = measure(subject.model, &map);
    let mut basis = BTreeMap::new();
    let asa = subject.around.metadata.as_ref();
    let object = object(subject, &verdict, catalog, &mut basis);
    let mut note = |field: &str, how: Basis| {
        basis.insert(field.to_owned(), how);
    };
    let kind = kind(asa, object, &mut note);
    let affordances = affordances(asa, object, &kind, &mut note);
    let front = match asa.and_then(|a| a.face) {
        Some(axis) => {
            note("front", Basis::Given);
            Front { axis, found_by: "the annotation beside it".into() }
        }
        None => {
            note("front", Basis::Guessed);
            front::front(&measured, object, &affordances)
        }
    };
    let (mount, mount_height_m) = mount(asa, object, &measured, &mut note);
    let materials = materials(subject, asa, object, &mut note);
    let palette = color::palette(subject.model, &measured);
    note("palette", Basis::Measured);
    let mass = mass(subject.model, &measured, &kind, &mut note);
    note("size_m", if verdict.changes.is_empty() { Basis::Measured } else { Basis::Guessed });
    let called = subject.around.title.as_deref().unwrap_or_else(|| best_name(subject));
    let name = match asa.and_then(|a| a.name.as_deref()).map(title).filter(|n| !n.is_empty()) {
        Some(name) => name,
        None => object.map_or_else(|| title(called), |o| o.label.clone()),
    };
    let domains = domains(asa, subject, object);
    let room_types = match asa.map(|a| a.values("room").map(str::to_owned).collect::<Vec<_>>()) {
        Some(rooms) if !rooms.is_empty() => rooms,
        _ => object.map(|o| o.room_types.clone()).unwrap_or_default(),
    };
    let size = measured.size_m;
    let (hx, hy) = (size[0] / 2.0, size[1] / 2.0);
    let mut annotation = Annotation {
        version: 1,
        asset_id: asset_id(subject, &domains),
        name,
        description: String::new(),
        bounding_box_m: [[-hx, hx], [-hy, hy], [0.0, size[2]]].map(|row| row.map(rounded)),
        size_m: size.map(rounded),
        front,
        mount,
        mount_height_m,
        kind,
        object: object.map(|o| o.object_id.clone()),
        domains,
        room_types,
        tags: tags(subject, asa),
        materials,
        palette,
        affordances,
        footprint_m: measured.outline_m.iter().map(|p| p.map(rounded)).collect(),
        triangle_count: subject.model.triangle_count() as u64,
        mass,
        joints: joint_notes(&subject.model.joints),
        thumbnail: None,
        origin: subject.origin.clone(),
        model_from_file: map.rows.map(|row| row.map(|v| (v * 1e9).round() / 1e9 + 0.0)),
        basis,
        changes: verdict.changes,
    };
    let given = asa.and_then(|a| a.description.clone()).or_else(|| subject.around.description.clone());
    annotation.basis.insert("description".into(), if given.is_some() { Basis::Given } else { Basis::Guessed });
    annotation.description = description(&annotation, object, given.as_deref(), catalog);
    Some(annotation)
}

/// Returns the map onto the model frame: origin mid footprint on the underside.
fn map(model: &Model3d, verdict: &Verdict<'_>) -> Option<Map> {
    let mut map = Map::new(|p| verdict.turn.apply(p), verdict.scale);
    let [min, max] = bounds(model, &map)?;
    map.rows[0][3] = -(min[0] + max[0]) / 2.0;
    map.rows[1][3] = -(min[1] + max[1]) / 2.0;
    map.rows[2][3] = -min[2];
    Some(map)
}

/// Returns the names of a model as words, the most telling first. Names of its parts and materials are about other things
/// too, so they never say how large it is.
fn names(subject: &Subject<'_>) -> Vec<Vec<String>> {
    let given = subject.around.metadata.as_ref().and_then(|a| a.name.as_deref());
    let folders = subject.around.folders.iter().map(String::as_str);
    let title = subject.around.title.as_deref();
    let all = given
        .into_iter()
        .chain([subject.stem])
        .chain(title)
        .chain(folders)
        .chain(subject.around.description.as_deref());
    let mut names: Vec<Vec<String>> = Vec::new();
    for name in all {
        let split = words::split(name);
        if split.iter().any(|w| !words::is_beside_the_point(w)) && !names.contains(&split) {
            names.push(split);
        }
    }
    names
}

/// Returns the object that the metadata, else the name and the size say.
fn object<'c>(
    subject: &Subject<'_>,
    verdict: &Verdict<'c>,
    catalog: &'c Catalog,
    basis: &mut BTreeMap<String, Basis>,
) -> Option<&'c CatalogObject> {
    let given = subject.around.metadata.as_ref().and_then(|a| a.values("object").find_map(|id| catalog.object(id)));
    let found = given.or(verdict.object.filter(|_| verdict.confidence >= SURE));
    if found.is_some() {
        let how = if given.is_some() { Basis::Given } else { Basis::Guessed };
        basis.insert("object".into(), how);
        basis.insert("room_types".into(), how);
    }
    found
}

fn kind(asa: Option<&Asa>, object: Option<&CatalogObject>, note: &mut impl FnMut(&str, Basis)) -> String {
    if let Some(kind) = asa.and_then(|a| a.values("kind").next()) {
        note("kind", Basis::Given);
        return kind.to_owned();
    }
    note("kind", Basis::Guessed);
    object.map_or_else(|| "equipment".to_owned(), |o| o.kind.clone())
}

fn affordances(
    asa: Option<&Asa>,
    object: Option<&CatalogObject>,
    kind: &str,
    note: &mut impl FnMut(&str, Basis),
) -> Vec<String> {
    let given: Vec<String> = asa.map(|a| a.values("hoi").map(str::to_owned).collect()).unwrap_or_default();
    if !given.is_empty() {
        note("affordances", Basis::Given);
        return given;
    }
    note("affordances", Basis::Guessed);
    match object {
        Some(object) => object.affordances.clone(),
        None => kind_affordances(kind).into_iter().map(str::to_owned).collect(),
    }
}

/// Returns where it is fixed: given, as the catalog says, else by its build.
fn mount(
    asa: Option<&Asa>,
    object: Option<&CatalogObject>,
    m: &Measured,
    note: &mut impl FnMut(&str, Basis),
) -> (Mount, Option<f64>) {
    if let Some(mount) = asa.and_then(|a| a.values("mount").find_map(mount_from_name)) {
        note("mount", Basis::Given);
        return (mount, object.filter(|o| o.mount == mount).and_then(|o| o.mount_height_m));
    }
    note("mount", Basis::Guessed);
    if let Some(object) = object {
        return (object.mount, object.mount_height_m);
    }
    let [x, y, z] = m.size_m;
    let thin = x.min(y) < 0.12 && z > 4.0 * x.min(y) && x.max(y) > 3.0 * x.min(y);
    match () {
        () if thin && z < 1.6 => (Mount::Wall, Some(1.2)),
        () if x.max(y) < 0.5 && z < 0.5 => (Mount::Surface, None),
        () => (Mount::Floor, None),
    }
}

fn materials(
    subject: &Subject<'_>,
    asa: Option<&Asa>,
    object: Option<&CatalogObject>,
    note: &mut impl FnMut(&str, Basis),
) -> Vec<String> {
    let given: Vec<String> = asa.map(|a| a.values("material").map(str::to_owned).collect()).unwrap_or_default();
    if !given.is_empty() {
        note("materials", Basis::Given);
        return given;
    }
    note("materials", Basis::Guessed);
    let used = subject.model.bodies.iter().flat_map(|b| &b.visuals).filter_map(|v| v.material);
    let used: std::collections::BTreeSet<usize> = used.collect();
    let mut found: Vec<String> = Vec::new();
    let mut add = |word: &str| {
        if !found.iter().any(|f| f == word) {
            found.push(word.to_owned());
        }
    };
    for material in used.iter().filter_map(|i| subject.model.materials.get(*i)) {
        for word in words::split(&material.name) {
            MATERIALS.iter().filter(|(name, _)| *name == word).for_each(|(_, kept)| add(kept));
        }
        if material.metallic > 0.5 {
            add("metal");
        }
        if material.opacity < 0.5 {
            add("glass");
        }
    }
    if let (true, Some(object)) = (found.is_empty(), object) {
        found.push(object.material.clone());
    }
    found
}

/// Returns mass and inertia: of the model when it has one, else as such things usually weigh, spread over the surface.
fn mass(model: &Model3d, m: &Measured, kind: &str, note: &mut impl FnMut(&str, Basis)) -> Option<Mass> {
    let box_m3: f64 = m.size_m.iter().map(|s| s.max(0.01)).product();
    if m.area_m2 <= 0.0 {
        return None;
    }
    let own: f64 = model.bodies.iter().map(|b| b.mass_kg).filter(|v| v.is_finite() && *v > 0.0).sum();
    note("mass", if own > 0.0 { Basis::Given } else { Basis::Guessed });
    let mass_kg = if own > 0.0 { own } else { (box_m3 * kind_density(kind)).max(0.01) };
    let [xx, yy, zz, xy, xz, yz] = m.moments_m2.map(|v| v * mass_kg);
    let inertia = [yy + zz, xx + zz, xx + yy, -xy, -xz, -yz];
    Some(Mass {
        mass_kg: significant(mass_kg),
        center_m: m.center_m.map(rounded),
        inertia_kg_m2: inertia.map(significant),
        density_kg_m3: significant(mass_kg / box_m3),
    })
}

/// Returns what is told of the joints of a model.
pub fn joint_notes(joints: &[Joint]) -> Vec<JointNote> {
    let kind = |k: JointKind| match k {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
        JointKind::Continuous => "continuous",
    };
    let note = |j: &Joint| JointNote { name: j.name.clone(), kind: kind(j.kind).into(), limits: j.limits };
    joints.iter().map(note).collect()
}

/// Returns the domains it belongs in: given, then those of the object.
fn domains(asa: Option<&Asa>, subject: &Subject<'_>, object: Option<&CatalogObject>) -> Vec<String> {
    let given: Vec<String> = asa.map(|a| a.values("domain").map(str::to_owned).collect()).unwrap_or_default();
    if !given.is_empty() {
        return given;
    }
    match object {
        Some(object) => object.domains.clone(),
        None => subject.domain.map(str::to_lowercase).into_iter().collect(),
    }
}

/// Returns `Domain/Name`: the domain asked for, that of the metadata or the folder, else `Common`.
fn asset_id(subject: &Subject<'_>, domains: &[String]) -> String {
    let asa = subject.around.metadata.as_ref();
    let given = asa.and_then(|a| a.values("domain").next());
    let folder = subject.around.folders.iter().rev().flat_map(|f| words::split(f)).find(|w| domains.contains(w));
    let domain = subject.domain.map(str::to_owned).or(given.map(camel)).or(folder.map(|f| camel(&f)));
    let domain = domain.map(|d| safe(&d)).filter(|d| !d.is_empty()).unwrap_or_else(|| "Common".into());
    let name = asa.and_then(|a| a.name.as_deref()).unwrap_or_else(|| best_name(subject));
    let name = Some(safe(name)).filter(|n| !n.is_empty()).unwrap_or_else(|| "Model".into());
    format!("{domain}/{name}")
}

/// Returns the name of the file, or of its folder where that says nothing.
fn best_name<'a>(subject: &'a Subject<'_>) -> &'a str {
    let tells = |name: &&str| words::split(name).iter().any(|w| !words::is_beside_the_point(w));
    let folders = subject.around.folders.iter().map(String::as_str);
    [subject.stem].into_iter().chain(folders).find(tells).unwrap_or(subject.stem)
}

/// Returns a text with nothing but letters, digits and single underscores.
fn safe(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            'a'..='z' | 'A'..='Z' | '0'..='9' => out.push(c),
            _ if out.ends_with('_') => {}
            _ => out.push('_'),
        }
    }
    out.trim_matches('_').chars().take(80).collect()
}

/// Returns further tags: those of the metadata, else the words of the name.
fn tags(subject: &Subject<'_>, asa: Option<&Asa>) -> Vec<String> {
    const OWN_FIELDS: &[&str] = &["domain", "kind", "mount", "hoi", "material", "room", "object"];
    let mut tags: Vec<String> = Vec::new();
    let mut add = |tag: String| {
        if !tags.contains(&tag) {
            tags.push(tag);
        }
    };
    for (key, value) in asa.into_iter().flat_map(|a| &a.tags).filter(|(key, _)| !OWN_FIELDS.contains(&key.as_str())) {
        add(if key.is_empty() { value.clone() } else { format!("{key}::{value}") });
    }
    for word in words::split(best_name(subject)) {
        if word.chars().count() > 2 && !word.starts_with(|c: char| c.is_ascii_digit()) {
            add(word);
        }
    }
    tags
}

fn rounded(v: f64) -> f64 {
    (v * 1e6).round() / 1e6 + 0.0
}

/// Returns a figure with four digits that count.
pub(crate) fn significant(v: f64) -> f64 {
    if v == 0.0 || !v.is_finite() {
        return 0.0;
    }
    let scale = 10f64.powi(3 - v.abs().log10().floor() as i32);
    (v * scale).round() / scale
}

#[cfg(test)]
mod tests;
