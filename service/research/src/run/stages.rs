//! The stages in their order, each from the file of the one before.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

use d3dgen_model::document::Document;
use d3dgen_model::knowledge::{KnowledgeBase, is_date, is_jurisdiction};

use super::agent::{Agent, Note, Session, Unverified};
use super::files::{Folder, Memory, RUN, jsonl, listed, sha256};
use super::gather::{Gathered, Place, gather};
use super::report::{EXECUTION, Execution, Outcome, StageRow, Status};
use super::{Context, Plan, Stage, extraction, shown};
use crate::Error;
use crate::corpus::record::{ConstraintRecord, DocumentRecord, PassageRecord, Record};
use crate::corpus::{Corpus, merge};
use crate::synthesis::synthesize;

/// Names of the documents that the last two stages write.
const CORPUS: &str = "corpus.json";
const KNOWLEDGE: &str = "knowledge.json";
/// Name of the file of what a model said and its evidence does not hold.
const UNVERIFIED: &str = "unverified.json";
/// How a run without a model says that it was made.
const BY_RULES: &str = "d3dgen research: documents read by rules, without a language model";

/// A run on its way.
struct Run<'a> {
    context: &'a Context<'a>,
    plan: &'a Plan,
    folder: &'a Folder,
    memory: Memory,
    session: Option<Session<'a>>,
    unverified: usize,
    rows: Vec<StageRow>,
    warnings: Vec<String>,
    failed: usize,
    passages: usize,
    found: usize,
}

/// Runs a plan to its knowledge base, with the help of a model if there is one.
///
/// # Errors
/// `Problems` for settings, documents and stage files that cannot be used, each with its place; `Model` when a model that
/// is needed gives nothing; `File`; `Interrupted`.
pub async fn run(context: &Context<'_>, plan: &Plan, agent: Option<&Agent<'_>>) -> Result<Outcome, Error> {
    if plan.from == Stage::Documents && plan.places.is_empty() && agent.is_none() {
        let message = "give documents (--documents) or a language model that searches for them (--model)";
        return Err(Error::Problems(vec![message.to_owned()]));
    }
    let folder = Folder::open(&plan.out)?;
    let before = folder.memory()?;
    if !plan.overwrite {
        folder.check_unedited(before.as_ref(), &written_by(plan.from))?;
    }
    let mut plan = plan.clone();
    let mut session = agent.map(|a| Session::new(a, context, &folder));
    if let (Some(session), Some(agent)) = (&mut session, agent) {
        begin(&mut plan, &folder, session, agent).await?;
    }
    let mut memory = memory(context, &plan, &folder, before)?;
    if plan.from <= Stage::Passages {
        memory.generated_by =
            agent.map_or_else(|| BY_RULES.to_owned(), |a| format!("d3dgen research with {}", a.name()));
    }
    let mut run = Run {
        context,
        plan: &plan,
        folder: &folder,
        memory,
        session,
        unverified: 0,
        rows: Vec::new(),
        warnings: Vec::new(),
        failed: 0,
        passages: 0,
        found: 0,
    };
    let corpus = match plan.from {
        Stage::Corpus => folder.document(CORPUS)?.ok_or_else(|| run.missing(CORPUS))?,
        _ => run.corpus().await?,
    };
    let knowledge = run.knowledge(&corpus)?;
    let status = if run.failed > 0 { Status::Partial } else { Status::Complete };
    let model = agent.map(Agent::name);
    let execution = Execution { version: 1, status, model, stages: run.rows, warnings: run.warnings };
    let text = serde_json::to_string_pretty(&execution).expect("times are finite") + "\n";
    folder.write(EXECUTION, text.as_bytes())?;
    Ok(Outcome {
        knowledge,
        documents: corpus.documents.len(),
        passages: run.passages,
        found: run.found,
        unverified: run.unverified,
        execution,
    })
}

