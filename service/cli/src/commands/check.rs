//! `d3dgen check`: the verdict on existing worlds.

use std::fs;
use std::path::{Path, PathBuf};

#[cfg(feature = "physics")]
use d3dgen_export::Subject;
#[cfg(feature = "physics")]
use d3dgen_model::domain::Domain;
use d3dgen_model::world::World;
use d3dgen_pipeline::{generate, world};

#[cfg(feature = "physics")]
use crate::commands::assets::Kept;
use crate::error::Error;
use crate::input::{document, write_text};
use crate::registry::{RegistryArgs, domain};
use crate::summary;
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// world.json, a world's folder, or a folder of such folders
    #[arg(value_name = "WORLD", required = true)]
    worlds: Vec<PathBuf>,
    /// Print each report as one JSON line
    #[arg(long)]
    json: bool,
    /// Step each world in a physics engine too, and name what does not stay where it was put
    #[cfg(feature = "physics")]
    #[arg(long)]
    physics: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load()?;
        #[cfg(feature = "physics")]
        let kept = self.physics.then(|| Kept::of(&self.registry.store)).transpose()?;
        let mut rows = Vec::new();
        let mut unsound = Vec::new();
        #[cfg_attr(not(feature = "physics"), expect(unused_mut, reason = "nothing is stepped without an engine"))]
        let mut moving: Vec<String> = Vec::new();
        for path in self.worlds.iter().map(|p| files(p)).collect::<Result<Vec<_>, Error>>()?.concat() {
            let world: World = document(&path)?;
            let plugin = domain(&registry, &world.scene_graph.domain)?;
            let retrieved = generate::retrieve(&world.scene_graph, plugin);
            let report = world::check(&world, plugin.domain(), &retrieved);
            if self.json {
                write_text(None, &format!("{}\n", serde_json::json!(report)))?;
            }
            summary::print_broken(&report);
            #[cfg(feature = "physics")]
            if let Some(kept) = &kept
                && !stands(&world, plugin.domain(), kept)?
            {
                moving.push(report.world.clone());
            }
            let c = &report.summary;
            let cells = [c.satisfied, c.violated, c.not_decidable].map(|n| n.to_string());
            let verdict = summary::verdict(&report);
            rows.push(
                [vec![report.world.clone(), verdict.into(), report.rules.len().to_string()], cells.to_vec()].concat(),
            );
            if !report.sound {
                unsound.push(report.world);
            }
        }
        if !self.json {
            let header = ["world", "", "rules", "satisfied", "violated", "not decidable"];
            write_text(None, &table(&header, &rows))?;
        }
        let faults = [("break hard rules", &unsound), ("do not stand still", &moving)];
        match faults.iter().find_map(|(fault, worlds)| Some((fault, worlds.first()?, worlds.len()))) {
            None => Ok(()),
            Some((fault, first, count)) => {
                Err(Error::Unsound(format!("{count} of {} worlds {fault}, first {first}", rows.len())))
            }
        }
    }
}

/// Steps a world, and names what moves by itself or begins in something else.
///
/// # Errors
/// `Export` when the world is no scene for simulators.
#[cfg(feature = "physics")]
fn stands(world: &World, domain: &Domain, kept: &Kept) -> Result<bool, Error> {
    let settled = d3dgen_physics::settle(Subject::new(world, domain, kept).scene()?);
    for moved in &settled.moved {
        eprintln!("{}: {} does not stay: it ends {:.2} m away", world.name, moved.id, moved.way_m);
    }
    for overlap in &settled.overlaps {
        let [a, b] = &overlap.ids;
        eprintln!("{}: {a} begins {:.3} m inside {b}", world.name, overlap.depth_m);
    }
    let stay = settled.bodies - settled.moved.len();
    eprintln!("{}: {stay} of {} things that can be moved stay where they were put", world.name, settled.bodies);
    Ok(settled.moved.is_empty() && settled.overlaps.is_empty())
}

/// Returns the world files a path stands for.
fn files(path: &Path) -> Result<Vec<PathBuf>, Error> {
    if !path.is_dir() || path.join("world.json").is_file() {
        return Ok(vec![path.to_path_buf()]);
    }
    let entries = fs::read_dir(path).map_err(|source| Error::Read { path: path.to_path_buf(), source })?;
    let mut found: Vec<PathBuf> =
        entries.filter_map(Result::ok).map(|e| e.path().join("world.json")).filter(|p| p.is_file()).collect();
    // Seeds by number, other names by letter.
    found.sort_by_cached_key(|p| {
        let name = p.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
        (name.parse::<u64>().unwrap_or(u64::MAX), name)
    });
    if found.is_empty() {
        return Err(Error::Input(format!("{} holds no world: no world.json in it or in its folders", path.display())));
    }
    Ok(found)
}
