//! `d3dgen dataset sample`: some worlds of a data set as the folders that `generate` would have made.

use std::io::Read;
use std::path::PathBuf;

use d3dgen_dataset::part::SPEC;
use d3dgen_dataset::shelf::{Shelf, Stored};
use d3dgen_dataset::spec::Spec;
use d3dgen_dataset::tasks::{Task, Tasks};

use crate::error::Error;
use crate::input::text;
use crate::interrupt;
use crate::output::Output;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// A finished data set
    dataset: PathBuf,
    /// How many worlds, evenly over all
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    count: u64,
    /// Only worlds of this split
    #[arg(long, value_name = "NAME")]
    split: Option<String>,
    /// Folder to write; each world gets a folder with its key in it
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        interrupt::listen();
        let (path, spec) = text(&self.dataset.join(SPEC), SPEC)?;
        let spec = Spec::from_toml(&spec, &path.display().to_string())?;
        let tasks = Tasks::of(&spec).map_err(Error::Input)?;
        let mut shelf = Shelf::default();
        shelf.add_dataset(&self.dataset)?;
        let wanted = |task: &Task<'_>| {
            self.split.as_ref().is_none_or(|split| task.prompt.split == *split) && shelf.failure(task.id).is_none()
        };
        let chosen: Vec<Task<'_>> = tasks.iter().filter(wanted).collect();
        if chosen.is_empty() {
            return Err(Error::Input("there is no such world".into()));
        }
        let count = self.count.min(chosen.len() as u64) as usize;
        for i in 0..count {
            interrupt::check()?;
            let task = &chosen[i * chosen.len() / count];
            let Some(world) = shelf.world(task.id)? else { continue };
            self.write(&format!("world-{:06}", task.number), &world, &shelf)?;
        }
        eprintln!("{count} worlds\n  folder       {}", self.out.display());
        Ok(())
    }

    fn write(&self, key: &str, world: &Stored, shelf: &Shelf) -> Result<(), Error> {
        let folder = self.out.join(key);
        let output = Output::new(&folder)?;
        for (ext, bytes) in &world.members {
            let Some(path) = world.row.paths.get(ext) else { continue };
            check_inside(path)?;
            if !ext.ends_with(".gz") || path.ends_with(".gz") {
                output.write(path, bytes)?;
                continue;
            }
            let mut plain = Vec::new();
            let unpacked = flate2::read::GzDecoder::new(bytes.as_slice()).read_to_end(&mut plain);
            unpacked.map_err(|source| Error::Read { path: folder.join(path), source })?;
            output.write(path, &plain)?;
        }
        for (path, name) in &world.row.models {
            check_inside(path)?;
            output.write(path, &shelf.model(name)?)?;
        }
        output.commit().map(|_| ())
    }
}

/// Refuses a path of somebody's data set that leads out of the folder of its world.
fn check_inside(path: &str) -> Result<(), Error> {
    let plain = |part: &str| !part.is_empty() && part != "." && part != ".." && !part.contains(['\\', ':']);
    if path.split('/').all(plain) {
        Ok(())
    } else {
        Err(Error::Input(format!("`{path}` leads out of a world's folder")))
    }
}
