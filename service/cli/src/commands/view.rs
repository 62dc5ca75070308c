//! `d3dgen view`: a page that shows a world in three dimensions, in one file that needs nothing else.

use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use d3dgen_export::scene::SimScene;
use d3dgen_export::view::world3d;
use d3dgen_mesh::writers::world_glb;
use d3dgen_model::world::World;

use super::assets::Kept;
use super::export::own_folder;
use crate::error::Error;
use crate::input::document;
use crate::output::{Output, VIEW};
use crate::registry::{RegistryArgs, domain};

/// The page with a place for the program and one for the world.
const PAGE: &str = include_str!("../../data/view/page.html");
/// The viewer with three.js in it; `data/view/README.md` says how it is made.
const PROGRAM: &str = include_str!("../../data/view/viewer.min.js");

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// world.json, or a world's folder
    #[arg(value_name = "WORLD")]
    world: PathBuf,
    /// Folder for the page; otherwise `view` in the world's own
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let world: World = document(&self.world)?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &world.scene_graph.domain)?;
        let scene = SimScene::of(&world, plugin.domain(), &Kept::of(&self.registry.store)?)?;
        let glb = world_glb(&world3d(&scene)?).map_err(d3dgen_export::Error::from)?;
        let out = self.out.unwrap_or_else(|| own_folder(&self.world).join(VIEW));
        let output = Output::among(&out)?;
        output.write("index.html", page(&world.name, &glb).as_bytes())?;
        output.commit()?;
        eprintln!("open {} in a browser", out.join("index.html").display());
        Ok(())
    }
}

/// Returns the whole page.
fn page(name: &str, glb: &[u8]) -> String {
    // The last place first: what is put in is not looked at again.
    let (head, tail) = PAGE.split_once("{{PROGRAM}}").unwrap_or((PAGE, ""));
    let (start, end) = head.split_once("{{WORLD}}").unwrap_or((head, ""));
    [&start.replace("{{NAME}}", name), STANDARD.encode(glb).as_str(), end, PROGRAM, tail].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_world_and_program_and_asks_the_network_for_nothing() {
        let page = page("flat_1", b"glTF");
        assert!(page.contains("Z2xURg==") && page.contains("flat_1") && !page.contains("{{"));
        assert!(PAGE.find("{{WORLD}}") < PAGE.find("{{PROGRAM}}"));
        for word in ["src=\"http", "href=\"http", "url(http", "@import"] {
            assert!(!PAGE.contains(word), "{word}");
        }
        assert!(!PROGRAM.contains("</script"), "it would end the page's script");
        assert!(PROGRAM.contains("MIT"), "the license of three.js goes with it");
    }
}
