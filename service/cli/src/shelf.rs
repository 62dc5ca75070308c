//! A folder of models that many worlds share: each file once, named by its contents.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use d3dgen_export::File;

use crate::error::Error;

/// Digits of a digest that name the folder of a file, so that no folder gets too long to list.
const FOLDER_DIGITS: usize = 2;

/// A folder of files by their contents: `ab/abcd….obj`.
pub struct Shelf(PathBuf);

impl Shelf {
    /// Returns the shelf in a folder, which is made where it is not there.
    ///
    /// # Errors
    /// `Write` when it cannot be made.
    pub fn at(folder: &Path) -> Result<Self, Error> {
        fs::create_dir_all(folder).map_err(|source| Error::Write { path: folder.to_path_buf(), source })?;
        Ok(Self(folder.to_path_buf()))
    }

    /// Returns where a file is kept; one that is new is put there, whole or not at all.
    ///
    /// # Errors
    /// `Write`.
    pub fn place(&self, file: &File) -> Result<PathBuf, Error> {
        let digest = file.sha256();
        let extension = Path::new(&file.path).extension().and_then(|e| e.to_str()).unwrap_or("bin");
        let folder = self.0.join(&digest[..FOLDER_DIGITS]);
        let place = folder.join(format!("{digest}.{extension}"));
        // One of another length was changed by somebody, through a world that shares it.
        if fs::metadata(&place).is_ok_and(|found| found.len() == file.bytes.len() as u64) {
            return Ok(place);
        }
        put(&folder, &place, &file.bytes).map_err(|source| Error::Write { path: place.clone(), source })?;
        Ok(place)
    }
}

fn put(folder: &Path, place: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let fresh = tempfile::NamedTempFile::new_in(folder)?;
    fs::write(fresh.path(), bytes)?;
    readable(fresh.path())?;
    fresh.persist(place)?;
    Ok(())
}

/// Lets everybody read a file, as other files of a world may be read; temporary ones are their owner's alone.
#[cfg(unix)]
fn readable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use tempfile::TempDir;

    use super::*;

    #[test]
    fn a_file_is_kept_once_and_put_back_where_it_was_cut_off() {
        let home = TempDir::new().unwrap();
        let shelf = Shelf::at(&home.path().join("models")).unwrap();
        let [desk, chair] = ["usd/models/desk.png", "mujoco/models/chair.png"].map(|path| File::new(path, "wood"));
        let place = shelf.place(&desk).unwrap();
        assert_eq!(shelf.place(&chair).unwrap(), place, "the same contents are one file");
        assert_eq!(fs::read(&place).unwrap(), b"wood");
        fs::write(&place, "wo").unwrap();
        shelf.place(&desk).unwrap();
        assert_eq!(fs::read(&place).unwrap(), b"wood");
        assert!(shelf.place(&File::new("usd/models/lamp.png", "light")).unwrap() != place);
    }
}
