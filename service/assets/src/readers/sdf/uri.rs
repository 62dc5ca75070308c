//! Where the files are that a model names: `model://NAME/path` and its relatives, found by walking upward.
//!
//! Simulators find NAME on paths of their own environment. Here it is looked for in the folders around the model, which
//! hold it in every package of models: the model's own folder, those above it, and what lies beside these.

use roxmltree::Document;

use super::words;
use crate::readers::folder::Folder;

/// The largest `model.config`.
const MAX_CONFIG_BYTES: u64 = 1 << 20;
/// Folders of models within a package, as packages name them.
const SHELVES: &[&str] = &["", "models/"];

/// What a `model.config` says.
#[derive(Debug, Default, PartialEq)]
pub struct Config {
    /// Name of the model.
    pub name: Option<String>,
    /// The model's SDF file: that of the newest version, where there are several.
    pub sdf: Option<String>,
    /// All SDF files of the model.
    pub all: Vec<String>,
}

/// Returns the path of a file, relative to a folder, that a URI names; none when it is not there or may not be read.
pub fn located(folder: &Folder, uri: &str) -> Option<String> {
    of_name(folder, uri).or_else(|| {
        // A model downloaded under another name, or in a folder of its version, is still in the folder of its SDF.
        let own = candidates(folder, uri, true);
        let other = decoded(uri).map(|uri| candidates(folder, &uri, true)).unwrap_or_default();
        own.into_iter().chain(other).find(|path| folder.resolve(path).is_some())
    })
}

/// Returns the same where the name in the URI leads there, and not the folder that asks.
fn of_name(folder: &Folder, uri: &str) -> Option<String> {
    let found = |uri: &str| candidates(folder, uri, false).into_iter().find(|path| folder.resolve(path).is_some());
    found(uri).or_else(|| decoded(uri).and_then(|uri| found(&uri)))
}

/// Returns the path of the SDF file of a model that an `<include>` names: the file itself, or its folder.
pub fn included(folder: &Folder, uri: &str) -> Option<String> {
    let uri = uri.trim_end_matches('/');
    if uri.to_ascii_lowercase().ends_with(".sdf") {
        return of_name(folder, uri);
    }
    let config = of_name(folder, &format!("{uri}/model.config"));
    let named = config.and_then(|path| {
        let bytes = folder.read(&path, MAX_CONFIG_BYTES).ok()?;
        let sdf = config_of(&super::text(&bytes)).sdf?;
        let (parent, _) = path.rsplit_once('/')?;
        Some(format!("{parent}/{sdf}")).filter(|p| folder.resolve(p).is_some())
    });
    named.or_else(|| of_name(folder, &format!("{uri}/model.sdf")))
}

/// Reads a `model.config`; one that cannot be read says nothing.
pub fn config_of(text: &str) -> Config {
    let Ok(document) = Document::parse(text) else { return Config::default() };
    let root = document.root_element();
    let version = |text: &str| -> Vec<u32> { text.split('.').map(|p| p.trim().parse().unwrap_or(0)).collect() };
    let files = root.children().filter(|n| n.has_tag_name("sdf"));
    let files = files.filter_map(|n| {
        let file = n.text()?.trim();
        (!file.is_empty()).then(|| (version(n.attribute("version").unwrap_or_default()), file.to_owned()))
    });
    let files: Vec<(Vec<u32>, String)> = files.collect();
    Config {
        name: words(root, "name").map(str::to_owned),
        sdf: files.iter().max_by(|a, b| a.0.cmp(&b.0)).map(|(_, file)| file.clone()),
        all: files.into_iter().map(|(_, file)| file).collect(),
    }
}

/// Returns where the file of a URI may be, the likeliest first; in the folder that asks, whatever the name, where `own`.
fn candidates(folder: &Folder, uri: &str, own: bool) -> Vec<String> {
    match uri.split_once("://") {
        None if uri.starts_with('/') => tails(uri),
        None => vec![uri.to_owned()],
        Some(("model" | "package", rest)) => match rest.split_once('/') {
            Some((name, path)) => named(folder, name, path, own),
            None => Vec::new(),
        },
        Some(("file", rest)) => {
            let rest = rest.trim_start_matches("./");
            match rest.split_once('/') {
                Some((name, path)) if !name.is_empty() => {
                    std::iter::once(rest.to_owned()).chain(named(folder, name, path, own)).collect()
                }
                _ => tails(rest),
            }
        }
        // Fuel: https://server/1.0/owner/models/NAME/tip/files/path, beside the folder of the model once it is downloaded.
        Some(("http" | "https" | "fuel", rest)) => {
            match rest.split_once("/models/").and_then(|(_, r)| r.split_once('/')) {
                Some((name, path)) => {
                    let path = path.split_once("files/").map_or(path, |(_, path)| path);
                    let path = path.strip_prefix("tip/").unwrap_or(path);
                    named(folder, name, path, own)
                }
                None => Vec::new(),
            }
        }
        Some(_) => Vec::new(),
    }
}

