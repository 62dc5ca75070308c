//! Tar files of worlds: the blocks that a run writes, and the shards of a finished data set. Both have the same form: the files
//! of a world stand together, `KEY.json` first, then the others by extension. Nothing in a header depends on when or where it
//! was written.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use flate2::{Compression, GzBuilder};

use crate::error::Error;
use crate::maker::Outcome;
use crate::tasks::TaskId;

/// Extension of what is known of a world.
pub const ROW: &str = "json";
/// Extension of the reason why a task came to no world, in blocks.
pub const FAILURE: &str = "failed.json";
/// Folder of shared models in blocks.
pub const MODELS: &str = "models/";

/// Compresses bytes; the same bytes give the same ones everywhere.
pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut writer = GzBuilder::new().mtime(0).operating_system(255).write(Vec::new(), Compression::new(6));
    writer.write_all(bytes).and_then(|()| writer.finish()).expect("memory takes what is written")
}

/// Writes a file beside its place, then puts it there: whole or not at all, also when the power goes.
///
/// # Errors
/// `Write`, or `Full` when the disk is.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut io::BufWriter<File>) -> io::Result<()>) -> Result<(), Error> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".tmp");
    let fresh = path.with_file_name(name);
    let written = File::create(&fresh).and_then(|file| {
        let mut file = io::BufWriter::new(file);
        write(&mut file)?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&fresh, path)
    });
    if written.is_err() {
        let _ = fs::remove_file(&fresh); // the error above is the one to report
    }
    written.map_err(Error::write(path))
}

/// Writes one tar file.
pub struct TarWriter<W: Write>(tar::Builder<W>);

impl<W: Write> TarWriter<W> {
    /// Returns a writer into `inner`.
    pub fn new(inner: W) -> Self {
        Self(tar::Builder::new(inner))
    }

    /// Adds a file.
    ///
    /// # Errors
    /// What the system says.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut header = tar::Header::new_ustar();
        header.set_entry_type(tar::EntryType::Regular);
        header.set_mode(0o644);
        header.set_mtime(0);
        header.set_size(bytes.len() as u64);
        self.0.append_data(&mut header, name, bytes)
    }

    /// Ends the tar file and returns the writer it went into.
    ///
    /// # Errors
    /// What the system says.
    pub fn finish(self) -> io::Result<W> {
        self.0.into_inner()
    }
}

/// Returns the bytes of a block: what became of some tasks, in their order.
pub fn block(outcomes: &[(TaskId, Outcome)]) -> Vec<u8> {
    write_block(outcomes).expect("memory takes what is written, and names of members fit a header")
}

fn write_block(outcomes: &[(TaskId, Outcome)]) -> io::Result<Vec<u8>> {
    let mut tar = TarWriter::new(Vec::new());
    let mut models = std::collections::BTreeMap::new();
    for (id, outcome) in outcomes {
        match outcome {
            Outcome::World(made) => {
                tar.add(&format!("{id}.{ROW}"), &serde_json::to_vec(&made.row)?)?;
                for (ext, bytes) in &made.members {
                    tar.add(&format!("{id}.{ext}"), bytes)?;
                }
                models.extend(made.models.iter());
            }
            Outcome::Nothing(failure) => tar.add(&format!("{id}.{FAILURE}"), &serde_json::to_vec(failure)?)?,
        }
    }
    for (name, bytes) in models {
        tar.add(&format!("{MODELS}{name}"), bytes)?;
    }
    tar.finish()
}

/// A member of a tar file, seen in passing.
pub struct Member<'a> {
    /// Its whole name.
    pub name: String,
    /// Where its header begins, bytes.
    pub header_at: u64,
    /// Where its bytes begin.
    pub bytes_at: u64,
    /// How many they are.
    pub size: u64,
    /// Its bytes.
    pub content: &'a mut dyn Read,
}

impl Member<'_> {
    /// Returns its bytes.
    ///
    /// # Errors
    /// What the system says.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.content.read_to_end(&mut bytes)?;
        if bytes.len() as u64 == self.size { Ok(bytes) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
    }

    /// Returns key and extension: what stands before and after the first dot of the file's name; none for a name without.
    pub fn key(&self) -> Option<(&str, &str)> {
        key(&self.name)
    }
}

/// Returns key and extension of a member's name.
pub fn key(name: &str) -> Option<(&str, &str)> {
    let base = name.rfind('/').map_or(0, |at| at + 1);
    let dot = base + name[base..].find('.')?;
    Some((&name[..dot], &name[dot + 1..]))
}

/// Goes through a tar file from a place on, until `each` says false.
///
/// # Errors
/// `Read`; `Damaged` when it is no tar file or cut off.
pub fn scan(path: &Path, from: u64, each: &mut dyn FnMut(&mut Member<'_>) -> Result<bool, Error>) -> Result<(), Error> {
    let mut file = File::open(path).map_err(Error::read(path))?;
    file.seek(SeekFrom::Start(from)).map_err(Error::read(path))?;
    let damaged = |e: io::Error| Error::damaged(path, format!("is no whole tar file: {e}"));
    let mut archive = tar::Archive::new(io::BufReader::with_capacity(1 << 16, file));
    for entry in archive.entries().map_err(damaged)? {
        let mut entry = entry.map_err(damaged)?;
        let name = String::from_utf8(entry.path_bytes().into_owned());
        let name = name.map_err(|_| Error::damaged(path, "has a member whose name is no text"))?;
        if !entry.header().entry_type().is_file() {
            return Err(Error::damaged(path, format!("`{name}` is no plain file")));
        }
        let (header_at, bytes_at) = (from + entry.raw_header_position(), from + entry.raw_file_position());
        let size = entry.size();
        if !each(&mut Member { name, header_at, bytes_at, size, content: &mut entry })? {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tar_file_is_the_same_whoever_writes_it_and_is_read_back_from_any_member() {
        let write = || {
            let mut tar = TarWriter::new(Vec::new());
            tar.add("a.json", b"{}").unwrap();
            tar.add(&format!("a.{}", "long".repeat(40)), b"12345").unwrap();
            tar.add("b.json", b"{ }").unwrap();
            tar.finish().unwrap()
        };
        assert_eq!(write(), write());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.tar");
        fs::write(&path, write()).unwrap();
        let mut found = Vec::new();
        scan(&path, 0, &mut |m| {
            found.push((m.name.clone(), m.header_at, m.read().unwrap().len()));
            Ok(true)
        })
        .unwrap();
        assert_eq!(found.iter().map(|f| f.2).collect::<Vec<_>>(), [2, 5, 3]);
        let mut last = Vec::new();
        scan(&path, found[2].1, &mut |m| {
            last.push(m.name.clone());
            Ok(true)
        })
        .unwrap();
        assert_eq!(last, ["b.json"]);
        fs::write(&path, &write()[..700]).unwrap();
        assert!(scan(&path, 0, &mut |m| m.read().map(|_| true).map_err(Error::read(Path::new("x")))).is_err());
    }

    #[test]
    fn keys_end_at_the_first_dot_of_the_file_name() {
        assert_eq!(key("a/b.c/w-1.plan.svg.gz"), Some(("a/b.c/w-1", "plan.svg.gz")));
        assert_eq!(key("a.b/c"), None);
    }

    #[test]
    fn a_file_is_whole_or_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        write_whole(&path, |f| f.write_all(b"old")).unwrap();
        let refused = write_whole(&path, |f| f.write_all(b"ne").and(Err(io::ErrorKind::StorageFull.into())));
        assert!(matches!(refused, Err(Error::Full(_))));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
