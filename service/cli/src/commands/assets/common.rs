//! What the commands on assets share: the catalog, the database, the index, models of any asset.

use std::path::Path;
use std::sync::atomic::Ordering;

use d3dgen_assets::annotation::Origin;
use d3dgen_assets::catalog::Catalog;
use d3dgen_assets::database::{Database, Provenance, Searcher, Shelf};
use d3dgen_assets::search::{Filters, Found};
use d3dgen_mesh::picture::Picture;
use d3dgen_mesh::{Model3d, builds};
use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Plugin, Registry};
use d3dgen_store::index::{Progress, Watch};
use d3dgen_store::{Access, Options};

use crate::database::{StoreArgs, embedder, provenance};
use crate::error::Error;
use crate::interrupt;
use crate::registry::RegistryArgs;

/// Flags that choose assets.
#[derive(clap::Args, Clone, Default)]
pub struct Choice {
    /// Condition: height<1.0, width>=60cm, mount=wall, color=red,blue, kind!=lamp, affordance=sit, articulated; may be
    /// given more than once
    #[arg(long, short, value_name = "COND")]
    pub filter: Vec<String>,
    /// Only assets of this domain
    #[arg(long, value_name = "ID")]
    pub domain: Option<String>,
    /// Only assets of this kind (chair, bed, lamp, ...)
    #[arg(long, value_name = "KIND")]
    pub kind: Option<String>,
    /// Only assets that come from here: ingested, generated or library
    #[arg(long, value_name = "FROM", value_parser = ["ingested", "generated", "library"])]
    pub origin: Option<String>,
}

impl Choice {
    /// Returns the conditions.
    ///
    /// # Errors
    /// `Assets` for one that cannot be read, with what would work.
    pub fn filters(&self) -> Result<Filters, Error> {
        let mut filters = Filters::default();
        for text in &self.filter {
            filters.add(text)?;
        }
        for (name, value) in [("domain", &self.domain), ("kind", &self.kind), ("origin", &self.origin)] {
            if let Some(value) = value {
                filters.add(&format!("{name}={value}"))?;
            }
        }
        Ok(filters)
    }
}

/// Domains and what they make up.
pub struct World {
    /// The domains.
    pub registry: Registry,
    /// Their objects.
    pub catalog: Catalog,
}

impl World {
    /// Loads the domains.
    ///
    /// # Errors
    /// As [`RegistryArgs::load_as_brought`].
    pub fn load(args: &RegistryArgs) -> Result<Self, Error> {
        let registry = args.load_as_brought()?;
        let domains: Vec<&Domain> = registry.iter().map(Plugin::domain).collect();
        let catalog = Catalog::new(domains);
        Ok(Self { registry, catalog })
    }

