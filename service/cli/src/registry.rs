//! The domains a command works with: those built in, and folders named on the command line.

use std::path::{Path, PathBuf};

use d3dgen_plugins::{Plugin, Registry};

use crate::database::StoreArgs;
use crate::error::Error;

/// Flag for further domains.
#[derive(clap::Args, Clone, Default)]
pub struct RegistryArgs {
    /// Folder of a custom domain, or of several; may be given more than once
    #[arg(long, value_name = "DIR")]
    pub domains_dir: Vec<PathBuf>,
    #[command(flatten)]
    pub store: StoreArgs,
}

impl RegistryArgs {
    /// Returns the built-in domains with those of the folders added, with the rules and the assets that the database has
    /// changed.
    ///
    /// # Errors
    /// `Read` or `Input` when a folder holds no domain, `Domain` with every problem of one that is broken; `Knowledge`
    /// when the database cannot be read.
    pub fn load(&self) -> Result<Registry, Error> {
        let mut registry = self.load_as_brought()?;
        let folders = registry.iter().filter(|p| !d3dgen_plugins::is_shipped(p.id()));
        let own_rules: Vec<String> =
            folders.filter(|p| !p.knowledge().references.is_empty()).map(|p| p.id().to_owned()).collect();
        self.store.overlay(&mut registry, &own_rules)?;
        crate::commands::assets::stock(&mut registry, &self.store)?;
        Ok(registry)
    }

    /// Returns the built-in domains with those of the folders added, each with the rules it brings.
    ///
    /// # Errors
    /// As [`RegistryArgs::load`], the database aside.
    pub fn load_as_brought(&self) -> Result<Registry, Error> {
        let mut registry = Registry::builtin();
        for dir in &self.domains_dir {
            for folder in domain_folders(dir)? {
                registry.add_folder(&folder)?;
            }
        }
        Ok(registry)
    }
}

/// Returns the folder itself when it is a domain, else the domains in it by name.
///
/// # Errors
/// `Read` when it cannot be read, `Input` when there is no domain.
pub fn domain_folders(dir: &Path) -> Result<Vec<PathBuf>, Error> {
    let is_domain = |p: &Path| p.join("domain.toml").is_file();
    let refused = |source| Error::Read { path: dir.to_path_buf(), source };
    let entries = std::fs::read_dir(dir).map_err(refused)?;
    if is_domain(dir) {
        return Ok(vec![dir.to_path_buf()]);
    }
    let mut folders =
        entries.map(|e| e.map(|e| e.path())).collect::<std::io::Result<Vec<PathBuf>>>().map_err(refused)?;
    folders.retain(|p| is_domain(p));
    folders.sort();
    if folders.is_empty() {
        return Err(Error::Input(format!("{} holds no domain: no domain.toml in it or in its folders", dir.display())));
    }
    Ok(folders)
}

/// Returns the domain of a document.
///
/// # Errors
/// `Input` with the domains there are.
pub fn domain<'a>(registry: &'a Registry, id: &str) -> Result<&'a dyn Plugin, Error> {
    registry.get(id).ok_or_else(|| {
        let known: Vec<&str> = registry.iter().map(Plugin::id).collect();
        Error::Input(format!(
            "domain `{id}` is not known; there are {} (add others with --domains-dir)",
            known.join(", ")
        ))
    })
}
