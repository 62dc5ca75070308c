//! `d3dgen assets export`: models with their annotations as files, in the folders Arena has them in.

use std::path::{Path, PathBuf};

use d3dgen_assets::annotation::{Annotation, asa};
use d3dgen_assets::database::Shelf;
use d3dgen_assets::search::SearchQuery;
use d3dgen_mesh::{Model3d, writers};
use d3dgen_model::Document;

use super::common::{Choice, World};
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Assets to write
    #[arg(value_name = "ASSET_ID")]
    asset_ids: Vec<String>,
    #[command(flatten)]
    choice: Choice,
    /// Folder to write into: DIR/Domain/Object/Name/...
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What to write, by commas: usdz, glb, sdf, json (the whole annotation); annotation.yaml comes with any of them
    #[arg(long, value_name = "FORMATS", default_value = "usdz,glb,sdf", value_delimiter = ',', value_parser = ["usdz", "glb", "sdf", "json"])]
    format: Vec<String>,
    /// Print one JSON line for each file
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let filters = self.choice.filters()?;
        if self.asset_ids.is_empty() && filters.is_empty() {
            return Err(Error::Input("name assets to export, or choose them with --filter, --kind or --origin".into()));
        }
        let mut ids = self.asset_ids.clone();
        if !filters.is_empty() {
            let searcher = world.searcher(&self.registry.store)?;
            let query = SearchQuery { filters, limit: usize::MAX, one_per_object: true, ..SearchQuery::default() };
            ids.extend(searcher.search(&query)?.into_iter().map(|f| f.annotation.asset_id));
        }
        let shelf = world.shelf(&self.registry.store)?;
        let mut text = String::new();
        for id in ids {
            interrupt::check()?;
            for (path, bytes) in self.files(&world, &shelf, &id)? {
                let file = self.out.join(&path);
                write(&file, &bytes)?;
                text += &match self.json {
                    true => format!("{}\n", serde_json::json!({ "asset_id": id, "file": path, "bytes": bytes.len() })),
                    false => format!("{}\n", file.display()),
                };
            }
        }
        write_text(None, &text)
    }

    /// Returns the files of an asset, by path below the folder.
    fn files(&self, world: &World, shelf: &Shelf<'_>, id: &str) -> Result<Vec<(String, Vec<u8>)>, Error> {
        let mut annotation: Annotation = shelf.get(id)?;
        let mut model: Model3d = world.model(shelf, id)?;
        let (domain, name) = id.split_once('/').unwrap_or(("Common", id));
        model.name = name.to_owned();
        annotation.triangle_count = model.triangle_count() as u64;
        let folder = format!("{domain}/Object/{name}");
        let failed = |e: d3dgen_mesh::Error| Error::Input(format!("{id} cannot be written: {e}"));
        let mut files = vec![(format!("{folder}/annotation.yaml"), asa::write(&annotation).into_bytes())];
        for format in &self.format {
            match format.as_str() {
                "usdz" => files.push((format!("{folder}/{name}.usdz"), writers::usdz(&model).map_err(failed)?)),
                "glb" => files.push((format!("{folder}/{name}.glb"), writers::glb(&model).map_err(failed)?)),
                "sdf" => {
                    let parts = writers::sdf(&model).map_err(failed)?;
                    files.extend(parts.into_iter().map(|f| (format!("{folder}/{name}.sdf/{}", f.name), f.bytes)));
                }
                _ => files.push((format!("{folder}/{name}.json"), annotation.to_json().into_bytes())),
            }
        }
        Ok(files)
    }
}

fn write(file: &Path, bytes: &[u8]) -> Result<(), Error> {
    let failed = |source| Error::Write { path: file.to_path_buf(), source };
    let folder = file.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(failed)?;
    std::fs::write(file, bytes).map_err(failed)
}
