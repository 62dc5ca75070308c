//! `d3dgen knowledge import`, `export`, `snapshot` and `restore`: the database as files.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use d3dgen_model::Document;
use d3dgen_store::{Backend, Options, snapshot};

use crate::database::provenance;
use crate::error::Error;
use crate::input::{knowledge_base, write_lines, write_text};
use crate::interrupt;
use crate::progress::Progress;
use crate::registry::RegistryArgs;

/// Arguments of `import`.
#[derive(clap::Args)]
pub struct ImportArgs {
    /// `knowledge.json` or `rag_data.generated.json`; `-` for standard input
    file: PathBuf,
    /// Let the domain hold exactly this afterwards; otherwise what it has beside it stays
    #[arg(long)]
    replace: bool,
    /// Who does it; otherwise the user's name
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Why; otherwise the file's name
    #[arg(long, value_name = "TEXT")]
    why: Option<String>,
    /// What a new database keeps its records in: redb, or sled where the program was built with it
    #[arg(long, value_name = "NAME", value_parser = Backend::from_name)]
    backend: Option<Backend>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl ImportArgs {
    pub fn run(self) -> Result<(), Error> {
        let (path, imported) = knowledge_base(&self.file)?;
        for (unit, id) in &imported.unknown_units {
            eprintln!("warning: unit `{unit}` (of {id}) is not known; its figures stay as printed");
        }
        for kept in &imported.quarantined {
            eprintln!("kept apart: {}: {}", kept.constraint_id, kept.reason);
        }
        let registry = self.registry.load_as_brought()?;
        let database = self.registry.store.open(&registry, self.backend)?;
        let why = self.why.unwrap_or_else(|| format!("import of {}", path.display()));
        let change = database.import(&imported.knowledge, !self.replace, &provenance(self.by.as_deref(), &why))?;
        let domain = &imported.knowledge.metadata.domain;
        if self.json {
            let apart: Vec<_> = imported
                .quarantined
                .iter()
                .map(|q| serde_json::json!({"constraint_id": q.constraint_id, "reason": q.reason}))
                .collect();
            let line = serde_json::json!({
                "domain": domain, "change": change, "converted": imported.converted, "quarantined": apart,
            });
            return write_lines([line]);
        }
        match change {
            None => eprintln!("{domain}: the database has all of it already"),
            Some(c) => eprintln!(
                "{domain}: change {}: {} added, {} changed, {} removed; {} converted to SI",
                c.seq, c.added, c.changed, c.removed, imported.converted
            ),
        }
        Ok(())
    }
}

/// Arguments of `export`.
#[derive(clap::Args)]
pub struct ExportArgs {
    /// Domain to write
    #[arg(long, value_name = "ID")]
    domain: String,
    /// File to write; standard output when left out
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl ExportArgs {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load_as_brought()?;
        let knowledge = self.registry.store.read(&registry)?.knowledge_base(&self.domain)?;
        write_text(self.out.as_deref(), &knowledge.to_json())
    }
}

/// Arguments of `snapshot`.
#[derive(clap::Args)]
pub struct SnapshotArgs {
    /// File to write; must not be there yet
    file: PathBuf,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl SnapshotArgs {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load_as_brought()?;
        let database = self.registry.store.read(&registry)?;
        let by = Options::default().written_by;
        let summary =
            with_progress(|observe, cancelled| snapshot::write(database.store(), &self.file, &by, observe, cancelled))?;
        eprintln!("wrote {}: {} records", self.file.display(), summary.records);
        Ok(())
    }
}

/// Arguments of `restore`.
#[derive(clap::Args)]
pub struct RestoreArgs {
    /// A snapshot
    file: PathBuf,
    /// Folder of the new database; must be missing or empty
    #[arg(long, value_name = "DIR")]
    into: PathBuf,
    /// What to keep the records in: redb, or sled where the program was built with it
    #[arg(long, value_name = "NAME", value_parser = Backend::from_name)]
    backend: Option<Backend>,
}

impl RestoreArgs {
    pub fn run(self) -> Result<(), Error> {
        let mut options = Options::default();
        options.backend = self.backend.unwrap_or(options.backend);
        restore(&self.file, &self.into, &options)?;
        eprintln!("restored into {}; use it with --store", self.into.display());
        Ok(())
    }
}

fn restore(file: &Path, into: &Path, options: &Options) -> Result<(), Error> {
    with_progress(|observe, cancelled| snapshot::restore(file, into, options, observe, cancelled).map(drop))
}

/// Runs long work on records with progress; Ctrl-C ends it.
fn with_progress<T>(
    work: impl FnOnce(&mut dyn FnMut(d3dgen_store::Progress), &AtomicBool) -> d3dgen_store::Result<T>,
) -> Result<T, Error> {
    interrupt::listen();
    let progress = Progress::of(1);
    let mut observe = |p: d3dgen_store::Progress| progress.doing(&format!("records: {} of {}", p.done, p.total));
    let done = work(&mut observe, interrupt::flag());
    progress.finish();
    done.map_err(|e| d3dgen_knowledge::Error::from(e).into())
}
