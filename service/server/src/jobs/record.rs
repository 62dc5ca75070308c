//! What is stored of a job.

use serde::{Deserialize, Serialize};
use tonic::Status;
use tonic_types::StatusExt;

use super::{batch, ingest, research};
use crate::status::code_name;

/// A job as it is stored.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// Id.
    pub id: String,
    /// Counts the jobs of this server.
    pub number: u64,
    /// Name of the client that asked for it.
    pub owner: String,
    /// What it does, for people.
    pub title: String,
    /// What is to be done.
    pub spec: Spec,
    /// Where it stands.
    pub state: State,
    /// Step at hand.
    pub stage: String,
    /// What is being done, for people.
    pub message: String,
    /// Share done, 0 to 1.
    pub fraction: f64,
    /// When it was asked for, ms since 1970.
    pub created_ms: u64,
    /// When it began first.
    pub started_ms: Option<u64>,
    /// When it ended.
    pub ended_ms: Option<u64>,
    /// How often it began.
    pub runs: u32,
    /// How often in a row it was cut short before a piece was done.
    pub cut_short: u32,
    /// True once the client has asked to stop.
    pub cancelled: bool,
    /// Why it failed.
    pub failure: Option<Failure>,
    /// What is finished, in the form of its kind.
    pub checkpoint: serde_json::Value,
    /// What came of it, in the form of its kind.
    pub outcome: serde_json::Value,
    /// Lines of log so far.
    pub lines: u64,
}

/// What is to be done.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
#[expect(clippy::large_enum_variant, reason = "a job has one, and few jobs run at once")]
pub enum Spec {
    /// Worlds of one request, the seed counted up.
    Batch(batch::Batch),
    /// A folder of models.
    Ingest(ingest::Ingest),
    /// A knowledge base of documents.
    Research(research::Research),
}

impl Spec {
    /// Returns the name of the kind.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Batch(_) => "batch",
            Self::Ingest(_) => "ingest",
            Self::Research(_) => "research",
        }
    }
}

/// Where a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Waits.
    Queued,
    /// Runs.
    Running,
    /// Ended well.
    Succeeded,
    /// Ended with an error.
    Failed,
    /// Was cancelled.
    Cancelled,
}

impl State {
    /// Returns true when it does not go on by itself.
    pub fn is_ended(self) -> bool {
        matches!(self, Self::Succeeded | Self::Failed | Self::Cancelled)
    }

    /// Returns the word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Running => "running",
            Self::Succeeded => "succeeded",
            Self::Failed => "failed",
            Self::Cancelled => "cancelled",
        }
    }
}

/// Why a job failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Name of the code that a call would have.
    pub code: String,
    /// What is wrong.
    pub message: String,
    /// Problems of the input: field and reason.
    pub problems: Vec<(String, String)>,
}

impl Failure {
    /// Returns what an answer says.
    pub fn of(status: &Status) -> Self {
        let fields = status.get_details_bad_request().map(|b| b.field_violations).unwrap_or_default();
        Self {
            code: code_name(status.code()).to_owned(),
            message: status.message().to_owned(),
            problems: fields.into_iter().map(|f| (f.field, f.description)).collect(),
        }
    }
}

/// How important a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// What was done.
    Info,
    /// What was left out, and why.
    Warning,
    /// What went wrong.
    Error,
}

/// A line of a job's log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Line {
    /// Number, from 1.
    pub seq: u64,
    /// When, ms since 1970.
    pub at_ms: u64,
    /// How important.
    pub level: Level,
    /// One sentence.
    pub text: String,
}

impl Job {
    pub(super) fn new(id: String, number: u64, owner: &str, title: String, spec: Spec, now_ms: u64) -> Self {
        Self {
            id,
            number,
            owner: owner.to_owned(),
            title,
            spec,
            state: State::Queued,
            stage: State::Queued.name().into(),
            message: String::new(),
            fraction: 0.0,
            created_ms: now_ms,
            started_ms: None,
            ended_ms: None,
            runs: 0,
            cut_short: 0,
            cancelled: false,
            failure: None,
            checkpoint: serde_json::Value::Null,
            outcome: serde_json::Value::Null,
            lines: 0,
        }
    }
}
