//! A file of a world, before it is written.

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

/// Folders of what worlds share.
const SHARED: [&str; 3] = ["models", "textures", "Object"];

/// A file to be written, relative to the world's output folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Relative path with forward slashes: `arena/worlds/ward/0/world.yaml`.
    pub path: String,
    /// Contents.
    pub bytes: Vec<u8>,
}

impl File {
    /// Returns a file.
    pub fn new(path: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { path: path.into(), bytes: bytes.into() }
    }

    /// Returns the SHA-256 of its contents, lower-case hex.
    pub fn sha256(&self) -> String {
        HEXLOWER.encode(&Sha256::digest(&self.bytes))
    }

    /// Returns true for a file of a model or a surface, which is the same in every world that uses it.
    pub fn is_shared(&self) -> bool {
        let mut folders = self.path.split('/').rev().skip(1);
        folders.any(|folder| SHARED.contains(&folder))
    }
}
