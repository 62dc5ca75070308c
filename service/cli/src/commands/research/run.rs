//! A run of `d3dgen research`: flags into a plan, the clock and the environment into values, the outcome into a table.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use clap::ValueEnum;
use d3dgen_research::fetch::{Cache, Fetcher, Mode, Network, Options as FetchOptions};
use d3dgen_research::run::{Agent, Context, Facts, Outcome, Plan, Stage, Status, Stop, places, run};
use d3dgen_research::{Error as ResearchError, read};
use serde_json::json;

use super::model::{ModelArgs, confirm};
use crate::error::Error;
use crate::input::write_text;
use crate::interrupt;
use crate::progress::Progress;
use crate::registry::RegistryArgs;
use crate::table::table;

/// Name of the hidden command that reads a PDF file.
pub const READ_PDF: &str = "read-pdf";
const DAY_S: u64 = 86_400;

pub const AFTER_HELP: &str = "\
The output folder keeps the file of each stage: documents.jsonl, passages.jsonl, constraints.jsonl, corpus.json and
knowledge.json. Each may be edited; --from goes on from it. What documents do not say of themselves (jurisdiction,
publisher, edition, source_type, url) is read from sources.toml beside them:
  [documents.\"asr.html\"]
  jurisdiction = \"DE\"
  source_type = \"regulation\"

With --model, a figure becomes a constraint only where the evidence holds it; the rest is in unverified.json. Keys are read
from the environment (GEMINI_API_KEY, OPENAI_API_KEY, ANTHROPIC_API_KEY) and written nowhere. Google's terms forbid storing
grounded results, building databases from them and following their links; hence --accept-grounding-terms, and no link in an
answer is ever followed.";

/// Where to start.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum From {
    /// With the documents
    Documents,
    /// With passages.jsonl
    Passages,
    /// With constraints.jsonl
    Constraints,
    /// With corpus.json
    Corpus,
}

/// Arguments of a run.
#[derive(clap::Args)]
pub struct RunArgs {
    /// What the rules are for, in a sentence; a model finds domain and country in it
    #[arg(value_name = "REQUEST")]
    request: Option<String>,
    /// Domain that the rules are for, such as hospital
    #[arg(long, value_name = "ID")]
    domain: Option<String>,
    /// Country of documents that do not say where they apply: ISO 3166 code, EU or INT
    #[arg(long, value_name = "CODE")]
    country: Option<String>,
    /// Documents: files, folders, http(s) addresses; HTML, PDF, Markdown, plain text
    #[arg(long, value_name = "DIR|FILE|URL", num_args = 1..)]
    documents: Vec<String>,
    /// Folder for the files of all stages
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Start from this stage's file in the output folder
    #[arg(long, value_enum, value_name = "STAGE")]
    from: Option<From>,
    /// Facts about documents, beside the sources.toml that lie with them
    #[arg(long, value_name = "FILE")]
    sources: Option<PathBuf>,
    /// Kind of documents that do not say it: regulation, standard, guideline, manufacturer_doc, paper, practice, web_page
    #[arg(long, value_name = "KIND")]
    source_type: Option<String>,
    /// Publisher of documents that do not say it
    #[arg(long, value_name = "NAME")]
    publisher: Option<String>,
    /// Date of the run instead of today
    #[arg(long, value_name = "YYYY-MM-DD")]
    date: Option<String>,
    /// Fetch nothing; take pages from the cache of an earlier run
    #[arg(long)]
    offline: bool,
    /// Folder of fetched pages; cache/ in the output folder when left out
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Fetch pages again that are older than this
    #[arg(long, value_name = "DAYS")]
    max_age: Option<u64>,
    /// Fetch from this network as well, which is not public: a document server of your own, such as 10.1.0.0/16
    #[arg(long, value_name = "NETWORK")]
    allow_network: Vec<String>,
    /// Fetch from this port as well as 80 and 443
    #[arg(long, value_name = "PORT")]
    allow_port: Vec<u16>,
    /// Overwrite stage files that were edited
    #[arg(long)]
    overwrite: bool,
    /// Print the outcome as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl RunArgs {
    /// Runs the stages and prints what came of them.
    ///
    /// # Errors
    /// `Input` with every problem and its place; `Interrupted`.
    pub fn run(self) -> Result<(), Error> {
        let out = self.out.clone().ok_or_else(|| {
            Error::Input("--out is missing: name a folder for the stage files, or see d3dgen research --help".into())
        })?;
        let plan = self.plan(out.clone())?;
        let mut today = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        today.truncate("YYYY-MM-DD".len());
        let cache = self.cache.clone().unwrap_or_else(|| out.join("cache"));
        let fetcher =
            self.fetcher(cache, plan.places.iter().any(|p| matches!(p, d3dgen_research::run::Place::Url(_))))?;
        let read = read::Options { pdf: pdf_program(), ..read::Options::default() };
        let client = self.model.llm.client()?;
        interrupt::listen();
        let progress = Progress::of(1);
        let say = |what: &str| progress.doing(what);
        let context =
            Context { date: &today, fetch: &fetcher, read: &read, stop: Stop(interrupt::flag()), progress: &say };
        let ask = |estimate: &_| confirm(estimate, &self.model);
        let domains = match &client {
            Some(_) => self.registry.load_as_brought()?.iter().map(|p| p.id().to_owned()).collect(),
            None => Vec::new(),
        };
        let agent = client.as_ref().map(|client| Agent {
            client,
            request: self.request.clone(),
            domains,
            passes: self.model.passes,
            parallel: self.model.parallel,
            max_searches: self.model.max_searches,
            searches: self.model.llm.searches(),
            accept_grounding_terms: self.model.accept_grounding_terms,
            confirm: &ask,
        });
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
        let runtime = runtime.map_err(|e| Error::Input(format!("cannot start the network: {e}")))?;
        let outcome = runtime.block_on(run(&context, &plan, agent.as_ref()));
        progress.finish();
        let outcome = outcome.map_err(error)?;
        for warning in &outcome.execution.warnings {
            eprintln!("warning: {warning}");
        }
        write_text(None, &if self.json { shown_json(&outcome) } else { shown(&outcome, &out) })
    }

