//! A stage's question, asked once or, when little of the answer is of use, twice; and the record of it.

use std::fmt::Write as _;

use d3dgen_llm::{Error as LlmError, Message, Request as LlmRequest, Role};
use d3dgen_model::proposal::{FateCounts, Outcome, ProposedItem, StageProposal, TokenUsage};
use d3dgen_pipeline::Error;
use d3dgen_pipeline::generate::Stage;
use data_encoding::HEXLOWER;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

use crate::prompt::prompts;
use crate::{Asked, Desk};

/// Share of the proposed things that are as proposed or near it, below which the model is asked once more.
const LITTLE: f64 = 0.5;
/// Most problems that a model is told.
const MOST_PROBLEMS: usize = 12;

/// What a stage asks.
pub struct Question {
    pub stage: Stage,
    pub request: LlmRequest,
    /// Constraints that it quotes.
    pub constraint_ids: Vec<String>,
}

/// A proposal, judged.
pub struct Trial<T> {
    /// What it became; none when it is of no use.
    pub result: Option<T>,
    /// Every proposed thing with what became of it.
    pub items: Vec<ProposedItem>,
    /// What became of the whole, one sentence.
    pub note: String,
}

impl<T> Trial<T> {
    /// Returns the share of the proposed things that are there as proposed or near it.
    fn share(&self) -> f64 {
        let counts = FateCounts::of(&self.items);
        if self.result.is_none() {
            return 0.0;
        }
        f64::from(counts.kept + counts.moved) / f64::from(counts.proposed().max(1))
    }
}

/// Asks for a stage's proposal and has it judged; returns what it became with the record.
///
/// # Errors
/// What the judge returns; trouble with the model is in the record.
pub fn propose<A: DeserializeOwned, T>(
    desk: &mut Desk<'_, '_>,
    question: Question,
    mut judge: impl FnMut(&mut Desk<'_, '_>, A) -> Result<Trial<T>, Error>,
) -> Result<(Option<T>, StageProposal), Error> {
    let mut record = StageProposal {
        stage: question.stage.name().to_owned(),
        outcome: Outcome::Failed,
        note: String::new(),
        error: None,
        prompt_sha256: digest(&question.request),
        constraint_ids: question.constraint_ids,
        answered_by: String::new(),
        usage: TokenUsage::default(),
        counts: FateCounts::default(),
        items: Vec::new(),
    };
    let mut request = question.request;
    let asked = match desk.trouble.clone() {
        Some(trouble) => Err(trouble),
        None => {
            (desk.proposer.say)(question.stage);
            ask(desk, &request, &mut record)
        }
    };
    let (text, answer) = match asked {
        Ok(found) => found,
        Err(error) => {
            desk.check()?;
            if lasts(&error) {
                desk.trouble = Some(error.clone());
            }
            record.error = Some(error.category().to_owned());
            record.note = format!("there is no usable answer, so the stage is as without a model: {}", plain(&error));
            return Ok((None, record));
        }
    };
    let mut best = judge(desk, answer)?;
    desk.check()?;
    if best.share() < LITTLE {
        request.messages.push(Message { role: Role::Assistant, text });
        request.messages.push(Message { role: Role::User, text: prompts().again(&problems(&best)) });
        (desk.proposer.say)(question.stage);
        // without a second answer the first one stands
        if let Ok((_, answer)) = ask(desk, &request, &mut record) {
            let other = judge(desk, answer)?;
            if (other.result.is_some(), other.share()) > (best.result.is_some(), best.share()) {
                best = other;
            }
        }
        desk.check()?;
    }
    record.outcome = if best.result.is_some() { Outcome::Used } else { Outcome::NotUsed };
    record.counts = FateCounts::of(&best.items);
    record.items = best.items;
    record.note = best.note;
    Ok((best.result, record))
}

/// Returns the record of a stage that has nothing to ask.
pub fn not_asked(stage: Stage, note: &str) -> StageProposal {
    StageProposal {
        stage: stage.name().to_owned(),
        outcome: Outcome::NotUsed,
        note: note.to_owned(),
        error: None,
        prompt_sha256: String::new(),
        constraint_ids: Vec::new(),
        answered_by: String::new(),
        usage: TokenUsage::default(),
        counts: FateCounts::default(),
        items: Vec::new(),
    }
}

/// Asks once; returns the answer as it was written and as its type.
fn ask<A: DeserializeOwned>(
    desk: &Desk<'_, '_>,
    request: &LlmRequest,
    record: &mut StageProposal,
) -> Result<(String, A), LlmError> {
    let Asked { answer, usage } = (desk.proposer.ask)(request);
    record.usage.input = record.usage.input.saturating_add(usage.input);
    record.usage.output = record.usage.output.saturating_add(usage.output);
    record.usage.tries = record.usage.tries.saturating_add(usage.tries);
    let answer = answer?;
    record.answered_by.clone_from(&answer.model);
    let invalid = |problem: String| LlmError::InvalidAnswer { problems: vec![problem], text: String::new() };
    let json = answer.json.ok_or_else(|| invalid("there is no JSON in the answer".into()))?;
    let text = json.to_string();
    let typed = serde_json::from_value(json).map_err(|e| invalid(e.to_string()))?;
    Ok((text, typed))
}

/// Returns true for trouble that the next question would meet as well.
fn lasts(error: &LlmError) -> bool {
    error.stops_run()
        || matches!(error, LlmError::Unavailable { .. } | LlmError::Timeout { .. } | LlmError::RateLimited { .. })
}

/// Returns what went wrong with a model, without what the answer says: it may be anything.
fn plain(error: &LlmError) -> String {
    match error {
        LlmError::InvalidAnswer { problems, .. } => {
            format!("it does not have the form that was asked for, in {} places", problems.len().max(1))
        }
        other => other.to_string(),
    }
}

/// Returns what a model is told of its answer.
fn problems<T>(trial: &Trial<T>) -> String {
    let mut out = String::new();
    let told = trial.items.iter().filter(|i| !i.reason.is_empty());
    for item in told.take(MOST_PROBLEMS) {
        let _ = writeln!(out, "- {}: {}", item.proposed, item.reason);
    }
    if trial.result.is_none() {
        let _ = writeln!(out, "- {}", trial.note);
    }
    out
}

/// Returns the digest of all that is asked.
fn digest(request: &LlmRequest) -> String {
    let mut sha = Sha256::new();
    sha.update(request.system.as_deref().unwrap_or_default());
    for message in &request.messages {
        sha.update([0]);
        sha.update(&message.text);
    }
    if let Some(schema) = &request.schema {
        sha.update([0]);
        sha.update(schema.wire().to_string());
    }
    HEXLOWER.encode(&sha.finalize())
}
