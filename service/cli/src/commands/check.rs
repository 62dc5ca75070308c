//! `d3dgen check`: the verdict on existing worlds.

use std::fs;
use std::path::{Path, PathBuf};

use d3dgen_model::world::World;
use d3dgen_pipeline::{generate, world};

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
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load()?;
        let mut rows = Vec::new();
        let mut unsound = Vec::new();
        for path in self.worlds.iter().map(|p| files(p)).collect::<Result<Vec<_>, Error>>()?.concat() {
            let world: World = document(&path)?;
            let plugin = domain(&registry, &world.scene_graph.domain)?;
            let retrieved = generate::retrieve(&world.scene_graph, plugin);
            let report = world::check(&world, plugin.domain(), &retrieved);
            if self.json {
                write_text(None, &format!("{}\n", serde_json::json!(report)))?;
            }
            summary::print_broken(&report);
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
        match unsound.first() {
            None => Ok(()),
            Some(first) => Err(Error::Unsound(format!(
                "{} of {} worlds break hard rules, first {first}",
                unsound.len(),
                rows.len()
            ))),
        }
    }
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
