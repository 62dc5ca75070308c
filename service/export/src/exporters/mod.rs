//! One file per target; [`all`] is the list that `--format` and its help read.

mod arena;
mod nav2;
pub mod plan;
mod rmf;
mod tasks;

use d3dgen_model::domain::Domain;
use d3dgen_model::world::World;

use crate::Error;
use crate::models::KeptModels;

pub use arena::Arena;
pub use nav2::Nav2;
pub use plan::Plan;
pub use rmf::Rmf;
pub use tasks::Tasks;

/// A file to be written, relative to the world's output folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Relative path with forward slashes: `arena/worlds/ward/0/world.yaml`.
    pub path: String,
    /// Contents.
    pub bytes: Vec<u8>,
}

impl File {
    /// Returns a file.
    pub fn new(path: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { path: path.into(), bytes: bytes.into() }
    }
}

/// Turns a world into the files of one target.
pub trait Exporter: Sync {
    /// Returns the snake-case name used by `--format`.
    fn name(&self) -> &'static str;

    /// Returns one sentence on what it writes and who reads it.
    fn about(&self) -> &'static str;

    /// Returns the names that its files and folders have at the top of a world's folder: `["plan.svg"]`, `["arena"]`.
    ///
    /// They are its own: a folder that holds nothing but such names and the documents of a world may be written again.
    fn roots(&self) -> &'static [&'static str];

    /// Returns the files, sorted by path; a pure function of world, domain and kept models.
    ///
    /// # Errors
    /// `Unsupported` or `TooLarge` when the format cannot hold this world, `Model` and `Kept` when a model of it cannot be
    /// had, `Picture` when drawing fails.
    fn export(&self, world: &World, domain: &Domain, kept: &dyn KeptModels) -> Result<Vec<File>, Error>;
}

/// Returns every exporter, the default ones first.
pub fn all() -> &'static [&'static dyn Exporter] {
    &[&Arena, &Plan, &Nav2, &Rmf, &Tasks]
}

/// Returns the names at the top of a world's folder that exporters write, each once.
pub fn roots() -> impl Iterator<Item = &'static str> {
    all().iter().flat_map(|e| e.roots()).copied()
}

/// Returns the exporter with this name.
pub fn get(name: &str) -> Option<&'static dyn Exporter> {
    all().iter().copied().find(|e| e.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::NothingKept;
    use crate::sample;

    #[test]
    fn names_are_unique_and_described() {
        let names: std::collections::BTreeSet<_> = all().iter().map(|e| e.name()).collect();
        assert_eq!(names.len(), all().len());
        for exporter in all() {
            assert!(exporter.about().len() > 20, "{} needs a sentence", exporter.name());
            assert_eq!(get(exporter.name()).map(Exporter::name), Some(exporter.name()));
        }
        assert!(get("no_such_format").is_none());
        let distinct: std::collections::BTreeSet<_> = roots().collect();
        assert_eq!(distinct.len(), roots().count(), "no two exporters write to one name");
    }

    #[test]
    fn every_exporter_is_deterministic_and_writes_relative_sorted_paths() {
        let (world, domain) = (sample::world(), sample::domain());
        for exporter in all() {
            let files = exporter.export(&world, &domain, &NothingKept).unwrap();
            assert!(!files.is_empty());
            assert_eq!(files, exporter.export(&world, &domain, &NothingKept).unwrap());
            assert!(files.iter().all(|f| !f.path.starts_with('/') && !f.path.contains("..")));
            let root = |f: &File| f.path.split('/').next().unwrap_or_default().to_owned();
            let used: std::collections::BTreeSet<String> = files.iter().map(root).collect();
            let named = exporter.roots().iter().map(|r| (*r).to_owned()).collect();
            assert_eq!(used, named, "{} names the roots it writes to, and no others", exporter.name());
            assert!(files.windows(2).all(|p| p[0].path < p[1].path), "{} sorts its files", exporter.name());
        }
    }
}
