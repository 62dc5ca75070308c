//! What lies beside a model's file: metadata, the model of a simulator, telling folder names.
//!
//! Only named files in the model's folder and two above are looked at, never outside the folder that was asked for.

use std::path::{Path, PathBuf};

use crate::annotation::asa::{self, Asa};
use crate::plausibility::Simulator;

/// Metadata and model files are never larger, bytes.
const LARGEST: u64 = 1 << 20;
/// Folders above the model's own that may be about it.
const LEVELS: usize = 3;

/// What was found around a model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surroundings {
    /// Names of the folders it is in, the nearest first, below the folder that was asked for.
    pub folders: Vec<String>,
    /// The annotation beside it.
    pub metadata: Option<Asa>,
    /// What `model.config` calls it.
    pub title: Option<String>,
    /// What `model.config` says about it.
    pub description: Option<String>,
    /// The simulator's model around it.
    pub simulator: Option<Simulator>,
    /// Metadata that could not be read, for people.
    pub warnings: Vec<String>,
    /// Files that say something about it, in the order found.
    pub files: Vec<PathBuf>,
}

/// Looks around a model file, not above `root`.
pub fn look_around(file: &Path, root: Option<&Path>) -> Surroundings {
    let mut found = Surroundings::default();
    let stem = file.file_stem().map(|s| s.to_string_lossy().to_lowercase()).unwrap_or_default();
    let is_sdf = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("sdf"));
    let mut is_package = false;
    let root = root.filter(|r| file.starts_with(r));
    for folder in file.ancestors().skip(1).take(LEVELS) {
        let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if found.metadata.is_none() {
            metadata(folder, &stem, &name, &mut found);
        }
        if !is_package && is_model(folder, is_sdf) {
            is_package = true;
            if !is_sdf {
                simulator(folder, file, &mut found);
            }
            config(folder, &mut found);
        }
        if root == Some(folder) {
            break;
        }
        found.folders.push(name);
    }
    found
}

/// Reads `<stem>.annotation.yaml`, or `annotation.yaml` where it is about this model.
fn metadata(folder: &Path, stem: &str, folder_name: &str, found: &mut Surroundings) {
    let own = folder.join(format!("{stem}.annotation.yaml"));
    for (path, is_own) in [(own, true), (folder.join("annotation.yaml"), false)] {
        let Some(text) = read(&path) else { continue };
        match asa::read(&text) {
            Ok(asa) => {
                let about = asa.name.as_deref().map(str::to_lowercase);
                let fits = about.is_none_or(|n| n == stem || n == folder_name.to_lowercase());
                if is_own || fits {
                    found.metadata = Some(asa);
                    found.files.push(path);
                    return;
                }
            }
            Err(reason) => found.warnings.push(format!("{} {reason}", path.display())),
        }
    }
}

/// Tells whether a folder is that of a Gazebo model. Of an SDF file it is its own, whatever it is called.
fn is_model(folder: &Path, is_sdf: bool) -> bool {
    folder.join("model.sdf").is_file() || is_sdf
}

/// Reads what the `model.sdf` of a Gazebo model folder says of a mesh.
fn simulator(folder: &Path, file: &Path, found: &mut Surroundings) {
    let path = folder.join("model.sdf");
    let Some(text) = read(&path) else { return };
    let Ok(document) = roxmltree::Document::parse(&text) else { return };
    let name = file.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let meshes = document.descendants().filter(|n| n.has_tag_name("mesh"));
    let of_this = |mesh: &roxmltree::Node<'_, '_>| {
        let uri = mesh.children().find(|n| n.has_tag_name("uri")).and_then(|n| n.text()).unwrap_or_default();
        uri.trim().rsplit(['/', '\\']).next().unwrap_or_default().to_lowercase() == name
    };
    let scale = meshes.filter(of_this).map(|mesh| {
        let text = mesh.children().find(|n| n.has_tag_name("scale")).and_then(|n| n.text()).unwrap_or("1 1 1");
        let figures: Vec<f64> = text.split_whitespace().filter_map(|f| f.parse().ok()).collect();
        match figures[..] {
            [x, y, z] if [x, y, z].iter().all(|f: &f64| f.is_finite() && *f != 0.0) => [x, y, z],
            _ => [1.0; 3],
        }
    });
    found.simulator = Some(Simulator { scale: scale.into_iter().next() });
    found.files.push(path);
}

/// Reads `model.config` of a Gazebo model folder.
fn config(folder: &Path, found: &mut Surroundings) {
    let config = folder.join("model.config");
    if let Some(text) = read(&config)
        && let Ok(document) = roxmltree::Document::parse(&text)
    {
        let texts = document.descendants().filter(|n| n.has_tag_name("description")).filter_map(|n| n.text());
        let joined = texts.map(|t| t.split_whitespace().collect::<Vec<_>>().join(" ")).find(|t| !t.is_empty());
        found.title = crate::readers::sdf::config_of(&text).name.map(|n| n.chars().take(100).collect());
        found.description = joined.map(|t| t.chars().take(500).collect());
        found.files.push(config);
    }
}

/// Returns the text of a plain file that is not too large.
fn read(path: &Path) -> Option<String> {
    let meta = std::fs::symlink_metadata(path).ok()?;
    (meta.is_file() && meta.len() <= LARGEST).then(|| std::fs::read_to_string(path).ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metadata_and_simulator_models_are_found() {
        let home = tempfile::tempdir().expect("a folder");
        let meshes = home.path().join("IVStand/meshes");
        std::fs::create_dir_all(&meshes).expect("made");
        let write = |path: &str, text: &str| std::fs::write(home.path().join(path), text).expect("written");
        write("annotation.yaml", "name: something_else\n");
        write(
            "IVStand/model.sdf",
            "<sdf><model><link><visual><geometry><mesh><uri>model://IVStand/meshes/iv.obj</uri>\
               <scale>0.5 0.5 0.5</scale></mesh></geometry></visual></link></model></sdf>",
        );
        write("IVStand/model.config", "<model><name>x</name><description>A stand\n for drips</description></model>");
        let file = meshes.join("iv.obj");
        let found = look_around(&file, Some(home.path()));
        assert_eq!(found.folders, ["meshes", "IVStand"]);
        assert_eq!(found.simulator, Some(Simulator { scale: Some([0.5; 3]) }));
        assert_eq!(found.description.as_deref(), Some("A stand for drips"));
        assert_eq!(found.metadata, None);
        write("IVStand/annotation.yaml", "name: IVStand\ntags: [kind::equipment]\n");
        let found = look_around(&file, Some(home.path()));
        assert_eq!(found.metadata.map(|m| m.name), Some(Some("IVStand".into())));
        assert_eq!(
            look_around(&meshes.join("other.dae"), Some(home.path())).simulator,
            Some(Simulator { scale: None })
        );
        write("IVStand/annotation.yaml", "name: [\n");
        assert_eq!(look_around(&file, Some(home.path())).warnings.len(), 1);
    }
}
