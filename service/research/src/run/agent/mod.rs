//! Research with a language model: infer, search eight topics in some passes, structure; the rest is the same as without.
//!
//! A model proposes. What it says is data that has to fit the one schema, and a figure becomes a constraint only where the
//! evidence holds it (`figures`). What it is not for: keys, addresses of providers, prices; they are in the client.

mod calls;
mod figures;
mod infer;
mod prompts;
mod search;
mod structure;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;
use std::time::Instant;

use d3dgen_llm::{Answer, Client, Estimate, Plan as CallPlan, Request};

use super::files::Folder;
use super::gather::{Gathered, Place};
use super::report::StageRow;
use super::{BoxFuture, Context};
use crate::Error;
use crate::corpus::record::{ConstraintRecord, DocumentRecord, PassageRecord};
pub use calls::CALLS;
use calls::{Calls, all};
use prompts::prompts;
pub use search::Note;
pub use structure::Unverified;

/// Bytes that a page of the network is reckoned with before it is fetched.
const PAGE_BYTES: u64 = 60_000;
/// Bytes of text that are structured at once, for the estimate.
const CHUNK_BYTES: u64 = 6_000;

/// A model and how it is to be asked.
pub struct Agent<'a> {
    /// Asks the provider, within its budget.
    pub client: &'a Client,
    /// The user's sentence, when domain or country are to be found in it.
    pub request: Option<String>,
    /// Domain ids to choose from.
    pub domains: Vec<String>,
    /// Passes of each topic.
    pub passes: u32,
    /// Requests on their way at a time.
    pub parallel: usize,
    /// Searches of one request, at most.
    pub max_searches: u32,
    /// Whether the provider can search.
    pub searches: bool,
    /// Whether the user agrees to the provider's terms of grounded results.
    pub accept_grounding_terms: bool,
    /// Asks the user whether to go on, with what it may cost at most.
    pub confirm: &'a (dyn Fn(&Estimate) -> bool + Sync),
}

impl Agent<'_> {
    /// Returns provider and model, as they are cited.
    pub fn name(&self) -> String {
        format!("{}:{}", self.client.provider().name(), self.client.provider().model())
    }

    fn needs_terms(&self) -> bool {
        prompts().grounding_terms.providers.iter().any(|p| p == self.client.provider().name())
    }
}

/// A run's dealings with its model.
pub struct Session<'a> {
    agent: &'a Agent<'a>,
    context: &'a Context<'a>,
    calls: Calls<'a>,
    /// Why nothing more is asked.
    halted: Mutex<Option<String>>,
    /// What is missing.
    pub warnings: Vec<String>,
    /// Requests without answer.
    pub failed: usize,
    /// Rows of the execution table.
    pub rows: Vec<StageRow>,
}

impl<'a> Session<'a> {
    /// Returns a session.
    pub fn new(agent: &'a Agent<'a>, context: &'a Context<'a>, folder: &'a Folder) -> Self {
        Self {
            agent,
            context,
            calls: Calls::new(agent.client, folder),
            halted: Mutex::default(),
            warnings: Vec::new(),
            failed: 0,
            rows: Vec::new(),
        }
    }

    /// Asks the user whether to go on, before the first request.
    ///
    /// # Errors
    /// `Problems` when the terms are not agreed to, the budget is too small or the user declines.
    pub fn begin(&self, infers: bool, searches: bool, structures: u64) -> Result<(), Error> {
        if searches && self.agent.needs_terms() && !self.agent.accept_grounding_terms {
            return Err(Error::Problems(vec![prompts().grounding_terms.notice.clone()]));
        }
        let mut plans = Vec::new();
        if infers {
            plans.push(CallPlan::of(&infer::request("request", &self.agent.domains)?));
        }
        if searches {
            let one = search::requests("domain", None, 1, self.agent.max_searches).pop().map(|r| CallPlan::of(&r.2));
            let calls = 8 * u64::from(self.agent.passes);
            plans.extend(one.map(|p| CallPlan { calls, ..p }));
        }
        let structures = if searches { 8 * u64::from(self.agent.passes) } else { structures };
        if structures > 0 {
            let chunk = CallPlan::of(&structure::request("domain", "0", &[])?);
            let input_tokens = chunk.input_tokens + CHUNK_BYTES / 3;
            plans.push(CallPlan { calls: structures, input_tokens, ..chunk });
        }
        let estimate = self.agent.client.budget().estimate(self.agent.client.provider().model(), &plans);
        let agreed = estimate.calls == 0 || (self.agent.confirm)(&estimate);
        if agreed {
            Ok(())
        } else {
            Err(Error::Problems(vec!["not started: the estimate was not agreed to".to_owned()]))
        }
    }

