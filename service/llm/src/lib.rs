//! Thin clients of language-model providers: one request, one checked answer, one retry policy, one budget.
//!
//! A [`Request`] goes to a [`Client`], which asks its [`Provider`] and gives back an [`Answer`]: text or checked JSON,
//! what it cites, what it used. Trouble is one of the categories of [`Error`], whoever the provider is. Names of models,
//! base URLs, keys and prices are values of the [`Config`] and the [`Budget`].
//!
//! ```
//! use d3dgen_llm::{Budget, Client, Request, RetryPolicy, Schema, providers::Replay};
//!
//! # tokio::runtime::Builder::new_current_thread().build().expect("a runtime without drivers").block_on(async {
//! let recording = r#"{"stage": "infer", "answer": {"text": "Sure: {'domain': 'office',}"}}"#;
//! let client = Client::new(Box::new(Replay::new(recording)?), RetryPolicy::default(), Budget::unlimited());
//! let schema = Schema::new("domain", serde_json::json!({
//!     "type": "object",
//!     "properties": {"domain": {"type": "string", "enum": ["office", "hospital"]}},
//!     "required": ["domain"],
//!     "additionalProperties": false,
//! }))?;
//! let answer = client.complete(&Request::new("infer", "desks for ten").with_schema(schema)).await?;
//! assert_eq!(answer.json, Some(serde_json::json!({"domain": "office"})));
//! assert!(!answer.grounded);
//! # Ok::<(), d3dgen_llm::Error>(())
//! # }).expect("the recording fits");
//! ```
//!
//! What it is not: it knows nothing of buildings or of where a key, a file or the date comes from; it follows no link
//! that an answer names; and it does not believe an answer. Whoever asks checks what was said against the evidence.

mod answer;
mod budget;
mod classify;
mod client;
mod delay;
mod error;
mod json_text;
mod policy;
pub mod providers;
mod request;
mod schema;
mod secret;
mod stream;
mod template;
mod transport;

pub use answer::{Answer, Citation, Finish, Note, Segment, Usage};
pub use budget::{Budget, CallRecord, Estimate, Limits, Plan, Prices, StageRow};
pub use client::{Client, Sleep};
pub use error::Error;
pub use json_text::json_candidates;
pub use policy::RetryPolicy;
pub use providers::{Config, Entry, Provider, Structured, TokenField};
pub use request::{Grounding, MIN_OUTPUT_TOKENS, Message, Request, Role};
pub use schema::{Schema, check_lowest_common};
pub use secret::Secret;
pub use template::fill;