/// Asks the user, then the model what the user's sentence is about.
async fn begin(plan: &mut Plan, folder: &Folder, session: &mut Session<'_>, agent: &Agent<'_>) -> Result<(), Error> {
    let starts = plan.from == Stage::Documents;
    let sentence = agent.request.as_deref().filter(|_| starts && (plan.domain.is_none() || plan.country.is_none()));
    let searches = starts && plan.places.is_empty();
    let structures = match plan.from {
        Stage::Documents => Session::structures_of(&plan.places),
        Stage::Passages => Session::structures_of(&[Place::of_file(folder.file(PassageRecord::FILE))]),
        Stage::Constraints | Stage::Corpus => 0,
    };
    if starts && plan.domain.is_none() && sentence.is_none() {
        let message = "say what the rules are for: a sentence (\"hospital in Germany\"), or --domain and --country";
        return Err(Error::Problems(vec![message.to_owned()]));
    }
    session.begin(sentence.is_some(), searches, structures)?;
    if let Some(sentence) = sentence {
        let (domain, country) = session.infer(sentence).await?;
        plan.domain = plan.domain.take().or(domain);
        plan.country = plan.country.take().or(country);
    }
    Ok(())
}

/// Returns the files that a run from a stage writes, each with the stage that starts from it.
fn written_by(from: Stage) -> Vec<(&'static str, &'static str)> {
    let all = [
        (Stage::Documents, DocumentRecord::FILE, "passages"),
        (Stage::Documents, PassageRecord::FILE, "passages"),
        (Stage::Documents, Note::FILE, "passages"),
        (Stage::Passages, ConstraintRecord::FILE, "constraints"),
        (Stage::Constraints, CORPUS, "corpus"),
        (Stage::Corpus, KNOWLEDGE, ""),
    ];
    all.into_iter().filter(|(stage, ..)| *stage >= from).map(|(_, name, next)| (name, next)).collect()
}

/// Returns what is wanted: the flags, and for a restart what the first run was asked for.
fn memory(context: &Context<'_>, plan: &Plan, folder: &Folder, before: Option<Memory>) -> Result<Memory, Error> {
    let mut problems = Vec::new();
    let restart = plan.from > Stage::Documents;
    let kept = before.filter(|_| restart);
    let of_corpus = if plan.from == Stage::Corpus { folder.document::<Corpus>(CORPUS)? } else { None };
    if let (Some(given), Some(corpus)) = (&plan.domain, &of_corpus)
        && *given != corpus.domain
    {
        let place = shown(&folder.file(CORPUS));
        problems.push(format!("--domain: `{given}`, but {place} is about `{}`; change it there", corpus.domain));
    }
    let domain = plan.domain.clone().or_else(|| kept.as_ref().map(|k| k.domain.clone()));
    let domain = domain.or_else(|| of_corpus.as_ref().map(|c| c.domain.clone())).unwrap_or_default();
    if domain.is_empty() || !domain.bytes().all(|b| matches!(b, b'a'..=b'z' | b'0'..=b'9' | b'_')) {
        problems.push(format!("--domain: `{domain}` is no domain id; it has a-z, 0-9 and _, like hospital"));
    }
    let country = plan.country.clone().or_else(|| kept.as_ref().and_then(|k| k.country.clone()));
    if let Some(code) = country.as_ref().filter(|c| !is_jurisdiction(c)) {
        problems.push(format!("--country: `{code}` is no ISO 3166 code (`DE`, `US-NC`), `EU` or `INT`"));
    }
    let date = plan.date.clone().or_else(|| kept.as_ref().map(|k| k.date.clone()));
    let date = date.unwrap_or_else(|| context.date.to_owned());
    if !is_date(&date) {
        problems.push(format!("--date: `{date}` is no date like 2026-11-21"));
    }
    if !problems.is_empty() {
        return Err(listed(problems));
    }
    let files = kept.as_ref().map(|k| k.files.clone()).unwrap_or_default();
    let generated_by = kept.map_or_else(|| BY_RULES.to_owned(), |k| k.generated_by);
    Ok(Memory { version: 1, domain, country, date, generated_by, files })
}