    /// Returns all assets: of the database where there is one, and of the library.
    ///
    /// # Errors
    /// `Assets` when the database is damaged; `Input` when a folder named with `--store` holds none.
    pub fn shelf(&self, args: &StoreArgs) -> Result<Shelf<'_>, Error> {
        Ok(Shelf::new(existing(args)?, &self.catalog)?)
    }

    /// Opens the index of all assets, with progress when it has to be made.
    ///
    /// # Errors
    /// As [`World::shelf`]; `Interrupted`.
    pub fn searcher(&self, args: &StoreArgs) -> Result<Searcher<'_>, Error> {
        interrupt::listen();
        let shelf = self.shelf(args)?;
        let progress = crate::progress::Progress::of(1);
        let report = |p: Progress| progress.doing(&format!("indexing: {} of {}", p.done, p.total));
        let cancel = || interrupt::flag().load(Ordering::SeqCst);
        let kept = shelf.database().is_some();
        let searcher = Searcher::open(shelf, embedder()?, Watch { progress: &report, cancel: &cancel });
        progress.finish();
        let searcher = searcher?;
        if let (true, Some(reason)) = (kept, searcher.news().0) {
            eprintln!("index made anew: {reason}");
        }
        if let Some(reason) = searcher.news().1 {
            eprintln!("warning: the index could not be kept: {reason}");
        }
        Ok(searcher)
    }

    /// Returns the model of an asset: kept in the database, or made now.
    ///
    /// # Errors
    /// `Assets` when there is no such asset or its file is damaged; `Input` when it cannot be made.
    pub fn model(&self, shelf: &Shelf<'_>, asset_id: &str) -> Result<Model3d, Error> {
        let annotation = shelf.get(asset_id)?;
        if let Some(model) = shelf.database().map(|d| d.model(asset_id)).transpose()?.flatten() {
            return Ok(model);
        }
        let (domain, object, seed) = match &annotation.origin {
            Origin::Generated { domain, object, seed } => (domain, object, *seed),
            Origin::Library { domain, object } => (domain, object, 0),
            Origin::Ingested { path, .. } => {
                return Err(Error::Input(format!(
                    "{asset_id}: its model, read from {path}, is not kept; ingest it again"
                )));
            }
        };
        let mut model = self.generate(domain, object, annotation.width_depth_height(), seed)?;
        model.name = asset_id.rsplit('/').next().unwrap_or_default().to_owned();
        Ok(model)
    }

    /// Makes a model of an object.
    ///
    /// # Errors
    /// `Input` when the domain or the object is not known, or it cannot be made at this size.
    pub fn generate(&self, domain: &str, object: &str, size_m: [f64; 3], seed: u64) -> Result<Model3d, Error> {
        let domain = crate::registry::domain(&self.registry, domain)?.domain();
        let object_type = domain.objects.iter().find(|o| o.id == object);
        let object_type =
            object_type.ok_or_else(|| Error::Input(format!("domain {} has no object `{object}`", domain.id)))?;
        let library = builds::Library::shipped().with(&domain.builds);
        builds::generate(&library, object_type, size_m, seed).map_err(|e| Error::Input(e.to_string()))
    }
}

/// Opens the database for reading when there is one; a folder named on the command line must hold one.
///
/// # Errors
/// As [`World::shelf`].
pub fn existing(args: &StoreArgs) -> Result<Option<Database>, Error> {
    match (if_there(args)?, &args.store) {
        (None, Some(dir)) => {
            Err(Error::Input(format!("{} holds no database; `assets ingest` makes one", dir.display())))
        }
        (found, _) => Ok(found),
    }
}

/// Opens the database for reading when there is one.
///
/// # Errors
/// `Assets` when it is damaged.
pub fn if_there(args: &StoreArgs) -> Result<Option<Database>, Error> {
    let Ok(dir) = args.folder() else { return Ok(None) };
    match Database::open(&dir, Access::Read, &Options::default()) {
        Ok(database) => Ok(Some(database)),
        Err(d3dgen_assets::Error::Store(d3dgen_store::Error::NotFound { .. })) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Opens the database for changes, made if it is not there.
///
/// # Errors
/// `Input` without a folder; `Assets` when another process writes it or it is damaged.
pub fn open(args: &StoreArgs) -> Result<Database, Error> {
    let dir = args.folder()?;
    if let Some(parent) = dir.parent().filter(|p| !p.as_os_str().is_empty()) {
        std::fs::create_dir_all(parent).map_err(|source| Error::Write { path: parent.to_path_buf(), source })?;
    }
    Ok(Database::open_or_create(&dir, &Options::default())?)
}

/// Returns who changes assets now, and why.
pub fn by(who: Option<&str>, why: &str) -> Provenance {
    let p = provenance(who, why);
    Provenance { who: p.who, when: p.when, why: p.why }
}

/// Returns an extent for a table.
pub fn size_text([x, y, z]: [f64; 3]) -> String {
    format!("{x:.2} x {y:.2} x {z:.2}")
}

/// Writes a picture as a PNG file.
///
/// # Errors
/// `Write`.
pub fn write_picture(path: &Path, picture: &Picture) -> Result<(), Error> {
    let bytes = picture.png().map_err(|e| Error::Input(format!("the picture cannot be written: {e}")))?;
    std::fs::write(path, bytes).map_err(|source| Error::Write { path: path.to_path_buf(), source })
}

/// Returns a line of JSON about an asset that was found.
pub fn json_line(found: &Found) -> serde_json::Value {
    let a = &found.annotation;
    serde_json::json!({
        "asset_id": a.asset_id, "name": a.name, "object": a.object, "kind": a.kind, "size_m": a.size_m,
        "score": found.score, "reasons": found.reasons, "annotation": a,
    })
}
