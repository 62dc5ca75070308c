//! Model folders of simulators: which files of a tree are parts of such models, and so no assets of their own.
//!
//! An SDF model is one asset, of what it shows. The meshes it names, to be seen or to collide, are its parts wherever they
//! lie; so is every other model file in its folder, unless a folder below holds a model itself.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use roxmltree::{Document, ParsingOptions};

use crate::readers::{Folder, sdf};
use crate::words;

/// Larger files are looked at by the reader alone, bytes.
const LARGEST: u64 = 16 << 20;
/// Words that name what only collides.
const SHAPES: &[&str] = &["collision", "collisions", "collider", "colliders", "collide"];
/// The same of what is seen, and words that say nothing of either.
const LOOKS: &[&str] = &["visual", "visuals", "mesh", "meshes", "model", "body"];

/// Takes the files out of a list of models that are parts of others, and returns those that are left out with a word.
pub(super) fn leave_parts_out(root: &Path, models: &mut Vec<(String, PathBuf)>) -> Vec<(String, String)> {
    let sdfs: Vec<(String, PathBuf)> = models.iter().filter(|(path, _)| is_sdf(path)).cloned().collect();
    let mut dropped: BTreeSet<String> = BTreeSet::new();
    let by_file: BTreeMap<PathBuf, &str> =
        models.iter().filter_map(|(path, file)| Some((file.canonicalize().ok()?, path.as_str()))).collect();
    let mut packages: BTreeSet<String> = BTreeSet::new();
    for (path, file) in &sdfs {
        let Some(folder) = file.parent() else { continue };
        let config = config(folder);
        let name = file_name(path);
        let main = config.sdf.clone().filter(|f| folder.join(f).is_file());
        let is_main = main.as_deref().map_or(name == "model.sdf", |m| m == name);
        if is_older(name, main.as_deref(), &config, folder) || !holds_model(file) {
            dropped.insert(path.clone());
        } else {
            if is_main {
                packages.insert(folder_of(path).to_owned());
            }
            let named = meshes(file, root).into_iter().filter_map(|f| by_file.get(&f));
            dropped.extend(named.map(|p| (*p).to_owned()));
        }
    }
    for (path, _) in models.iter().filter(|(path, _)| !is_sdf(path)) {
        if ancestors(folder_of(path)).any(|folder| packages.contains(folder)) {
            dropped.insert(path.clone());
        }
    }
    let shapes = shapes(models.iter().map(|(path, _)| path.as_str()).filter(|p| !dropped.contains(*p)));
    models.retain(|(path, _)| !dropped.contains(path) && !shapes.contains_key(path));
    let reason = |seen: String| format!("is what collides of {seen}: shapes are no assets");
    shapes.into_iter().map(|(path, seen)| (path, reason(seen))).collect()
}

fn is_sdf(path: &str) -> bool {
    path.to_lowercase().ends_with(".sdf")
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// Returns the folder of a path, empty for the top.
fn folder_of(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Returns a folder and those above it, the top last.
fn ancestors(folder: &str) -> impl Iterator<Item = &str> {
    std::iter::successors(Some(folder), |f| (!f.is_empty()).then(|| folder_of(f)))
}

fn config(folder: &Path) -> sdf::Config {
    read(&folder.join("model.config")).map(|text| sdf::config_of(&text)).unwrap_or_default()
}

/// Tells whether a file is a model in the form of an older version of the format, beside the current one.
fn is_older(name: &str, main: Option<&str>, config: &sdf::Config, folder: &Path) -> bool {
    let listed = main.is_some_and(|main| main != name) && config.all.iter().any(|f| f == name);
    let version = name.strip_prefix("model").and_then(|rest| rest.strip_suffix(".sdf")).unwrap_or_default();
    let numbered =
        version.starts_with(['-', '_']) && version[1..].chars().all(|c| c.is_ascii_digit() || "._-".contains(c));
    listed || numbered && (main.is_some_and(|m| m != name) || folder.join("model.sdf").is_file())
}

/// Tells whether a file may be a model: worlds and files with lights alone are none. What cannot be read is left to the
/// reader, which says why.
fn holds_model(file: &Path) -> bool {
    let Some(text) = read(file) else { return true };
    let Some(document) = parsed(&text) else { return true };
    let root = document.root_element();
    let other = ["world", "light", "actor", "state"];
    root.has_tag_name("model")
        || root.children().any(|n| n.has_tag_name("model"))
        || !root.children().any(|n| other.contains(&n.tag_name().name()))
}

/// Returns the meshes that an SDF file names, to be seen or to collide.
fn meshes(file: &Path, root: &Path) -> Vec<PathBuf> {
    let Some(text) = read(file) else { return Vec::new() };
    let Some(document) = parsed(&text) else { return Vec::new() };
    let Ok((folder, _)) = Folder::of(file, Some(root)) else { return Vec::new() };
    let uris = document.descendants().filter(|n| n.has_tag_name("mesh"));
    let uris = uris.filter_map(|n| n.children().find(|c| c.has_tag_name("uri"))?.text());
    uris.filter_map(|uri| folder.resolve(&sdf::located(&folder, uri.trim())?)).collect()
}

fn parsed(text: &str) -> Option<Document<'_>> {
    Document::parse_with_options(text, ParsingOptions { nodes_limit: 1_000_000, ..ParsingOptions::default() }).ok()
}

fn read(file: &Path) -> Option<String> {
    let meta = std::fs::symlink_metadata(file).ok()?;
    let bytes = (meta.is_file() && meta.len() <= LARGEST).then(|| std::fs::read(file).ok()).flatten()?;
    Some(sdf::text(&bytes))
}

/// Returns the files that by their names are what collides of another file, which is seen, each with that one:
/// `chair_collision.stl` beside `chair.dae`, `collision/chair.stl` beside `visual/chair.dae`.
fn shapes<'p>(paths: impl Iterator<Item = &'p str> + Clone) -> BTreeMap<String, String> {
    let mut seen: BTreeMap<(Vec<String>, Vec<String>), &str> = BTreeMap::new();
    for path in paths.clone().filter(|p| !is_shape(p)) {
        seen.entry(subject(path)).or_insert(path);
    }
    let shapes = paths.filter(|p| is_shape(p));
    shapes.filter_map(|path| Some((path.to_owned(), (*seen.get(&subject(path))?).to_owned()))).collect()
}

