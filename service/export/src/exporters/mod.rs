//! One file per target; [`all`] is the list that `--format` and its help read.

mod arena;
mod gazebo;
mod gltf;
mod mujoco;
mod nav2;
pub mod plan;
mod rmf;
mod tasks;
mod usd;

use crate::error::Error;
pub use crate::file::File;
use crate::scene::SimScene;
use crate::subject::Subject;

pub use arena::Arena;
pub use gazebo::Gazebo;
pub use gltf::Gltf;
pub use mujoco::Mujoco;
pub use nav2::Nav2;
pub use plan::Plan;
pub use rmf::Rmf;
pub use tasks::Tasks;
pub use usd::Usd;

/// Name of all formats together.
const ALL: &str = "all";
/// Letters of a name that a refusal repeats.
const NAME_SHOWN: usize = 60;

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

    /// Returns true for what is written when nobody names a format.
    fn is_usual(&self) -> bool {
        false
    }

    /// Returns the files, sorted by path; a pure function of the subject.
    ///
    /// # Errors
    /// `Unsupported` or `TooLarge` when the format cannot hold this world, `Model` and `Kept` when a model of it cannot be
    /// had, `Picture` when drawing fails.
    fn export(&self, subject: &Subject<'_>) -> Result<Vec<File>, Error>;

    /// Returns where its files have what the ids of a scene name: id and place, for `manifest.json`. Nothing of what it leaves
    /// out.
    fn places(&self, scene: &SimScene, files: &[File]) -> Vec<(String, String)> {
        let _ = (scene, files);
        Vec::new()
    }
}

/// Returns every exporter, the default ones first.
pub fn all() -> &'static [&'static dyn Exporter] {
    &[&Arena, &Plan, &Nav2, &Rmf, &Mujoco, &Gazebo, &Gltf, &Usd, &Tasks]
}

/// Returns the names at the top of a world's folder that exporters write, each once.
pub fn roots() -> impl Iterator<Item = &'static str> {
    all().iter().flat_map(|e| e.roots()).copied()
}

/// Returns the exporter with this name.
pub fn get(name: &str) -> Option<&'static dyn Exporter> {
    all().iter().copied().find(|e| e.name() == name)
}

/// Returns those whose files are written when nobody names a format.
pub fn usual() -> impl Iterator<Item = &'static dyn Exporter> {
    all().iter().copied().filter(|e| e.is_usual())
}

/// Returns the exporters of a list of names, each once; `all` is the name of all of them.
///
/// # Errors
/// `NoFormat` with the names there are.
pub fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Vec<&'static dyn Exporter>, Error> {
    let mut found: Vec<&'static dyn Exporter> = Vec::new();
    for name in names {
        let of_name = if name == ALL { all().to_vec() } else { get(name).into_iter().collect() };
        if of_name.is_empty() {
            let known: Vec<&str> = all().iter().map(|e| e.name()).chain([ALL]).collect();
            let name = name.chars().take(NAME_SHOWN).collect();
            return Err(Error::NoFormat { name, known: known.join(", ") });
        }
        for exporter in of_name {
            if found.iter().all(|f| f.name() != exporter.name()) {
                found.push(exporter);
            }
        }
    }
    Ok(found)
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
        assert!(get("no_such_format").is_none() && get(ALL).is_none());
        let distinct: std::collections::BTreeSet<_> = roots().collect();
        assert_eq!(distinct.len(), roots().count(), "no two exporters write to one name");
    }

    #[test]
    fn lists_of_names_are_exporters_each_once() {
        let names = |list: &[&str]| named(list.iter().copied()).map(|l| l.iter().map(|e| e.name()).collect::<Vec<_>>());
        assert_eq!(names(&["plan", "arena", "plan"]).unwrap(), ["plan", "arena"]);
        assert_eq!(names(&["plan", "all"]).unwrap().len(), all().len());
        assert!(names(&[]).unwrap().is_empty() && usual().count() > 0);
        let refused = names(&["arena", "blend"]).unwrap_err().to_string();
        assert!(
            refused.starts_with("format `blend` is not known; there are ") && refused.contains("nav2"),
            "{refused}"
        );
    }

    #[test]
    fn what_worlds_share_is_told_from_what_is_a_worlds_own() {
        let is_shared = |path: &str| File::new(path, "").is_shared();
        assert!(is_shared("mujoco/models/Desk/Desk.obj") && is_shared("usd/textures/oak.png"));
        assert!(!is_shared("mujoco/world.xml") && !is_shared("models") && !is_shared("gltf/models.glb"));
        assert!(File::new("a", "abc").sha256().starts_with("ba7816bf8f01cfea414140de5dae2223"));
    }

    #[test]
    fn every_exporter_is_deterministic_and_writes_relative_sorted_paths() {
        let (world, domain) = (sample::world(), sample::domain());
        for exporter in all() {
            let files = exporter.export(&Subject::new(&world, &domain, &NothingKept)).unwrap();
            assert!(!files.is_empty());
            assert_eq!(files, exporter.export(&Subject::new(&world, &domain, &NothingKept)).unwrap());
            assert!(files.iter().all(|f| !f.path.starts_with('/') && !f.path.contains("..")));
            let root = |f: &File| f.path.split('/').next().unwrap_or_default().to_owned();
            let used: std::collections::BTreeSet<String> = files.iter().map(root).collect();
            let named = exporter.roots().iter().map(|r| (*r).to_owned()).collect();
            assert_eq!(used, named, "{} names the roots it writes to, and no others", exporter.name());
            assert!(files.windows(2).all(|p| p[0].path < p[1].path), "{} sorts its files", exporter.name());
        }
    }
}
