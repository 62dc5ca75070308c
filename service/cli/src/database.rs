//! Where the knowledge database lies, and how commands open it.
//!
//! It is made when a `knowledge` command first needs it, and begins with the rules shipped with this release. Worlds are
//! made from it only once something in it was changed; until then they come from the shipped rules as they are.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use d3dgen_knowledge::database::{Database, Provenance, digest};
use d3dgen_model::knowledge::KnowledgeBase;
use d3dgen_plugins::{Plugin, Registry};
use d3dgen_store::embed::Embedder;
use d3dgen_store::{Access, Backend, Options};

use crate::error::Error;

/// Variables of the embedder: the library of ONNX Runtime, and the folder of a sentence model.
#[cfg(feature = "fastembed")]
const EMBEDDER_VARIABLES: [&str; 2] = ["ORT_DYLIB_PATH", "D3DGEN_MODEL_DIR"];
/// Variable that names the folder; empty means that there is no database.
const FOLDER_VARIABLE: &str = "D3DGEN_STORE";

/// Flag for the place of the database.
#[derive(clap::Args, Clone, Default)]
pub struct StoreArgs {
    /// Folder of the knowledge database; otherwise $D3DGEN_STORE, or d3dgen/knowledge in the user's data folder
    #[arg(long, value_name = "DIR")]
    pub store: Option<PathBuf>,
}

impl StoreArgs {
    /// Returns the folder of the database, whether it is there or not.
    fn dir(&self) -> Option<PathBuf> {
        if let Some(dir) = &self.store {
            return Some(dir.clone());
        }
        if let Some(dir) = std::env::var_os(FOLDER_VARIABLE) {
            return (!dir.is_empty()).then(|| dir.into());
        }
        Some(data_folder()?.join("knowledge"))
    }

    /// Returns the folder of the database.
    ///
    /// # Errors
    /// `Input` when nothing says where it is.
    pub fn folder(&self) -> Result<PathBuf, Error> {
        self.dir().ok_or_else(|| {
            Error::Input("there is no folder for the knowledge database: name one with --store DIR".into())
        })
    }

    /// Opens the database for changes, made if it is not there, with the rules of this release in it.
    ///
    /// # Errors
    /// `Input` without a folder; `Knowledge` when another process writes it or it is damaged.
    pub fn open(&self, registry: &Registry, backend: Option<Backend>) -> Result<Database, Error> {
        let mut options = Options::default();
        options.backend = backend.unwrap_or(options.backend);
        let dir = self.folder()?;
        if let Some(parent) = dir.parent() {
            std::fs::create_dir_all(parent).map_err(|source| Error::Write { path: parent.to_path_buf(), source })?;
        }
        let database = Database::open_or_create(&dir, &options)?;
        bring_shipped(&database, registry)?;
        Ok(database)
    }

    /// Opens the database for reading; made first when it is not there or lacks the rules of this release.
    ///
    /// # Errors
    /// As [`StoreArgs::open`].
    pub fn read(&self, registry: &Registry) -> Result<Database, Error> {
        if let Some(database) = self.existing()?
            && up_to_date(&database, registry)?
        {
            return Ok(database);
        }
        drop(self.open(registry, None)?);
        Ok(Database::open(&self.folder()?, Access::Read, &Options::default())?)
    }

    /// Opens the database for reading, however it is.
    ///
    /// # Errors
    /// `Knowledge`, also when there is none.
    pub fn open_as_it_is(&self) -> Result<Database, Error> {
        Ok(Database::open(&self.folder()?, Access::Read, &Options::default())?)
    }

