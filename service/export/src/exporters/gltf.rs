//! The whole world as one GLB file, for viewers, engines and people who look at it in a browser.

use d3dgen_mesh::writers;

use super::Exporter;
use crate::error::Error;
use crate::file::File;
use crate::scene::SimScene;
use crate::subject::Subject;
use crate::view;

/// The exporter.
pub struct Gltf;

impl Exporter for Gltf {
    fn name(&self) -> &'static str {
        "gltf"
    }

    fn about(&self) -> &'static str {
        "one GLB of the whole world: rooms, doors and drawers that open, lamps, materials, ids in extras"
    }

    fn roots(&self) -> &'static [&'static str] {
        &["gltf"]
    }

    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error> {
        let seen = view::world3d(subject.scene()?)?;
        Ok(vec![File::new(format!("gltf/{}.glb", subject.world.name), writers::world_glb(&seen)?)])
    }

    /// Nodes have the ids of the scene; zones and robots are not seen.
    fn places(&self, scene: &SimScene, _: &[File]) -> Vec<(String, String)> {
        let seen = |kind: &str| !matches!(kind, "zone" | "robot");
        scene.ids().into_iter().filter(|(_, kind)| seen(kind)).map(|(id, _)| (id.to_owned(), id.to_owned())).collect()
    }
}
