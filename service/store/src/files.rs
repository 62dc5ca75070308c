//! Files that are there whole or not at all.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::error::{Error, Result};

/// How the names of files begin that are not finished yet.
pub(crate) const UNFINISHED: &str = ".unfinished-";

/// Writes `path` with what `fill` writes: beside it first, then in its place in one step that a crash cannot halve.
/// `replace` says whether a file of that name may be there.
pub(crate) fn write_whole(
    path: &Path,
    replace: bool,
    fill: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> Result<()>,
) -> Result<()> {
    let dir = folder_of(path);
    if !replace && path.symlink_metadata().is_ok() {
        return Err(Error::Exists { path: path.to_path_buf() });
    }
    let mut unfinished = new_file(&dir).map_err(Error::io(path))?;
    let mut writer = BufWriter::with_capacity(1 << 16, &mut unfinished);
    fill(&mut writer)?;
    writer.flush().map_err(Error::io(path))?;
    drop(writer);
    unfinished.as_file().sync_all().map_err(Error::io(path))?;
    let put = if replace { unfinished.persist(path) } else { unfinished.persist_noclobber(path) };
    put.map_err(|e| match e.error.kind() {
        std::io::ErrorKind::AlreadyExists => Error::Exists { path: path.to_path_buf() },
        _ => Error::io(path)(e.error),
    })?;
    sync_folder(&dir)
}

/// Room that a change must leave on the disk, bytes: enough for what a database adds to what it is given.
const ROOM: u64 = 4 << 20;

/// Returns an error when the disk has no room for so many bytes more, and for what storing them takes besides.
///
/// Asked before a change it costs nothing; a database that runs out of room in the middle has to be opened again.
pub(crate) fn check_room(path: &Path, bytes: u64) -> Result<()> {
    #[cfg(unix)]
    if let Ok(disk) = rustix::fs::statvfs(folder_of(path)) {
        let free = disk.f_bavail.saturating_mul(disk.f_frsize);
        if free < ROOM.saturating_add(bytes.saturating_mul(2)) {
            return Err(Error::Full { path: path.to_path_buf() });
        }
    }
    Ok(())
}

/// Bytes of a trial of whether a file can grow.
const TRIAL: usize = 256 << 10;

/// Returns an error when no file beside this one can grow, by letting one grow: what a quota leaves, no disk tells.
pub(crate) fn try_room(path: &Path) -> Result<()> {
    let mut trial = new_file(&folder_of(path)).map_err(Error::io(path))?;
    trial.write_all(&vec![0; TRIAL]).and_then(|()| trial.as_file().sync_data()).map_err(Error::io(path))
}

/// Makes the names in a folder durable: a renamed file may otherwise be gone after a power failure.
pub(crate) fn sync_folder(dir: &Path) -> Result<()> {
    // Other systems do not open folders as files, and write names through.
    if cfg!(unix) {
        File::open(dir).and_then(|d| d.sync_all()).map_err(Error::io(dir))?;
    }
    Ok(())
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(dir) if !dir.as_os_str().is_empty() => dir.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

fn new_file(dir: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(UNFINISHED);
    // A temporary file would be private; this one becomes a file like any other.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(dir)
}
