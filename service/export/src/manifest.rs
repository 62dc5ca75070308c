//! `manifest.json` beside the folders of all formats: where each id of a world is in each of them, and the files with their
//! checksums.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value, json};

use crate::error::Error;
use crate::exporters::{Exporter, File};
use crate::scene::SimScene;
use crate::subject::Subject;

/// Name of the file at the top of a world's folder.
pub const FILE: &str = "manifest.json";
/// What its `format` says.
const FORMAT: &str = "d3dgen-manifest/1";

/// What the formats of a world report while they are written.
pub struct Manifest<'a> {
    world: &'a str,
    /// None of a world that simulators cannot be given; the exporter that is asked for it says why.
    scene: Option<&'a SimScene>,
    formats: BTreeSet<&'static str>,
    /// Id -> format -> place in it.
    places: BTreeMap<String, BTreeMap<&'static str, String>>,
    /// Path -> format, checksum and size of the file.
    files: BTreeMap<String, (&'static str, String, usize)>,
}

impl<'a> Manifest<'a> {
    /// Returns an empty manifest of a world.
    ///
    /// Every model of the world is made and looked at here, so that a broken one is known before anything is written.
    ///
    /// # Errors
    /// As [`SimScene::of`].
    pub fn of(subject: &'a Subject<'_>) -> Result<Self, Error> {
        let scene = match subject.scene() {
            Err(Error::Unsupported { .. }) => None,
            made => Some(made?),
        };
        Ok(Self {
            world: &subject.world.name,
            scene,
            formats: BTreeSet::new(),
            places: BTreeMap::new(),
            files: BTreeMap::new(),
        })
    }

    /// Adds what an exporter has written.
    pub fn add(&mut self, exporter: &dyn Exporter, files: &[File]) {
        let format = exporter.name();
        self.formats.insert(format);
        for (id, place) in self.scene.iter().flat_map(|scene| exporter.places(scene, files)) {
            self.places.entry(id).or_default().insert(format, place);
        }
        for file in files {
            self.files.insert(file.path.clone(), (format, file.sha256(), file.bytes.len()));
        }
    }

    /// Returns the file; formats of an earlier one of the same world that were not written anew stay in it.
    pub fn file(&self, earlier: Option<&[u8]>) -> File {
        let earlier = earlier.and_then(|bytes| serde_json::from_slice::<Value>(bytes).ok());
        let earlier = earlier.filter(|e| e["format"] == FORMAT && e["world"] == self.world);
        let earlier = earlier.unwrap_or_else(|| json!({}));
        let is_kept = |format: &Value| format.as_str().is_some_and(|f| !self.formats.contains(f));
        let list = |key: &str| earlier[key].as_array().cloned().unwrap_or_default();
        let mut formats: Vec<Value> = list("formats").into_iter().filter(is_kept).collect();
        formats.extend(self.formats.iter().map(|f| json!(f)));
        formats.sort_by(|a, b| a.as_str().cmp(&b.as_str()));
        let ids: Map<String, Value> = self
            .scene
            .iter()
            .flat_map(|scene| scene.ids())
            .map(|(id, kind)| {
                let mut own: BTreeMap<String, Value> = BTreeMap::new();
                let before = earlier["ids"][id]["in"].as_object().cloned().unwrap_or_default();
                own.extend(before.into_iter().filter(|(format, _)| is_kept(&json!(format))));
                let now = self.places.get(id).into_iter().flatten();
                own.extend(now.map(|(format, place)| ((*format).to_owned(), json!(place))));
                (id.to_owned(), json!({"kind": kind, "in": own}))
            })
            .collect();
        let mut files: Vec<Value> = list("files").into_iter().filter(|f| is_kept(&f["format"])).collect();
        files.extend(self.files.iter().map(
            |(path, (format, sha256, bytes))| json!({"path": path, "format": format, "sha256": sha256, "bytes": bytes}),
        ));
        files.sort_by(|a, b| a["path"].as_str().cmp(&b["path"].as_str()));
        let manifest = json!({
            "format": FORMAT,
            "world": self.world,
            "formats": formats,
            "ids": ids,
            "files": files,
        });
        File::new(FILE, serde_json::to_string(&manifest).unwrap_or_default() + "\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exporters;
    use crate::models::NothingKept;
    use crate::sample;

    fn manifest(formats: &[&str], earlier: Option<&[u8]>) -> (File, Value) {
        let (world, domain) = (sample::world(), sample::domain());
        let subject = Subject::new(&world, &domain, &NothingKept);
        let mut manifest = Manifest::of(&subject).unwrap();
        for exporter in formats.iter().filter_map(|f| exporters::get(f)) {
            manifest.add(exporter, &exporter.export(&subject).unwrap());
        }
        let file = manifest.file(earlier);
        let value = serde_json::from_slice(&file.bytes).unwrap();
        (file, value)
    }

    #[test]
    fn a_door_is_found_in_every_format_and_files_have_checksums() {
        let (_, found) = manifest(&["arena", "mujoco"], None);
        assert_eq!(found["ids"]["door_2"]["kind"], "door");
        assert_eq!(found["ids"]["door_2"]["in"]["mujoco"], "door_2");
        assert!(found["ids"]["door_2"]["in"]["arena"].as_str().is_some_and(|p| p.contains("door_2")));
        let files = found["files"].as_array().unwrap();
        let world = files.iter().find(|f| f["path"] == "mujoco/world.xml").unwrap();
        assert_eq!(world["sha256"].as_str().map(str::len), Some(64));
    }

    #[test]
    fn every_format_with_places_says_where_a_door_is() {
        let (_, found) = manifest(&["usd", "gltf", "gazebo", "nav2", "rmf"], None);
        let door = &found["ids"]["door_2"]["in"];
        assert_eq!((&door["usd"], &door["gltf"]), (&json!("/World/Doors/door_2"), &json!("door_2")));
        let node = door["nav2"].as_str().expect("robots pass it").to_owned();
        assert!(node.starts_with("nav2/0/route_graph.geojson#"), "{node}");
        assert!(door["rmf"].as_str().is_some_and(|p| p.ends_with(".building.yaml#door_2")), "{door}");
    }

    #[test]
    fn what_is_added_to_a_folder_is_added_to_its_manifest() {
        let (first, _) = manifest(&["mujoco"], None);
        let (second, both) = manifest(&["arena"], Some(&first.bytes));
        assert_eq!(both["formats"], json!(["arena", "mujoco"]));
        assert_eq!(both["ids"]["door_2"]["in"]["mujoco"], "door_2");
        assert_eq!(manifest(&["arena"], Some(&second.bytes)).0, second, "writing anew changes nothing");
    }
}
