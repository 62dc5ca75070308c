//! Readers of other programs' 3D files: one file a format, and the one list of them.
//!
//! Files are not trusted: every count is checked before memory is taken for it, every path before a file is opened, and
//! whoever reads files of others does so in a process of its own ([`Pool`]).

mod builder;
mod child;
mod dae;
mod facts;
mod folder;
mod frame;
mod gltf;
mod meshopt;
mod obj;
mod pool;
pub(crate) mod sdf;
mod stl;
mod usd;
mod wire;

use std::path::{Path, PathBuf};

pub use child::run_child;
pub use facts::{Bounds, Facts, Feature, ReadModel, Refusal, TextureFact};
pub use folder::Folder;
pub use pool::{Limits, Pool, Program, Worker};

/// A file as a reader gets it.
pub struct Source<'a> {
    /// Its name without folder.
    pub name: PathBuf,
    /// Its content.
    pub bytes: &'a [u8],
    /// The folder it is in, through which it reaches other files.
    pub folder: &'a Folder,
}

/// Reads one format.
pub trait Reader: Sync {
    /// Returns the name of the format.
    fn name(&self) -> &'static str;

    /// Returns the endings of its files, in small letters.
    fn endings(&self) -> &'static [&'static str];

    /// Tells whether a file is of the format by its first kilobyte, and, where the content cannot tell, by its ending.
    fn recognizes(&self, head: &[u8], ending: &str) -> bool;

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// When it is no model that can be used; with the facts, as far as they are known.
    fn read(&self, source: &Source) -> Result<ReadModel, Refusal>;
}

/// Returns all readers, in the order in which they are asked.
pub fn all() -> &'static [&'static dyn Reader] {
    &[&usd::Usd, &gltf::Gltf, &dae::Dae, &sdf::Sdf, &obj::Obj, &stl::Stl]
}

/// Tells whether a file is a model by its ending, for those who walk through folders.
pub fn is_model(path: &Path) -> bool {
    let ending = ending(path);
    all().iter().any(|r| r.endings().contains(&ending.as_str()))
}

/// Reads the model in a file. It may name files in `root`, or, when that is none, in its own folder and a few above.
/// Files of others are read through a [`Pool`], which holds this to limits.
///
/// # Errors
///
/// When it is no model that can be used; with the facts, as far as they are known.
pub fn read(path: &Path, root: Option<&Path>) -> Result<ReadModel, Refusal> {
    let (folder, name) = Folder::of(path, root)?;
    let bytes = folder.read_own(&name)?;
    let own = folder.file(&name);
    let mut read = read_bytes(&bytes, name, &folder)?;
    // A name that is no text cannot cross to another process.
    read.companions = folder.used().into_iter().filter(|f| own.as_ref() != Some(f) && f.to_str().is_some()).collect();
    Ok(read)
}

/// Reads a model from the content of a file.
///
/// # Errors
///
/// As of [`read`].
pub fn read_bytes(bytes: &[u8], name: PathBuf, folder: &Folder) -> Result<ReadModel, Refusal> {
    if bytes.is_empty() {
        return Err("is empty: 0 bytes".into());
    }
    let head = bytes.get(..1024.min(bytes.len())).unwrap_or_default();
    let ending = ending(&name);
    let by_ending = all().iter().find(|r| r.endings().contains(&ending.as_str()));
    match all().iter().find(|r| r.recognizes(head, &ending)) {
        Some(found) if by_ending.is_some_and(|r| r.name() != found.name()) => {
            Err(format!("is called .{ending} and is {} inside; give it that ending", found.name()).into())
        }
        Some(reader) => reader.read(&Source { name, bytes, folder }),
        None => Err(unknown(head, &ending, by_ending.is_some())),
    }
}

/// First bytes of files that are often found under the name of a model.
const OTHERS: &[(&[u8], &str)] = &[
    (b"version https://git-lfs", "a pointer of Git LFS instead of the file; run `git lfs pull` in its repository"),
    (b"<!DOCTYPE html", "a web page, perhaps of a failed download"),
    (b"<!doctype html", "a web page, perhaps of a failed download"),
    (b"<html", "a web page, perhaps of a failed download"),
    (b"PK\x03\x04", "a ZIP archive; unpack it"),
    (b"PK\x05\x06", "an empty ZIP archive"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"Ogawa", "Alembic, which is not read; convert it to USD"),
    (b"Kaydara FBX", "FBX, which is not read; convert it to GLB"),
    (b"BLENDER", "a Blender file, which is not read; export it as GLB"),
];

fn unknown(head: &[u8], ending: &str, known: bool) -> Refusal {
    match OTHERS.iter().find(|(magic, _)| head.starts_with(magic)) {
        Some((_, what)) => format!("is {what}").into(),
        None if known => {
            format!("does not begin as a .{ending} file does: it is damaged, cut off or something else").into()
        }
        None => {
            let mut endings: Vec<&str> = all().iter().flat_map(|r| r.endings()).copied().collect();
            endings.sort_unstable();
            format!("is of no known format; models end in {}", endings.join(", ")).into()
        }
    }
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}
