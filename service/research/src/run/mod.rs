//! A whole run: documents or a model's search -> passages -> constraints -> corpus -> knowledge base.
//!
//! Each stage leaves a file in the output folder, and any stage can start again from the file before it. What it is not
//! for: flags, the clock, the environment; they are values of [`Plan`] and [`Context`].

mod agent;
mod extraction;
mod files;
mod gather;
mod report;
mod sidecar;
mod stages;

use std::future::Future;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::{Error, read};

pub use agent::{Agent, CALLS, Note, Unverified};
pub use extraction::RULES;
pub use files::Folder;
pub use gather::{Fetch, Page, Place, places};
pub use report::{Execution, Outcome, StageRow, Status};
pub use sidecar::{Facts, SIDECAR};
pub use stages::run;

/// A future that may be sent between threads.
pub type BoxFuture<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// How often the user's wish to stop is looked for while something else is waited for.
const STOP_POLL: Duration = Duration::from_millis(50);

/// Where a run starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// With the documents themselves, or with a model's search.
    Documents,
    /// With `documents.jsonl` and `passages.jsonl`.
    Passages,
    /// With `documents.jsonl` and `constraints.jsonl`.
    Constraints,
    /// With `corpus.json`.
    Corpus,
}

impl Stage {
    /// Returns the word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Documents => "documents",
            Self::Passages => "passages",
            Self::Constraints => "constraints",
            Self::Corpus => "corpus",
        }
    }
}

/// What is wanted.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Folder of the stage files.
    pub out: PathBuf,
    /// Where to start.
    pub from: Stage,
    /// Domain id; a restart may leave it out.
    pub domain: Option<String>,
    /// Country of documents that do not say where they apply.
    pub country: Option<String>,
    /// Date of the run, `YYYY-MM-DD`; a restart may leave it out and keeps the first run's.
    pub date: Option<String>,
    /// Documents, when the run starts with them.
    pub places: Vec<Place>,
    /// A sidecar file beside those that lie with the documents.
    pub sources: Option<PathBuf>,
    /// What holds for documents of which nothing else says it.
    pub flags: Facts,
    /// Allows that edited stage files are overwritten.
    pub overwrite: bool,
}

/// What a run works with.
pub struct Context<'a> {
    /// Today, `YYYY-MM-DD`.
    pub date: &'a str,
    /// Gets pages.
    pub fetch: &'a dyn Fetch,
    /// How documents are read.
    pub read: &'a read::Options,
    /// The user's wish to stop.
    pub stop: Stop<'a>,
    /// Says what is being done.
    pub progress: &'a (dyn Fn(&str) + Sync),
}

impl Context<'_> {
    /// Says what is being done.
    pub fn say(&self, what: &str) {
        (self.progress)(what);
    }
}

/// A flag that is set when the user wants to stop.
#[derive(Debug, Clone, Copy)]
pub struct Stop<'a>(pub &'a AtomicBool);

impl Stop<'_> {
    /// Returns an error once the user wants to stop.
    ///
    /// # Errors
    /// `Interrupted`.
    pub fn check(&self) -> Result<(), Error> {
        if self.0.load(Ordering::SeqCst) { Err(Error::Interrupted) } else { Ok(()) }
    }
}

/// Returns a path for messages.
fn shown(path: &Path) -> String {
    path.display().to_string()
}
