//! SHA-256 of bytes, of files, and of the files of a world.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use data_encoding::HEXLOWER;
use sha2::{Digest, Sha256};

use crate::error::Error;

/// Returns the SHA-256 of bytes, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    HEXLOWER.encode(&Sha256::digest(bytes))
}

/// Returns the SHA-256 of a file, hexadecimal.
///
/// # Errors
/// `Read`.
pub fn sha256_of_file(path: &Path) -> Result<String, Error> {
    let mut file = File::open(path).map_err(Error::read(path))?;
    let (mut hash, mut buffer) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        let n = file.read(&mut buffer).map_err(Error::read(path))?;
        if n == 0 {
            return Ok(HEXLOWER.encode(&hash.finalize()));
        }
        hash.update(&buffer[..n]);
    }
}

/// Returns what tells a world from every other: the SHA-256 over extension and SHA-256 of each of its files by extension, what
/// is only known of it (`json`) aside.
pub fn of_members<'a>(members: impl IntoIterator<Item = (&'a str, &'a str)>) -> String {
    let mut sorted: Vec<(&str, &str)> = members.into_iter().filter(|(ext, _)| *ext != "json").collect();
    sorted.sort_unstable();
    let mut hash = Sha256::new();
    for (ext, sum) in sorted {
        hash.update(format!("{ext}\0{sum}\n"));
    }
    HEXLOWER.encode(&hash.finalize())
}

/// A writer that sums what passes.
pub struct Summed<W> {
    inner: W,
    hash: Sha256,
    bytes: u64,
}

impl<W: Write> Summed<W> {
    /// Returns a writer into `inner`.
    pub fn new(inner: W) -> Self {
        Self { inner, hash: Sha256::new(), bytes: 0 }
    }

    /// Returns the inner writer, the SHA-256 of what passed, and how many bytes that were.
    pub fn finish(self) -> (W, String, u64) {
        (self.inner, HEXLOWER.encode(&self.hash.finalize()), self.bytes)
    }
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.hash.update(&bytes[..n]);
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