    /// Opens the database for reading when there is one; a folder named on the command line must hold one.
    ///
    /// # Errors
    /// `Knowledge`.
    fn existing(&self) -> Result<Option<Database>, Error> {
        let Some(dir) = self.dir() else { return Ok(None) };
        match Database::open(&dir, Access::Read, &Options::default()) {
            Ok(database) => Ok(Some(database)),
            Err(d3dgen_knowledge::Error::Store(d3dgen_store::Error::NotFound { .. })) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Gives every domain the rules that were changed in the database.
    ///
    /// Domains of folders that bring rules of their own keep them.
    ///
    /// # Errors
    /// `Knowledge`; `Input` when the folder named with `--store` holds no database.
    pub fn overlay(&self, registry: &mut Registry, own_rules: &[String]) -> Result<(), Error> {
        let Some(mut database) = self.existing()? else {
            return match &self.store {
                Some(dir) => Err(Error::Input(format!(
                    "{} holds no knowledge database; `knowledge import` makes one",
                    dir.display()
                ))),
                None => Ok(()),
            };
        };
        let changed = |database: &Database| -> Result<Vec<String>, Error> {
            let mut entries = database.domains()?;
            entries.retain(|e| e.changes > 0 && !own_rules.contains(&e.domain));
            Ok(entries.into_iter().map(|e| e.domain).collect())
        };
        let wanted = changed(&database)?;
        if wanted.is_empty() {
            return Ok(());
        }
        if !up_to_date(&database, registry)? {
            drop(database);
            database = self.read(registry)?; // the rules of another release, with the same changes
        }
        for domain in wanted {
            let knowledge = database.knowledge_base(&domain)?;
            registry.set_knowledge(&domain, knowledge);
        }
        Ok(())
    }
}

/// Returns the folder of d3dgen in the user's data folder.
pub fn data_folder() -> Option<PathBuf> {
    let data = std::env::var_os("XDG_DATA_HOME").filter(|d| Path::new(d).is_absolute()).map(PathBuf::from);
    let home = || std::env::var_os("HOME").filter(|h| !h.is_empty()).map(|h| PathBuf::from(h).join(".local/share"));
    Some(data.or_else(home)?.join("d3dgen"))
}

/// Returns who changes the database now, and why.
pub fn provenance(by: Option<&str>, why: &str) -> Provenance {
    let user = || ["USER", "USERNAME", "LOGNAME"].iter().find_map(|v| std::env::var(v).ok().filter(|n| !n.is_empty()));
    Provenance {
        who: by.map(str::to_owned).or_else(user).unwrap_or_else(|| "unknown".into()),
        when: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
        why: why.to_owned(),
    }
}

/// Returns the embedder that this machine is set up for: the table that is in the program, and a
/// transformer with it when its library and model are named.
///
/// # Errors
/// `Knowledge` when what is named cannot be used.
pub fn embedder() -> Result<Arc<dyn Embedder>, Error> {
    #[cfg(feature = "fastembed")]
    if let [Some(library), Some(folder)] = EMBEDDER_VARIABLES.map(std::env::var_os) {
        let files = d3dgen_store::embed::TransformerFiles { runtime: library.into(), model_dir: folder.into() };
        let transformer = d3dgen_store::embed::Transformer::load(&files).map_err(d3dgen_knowledge::Error::from)?;
        return Ok(Arc::new(d3dgen_store::embed::Ensemble::of_table_and(Arc::new(transformer))));
    }
    Ok(Arc::new(d3dgen_store::embed::StaticTable::new()))
}

fn up_to_date(database: &Database, registry: &Registry) -> Result<bool, Error> {
    let entries = database.domains()?;
    Ok(shipped(registry).all(|knowledge| {
        let entry = entries.iter().find(|e| e.domain == knowledge.metadata.domain);
        entry.is_some_and(|e| e.shipped.as_ref().is_none_or(|d| *d == digest(knowledge)))
    }))
}

fn bring_shipped(database: &Database, registry: &Registry) -> Result<(), Error> {
    if up_to_date(database, registry)? {
        return Ok(());
    }
    let rules: Vec<&KnowledgeBase> = shipped(registry).collect();
    let release = concat!("d3dgen ", env!("CARGO_PKG_VERSION"));
    let by = provenance(Some(release), &format!("the rules shipped with {release}"));
    for change in database.bring_shipped(&rules, &by)? {
        eprintln!("{}: {} rules and documents of {release}", change.domain, change.added + change.changed);
    }
    Ok(())
}

/// Returns the rules that came with the program.
fn shipped(registry: &Registry) -> impl Iterator<Item = &KnowledgeBase> {
    registry.iter().filter(|p| d3dgen_plugins::is_shipped(p.id())).map(Plugin::knowledge)
}
