//! The files of a run: written whole or not at all, read with every problem named by file and line.
//!
//! `run.json` remembers what was written, so that a file that a person has edited is never overwritten unseen.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use d3dgen_model::document::Document;
use d3dgen_model::knowledge::is_date;
use data_encoding::HEXLOWER;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::Error;
use crate::corpus::record::Record;

/// Name of the file that remembers.
pub const RUN: &str = "run.json";
/// The most problems that are listed for one file.
const MAX_PROBLEMS: usize = 50;

/// What a run was asked for, so that a restart needs no flags, and what it has written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Memory {
    /// Format version; 1.
    pub version: u32,
    /// Domain id.
    pub domain: String,
    /// Country the rules are wanted for, if any.
    pub country: Option<String>,
    /// Date of the run, `YYYY-MM-DD`.
    pub date: String,
    /// How the rules are found, one sentence.
    pub generated_by: String,
    /// SHA-256 of each stage file as written.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
}

/// The folder of a run.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Returns the folder, made if it is not there.
    ///
    /// # Errors
    /// `File` when it cannot be made.
    pub fn open(path: &Path) -> Result<Self, Error> {
        std::fs::create_dir_all(path).map_err(|e| Error::file("make", path, &e))?;
        Ok(Self { path: path.to_path_buf() })
    }

    /// Returns the path of a file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Returns what a file holds, `None` when it is not there.
    ///
    /// # Errors
    /// `File` when it is there and cannot be read as text.
    pub fn text(&self, name: &str) -> Result<Option<String>, Error> {
        let path = self.file(name);
        match std::fs::read_to_string(&path) {
            Ok(text) => Ok(Some(text)),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(Error::file("read", &path, &e)),
        }
    }

    /// Writes a file whole or not at all.
    ///
    /// # Errors
    /// `File`; what was there before is then still there.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let path = self.file(name);
        let folder = path.parent().unwrap_or(&self.path);
        let write = || {
            std::fs::create_dir_all(folder)?;
            let mut file = tempfile::Builder::new().prefix(".d3dgen-").suffix(".tmp").tempfile_in(folder)?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            file.persist(&path).map_err(|e| e.error)?;
            Ok(())
        };
        write().map_err(|e: std::io::Error| Error::file("write", &path, &e))
    }

    /// Returns the lines of a stage file; `None` when it is not there. Blank lines are skipped.
    ///
    /// # Errors
    /// `Problems` with every bad line.
    pub fn lines<R: Record>(&self) -> Result<Option<Vec<R>>, Error> {
        let Some(text) = self.text(R::FILE)? else { return Ok(None) };
        let mut records = Vec::new();
        let mut problems = Vec::new();
        for (i, line) in text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty()) {
            let place = format!("{}:{}", self.file(R::FILE).display(), i + 1);
            match serde_json::from_str::<R>(line) {
                Ok(record) => {
                    problems.extend(record.problems().into_iter().map(|p| format!("{place}: {p}")));
                    records.push(record);
                }
                Err(e) => {
                    let said = e.to_string();
                    problems.push(format!("{place}: {}", said.split(" at line ").next().unwrap_or_default()));
                }
            }
        }
        if problems.is_empty() { Ok(Some(records)) } else { Err(listed(problems)) }
    }

    /// Returns a checked document of the folder; `None` when it is not there.
    ///
    /// # Errors
    /// `Problems` with every problem and its path in the document.
    pub fn document<D: Document>(&self, name: &str) -> Result<Option<D>, Error> {
        let Some(text) = self.text(name)? else { return Ok(None) };
        D::from_json(&text).map(Some).map_err(|e| Error::of_document(&self.file(name).display().to_string(), e))
    }

    /// Returns what the last run remembers, `None` for a new folder.
    ///
    /// # Errors
    /// `Problems` when `run.json` is damaged.
    pub fn memory(&self) -> Result<Option<Memory>, Error> {
        let Some(text) = self.text(RUN)? else { return Ok(None) };
        let place = self.file(RUN).display().to_string();
        let memory: Memory =
            serde_json::from_str(&text).map_err(|e| Error::Problems(vec![format!("{place}: {e}; remove it")]))?;
        if memory.version == 1 && is_date(&memory.date) {
            Ok(Some(memory))
        } else {
            Err(Error::Problems(vec![format!("{place}: is of another version or has no date; remove it")]))
        }
    }

    /// Refuses to overwrite files that were edited since they were written.
    ///
    /// # Errors
    /// `Problems` naming each.
    pub fn check_unedited(&self, memory: Option<&Memory>, names: &[(&str, &str)]) -> Result<(), Error> {
        let Some(memory) = memory else { return Ok(()) };
        let mut problems = Vec::new();
        for (name, stage) in names {
            let (Some(text), Some(written)) = (self.text(name)?, memory.files.get(*name)) else { continue };
            if sha256(text.as_bytes()) != *written {
                let place = super::shown(&self.file(name));
                problems.push(if stage.is_empty() {
                    format!("{place}: was edited and would be lost; move it away, or allow that with --overwrite")
                } else {
                    format!("{place}: was edited and would be lost; go on from it with --from {stage}, or allow that with --overwrite")
                });
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(Error::Problems(problems)) }
    }
}

/// Returns records as JSON lines.
pub fn jsonl<R: Serialize>(records: &[R]) -> String {
    let mut text = String::new();
    for record in records {
        text += &serde_json::to_string(record).expect("records hold only finite numbers and string keys");
        text.push('\n');
    }
    text
}

/// Returns the SHA-256 of bytes, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    HEXLOWER.encode(&Sha256::digest(bytes))
}

/// Returns problems as an error, the first ones only where there are very many.
pub fn listed(mut problems: Vec<String>) -> Error {
    let more = problems.len().saturating_sub(MAX_PROBLEMS);
    if more > 0 {
        problems.truncate(MAX_PROBLEMS);
        problems.push(format!("... and {more} more"));
    }
    Error::Problems(problems)
}
