//! `d3dgen assets inspect`: what files of models hold, a line each.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use d3dgen_assets::annotation::Origin;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::ingest::{Read, annotate_file};
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
    /// Files of models: USD, USDZ, GLB, glTF, OBJ, DAE, STL, or the model.sdf of a folder
    #[arg(value_name = "FILE", required = true)]
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
    pub fn run(self) -> Result<(), Error> {
        let world = World::load(&self.registry)?;
        let mut rows = Vec::new();
        let mut refused = Vec::new();
        let mut written = Ok(());
        reader::pool()?.read(&self.files, self.root.as_deref(), |index, result| {
            let Some(file) = self.files.get(index) else { return ControlFlow::Break(()) };
            let name = file.display().to_string();
            if self.json {
                let line = line(&name, &result, annotated(&result, file, self.root.as_deref(), &world.catalog));
                written = writeln!(std::io::stdout().lock(), "{line}");
            } else if let Ok(read) = &result {
                rows.push(row(&name, read));
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
            print!(
                "{}",
                table(&["file", "format", "up", "m per unit", "size m", "meshes", "triangles", "materials"], &rows)
            );
        }
        match refused.len() {
            0 => Ok(()),
            1 => Err(Error::Input(refused.concat())),
            count => Err(Error::Input(format!("{count} files are refused:\n  {}", refused.join("\n  ")))),
        }
    }
}

/// Returns what plausibility and rules make of a model; nothing of one that is refused or shows nothing.
fn annotated(result: &Result<ReadModel, Refusal>, file: &Path, root: Option<&Path>, catalog: &Catalog) -> Value {
    let Ok(read) = result else { return Value::Null };
    let path = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let origin = Origin::Ingested { path, hash: String::new() };
    let read = Read::from(read.clone());
    let annotation = annotate_file(&read, file, root, None, origin, catalog);
    annotation.map_or(Value::Null, |a| serde_json::to_value(a).unwrap_or_default())
}

fn row(name: &str, read: &ReadModel) -> Vec<String> {
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
    ]
}