/// Returns where a file of a model called NAME may be.
fn named(folder: &Folder, name: &str, path: &str, own: bool) -> Vec<String> {
    let mut all = Vec::new();
    for (up, above) in folder.base().ancestors().take(folder.height() + 1).enumerate() {
        let climb = "../".repeat(up);
        if above.file_name().and_then(|f| f.to_str()).is_some_and(|f| f.eq_ignore_ascii_case(name)) {
            all.push(format!("{climb}{path}"));
        }
        all.extend(SHELVES.iter().map(|shelf| format!("{climb}{shelf}{name}/{path}")));
    }
    if own {
        all.extend([path.to_owned(), format!("../{path}")]);
    }
    all
}

/// Returns the ends of a path of somebody else's machine, the longest first: the file may be here below the same folders.
fn tails(path: &str) -> Vec<String> {
    let path = path.trim_start_matches('/');
    let starts = path.match_indices('/').map(|(at, _)| at + 1);
    std::iter::once(0).chain(starts).filter_map(|at| path.get(at..)).map(str::to_owned).collect()
}

/// Returns a URI with its `%20` and the like as what they stand for; none without any.
fn decoded(uri: &str) -> Option<String> {
    let bytes = uri.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while let Some(&byte) = bytes.get(at) {
        let code = uri.get(at + 1..at + 3).filter(|_| byte == b'%').and_then(|h| u8::from_str_radix(h, 16).ok());
        out.push(code.unwrap_or(byte));
        at += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8(out).ok().filter(|text| text != uri)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn home(files: &[&str]) -> tempfile::TempDir {
        let home = tempfile::tempdir().expect("a folder");
        for file in files {
            let path = home.path().join(file);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            std::fs::write(path, "x").expect("written");
        }
        home
    }

    #[test]
    fn names_are_found_by_walking_upward() {
        let home = home(&[
            "static/desk/sdf/meshes/desk.obj",
            "static/desk/sdf/desk.sdf",
            "static/lamp/meshes/lamp.dae",
            "fuel/chair/1/model.sdf",
            "fuel/chair/1/meshes/chair.dae",
            "pkg/worlds/w/model.sdf",
            "pkg/models/shelf one/meshes/a.stl",
        ]);
        let check = |sdf: &str, uri: &str, expected: Option<&str>| {
            let (folder, _) = Folder::of(&home.path().join(sdf), Some(home.path())).expect("there");
            let found = located(&folder, uri).and_then(|p| folder.resolve(&p));
            let expected = expected.map(|e| home.path().canonicalize().expect("there").join(e));
            assert_eq!(found, expected, "{sdf} {uri}");
        };
        let desk = "static/desk/sdf/desk.sdf";
        let own = Some("static/desk/sdf/meshes/desk.obj");
        check(desk, "model://desk/sdf/meshes/desk.obj", own);
        check(desk, "model://desk/meshes/desk.obj", own);
        check(desk, "meshes/desk.obj", own);
        check(desk, "file://meshes/desk.obj", own);
        check(desk, "file://desk/sdf/meshes/desk.obj", own);
        check(desk, "file:///home/somebody/static/desk/sdf/meshes/desk.obj", own);
        check(desk, "model://lamp/meshes/lamp.dae", Some("static/lamp/meshes/lamp.dae"));
        check(desk, "model://desk/sdf/meshes/none.obj", None);
        check(desk, "model://../../../../etc/passwd", None);
        let chair = Some("fuel/chair/1/meshes/chair.dae");
        check("fuel/chair/1/model.sdf", "model://chair/meshes/chair.dae", chair);
        check("fuel/chair/1/model.sdf", "model://Chair/1/meshes/chair.dae", chair);
        let fuel = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Chair/1/files/meshes/chair.dae";
        check("fuel/chair/1/model.sdf", fuel, chair);
        let shelf = Some("pkg/models/shelf one/meshes/a.stl");
        check("pkg/worlds/w/model.sdf", "model://shelf%20one/meshes/a.stl", shelf);
    }

    #[test]
    fn the_newest_version_of_a_model_is_taken() {
        let text = "<model><name> Office chair </name><sdf version='1.4'>a.sdf</sdf><sdf version='1.10'>c.sdf</sdf>\
                    <sdf version='1.9'>b.sdf</sdf></model>";
        let config = config_of(text);
        assert_eq!((config.name.as_deref(), config.sdf.as_deref()), (Some("Office chair"), Some("c.sdf")));
        assert_eq!(config.all.len(), 3);
        assert_eq!(config_of("<model"), Config::default());
    }
}
