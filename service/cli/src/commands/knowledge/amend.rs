//! `d3dgen knowledge amend`: a sentence, another figure or an edited file becomes a reviewed change.

use std::io::{self, BufRead, IsTerminal, Write};
use std::path::PathBuf;

use d3dgen_knowledge::amend::{correct, state};
use d3dgen_knowledge::database::{Edit, Provenance, difference};
use d3dgen_knowledge::phrase;
use d3dgen_model::knowledge::{KnowledgeBase, Value};
use d3dgen_research::extract::Extractor;

use super::history::shown;
use crate::database::provenance;
use crate::error::Error;
use crate::input::{knowledge_base, write_lines};
use crate::registry::RegistryArgs;

/// Arguments.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["sentence", "rule", "file"])))]
pub struct Args {
    /// A rule of the building's owner, in a sentence: "corridors in our ward are at least 2.6 m wide"
    sentence: Option<String>,
    /// Id of a rule to give another figure
    #[arg(long, value_name = "ID", requires = "value")]
    rule: Option<String>,
    /// The other figure, in the rule's unit: a number, or JSON as in the knowledge base
    #[arg(long, value_name = "FIGURE", requires = "rule", allow_negative_numbers = true)]
    value: Option<String>,
    /// The domain's knowledge base as exported and edited
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Domain it concerns; not needed with --file
    #[arg(long, value_name = "ID", required_unless_present = "file")]
    domain: Option<String>,
    /// Language of the sentence; otherwise English and German are tried
    #[arg(long, value_name = "CODE")]
    lang: Option<String>,
    /// Who does it; otherwise the user's name
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    /// Why; otherwise the sentence
    #[arg(long, value_name = "TEXT", required_unless_present = "sentence")]
    why: Option<String>,
    /// Apply without asking
    #[arg(long)]
    yes: bool,
    /// Print the change as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let registry = self.registry.load_as_brought()?;
        let database = self.registry.store.open(&registry, None)?;
        let why = self.why.as_deref().or(self.sentence.as_deref()).unwrap_or_default().trim();
        let by = provenance(self.by.as_deref(), why);
        let edited = self.edited()?;
        let id = edited.as_ref().map(|k| k.metadata.domain.clone()).or_else(|| self.domain.clone()).unwrap_or_default();
        let knowledge = database.knowledge_base(&id)?;
        let edits = match (&edited, &self.rule, &self.sentence) {
            (Some(edited), ..) => difference(&knowledge, edited, false),
            (_, Some(rule), _) => correct(&knowledge, rule, figure(self.value.as_deref().unwrap_or_default())?, &by)?,
            (.., sentence) => self.stated(sentence.as_deref().unwrap_or_default(), &knowledge, &by)?,
        };
        if edits.is_empty() {
            return Err(Error::Input(format!("nothing differs from what the database holds of {id}")));
        }
        eprint!("{}", shown(&edits));
        if !self.yes && !confirmed()? {
            eprintln!("nothing was changed; --yes applies it");
            return Ok(());
        }
        let change = database.amend(&id, edits, &by)?;
        if self.json {
            return write_lines([&change]);
        }
        eprintln!("change {}; `d3dgen knowledge undo {}` takes it back", change.seq, change.seq);
        Ok(())
    }

    fn edited(&self) -> Result<Option<KnowledgeBase>, Error> {
        let Some(file) = &self.file else { return Ok(None) };
        let (_, imported) = knowledge_base(file)?;
        if let Some(domain) = self.domain.as_ref().filter(|d| **d != imported.knowledge.metadata.domain) {
            let is = &imported.knowledge.metadata.domain;
            return Err(Error::Input(format!("--domain {domain}: the file is of domain {is}")));
        }
        Ok(Some(imported.knowledge))
    }

    /// Returns the edits that make the rules of a sentence rules of the owner.
    fn stated(&self, sentence: &str, knowledge: &KnowledgeBase, by: &Provenance) -> Result<Vec<Edit>, Error> {
        let found = Extractor::shared().extract_best(sentence, self.lang.as_deref());
        if found.is_empty() {
            return Err(Error::Input(format!(
                "no rule with a figure was found in \"{sentence}\"; say it like \"corridors are at least 2.6 m wide\""
            )));
        }
        let mut after = knowledge.clone();
        for finding in &found {
            let edits = state(&after, &finding.statement(), by)?;
            d3dgen_knowledge::database::apply(&mut after, &edits);
        }
        let local = after.references.iter().filter(|r| r.jurisdiction == d3dgen_model::knowledge::LOCAL);
        for rule in local.flat_map(|r| &r.constraints).filter(|c| !is_held(knowledge, c)) {
            eprintln!("{}", phrase::sentence(rule));
        }
        Ok(difference(knowledge, &after, true))
    }
}

fn is_held(knowledge: &KnowledgeBase, rule: &d3dgen_model::knowledge::Constraint) -> bool {
    knowledge.references.iter().flat_map(|r| &r.constraints).any(|c| c == rule)
}

fn figure(text: &str) -> Result<Value, Error> {
    let value: Result<Value, _> = serde_json::from_str(text);
    value.map_err(|_| {
        Error::Input(format!("--value {text}: no number, and no JSON like {{\"min\": 1.2, \"max\": 1.5}}"))
    })
}

/// Asks on a terminal; without one, nobody has agreed.
fn confirmed() -> Result<bool, Error> {
    if !io::stdin().is_terminal() || !io::stderr().is_terminal() {
        return Ok(false);
    }
    eprint!("apply this? [y/N] ");
    let refused = |source| Error::Read { path: "standard input".into(), source };
    io::stderr().flush().map_err(refused)?;
    let mut answer = String::new();
    io::stdin().lock().read_line(&mut answer).map_err(refused)?;
    Ok(matches!(answer.trim().to_lowercase().as_str(), "y" | "yes" | "j" | "ja"))
}