impl Run<'_> {
    /// Returns the corpus, from as far back as the plan says.
    async fn corpus(&mut self) -> Result<Corpus, Error> {
        let (documents, constraints) = match self.plan.from {
            Stage::Documents => {
                let (gathered, notes) = self.gathered().await?;
                let constraints = self.constraints(&gathered.documents, &gathered.passages, &notes).await?;
                (gathered.documents, constraints)
            }
            Stage::Passages => {
                let documents: Vec<DocumentRecord> = self.stage_file()?;
                let passages: Vec<PassageRecord> = self.stage_file()?;
                let notes: Vec<Note> = self.folder.lines()?.unwrap_or_default();
                self.check_documents(&documents)?;
                let ids = passages.iter().map(|p| p.document_id.as_str());
                self.check_known(PassageRecord::FILE, &documents, ids)?;
                let constraints = self.constraints(&documents, &passages, &notes).await?;
                (documents, constraints)
            }
            Stage::Constraints | Stage::Corpus => {
                let documents: Vec<DocumentRecord> = self.stage_file()?;
                let constraints: Vec<ConstraintRecord> = self.stage_file()?;
                self.check_documents(&documents)?;
                let ids = constraints.iter().map(|c| c.evidence.document_id.as_str());
                self.check_known(ConstraintRecord::FILE, &documents, ids)?;
                (documents, constraints)
            }
        };
        self.context.stop.check()?;
        let start = Instant::now();
        let memory = &self.memory;
        let corpus = merge(&memory.domain, &memory.date, &memory.generated_by, &documents, &constraints);
        self.timed("merge", start);
        self.write(CORPUS, &corpus.to_json())?;
        Ok(corpus)
    }

    /// Returns documents and passages: those that are named, or what a model's search brings.
    async fn gathered(&mut self) -> Result<(Gathered, Vec<Note>), Error> {
        let (gathered, notes) = match &mut self.session {
            Some(session) if self.plan.places.is_empty() => {
                let memory = &self.memory;
                session.search(&memory.domain, memory.country.as_deref(), &memory.date).await?
            }
            _ => (self.documents().await?, Vec::new()),
        };
        self.take_session();
        self.write(DocumentRecord::FILE, &jsonl(&gathered.documents))?;
        self.write(PassageRecord::FILE, &jsonl(&gathered.passages))?;
        // Notes of an earlier run are none of this one.
        self.write(Note::FILE, &jsonl(&notes))?;
        Ok((gathered, notes))
    }

    async fn documents(&mut self) -> Result<Gathered, Error> {
        let start = Instant::now();
        let flags = super::Facts { jurisdiction: self.memory.country.clone(), ..self.plan.flags.clone() };
        let gathered = gather(self.context, &self.plan.places, self.plan.sources.as_deref(), &flags).await?;
        self.timed("documents", start);
        self.warnings.extend(gathered.warnings.iter().cloned());
        self.failed += gathered.failed;
        if gathered.documents.is_empty() {
            let mut problems = vec!["no document could be read".to_owned()];
            problems.extend(gathered.warnings);
            return Err(listed(problems));
        }
        Ok(gathered)
    }

    async fn constraints(
        &mut self,
        documents: &[DocumentRecord],
        passages: &[PassageRecord],
        notes: &[Note],
    ) -> Result<Vec<ConstraintRecord>, Error> {
        self.context.stop.check()?;
        self.context.say("finding rules");
        let start = Instant::now();
        let mut constraints = extraction::constraints(documents, passages);
        self.timed("extract", start);
        if let Some(session) = &mut self.session {
            let domain = self.memory.domain.clone();
            let (all, unverified) = session.structure(&domain, documents, passages, notes, constraints).await?;
            constraints = all;
            self.take_session();
            self.keep_apart(&unverified)?;
        }
        self.passages = passages.len();
        self.found = constraints.len();
        self.write(ConstraintRecord::FILE, &jsonl(&constraints))?;
        Ok(constraints)
    }

    /// Takes over what the model's part of a stage has to report.
    fn take_session(&mut self) {
        if let Some(session) = &mut self.session {
            self.rows.append(&mut session.rows);
            self.warnings.append(&mut session.warnings);
            self.failed += std::mem::take(&mut session.failed);
        }
    }

    fn keep_apart(&mut self, unverified: &[Unverified]) -> Result<(), Error> {
        self.unverified = unverified.len();
        let text = serde_json::to_string_pretty(unverified).expect("claims come from JSON") + "\n";
        self.write(UNVERIFIED, &text)
    }

    fn knowledge(&mut self, corpus: &Corpus) -> Result<KnowledgeBase, Error> {
        self.context.stop.check()?;
        let start = Instant::now();
        let (plausible, doubted) = corpus.without_doubtful();
        for (id, reason) in &doubted {
            self.warnings.push(format!("kept apart: {id}: {reason}"));
        }
        let knowledge = synthesize(&plausible)?;
        self.timed("synthesize", start);
        self.write(KNOWLEDGE, &knowledge.to_json())?;
        Ok(knowledge)
    }

    fn timed(&mut self, stage: &str, start: Instant) {
        let row = StageRow { stage: stage.to_owned(), seconds: start.elapsed().as_secs_f64(), ..StageRow::default() };
        self.rows.push(row);
    }

    /// Writes a stage file and remembers it, so that an interrupted run is known as far as it came.
    fn write(&mut self, name: &str, text: &str) -> Result<(), Error> {
        self.folder.write(name, text.as_bytes())?;
        self.memory.files.insert(name.to_owned(), sha256(text.as_bytes()));
        let memory = serde_json::to_string_pretty(&self.memory).expect("strings serialize") + "\n";
        self.folder.write(RUN, memory.as_bytes())
    }

    fn missing(&self, name: &str) -> Error {
        let path = shown(&self.folder.file(name));
        Error::Problems(vec![format!(
            "{path}: is not there; start from an earlier stage than --from {}",
            self.plan.from.name()
        )])
    }

    fn stage_file<R: Record>(&self) -> Result<Vec<R>, Error> {
        self.folder.lines()?.ok_or_else(|| self.missing(R::FILE))
    }

    fn check_documents(&self, documents: &[DocumentRecord]) -> Result<(), Error> {
        let mut seen = BTreeSet::new();
        let twice = documents.iter().filter(|d| !seen.insert(d.document_id.as_str()));
        let place = shown(&self.folder.file(DocumentRecord::FILE));
        let problems: Vec<String> =
            twice.map(|d| format!("{place}: document_id `{}` is used twice; ids are unique", d.document_id)).collect();
        if problems.is_empty() { Ok(()) } else { Err(listed(problems)) }
    }

    /// Refuses records of documents that are not there.
    fn check_known<'b>(
        &self,
        file: &str,
        documents: &[DocumentRecord],
        ids: impl Iterator<Item = &'b str>,
    ) -> Result<(), Error> {
        let known: BTreeSet<&str> = documents.iter().map(|d| d.document_id.as_str()).collect();
        let mut unknown: BTreeMap<&str, usize> = BTreeMap::new();
        for id in ids.filter(|id| !known.contains(id)) {
            *unknown.entry(id).or_default() += 1;
        }
        let place = shown(&self.folder.file(file));
        let problem = |(id, n): (&str, usize)| {
            format!("{place}: document_id `{id}` ({n} lines) is not in {}", DocumentRecord::FILE)
        };
        let problems: Vec<String> = unknown.into_iter().map(problem).collect();
        if problems.is_empty() { Ok(()) } else { Err(listed(problems)) }
    }
}