    fn plan(&self, out: PathBuf) -> Result<Plan, Error> {
        let from = match self.from {
            None | Some(From::Documents) => Stage::Documents,
            Some(From::Passages) => Stage::Passages,
            Some(From::Constraints) => Stage::Constraints,
            Some(From::Corpus) => Stage::Corpus,
        };
        if from != Stage::Documents && !self.documents.is_empty() {
            return Err(Error::Input("--documents and --from exclude each other: --from starts behind them".into()));
        }
        if self.request.is_some() && self.model.llm.model.is_none() {
            return Err(Error::Input(
                "a request in words needs a language model to understand it (--model); without one give --domain and --country"
                    .into(),
            ));
        }
        let mut flags =
            Facts { source_type: self.source_type.clone(), publisher: self.publisher.clone(), ..Facts::default() };
        let problems = flags.normalize();
        if !problems.is_empty() {
            return Err(Error::Input(
                problems.into_iter().map(|p| format!("--{p}").replace('_', "-")).collect::<Vec<_>>().join("\n"),
            ));
        }
        Ok(Plan {
            out,
            from,
            domain: self.domain.clone(),
            country: self.country.as_ref().map(|c| c.to_uppercase()),
            date: self.date.clone(),
            places: places(&self.documents).map_err(error)?,
            sources: self.sources.clone(),
            flags,
            overwrite: self.overwrite,
        })
    }

    fn fetcher(&self, cache: PathBuf, fetches: bool) -> Result<Fetcher, Error> {
        let max_age = self.max_age.map(|days| std::time::Duration::from_secs(days.saturating_mul(DAY_S)));
        let mode = if self.offline { Mode::Offline } else { Mode::Online { max_age } };
        let mut options = FetchOptions { mode, ..FetchOptions::default() };
        options.ports.extend(&self.allow_port);
        for network in &self.allow_network {
            let parsed: Result<Network, _> = network.parse();
            let parsed = parsed.map_err(|e| Error::Input(format!("--allow-network {network}: {e}")))?;
            options.allow_addresses.push(parsed);
        }
        let cache = if fetches { Some(Cache::open(&cache).map_err(error)?) } else { None };
        Ok(Fetcher::new(options, cache, Arc::new(now_s)))
    }
}

/// Returns this very program as the reader of PDF files.
pub fn pdf_program() -> Option<read::pdf::Program> {
    let path = std::env::current_exe().ok()?;
    let arguments = vec!["research".to_owned(), READ_PDF.to_owned()];
    Some(read::pdf::Program { path, arguments, limits: read::pdf::Limits::default() })
}

fn error(error: ResearchError) -> Error {
    match error {
        ResearchError::Interrupted => Error::Interrupted,
        other => Error::Input(other.to_string()),
    }
}

fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs())
}

fn counts(outcome: &Outcome) -> (usize, usize) {
    let references = &outcome.knowledge.references;
    (references.len(), references.iter().map(|r| r.constraints.len()).sum())
}

fn shown(outcome: &Outcome, out: &std::path::Path) -> String {
    let (references, constraints) = counts(outcome);
    let partial = if outcome.execution.status == Status::Partial { ", partial: see the warnings" } else { "" };
    let mut text =
        format!("{constraints} constraints in {references} references from {} documents{partial}\n", outcome.documents);
    if outcome.unverified > 0 {
        text += &format!("{} figures that no evidence holds are kept apart in unverified.json\n", outcome.unverified);
    }
    let model = outcome.execution.model.is_some();
    let rows: Vec<Vec<String>> = outcome
        .execution
        .stages
        .iter()
        .map(|row| {
            let mut cells = vec![row.stage.clone(), format!("{:.1}", row.seconds)];
            if model {
                let counts = [row.calls, row.kept, row.failed, row.input_tokens, row.output_tokens, row.searches];
                cells.extend(counts.map(|n| n.to_string()));
                cells.push(row.cost.map_or_else(|| "-".into(), |c| format!("{c:.4}")));
            }
            cells
        })
        .collect();
    let head = ["stage", "seconds", "requests", "kept", "failed", "tokens in", "tokens out", "searches", "cost"];
    text += "\n";
    text += &table(if model { &head } else { head.get(..2).unwrap_or_default() }, &rows);
    text += &format!("\n{}\n", out.join("knowledge.json").display());
    text
}

fn shown_json(outcome: &Outcome) -> String {
    let (references, constraints) = counts(outcome);
    let value = json!({
        "status": outcome.execution.status, "documents": outcome.documents, "passages": outcome.passages,
        "found": outcome.found, "references": references, "constraints": constraints,
        "unverified": outcome.unverified, "execution": outcome.execution,
    });
    serde_json::to_string_pretty(&value).expect("times are finite") + "\n"
}
