//! Who may write: an advisory lock on a file in the store's folder, which the system lets go of when a process dies.
//!
//! It keeps writers apart, and with a backend that serves one process also readers from writers. It does not keep
//! anybody out of the files who does not ask for it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::Duration;

use crate::error::{Error, Result};

/// Name of the file. It stays when the lock is let go: to remove it would let two processes lock two files.
pub(crate) const FILE: &str = "writer.lock";

/// Pause between two tries.
pub(crate) const PAUSE: Duration = Duration::from_millis(20);

/// How many tries with [`PAUSE`] between them fill `wait`, the first one not counted.
pub(crate) fn retries(wait: Duration) -> u128 {
    wait.as_millis().div_ceil(PAUSE.as_millis())
}

/// Holds the lock until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    file: File,
}

impl Lock {
    /// Takes the lock of the store in `dir`, trying for about `wait`. `shared` says whether readers need it not.
    ///
    /// # Errors
    /// [`Error::InUse`] with the holder's process; [`Error::Io`] when the file cannot be made.
    pub(crate) fn take(dir: &Path, wait: Duration, shared: bool) -> Result<Self> {
        let path = dir.join(FILE);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(Error::io(&path))?;
        let mut left = retries(wait);
        loop {
            match file.try_lock() {
                Ok(()) => break,
                Err(TryLockError::WouldBlock) if left > 0 => std::thread::sleep(PAUSE),
                Err(TryLockError::WouldBlock) => {
                    return Err(Error::InUse { dir: dir.to_path_buf(), pid: holder(&mut file), shared });
                }
                Err(TryLockError::Error(source)) => return Err(Error::Io { path, source }),
            }
            left -= 1;
        }
        // Only a message needs the number, so that a full disk keeps nobody from opening the store.
        let _ = note(&mut file, &std::process::id().to_string());
        Ok(Self { file })
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = note(&mut self.file, "");
        // Explicitly, because a child that was being started in this moment may still hold a copy of the file.
        let _ = self.file.unlock();
    }
}

/// Returns the process that noted its number, if it has done so by now.
pub(crate) fn holder(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.seek(SeekFrom::Start(0)).ok()?;
    file.take(20).read_to_string(&mut text).ok()?;
    text.trim().parse().ok()
}

fn note(file: &mut File, text: &str) -> std::io::Result<()> {
    file.set_len(0)?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(text.as_bytes())
}
