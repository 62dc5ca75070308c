//! A research: documents into a knowledge base, without a language model, and into the database of rules when that is
//! asked for.

use std::path::PathBuf;
use std::sync::Arc;

use d3dgen_knowledge::database::Provenance;
use d3dgen_research::fetch::{Cache, Fetcher, Mode, Options as FetchOptions};
use d3dgen_research::run::{Context, Facts, Plan, Stage, Stop, places, run as run_stages};
use d3dgen_research::{Error as ResearchError, read};
use serde::{Deserialize, Serialize};
use tonic::Status;

use super::{Level, Run};
use crate::status;

/// Folder of uploaded documents in a job's folder.
const DOCUMENTS: &str = "documents";

/// Documents to read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Research {
    /// Domain that the rules are for.
    pub domain: String,
    /// Country of documents that do not say where they apply.
    pub country: Option<String>,
    /// Addresses, files and folders of the server's machine; uploaded documents lie in the job's folder.
    pub places: Vec<String>,
    /// Facts about documents, as `sources.toml` says them.
    pub sources: String,
    /// Whether the result goes into the database of rules.
    pub import: bool,
}

/// What a research came to.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Found {
    /// Documents read.
    pub documents: u64,
    /// Rules found.
    pub constraints: u64,
    /// What is missing and what else to know.
    pub warnings: Vec<String>,
    /// Change of the database of rules.
    pub change: Option<u64>,
}

/// Returns the folder of uploaded documents of a job.
pub fn documents_dir(job_dir: &std::path::Path) -> PathBuf {
    job_dir.join(DOCUMENTS)
}

/// Reads the documents and keeps what they say.
///
/// # Errors
/// `CANCELLED`; `INVALID_ARGUMENT` with the document at fault.
pub(super) fn run(run: &Run, spec: &Research) -> Result<serde_json::Value, Status> {
    let core = &run.core;
    let dir = run.dir()?;
    let uploaded = documents_dir(&dir);
    let mut words = spec.places.clone();
    if uploaded.is_dir() {
        words.push(uploaded.display().to_string());
    }
    let sources = dir.join("facts.toml");
    std::fs::write(&sources, &spec.sources).map_err(|e| status::io(&e))?;
    let date = core.clock.date();
    let plan = Plan {
        out: dir.join("out"),
        from: Stage::Documents,
        domain: Some(spec.domain.clone()),
        country: spec.country.clone(),
        date: Some(date.clone()),
        places: places(&words).map_err(refused)?,
        sources: Some(sources),
        flags: Facts::default(),
        overwrite: true,
    };
    let cache = Cache::open(&dir.join("cache")).map_err(refused)?;
    let clock = core.clock.clone();
    let now = Arc::new(move || clock.now_ms() / 1000);
    let options = FetchOptions { mode: Mode::Online { max_age: None }, ..FetchOptions::default() };
    let fetcher = Fetcher::new(options, Some(cache), now);
    let read = read::Options { pdf: core.programs.pdf.clone(), ..read::Options::default() };
    let progress = |what: &str| run.step("research", 0.5, what);
    let context = Context { date: &date, fetch: &fetcher, read: &read, stop: Stop(run.flag()), progress: &progress };
    run.step("research", 0.05, "reading documents");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|e| status::internal(&e))?;
    let outcome = runtime.block_on(run_stages(&context, &plan, None)).map_err(refused)?;
    let mut found = Found {
        documents: outcome.documents as u64,
        constraints: outcome.knowledge.references.iter().map(|r| r.constraints.len() as u64).sum(),
        warnings: outcome.execution.warnings,
        change: None,
    };
    found.warnings.iter().take(200).for_each(|w| run.log(Level::Warning, w));
    if spec.import {
        run.check()?;
        run.step("import", 0.9, "keeping the rules");
        let why = format!("research job {}", run.job.id);
        let by = Provenance { who: run.job.owner.clone(), when: core.clock.text(), why };
        let change = core.change_rules(|rules| rules.import(&outcome.knowledge, true, &by))?;
        found.change = change.map(|c| c.seq);
    }
    super::run::remove_dir(&dir.join("cache"));
    serde_json::to_value(&found).map_err(|e| status::internal(&e))
}

fn refused(error: ResearchError) -> Status {
    match error {
        ResearchError::Interrupted => Status::cancelled("stopped"),
        other => status::invalid("documents", other.to_string()),
    }
}