    /// Returns how many requests documents need, at most.
    pub fn structures_of(places: &[Place]) -> u64 {
        let bytes = |place: &Place| match place {
            Place::File { path, .. } => std::fs::metadata(path).map_or(0, |m| m.len()),
            Place::Url(_) => PAGE_BYTES,
        };
        places.iter().map(|p| bytes(p).div_ceil(CHUNK_BYTES)).sum()
    }

    /// Returns domain and country of the user's sentence.
    ///
    /// # Errors
    /// `Model`, `File`, `Interrupted`.
    pub async fn infer(&mut self, text: &str) -> Result<(Option<String>, Option<String>), Error> {
        let start = Instant::now();
        let request = infer::request(text, &self.agent.domains)?;
        let answer = self.calls.ask(self.context, &request).await?;
        self.row("infer", start, 0);
        Ok(answer.json.as_ref().map(infer::read).unwrap_or_default())
    }

    /// Returns what the searches of all topics found, and the notes.
    ///
    /// # Errors
    /// `Model` when not one search was answered; `File`, `Interrupted`.
    pub async fn search(
        &mut self,
        domain: &str,
        country: Option<&str>,
        date: &str,
    ) -> Result<(Gathered, Vec<Note>), Error> {
        let (start, kept) = (Instant::now(), self.calls.kept());
        if !self.agent.searches {
            let name = self.agent.client.provider().name();
            self.warnings.push(format!(
                "{name} cannot search: what it says rests on no source and is kept in unverified.json; give --documents"
            ));
        }
        let mut asked = search::requests(domain, country, self.agent.passes, self.agent.max_searches);
        if !self.agent.searches {
            asked.iter_mut().for_each(|r| r.2.grounding = None);
        }
        let requests: Vec<Request> = asked.iter().map(|r| r.2.clone()).collect();
        let answers = self.ask_all(&requests).await?;
        self.row("search", start, kept);
        let mut gathered = Gathered::default();
        let mut notes = Vec::new();
        let mut known = BTreeSet::new();
        for ((topic, pass, _), answer) in asked.iter().zip(answers) {
            let Some(answer) = answer else { continue };
            if !answer.grounded && self.agent.searches {
                let why = answer.search_error.as_deref().unwrap_or("the model did not search, or found nothing");
                self.warnings.push(format!("search/{topic}/{pass}: no sources: {why}"));
            }
            let found = search::found(&answer, topic, country, date);
            let fresh = |d: &DocumentRecord| known.insert(d.document_id.clone());
            gathered.documents.extend(found.documents.into_iter().filter({
                let mut fresh = fresh;
                move |d| fresh(d)
            }));
            gathered.passages.extend(found.passages);
            notes.push(Note {
                topic: topic.clone(),
                pass: *pass,
                grounded: answer.grounded,
                sources: answer.citations.iter().map(|c| c.uri.clone()).collect(),
                queries: answer.queries,
                text: answer.text,
            });
        }
        let mut seen = BTreeSet::new();
        gathered.passages.retain(|p| seen.insert((p.document_id.clone(), p.passage_id.clone())));
        gathered.documents.sort_by(|a, b| a.document_id.cmp(&b.document_id));
        Ok((gathered, notes))
    }

    /// Returns what the model finds in passages and, kept apart, what they do not hold. `notes` are texts without source.
    ///
    /// # Errors
    /// `File`, `Interrupted`; `Model` when key, model or configuration are wrong.
    pub async fn structure(
        &mut self,
        domain: &str,
        documents: &[DocumentRecord],
        passages: &[PassageRecord],
        notes: &[Note],
        by_rules: Vec<ConstraintRecord>,
    ) -> Result<(Vec<ConstraintRecord>, Vec<Unverified>), Error> {
        let (start, kept) = (Instant::now(), self.calls.kept());
        let sources: BTreeMap<&str, &str> =
            documents.iter().map(|d| (d.document_id.as_str(), d.source.as_str())).collect();
        let memory: Vec<PassageRecord> = notes.iter().filter(|n| !n.grounded).map(passage_of).collect();
        let held = structure::chunks(passages);
        let unheld = structure::chunks(&memory);
        let mut requests = Vec::new();
        for (i, chunk) in held.iter().chain(&unheld).enumerate() {
            let topic = chunk.first().and_then(|p| p.topic.as_deref()).unwrap_or("documents");
            requests.push(structure::request(domain, &format!("{topic}/{}", i + 1), chunk)?);
        }
        let answers = self.ask_all(&requests).await?;
        self.row("structure", start, kept);
        let (name, mut found, mut unverified) = (self.agent.name(), Vec::new(), Vec::new());
        for (i, (chunk, answer)) in held.iter().chain(&unheld).zip(answers).enumerate() {
            let Some(json) = answer.and_then(|a| a.json) else { continue };
            let source = |id: &str| sources.get(id).map_or_else(String::new, |s| (*s).to_owned());
            let structured = structure::checked(&json, chunk, source, &name, i < held.len());
            found.extend(structured.constraints);
            unverified.extend(structured.unverified);
        }
        Ok((structure::joined(by_rules, found), unverified))
    }