fn stem_words(path: &str) -> Vec<String> {
    let name = file_name(path);
    words::split(name.rsplit_once('.').map_or(name, |(stem, _)| stem))
}

fn is_shape(path: &str) -> bool {
    let of = |words: Vec<String>| words.iter().any(|w| SHAPES.contains(&w.as_str()));
    of(stem_words(path)) || of(words::split(file_name(folder_of(path))))
}

/// Returns what a path is about: the words of the folder and of the name, without those of looks and shapes.
fn subject(path: &str) -> (Vec<String>, Vec<String>) {
    let told = |w: &String| !SHAPES.contains(&w.as_str()) && !LOOKS.contains(&w.as_str());
    let folders = folder_of(path).split('/').filter(|f| words::split(f).iter().any(told)).map(str::to_owned).collect();
    (folders, stem_words(path).into_iter().filter(told).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(files: &[(&str, &str)]) -> (Vec<String>, Vec<(String, String)>) {
        let home = tempfile::tempdir().expect("a folder");
        let mut models = Vec::new();
        for (path, text) in files {
            let file = home.path().join(path);
            std::fs::create_dir_all(file.parent().expect("a folder")).expect("made");
            std::fs::write(&file, text).expect("written");
            if !path.ends_with(".config") {
                models.push(((*path).to_owned(), file));
            }
        }
        let refused = leave_parts_out(home.path(), &mut models);
        (models.into_iter().map(|m| m.0).collect(), refused)
    }

    #[test]
    fn a_model_folder_is_one_asset_and_what_it_names_is_none() {
        let sdf = |uri: &str| {
            format!(
                "<sdf><model name='m'><link name='l'><visual name='v'><geometry><mesh><uri>{uri}</uri></mesh></geometry></visual></link></model></sdf>"
            )
        };
        let (desk, lamp) = (sdf("model://desk/meshes/a.dae"), sdf("model://shared/lamp.dae"));
        let world = "<sdf><world name='w'><model name='m'/></world></sdf>";
        let config = "<model><sdf version='1.4'>model-1_4.sdf</sdf><sdf version='1.6'>desk.sdf</sdf></model>";
        let (models, refused) = left(&[
            ("desk/model.config", config),
            ("desk/desk.sdf", &desk),
            ("desk/model-1_4.sdf", &desk),
            ("desk/meshes/a.dae", "x"),
            ("desk/meshes/hull.stl", "x"),
            ("desk/extra/desk.usdz", "x"),
            ("lamps/lamp.sdf", &lamp),
            ("lamps/other.glb", "x"),
            ("shared/lamp.dae", "x"),
            ("shared/vase.dae", "x"),
            ("worlds/office.sdf", world),
            ("broken/model.sdf", "<sdf"),
        ]);
        assert_eq!(
            models,
            ["desk/desk.sdf", "lamps/lamp.sdf", "lamps/other.glb", "shared/vase.dae", "broken/model.sdf"]
        );
        assert_eq!(refused, []);
    }

    #[test]
    fn shapes_beside_what_is_seen_are_no_assets() {
        let (models, refused) = left(&[
            ("a/chair.dae", "x"),
            ("a/chair_collision.stl", "x"),
            ("b/visual/bed.dae", "x"),
            ("b/collision/bed.stl", "x"),
            ("c/collision_test_dummy.glb", "x"),
        ]);
        assert_eq!(models, ["a/chair.dae", "b/visual/bed.dae", "c/collision_test_dummy.glb"]);
        let paths: Vec<&str> = refused.iter().map(|r| r.0.as_str()).collect();
        assert_eq!(paths, ["a/chair_collision.stl", "b/collision/bed.stl"]);
        assert!(refused[0].1.contains("a/chair.dae"), "{refused:?}");
    }
}
