//! Which files of a folder are models, and what tells whether they are known already.

use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::annotate::look_around;
use crate::error::Error;

/// Endings of models, small letters.
const ENDINGS: &[&str] = &["usd", "usda", "usdc", "usdz", "glb", "gltf", "obj", "dae", "stl"];
/// Folders deeper than this are somebody's mistake, or a circle.
const DEEPEST: usize = 24;
/// Larger files are not read, bytes.
const LARGEST: u64 = 256 << 20;

/// What a folder holds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Walk {
    /// The folder, or that of the file asked for.
    pub root: PathBuf,
    /// Models: path below the root with `/`, and the file; by path.
    pub models: Vec<(String, PathBuf)>,
    /// What looks like a model and is not taken, with the reason.
    pub refused: Vec<(String, String)>,
}

/// Lists the models of a folder, or takes one file. Links are not followed.
///
/// # Errors
/// `File` when the folder cannot be read.
pub fn walk(folder: &Path) -> Result<Walk, Error> {
    let failed = |source| Error::File { path: folder.to_path_buf(), source };
    let meta = std::fs::metadata(folder).map_err(failed)?;
    if !meta.is_dir() {
        let root = folder.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf();
        let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        return Ok(Walk { root, models: vec![(name, folder.to_path_buf())], refused: Vec::new() });
    }
    let mut found = Walk { root: folder.to_path_buf(), ..Walk::default() };
    descend(folder, "", 0, &mut found).map_err(failed)?;
    found.models.sort();
    found.refused.sort();
    Ok(found)
}

fn descend(folder: &Path, below: &str, depth: usize, found: &mut Walk) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let (kind, name) = (entry.file_type()?, entry.file_name().to_string_lossy().into_owned());
        let path = if below.is_empty() { name.clone() } else { format!("{below}/{name}") };
        if kind.is_dir() {
            if name.starts_with('.') {
                continue;
            }
            let reason = match depth < DEEPEST {
                true => descend(&entry.path(), &path, depth + 1, found).err().map(|e| format!("cannot be read: {e}")),
                false => Some(format!("is {DEEPEST} folders deep; nothing below it is looked at")),
            };
            found.refused.extend(reason.map(|reason| (path, reason)));
            continue;
        }
        let ending = Path::new(&name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if !ENDINGS.contains(&ending.as_str()) {
            continue;
        }
        match kind.is_file() {
            true => found.models.push((path, entry.path())),
            false => found.refused.push((path, "is no plain file; links and devices are not followed".into())),
        }
    }
    Ok(())
}

/// Returns the digest of a model's file and of what lies beside it and speaks of it.
///
/// # Errors
/// Why it cannot be read, for people.
pub(super) fn digest(file: &Path, root: &Path) -> Result<String, String> {
    let mut hash = Sha256::new();
    let beside = look_around(file, Some(root)).files;
    for path in std::iter::once(file).chain(beside.iter().map(PathBuf::as_path)) {
        let handle = std::fs::File::open(path).map_err(|e| format!("cannot be read: {e}"))?;
        let length = handle.metadata().map_err(|e| format!("cannot be read: {e}"))?.len();
        if length > LARGEST {
            return Err(format!("is {} MiB large, at most {} MiB are read", length >> 20, LARGEST >> 20));
        }
        hash.update(length.to_le_bytes());
        let (mut handle, mut page) = (handle.take(LARGEST), vec![0; 1 << 16]);
        loop {
            let n = handle.read(&mut page).map_err(|e| format!("cannot be read: {e}"))?;
            if n == 0 {
                break;
            }
            hash.update(&page[..n]);
        }
    }
    Ok(hash.finalize().iter().map(|b| format!("{b:02x}")).collect())
}
