//! `d3dgen assets inspect`: what files of models hold, or those of folders, a line each.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use d3dgen_assets::annotation::{Annotation, Origin};
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::ingest::{Read, Walk, annotate_file, walk};
use d3dgen_assets::inspect::line;
use d3dgen_assets::readers::{Bounds, ReadModel, Refusal};
use serde_json::Value;

use super::common::World;
use super::reader;
use crate::error::Error;
use crate::interrupt;
use crate::registry::RegistryArgs;
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Files of models: USD, USDZ, GLB, glTF, OBJ, DAE, STL, SDF; or folders, of which each asset is looked at as `ingest`
    /// would take it
    #[arg(value_name = "PATH", required = true)]
    files: Vec<PathBuf>,
    /// Print one JSON object a line instead of a table
    #[arg(long)]
    json: bool,
    /// Folder that bounds which other files a model may name; its own and a few above when left out
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    /// Returns the files, those of folders as `ingest` would take them, and what is refused already.
    fn listed(&self) -> Result<(Vec<PathBuf>, Vec<String>), Error> {
        let (mut files, mut refused) = (Vec::new(), Vec::new());
        for path in &self.files {
            if !path.is_dir() {
                files.push(path.clone());
                continue;
            }
            let Walk { models, refused: others, shapes, .. } = walk(path)?;
            if models.is_empty() && others.is_empty() {
                refused.push(format!("{}: holds no model", path.display()));
            }
            files.extend(models.into_iter().map(|(_, file)| file));
            let shown = |(file, reason): (String, String)| format!("{}: {reason}", path.join(file).display());
            shapes.into_iter().map(shown).for_each(|note| eprintln!("{note}"));
            refused.extend(others.into_iter().map(shown));
        }
        Ok((files, refused))
    }

    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let mut rows = Vec::new();
        let (files, mut refused) = self.listed()?;
        let mut written = Ok(());
        reader::pool()?.read(&files, self.root.as_deref(), |index, result| {
            let Some(file) = files.get(index) else { return ControlFlow::Break(()) };
            let name = file.display().to_string();
            let annotation = annotated(&result, file, self.root.as_deref(), &world.catalog);
            if self.json {
                let value = annotation.map_or(Value::Null, |a| serde_json::to_value(a).unwrap_or_default());
                written = writeln!(std::io::stdout().lock(), "{}", line(&name, &result, value));
            } else if let Ok(read) = &result {
                rows.push(row(&name, read, annotation.as_ref()));
            }
            if let Err(refusal) = result {
                refused.push(format!("{name}: {refusal}"));
            }
            if written.is_err() || interrupt::check().is_err() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })?;
        if interrupt::check().is_err() {
            return Err(Error::Interrupted);
        }
        written.map_err(|source| Error::Write { path: "standard output".into(), source })?;
        if !rows.is_empty() {
            let head = [
                "file",
                "format",
                "up",
                "m per unit",
                "size m",
                "meshes",
                "triangles",
                "materials",
                "is",
                "taken as m",
            ];
            print!("{}", table(&head, &rows));
        }
        match refused.len() {
            0 => Ok(()),
            1 => Err(Error::Input(refused.concat())),
            count => Err(Error::Input(format!("{count} files are refused:\n  {}", refused.join("\n  ")))),
        }
    }
}

/// Returns what plausibility and rules make of a model; nothing of one that is refused or shows nothing.
fn annotated(
    result: &Result<ReadModel, Refusal>,
    file: &Path,
    root: Option<&Path>,
    catalog: &Catalog,
) -> Option<Annotation> {
    let path = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let origin = Origin::Ingested { path, hash: String::new() };
    let read = Read::from(result.as_ref().ok()?.clone());
    annotate_file(&read, file, root, None, origin, catalog)
}

fn row(name: &str, read: &ReadModel, annotation: Option<&Annotation>) -> Vec<String> {
    let facts = &read.facts;
    let size = |[min, max]: Bounds| {
        let lengths: Vec<String> = (0..3).map(|i| format!("{:.3}", max[i] - min[i])).collect();
        lengths.join(" x ")
    };
    vec![
        name.to_owned(),
        facts.format.clone(),
        facts.up_axis.clone().unwrap_or_else(|| "-".into()),
        facts.meters_per_unit.map_or_else(|| "-".into(), |m| m.to_string()),
        facts.bbox_zup.or(facts.bbox_stage).map_or_else(|| "-".into(), size),
        facts.mesh_count.to_string(),
        facts.triangle_count.to_string(),
        facts.material_names.len().to_string(),
        annotation.and_then(|a| a.object.clone()).unwrap_or_else(|| "-".into()),
        annotation.map_or_else(|| "-".into(), |a| a.size_m.map(|v| format!("{v:.3}")).join(" x ")),
    ]
}
