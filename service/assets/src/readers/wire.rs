//! What the process that reads models and the one that started it tell each other: frames of a length and postcard.
//!
//! What it is not for: other programs; both sides are always the same release.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// A file to read.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    /// The file.
    pub path: Name,
    /// The folder that bounds what else is read.
    pub root: Option<Name>,
}

/// A path in the bytes of the system: names of files need not be UTF-8.
#[derive(Debug, Serialize, Deserialize)]
pub struct Name(Vec<u8>);

impl Name {
    /// Returns a path as it is sent.
    #[cfg(unix)]
    pub fn of(path: &Path) -> Self {
        use std::os::unix::ffi::OsStrExt;
        Self(path.as_os_str().as_bytes().to_vec())
    }

    /// Returns a path as it is sent.
    #[cfg(not(unix))]
    pub fn of(path: &Path) -> Self {
        Self(path.to_string_lossy().into_owned().into_bytes())
    }

    /// Returns the path.
    #[cfg(unix)]
    pub fn path(&self) -> PathBuf {
        use std::os::unix::ffi::OsStrExt;
        PathBuf::from(std::ffi::OsStr::from_bytes(&self.0))
    }

    /// Returns the path.
    #[cfg(not(unix))]
    pub fn path(&self) -> PathBuf {
        PathBuf::from(String::from_utf8_lossy(&self.0).into_owned())
    }
}

/// Writes one message.
///
/// # Errors
///
/// When it cannot be written.
pub fn send(output: &mut impl Write, message: &impl Serialize) -> std::io::Result<()> {
    let bytes = postcard::to_stdvec(message).map_err(std::io::Error::other)?;
    let length = u32::try_from(bytes.len()).map_err(std::io::Error::other)?;
    output.write_all(&length.to_le_bytes())?;
    output.write_all(&bytes)?;
    output.flush()
}

/// Reads one message of at most `most` bytes; none at the end.
///
/// # Errors
///
/// When it cannot be read, is too long, or is no message.
pub fn receive<T: DeserializeOwned>(input: &mut impl Read, most: u64) -> std::io::Result<Option<T>> {
    let mut length = [0u8; 4];
    match input.read_exact(&mut length) {
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(None),
        other => other?,
    }
    let length = u64::from(u32::from_le_bytes(length));
    if length > most {
        return Err(std::io::Error::other(format!("a message of {length} bytes")));
    }
    let mut bytes = Vec::new();
    input.take(length).read_to_end(&mut bytes)?;
    postcard::from_bytes(&bytes).map(Some).map_err(std::io::Error::other)
}
