//! Files of models: one each, named by its digest, whole or not there.

use std::io::Write;
use std::path::{Path, PathBuf};

use d3dgen_mesh::Model3d;
use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

use crate::error::Error;

/// First bytes: what it is, and the form of what follows.
const MAGIC: &[u8] = b"d3dgen model 2\n";
const ENDING: &str = "model";
const PICTURE: &str = "png";

/// Writes a model, its picture first, and returns the model's digest. What is there already is left as it is.
///
/// # Errors
/// `File`.
pub(super) fn write(dir: &Path, model: &Model3d, picture: Option<&[u8]>) -> Result<String, Error> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend(postcard::to_allocvec(model).map_err(|e| failed(dir, std::io::Error::other(e)))?);
    let hash = digest(&bytes);
    if let Some(picture) = picture {
        write_whole(&path(dir, &hash, PICTURE), picture)?;
    }
    write_whole(&path(dir, &hash, ENDING), &bytes)?;
    Ok(hash)
}

fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    if path.is_file() {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(|e| failed(folder, e))?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_data()).map_err(|e| failed(path, e))?;
    file.persist(path).map_err(|e| failed(path, e.error))?;
    Ok(())
}

/// Reads the picture of a model; `None` of one that was kept without.
///
/// # Errors
/// `File` when it is there and cannot be read.
pub(super) fn picture(dir: &Path, hash: &str) -> Result<Option<Vec<u8>>, Error> {
    let path = path(dir, hash, PICTURE);
    match std::fs::read(&path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        read => read.map(Some).map_err(|e| failed(&path, e)),
    }
}

/// Reads a model.
///
/// # Errors
/// `File` when it is missing, or is not what was written.
pub(super) fn read(dir: &Path, hash: &str) -> Result<Model3d, Error> {
    let path = path(dir, hash, ENDING);
    let bytes = std::fs::read(&path).map_err(|e| failed(&path, e))?;
    let damaged = |what: &str| failed(&path, std::io::Error::other(format!("is damaged: {what}")));
    if digest(&bytes) != hash {
        return Err(damaged("its digest is another"));
    }
    let body = bytes.strip_prefix(MAGIC).ok_or_else(|| damaged("it was written by another release"))?;
    postcard::from_bytes(body).map_err(|e| damaged(&e.to_string()))
}

/// Removes a model's file and its picture, if they are there.
///
/// # Errors
/// `File`.
pub(super) fn remove(dir: &Path, hash: &str) -> Result<(), Error> {
    for path in [path(dir, hash, ENDING), path(dir, hash, PICTURE)] {
        match std::fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(failed(&path, e)),
            _ => {}
        }
    }
    Ok(())
}

/// Returns the digests of all files with their sizes, sorted.
///
/// # Errors
/// `File`.
pub(super) fn list(dir: &Path) -> Result<Vec<(String, u64)>, Error> {
    let mut found = Vec::new();
    let entries = |folder: &Path| -> Result<Vec<PathBuf>, Error> {
        match std::fs::read_dir(folder) {
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Vec::new()),
            Err(e) => Err(failed(folder, e)),
            Ok(all) => all.map(|e| e.map(|e| e.path()).map_err(|e| failed(folder, e))).collect(),
        }
    };
    for folder in entries(dir)?.into_iter().filter(|f| f.is_dir()) {
        for file in entries(&folder)?.into_iter().filter(|f| f.extension().is_some_and(|e| e == ENDING)) {
            let bytes = std::fs::metadata(&file).map_err(|e| failed(&file, e))?.len();
            found.push((file.file_stem().unwrap_or_default().to_string_lossy().into_owned(), bytes));
        }
    }
    found.sort();
    Ok(found)
}

/// Returns the SHA-256 of bytes, hexadecimal.
pub(crate) fn digest(bytes: &[u8]) -> String {
    HEXLOWER.encode(&Sha256::digest(bytes))
}

fn path(dir: &Path, hash: &str, ending: &str) -> PathBuf {
    dir.join(hash.get(..2).unwrap_or("__")).join(format!("{hash}.{ending}"))
}

fn failed(path: &Path, source: std::io::Error) -> Error {
    Error::File { path: path.to_path_buf(), source }
}
