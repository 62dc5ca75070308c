//! Which files of a folder are models, and what tells whether they are known already.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

use super::packages::leave_parts_out;
use crate::annotate::look_around;
use crate::error::Error;

/// Endings of models, small letters.
const ENDINGS: &[&str] = &["usd", "usda", "usdc", "usdz", "glb", "gltf", "obj", "dae", "stl", "sdf"];
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
    /// What is by its name only the shape that collides of another model, with a word on that.
    pub shapes: Vec<(String, String)>,
}

/// Lists the models of a folder, without the files that are parts of others, or takes one file. Links are not followed.
///
/// # Errors
/// `File` when the folder cannot be read.
pub fn walk(folder: &Path) -> Result<Walk, Error> {
    let failed = |source| Error::File { path: folder.to_path_buf(), source };
    let meta = std::fs::metadata(folder).map_err(failed)?;
    if !meta.is_dir() {
        let root = folder.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf();
        let name = folder.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        return Ok(Walk { root, models: vec![(name, folder.to_path_buf())], ..Walk::default() });
    }
    let mut found = Walk { root: folder.to_path_buf(), ..Walk::default() };
    descend(folder, "", 0, &mut found).map_err(failed)?;
    found.models.sort();
    found.shapes = leave_parts_out(folder, &mut found.models);
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
        add(&mut hash, path)?;
    }
    Ok(HEXLOWER.encode(&hash.finalize()))
}

/// Returns the digests of the files that a model is made of beside its own, by their paths below the root; those that
/// are elsewhere or cannot be read are left out.
pub(super) fn digests(companions: &[PathBuf], root: &Path) -> BTreeMap<String, String> {
    let Ok(root) = root.canonicalize() else { return BTreeMap::new() };
    let one = |file: &PathBuf| Some((slashed(file.strip_prefix(&root).ok()?)?, of_file(file).ok()?));
    companions.iter().filter_map(one).collect()
}

/// Tells whether files below the root are as they were.
pub(super) fn are_unchanged(companions: &BTreeMap<String, String>, root: &Path) -> bool {
    companions.iter().all(|(path, digest)| of_file(&root.join(path)).is_ok_and(|now| now == *digest))
}

/// Returns the companions of a model as a copy of it elsewhere names them: what lies in the model's folder is looked for
/// in the copy's.
pub(super) fn beside(companions: &BTreeMap<String, String>, model: &str, copy: &str) -> BTreeMap<String, String> {
    let folder = |path: &str| path.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
    let (from, to) = (folder(model), folder(copy));
    let moved = |path: &String| path.strip_prefix(&from).map_or_else(|| path.clone(), |rest| format!("{to}{rest}"));
    companions.iter().map(|(path, digest)| (moved(path), digest.clone())).collect()
}

fn of_file(file: &Path) -> Result<String, String> {
    let mut hash = Sha256::new();
    add(&mut hash, file)?;
    Ok(HEXLOWER.encode(&hash.finalize()))
}

fn add(hash: &mut Sha256, path: &Path) -> Result<(), String> {
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
            return Ok(());
        }
        hash.update(&page[..n]);
    }
}

fn slashed(path: &Path) -> Option<String> {
    let parts: Option<Vec<&str>> = path.iter().map(|part| part.to_str()).collect();
    Some(parts?.join("/"))
}