    /// Asks all, some at a time; what fails alone is missing and said.
    async fn ask_all(&mut self, requests: &[Request]) -> Result<Vec<Option<Answer>>, Error> {
        let this = &*self;
        let futures: Vec<BoxFuture<'_, Result<Option<Answer>, Error>>> =
            requests.iter().map(|request| -> BoxFuture<'_, _> { Box::pin(this.one(request)) }).collect();
        let results = all(futures, self.agent.parallel).await;
        let (mut answers, mut failures) = (Vec::new(), Vec::new());
        for result in results {
            match result {
                Ok(answer) => answers.push(answer),
                Err(Error::Model { stage, source }) => {
                    failures.push(Error::Model { stage, source });
                    answers.push(None);
                }
                Err(e) => return Err(e),
            }
        }
        self.warnings.extend(self.calls.take_warnings());
        let nothing = answers.iter().all(Option::is_none);
        self.failed += failures.len();
        self.warnings.extend(failures.iter().map(|e| format!("missing: {e}")));
        let skipped = answers.iter().filter(|a| a.is_none()).count() - failures.len();
        let halted = self.halted.lock().map(|h| h.clone()).unwrap_or_default();
        if let Some(reason) = halted.filter(|_| skipped > 0) {
            self.failed += skipped;
            self.warnings.push(format!("missing: {skipped} requests were not made: {reason}"));
        }
        let hopeless = |e: &Error| match e {
            Error::Model { stage, source } => {
                let setting = matches!(
                    **source,
                    d3dgen_llm::Error::Auth { .. }
                        | d3dgen_llm::Error::ModelNotFound { .. }
                        | d3dgen_llm::Error::Config { .. }
                );
                setting || stage.starts_with("search/")
            }
            _ => false,
        };
        match failures.into_iter().find(hopeless) {
            Some(error) if nothing => Err(error),
            _ => Ok(answers),
        }
    }

    async fn one(&self, request: &Request) -> Result<Option<Answer>, Error> {
        if self.halted.lock().is_ok_and(|h| h.is_some()) {
            return Ok(None);
        }
        match self.calls.ask(self.context, request).await {
            Ok(answer) => Ok(Some(answer)),
            Err(Error::Model { stage, source }) => {
                if source.stops_run()
                    && let Ok(mut halted) = self.halted.lock()
                {
                    *halted = Some(source.to_string());
                }
                Err(Error::Model { stage, source })
            }
            Err(e) => Err(e),
        }
    }

    fn row(&mut self, stage: &str, start: Instant, kept_before: u64) {
        let mut row =
            StageRow { stage: stage.to_owned(), seconds: start.elapsed().as_secs_f64(), ..StageRow::default() };
        if let Some(used) = self.agent.client.budget().table().into_iter().find(|r| r.stage == stage) {
            row.kept = self.calls.kept() - kept_before;
            row.calls = used.calls.saturating_sub(row.kept);
            row.failed = used.failed;
            row.tries = used.tries;
            row.input_tokens = used.usage.input;
            row.output_tokens = used.usage.output + used.usage.thoughts;
            row.searches = used.usage.searches;
            row.cost = used.cost;
        }
        self.rows.push(row);
    }
}

/// Returns a note without source in the form that is structured; it is no passage of a document.
fn passage_of(note: &Note) -> PassageRecord {
    PassageRecord {
        passage_id: format!("{}_{}", note.topic, note.pass),
        document_id: String::new(),
        heading: Vec::new(),
        kind: "note".to_owned(),
        page: None,
        topic: Some(note.topic.clone()),
        text: note.text.clone(),
    }
}
