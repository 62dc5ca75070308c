//! `d3dgen render`: pictures of a world in three dimensions.

use std::path::PathBuf;

use d3dgen_export::render::{Wish, pictures};
use d3dgen_export::scene::SimScene;
use d3dgen_export::view::world3d;
use d3dgen_mesh::picture::studio::Effort;
use d3dgen_model::world::World;

use super::assets::Kept;
use super::export::own_folder;
use crate::error::Error;
use crate::input::document;
use crate::interrupt;
use crate::output::{Output, PICTURES};
use crate::registry::{RegistryArgs, domain};

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// world.json, or a world's folder
    #[arg(value_name = "WORLD")]
    world: PathBuf,
    /// Folder for the pictures; otherwise `pictures` in the world's own
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Width and height of each picture, px
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = size)]
    size: [usize; 2],
    /// Rays a pixel: more give smoother pictures and take longer
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=256))]
    samples: u16,
    /// Height of the eye in rooms, m: 1.6 for a person, 0.5 for a small robot
    #[arg(long, value_name = "M", default_value_t = 1.6)]
    eye: f64,
    /// By night, with lamps on
    #[arg(long)]
    night: bool,
    /// Only these rooms (ids, by comma)
    #[arg(long, value_name = "ROOM", value_delimiter = ',')]
    rooms: Option<Vec<String>>,
    /// Only the pictures from above
    #[arg(long, conflicts_with = "rooms")]
    overview: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let world: World = document(&self.world)?;
        let registry = self.registry.load()?;
        let plugin = domain(&registry, &world.scene_graph.domain)?;
        let out = self.out.unwrap_or_else(|| own_folder(&self.world).join(PICTURES));
        let output = Output::among(&out)?;
        let scene = SimScene::of(&world, plugin.domain(), &Kept::of(&self.registry.store)?)?;
        let wish = Wish {
            size_px: self.size,
            effort: Effort {
                samples: usize::from(self.samples),
                threads: std::thread::available_parallelism().map_or(1, usize::from),
            },
            eye_m: self.eye,
            night: self.night,
            overview: self.rooms.is_none(),
            rooms: if self.overview { Some(Vec::new()) } else { self.rooms },
        };
        let mut count = 0;
        pictures(&scene, &world3d(&scene)?, &wish, &mut |file, all| {
            interrupt::check()?;
            count += 1;
            eprintln!("{count}/{all} {}", file.path);
            output.write(&file.path, &file.bytes)
        })?;
        output.commit()?;
        eprintln!("wrote {count} pictures into {}", out.display());
        Ok(())
    }
}

/// Reads `1280x800`.
fn size(text: &str) -> Result<[usize; 2], String> {
    let parsed = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match parsed {
        Some([w, h]) if (16..=8192).contains(&w) && (16..=8192).contains(&h) => Ok([w, h]),
        _ => Err("is no size such as 1280x800, 16 to 8192 px each way".to_owned()),
    }
}
