//! What a run did: time and tokens of each stage, as a table and as `execution.json`.

use serde::{Deserialize, Serialize};

use d3dgen_model::knowledge::KnowledgeBase;

/// Name of the file.
pub const EXECUTION: &str = "execution.json";

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// All was done.
    Complete,
    /// Some documents or topics are missing; what was found is kept.
    Partial,
}

/// A row of the execution table.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StageRow {
    /// `infer`, `search`, `documents`, `structure`, `extract`, `merge`, `synthesize`.
    pub stage: String,
    /// Seconds, waits included.
    pub seconds: f64,
    /// Requests to a model; answers kept from an interrupted run not among them.
    pub calls: u64,
    /// Answers that were kept from an earlier run.
    pub kept: u64,
    /// Requests without answer.
    pub failed: u64,
    /// How often the provider was asked, retries among them.
    pub tries: u64,
    /// Tokens of prompts.
    pub input_tokens: u64,
    /// Tokens of answers and thoughts.
    pub output_tokens: u64,
    /// Searches that ran.
    pub searches: u64,
    /// Money; absent when the model has no price or none was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
}

/// What a run did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Execution {
    /// Format version; 1.
    pub version: u32,
    /// How it ended.
    pub status: Status,
    /// Provider and model, when one was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// In the order of the run.
    pub stages: Vec<StageRow>,
    /// What is missing and what else to know.
    pub warnings: Vec<String>,
}

/// What a run found.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The knowledge base.
    pub knowledge: KnowledgeBase,
    /// Documents of the corpus.
    pub documents: usize,
    /// Passages read; 0 where the run started behind them.
    pub passages: usize,
    /// Rules before merging; 0 where the run started behind them.
    pub found: usize,
    /// Figures of a model that its evidence does not hold.
    pub unverified: usize,
    /// Time and tokens.
    pub execution: Execution,
}
